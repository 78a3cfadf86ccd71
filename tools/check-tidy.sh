#!/bin/sh
# clang-tidy over the library, the program and the tests; warnings are errors (.clang-tidy).
# usage: check-tidy.sh BUILD_DIR (one with compile_commands.json, built with clang)
set -eu
cd "$(dirname "$0")/.."
git ls-files 'src/*.c' | xargs -P "$(nproc)" -n 4 clang-tidy --quiet -p "$1" 2>/dev/null
