#!/usr/bin/env bash
# Each template of scenes to its end: within 120 s of processor time on one thread, its ledger below 1e-2; and once
# more killed outright at three random moments and gone on with, to the same series and motion.
# usage: templates.sh SCREE [TEMPLATE...]
set -uo pipefail
scree=$(realpath -e "$1") || exit 1
shift
[ $# -gt 0 ] || set -- hopper drum tilting-box drawdown hollow-cylinder conveyor vibrating-screen shear-box drum-lifters paddle-mixer tumbler hammer-mill shredder transfer-chute belt auger hole-screen
cd "$(mktemp -d)" || exit 1
trap 'rm -rf "$PWD"' EXIT
failed=0
export OMP_NUM_THREADS=1

seconds() { (TIMEFORMAT="$1"; shift; time "$@" >out.txt 2>&1) 2>&1; }
cut_run() { exec "$scree" run scene.yaml -o cut --no-picture -q "$@" >/dev/null 2>&1; }

for name in "$@"; do
  "$scree" run --template "$name" >scene.yaml
  sed -i -E 's/(frames: )[0-9.]+/\10/; s/(checkpoint: )[0-9.]+/\10.05/' scene.yaml
  read -r clock processor < <(seconds '%R %U' "$scree" run scene.yaml -o whole --no-picture -q)
  resume=
  killed=0
  for _ in 1 2 3; do
    cut_run $resume &
    victim=$!
    sleep "$(awk -v t="$clock" -v r=$RANDOM 'BEGIN { print t * r / 32768 / 2 }')"
    kill -9 $victim 2>/dev/null && killed=$((killed + 1))
    wait $victim 2>/dev/null
    resume=--resume
  done
  (cut_run --resume)
  same=differs
  cmp -s whole/series.csv cut/series.csv && cmp -s whole/motion.scree cut/motion.scree && same="the same bits"
  ledger=$(awk -F, 'NR == 2 { for (i = 1; i <= NF; i++) if ($i == "ledger") c = i } END { print $c }' whole/series.csv)
  printf '%-17s %6.1f s of processor time, ledger %s, killed %d times: %s; %s\n' "$name" "$processor" "$ledger" \
    $killed "$same" "$(grep -m1 after out.txt)"
  awk -v s="$processor" -v l="$ledger" 'BEGIN { exit !(s < 120 && l != "" && l < 1e-2 && l > -1e-2) }' || failed=1
  [ "$same" = "the same bits" ] && ! grep -q "^stopped" out.txt || failed=1
  rm -rf whole cut
done
exit $failed
