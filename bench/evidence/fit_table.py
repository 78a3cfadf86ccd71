#!/usr/bin/env python3
"""What a calibration says, and its runs, as two tables to be committed.

  fit_table.py FOLDER FIT.csv RUNS.csv     of a folder of `scree calibrate`"""
import json
import pathlib
import re
import sqlite3
import sys

from common import Table, run

FIT = ["kind", "name", "measured", "mean", "low", "high", "single_low", "single_high", "identified"]


def fit(folder, path):
    told, table = json.loads(run("calibrate", "status", folder, "--json")), Table(path, FIT, 2)
    for p in told["parameters"]:
        bounds = [f"at {end} {p[f'at_{end}']:.3g}" for end in ("least", "most") if p[f"at_{end}"] is not None]
        table.add("parameter", p["name"], "", p["mean"], p["low"], p["high"], "", "", "yes" if p["identified"] else bounds[0] if bounds else "no")
    for a in told["answers"]:
        kind = "prediction" if a["predicted"] else "target" if a["measured"] else "offer"
        table.add(kind, a["name"], a["value"] if a["measured"] else "", a["mean"], a["low"], a["high"], a["single_low"], a["single_high"], "")


def runs(folder, path):
    names, planned = [], []
    for file in sorted((folder / "rounds").glob("*.yaml")):
        text = file.read_text()
        head = re.search(r"^parameters: (.*)$", text, re.MULTILINE)
        if not head:                                # the last says why there are no more
            continue
        names = re.findall(r'"([^"]*)"', head[1])
        planned += [(e, int(s), re.findall(r'"([^"]*)"', v)) for e, s, v in
                    re.findall(r'experiment: "([^"]*)", seed: (\d+), values: \[(.*?)\]', text)]
    answers, found = [], {}
    for name in sorted({e for e, _, _ in planned}):
        base = sqlite3.connect(f"file:{folder / name / 'study.sqlite'}?mode=ro", uri=True)
        for seed, answer, value in base.execute("select seed, answer.name, value from run join answer using (key) where state = 'done'"
                                                " order by seed, number"):
            found.setdefault((name, seed), {})[answer] = value
            answers += [answer] if answer not in answers else []
    table = Table(path, ["experiment", "seed", *names, *answers], 2)
    for name, seed, values in planned:
        if (name, seed) in found:
            row = found[name, seed]
            table.add(name, seed, *values, *(float(row[a]) if a in row and row[a] is not None else "" for a in answers))


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    for made in sys.argv[2:]:
        pathlib.Path(made).unlink(missing_ok=True)
    fit(sys.argv[1], sys.argv[2])
    runs(pathlib.Path(sys.argv[1]), sys.argv[3])
