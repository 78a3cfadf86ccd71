#!/bin/sh
# clang-tidy over the library, the program, tests, examples and benchmarks; warnings are errors (.clang-tidy).
# usage: check-tidy.sh BUILD_DIR (one with compile_commands.json, built with clang)
set -eu
cd "$(dirname "$0")/.."
# Files of other systems and of devices are in no build here; what others wrote is theirs.
git ls-files 'src/*.c' 'tests/*.c' 'examples/*.c' ':!*/vendor/*' | while read -r file; do
  ! grep -q "/$file\"" "$1/compile_commands.json" || echo "$file"
done |
  xargs -P "$(nproc)" -n 4 clang-tidy --quiet -p "$1" 2>/dev/null
# the benchmarks are not in every build: the flags that matter here
git ls-files 'bench/*.c' | xargs -P "$(nproc)" -n 4 sh -c 'clang-tidy --quiet "$@" -- -std=c17 \
  -D_POSIX_C_SOURCE=200809L -Iinclude -Ibench/world' clang-tidy 2>/dev/null
