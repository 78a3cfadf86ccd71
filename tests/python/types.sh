#!/bin/sh
# Type hints by mypy: the module agrees with its own, and one who uses it is told of a wrong use.
# usage: types.sh SOURCE_DIR      Exits 77 where there is no mypy.
set -eu
command -v mypy >/dev/null || {
  echo "skipped: mypy is not installed (Debian: mypy)"
  exit 77
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export MYPYPATH="$1/python"
mypy --ignore-missing-imports --cache-dir "$folder/cache" -p scree
cat >right.py <<'EOF'
import scree

scan: scree.Mesh = scree.load("phone.stl", unit="mm")
choice = scan.choose(tolerances={"widths": 0.02, "mean": 0.002})
count: int = choice.recommended.triangle_count + choice.mesh().triangle_count
answer: str = choice.answer
cost: float = choice.export("mujoco").volume_error + scan.export("a.stl").mass + scan.volume + scan.check().triangle_count
world = scree.World(law="hertz")
index: int = world.add_body(scree.Particle(scan), world.add_material(), position=(0, 0, 1))
scree.Scene("drum.yaml", {"time": 2}).every(0.1, lambda scene: print(scene.sensors["inside"]))
EOF
mypy --strict --follow-imports=silent --cache-dir "$folder/cache" right.py
# the examples as their readers type them; that for YADE speaks YADE's own Python
for example in "$1"/examples/*.py; do
  [ "$(basename "$example")" = pile_to_yade.py ] || (cd "$1/examples" && mypy --strict --follow-imports=silent --cache-dir "$folder/cache" "$example")
done
python3 "$1/tools/python-records.py" --check
while read -r wrong; do
  printf 'import scree\nscan = scree.sample("box")\nworld = scree.World()\n%s\n' "$wrong" >wrong.py
  if mypy --cache-dir "$folder/cache" wrong.py >said; then
    echo "not told: $wrong"
    exit 1
  fi
done <<'EOF'
scan.simplify(count="100")
world.step("5")
world.add_body(scan, 0)
text: str = scan.triangle_count
scan.choose().recommended.trianglecount
scan.choose(tolerence={"widths": 0.1})
scan.measure().volum
scan.choose().export("mujocco")
scan.check(intersection=True)
scree.Particle(scan).measure().mass
scree.Particle.clump_of(scan)
EOF
