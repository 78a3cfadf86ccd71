# Runs killed outright in every phase, and gone on with: what they write in the end is what an
# uninterrupted run writes, but for the costs. A phase takes longer than the interval of checkpoints.
box 20 12 6 >box.off
cat >pot.yaml <<'END'
particles: 12
cylinder: {diameter: 0.08}
disc: {diameter: 0.3}
phases: {pack_time: 0.8, settle_time: 0.8, lift_speed: 0.2, lift_time: 0.8, hold_time: 0.8,
         drop_height: 0.01, still_energy: 0}
contact: {young_particle: 1e7, steps: 60}
output: {checkpoint_interval: 0.01, series_interval: 0.05, angle_interval: 0.5}
END
cat >pots.yaml <<'END'
name: pots
unit: mm
replicates: 1
attempts: 50
shapes: [box.off]
base:
  particles: 12
  cylinder: {diameter: 0.08}
  disc: {diameter: 0.3}
  phases: {pack_time: 0.8, settle_time: 0.8, lift_speed: 0.2, lift_time: 0.8, hold_time: 0.8,
           drop_height: 0.01, still_energy: 0}
  contact: {young_particle: 1e7, steps: 60}
  output: {checkpoint_interval: 0.01, series_interval: 0.05, angle_interval: 0.5}
factors:
  friction_all: [0.5]
END
phases="pack settle lift hold"

# `cut_short PHASE CHECKPOINT WORDS...`: starts scree WORDS and kills it once its checkpoint is in the phase.
cut_short() {
  phase=$1
  checkpoint=$2
  shift 2
  "$SCREE" "$@" >cut.txt 2>&1 &
  victim=$!
  while kill -0 $victim 2>/dev/null; do
    case $("$SCREE" pile $checkpoint 2>/dev/null) in
    $phase*)
      kill -9 $victim && echo "killed in $phase"
      break
      ;;
    esac
  done
  wait $victim 2>/dev/null
}

# one run
"$SCREE" repose -c pot.yaml -j 1 --no-picture box.off -o whole >/dev/null || echo failed
resume=
for phase in $phases; do
  cut_short $phase cut/checkpoint.scree repose -c pot.yaml -j 1 --no-picture box.off -o cut $resume
  resume=--resume
done
"$SCREE" repose -c pot.yaml -j 1 --no-picture box.off -o cut --resume >/dev/null || echo failed
grep -c '"piece_count": 5' cut/result.json
# the costs of the machine, and what the files are told of the command
plain() { grep -v '"command"\|"file"\|_seconds"\|"next"\|"piece_count"'; }
plain <whole/result.json >whole.json
plain <cut/result.json | cmp - whole.json && cmp whole/series.csv cut/series.csv && echo "the same heap and series"
"$SCREE" pile whole/last.scree --json | plain >last.json
"$SCREE" pile cut/last.scree --json | plain | cmp - last.json && echo "the same frame"

# a run of a study
"$SCREE" study pots.yaml -o whole.study --jobs 1 >/dev/null || echo failed
key=$(sqlite3 whole.study/study.sqlite 'SELECT key FROM run')
for phase in $phases; do
  cut_short $phase "cut.study/runs/$key/checkpoint.scree" study pots.yaml -o cut.study --worker
done
"$SCREE" study pots.yaml -o cut.study --jobs 1 >/dev/null || echo failed
sqlite3 cut.study/study.sqlite 'SELECT state, piece_count FROM run'
numbers() {
  sqlite3 "$1/study.sqlite" 'SELECT * FROM series ORDER BY time' \
    'SELECT hash, heap, sector_deg, cone_deg, silhouette_deg, height, base_radius, run_out, body_count,
            packing_fraction, coordination, kinetic, time, still, step_count, largest_overlap FROM run'
}
numbers whole.study >whole.txt
numbers cut.study | cmp - whole.txt && echo "the same series and results"
