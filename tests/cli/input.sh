# every verb takes sample:NAME, and the options of samples, where it takes a file
small="--resolution 3mm --noise 0.2mm"
run simplify sample:fp-1 $small -n 60 -o fp.ply -q && grep -a "element" fp.ply
run curve sample:fp-1 $small --grid 1e-2:1e-2:9 | head -1 | cut -c1-30
run measure sample:box-12 | head -6
run measure --json sample:box-12 | grep -E '"(file|format|checksum|unit_m)"'
run check -q sample:fp-1 $small --sample-seed 2
run check --json sample:box-12 | grep -E '"(file|format|checksum|unit_m)"'
run distance sample:box-12 sample:icosphere-2 | cut -d" " -f1-3 | head -1 | cut -c1-30
run distance --json sample:box-12 sample:box-12 | grep '"file"'
run repair sample:icosphere-1 -o ball.off | tail -4
run choose sample:icosphere-2 --json | grep -E '"(file|format|checksum|unit_m)"'
run measure sample:nosuch
run check sample:fp-1 --noise 0.1mm
run distance sample:box-12 sample:box-12 --resolution 3
# the limit of memory names the file
run repair -q sample:icosphere-5 -o large.obj | tail -1 | cut -c1-20
run check --max-memory 300K large.obj 2>&1
# nothing could be done is not nothing had to be done
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >alone.off
run repair alone.off -o closed.off | head -3
# text with a byte that no text has, and OFF of the other kind, are not taken for binary STL
facet='facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n'
printf "solid x\n$facet$facet" >nul.stl
printf "\000${facet}endsolid x\n" >>nul.stl
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# a comment \001\n' >one.obj
printf 'OFF BINARY\n\000\000\000\004\000\000\000\004\000\000\000\000' >binary.off
head -c 100 /dev/zero >>binary.off
(printf '%-80s' 'solid facet vertex' && printf '\004\000\000\000' && head -c 120 /dev/zero) >cut.stl
for file in nul.stl one.obj binary.off cut.stl; do run measure $file; done
# a stream that never ends is left as soon as it shows to be no mesh, or longer than it says
yes | "$SCREE" measure - 2>&1
"$SCREE" measure /dev/zero 2>&1
"$SCREE" sample icosphere-2 -o ball.stl -q >/dev/null
(cat ball.stl && yes) 2>/dev/null | "$SCREE" measure - 2>&1
(cat ball.stl && printf '%49s' x) | "$SCREE" measure - | head -n 1
(cat ball.stl && printf '%50s' x) | "$SCREE" measure - 2>&1
"$SCREE" sample icosphere-5 -o large.ply -q >/dev/null
cat large.ply | "$SCREE" measure - --json | grep -E '"(format|checksum)"'
"$SCREE" measure large.ply --json | grep '"checksum"'
(yes '# a comment' | head -n 20000 && cat one.obj) | grep -v "$(printf '\001')" | "$SCREE" measure - 2>/dev/null | head -n 1
# nor is a large file that is no mesh read to its end
truncate -s 3G sparse.stl
(printf '%-80s' cut && printf '\377\377\377\377') >long.stl && truncate -s 3G long.stl
(yes 1,2,3 | head -n 20000) >table.csv && truncate -s 3G table.csv
for file in sparse.stl long.stl table.csv; do run measure --max-memory 1M $file; done
