#!/bin/sh
# The accuracy test: on the phantom, and on pictures of objects that stand somewhere.
. "$(dirname "$0")/harness.sh"

# --- the phantom
succeed iso-check --quick -o accuracy
says 'sphere 7\.8 mm' out.txt
says 'over 6' out.txt
says 'types A and B are not reproduced' out.txt
says 'passed$' out.txt
have accuracy/iso-check.csv accuracy/iso-check.json
json accuracy/iso-check.json placido-iso-check/1 software instrument passed note objects objects
# a header, three objects of three zones
[ "$(wc -l < accuracy/iso-check.csv)" -eq 10 ] || fail "iso-check.csv has $(wc -l < accuracy/iso-check.csv) lines"
if [ "$FIGURES" = ON ]; then
  have accuracy/iso-check.html accuracy/iso-check.png
  says 'types A and B are not reproduced' accuracy/iso-check.html
fi
# an earlier result is replaced, a file of one's own is not
succeed iso-check --quick -q -o accuracy
[ ! -s out.txt ] || fail "--quiet prints"

# --- pictures: a ball off the axis, and a toric of which the surface is known
echo '{"format": "placido-surface/1", "radius_mm": 5.5, "parts": [{"kind": "biconic", "r1": 7.9, "q1": 0}]}' > ball.json
echo '{"format": "placido-surface/1", "radius_mm": 5.5, "parts": [{"kind": "biconic", "r1": 8, "q1": -0.2, "r2": 7.6, "q2": -0.2, "axis_deg": 40}]}' > toric.json
succeed phantom --eye ./ball.json --instrument cone24 --shift 0.2,-0.1,0 --blur 0.8 --noise 1 -o a.png
z_ball=$(sed 's/.*axis-z \(.*\) mm.*/\1/' out.txt)
succeed phantom --eye ./toric.json --instrument cone24 --shift 0.05,0.1,0 --blur 0.8 --noise 1 -o b.png
z_toric=$(sed 's/.*axis-z \(.*\) mm.*/\1/' out.txt)
succeed iso-check --instrument a.instrument.json --image a.png --sphere 7.9 --image b.png --surface toric.json \
  --axis-z "$z_ball,$z_toric"
says 'sphere 7\.9 mm +axial power.*passed' out.txt
says 'toric\.json +axis.*passed' out.txt

# the same as a list
mkdir list
cp a.png toric.json b.png list
printf '# objects\na.png,7.9,%s\n\nb.png,toric.json,%s\n' "$z_ball" "$z_toric" > list/objects.csv
succeed iso-check --instrument a.instrument.json --list list/objects.csv --json
json out.txt placido-iso-check/1 passed objects command exit_code
says '"passed": true' out.txt

# a ball that is not what it is said to be misses the targets, and the distance is asked for
status=0
"$PLACIDO" iso-check --instrument a.instrument.json --image a.png --sphere 7.8 -o missed > out.txt 2> err.txt || status=$?
[ "$status" -eq 4 ] || fail "a ball of the wrong radius: exit $status"
says 'FAILED' out.txt
says '1 of 1 objects miss' err.txt
says 'distance is not known' err.txt
have missed/iso-check.json

# --- what is wrong
refuse 2 '1 --image and 0' iso-check --instrument a.instrument.json --image a.png
refuse 2 'with --instrument' iso-check --image a.png --sphere 7.9
refuse 2 'sphere abc: a number' iso-check --image a.png --sphere abc
refuse 2 'axis-z: 2 values for 1' iso-check --instrument a.instrument.json --image a.png --sphere 7.9 --axis-z 0,1
echo 'a.png' > short.csv
refuse 3 'short.csv:1: expected image,object' iso-check --instrument a.instrument.json --list short.csv
echo '# nothing' > empty.csv
refuse 3 'names no object' iso-check --instrument a.instrument.json --list empty.csv
mkdir own
echo mine > own/file
refuse 1 'own' iso-check --quick -o own

finish
