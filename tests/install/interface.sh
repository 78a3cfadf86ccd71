#!/bin/sh
# The public interface as a list: every exported symbol of the library and the size of every public struct (64 bit).
# Fails where the list in interface.txt says otherwise: a change of it is a change that programs notice, and after
# a release asks for a new minor version (CONTRIBUTING.md).
# usage: interface.sh SOURCE_DIR C_COMPILER LIBRARY [--update]
set -eu
list=$1/tests/install/interface.txt
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# clang exports what picks a function by the processor: NAME.resolver
nm -D --defined-only "$3" | sed -n 's/^[0-9a-f]* [A-Z] \([^.]*\)$/\1/p' >"$folder/found"
{
  printf '#include <scree.h>\n#include <stdio.h>\nint main(void) {\n'
  sed -n 's/^} \(scree_[a-z0-9_]*\);.*/\1/p' "$1"/include/scree/*.h |
    sed 's/.*/  printf("& %zu\\n", sizeof(&));/'
  printf '  return 0;\n}\n'
} >"$folder/sizes.c"
"$2" -std=c17 -I"$1/include" "$folder/sizes.c" -o "$folder/sizes"
"$folder/sizes" >>"$folder/found"
LC_ALL=C sort "$folder/found" >"$folder/interface"
if [ "${4:-}" = --update ]; then
  cp "$folder/interface" "$list"
elif ! diff -u "$list" "$folder/interface"; then
  echo "the public interface has changed; if it is meant: tests/install/interface.sh . cc build/release/libscree.so --update"
  exit 1
fi
