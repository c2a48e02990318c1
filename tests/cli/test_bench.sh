#!/bin/sh
# `placido bench`: that every benchmark runs, what it tells, and that it leaves nothing behind. Never a time.
. "$(dirname "$0")/harness.sh"

# figure NAME: a row of the table with that name, a number and a unit.
figure() {
  says "^  $1 +[0-9.e+-]+ " out.txt
}

# compared NAME AGAINST: and a ratio.
compared() {
  says "^  $1 .* [0-9.e+-]+ × $2\$" out.txt
}

succeed help bench
for name in record live reconstruct simulate effects accuracy; do
  says "^  $name  " out.txt
done
for option in $(grep -oE '^  .{4}--[a-z-]+' out.txt | sed 's/.*--//'); do
  says "-$option" "$MANUAL/placido-bench.1"
done

refuse 2 'no benchmark "speed"' bench speed
refuse 2 'no benchmark "speed"' bench live speed --quick
refuse 2 'ranges from 0.1 to 3600' bench record --for 0

succeed bench --quick live reconstruct
says '^load [0-9.]+ on [0-9]+ processors$' out.txt
says '^live: ' out.txt
says '^reconstruct: ' out.txt
figure 'reading the frame once'
compared 'guidance of a frame' 'reading the frame once'
compared 'mires of a frame' 'reading the frame once'
compared 'surface with its error bars' 'reading the frame once'
for stage in 'mires of a frame' 'surface with its error bars' 'surface from the frame before'; do
  compared "$stage" 'one evaluation of residuals'
done
compared 'live topography' '30 frames/s'
if grep -q '^simulate: ' out.txt; then
  fail "simulate runs without being named"
fi

succeed bench simulate --quick
compared 'spread of 19,801 rays' 'tight loop: 19,801 rays, conicoid'
compared 'spread of a million rays' 'tight loop: a million rays, conicoid'
compared 'diffraction of a 4 mm pupil, 555 nm' 'transforms of 576×576'
compared 'the same, 31 wavelengths' 'transforms of 576×576'
compared 'fit of them to 100,000 values' '36 Zernike terms at 100,000 points'
compared 'convolution of 500×250×3' 'transforms of 500×250×3'

mkdir grid
succeed bench effects --quick -o grid
figure 'tumbling-e: largest difference'
figure 'tumbling-e: of tiny effects left out'
figure 'tumbling-e: planning, at most'
compared 'tumbling-e: planned' 'everything on'
says '^  tumbling-e: mostly runs ' out.txt
says '^scene,eye,pupil_mm,tolerance,difference,.*,diffraction_ran,diffraction_bound,diffraction_worth' \
  grid/effects.csv
says '^tumbling-e,normal,4,0.01,' grid/effects.csv

# The accuracy table: every stage of it, every row whole, and the user's own is not touched.
XDG_CACHE_HOME=$work/cache succeed bench accuracy --quick -o table
says '^accuracy: ' out.txt
compared 'mires: least error' 'what measuring leaves'
compared 'exam: its time' 'the probe'
says '^  The fit, error of elevation in the hardest of 2 eyes: .*µm costs [0-9.]+ ms \(' out.txt
says '^# placido-accuracy/1$' table/accuracy.csv
for stage in mires fit trace psf convolution acuity rest floor exam; do
  says "^$stage,[a-z_]+=.*,(normal|keratoconus),.*,[0-9.e+-]+$" table/accuracy.csv
done
awk -F, '/^#/ { next } NF != 9 { bad = 1 } END { exit bad }' table/accuracy.csv ||
  fail "a row of the accuracy table is not whole"
if [ "$FIGURES" = ON ]; then
  says 'Detection of the mires' table/accuracy.html
  says '<svg' table/accuracy-fit-psf_otf.svg
fi
[ ! -e cache ] || fail "a quick accuracy table is kept"
refuse 1 'nowhere' bench accuracy --quick -o nowhere/deeper

succeed bench --quick --json
json out.txt - load processors benchmarks command exit_code
says '"name": "simulate"' out.txt
succeed bench live --quick -q
[ ! -s out.txt ] || fail "--quiet is not quiet"

if [ "$SESSIONS" = ON ]; then
  mkdir disk
  succeed bench record --quick -o disk
  for codec in ffvhuff raw; do
    compared "$codec: recorded" 'the rate asked for'
    figure "$codec: share of a core"
    compared "$codec: written" "the samples' bytes"
    compared "$codec: dropped" 'the frames that came'
  done
  figure 'ffv1: recorded'
  if command -v ffmpeg > /dev/null; then
    compared 'ffv1: recorded' "ffmpeg's rate"
    figure 'ffmpeg ffv1: share of a core'
  fi
  [ -z "$(ls -A disk)" ] || fail "it leaves something on the disk"

  # Without ffmpeg there is nothing to compare with, which is told.
  mkdir none
  PATH_BEFORE=$PATH
  PATH=$work/none
  status=0
  "$PLACIDO" bench record --quick > out.txt 2> err.txt || status=$?
  PATH=$PATH_BEFORE
  [ "$status" -eq 0 ] || fail "without ffmpeg: exit $status"
  says 'warning: record: ffmpeg is not installed' err.txt
  figure 'ffv1: recorded'

  refuse 1 'cannot write into .*nowhere' bench record --quick -o nowhere
  # An hour of frames, 280 GB, fits nowhere that a test would run.
  room_kB=$(df -Pk . | awk 'NR == 2 { print $4 }')
  if [ "$room_kB" -lt 280000000 ]; then
    refuse 1 'has room for .* are needed' bench record --for 3600
  fi

  # A signal ends it, and what was on the disk is gone.
  "$PLACIDO" bench record --for 60 -o disk > out.txt 2> err.txt &
  job=$!
  waited=0
  while [ -z "$(ls disk/*/recorded.session/frames.mkv 2> /dev/null)" ] && [ $waited -lt 600 ]; do
    sleep 0.1
    waited=$((waited + 1))
  done
  kill -TERM $job
  status=0
  wait $job || status=$?
  [ "$status" -eq 143 ] || fail "TERM: exit $status"
  says 'stopped by a signal' err.txt
  [ -z "$(ls -A disk)" ] || fail "TERM leaves something on the disk"
else
  refuse 1 'FFmpeg|sessions' bench record --quick
fi
finish
