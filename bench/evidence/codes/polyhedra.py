#!/usr/bin/env python3
"""Octahedra and boxes from a lifted box: scree beside YADE's convex polyhedra, from the same places.

  polyhedra.py run TABLE.csv SEEDS VARIANT...     VARIANT: scree, yade, or scree:RESTITUTION, yade:DAMPING, yade-contacts, whose
                                                  damping leaves gravity alone
  polyhedra.py compare TABLE.csv                  as CSV: means, standard errors, differences
  polyhedra.py slide VARIANT...                   as CSV: the way of a box on a slope in 0.2 s beside the closed form

Rows: root mean square distance of the bodies from their common axis, mean height and angle by volume and centroid of the last
places of both. Environment: YADE (the program)."""
import json
import math
import pathlib
import random
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, commit, library, needs, processor_time, write_stl  # noqa: E402
from heaps import COLUMNS, compare, measured  # noqa: E402

A, HALF = 0.015, (0.011, 0.009, 0.007)
SHAPES = {
    "octahedron": [[A, 0, 0], [-A, 0, 0], [0, A, 0], [0, -A, 0], [0, 0, A], [0, 0, -A]],
    "box": [[i * HALF[0], j * HALF[1], k * HALF[2]] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)],
}
FACETS = {
    "octahedron": [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)],
    "box": [f for q in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
            for f in ((q[0], q[1], q[2]), (q[0], q[2], q[3]))],
}
COUNT, CLEAR = 36, 0.0325
DOWN = [0, 0, -9.81]
YOUNG = 1e9  # N/m3, of YADE: in series of two a face of 1 cm2 is as stiff as 5e4 N/m, a corner 1 mm deep presses with 0.3 N


def turn(rng):
    """A random orientation."""
    q = [rng.gauss(0, 1) for _ in range(4)]
    return [v / math.hypot(*q) for v in q]


def places(seed):
    """Layers of nine in the box, each body free to have any orientation: rows of place and quaternion."""
    rng, rows = random.Random(seed), []
    while len(rows) < COUNT:
        k = len(rows)
        i, j, layer = k % 3 - 1, k // 3 % 3 - 1, k // 9
        rows.append([i * CLEAR + rng.uniform(-1, 1) * 3e-4, j * CLEAR + rng.uniform(-1, 1) * 3e-4, 0.0165 + layer * CLEAR, *turn(rng)])
    return rows


def prepare(folder, shape, rows):
    write_stl(folder / "grain.stl", [[SHAPES[shape][k] for k in f] for f in FACETS[shape]])
    shutil.copy(HERE / "polyhedra.yaml", folder)
    lines = ["shape,x,y,z,qw,qx,qy,qz", *("grain," + ",".join(map(repr, row)) for row in rows)]
    (folder / "bodies.csv").write_text("\n".join(lines) + "\n")
    return folder / "polyhedra.yaml"


def with_scree(folder, shape, rows, value, gravity=DOWN, time=0.8):
    scene = library().Scene(str(prepare(folder, shape, rows)), {"materials.grain.restitution": float(value or 0.3), "gravity": gravity})
    scene.run(time)
    print(f"scree: ledger {scene.sensors['ledger']:.1e}", file=sys.stderr)
    return scene


def with_yade(folder, shape, rows, value, gravity=DOWN, time=0.8):
    text = (HERE / "polyhedra.yaml").read_text()
    slabs = [(json.loads(at), json.loads(size)) for size, at in re.findall(r"box: (\[.*?\]), at: (\[.*?\])", text)]
    case = {"corners": SHAPES[shape], "bodies": rows, "slabs": slabs, "young": YOUNG, "friction": 0.5,
            "damping": 0.3 if value == "contacts" else float(value or 0.3), "damp_gravity": value != "contacts", "gravity": gravity,
            "step": 1.2e-4, "lift": min(0.3, time), "speed": 0.6, "time": time}
    (folder / "case.json").write_text(json.dumps(case))
    told = subprocess.run([needs("YADE"), "-n", "-x", "-j1", str(HERE / "polyhedra_yade.py"), str(folder / "case.json")],
                          cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    last = [list(map(float, line.split()[1:])) for line in told.splitlines() if line.startswith("body ")]
    if len(last) != len(rows):
        sys.exit(f"YADE ended before the heap was there: see {folder}")
    return library().Scene(str(prepare(folder, shape, last)))


def go(variant, *case, **more):
    """The scene at its end, by the code that a variant names."""
    code, _, value = variant.replace("-", ":").partition(":")
    return {"scree": with_scree, "yade": with_yade}[code](*case, value, **more)


def run(path, seeds, variants):
    needs("YADE")
    table = Table(path, COLUMNS, 3)
    for seed in range(1, seeds + 1):
        for shape in SHAPES:
            for variant in variants:
                if table.key((shape, seed, variant)) in table.done:
                    continue
                folder = WORK / "polyhedra" / f"{shape}-{seed}-{variant.replace(':', '-')}"
                folder.mkdir(parents=True, exist_ok=True)
                begun = processor_time()
                found = measured(go(variant, folder, shape, places(seed)))
                table.add(shape, seed, variant, *found, round(processor_time() - begun, 1))


def slide(variants):
    """A box that starts at rest, flat on a slope, friction 0.5: half of the time squared times g (sin a - 0.5 cos a). In scree
    its tangential spring, softer than YADE's, gives way first: some 2 mm more."""
    needs("YADE")
    print(f"# commit {commit()}; polyhedra.py slide {' '.join(variants)}\ndegrees,variant,way_mm,closed_form_mm")
    folder = WORK / "polyhedra" / "slide"
    folder.mkdir(parents=True, exist_ok=True)
    for variant in variants:
        height = HALF[2]
        for degrees in (0, 15, 25, 28, 35):  # level first: how high it rests
            a = math.radians(degrees)
            gravity, closed = [9.81 * math.sin(a), 0, -9.81 * math.cos(a)], 9.81 * max(0, math.sin(a) - 0.5 * math.cos(a))
            x, _, z = go(variant, folder, "box", [[0, 0, height, 1, 0, 0, 0]], gravity=gravity, time=0.2).bodies().position.tolist()[0]
            height = height if degrees else z
            print(f"{degrees},{variant},{1e3 * x:.3f},{1e3 * 0.5 * 0.2 ** 2 * closed:.3f}")


if __name__ == "__main__":
    if len(sys.argv) > 4 and sys.argv[1] == "run":
        run(sys.argv[2], int(sys.argv[3]), sys.argv[4:])
    elif len(sys.argv) == 3 and sys.argv[1] == "compare":
        compare(sys.argv[2])
    elif len(sys.argv) > 2 and sys.argv[1] == "slide":
        slide(sys.argv[2:])
    else:
        sys.exit(__doc__)
