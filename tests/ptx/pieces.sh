#!/bin/bash
# The script for a device runs a study in pieces, each interrupted and gone on with; its runs end as the processor's.
# SCREE is the program; the stand-in is found as the driver.
# usage: pieces.sh BENCH_FOLDER
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >small.yaml <<'YAML'
name: small
replicates: 2
shapes: [sample:icosphere-1]
base:
  preset: demo
  particles: 12
  cylinder: {diameter: 0.3}
  disc: {diameter: 1}
  phases: {pack_time: 0.3, settle_time: 0.1, lift_speed: 1, lift_time: 0.2, hold_time: 0.1}
factors:
  rp: [spheres, scan]
YAML
export SCREE_BENCH_BUILD=$(dirname "$(dirname "$SCREE")") SCREE_BENCH_WORK=$work/work SCREE_BENCH_RESULTS=$work/results
pieces=0 code=3 seconds=2 # in which no machine does it all
while [ $code = 3 ]; do
  code=0
  SCREE_BENCH_SECONDS=$seconds SCREE_BENCH_RUNS=3 "$1/device.sh" study cuda small.yaml 2>told || code=$?
  pieces=$((pieces + 1)) seconds=48
  [ $code = 0 ] || [ $code = 3 ] || { cat told; exit $code; }
done
echo "$pieces pieces"
test $pieces -gt 1
test "$(grep -c ',done,' results/study/device-runs.csv)" = 4
"$SCREE" study small.yaml -o here >/dev/null
everything() { sqlite3 "$1" 'SELECT * FROM series ORDER BY key, time' 'SELECT run, state, hash, sector_deg, cone_deg, height FROM run ORDER BY run'; }
everything here/study.sqlite >here.txt
everything work/study/small/study.sqlite | cmp - here.txt
