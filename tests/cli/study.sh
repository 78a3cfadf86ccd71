cat >tiny.yaml <<'YAML'
name: tiny
replicates: 2
shapes: [sample:icosphere-1]
base:
  preset: demo
  particles: 8
  cylinder: {diameter: 0.4}
  phases: {pack_time: 0.3, settle_time: 0.05, lift_speed: 1, lift_time: 0.3, hold_time: 0.05}
factors:
  friction_all: [0.2, 0.5]
  rp: [spheres]
YAML
hashes() { sqlite3 "$1/study.sqlite" "SELECT run, state, hash FROM run ORDER BY run"; }
run study tiny.yaml --dry-run
# the whole; times are the machine's
run study tiny.yaml -o whole -v --jobs 2 2>/dev/null | sed 's/  *[0-9.e-]*$//'
ls whole
hashes whole >whole.txt
# -f begins anew: another file may have the folder, and what is not a study's stays
sed 's/friction_all: .*/friction_all: [0.3]/; s/replicates: 2/replicates: 1/' tiny.yaml >other.yaml
cp -r whole again && touch again/results/old.yaml again/notes
run study other.yaml -o again -f --jobs 1 2>/dev/null >/dev/null && hashes again | wc -l && ls again | grep notes && ls again/results | wc -l
run study other.yaml -o again -f --worker 2>&1 | lines 2
# what is wrong with another one costs no earlier run
hashes again >before.txt
sed 's/^shapes:.*/shapes: [none.ply]/' other.yaml >none.yaml
run study none.yaml -o again -f
hashes again | cmp - before.txt && cmp other.yaml again/study.yaml && ls -A again/runs again/shapes | wc -l && ls -A again | grep earlier
# a worker killed in the middle, two processes after it, then a look at it
"$SCREE" study tiny.yaml -o parts --worker --no-wait &
worker=$!
while kill -0 $worker 2>/dev/null && ! ls parts/leases/run-* >/dev/null 2>&1; do sleep 0.02; done
kill -9 $worker 2>/dev/null
wait $worker 2>/dev/null
"$SCREE" study tiny.yaml -o parts --worker &
second=$!
run study tiny.yaml -o parts --jobs 1 >/dev/null
wait $second || echo "the second worker failed"
hashes parts | cmp - whole.txt
run study status parts --csv | cut -d, -f1-8
run study status parts --json | sed -n '/"runs"/{p;q}'
# a job array, whose task runs without Slurm too
run study tiny.yaml -o array --slurm --dry-run --tasks 3 | sed 's/[^ `]*\(study.sbatch\)/\1/g'
grep -c '^#SBATCH' array/study.sbatch
grep array= array/study.sbatch
sh array/study.sbatch
"$SCREE" study status array >/dev/null
hashes array | cmp - whole.txt
# ranks as workers, one of them killed; the same command ends it
if command -v mpirun >/dev/null; then
  ranks() {
    OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
      mpirun --oversubscribe -n 2 "$SCREE" study tiny.yaml -o ranks "$@" >ranks.txt 2>&1
  }
  ranks &
  job=$!
  while kill -0 $job 2>/dev/null && ! ls ranks/leases/run-* >/dev/null 2>&1; do sleep 0.02; done
  rank=$(sed -n 3p ranks/leases/run-* 2>/dev/null | head -1)
  [ -z "$rank" ] || kill -9 "$rank" 2>/dev/null
  wait $job 2>/dev/null
  ranks || cat ranks.txt
  hashes ranks | cmp - whole.txt
fi
# what is wrong is said
printf 'shapes: [sample:box]\nfactors: {rp: [7]}\n' >bad.yaml
run study bad.yaml
run study missing.yaml
run study status nowhere
run study status 2>&1 | lines 2
run study tiny.yaml other.yaml 2>&1 | lines 2
run study tiny.yaml --json --csv 2>&1 | lines 2
echo "no database" >whole/study.sqlite
run study tiny.yaml -o whole
rm whole/study.sqlite
run study tiny.yaml -o whole --csv | cut -d, -f1-4
# no room for a record
(
  ulimit -f 4
  trap '' XFSZ
  "$SCREE" study tiny.yaml -o full --jobs 1 >full.txt 2>&1
)
grep -v '^scree, after ' full.txt | head -1 | sed 's/[0-9a-f]\{16\}/KEY/; s/[a-z]*\.scree/FILE/'
"$SCREE" study tiny.yaml -o full >/dev/null
hashes full | cmp - whole.txt
# a run again from the scan, and from the shape that the study wrote in metres: the same bits
"$SCREE" sample icosphere-4 -o round.stl -q >/dev/null
cat >one.yaml <<'END'
name: one
replicates: 1
shapes: [round.stl]
base: {preset: demo, particles: 6, cylinder: {diameter: 0.2}, phases: {pack_time: 0.2, settle_time: 0.05, lift_speed: 1, lift_time: 0.05, hold_time: 0.05}}
factors: {rp: [0.02]}
END
"$SCREE" study one.yaml -o one --jobs 1 -q >/dev/null
once="-p demo --particles 6 --cylinder 0.2 --pack-time 0.2 --settle-time 0.05 --lift-speed 1 --lift-time 0.05 --hold-time 0.05 --seed 1 --no-picture --json -q"
"$SCREE" repose round.stl --rp 0.02 $once | grep -v '"command"\|"file"\|_seconds"\|"next"\|"name"\|"family"\|"source"' >scan.json
"$SCREE" repose one/shapes/round-rp0.02.ply --unit m $once | grep -v '"command"\|"file"\|_seconds"\|"next"\|"name"\|"family"\|"source"' >written.json
diff scan.json written.json
grep -c height scan.json
# of shapes that are not decimated yet nothing is said to be known
mkdir -p early/leases early/runs early/shapes
printf 'name: early\nreplicates: 2\nshapes: [sample:icosphere-3]\nbase: {preset: demo}\nfactors: {rp: [1e-2, 1e-1]}\n' >early/study.yaml
run study status early -v 2>/dev/null
# studies of commands: {here}, replicates that would be alike, a failure with what the command said
printf '#!/bin/sh\nawk -v a="$1" -v s="$2" '"'BEGIN { srand(s); printf \"y: %%.6g\\\\n\", 10 * a + rand() }'\n" >model.sh
printf '#!/bin/sh\necho "no such grain" >&2\nexit 3\n' >fails.sh
chmod +x model.sh fails.sh
printf 'base: {command: ["{here}/model.sh", "{a}", "{seed}"], timeout: 20}\nfactors: {a: [1, 2, 3]}\nanswers: [y]\nreplicates: 4\n' >command.yaml
run study command.yaml -o command -q --jobs 1 | sed -E 's/\(\+[0-9.]+ \+- [0-9.]+\)/(+N +- N)/; s/from [0-9.]+ to [0-9.]+/from N to N/; s/runs, .* of a/runs, N of a/'
sed 's/, "{seed}"//' command.yaml >alike.yaml
run study alike.yaml
sed -i '/replicates/d' alike.yaml
run study alike.yaml -o alike -q --jobs 1 | tail -1
sed 's/model.sh/fails.sh/' command.yaml >fails.yaml
run study fails.yaml -o fails -q --jobs 1
