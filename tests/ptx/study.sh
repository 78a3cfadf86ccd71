#!/bin/sh
# Studies whose runs share the device have the states that the processor's have: all at once, where the device has
# room for some only, and after it was lost midway. SCREE is the program; the stand-in is found as the driver.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >tiny.yaml <<'YAML'
name: tiny
replicates: 3
shapes: [sample:icosphere-1]
base:
  preset: demo
  particles: 3
  cylinder: {diameter: 0.3}
  phases: {pack_time: 0.1, settle_time: 0.01, lift_speed: 1, lift_time: 0.02, hold_time: 0.01}
  output: {checkpoint_interval: 0.01}
factors:
  rp: [spheres]
YAML
# `on_device FOLDER WORDS...`: what the stand-in tells of it is in `told`.
on_device() {
  folder=$1
  shift
  SCREE_STAND_IN_COUNTS=1 "$SCREE" study tiny.yaml -o "$folder" --backend cuda "$@" >out 2>told
}
# `told_of WORDS`: the number before these words.
told_of() { sed -n "s/^stand-in: .*[^0-9]\([0-9]*\) $1.*/\1/p" told; }
same() {
  sqlite3 "$1/study.sqlite" "SELECT run, state, hash FROM run ORDER BY run" >"$1.txt"
  cmp here.txt "$1.txt"
}
"$SCREE" study tiny.yaml -o here --jobs 1 >/dev/null
same here
test "$(grep -c 'done' here.txt)" = 3

on_device one --jobs 1
same one
room=$(($(told_of 'bytes in use') * 3 / 2))
on_device all
same all
test "$(told_of 'times too little')" = 0
test "$(told_of 'bytes in use')" -gt $room
launches=$(told_of launches)

# room for one run
export SCREE_STAND_IN_MEMORY=$room
on_device some
same some
test "$(told_of 'times too little')" -gt 0
# room for none
export SCREE_STAND_IN_MEMORY=10000
if on_device none; then exit 1; fi
grep -q 'out of memory: the device has no room for [0-9]* bytes more' told
test "$(find none/results -name '*.yaml' | wc -l)" = 0
unset SCREE_STAND_IN_MEMORY

# lost: no run is a failed one, and the same command goes on
export SCREE_STAND_IN_LOST=$((launches / 2))
if on_device lost; then exit 1; fi
grep -q 'unspecified launch failure' told
test "$(find lost/results -type f | wc -l)" -lt 3
test "$(find lost/runs -name checkpoint.scree | wc -l)" -gt 0
unset SCREE_STAND_IN_LOST
on_device lost
same lost
test "$(find lost/results -name '*failed*' | wc -l)" = 0
