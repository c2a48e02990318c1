#!/bin/sh
# Accuracy and time that are asked for: settings are chosen by the table, refusals say why, and what was promised and
# came out stands in the record.
. "$(dirname "$0")/harness.sh"
export XDG_CACHE_HOME="$work/cache" # nobody's own table

echo "== help and manual"
for command in exam reconstruct simulate; do
  "$PLACIDO" $command --help > help.txt
  for option in max-time accuracy; do
    says "--$option" help.txt
    says "-$option" "$MANUAL/placido-$command.1"
  done
done
for option in max-error max-error-psf degree fit-tolerance filter trials; do
  says "-$option" "$MANUAL/placido-exam.1"
done

succeed phantom --eye normal --instrument cone24 --noise 1.5 --blur 0.8 -o eye.png
z=$(sed -n 's/.*--axis-z \([-0-9.]*\).*/\1/p' out.txt)
eye="eye.png --instrument eye.instrument.json --axis-z ${z:-0}"

echo "== an error"
# shellcheck disable=SC2086
succeed reconstruct $eye --max-error 0.5um -o coarse
json coarse/reconstruction.json placido-reconstruction/1 accuracy.asked.max_error_um accuracy.promised.max_error_um \
  accuracy.promised.time_ms accuracy.settings.meridians accuracy.table.created accuracy.found.sigma_um \
  accuracy.found.time_ms
says "promised: elevation to" out.txt
# shellcheck disable=SC2086
succeed reconstruct $eye --max-error 50nm -o fine
coarse=$(sed -n 's/.*"meridians": \([0-9]*\).*/\1/p' coarse/reconstruction.json | head -n 1)
fine=$(sed -n 's/.*"meridians": \([0-9]*\).*/\1/p' fine/reconstruction.json | head -n 1)
[ "$coarse" -le "$fine" ] || fail "less error with fewer meridians: $fine than $coarse"

echo "== what stands on the command line stays, and what this measurement cannot keep is told"
succeed reconstruct eye.png --instrument eye.instrument.json --axis-z "${z:-0},0.1" --max-error 0.2 --knots 0.6 \
  --meridians 200 -o given
says "max-error 0.2 um is not kept.*distance" err.txt
says '"knot_mm": 0.59999999999999998' given/reconstruction.json
says '"meridians": 200' given/reconstruction.json

echo "== a time, and a name"
# shellcheck disable=SC2086
succeed exam $eye --max-time 3s --pupils 4 -o timed
json timed/exam.json placido-exam/1 accuracy.asked.max_time_ms accuracy.promised.max_error_psf accuracy.found.wall_ms
if [ "$FIGURES" = ON ]; then
  says "<h2>Accuracy</h2>" timed/report.html
fi
succeed simulate timed/surface.json --accuracy fast --pupils 4 -o fast
json fast/simulation.json placido-simulation/1 accuracy.asked.accuracy accuracy.promised.max_error_psf
says '"samples": 100' fast/simulation.json
# shellcheck disable=SC2086
succeed reconstruct $eye --accuracy standard -o standard
# shellcheck disable=SC2086
succeed reconstruct $eye -o default
cmp -s standard/surface.json default/surface.json || fail "standard is not the default"
grep -q '"accuracy"' default/reconstruction.json && fail "nothing was asked for"

echo "== one's own table"
mkdir -p cache/placido
echo "stage" > cache/placido/accuracy.csv
# shellcheck disable=SC2086
refuse 4 'cannot be promised' reconstruct $eye --max-error 1e-6um -o no
says "own accuracy table is not used: .*accuracy.csv:1" err.txt
cat > cache/placido/accuracy.csv <<'END'
# placido-accuracy/1
# created 2026-01-02T03:04:05Z
# machine by hand
# probe_ms 3
stage,setting,eye,elevation_um,axial_D,psf_otf,image,logmar,ms
mires,meridians=100,a,0.1,,,,,10
fit,knot_mm=0.7,a,0.1,,,,,50
rest,part=maps,a,,,,,,60
floor,knobs=finest,a,0.1,,,,,1
END
# shellcheck disable=SC2086
succeed reconstruct $eye --max-error 0.5 -o own
says '"machine": "by hand"' own/reconstruction.json
says '"meridians": 100' own/reconstruction.json
says '"max_error_um": 0.30000000000000' own/reconstruction.json
# shellcheck disable=SC2086
refuse 4 'elevation to 0.2 um cannot be promised: the best settings reach 0.3 um' \
  reconstruct $eye --max-error 0.2 -o no
rm cache/placido/accuracy.csv

echo "== refused before any work"
# shellcheck disable=SC2086
refuse 4 'elevation to 1e-06 um cannot be promised.*limits it' reconstruct $eye --max-error 1e-6um -o no
# shellcheck disable=SC2086
refuse 4 '1 ms cannot be promised: the quickest settings take' exam $eye --max-time 1ms -o no
# shellcheck disable=SC2086
refuse 4 'accurate enough take' reconstruct $eye --max-error 0.5 --max-time 1 -o no
# shellcheck disable=SC2086
refuse 4 'promised of knot_mm=0.15' reconstruct $eye --max-error 0.5 --knots 0.15 -o no
refuse 2 'max-error 3cm: a number was expected, in um or mm' reconstruct eye.png --max-error 3cm -o no
refuse 2 'max-time -1: it ranges' reconstruct eye.png --max-time=-1 -o no
refuse 2 'accuracy best: fast, standard or reference' reconstruct eye.png --accuracy best -o no
refuse 2 'leave one out' reconstruct eye.png --accuracy fast --max-error 1 -o no
refuse 2 'max-time.*combine' reconstruct eye.png --max-time 1s --combine 3 -o no
refuse 2 'max-time.*diffraction' simulate timed/surface.json --max-time 1s --diffraction 555 -o no
refuse 2 'cwhatuc' simulate timed/surface.json --max-time 1s --cwhatuc -o no
refuse 2 'degree 4: 3 or 5' reconstruct eye.png --degree 4 -o no
refuse 2 'filter' reconstruct eye.png --filter 9 -o no
refuse 2 'trials' simulate timed/surface.json --trials 3 -o no
finish
