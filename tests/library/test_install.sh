# Installs the build, then builds the example against the installation, by find_package and by pkg-config, and lets it see.
#   test_install.sh CMAKE BUILD EXAMPLES CC
set -eu
cmake=$1 build=$2 examples=$3 cc=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$cmake" --install "$build" --prefix "$work/prefix" > "$work/install.log"
library=$(dirname "$(find "$work/prefix" -name libplacido.so)")

cat > "$work/eye.json" << 'SURFACE'
{"format": "placido-surface/1", "radius_mm": 5, "parts": [{"kind": "biconic", "r1": 7.8, "q1": -0.2}]}
SURFACE

# see PROGRAM NAME: the example makes a picture
see() {
  LD_LIBRARY_PATH="$library" "$1" "$work/eye.json" "$work/$2.png"
  test -s "$work/$2.png"
}

"$cmake" -S "$examples" -B "$work/by-cmake" -DCMAKE_PREFIX_PATH="$work/prefix" > "$work/configure.log"
"$cmake" --build "$work/by-cmake" > "$work/build.log"
see "$work/by-cmake/see" by-cmake

export PKG_CONFIG_PATH="$library/pkgconfig"
# shellcheck disable=SC2046 # flags are words
"$cc" -std=c11 -Wall -Wextra -Wpedantic -Werror "$examples/see.c" -o "$work/see" $(pkg-config --cflags --libs placido)
see "$work/see" by-pkg-config
cmp "$work/by-cmake.png" "$work/by-pkg-config.png"

# every public header stands on its own
for header in "$work"/prefix/include/placido/*.h; do
  echo "#include <placido/$(basename "$header")>" > "$work/one.c"
  "$cc" -std=c11 -Wall -Wextra -Wpedantic -Werror -I"$work/prefix/include" -fsyntax-only "$work/one.c"
done

# nothing but the project's own names is exported, and no data
if nm -D --defined-only "$library/libplacido.so" | grep -v ' placido_' | grep -q .; then
  echo "libplacido exports names that are not its own"
  exit 1
fi
echo "all passed"
