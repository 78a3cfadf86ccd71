#!/usr/bin/env python3
"""Twin experiments of scree calibrate: two parameters are drawn from their ranges, a heap and a drawdown "measured" by one
run of each with fresh seeds, and what an estimator makes of these is compared with the truth.

usage: twins.py METHOD TABLE [--twins FROM:TO]
  calibrate  scree calibrate, at growing budgets; the answer is the posterior's mean
  angle      the same with nothing measured but the heap's angle
  latin      one Latin design for all twins: its run nearest to the measurements, and the least of a quadratic surface
  cma        CMA-ES of DEAP (Debian: python3-deap) on the distance to the measurements
  flat       the heap's angle over both parameters, in a table of its own: where it is low it tells rolling friction alone
  report     what the table says
A row a twin and budget; a run that was broken off goes on. Runs of both experiments count."""
import argparse
import json
import math
import pathlib
import random
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "evidence"))
import common  # noqa: E402

FIELDS = {"friction": "materials.grain.friction", "rolling": "materials.grain.rolling_friction"}
RANGES = {"friction": (0.1, 0.9), "rolling": (0.1, 0.5)}
# experiment, answer, where, uncertainty of measuring, scatter of a run (for the distance of latin and cma)
TARGETS = {"angle": ("heap", "pile.volume_deg", "", 0.3, 1.5), "height": ("heap", "pile.height", "", 0.0003, 0.0015),
           "left": ("drawdown", "above.count", "", 0.5, 2), "early": ("drawdown", "above.count", "at: 0.4", 0.5, 2.5)}
BUDGETS = (24, 36, 48)
COLUMNS = ["method", "twin", "runs", "friction", "friction_mean", "friction_low", "friction_high", "friction_identified", "rolling",
           "rolling_mean", "rolling_low", "rolling_high", "rolling_identified", "distance", "seconds"]


def work(name):
    folder = common.WORK / "twins" / name
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def runs(folder, rows, experiments=("heap", "drawdown")):
    """Answers of a heap and a drawdown at every row (friction, rolling, seed): {target: [number or None]}, seconds."""
    answers, seconds = {}, 0
    for experiment in experiments:
        targets = {name: t for name, t in TARGETS.items() if t[0] == experiment}
        lines = [f"base: {{scene: {HERE / experiment}.yaml}}", "design: list", "replicates: 1", "factors:"]
        for k, field in enumerate([*FIELDS.values(), "seed"]):
            lines.append(f"  {field}: [{', '.join(repr(row[k]) for row in rows)}]")
        lines += ["answers:"] + [f"  - {a}: {{{where}}}" if where else f"  - {a}" for _, a, where, _, _ in targets.values()]
        (folder / f"{experiment}.yaml").write_text("\n".join(lines) + "\n")
        words = [common.PROGRAM, "study", folder / f"{experiment}.yaml", "-o", folder / experiment, "-q", "--json", "-j", "1"]
        told = json.loads(subprocess.run(words, stdout=subprocess.PIPE, text=True).stdout)  # 1 where a run failed
        for k, name in enumerate(targets):
            answers[name] = [list(point["answers"].values())[k]["mean"] for point in told["points"]]
        seconds += sum(point["seconds"]["mean"] or 0 for point in told["points"])
    return answers, seconds


def twin(index):
    """Truth, and what was measured of it."""
    rng = random.Random(index)
    truth = {name: rng.uniform(*ends) for name, ends in RANGES.items()}
    for seed in range(1000000 + index, 2000000, 1000):  # the next where a run failed
        answers, _ = runs(work(f"twin-{index}/truth-{seed}"), [(truth["friction"], truth["rolling"], seed)])
        measured = {name: values[0] for name, values in answers.items()}
        if measured["height"] is not None and measured["left"] is not None:
            return truth, measured
    raise SystemExit(f"twin {index}: no seed gives a measurement")


def unit(name, value):
    low, high = RANGES[name]
    return (value - low) / (high - low)


def distance(truth, found):
    """Root mean square over parameters, in shares of their ranges; two points at random are 0.38 apart in the mean."""
    return math.sqrt(common.mean([(unit(n, truth[n]) - unit(n, found[n])) ** 2 for n in truth]))


def told(p):
    """yes: identified; end: narrow, but closed by an end of the range; no."""
    return "yes" if p["identified"] else "no" if p["at_least"] is None and p["at_most"] is None else "end"


def calibrate(index, table, method):
    truth, measured = twin(index)
    chosen = {n: t for n, t in TARGETS.items() if measured[n] is not None and (method == "calibrate" or n == "angle")}
    if not chosen:
        return print(f"twin {index}: no heap, no angle")
    experiments = sorted({t[0] for t in chosen.values()})
    folder = work(f"twin-{index}")
    for budget in BUDGETS if method == "calibrate" else BUDGETS[:1]:
        if (method, str(index), str(budget)) in table.done:
            continue
        lines = [f"seed: {1 + 10000 * index}", "experiments:"] + [f"  {e}: {{scene: {HERE / e}.yaml}}" for e in experiments]
        lines += ["parameters:"] + [f"  {n}: {{field: {FIELDS[n]}, from: {low}, to: {high}}}" for n, (low, high) in RANGES.items()]
        lines += ["targets:"]
        for name, (experiment, answer, where, uncertainty, _) in chosen.items():
            lines.append(f"  {name}: {{experiment: {experiment}, answer: {answer}, value: {measured[name]!r}, "
                         f"uncertainty: {uncertainty}{', ' + where if where else ''}}}")
        lines += [f"budget: {{runs: {budget}}}", "start: {points: 8}"]
        (folder / f"{method}.yaml").write_text("\n".join(lines) + "\n")
        r = json.loads(common.run("calibrate", folder / f"{method}.yaml", "-o", folder / method, "-q", "--json", "-j", 1))
        found = {p["name"]: p for p in r["parameters"]}
        cells = [x for n in RANGES for p in [found[n]] for x in (truth[n], p["mean"], p["low"], p["high"], told(p))]
        table.add(method, index, budget, *cells, distance(truth, {n: p["mean"] for n, p in found.items()}), r["seconds"])


def misfit(answers, measured, row):
    """Sum of squares in units of a run's scatter; a heap too low to have an angle has 0 degrees, a run that failed nothing."""
    return sum((((answers[n][row] or 0) - measured[n]) / math.hypot(t[3], t[4])) ** 2
               for n, t in TARGETS.items() if measured[n] is not None)


def add_point(table, method, index, budget, truth, found, seconds):
    table.add(method, index, budget, *[x for n in RANGES for x in (truth[n], found[n], "", "", "")], distance(truth, found), seconds)


def latin(index, table):
    import numpy
    from scipy.stats import qmc
    truth, measured = twin(index)
    for budget in BUDGETS:
        count = budget // 2
        places = qmc.scale(qmc.LatinHypercube(2, seed=budget).random(count), *zip(*RANGES.values())).tolist()
        answers, seconds = runs(work(f"latin-{budget}"), [(*p, 5000 + i) for i, p in enumerate(places)])
        misfits = [misfit(answers, measured, i) for i in range(count)]
        nearest = dict(zip(RANGES, places[min(range(count), key=misfits.__getitem__)]))
        add_point(table, "latin-nearest", index, budget, truth, nearest, seconds)

        def terms(u, v):
            return numpy.array([numpy.ones_like(u), u, v, u * u, u * v, v * v]).T
        u, v = (numpy.array([2 * unit(n, p[k]) - 1 for p in places]) for k, n in enumerate(RANGES))
        grid = numpy.linspace(-1, 1, 81)
        gu, gv = (g.ravel() for g in numpy.meshgrid(grid, grid))
        surfaces = {n: [terms(gu, gv) @ numpy.linalg.lstsq(terms(u, v), numpy.array([a or 0 for a in answers[n]]), rcond=None)[0]]
                    for n in TARGETS}
        least = min(range(len(gu)), key=[misfit({n: [s[0][i]] for n, s in surfaces.items()}, measured, 0)
                                         for i in range(len(gu))].__getitem__)
        found = {n: low + (high - low) * 0.5 * (1 + g[least]) for (n, (low, high)), g in zip(RANGES.items(), (gu, gv))}
        add_point(table, "latin-surface", index, budget, truth, found, seconds)


def cma(index, table):
    import numpy
    from deap import base, cma as deap_cma, creator
    if not hasattr(creator, "Place"):
        creator.create("Least", base.Fitness, weights=(-1.0,))
        creator.create("Place", list, fitness=creator.Least)
    truth, measured = twin(index)
    numpy.random.seed(index)
    strategy = deap_cma.Strategy(centroid=[0.5, 0.5], sigma=0.3, lambda_=6)
    done, rows, seconds = 0, [], 0
    while done < BUDGETS[-1]:
        people = strategy.generate(creator.Place)
        inside = [[min(1.0, max(0.0, x)) for x in person] for person in people]
        rows = [[low + x * (high - low) for x, (low, high) in zip(p, RANGES.values())] for p in inside]
        answers, used = runs(work(f"twin-{index}/cma-{done}"), [(*row, 9000 + done + i) for i, row in enumerate(rows)])
        for i, person in enumerate(people):  # beyond the ranges it is as bad as it is far
            outside = sum((x - y) ** 2 for x, y in zip(person, inside[i]))
            person.fitness.values = (misfit(answers, measured, i) + 100 * outside,)
        strategy.update(people)
        done += 2 * len(people)
        seconds += used
        if done in BUDGETS and ("cma", str(index), str(done)) not in table.done:
            found = {n: low + min(1, max(0, x)) * (high - low) for x, (n, (low, high)) in zip(strategy.centroid, RANGES.items())}
            add_point(table, "cma", index, done, truth, found, seconds)


def flat(path):
    table = common.Table(path, ["friction", "rolling", "heaps", "angle_deg", "standard_error"], 2)
    for rolling in (0.1, 0.16, 0.25, 0.35):
        for friction in (0.1, 0.3, 0.6, 0.9):
            if table.key((friction, rolling)) not in table.done:
                answers, _ = runs(work(f"flat-{friction}-{rolling}"), [(friction, rolling, 700 + i) for i in range(4)], ("heap",))
                angles = [a or 0 for a in answers["angle"]]  # too low to have one
                table.add(friction, rolling, len(angles), common.mean(angles), common.deviation(angles) / math.sqrt(len(angles)))


def report(table):
    print("method,runs,twins,distance,sd,friction_held,rolling_held,friction_identified,rolling_identified,friction_end,rolling_end,identified_held,friction_width,rolling_width")
    for method, budget in sorted({(r["method"], int(r["runs"])) for r in table.rows}):
        rows = [r for r in table.rows if (r["method"], int(r["runs"])) == (method, budget)]
        far = [float(r["distance"]) for r in rows]
        cells = [f"{common.mean(far):.3f}", f"{common.deviation(far):.3f}" if len(far) > 1 else ""]
        if rows[0]["friction_low"]:
            cells += [sum(float(r[f"{n}_low"]) <= float(r[n]) <= float(r[f"{n}_high"]) for r in rows) for n in RANGES]
            cells += [sum(r[f"{n}_identified"] == word for r in rows) for word in ("yes", "end") for n in RANGES]
            cells.append(sum(r[f"{n}_identified"] == "yes" and float(r[f"{n}_low"]) <= float(r[n]) <= float(r[f"{n}_high"])
                             for r in rows for n in RANGES))
            cells += [f"{common.mean([float(r[f'{n}_high']) - float(r[f'{n}_low']) for r in rows]):.3f}" for n in RANGES]
        else:
            cells += [""] * 9
        print(",".join(map(str, [method, budget, len(rows), *cells])))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("method", choices=["calibrate", "angle", "latin", "cma", "flat", "report"])
    parser.add_argument("table")
    parser.add_argument("--twins", default="0:20")
    options = parser.parse_args()
    if options.method == "flat":
        return flat(options.table)
    table = common.Table(options.table, COLUMNS, 3)
    if options.method == "report":
        return report(table)
    for index in range(*map(int, options.twins.split(":"))):
        if options.method in ("calibrate", "angle"):
            calibrate(index, table, options.method)
        elif (options.method if options.method == "cma" else "latin-surface", str(index), str(BUDGETS[-1])) not in table.done:
            (latin if options.method == "latin" else cma)(index, table)


main()
