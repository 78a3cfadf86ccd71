#!/bin/bash
# The cuda backend on a device: the processor's bits, and its speed. At most 8 minutes.
#
#   bench/device.sh [BACKEND]       BACKEND: cuda (the default), cuda:N
#
# Compares the hashes of the golden worlds and of 133, 1197 and 25,137 devices with the processor's, and measures
# particle-steps per second of those scenes. Scenes are those of bench/world.sh, which makes them in about 20
# minutes: make them first, and take work/world along; scenes that are not there are left out by name. Writes
# results/device.md. Without a device it runs against the tests' stand-in, whose speed says nothing:
#
#   LD_LIBRARY_PATH=build/bench/stand_in bench/device.sh
set -euo pipefail
. "$(dirname "$0")/lib.sh"
backend=${1:-cuda}
begin=$SECONDS
left() { echo $((480 - (SECONDS - begin))); }
cmake -S "$root" --preset release -B "$build" -DSCREE_BENCH=ON -DBUILD_TESTING=ON >/dev/null
cmake --build "$build" --target bench_world golden_world scree $(
  [ ! -d "$build/tests/ptx" ] || echo stand_in) >/dev/null
device=$("$bin/scree" version | sed -n 's/^backend cuda *//p')
case $device in "not there"*) echo "$device" >&2; exit 1 ;; esac
scenes=$work/world
rows=$(mktemp)
trap 'rm -f "$rows"' EXIT

# same SCENE STEPS: both hashes; the bits of the state after so many steps.
same() {
  local file=$scenes/$1.scree want got
  [ -s "$file" ] || { echo "$1: not made, left out" >&2; return 0; }
  [ "$(left)" -gt 60 ] || { echo "$1: no time left" >&2; return 0; }
  want=$("$bin/bench_world" hash 0 "$2" "$file")
  if got=$(timeout "$(left)" "$bin/bench_world" --backend "$backend" hash 0 "$2" "$file"); then
    [ "$want" = "$got" ] && got="the same bits" || got="OTHER BITS"
  else
    got="failed"
  fi
  echo "| $1 | $2 steps | $got |" | tee -a "$rows" >&2
}

# rate SCENE SECONDS: particle-steps per second.
rate() {
  local file=$scenes/$1.scree row
  [ -s "$file" ] && [ "$(left)" -gt 40 ] || return 0
  row=$(timeout "$(left)" "$bin/bench_world" --backend "$backend" time 0 "$2" "$file") || row=,,,,,,0
  echo "| $1 | $2 s | $(echo "$row" | cut -d, -f7) particle-steps/s |" | tee -a "$rows" >&2
}

"$bin/golden_world" "$backend" >&2 && echo "| golden worlds | 1500 steps | the same bits |" >>"$rows"
[ ! -s "$scenes/devices.scree" ] || [ -s "$scenes/shelved.scree" ] ||
  "$bin/bench_world" shelve 21 0 "$scenes/devices.scree" "$scenes/shelved.scree" >&2
same devices133 300
same devices 300
same flowing 300
same shelved 10
for scene in devices133 devices flowing; do rate $scene 10; done
rate shelved 20
{
  echo "# The cuda backend on a device"
  echo
  echo '```'
  provenance "bench/device.sh $backend"
  echo "# device: $device"
  echo '```'
  echo
  echo "| scene | run | result |"
  echo "|---|---|---|"
  cat "$rows"
} >"$results/device.md"
