#!/bin/bash
# Clumps of every method on the scans of SCREE_DATA_DIR and two samples: intersection over union by a million
# points of a test of its own, and what the union's volume, centroid and inertia are off.
#
#   bench/clumps.sh [FILE...]
#
# Writes results/clumps.csv. SCREE_BENCH_SPHERES: the largest count (default 100); SCREE_BENCH_METHOD: one method alone.
set -euo pipefail
. "$(dirname "$0")/lib.sh"

scans=("$@")
if [ $# -eq 0 ]; then
  for name in stone_073ac.ply weee_cam1.ply ycb_power_drill.obj rock_complexshape.stl scan_hammer_raw.obj \
    weee_slab2.ply sample:fp-1 stone_E22.ply stone_0_320.ply rock_chrono4.obj imu_adis16480.stl weee_flip2.ply \
    scan_turbineblade.ply scan_nefertiti_70k.obj organic_scorpion_100k.obj scan_bunny_holes.stl penkesu_screen_case.stl; do
    case $name in sample:*) scans+=("$name") ;; *) scans+=("$data/$name") ;; esac
  done
fi
output=$results/clumps.csv
{
  provenance "bench/clumps.sh"
  echo "# seconds: processor time for all counts up to the largest"
  echo "body,method,asked,spheres,iou,iou_told,volume_error,centroid_error,inertia_error,seconds"
} >"$output"
for scan in "${scans[@]}"; do
  name=$(basename "${scan#sample:}")
  level=$work/${name%.*}.stl
  "$bin/scree" simplify "$scan" -n 2000 -o "$level" -f -q
  OMP_NUM_THREADS=1 "$bin/bench_clumps" "$level" 1e-3 "${SCREE_BENCH_SPHERES:-100}" 1000000 ${SCREE_BENCH_METHOD:-} >>"$output"
done
# Where another method is above the fitted spheres.
awk -F, '!/^#/ && $1 != "body" { if ($2 == "fitted") best[$1, $3] = $5; else if ($5 > best[$1, $3]) print "above fitted: " $0 }' "$output"
