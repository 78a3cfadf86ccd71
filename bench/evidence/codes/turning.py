#!/usr/bin/env python3
"""Spheres in a drum that turns at three speeds: scree beside LIGGGHTS, from the same places, on the same triangles.

  turning.py run TABLE.csv RPM:SEEDS,... CODE...    CODE: scree, liggghts, or liggghts-no-dashpot, without its dashpots of sliding
                                                    and of rolling, liggghts-no-sliding, liggghts-no-rolling without that one;
                                                    adds to the table what it lacks
  turning.py compare TABLE.csv                      as CSV: slopes with standard errors, differences to scree

The slope is the direction of the spheres' common centre as seen from the axis: 0 is straight below, and a level surface that tilts
by an angle turns it by that angle. Rows are means over quarters of the second turn. Environment: LIGGGHTS (the program)."""
import math
import pathlib
import random
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, deviation, library, liggghts, main, mean, needs, processor_time, read, write_stl  # noqa: E402

D, RADIUS, HALF, COUNT, STEP, FILL, QUARTER = 0.006, 0.05, 0.01, 320, 5.3e-5, 0.3, 50
CODES = "scree", "liggghts", "liggghts-no-dashpot", "liggghts-no-sliding", "liggghts-no-rolling"


def places(seed):
    """The lowest of a jittered grid, three layers along the axis: rows of x, y, z."""
    rng, pitch, far = random.Random(seed), 1.08 * D, RADIUS - 0.54 * D
    grid = [(i * pitch, j * pitch, k * pitch) for k in range(-9, 10) for i in range(-9, 10) for j in (-1, 0, 1)
            if math.hypot(i, k) * pitch < far - 0.02 * D]
    return [[v + rng.uniform(-0.01, 0.01) * D for v in row] for row in grid[:COUNT]]


def drum():
    """Triangles of a shell of 90 sides with its two ends, seen from inside."""
    def corner(k, y):
        return RADIUS * math.cos(math.pi * k / 45), y, RADIUS * math.sin(math.pi * k / 45)
    found = []
    for k in range(90):
        a, b, c, d = corner(k, -HALF), corner(k + 1, -HALF), corner(k + 1, HALF), corner(k, HALF)
        found += [(a, b, c), (a, c, d), ((0, -HALF, 0), b, a), ((0, HALF, 0), d, c)]
    return found


def slope(x, z):
    return math.degrees(math.atan2(-x, -z))


def with_scree(rpm, rows, folder):
    (folder / "bodies.csv").write_text("\n".join(["shape,x,y,z", *("grain," + ",".join(map(repr, row)) for row in rows)]) + "\n")
    shutil.copy(HERE / "turning.yaml", folder)
    turn, found = 60 / rpm, []
    scene = library().Scene(str(folder / "turning.yaml"), {"geometry.drum.motion.0.rotate.speed": 2 * math.pi / turn, "time": FILL + 2 * turn + 1})
    scene.run(FILL + turn)
    for k in range(4 * QUARTER):
        scene.run(until=FILL + turn * (1 + (k + 1) / (4 * QUARTER)))
        at = scene.bodies().position.tolist()
        if len(at) != COUNT:
            sys.exit(f"{COUNT - len(at)} spheres left the drum: see {folder}")
        found.append(slope(mean([p[0] for p in at]), mean([p[2] for p in at])))
    print(f"scree: ledger {scene.sensors['ledger']:.1e}")
    return found


def with_liggghts(rpm, rows, folder, code):
    lines = [f"spheres\n\n{len(rows)} atoms\n2 atom types\n", "-0.06 0.06 xlo xhi\n-0.02 0.02 ylo yhi\n-0.06 0.06 zlo zhi\n\nAtoms\n"]
    lines += [f"{i + 1} 1 {D} 2500 {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(rows)]
    (folder / "spheres.data").write_text("\n".join(lines) + "\n")
    every, without = round(60 / rpm / (4 * QUARTER) / STEP), code.partition("-no-")[2]
    liggghts(HERE / "turning.in", folder, {"FILL": round(FILL / STEP), "PERIOD": 60 / rpm, "FIRST": round(60 / rpm / STEP), "EVERY": every,
                                           "LAST": every * 4 * QUARTER, "VISCOUS": 0 if without in ("dashpot", "rolling") else 0.3,
                                           "DASHPOT": "tangential_damping " + ("off" if without in ("dashpot", "sliding") else "on")})
    found = [slope(*map(float, line.split())) for line in open(folder / "places.txt") if not line.startswith("#")]
    return found[-4 * QUARTER:]


def one(rpm, seed, code):
    folder = WORK / "turning" / f"{rpm}-{seed}-{code}"
    folder.mkdir(parents=True, exist_ok=True)
    write_stl(folder / "drum.stl", drum())
    found = with_scree(rpm, places(seed), folder) if code == "scree" else with_liggghts(rpm, places(seed), folder, code)
    return [mean(found[k:k + QUARTER]) for k in range(0, 4 * QUARTER, QUARTER)]


def run(path, speeds, codes):
    needs("LIGGGHTS")
    table = Table(path, ["rpm", "seed", "code", "quarter", "slope_deg", "cpu_s"], 4)
    seeds = {int(rpm): int(count) for rpm, _, count in (s.partition(":") for s in speeds.split(","))}
    for seed in range(1, max(seeds.values()) + 1):
        for rpm, count in seeds.items():
            for code in codes:
                if seed > count or table.key((rpm, seed, code, 4)) in table.done:
                    continue
                begun = processor_time()
                found = one(rpm, seed, code)
                spent = processor_time() - begun
                for k, value in enumerate(found):
                    table.add(rpm, seed, code, k + 1, value, round(spent, 1))


def compare(path):
    """Quarters of turns count as independent."""
    groups = {}
    for row in read(path):
        groups.setdefault((int(row["rpm"]), row["code"]), []).append(float(row["slope_deg"]))
    print("rpm,code,quarters,slope_deg,error,less_scree,error")
    for rpm, code in sorted(groups, key=lambda key: (key[0], CODES.index(key[1]))):
        (m, error), (m0, error0) = ((mean(v), deviation(v) / math.sqrt(len(v))) for v in (groups[rpm, code], groups[rpm, "scree"]))
        other = "," if code == "scree" else f"{m - m0:.2f},{math.hypot(error, error0):.2f}"
        print(f"{rpm},{code},{len(groups[rpm, code])},{m:.2f},{error:.2f},{other}")


if __name__ == "__main__":
    main(run, compare, CODES, __doc__)
