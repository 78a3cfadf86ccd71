#!/bin/bash
# Spheres beside LIGGGHTS on one core, with the same places, stiffness, damping, friction and step on both sides:
# a lifted tube, a sphere that rolls out, rates at rest and falling. Flow through holes: bench/evidence/orifice.
#
#   bench/liggghts.sh [SEEDS [SCENE...]]
#
# SEEDS (default 10) runs a scene and engine, of half a minute at most; needs liggghts (apt-get install liggghts).
# Writes results/liggghts.md; of scenes that are named, results/liggghts-SCENE.md by the first of them: tube, roll,
# rest1000, rest10000, rest100000, fall50000 (particle-steps a second; on an idle machine, three seeds).
# LIGGGHTS has its rolling model CDT, a constant couple; in the tube also EPSD, a spring up to the same couple, without a
# dashpot and with one of 0.3 of critical besides. Here it is a spring and such a dashpot, both together up to the same
# couple.
set -euo pipefail
. "$(dirname "$0")/lib.sh"
seeds=${1:-10}
named=("${@:2}")
[ ${#named[@]} -gt 0 ] || named=(tube roll rest1000 rest10000 rest100000 fall50000)
cmake -S "$root" --preset release -B "$build" -DSCREE_BENCH=ON -DBUILD_TESTING=OFF >/dev/null
cmake --build "$build" --target bench_spheres ${SCREE_BENCH_JOBS:+-j "$SCREE_BENCH_JOBS"} >/dev/null
scenes=$work/liggghts
mkdir -p "$scenes"

# places SEED: 800 centres in a column of 36 mm, a line each.
places() {
  awk -v seed="$1" 'BEGIN {
    srand(seed); p = 0.0066; left = 800
    for (z = 0.004; left > 0; z += p)
      for (i = -5; i <= 5; i++)
        for (j = -5; j <= 5; j++) {
          x = i * p + (rand() - 0.5) * 5e-4; y = j * p + (rand() - 0.5) * 5e-4
          if (x * x + y * y < 0.0328 ^ 2 && left-- > 0)
            printf "%.9g %.9g %.9g\n", x, y, z + (rand() - 0.5) * 5e-4
        }
  }'
}
# The tube of 72 mm, as STL.
awk '
  function corner(z, k) { printf "vertex %.9g %.9g %.9g\n", 0.036 * cos(w * k), 0.036 * sin(w * k), z }
  BEGIN {
    w = 2 * 3.14159265358979 / 90; print "solid tube"
    for (k = 0; k < 90; k++) {
      print "facet normal 0 0 0\nouter loop"; corner(0, k); corner(0.14, k); corner(0.14, k + 1)
      print "endloop\nendfacet\nfacet normal 0 0 0\nouter loop"; corner(0, k); corner(0.14, k + 1)
      corner(0, k + 1); print "endloop\nendfacet"
    }
    print "endsolid tube"
  }' >"$scenes/tube.stl"

# property NAME PAIR WALL: of sphere and sphere, sphere and wall.
property() { echo "fix $1 all property/global $1 peratomtypepair 2 $2 $3 $3 $2"; }
# lammps SCENE PLACES ROLLING [VISCOUS]: the input; damping 2 eta sqrt(m K) of e = 0.3, force cut off at 0.
lammps() {
  local options='absolute_damping on limitForce on' model="model hooke/stiffness tangential history rolling_friction $3"
  local side=${5:-} box='-0.5 0.5 -0.5 0.5 -0.02 0.2'
  [ -z "$side" ] || box="-0.01 $(awk "BEGIN { print $side + 0.01 }") -0.01 $(awk "BEGIN { print $side + 0.01 }") -0.02 2"
  cat <<I
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
units si
region box block $box units box
create_box 2 box
neighbor 0.001 bin
neigh_modify delay 0
I
  echo 'fix youngs all property/global youngsModulus peratomtype 5.e6 5.e6'
  echo 'fix poisson all property/global poissonsRatio peratomtype 0.3 0.3'
  property kn 1000 1000
  property kt 1000 1000
  property gamman_abs 0.373919 0.528802
  property gammat_abs 0.373919 0.528802
  property coefficientFriction 0.5 0.5
  property coefficientRollingFriction 0.2 0.2
  [ -z "${4:-}" ] || property coefficientRollingViscousDamping "$4" "$4"
  property coefficientRestitution 0.3 0.3
  echo "pair_style gran $model $options"
  echo 'pair_coeff * *'
  echo 'timestep 2.5e-5'
  echo 'fix weight all gravity 9.81 vector 0 0 -1'
  echo "fix floor all wall/gran $model primitive type 2 zplane 0.0 $options"
  if [ "$1" = tube ]; then
    echo "fix tube all mesh/surface file $scenes/tube.stl type 2"
    echo "fix walls all wall/gran $model mesh n_meshes 1 meshes tube $options"
  fi
  if [ -n "$side" ]; then
    local wall=0 plane
    for plane in 'xplane 0.0' "xplane $side" 'yplane 0.0' "yplane $side"; do
      echo "fix side$((wall++)) all wall/gran $model primitive type 2 $plane $options"
    done
    awk -v box="$box" 'BEGIN { split(box, b, " ") } { at[NR] = $0 } END {
      printf "places\n\n%d atoms\n2 atom types\n%g %g xlo xhi\n%g %g ylo yhi\n%g %g zlo zhi\n\nAtoms\n\n", NR, b[1], b[2], b[3],
        b[4], b[5], b[6]
      for (i = 1; i <= NR; i++) print i, 1, 0.006, 2500, at[i] }' "$2" >"$scenes/places.data"
    echo "read_data $scenes/places.data add"
  elif [ "$1" = roll ]; then
    echo 'create_atoms 1 single 0 0 0.003 units box'
  else
    awk '{ print "create_atoms 1 single", $1, $2, $3, "units box" }' "$2"
  fi
  echo 'set group all diameter 0.006 density 2500'
  [ "$1" != roll ] || echo 'velocity all set 0.5 0 0 units box'
  echo 'fix motion all nve/sphere'
  echo 'thermo_modify lost ignore' # what leaves the box does not count
  echo "dump places all custom 1000000 $scenes/places.txt id x y z"
  local write="undump places
dump places all custom 1 $scenes/places.txt id x y z
run 0
undump places
shell mv $scenes/places.txt $scenes"
  case $1 in
  rest* | fall*) printf 'thermo 1000000\nrun %d\nrun %d\n' $(($6 / 10)) "$6" ;;
  tube) printf 'run 14000\nfix lift all move/mesh mesh tube linear 0. 0. 0.1\nrun 38000\n%s/last.txt\n' "$write" ;;
  roll) printf 'run 40000\n%s/last.txt\n' "$write" ;;
  esac
}
# of_places SCENE FILE: the value that bench_spheres prints.
of_places() {
  awk -v scene="$1" '/ITEM: ATOMS/ { atoms = 1; next } !atoms { next } { n++; r2 += $2 * $2 + $3 * $3; x = $2 }
    END { print 1000 * (scene == "tube" ? sqrt(r2 / n) : x) }' "$2"
}
# peer SCENE PLACES ROLLING [VISCOUS]: value and CPU seconds.
peer() {
  rm -f "$scenes"/{places,last}.txt
  lammps "$@" >"$scenes/in"
  local TIMEFORMAT=%U seconds
  seconds=$({ time liggghts -in "$scenes/in" -log "$scenes/log" >"$scenes/screen" 2>&1; } 2>&1) || tail -3 "$scenes/screen" >&2
  echo "$(of_places "$1" "$scenes/last.txt") $seconds"
}
# rates SCENE SEED: rows of both, in turns. At rest from a lattice of spheres that nearly touch; falling far apart.
rates() {
  local count=${1#[a-z][a-z][a-z][a-z]} pitch=0.006 side steps
  [[ $1 == rest* ]] || pitch=0.009
  steps=$((1 + 20000000 / count))
  side=$(awk "BEGIN { print $pitch * int($count ^ (1 / 3) + 0.999) }")
  awk -v count="$count" -v pitch=$pitch -v side="$side" -v seed="$2" -v low="$([[ $1 == rest* ]] || echo 0.5)" 'BEGIN {
    srand(seed); n = int(side / pitch + 0.5)
    for (k = 0; k < count; k++)
      printf "%.9g %.9g %.9g\n", pitch * (k % n + 0.5) + (rand() - 0.5) * 2e-4, pitch * (int(k / n) % n + 0.5) + (rand() - 0.5) * 2e-4,
        low + pitch * (int(k / n / n) + 0.52) + (rand() - 0.5) * 2e-4 }' >"$scenes/lattice"
  if [[ $1 == rest* ]]; then "$bin/bench_spheres" rest "$scenes/lattice" "$side" >"$scenes/box"; else mv "$scenes/lattice" "$scenes/box"; fi
  echo "$1 scree $("$bin/bench_spheres" rate "$scenes/box" "$side" "$steps" | awk '{ print $1 / 1e6, $2 }')" >>"$rows"
  lammps "$1" "$scenes/box" cdt '' "$side" "$steps" >"$scenes/in"
  liggghts -in "$scenes/in" -log "$scenes/log" >"$scenes/screen" 2>&1 || tail -3 "$scenes/screen" >&2
  awk -v name="$1" '/^Loop time/ { t = $4; w = $9 * $12 / 1e6; all += t } END { print name, "liggghts,cdt", w / t, all }' "$scenes/log" >>"$rows"
}
rows=$scenes/rows
: >"$rows"
for ((seed = 1; seed <= seeds; seed++)); do
  places "$seed" >"$scenes/at"
  for scene in "${named[@]}"; do
    [ $scene != roll ] || [ "$seed" = 1 ] || continue
    case $scene in rest* | fall*)
      [ "$seed" -gt 3 ] || rates "$scene" "$seed"
      continue ;;
    esac
    echo "$scene scree $("$bin/bench_spheres" $scene "$scenes/at")" >>"$rows"
    echo "$scene liggghts,cdt $(peer $scene "$scenes/at" cdt)" >>"$rows"
    [ $scene = tube ] || continue
    for viscous in 0 0.3; do
      echo "$scene liggghts,epsd,$viscous $(peer $scene "$scenes/at" epsd $viscous)" >>"$rows"
    done
  done
done

{
  echo '# Spheres beside LIGGGHTS'
  echo
  provenance "bench/liggghts.sh $seeds ${*:2}" | sed 's/^# /    /'
  echo "    $(cd "$scenes" && liggghts -h 2>/dev/null | grep -m1 -o 'PUBLIC [0-9.]*' | sed 's/^/LIGGGHTS-/' || true), one core each, in turns"
  echo
  echo '| scene | engine | n | mean | standard error | CPU s a run |'
  echo '|---|---|--:|--:|--:|--:|'
  awk 'BEGIN { what["tube"] = "lifted tube, rms radius of the heap (mm)"; what["roll"] = "a sphere of 0.5 m/s stops after (mm)"
      split("1000 10000 100000", c, " "); for (i in c) what["rest" c[i]] = c[i] " spheres at rest, 1e6 particle-steps/s"
      what["fall50000"] = "50000 spheres that fall, 1e6 particle-steps/s" }
    { k = $1 " " $2; if (!(k in n)) order[++m] = k; n[k]++; s[k] += $3; q[k] += $3 * $3; t[k] += $4 }
    END { for (i = 1; i <= m; i++) { k = order[i]; split(k, name, " "); mean = s[k] / n[k]
      v = n[k] > 1 ? (q[k] - n[k] * mean * mean) / (n[k] - 1) : 0
      printf "| %s | %s | %d | %.2f | %s | %.1f |\n", what[name[1]], name[2], n[k], mean,
        (n[k] > 1 ? sprintf("%.2f", sqrt((v > 0 ? v : 0) / n[k])) : "-"), t[k] / n[k] } }' "$rows"
} >"$results/liggghts${2:+-$2}.md"
