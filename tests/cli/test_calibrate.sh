#!/bin/sh
# Balls in, a calibrated instrument out; and the daily check with its log.
. "$(dirname "$0")/harness.sh"

# A topographer with a quarter of the built-in one's pixels, so that rendering is quick.
succeed phantom --eye sphere --instrument cone24 -o s.png
sed 's/1280/640/; s/1024/512/; s/10800\.0/5400/; s/639\.5/319.5/; s/511\.5/255.5/; s/"calibrated": true/"calibrated": false/' \
  s.instrument.json > nominal.json
# What it really is: the camera is 0.2 mm farther away, its lens longer by 1 %.
sed 's/5400/5454/; s/120\.0/120.2/' nominal.json > real.json

# ball RADIUS X Y Z NAME
ball() {
  echo "{\"format\": \"placido-surface/1\", \"radius_mm\": 5.5, \"parts\": [{\"kind\": \"biconic\", \"r1\": $1, \"q1\": 0}]}" > ball.json
  succeed phantom --eye ./ball.json --instrument ./real.json --shift "$2,$3,$4" --noise 1 --blur 0.6 -o "$5.png"
}
ball 6.5 0.2 0.1 -0.8 a1
ball 6.5 -0.2 0.2 0.8 a2
ball 9.5 0.1 -0.2 -0.8 b1
ball 9.5 -0.1 -0.2 0.8 b2
ball 7.8 0.05 0 0 c1

plan() {
  echo "{\"format\": \"placido-calibration/1\", \"instrument\": \"nominal.json\", \"pictures\": ["
  for picture in "a1 6.5 -0.8" "a2 6.5 0.8" "b1 9.5 -0.8" "b2 9.5 0.8"; do
    set -- $picture
    echo "{\"file\": \"$1.png\", \"radius_mm\": $2, \"z_mm\": $3, \"z_sigma_mm\": 0.005},"
  done
  echo "{\"file\": \"c1.png\", \"radius_mm\": 7.8, \"z_mm\": 0, \"z_sigma_mm\": 0.005, \"held_out\": true}]}"
}
plan > plan.json

# --- calibrate
succeed calibrate plan.json -o calibration
says 'held out: ball of 7.8 mm measured as 7\.(79|80)' out.txt
says 'only 2 balls|2 times' err.txt
have calibration/instrument.json calibration/calibration.json
json calibration/instrument.json placido-instrument/1 sigma.camera.focal_px sigma.mires.edges covariance.modes
json calibration/calibration.json placido-calibration-report/1 solution.rms_px balls pictures edges undetermined
says '"calibrated": true' calibration/instrument.json

refuse 1 'exists|empty' calibrate plan.json -o calibration
refuse 2 'PLAN.json is missing' calibrate -o new
sed 's/"a2.png", "radius_mm": 6.5, "z_mm": 0.8, "z_sigma_mm": 0.005/"a2.png", "radius_mm": 6.5, "z_mm": 0.8/' plan.json > broken.json
refuse 3 'pictures\[1\].z_sigma_mm' calibrate broken.json -o new
sed 's/b2.png/nowhere.png/' plan.json > broken.json
refuse '1|3' 'nowhere.png' calibrate broken.json -o new

# --- verify
succeed verify c1.png --instrument calibration/instrument.json --ball 7.8 --axis-z 0 --log verify.csv
says '^passed' out.txt
succeed verify c1.png --instrument real.json --ball 7.8 --log verify.csv
says 'only its shape' err.txt
status=0
"$PLACIDO" verify c1.png --instrument nominal.json --ball 7.8 --axis-z 0 --log verify.csv > out.txt 2> err.txt || status=$?
[ "$status" -eq 4 ] || fail "verify with the nominal instrument: exit $status"
says 'FAILED' out.txt
says 'axial power' err.txt
[ "$(wc -l < verify.csv)" -eq 4 ] || fail "the log has $(wc -l < verify.csv) lines, not a header and three"
says '^time,result,ball_mm' verify.csv
says '^20[0-9-]*T[0-9:]*Z,pass,7.8,.*,given,' verify.csv
says '^20[0-9-]*T[0-9:]*Z,fail,7.8,' verify.csv
if [ "$FIGURES" = ON ]; then
  have verify.png
fi

# A line that a power cut tore harms only itself.
printf '2026-11-22T07:00:00Z,pass,7.8' >> verify.csv
succeed verify c1.png --instrument calibration/instrument.json --ball 7.8 --axis-z 0 --log verify.csv --json
json out.txt - passed radius_mm rms_8_um power_error_D
says '1 lines of verify.csv cannot be read' err.txt
[ "$(wc -l < verify.csv)" -eq 6 ] || fail "the torn line was not ended"

echo "my own notes" > notes.csv
refuse 3 'no log of placido verify' verify c1.png --instrument real.json --ball 7.8 --axis-z 0 --log notes.csv --quiet
[ "$(cat notes.csv)" = "my own notes" ] || fail "a person's file was changed"
refuse 2 '--ball' verify c1.png --instrument real.json
refuse 2 '--instrument' verify c1.png --ball 7.8
refuse 2 'ranges from' verify c1.png --instrument real.json --ball 70
finish
