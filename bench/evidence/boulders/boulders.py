#!/usr/bin/env python3
"""Boulders of a quarry (Garcia and others, Engineering Geology 310, 106855, 2022) on its slope.

  boulders.py drop --profile P --count N --seed S [--variant V] ZONE.restitution=X ZONE.friction=X ...
                        N boulders drawn at random; prints lines NAME: NUMBER, as `scree calibrate` asks
  boulders.py grid FILE.csv ZONE.restitution=X ... [--profile P] [--variant V,...] [--every N]
                        all shapes, places and every Nth orientation; adds to the table what it lacks
  boulders.py rolling FILE.csv   spheres on a ground that resists rolling by several values, at restitution 0.05 and friction 1
  boulders.py ground FILE.csv M [M ...] [--every N]   both profiles on a ground that resists rolling: zones as IMPACTS, rolling
                        friction M on the vegetated and rocky ones
  boulders.py used [--variant V,...]     triangles or spheres of every shape
  boulders.py measured  the numbers of the 41 boulders and their standard errors by bootstrap
  boulders.py fitted FIT.csv     its means, as words for `grid`

Variants: recommended, 0.0625x, 0.25x, 4x (of the recommended count), sphere, clump5, clump20, clump50.
Environment: SCREE_EVIDENCE_DIR, the folder of measurements."""
import argparse
import json
import math
import pathlib
import random
import re
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from common import WORK, Table, bootstrap, data, deviation, library, mean, read, run  # noqa: E402

SHAPES, ZONES = ("SP1A", "SP2A", "SP2B", "SP3A"), ("blue", "gray", "red")
# Restitution and friction by zone, as single impacts of Rockable read; whether the zone resists rolling.
IMPACTS = {"blue": (0.1, 0.7, 1), "gray": (0.1, 0.3, 0), "red": (0.1, 0.7, 1)}
FAR = 45  # m: on profile 1 the pit's floor begins there
COLUMNS = ["variant", "shape", "place", "orientation", "x", "y", "z", "along", "sideways", "zone", "time", "end"]


def numbers(path):
    return [list(map(float, line.split())) for line in open(path) if re.match(r"\s*[-\d]", line)]


class Terrain:
    """Which sheet lies at a place, and the fall line of a profile."""

    def __init__(self, folder, profile):
        self.cells = {}
        vertices = set()
        for zone in ZONES:
            text = open(folder / f"DTM_{zone.capitalize()}_zone.stl").read()
            rows = [tuple(map(float, line.split()[1:])) for line in re.findall(r"vertex[^\n]*", text)]
            vertices.update(rows)
            for i in range(0, len(rows), 3):
                a, b, c = rows[i:i + 3]
                for u in range(*self.span(a[0], b[0], c[0])):
                    for v in range(*self.span(a[2], b[2], c[2])):
                        self.cells.setdefault((u, v), []).append((zone, a, b, c))
        self.places = [p[:3] for p in numbers(folder / f"positions_P{profile}.xyz")]
        self.start = [mean([p[k] for p in self.places]) for k in range(3)]
        near = [v for v in vertices if abs(v[2] - self.start[2]) <= 20 and v[0] - self.start[0] <= 75]
        x, y, z = ([v[k] - mean([w[k] for w in near]) for v in near] for k in range(3))
        xx, zz, xz = (sum(p * q for p, q in zip(*pair)) for pair in ((x, x), (z, z), (x, z)))
        xy, zy = (sum(p * q for p, q in zip(s, y)) for s in (x, z))
        gx, gz = xz * zy - xy * zz, xz * xy - zy * xx
        self.down = gx / math.hypot(gx, gz), gz / math.hypot(gx, gz)

    @staticmethod
    def span(*values):
        return math.floor(min(values) / 4), math.floor(max(values) / 4) + 1

    def below(self, x, z):
        """Height and zone of the highest sheet at a place; None off the terrain."""
        best = None
        for zone, a, b, c in self.cells.get((math.floor(x / 4), math.floor(z / 4)), []):
            d = (b[2] - c[2]) * (a[0] - c[0]) + (c[0] - b[0]) * (a[2] - c[2])
            if d == 0:
                continue
            u = ((b[2] - c[2]) * (x - c[0]) + (c[0] - b[0]) * (z - c[2])) / d
            v = ((c[2] - a[2]) * (x - c[0]) + (a[0] - c[0]) * (z - c[2])) / d
            if min(u, v, 1 - u - v) >= 0:
                y = u * a[1] + v * b[1] + (1 - u - v) * c[1]
                best = max(best, (y, zone)) if best else (y, zone)
        return best

    def zone(self, x, z):
        best = self.below(x, z)
        return best[1] if best else "off"

    def seen(self, x, z):
        """Along, sideways."""
        x, z = x - self.start[0], z - self.start[2]
        return x * self.down[0] + z * self.down[1], z * self.down[0] - x * self.down[1]


def times(a, b):
    """The product of two quaternions w x y z."""
    (w, x, y, z), (p, q, r, s) = a, b
    return (w * p - x * q - y * r - z * s, w * q + x * p + y * s - z * r, w * r - x * s + y * p + z * q, w * s + x * r - y * q + z * p)


class Quarry:
    def __init__(self, profile, words):
        self.scree = library()
        self.folder = data("authume")
        self.terrain = Terrain(self.folder, profile)
        self.orientations = [row[:4] for row in numbers(self.folder / "orientations.txt")]
        values = {f"{zone}.{what}": None for zone in ZONES for what in ("restitution", "friction", "rolling_friction")}
        for word in words:
            name, _, value = word.partition("=")
            if name not in values:
                sys.exit(f"{word}: no such parameter; there are {', '.join(values)}")
            values[name] = float(value)
        self.fields = {f"pairs.{ZONES.index(zone)}.{what}": value for name, value in values.items() if value is not None
                       for zone, what in [name.split(".")]}
        for zone in ZONES:
            self.fields[f"geometry.{zone}.file"] = str(self.folder / f"DTM_{zone.capitalize()}_zone.stl")
        self.shapes, self.scratch = {}, tempfile.TemporaryDirectory()

    def closed(self, scan):
        mesh = self.scree.load(str(scan), "m").repair()
        return mesh[0] if isinstance(mesh, tuple) else mesh

    def shape(self, variant, name):
        """Fields of the scene, and how the particle's axes stand in the scan's coordinates. The files are made once."""
        if (variant, name) in self.shapes:
            return self.shapes[variant, name]
        scan, folder = self.folder / f"{name}.stl", WORK / "boulders" / variant
        folder.mkdir(parents=True, exist_ok=True)
        if variant == "sphere":
            fields, particle = {"sphere": self.scree.Particle(self.closed(scan)).measure().size, "file": None, "unit": None,
                                "triangles": None}, None
        elif variant.startswith("clump"):
            path = folder / f"{name}.csv"
            if not path.exists():
                run("clump", scan, "--unit", "m", "-n", variant[5:], "-o", folder, "-q", "-f")
            fields, particle = {"clump": str(path), "file": None, "triangles": None}, self.scree.Particle(self.closed(scan))
        else:
            path = folder / f"{name}.stl"
            if not path.exists():
                mesh = self.closed(scan)
                curve = mesh.curve()
                count = curve.choose().recommended.triangle_count * (1.0 if variant == "recommended" else float(variant[:-1]))
                level = curve.mesh(curve.find(max(4, round(count)))) if count < len(mesh.triangles) else mesh
                level.write(str(path), "m")
            fields, particle = {"file": str(path)}, self.scree.Particle(self.scree.load(str(path), "m"))
        turn = particle.measure().orientation if particle else (1, 0, 0, 0)
        self.shapes[variant, name] = fields, tuple(turn)
        return self.shapes[variant, name]

    def fall(self, variant, name, place, orientation):
        """One trajectory: a row of the table behind its key."""
        fields, turn = self.shape(variant, name)
        start = pathlib.Path(self.scratch.name) / "start.csv"
        q = times(self.orientations[orientation], turn)
        start.write_text("shape,x,y,z,qw,qx,qy,qz\nboulder," + ",".join(map(repr, [*self.terrain.places[place], *q])) + "\n")
        shape = {"file": str(self.folder / f"{name}.stl"), "unit": "m", "triangles": "all", "material": "rock"}
        shape.update(fields)
        flow = "{" + ", ".join(f"{key}: {json.dumps(value)}" for key, value in shape.items() if value is not None) + "}"
        text = (HERE / "scene.yaml").read_text()
        text = re.sub(r"^  boulder: .*$", lambda _: f"  boulder: {flow}", text, flags=re.MULTILINE)
        path = start.with_name("scene.yaml")
        path.write_text(text)
        try:
            scene = self.scree.Scene(str(path), self.fields)
            scene.run()
        except self.scree.Error as error:
            return ["nan"] * 5 + ["none", "nan", str(error).replace(",", ";").replace("\n", " ")]
        inside = bool(scene.world.live())
        x, y, z = (float(v) for v in scene.world.body(0).position)
        along, sideways = self.terrain.seen(x, z)
        return [x, y, z, along, sideways, self.terrain.zone(x, z) if inside else "off", float(scene.time),
                scene.end.replace(",", ";") if inside else "left the terrain"]


def told(rows):
    """The numbers of a drop: rows of along, sideways, zone."""
    along, sideways, zones = [r[0] for r in rows], [r[1] for r in rows], [r[2] for r in rows]
    answers = {"along_mean": mean(along), "along_sd": deviation(along), "sideways_mean": mean(sideways),
               "sideways_sd": deviation(sideways), "far_share": mean([float(a > FAR) for a in along])}
    answers.update({f"{zone}_share": zones.count(zone) / len(zones) for zone in (*ZONES, "off")})
    return answers


def drop(options):
    quarry, rng, rows, failed = Quarry(options.profile, options.words), random.Random(options.seed), [], 0
    while len(rows) < options.count:
        end = quarry.fall(options.variant, rng.choice(SHAPES), rng.randrange(4), rng.randrange(64))
        if end[5] == "none":
            failed += 1
            print("failed:", end[-1], file=sys.stderr)
            if failed > options.count // 4:
                sys.exit("more than a fifth of the trajectories failed")
        else:
            rows.append((end[3], end[4], end[5]))
    for name, value in told(rows).items():
        print(f"{name}: {value!r}")
    print(f"failed: {failed}")


def grid(options):
    table, quarry = Table(options.file, COLUMNS, 4), Quarry(options.profile, options.words)
    for orientation in range(0, 64, options.every):
        for place in range(4):
            for variant in options.variant.split(","):
                for name in SHAPES:
                    key = (variant, name, place, orientation)
                    if table.key(key) not in table.done:
                        table.add(*key, *quarry.fall(*key))


def rolling(options):
    table = Table(options.file, ["rolling_friction", "count", "along_mean", "along_sd", *(f"{z}_share" for z in (*ZONES, "off"))], 1)
    for value in (0.2, 0.3, 0.4, 0.5, 0.525, 0.55, 0.6, 0.7):
        if table.key((value,)) in table.done:
            continue
        words = {"restitution": 0.05, "friction": 1, "rolling_friction": value}
        quarry = Quarry(1, [f"{zone}.{what}={x}" for zone in ZONES for what, x in words.items()])
        ends = [quarry.fall("sphere", name, place, 0) for place in range(4) for name in SHAPES]
        answers = told([(end[3], end[4], end[5]) for end in ends])
        table.add(value, len(ends), *(answers[name] for name in table.columns[2:]))


def ground(options):
    """All shapes, places and every Nth orientation, by rolling friction and profile."""
    table = Table(options.file, ["rolling_friction", "profile", *COLUMNS], 6)
    for profile in (1, 2):
        for value in map(float, options.words):
            words = [f"{zone}.{what}={x}" for zone, (e, mu, rolls) in IMPACTS.items()
                     for what, x in (("restitution", e), ("friction", mu), ("rolling_friction", value * rolls))]
            quarry = Quarry(profile, words)
            for orientation in range(0, 64, options.every):
                for key in ((options.variant, name, place, orientation) for place in range(4) for name in SHAPES):
                    if table.key((value, profile, *key)) not in table.done:
                        table.add(value, profile, *key, *quarry.fall(*key))


def measured_rows(profile=1):
    folder = data("authume")
    terrain = Terrain(folder, profile)
    return [(*terrain.seen(row[0], row[2]), terrain.zone(row[0], row[2])) for row in numbers(folder / f"Endpoints_P{profile}.txt")]


def measured(_options):
    rows = measured_rows()
    print("answer,value,standard_error")
    for name, value in told(rows).items():
        low, high = bootstrap(lambda sample: told(sample)[name], rows, level=0.6827)
        print(f"{name},{value:.4g},{(high - low) / 2:.3g}")
    terrain, places = Terrain(data("authume"), 1), numbers(data("authume") / "Endpoints_P1.txt")
    above = sorted(y - terrain.below(x, z)[0] for x, y, z, *_ in places)
    print(f"above_terrain_median_m,{above[len(above) // 2]:.4g},")


def used(options):
    """How many triangles or spheres each description of each shape has."""
    quarry = Quarry(1, [])
    print("variant,shape,triangles,spheres")
    for variant in options.variant.split(","):
        for name in SHAPES:
            fields, _ = quarry.shape(variant, name)
            spheres = 1 if variant == "sphere" else int(variant[5:]) if variant.startswith("clump") else ""
            print(f"{variant},{name},{'' if spheres else len(quarry.scree.load(fields['file'], 'm').triangles)},{spheres}")


def fitted(options):
    for row in read(options.file):
        if row["kind"] == "parameter":
            print(f"{row['name'].replace('_', '.')}={row['mean']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    for name, function in (("drop", drop), ("grid", grid), ("rolling", rolling), ("ground", ground), ("used", used), ("measured", measured), ("fitted", fitted)):
        verb = verbs.add_parser(name)
        verb.set_defaults(function=function)
        if name in ("grid", "rolling", "ground", "fitted"):
            verb.add_argument("file")
        if name in ("drop", "grid"):
            verb.add_argument("--profile", type=int, default=1)
        if name in ("drop", "grid", "ground"):
            verb.add_argument("words", nargs="*")
        if name in ("drop", "grid", "ground", "used"):
            verb.add_argument("--variant", default="recommended")
        if name == "drop":
            verb.add_argument("--count", type=int, required=True)
            verb.add_argument("--seed", type=int, default=1)
        if name in ("grid", "ground"):
            verb.add_argument("--every", type=int, default=1)
    options = parser.parse_args()
    options.function(options)


if __name__ == "__main__":
    main()
