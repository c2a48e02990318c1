#!/bin/sh
# Predicted acuity and ghosts: what is asked for is written, and shown.
. "$(dirname "$0")/harness.sh"

cat > ridge.json <<'END'
{"format": "placido-surface/1", "vertex_z_mm": 0, "radius_mm": 4.5, "parts": [
  {"kind": "biconic", "r1": 7.8, "q1": -0.559},
  {"kind": "ridge", "slope": 0.02, "width_mm": 0.05, "offset_mm": 0.3, "axis_deg": 0}]}
END

echo "== asked for"
succeed simulate ridge.json --pupils 4 --acuity c8,e -o seen
"$JSON_CHECK" seen/pupil-4mm/acuity.json placido-acuity/1 > /dev/null || fail "acuity.json"
grep -q '"name": "c8"' seen/pupil-4mm/acuity.json || fail "no c8"
grep -q '"name": "sloan"' seen/pupil-4mm/acuity.json && fail "sloan was not asked for"
grep -q '"diplopia": true' seen/pupil-4mm/acuity.json || fail "a ridge doubles"
grep -q "^  e .*logMAR" out.txt || fail "the summary has no acuity"
grep -q "12 o'clock" out.txt || fail "the summary has no ghost"
grep -q '"logmar"' seen/simulation.json || fail "the record has no acuity"

echo "== an earlier result is replaced"
succeed simulate ridge.json --pupils 4 --acuity none -o seen
[ ! -e seen/pupil-4mm/acuity.json ] || fail "none was asked for"

echo "== the same with any number of threads"
succeed simulate ridge.json --pupils 4 --threads 1 -o one
succeed simulate ridge.json --pupils 4 --threads 3 -o three
for result in one three; do
  grep -v '"seconds"' $result/pupil-4mm/acuity.json > $result.txt
done
cmp -s one.txt three.txt || fail "threads change the acuity"

echo "== refused"
refuse 2 'acuity.*known are' simulate ridge.json --acuity snellen -o no
refuse 2 'acuity.*twice' simulate ridge.json --acuity e,e -o no
refuse 2 'acuity' simulate ridge.json --acuity e, -o no
finish
