#!/bin/sh
# Several frames made into one, and an examination of recordings in which something goes wrong.
. "$(dirname "$0")/harness.sh"
if [ "$SESSIONS" != ON ]; then
  echo "skipped: this build has no sessions"
  exit 0
fi
succeed phantom --eye normal --instrument cone24 --noise 4 --frames 8 -o eye.session

echo "== frames combined"
succeed reconstruct eye.session --combine 8 --json -o together
json together/reconstruction.json placido-reconstruction/1 settings.combine capture.combined
says '^placido: warning: frame 2 was (set aside|left out)' err.txt # out of focus
cp out.txt together.txt
says '"weight": 0\.1' together.txt
succeed reconstruct eye.session --combine 8 -o together
says '^[4-7] frames combined, of which frame [0-9] is the best' out.txt
cp together/maps.csv maps.first
succeed reconstruct eye.session --combine 8 --threads 1 --quiet -o together
cmp maps.first together/maps.csv || fail "the maps depend on the number of threads"
succeed reconstruct eye.session --combine 20 -o together
says 'warning: 20 frames to combine were asked for, 8 can be' err.txt
succeed reconstruct eye.session --combine 1 -o together
if grep -q combined out.txt; then
  fail "--combine 1 combines"
fi
"$PLACIDO" session export eye.session --frames 0 -o pictures -q
succeed reconstruct pictures/*.png --instrument eye.session/instrument.json --combine 4 -o together
says '4 frames to combine were asked for, 1 can be' err.txt
refuse 2 'leave one of them out' reconstruct eye.session --combine 4 --frame 1 -o no
refuse 2 '--combine 33: it ranges from 1 to 32' reconstruct eye.session --combine 33 -o no

# examine SCRIPT: as far as an exam's first half.
examine() {
  echo "== $1"
  echo "$1" > faults.txt
  succeed reconstruct 'replay:eye.session?faults=faults.txt' --meridians 90 -o result
}
# examine_not SCRIPT EXIT PATTERN
examine_not() {
  echo "$1" > faults.txt
  refuse "$2" "$3" reconstruct 'replay:eye.session?replug_s=0.5&faults=faults.txt' -o no
}
examine 'at frame 1 drop 3'
says '^frame [0-9] of 5' out.txt
examine 'at 0s truncate 2'
says 'warning: 2 of 8 frames are damaged$' err.txt
examine 'at frame 3 corrupt 5'
says 'warning: 5 of 8 frames are damaged$' err.txt
examine 'at frame 0 damage 3'
says 'warning: 3 of 8 frames are damaged$' err.txt
examine 'at frame 4 delay 200ms'
examine 'at frame 2 disconnect 50ms'
says 'warning: the device was unplugged and came back, 1 time$' err.txt
examine_not 'at frame 2 disconnect' 1 'unplugged for good, as its script says; waited 0.5 s'
examine_not 'at frame 7 error' 1 'failed, as its script says'
examine_not 'at frame 0 drop 8' 3 'holds no frame that can be read'
examine_not 'at frame 0 dorp' 3 'faults.txt:1: "dorp" is not drop'
refuse 1 'cannot open .*not-there|not-there: No such file' reconstruct 'eye.session?faults=not-there' -o no

finish
