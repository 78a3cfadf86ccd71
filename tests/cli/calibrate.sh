# A calibration on a closed form with noise: a banana is told as one, a second test would tell, what was killed
# gives the same answer, another budget goes on, what is wrong is told.
cat >model.sh <<'END'
#!/bin/sh
# model.sh FRICTION ROLLING SEED
echo >>"${0%/*}/calls"
awk -v a="$1" -v b="$2" -v s="$3" 'BEGIN {
  for (i = 0; i < 12; i++) { s = (s * 16807 + 12345) % 2147483647; n += s / 2147483647 }
  printf "a line of its own\nangle: %.9g\ntime = %.9g\nextra: 7\n", 30 + 20 * (a - 0.5) + 15 * (b - 0.4) * (1 + b) + n - 6, 5 - 3 * a + 0.1 * (n - 6)
}'
END
chmod +x model.sh
cat >heap.yaml <<'END'
title: a heap
seed: 2
experiments:
  heap: {command: ["{here}/model.sh", "{friction}", "{rolling}", "{seed}"]}
parameters:
  friction: {from: 0.1, to: 0.9}
  rolling: {from: 0, to: 0.8}
targets:
  angle: {answer: angle, value: 30.5, uncertainty: 0.2}
  discharge: {answer: time, uncertainty: 0.05}
predict:
  twice: {answer: angle}
budget: {runs: 34}
END
words() { sed -nE 's/^(friction|rolling) .* (identified|not identifiable)$/\1 \2/p; s/ (0\.[0-9]+) / N /g; /trade|would tell/p' | sed -E 's/ [0-9.]+( with| gives| of|$)/ N\1/g; s/[0-9]+ (times?|%)/N \1/g; s/ [0-9.]+,/ N,/g'; }
"$SCREE" calibrate heap.yaml -o whole -q -v --jobs 2 >whole.txt 2>errors.txt || cat errors.txt
words <whole.txt
sed -nE '/^checked/,$s/ [0-9.]+/ N/gp' whole.txt | grep -v tell
sed -n 1p whole.txt
ls whole | tr '\n' ' '
echo
grep -c . whole/samples.csv
# killed at random moments: the same answer
killed=0
for moment in 0.15 0.3 0.2 0.4 0.25 0.35 0.1 0.45 0.22 0.31; do
  timeout -s KILL $moment "$SCREE" calibrate heap.yaml -o killed -q --jobs 1 >/dev/null 2>&1 || killed=$((killed + 1))
done
[ $killed -ge 3 ] || echo "killed only $killed times"
"$SCREE" calibrate heap.yaml -o killed -q --jobs 1 >/dev/null || echo "does not go on"
cmp whole/samples.csv killed/samples.csv && echo "the same samples"
# another budget and the second test measured: it goes on
sed -i 's/runs: 34/runs: 50/; s/answer: time, /answer: time, value: 3.5, /' heap.yaml
"$SCREE" calibrate heap.yaml -o whole -q -v --jobs 2 >more.txt 2>errors.txt
sed -n 1p more.txt
words <more.txt
"$SCREE" calibrate status whole -q | sed -n "1p;\$p"
# in a corner of the ranges their ends close the intervals
sed 's/value: 30.5/value: 46/; s/value: 3.5, //; s/runs: 50/runs: 34/' heap.yaml >corner.yaml
"$SCREE" calibrate corner.yaml -o corner -q -v --jobs 2 2>errors.txt | sed -nE 's/^(friction|rolling) .* at (least|most) .*/\1 at \2/p; /range ends/p'
# an interval that rests on where runs gave no answer tells nothing
cat >low.sh <<'END'
#!/bin/sh
# low.sh FRICTION ROLLING SEED: an angle that rolling alone sets, from a friction of LEAST on
awk -v a="$1" -v b="$2" -v s="$3" -v least="$LEAST" 'BEGIN {
  for (i = 0; i < 12; i++) { s = (s * 16807 + 12345) % 2147483647; n += s / 2147483647 }
  if (a >= least) printf "angle: %.9g\n", 30 + 30 * (b - 0.4) + n - 6
}'
END
chmod +x low.sh
sed '/discharge/d; s/model.sh/low.sh/; s/runs: 50/runs: 34/' heap.yaml >low.yaml
for LEAST in 0 0.5; do
  export LEAST
  "$SCREE" calibrate low.yaml -o low-$LEAST -q -v --jobs 2 2>errors.txt | sed -nE 's/^(friction|rolling) .* (identified|not identifiable)$/from '$LEAST': \1 \2/p'
done
# an answer that nobody asked for: taken from what the runs printed, none is made again
calls=$(grep -c '' calls)
sed 's/^budget/  seven: {answer: extra}\nbudget/' heap.yaml >asks.yaml
"$SCREE" calibrate asks.yaml -o whole -q --jobs 2 --json | grep -A 12 '"name": "seven"' | grep -oE '"(name|mean)": [^,]*' | sed 's/: [67][.][09]*.*/: 7/'
[ "$(grep -c '' calls)" = "$((calls + 3))" ] || echo "made again: $calls, $(grep -c '' calls)" # the new check
rm whole/heap/runs/*/output.txt
sed 's/seven: {answer: extra}/eight: {answer: extra}/; s/{answer: angle}/{answer: time}/' asks.yaml >gone.yaml
"$SCREE" calibrate gone.yaml -o whole -q --jobs 2 >/dev/null || echo failed
[ "$(grep -c '' calls)" = "$((calls + 3 + 56 + 3))" ] || echo "not made again: $calls, $(grep -c '' calls)"
# the least of an answer under a limit
sed -e 's/^targets:/limits:/; /angle:.*value/d; s/discharge: .*/least: {answer: angle, at_least: 27}/; /^predict/d; /twice/d' \
  -e 's/^limits:/minimise: {answer: time}\nlimits:/; s/runs: 50/runs: 40/' heap.yaml >search.yaml
"$SCREE" optimise search.yaml -o search -q -v 2>errors.txt | sed -nE '1p; /^the least/p; s/^ *(0\.[0-9])[0-9]* .*best$/friction \1/p'
run calibrate search.yaml 2>&1 | lines 1,2
# what is wrong
wrong() {
  sed "$1" heap.yaml >wrong.yaml
  run calibrate wrong.yaml -o wrong 2>&1
}
wrong 's/answer: angle, value: 30.5/answr: angle, value: 30.5/'
wrong 's/value: 30.5/value: 30.5, measured: [30, 31]/'
wrong 's/to: 0.9/to: 0.05/'
wrong 's/friction: {/fricton: {/'
wrong 's/runs: 50/runs: 12/'
wrong 's/angle: {answer: angle/angle: {experiment: drum, answer: angle/'
wrong 's/answer: angle}/answer: angle, at: 3}/'
wrong 's/{friction}/{friction}x/; s/answer: angle}/answer: angel}/'
# a target that no setting reaches is told first, and nothing is fitted, predicted or called identified
sed 's/value: 30.5/value: 75/; s/runs: 50/runs: 24/' heap.yaml >far.yaml
"$SCREE" calibrate far.yaml -o far -q --jobs 2 | sed -E 's/[0-9]+\.[0-9]+/N/g' | sed -n '1,4p'
grep -cE 'identified|"low"|agrees with' far/calibration.txt
grep -E '"fits"|"met"' far/calibration.json
grep -oE '"(samples|trades|advice)": \[[^]]*\]' far/calibration.json
ls far | grep -c samples.csv
# of two that are at odds each is left out in turn
sed 's/value: 30.5/value: 24/; s/value: 3.5, /value: 2.7, /; s/runs: 50/runs: 24/' heap.yaml >odds.yaml
"$SCREE" calibrate odds.yaml -o odds -q -v --jobs 2 2>errors.txt | sed -nE '1d; 2p; s/^(without [a-z]+ the others [a-z ]+):.*/\1/p'
# a decimal comma, a slip in a name at the first run, a command that hangs with its child, what it said of its error
cat >say.sh <<'END'
#!/bin/sh
# say.sh FRICTION: as KIND says
echo "asked" >>"${0%/*}/asked"
case $KIND in
comma) echo "mass: 0,2417" ;;
slip) printf 'mas: 0.2\nother: 1\n' ;;
hang) sleep 1000 & echo $! >>"${0%/*}/children"; sleep 1000 ;;
fail) echo "no such grain" >&2; exit 3 ;;
esac
END
chmod +x say.sh
cat >say.yaml <<'END'
experiments: {e: {command: ["{here}/say.sh", "{friction}"], timeout: 0.3}}
parameters: {friction: {from: 0.1, to: 0.9}}
targets: {mass: {answer: mass, value: 0.24, uncertainty: 0.01}}
start: {points: 2}
budget: {runs: 4}
END
for KIND in comma slip hang fail; do
  export KIND
  rm -rf say asked
  "$SCREE" calibrate say.yaml -o say -q --jobs 1 2>&1 | tail -1
  grep -c '' asked
done
for child in $(cat children); do # one that ended and that nobody has asked for yet is not left
  grep -s '^State:' "/proc/$child/status" | grep -q -v 'Z (' && echo "$child is left"
done
ls say/e/runs/*/errors.txt | head -1 | grep -c errors.txt
