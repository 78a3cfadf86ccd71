# Read by the bench scripts: where things lie, and the lines every result begins with.
bench_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(dirname "$bench_dir")
build=${SCREE_BENCH_BUILD:-$root/build/bench}
bin=$build/bin
work=${SCREE_BENCH_WORK:-$build/work}
results=${SCREE_BENCH_RESULTS:-$bench_dir/results}
data=${SCREE_DATA_DIR:-}
mkdir -p "$work" "$results"
export LC_ALL=C

# provenance COMMAND: comment lines that let anybody run it again.
provenance() {
  local changed=
  git -C "$root" diff --quiet HEAD 2>/dev/null || changed=', changed since'
  echo "# scree $(cat "$root/VERSION"), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || cat "$root/.commit")$changed"
  echo "# machine: $(lscpu | sed -n 's/^Model name: *//p' | head -1), $(nproc) processors, $(
    awk '/MemTotal/ { printf "%.0f GiB", $2 / 1048576 }' /proc/meminfo), $(uname -sm)"
  echo "# load before the run: $(cut -d' ' -f1-3 /proc/loadavg)"
  echo "# command: $1"
}

# body KIND COUNT EXTENSION: the path of a test body, made on first use.
body() {
  local path=$work/$1_$2.$3
  [ -s "$path" ] || "$bin/bench_shape" "$1" "$2" "$path" >&2 || exit 1
  echo "$path"
}

# facets FILE: how many triangles scree reads from it.
facets() { "$bin/bench_quality" "$1" - 2>/dev/null | cut -d, -f2; }

# median [SORT OPTION...]: of the lines on stdin, the one whose number, or field (-t, -kN,N), is the median.
median() { sort -g "$@" | awk '{ line[NR] = $0 } END { print line[int((NR + 1) / 2)] }'; }

# ratio A B: A over B.
ratio() { awk -v a="$1" -v b="$2" 'BEGIN { if (b > 0) printf "%.4f\n", a / b }'; }
