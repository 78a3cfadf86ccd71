#!/bin/sh
# A run, and a scene with moving walls and sensors, that go back and forth between device and processor, killed in
# the middle, end as those that stayed. SCREE is the program; the stand-in is found as the driver.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >pot.yaml <<'YAML'
preset: demo
particles: 6
cylinder: {diameter: 0.25}
disc: {diameter: 1}
phases: {pack_time: 0.2, settle_time: 0.1, lift_speed: 1, lift_time: 0.2, hold_time: 0.1, stop_when_still: false}
output: {checkpoint_interval: 0.01}
YAML
"$SCREE" run --template drum | sed -e 's/^time: .*/time: 0.2/' -e 's/count: 250/count: 8/' -e 's/from: 0.7/from: 0.05/' \
  -e 's/checkpoint: 30/checkpoint: 0.01/' >drum.yaml

# `cut_short BACKEND WORDS...`: kills scree WORDS once it has written another checkpoint; the processor may be done first.
cut_short() {
  backend=$1
  shift
  rm -f seen
  [ ! -e cut/checkpoint.scree ] || touch -r cut/checkpoint.scree seen
  "$SCREE" "$@" --backend "$backend" >/dev/null 2>&1 &
  victim=$!
  while kill -0 $victim 2>/dev/null; do
    if [ -e cut/checkpoint.scree ] && { [ ! -e seen ] || [ cut/checkpoint.scree -nt seen ]; }; then
      kill -9 $victim && killed="$killed $backend"
      break
    fi
    sleep 0.01
  done
  wait $victim 2>/dev/null || true
}
# the costs of the machine, and what the files are told of the command
plain() { grep -v '"command"\|"file"\|_seconds"\|"next"\|"piece_count"' "$1/result.json"; }
# `back_and_forth WORDS...`: its result and series are the same.
back_and_forth() {
  rm -rf whole cut
  killed=
  "$SCREE" "$@" -o whole >/dev/null
  cut_short cuda "$@" -o cut
  for backend in cpu cuda cpu; do cut_short $backend "$@" -o cut --resume; done
  "$SCREE" "$@" -o cut --resume --backend cuda >/dev/null
  echo "$1: killed on$killed"
  test "${killed#* cuda}" != "$killed"
  plain whole >whole.json
  plain cut | cmp - whole.json
  cmp whole/series.csv cut/series.csv
}
back_and_forth repose -c pot.yaml --no-picture sample:icosphere-1
back_and_forth run drum.yaml
