#!/usr/bin/env python3
"""Whether a calibration says rightly that the model gives what was measured, or that it does not, on closed forms.

usage: fits.py DIR [FIRST [COUNT]]
Case by case a line: kind, parameters, whether it was said to fit, parameters called identified and how many intervals hold.
Of 60 cases 40 can be reached, with 2, 3 and 4 parameters; 20 cannot: another law, a truth beyond the ranges, a factor on one
answer. Every second has noise that depends on the place. At the end a line of sums. Cases that were made are read again."""
import json
import math
import os
import pathlib
import random
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ.get("SCREE", str(HERE.parent.parent / "build" / "release" / "bin" / "scree"))
NAMES = "abcd"
FAR = 6  # standard uncertainties, in all: so far off is the nearest setting of a case that cannot be reached


class Form:
    """Answers with a trend, a product, a wave, and noise that may change tenfold over the ranges."""

    def __init__(self, rng, parameters, local):
        self.n, self.p, self.local = parameters + 1 + rng.randrange(2), parameters, local
        self.c = [[rng.gauss(0, 1) for _ in range(parameters)] for _ in range(self.n)]
        for j, row in enumerate(self.c):  # each parameter is told by some answer
            row[j % parameters] += math.copysign(2, row[j % parameters])
        self.q = [[rng.gauss(0, 0.35) for _ in range(parameters)] for _ in range(self.n)]
        self.w = [(rng.uniform(0, 0.5), rng.uniform(1, 2.5), rng.randrange(parameters)) for _ in range(self.n)]
        self.sd = [rng.uniform(0.1, 0.3) for _ in range(self.n)]
        self.place = [rng.uniform(-0.6, 0.6) for _ in range(parameters)]
        self.offset = [0.0] * self.n

    def mean(self, x, j):
        s, k, m = self.w[j]
        return (10 + self.offset[j] + sum(c * v for c, v in zip(self.c[j], x)) + s * math.sin(k * x[m])
                + sum(q * x[i] * x[(i + 1) % self.p] for i, q in enumerate(self.q[j])))

    def noise(self, x, j):
        if not self.local:
            return self.sd[j]
        square = sum((v - c) ** 2 for v, c in zip(x, self.place))
        return self.sd[j] * (0.2 + 1.8 * (1 - math.exp(-2 * square)))

    def awk(self):
        names = NAMES[:self.p]
        square = "+".join(f"({n}-({c!r}))^2" for n, c in zip(names, self.place))
        lines = ["function normal() { return sqrt(-2*log(1-rand()))*cos(6.283185307179586*rand()) }",
                 "BEGIN { srand(seed); for (i = 0; i < 20; i++) rand()", f"q = {square}"]
        for j in range(self.n):
            s, k, m = self.w[j]
            mean = "+".join([repr(10 + self.offset[j]), *(f"({c!r})*{n}" for c, n in zip(self.c[j], names)),
                             f"{s!r}*sin({k!r}*{names[m]})",
                             *(f"({q!r})*{names[i]}*{names[(i + 1) % self.p]}" for i, q in enumerate(self.q[j]))])
            sd = f"{self.sd[j]!r}" + ("*(0.2+1.8*(1-exp(-2*q)))" if self.local else "")
            lines.append(f'printf "t{j}: %.9g\\n", {mean}+{sd}*normal()')
        return "\n".join(lines) + " }\n"


def nearest(form, seen, error):
    """Least root of the sum of squares of what is missed over its uncertainty, by random search with steps that shrink."""
    rng = random.Random(1)
    gap = lambda x: math.sqrt(sum(((v - form.mean(x, j)) / math.hypot(error, form.noise(x, j))) ** 2 for j, v in enumerate(seen)))  # noqa: E731
    best = min(([rng.uniform(-1, 1) for _ in range(form.p)] for _ in range(3000)), key=gap)
    for i in range(3000):
        step = 0.5 * 0.997 ** i
        best = min(best, [max(-1, min(1, v + rng.gauss(0, step))) for v in best], key=gap)
    return gap(best)


def case(index):
    """Form, truth (None: none), what was measured with its uncertainty and repeats, kind."""
    rng = random.Random(1000 + index)
    parameters, local, repeats, error = 2 + index % 3, index // 3 % 2 == 1, 3, 0.05
    kind = "reached" if index < 40 else ("law", "range", "shape")[index % 3]
    while True:
        form = Form(rng, parameters, local)
        truth = [rng.uniform(-0.8, 0.8) for _ in range(parameters)]
        if kind == "range":
            truth[rng.randrange(parameters)] = rng.choice((-1, 1)) * rng.uniform(1.5, 2.5)
        mean = [form.mean(truth, j) for j in range(form.n)]
        if kind == "law":
            mean = [m + rng.gauss(0, 1.5) for m in mean]
        if kind == "shape":
            mean[rng.randrange(form.n)] *= rng.choice((0.7, 1.4))
        seen = [m + rng.gauss(0, error) + rng.gauss(0, form.noise(truth, j)) / math.sqrt(repeats) for j, m in enumerate(mean)]
        if kind == "reached" or nearest(form, seen, error) >= FAR:
            return form, truth, seen, error, repeats, kind


def calibrate(folder, index):
    form, truth, seen, error, repeats, kind = case(index)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "form.awk").write_text(form.awk())
    words = ["awk", *(w for n in NAMES[:form.p] for w in ("-v", f"{n}={{{n}}}")), "-v", "seed={seed}", "-f", "{here}/form.awk"]
    lines = [f"seed: {1 + 1000 * index}", "experiments:", f"  e: {{command: {json.dumps(words)}}}", "parameters:"]
    lines += [f"  {n}: {{from: -1, to: 1}}" for n in NAMES[:form.p]] + ["targets:"]
    lines += [f"  t{j}: {{answer: t{j}, value: {v!r}, uncertainty: {error}, repeats: {repeats}}}" for j, v in enumerate(seen)]
    (folder / "fit.yaml").write_text("\n".join([*lines, f"budget: {{runs: {20 + 20 * form.p}}}", "batch: 10"]) + "\n")
    told = json.loads(subprocess.run([PROGRAM, "calibrate", folder / "fit.yaml", "-o", folder / "out", "-q", "--json", "--jobs", "1", "-j", "1"],
                                     check=True, stdout=subprocess.PIPE, text=True).stdout)
    identified = held = 0
    width = []
    for p, real in zip(told["parameters"], truth):
        if told.get("fits") is not False and p.get("identified"):
            identified += 1
            held += p["low"] <= real <= p["high"]
            width.append(p["high"] - p["low"])
    return {"index": index, "kind": kind, "p": form.p, "n": form.n, "local": form.local, "fits": told.get("fits"),
            "misfit": told.get("misfit"), "limit": told.get("misfit_limit"), "runs": told["runs"], "identified": identified, "held": held,
            "width": sum(width) / len(width) if width else None, "planning": told["planning_seconds"]}


def main(path, first=0, count=60):
    rows = []
    for index in range(int(first), int(first) + int(count)):
        done = path / f"{index}.json"
        if not done.exists():
            path.mkdir(parents=True, exist_ok=True)
            done.write_text(json.dumps(calibrate(path / str(index), index)))
        rows.append(json.loads(done.read_text()))
        print(*(f"{k}={v:.3g}" if isinstance(v, float) else f"{k}={v}" for k, v in rows[-1].items()), flush=True)
    can = [r for r in rows if r["kind"] == "reached"]
    cannot = [r for r in rows if r["kind"] != "reached"]
    print(f"cannot be reached: told in {sum(r['fits'] is False for r in cannot)} of {len(cannot)}; "
          f"can: told of {sum(r['fits'] is False for r in can)} of {len(can)}; "
          f"intervals of identified parameters hold {sum(r['held'] for r in can)} of {sum(r['identified'] for r in can)}")


if len(sys.argv) < 2:
    sys.exit(__doc__)
main(pathlib.Path(sys.argv[1]), *sys.argv[2:])
