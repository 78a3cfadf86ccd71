# What cannot be written is said before any work: each input here is missing or broken, and only the output is told.
echo text >file
mkdir folder
touch there.stl there.json there.yaml
for output in nowhere/x.stl folder there.stl; do
  run simplify missing.stl -n 10 -o $output
  run repair missing.stl -o $output
  run sample nonsense -o $output 2>&1 | sed 's|nonsense.*|nonsense|'
done
run simplify missing.stl -n 10 --density 1000 -o there.off
run simplify missing.stl -n 10 --density 1000 -o - 2>&1 | lines 2
run repair missing.stl -f -o folder
run simplify missing.stl -n 10 -o x.xyz
run repair missing.stl -o -
run export missing.stl -o nowhere/x.stl
run render missing.stl -o nowhere/x.png
run pile missing.scree --vtp nowhere/x.vtp
run choose missing.stl -o file
run choose missing.stl -o file/x
mkdir -p old/levels && touch old/missing.mass.json
run choose missing.stl -o old
run drop missing.stl -o file
touch old/series.csv
run drop missing.stl -o old
run repose missing.stl -o file
touch old/scene.yaml
run repose missing.stl -o old
mkdir -p old/spheres && touch old/spheres/scene.yaml
run repose missing.stl --rp 0.1 --spheres -o old
printf 'name: x\nreplicates: 1\nshapes: [missing.stl]\nfactors: {rp: [1]}\n' >study.yaml
run study study.yaml -o file
ls -R | grep -c part
# what fails before anything was written leaves no folder, only those that were there
mkdir kept
for words in 'choose missing.stl' 'drop missing.stl' 'drop --resume' 'repose missing.stl' 'sample nonsense'; do
  run $words -o new 2>&1 | cut -c -60
  for folder in new/a/b kept kept/c/; do "$SCREE" $words -o $folder 2>/dev/null; done
  ls -d new* kept kept/* 2>/dev/null
done
# nor does a heap that is refused before it begins
box 20 30 40 >box.off
run repose box.off --particles 4 --cylinder 0.01 -o new
run repose box.off --particles 4 --cell 1 -o new
run repose box.off --particles 4 --rp 0.5,1 --cell 1 -o new
ls -d new* kept 2>/dev/null
# nor is a link that leads nowhere replaced unasked
ln -s nowhere.off dangling.off
run sample box-12 -o dangling.off
[ -L dangling.off ] && run sample box-12 -o dangling.off -f -q
# a limit on the size of files is told as a full disk is, and leaves nothing
mkdir limited && cd limited || exit
(ulimit -f 1 && run sample icosphere-3 -q -o ball.stl 2>&1) | cat
ls
# a name as long as names may be, of characters of two bytes
long=$(printf '\303\244%.0s' $(seq 125)).off
run sample box-12 -q -o "$long" >/dev/null && ls
run sample box-12 -q -o "long$long"
# a character that a terminal obeys may take two bytes
control=$(printf 'c\302\2331m.off')
box 1 2 3 >"$control"
"$SCREE" measure "$control" | sed -n 1p
"$SCREE" check "nothing-$control"
# one call at a time in a folder: the second is told of the first, and what a killed one left stops nobody
mkdir held && echo 1234 >held/.scree-lock
(
  flock 9
  run drop sample:box-12 -n 4 -o held -f 2>&1 | sed 's/since [0-9]* s/since N s/'
) 9<>held/.scree-lock
run drop sample:box-12 -n 4 --time 0.01 -o held -f -q >/dev/null 2>&1
ls -A held | grep -c scree-lock
