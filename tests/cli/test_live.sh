#!/bin/sh
# `placido live`: text, bars, JSON lines, and its ends.
. "$(dirname "$0")/harness.sh"

"$PLACIDO" phantom --eye normal --instrument cone24 --shift=-0.6,0,0 --noise 3 -o left.png -q
"$PLACIDO" phantom --eye normal --instrument cone24 --noise 3 -o good.png -q

succeed live left.png --instrument left.instrument.json
says '^ +0 align +across +-0\.60 .*  left 0\.6 mm$' out.txt
says '^1 frames judged, 0 skipped, 0 lost, 0 damaged$' out.txt
succeed live good.png --instrument cone24
says '^ +0 ready .*  hold$' out.txt
succeed live good.png --instrument cone24 --quiet
[ -s out.txt ] && fail "--quiet is not"

# The manual page knows every option of the help.
succeed live --help
for option in $(grep -oE '^  .{4}--[a-z-]+' out.txt | sed 's/.*--//'); do
  says "-$option" "$MANUAL/placido-live.1"
done

# As JSON: a line a frame, and one at the end.
succeed live 'good.png?loop=1' --instrument cone24 --frames 4 --json
[ "$(wc -l < out.txt)" -eq 5 ] || fail "--frames 4 --json: $(wc -l < out.txt) lines"
head -n 1 out.txt > frame.json
json frame.json - frame sequence timestamp_ns state instruction x_mm y_mm focus_mm blur_px motion_px \
  coverage clipped break_up score u_px v_px skipped look_ms
says '"focus_mm":null' frame.json
tail -n 1 out.txt > end.json
json end.json - frames skipped lost damaged command exit_code
says '"frames":4' end.json

# Without a display, and in a build without windows, the text goes on.
DISPLAY='' WAYLAND_DISPLAY='' QT_QPA_PLATFORM='' succeed live good.png --instrument cone24 --window
says '^placido: warning: --window: no window can be opened' err.txt
says ' hold$' out.txt
QT_QPA_PLATFORM=offscreen succeed live 'good.png?loop=1' --instrument cone24 --window --frames 3
says '^3 frames judged' out.txt

# Topography: the normal eye's keratometry, or why there is none.
succeed live 'good.png?speed=0' --instrument cone24 --topography
says ' hold  K 4[0-9]\.[0-9]+ D @ [0-9]+, 4[0-9]\.[0-9]+ D @ [0-9]+, cylinder [0-9.]+ D$' out.txt
says '^1 frames measured, 1 with a surface$' out.txt
"$PLACIDO" phantom --eye normal --instrument cone24 --noise 3 --blur 12 -o dull.png -q
succeed live 'dull.png?speed=0' --instrument cone24 --topography
says ' no topography: .*mires' out.txt
says '^1 frames measured, 0 with a surface$' out.txt
succeed live 'good.png?loop=1' --instrument cone24 --topography --frames 3 --json
head -n 1 out.txt > frame.json
json frame.json - topography.measured topography.sequence topography.simk_flat_D \
  topography.simk_flat_axis_deg topography.simk_steep_D topography.simk_steep_axis_deg \
  topography.simk_cylinder_D topography.refusal topography.measure_ms
tail -n 1 out.txt > end.json
json end.json - measured corneas
QT_QPA_PLATFORM=offscreen succeed live 'good.png?loop=1' --instrument cone24 --window --topography --frames 20
says ' cylinder ' out.txt

if [ "$SESSIONS" = ON ]; then
  "$PLACIDO" phantom --eye keratoconus --instrument cone24 --noise 3 --frames 12 -o eye.session -q
  succeed live 'eye.session?speed=0' --topography
  says '^12 frames measured, (8|9|10|11|12) with a surface$' out.txt
  says ' K [0-9.]+ D @ ' out.txt
  succeed live 'eye.session?speed=0'
  says ' blink ' out.txt
  says '^12 frames judged' out.txt
fi

refuse 2 'DEVICE .*is missing' live
refuse 2 'good.png does not know .* --instrument' live good.png
refuse 1 'none.png' live none.png --instrument cone24
refuse 3 'no built-in instrument is called "square"' live good.png --instrument square
refuse 2 '--frames 0: it ranges' live good.png --instrument cone24 --frames 0

# A frame of another size is refused before anything is shown.
sed 's/1280/640/' good.instrument.json > narrow.json
refuse 3 'a frame of 1280 × 1024 pixels: the instrument' live good.png --instrument narrow.json --quiet

# Ctrl-C and a time limit end it in an orderly way.
"$PLACIDO" live 'good.png?loop=1' --instrument cone24 --json > aim.jsonl 2> err.txt &
pid=$!
sleep 1.5
kill -TERM "$pid" || fail "live ended by itself"
status=0
wait "$pid" || status=$?
[ "$status" -eq 0 ] || fail "live, stopped by a signal: exit $status"
tail -n 1 aim.jsonl > end.json
json end.json - frames skipped exit_code
succeed live 'good.png?loop=1' --instrument cone24 --for 0.5 --quiet
if [ -w /dev/full ]; then
  status=0
  "$PLACIDO" live 'good.png?loop=1' --instrument cone24 > /dev/full 2> err.txt || status=$?
  [ "$status" -eq 1 ] || fail "live > /dev/full: exit $status"
  says 'standard output cannot be written' err.txt
fi

# On a terminal: bars in place, and the terminal as it was. (script gives it one.)
if command -v script > /dev/null; then
  script -qec "stty -a > before.txt; '$PLACIDO' live 'good.png?loop=1' --instrument cone24 --frames 3; stty -a > after.txt" \
    /dev/null > bars.txt < /dev/null
  says 'coverage \[#+' bars.txt
  cmp -s before.txt after.txt || fail "the terminal is not as it was"
fi
finish
