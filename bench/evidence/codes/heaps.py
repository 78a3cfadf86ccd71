"""What the heaps of polyhedra and of clumps share: how they are measured, and their tables compared with scree's."""
import math

from common import deviation, mean, read

COLUMNS = ["shape", "seed", "variant", "radius_mm", "height_mm", "angle_deg", "cpu_s"]


def measured(scene):
    """Of a scene's bodies: root mean square distance from their common axis and mean height (mm), and the angle by volume and
    centroid, which a low heap has not."""
    at = scene.bodies().position.tolist()
    x, y, z = (mean([p[k] for p in at]) for k in range(3))
    return 1e3 * math.sqrt(mean([(p[0] - x) ** 2 + (p[1] - y) ** 2 for p in at])), 1e3 * z, float(scene.sensors["pile.volume_deg"])


def compare(path):
    """Standard errors of the differences are those of independent heaps. What some heap has not is left out."""
    groups = {}
    for row in read(path):
        groups.setdefault((row["shape"], row["variant"]), []).append(row)
    print("shape,variant,heaps,what,mean,error,less_scree,error,errors,percent")
    for (shape, variant), rows in groups.items():
        for what in COLUMNS[3:6]:
            own, ours = ([float(r[what]) for r in group] for group in (rows, groups[shape, "scree"]))
            if any(map(math.isnan, own + ours)) or min(len(own), len(ours)) < 2:
                continue
            (m, error), (m0, error0) = ((mean(v), deviation(v) / math.sqrt(len(v))) for v in (own, ours))
            line = f"{shape},{variant},{len(own)},{what},{m:.3g},{error:.2g}"
            apart = math.hypot(error, error0)
            print(line + ("" if variant == "scree" else f",{m - m0:.2g},{apart:.2g},{(m - m0) / apart:.1f},{100 * (m - m0) / m0:.1f}"))
