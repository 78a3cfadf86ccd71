#!/usr/bin/env python3
"""Does shape beat calibration? Cheaper descriptions of a scan, whose friction or rolling friction is fitted to the truth's heap, tell
what was not fitted.

  shape.py tower TABLE.csv SCAN SEEDS DESCRIPTION...   heap, packing, discharge and what stays, by friction and rolling friction
  shape.py slope|drum TABLE.csv SCAN SEEDS TOWER.csv DESCRIPTION...   run-out; slope and segregation: as the truth is and as fitted
  shape.py compare SLOPE.csv DRUM.csv TOWER.csv   what is fitted and the errors of what is not, as CSV

SCAN is stone, device or boulder. SEEDS is a range as 2-4; tables get the rows that they lack. Descriptions: 4x (the truth), recommended,
0.25x, 0.0625x, clump1 to clump50. Margins: ../margins.md. Environment: SCREE_DATA_DIR (stone and device, default ../shared/data),
SCREE_EVIDENCE_DIR (the boulder)."""
import math
import os
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import DATA, ROOT, WORK, Table, deviation, library, mean, processor_time, read, run, show  # noqa: E402

FOLDER = pathlib.Path(os.environ.get("SCREE_DATA_DIR", ROOT.parent / "shared" / "data"))
SCANS = {"stone": FOLDER / "stone_073ac.ply", "device": FOLDER / "ycb_power_drill.obj", "boulder": DATA / "authume" / "SP3A.stl"}
LEVELS = ("4x", "recommended", "0.25x", "0.0625x")
TRUTH, FRICTION, D = "4x", 0.5, 0.02
# Ways to fit: rows of friction and rolling friction, along which one of them grows.
WAYS = {"rolling": [(0.5, 0.0), (0.5, 0.15), (0.5, 0.4)], "friction": [(0.25, 0.0), (0.5, 0.0), (0.9, 0.0)]}
KEY = ["scan", "description", "friction", "rolling", "seed"]
AS_TRUE = (FRICTION, 0.0)
MARGINS = {"packing": 0.015, "discharge": 0.02, "stays": 4, "run_out": 0.05, "slope": 2, "segregation": 0.1}


def grain(scan, description):
    """The file of a description, made once; the levels of a scan together, as its curve costs more than they do."""
    name = SCANS[scan].stem + (".csv" if description.startswith("clump") else ".stl")
    path = WORK / "shape" / scan / description / name
    if path.exists():
        return path
    if description.startswith("clump"):
        path.parent.mkdir(parents=True, exist_ok=True)
        run("clump", SCANS[scan], "-n", description[5:], "-o", path.parent, "-q", "-f", "--threads", 1)
        return path
    mesh = library().load(str(SCANS[scan]), "m").repair()
    curve = (mesh[0] if isinstance(mesh, tuple) else mesh).curve()
    recommended = curve.choose().recommended.triangle_count
    for level in LEVELS:
        count = recommended * (1.0 if level == "recommended" else float(level[:-1]))
        file = WORK / "shape" / scan / level / name
        file.parent.mkdir(parents=True, exist_ok=True)
        curve.mesh(curve.find(max(4, round(count)))).write(str(file))
    return path


def scene(name, scan, description, friction, rolling, seed=1):
    path = grain(scan, description)
    file = path.with_name(f"{name}.yaml")
    file.write_text((HERE / file.name).read_text().replace("file: grain.stl", f"{'clump' if path.suffix == '.csv' else 'file'}: {path.name}"))
    return library().Scene(str(file), {"materials.grain.friction": friction, "materials.grain.rolling_friction": rolling, "seed": seed})


def tower(scan, description, friction, rolling, seed):
    """Angle of the wedge below, packing, time until 40 are out, how many stay, processor time of a body and step."""
    grain(scan, description)
    begun = processor_time()
    box = scene("tower", scan, description, friction, rolling, seed)
    box.run(until=0.7)
    heights = [p[2] for p in box.bodies().position.tolist()]
    packing = len(heights) * math.pi / 6 * D ** 3 / (0.16 * 0.1 * 2 * mean(heights))
    below, moment = 0, math.nan
    while box.time < 1.8 - 1e-9:
        box.run(until=box.time + 0.01)
        at = box.bodies().position.tolist()
        now = sum(p[2] < 0 for p in at)
        if below < 40 <= now:
            moment = box.time - 0.7 - 0.01 * (now - 40) / (now - below)
        below = now
    heap = [(p[0], p[2] + 0.07) for p in at if p[2] < 0]
    middle = mean([x for x, _ in heap])
    wide = math.sqrt(mean([(x - middle) ** 2 for x, _ in heap]))
    angle = math.degrees(math.atan(3 * mean([z for _, z in heap]) / (math.sqrt(6) * wide)))
    return angle, packing, moment, len(at) - below, 1e6 * (processor_time() - begun) / (90 * box.world.step_count)


def slope(scan, description, friction, rolling, seed):
    """How far 30 bodies, far from each other, run out from the foot: the mean and its standard error."""
    rng, rows = random.Random(seed), ["shape,size,x,y,z,qw,qx,qy,qz"]
    for k in range(30):
        turn = [rng.gauss(0, 1) for _ in range(4)]
        rows.append(f"grain,{D},-0.52,{0.2 * k},0.35," + ",".join(repr(q / math.hypot(*turn)) for q in turn))
    (grain(scan, description).parent / "bodies.csv").write_text("\n".join(rows) + "\n")
    fall = scene("slope", scan, description, friction, rolling)
    fall.run()
    ways = [p[0] for p in fall.bodies().position.tolist()]
    return mean(ways), deviation(ways) / math.sqrt(len(ways))


def drum(scan, description, friction, rolling, seed):
    """Over three quarters of a turn, after a half: slope of the common centre; how much farther the large ones are from the axis."""
    shell, slopes, apart = scene("drum", scan, description, friction, rolling, seed), [], []
    for k in range(31):
        shell.run(until=1.3 + 0.05 * k)
        bodies = shell.bodies()
        at, heavy = bodies.position.tolist(), max(bodies.mass)
        slopes.append(abs(math.degrees(math.atan2(mean([p[0] for p in at]), -mean([p[2] for p in at])))))
        far = [[math.hypot(p[0], p[2]) for p, m in zip(at, bodies.mass) if (m > 0.7 * heavy) == large] for large in (False, True)]
        apart.append((mean(far[1]) - mean(far[0])) / 0.019)
    return mean(slopes), mean(apart)


def settings(description):
    return [AS_TRUE] if description == TRUTH else list(dict.fromkeys(row for rows in WAYS.values() for row in rows))


def towers(path, scan, seeds, descriptions):
    table = Table(path, [*KEY, "angle", "packing", "discharge", "stays", "us"], 5)
    for seed in seeds:
        for description in descriptions:
            for setting in settings(description):
                if table.key((scan, description, *setting, seed)) not in table.done:
                    table.add(scan, description, *setting, seed, *tower(scan, description, *setting, seed))


def grouped(path, scan, *names):
    """A scan's rows by description and way, or by description and setting."""
    groups = {}
    for row in read(path) if pathlib.Path(path).exists() else []:
        if row["scan"] == scan:
            key = (row["description"], *(row[n] if n == "way" else float(row[n]) for n in names))
            groups.setdefault(key, []).append({k: float(v) for k, v in row.items() if k not in ("scan", "description", "way")})
    return groups


def pooled(groups, name):
    """The scatter of one run, over all settings."""
    told = [[r[name] for r in rows] for rows in groups.values()]
    sums = [(sum((v - mean(values)) ** 2 for v in values), len(values) - 1) for values in told if not math.isnan(sum(values))]
    return math.sqrt(sum(s for s, _ in sums) / max(1, sum(n for _, n in sums)))


def place(angles, wanted, beyond=False):
    """Between which rows of a way, and how far, straight lines reach the angle wanted; beyond: else the nearer end."""
    for k, (a, b) in enumerate(zip(angles, angles[1:])):
        if (a - wanted) * (b - wanted) <= 0 and a != b:
            return k, (a - wanted) / (a - b)
    return (min(((k, t) for k in range(len(angles) - 1) for t in (0, 1)), key=lambda p: abs(angles[p[0] + p[1]] - wanted)) if beyond else None)


def along(values, at):
    k, t = at
    return values[k] + t * (values[k + 1] - values[k])


def fitted(runs, description):
    """By way: friction and rolling friction; without those ways that do not reach the truth's angle."""
    found, angle = {"as true": AS_TRUE}, lambda key: mean([r["angle"] for r in runs[key]])
    for way, rows in WAYS.items():
        if description != TRUTH and all((description, *row) in runs for row in rows):
            at = place([angle((description, *row)) for row in rows], angle((TRUTH, *AS_TRUE)))
            if at:
                found[way] = tuple(along([row[i] for row in rows], at) for i in (0, 1))
    return found


def predictions(what, path, scan, seeds, runs, descriptions):
    name, names = {"slope": (slope, ["run_out", "error"]), "drum": (drum, ["slope", "segregation"])}[what]
    table = Table(path, ["scan", "description", "way", "seed", "friction", "rolling", *names], 4)
    for seed in seeds:
        for description in descriptions:
            for way, setting in fitted(runs, description).items():
                if table.key((scan, description, way, seed)) not in table.done:
                    table.add(scan, description, way, seed, *setting, *name(scan, description, *setting, seed))


def compare(scan, path, others):
    """Errors of a scan's descriptions, description less truth, drawn 4,000 times. A draw holds for all of them: the truth that two
    descriptions are held against is the same in both."""
    rng, runs, tables = random.Random(1), grouped(path, scan, "friction", "rolling"), [grouped(other, scan, "way") for other in others]
    columns = [(runs, name) for name in ("angle", "packing", "discharge", "stays")]
    columns += [(table, name) for table, names in zip(tables, (["run_out"], ["slope", "segregation"])) for name in names
                if any(len(rows) > 1 for rows in table.values())]  # one run of each tells no scatter
    first, noise = {}, {}
    for table, name in columns:
        for key, rows in table.items():
            first[name, key] = mean([r[name] for r in rows])
            noise[name, key] = pooled(table, name) / math.sqrt(len(rows))
    draws = [{key: m + rng.gauss(0, noise[key]) for key, m in first.items()} for _ in range(4000)]
    truth = {name: (TRUTH, *AS_TRUE) if table is runs else (TRUTH, "as true") for table, name in columns}

    def errors(description, way, means):
        keys, found = [(description, *row) for row in WAYS.get(way, [AS_TRUE])], {}
        at = place([means["angle", key] for key in keys], means["angle", truth["angle"]], True) if way in WAYS else None
        for table, name in columns[1:]:
            if table is runs:
                values = [means[name, key] for key in keys]
                found[name] = (along(values, at) if at else values[0]) - means[name, truth[name]]
            elif (description, way) in table and truth[name] in table:
                found[name] = means[name, (description, way)] - means[name, truth[name]]
        if not at:
            found["angle"] = means["angle", keys[0]] - means["angle", truth["angle"]]  # told, and no part of the error
        return {name: e for name, e in found.items() if not math.isnan(e)}

    def score(found):
        return math.sqrt(mean([(e / MARGINS[name]) ** 2 for name, e in found.items() if name in MARGINS]))

    base, bases = score(errors("recommended", "as true", first)), [score(errors("recommended", "as true", d)) for d in draws]
    for description in dict.fromkeys(key[0] for key in runs if key[0] != TRUTH):
        cost = mean([r["us"] for key, rows in runs.items() if key[0] == description for r in rows])
        for way, setting in fitted(runs, description).items():
            seeds = min(len(runs[description, *row]) for row in WAYS.get(way, [AS_TRUE]))
            told, drawn = errors(description, way, first), [errors(description, way, d) for d in draws]
            for name in [*told, "all", "less recommended"]:
                if name in told:
                    value, many = told[name], [d[name] for d in drawn if name in d]
                else:
                    value, many = score(told), [score(d) for d in drawn]
                    if name != "all":
                        value, many = value - base, [a - b for a, b in zip(many, bases)]
                many.sort()
                low, high = many[len(many) // 20], many[len(many) * 19 // 20]
                margin = MARGINS.get(name, 0.0)
                verdict = "right" if -margin < low and high < margin else "wrong" if high < -margin or low > margin else "open"
                if name not in MARGINS:
                    verdict = "" if name in ("all", "angle") or low <= 0 <= high else "larger" if low > 0 else "smaller"
                show(scan, description, way, *setting, cost, seeds, name, value, low, high, verdict)


def span(word):
    first, _, last = word.partition("-")
    return range(int(first), int(last or first) + 1)


def main(verb, path, *words):
    if verb == "tower":
        return towers(path, words[0], span(words[1]), words[2:])
    if verb == "compare":
        show("scan", "description", "way", "friction", "rolling", "us", "seeds", "quantity", "error", "low", "high", "verdict")
        for scan in dict.fromkeys(row["scan"] for row in read(words[-1])):
            if any(row["scan"] == scan for row in read(words[0])):  # the drum comes last: a scan that got so far
                compare(scan, words[-1], [path, *words[:-1]])
        return None
    return predictions(verb, path, words[0], span(words[1]), grouped(words[2], words[0], "friction", "rolling"), words[3:])


if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[1] not in ("tower", "slope", "drum", "compare"):
        sys.exit(__doc__)
    main(*sys.argv[1:])
