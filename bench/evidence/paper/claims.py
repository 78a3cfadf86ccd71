#!/usr/bin/env python3
"""The claims of Katagiri and Koyanaka (Materials Transactions 61, 1158, 2020) on the reduced study: 297 of the nine devices, ten
replicates of seven levels (bench/results/study/runs.csv), and the recommended level (recommended-runs.csv).

  claims.py                       as CSV: each claim's number, its interval of 90 %, what was asked of it, and the verdict
  claims.py runs FOLDER TABLE.csv  adds to the table the runs of study.yaml that are done; its heaps are measured by volume and centroid

An equality is confirmed if the interval lies within the margin, refuted if it lies outside; a direction is confirmed if the interval lies
on its side of 0, refuted on the other; else it is not shown. Replicates: what shows an equality within the margin with 90 % power
if there is no difference, a direction if the difference is as measured. The last rows are the cost of the study at full size
at the rates of these runs, steps as in bench/results/paper."""
import math
import pathlib
import sqlite3
import statistics
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import ROOT, Table, deviation, mean, read, student  # noqa: E402

STUDY = ROOT / "bench" / "results" / "study"
RUNS = HERE.parent / "results" / "paper-runs.csv"
ASKED = 6  # heaps of a level
ANGLES = {"volume_deg": "by volume", "sector_deg": "by sectors, the same heaps"}
LEVELS = ("1e-5", "3e-5", "1e-4", "3e-4", "1e-3", "2e-3")
FULL_STEPS, FULL_BODIES, REPLICATES = 1444400, 1197, 10
POWER = 1.645 + 1.282


def values(rows, rp, column):
    return [float(r[column]) for r in rows if r["rp"] == rp and r[column]]


def apart(a, b):
    """Difference of both means, its standard error, Welch's degrees of freedom."""
    u, v = (deviation(x) ** 2 / len(x) for x in (a, b))
    return mean(a) - mean(b), math.sqrt(u + v), (u + v) ** 2 / (u * u / (len(a) - 1) + v * v / (len(b) - 1))


def spread(rows, relative):
    """The logarithm of the scatter of the two finest levels less that of the two coarsest, as apart()."""
    terms = []
    for rp in ("1e-3", "2e-3", "1e-5", "3e-5"):
        x = values(rows, rp, "sector_deg")
        share = deviation(x) / mean(x) if relative else 0.0
        terms.append((math.log(share or deviation(x)), 0.5 / (len(x) - 1) + share * share / len(x)))
    return 0.5 * (terms[0][0] + terms[1][0] - terms[2][0] - terms[3][0]), 0.5 * math.sqrt(sum(t[1] for t in terms)), 36


def equal(claim, found, margin, count, unit):
    difference, error, free = found
    low, high = difference - student(free) * error, difference + student(free) * error
    verdict = "confirmed" if -margin < low and high < margin else "refuted" if low > margin or high < -margin else "not shown"
    needed = math.ceil(count * (POWER * error / margin) ** 2)
    print(f"{claim},{difference:.3g},{low:.3g},{high:.3g},within {margin:g} {unit},{verdict},{needed}")


def side(claim, found, sign, count):
    difference, error, free = found
    low, high = difference - student(free) * error, difference + student(free) * error
    verdict = "confirmed" if sign * low > 0 and sign * high > 0 else "refuted" if sign * low < 0 and sign * high < 0 else "not shown"
    needed = math.ceil(count * (POWER * error / difference) ** 2)
    print(f"{claim},{difference:.3g},{low:.3g},{high:.3g},{'above' if sign > 0 else 'below'} 0,{verdict},{needed}")


def line(points):
    """Least squares: the fit, its slope's standard error, degrees of freedom."""
    fit = statistics.linear_regression(*zip(*points))
    x = mean([p[0] for p in points])
    rest = sum((y - fit.slope * a - fit.intercept) ** 2 for a, y in points) / (len(points) - 2)
    return fit.slope, math.sqrt(rest / sum((a - x) ** 2 for a, _ in points)), len(points) - 2


def slope(rows):
    """Of the logarithm of processor time over that of Rp from 1e-4 on."""
    return line([(math.log(float(rp)), math.log(s)) for rp in LEVELS[2:] for s in values(rows, rp, "processor_seconds")])


def trend(rows):
    """The rise of the angle over the logarithm of the triangles from 1e-4 to 2e-3."""
    counts = {rp: math.log(values(rows, rp, "triangle_count")[0]) for rp in (*LEVELS[2:], "recommended", "2*recommended")}
    rise, error, free = line([(x, angle) for rp, x in counts.items() for angle in values(rows, rp, "sector_deg")])
    span = counts[LEVELS[-1]] - counts[LEVELS[2]]
    return rise * span, error * span, free


def by_volume():
    rows = read(RUNS)

    def asked(claim, way, one, other, test):
        a, b = (values(rows, level, way) for level in (one, other))
        if min(len(a), len(b)) >= ASKED:
            test(f"angle {ANGLES[way]} at {one} less that at {other} (deg)", apart(a, b), claim, min(len(a), len(b)))
    for way in ANGLES:
        for level in ("1e-4", "recommended"):
            asked(3, way, level, "1e-3", lambda *words: equal(*words, "deg"))
        asked(-1, way, "1e-5", "1e-4", side)


def runs(folder, path):
    table = Table(path, ["rp", "replicate", "seed", "triangles", "processor_seconds", *ANGLES, "silhouette_deg", "hash"], 2)
    base = sqlite3.connect(f"file:{pathlib.Path(folder) / 'study.sqlite'}?mode=ro", uri=True)
    for row in base.execute("select rp, replicate, seed, triangle_count, processor_seconds, answer.value, sector_deg, silhouette_deg, hash"
                            " from run join point using (point) join answer using (key) where state = 'done' order by run"):
        if table.key(row) not in table.done:
            table.add(*("" if v is None else v for v in row))


def claims():
    rows = [r for r in read(STUDY / "runs.csv") if r["state"] == "done"]
    recommended = read(STUDY / "recommended-runs.csv")

    def heaps(rp):
        return values(recommended if "recommended" in rp else rows, rp, "sector_deg")

    print("claim,value,low,high,asked,verdict,replicates")
    for rp in ("1e-4", "3e-4", "1e-3"):
        equal(f"angle at {rp} less that at 2e-3 (deg)", apart(heaps(rp), heaps("2e-3")), 3, 10, "deg")
    equal("angle at the recommended level less that at 2e-3 (deg)", apart(heaps("recommended"), heaps("2e-3")), 3, len(heaps("recommended")), "deg")
    rise = trend(rows + recommended)
    equal("rise of the angle from 1e-4 to 2e-3 by all levels (deg)", rise, 3, 10, "deg")
    side("angle at 1e-5 less that at 1e-4 (deg)", apart(heaps("1e-5"), heaps("1e-4")), -1, 9)
    side("ln of SD at 1e-3 and 2e-3 over 1e-5 and 3e-5", spread(rows, False), -1, 10)
    side("ln of CV at 1e-3 and 2e-3 over 1e-5 and 3e-5", spread(rows, True), -1, 10)
    none = sum(r["heap"] == "0" for r in rows if r["rp"] == "spheres")
    print(f"spheres without a heap of {REPLICATES},{none},,,all,{'confirmed' if none == REPLICATES else 'refuted'},")

    if RUNS.exists():
        by_volume()

    def turning(rp):
        return values(rows, rp, "mean_rotation_lifting")
    side("rotation of spheres less that at 1e-4 (rad/s)", apart(turning("spheres"), turning("1e-4")), 1, 10)
    side("rotation at 1e-5 less that at 1e-4 (rad/s)", apart(turning("1e-5"), turning("1e-4")), 1, 9)
    fine, finest = (values(rows, rp, "processor_seconds") for rp in ("1e-3", "2e-3"))
    share = 100 * mean(fine) / mean(finest)
    error = share * math.sqrt(sum((deviation(x) / mean(x)) ** 2 / len(x) for x in (fine, finest)))
    equal("time at 1e-3 in % of that at 2e-3 less 58", (share - 58, error, 18), 5, 10, "points")
    equal("power of Rp that time grows with less 4", (slope(rows)[0] - 4, *slope(rows)[1:]), 0.5, 10, "")
    total = 0.0
    for rp in ("spheres", *LEVELS):
        rate = mean([float(r["processor_seconds"]) / float(r["particle_steps"]) for r in rows if r["rp"] == rp])
        hours = rate * FULL_STEPS * FULL_BODIES / 3600
        total += REPLICATES * hours
        print(f"full size: hours of a core for one run at {rp},{hours:.2g},,,,,")
    print(f"full size: hours of a core for {REPLICATES} replicates of all,{total:.3g},,,,,")


if __name__ == "__main__":
    if sys.argv[1:2] == ["runs"] and len(sys.argv) == 4:
        runs(*sys.argv[2:])
    elif len(sys.argv) == 1:
        claims()
    else:
        sys.exit(__doc__)
