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
    """Standard errors of differences are those of pairs with the same seed. An angle that a heap has not leaves the mean out."""
    groups = {}
    for row in read(path):
        groups.setdefault((row["shape"], row["variant"]), {})[row["seed"]] = row
    print("shape,variant,seeds,what,mean,error,less_scree,error")
    for (shape, variant), rows in groups.items():
        for what in COLUMNS[3:6]:
            ours = groups[shape, "scree"]
            values = [float(row[what]) for row in rows.values()]
            both = [float(rows[seed][what]) - float(ours[seed][what]) for seed in rows if seed in ours]
            cells = [c for v in (values, both) for c in (mean(v), deviation(v) / math.sqrt(len(v)) if len(v) > 1 else math.nan)]
            print(",".join([shape, variant, str(len(rows)), what, *(f"{c:.3g}" for c in cells)]))
