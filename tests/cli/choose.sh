# Counts and errors follow the decimation's details, so numbers are shown as N.
shape() { sed 's/[0-9][0-9.,]*\(e-[0-9]*\)*/N/g; s/N %\*/N % /; s/  */ /g'; }
run choose 2>&1 | lines 2
run choose --grid 1e-5 sample:icosphere-3 2>&1 | lines 2
run choose --json --csv sample:icosphere-3 2>&1 | lines 2
run choose --paper --method volume sample:icosphere-3 2>&1 | lines 2
run choose sample:nonsense 2>&1 | cut -c 1-40
run choose missing.stl
"$SCREE" choose sample:icosphere-2 sample:icosphere-3 --errors -o out | shape
ls out out/set
run choose sample:icosphere-2 sample:icosphere-3 -o out
"$SCREE" choose sample:icosphere-3 --paper --json >a.json
OMP_NUM_THREADS=1 "$SCREE" choose sample:icosphere-3 --paper --json >b.json
cmp a.json b.json && grep -c '"rp"' a.json
"$SCREE" choose sample:icosphere-3 --csv | wc -l
cp out/icosphere-3.stl again.stl
"$SCREE" choose again.stl --no-repair --json | grep '"unit_m"'
# the grid is the paper's; of a box, whose count does not depend on the scan's resolution, none is said to
run choose --paper --grid 1e-4:1:3 sample:icosphere-3 2>&1 | lines 2
box 3 2 1 >box.off
"$SCREE" choose box.off --unit cm | shape
# levels do not hang on the unit, though of such a ball many edges cost the same
"$SCREE" sample icosphere-3 -o ball.stl -q >/dev/null
for unit in mm inch km; do
  "$SCREE" choose ball.stl --unit $unit --csv >$unit.csv
  awk -F, 'NR > 1 { printf "%s %s %.12f %.12f %s\n", $3, $4, $7, $8, $12 }' $unit.csv >$unit.txt
  "$SCREE" simplify ball.stl --unit $unit -n 100 -q -o $unit.stl # whose header tells the unit
  tail -c +81 $unit.stl >$unit.bin
  cmp mm.txt $unit.txt && cmp mm.bin $unit.bin && wc -l <$unit.txt
done
awk -F, 'NR == 2 { print $5 * 1e6 }' mm.csv
awk -F, 'NR == 2 { print $5 / .0254 ^ 2 }' inch.csv
# names of many kinds keep to their column; control characters, which a table or a file name cannot bear, do not stay
"$SCREE" sample icosphere-2 -o plain.stl -q >/dev/null
lines=$(printf 'two\nlines.stl')
for name in 'sp a ce' 'ünï-☃-ünï-☃' "${lines%.stl}" -dash; do cp plain.stl "./$name.stl"; done
run choose -o named -- 'sp a ce.stl' 'ünï-☃-ünï-☃.stl' "$lines" -dash.stl
ls named | grep lines
run check -dash.stl 2>&1 | lines 2
mv ./-dash.stl ./--dash.stl
run check --dash.stl 2>&1 | lines 2
# a file that cannot be used is said and left out, of one folder, table and set; the exit code says it too
echo junk >junk.stl
run choose plain.stl junk.stl again.stl missing.stl -o rest
ls rest/set
run choose plain.stl junk.stl again.stl --csv | sed 's/^\([a-z]*\.stl\),.*/\1/; s/,,,,*[0-9].*,set/, set/' | uniq
# with -f all that an earlier choice left goes when the new one is there, not before; other files stay
cp junk.stl rest/own.stl && cp junk.stl rest/set/again.off && cp -r rest read && cp junk.stl rest/again.curve.csv
find rest | sort >before
"$SCREE" choose missing.stl -o rest -f
find rest | sort | cmp - before
run choose read/set/plain.stl -o read -f
run choose junk.stl plain.stl -o rest -f --json | grep -E '"(file|object_count|mesh_file)"'
find rest -name 'again*' -o -name 'own*' -o -path 'rest/set*' | sort
"$SCREE" choose sample:icosphere-2 -o read -f >/dev/null
find read -name 'again*' -o -name 'plain*' -o -name 'icosphere*' | sort
run choose junk.stl plain.stl -o alone | tail -n 6
find alone -name set
run choose junk.stl missing.stl -o none/of/it
ls -d none
# the estimate for half the spacing is of the choice that is told, the set's own where there are several
"$SCREE" choose sample:icosphere-2 sample:box-12 sample:icosphere-3 --paper 2>&1 | grep spacing
"$SCREE" choose sample:icosphere-3 --paper 2>&1 | grep spacing
# by the paper's rule the set's Rp is one of the grid, and so are the counts: those of the meshes written
"$SCREE" choose --paper sample:icosphere-2 sample:icosphere-3 -o by-paper 2>/dev/null | grep '^Use'
for name in icosphere-2 icosphere-3; do "$SCREE" measure by-paper/set/$name.stl | sed -n 's/^  \([0-9]* facets\),.*/\1/p'; done
# noise that was not found is not said to be used
noisy="--resolution 3mm --noise 0.6mm --sample-seed 6"
for words in plain.stl "sample:sp-1 $noisy"; do
  "$SCREE" choose $words --area smooth -v 2>&1 | grep "^paper: "
done
"$SCREE" choose sample:sp-1 $noisy --rule paper 2>&1 | grep misleads | shape
run choose plain.stl --rule robust | lines 2
# what is worth a warning stands in the text, the JSON and the page alike, and nothing of it in one of them alone
box 3 2 1 | sed '2s/6/5/; $d' >open.off
box 30000 20000 10000 >huge.off
warned() {
  "$SCREE" choose "$@" -o warned -f 2>&1 | sed "/^scree, after /d" >text
  cp warned/choice.json warnings.json
  python3 - text warned/choice.txt warned/report.html warnings.json <<'PYTHON'
import html, json, re, sys
texts = [open(name, encoding="utf-8").read() for name in sys.argv[1:4]]
texts[2] = html.unescape(re.sub("<[^>]*>", "", texts[2]))
objects = json.load(open(sys.argv[4], encoding="utf-8"))
told = [(o["name"] + ": " if "name" in o else "") + w for o in objects for w in o["warnings"]]
for text in texts:
    print(len(told), "warnings in the JSON,", sum(w in text for w in told), "of them in a text")
print(len(texts[0].split("\n")) - 1 - len(told), "lines and the warnings")
PYTHON
}
if command -v python3 >/dev/null; then
  warned open.off huge.off missing.stl
  warned "sample:sp-1" $noisy --rule paper
  "$SCREE" choose open.off huge.off --csv 2>&1 >/dev/null | shape
fi
# what has hardly an error is not on the figure's logarithmic axis, which says so
"$SCREE" choose sample:box --resolution 5mm -o box >/dev/null 2>&1
grep '^# scree' box/figure.gnuplot out/figure.gnuplot | sed 's/scree [0-9][0-9.]*[^,]*/scree N/'
# nor does the dense curve, of a coarse grid, leave it at the top; a choice behind the grid's end is drawn and named where it is
"$SCREE" choose sample:sp-3 --resolution 4mm --grid 1e-5:1e-1:1 -o spiky >/dev/null
"$SCREE" choose box.off -o one-level 2>/dev/null | grep Use | shape
"$SCREE" choose box.off --paper 2>/dev/null | grep Use
for folder in spiky one-level; do
  sed -n 's/^set \([xy]\)range \[.*:\(.*\)\]$/\1 \2/p' $folder/figure.gnuplot >ends
  awk -F, 'NR == FNR { split($0, w, " "); panel += w[1] == "x"; end[panel w[1]] = w[2]; next }
    FNR > 1 && $5 > 0 { drawn++; hidden = $4 > end[$1 "x"]
      outside += hidden ? $3 ~ /choice/ : $5 > end[$1 "y"] }
    END { print (drawn ? "some" : "none"), "drawn,", outside + 0, "outside" }' ends $folder/figure.csv
done

# a body too thin for its walls to be measured is told, with what keeps its thickness
box 30 20 0.01 >foil.off
"$SCREE" choose foil.off 2>&1 | grep 'A foil' | shape
