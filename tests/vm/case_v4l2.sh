# Placido's V4L2 driver with the kernel's test camera, once with the plain interface and once with the multiplanar one.
. tests/vm/lib.sh

modprobe vivid n_devs=2 node_types=0x1,0x1 num_inputs=1,1 input_types=0,0 multiplanar=1,2
check "vivid makes two cameras" wait_for 10 test -e /dev/video1
check "placido devices runs" sh -c 'placido devices > devices.txt'
check "both cameras are listed" says 'v4l2:/dev/video1 .*vivid' devices.txt
echo "plain:"
check_each case_v4l2 v4l2:/dev/video0
echo "multiplanar:"
check_each case_v4l2 v4l2:/dev/video1
finish
