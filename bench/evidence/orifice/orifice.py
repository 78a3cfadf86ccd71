#!/usr/bin/env python3
"""Spheres through a hole: scree beside LIGGGHTS, and Beverloo's law (Chemical Engineering Science 15, 260, 1961).

  orifice.py run FILE.csv HOLE:SEEDS,... CODE...
                                  from the same places, seed by seed; adds to the table what it lacks. HOLE is in diameters.
                                  CODE is scree, liggghts, or liggghts-no-dashpot: its tangential dashpot acts in every
                                  contact, scree's in those that last; yade, which has none
  orifice.py compare FILE.csv     as CSV: each hole's rates, their relative difference, and the fits of
                                  W = C rho sqrt(g) (D - k d)^n, with half of their intervals of 90 %

A rate scatters from seed to seed by s / sqrt(count); s is of all holes and codes together, since a large hole has few
seeds. Intervals of fits are those of rates drawn anew with their scatter.

A bin is 2 holes wide, its bed 2 holes high at the start. The rate is taken from when a fifth has left until half has: the
bed is then still a hole high. rho is what lies, meanwhile, in a box in the bed. Environment: LIGGGHTS, YADE (the programs)."""
import json
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
from common import WORK, Table, deviation, library, liggghts, main, mean, needs, read, student, write_stl  # noqa: E402

D, G, EVERY = 0.006, 9.81, 0.009
FIRST, LAST, WIDE = 0.2, 0.5, 2
CODES = "scree", "liggghts", "liggghts-no-dashpot", "yade"
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


def ring(first, second):
    """Triangles between two rings of 90 corners, each a radius and a height."""
    def corner(r, z, k):
        return r * math.cos(math.pi * k / 45), r * math.sin(math.pi * k / 45), z
    quads = [(corner(*first, k), corner(*second, k), corner(*second, k + 1), corner(*first, k + 1)) for k in range(90)]
    return [three for a, b, c, d in quads for three in ((a, b, c), (a, c, d))]


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
    before = os.times().children_user
    liggghts(HERE / "liggghts.in", folder, words)
    rows = [tuple(map(float, line.split())) for line in open(folder / "counts.txt") if not line.startswith("#")]
    return rows, os.times().children_user - before


def with_yade(spheres, hole, folder):
    """Its cylinder has 90 sides."""
    radius = 0.5 * WIDE * hole * D
    case = {"spheres": spheres, "diameter": D, "facets": ring((0.5 * hole * D, 0), (radius + 0.001, 0)) + ring((radius, 0), (radius, 0.4)),
            "kn": 1000, "damping": [0.373919, 0.528802], "friction": 0.5, "step": 3.75e-5, "every": round(EVERY / 3.75e-5),
            "least": round((1 - LAST) * len(spheres)), "box": box(hole)}
    (folder / "case.json").write_text(json.dumps(case))
    before = os.times().children_user
    told = subprocess.run([needs("YADE"), "-n", "-x", "-j1", str(HERE / "orifice_yade.py"), str(folder / "case.json")], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    return [tuple(map(float, line.split()[1:])) for line in told.splitlines() if line.startswith("row ")], os.times().children_user - before


def one(hole, seed, code):
    folder, spheres = WORK / "orifice" / f"{hole}-{seed}-{code}", places(hole, seed)
    folder.mkdir(parents=True, exist_ok=True)
    write_stl(folder / "ring.stl", ring((0.5 * hole * D, 0), (0.5 * WIDE * hole * D + 0.001, 0)))
    rows, seconds = with_liggghts(spheres, hole, folder, code) if "liggghts" in code else \
        {"scree": with_scree, "yade": with_yade}[code](spheres, hole, folder)
    begin = next(row for row in rows if row[1] <= (1 - FIRST) * len(spheres))
    end = next((row for row in rows if row[1] <= (1 - LAST) * len(spheres)), None)
    if not end:
        sys.exit(f"hole of {hole} diameters, seed {seed}, {code}: jammed, see {folder}")
    low, high = box(hole)
    solid = mean([row[2] for row in rows if begin[0] <= row[0] <= end[0]]) * math.pi / 6 * D ** 3
    solid /= math.prod(b - a for a, b in zip(low, high))
    return len(spheres), begin[0], end[0], int(begin[1] - end[1]), (begin[1] - end[1]) / (end[0] - begin[0]), solid, seconds


def run(path, holes, codes):
    needs("YADE" if "yade" in codes else "LIGGGHTS")
    table, seeds = Table(path, COLUMNS, 3), {hole: int(count) for hole, _, count in (h.partition(":") for h in holes.split(","))}
    for seed in range(1, max(seeds.values()) + 1):
        for code in codes:
            for hole, count in seeds.items():
                if seed <= count and table.key((hole, seed, code)) not in table.done:
                    table.add(hole, seed, code, *one(float(hole), seed, code))


def line(points):
    """Weighted least squares of x, y, weight: offset and slope."""
    whole = sum(p[2] for p in points)
    x, y = (sum(p[k] * p[2] for p in points) / whole for k in (0, 1))
    slope = sum(w * (a - x) * (b - y) for a, b, w in points) / sum(w * (a - x) ** 2 for a, _, w in points)
    return y - slope * x, slope


def beverloo(rates):
    """Rows of hole, flow, weight of the flow's logarithm: k and C with n = 5/2, C and n with k = 1.4. In diameters:
    flow = rate pi/6 / solid / sqrt(g/d) = C (D - k)^n."""
    offset, slope = line([(hole, w ** 0.4, weight / w ** 0.8) for hole, w, weight in rates])
    whole = sum(row[2] for row in rates)
    return (-offset / slope, slope ** 2.5,
            math.exp(sum(weight * math.log(w / (hole - 1.4) ** 2.5) for hole, w, weight in rates) / whole),
            line([(math.log(hole - 1.4), math.log(w), weight) for hole, w, weight in rates])[1])


def scatter(groups):
    """s of a rate's relative scatter s / sqrt(count), and Student's quantile 0.95 of its degrees of freedom."""
    free = sum(len(rows) - 1 for rows in groups.values())
    s2 = sum(row[1] * (row[0] / mean([r[0] for r in rows]) - 1) ** 2 for rows in groups.values() for row in rows) / free
    return math.sqrt(s2), student(free)


def compare(path):
    groups = {}
    for r in read(path):
        groups.setdefault((r["code"], float(r["hole"])), []).append((float(r["rate"]), float(r["count"]), float(r["solid"])))
    (s, student), rng = scatter(groups), random.Random(1)
    print("what,code,seeds,mean,half_of_90,scree_less_this,half_of_90")
    print(f"scatter x sqrt(count),,,{s:.3g},,,")
    for code in CODES:
        holes = sorted(hole for c, hole in groups if c == code and ("scree", hole) in groups)
        rows, differences = [], []
        for hole in holes:
            (rate, sd, count), (ours, ours_sd, _) = (summary(groups[c, hole], s) for c in (code, "scree"))
            differences.append((ours / rate - 1, sd * sd + ours_sd * ours_sd))
            other = "" if code == "scree" else f"{differences[-1][0]:.4f},{student * math.sqrt(differences[-1][1]):.3f}"
            print(f"rate of {hole:g},{code},{count},{rate:.5g},{student * sd * rate:.2g},{other or ','}")
            solid = mean([row[2] for row in groups[code, hole]])
            rows.append((hole, rate * math.pi / 6 / solid / math.sqrt(G / D), sd))
        if len(holes) < 3:
            continue
        if code != "scree":
            half = student * math.sqrt(sum(d[1] for d in differences)) / len(holes)
            print(f"mean of all holes,{code},,,,{mean([d[0] for d in differences]):.4f},{half:.3f}")
        drawn = [beverloo([(h, w * math.exp(sd * rng.gauss(0, 1)), sd ** -2) for h, w, sd in rows]) for _ in range(1000)]
        for name, value, draws in zip(("k", "C", "C with k = 1.4", "n with k = 1.4"),
                                      beverloo([(h, w, sd ** -2) for h, w, sd in rows]), zip(*drawn)):
            print(f"{name},{code},,{value:.4g},{student * deviation(draws):.2g},,")
        print(f"solid,{code},,{mean([mean([row[2] for row in groups[code, h]]) for h in holes]):.4g},,,")


def summary(rows, s):
    """Mean rate, its relative standard error, how many."""
    return mean([row[0] for row in rows]), s / math.sqrt(sum(row[1] for row in rows)), len(rows)


if __name__ == "__main__":
    main(run, compare, CODES, __doc__)
