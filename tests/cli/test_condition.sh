#!/bin/sh
# The condition numbers of a record against differences of records.
. "$(dirname "$0")/harness.sh"

# entry NAME KEY FILE: the first number called KEY after the first "name": NAME among the outputs.
entry() {
  awk -v name="\"name\": \"$1\"" -v key="\"$2\": " '/"outputs"/ { here = 1 }
    here && index($0, name) { found = 1 }
    found && (at = index($0, key)) { text = substr($0, at + length(key)); sub(/[,}].*/, "", text); print text; exit }' "$3"
}

# near VALUE EXPECTED LIMIT WHAT
near() {
  awk -v a="$1" -v b="$2" -v limit="$3" 'BEGIN { d = a - b; exit !(a != "" && b != "" && d <= limit && -d <= limit) }' ||
    fail "$4 is $1, not $2 within $3"
}

echo "== what a record says"
succeed phantom --eye irregular --instrument cone24 -o eye.png --noise 1
for z in -0.02 0 0.02; do
  succeed reconstruct eye.png --instrument eye.instrument.json --axis-z="$z,0.05" --knots 0.5 --wavefront 4 -q -o "at$z"
done
record=at0/reconstruction.json
json $record placido-reconstruction/1 condition.normal_matrix condition.zone_mm condition.inputs.edges.sigma_px \
  condition.inputs.edges.scale_px condition.inputs.distance.sigma_mm condition.inputs.distance.scale_mm condition.outputs
near "$(awk '/"scale_mm"/ { sub(/.*: /, ""); print; exit }' $record)" 120 1e-9 "the working distance"

echo "== the derivative by the distance is the difference of two fits"
# Differences over 0.04 mm are exact to the third order; each fit ends within a hundredth of its noise, which leaves
# some 1e-3 of the change. One part in a hundred is asked for. The power's derivative is nearly the same everywhere, so
# that the root mean square's is that of the root mean square.
for name in simk_mean_D axial; do
  slope=$(entry $name per_mm $record)
  before=$(entry $name value at-0.02/reconstruction.json)
  after=$(entry $name value at0.02/reconstruction.json)
  found=$(awk -v a="$before" -v b="$after" 'BEGIN { printf "%.9g", (b - a) / 0.04 }')
  limit=$(awk -v a="$slope" 'BEGIN { print 0.01 * (a < 0 ? -a : a) + 1e-3 }')
  echo "$name: $slope per mm, $found between fits"
  near "$slope" "$found" "$limit" "$name per mm"
done

echo "== sources add up"
for name in elevation axial simk_mean_D z_4_0; do
  sigma=$(entry $name sigma $record)
  edges=$(entry $name per_sigma $record)
  slope=$(entry $name per_mm $record)
  sum=$(awk -v e="$edges" -v s="$slope" 'BEGIN { printf "%.9g", sqrt(e * e + 0.0025 * s * s) }')
  # the distance's own share bends by some 1e-3 over its sigma of 0.05 mm
  near "$sum" "$sigma" "$(awk -v s="$sigma" 'BEGIN { print 5e-3 * s }')" "$name's sigma from its sources"
done

echo "== the smaller the noise, the smaller what edges do, and not per pixel"
succeed phantom --eye irregular --instrument cone24 -o noisy.png --noise 6
succeed reconstruct noisy.png --instrument noisy.instrument.json --axis-z=0,0.05 --knots 0.5 -q -o noisy
quiet=$(entry elevation per_sigma $record)
noisy=$(entry elevation per_sigma noisy/reconstruction.json)
awk -v a="$quiet" -v b="$noisy" 'BEGIN { exit !(b > 1.5 * a) }' || fail "edges leave $noisy um with more noise, $quiet before"
# smoothing counts for less where noise is small, and edges err together where it is: per pixel within a factor of two
ratio=$(awk -v a="$(entry elevation per_px $record)" -v b="$(entry elevation per_px noisy/reconstruction.json)" 'BEGIN { print b / a }')
near "$ratio" 1.25 0.75 "the ratio of what a pixel does"

if [ "$FIGURES" = ON ]; then
  echo "== and the page"
  succeed exam eye.png --instrument eye.instrument.json --axis-z=0,0.05 --pupils 3 --acuity none -q -o exam
  says 'Independent errors of 0.1 px in all edge points change elevation by' exam/report.html
  json exam/exam.json placido-exam/1 condition.outputs
  says '"name": "strehl_g"' exam/exam.json
fi

finish
