#!/bin/bash
# The speed of scree's world: particle-steps per second on settled and flowing piles, against triangle
# count, body count, threads, and beside the engines that Debian packages.
#
#   bench/world.sh [SECONDS [PATTERN]]
#
# Each measurement takes SECONDS (default 5), three times; the median counts; ratios are of five pairs in
# turns. With PATTERN (an extended regular expression) only scenes whose name matches are made and measured.
#
# Scenes are made once, as checkpoints in the build folder (about 20 minutes on one core); delete
# work/world there to make them again, which a new version of checkpoints asks for. A scene is
# poured, settled and stacked by bench_world. Writes results/world.md and results/world.json. Peers, each
# left out by name where it is not installed: apt-get install libode-dev libbullet-dev yade.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cmake -S "$root" --preset release -B "$build" -DSCREE_BENCH=ON -DBUILD_TESTING=OFF >/dev/null
for target in bench_world peer_ode peer_bullet; do # a peer that is not installed is no target
  cmake --build "$build" --target $target ${SCREE_BENCH_JOBS:+-j "$SCREE_BENCH_JOBS"} >/dev/null 2>&1 ||
    echo "$target is left out" >&2
done
seconds=${1:-5}
pattern=${2:-.}
scenes=$work/world
mkdir -p "$scenes"
rows=$scenes/rows
: >"$rows"

# make NAME ARGUMENT...: the scene NAME by bench_world ARGUMENT... NAME, unless it is there.
make_scene() {
  local out=$scenes/$1.scree
  [[ $1 =~ $pattern ]] || return 0
  shift
  [ -s "$out" ] || "$bin/bench_world" "${@//@/$scenes/}" "$out" >&2
}
# timed THREADS SCENE: the line of the median of three runs, by CPU time for one thread, else by wall clock.
timed() {
  local i column=$([ "$1" = 1 ] && echo 8 || echo 7)
  for i in 1 2 3; do "$bin/bench_world" time "$1" "$seconds" "$scenes/$2.scree"; done | median -t, -k$column,$column
}
# measure LABEL THREADS SCENE BAR: a row; BAR is what its rate should be at least, or empty.
measure() {
  [[ $3 =~ $pattern ]] && [ -s "$scenes/$3.scree" ] || return 0
  echo "$1,$2,${4:-},$(timed "$2" "$3")" >>"$rows"
  tail -1 "$rows" | cut -d, -f1,10,11 >&2
}
# rate LABEL COLUMN: of the row's numbers.
rate() { awk -F, -v l="$1" -v c="$2" '$1 == l { print $c }' "$rows"; }

make_scene boxes200 fill boxes 12 200
make_scene boxes200t retime 1e-5 @boxes200.scree
make_scene boxes1000 stack 5 @boxes200.scree
make_scene boxes1000t retime 1e-5 @boxes1000.scree
for n in 28 448; do
  make_scene tray$n fill tray $n 200
  make_scene tray${n}t retime 1e-5 @tray$n.scree
done
make_scene devices133 fill devices 760 133
make_scene devices stack 9 @devices133.scree
make_scene flowing lift 0.25 @devices.scree
for n in 100 300 1500; do
  make_scene devices133_$n fill devices $n 133
  make_scene devices_$n shelve 9 0.05 @devices133_$n.scree
done
make_scene devices12000 shelve 10 0.05 @devices.scree
make_scene devices100000 shelve 84 0 @devices_100.scree

measure "133 devices at rest" 1 devices133 500000
measure "1197 devices at rest" 1 devices 500000
measure "1197 devices flowing" 1 flowing 260000
measure "1197 devices at rest with two threads" 2 devices
for n in 100 300 1500; do measure "1197 devices of $n triangles" 1 devices_$n; done
measure "11970 devices at rest" 1 devices12000
measure "100548 devices of 100 triangles" 1 devices100000
measure "200 boxes" 1 boxes200t 1200000
measure "1000 boxes" 1 boxes1000t 1000000
measure "200 trays of 28 triangles" 1 tray28t 460000
measure "200 trays of 448 triangles" 1 tray448t 200000

# Ratios are taken in turns, so that both see the same machine: ROUNDS times A and B one after the other, the
# median of B over A counts.
rounds=5
# speed THREADS SCENE COLUMN: one run's rate by wall clock (7) or CPU time (8).
speed() { "$bin/bench_world" time "$1" "$seconds" "$scenes/$2.scree" | cut -d, -f"$3"; }
# side_by_side SCENE: the rates by wall clock of two runs at once, added up.
side_by_side() {
  speed 1 "$1" 7 >"$scenes/first" &
  speed 1 "$1" 7 >"$scenes/second"
  wait
  cat "$scenes/first" "$scenes/second" | awk '{ sum += $1 } END { print sum }'
}
# in_turns A B: the median ratio of what the command B prints over what A prints.
in_turns() {
  local i a b
  for ((i = 0; i < rounds; i++)); do
    a=$($1)
    b=$($2)
    ratio "$b" "$a"
  done | median
}
two_threads='' two_runs='' many_bodies='' many_triangles=''
has() { [[ $1 =~ $pattern ]] && [ -s "$scenes/$1.scree" ]; }
for scene in devices devices133 boxes200t; do
  has $scene || continue
  two_threads=$(in_turns "speed 1 $scene 7" "speed 2 $scene 7")
  two_runs=$(in_turns "speed 1 $scene 7" "side_by_side $scene")
  break
done
if has devices && has devices12000; then many_bodies=$(in_turns 'speed 1 devices 8' 'speed 1 devices12000 8'); fi
if has devices_100 && has devices_1500; then many_triangles=$(in_turns 'speed 1 devices_1500 8' 'speed 1 devices_100 8'); fi

# Peers on dumped scenes, 2 ms steps: rate, and simulated seconds per second.
peers=$scenes/peers
: >"$peers"
for scene in boxes200t boxes1000t tray28t tray448t; do
  [[ $scene =~ $pattern ]] && [ -s "$scenes/$scene.scree" ] || continue
  "$bin/bench_world" dump "$scenes/$scene.scree" "$scenes/$scene.txt"
  for peer in ode bullet; do
    [ -x "$bin/peer_$peer" ] || continue
    echo "$scene,$("$bin/peer_$peer" "$scenes/$scene.txt" "$seconds")" >>"$peers"
  done
done
# YADE's polyhedra are convex; they sink for a minute before they are timed.
if ! command -v yade >/dev/null; then
  echo "yade is left out" >&2
elif [ -s "$scenes/boxes200t.txt" ] && [[ boxes200t =~ $pattern ]]; then
  line=$(yade -n -x "$bench_dir/peers/yade.py" "$scenes/boxes200t.txt" "$seconds" 2>/dev/null | grep '^YADE') || true
  [ -z "$line" ] || echo "boxes200t,$line" >>"$peers"
fi

# ratio_row NAME RATIO BAR: a row, where the ratio was measured.
ratio_row() { [ -z "$2" ] || printf '| %s | %.2f | %s |\n' "$1" "$2" "$3"; }
command="bench/world.sh $seconds${2:+ '$2'}"
md=$results/world.md
{
  echo '# Speed of the world'
  echo
  provenance "$command" | sed 's/^# /    /'
  echo
  echo 'Rates are particle-steps per second of CPU time (with two threads: of wall clock). Shares are of the'
  echo 'time of a step. Pairs and contacts touch, items are evaluated, each per body. The ratios are medians of five pairs'
  echo 'of runs in turns.'
  echo
  echo '| scene | rate | bar | triangles | step (us) | lists % | contacts % | bodies % | pairs | contacts | items | overlap (um) | memory (MiB) |'
  echo '|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|'
  awk -F, '{ printf "| %s | %.3g | %s | %d | %.1f | %s | %s | %s | %s | %s | %s | %.1f | %.0f |\n", $1,
    ($2 == 1 ? $11 : $10), $3, $5, 1e6 * $6, $13, $14, $15, $16, $17, $18, 1e6 * $21, $22 / 1048576 }' "$rows"
  echo
  echo '| ratio | measured | bar |'
  echo '|---|--:|--:|'
  ratio_row "two threads over one" "$two_threads" "at least 1.7"
  ratio_row "two runs side by side over one" "$two_runs" "at least 1.95"
  ratio_row "cost at 1500 triangles over 100" "$many_triangles" "at most 2"
  ratio_row "rate at 11970 bodies over 1197" "$many_bodies" "at least 0.8"
  yade=$(awk -F, '$2 == "YADE polyhedra" { print $7 }' "$peers")
  boxes=$(rate "200 boxes" 11)
  [ -z "$yade" ] || [ -z "$boxes" ] || ratio_row "200 boxes over YADE's polyhedra" "$(ratio "$boxes" "$yade")" ""
  echo
  echo 'Peers from the same state, with steps of 2 ms: impulse engines, whose step is another kind of step (YADE: soft'
  echo 'contacts and steps of 1e-5 s, as here). scree at'
  echo '1e-5 s makes 1e-5 times its rate over the bodies: 200 boxes at 1e6/s are 0.05 simulated seconds per second.'
  echo
  echo '| scene | engine | bodies | rate | simulated s per CPU s |'
  echo '|---|---|--:|--:|--:|'
  awk -F, '{ printf "| %s | %s | %d | %.3g | %.3g |\n", $1, $2, $3, $7, $8 }' "$peers"
} >"$md.part"
mv "$md.part" "$md"

{
  printf '{"command": "%s", "commit": "%s", "machine": "%s", "processors": %s, "two_threads": %s, "side_by_side": %s, "rows": [' "$command" \
    "$(git -C "$root" rev-parse --short HEAD)" "$(lscpu | sed -n 's/^Model name: *//p' | head -1)" "$(nproc)" \
    "${two_threads:-null}" "${two_runs:-null}"
  awk -F, '{ printf "%s\n{\"scene\": \"%s\", \"threads\": %s, \"bodies\": %s, \"triangles\": %s, \"time_step_s\": %s, \"steps\": %s, \"wall_s\": %s, \"cpu_s\": %s, \"rate_wall\": %s, \"rate_cpu\": %s, \"broad_percent\": %s, \"lists_percent\": %s, \"contacts_percent\": %s, \"bodies_percent\": %s, \"pairs_per_body\": %s, \"contacts_per_body\": %s, \"items_per_body\": %s, \"lists_per_1000_body_steps\": %s, \"kinetic_J\": %s, \"overlap_m\": %s, \"peak_bytes\": %s}", (NR > 1 ? "," : ""), $1, $2, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15, $16, $17, $18, $19, $20, $21, $22 }' "$rows"
  echo ']}'
} >"$results/world.json"
echo "$md"
