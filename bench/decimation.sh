#!/bin/bash
# Quality and speed of decimation: scree and its peers on the same files in one run.
#
#   bench/decimation.sh [FILE...]
#
# Without files: the noisy phone of 762,008 triangles, the flat cube upright and turned, the nine samples, and
# the scans of SCREE_DATA_DIR where it is set. Levels at Rp 1e-1 ... 1e-5; SCREE_BENCH_PEERS names the peers to
# run (default: all that are built). Writes results/decimation.csv and results/decimation.md.
# meshoptimizer of today, where Debian's is older, runs after
#   npm install --prefix build/bench/node meshoptimizer
set -euo pipefail
. "$(dirname "$0")/lib.sh"

scans="weee_flip2.ply weee_cam1.ply weee_slab2.ply scan_turbineblade.ply scan_nefertiti_70k.obj
  organic_scorpion_100k.obj stone_073ac.ply scan_hammer_raw.obj rock_complexshape.stl"
peers=${SCREE_BENCH_PEERS:-meshopt meshopt_chained meshopt_today meshopt_today_chained cgal_lt cgal_gh
  openmesh vtk}

# program PEER: the program that holds it; empty where it is not built.
program() {
  case $1 in
    meshopt | meshopt_chained) echo "$bin/peer_meshoptimizer" ;;
    cgal_*) echo "$bin/peer_cgal" ;;
    *) echo "$bin/peer_$1" ;;
  esac
}

# counts COUNT: the five levels, truncated as MeshLab does; none below a tetrahedron.
counts() {
  awk -v n="$1" 'BEGIN { for (r = 10; r <= 1e5; r *= 10) if (n / r >= 4) print int(n / r + 1e-9) }'
}

# steps COUNT: all 17 levels of the chained peers, four per decade.
steps() {
  awk -v n="$1" 'BEGIN { for (i = 4; i <= 20; i++) if (n >= 4 * 10 ^ (i / 4)) print int(n * 10 ^ (-i / 4) + 1e-6) }'
}

# run_peer PEER FILE COUNT: CSV lines peer,asked,got,cpu,peak,level on stdout.
run_peer() {
  local peer=$1 file=$2 count=$3 name prefix
  name=$(basename "${file%.*}")
  prefix=$work/${name}_$peer
  case $peer in
    volume | qecd) "$bin/bench_levels" "$peer" "$file" "$prefix" $(counts "$count") ;;
    meshopt_today*)
      [ -d "$build/node/node_modules/meshoptimizer" ] || return 0
      cp "$bench_dir/peers/meshoptimizer.mjs" "$build/node/"
      "$bin/bench_convert" "$file" "$work/$name.exchange.ply" || return 0
      node "$build/node/meshoptimizer.mjs" "$peer" "$work/$name.exchange.ply" "$prefix" \
        $([ "$peer" = meshopt_today ] && counts "$count" || steps "$count") ;;
    *)
      [ -x "$(program "$peer")" ] || return 0
      timeout 3600 "$(program "$peer")" "$peer" "$file" "$prefix" \
        $([ "$peer" = meshopt_chained ] && steps "$count" || counts "$count") ;;
  esac
}

judge_file() {
  local file=$1 count name reference
  count=$(facets "$file")
  name=$(basename "${file%.*}")
  echo "$name: $count triangles" >&2
  "$bin/bench_quality" "$file" - | awk -F, -v OFS=, -v name="$name" -v n="$count" \
    '{ $1 = ""; print name, "scan", n, $2, "", "", "" substr($0, length($2) + 2) }'
  reference=$("$bin/peer_meshoptimizer" meshopt "$file" "$work/reference" $((count / 1000)) |
    cut -d, -f4) || reference=
  for peer in volume qecd $peers; do
    echo "  $peer" >&2
    { run_peer "$peer" "$file" "$count" || true; } | while IFS=, read -r who asked got cpu peak level; do
      counts "$count" | grep -qx "$asked" || { rm -f "$level"; continue; }
      "$bin/bench_quality" "$file" "$level" | awk -F, -v OFS=, -v name="$name" -v peer="$who" \
        -v asked="$asked" -v cpu="$cpu" -v ref="$reference" -v peak="$peak" -v n="$count" \
        '{ line = $0; sub(/^[^,]*,[^,]*/, "", line)
           print name, peer, asked, $2, cpu, (ref > 0 ? sprintf("%.2f", cpu / ref) : ""),
                 (peak > 0 ? sprintf("%.0f", peak / n) : "") line }'
      rm -f "$level"
    done
  done
}

files=("$@")
if [ $# -eq 0 ]; then
  files=("$(body phone 762008 ply)" "$(body cube 786432 ply)" "$(body turned 786432 ply)")
  "$bin/scree" sample -q -f -o "$work" all
  for sample in fp-1 fp-2 fp-3 dc-1 dc-2 dc-3 sp-1 sp-2 sp-3; do files+=("$work/$sample.stl"); done
  for scan in $scans; do
    if [ -n "$data" ] && [ -e "$data/$scan" ]; then files+=("$data/$scan"); fi
  done
fi
csv=$results/decimation.csv
{
  provenance "bench/decimation.sh $(for f in "$@"; do basename "$f"; done | tr '\n' ' ')"
  echo 'file,method,asked,triangles,cpu_s,ratio,bytes_per_triangle,eps_s,eps_v,mean,mean_back,hausdorff,folds,worst_fold_deg,crossings,nonmanifold_edges,nonmanifold_vertices,boundary_edges,degenerate'
  for file in "${files[@]}"; do judge_file "$file"; done
} >"$csv.part"
mv "$csv.part" "$csv"
{
  awk -f "$bench_dir/decimation/table.awk" "$csv"
  awk -f "$bench_dir/decimation/bars.awk" "$csv"
} >"$results/decimation.md"
echo "$csv" "$results/decimation.md"
