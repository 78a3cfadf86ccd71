#!/bin/bash
# Evidence: cases beside measurements and other codes, docs/background/evidence.md.
#   bench/evidence/run.sh [CASE...]     boulders, drum, penetration, orifice, bulk, polyhedra, clumps, turning, rockable, hits, impacts, paper, estimator, shape; all without a name
# Each piece goes on where it was broken off; what is done is not done again (delete its table in results/ to repeat it).
# SCREE_EVIDENCE_SECONDS stops each piece after so long, at a row of its table; the same call goes on with the next. A row that takes
# longer never ends: some take minutes.
# SCREE_EVIDENCE_DIR names the folder of measurements (default ../shared/evidence), SCREE_DATA_DIR that of scans (../shared/data); a
# case without its folder, or the program that it is compared with, is skipped. One process at a time: nice -n 15 bench/evidence/run.sh runs beside other work. Some hours of one core in all.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
export SCREE_EVIDENCE_DIR=${SCREE_EVIDENCE_DIR:-$root/../shared/evidence}
scree=${SCREE:-$root/build/release/bin/scree}
work=${SCREE_EVIDENCE_WORK:-$root/build/evidence}
results=$here/results
shapes=recommended,4x,0.25x,0.0625x,sphere,clump5,clump20,clump50
mkdir -p "$work" "$results"
cases=(boulders drum penetration orifice bulk polyhedra clumps turning rockable hits impacts paper estimator shape)
[ $# -gt 0 ] || set -- "${cases[@]}"

# piece COMMAND...: within the limit; stopped says that one of the case's ended there.
piece() {
  code=0
  timeout "${SCREE_EVIDENCE_SECONDS:-0}" "$@" || code=$?
  [ $code != 124 ] || { stopped=1 && echo "stopped after $SCREE_EVIDENCE_SECONDS s: ${*#"$root/"}" >&2; }
  [ $code = 0 ] || [ $code = 124 ]
}

# table FILE COMMAND...: what the command prints, whole or not at all.
table() {
  piece "${@:2}" >"$work/table"
  [ $code != 0 ] || [ ! -s "$work/table" ] || cp "$work/table" "$1"
}

# compared RUNS RESULT COMMAND...: what the command says of the runs, when all are there.
compared() { [ "$stopped" ] || [ ! -s "$1" ] || table "$2" "${@:3}" "$1"; }

# fitted CASE: its calibration and both tables of it.
fitted() {
  [ -s "$results/$1-fit.csv" ] && return
  piece "$scree" calibrate "$here/$1/fit.yaml" -o "$work/$1-fit" --jobs 1 -j 1
  [ "$stopped" ] || "$here/fit_table.py" "$work/$1-fit" "$results/$1-fit.csv" "$results/$1-runs.csv"
}

boulders() {
  [ -s "$results/boulders-measured.csv" ] || table "$results/boulders-measured.csv" "$here/boulders/boulders.py" measured
  [ -s "$results/boulders-used.csv" ] || table "$results/boulders-used.csv" "$here/boulders/boulders.py" used --variant $shapes
  fitted boulders
  [ -s "$results/boulders-fit.csv" ] || return 0
  local words corner=() zone part
  words=$("$here/boulders/boulders.py" fitted "$results/boulders-fit.csv")
  for zone in blue gray red; do corner+=("$zone.restitution=0.05" "$zone.friction=1"); done
  # shellcheck disable=SC2086 # many words
  piece "$here/boulders/boulders.py" grid "$results/boulders-grid.csv" $words --every 16 --variant $shapes
  piece "$here/boulders/boulders.py" grid "$results/boulders-corner.csv" "${corner[@]}" --every 4 --variant $shapes
  piece "$here/boulders/boulders.py" rolling "$results/boulders-rolling.csv"
  piece "$here/boulders/boulders.py" ground "$results/boulders-ground.csv" 0.15 0.2 0.25 0.3 --every 16
  compared "$results/boulders-ground.csv" "$results/boulders-ground-compared.csv" "$here/boulders/compare.py" ground
  for part in grid corner; do
    compared "$results/boulders-$part.csv" "$results/boulders-$part-places.csv" "$here/boulders/compare.py" places
    compared "$results/boulders-$part.csv" "$results/boulders-$part-shapes.csv" "$here/boulders/compare.py" shapes
  done
}

drum() {
  [ -s "$results/drum-measured.csv" ] || "$here/drum/drum.py" outlines "$results/drum-measured.csv"
  table "$results/drum-acces.csv" "$here/drum/drum.py" acces
  [ ! -s "$results/drum-30.csv" ] || table "$results/drum-held.csv" "$here/drum/drum.py" held "$results"
  piece "$here/drum/drum.py" sizes "$results/drum-sizes.csv" 6.0 4.5 3.5 --measured "$results/drum-measured.csv"
  fitted drum
  [ -s "$results/drum-fit.csv" ] || return 0
  local rpm friction rolling solid
  friction=$(awk -F, '$2 == "friction" { print $4 }' "$results/drum-fit.csv")
  rolling=$(awk -F, '$2 == "rolling" { print $4 }' "$results/drum-fit.csv")
  solid=$(awk -F, '$2 == "solid" { print $4 }' "$results/drum-fit.csv")
  [ -n "$solid" ] || { echo "drum-fit.csv is of a fit without the powder's volume: remove it, and drum-10.csv to drum-45.csv" >&2; return 1; }
  for rpm in 10 15 30 45; do
    [ -s "$results/drum-$rpm.csv" ] || piece "$here/drum/drum.py" one --rpm $rpm --friction "$friction" --rolling "$rolling" \
      --solid "$solid" --size 3.5 --profile "$results/drum-$rpm.csv"
  done
}

penetration() {
  [ -s "$results/penetration.csv" ] || piece "$here/penetration/penetration.py" run "$results/penetration.csv"
  compared "$results/penetration.csv" "$results/penetration.txt" "$here/penetration/penetration.py" compare
}

orifice() {
  piece "$here/orifice/orifice.py" run "$results/orifice.csv" 5.5:4,6.25:4,7:4,8:2,9:1 scree liggghts liggghts-no-dashpot
  piece "$here/orifice/orifice.py" run "$results/orifice.csv" 5.5:4 yade
  compared "$results/orifice.csv" "$results/orifice-compared.csv" "$here/orifice/orifice.py" compare
}

bulk() {
  local case
  for case in drum silo-large silo-small; do
    piece "$here/bulk/bulk.py" run $case:1 "$results/bulk-$case.csv"
    compared "$results/bulk-$case.csv" "$results/bulk-$case-compared.csv" "$here/bulk/bulk.py" compare $case
  done
}

# heaps NAME SEEDS VARIANT...: a table of codes/NAME.py.
heaps() { piece "$here/codes/$1.py" run "$results/$1.csv" "${@:2}"; }

polyhedra() {
  heaps polyhedra 5 yade
  heaps polyhedra 3 yade-contacts scree:0.7
  heaps polyhedra 2 yade:0.1
  heaps polyhedra 12 scree:0.1
  heaps polyhedra 20 scree
  compared "$results/polyhedra.csv" "$results/polyhedra-compared.csv" "$here/codes/polyhedra.py" compare
  [ -s "$results/polyhedra-slide.csv" ] || table "$results/polyhedra-slide.csv" "$here/codes/polyhedra.py" slide scree yade yade:0.1 yade-contacts
}

clumps() {
  heaps clumps 40 liggghts scree
  heaps clumps 40 lammps
  heaps clumps 4 liggghts-dashpot
  compared "$results/clumps.csv" "$results/clumps-compared.csv" "$here/codes/clumps.py" compare
}

turning() {
  heaps turning 40:3,20:3,10:2 scree liggghts liggghts-no-rolling
  heaps turning 40:3,20:1 liggghts-no-dashpot
  heaps turning 40:3 liggghts-no-sliding
  compared "$results/turning.csv" "$results/turning-compared.csv" "$here/codes/turning.py" compare
  # made by a scree built with rolling_damping_ratio 0 (src/world/state/constants.h)
  compared "$results/turning-bare.csv" "$results/turning-bare-compared.csv" "$here/codes/turning.py" compare
}

rockable() {
  local script=$here/codes/rockable.py
  piece "$script" run "$results/rockable.csv" drop:4 scree rockable rockable-shared scree-0.2
  piece "$script" run "$results/rockable.csv" drum:1,heap:2 scree rockable
  piece "$script" run "$results/rockable.csv" heap:4 scree
  piece "$script" slope "$results/rockable-slope.csv" 32 scree rockable
  compared "$results/rockable.csv" "$results/rockable-compared.csv" "$script" compare
  compared "$results/rockable-slope.csv" "$results/rockable-slope-compared.csv" "$script" places
}

hits() { [ -s "$results/hits.csv" ] || table "$results/hits.csv" "$here/hits/hits.py"; }

impacts() {
  [ -s "$results/impacts-measured.csv" ] || table "$results/impacts-measured.csv" "$here/impacts/impacts.py" measured
  piece "$here/impacts/impacts.py" grid "$results/impacts.csv"
  compared "$results/impacts.csv" "$results/impacts-compared.csv" "$here/impacts/impacts.py" compare
}

paper() {
  local runs=$results/paper-runs.csv
  if [ ! -s "$runs" ] || [ "$(wc -l <"$runs")" -lt 14 ]; then
    piece "$scree" study "$here/paper/study.yaml" -o "$work/paper" --jobs 1
    [ ! -s "$work/paper/study.sqlite" ] || "$here/paper/claims.py" runs "$work/paper" "$runs"
  fi
  table "$results/paper-claims.csv" "$here/paper/claims.py"
}

estimator() {
  piece "$here/estimator/estimator.py" run "$results/estimator.csv" sphere:75:32 sphere:150:60 sphere:300:32 sphere:600:6 box:150:20
  compared "$results/estimator.csv" "$results/estimator-compared.csv" "$here/estimator/estimator.py" compare
}

shape() {
  local tower=$results/shape-tower.csv slope=$results/shape-slope.csv drum=$results/shape-drum.csv scan
  local descriptions=(4x recommended clump1 clump5 0.0625x clump20 0.25x clump50)
  [ -d "${SCREE_DATA_DIR:-$root/../shared/data}" ] || { echo "shape: skipped, there is no folder of scans (SCREE_DATA_DIR)" >&2 && return; }
  for scan in stone device boulder; do
    [ $scan != boulder ] || [ -d "$SCREE_EVIDENCE_DIR/authume" ] || continue
    piece "$here/shape/shape.py" tower "$tower" $scan 2-4 "${descriptions[@]}"
    [ "$stopped" ] && return
    piece "$here/shape/shape.py" slope "$slope" $scan 2-4 "$tower" "${descriptions[@]}"
    piece "$here/shape/shape.py" drum "$drum" $scan 2-4 "$tower" "${descriptions[@]}"
    [ "$stopped" ] && return
  done
  compared "$tower" "$results/shape-compared.csv" "$here/shape/shape.py" compare "$slope" "$drum"
}

for case in "$@"; do
  folder='' needs='' stopped=''
  case $case in
  boulders) folder=authume ;;
  drum) folder=granudrum ;;
  penetration | bulk) folder=bulk needs=LIGGGHTS ;;
  orifice | clumps | turning) needs=LIGGGHTS ;;
  polyhedra) needs=YADE ;;
  rockable) folder=authume needs=ROCKABLE ;;
  impacts) folder=chantsura ;;
  hits | paper | estimator | shape) ;;
  *) echo "run.sh: no case '$case'; there are ${cases[*]}" >&2 && exit 2 ;;
  esac
  program=${needs:+${!needs:-${needs,,}}}
  if [ ! -d "$SCREE_EVIDENCE_DIR/$folder" ] && [ "$folder" ]; then
    echo "$case: skipped, there is no folder $SCREE_EVIDENCE_DIR/$folder (SCREE_EVIDENCE_DIR)" >&2
  elif [ "$program" ] && ! command -v "$program" >/dev/null; then
    echo "$case: skipped, there is no program $program (apt install ${needs,,}; or $needs=PROGRAM)" >&2
  else
    $case
  fi
done
"$here/figures.py"
