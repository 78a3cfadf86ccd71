#!/bin/bash
# Evidence: cases beside measurements and other codes, docs/background/evidence.md.
#   bench/evidence/run.sh [CASE...]     boulders, drum, penetration, orifice, bulk, polyhedra, clumps, turning, paper; all without a name
# Each piece goes on where it was broken off; what is done is not done again (delete its table in results/ to repeat it).
# SCREE_EVIDENCE_DIR names the folder of measurements (default ../shared/evidence); a case without its folder is skipped.
# One process at a time: nice -n 15 bench/evidence/run.sh runs beside other work. Some hours of one core in all.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
export SCREE_EVIDENCE_DIR=${SCREE_EVIDENCE_DIR:-$root/../shared/evidence}
scree=${SCREE:-$root/build/release/bin/scree}
work=${SCREE_EVIDENCE_WORK:-$root/build/evidence}
results=$here/results
shapes=recommended,4x,0.25x,0.0625x,sphere,clump5,clump20,clump50
mkdir -p "$work" "$results"
[ $# -gt 0 ] || set -- boulders drum penetration orifice bulk polyhedra clumps turning paper

# fitted CASE: its calibration and both tables of it.
fitted() {
  [ -s "$results/$1-fit.csv" ] && return
  "$scree" calibrate "$here/$1/fit.yaml" -o "$work/$1-fit" --jobs 1 -j 1
  "$here/fit_table.py" "$work/$1-fit" "$results/$1-fit.csv" "$results/$1-runs.csv"
}

boulders() {
  [ -s "$results/boulders-measured.csv" ] || "$here/boulders/boulders.py" measured >"$results/boulders-measured.csv"
  [ -s "$results/boulders-used.csv" ] || "$here/boulders/boulders.py" used --variant $shapes >"$results/boulders-used.csv"
  fitted boulders
  local words corner=() zone table
  words=$("$here/boulders/boulders.py" fitted "$results/boulders-fit.csv")
  for zone in blue gray red; do corner+=("$zone.restitution=0.05" "$zone.friction=1"); done
  # shellcheck disable=SC2086 # many words
  "$here/boulders/boulders.py" grid "$results/boulders-grid.csv" $words --every 16 --variant $shapes
  "$here/boulders/boulders.py" grid "$results/boulders-corner.csv" "${corner[@]}" --every 4 --variant $shapes
  "$here/boulders/boulders.py" rolling "$results/boulders-rolling.csv"
  for table in grid corner; do
    "$here/boulders/compare.py" places "$results/boulders-$table.csv" "$results/boulders-$table-places.csv"
    "$here/boulders/compare.py" shapes "$results/boulders-$table.csv" "$results/boulders-$table-shapes.csv"
  done
}

drum() {
  "$here/drum/drum.py" outlines "$results/drum-measured.csv"
  "$here/drum/drum.py" acces >"$results/drum-acces.csv"
  "$here/drum/drum.py" sizes "$results/drum-sizes.csv" 6.0 4.5 3.5 --measured "$results/drum-measured.csv"
  fitted drum
  local rpm friction rolling solid
  friction=$(awk -F, '$2 == "friction" { print $4 }' "$results/drum-fit.csv")
  rolling=$(awk -F, '$2 == "rolling" { print $4 }' "$results/drum-fit.csv")
  solid=$(awk -F, '$2 == "solid" { print $4 }' "$results/drum-fit.csv")
  [ -n "$solid" ] || { echo "drum-fit.csv is of a fit without the powder's volume: remove it, and drum-10.csv to drum-45.csv" >&2; return 1; }
  for rpm in 10 15 30 45; do
    [ -s "$results/drum-$rpm.csv" ] || "$here/drum/drum.py" one --rpm $rpm --friction "$friction" --rolling "$rolling" \
      --solid "$solid" --size 3.5 --profile "$results/drum-$rpm.csv"
  done
}

penetration() {
  [ -s "$results/penetration.csv" ] || "$here/penetration/penetration.py" run "$results/penetration.csv"
  "$here/penetration/penetration.py" compare "$results/penetration.csv" >"$results/penetration.txt"
}

orifice() {
  "$here/orifice/orifice.py" run "$results/orifice.csv" 5.5:4,6.25:4,7:4,8:2,9:1 scree liggghts liggghts-no-dashpot
  "$here/orifice/orifice.py" compare "$results/orifice.csv" >"$results/orifice-compared.csv"
}

bulk() {
  local case
  for case in drum silo-large silo-small; do
    "$here/bulk/bulk.py" run $case:1 "$results/bulk-$case.csv"
    [ ! -s "$results/bulk-$case.csv" ] || "$here/bulk/bulk.py" compare $case "$results/bulk-$case.csv" >"$results/bulk-$case-compared.csv"
  done
}

# heaps NAME SEEDS VARIANT...: tables of codes/NAME.py; without its other code nothing is there to compare.
heaps() {
  "$here/codes/$1.py" run "$results/$1.csv" "${@:2}"
  [ ! -s "$results/$1.csv" ] || "$here/codes/$1.py" compare "$results/$1.csv" >"$results/$1-compared.csv"
}

polyhedra() {
  heaps polyhedra 3 yade yade-contacts scree:0.7
  heaps polyhedra 2 yade:0.1
  heaps polyhedra 12 scree:0.1
  heaps polyhedra 20 scree
  [ -s "$results/polyhedra-slide.csv" ] || ! command -v "${YADE:-yade}" >/dev/null ||
    "$here/codes/polyhedra.py" slide scree yade yade:0.1 yade-contacts >"$results/polyhedra-slide.csv"
}

clumps() {
  heaps clumps 10 liggghts scree
  heaps clumps 4 liggghts-dashpot
}

turning() {
  "$here/codes/turning.py" run "$results/turning.csv" 40:3,20:3,10:2 scree liggghts
  "$here/codes/turning.py" run "$results/turning.csv" 40:3,20:1 liggghts-no-dashpot
  "$here/codes/turning.py" run "$results/turning.csv" 40:3 liggghts-no-sliding liggghts-no-rolling
  [ ! -s "$results/turning.csv" ] || "$here/codes/turning.py" compare "$results/turning.csv" >"$results/turning-compared.csv"
}

paper() { "$here/paper/claims.py" >"$results/paper-claims.csv"; }

for case in "$@"; do
  case $case in
  boulders) folder=authume ;;
  drum) folder=granudrum ;;
  penetration | bulk) folder=bulk ;;
  orifice | polyhedra | clumps | turning | paper) folder= ;; # nothing measured
  *) echo "run.sh: no case '$case'; there are boulders, drum, penetration, orifice, bulk, polyhedra, clumps, turning and paper" >&2 && exit 2 ;;
  esac
  if [ -z "$folder" ] || [ -d "$SCREE_EVIDENCE_DIR/$folder" ]; then $case; else echo "$case: skipped, there is no folder $SCREE_EVIDENCE_DIR/$folder"; fi
done
"$here/figures.py"
