#!/bin/bash
# The whole job, from file to choice, against one meshopt_simplify call to Rp = 1e-3 on the same mesh
# already in memory; its memory; its growth with the size of the scan; several files at once.
#
#   bench/job.sh [COUNT...]         sizes of the noisy phone (default 750k, 1.5M, 3M, 6M, 12M triangles)
#
# The phone's noise is the same at every size, so that finer scans are rougher; "even" is a phone whose noise
# shrinks with the spacing, and tells how time grows with the count alone.
#
# Writes results/job.csv. Bars: ratio at most 3 (aim 1), 250 bytes per triangle (aim 150), time over
# N log N that does not grow.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
[ $# -gt 0 ] || set -- 762008 1500000 3000000 6000000 12000000

# Rounds of a measurement: in each the peer and scree run one after the other, so that both see the same
# machine. The row has the median of each, by CPU time, and the medians of the rounds' ratios.
rounds_of() { if [ "$1" -gt 2000000 ]; then echo 1; else echo 5; fi; }
cost() { "$bin/bench_cost" "$@" || true; }

csv=$results/job.csv
{
  provenance "bench/job.sh $*"
  echo 'what,triangles,wall_s,cpu_s,peak_bytes,meshopt_cpu_s,ratio_wall,ratio_cpu,bytes_per_triangle,ns_per_n_log2_n'
  for kind in phone even; do for count in "$@"; do
    file=$(body $kind "$count" stl)
    even=${kind#phone}
    n=$((($(stat -c %s "$file") - 84) / 50))
    for method in meshopt volume qecd; do : >"$work/rounds_$method"; done
    for ((round = 0; round < $(rounds_of "$n"); round++)); do
      peer=$("$bin/peer_meshoptimizer" meshopt "$file" "$work/reference" $((n / 1000)) | cut -d, -f4)
      echo "$peer" >>"$work/rounds_meshopt"
      for method in volume qecd; do
        IFS=, read -r wall cpu peak status < <(cost "$bin/scree" choose -q --method "$method" "$file")
        [ "$status" = 0 ] || echo "scree choose --method $method $file: exit $status" >&2
        echo "$wall,$cpu,$peak,$(ratio "$wall" "$peer"),$(ratio "$cpu" "$peer")" >>"$work/rounds_$method"
      done
    done
    for method in volume qecd; do
      IFS=, read -r wall cpu peak _ < <(median -t, -k2,2 <"$work/rounds_$method")
      awk -v OFS=, -v m="choose $method${even:+ (even)}" -v n="$n" -v w="$wall" -v c="$cpu" -v p="$peak" \
        -v r="$(median <"$work/rounds_meshopt")" -v rw="$(cut -d, -f4 "$work/rounds_$method" | median)" \
        -v rc="$(cut -d, -f5 "$work/rounds_$method" | median)" 'BEGIN { print m, n, w, c, p, r, sprintf("%.2f", rw),
          sprintf("%.2f", rc), sprintf("%.0f", p / n), sprintf("%.1f", 1e9 * c / (n * log(n) / log(2))) }'
    done
  done; done
  # Four files in one call against the sum of four calls.
  n=300000
  for i in 1 2 3 4; do cp "$(body phone $n stl)" "$work/many_$i.stl"; done
  for file in many one; do : >"$work/rounds_$file"; done
  for round in 1 2 3; do
    cost "$bin/scree" choose -q "$work"/many_[1-4].stl >>"$work/rounds_many"
    cost "$bin/scree" choose -q "$work/many_1.stl" >>"$work/rounds_one"
  done
  IFS=, read -r wall cpu peak _ < <(median -t, -k2,2 <"$work/rounds_many")
  IFS=, read -r one one_cpu _ _ < <(median -t, -k2,2 <"$work/rounds_one")
  awk -v OFS=, -v n=$n -v w="$wall" -v c="$cpu" -v p="$peak" -v o="$one" -v oc="$one_cpu" 'BEGIN {
    print "four files at once", 4 * n, w, c, p, "", "", "", sprintf("%.0f", p / (4 * n)), ""
    print "one of them", n, o, oc, "", "", "", "", "", "" }'
  rm -f "$work"/many_[1-4].stl "$work"/rounds_*
} >"$csv.part"
mv "$csv.part" "$csv"
echo "$csv"
