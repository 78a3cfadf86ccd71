"""From scans to an angle of repose, in Python: decimates each scan, pours the mix into a heap, prints what it
measures, and leaves report.html, in which the heap plays. Interrupted, the same command goes on.

    python3 examples/heap.py FOLDER [SCAN...]      SCAN: a file in mm, or sample:NAME"""
from __future__ import annotations

import math
import pathlib
import sys
from typing import Any, Mapping

import scree


def main(target: str | pathlib.Path, *scans: str, fields: Mapping[str, Any] | None = None, triangles: int = 60) -> None:
    folder = pathlib.Path(target)
    shapes = {}
    for name in scans or ("sample:fp-1", "sample:sp-1"):
        options: dict[str, Any] = {"resolution": 2e-3} if name.startswith("sample:") else {}
        shapes[pathlib.Path(name.removeprefix("sample:")).stem] = scree.load(name, **options).simplify(count=triangles)

    settings = {"preset": "demo", "particles": 40, "cylinder.diameter": 0.25, **(fields or {})}
    scene = scree.Scene.template("repose", shapes, settings).complete(folder, resume=True)

    heap = scene.piles()["heap"]
    if heap.repose.heap:
        print(f"{heap.repose.sector_deg:.1f} degrees by sectors, {heap.repose.cone_deg:.1f} by the cone")
    else:
        print(f"no heap: {heap.repose.reason}")
    series = scene.series()
    fastest = max(range(len(series["time"])), key=lambda row: float(series["mean_rotation"][row]))
    print(f"{heap.body_count} particles after {scene.time:.2f} s; most rotation {series['mean_rotation'][fastest]:.1f} rad/s, "
          f"at {series['time'][fastest]:.2f} s")

    motion = scree.Motion(folder)  # where every wall and body was
    walls = len(scene.geometry)
    start, end = [[pose for pose in motion.poses[frame][walls:] if not math.isnan(pose[0])]
                  for frame in (len(motion) // 2, -1)]
    print(f"highest centre at half time {1000 * max(pose[2] for pose in start):.0f} mm, at the end "
          f"{1000 * max(pose[2] for pose in end):.0f} mm")
    scree.report(folder, folder / "report.html")


if __name__ == "__main__":
    main(*sys.argv[1:])
