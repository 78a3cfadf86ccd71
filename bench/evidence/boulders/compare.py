#!/usr/bin/env python3
"""Where boulders came to rest: measured, by Rockable and by scree; and which description of the shape would have misled.

  compare.py places GRID.csv     as CSV: measured, Rockable and scree at the fitted parameters, two by two
  compare.py ground GROUND.csv   as CSV: places by rolling friction beside the measured ones; fitted on one profile, told of the other
  compare.py shapes GRID.csv     as CSV: every variant beside 4x, trajectories with the same start as pairs
Margins: ../margins.md. Environment: SCREE_EVIDENCE_DIR."""
import csv
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from boulders import ZONES, Terrain, measured_rows  # noqa: E402
from common import bootstrap, data, deviation, kolmogorov, kolmogorov_p, mean, read, show  # noqa: E402

REFERENCE, SPAN, NEAR, FAR = "4x", 3.0, 0.12, 0.2   # m; Kolmogorov distances
FIT = 0.35


def rockable():
    terrain, rows = Terrain(data("authume"), 1), []
    with open(data("authume") / "rockable_endpoints.csv") as file:
        for row in csv.DictReader(file):
            if row["profile"] != "P1":
                continue
            x, z = float(row["x_end_m"]), float(row["z_end_m"])
            rows.append((*terrain.seen(x, z), terrain.zone(x, z)))
    return rows


def simulated(path, variant="recommended"):
    return [(float(r["along"]), float(r["sideways"]), r["zone"]) for r in read(path) if r["variant"] == variant and r["zone"] != "none"]


def distance_interval(d, a, b):
    """Basic bootstrap: samples drawn anew lie farther apart than those they are drawn from, by what 2 d - q takes away."""
    low, high = bootstrap(kolmogorov, a, b)
    return max(0.0, 2 * d - high), min(1.0, max(0.0, 2 * d - low))


def places(grid):
    samples = {"measured": measured_rows(), "rockable": rockable(), "scree": simulated(grid)}
    show("sample", "beside", "count", "along_mean", "along_sd", "sideways_mean", "sideways_sd", *ZONES, "off", "d_along", "d_along_low",
         "d_along_high", "p_along", "d_sideways", "d_sideways_low", "d_sideways_high", "p_sideways", "verdict_along")
    for name, beside in (("measured", ""), ("rockable", "measured"), ("scree", "measured"), ("scree", "rockable")):
        rows = samples[name]
        line = [name, beside, len(rows), *(f([r[k] for r in rows]) for k in (0, 1) for f in (mean, deviation)),
                *([r[2] for r in rows].count(zone) / len(rows) for zone in (*ZONES, "off"))]
        verdict = ""
        for k in (0, 1) if beside else ():
            a, b = [r[k] for r in rows], [r[k] for r in samples[beside]]
            d = kolmogorov(a, b)
            p, (low, high) = kolmogorov_p(d, len(a), len(b)), distance_interval(d, a, b)
            line += [d, low, high, p]
            if k == 0:
                verdict = "differs" if p < 0.05 else "agrees" if high < FIT else "open"
        show(*line, *([""] * 8 if not beside else []), verdict)


def crossing(values, means, wanted):
    """Where straight lines between the means reach what is wanted; beyond the values the nearest one."""
    rows = sorted(zip(values, means))
    for (a, fa), (b, fb) in zip(rows, rows[1:]):
        if (fa - wanted) * (fb - wanted) <= 0 and fa != fb:
            return a + (b - a) * (fa - wanted) / (fa - fb)
    return min(rows, key=lambda row: abs(row[1] - wanted))[0]


def between(values, means, at):
    rows = sorted(zip(values, means))
    for (a, fa), (b, fb) in zip(rows, rows[1:]):
        if a <= at <= b:
            return fa + (fb - fa) * (at - a) / (b - a)
    return rows[0][1] if at < rows[0][0] else rows[-1][1]


def ground(path):
    rows, values = {}, []
    for r in read(path):
        if r["zone"] != "none":
            rows.setdefault((int(r["profile"]), float(r["rolling_friction"])), []).append((float(r["along"]), float(r["sideways"]), r["zone"]))
    values = sorted({value for _, value in rows})
    show("profile", "rolling_friction", "count", "along_mean", "along_sd", "sideways_mean", "sideways_sd", *ZONES, "off", "low", "high")
    real = {profile: measured_rows(profile) for profile in (1, 2)}
    for profile in (1, 2):
        for value, sample in [("measured", real[profile])] + [(v, rows[profile, v]) for v in values if (profile, v) in rows]:
            show(profile, value, len(sample), *(f([r[k] for r in sample]) for k in (0, 1) for f in (mean, deviation)),
                 *([r[2] for r in sample].count(zone) / len(sample) for zone in (*ZONES, "off")), "", "")
    keys = sorted(rows)
    for fitted, told in ((1, 2), (2, 1)):
        def answer(*samples):
            means = {key: mean([r[0] for r in sample]) for key, sample in zip(keys, samples)}
            at = crossing(values, [means[fitted, v] for v in values], mean([r[0] for r in samples[-1]]))
            return at, between(values, [means[told, v] for v in values], at)
        samples = [rows[key] for key in keys] + [real[fitted]]
        best = answer(*samples)
        spans = [bootstrap(lambda *s, k=k: answer(*s)[k], *samples) for k in (0, 1)]
        show(f"fitted on {fitted}", best[0], *[""] * 9, *spans[0])
        show(f"told of {told}", "", "", best[1], *[""] * 7, *spans[1])


def shapes(grid):
    rows = {}
    for r in read(grid):
        if r["zone"] != "none":
            rows.setdefault(r["variant"], {})[r["shape"], r["place"], r["orientation"]] = float(r["along"])
    show("variant", "pairs", "along_mean", "along_sd", "difference", "low", "high", "sd_of_differences", "d", "d_low", "d_high", "verdict")
    reference = rows[REFERENCE]
    for variant, ends in rows.items():
        keys = [k for k in ends if k in reference]
        a, b = [ends[k] for k in keys], [reference[k] for k in keys]
        if variant == REFERENCE:
            show(variant, len(keys), mean(a), deviation(a), *[""] * 8)
            continue
        differences = [x - y for x, y in zip(a, b)]
        half = 1.645 * deviation(differences) / math.sqrt(len(keys))
        low, high = mean(differences) - half, mean(differences) + half
        d = kolmogorov(a, b)
        d_low, d_high = distance_interval(d, a, b)
        misled = low > SPAN or high < -SPAN or d_low > NEAR
        same = low > -SPAN and high < SPAN and d_high < FAR
        show(variant, len(keys), mean(a), deviation(a), mean(differences), low, high, deviation(differences), d, d_low, d_high,
             "misleads" if misled else "does not" if same else "open")


if __name__ == "__main__":
    if len(sys.argv) != 3 or sys.argv[1] not in ("places", "ground", "shapes"):
        sys.exit(__doc__)
    {"places": places, "ground": ground, "shapes": shapes}[sys.argv[1]](sys.argv[2])
