#!/usr/bin/env python3
"""Spheres through a hole: scree beside LIGGGHTS, and Beverloo's law (Chemical Engineering Science 15, 260, 1961).

  orifice.py run FILE.csv SEEDS CODE...
                                  both codes from the same places, seed by seed; adds to the table what it lacks. CODE is scree,
                                  liggghts, or liggghts-no-dashpot: its tangential dashpot acts in every contact, scree's in
                                  those that last
  orifice.py compare FILE.csv     as CSV: each hole's rates, their relative difference, and the fits of
                                  W = C rho sqrt(g) (D - k d)^n; of the seeds that both codes have

A bin is 2 holes wide, its bed 2 holes high at the start. The rate is taken from when a fifth has left until half has: the
bed is then still a hole high. rho is what lies, meanwhile, in a box in the bed. Environment: LIGGGHTS (the program)."""
import math
import os
import pathlib
import random
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, deviation, library, mean, read  # noqa: E402

D, G, EVERY = 0.006, 9.81, 0.009
HOLES = (5.5, 6.25, 7.0, 8.0, 9.0)  # sphere diameters
FIRST, LAST, WIDE = 0.2, 0.5, 2
CODES = "scree", "liggghts", "liggghts-no-dashpot"
STUDENT = 6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895, 1.860, 1.833  # its quantile 0.95 of 1, 2, ... degrees of freedom
COLUMNS = ["hole", "seed", "code", "spheres", "from_s", "until_s", "count", "rate", "solid", "cpu_s"]


def places(hole, seed):
    """Jittered layers, each in the hollows of the one below, with a tenth of a diameter between neighbours: they settle by
    an eighth of their height. With 60 % of it solid the bed is then as high as the bin is wide."""
    rng, pitch, up, radius = random.Random(seed), 1.2 * D, 0.7 * D, 0.5 * WIDE * hole * D - 0.56 * D
    count, half, found, layer = round(0.9 * (WIDE * hole) ** 3), int(radius / pitch) + 1, [], 0
    while len(found) < count:
        for i in range(-half, half + 1):
            for j in range(-half, half + 1):
                x, y = ((k + 0.5 * (layer % 2)) * pitch for k in (i, j))
                if math.hypot(x, y) < radius and len(found) < count:
                    found.append([v + rng.uniform(-0.03, 0.03) * D for v in (x, y, 0.6 * D + layer * up)])
        layer += 1
    return found


def ring(path, inner, outer):
    """The floor about a hole of 90 corners, as STL."""
    def corner(r, k):
        return f"vertex {r * math.cos(math.pi * k / 45):.9g} {r * math.sin(math.pi * k / 45):.9g} 0"
    lines = ["solid ring"]
    for k in range(90):
        a, b, c, d = corner(inner, k), corner(outer, k), corner(outer, k + 1), corner(inner, k + 1)
        for three in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 1", "outer loop", *three, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid ring"]) + "\n")


def box(hole):
    """In the bed: half a hole to 1 above the floor, half the bin wide."""
    side = 0.25 * WIDE * hole * D
    return [-side, -side, 0.5 * hole * D], [side, side, hole * D]


def with_scree(spheres, hole, folder):
    lines = ["shape,x,y,z", *(f"grain,{x!r},{y!r},{z!r}" for x, y, z in spheres)]
    (folder / "bodies.csv").write_text("\n".join(lines) + "\n")
    shutil.copy(HERE / "scene.yaml", folder)
    low, high = box(hole)
    scene, rows = library().Scene(str(folder / "scene.yaml"), {"geometry.bin.cylinder.radius": 0.5 * WIDE * hole * D,
                                                               "sensors.bed.region.box.min": low, "sensors.bed.region.box.max": high}), []
    begun = time.process_time()
    while not rows or rows[-1][1] > (1 - LAST) * len(spheres) and rows[-1][0] < 10:
        scene.run(until=(len(rows) + 1) * EVERY)
        rows.append((scene.time, scene.sensors["bin.count"], scene.sensors["bed.count"]))
    return rows, time.process_time() - begun


def with_liggghts(spheres, hole, folder, code):
    low, high = box(hole)
    far = 0.5 * WIDE * hole * D + 0.01
    lines = [f"spheres\n\n{len(spheres)} atoms\n2 atom types\n", f"-{far} {far} xlo xhi\n-{far} {far} ylo yhi\n-0.03 0.45 zlo zhi\n\nAtoms\n"]
    lines += [f"{i + 1} 1 {D} 2500 {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(spheres)]
    (folder / "spheres.data").write_text("\n".join(lines) + "\n")
    words = {"RADIUS": 0.5 * WIDE * hole * D, "LEAST": round((1 - LAST) * len(spheres)),
             "BED": " ".join(f"{a} {b}" for a, b in zip(low, high)), "DASHPOT": "tangential_damping " + ("off" if "no" in code else "on")}
    text = (HERE / "liggghts.in").read_text()
    for name, value in words.items():
        text = text.replace(name, str(value))
    (folder / "liggghts.in").write_text(text)
    before = os.times().children_user
    subprocess.run([shutil.which(os.environ.get("LIGGGHTS", "liggghts")), "-in", "liggghts.in", "-log", "none"], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)
    rows = [tuple(map(float, line.split())) for line in open(folder / "counts.txt") if not line.startswith("#")]
    return rows, os.times().children_user - before


def one(hole, seed, code):
    folder, spheres = WORK / "orifice" / f"{hole}-{seed}-{code}", places(hole, seed)
    folder.mkdir(parents=True, exist_ok=True)
    ring(folder / "ring.stl", 0.5 * hole * D, 0.5 * WIDE * hole * D + 0.001)
    rows, seconds = with_scree(spheres, hole, folder) if code == "scree" else with_liggghts(spheres, hole, folder, code)
    begin = next(row for row in rows if row[1] <= (1 - FIRST) * len(spheres))
    end = next((row for row in rows if row[1] <= (1 - LAST) * len(spheres)), None)
    if not end:
        sys.exit(f"hole of {hole} diameters, seed {seed}, {code}: jammed, see {folder}")
    low, high = box(hole)
    solid = mean([row[2] for row in rows if begin[0] <= row[0] <= end[0]]) * math.pi / 6 * D ** 3
    solid /= math.prod(b - a for a, b in zip(low, high))
    return len(spheres), begin[0], end[0], int(begin[1] - end[1]), (begin[1] - end[1]) / (end[0] - begin[0]), solid, seconds


def run(path, seeds, codes):
    if not shutil.which(os.environ.get("LIGGGHTS", "liggghts")):
        print("skipped: LIGGGHTS is not installed")
        return
    table = Table(path, COLUMNS, 3)
    for seed in range(1, seeds + 1):
        for code in codes:
            for hole in HOLES:
                if table.key((hole, seed, code)) not in table.done:
                    table.add(hole, seed, code, *one(hole, seed, code))


def student(values):
    """Mean and half of the interval of 90 %."""
    return mean(values), STUDENT[len(values) - 2] * deviation(values) / math.sqrt(len(values))


def line(xs, ys):
    x, y = mean(xs), mean(ys)
    slope = sum((a - x) * (b - y) for a, b in zip(xs, ys)) / sum((a - x) ** 2 for a in xs)
    return y - slope * x, slope


def beverloo(rates, solids):
    """k and C with n = 5/2; C with k = 1.4; n with k = 1.4. In diameters: rate pi/6 / solid / sqrt(g/d) = C (D - k)^n."""
    flows = [rate * math.pi / 6 / solid / math.sqrt(G / D) for rate, solid in zip(rates, solids)]
    offset, slope = line(HOLES, [w ** 0.4 for w in flows])
    return (-offset / slope, slope ** 2.5, mean([w / (hole - 1.4) ** 2.5 for w, hole in zip(flows, HOLES)]),
            line([math.log(hole - 1.4) for hole in HOLES], [math.log(w) for w in flows])[1])


def compare(path):
    found = {(float(r["hole"]), int(r["seed"]), r["code"]): (float(r["rate"]), float(r["solid"])) for r in read(path)}
    print("what,code,seeds,mean,half_of_90,less_than_scree")
    for code in CODES:
        seeds = [s for s in sorted({key[1] for key in found}) if all((h, s, c) in found for h in HOLES for c in {"scree", code})]
        if len(seeds) < 2:
            continue

        def tell(what, values, other=""):
            print(f"{what},{code},{len(seeds)},{values[0]:.4g},{values[1]:.2g},{other}")
        differences = []
        for hole in HOLES:
            ours, theirs = ([found[hole, s, c][0] for s in seeds] for c in ("scree", code))
            difference, error = mean(ours) - mean(theirs), math.hypot(deviation(ours), deviation(theirs)) / math.sqrt(len(seeds))
            tell(f"rate {hole:g}", student(theirs), "" if code == "scree" else f"{difference / error:.1f} standard errors")
            differences.append([a / b - 1 for a, b in zip(ours, theirs)])
        if code != "scree":
            tell("scree more than this, share", student([mean(d) for d in zip(*differences)]))
        fits = [beverloo(*zip(*(found[hole, s, code] for hole in HOLES))) for s in seeds]
        for name, values in zip(("k", "C", "C with k = 1.4", "n with k = 1.4"), zip(*fits)):
            tell(name, student(values))
        tell("solid", student([mean([found[hole, s, code][1] for hole in HOLES]) for s in seeds]))


if __name__ == "__main__":
    if sys.argv[1:2] == ["run"] and len(sys.argv) > 4 and set(sys.argv[4:]) <= set(CODES):
        run(sys.argv[2], int(sys.argv[3]), sys.argv[4:])
    elif sys.argv[1:2] == ["compare"] and len(sys.argv) == 3:
        compare(sys.argv[2])
    else:
        sys.exit(__doc__)
