#!/bin/sh
# Plans: told before anything runs, forced, refused, and beside every picture.
. "$(dirname "$0")/harness.sh"

cat > eye.json <<'END_OF_EYE'
{"format": "placido-surface/1", "vertex_z_mm": 0, "radius_mm": 4, "parts": [{"kind": "biconic", "r1": 7.8, "q1": -0.2}]}
END_OF_EYE
effects="pupil rest-of-eye stiles-crawford longitudinal-chromatic transverse-chromatic diffraction object-distance field
  straylight receptors"

# row NAME: what out.txt says of an effect.
row() {
  grep -E "(^| )$1( |\$)" out.txt | head -n 1
}

echo "== a plan before anything runs: every effect with its sentence, and nothing is written"
succeed plan street --eye eye.json --pupils 4
[ "$(find . ! -name '*.txt' | sort | tr '\n' ' ')" = '. ./eye.json ' ] || fail "a plan leaves something behind"
for name in $effects; do
  [ -n "$(row "$name")" ] || fail "$name is not in the plan"
done
succeed plan street --eye eye.json --pupils 4 --quiet
[ ! -s out.txt ] || fail "--quiet is not quiet"
succeed help plan
for name in $effects; do
  says "^  $name " out.txt
done

echo "== the pupil that the luminance gives is the default, and is wider for the young by night"
succeed plan street --eye eye.json --json
json out.txt - plans command exit_code
succeed plan street --eye eye.json --age 20 -o young.json
succeed plan street --eye eye.json --age 80 -o old.json
pupil() {
  grep -oE '"pupil_mm": *[0-9.]+' "$1" | head -n 1 | grep -oE '[0-9.]+'
}
awk "BEGIN {exit !($(pupil young.json) > $(pupil old.json) + 0.5)}" || fail "the old have no smaller pupil"

echo "== what is forced is told"
succeed plan building --eye eye.json --pupils 4 --force off all
! grep -Eq '^[a-z-]+ +runs' out.txt || fail "off all does not leave all out"
succeed plan building --eye eye.json --pupils 4 --force off all --force on diffraction --force on straylight
row diffraction | grep -q 'runs, forced' || fail "a forced effect is not told as such: $(row diffraction)"
row rest-of-eye | grep -q 'out, forced' || fail "the rest of the eye was forced off: $(row rest-of-eye)"
succeed plan building --eye eye.json --pupils 4 --force=on straylight
row straylight | grep -q 'runs, forced' || fail "straylight was forced on: $(row straylight)"
succeed plan building --eye eye.json --pupils 4 --force 'on straylight'

echo "== a tighter tolerance leaves out no more"
succeed plan building --eye eye.json --pupils 4 --tolerance 0.1
loose=$(grep -c 'left out' out.txt)
succeed plan building --eye eye.json --pupils 4 --tolerance 0.0001
[ "$(grep -c 'left out' out.txt)" -le "$loose" ] || fail "a tighter tolerance leaves out more"

echo "== as a file, and as one object"
succeed plan page --eye eye.json --pupils 3 -o plan.json
json plan.json placido-plan/1
succeed plan page --eye eye.json --pupils 2,4 --json
[ "$(grep -c '"placido-plan/1"' out.txt)" -eq 2 ] || fail "two pupils are not two plans"

echo "== refused"
refuse 2 'SCENE .*is missing' plan --eye eye.json
refuse 2 '--eye SURFACE.json is missing' plan street
refuse 3 'no-such-chart' plan no-such-chart --eye eye.json
refuse '1|3' 'none.json' plan street --eye none.json
refuse 2 'no effect "glare"' plan street --eye eye.json --force on glare
refuse 2 'on or off was expected' plan street --eye eye.json --force maybe straylight
refuse 2 'is missing' plan street --eye eye.json --force on
refuse 2 'is missing' plan street --eye eye.json --force off --json
refuse 2 '--iris red: brown, dark, green or blue' plan street --eye eye.json --iris red
refuse 2 '--age 3: it ranges' plan street --eye eye.json --age 3
refuse 2 '--tolerance 2: it ranges' plan street --eye eye.json --tolerance 2
refuse 2 '--pupils 4,wide: a number was expected' plan street --eye eye.json --pupils 4,wide
refuse 2 'auto stands twice' plan street --eye eye.json --pupils auto,auto
refuse 2 '-o takes one plan' plan street --eye eye.json --pupils 2,4 -o plans.json
refuse 2 '--cwhatuc knows the cornea alone' simulate eye.json --cwhatuc --force on field -o out
refuse 2 '--cwhatuc knows no pupil' simulate eye.json --cwhatuc --pupils auto -o out
refuse 4 '' plan street --eye eye.json --pupils 12

echo "== what it took is told"
asked=$(grep -oE '"seconds_asking": *[0-9.e-]+' plan.json | sed 's/.*: *//')
awk "BEGIN {exit !($asked > 0)}" || fail "planning took $asked s"

# Pictures that wait for waves and nodes of the field would take a minute: these effects have tests of their own.
quick="--force off field --force off diffraction --acuity none"

echo "== beside every picture"
# shellcheck disable=SC2086
succeed simulate eye.json --pupils 4 --scene street --scene building $quick --timing -o seen
says '^plan 4 mm +[0-9.]+' out.txt
says '^run 4 mm +[0-9.]+' out.txt
for scene in street building; do
  have seen/pupil-4mm/$scene.png
  json seen/pupil-4mm/$scene.plan.json placido-plan/1
done
json seen/pupil-4mm/psf.json placido-psf/1 effects.ran effects.left_out
if [ "$FIGURES" = ON ]; then
  [ "$(grep -c '<details class="plan"' seen/report.html)" -eq 2 ] || fail "the report has not two plans"
  for name in $effects; do
    says "<th scope=\"row\">$name</th>" seen/report.html
  done
fi
says '"field": "off"' seen/simulation.json
succeed simulate eye.json --pupils 4 --scene street --cwhatuc --acuity none -o plain
have plain/pupil-4mm/street.png
have_not plain/pupil-4mm/street.plan.json

echo "== a photograph does not tell its luminance"
cat > unlit.json <<'END_OF_SCENE'
{"format": "placido-scene/1", "name": "unlit", "image": "seen/pupil-4mm/street.png",
 "calibration": {"kind": "arcmin_per_px", "value": 0.5}}
END_OF_SCENE
refuse 2 'scene unlit: the pupil .* luminance' plan unlit.json --eye eye.json
refuse 2 'scene unlit: the pupil .* luminance' simulate eye.json --scene unlit.json --pupils auto -o out
succeed plan unlit.json --eye eye.json --pupils 4

echo "== every scene through the pupil that its light gives"
succeed simulate eye.json --pupils auto,3 --scene stars --scene building --force off all --force on pupil \
  --acuity none -o lit
have lit/pupil-3mm/stars.png lit/pupil-3mm/building.png
[ "$(find lit -name stars.png | wc -l)" -eq 2 ] || fail "the stars were not seen through their own pupil"
[ "$(find lit -name 'pupil-*' | wc -l)" -eq 3 ] || fail "two scenes have not two pupils"
json lit/simulation.json placido-simulation/1 pupils settings.forced settings.iris
says '"automatic": true' lit/simulation.json
says '"auto"' lit/simulation.json

finish
