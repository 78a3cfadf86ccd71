#!/usr/bin/env python3
"""Norm blocks that hit an alpine slope with spin (Chant Sura; Caviezel and others, Earth Surface Dynamics 7, 199, 2019): measured
velocities and spins before and after, beside blocks of the same shape that hit a plane in all orientations.

  impacts.py measured               the impacts, as CSV: speeds against and along the slope and spin, before and after
  impacts.py grid TABLE.csv         means and quantiles of 64 orientations, by impact, restitution and friction; adds what the table lacks
  impacts.py compare TABLE.csv      the best settings on the first part, and what they tell of the part kept back

The slope is the plane of least squares through the ground within 0.4 m. How a block stood when it hit is not told. Only impacts of
the wheel-shaped block with both spins count. Environment: SCREE_EVIDENCE_DIR with a folder chantsura: observed_contact_events_,
observed_trajectories_contact_ and terrain_rf16_contact_ of extended and heldout, as the repository ofuhrer/rust_rockfall
(MIT) has them from doi 10.16904/envidat.174 (WSL Data Policy)."""
import itertools
import math
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, data, deviation, library, mean, read, show, write_stl  # noqa: E402

PARTS = {"fitted": "extended", "kept back": "heldout"}
DENSITY, COUNT = 2670, 64
SIDES = 1.413631, 1.413631, 0.706816    # m, of a cubic metre
WHAT = "against", "along", "spin"
RESTITUTION, FRICTION = (0.05, 0.2, 0.35, 0.5, 0.65, 0.8), (0.2, 0.35, 0.5, 0.7, 1.0, 1.4)


def ground(path):
    lines = path.read_text().splitlines()
    head = {line.split()[0].lower(): float(line.split()[1]) for line in lines[:6]}
    rows, cell = [list(map(float, line.split())) for line in lines[6:] if line.strip()], head["cellsize"]
    return [(head["xllcorner"] + (j + 0.5) * cell, head["yllcorner"] + (len(rows) - i - 0.5) * cell, z)
            for i, row in enumerate(rows) for j, z in enumerate(row) if z > 0]


def normal(points, x, y):
    near = [(a - x, b - y, z) for a, b, z in points if math.hypot(a - x, b - y) < 0.4]
    if len(near) < 20:
        return None
    x, y, z = ([p[k] - mean([q[k] for q in near]) for p in near] for k in range(3))
    xx, yy, xy, xz, yz = (sum(p * q for p, q in zip(*pair)) for pair in ((x, x), (y, y), (x, y), (x, z), (y, z)))
    n = (yz * xy - xz * yy) / (xx * yy - xy * xy), (xz * xy - yz * xx) / (xx * yy - xy * xy), 1
    return [v / math.hypot(*n) for v in n]


def impacts():
    """Of each: its part, name, mass, and in the slope's axes (z along its normal) velocity and spin before and after."""
    folder, found = data("chantsura"), []
    for part, name in PARTS.items():
        points, flights = ground(folder / f"terrain_rf16_contact_{name}.asc"), {}
        for row in read(folder / f"observed_trajectories_contact_{name}.csv"):
            flights.setdefault(row["segment_id"], []).append(row)
        for row in read(folder / f"observed_contact_events_{name}.csv"):
            n = normal(points, float(row["x_m"]), float(row["y_m"]))
            vectors = [[float(row[f"{when}_v{k}_mps"]) for k in "xyz"] for when in ("incoming", "outgoing")]
            flown = [flights[row[f"{which}_segment_id"]][at] for which, at in (("source", -1), ("next", 0))]
            vectors += [[float(moment[f"omega_{k}_radps"]) for k in "xyz"] for moment in flown]
            if not n or any(math.isnan(x) for v in vectors for x in v):
                continue
            e = [n[2], 0, -n[0]]
            e = [x / math.hypot(*e) for x in e]
            f = [n[1] * e[2] - n[2] * e[1], n[2] * e[0] - n[0] * e[2], n[0] * e[1] - n[1] * e[0]]
            vectors = [[sum(p * q for p, q in zip(axis, v)) for axis in (e, f, n)] for v in vectors]
            found.append([part, row["event_id"], float(row["mass_kg"]), *vectors])
    return found


def told(v, w):
    """Speeds from and along the plane, m/s, and spin, rad/s."""
    return v[2], math.hypot(v[0], v[1]), math.hypot(*w)


def block(path, mass):
    """Corners at a half and two quarters of the sides; its 26 faces."""
    size = (mass / DENSITY) ** (1 / 3)
    places = sorted({tuple(a * b for a, b in zip(p, signs)) for signs in itertools.product((-1, 1), repeat=3)
                     for p in itertools.permutations((0.5, 0.25, 0.25))})
    planes = [d for d in itertools.product((-1, 0, 1), repeat=3) if any(d)]
    triangles = []
    for d in planes:
        far = max(sum(p * q for p, q in zip(c, d)) for c in places)
        face = [c for c in places if sum(p * q for p, q in zip(c, d)) > far - 1e-9]
        middle = [mean([c[k] for c in face]) for k in range(3)]
        u = [a - b for a, b in zip(face[0], middle)]
        v = [d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2], d[0] * u[1] - d[1] * u[0]]
        u, v = ([x / math.hypot(*w) for x in w] for w in (u, v))
        angles = {c: math.atan2(*(sum((a - b) * q for a, b, q in zip(c, middle, axis)) for axis in (v, u))) for c in face}
        face.sort(key=angles.get)
        triangles += [[[size * s * x for s, x in zip(SIDES, c)] for c in (face[0], face[k], face[k + 1])] for k in range(1, len(face) - 1)]
    write_stl(path, triangles)


def hits(event, restitution, friction):
    """Rows of what is told of each orientation. There is no gravity; what has not left after 0.4 s counts as it moves then."""
    _, name, mass, v, _, w, _ = event
    folder = WORK / "impacts"
    folder.mkdir(parents=True, exist_ok=True)
    block(folder / "block.stl", mass)
    rng, rows = random.Random(1), []
    for k in range(COUNT):
        q = [rng.gauss(0, 1) for _ in range(4)]
        rows.append(["block", 10 * (k % 8), 10 * (k // 8), 0.6, *(x / math.hypot(*q) for x in q), *v, *w])
    lines = ["shape,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz", *(",".join([r[0], *map(repr, r[1:])]) for r in rows)]
    (folder / "bodies.csv").write_text("\n".join(lines) + "\n")
    (folder / "scene.yaml").write_text((HERE / "scene.yaml").read_text())
    scene = library().Scene(str(folder / "scene.yaml"), {"materials.ground.restitution": restitution, "materials.ground.friction": friction})
    scene.run(0.4)
    bodies = scene.bodies()
    return [told(a, b) for a, b in zip(bodies.velocity.tolist(), bodies.angular_velocity.tolist())]


def quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def grid(path):
    table = Table(path, ["impact", "restitution", "friction", *(f"{what}_{of}" for what in WHAT for of in ("mean", "sd", "low", "high"))], 3)
    for event in impacts():
        for restitution in RESTITUTION:
            for friction in FRICTION:
                if table.key((event[1], restitution, friction)) not in table.done:
                    columns = list(zip(*hits(event, restitution, friction)))
                    numbers = ((mean(c), deviation(c), quantile(c, 0.05), quantile(c, 0.95)) for c in columns)
                    table.add(event[1], restitution, friction, *(x for four in numbers for x in four))


def measured():
    print("part,impact,mass_kg," + ",".join(f"{what}_{when}" for when in ("before", "after") for what in WHAT))
    for part, name, mass, v, u, w, s in impacts():
        show(part, name, mass, *told(v, w), *told(u, s))


def compare(path):
    """Best is the least mean of squares, over the first part, of measured less mean by the scatter of orientations."""
    events, rows = impacts(), {}
    for row in read(path):
        rows.setdefault((float(row["restitution"]), float(row["friction"])), {})[row["impact"]] = row

    def scored(setting, part):
        found = []
        for kind, name, _, _, u, _, s in events:
            if kind == part:
                row = rows[setting][name]
                found += [(value - float(row[f"{what}_mean"])) ** 2 / (float(row[f"{what}_sd"]) ** 2 + 0.25) for what, value in zip(WHAT, told(u, s))]
        return mean(found)

    best = min(rows, key=lambda setting: scored(setting, "fitted"))
    print("part,restitution,friction,score,numbers,within_90,what,measured_mean,told_mean")
    for part in PARTS:
        mine = [e for e in events if e[0] == part]
        for k, what in enumerate(WHAT):
            values, told_of = [told(e[4], e[6])[k] for e in mine], [rows[best][e[1]] for e in mine]
            inside = sum(float(r[f"{what}_low"]) <= x <= float(r[f"{what}_high"]) for x, r in zip(values, told_of))
            show(part, *best, scored(best, part), len(mine), inside, what, mean(values), mean([float(r[f"{what}_mean"]) for r in told_of]))


if __name__ == "__main__":
    if sys.argv[1:] == ["measured"]:
        measured()
    elif len(sys.argv) == 3 and sys.argv[1] in ("grid", "compare"):
        {"grid": grid, "compare": compare}[sys.argv[1]](sys.argv[2])
    else:
        sys.exit(__doc__)
