#!/usr/bin/env python3
"""The scripts of bench/evidence on inputs whose answers are known: statistics against counting and random samples, a table
that was broken off, a drawn picture, a camera over one sphere, hits, a cube dropped on a slope of three sheets, fits on
straight lines, and rates by Beverloo's law.
usage: check.py ROOT, with SCREE_LIBRARY and PYTHONPATH"""
import contextlib
import io
import math
import os
import pathlib
import random
import struct
import sys
import tempfile
from types import SimpleNamespace

ROOT, SCRATCH = pathlib.Path(sys.argv[1]), tempfile.TemporaryDirectory()
HOME = pathlib.Path(SCRATCH.name)
os.environ["SCREE_EVIDENCE_DIR"], os.environ["SCREE_EVIDENCE_WORK"] = str(HOME), str(HOME / "work")
for folder in ("", "boulders", "bulk", "codes", "drum", "hits", "impacts", "orifice", "paper", "shape"):
    sys.path.insert(0, str(ROOT / "bench" / "evidence" / folder))
import boulders  # noqa: E402
import bulk  # noqa: E402
import claims  # noqa: E402
import clumps  # noqa: E402
import common  # noqa: E402
import drum  # noqa: E402
import heaps  # noqa: E402
import hits  # noqa: E402
import impacts  # noqa: E402
import orifice  # noqa: E402
import polyhedra  # noqa: E402
import rockable  # noqa: E402
import shape  # noqa: E402
import turning  # noqa: E402

wrong = []


def check(true, what):
    if not true:
        wrong.append(what)


def statistics():
    rng = random.Random(1)
    for _ in range(300):
        a, b = ([rng.randrange(8) for _ in range(rng.randrange(1, 12))] for _ in range(2))
        slow = max(abs(sum(v <= x for v in a) / len(a) - sum(v <= x for v in b) / len(b)) for x in a + b)
        check(abs(common.kolmogorov(a, b) - slow) < 1e-12, f"the distance of {a} and {b}")
    hits = sum(common.kolmogorov_p(common.kolmogorov(*([rng.random() for _ in range(n)] for n in (41, 60))), 41, 60) < 0.1
               for _ in range(1000))
    check(60 < hits < 130, f"{hits} of 1000 samples of one distribution have p below 0.1")
    held = 0
    for k in range(200):
        low, high = common.bootstrap(common.mean, [rng.gauss(0, 1) for _ in range(40)], rounds=300, seed=k)
        held += low < 0 < high
    check(165 < held < 195, f"{held} of 200 intervals of 90 % hold the mean")


def table():
    path = HOME / "table.csv"
    common.Table(path, ["a", "b"], 1).add("x", 0.5)
    with open(path, "a") as file:
        file.write("y,0.")                      # broken off
    again = common.Table(path, ["a", "b"], 1)
    check(again.done == {("x",)}, "a row that was broken off counts as done")
    again.add("y", 0.25)
    check([tuple(row.values()) for row in common.read(path)] == [("x", "0.5"), ("y", "0.25")], "a table that goes on")
    common.Table(HOME / "times.csv", ["a", "b"], 1).add(2.0, 1)
    again = common.Table(HOME / "times.csv", ["a", "b"], 1)
    check(again.key((2.0,)) in again.done, "a row of a whole number is not found again")


def profiles():
    size, slope, radius = 406, math.radians(37), drum.RADIUS
    stride = (size + 3) // 4 * 4
    palette = b"".join(bytes([k, k, k, 0]) for k in range(256))
    rows = bytearray(stride * size)
    for y in range(size):
        for x in range(size):
            dark = y + 0.5 - size / 2 < -math.tan(slope) * (x + 0.5 - size / 2)
            rows[y * stride + x] = 10 if dark else 240
    head = struct.pack("<2sIHHI", b"BM", 1078 + len(rows), 0, 0, 1078)
    head += struct.pack("<IiiHHIIiiII", 40, size, size, 1, 8, 0, len(rows), 0, 0, 256, 0)
    path = HOME / "drawn.bmp"
    path.write_bytes(head + palette + rows)
    lengths = drum.picture(path)
    check(abs(drum.angle(lengths) - 37) < 0.2, f"a surface of 37 degrees is read as {drum.angle(lengths)}")
    area = sum(lengths) * 2 * radius / drum.COLUMNS
    check(abs(area - math.pi * radius * radius / 2) < 20, f"half a drum has {area} mm2")
    used = sum(1 for c in range(drum.COLUMNS) if abs(drum.place(c)) < drum.USED * radius) * 2 * radius / drum.COLUMNS
    check(abs(drum.error(lengths, [v + 0.5 for v in lengths]) - 0.5 * used) < 1e-9, "the area between two profiles")
    camera = drum.Camera()
    for x in (5, 5, 30):
        camera.look([(x, -7, 6)])
    seen = camera.lengths()
    for c in range(drum.COLUMNS):
        chord = 2 * math.sqrt(max(0, 36 - (drum.place(c) - 5) ** 2))
        check(abs(seen[c] - chord) <= 2 * radius / drum.COLUMNS, f"a sphere's column at {drum.place(c)} mm: {seen[c]}, not {chord}")


def facets(path, triangles):
    with open(path, "w") as file:
        file.write("solid s\n")
        for t in triangles:
            file.write("facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*v) for v in t) + "endloop\nendfacet\n")
        file.write("endsolid s\n")


def quarry():
    """A slope of 1 to 2 down +x, then two level sheets."""
    folder = HOME / "authume"
    folder.mkdir()
    for zone, x0, x1 in (("Blue", -10, 20), ("Gray", 20, 60), ("Red", 60, 100)):
        height = {x: max(0, 20 - x) / 2 + 160 for x in (x0, x1)}
        a, b, c, d = ((x, height[x], z) for x, z in ((x0, 305), (x1, 305), (x1, 335), (x0, 335)))
        facets(folder / f"DTM_{zone}_zone.stl", [(a, c, b), (a, d, c)])
    corner = [(x, y, z) for x in (-0.4, 0.4) for y in (-0.4, 0.4) for z in (-0.4, 0.4)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    facets(folder / "SP3A.stl", [tuple(corner[q[k]] for k in t) for q in sides for t in ((0, 1, 2), (0, 2, 3))])
    (folder / "positions_P1.xyz").write_text("0 170.45 320\n" * 4)
    (folder / "orientations.txt").write_text("q0\tq1\tq2\tq3\n" + "0.9732489895\t0\t0\t-0.2297529205\n" * 64)
    words = [f"{zone}.{what}={value}" for zone in boulders.ZONES for what, value in (("restitution", 0.2), ("friction", 0.3))]
    yard = boulders.Quarry(1, words)
    check([yard.terrain.zone(x, 320) for x in (3, 30, 70, 200)] == ["blue", "gray", "red", "off"], "zones of places")
    check(yard.terrain.down[0] > 0.999, f"the fall line is {yard.terrain.down}")
    check(all(abs(p - q) < 1e-9 for p, q in zip(yard.terrain.seen(7, 323), (7, 3))), "along and sideways")
    end = yard.fall("4x", "SP3A", 0, 0)
    # It slides until m g h is lost to 0.3 m g times its horizontal way, or before, as it hits the level.
    check(end[5] == "gray" and 20 < end[3] < 10.1 / 0.3 and abs(end[1] - 160.4) < 0.05, f"a cube ends at {end}")
    words[1] = "blue.friction=1.5"
    stuck = boulders.Quarry(1, words).fall("4x", "SP3A", 0, 0)
    check(stuck[5] == "blue", f"a cube on a slope below its friction ends at {stuck}")


def turns():
    rng = random.Random(2)

    def matrix(q):
        w, x, y, z = q
        return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]

    for _ in range(50):
        a, b = ([v / math.hypot(*q) for v in q] for q in ([rng.gauss(0, 1) for _ in range(4)] for _ in range(2)))
        product, left, right = matrix(boulders.times(a, b)), matrix(a), matrix(b)
        check(all(abs(product[i][j] - sum(left[i][k] * right[k][j] for k in range(3))) < 1e-12 for i in range(3) for j in range(3)),
              "the product of two turns")


def speed():
    """The drum carries the powder up on the left: its surface falls to the right."""
    lengths, scene = drum.simulate(SimpleNamespace(rpm=45, friction=0.5, rolling=0.2, seed=1, size=9.0, solid=drum.SOLID))
    check(len(scene.world) > 30 and 20 < drum.angle(lengths) < 75, f"{len(scene.world)} spheres stand at {drum.angle(lengths)} degrees")


def holes():
    holes = [(hole, 0.6 * (hole - 1.4) ** 2.5, weight) for hole, weight in ((5.5, 4), (7, 1), (9, 2))]
    check(all(abs(a - b) < 1e-9 for a, b in zip(orifice.beverloo(holes), (1.4, 0.6, 0.6, 2.5))), "the fit of rates by the law")
    rng, groups = random.Random(3), {}
    for k in range(200):
        groups[k] = [(50 * (1 + 0.5 * rng.gauss(0, 1) / math.sqrt(n)), n, 0.6) for n in (400, 400, 900)]
    check(abs(orifice.scatter(groups)[0] - 0.5) < 0.05, f"the scatter of rates is {orifice.scatter(groups)[0]}, not 0.5")
    places, far = orifice.places(5.5, 1), 0.5 * orifice.WIDE * 5.5 * orifice.D
    least = min(math.dist(a, b) for i, a in enumerate(places) for b in places[:i])
    check(least > 0.99 * orifice.D and all(math.hypot(x, y) < far - 0.5 * orifice.D for x, y, _ in places),
          f"spheres begin {least} m apart, inside the bin")


def processes():
    series = [(0.1 * k, 10 - k) for k in range(1, 11)]  # a tenth every tenth of a second
    check(all(abs(bulk.halves(series, 10, share) - (1 - share)) < 1e-9 for share in (0.97, 0.5, 0.13)), "when a share is left")
    check(math.isnan(bulk.halves(series[:5], 10, 0.2)), "a share that was not reached")
    rows = [("small", 1, 0, 1), ("small", -1, 0, -1), ("large", -1, 0, -1), ("large", -1, 0, 1), ("small", 1, 0, -1)]
    check(bulk.counted(bulk.CASES["drum"], rows) == [1, 0, 1, 1], "counts in the quarters")
    silo = bulk.CASES["silo-large"]
    check(abs(bulk.counted(silo, [("grain", 0, 0, z) for z in (0, 0.1, -0.1)])[0] / bulk.counted(silo, [("grain", 0, 0, 0)])[0] - 2) < 1e-12,
          "the mass above the hole")


def bodies():
    rng, lines, made = random.Random(4), [], []
    for k in range(clumps.COUNT):
        axis = [rng.gauss(0, 1) for _ in range(3)] if k else [-1.0, 0.0, 0.0]
        axis = [v / math.hypot(*axis) for v in axis]
        middle = [rng.gauss(0, 1) for _ in range(3)]
        made.append((middle, axis))
        lines += [" ".join(map(repr, [3 * k + j + 1, *(m + 2 * clumps.R * (j - 1) * v for m, v in zip(middle, axis))])) for j in range(3)]
    rng.shuffle(lines)
    path = HOME / "rods.txt"
    path.write_text("ITEM: ATOMS id x y z\n" + "\n".join(lines) + "\n")
    for (middle, axis), pose in zip(made, clumps.poses(path)):
        w, x, y, z = pose[3:]
        along = [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)]  # what the turn makes of x
        check(math.dist(pose[:3], middle) < 1e-12 and math.dist(along, axis) < 1e-6, f"a rod along {axis} is read as {along}")
    for shape, corners in polyhedra.SHAPES.items():
        reach = max(math.hypot(*c) for c in corners)
        places = polyhedra.places(1)
        check(len(places) == polyhedra.COUNT and min(p[2] for p in places) > reach, f"{shape}: one begins in the floor")
        volume = sum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
                     for a, b, c in ([corners[k] for k in f] for f in polyhedra.FACETS[shape])) / 6
        whole = 4 / 3 * polyhedra.A ** 3 if shape == "octahedron" else 8 * math.prod(polyhedra.HALF)
        check(abs(volume / whole - 1) < 1e-12, f"{shape}: facets enclose {volume} m3, not {whole}")
    place = SimpleNamespace(tolist=lambda: [[1.0, 0.0, 2.0], [3.0, 0.0, 4.0]])
    scene = SimpleNamespace(bodies=lambda: SimpleNamespace(position=place), sensors={"pile.volume_deg": 30})
    check(all(abs(a - b) < 1e-9 for a, b in zip(heaps.measured(scene), (1000, 3000, 30))), "radius and height of two bodies")
    path = HOME / "heaps.csv"
    rows = [("a", 1, "scree", 1, 10, 20), ("a", 2, "scree", 3, 10, 22), ("a", 1, "other", 5, 10, math.nan), ("a", 2, "other", 7, 12, 30)]
    path.write_text(",".join(heaps.COLUMNS) + "\n" + "".join(",".join(map(str, [*row, 0])) + "\n" for row in rows))
    with contextlib.redirect_stdout(io.StringIO()) as told:
        heaps.compare(path)
    # 6 +- 1 beside 2 +- 1; an angle that one heap has not is left out
    check("a,other,2,radius_mm,6,1,4,1.4,2.8,200.0" in told.getvalue().splitlines() and "other,2,angle" not in told.getvalue(),
          f"heaps beside each other: {told.getvalue()}")


def slopes():
    rng = random.Random(6)
    for _ in range(20):
        angle, level = rng.uniform(-180, 180), rng.uniform(-0.6, 0.6)
        down = -math.sin(math.radians(angle)), -math.cos(math.radians(angle))
        below = [p for p in ((rng.uniform(-1, 1), rng.uniform(-1, 1)) for _ in range(40000)) if math.hypot(*p) < 1 and p[0] * down[0] + p[1] * down[1] > level]
        found = turning.slope(common.mean([p[0] for p in below]), common.mean([p[1] for p in below]))
        check(abs((found - angle + 180) % 360 - 180) < 3, f"a bed at {angle} degrees is read as {found}")
    volume = sum(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
                 for a, b, c in turning.drum()) / 6
    whole = -90 * math.sin(math.radians(4)) * turning.RADIUS ** 2 * turning.HALF
    check(abs(volume / whole - 1) < 1e-12, f"the drum, seen from inside, encloses {volume} m3, not {whole}")
    places = turning.places(1)
    least = min(math.dist(a, b) for i, a in enumerate(places) for b in places[:i])
    inside = turning.RADIUS * math.cos(math.radians(2)) - 0.5 * turning.D
    check(least > turning.D and all(math.hypot(x, z) < inside and abs(y) < turning.HALF - 0.5 * turning.D for x, y, z in places) and
          len(places) == turning.COUNT, f"spheres begin {least} m apart, inside the drum")
    path = HOME / "turning.csv"
    rows = [(10, 1, "scree", 30), (10, 1, "scree", 32), (10, 1, "liggghts", 34), (10, 1, "liggghts", 36)]
    path.write_text("rpm,seed,code,slope_deg\n" + "".join(",".join(map(str, row)) + "\n" for row in rows))
    with contextlib.redirect_stdout(io.StringIO()) as told:
        turning.compare(path)
    check("10,liggghts,2,35.00,1.00,4.00,1.41" in told.getvalue().splitlines(), f"slopes beside each other: {told.getvalue()}")


def equations():
    check(abs(hits.integrated(0.0)[0] - 1) < 1e-3, "an elastic hit keeps its speed")
    check(abs(hits.integrated(hits.dashpot(0.5))[0] - 0.5) < 1e-3, "a dashpot for a restitution")
    check(abs(hits.share(hits.SLIDING, 1e4, 1) - 1) < 1e-3, "a fast slip gives the whole impulse")


def intervals():
    rng, held = random.Random(5), 0
    for _ in range(400):
        difference, error, free = claims.apart([rng.gauss(1, 2) for _ in range(10)], [rng.gauss(0, 1) for _ in range(6)])
        held += abs(difference - 1) < common.student(free) * error
    check(335 < held < 385, f"{held} of 400 intervals of 90 % hold the difference")


def stones():
    corners = [[float(c) for c in f"{k:03b}"] for k in range(8)]
    triangles = [f for a, b, c, d in ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)) for f in ((a, b, c), (a, c, d))]
    moved = rockable.inset(corners, triangles, 0.1)
    check(all(0.05 < abs(p - q) < 0.2 and abs(p - 0.5) < 0.5 for a, b in zip(moved, corners) for p, q in zip(a, b)), f"a cube's corners inwards: {moved}")
    lines = rockable.shape("cube", corners, triangles, 0.1).splitlines()
    check({"nv 8", "ne 18", "nf 12", "obb.extent 0.6 0.6 0.6"} <= set(lines), "a cube as Rockable's shape")
    one = SimpleNamespace(measures=SimpleNamespace(volume=2.0, inertia=[1.0, 2.0, 3.0]))
    told = rockable.energy(["s", 0, 0, 0, 3, 0, 0, 0, 0, 0, math.sqrt(0.5), 0, 0, math.sqrt(0.5), 1, 0, 0], {"s": one})
    check(abs(told / (0.5e6 * rockable.DENSITY * (18 + 2)) - 1) < 1e-12, f"a stone that was turned has {told} uJ")
    path, mass = HOME / "block.stl", 210.0
    impacts.block(path, mass)
    found = impacts.library().Particle(impacts.library().load(str(path), "m")).measure().volume * impacts.DENSITY
    check(abs(found / mass - 1) < 1e-3, f"the block of {mass} kg has {found}")
    n = impacts.normal([(x / 20, y / 20, 0.5 * x / 20) for x in range(-9, 10) for y in range(-9, 10)], 0.0, 0.0)
    check(abs(n[0] / n[2] + 0.5) < 1e-9 and abs(n[1]) < 1e-9, f"the normal of a slope: {n}")


def crossings():
    check(shape.place([10, 20, 18], 19) == (0, 0.9) and shape.place([10, 20, 18], 25) is None and shape.place([10, 20, 18], 25, True) == (0, 1),
          "where a way reaches an angle")
    rows = [{"angle": float(a)} for a in (10, 12)]
    runs = {("4x", 0.5, 0.0): rows, ("a", 0.25, 0.0): [{"angle": 9.0}], ("a", 0.5, 0.0): [{"angle": 13.0}], ("a", 0.9, 0.0): [{"angle": 14.0}]}
    check(shape.fitted(runs, "a") == {"as true": (0.5, 0.0), "friction": (0.375, 0.0)}, f"a friction fitted: {shape.fitted(runs, 'a')}")
    check(abs(shape.pooled(runs, "angle") - math.sqrt(2)) < 1e-12, "a pooled scatter")


for part in (statistics, table, profiles, turns, quarry, speed, holes, processes, bodies, slopes, equations, intervals, stones, crossings):
    part()
print("\n".join(wrong) or "the scripts of bench/evidence give what is known")
sys.exit(bool(wrong))
