#!/bin/bash
# The translator refuses what would not give the processor's bits.
# usage: refuses.sh KERNELS.ptx
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# refused PATTERN REPLACEMENT MESSAGE: the text with the first line that matches changed
refused() {
  sed "0,/$1/s//$2/" "$ptx" >"$work/changed.ptx"
  ! cmp -s "$ptx" "$work/changed.ptx" || { echo "nothing matches $1" >&2; exit 1; }
  if python3 "$here/ptx_to_c.py" "$work/changed.ptx" "$work/out.c" 2>"$work/said"; then
    echo "taken: $2" >&2
    exit 1
  fi
  grep -q "$3" "$work/said" || { cat "$work/said" >&2; exit 1; }
}
ptx=$1
refused 'add\.rn\.f64' 'add.f64' 'not rounded to nearest: add.f64'
refused 'mul\.rn\.f64' 'mul.rz.f64' 'not rounded to nearest: mul.rz.f64'
refused 'sqrt\.rn\.f64' 'sqrt.approx.f64' 'not rounded to nearest: sqrt.approx.f64'
refused 'add\.rn\.f64' 'fma.rn.f64' 'unknown instruction fma.rn.f64'
refused 'selp\.f64' 'frobnicate.f64' 'unknown instruction frobnicate.f64'
