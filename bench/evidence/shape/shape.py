#!/usr/bin/env python3
"""Does shape beat calibration? Cheaper descriptions of a stone, whose friction or rolling friction is fitted to the truth's heap, tell
what was not fitted.

  shape.py tower TABLE.csv SEEDS DESCRIPTION...   heap, packing, discharge and what stays, by friction and rolling friction
  shape.py slope|drum TABLE.csv SEEDS TOWER.csv DESCRIPTION...   run-out; slope and segregation: as the truth is and as fitted
  shape.py compare TOWER.csv SLOPE.csv DRUM.csv   what is fitted and the errors of what is not, as CSV

SEEDS is a range as 2-4; tables get the rows that they lack. Descriptions: 4x (the truth), recommended, 0.25x, 0.0625x, clump1 to
clump50. Margins: ../margins.md. Environment: SCREE_DATA_DIR (the stone's folder, default ../shared/data)."""
import math
import os
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import ROOT, WORK, Table, bootstrap, library, mean, processor_time, read, run, show  # noqa: E402

SCAN = pathlib.Path(os.environ.get("SCREE_DATA_DIR", ROOT.parent / "shared" / "data")) / "stone_073ac.ply"
TRUTH, FRICTION, D = "4x", 0.5, 0.02
# Ways to fit: rows of friction and rolling friction, along which one of them grows. Spheres need both.
WAYS = {"friction": [(0.25, 0.0), (0.5, 0.0), (0.9, 0.0)], "rolling": [(0.25, 0.0), (0.25, 0.15), (0.25, 0.4)],
        "both": [(0.5, 0.0), (0.5, 0.15), (0.5, 0.4)]}
AS_TRUE = (FRICTION, 0.0)
MARGINS = {"packing": 0.015, "discharge": 0.02, "stays": 4, "run_out": 0.05, "slope": 2, "segregation": 0.1}


def grain(description):
    """The file of a description, made once."""
    path = WORK / "shape" / description / (SCAN.stem + (".csv" if description.startswith("clump") else ".stl"))
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        if description.startswith("clump"):
            run("clump", SCAN, "-n", description[5:], "-o", path.parent, "-q", "-f", "--threads", 1)
        else:
            mesh = library().load(str(SCAN)).repair()
            curve = (mesh[0] if isinstance(mesh, tuple) else mesh).curve()
            count = curve.choose().recommended.triangle_count * (1.0 if description == "recommended" else float(description[:-1]))
            curve.mesh(curve.find(max(4, round(count)))).write(str(path))
    return path


def scene(name, description, friction, rolling, seed=1):
    path = grain(description)
    file = path.with_name(f"{name}.yaml")
    file.write_text((HERE / file.name).read_text().replace("file: grain.stl", f"{'clump' if path.suffix == '.csv' else 'file'}: {path.name}"))
    return library().Scene(str(file), {"materials.grain.friction": friction, "materials.grain.rolling_friction": rolling, "seed": seed})


def tower(description, friction, rolling, seed):
    """Angle of the wedge below, packing, time until 40 are out, how many stay, processor time of a body and step."""
    begun = processor_time()
    box = scene("tower", description, friction, rolling, seed)
    box.run(until=0.7)
    heights = [p[2] for p in box.bodies().position.tolist()]
    packing = len(heights) * math.pi / 6 * D ** 3 / (0.16 * 0.1 * 2 * mean(heights))
    below, moment = 0, math.nan
    while box.time < 1.8 - 1e-9:
        box.run(until=box.time + 0.01)
        at = box.bodies().position.tolist()
        now = sum(p[2] < 0 for p in at)
        if below < 40 <= now:
            moment = box.time - 0.7 - 0.01 * (now - 40) / (now - below)
        below = now
    heap = [(p[0], p[2] + 0.07) for p in at if p[2] < 0]
    middle = mean([x for x, _ in heap])
    wide = math.sqrt(mean([(x - middle) ** 2 for x, _ in heap]))
    angle = math.degrees(math.atan(3 * mean([z for _, z in heap]) / (math.sqrt(6) * wide)))
    return angle, packing, moment, len(at) - below, 1e6 * (processor_time() - begun) / (90 * box.world.step_count)


