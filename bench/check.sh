#!/bin/bash
# check and repair of a scan of 786,864 triangles against admesh reading the same file: CPU seconds of
# one thread's worth of work (user and system) and wall clock, medians of seven alternating runs.
#
#   bench/check.sh [SCREE]          the program; default build/release/bin/scree
#
# `admesh -c` reads and measures, `admesh -e` also matches the facets' edges exactly (which is what
# makes a mesh of them), plain `admesh` looks for what it would repair. Writes results/check.csv.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
scree=${1:-$root/build/release/bin/scree}
export OMP_WAIT_POLICY=passive # threads that wait do not count as work
scan=$work/fp-1.stl
[ -s "$scan" ] || "$scree" sample -q fp-1 -o "$scan"

names=("admesh -c" "admesh -e" "admesh" "scree check --fast" "scree repair --fast, to STL"
  "scree repair --fast, to PLY" "scree check" "scree repair, to STL")
call() {
  case $1 in
  0) admesh -c "$scan" ;;
  1) admesh -e "$scan" ;;
  2) admesh "$scan" ;;
  3) "$scree" check --fast "$scan" ;;
  4) "$scree" repair --fast -f "$scan" -o "$work/repaired.stl" ;;
  5) "$scree" repair --fast -f "$scan" -o "$work/repaired.ply" ;;
  6) "$scree" check "$scan" ;;
  7) "$scree" repair -f "$scan" -o "$work/repaired.stl" ;;
  esac
}

times=$(mktemp)
trap 'rm -f "$times"' EXIT
TIMEFORMAT='%U %S %R'
for round in 1 2 3 4 5 6 7; do
  for i in "${!names[@]}"; do
    [ "$round" -le 3 ] || [ "$i" -lt 6 ] || continue # the slow ones three times
    used=$({ time call "$i" >/dev/null 2>&1; } 2>&1)
    echo "$i $used" >>"$times"
  done
done
csv=$results/check.csv
{
  provenance "bench/check.sh"
  echo 'what,user_s,system_s,wall_s'
  for i in "${!names[@]}"; do
    of() { awk -v i="$i" -v column="$1" '$1 == i { print $column }' "$times" | median; }
    echo "\"${names[$i]}\",$(of 2),$(of 3),$(of 4)"
  done
} >"$csv.part"
mv "$csv.part" "$csv"
cat "$csv"
