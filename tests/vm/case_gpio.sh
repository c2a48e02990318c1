# Placido's GPIO driver with the kernel's simulated chip (gpio-sim): lights, a pedal, a trigger.
. tests/vm/lib.sh

chip=/sys/kernel/config/gpio-sim/topographer
modprobe gpio-sim
mkdir -p "$chip/bank/line5" "$chip/bank/line7"
echo 8 > "$chip/bank/num_lines"
echo RINGLIGHT > "$chip/bank/line5/name"
echo PEDAL > "$chip/bank/line7/name"
echo 1 > "$chip/live"
name=$(cat "$chip/bank/chip_name")
check "gpio-sim makes a chip" wait_for 10 test -e "/dev/$name"
gpioinfo "$name" > lines.txt
check "gpioinfo sees its lines" says '"RINGLIGHT"' lines.txt
check_each case_gpio "/dev/$name" "/sys/devices/platform/$(cat "$chip/dev_name")/$name" "$chip/live"
echo 0 > "$chip/live"
finish
