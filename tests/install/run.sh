#!/bin/sh
# Installs into an empty prefix, moves that, uninstalls the first, and builds the same small program against it
# in the three ways that users have: pkg-config, pkg-config --static, and find_package(scree); and as C++.
# usage: run.sh SOURCE_DIR BUILD_DIR C_COMPILER
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$2
compiler=$3
folder=$(mktemp -d)
manifest=$build/install_manifest.txt
[ ! -f "$manifest" ] || cp "$manifest" "$folder/manifest"
restore() {
  rm -f "$manifest"
  [ ! -f "$folder/manifest" ] || cp "$folder/manifest" "$manifest"
  rm -rf "$folder"
}
trap restore EXIT
cmake --install "$build" --prefix "$folder/first" >"$folder/log" || { cat "$folder/log"; exit 1; }
cp -R "$folder/first" "$folder/prefix" # an installation may be moved
"$1/tools/uninstall.sh" "$build"
left=$(find "$folder/first" ! -type d)
[ -z "$left" ] || { echo "left after uninstalling: $left"; exit 1; }
version=$(cat "$1/VERSION")
libdir=$(dirname "$(find "$folder/prefix" -name scree.pc)")/..
pc() { PKG_CONFIG_PATH="$libdir/pkgconfig" pkg-config "$@" scree; }

expect() {
  [ "$2" = "$version" ] || { echo "$1: printed '$2', not $version"; exit 1; }
}
# shellcheck disable=SC2046
"$compiler" "$here/consumer.c" -o "$folder/shared" $(pc --cflags --libs)
expect shared "$(LD_LIBRARY_PATH=$libdir "$folder/shared")"
# shellcheck disable=SC2046
"$compiler" "$here/consumer.c" -o "$folder/static" $(pc --cflags) "$libdir/libscree.a" \
  $(pc --static --libs | sed 's/-lscree//')
expect static "$("$folder/static")"
# The parts alone: each with its own headers, DEM with nothing behind it and no reader in it.
part() { PKG_CONFIG_PATH="$libdir/pkgconfig" pkg-config --cflags --libs "scree-$1"; }
# shellcheck disable=SC2046
"$compiler" "$here/consumer_dem.c" -o "$folder/dem" $(part dem)
expect dem "$("$folder/dem")"
# shellcheck disable=SC2046
"$compiler" -Wl,--whole-archive "$libdir/libscree-dem.a" -Wl,--no-whole-archive "$here/consumer_dem.c" -o "$folder/dem" \
  $(part dem | sed 's/-lscree-dem//') || { echo "libscree-dem.a stands on another library"; exit 1; }
[ "$(part dem | tr ' ' '\n' | grep -c '^-l')" = 2 ] || { echo "scree-dem.pc names libraries: $(part dem)"; exit 1; }
readers=$(nm -g --defined-only "$libdir/libscree-dem.a" 2>/dev/null | grep -E ' T scree_(scan_|read_(file|options|mesh|scan))' || true)
[ -z "$readers" ] || { echo "libscree-dem.a reads scans: $readers"; exit 1; }
"$folder/prefix/bin/scree" sample icosphere-2 -q -o "$folder/ball.stl" >/dev/null
# shellcheck disable=SC2046
"$compiler" "$here/consumer_mesh.c" -o "$folder/mesh" $(part mesh)
expect mesh "$("$folder/mesh" "$folder/ball.stl")"
if command -v c++ >/dev/null; then
  # shellcheck disable=SC2046
  c++ -x c++ -fsyntax-only $(pc --cflags) "$here/consumer.c"
fi
cmake -S "$here" -B "$folder/cmake" -DCMAKE_PREFIX_PATH="$folder/prefix" -DCMAKE_C_COMPILER="$compiler" \
  >"$folder/log" && cmake --build "$folder/cmake" >>"$folder/log" || { cat "$folder/log"; exit 1; }
expect cmake "$("$folder/cmake/consumer")"
expect program "$("$folder/prefix/bin/scree" --version | sed 's/scree //')"
if [ -x /usr/bin/python3 ]; then
  module=$(dirname "$(dirname "$(find "$folder/prefix" -path '*/scree/__init__.py')")")
  expect python "$(env -u SCREE_LIBRARY PYTHONPATH="$module" /usr/bin/python3 -c 'import scree; print(scree.version())')"
fi
for file in man/man1/scree.1 man/man1/scree-choose.1 bash-completion/completions/scree zsh/site-functions/_scree \
  fish/vendor_completions.d/scree.fish; do
  [ -s "$folder/prefix/share/$file" ] || { echo "not installed: $file"; exit 1; }
done
