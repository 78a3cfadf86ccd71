#!/usr/bin/env bash
# Pours, none of which may end in an error or leave a body in another.
#
#   [MODE=repose] run.sh SCREE INSIDE SHAPES FIRST_SEED LAST_SEED [OPTIONS]
#
# Each seed pours three shapes of the folder SHAPES: 20 of each by `scree drop`, or with MODE=repose 120 by
# `scree repose -p demo`. INSIDE is the program of inside.c. One line a failure, a count at the end; exit 1
# where any failed, or where more than 1 % of the energy that came in is not accounted for.
scree=$(realpath "$1") inside=$(realpath "$2") first=$4 last=$5
cd "$3" || exit 2
shift 5
shapes=(*.ply *.stl)
for i in "${!shapes[@]}"; do [ -e "${shapes[i]}" ] || unset "shapes[i]"; done
shapes=("${shapes[@]}")
n=${#shapes[@]} bad=0
[ "$n" -gt 0 ] || { echo "no shapes"; exit 2; }
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for ((s = first; s <= last; s++)); do
  a=${shapes[s % n]} b=${shapes[(s * 5 + 1) % n]} c=${shapes[(s * 7 + 3) % n]}
  if [ "${MODE:-drop}" = repose ]; then
    run=(repose "$a" "$b" "$c" -p demo --particles 120)
  else
    run=(drop "$a=20" "$b=20" "$c=20")
  fi
  rm -rf "$out/d"
  if ! "$scree" "${run[@]}" --frames 0 --seed "$s" --no-picture -q -f -o "$out/d" "$@" >"$out/log" 2>&1; then
    what=$(tail -n 1 "$out/log" | cut -c1-200)
  else
    lost=$(sed -n 's/.*unaccounted \([-+0-9.e]*\) of.*/\1/p' "$out/log" "$out"/d/*.txt 2>/dev/null | head -n 1)
    what=
    [ -e "$out/d/last.world" ] && { what=$("$inside" "$out/d/last.world") && what=; }
    awk -v x="${lost:-0}" 'BEGIN { exit !(x > 0.01 || x < -0.01) }' && what="$what unaccounted: $lost"
  fi
  [ -z "$what" ] && continue
  bad=$((bad + 1))
  echo "seed $s $a $b $c: $what"
done
echo "$bad of $((last - first + 1)) pours failed"
[ "$bad" = 0 ]
