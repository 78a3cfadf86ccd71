#!/usr/bin/env python3
"""Two of the three processes that ten codes agreed on (Dosta and others, Computer Physics Communications 296, 109066,
2024), coarse-grained: scree beside LIGGGHTS from the same state, with Hertz's and Mindlin's law and the same step.

  bulk.py run CASE:SEEDS TABLE.csv       CASE is drum, silo-large or silo-small; adds the seeds that it lacks
  bulk.py compare CASE TABLE.csv         as CSV: what margins.md asks for

COARSE times the published diameters and lengths of time steps; counts are as many times COARSE cubed fewer, so that the
volume is as published. The silos' filling is not published: it is a quarter of the count, filled anew. Environment:
SCREE_EVIDENCE_DIR, LIGGGHTS (the program)."""
import math
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, data, deviation, library, liggghts, mean, needs, processor_time, read, write_stl  # noqa: E402

EVERY = 0.05
# Steps are what scree asks for at least: 15 in a quarter period of a hit at 1 m/s.
CASES = {
    "drum": {"scene": "drum", "coarse": 3, "step": 3.4e-5, "time": 5.0, "walls": "Drum_walls.txt", "shapes": {"small": (0.002, 30000), "large": (0.004, 8000)},
             "inlet": {"at": [0, -0.03, 0], "axis": [0, 1, 0], "radius": 0.1, "length": 0.06}, "fill": 0.8, "stiff": 10},
    "silo-large": {"scene": "silo", "coarse": 2, "step": 2.4e-5, "time": 2.0, "walls": "Silo_walls__large_orifice_.txt", "shapes": {"grain": (0.004, 25000)},
                   "inlet": {"at": [0, 0, 0.02], "axis": [0, 0, 1], "radius": 0.1, "length": 0.28}, "fill": 0.5, "stiff": 3},
    "silo-small": {"scene": "silo", "coarse": 2, "step": 2.4e-5, "time": 5.5, "walls": "Silo_walls__small_orifice_.txt", "shapes": {"grain": (0.004, 25000)},
                   "inlet": {"at": [0, 0, 0.02], "axis": [0, 0, 1], "radius": 0.1, "length": 0.28}, "fill": 0.5, "stiff": 3},
}
COLUMNS = {"drum": ["up.small", "up.large", "down.small", "down.large"], "silo": ["mass"]}
MATERIALS = {  # of LIGGGHTS, by type
    "drum": {"YOUNG": "2e6 1e6 4.2e8", "POISSON": "0.2 0.2 0.2", "RESTITUTION": "3 0.5 0.45 0.4 0.45 0.4 0.4 0.4 0.4 0.6",
             "FRICTION": "3 0.3 0.2 0.2 0.2 0.4 0.2 0.2 0.2 0.5", "STEEL": "3", "SKIN": "0.0015",
             "MOTION": "fix turn all move/mesh mesh surface rotate origin 0. 0. 0. axis 0. -1. 0. period 3.14159265358979"},
    "silo": {"YOUNG": "1e7 2.1e9", "POISSON": "0.2 0.2", "RESTITUTION": "2 0.5 0.4 0.4 0.6", "FRICTION": "2 0.3 0.2 0.2 0.5", "STEEL": "2",
             "SKIN": "0.001", "MOTION": ""},
}
DENSITY = {"small": 2500, "large": 2000, "grain": 2500}


def walls(case, path):
    """The published triangles as STL; of the drum the inner surface alone, as LIGGGHTS feels both sides of each."""
    found, inner = [], case["scene"] == "drum"
    for row in open(data("bulk") / case["walls"]):
        try:
            numbers = list(map(float, row.split()))
        except ValueError:
            continue
        corners = [numbers[i:i + 3] for i in (0, 3, 6)] if len(numbers) == 9 else []
        if not corners or inner and any(math.hypot(x, z) > 0.101 or abs(y) > 0.031 for x, y, z in corners):
            continue
        found.append(corners)
    write_stl(path, found)


def sizes(case):
    return {name: (d * case["coarse"], round(n / case["coarse"] ** 3)) for name, (d, n) in case["shapes"].items()}


def fields(case):
    return {"contact.time_step": case["step"], **{f"shapes.{name}.sphere": d for name, (d, _) in sizes(case).items()}}


def filled(case, folder, seed):
    """Spheres that came to rest, each a row of shape and place: from an inlet in the resting walls, a silo with a plug. They
    are stiffer meanwhile, since they fall faster than they will flow."""
    text = (HERE / f"{case['scene']}.yaml").read_text().splitlines()
    inlet = {**case["inlet"], "radius": case["inlet"]["radius"] - 0.6 * max(d for d, _ in sizes(case).values())}
    lines = [line for line in text if not line.startswith(("bodies:", "outlets:"))]
    if case["scene"] == "drum":
        lines = [line.split(", motion")[0] + "}" if "motion:" in line else line for line in lines]
    else:
        at = lines.index(next(line for line in lines if "wall.stl" in line))
        lines.insert(at + 1, "  plug: {disc: {radius: 0.05, normal: [0, 0, 1]}, at: [0, 0, -0.056], material: steel}")
    lines += [f"seed: {seed}", "inlets:", "  feed:", f"    cylinder: {inlet}".replace("'", ""),
              "    shapes: {" + ", ".join(f"{name}: {n}" for name, (_, n) in sizes(case).items()) + "}",
              f"    count: {sum(n for _, n in sizes(case).values())}"]
    (folder / "fill.yaml").write_text("\n".join(lines) + "\n")
    stiff = {f"materials.{word.strip()}.young": case["stiff"] * float(young) for word, _, young in
             (line.partition(": {young: ") for line in lines) if young for young in [young.split(",")[0]]}
    scene = library().Scene(str(folder / "fill.yaml"), {**fields(case), **stiff, "contact.time_step": 0.98 * case["stiff"] ** -0.4 * case["step"]})
    scene.run(case["fill"])
    names, bodies = list(sizes(case)), scene.bodies()
    return [(names[k], *p) for k, p in zip(bodies.shape, bodies.position.tolist())]


def counted(case, rows):
    """What is asked for, of rows of shape and place."""
    if case["scene"] == "drum":
        return [sum(shape == name and sign * x > 0 and sign * z > 0 for shape, x, _, z in rows)
                for sign in (1, -1) for name in ("small", "large")]
    grain = DENSITY["grain"] * math.pi / 6 * sizes(case)["grain"][0] ** 3
    return [grain * sum(z > -0.06 for _, _, _, z in rows)]


def with_scree(case, rows, folder):
    (folder / "bodies.csv").write_text("\n".join(["shape,x,y,z", *(f"{n},{x!r},{y!r},{z!r}" for n, x, y, z in rows)]) + "\n")
    shutil.copy(HERE / f"{case['scene']}.yaml", folder)
    scene, names, found = library().Scene(str(folder / f"{case['scene']}.yaml"), fields(case)), list(sizes(case)), []
    while scene.time < case["time"] - 1e-9:
        scene.run(until=(len(found) + 1) * EVERY)
        bodies = scene.bodies()
        found.append(counted(case, [(names[k], *p) for k, p in zip(bodies.shape, bodies.position.tolist())]))
    print(f"scree: ledger {scene.sensors['ledger']:.1e}")
    return found


def with_liggghts(case, rows, folder):
    names = list(sizes(case))
    lines = [f"spheres\n\n{len(rows)} atoms\n{len(names) + 1} atom types\n", "-0.21 0.21 xlo xhi\n-0.21 0.21 ylo yhi\n-0.31 0.61 zlo zhi\n\nAtoms\n"]
    lines += [f"{i + 1} {names.index(n) + 1} {sizes(case)[n][0]} {DENSITY[n]} {x!r} {y!r} {z!r}" for i, (n, x, y, z) in enumerate(rows)]
    (folder / "spheres.data").write_text("\n".join(lines) + "\n")
    every = round(EVERY / case["step"])
    words = {**MATERIALS[case["scene"]], "STEPS": every * round(case["time"] / EVERY), "EVERY": every, "STEP": case["step"]}
    liggghts(HERE / "liggghts.in", folder, words)
    found, frame = [], []
    for line in open(folder / "places.txt"):
        words = line.split()
        if line.startswith("ITEM: TIMESTEP"):
            found.append(frame := [])
        elif len(words) == 5 and not line.startswith("ITEM"):
            frame.append((names[int(words[1]) - 1], *map(float, words[2:])))
    return [counted(case, frame) for frame in found[1:]]


def run(word, path):
    name, _, seeds = word.partition(":")
    case = CASES[name]
    needs("LIGGGHTS")
    data("bulk")
    table = Table(path, ["seed", "code", "time", *COLUMNS[case["scene"]], "cpu_s"], 3)
    for seed in range(1, int(seeds) + 1):
        folder = WORK / "bulk" / f"{name}-{seed}"
        folder.mkdir(parents=True, exist_ok=True)
        walls(case, folder / "wall.stl")
        rows = None
        for code, go in (("scree", with_scree), ("liggghts", with_liggghts)):
            if table.key((seed, code, round(case["time"], 6))) in table.done:
                continue
            rows = rows or filled(case, folder, seed)
            begun = processor_time()
            for k, found in enumerate(go(case, rows, folder)):
                spent = processor_time() - begun
                if table.key((seed, code, moment := round((k + 1) * EVERY, 6))) not in table.done:  # of a run that was cut off
                    table.add(seed, code, moment, *found, round(spent, 1))


def halves(series, whole, share):
    """When the mass has fallen to a share of the whole, linear between rows."""
    before = (0.0, whole)
    for now in series:
        if now[1] <= share * whole:
            return before[0] + (now[0] - before[0]) * (before[1] - share * whole) / max(1e-12, before[1] - now[1])
        before = now
    return math.nan


def compare(name, path):
    case, groups = CASES[name], {}
    for row in read(path):
        groups.setdefault((row["code"], row["seed"]), []).append({k: float(v) for k, v in row.items() if k not in ("code", "seed")})
    seeds = sorted({seed for _, seed in groups})
    print("what,scree,liggghts,difference,standard_error")
    if case["scene"] == "drum":
        # Means over blocks of half a second from 2 s on: their scatter over blocks and seeds is the error's.
        for column in COLUMNS["drum"]:
            whole = sizes(case)[column.split(".")[1]][1]
            blocks = {code: [100 / whole * mean([r[column] for r in groups[code, seed] if b < r["time"] - 1e-6 <= b + 0.5])
                             for seed in seeds for b in (2, 2.5, 3, 3.5, 4, 4.5)] for code in ("scree", "liggghts")}
            a, b = blocks["scree"], blocks["liggghts"]
            error = math.sqrt((deviation(a) ** 2 + deviation(b) ** 2) / len(a))
            print(f"{column} %,{mean(a):.2f},{mean(b):.2f},{mean(a) - mean(b):.2f},{error:.2f}")
        return
    count = sizes(case)["grain"][1]
    whole = count * DENSITY["grain"] * math.pi / 6 * sizes(case)["grain"][0] ** 3
    for share in (0.9, 0.75, 0.5, 0.25, 0.1):
        times = {code: [halves([(r["time"], r["mass"]) for r in groups[code, seed]], whole, share) for seed in seeds] for code in ("scree", "liggghts")}
        a, b = mean(times["scree"]), mean(times["liggghts"])
        if math.isnan(a + b):
            continue  # the run ended before
        # a flow of n scatters by 0.65/sqrt(n): orifice-compared.csv
        error = 0.652 / math.sqrt((1 - share) * count * len(seeds)) * math.sqrt(a * a + b * b)
        print(f"time to {100 * share:.0f} % s,{a:.4g},{b:.4g},{a - b:.4g},{error:.2g}")


if __name__ == "__main__":
    if len(sys.argv) == 4 and sys.argv[1] == "run" and sys.argv[2].split(":")[0] in CASES:
        run(*sys.argv[2:])
    elif len(sys.argv) == 4 and sys.argv[1] == "compare" and sys.argv[2] in CASES:
        compare(*sys.argv[2:])
    else:
        sys.exit(__doc__)
