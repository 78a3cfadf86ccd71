"""From scans to an angle of repose, in Python: decimates each scan, pours the mix into a heap, prints what it
measures, and leaves report.html, in which the heap plays. Interrupted, the same command goes on.

    python3 examples/heap.py FOLDER [SCAN...]      SCAN: a file in mm, or sample:NAME"""
import math
import pathlib
import sys

import scree


def main(folder, *scans, fields=(), triangles=60):
    folder = pathlib.Path(folder)
    shapes = {}
    for name in scans or ("sample:fp-1", "sample:sp-1"):
        options = {"resolution": 2e-3} if name.startswith("sample:") else {}
        shapes[pathlib.Path(name.removeprefix("sample:")).stem] = scree.load(name, **options).simplify(count=triangles)

    experiment = scree.Experiment("demo", {"particles": 40, "cylinder.diameter": 0.25, **dict(fields)})
    run = scree.repose(shapes, experiment, folder=folder, resume=True)

    heap = run.measure()
    if heap.repose.heap:
        print(f"{heap.repose.sector_deg:.1f} degrees by sectors, {heap.repose.cone_deg:.1f} by the cone")
    else:
        print(f"no heap: {heap.repose.reason}")
    fastest = max(run.series(), key=lambda point: point.mean_rotation)
    print(f"{heap.body_count} particles after {heap.time:.2f} s; most rotation {fastest.mean_rotation:.1f} rad/s, "
          f"while {fastest.phase}, at {fastest.time:.2f} s")

    motion = scree.Motion(folder)  # where every body was
    start, end = [[pose for pose in motion.poses[frame] if not math.isnan(pose[0])] for frame in (len(motion) // 2, -1)]
    print(f"highest centre at half time {1000 * max(pose[2] for pose in start):.0f} mm, at the end "
          f"{1000 * max(pose[2] for pose in end):.0f} mm")

    run.write_json(folder / "result.json", overwrite=True)
    scree.report(folder, folder / "report.html", overwrite=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
