cat > open.off <<'END'
OFF
5 6 0
0 0 0
10 0 0
0 10 0
0 0 10
10 10 10
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 4
3 1 4 3
3 1 2 4
END
cat > solid.off <<'END'
OFF
4 4 0
0 0 0
10 0 0
0 10 0
0 0 10
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
END
run check open.off
run check -q solid.off open.off
run check --fast solid.off
run check --json solid.off | grep -v '"version"'
run check nosuch.stl
run check 2>&1
run repair open.off
run repair open.off -o closed.off
run check -q closed.off
run repair open.off -o closed.off
run repair -q open.off -o closed.off -f --holes 2%
run repair -f --json open.off -o closed.stl | grep -v '"version"'
ls
# what is guessed is told, and what is too much of it is refused, with what would fill it, and does
"$SCREE" sample icosphere-5 -o ball.off -q >/dev/null
awk '/^[OF#]/ { next } !n { n = $1; next } v < n { z[v++] = $3; points = points $0 "\n"; next }
  z[$2] < 1 || z[$3] < 1 || z[$4] < 1 { faces = faces $0 "\n"; k++ }
  END { printf "OFF\n%d %d 0\n%s%s", n, k, points, faces }' ball.off >bowl.off
run repair bowl.off -o full.off 2>&1 | grep guessed
run choose bowl.off 2>&1 | grep guessed
printf 'OFF\n4 1 0\n0 0 0\n9 0 0\n9 9 1\n0 9 0\n4 0 1 2 3\n' >sheet.off
run choose sheet.off
run repair sheet.off -o full.off --holes 100% -f | grep '^repaired'
run choose bowl.off --no-repair
# what scree wrote is read in the unit it was written in; -u goes before; sizes that no particle has are named
"$SCREE" simplify sample:box-12 -n 12 -u m -o metres.stl -q
cp metres.stl here.stl
for unit in "" "-u mm" "-u m" "-u km"; do run measure here.stl $unit 2>&1 | grep -E "^(here|\\$)|dimensions x"; done
# as small as a scan in metres would be: a question, but where the unit is said
box 0.2 0.1 0.1 >stone.off
for unit in "" "-u mm"; do run measure stone.off $unit 2>&1 | lines 1,2; done
run export here.stl -o there.stl -d 1.2 2>&1 | lines 1,3
