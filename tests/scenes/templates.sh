#!/usr/bin/env bash
# Each template of scenes to its end: within 120 s of processor time on one thread, its ledger below 1e-2; and once
# more killed outright three times and gone on with, to the same series and motion.
# usage: templates.sh SCREE [TEMPLATE...]
set -uo pipefail
scree=$(realpath "$1")
shift
[ $# -gt 0 ] || set -- hopper drum tilting-box drawdown hollow-cylinder conveyor vibrating-screen shear-box
cd "$(mktemp -d)" || exit 1
trap 'rm -rf "$PWD"' EXIT
failed=0
export OMP_NUM_THREADS=1

processor_seconds() { (TIMEFORMAT='%U'; time "$@" >out.txt 2>&1) 2>&1; }

for name in "$@"; do
  "$scree" run --template "$name" >scene.yaml
  sed -i -E 's/(frames: )[0-9.]+/\10/; s/(checkpoint: )[0-9.]+/\11/' scene.yaml
  seconds=$(processor_seconds "$scree" run scene.yaml -o whole --no-picture)
  "$scree" run scene.yaml -o cut --no-picture -q >/dev/null 2>&1 &
  for kill in 1 2 3; do
    victim=$!
    sleep $((2 + RANDOM % 5))
    kill -9 $victim 2>/dev/null
    wait $victim 2>/dev/null
    [ $kill -lt 3 ] && { "$scree" run scene.yaml -o cut --resume --no-picture -q >/dev/null 2>&1 & }
  done
  "$scree" run scene.yaml -o cut --resume --no-picture -q >/dev/null 2>&1
  same=differs
  cmp -s whole/series.csv cut/series.csv && cmp -s whole/motion.scree cut/motion.scree && same="the same bits"
  ledger=$(sed -n 's/.*energy unaccounted for: \([^ ]*\) .*/\1/p' out.txt)
  printf '%-17s %6.1f s of processor time, ledger %s, killed three times: %s; %s\n' "$name" "$seconds" "$ledger" "$same" \
    "$(grep -m1 after out.txt)"
  awk -v s="$seconds" -v l="$ledger" 'BEGIN { exit !(s < 120 && l != "" && l < 1e-2 && l > -1e-2) }' || failed=1
  [ "$same" = "the same bits" ] && ! grep -q "^stopped" out.txt || failed=1
  rm -rf whole cut
done
exit $failed
