#!/bin/sh
# Inputs that are not what they should be: one clear line, a status, nothing left behind.
. "$(dirname "$0")/harness.sh"

succeed phantom --eye normal --instrument cone24 -o eye.png --noise 1
have eye.png eye.instrument.json eye.surface.json

# exam_refuse EXIT PATTERN IMAGE INSTRUMENT
exam_refuse() {
  refuse "$1" "$2" exam "$3" --instrument "$4" --axis-z 0 --pupils 4 -o result
}

# edit NAME SED-EXPRESSION: the good instrument with a change.
edit() {
  sed -E "$2" eye.instrument.json > "$1"
  ! cmp -s "$1" eye.instrument.json || fail "$1: the edit changed nothing"
}

echo "== files"
refuse 1 'nowhere.png' exam nowhere.png --instrument eye.instrument.json -o result
refuse 1 'nowhere.json' exam eye.png --instrument nowhere.json -o result
refuse 2 'is an image: .*--instrument' exam eye.png -o result
refuse 3 'eye.surface.json: not an image' exam eye.surface.json --instrument eye.instrument.json -o result
printf 'not an image' > text.png
exam_refuse 3 'text.png' text.png eye.instrument.json
head -c 2000 eye.png > short.png
exam_refuse 3 'short.png' short.png eye.instrument.json
mkfifo pipe.png
exam_refuse 3 'pipe.png: the file is empty' pipe.png eye.instrument.json
exam_refuse 3 'pipe.png:1:1: the file is empty' eye.png pipe.png
rm pipe.png
refuse 1 'nowhere' exam eye.png --instrument eye.instrument.json -o nowhere/result
refuse 3 'frame 7' exam eye.png --instrument eye.instrument.json --frame 7 -o result
refuse 1 'scene.json' exam eye.png --instrument eye.instrument.json --scene scene.json -o result

echo "== JSON"
printf '{ "format": "placido-instrument/1",\n  "name": \n' > bad.json
exam_refuse 3 'bad.json:[0-9]+.*JSON' eye.png bad.json
: > empty.json
exam_refuse 3 'empty.json' eye.png empty.json
edit version.json 's|placido-instrument/1|placido-instrument/9|'
exam_refuse 3 'version.json:[0-9]+: .*placido-instrument/9.*placido-instrument/1' eye.png version.json
exam_refuse 3 'placido-surface/1.*placido-instrument/1' eye.png eye.surface.json
edit missing.json 's/"focal_px"/"focal_pixels"/'
exam_refuse 3 'missing.json:[0-9]+: field camera.focal_px' eye.png missing.json
edit type.json 's/"model": *"pinhole"/"model": 7/'
exam_refuse 3 'type.json:[0-9]+: field camera.model' eye.png type.json
tr -d '\n' < eye.instrument.json | sed -E 's/"focal_px": *\[[^]]*\]/"focal_px": ["a", 1]/' > element.json
exam_refuse 3 'element.json:1: field camera.focal_px: element 0' eye.png element.json

# An editor's byte order mark and line ends change nothing.
{ printf '\357\273\277'; sed 's/$/\r/' eye.instrument.json; } > marked.json
succeed reconstruct eye.png --instrument marked.json --axis-z 0 -o marked
printf '{"format": "placido-instrument/1",\n"name": "\344"}' > latin.json
exam_refuse 3 'latin.json:2.*UTF-8 is expected' eye.png latin.json

echo "== geometry"
tr -d '\n' < eye.instrument.json | sed -E 's/"focal_px": *\[[^]]*\]/"focal_px": [0, 10800]/' > focal.json
exam_refuse 3 'focal.json:1: field camera.focal_px' eye.png focal.json
tr -d '\n' < eye.instrument.json | sed -E 's/"focal_px": *\[[^]]*\]/"focal_px": [NaN, 10800]/' > nan.json
exam_refuse 3 'nan.json:1' eye.png nan.json
tr -d '\n' < eye.instrument.json | sed -E 's/"radius_mm": *[0-9.]+/"radius_mm": -6/' > radius.json
exam_refuse 3 'radius.json:1: field mires.edges\[0\]' eye.png radius.json
tr -d '\n' < eye.instrument.json | sed -E 's/"radius_mm": *[0-9.]+/"radius_mm": 1e999/' > huge.json
exam_refuse 3 'huge.json' eye.png huge.json
tr -d '\n' < eye.instrument.json | sed -E 's/"z_mm": *[0-9.]+/"z_mm": -20/' > behind.json
exam_refuse 3 'behind.json:1: field mires.edges\[0\].z_mm: -20 mm: .*behind the cornea' eye.png behind.json
tr -d '\n' < eye.instrument.json | sed -E 's/"image_size_px": *\[[^]]*\]/"image_size_px": [640, 480]/' > size.json
exam_refuse 3 '1280.*640|640.*1280' eye.png size.json

echo "== pictures"
{ printf 'P5\n1280 1024\n255\n'; head -c 1310720 /dev/zero | tr '\0' '\200'; } > grey.pgm
exam_refuse 4 'mire' grey.pgm eye.instrument.json
{ printf 'P5\n1280 1024\n255\n'; head -c 1310720 /dev/zero; } > black.pgm
exam_refuse 4 'mire' black.pgm eye.instrument.json
# Three edges are no cornea: the same image rendered with an instrument of the first three edges only.
tr -d '\n' < eye.instrument.json |
  sed -E 's/("edges": *\[ *(\{[^}]*\} *, *){2}\{[^}]*\}).*/\1]}}/' > three.json
"$JSON_CHECK" three.json placido-instrument/1 mires.edges || fail "three.json is no instrument"
succeed phantom --eye normal --instrument ./three.json -o three.png
exam_refuse 4 'edge|mire' three.png three.json
exam_refuse 4 'edge|mire' three.png eye.instrument.json

echo "== output"
mkdir foreign
echo precious > foreign/letter.txt
refuse 1 'foreign' exam eye.png --instrument eye.instrument.json -o foreign
[ "$(cat foreign/letter.txt)" = precious ] || fail "a foreign file was touched"
echo precious > taken
refuse 1 'taken' exam eye.png --instrument eye.instrument.json -o taken
refuse 1 'eye.png.*exists' phantom --eye sphere --instrument cone24 -o eye.png
if [ "$(id -u)" -ne 0 ]; then
  mkdir locked
  chmod a-w locked
  refuse 1 'locked' exam eye.png --instrument eye.instrument.json -o locked/result
fi

echo "== surface and scene"
refuse 3 'eye.instrument.json:[0-9]+.*placido-surface/1' simulate eye.instrument.json -o result
refuse 1 'nowhere.json' simulate nowhere.json -o result
tr -d '\n' < eye.surface.json | sed -E 's/"r1": *[0-9.]+/"r1": 0/' > flat.json
refuse 3 'flat.json' simulate flat.json -o result
printf '{"format": "placido-scene/1", "image": "eye.png"}\n' > scene.json
refuse 3 'scene.json:1: field calibration' simulate eye.surface.json --scene scene.json -o result
printf '{"format": "placido-scene/1", "image": "x.png", "calibration": {"kind": "arcmin_per_px", "value": 0.5}}\n' > scene.json
refuse 1 'x.png' simulate eye.surface.json --scene scene.json -o result
refuse 3 'no chart called snellen.*sloan' simulate eye.surface.json --scene snellen -o result

echo "== sessions"
if [ "$SESSIONS" = ON ]; then
  mkdir empty.session
  refuse 3 'empty.session .*session.json' exam empty.session -o result
  succeed phantom --eye normal --instrument cone24 --frames 3 -o eye.session
  # edit_session NAME FILE EXPRESSION
  edit_session() {
    cp -r eye.session "$1"
    sed -i -E "$3" "$1/$2"
  }
  # Torn within its head, nothing can be read; torn in the middle, what is whole can.
  cp -r eye.session torn.session
  for bytes in 0 20 60 100 300 500; do
    head -c "$bytes" eye.session/frames.mkv > torn.session/frames.mkv
    refuse 3 'torn.session/frames.mkv .*torn' exam torn.session -o result
  done
  rm torn.session/frames.mkv
  mkfifo torn.session/frames.mkv
  refuse 3 'torn.session/frames.mkv is not a regular file' exam torn.session -o result
  rm -r torn.session
  # A frame that cannot be decoded keeps its number, and is told.
  cp -r eye.session hurt.session
  size=$(wc -c < hurt.session/frames.mkv)
  printf '\252\252\252\252' | dd of=hurt.session/frames.mkv bs=1 seek=$((size / 6)) conv=notrunc 2> /dev/null
  succeed reconstruct hurt.session --json -o hurt
  says 'warning: 1 of 3 frames are damaged' err.txt
  grep -Eq '"damaged": *1,?$' out.txt || fail "the damaged frame is not counted"
  refuse 3 'frame 0 is damaged' reconstruct hurt.session --frame 0 -o result
  succeed reconstruct hurt.session --frame 2 --json -o hurt
  grep -Eq '"frame": *2,?$' out.txt || fail "frames are numbered without the damaged one"
  cp -r eye.session half.session
  size=$(wc -c < eye.session/frames.mkv)
  head -c $((size * 2 / 3)) eye.session/frames.mkv > half.session/frames.mkv
  succeed reconstruct half.session -o half
  have half/surface.json
  says 'warning: .*(damaged|cut|torn|truncated|incomplete)' err.txt
  cp -r eye.session none.session
  rm none.session/frames.mkv
  refuse 3 'frames.mkv' exam none.session -o result
  edit_session eyed.session session.json 's/"OD"/"OX"/'
  refuse 3 'session.json:[0-9]+: field eye' exam eyed.session -o result
  edit_session far.session session.json 's/"axis_z_mm": *[-0-9.e]+/"axis_z_mm": 1e300/'
  refuse 3 'session.json:[0-9]+: field axis_z_mm: is 1e\+300, -100 to 100' exam far.session -o result
  edit_session wrong.session session.json 's|placido-session/1|placido-session/2|'
  refuse 3 'session.json:[0-9]+: .*placido-session/2' exam wrong.session -o result
  refuse 3 'frame 99' exam eye.session --frame 99 -o result
  refuse 1 'eye.session' phantom --eye normal --instrument cone24 --frames 1 -o eye.session
else
  refuse 1 'FFmpeg' phantom --eye normal --instrument cone24 --frames 1 -o eye.session
fi
finish
