#!/bin/bash
# The whole job, from file to choice, against one meshopt_simplify call to Rp = 1e-3 on the same mesh
# already in memory; its memory; its growth with the size of the scan; several files at once.
#
#   bench/job.sh [COUNT...]         sizes of the noisy phone (default 750k, 1.5M, 3M, 6M, 12M triangles)
#
# Writes results/job.csv. Bars: ratio at most 3 (aim 1), 250 bytes per triangle (aim 150), time over
# N log N that does not grow.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
[ $# -gt 0 ] || set -- 762008 1500000 3000000 6000000 12000000

# Median by CPU time, of three runs up to two million triangles, else of the one run.
runs_of() { if [ "$1" -gt 2000000 ]; then echo 1; else echo 3; fi; }
cost() {
  local i runs=$1
  shift
  for ((i = 0; i < runs; i++)); do "$bin/bench_cost" "$@" || true; done |
    sort -t, -k2,2n | sed -n "$(((runs + 1) / 2))p"
}

csv=$results/job.csv
{
  provenance "bench/job.sh $*"
  echo 'what,triangles,wall_s,cpu_s,peak_bytes,meshopt_cpu_s,ratio_wall,ratio_cpu,bytes_per_triangle,ns_per_n_log2_n'
  for count in "$@"; do
    file=$(body phone "$count" stl)
    n=$((($(stat -c %s "$file") - 84) / 50))
    reference=$(for _ in 1 2 3; do
      "$bin/peer_meshoptimizer" meshopt "$file" "$work/reference" $((n / 1000)) | cut -d, -f4
    done | sort -n | sed -n 2p)
    for method in volume qecd; do
      IFS=, read -r wall cpu peak status < <(cost "$(runs_of "$n")" "$bin/scree" choose -q --method "$method" "$file")
      [ "$status" = 0 ] || echo "scree choose --method $method $file: exit $status" >&2
      awk -v OFS=, -v m="choose $method" -v n="$n" -v w="$wall" -v c="$cpu" -v p="$peak" \
        -v r="$reference" 'BEGIN { print m, n, w, c, p, r, sprintf("%.2f", w / r),
          sprintf("%.2f", c / r), sprintf("%.0f", p / n), sprintf("%.1f", 1e9 * c / (n * log(n) / log(2))) }'
    done
  done
  # Four files in one call against the sum of four calls.
  n=300000
  for i in 1 2 3 4; do cp "$(body phone $n stl)" "$work/many_$i.stl"; done
  IFS=, read -r wall cpu peak _ < <(cost 3 "$bin/scree" choose -q "$work"/many_[1-4].stl)
  IFS=, read -r one one_cpu _ _ < <(cost 3 "$bin/scree" choose -q "$work/many_1.stl")
  awk -v OFS=, -v n=$n -v w="$wall" -v c="$cpu" -v p="$peak" -v o="$one" -v oc="$one_cpu" 'BEGIN {
    print "four files at once", 4 * n, w, c, p, "", "", "", sprintf("%.0f", p / (4 * n)), ""
    print "one of them", n, o, oc, "", "", "", "", "", "" }'
  rm -f "$work"/many_[1-4].stl
} >"$csv.part"
mv "$csv.part" "$csv"
echo "$csv"
