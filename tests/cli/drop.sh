run drop 2>&1 | lines 2
run drop sphere:40 -o no 2>&1 | lines 2
run drop sphere:40mm=0 -o no 2>&1 | lines 2
# what stands behind '=' of a shape that is there is a count; a file may be called so all the same
for count in -3 3.5 1e3 x ''; do run drop "sphere:40mm=$count" -o no 2>&1 | lines 2; done
run drop no=body.off -o no
box 1 1 1 >a && cp a a=b && run drop a=c -o no 2>&1 | lines 2
run drop a=b -o named --time 0.01 --frames 0 --no-picture -N 1 -q >/dev/null && ls named | grep -c report && rm -r a a=b named
run drop sample:box-12 -r 0.1 -n 10 2>&1 | lines 2
run drop none.stl -o no
run drop sphere:40mm=3 -w 30mm -o no
run drop sphere:40mm=3 sample:box-12 -o out --resolution 0.02mm 2>&1 | lines 2
run drop none=5.stl -o no
ls
run drop sphere:40mm=3 --depth 30mm -o no 2>&1 | lines 2
run drop sphere:40mm=3 --width 0mm -o no 2>&1 | lines 2
# numbers may differ in their last digits between compilers: only their form is compared
shape() { sed 's/[0-9][0-9.]*\(e[-+][0-9]*\)*/N/g; s/-N/N/g; s/  */ /g'; }
drop() {
  { "$SCREE" drop "$@" --rays 1 --stiffness 1e-2 --progress 2>progress || cat progress; } | shape
}
drop sphere:40mm=3 sample:icosphere-1=4 --time 0.02 --frames 0.05 -o out
grep -c "steps/s" progress
ls out | sed 's/scene.png//' | grep .
sed -n 2p out/series.csv
grep -c DataSet out/bodies.pvd
run drop sphere:40mm=3 -o out
# the same bits again, another number of threads
drop sphere:40mm=3 sample:icosphere-1=4 --time 0.02 --frames 0.05 -o again -j 3 >/dev/null
for file in out/frame-*.vtp; do cmp "$file" again/"${file#out/}"; done
# begun anew: nothing of the earlier drop stays, and nothing else goes
touch out/mine.txt out/frame-x.vtp
drop sphere:40mm=1 --time 0 --frames 0 --no-picture -o out -f >/dev/null
ls out
# a box, without frames and picture
drop sphere:40mm=9 --container box -w 100mm --depth 60mm --frames 0 --no-picture --time 0 -o box | head -3
ls box
# Ctrl-C
"$SCREE" drop sphere:40mm=9 -o stopped --time 1000 --still 0 -q >text 2>&1 &
child=$!
tries=0
while ! [ -s stopped/frame-000001-bodies.vtp ] && [ $tries -lt 1000 ]; do
  sleep 0.1
  tries=$((tries + 1))
done
kill -INT $child
wait $child
echo "exit code $?"
ls stopped | grep -c part
grep -c "$(ls stopped/frame-*.vtp | tail -1 | sed 's/.*\///')" stopped/bodies.pvd
# clumps
printf 'x,y,z,r\n-12,0,0,10\n12,0,0,8\n0,0,5,9\n' >clump.csv
drop clump.csv=3 --frames 0 --no-picture --time 0 -o clumps | head -1
printf '1,2,3,-4\n' >negative.csv
printf '1,2,3\n' >three.csv
run drop negative.csv -o no
run drop three.csv -o no
# stopped, killed, and gone on with: the same files as those of a drop left alone
pour="sphere:40mm=6 sample:icosphere-1=6 --time 0.3 --still 0 --frames 0.05 --no-picture --stiffness 1e-2"
"$SCREE" drop $pour -o whole -q >/dev/null
for how in INT KILL; do
  "$SCREE" drop $pour -o cut --checkpoint 0.01 -q >/dev/null 2>&1 &
  child=$!
  tries=0
  while ! { [ -s cut/checkpoint.scree ] && [ -s cut/frame-000002-bodies.vtp ]; } && [ $tries -lt 1000 ]; do
    sleep 0.01
    tries=$((tries + 1))
  done
  kill -$how $child && echo "$how"
  wait $child 2>/dev/null
  [ $how = INT ] && again="" || again=$pour
  "$SCREE" drop $again --resume -o cut --time 0.3 --still 0 --frames 0.05 --no-picture -q >/dev/null || echo failed
  for file in whole/*; do
    case $file in
    # these know the command, or where the pour was stopped
    whole/checkpoint.scree | whole/result.json | whole/provenance.json | whole/scene.yaml | whole/report.html) continue ;;
    esac
    sed 1,2d "$file" >left.txt # names of files, and the command
    sed 1,2d "cut/${file#whole/}" | cmp - left.txt
  done
  ls whole >left.txt
  ls cut | cmp - left.txt
  [ $how = KILL ] || rm -r cut
done
run export cut/checkpoint.scree --view contacts -o contacts.vtp
# a drop that is done is done at once, or goes on for longer
"$SCREE" drop --resume -o cut --time 0.3 --still 0 --frames 0.05 --no-picture -q | head -1 | shape
"$SCREE" drop --resume -o cut --time 0.4 --still 0 --frames 0.05 --no-picture -q >/dev/null
ls whole/frame* cut/frame* | wc -l
run drop --resume -o cut --friction 0.4
run drop $pour --seed 3 --resume -o cut
run drop --resume -o cut --frames 0.01
run drop sphere:41mm=6 sphere:40mm=6 --stiffness 1e-2 --resume -o cut 2>&1 | grep -v mm
run drop --resume -o none
for words in '-r 0.5' '-n 12' '-N 5' --no-repair '-u m'; do run drop --resume -o cut $words 2>&1 | lines 2; done
head -c 300 cut/checkpoint.scree >short && mv short cut/checkpoint.scree
run drop --resume -o cut 2>&1 | sed 's/announces [0-9]*/announces more/' # where it stopped
