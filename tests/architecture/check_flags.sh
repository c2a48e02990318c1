#!/bin/sh
# check_flags.sh BUILD_DIR ROOT: fails where anything is compiled or linked with an option, or a source has a pragma or
# call, under which numbers are not what IEEE 754 says: NaN means "missing", and results are the same everywhere.
set -eu
build=$1
root=$2
failed=0

# -ffast-math and all that it stands for, x87, and contraction; at link time the first two would also set the processor
# to flush denormal numbers to zero.
options='-Ofast|-ffast-math|-funsafe-math-optimizations|-ffinite-math-only|-fassociative-math|-freciprocal-math'
options="$options|-fno-signed-zeros|-fapprox-func|-fcx-limited-range|-fsingle-precision-constant|-fexcess-precision=fast"
options="$options|-mfpmath=387|-mfpmath=both|-mdaz-ftz|-mpc32|-mpc64|-mpc80|-ffp-contract=(fast|on)|-mrecip[^ ]*"

commands="$build/compile_commands.json"
[ -s "$commands" ] || { echo "$commands is missing: nothing was checked"; exit 1; }
for file in "$commands" "$build/build.ninja"; do
  if [ -e "$file" ] && grep -nEo -e "(^|[ \"=])($options)([ \"]|\$)" "$file" | sort -u | head -n 5 | grep .; then
    echo "$file: unsafe arithmetic"
    failed=1
  fi
done
# What only other build types have.
if grep -nE -e "(^|[ \"=])($options)([ \"]|\$)" "$root/CMakePresets.json"; then
  echo "CMakePresets.json: unsafe arithmetic"
  failed=1
fi

words='_MM_SET_(FLUSH_ZERO|DENORMALS_ZERO|ROUNDING)_MODE|_mm_setcsr|__builtin_ia32_ldmxcsr|_controlfp|fesetround|fesetenv'
words="$words|#[ 	]*pragma[ 	]+(GCC[ 	]+optimize|STDC[ 	]+FP_CONTRACT[ 	]+ON|float_control|clang[ 	]+fp)"
words="$words|__attribute__[ 	]*\(\([ 	]*(__)?optimize"
found=$(cd "$root" && grep -rnE --include='*.[ch]' --include='*.cpp' -e "$words" \
  acquire base drivers exchange gadget include package phantom reconstruct report simulate udev 2>/dev/null || true)
if [ -n "$found" ]; then
  echo "$found"
  failed=1
fi
exit $failed
