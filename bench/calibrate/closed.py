#!/usr/bin/env python3
"""Calibrations of a closed form with noise (form.awk), which cost little but their planning.

usage: closed.py VERB TABLE
  shrink    intervals of two parameters over runs and over repeats of the measurement, at several truths; a truth's calibration
            goes on from budget to budget
  overhead  processor seconds of calibrations of 200 runs of 2 and 4 parameters, 2 and 8 targets, less those of the runs
  report    mean widths of the table that shrink made, in shares of the range, and how many intervals hold the truth
A row a calibration and budget; a run that was broken off goes on."""
import json
import pathlib
import random
import resource
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "evidence"))
import common  # noqa: E402

FORM, NAMES, ANSWERS = HERE / "form.awk", "abcd", ("angle", "time", "third", "fourth")
TWINS, REPEATS, BUDGETS = 4, (1, 20, 400), (20, 60, 200)
SHRINK = ["twin", "repeats", "runs", "a", "a_low", "a_high", "b", "b_low", "b_high"]
OVERHEAD = ["parameters", "targets", "experiments", "runs", "planning_s", "all_s"]


def measure(truth, seed, repeats):
    words = [w for name, x in zip(NAMES, truth) for w in ("-v", f"{name}={x}")]
    told = subprocess.run(["awk", *words, "-v", f"seed={seed}", "-v", f"repeats={repeats}", "-f", FORM], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    return {line.split(": ")[0]: float(line.split(": ")[1]) for line in told.splitlines()}


def calibrate(folder, seed, experiments, parameters, targets, budget):
    """targets: of (experiment, answer, value, repeats). Returns what --json tells."""
    command = ["awk", *(w for name in NAMES[:parameters] for w in ("-v", f"{name}={{{name}}}")), "-v", "seed={seed}", "-f", str(FORM)]
    lines = [f"seed: {seed}", "experiments:"] + [f"  e{e}: {{command: {json.dumps(command)}}}" for e in range(experiments)]
    lines += ["parameters:"] + [f"  {name}: {{from: -1, to: 1}}" for name in NAMES[:parameters]] + ["targets:"]
    lines += [f"  t{k}: {{experiment: e{e}, answer: {answer}, value: {value!r}, uncertainty: 0, repeats: {repeats}}}"
              for k, (e, answer, value, repeats) in enumerate(targets)]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "fit.yaml").write_text("\n".join([*lines, f"budget: {{runs: {budget}}}", "confidence: 0.9"]) + "\n")
    return json.loads(common.run("calibrate", folder / "fit.yaml", "-o", folder / "out", "-q", "--json", "--jobs", 1, "-j", 1))


def shrink(path):
    table = common.Table(path, SHRINK, 3)
    for twin in range(TWINS):
        rng = random.Random(twin)
        truth = rng.uniform(-0.8, 0.8), rng.uniform(-0.8, 0.8)
        for repeats in REPEATS:
            seen = measure(truth, 9000 + 10000 * twin, repeats)
            for budget in BUDGETS:
                if table.key((twin, repeats, budget)) in table.done:
                    continue
                targets = [(0, answer, seen[answer], repeats) for answer in ANSWERS[:2]]
                told = calibrate(common.WORK / "closed" / f"{twin}-{repeats}", 1 + 10000 * twin, 1, 2, targets, budget)
                cells = [x for p, real in zip(told["parameters"], truth) for x in (real, p["low"], p["high"])]
                table.add(twin, repeats, budget, *cells)


def overhead(path):
    table = common.Table(path, OVERHEAD, 2)
    for parameters, answers, experiments in ((2, 2, 1), (4, 4, 2)):
        if table.key((parameters, answers * experiments)) in table.done:
            continue
        seen = measure((0.1, 0.2, -0.1, 0.3)[:parameters], 9000, 100)  # so many that no budget is too large
        targets = [(e, answer, seen[answer], 100) for e in range(experiments) for answer in ANSWERS[:answers]]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        told = calibrate(common.WORK / "closed" / f"overhead-{parameters}", 1, experiments, parameters, targets, 200)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        table.add(parameters, answers * experiments, experiments, told["runs"], told["planning_seconds"], spent - told["seconds"])


def report(path):
    rows = [{k: float(v) for k, v in row.items()} for row in common.read(path)]
    print("repeats,runs,twins,a_width,b_width,a_held,b_held")
    for repeats in REPEATS:
        for budget in BUDGETS:
            some = [r for r in rows if (r["repeats"], r["runs"]) == (repeats, budget)]
            if some:
                widths = [f"{common.mean([r[f'{n}_high'] - r[f'{n}_low'] for r in some]) / 2:.3f}" for n in "ab"]
                held = [str(sum(r[f"{n}_low"] <= r[n] <= r[f"{n}_high"] for r in some)) for n in "ab"]
                print(",".join([str(repeats), str(budget), str(len(some)), *widths, *held]))


if len(sys.argv) != 3 or sys.argv[1] not in ("shrink", "overhead", "report"):
    sys.exit(__doc__)
{"shrink": shrink, "overhead": overhead, "report": report}[sys.argv[1]](sys.argv[2])
