#!/bin/sh
# Others' heights: a CSO export and tables, what comes of them, and what is refused.
. "$(dirname "$0")/harness.sh"

# cso NAME: what a CSO topographer would export of a toric cornea of 7.9 and 7.7 mm, lying and standing.
cso() {
  awk 'function put(value,   text) { text = sprintf("%.12g", value); sub(/\./, ",", text); printf "%s\r\n", text }
    BEGIN {
      printf "Paziente :\r\nOcchio : True\r\nSIM-k : \r\nK1 = 42,6 D @ 0\302\260\r\nK2 = 43,7 D @ 90\302\260\r\n"
      printf "Dato misurato : Elevazioni\r\nN\302\260 Anelli : 24\r\nN\302\260 Semimeridiani : 256\r\n-----\r\n"
      for (block = 0; block < 2; block++) for (ring = 0; ring < 24; ring++) for (j = 0; j < 256; j++) {
        r = 0.2 + 0.2 * ring; a = j * 6.283185307179586 / 256
        x = r * cos(a); y = r * sin(a); p = x * x / 7.9 + y * y / 7.7
        sag = p / (1 + sqrt(1 - x * x / 7.9 / 7.9 - y * y / 7.7 / 7.7))
        put(ring > 19 && j < 40 ? -1 : block ? -sag : r)
      }
    }' > "$1"
}

# figure KEY FILE: a number from indices.json or a record.
figure() {
  awk -v name="\"$1\"" 'index($0, name) { found = 1 } found && match($0, /"value": [-0-9.e]+/) {
    print substr($0, RSTART + 9, RLENGTH - 9); exit }' "$2"
}

near() { # near VALUE EXPECTED LIMIT WHAT
  awk -v a="$1" -v b="$2" -v limit="$3" 'BEGIN { d = a - b; exit !(a != "" && d <= limit && -d <= limit) }' ||
    fail "$4 is $1, not $2"
}

echo "== a CSO export"
cso eye.txt
succeed import eye.txt -o cornea
says '5984 points, 160 missing: residual 0\.0' out.txt
json cornea/import.json placido-import/1 heights.rms_um heights.maker.k1_D fit.points
json cornea/indices.json placido-indices/1 indices
json cornea/surface.json placido-surface/1 coverage parts
have cornea/maps.csv
have_not cornea/mires.csv cornea/mires.png cornea/capture.png
near "$(figure simk_flat_D cornea/indices.json)" 42.72 0.02 "flat SimK"
near "$(figure simk_steep_axis_deg cornea/indices.json)" 90 0.5 "its axis"
near "$(figure simk_steep_D cornea/indices.json)" 43.83 0.02 "steep SimK"
near "$(figure placido_pi_2 cornea/indices.json)" 0 0.001 "PI_2 of concentric rings"
succeed import eye.txt -o cornea --json
json out.txt - directory indices heights exit_code
refuse 1 'cornea' import eye.txt -o cornea/import.json
refuse 1 'exists, and there is no reconstruction.json' reconstruct eye.txt --instrument eye.txt -o cornea

echo "== tables"
succeed import cornea/maps.csv -q -o again
near "$(figure simk_steep_D again/indices.json)" 43.83 0.03 "SimK of maps.csv"
awk -F, 'NR > 1 && $3 == 1 { printf "%s %s %.9g\n", $1, $2, -1000 * $4 }' cornea/maps.csv > depths.txt
succeed import depths.txt --unit mm,um -o depths
says 'taken for depths' err.txt
succeed import depths.txt --unit mm,um --heights down --eye OS -o depths
! grep -q 'taken for depths' err.txt || fail "a note although --heights says it"
says '"eye": "OS"' depths/import.json

echo "== refused, and nothing left"
refuse 3 'depths.txt:1: z is 1[0-9.]* mm: the unit is wrong' import depths.txt -o out
refuse 4 'depths.txt: the points have a radius of curvature of -' \
  import depths.txt --unit mm,um --heights up -o out
head -n 100 depths.txt > few.txt
refuse 4 'few.txt: only 100 points' import few.txt --unit mm,um -o out
head -n 2000 eye.txt > short.txt
refuse 3 'short.txt:2000: the file ends after 1991 of 12288 numbers' import short.txt -o out
sed '500s/.*/1,2,3/' eye.txt > bad.txt
refuse 3 'bad.txt:500: "1,2,3" is no number' import bad.txt -o out
refuse 1 'nothing.txt' import nothing.txt -o out
head -c 3000 /dev/zero > zero.txt
refuse 3 'is no text' import zero.txt -o out
refuse 2 '--unit furlong: mm, um' import eye.txt --unit furlong -o out
refuse 2 '--heights left: up' import eye.txt --heights left -o out
refuse 2 'FILE .*is missing' import -o out
refuse 2 '-o' import eye.txt

finish
