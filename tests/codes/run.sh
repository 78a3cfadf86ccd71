#!/bin/sh
# What `scree export --to CODE` writes, run by the code itself: one clump, and a few that fall into a box.
# A code that is not installed is left out; skipped (77) where none is. usage: run.sh PROGRAM
set -u
SCREE=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
fail() {
  echo "FAILED: $*"
  tail -n 20 ./*.log
  exit 1
}
# 0.6604... kg: the box's 69.12 mm cubed at 2000 kg/m3, whatever its spheres have
mass=0.66045
ran=0
for count in 1 4; do
  for code in lammps liggghts yade; do
    "$SCREE" export sample:box-12 --to $code -n 4 --particles $count -o $code-$count -q ||
      fail "scree export --to $code"
  done
  if command -v lmp >/dev/null; then
    ran=1
    (cd lammps-$count && OMP_NUM_THREADS=1 timeout 120 lmp -in in.box-12) >lammps.log 2>&1 || fail "lammps"
    grep -q WARNING.*Lost lammps.log && fail "lammps lost spheres"
    # index, id, mass, x, y, z of the last frame: all there, with the body's mass, at rest on the floor
    tail -n $count lammps-$count/bodies.dump |
      awk -v n=$count -v m=$mass '{ if ($3 < 0.999 * m || $3 > 1.001 * m || $6 < 0.02 || $6 > 0.5) bad = 1 }
        END { exit bad || NR != n }' || fail "lammps: bodies"
  fi
  if command -v liggghts >/dev/null; then
    ran=1
    (cd liggghts-$count && timeout 120 liggghts -in in.box-12) >liggghts.log 2>&1 || fail "liggghts"
    awk -v n=$count -v m=$mass '/ENTRIES c_/ { rows = 0; next } /^ITEM/ { next }
      $1 > 0.999 * m && $1 < 1.001 * m { rows++ } END { exit rows != n }' liggghts-$count/bodies.dump ||
      fail "liggghts: bodies"
  fi
  if command -v yade >/dev/null; then
    ran=1
    (cd yade-$count && timeout 120 yade -n -x box-12.py) >yade.log 2>&1 || fail "yade"
    grep -q "^$count clumps of 0.6604" yade.log || fail "yade: bodies"
  fi
done
# powders: grains of 60 um
"$SCREE" sample box-12 -o box.off -q
if command -v liggghts >/dev/null; then
  "$SCREE" export box.off -u um --to liggghts -n 2 --particles 2 -o powder -q || fail "scree export"
  (cd powder && timeout 120 liggghts -in in.box) >liggghts.log 2>&1 || fail "liggghts: powder"
fi
[ $ran = 1 ] || {
  echo "skipped: neither lmp nor liggghts nor yade"
  exit 77
}
