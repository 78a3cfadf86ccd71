#!/bin/sh
# Follows a page of docs/contributing: its patch goes into a copy of the sources, touches four files (a contact law eight,
# with the world's own), is documented, and its test passes. Objects of the build stand in for what the patch does not change.
# usage: follow.sh ROOT BUILD COMPILER PROGRAM PATCH LIBRARY...
set -eu
root=$1 build=$2 compiler=$3 program=$4 patch=$5
shift 5
command -v patch >/dev/null || exit 77
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
mkdir -p "$copy/tests/law" "$copy/docs/reference"
cp -R "$root/src" "$root/include" "$copy"
cp -R "$root/tests/support" "$copy/tests"
cp "$root/docs/reference/scenes.md" "$copy/docs/reference"
mkdir -p "$copy/docs/tutorials" && cp "$root/docs/tutorials/own-machine.md" "$copy/docs/tutorials"
cd "$copy"
patch -s -p1 <"$patch"
files=$(grep -c '^+++ ' "$patch")
wanted=4 folders=src/scene
if grep -q '^+++ b/src/world' "$patch"; then wanted=8 folders="src/scene src/world"; fi
[ "$files" -eq $wanted ] || { echo "$(basename "$patch") touches $files files"; exit 1; }
python3 "$root/tests/docs/scene_fields.py" "$copy" "$program"
new=$(sed -n 's/^+++ b\/\(tests\/.*\.c\)$/\1/p' "$patch")
flags="-std=c17 -D_POSIX_C_SOURCE=200809L -O0 -w -Iinclude -Isrc -Itests -DSCREE_SCAN_DATA=\"\""
# shellcheck disable=SC2086
find $folders -name '*.c' ! -path '*/kernels/*' | xargs -n 8 -P 2 sh -c '
  for f in "$@"; do '"$compiler $flags"' -c "$f" -o "$(echo "$f" | tr / _).o" || exit 255; done' sh
# shellcheck disable=SC2046,SC2086
$compiler $flags "$new" src_*.o "$build/tests/libscree_test_support.a" "$build/libscree.a" \
  $(pkg-config --libs expat zlib yaml-0.1 sqlite3 cairo 2>/dev/null) -lqhull_r -lmeshoptimizer "$@" -lcmocka -pthread -lm -o followed
./followed
