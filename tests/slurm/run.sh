#!/bin/sh
# A study under Slurm for real: munged, slurmctld and slurmd of our own on this machine, `scree study --slurm`
# submits, one worker is killed in the middle, and the numbers are those of a study without Slurm.
# Skipped (77) where Slurm is not installed. usage: run.sh PROGRAM
set -u
SCREE=$1
for tool in munged slurmctld slurmd sbatch squeue sqlite3; do
  command -v $tool >/dev/null || PATH=$PATH:/usr/sbin
  command -v $tool >/dev/null || {
    echo "skipped: no $tool"
    exit 77
  }
done
folder=$(mktemp -d)
daemons=
trap 'for pid in $daemons; do kill "$pid" 2>/dev/null; done; sleep 1; rm -rf "$folder"' EXIT
cd "$folder" || exit 1
fail() {
  echo "FAILED: $*"
  tail -n 20 ./*.log slurm-study/*.out 2>/dev/null
  exit 1
}
# `wait_until SECONDS COMMAND...`
wait_until() {
  left=$(($1 * 5))
  shift
  while [ $left -gt 0 ]; do
    "$@" >/dev/null 2>&1 && return 0
    sleep 0.2
    left=$((left - 1))
  done
  return 1
}

# ---- a cluster of one machine ----

host=$(hostname -s)
port=$((20000 + $$ % 20000))
mkdir state spool munge
chmod 755 "$folder"
chmod 700 munge
head -c 1024 /dev/urandom >munge/key
chmod 600 munge/key
munged --foreground --force --key-file="$folder/munge/key" --socket="$folder/munge.socket" --num-threads=2 \
  --pid-file="$folder/munge/pid" --seed-file="$folder/munge/seed" 2>munged.log &
daemons=$!
cat >slurm.conf <<END
ClusterName=scree
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
SlurmctldPort=$port
SlurmdPort=$((port + 1))
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=batch_sched_delay=0,sched_interval=2
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP OverSubscribe=FORCE:4
END
SLURM_CONF=$folder/slurm.conf
export SLURM_CONF
wait_until 20 test -S munge.socket || fail "munged does not start"
slurmctld -D -f "$SLURM_CONF" >slurmctld.log 2>&1 &
daemons="$daemons $!"
slurmd -D -f "$SLURM_CONF" >slurmd.log 2>&1 &
daemons="$daemons $!"
is_idle() { sinfo -h -o %T | grep -q '^\(idle\|mixed\)$'; }
wait_until 60 is_idle || fail "no node becomes idle"

# ---- the study ----

cat >tiny.yaml <<'END'
name: tiny
replicates: 2
shapes: [sample:icosphere-1]
base:
  preset: demo
  particles: 40
  cylinder: {diameter: 0.4}
  contact: {steps: 60}
  phases: {pack_time: 1, settle_time: 0.3, lift_speed: 0.5, lift_time: 0.5, hold_time: 0.2, still_energy: 0}
  output: {checkpoint_interval: 0.05}
factors:
  friction_all: [0.2, 0.5]
  rp: [spheres]
END
hashes() { sqlite3 "$1/study.sqlite" "SELECT run, state, hash FROM run ORDER BY run"; }
"$SCREE" study tiny.yaml -o whole --jobs 2 >/dev/null || fail "the study without Slurm"
hashes whole >whole.txt
"$SCREE" study tiny.yaml -o slurm-study --slurm --tasks 2 || fail "submitting"
begun() { ls slurm-study/runs/*/checkpoint.scree; }
wait_until 60 begun || fail "no run begins: $(squeue)"
run=$(begun | head -n 1 | cut -d/ -f3)
victim=$(sed -n 3p "slurm-study/leases/run-$run")
kill -9 "$victim" || fail "no worker of the run begun to kill"
echo "killed one worker of $(squeue -h -r | wc -l) tasks"
is_over() { [ -z "$(squeue -h)" ]; }
wait_until 300 is_over || fail "the array does not end: $(squeue)"
"$SCREE" study status slurm-study >status.txt || fail "no status"
cat status.txt
hashes slurm-study | cmp - whole.txt || fail "other numbers than without Slurm"
grep -q done whole.txt || fail "no run is done"
[ "$(sqlite3 slurm-study/study.sqlite "SELECT piece_count FROM run WHERE key = '$run'")" = 2 ] ||
  fail "the run whose worker died was not gone on with"
echo "the same numbers"
