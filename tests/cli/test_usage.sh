#!/bin/sh
# Help, version, and command lines that are wrong.
. "$(dirname "$0")/harness.sh"

succeed --version
says '^placido [0-9]+\.[0-9]+' out.txt
succeed help
says '^  exam ' out.txt
for command in exam reconstruct simulate phantom devices record iso-check import export study plan; do
  succeed help $command
  says "^usage: placido $command " out.txt
  says '^examples' out.txt
  cp out.txt once.txt
  succeed $command --help
  cmp -s once.txt out.txt || fail "$command --help is not help $command"
  # The manual page knows every option of the help.
  for option in $(grep -oE '^  .{4}--[a-z-]+' out.txt | sed 's/.*--//'); do
    says "-$option" "$MANUAL/placido-$command.1"
  done
done
succeed devices
says 'replay' out.txt
succeed devices --json
json out.txt - drivers devices command exit_code

refuse 2 'no command "foo"' foo
refuse 2 'no command "foo"' help foo
refuse 2 'INPUT .*is missing' exam -o out
refuse 2 '-o' exam input.png
refuse 2 'unknown or ambiguous option --foo' exam input.png --foo -o out
refuse 2 'unknown option -x' exam input.png -x -o out
refuse 2 '--axis-z needs a value: Z' exam input.png -o out --axis-z
refuse 2 '--json takes no value' exam input.png -o out --json=1
refuse 2 '--axis-z abc: a number' exam input.png -o out --axis-z abc
refuse 2 '--axis-z nan: a number' exam input.png -o out --axis-z nan
refuse 2 '--axis-z 1,2,3' exam input.png -o out --axis-z 1,2,3
refuse 2 'SIGMA is not negative' exam input.png -o out --axis-z 0,-1
refuse 2 '--pupils 20: it ranges from 0.1 to 12' exam input.png -o out --pupils 2,20
refuse 2 '--pupils: 2 stands twice' exam input.png -o out --pupils 2,4,2
refuse 2 '--pupils 2,4,: a number was expected after each comma' exam input.png -o out --pupils 2,4,
refuse 2 '--wavefront: 3 stands twice' exam input.png -o out --wavefront 3,5,3.0
refuse 2 '--pupils: its value is empty' exam input.png -o out --pupils ''
# Two pupils that would share a folder are one.
refuse 2 '--pupils: 4 stands twice' exam input.png -o out --pupils 4,4.0000001
# The ranges of the tables are the libraries' own: beyond them the command line is wrong, not an input.
refuse 2 '--rays 4001: it ranges' exam input.png -o out --rays 4001
refuse 2 '--pattern random: crosshatch, equal-area or' exam input.png -o out --pattern random
refuse 2 '--light bright: spread or counted' simulate surface.json -o out --light bright
refuse 2 '--grow 17: it ranges' simulate surface.json -o out --grow 17
refuse 2 '--meridians 23: it ranges' exam input.png -o out --meridians 23
refuse 2 '--retina 4: it ranges' simulate surface.json -o out --retina 4
refuse 2 '--correction 50,0,0: sphere' simulate surface.json -o out --correction 50,0,0
refuse 2 '--wear -5 -1: a sphere, or' simulate surface.json -o out --wear '-5 -1'
refuse 2 '--wear -5 @40: the axis ranges' simulate surface.json -o out --wear '-5 @40'
refuse 2 '--correct half: sphere, full or none' simulate surface.json -o out --correct half
refuse 2 '--correct none: a cornea alone does not tell' simulate surface.json -o out --correct none
refuse 2 '--correct full searches the lens' simulate surface.json -o out --correct full --wear -5
refuse 2 '--retina and --axial-length both' simulate surface.json -o out --retina 24 --axial-length 24
refuse 2 '--motion 300,0: its length' phantom --eye sphere --instrument cone24 -o out.png --motion 300,0
refuse 2 '--side od: OD or OS' phantom --eye sphere --instrument cone24 -o out.session --side od
refuse 2 '--cwhatuc has buckets of its own' exam input.png -o out --cwhatuc --bucket 2
refuse 2 '--cwhatuc knows rays, no waves' exam input.png -o out --cwhatuc --diffraction 555
refuse 2 '--diffraction 200: it ranges' simulate surface.json -o out --diffraction 200
refuse 2 'tumbling-e.png is taken' exam input.png -o out --scene tumbling-e --scene tumbling-e
refuse 2 'INPUT .*is empty' exam '' -o out
refuse 2 'help explains one command' help exam phantom
refuse 2 'no command "two lines"' "two
lines"
refuse 2 '--meridians 90.5: a whole number' exam input.png -o out --meridians 90.5
refuse 2 '"second.png" is one too many' exam input.png second.png -o out
refuse 2 '--correction 1,2' simulate surface.json -o out --correction 1,2
refuse 2 '--eye is missing' phantom --instrument cone24 -o out.png
refuse 2 '--instrument is missing' phantom --eye sphere -o out.png
refuse 2 'FILE.png or NAME.session' phantom --eye sphere --instrument cone24 -o out.tiff
refuse 3 'no built-in eye is called "square"' phantom --eye square --instrument cone24 -o out.png
refuse 3 'square' phantom --eye sphere --instrument square -o out.png

# Without a command: the overview, and why that is an error.
status=0
"$PLACIDO" > out.txt 2> err.txt || status=$?
[ "$status" -eq 2 ] || fail "no command: exit $status"
says '^placido: a command is missing$' err.txt
says '^usage' out.txt

# With --json the reason is on standard output as well, as an object.
status=0
"$PLACIDO" exam --json -o out > out.txt 2> err.txt || status=$?
[ "$status" -eq 2 ] || fail "--json: exit $status"
json out.txt - error exit_code

# What cannot be written to standard output is an error.
if [ -w /dev/full ]; then
  status=0
  "$PLACIDO" devices > /dev/full 2> err.txt || status=$?
  [ "$status" -eq 1 ] || fail "a full disk goes unnoticed"
  for words in help --version 'exam --help'; do
    status=0
    # shellcheck disable=SC2086
    "$PLACIDO" $words > /dev/full 2> err.txt || status=$?
    [ "$status" -eq 1 ] || fail "$words: a full disk goes unnoticed"
  done
fi
status=0
"$PLACIDO" help >&- 2> err.txt || status=$?
[ "$status" -eq 1 ] || fail "a closed standard output goes unnoticed"

# More processors than the libraries take threads are no error.
OMP_NUM_THREADS=1000 "$PLACIDO" --version > out.txt 2> err.txt || fail "1000 threads"
says '^threads: (256|1)$' out.txt
finish
