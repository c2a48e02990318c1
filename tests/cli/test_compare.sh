#!/bin/sh
# Two exams compared: an eye with itself, moved in between, with the other eye; and what is no exam.
. "$(dirname "$0")/harness.sh"

# number FILE PATH-OF-LINES: the first value behind the keys, one after the other.
number() {
  awk -v keys="$2" 'BEGIN { n = split(keys, key, " "); k = 1 }
    index($0, "\"" key[k] "\"") { if (k == n) { sub(/^[^:]*: */, ""); sub(/,$/, ""); print; exit } k++ }' "$1"
}

# within VALUE EXPECTED TOLERANCE WHAT
within() {
  awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { exit !(a - b <= t && b - a <= t) }' ||
    fail "$4 is $1, not $2 within $3"
}

echo "== an eye, and the same eye 0.15 mm to the right"
succeed phantom --eye keratoconus --instrument cone24 --noise 1 -o a.png --json
z=$(number out.txt axis_z_mm)
succeed reconstruct a.png --instrument a.instrument.json --axis-z "$z" -o a
succeed phantom --eye keratoconus --instrument cone24 --noise 1 --seed 2 --shift 0.15,-0.1,0 -o b.png --json
z=$(number out.txt axis_z_mm)
succeed reconstruct b.png --instrument a.instrument.json --axis-z "$z" -o b
have a/maps_more.csv a/maps_sigma.csv
[ "$(wc -l < a/maps_more.csv)" -eq "$(wc -l < a/maps.csv)" ] || fail "maps_more.csv has not the rows of maps.csv"
[ "$(wc -l < a/maps_sigma.csv)" -eq "$(wc -l < a/maps.csv)" ] || fail "maps_sigma.csv has not the rows of maps.csv"
json a/reconstruction.json - maps.best_fit_toric.q maps.best_fit_conic.r1_mm maps.retina_mm maps.index

succeed compare a a -o same
json same/compare.json placido-compare/1 alignment.shift_x_mm.sigma alignment.torsion_deg.value maps.elevation.zones indices mirrored warnings
within "$(number same/compare.json 'maps zones mean')" 0 1e-9 "the difference of an eye with itself"
within "$(number same/compare.json 'alignment rms_um')" 0 1e-6 "what is left of an eye and itself"
have same/difference.csv
[ "$(head -n 1 same/difference.csv)" = x_mm,y_mm,valid,difference_elevation_um,sigma_elevation_um,difference_axial_D,sigma_axial_D,difference_tangential_D,sigma_tangential_D ] ||
  fail "the columns of difference.csv"
if [ "$FIGURES" = ON ]; then
  have same/compare.html same/maps/elevation.png same/maps/axial.png same/maps/tangential.png
  says 'data:image/png;base64' same/compare.html
else
  have_not same/compare.html
  says 'draws no figures' err.txt
fi

# The noise of two pictures moves heights by some 0.01 µm, and the vertex, found again, by a micrometre.
succeed compare a b -o moved
within "$(number moved/compare.json 'shift_x_mm value')" -0.15 0.005 "the shift found"
within "$(number moved/compare.json 'shift_y_mm value')" 0.1 0.005 "the shift found"
within "$(number moved/compare.json 'alignment rms_um')" 0 0.1 "what is left of a moved eye"
succeed compare a b --no-align -o moved --json
json out.txt placido-compare/1 alignment exit_code
[ "$(number out.txt alignment)" = null ] || fail "--no-align aligns"

echo "== the other eye, mirrored"
sed 's/"x_mm": 0.45/"x_mm": -0.45/; s/"axis_deg": 20/"axis_deg": 160/; s/"axis_deg": 12/"axis_deg": 168/' a.surface.json > left.json
succeed phantom --eye left.json --instrument cone24 --noise 1 --seed 3 -o left.png --json
z=$(number out.txt axis_z_mm)
succeed reconstruct left.png --instrument a.instrument.json --axis-z "$z" -o left
succeed compare a left --mirror -o eyes
within "$(number eyes/compare.json 'alignment rms_um')" 0 0.1 "what is left of mirrored eyes"
within "$(number eyes/compare.json 'simk_flat_axis_deg difference')" 0 1 "the axis of a mirrored eye"

echo "== what cannot be compared"
refuse 2 'EXAM_A is missing' compare -o no
refuse 2 'two exams are compared' compare a -o no
refuse 2 'two exams are compared' compare a b left -o no
refuse 2 'say where the result goes' compare a b
refuse 3 'is no exam' compare a . -o no
refuse 3 'is no exam' compare nothing b -o no
cp -r b broken
sed -i '30s/.*/0.1,x,1/' broken/maps.csv
refuse 3 'maps.csv:30: ' compare a broken -o no
cp b/maps.csv broken/maps.csv
sed -i 's|placido-reconstruction/1|placido-reconstruction/9|' broken/reconstruction.json
refuse 3 'placido-reconstruction/9.*placido-reconstruction/1|placido-reconstruction/1.*placido-reconstruction/9' compare a broken -o no
cp b/reconstruction.json broken/
echo '{"format": "placido-indices/1", "indices": [{"name": 3}]}' > broken/indices.json
refuse 3 'indices\[0\].name' compare a broken -o no
cp b/indices.json broken/
rm broken/maps_sigma.csv
succeed compare a broken -o partial
says 'warning: .*maps_sigma.csv is missing' err.txt
rm broken/surface.json
refuse 1 'surface.json' compare a broken -o no
mkdir -p precious && echo mine > precious/file
refuse 1 'precious' compare a b -o precious
finish
