#!/bin/sh
# What `scree export --to CODE` writes, run by the code itself. A lopsided body, whose centre of mass is not that of its
# spheres: mass, moments and centre are read back, it falls freely without a turn, stays on a gentle incline and slides
# down a steep one as Coulomb says (LAMMPS), and some of it make a pile that loses none.
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
has() { command -v "$1" >/dev/null; }
has lmp || has liggghts || has yade || {
  echo "skipped: neither lmp nor liggghts nor yade"
  exit 77
}
# mm; the mass lies off the spheres' plane and off their middle
cat >body.csv <<'E'
x,y,z,radius
# volume 18000
# centroid 8 4 1
# inertia 1.6e6 2.6e6 3.4e6 3e5 1e5 0
-10,-10,0,8
25,-8,0,8
5,22,0,8
8,3,2,9
E
# a name with what means something in a script
mkdir strange
odd="strange/a #1 \$x é.csv"
cp body.csv "$odd"
for code in lammps liggghts yade pfc chrono edem mfix; do
  "$SCREE" export "$odd" --to $code --particles 1 -o "strange/$code" -q -u mm || fail "scree export --to $code"
done
find strange -mindepth 2 | grep '[#$é ]' && fail "names"
export OMP_NUM_THREADS=1
mass=0.036
near() { awk -v a="$1" -v b="$2" -v s="$3" 'BEGIN { d = a - b; if (d < 0) d = -d; exit !(d <= s * (a < 0 ? -a : a)) }'; }
# the principal moments of the inertia above at 2000 kg/m3, kg m2
moments="3.02396812e-06 5.36422709e-06 6.8118048e-06"
check_moments() { # CODE THREE-FOUND
  [ "$(printf '%s\n' $2 | sort -g | awk -v m="$moments" 'BEGIN { split(m, want, " ") }
    { d = $1 / want[NR] - 1; if (d * d > 1e-8) bad = 1 } END { print bad + 0, NR }')" = "0 3" ] || fail "$1: moments $2, not $moments"
}
# the row of the last frame: mass, x, y, z, vx, vy, vz, spin, moments
check_fall() { # CODE SPEED ROW...
  code=$1 speed=$2
  shift 2
  near $mass "$1" 1e-5 || fail "$code: mass $1"
  near "-$speed" "$7" 2e-3 || fail "$code: falls with $7 after -$speed"
  awk -v a="$8" -v b="$9" -v c="${10}" 'BEGIN { exit !(a * a + b * b + c * c < 1e-12) }' || fail "$code: turns in free fall: $8 $9 ${10}"
  check_moments "$code" "${11} ${12} ${13}"
}
rests() { awk '{ exit !(NF == 13 && $5 * $5 + $6 * $6 + $7 * $7 < 1e-6) }'; }
over() { awk -v s="$1" -v t="$2" 'BEGIN { printf "%d", t / s }'; }

# degrees: tan 40 = 0.839, friction 0.5; g (sin 40 - 0.5 cos 40) = 2.548 m/s2
steep_x=0.642788 steep_z=-0.766044 gentle_x=0.173648 gentle_z=-0.984808 slides=2.548
# what vx gains between the last frames of FILE, whose rows have COLUMNS, over SECONDS
gain() { awk -v n="$2" -v at="$3" -v t="$4" 'NF == n { v[++k] = $at } END { print (v[k] - v[k - 1]) / t }' "$1"; }

# ---- LAMMPS ----
if has lmp; then
  "$SCREE" export body.csv --to lammps --particles 1 --young 5e6 -o lammps -q -u mm || fail "scree export"
  # without sides, and a long floor
  sed '/^fix sides/d; s/^region box.*/region box block -5 5 -1 1 0 0.9 units box/
    s/^dump .*/dump bodies all local ${every} ${name} index c_bodies[*]/
    s/^region top.*/region top block -0.01 0.01 -0.01 0.01 ${from} 0.5 units box/; s/^thermo [0-9]*/thermo 1000/; s/^run .*/run ${steps}/' \
    lammps/in.body >lammps/in.wide
  step=$(awk '/^timestep/ { print $2 }' lammps/in.body)
  run_lammps() { # NAME FROM STEPS EVERY DOWN_X DOWN_Z
    (cd lammps && timeout 400 lmp -in in.wide -var name "$1" -var from "$2" -var steps "$3" -var every "$4" -var down_x "$5" -var down_z "$6") \
      >lammps.log 2>&1 || fail "lammps: $1"
  }
  row() { tail -n 1 "lammps/$1" | cut -d' ' -f3-; }
  steps=$(over "$step" 0.2)
  run_lammps fall 0.4 "$steps" "$steps" 0 -1
  # shellcheck disable=SC2046
  check_fall lammps "$(awk -v n="$steps" -v s="$step" 'BEGIN { print 9.81 * (n - 1) * s }')" $(row fall)
  half=$(over "$step" 0.6)
  run_lammps gentle 0.03 $((2 * half)) "$half" $gentle_x $gentle_z
  row gentle | rests || fail "lammps: does not stay on 10 degrees: $(row gentle)"
  run_lammps steep 0.03 $((2 * half)) "$half" $steep_x $steep_z
  gained=$(gain lammps/steep 15 7 "$(awk -v n="$half" -v s="$step" 'BEGIN { print n * s }')")
  near $slides "$gained" 0.05 || fail "lammps: slides down 40 degrees with $gained m/s2, not $slides"
  "$SCREE" export body.csv --to lammps --particles 8 -o lammps-8 -q -u mm || fail "scree export"
  (cd lammps-8 && timeout 400 lmp -in in.body) >lammps.log 2>&1 || fail "lammps: pile"
  tail -n 8 lammps-8/bodies.dump | awk -v m=$mass '{ if ($3 < 0.999 * m || $3 > 1.001 * m || $6 < 0.004 || $6 > 0.2) bad = 1 } END { exit bad || NR != 8 }' ||
    fail "lammps: pile of $(tail -n 8 lammps-8/bodies.dump)"
fi

# ---- LIGGGHTS ----
if has liggghts; then
  "$SCREE" export body.csv --to liggghts --particles 1 --young 5e6 -o liggghts -q -u mm || fail "scree export"
  sed '/^fix left/d; /^fix right/d; /^fix front/d; /^fix back/d; s/^region box.*/region box block -0.3 0.3 -0.3 0.3 -0.05 0.9 units box/
    s/^\(region top block\) [^u]*units/\1 -0.06 0.06 -0.06 0.06 ${from} ${to} units/; s/vel constant 0 0 -0.1/vel constant 0 0 0/
    s/^dump bodies all local [0-9]* [^ ]*/dump bodies all local ${every} ${name}/; s/^run [0-9][0-9]*$/run ${steps}/' liggghts/in.body |
    awk '/^run/ && !seen++ { print "run 1"; next } { print }' >liggghts/in.wide
  step=$(awk '/^timestep/ { print $2 }' liggghts/in.body)
  run_liggghts() { # NAME FROM TO STEPS EVERY DOWN_X DOWN_Z
    (cd liggghts && timeout 400 liggghts -in in.wide -var name "$1" -var from "$2" -var to "$3" -var steps "$4" -var every "$5" -var down_x "$6" \
      -var down_z "$7") >liggghts.log 2>&1 || fail "liggghts: $1"
  }
  row() { tail -n 1 "liggghts/$1"; }
  steps=$(over "$step" 0.2)
  run_liggghts fall 0.5 0.6 "$steps" 1 0 -1
  # shellcheck disable=SC2046
  check_fall liggghts "$(awk -v n="$steps" -v s="$step" 'BEGIN { print 9.81 * n * s }')" $(row fall)
  half=$(over "$step" 0.6)
  run_liggghts gentle 0.001 0.13 $((2 * half)) 1 $gentle_x $gentle_z
  row gentle | rests || fail "liggghts: does not stay on 10 degrees: $(row gentle)"
  # bodies of decimetres to powders: none is lost
  for unit in mm cm um; do
    "$SCREE" export body.csv --to liggghts --particles 8 -o liggghts-8 -q -f -u $unit || fail "scree export"
    (cd liggghts-8 && timeout 400 liggghts -in in.body) >liggghts.log 2>&1 || fail "liggghts: pile in $unit"
    awk '/ENTRIES c_/ { rows = 0; next } /^ITEM/ { next } NF == 13 && $4 > 0 { rows++ } END { exit rows != 8 }' liggghts-8/bodies.dump ||
      fail "liggghts: pile in $unit"
  done
fi

# ---- YADE ----
if has yade; then
  "$SCREE" export body.csv --to yade --particles 8 --young 5e6 -o yade -q -u mm || fail "scree export"
  (cd yade && timeout 400 yade -n -x body.py) >yade.log 2>&1 || fail "yade: pile"
  grep -q "^8 clumps of 0.036 kg" yade.log || fail "yade: pile"
  # its add_clump() in scenes of their own
  sed '/^clumps = \[\]/,$d' yade/body.py >yade/alone.py
  cat >>yade/alone.py <<'E'
def start(height, down, turn=Quaternion.Identity):
    O.bodies.clear(), O.interactions.clear()
    O.bodies.append(utils.wall(0, axis=2, sense=1, material=light))
    O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
                 InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()],
                                 [Law2_ScGeom_FrictPhys_CundallStrack()]),
                 NewtonIntegrator(damping=0.3, dampGravity=False, gravity=9.81 * Vector3(*down))]
    O.dt = 0.3 * min(s[3] for s in SPHERES) * (DENSITY / YOUNG) ** 0.5
    return O.bodies[add_clump((0, 0, height), turn)].state
def run(seconds):
    O.run(int(seconds / O.dt), True)
s = start(1, (0, 0, -1), Quaternion(Vector3(1, 2, 3).normalized(), 1))
print('CENTRE', (s.pos - Vector3(0, 0, 1)).norm())
before = O.time
run(0.2)
print('FALL', s.mass, *s.pos, *s.vel, *s.angVel, *s.inertia)
print('SPEED', 9.81 * (O.time - before))
s = start(0.5 * SIZE, (0.173648, 0, -0.984808))
run(2)
print('GENTLE', s.vel.norm())
E
  (cd yade && timeout 400 yade -n -x alone.py) >yade.log 2>&1 || fail "yade"
  said() { awk -v word="$1" '$1 == word { $1 = ""; print }' yade.log; }
  [ -n "$(said GENTLE)" ] || fail "yade"
  awk -v d="$(said CENTRE)" 'BEGIN { exit !(d < 1e-9) }' || fail "yade: the centre is $(said CENTRE) m off"
  # shellcheck disable=SC2046
  check_fall yade $(said SPEED) $(said FALL)
  awk -v d="$(said GENTLE)" 'BEGIN { exit !(d < 1e-3) }' || fail "yade: does not stay on 10 degrees: $(said GENTLE)"
fi
exit 0
