# Folders and files with spaces and letters beyond ASCII, for every verb; then standard output that is closed,
# full, or the output file itself.
mkdir 'ä b' && cd 'ä b' || exit
ok() {
  "$SCREE" "$@" -q >said 2>&1 && return
  echo "exit code $? of scree $*"
  cat said
}
ok sample icosphere-3 -o 'bäll 1.stl'
ok sample fp-1 --resolution 3mm --noise 0mm -o 'sämples 1'
ok check 'bäll 1.stl'
ok repair 'bäll 1.stl' -o 'repaired ü.ply'
ok measure 'bäll 1.stl'
ok distance 'bäll 1.stl' 'repaired ü.ply' --points 100
ok simplify 'bäll 1.stl' -n 100 -o 'lével 1.obj'
ok curve 'bäll 1.stl' --grid 1e-5:1e-1:1
ok choose 'bäll 1.stl' 'sämples 1/fp-1.stl' -o 'chösen 1'
ok report 'chösen 1' -o 'päge 1.html'
ok drop 'lével 1.obj=2' -o 'pöur 1' --time 0.02 --no-picture
ok repose 'lével 1.obj' -o 'heäp 1' -p demo --particles 2 --pack-time 0.02 --settle-time 0.01 --lift-time 0.01 \
  --hold-time 0.01 --no-picture
ok pile 'heäp 1/last.scree' --vtp 'sëries 1.vtp'
ok export 'heäp 1/last.scree' -o 'pöints 1.vtp' --view points
"$SCREE" render 'bäll 1.stl' 'lével 1.obj' -o 'pïcture 1.png' --size 64x64 --rays 1 2>said >&2 ||
  grep -q 'without Embree\|not built' said || cat said
cat >'stüdy 1.yaml' <<'YAML'
name: tiny
replicates: 1
shapes: ["lével 1.obj"]
base:
  preset: demo
  particles: 2
  phases: {pack_time: 0.02, settle_time: 0.01, lift_time: 0.01, hold_time: 0.01}
factors:
  rp: [spheres]
YAML
ok study 'stüdy 1.yaml' -o 'stüdy 1' --jobs 2
LC_ALL=C ls

# what is printed and cannot be is an error
for words in version help "help choose" "measure bäll*" "sample --list"; do
  for stream in '/dev/full' '&-'; do
    (eval "IFS=' '; \"\$SCREE\" $words >$stream" 2>&1)
    echo "scree $words >$stream: exit code $?"
  done
done
"$SCREE" simplify 'bäll 1.stl' -n 20 -o twenty.ply >&- 2>&-
echo "exit code $?"
head -c 3 twenty.ply
echo
# devices and pipes are written to as they are, and stay what they are
"$SCREE" simplify 'bäll 1.stl' -n 20 -o - -q >/dev/full
echo "exit code $?"
"$SCREE" drop sphere:40mm -N 1 --time 0 -o full --no-picture --frames 0 -q >/dev/full
echo "exit code $?"
mkfifo pipe.ply
grep -av ^comment twenty.ply >expected
grep -av ^comment pipe.ply | cmp expected - &
run simplify 'bäll 1.stl' -n 20 -o pipe.ply -q
wait $! && [ -p pipe.ply ] && echo "through a pipe: the same"
ln -s /dev/full full.png
run render 'bäll 1.stl' -o full.png -q --size 64x64 --rays 1
[ -c full.png ] && echo "a device stays a device"
