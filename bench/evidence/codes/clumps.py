#!/usr/bin/env python3
"""Rods of three touching spheres from a lifted tube: scree's clumps beside LIGGGHTS's multispheres and the rigid bodies of LAMMPS,
from the same places.

  clumps.py run TABLE.csv SEEDS VARIANT...   VARIANT: scree, lammps, liggghts, or liggghts-dashpot (its tangential dashpot
                                             on), liggghts-soft (a fourth of the stiffness)
  clumps.py compare TABLE.csv                as CSV: means, standard errors, differences

Rows: root mean square distance of the rods from their common axis, mean height and angle by volume and centroid of the last places of
all. LIGGGHTS fills the tube; its first places are where the others begin. Environment: LIGGGHTS, LMP (the programs)."""
import math
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, library, liggghts, needs, processor_time, write_stl  # noqa: E402
from heaps import COLUMNS, compare, measured  # noqa: E402

R, DENSITY, COUNT, STIFF, TUBE, HIGH = 0.0025, 2500, 100, 800.0, 0.025, 0.24
SPHERE = DENSITY * 4 / 3 * math.pi * R ** 3
PRIMES = (32452843, 49979687, 67867967, 86028121, 104395301, 122949823, 141650939, 160481183, 179424673, 198491317,
          217645199, 236887691, 256203161, 275604541, 295075147, 314606869, 334214459, 353868013, 373587883, 393342739,
          400000009, 420000029, 440000047, 460000141, 480000163, 500000183, 520000193, 540000203, 560000209, 580000217,
          600000239, 620000257, 640000321, 660000337, 680000339, 700000349, 720000397, 740000419, 760000421, 780000427)


def tube(path):
    def corner(z, k):
        return TUBE * math.cos(math.pi * k / 45), TUBE * math.sin(math.pi * k / 45), z
    quads = [(corner(0.0005, k), corner(0.0005, k + 1), corner(HIGH, k + 1), corner(HIGH, k)) for k in range(90)]
    write_stl(path, [three for a, b, c, d in quads for three in ((a, b, c), (a, c, d))])


def spheres(path):
    """Their centres. A rod's three follow each other by number."""
    rows = sorted([float(v) for v in line.split()] for line in open(path) if len(line.split()) == 4 and not line.startswith("ITEM"))
    if len(rows) != 3 * COUNT:
        sys.exit(f"{path}: {len(rows)} spheres, not {3 * COUNT}")
    return [row[1:] for row in rows]


def poses(path):
    """Of each rod its middle and the turn that takes x to its axis."""
    rows, found = spheres(path), []
    for k in range(0, len(rows), 3):
        a, b, c = rows[k:k + 3]
        axis = [(q - p) / (4 * R) for p, q in zip(a, c)]
        if abs(math.hypot(*axis) - 1) > 1e-3:
            sys.exit(f"{path}: spheres {k + 1} to {k + 3} are no rod")
        # q = 1 + x axis, up to its length
        turn = [1 + axis[0], 0.0, -axis[2], axis[1]] if axis[0] > -0.999999 else [0.0, 0.0, 1.0, 0.0]
        found.append([*b, *(v / math.hypot(*turn) for v in turn)])
    return found


def contact(stiff):
    pair = 0.9945 * math.sqrt(3 * SPHERE / 4 * stiff)  # 2 eta of a restitution of .3, Schwager and Poeschel 2007
    return {"STIFF": stiff, "PAIR": pair, "WALL": pair * math.sqrt(2)}


def with_liggghts(folder, seed, variant):
    """The variant "first" ends with the rods in the tube."""
    fall, lift = (0, 0) if variant == "first" else (11249, 28036)
    axial, across = 3 * 0.4 * SPHERE * R * R, 3 * 0.4 * SPHERE * R * R + 8 * SPHERE * R * R
    words = {**contact(STIFF / 4 if "soft" in variant else STIFF), "MASS": 3 * SPHERE, "AXIAL": axial, "ACROSS": across, "COUNT": COUNT,
             "SEED": PRIMES[seed - 1], "FALL": fall, "LIFT": lift, "DASHPOT": "tangential_damping " + ("on" if "dashpot" in variant else "off")}
    (folder / "rod.txt").write_text("".join(f"{x} 0 0 {R}\n" for x in (-2 * R, 0, 2 * R)))
    tube(folder / "tube.stl")
    liggghts(HERE / "clumps.in", folder, words)


def with_lammps(folder, first):
    lines = [f"rods\n\n{3 * COUNT} atoms\n1 atom types\n", "-0.6 0.6 xlo xhi\n-0.6 0.6 ylo yhi\n-0.02 0.7 zlo zhi\n\nAtoms\n"]
    lines += [f"{i + 1} 1 {x!r} {y!r} {z!r} {2 * R} {DENSITY} {i // 3 + 1}" for i, (x, y, z) in enumerate(spheres(first))]
    (folder / "rods.data").write_text("\n".join(lines) + "\n")
    liggghts(HERE / "clumps_lammps.in", folder, contact(STIFF), "LMP")


def scene(folder, rows):
    shutil.copy(HERE / "clumps.yaml", folder)
    tube(folder / "tube.stl")
    (folder / "rod.csv").write_text("x,y,z,radius\n" + "".join(f"{x},0,0,{R}\n" for x in (-2 * R, 0, 2 * R)))
    lines = ["shape,x,y,z,qw,qx,qy,qz", *("rod," + ",".join(map(repr, row)) for row in rows)]
    (folder / "bodies.csv").write_text("\n".join(lines) + "\n")
    return library().Scene(str(folder / "clumps.yaml"))


def prepared(seed, variant):
    folder = WORK / "clumps" / f"{seed}-{variant}"
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def first(seed):
    """Where LIGGGHTS has put the rods, before they fall."""
    path = prepared(seed, "first") / "first.txt"
    if not path.exists():
        with_liggghts(path.parent, seed, "first")
    return path


def one(seed, variant):
    folder = prepared(seed, variant)
    if variant == "scree":
        ours = scene(folder, poses(first(seed)))
        ours.run(1.1)
        print(f"scree: ledger {ours.sensors['ledger']:.1e}")
        return measured(ours)
    if variant == "lammps":
        with_lammps(folder, first(seed))
    else:
        with_liggghts(folder, seed, variant)
    return measured(scene(folder, poses(folder / "last.txt")))


def run(path, seeds, variants):
    needs("LIGGGHTS")
    if "lammps" in variants:
        needs("LMP")
    table = Table(path, COLUMNS, 3)
    for seed in range(1, seeds + 1):
        for variant in variants:
            if table.key(("rod", seed, variant)) not in table.done:
                begun = processor_time()
                found = one(seed, variant)
                table.add("rod", seed, variant, *found, round(processor_time() - begun, 1))


if __name__ == "__main__":
    if len(sys.argv) > 4 and sys.argv[1] == "run":
        run(sys.argv[2], int(sys.argv[3]), sys.argv[4:])
    elif len(sys.argv) == 3 and sys.argv[1] == "compare":
        compare(sys.argv[2])
    else:
        sys.exit(__doc__)
