#!/bin/sh
# Fails where clang-format would change a tracked C file.
set -eu
cd "$(dirname "$0")/.."
git ls-files '*.c' '*.h' '*.cu' | grep -v '/vendor/' | xargs clang-format --dry-run -Werror
