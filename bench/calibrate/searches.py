#!/usr/bin/env python3
"""Searches of known functions with noise and limits, beside random search of as many runs.

usage: searches.py DIR [FIRST [COUNT]]
30 searches: three seeds of Branin, Hartmann (3), Rosenbrock, a surface with many hollows and one with a ridge, the first 15 with
one limit or none, the others with two. A line each: regret at what is called best, random search's median, whether the limits hold,
whether the interval does. At the end a line of sums. Searches that were made are read again."""
import json
import math
import os
import pathlib
import random
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ.get("SCREE", str(HERE.parent.parent / "build" / "release" / "bin" / "scree"))
NAMES, BUDGET, RANDOM = "abc", 60, 400
A = ((3, 10, 30), (0.1, 10, 35), (3, 10, 30), (0.1, 10, 35))
P = ((0.3689, 0.117, 0.2673), (0.4699, 0.4387, 0.747), (0.1091, 0.8732, 0.5547), (0.0381, 0.5743, 0.8828))
C = (1, 1.2, 3, 3.2)


def awk_sum(terms):
    return "+".join(terms)


HARTMANN = "-(" + awk_sum(f"{c}*exp(-({awk_sum(f'{a}*(({n}+1)/2-{p})^2' for a, p, n in zip(As, Ps, NAMES))}))" for c, As, Ps in zip(C, A, P)) + ")"
FORMS = {  # parameters, the function on [-1, 1], noise; awk and Python read the same words, ^ aside
    "branin": (2, "((15*(b+1)/2-5.1/39.4784176*(15*(a+1)/2-5)^2+5/3.14159265*(15*(a+1)/2-5)-6)^2+10*(1-1/25.1327412)*cos(15*(a+1)/2-5)+10)/10", 0.1),
    "hartmann": (3, HARTMANN, 0.05),
    "rosenbrock": (2, "log(1+100*(2*b-4*a^2+1)^2/10+(1-2*a)^2)", 0.05),
    "hollows": (2, "a^2+b^2+0.4*(2-cos(9*a-1)-cos(9*b+2))", 0.05),
    "ridge": (2, "sqrt((a-0.5*sin(3*b)-0.2)^2+0.01)+0.3*(b-0.4)^2", 0.03),
}
LIMITS = (("a+b", 0.3), ("a*a+0.5*b", 0.6))  # answer, at most


def value(words, x):
    scope = {n: v for n, v in zip(NAMES, x)} | {"exp": math.exp, "cos": math.cos, "sin": math.sin, "log": math.log, "sqrt": math.sqrt}
    return eval(words.replace("^", "**"), {"__builtins__": {}}, scope)


def cases():
    for index in range(30):
        name = list(FORMS)[index % 5]
        yield index, name, 2 if index >= 15 else (index // 5) % 2


def best_of(parameters, words, limits):
    rng = random.Random(1)
    allowed = lambda x: all(value(w, x) <= most for w, most in limits)  # noqa: E731
    best = min((x for x in ([rng.uniform(-1, 1) for _ in range(parameters)] for _ in range(20000)) if allowed(x)), key=lambda x: value(words, x))
    for i in range(4000):
        tried = [max(-1, min(1, v + rng.gauss(0, 0.2 * 0.998 ** i))) for v in best]
        if allowed(tried) and value(words, tried) < value(words, best):
            best = tried
    return value(words, best)


def random_regret(rng, parameters, words, noise, limits, least):
    seen = []
    for _ in range(BUDGET):
        x = [rng.uniform(-1, 1) for _ in range(parameters)]
        held = all(value(w, x) + rng.gauss(0, 0.05) <= most for w, most in limits)
        seen.append((not held, value(words, x) + rng.gauss(0, noise), x))
    x = min(seen)[2]
    return max(value(words, x) - least, max([value(w, x) - most for w, most in limits], default=0), 0)


def search(folder, index, name, count):
    parameters, words, noise = FORMS[name]
    limits = LIMITS[:count]
    least = best_of(parameters, words, limits)
    rng = random.Random(index)
    chance = statistics.median(random_regret(rng, parameters, words, noise, limits, least) for _ in range(RANDOM // 4))
    folder.mkdir(parents=True, exist_ok=True)
    lines = ["function normal() { return sqrt(-2*log(1-rand()))*cos(6.283185307179586*rand()) }",
             "BEGIN { srand(seed); for (i = 0; i < 20; i++) rand()", f'printf "f: %.9g\\n", {words}+{noise}*normal()']
    lines += [f'printf "g{k}: %.9g\\n", {w}+0.05*normal()' for k, (w, _) in enumerate(limits)]
    (folder / "form.awk").write_text("\n".join(lines) + " }\n")
    command = ["awk", *(w for n in NAMES[:parameters] for w in ("-v", f"{n}={{{n}}}")), "-v", "seed={seed}", "-f", "{here}/form.awk"]
    text = [f"seed: {1 + 1000 * index}", "experiments:", f"  e: {{command: {json.dumps(command)}}}", "parameters:"]
    text += [f"  {n}: {{from: -1, to: 1}}" for n in NAMES[:parameters]] + ["minimise: {answer: f}"]
    text += ["limits:"] * (count > 0) + [f"  g{k}: {{answer: g{k}, at_most: {most}}}" for k, (_, most) in enumerate(limits)]
    (folder / "search.yaml").write_text("\n".join([*text, f"budget: {{runs: {BUDGET}}}"]) + "\n")
    told = json.loads(subprocess.run([PROGRAM, "optimise", folder / "search.yaml", "-o", folder / "out", "-q", "--json", "--jobs", "1", "-j", "1"],
                                     check=True, stdout=subprocess.PIPE, text=True).stdout)
    best = told["settings"][0]
    real = value(words, best["values"])
    over = max([value(w, best["values"]) - most for w, most in limits], default=-1)
    return {"index": index, "form": name, "limits": count, "regret": max(0, real - least), "random": chance, "kept": over <= 0,
            "allowed": best["allowed"], "held": best["low"] <= real <= best["high"], "runs": told["runs"]}


def main(path, first=0, count=30):
    rows = []
    for index, name, limits in list(cases())[int(first):int(first) + int(count)]:
        done = path / f"{index}.json"
        if not done.exists():
            path.mkdir(parents=True, exist_ok=True)
            done.write_text(json.dumps(search(path / str(index), index, name, limits)))
        rows.append(json.loads(done.read_text()))
        print(*(f"{k}={v:.3g}" if isinstance(v, float) else f"{k}={v}" for k, v in rows[-1].items()), flush=True)
    print(f"regret at most half of random search's median in {sum(r['regret'] <= r['random'] / 2 for r in rows)} of {len(rows)}; "
          f"limits kept in {sum(r['kept'] for r in rows)}; intervals hold {sum(r['held'] for r in rows)}")


if len(sys.argv) < 2:
    sys.exit(__doc__)
main(pathlib.Path(sys.argv[1]), *sys.argv[2:])
