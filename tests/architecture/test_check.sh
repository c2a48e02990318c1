#!/bin/sh
# The check itself: a tree in order passes, and each kind of violation, planted, is found.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

plant() { # plant FILE LINE: appends a line to a file of the tree
  printf '%s\n' "$2" >> "$work/tree/$1"
}

make_tree() {
  rm -rf "$work/tree"
  mkdir -p "$work/tree/include/placido" "$work/tree/base/cv" "$work/tree/drivers" "$work/tree/simulate" \
    "$work/tree/reconstruct/surface" "$work/tree/acquire/cli"
  cat > "$work/libraries.txt" <<'END'
base|base||status.h,frame.h
drivers|drivers|base|device.h
surface|reconstruct/surface|base|surface.h
reconstruct|reconstruct|surface,base|mires.h
simulate|simulate|surface,base|simulate.h
acquire|acquire|drivers,base|
END
  plant include/placido/status.h '#include <stddef.h>'
  plant include/placido/mires.h '#include <placido/frame.h>'
  plant base/cv/cv.cpp '#include <opencv2/core.hpp>'
  plant base/frame.c '#include "base/memory.h"'
  plant reconstruct/find.c '#include <placido/surface.h>'
  plant reconstruct/surface/table.c '#include "reconstruct/surface/part.h"'
  plant simulate/psf.c '#include "reconstruct/surface/part.h"'
  plant acquire/cli/main.c '#include <placido/simulate.h>'
}

check() { "$here/check_includes.sh" "$work/libraries.txt" "$work/tree" > "$work/said" 2>&1; }

expect_found() { # expect_found WHAT FILE LINE
  make_tree
  plant "$2" "$3"
  if check; then
    echo "not found: $1 ($3 in $2)"
    exit 1
  fi
  if ! grep -q "^$2:" "$work/said"; then
    echo "found, but not named: $1"
    cat "$work/said"
    exit 1
  fi
  echo "found: $1"
}

make_tree
if ! check; then
  echo "a tree in order was refused:"
  cat "$work/said"
  exit 1
fi
expect_found "a private header of a library that is not seen" simulate/psf.c '#include "reconstruct/solve.h"'
expect_found "a public header of a library that is not seen" simulate/psf.c '#include <placido/mires.h>'
expect_found "a library inside another's folder looking outwards" reconstruct/surface/table.c '#include "reconstruct/solve.h"'
expect_found "seeing through another library" reconstruct/find.c '#include <placido/device.h>'
expect_found "the lowest library looking upwards" base/frame.c '  #  include "drivers/table.h"'
expect_found "a public header that sees too much" include/placido/status.h '#include <placido/surface.h>'
expect_found "a header of no library" simulate/psf.c '#include <placido/nowhere.h>'
expect_found "OpenCV outside its place" reconstruct/find.c '#include <opencv2/core.hpp>'
expect_found "a library that does not see the simulation" acquire/select.c '#include <placido/simulate.h>'
expect_found "the program's own header in a library" acquire/select.c '#include "acquire/cli/command.h"'
