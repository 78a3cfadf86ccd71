#!/usr/bin/env python3
"""The figures of docs/background/evidence.md and shape-and-calibration.md, from the tables in results/ that are there."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "boulders"))
from boulders import measured_rows  # noqa: E402
from common import DATA, HERE, ROOT, read  # noqa: E402
from compare import rockable, simulated  # noqa: E402
from figure import distribution, stack, write  # noqa: E402

RESULTS, FIGURES = HERE / "results", ROOT / "docs" / "figures"


def boulders():
    corner, fit = RESULTS / "boulders-corner.csv", RESULTS / "boulders-grid.csv"
    if not corner.exists() or not fit.exists() or not (DATA / "authume").is_dir():
        return
    samples = [("measured, 41 boulders", measured_rows()), ("Rockable", rockable()), ("scree, most dissipative", simulated(corner)),
               ("scree, first fit", simulated(fit))]
    write(FIGURES / "evidence-boulders.svg", [(name, distribution([r[0] for r in rows]), "line") for name, rows in samples],
          "run-out along the fall line, m", "share that stopped before", (-5, 115, 0, 1))
    variants = ("4x", "recommended", "0.25x", "0.0625x", "clump50", "clump20", "clump5", "sphere")
    write(FIGURES / "evidence-shapes.svg", [(v, distribution([r[0] for r in simulated(corner, v)]), "line") for v in variants],
          "run-out along the fall line, m", "share that stopped before", (-5, 115, 0, 1))


def drum():
    table = RESULTS / "drum-measured.csv"
    if not table.exists():
        return
    series = []
    for rpm in (15, 45):
        series.append((f"measured, {rpm} rpm", surface(read(table), f"length_{rpm}_mm"), "points"))
    for rpm in (10, 15, 30, 45):
        path = RESULTS / f"drum-{rpm}.csv"
        if path.exists():
            series.append((f"scree, {rpm} rpm", surface(read(path), "length_mm"), "line"))
    write(FIGURES / "evidence-drum.svg", series, "x, mm", "height of the surface, mm", (-42, 42, -42, 42))


def surface(rows, column):
    points = [(float(r["x_mm"]), float(r[column])) for r in rows]
    return [(x, length - (42 * 42 - x * x) ** 0.5) for x, length in points if abs(x) < 0.9 * 42]


def penetration():
    table = RESULTS / "penetration.csv"
    if table.exists():
        rows = read(table)
        write(FIGURES / "evidence-penetration.svg",
              [(name, [(1e3 * float(r["time"]), 1e3 * float(r[f"{column}_z"])) for r in rows], "line")
               for name, column in (("LIGGGHTS", "liggghts"), ("scree", "scree"))], "time, ms", "height of the ball, mm")


def orifice():
    table = RESULTS / "orifice.csv"
    if table.exists():
        series = [(name, [(float(r["hole"]), float(r["rate"]) ** 0.4) for r in read(table) if r["code"] == name], "points")
                  for name in ("scree", "liggghts", "liggghts-no-dashpot", "yade")]
        write(FIGURES / "evidence-orifice.svg", series, "hole, sphere diameters", "(spheres a second) to the power 2/5")


def bulk():
    table = RESULTS / "bulk-drum.csv"
    if table.exists():
        rows = read(table)
        series = [(f"{code}, {name}", [(float(r["time"]), float(r[column])) for r in rows if r["code"] == code.lower()], "line")
                  for column, name in (("down.small", "small below"), ("down.large", "large below"), ("up.small", "small above"), ("up.large", "large above"))
                  for code in ("scree", "LIGGGHTS")]
        write(FIGURES / "evidence-bulk.svg", series, "time, s", "spheres in a quarter")


def shape():
    table = RESULTS / "shape-compared.csv"
    if not table.exists():
        return
    most, names, rows = 8.0, {"as true": "friction as true", "rolling": "rolling fitted at 0.5", "friction": "friction fitted"}, read(table)
    panels = {row["scan"]: {way: [] for way in names} for row in rows}
    for r in rows:
        if r["quantity"] == "all":
            error, label = float(r["error"]), {"clump1": "sphere", "0.25x": "a quarter", "0.0625x": "a sixteenth"}.get(r["description"], r["description"])
            panels[r["scan"]][r["way"]].append((float(r["us"]), min(error, most), f"{label}: {error:.0f}" if error > most else label,
                                                *(min(float(r[end]), most) for end in ("low", "high"))))
    stack(FIGURES / "shape-and-calibration.svg", [(scan, [(names[way], points, "points") for way, points in series.items() if points])
                                                  for scan, series in panels.items()],
          "processor time of a body and step, us", "error of what was not fitted, margins", (0, 1.8, 0, 1.05 * most))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        sys.exit(__doc__)
    boulders()
    drum()
    penetration()
    orifice()
    bulk()
    shape()
