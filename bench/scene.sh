#!/bin/bash
# What a turning drum of 20,000 triangles costs a scene of 5,000 devices, and how much memory a body takes.
#
#   bench/scene.sh [ROUNDS [STEPS [COUNT [WALL]]]]
#
# "The particles alone" are the same devices in a drum that is one cylinder and two planes, turning as fast.
# The drum is an open sheet of 20,000 triangles with planes as its ends, or, where WALL is not 0, a closed solid with
# walls WALL m thick. Both scenes fall into their drums for 1 s and are kept as checkpoints in work/drum-COUNT-WALL
# (an hour of one core for 5,000; delete it to make them again). Then they are advanced in turns, ROUNDS times (default 7)
# STEPS steps (default 100); the median ratio counts. Memory is that of the scene with the mesh, loaded and stepped in a process of its own.
# Writes results/scene.md, or of the closed solid results/scene-closed.md.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cmake -S "$root" --preset release -B "$build" -DSCREE_BENCH=ON -DBUILD_TESTING=OFF >/dev/null
cmake --build "$build" --target scree bench_scene ${SCREE_BENCH_JOBS:+-j "$SCREE_BENCH_JOBS"} >/dev/null
rounds=${1:-7} steps=${2:-100} count=${3:-5000} wall=${4:-0}
scenes=$work/drum-$count-$wall
mkdir -p "$scenes"
case $wall in
0) size='-v n=200 -v m=50' ;;
*) size='-v n=125 -v m=35' ;;
esac
# shellcheck disable=SC2086 # two options
awk $size -v radius=1 -v width=1.4 -v wall="$wall" -f "$bench_dir/scenes/drum.awk" >"$scenes/drum.obj"
triangles=$(grep -c ^f "$scenes/drum.obj")

turning='material: steel, motion: [{rotate: {axis: [0, 1, 0], through: [0, 0, 0], speed: 1}}]'
# scene NAME GEOMETRY...: its file.
scene() {
  local name=$1
  shift
  cat >"$scenes/$name.yaml" <<EOF
title: $count devices in a turning drum
time: 1000
materials:
  plastic: {young: 1e8, density: 1200, restitution: 0.3, friction: 0.5}
  steel: {young: 1e11}
shapes:
  phone: {sample: fp-1, triangles: recommended, material: plastic}
  camera: {sample: dc-1, triangles: recommended, material: plastic}
  smartphone: {sample: sp-1, triangles: recommended, material: plastic}
geometry:
$(printf '  %s\n' "$@")
inlets: # turned alike, more of them find room
  feed: {box: {min: [-0.7, -0.66, -0.65], max: [0.7, 0.66, 0.65]}, shapes: [phone, camera, smartphone], count: $count,
         orientation: fixed}
output: {series: 0.1}
EOF
}
ends=("near: {plane: [0, 1, 0], at: [0, -0.7, 0], $turning}" "far: {plane: [0, -1, 0], at: [0, 0.7, 0], $turning}")
drum="drum: {file: drum.obj, unit: m, $turning}"
if [ "$wall" = 0 ]; then scene mesh "$drum" "${ends[@]}"; else scene mesh "$drum"; fi
scene alone "shell: {cylinder: {radius: 1, length: 1.4, axis: [0, 1, 0]}, at: [0, -0.7, 0], $turning}" "${ends[@]}"
for name in mesh alone; do
  [ -e "$scenes/$name.settled" ] && continue
  (cd "$scenes" && "$bin/bench_scene" settle 1 $name.yaml $name.scree) >&2
  touch "$scenes/$name.settled"
done

"$bin/bench_scene" turns "$rounds" "$steps" "$scenes/mesh.scree" "$scenes/alone.scree" >"$scenes/turns"
read -r bodies held most process < <("$bin/bench_scene" memory "$steps" "$scenes/mesh.scree")
# column N: the median of the turns, in ms a step.
column() { cut -d' ' -f"$1" "$scenes/turns" | median | awk '{ printf "%.2f", 1e3 * $1 }'; }
md=$results/scene$([ "$wall" = 0 ] || echo -closed).md
{
  echo '# A scene beside its particles alone'
  echo
  provenance "bench/scene.sh $rounds $steps $count $wall" | sed 's/^# /    /'
  echo
  echo "$bodies devices in a drum that turns; bytes are those of the scene with the mesh, over its bodies."
  echo
  echo '| what | measured | bar |'
  echo '|---|--:|--:|'
  echo "| a step with the drum of $triangles triangles | $(column 1) ms | |"
  echo "| a step with a cylinder and two planes | $(column 2) ms | |"
  echo "| the first over the second, median of $rounds turns | $(awk '{ print $1 / $2 }' "$scenes/turns" | median |
    xargs printf %.3f) | at most 1.3 |"
  echo "| bytes a body that the library holds | $((held / bodies)) | at most 20,000 |"
  echo "| bytes a body that it held at most, when the checkpoint was read | $((most / bodies)) | |"
  echo "| bytes a body of the process at most | $((process / bodies)) | |"
} >"$md.part"
mv "$md.part" "$md"
echo "$md"
