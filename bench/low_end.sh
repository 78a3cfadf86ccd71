#!/bin/bash
# Few triangles: `scree simplify`, with the fit and without, beside one run of CGAL's Lindstrom-Turk to each count.
#
#   SCREE_DATA_DIR=<folder of scans> bench/low_end.sh [COUNT...]
#
# Judged against the scan as it was handed in; without counts: 100, 200, 500. Writes results/low_end.csv, whose
# last lines are geometric means over the scans of LT's mean and Hausdorff distance over scree's.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
counts=("$@")
[ ${#counts[@]} -gt 0 ] || counts=(100 200 500)
scans="organic_scorpion_100k.obj scan_hammer_raw.obj scan_nefertiti_70k.obj scan_turbineblade.ply stone_073ac.ply
  weee_cam1.ply weee_flip2.ply weee_slab2.ply"
level=$work/low_end.ply

# judge FILE METHOD COUNT LEVEL: a row.
judge() {
  "$bin/bench_quality" "$1" "$4" | awk -F, -v OFS=, -v file="$(basename "$1")" -v method="$2" -v asked="$3" \
    '{ print file, method, asked, $2, ($5 + $6) / 2, $7, $9, $10 }'
}

rows() {
  for scan in $scans; do
    file=$data/$scan
    for count in "${counts[@]}"; do
      # as if in metres: coordinates stay what they are
      "$bin/scree" simplify --unit m -q -f -n "$count" -o "$level" "$file" >/dev/null
      judge "$file" scree "$count" "$level"
      "$bin/scree" simplify --unit m -q -f -n "$count" --fit -o "$level" "$file" >/dev/null
      judge "$file" scree,fit "$count" "$level" | sed 's/scree,fit/scree fit/'
    done
    "$bin/peer_cgal" cgal_lt "$file" "$work/low_end" "${counts[@]}" | while IFS=, read -r _ asked _ _ _ found; do
      judge "$file" LT "$asked" "$found"
    done
  done
}
rows >"$work/low_end.rows"
{
  provenance "bench/low_end.sh ${counts[*]}"
  echo 'file,method,asked,triangles,mean,hausdorff,worst_fold_deg,crossings'
  cat "$work/low_end.rows"
  awk -F, -v OFS=, '
    { mean[$1, $3, $2] = $5; far[$1, $3, $2] = $6; crossings[$3, $2] += $8; file[$1]; count[$3] }
    END {
      for (c in count)
        for (k = 1; k <= 2; k++) {
          method = k == 1 ? "scree" : "scree fit"; m = h = n = 0
          for (f in file) {
            m += log(mean[f, c, "LT"] / mean[f, c, method]); h += log(far[f, c, "LT"] / far[f, c, method]); n++
          }
          printf "LT over %s at %d: mean %.3f, Hausdorff %.2f, crossings %d and %d\n", method, c, exp(m / n), exp(h / n),
            crossings[c, "LT"], crossings[c, method] | "sort -t\" \" -k5n"
        }
    }' "$work/low_end.rows" | sed 's/^/# /'
} >"$results/low_end.csv"
