run 2>&1 | head -4
run nonsense
run help nonsense
"$SCREE" --version | sed 's/[0-9][0-9.]*/N/'
"$SCREE" help | tail -4
# values that are not there, or beyond any range
for words in "simplify x -n 99999999999999999999" "simplify x -n 4294967296" "simplify x -n 0" "repair x --holes 5000"; do
  run $words -o y.stl 2>&1 | sed -n 2p
done
run check x '' 2>&1 | sed -n 2p
run simplify x -n 4 -o '' 2>&1 | sed -n 2p
run choose x --output= 2>&1 | sed -n 2p
