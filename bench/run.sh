#!/bin/bash
# Builds and runs every bench of decimation and of the whole job; results go to bench/results/.
#
#   [SCREE_DATA_DIR=folder of scans] bench/run.sh
#
# Peers come from Debian (apt-get install libmeshoptimizer-dev libcgal-dev libeigen3-dev
# libopenmesh-dev libvtk9-dev) and are left out by name where they are not installed. About 50 minutes
# on a quiet machine with all of them; SCREE_BENCH_PEERS="meshopt cgal_lt" takes fewer.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
cmake -S "$root" --preset release -B "$build" -DSCREE_BENCH=ON -DBUILD_TESTING=OFF >/dev/null
cmake --build "$build" ${SCREE_BENCH_JOBS:+-j "$SCREE_BENCH_JOBS"}
"$bench_dir/job.sh"
"$bench_dir/decimation.sh"
