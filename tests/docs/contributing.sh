#!/bin/sh
# Follows docs/contributing/add-a-file-format.md: applies its patch to a copy of the sources, compiles what it touches, and runs
# the test that it adds. usage: contributing.sh SOURCE_DIR BUILD_DIR C_COMPILER LIBRARY...
set -eu
root=$1 build=$2 compiler=$3
shift 3
command -v patch >/dev/null || { echo "skipped: no patch installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for page in "$root"/docs/contributing/read-*.patch; do
  rm -rf "$folder/tree"
  mkdir "$folder/tree"
  cp -R "$root/src" "$root/include" "$folder/tree"
  mkdir -p "$folder/tree/tests"
  cp -R "$root/tests/support" "$folder/tree/tests"
  cp "$page" "$folder/patch"
  (cd "$folder/tree" && patch -p1 --fuzz=2 -s <"$folder/patch") || { echo "$page: its patch does not apply"; exit 1; }
  objects=""
  for source in $(sed -n 's/^+++ b\/\(src\/.*\.c\)$/\1/p' "$folder/patch"); do
    object=$folder/$(echo "$source" | tr / -).o
    "$compiler" -std=c17 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror -O1 -ffp-contract=off -I"$folder/tree/src" -I"$folder/tree/include" \
      -c "$folder/tree/$source" -o "$object"
    objects="$objects $object"
  done
  # what was compiled here comes first, so the library's older file of the same names is not taken
  for source in $(sed -n 's/^+++ b\/\(tests\/unit\/.*\.c\)$/\1/p' "$folder/patch"); do
    # shellcheck disable=SC2086,SC2046
    "$compiler" -std=c17 -D_POSIX_C_SOURCE=200809L -Wall -Wextra -Werror -DSCREE_SCAN_DATA='""' \
      -I"$folder/tree/src" -I"$folder/tree/include" -I"$folder/tree/tests" \
      "$folder/tree/$source" $objects "$build/tests/libscree_test_support.a" "$build/libscree.a" \
      $(pkg-config --libs expat zlib yaml-0.1 sqlite3 cairo 2>/dev/null) -lqhull_r -lmeshoptimizer "$@" -lcmocka -pthread -lm -o "$folder/test"
    "$folder/test" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
    echo "$(basename "$page"): $source passes"
  done
done
