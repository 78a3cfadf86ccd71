#!/bin/bash
# The cuda backend on a device: the processor's bits, and its speed. At most 8 minutes.
#
#   bench/device.sh [BACKEND]       BACKEND: cuda (the default), cuda:N
#
# Compares the hashes of the golden worlds and of 133, 1197 and 25,137 devices with the processor's, and measures
# particle-steps per second of one world, of batches of 10 and 80, and of 100,548 bodies of 100 triangles. Scenes are
# those of bench/world.sh, which makes them in about 20 minutes: make them first, and take work/world along; what is
# not there is left out by name. Programs are built where they are not there (SCREE_BENCH_BUILD). Writes
# results/device.md. Without a device it runs against the tests' stand-in, whose speed says nothing:
#
#   LD_LIBRARY_PATH=build/bench/stand_in bench/device.sh
set -euo pipefail
. "$(dirname "$0")/lib.sh"
backend=${1:-cuda}
begin=$SECONDS
left() { echo $((480 - (SECONDS - begin))); }
if [ ! -x "$bin/bench_world" ] || [ ! -x "$bin/golden_world" ]; then
  cmake -S "$root" --preset release -B "$build" -DSCREE_BENCH=ON -DBUILD_TESTING=ON >/dev/null
  cmake --build "$build" --target bench_world golden_world $([ ! -d "$build/tests/ptx" ] || echo stand_in) >/dev/null
fi
scenes=$work/world
rows=$(mktemp) rates=$(mktemp)
trap 'rm -f "$rows" "$rates"' EXIT


# there SCENE SECONDS: whether the scene is, and so much time.
there() {
  [ -s "$scenes/$1.scree" ] || { echo "$1: not made, left out" >&2; return 1; }
  [ "$(left)" -gt "$2" ] || { echo "$1: no time left" >&2; return 1; }
}

# same SCENE STEPS NAME: both hashes; the bits of the state after so many steps.
same() {
  local file=$scenes/$1.scree want got
  there "$1" 60 || return 0
  want=$("$bin/bench_world" hash 0 "$2" "$file")
  if got=$(timeout "$(left)" "$bin/bench_world" --backend "$backend" hash 0 "$2" "$file"); then
    [ "$want" = "$got" ] && got="the same bits" || got="OTHER BITS"
  else
    got="failed"
  fi
  echo "| $3 | $2 | $got |" | tee -a "$rows" >&2
}

# rate SCENE WORLDS SECONDS NAME: particle-steps per second of all worlds.
rate() {
  local line
  there "$1" 40 || return 0
  if [ "$2" = 1 ]; then
    line=$(timeout "$(left)" "$bin/bench_world" --backend "$backend" time 0 "$3" "$scenes/$1.scree" | cut -d, -f7) || line=0
  else
    line=$(timeout "$(left)" "$bin/bench_world" --backend "$backend" batch "$2" "$3" "$scenes/$1.scree" | cut -d, -f4) || line=0
  fi
  echo "| $4 | $2 | $(printf %.3g "${line:-0}") |" | tee -a "$rates" >&2
}

"$bin/golden_world" "$backend" >&2 && echo "| the golden worlds | 1500 | the same bits |" >>"$rows"
if [ -s "$scenes/devices.scree" ] && [ ! -s "$scenes/shelved.scree" ]; then
  "$bin/bench_world" shelve 21 0 "$scenes/devices.scree" "$scenes/shelved.scree" >&2
fi
if [ -s "$scenes/devices_100.scree" ] && [ ! -s "$scenes/devices100000.scree" ]; then
  "$bin/bench_world" shelve 84 0 "$scenes/devices_100.scree" "$scenes/devices100000.scree" >&2
fi
same devices133 300 "133 devices of 760 triangles"
same devices 300 "1197 devices at rest"
same flowing 300 "1197 devices flowing"
same shelved 20 "25,137 devices"
rate devices133 1 5 "133 devices at rest"
for worlds in 1 10 80; do
  rate devices $worlds 5 "1197 devices of 760 triangles at rest"
  rate flowing $worlds 5 "1197 devices flowing"
done
rate devices100000 1 15 "100,548 devices of 100 triangles"
{
  echo "# The cuda backend on a device"
  echo
  echo '```'
  provenance "bench/device.sh $backend"
  echo "# device: $(nvidia-smi --query-gpu=name,driver_version --format=csv,noheader 2>/dev/null || echo the stand-in)"
  echo '```'
  echo
  echo "| world | steps | against the processor |"
  echo "|---|--:|---|"
  cat "$rows"
  echo
  echo "| world | at once | particle-steps/s |"
  echo "|---|--:|--:|"
  cat "$rates"
} >"$results/device.md"
