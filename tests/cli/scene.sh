# Scenes from the command line: what is printed, what is told of wrong files and wrong calls, what a folder holds.
numbers() { sed -E 's/[0-9]+(\.[0-9]+)?(e-?[0-9]+)?/N/g; s/  +/ /g'; }
run run 2>&1 | lines 1,2
run run --template silo 2>&1 | lines 1,2
"$SCREE" run --template hopper >hopper.yaml
head -2 hopper.yaml | tail -1
"$SCREE" run --template hopper --print --set time=0.05 | grep ^time
run run --template hopper --set time=0.001 -o built-in -q --no-picture 2>&1 | lines 1,2
ls built-in | head -3
run run --template hopper hopper.yaml 2>&1 | lines 1,2
"$SCREE" run hopper.yaml --print --set inlets.feed.count=20 --set time=0.05 >small.yaml
grep -E '^time|count|sphere' small.yaml
run run hopper.yaml --set inlets.feed.cuont=20 2>&1 | cut -c 1-120
run run hopper.yaml --set inlets 2>&1 | lines 1,2
# a name that the file lacks makes no thing that nothing uses
run run hopper.yaml --set materials.grian.friction=0.3
run run hopper.yaml --set outlets.chute.from=1
run run hopper.yaml --set time=short
# a field of a thing without its group, and a fault of the file itself, which no setting is blamed for
run run hopper.yaml --set friction=0.3 2>&1 | lines 1,2
run run hopper.yaml --set grain.friction=0.3 2>&1 | lines 1,2
sed 's/count: [0-9]*/count: few/' hopper.yaml >few.yaml
run run few.yaml --set time=1 2>&1 | lines 1,2
run run nowhere.yaml
run run hopper.yaml --resume 2>&1 | lines 1,2
# another encoding, a tab, a control character: in their line
printf 'time: 1\ntitle: Gr\374n\n' >latin.yaml
printf 'time: 1\nshapes:\n\tball: {sphere: 0.01}\n' >tab.yaml
printf 'time: 1\ntitle: \007\n' >bell.yaml
for file in latin tab bell; do run run $file.yaml; done
sed 's/friction: 0.3/fricton: 0.3/' hopper.yaml >wrong.yaml
run run wrong.yaml
# geometry without area, a period that a ball does not fit into: the place in the file, and no folder
printf 'OFF\n3 1 0\n0 0 7\n9 0 7\n4 0 7\n3 0 1 2\n' >line.off
cat >places.yaml <<'END'
time: 1
shapes: {ball: {sphere: 0.01}}
geometry: {tip: {file: line.off}}
inlets: {feed: {box: {min: [0, 0, 0.1], max: [0.02, 0.1, 0.2]}, shapes: ball, rate: 20}}
END
run run places.yaml -o nothing
sed -i 's/^geometry.*/domain: {min: [0, 0, 0], max: [0.02, 1, 1], periodic: x}/' places.yaml
run run places.yaml -o nothing
[ -e nothing ] || echo nothing written
"$SCREE" run hopper.yaml --set materials.grain.friction=50 --set materials.grain.density=2.65 --set time=1e-5 2>&1 | lines 1,2
run run small.yaml -o out --no-picture -q | numbers
ls out
run run small.yaml -o out --no-picture
run run small.yaml -o out --no-picture --resume -q --set inlets.feed.count=21
run run small.yaml -o out --no-picture --resume -q --set output.frames=0.001
# -f begins anew once the scene is one: what is wrong with it costs no earlier result
run run small.yaml -o out -f --set bodies.file=none.csv
ls out | wc -l
run run small.yaml -o out --no-picture -f -q | head -2 | numbers
run run -o out --resume -q --no-picture | head -2 | numbers
grep '"file"' out/result.json
sed -n 2p out/series.csv | cut -c 1-75
# killed outright and gone on with: the same as in one piece
"$SCREE" run small.yaml --set output.checkpoint=0.01 -o killed --no-picture -q >/dev/null 2>&1 &
victim=$!
sleep 0.3
kill -9 $victim 2>/dev/null
wait $victim 2>/dev/null
"$SCREE" run small.yaml --set output.checkpoint=0.01 -o killed --no-picture -q --resume >/dev/null
cmp out/series.csv killed/series.csv && echo same series
cmp out/motion.scree killed/motion.scree && echo same motion
# gone on with a change, which is told; killed in between, the change stays
cp -r out changed
run run -o changed --resume --no-picture --change materials.grain.density=900 -q
run run small.yaml -o changed --resume --change time=1
run run -o changed --resume --no-picture --change time=0.07 --change materials.grain.friction=0.2 -q | grep "changed at" | numbers
grep '"was"' changed/result.json | tail -1 | numbers
grep -a -c 'materials.grain.friction from' changed/report.html
run run -o changed --resume --no-picture --change time=0.07 -q | grep -c "changed at"
# the table of bodies, which another scene reads
run export out/checkpoint.scree -o table.csv
cmp table.csv out/bodies.csv && echo same table
run export out/checkpoint.scree -o table.csv
# one whose bodies become too fast for its steps names the body; its state is kept, and its report plays up to it
run run small.yaml --set materials.grain.young=1e4 --set 'gravity=[0, 0, -300]' --set time=1 -o soft --no-picture -q 2>&1 | grep '^scree' |
  sed -E "s/(step|body|by) [0-9.]+/\\1 N/g; s/wall [0-9]+/wall N/g; s/is '[a-z]+'/is NAME/"
run export soft/checkpoint.scree --view contacts -o contacts.vtp
grep -a -A1 '"piles"' soft/report.html | tail -1
run run -o soft --resume 2>&1 | cut -c 1-82
# its checkpoint for ParaView, and as a folder
run export out/checkpoint.scree --view walls -o walls.vtp
grep -c '<VTKFile' walls.vtp
run export out/checkpoint.scree -o pile
grep -c ',' pile/bodies.csv
