# A study whose base is a scene: any field a factor, any column of its sensors an answer.
cat >chute.yaml <<'END'
time: 0.3
materials: {grain: {young: 1e6, density: 1000, restitution: 0.3, friction: 0.4}}
shapes: {ball: {sphere: 0.01}}
geometry: {chute: {box: [0.2, 0.2, 0.02], turn: {axis: [0, 1, 0], angle_deg: 35}}}
inlets: {feed: {box: {min: [-0.05, -0.03, 0.06], max: [0, 0.03, 0.12]}, shapes: ball, rate: 100, until: 0.1}}
sensors: {all: {region: {box: {min: [-1, -1, -1], max: [1, 1, 1]}}, from: 0.15}, load: {wall: chute}}
output: {series: 0.02}
END
cat >study.yaml <<'END'
base: {scene: chute.yaml, time: 0.2}
factors:
  inlets.feed.rate: [50, 100]
  geometry.chute.turn.angle_deg: [20, 40]
answers: [all.count, all.count: {from: 0.15}, all.count: mean]
replicates: 2
END
# the last two columns are noise and time
table() { sed -E '/^ .*[/]/s/( +[0-9.e-]+)? +[0-9.e-]+$//'; } # without deviations and times
run study study.yaml -o out -q -v 2>/dev/null | table
sed -n '1s/.*,\(all.count.*\)/\1/p' out/points.csv
head -2 out/points.csv | cut -d, -f1-8
head -1 out/scene.yaml | sed 's/of .*\//of /'
run study status out | head -1
# before the first run nothing is known
"$SCREE" study study.yaml -o none --slurm --dry-run >/dev/null 2>&1
"$SCREE" study status none -v 2>/dev/null | grep -c ' -$'
"$SCREE" study status none -v 2>/dev/null | grep nan
# other answers come from what the runs left
touch before
sed 's/^answers.*/answers: [all.mass: {at: 0.1}, load.force_z]/' study.yaml >other.yaml
"$SCREE" study other.yaml -o out -q >/dev/null
find out/runs -newer before | grep -c .
cut -d, -f3- out/points.csv | sed -nE '1s/.*,(all.mass.*)/\1/p; 2s/.*(,[0-9.e-]+){2}$/has numbers/p'
"$SCREE" study other.yaml -o anew -q >/dev/null
awk -F, '{ print $(NF - 1), $(NF - 15) }' out/points.csv >kept; awk -F, '{ print $(NF - 1), $(NF - 15) }' anew/points.csv | cmp - kept
"$SCREE" study study.yaml -o out -q >/dev/null
rm chute.yaml
run study status out -v 2>/dev/null | sed -n 8,10p | table
cat >wrong.yaml <<'END'
base: {scene: out/scene.yaml}
factors: {inlets.feed.rat: [50, 100]}
answers: [all.count]
END
run study wrong.yaml 2>&1 | sed 's/: [^ ]*chute/: chute/' | cut -c 1-110
sed -i 's/inlets.feed.rat:/inlets.fed.rate:/' wrong.yaml
run study wrong.yaml 2>&1 | sed 's/: [^ ]*chute/: chute/'
sed -i 's/fed.rate:/feed.rate:/; s/all.count/all.cuont/' wrong.yaml
run study wrong.yaml 2>&1 | cut -c 1-110
sed -i 's/answers.*//' wrong.yaml
run study wrong.yaml
