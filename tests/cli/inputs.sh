# What is read is never written over, by whatever name it goes, not even with -f; nor what is write-protected.
"$SCREE" sample icosphere-3 -o ball.stl >/dev/null
cp ball.stl before.stl
ln -s ball.stl link.stl
ln ball.stl twin.stl
mkdir dir
ln -s ../ball.stl dir/far.stl
same() { cmp ball.stl before.stl && [ -L link.stl ] && ls; }
run simplify ball.stl -n 20 -o ball.stl
run simplify ball.stl -n 20 -f -o ball.stl
run simplify ball.stl -n 20 -f -o ./dir/../ball.stl
run simplify ball.stl -n 20 -f -o link.stl
run simplify dir/far.stl -n 20 -f -o twin.stl
run simplify - -n 20 -f -o ball.stl <ball.stl
run repair ball.stl -f -o link.stl
run choose ball.stl -f -o .
run export ball.stl -f -o ball.stl
cp ball.stl ball.vtp
run export before.stl --reference ball.vtp -f -o ball.vtp
cp ball.stl ball.png
run render ball.png -f -o ball.png
run render before.stl --reference ball.png --color-by distance -f -o ball.png
cmp ball.png ball.stl
cp ball.stl ball.json
run simplify ball.json -n 20 --density 1000 -f -o ball.ply
printf '0 0 0 1\n' >series.csv
run drop series.csv=3 -f -o .
run repose series.csv -f -o .
"$SCREE" repose --print >scene.yaml
cp scene.yaml yaml
run repose -c scene.yaml ball.stl -f -o .
cmp scene.yaml yaml
run report . -f -o series.csv
cat series.csv
echo mine >report.html
rm series.csv scene.yaml
run repose ball.stl -o .
run drop ball.stl -o .
cat report.html
cp ball.stl kept.stl
chmod 444 kept.stl
run simplify ball.stl -n 20 -o kept.stl
run simplify ball.stl -n 20 -f -o kept.stl
cmp kept.stl ball.stl
same
# an error names its file once, whatever the name
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >e
for verb in 'check -q' 'repair -o r.ply -q' 'simplify --no-repair -n 4 -o s.ply' 'choose --no-repair' 'export -o x.ply'; do
  run $verb e
  run $verb - <e
done
for verb in check measure choose; do
  run $verb - </dev/null
  run $verb - - <e 2>&1 | lines 2
done
# nor is it shown twice, or obeyed by a terminal, where it has control characters
escape=$(printf 'no\033[31m.stl')
"$SCREE" check "$escape"
"$SCREE" simplify --no-repair -n 4 -o s.ply "$escape"
cp e "$escape"
"$SCREE" choose --no-repair "$escape"
# nor in what else is printed of it; JSON and CSV have the name as it is
box 1 2 3 >box.off
cp box.off "$escape"
for words in check measure 'curve --grid 1:1:9' 'repair -o r.off' 'simplify -n 6 -o six.off' 'drop -N 1 --time 0 -o poured --no-picture --frames 0' \
  'distance --points 100 e' 'export box.off -f -o' 'sample box-12 -f -o'; do
  "$SCREE" $words "$escape" 2>&1 | tr '\033' '!' | grep -o 'no[!?]\[31m.stl' | sed "s/^/${words%% *}: /"
done
"$SCREE" choose box.off -o "$escape.d" | tr '\033' '!' | grep -o '^In no.*:'
"$SCREE" report poured -o "$escape.html" | tr '\033' '!'
"$SCREE" "$escape" 2>&1 | tr '\033' '!' | head -n 1
"$SCREE" check --"$escape" 2>&1 | tr '\033' '!' | head -n 1
"$SCREE" measure "$escape" --csv | tr '\033' '!' | sed -n 's/,.*//; 2p'
"$SCREE" check "$escape" --json | grep -o '"file": ".*31m.stl'
