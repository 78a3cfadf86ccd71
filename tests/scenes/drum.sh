#!/usr/bin/env bash
# The surface of the drum template over seeds: the mean angle from 4 s on, after its first turn. A seed's mean over 6 s has
# a standard error of about half a degree (docs/background/verification.md). That of the mean of the three stays below 1
# degree, and the mean between 15 and 25.
# usage: drum.sh SCREE
set -euo pipefail
scree=$(realpath -e "$1")
cd "$(mktemp -d)"
trap 'rm -rf "$PWD"' EXIT
export OMP_NUM_THREADS=1
"$scree" run --template drum >drum.yaml
for seed in 1 2 3; do
  "$scree" run drum.yaml --set seed=$seed --set time=10 --set output.frames=0 -o "$seed" --no-picture -q >/dev/null
  awk -F, -v seed=$seed 'NR == 2 { for (i = 1; i <= NF; i++) { if ($i ~ /^time /) t = i; if ($i ~ /^surface.angle/) c = i } }
    NR > 2 && $t >= 4 { sum += $c; n++ } END { printf "%d %.3f\n", seed, sum / n }' "$seed/series.csv" | tee -a angles
done
awk '{ if (NR == 1 || $2 < low) low = $2; if (NR == 1 || $2 > high) high = $2; sum += $2; squares += $2 * $2 }
  END { mean = sum / NR; error = sqrt((squares / NR - mean * mean) / (NR - 1))
    printf "angles differ by %.2f degrees; mean %.2f, standard error %.2f\n", high - low, mean, error
    exit !(error < 1 && mean > 15 && mean < 25) }' angles
