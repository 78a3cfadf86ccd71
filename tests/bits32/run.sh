#!/bin/sh
# Decimation in 32 bits gives the record that it gives in 64, to the bit. The libraries that scree stands on are not
# there in 32 bits, so only what decimation needs of base, mesh and simplify is built, both ways.
# usage: run.sh SOURCE_DIR COMPILER
set -eu
root=$1
compiler=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
printf '#include <stdio.h>\nint main(void) { return puts("32") < 0; }\n' >try.c
if ! "$compiler" -m32 try.c -o try 2>/dev/null || ! ./try >/dev/null; then
  echo "skipped: $compiler -m32 makes no program that runs here (Debian: gcc-multilib)"
  exit 77
fi
flags="-std=gnu17 -O1 -msse2 -mfpmath=sse -ffp-contract=off -w -Wno-psabi -ffunction-sections -I $root/src -I $root/include"
base="alloc arena eigen error math parallel platform_posix platform_unix progress radix rng"
mesh="mesh adjacency predicates index/closest index/intersect measure/bounds measure/extent measure/measure measure/minimum_box"
# build BITS: the program of that kind in BITS/curve
build() {
  mkdir "$1"
  {
    for name in $base; do echo "$root/src/base/$name.c"; done
    for name in $mesh; do echo "$root/src/mesh/$name.c"; done
    find "$root/src/simplify" -name '*.c'
    echo "$root/tests/bits32/hull_of_all.c" "$root/tests/bits32/record_of_torus.c"
  } | (cd "$1" && xargs -n 6 -P 2 "$compiler" "-m$1" $flags '-DSCREE_VERSION="0"' -c)
  "$compiler" "-m$1" -Wl,--gc-sections "$1"/*.o -lm -lpthread -o "$1/curve"
}
build 64
build 32
./64/curve >64.txt
./32/curve >32.txt
grep levels 64.txt
cmp 64.txt 32.txt
