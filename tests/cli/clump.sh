# Clumps: what is printed and written, wrong calls, and clumps in the place of scans in other verbs.
# Numbers of a fit are the machine's in their last digits: two are shown.
numbers() { sed -E 's/([0-9]*\.[0-9]{2})[0-9]+/\1/g; s/  +/ /g'; }
box 10 20 30 >box.off
run clump box.off --max 3 | numbers
run clump box.off --max 1 -q | tail -1
run clump box.off --max 3 --csv | cut -d, -f1-4,17- | numbers
run clump box.off --max 3 --json | grep -E '"(name|method|recommended|chosen|clump_file|sphere_count)"' | cut -c 1-28
run clump box.off -n 2 -o out -q
ls out
head -1 out/box.csv
grep -c '^[^#x]' out/box.csv
# a plate is told to be the wrong shape for spheres, and how many triangles its mesh has; inscribed ones are not judged so
box 60 40 1 >plate.off
run clump plate.off --max 12 | tail -2 | numbers
run clump plate.off --max 4 --inside | tail -1 | numbers
# a table names its unit, and is read in it
run clump box.off -u m -n 1 -o metres -q
sed -n 2p metres/box.csv | sed 's/[0-9.]*, /N, /'
run export metres/box.csv --to edem -o edem -q -d 1
sed 1d edem/box.tsv | cut -f4 | cut -c1-3
run clump box.off -n 2 -o out -q
run clump box.off -n 2 -o out -q -f -m peeling
run clump box.off -n 2 -o out/box.csv -q
# the tables of several inputs in one folder have names of their own
mkdir again
cp box.off again/
run clump box.off again/box.off -n 1 -o both -q
ls both | grep csv
# what is wrong is said
run clump
run clump box.off -n 301 2>&1 | lines 1,2
run clump box.off -n 2 -t 0.1 2>&1 | lines 1,2
run clump box.off --json --csv 2>&1 | lines 1,2
run clump box.off --tolerance 1e-6 --max 2
run clump box.off -m best 2>&1 | lines 1,2
run clump nowhere.stl
run clump out/box.csv
sed '$d' box.off | sed 's/8 6 0/8 5 0/' >open.off
run clump open.off --no-repair --max 1
# interrupted: nothing is left behind
"$SCREE" clump box.off --max 300 -o stopped -q &
victim=$!
sleep 0.5
kill -INT $victim
wait $victim
echo "exit code $?"
ls stopped 2>/dev/null
# a scene takes a table, or so many spheres in place of a shape's surface
cat >scene.yaml <<'END'
time: 0.01
materials: {stone: {density: 2500}}
shapes:
  table: {clump: out/box.csv, unit: mm, material: stone}
  fitted: {file: box.off, unit: mm, clump: 2, material: stone}
  cube: {box: [0.01, 0.02, 0.03], clump: 2, material: stone}
geometry:
  floor: {plane: [0, 0, 1], material: stone}
inlets:
  feed: {box: {min: [-0.1, -0.1, 0.05], max: [0.1, 0.1, 0.2]}, shapes: {table: 1, fitted: 1, cube: 1}, count: 6}
END
run run scene.yaml --print | grep clump:
run run scene.yaml -o scene --no-picture -q >/dev/null
grep -c '"kind": "clump"' scene/*.json
run run scene.yaml --set shapes.fitted.clump=301
run run scene.yaml --set shapes.cube.clump=cube.csv
# clumps of the shapes in a drop
run drop box.off=2 --clump 2 --time 0 --frames 0 --no-picture -o dropped 2>&1 | grep 'shape box' | cut -c1-34
run drop box.off=2 --clump 0 -o none 2>&1 | lines 1,2
run drop --clump 2 --resume -o dropped 2>&1 | lines 1,2
# a study of clumps beside the surface; one made on the way in `scree repose` has the bits of the study's table
cat >study.yaml <<'END'
replicates: 1
shapes: [box.off]
base:
  preset: demo
  particles: 8
  cylinder: {diameter: 0.2}
  phases: {pack_time: 0.3, settle_time: 0.05, lift_speed: 1, lift_time: 0.3, hold_time: 0.05}
factors: {rp: ["clump:2", scan]}
END
run study study.yaml -o study --csv -q | cut -d, -f1-4
ls study/shapes
once="-p demo --particles 8 --cylinder 0.2 --pack-time 0.3 --settle-time 0.05 --lift-speed 1 --lift-time 0.05 --hold-time 0.05 --no-picture --json -q"
same() { grep -v '"command"\|"next"\|"file"\|_seconds"\|"name"\|"family"\|"source"\|"rp'; }
"$SCREE" repose box.off --rp clump:2 $once | same >made.json
"$SCREE" repose study/shapes/box-clump2.csv --unit m $once | same >table.json
diff made.json table.json
grep -c height made.json
sed 's/clump:2/clump:0/' study.yaml >none.yaml
run study none.yaml --dry-run
