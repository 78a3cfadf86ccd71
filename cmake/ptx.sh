#!/bin/bash
# The kernels of a step as PTX text, from the sources that the processor runs, by clang and llvm alone.
#
#   cmake/ptx.sh CLANG LLVM_BIN OUT
#
# Writes OUT.ptx, and OUT.c with it as scree_ptx. CLANG has the NVPTX target (Debian's clang-14 has). Every double
# operation is rounded to nearest and none is contracted: the script fails where one is not, or where something is
# left undefined.
set -euo pipefail
clang=$1 llvm=$2 out=$3
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$root"
sources=(src/world/device/kernels/*.c src/world/contact/*.c src/base/math.c src/particle/closest.c
  src/world/state/{loop,motion,pairs,parameters,pool,remote,wall_forces,wall_shape,walls}.c
  src/world/broad/{candidates,grids,lists}.c src/world/observe/sums.c src/world/step/{integrate,joints,step}.c)
flags=(-std=c17 -target nvptx64-nvidia-cuda -Xclang -target-cpu -Xclang sm_70 -O2 -Xclang -disable-llvm-passes
  -ffp-contract=off -fno-math-errno -nostdinc -isystem "$("$clang" -print-resource-dir)/include"
  -isystem src/world/device/kernels/include -Isrc -Iinclude -DNDEBUG -w -emit-llvm -c)
for source in "${sources[@]}"; do
  "$clang" "${flags[@]}" -o "$work/$(echo "$source" | tr / _).bc" "$source"
done
"$llvm/llvm-link" "$work"/*.bc -S -o "$work/all.ll"
# what marks a kernel for llvm 14
kernels=$(sed -n 's/^  X(\([a-z_]*\)).*/scree_kernel_\1/p' src/world/device/kernels/device.h)
{
  number=9000 nodes=
  for kernel in $kernels; do
    echo "!$number = !{void (%struct.scree_world**, %struct.scree_device_step*)* @$kernel, !\"kernel\", i32 1}"
    nodes="$nodes${nodes:+, }!$number" number=$((number + 1))
  done
  echo "!nvvm.annotations = !{$nodes}"
} >>"$work/all.ll"
"$llvm/opt" -S -passes='internalize,globaldce,default<O3>,globaldce' \
  -internalize-public-api-list="$(echo $kernels | tr ' ' ,)" "$work/all.ll" -o "$work/opt.ll"
"$llvm/llc" -mcpu=sm_70 -O3 -fp-contract=off "$work/opt.ll" -o "$work/raw.ptx"
sed -e 's/[[:space:]]*\/\/.*$//' -e '/^[[:space:]]*$/d' "$work/raw.ptx" >"$work/out.ptx"
if grep -nE '\bfma\b|\b(add|sub|mul|div|sqrt|rcp)\.(f64|f32|approx|full|ftz)|^\.extern' "$work/out.ptx" | head -5 | grep .; then
  echo "ptx.sh: the lines above are contracted, not rounded to nearest, or undefined" >&2
  exit 1
fi
{
  echo '/* Made by cmake/ptx.sh. */'
  echo 'extern const char scree_ptx[];'
  echo 'const char scree_ptx[] ='
  sed -e 's/[\\"]/\\&/g' -e 's/.*/"&\\n"/' "$work/out.ptx"
  echo ';'
} >"$work/out.c"
cp "$work/out.ptx" "$out.ptx"
cp "$work/out.c" "$out.c"
