# Pieces of a scan and where they meet: what is printed and written, and wrong calls.
box 10 20 30 >box.off
run fracture box.off -n 4 --seed 1 -o out | sed -E 's/off by [0-9e.-]+/off by E/'
ls out
wc -l <out/joints.csv
cut -d, -f1-3 out/pieces.csv
# the pieces' volumes sum to the box's
tail -n +2 out/pieces.csv | awk -F, '{ sum += $4 } END { printf "%.15g\n", sum }'
for piece in out/piece-*.ply; do "$SCREE" check -q $piece; done
# the same again is the same, in another format, over what is there
cp out/joints.csv first.csv
run fracture box.off -n 4 -o out -q
run fracture box.off -n 4 -o out -q -f --format stl | sed -E 's/off by [0-9e.-]+/off by E/'
ls out
cmp first.csv out/joints.csv && echo same
run fracture box.off -n 3 -o grain --grain 0,0,1:4 --near 5mm,10mm,-2mm:4mm -q | sed -E 's/off by [0-9e.-]+/off by E/'
run fracture box.off -n 3
run fracture box.off -n 3 -o bad --near 5mm
run fracture box.off -n 3 -o bad --grain 0,0,1
run fracture box.off -n 3 -o bad --grain 0,0,0:2
run fracture box.off -n 0 -o bad 2>&1 | lines 2
printf 'OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n' >open.off
run fracture open.off -o bad --no-repair
ls bad 2>&1
# fragments of a checkpoint, each in its place
cat >scene.yaml <<'Y'
time: 1e-5
materials: {m: {young: 1e6}}
shapes: {s: {material: m, box: [0.02, 0.03, 0.01], fracture: {cells: 4, tension: 1e4}}}
geometry: {floor: {plane: [0, 0, 1], material: m}}
inlets: {i: {box: {min: [-0.1, -0.1, 0.05], max: [0.1, 0.1, 0.2]}, shapes: s, count: 2}}
Y
"$SCREE" run scene.yaml -o run -q >run.log 2>&1
run export run/checkpoint.scree -o export -q
ls export
"$SCREE" check export/fragment-0.stl | grep volume
