#!/bin/sh
# How scenes are convolved without a plan, which chooses for itself: in double precision, in tiles, with transforms
# measured for the machine.
. "$(dirname "$0")/harness.sh"

cat > eye.json <<'END'
{"format": "placido-surface/1", "vertex_z_mm": 0, "radius_mm": 3, "parts": [{"kind": "biconic", "r1": 7.8, "q1": -0.2}]}
END
export XDG_CACHE_HOME="$work/cache"
wisdom=cache/placido/fftw-float.wisdom

succeed simulate eye.json --pupils 4 --cwhatuc -o usual
[ ! -e cache ] || fail "a cache was made without being asked for"
succeed simulate eye.json --pupils 4 --cwhatuc -o again --threads 1
cmp -s usual/pupil-4mm/tumbling-e.png again/pupil-4mm/tumbling-e.png || fail "two runs differ"

succeed simulate eye.json --pupils 4 --cwhatuc --wisdom -o measured
[ -s $wisdom ] || fail "nothing was kept in $wisdom"
cp $wisdom first
succeed simulate eye.json --pupils 4 --cwhatuc --wisdom -o measured
cmp -s $wisdom first || fail "what was known was measured again"
echo nonsense > $wisdom
succeed simulate eye.json --pupils 4 --cwhatuc --wisdom -o measured
says 'no wisdom of this FFTW' err.txt
[ "$(wc -c < $wisdom)" -gt 100 ] || fail "broken wisdom stayed"

succeed simulate eye.json --pupils 4 --cwhatuc --double --memory 1 -o exact
[ ! -e cache/placido/fftw-double.wisdom ] || fail "wisdom was not asked for"
XDG_CACHE_HOME=/dev/null/cache succeed simulate eye.json --pupils 4 --cwhatuc --wisdom -o measured
says 'are not kept: cannot make' err.txt
refuse 2 '--wisdom is for --cwhatuc' simulate eye.json -o out --wisdom
refuse 2 '--memory 0: it ranges' simulate eye.json -o out --memory 0

finish
