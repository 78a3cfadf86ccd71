#!/bin/sh
# A study whose runs share the device has the states that the processor's has. SCREE is the program; the
# stand-in is found as the driver.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >tiny.yaml <<'YAML'
name: tiny
replicates: 3
shapes: [sample:icosphere-1]
base:
  preset: demo
  particles: 3
  cylinder: {diameter: 0.3}
  phases: {pack_time: 0.1, settle_time: 0.01, lift_speed: 1, lift_time: 0.02, hold_time: 0.01}
factors:
  rp: [spheres]
YAML
"$SCREE" study tiny.yaml -o here --jobs 1 >/dev/null
"$SCREE" study tiny.yaml -o there --backend cuda >/dev/null
for folder in here there; do
  sqlite3 $folder/study.sqlite "SELECT run, state, hash FROM run ORDER BY run" >$folder.txt
done
test "$(wc -l <here.txt)" = 3
cat there.txt
cmp here.txt there.txt
