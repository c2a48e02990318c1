# What the tests of recordings share: a small session to replay. Sourced behind harness.sh.

cat > small.instrument.json <<'END'
{"format": "placido-instrument/1", "name": "small cone",
 "camera": {"model": "pinhole", "image_size_px": [160, 128], "focal_px": [1350, 1350],
  "principal_px": [79.5, 63.5], "position_mm": [0, 0, 120]},
 "mires": {"first_band": "bright", "edges": [{"radius_mm": 6.3, "z_mm": 71.9},
  {"radius_mm": 9.0, "z_mm": 66.0}, {"radius_mm": 14.0, "z_mm": 60.0},
  {"radius_mm": 20.0, "z_mm": 50.0}]}}
END

# small NAME FRAMES: a session of noisy frames, 30 a second.
small() {
  "$PLACIDO" phantom --eye sphere --instrument ./small.instrument.json --frames "$2" --noise 3 \
    -o "$1" -q
}

# lines FILE: how many
lines() {
  wc -l < "$1" | tr -d ' '
}

# wait_for FILE: until it has something in it, 20 seconds at most
wait_for() {
  tries=0
  until [ -s "$1" ]; do
    tries=$((tries + 1))
    if [ "$tries" -gt 1000 ]; then
      fail "$1 does not come"
      return
    fi
    sleep 0.02
  done
}
