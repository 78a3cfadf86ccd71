#!/bin/bash
# NVIDIA's assembler takes the kernels for every target that it knows of these.
# usage: assembles.sh PTXAS KERNELS.ptx
set -euo pipefail
known=$("$1" --help)
count=0
for target in sm_75 sm_90 sm_120; do
  grep -qw "$target" <<<"$known" || continue
  "$1" -arch=$target "$2" -o /dev/null
  echo "assembled for $target"
  count=$((count + 1))
done
test $count -gt 0
