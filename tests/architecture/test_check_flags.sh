#!/bin/sh
# The check of options itself: a build in order passes, and each kind of unsafe arithmetic, planted, is found.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

make_tree() {
  rm -rf "$work/tree"
  mkdir -p "$work/tree/build" "$work/tree/base" "$work/tree/simulate"
  echo '[{"command": "cc -O2 -fno-math-errno -ffp-contract=off -o a.o -c a.c", "file": "a.c"}]' \
    > "$work/tree/build/compile_commands.json"
  echo '{"CMAKE_C_FLAGS_RELEASE": "-O3 -DNDEBUG"}' > "$work/tree/CMakePresets.json"
  echo 'int placido_optimize(void);' > "$work/tree/base/a.h"
}

check() { "$here/check_flags.sh" "$work/tree/build" "$work/tree" > "$work/said" 2>&1; }

expect_found() { # expect_found WHAT FILE LINE: the line stands in place of the file
  make_tree
  printf '%s\n' "$3" > "$work/tree/$2"
  if check; then
    echo "not found: $1 ($3 in $2)"
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
expect_found "fast arithmetic" build/compile_commands.json '[{"command": "cc -O2 -ffast-math -c a.c"}]'
expect_found "fast arithmetic by level" build/compile_commands.json '[{"command": "cc -Ofast -c a.c"}]'
expect_found "no NaN" build/compile_commands.json '[{"command": "cc -ffinite-math-only -c a.c"}]'
expect_found "an option at the end" build/compile_commands.json '[{"command": "cc -c a.c -mfpmath=387"}]'
expect_found "contraction" build/compile_commands.json '[{"command": "cc -ffp-contract=fast -c a.c"}]'
expect_found "fast arithmetic when linking" build/build.ninja '  LINK_FLAGS = -ffast-math'
expect_found "an option of a preset" CMakePresets.json '{"CMAKE_C_FLAGS_RELEASE": "-O3 -funsafe-math-optimizations"}'
expect_found "a pragma" simulate/b.c '#pragma GCC optimize("fast-math")'
expect_found "an attribute" simulate/b.c 'static __attribute__((optimize("O3"))) int f(void);'
expect_found "a processor's mode" base/b.cpp '  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);'
rm "$work/tree/build/compile_commands.json"
if check; then
  echo "a build without a list of its commands passes"
  exit 1
fi
