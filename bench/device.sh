#!/bin/bash
# The cuda backend on a device: the processor's bits, and its speed; and the paper's study at full size. Every call
# takes at most 8 minutes.
#
#   bench/device.sh [BACKEND]                       BACKEND: cuda (the default), cuda:N
#   bench/device.sh study [BACKEND [STUDY.yaml]]    a piece of the study; the same call goes on with the next
#
# The first compares the hashes of the golden worlds and of 133, 1197 and 25,137 devices with the processor's, and
# measures particle-steps per second of one world, of batches of 10 and 80, and of 100,548 bodies of 100 triangles.
# Scenes are those of bench/world.sh, which makes them in about 20 minutes: make them first, and take work/world along;
# what is not there is left out by name. Writes results/device.md.
#
# The second runs results/study/repose.yaml, three replicates at a time (SCREE_BENCH_RUNS=21). Its folder, work/study
# in the build folder, has all that the next piece needs: take it along. Writes the runs that are done to
# results/study/device-runs.csv. Exit code 0: the study is complete; 3: it needs another piece.
#
# Programs are built where they are not there (SCREE_BENCH_BUILD). Without a device both run against the tests'
# stand-in, whose speed says nothing:
#
#   LD_LIBRARY_PATH=build/bench/stand_in bench/device.sh
set -euo pipefail
. "$(dirname "$0")/lib.sh"
limit=${SCREE_BENCH_SECONDS:-480}
begin=$SECONDS
left() { echo $((limit - (SECONDS - begin))); }
# build PROGRAM...: those that are not there.
build() {
  local missing=() program
  for program; do [ -x "$bin/$program" ] || missing+=("$program"); done
  [ ${#missing[@]} -gt 0 ] || return 0
  cmake -S "$root" --preset release -B "$build" -DSCREE_BENCH=ON -DBUILD_TESTING=ON >/dev/null
  cmake --build "$build" --target "${missing[@]}" $([ ! -d "$build/tests/ptx" ] || echo stand_in) >/dev/null
}
# origin COMMAND: where the numbers come from.
origin() {
  provenance "$1"
  echo "# device: $(nvidia-smi --query-gpu=name,driver_version --format=csv,noheader 2>/dev/null || echo the stand-in)"
}

# ---- a piece of the study ----

columns="label, rp, replicate, seed, state, reason, triangle_count, time_step, step_count, particle_steps, wall_seconds,
  piece_count, largest_overlap, heap, heap_reason, sector_deg, sector_sd_deg, cone_deg, silhouette_deg,
  silhouette_sd_deg, height, base_radius, run_out, body_count, left_count, packing_fraction, coordination, time, still,
  hash"
# piece BACKEND STUDY.yaml: interrupted while there is time to write checkpoints.
piece() {
  local folder code=0 csv=$results/study/device-runs.csv
  build scree
  folder=$work/study/$(basename "$2" .yaml)
  mkdir -p "$folder" "$results/study"
  timeout -s INT -k $((limit / 8)) $(($(left) - limit / 8)) "$bin/scree" study "$2" -o "$folder" --backend "$1" \
    --jobs "${SCREE_BENCH_RUNS:-21}" >&2 || code=$?
  [ $code = 0 ] || [ $code = 124 ] || exit $code
  [ -f "$folder/study.sqlite" ] || exit 3 # the time was over before its runs were listed
  if command -v sqlite3 >/dev/null; then
    {
      origin "bench/device.sh study $1"
      sqlite3 -csv -header "$folder/study.sqlite" \
        "SELECT $columns FROM run JOIN point USING (point) WHERE state IN ('done', 'failed') ORDER BY run"
    } >"$csv"
  else
    echo "no sqlite3: the runs are in $folder/results alone" >&2
  fi
  "$bin/scree" study status "$folder" >&2
  [ $code = 0 ] || exit 3
}
if [ "${1:-}" = study ]; then
  piece "${2:-cuda}" "${3:-$bench_dir/results/study/repose.yaml}"
  exit 0
fi

# ---- bits and speed ----

backend=${1:-cuda}
build bench_world golden_world
scenes=$work/world
memory_bound=6.7e8 # particle-steps/s
rows=$(mktemp) rates=$(mktemp)
trap 'rm -f "$rows" "$rates"' EXIT

# there SCENE SECONDS: whether the scene is, and so much time.
there() {
  [ -s "$scenes/$1.scree" ] || { echo "$1: not made, left out" >&2; return 1; }
  [ "$(left)" -gt "$2" ] || { echo "$1: no time left" >&2; return 1; }
}

# same SCENE STEPS NAME: both hashes; the bits of the state after so many steps.
same() {
  local file=$scenes/$1.scree want got code=0
  there "$1" 60 || return 0
  want=$("$bin/bench_world" hash 0 "$2" "$file")
  got=$(timeout "$(left)" "$bin/bench_world" --backend "$backend" hash 0 "$2" "$file") || code=$?
  case $code,$got in
  "0,$want") got="the same bits" ;;
  0,*) got="OTHER BITS" ;;
  124,*) got="no time left" ;;
  *) got="failed" ;;
  esac
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
  awk -v n="$4" -v w="$2" -v r="${line:-0}" -v m=$memory_bound 'BEGIN {
    printf "| %s | %d | %.3g | %.1f |\n", n, w, r, 100 * r / m }' | tee -a "$rates" >&2
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
  origin "bench/device.sh $backend"
  echo '```'
  echo
  echo "| world | steps | against the processor |"
  echo "|---|--:|---|"
  cat "$rows"
  echo
  echo "The last column is of what an H100's memory allows (3.35e12 bytes a second), were it read and written once: 5 KB a"
  echo "body and step, as counted of 100,000 bodies. device-kernels.md tells what bounds each kernel."
  echo
  echo "| world | at once | particle-steps/s | % of memory's |"
  echo "|---|--:|--:|--:|"
  cat "$rates"
} >"$results/device.md"
