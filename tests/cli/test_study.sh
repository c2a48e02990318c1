#!/bin/sh
# The study: the phantom's eyes, and a folder of surfaces with all that may lie in one.
. "$(dirname "$0")/harness.sh"

# column NAME FILE: the values of a column of a study.csv, a line each; none but the last holds commas
column() {
  awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) k = i; next } { print $k }' "$2"
}

# --- the phantom
succeed study --quick --eyes normal,diplopic-scar -o study
have study/study.csv study/study.json
json study/study.json placido-study/1 software created source acuity pupils_mm scenes findings eyes
# a header, two eyes of three pupils
[ "$(wc -l < study/study.csv)" -eq 7 ] || fail "study.csv has $(wc -l < study/study.csv) lines"
for eye in normal diplopic-scar; do
  have "study/eyes/$eye/surface.json"
  for pupil in 2 4 8; do
    have "study/eyes/$eye/pupil-${pupil}mm/psf.json" "study/eyes/$eye/pupil-${pupil}mm/tumbling-e.png"
  done
done
# every cell has its figures: an acuity that was found, bars, a retina; none is NaN
[ "$(column verdict study/study.csv | sort -u)" = found ] || fail "not every acuity was found"
for name in logmar sigma_logmar low_logmar high_logmar snellen_20 bars_20 strehl_g retina_mm outside rays_entered; do
  column "$name" study/study.csv | grep -Evq '^-?[0-9.]+(e-?[0-9]+)?$' && fail "$name is not a number everywhere"
done
if grep -iq 'nan\|inf,' study/study.csv; then
  fail "study.csv has NaN"
fi
# the seed's findings: a regular cornea shows 20/10 to 20/40 at every pupil; behind the crease there is a ghost across
# it, upwards (80 degrees, within 20), at the largest pupil
says '"met": 3' study/study.json
column bars_20 study/study.csv | head -n 3 | awk '$1 < 9.9 || $1 > 40 { bad = 1 } END { exit bad }' \
  || fail "the normal eye is not between 20/10 and 20/40"
column ghost_deg study/study.csv | tail -n 1 | awk '{ exit !($1 > 60 && $1 < 100) }' \
  || fail "the diplopic eye's ghost is not across the crease"
[ "$(column diplopia study/study.csv | tail -n 1)" = 1 ] || fail "the diplopic eye does not see double"
if [ "$FIGURES" = ON ]; then
  have study/study.html study/eyes/normal/axial.png study/eyes/normal/pupil-2mm/psf.png
  says 'keep a tenth of their contrast' study/study.html
  says 'diplopic-scar' study/study.html
fi

# the same on one thread and on several, and in place of an earlier study
cp study/study.csv first.csv
succeed study --quick --eyes normal,diplopic-scar --threads 3 -q -o study
[ ! -s out.txt ] || fail "--quiet prints"
cmp first.csv study/study.csv || fail "the result depends on the threads"

# --- a folder: a surface, an exam, another format, what is no surface, and a broken one
mkdir -p folder/exam1 folder/empty
cp study/eyes/normal/surface.json folder/b.json
cp study/eyes/diplopic-scar/surface.json folder/exam1/surface.json
echo '{"format": "placido-indices/1"}' > folder/indices.json
echo 'a note' > folder/readme.txt
succeed study folder --quick --pupils 3 --scenes fan -o two
[ "$(column eye two/study.csv | tr -d '"' | tr '\n' ' ')" = 'b exam1 ' ] || fail "not the folder's eyes: $(column eye two/study.csv)"
have two/eyes/b/pupil-3mm/fan.png two/eyes/exam1/pupil-3mm/fan.png
succeed study folder --quick --pupils 3 --scenes fan --eyes b --json -o one
json out.txt placido-study/1 eyes command exit_code

echo '{"format": "placido-surface/1", "parts": [{"kind": "cube"}]}' > folder/broken.json
status=0
"$PLACIDO" study folder --quick --pupils 3 -o three > out.txt 2> err.txt || status=$?
[ "$status" -eq 3 ] || fail "a broken surface: exit $status"
says 'left out: .*broken.json' err.txt
says '1 of 3 surfaces' err.txt
says 'broken.*left out' out.txt
[ "$(wc -l < three/study.csv)" -eq 3 ] || fail "the others are not there"

# a pupil that the cornea does not fill is left out and says why
echo '{"format": "placido-surface/1", "radius_mm": 3, "parts": [{"kind": "biconic", "r1": 7.8, "q1": -0.2}]}' > small.json
mkdir small
mv small.json small
succeed study small --quick --pupils 2,8 -o small-study
says '8,left_out' small-study/study.csv
says 'left out' err.txt

# --- what is wrong
mkdir nothing only-broken own
cp folder/broken.json only-broken
echo mine > own/file
refuse 3 'holds no surface' study nothing --quick -o out
refuse 3 'no surface can be read.*cube' study only-broken --quick -o out
refuse 1 'missing: cannot be read as a folder' study missing --quick -o out
refuse 2 'eyes: .*no surface "c"' study folder --eyes b,c -o out
refuse 2 'no built-in eye is called "square"' study --eyes square -o out
refuse 2 'pupils: 4 stands twice' study --pupils 4,4 -o out
refuse 2 'scenes' study --scenes fan,,fan -o out
refuse 2 'fan.png is taken' study --scenes fan,fan -o out
refuse 2 '-o' study
refuse 1 'own' study --quick -o own

finish
