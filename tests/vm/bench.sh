# Frames per second and load of Placido's drivers beside the clients of others, same devices, same boot. For a person to
# read: run -t 900 sh tests/vm/bench.sh. Everything shares one emulated processor, the simulated camera with it: only
# the ratio of two lines means something.
# shellcheck disable=SC2016
. tests/vm/lib.sh
short_s=5
long_s=20

# timed COMMAND...: its words in words.txt, "real", "user" and "sys" in time.txt.
timed() {
  busybox time -p -o time.txt "$@" > words.txt 2>&1
}

# seconds KEY...: the sum of times.
seconds() {
  for key in "$@"; do
    sed -n "s/^$key //p" time.txt
  done | awk '{ sum += $1 } END { print sum }'
}

# measure WHAT COUNT COMMAND: COMMAND is run with $S seconds, few and many; the difference is free of the start. COUNT
# prints the frames that words.txt tells of.
measure() {
  for S in "$short_s" "$long_s"; do
    export S
    timed sh -c "$3"
    echo "$(sh -c "$2") $(seconds user sys) $(seconds real)"
  done | awk -v what="$1" -v span=$((long_s - short_s)) '
    NR == 1 { frames = $1; cpu = $2; real = $3 }
    END { printf "%-44s %6.1f frames/s  %5.1f %% CPU  %6.2f ms CPU a frame\n", what, ($1 - frames) / ($3 - real),
            100 * ($2 - cpu) / ($3 - real), 1000 * ($2 - cpu) / ($1 - frames) }'
}

placido_count="sed -n 's/^frames //p' words.txt"
aravis_count="sed -n 's/^n_completed_buffers *= //p' words.txt"

modprobe vhci-hcd
start_udevd
make_session eye 1280x1024
for rate in 10 500; do
  start_camera sim eye --face u3v --serial "BENCH$rate" --rate "$rate"
  wait_for 60 sh -c "arv-tool-0.8 | grep -q BENCH$rate"
  name=$(arv-tool-0.8 | sed -n "s/ (.*//p" | grep "BENCH$rate")
  echo "USB3 Vision, 1280 x 1024 Mono8, camera runs at $rate/s"
  measure "  Placido" "$placido_count" "stream u3v:BENCH$rate --seconds \$S"
  measure "  arv-camera-test" "$aravis_count" "arv-camera-test-0.8 -n '$name' --duration \$S"
  measure "  arv-camera-test -s async" "$aravis_count" "arv-camera-test-0.8 -s async -n '$name' --duration \$S"
  measure "  Placido once more" "$placido_count" "stream u3v:BENCH$rate --seconds \$S"
  order sim quit
done
end_all

# An HDMI input: vivid's webcam is slower.
modprobe vivid n_devs=1 node_types=0x1 num_inputs=1 input_types=3
wait_for 30 test -e /dev/video0
v4l2-ctl -d0 --set-dv-bt-timings cvt,width=1280,height=1024,fps=60 > /dev/null 2>&1
v4l2-ctl -d0 --set-fmt-video=pixelformat=GREY > /dev/null
echo "vivid, $(v4l2-ctl -d0 --get-fmt-video | sed -n 's#.*Width/Height *: ##p') GREY"
measure "  Placido" "$placido_count" 'stream "v4l2:/dev/video0?format=GREY&buffers=4" --seconds $S'
measure "  v4l2-ctl --stream-mmap=4" "sed -n 's/^frames //p' words.txt" \
  "timeout -s INT \$S v4l2-ctl -d0 --stream-mmap=4 --stream-to=/dev/null > v4l2.txt 2>&1; echo frames \$(tr -cd '<' < v4l2.txt | wc -c)"
measure "  Placido once more" "$placido_count" 'stream "v4l2:/dev/video0?format=GREY&buffers=4" --seconds $S'
