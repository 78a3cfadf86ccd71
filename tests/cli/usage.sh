run 2>&1 | lines 1,4
run nonsense
run help nonsense
"$SCREE" --version | sed 's/[0-9][0-9.]*/N/'
"$SCREE" help | grep '^[A-Z].*:$'
test "$("$SCREE" help | wc -l)" -le 40 || echo "the overview is longer than a screen"
# values that are not there, or beyond any range
for words in "simplify x -n 99999999999999999999" "simplify x -n 4294967296" "simplify x -n 0" "repair x --holes 5000"; do
  run $words -o y.stl 2>&1 | lines 2
done
run check x '' 2>&1 | lines 2
run simplify x -n 4 -o '' 2>&1 | lines 2
run choose x --output= 2>&1 | lines 2
# one progress for all that a call does, which never goes back and never says that 0 s are left
"$SCREE" curve sample:icosphere-4 --distance --grid 1e-5:1e-1:2 --progress 2>&1 >/dev/null | tr '\r' '\n' >drawn
sed -n 's/^\([a-z ]*[a-z]\) *\[.*/\1/p' drawn | uniq
sed -n 's/.*\] *\([0-9]*\) %.*/\1/p' drawn | awk '$1 < last { print "back to", $1 } { last = $1 }'
grep -c ' 0 s left' drawn
# what the overview lists has a help; lengths are in the unit that the help has
run help help
run help version
run measure sample:dc-1 --resolution 0.01mm 2>&1 | lines 2
run simplify x -n 4 -o y.stl -e 0mm 2>&1 | lines 2
# a sample's name without sample: is taken for a file, unless there is one
run measure fp-1
"$SCREE" sample icosphere-2 -o ball.stl -q >/dev/null && cp ball.stl fp-2
"$SCREE" measure fp-2 | head -n 1
# an error limit that ends it before the count asked for
run simplify ball.stl -n 8 -e 0.01mm -o fine.stl 2>&1 | grep asked
# an option that does nothing without another is refused
for words in "curve x --points 10" "choose x --density 2" "pile x -s 100x100" "pile x --view points" \
  "study x --tasks 3" "repose x -m qecd" "repose x --view=all"; do
  run $words 2>&1 | lines 2
done
# so are those of samples where there is none
for verb in 'simplify -n 4 -o y.stl' 'curve' 'measure' 'check' 'repair -o y.stl' 'distance ball.stl' 'export -o y.obj' 'render -o y.png' \
  'choose' 'repose' 'drop'; do
  run $verb ball.stl --resolution 3mm 2>&1 | lines 2
done
run measure ball.stl --noise 0mm --sample-seed 2 2>&1 | lines 2
run repose ball.stl --sample-seed 2 2>&1 | lines 2
for words in 'ball.stl sample:box-12' --samples; do run choose $words --resolution 3mm --json --csv 2>&1 | lines 2; done
"$SCREE" curve ball.stl --distance --points 10 --grid 1e-5:1e-1:1 | wc -l
# what cannot both be is wrong usage, and so is an output of no known format
for words in '--largest --body 2 -o y.stl' '-o x.xyz' '-o -'; do
  "$SCREE" repair ball.stl $words 2>said
  echo "exit code $?: $(head -n 1 said)"
done
# one table of options: old spellings name the new one, near misses what may be meant
for words in 'chose x' 'choose x --tolerence 1' 'curve x --per-decade 3' 'distance x y -n 9' 'render x -o y.png -l 0.1' 'choose x -p' \
  'export x -t mm' 'pile x --picture y.png' 'measure sample:box --seed 3' 'repose x --print-config' 'drop x --number 3'; do
  run $words 2>&1 | lines 2
done
for words in 'export x --to LIGGGHTS -o y' 'choose x --tol 1' 'choose x --rule recomended' 'run --template Drumm'; do run $words 2>&1 | lines 2; done
# whoever reads the beginning alone ends it without a word, also where a broken pipe is ignored
(trap '' PIPE; for verb in run study choose repose clump; do "$SCREE" help --markdown $verb; done) 2>said | head -n 1 && cat said
# a length may carry its unit, without one it is in metres; shares may be in percent
run simplify ball.stl -r 50% -o half.off
"$SCREE" simplify ball.stl -r 0.5 -q -o again.off && tail -n +3 half.off >half && tail -n +3 again.off | cmp - half
run simplify ball.stl -r 50 -o no.off 2>&1 | lines 2
run simplify ball.stl -r half -o no.off 2>&1 | lines 2
run sample box-12 --noise 0.3 -o no.off 2>&1 | lines 2
for length in 300mm 0.3 30cm; do "$SCREE" repose --print --cylinder $length --band-low 30%; done | grep 'radius: 0.15\|^      band_low: 0.3' |
  sort | uniq -c | cut -c1-26
run drop sphere:40mm --width 3bananas 2>&1 | lines 2
# what cannot be meant is named
"$SCREE" repose --print --young 1e13 --friction 50 --density 2.65 2>&1 >/dev/null
"$SCREE" repose --print --young 1e13 -q 2>&1 >/dev/null

# a decimal comma is told as one
run choose sample:box --tolerance men=0.1% 2>&1 | lines 2
for words in 'choose sample:box --tolerance mean=0,1%' 'simplify ball.stl --rp 0,1% -o no.off' 'drop sphere:40mm --friction 0,3' 'repose sample:box --friction 0,3'; do
  run $words 2>&1 | lines 2
done

# of several settings the one that is wrong is named
run run --template drum --set materials.grain.young=0 --set time=0.1 2>&1 | lines 2

# a call that lasts says in a log where it stands, and what is left
"$SCREE" export --to liggghts -n 300 sample:fp-1 -o long >/dev/null 2>said &
while kill -0 $! 2>/dev/null && [ "$(grep -c '^scree, after .*: [0-9]* %, [0-9]* [a-z]* left$' said)" -lt 1 ]; do sleep 0.2; done
kill -INT $!
wait $!
echo "exit code $?"
grep -v '^scree, after ' said | sed 's/decimation was cancelled at .*/cancelled/; s/cancelled while .*/cancelled/' # wherever it was
# what a parameter was called before is told
"$SCREE" repose --set contact.friction_particle=0.4 --print 2>&1 >/dev/null | lines 1
