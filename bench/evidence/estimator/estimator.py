#!/usr/bin/env python3
"""Which measurement of a heap tells two frictions apart with the least work: ways of taking the angle, sizes of heaps.
usage: estimator.py run TABLE SHAPE:COUNT:RUNS... | estimator.py compare TABLE >RESULT
SHAPE is sphere or box; RUNS heaps of COUNT particles at each of two frictions. A row a heap; what is done is not repeated."""
import json
import math
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import common  # noqa: E402

FRICTIONS = (0.4, 0.6)
WAYS = ("sector_deg", "cone_deg", "silhouette_deg", "volume_deg")
BOX = "{box: [9 mm, 7.5 mm, 5 mm]}"
STEP = 4  # heaps a study, so that little is lost where it is broken off


def settings(shape, count):
    """The scene's fields for so many particles; the fall grows with the tube, and the stiffness with it."""
    s = (count / 150) ** (1 / 3)
    speed = math.sqrt(s)
    values = {"inlets.feed.count": count, "geometry.tube.cylinder.radius": 0.025 * s, "inlets.feed.cylinder.radius": 0.025 * s - 0.001,
              "inlets.feed.cylinder.length": 0.22 * s, "geometry.tube.motion.0.from": 0.35 * speed, "time": 1.3 * speed,
              "geometry.tube.motion.0.translate.velocity.2": 0.25 * speed, "materials.grain.young": 5e5 * s}
    return values | ({"shapes.grain.size": None} if shape == "box" else {})


def scene(shape):
    text = (HERE / "scene.yaml").read_text()
    if shape == "box":
        text = "\n".join(f"shapes: {{grain: {BOX}}}" if line.startswith("shapes:") else line for line in text.split("\n"))
    path = common.WORK / f"estimator-{shape}.yaml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def run(table, shape, count, total):
    for friction in FRICTIONS:
        for first in range(0, total, STEP):
            seeds = [s for s in range(first + 1, min(first + STEP, total) + 1) if (shape, str(count), str(friction), str(s)) not in table.done]
            if not seeds:
                continue
            name = f"estimator-{shape}-{count}-{friction}-{first}"
            fixed = settings(shape, count) | {"materials.grain.friction": friction}
            lines = ["base:", f"  scene: {scene(shape)}"] + [f"  {k}: {v!r}" for k, v in fixed.items() if v is not None]
            lines += ["design: list", "replicates: 1", f"factors: {{seed: {seeds}}}",
                      f"answers: [{', '.join('pile.' + w for w in WAYS)}]"]
            (common.WORK / f"{name}.yaml").write_text("\n".join(lines) + "\n")
            words = [common.PROGRAM, "study", f"{name}.yaml", "-o", name, "-q", "--json", "-j", "1"]
            told = json.loads(subprocess.run(words, cwd=common.WORK, stdout=subprocess.PIPE, text=True).stdout)
            for seed, point in zip(seeds, told["points"]):
                ways = [a["mean"] for a in point["answers"].values()]
                table.add(shape, count, friction, seed, *["" if w is None else w for w in ways], point["seconds"]["mean"] or "")


def compare(table):
    """d: difference of the means in standard deviations of a heap. Heaps of each: (1.645 + 1.282)^2 2 / d^2, for a test of 5 %
    on one side with 90 % power."""
    print("shape,count,way,heaps,none,mean_low,mean_high,sd,sd_low,sd_high,d,d_low,d_high,heaps_needed,seconds_needed")
    ways = {w: (lambda r, w=w: float(r[w])) for w in WAYS}
    ways["three"] = lambda r: common.mean([float(r[w]) for w in WAYS[:3]])
    for shape, count in dict.fromkeys((r["shape"], r["count"]) for r in table.rows):
        rows = [r for r in table.rows if (r["shape"], r["count"]) == (shape, count)]
        seconds = common.mean([float(r["seconds"]) for r in rows if r["seconds"]])
        for name, way in ways.items():
            pair = [[way(r) for r in rows if float(r["friction"]) == f and r["volume_deg"]] for f in FRICTIONS]
            none = len(rows) - sum(map(len, pair))

            def pooled(a, b):
                return math.sqrt(((len(a) - 1) * common.deviation(a) ** 2 + (len(b) - 1) * common.deviation(b) ** 2) / (len(a) + len(b) - 2))

            def apart(a, b):
                return (common.mean(b) - common.mean(a)) / pooled(a, b)
            sd, d = pooled(*pair), apart(*pair)
            needed = 2 * (1.645 + 1.282) ** 2 / d ** 2
            cells = [common.mean(pair[0]), common.mean(pair[1]), sd, *common.bootstrap(pooled, *pair), d, *common.bootstrap(apart, *pair)]
            print(",".join([shape, count, name, str(len(rows)), str(none), *(f"{c:.2f}" for c in cells), f"{needed:.1f}",
                            f"{2 * needed * seconds:.0f}"]))


def main():
    table = common.Table(sys.argv[2], ["shape", "count", "friction", "seed", *WAYS, "seconds"], 4)
    if sys.argv[1] == "compare":
        return compare(table)
    for word in sys.argv[3:]:
        shape, count, total = word.split(":")
        run(table, shape, int(count), int(total))


main()
