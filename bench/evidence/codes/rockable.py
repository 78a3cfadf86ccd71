#!/usr/bin/env python3
"""Boulders' scans beside Rockable's sphero-polyhedra: the same triangles, places, stiffness, damping and friction.

  rockable.py run TABLE.csv CASE:SEEDS,... CODE...    CASE: drop (12 stones, each alone on a floor), heap (100 from a lifted box), drum
                                                      (60), heap and drum at a quarter of the recommended level; CODE: scree,
                                                      scree-RESTITUTION, rockable, or rockable-shared, where a pair's
                                                      contacts share one spring (its NumberWeight); adds what is not there
  rockable.py slope TABLE.csv EVERY CODE...           all boulders, places and every EVERYth orientation on profile 1 of the quarry
  rockable.py compare TABLE.csv                       as CSV: means, standard errors, differences to scree; of less than four
                                                      runs the scatter is taken as scree's
  rockable.py places TABLE.csv                        likewise of the slope

Rows: of a drop and a heap root mean square distance from the common axis (of a drop from where it began) and mean height; of a drum the
direction of the common centre from the axis, mean over a turn; the mean kinetic energy of a stone (at the end; in the drum over the
turn); of a drop the share of stones that lie on the same side as scree's, and how much higher those lie; steps of all bodies.
Environment: ROCKABLE (the program), SCREE_EVIDENCE_DIR."""
import json
import math
import pathlib
import random
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "boulders")]
from common import (WORK, Table, bootstrap, deviation, kolmogorov, kolmogorov_p, library, mean, needs, processor_time, read,  # noqa: E402
                    show, write_stl)
from boulders import SHAPES, ZONES, Quarry, times  # noqa: E402

STONES = "SP1A", "SP2A", "SP3A"
L, DENSITY, YOUNG, FRICTION, STEP = 0.025, 2500, 4e6, 0.5, 3.4e-5
ROUND, PLATE = 0.03, 0.002             # radius of stones over their size; of walls, m
ETA = 0.49724                          # of restitution 0.3 where the force is cut off at zero, as scree has it
BOX, PITCH, LIFT, TIME = 0.168, 0.042, 0.5, {"drop": 3.0, "heap": 1.3}
STONES_IN_DRUM = 60
RADIUS, DEPTH, FILL, TURN, QUARTER = 0.09, 0.09, 0.1, 1.6, 25   # the drum rests, turns by half a turn, and is looked at for one
COLUMNS = ["case", "seed", "code", "radius_mm", "height_mm", "slope_deg", "energy_uJ", "same_percent", "same_apart_mm", "body_steps", "cpu_s"]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def rotated(q, v):
    return times(times(q, (0, *v)), (q[0], -q[1], -q[2], -q[3]))[1:]


def turn(rng):
    q = [rng.gauss(0, 1) for _ in range(4)]
    return [v / math.hypot(*q) for v in q]


class Stone:
    """A level of a scan, scaled to a size: file for scree, sphero-polyhedron for Rockable."""

    def __init__(self, quarry, name, folder, size=None, level="recommended"):
        self.name, self.path = name, folder / f"{name}.stl"
        mesh = quarry.scree.load(quarry.shape(level, name)[0]["file"], "m")
        scale = size / quarry.scree.Particle(mesh).measure().size if size else 1
        self.corners, self.triangles = [[scale * x for x in v] for v in mesh.vertices.tolist()], mesh.triangles.tolist()
        write_stl(self.path, [[self.corners[k] for k in t] for t in self.triangles])
        self.measures = quarry.scree.Particle(quarry.scree.load(str(self.path), "m")).measure()

    def sphero(self):
        """In principal axes, its corners moved inwards so that rounded faces lie in the triangles."""
        m, r = self.measures, ROUND * self.measures.size
        back = [m.orientation[0], *(-v for v in m.orientation[1:])]
        corners = [rotated(back, [a - b for a, b in zip(v, m.centre)]) for v in inset(self.corners, self.triangles, r)]
        return shape(self.name, corners, self.triangles, r, m.volume, [i / m.volume for i in m.inertia])


def inset(corners, triangles, r):
    around = [[] for _ in corners]
    for t in triangles:
        a, b, c = (corners[k] for k in t)
        u, v = ([q - p for p, q in zip(a, w)] for w in (b, c))
        n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        for k in t:
            around[k].append([x / (math.hypot(*n) or 1) for x in n])
    found = []
    for corner, normals in zip(corners, around):
        n = [mean([m[k] for m in normals]) for k in range(3)]
        found.append([x - r * y / max(0.5 * math.hypot(*n), dot(n, n)) for x, y in zip(corner, n)])
    return found


def shape(name, corners, faces, r, volume=1, inertia=(1, 1, 1), more=""):
    """An entry of Rockable's library of shapes."""
    edges = sorted({tuple(sorted(e)) for f in faces for e in zip(f, [*f[1:], f[0]])})
    low, high = ([f(c[k] for c in corners) for k in range(3)] for f in (min, max))
    rows = ["<", f"name {name}", f"radius {r!r}", "preCompDone y", *([more] if more else []), f"nv {len(corners)}"]
    rows += ["{!r} {!r} {!r}".format(*c) for c in corners]
    rows += [f"ne {len(edges)}", *("{} {}".format(*e) for e in edges)]
    rows += [f"nf {len(faces)}", *(" ".join(map(str, [len(f), *f])) for f in faces)]
    rows += ["obb.extent " + " ".join(repr(0.5 * (b - a) + r) for a, b in zip(low, high)), "obb.e1 1 0 0", "obb.e2 0 1 0", "obb.e3 0 0 1"]
    rows += ["obb.center " + " ".join(repr(0.5 * (b + a)) for a, b in zip(low, high)), f"volume {volume!r}"]
    return "\n".join([*rows, "I/m {!r} {!r} {!r}".format(*inertia), ">", ""])


def plate(name, *corners):
    return shape(name, corners, [range(len(corners))], PLATE, more="isSurface")


class Rockable:
    """A folder in which it runs. Bodies are rows of name, place and quaternion; the walls come first and stand still until they are driven."""

    def __init__(self, folder, shapes, walls, bodies, settings):
        self.folder, self.walls, self.number = folder, len(walls), 0
        for path in [*folder.glob("conf*"), *folder.glob("drivingSystem.txt")]:
            path.unlink()
        (folder / "shapes.shp").write_text("".join(shapes))
        rows = [f"{name} 0 0 1 0 0 0 0 0 0 0 0 0 1 0 0 0 0 0 0 0 0 0" for name in walls]
        rows += [f"{name} 1 0 1 {x!r} {y!r} {z!r} 0 0 0 0 0 0 {q[0]!r} {q[1]!r} {q[2]!r} {q[3]!r} 0 0 0 0 0 0" for name, x, y, z, *q in bodies]
        lines = ["Rockable 21-08-2022", "t 0", *(f"{k} {v}" for k, v in settings.items()), "iconf 0", f"nDriven {len(walls)}"]
        lines += ["shapeFile shapes.shp", "precision 13", f"Particles {len(rows)}", *rows]
        (folder / "conf0").write_text("\n".join(lines) + "\n")

    def run(self, until, every, driving=(), spin=None):
        """Goes on from its last file; rows of the bodies in each of the new ones. A wall that is driven to turn has no surface speed
        unless its spin about y stands in the file."""
        (self.folder / "drivingSystem.txt").write_text("\n".join(driving) + "\n")
        last = self.folder / f"conf{self.number}"
        text = last.read_text()
        head, _, rest = text.partition("\nParticles ")
        head = re.sub(r"\n(tmax|interConf) .*", "", head)
        if spin:
            rest = re.sub(r"\n(\w+ 0 0(?: \S+){14}) \S+ \S+ \S+", rf"\n\1 0 {spin!r} 0", rest, count=1)
        last.write_text(f"{head}\ntmax {until + 0.02 * every!r}\ninterConf {every!r}\nParticles {rest}")
        told = subprocess.run([needs("ROCKABLE"), "-j", "1", "-v", "2", last.name], cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        found = []
        while (path := self.folder / f"conf{self.number + 1}").exists():
            self.number += 1
            found.append(self.bodies(path))
        if told.returncode or not found or any(math.isnan(v) for row in found[-1] for v in row[1:]):
            sys.exit(f"Rockable ended with {told.returncode}: see {self.folder}\n{told.stdout[-500:]}")
        return found

    def bodies(self, path):
        lines = iter(path.read_text().splitlines())
        count = next(int(line.split()[1]) for line in lines if line.startswith("Particles "))
        rows = [line.split() for _, line in zip(range(count + 1), lines) if not line.startswith("#")]
        return [[row[0], *map(float, row[4:])] for row in rows[self.walls:count]]

    def deepest(self):
        """m, of the contacts in its last file."""
        _, _, rest = (self.folder / f"conf{self.number}").read_text().partition("\nInteractions ")
        return max([-float(line.split()[8]) for line in rest.splitlines()[1:] if line[:1].isdigit()] or [0.0])


def energy(row, stones):
    """Kinetic, uJ, of a row of Rockable's."""
    _, _, _, _, u, v, w, _, _, _, *q = row
    m, spin = stones[row[0]].measures, rotated([q[0], *(-x for x in q[1:4])], q[4:7])
    return 0.5e6 * DENSITY * (m.volume * dot((u, v, w), (u, v, w)) + sum(i * x * x for i, x in zip(m.inertia, spin)))


def settings(size, density, stiffness, wall, step, friction, en2, shared, far=1):
    """`far`: how far the neighbours that it remembers reach."""
    words = {"dt": step, "interVerlet": 0.002 * far, "interConf": 1, "DVerlet": 0.12 * far * size, "dVerlet": 0.06 * far * size, "dynamicUpdateNL": 1,
             "dispUpdateNL": 0.018 * far * size, "angleUpdateNL": 1e9, "density 0": density, "density 1": density, "forceLaw": "Default",
             "AddOrRemoveInteractions": "OBBtree", "Integrator": "velocityVerlet", "ContactPartnership": "NumberWeight" if shared else "None"}
    for pair, k in (("0 1", wall), ("1 1", stiffness)):
        words.update({f"knContact {pair}": k, f"en2Contact {pair}": en2, f"ktContact {pair}": k, f"muContact {pair}": friction,
                      f"krContact {pair}": 0, f"murContact {pair}": 0})
    return words


def stones_settings(code):
    en2 = math.exp(-2 * math.pi * ETA / math.sqrt(1 - ETA * ETA))  # its formula, without the cut-off, gives this dashpot
    return settings(L, DENSITY, YOUNG * L / 2, YOUNG * L, STEP, FRICTION, en2, code.endswith("shared")) | {"gravity": "0 0 -9.81"}


def first(case, seed):
    """Rows of name, place, quaternion."""
    rng, rows = random.Random(seed), []
    if case == "drop":
        return [[STONES[k % 3], 0.2 * (k % 4), 0.2 * (k // 4), 0.06, *turn(rng)] for k in range(12)]
    if case == "drum":
        return json.loads((WORK / "rockable" / f"drum-{seed}" / "first.json").read_text())
    grid = [((i - 1.5) * PITCH, (j - 1.5) * PITCH, (k + 0.52) * PITCH) for k in range(7) for i in range(4) for j in range(4)]
    for k, place in enumerate(grid[:100]):
        rows.append([STONES[k % 3], *(v + rng.uniform(-2e-4, 2e-4) for v in place), *turn(rng)])
    return rows


def drum(sides=60):
    """Corners and faces of a shell with its two ends, seen from inside."""
    ring = [(RADIUS * math.cos(2 * math.pi * k / sides), RADIUS * math.sin(2 * math.pi * k / sides)) for k in range(sides)]
    corners = [(x, y, z) for y in (-DEPTH / 2, DEPTH / 2) for x, z in ring]
    shell = [(k, (k + 1) % sides, (k + 1) % sides + sides, k + sides) for k in range(sides)]
    return corners, shell, (range(sides), range(2 * sides - 1, sides - 1, -1))


def fill(seed, folder, stones):
    """Where scree's stones lie that were let into the drum."""
    path = folder.with_name(f"drum-{seed}") / "first.json"
    if path.exists():
        return
    path.parent.mkdir(exist_ok=True)
    feed = f"inlets: {{feed: {{cylinder: {{at: [0, {-0.45 * DEPTH}, 0], axis: [0, 1, 0], radius: {0.9 * RADIUS}, length: {0.9 * DEPTH}}}, " \
           f"shapes: {{{', '.join(f'{name}: 1' for name in STONES)}}}, count: {STONES_IN_DRUM}}}}}"
    scene = scree_scene(path.parent, stones, "drum", feed, {"seed": seed, "geometry.drum.motion.0.rotate.speed": 0})
    scene.run(1.5)
    b = scene.bodies()
    rows = [[STONES[int(k)], *p, *q] for k, p, q in zip(b.shape, b.position.tolist(), b.orientation.tolist())]
    if len(rows) != STONES_IN_DRUM:
        sys.exit(f"{len(rows)} stones are in the drum: see {path.parent}")
    path.write_text(json.dumps(rows))


def slope(rows):
    return math.degrees(math.atan2(-mean([r[1] for r in rows]), -mean([r[3] for r in rows])))


def with_rockable(case, seed, code, folder, stones):
    shapes, rows = [s.sphero() for s in stones.values()], first(case, seed)
    begun = processor_time()
    if case == "drum":
        grown = (RADIUS + PLATE / math.cos(math.pi / 60)) / RADIUS
        corners, shell, ends = drum()
        corners = [(grown * x, y + math.copysign(PLATE, y), grown * z) for x, y, z in corners]
        shapes.append(shape("drum", corners, [*shell, *ends], PLATE, more="isSurface"))
        code = Rockable(folder, shapes, ["drum"], rows, stones_settings(code))
        code.run(FILL, FILL)
        turning = [f"Control _yrot_Vel_ 0 {2 * math.pi / TURN!r}"], 2 * math.pi / TURN
        code.run(FILL + TURN / 2, TURN / 2, *turning)
        turned = code.run(FILL + 1.5 * TURN, TURN / (4 * QUARTER), *turning)[-4 * QUARTER:]
    else:
        half, high = BOX / 2 + PLATE, 0.35
        shapes += [plate("floor", (-1, -1, -PLATE), (1, -1, -PLATE), (1, 1, -PLATE), (-1, 1, -PLATE))]
        walls = {"east": (half, 0), "west": (-half, 0), "north": (0, half), "south": (0, -half)} if case == "heap" else {}
        for name, (x, y) in walls.items():
            a, b = (x - y, y - x), (x + y, y + x)
            shapes.append(plate(name, (*a, 0.001 + PLATE), (*b, 0.001 + PLATE), (*b, high), (*a, high)))
        code = Rockable(folder, shapes, ["floor", *walls], rows, stones_settings(code))
        turned = code.run(LIFT if walls else TIME[case], 0.1)
        if walls:
            turned = code.run(TIME[case], 0.1, [f"Control _z_Vel_ {k} 0.6" for k in range(1, 5)])
    print(f"Rockable: deepest contact {1e3 * code.deepest():.3f} mm of {1e3 * (PLATE + ROUND * L):.2f}", file=sys.stderr)
    return turned, [mean([energy(r, stones) for r in rows]) for rows in turned], processor_time() - begun, STEP


def scree_scene(folder, stones, case, bodies, fields):
    for stone in stones.values():
        (folder / stone.path.name).write_bytes(stone.path.read_bytes())
    corners, shell, ends = drum()
    triangles = [t for f in shell for t in ((f[0], f[1], f[2]), (f[0], f[2], f[3]))]
    triangles += [(e[0], e[k + 1], e[k]) for e in ends for k in range(1, len(e) - 1)]
    write_stl(folder / "drum.stl", [[corners[k] for k in t] for t in triangles])
    text = (HERE / "rockable.yaml").read_text().replace("bodies: {file: bodies.csv}", bodies)
    walls = {"drop": ("floor",), "heap": ("floor", "east", "west", "north", "south"), "drum": ("drum",)}[case]
    text = "\n".join(line for line in text.splitlines() if not (m := re.match(r"  (\w+): \{(plane|box|file: drum)", line)) or m[1] in walls)
    (folder / "rockable.yaml").write_text(text + "\n")
    return library().Scene(str(folder / "rockable.yaml"), fields)


def with_scree(case, seed, code, folder, stones):
    rows, restitution = first(case, seed), float(code.partition("-")[2] or 0.3)
    (folder / "bodies.csv").write_text("\n".join(["shape,x,y,z,qw,qx,qy,qz", *(",".join([r[0], *map(repr, r[1:])]) for r in rows)]) + "\n")
    fields = {"geometry.drum.motion.0.rotate.speed": 2 * math.pi / TURN, "geometry.drum.motion.0.from": FILL} if case == "drum" else {}
    fields.update({f"materials.{name}.restitution": restitution for name in ("grain", "wall")})
    scene = scree_scene(folder, stones, case, "bodies: {file: bodies.csv}", fields)
    begun, turned, energies = processor_time(), [], []
    moments = [FILL + TURN * (0.5 + (k + 1) / (4 * QUARTER)) for k in range(4 * QUARTER)] if case == "drum" else [TIME[case]]
    for moment in moments:
        scene.run(until=moment)
        b = scene.bodies()
        if len(b.position.tolist()) != len(rows):
            sys.exit(f"scree lost a stone: see {folder}")
        states = (a.tolist() for a in (b.position, b.velocity, b.orientation, b.angular_velocity))
        turned.append([[r[0], *p, *v, 0, 0, 0, *q, *w] for r, p, v, q, w in zip(rows, *states)])
        energies.append(mean([energy(r, stones) for r in turned[-1]]))
    print(f"scree: ledger {scene.sensors['ledger']:.1e}", file=sys.stderr)
    return turned, energies, processor_time() - begun, STEP


def one(case, seed, code):
    """The columns behind the key."""
    folder = WORK / "rockable" / f"{case}-{seed}-{code}"
    folder.mkdir(parents=True, exist_ok=True)
    quarry = Quarry(1, [])
    stones = {name: Stone(quarry, name, folder, L, "recommended" if case == "drop" else "0.25x") for name in STONES}
    if case == "drum":
        fill(seed, folder, stones)
    rows = first(case, seed)
    turned, energies, spent, step = (with_scree if code.startswith("scree") else with_rockable)(case, seed, code, folder, stones)
    last, same, apart, radius, height, angle = turned[-1], "", "", "", "", ""
    (folder / "last.json").write_text(json.dumps(last))
    if case == "drum":
        angle, kinetic, time = mean([slope(rows) for rows in turned]), mean(energies), FILL + 1.5 * TURN
    else:
        x, y = (mean([r[k] for r in last]) for k in (1, 2))
        away = [(r[1] - s[1], r[2] - s[2]) for r, s in zip(last, rows)] if case == "drop" else [(r[1] - x, r[2] - y) for r in last]
        radius, height = 1e3 * math.sqrt(mean([dot(v, v) for v in away])), 1e3 * mean([r[3] for r in last])
        kinetic, time = energies[-1], TIME[case]
    ours = folder.with_name(f"{case}-{seed}-scree") / "last.json"
    if case == "drop" and ours.exists():
        theirs = json.loads(ours.read_text())
        lower = [[rotated([r[10], *(-v for v in r[11:14])], (0, 0, -1)) for r in rows] for rows in (last, theirs)]
        alike = [dot(a, b) > math.cos(math.radians(10)) for a, b in zip(*lower)]
        same, apart = 100 * mean(alike), 1e3 * mean([r[3] - s[3] for r, s, one in zip(last, theirs, alike) if one])
    return [radius, height, angle, kinetic, same, apart, round(time / step) * len(rows), round(spent, 2)]


def run(path, cases, codes):
    needs("ROCKABLE")
    table = Table(path, COLUMNS, 3)
    for case, _, count in (c.partition(":") for c in cases.split(",")):
        for seed in range(1, int(count) + 1):
            for code in codes:
                if table.key((case, seed, code)) not in table.done:
                    table.add(case, seed, code, *one(case, seed, code))


def compare(path):
    groups = {}
    for row in read(path):
        groups.setdefault((row["case"], row["code"]), []).append(row)
    print("case,code,runs,what,mean,error,less_scree,error,errors,percent")
    for (case, code), rows in groups.items():
        rate = sum(float(r["body_steps"]) for r in rows) / sum(float(r["cpu_s"]) for r in rows)
        print(f"{case},{code},{len(rows)},body_steps_per_s,{rate:.3g},,,,,")
        for what in COLUMNS[3:9]:
            if not rows[0][what]:
                continue
            own, ours = ([float(r[what]) for r in group] for group in (rows, groups[case, "scree"]))
            scatter = [deviation(v if len(v) > 3 or len(ours) < 2 else ours) if len(max(v, ours, key=len)) > 1 else math.nan for v in (own, ours)]
            (m, error), (m0, error0) = ((mean(v), s / math.sqrt(len(v))) for v, s in zip((own, ours), scatter))
            line = f"{case},{code},{len(own)},{what},{m:.4g},{error:.2g}"
            apart = math.hypot(error, error0)
            if code != "scree" and apart and m0:
                line += f",{m - m0:.3g},{apart:.2g},{(m - m0) / apart:.1f},{100 * (m - m0) / m0:.1f}"
            print(line)


def trajectory(quarry, stone, place, orientation, code):
    """Rockable's: a row of boulders.py, and how far the deepest contact went."""
    folder = WORK / "rockable" / "slope"
    folder.mkdir(parents=True, exist_ok=True)
    m, terrain, q = stone.measures, quarry.terrain, times(quarry.orientations[orientation], stone.measures.orientation)
    stiffness = 1e8 * m.size
    step = 0.05 * math.pi / 2 * math.sqrt(3500 * m.volume / stiffness)
    words = settings(m.size, 3500, stiffness, stiffness, step, 1, 0, code.endswith("shared"), 6)
    code = Rockable(folder, [ground(quarry), stone.sphero()], ["ground"], [[stone.name, *terrain.places[place], *q]], words | {"gravity": "0 -9.81 0"})
    here, time, deep = terrain.places[place], 0, 0.0
    while time < 60:
        before, time = here, time + 4
        here = code.run(time, 4)[-1][0][1:4]
        deep = max(deep, code.deepest())
        zone = terrain.zone(here[0], here[2])
        if zone == "off" or math.dist(here, before) < 0.1:
            break
    return [*here, *terrain.seen(here[0], here[2]), zone, time, f"deepest {deep:.3f} m"]


def ground(quarry, r=0.1):
    """The three sheets as one, sunk by what rounds it."""
    triangles = [list(three) for three in sorted({tuple(t[1:]) for cell in quarry.terrain.cells.values() for t in cell})]
    corners = sorted({c for t in triangles for c in t})
    number = {c: k for k, c in enumerate(corners)}
    faces = [[number[c] for c in t] for t in triangles]
    for f in faces:
        a, b, c = (corners[k] for k in f)
        if (b[2] - a[2]) * (c[0] - a[0]) < (b[0] - a[0]) * (c[2] - a[2]):  # its normal looks down
            f.reverse()
    return shape("ground", inset(corners, faces, r), faces, r, more="isSurface")


def slopes(path, every, codes):
    needs("ROCKABLE")
    words = [f"{zone}.{what}={x}" for zone in ZONES for what, x in (("restitution", 0.1353), ("friction", 1))]
    quarry = Quarry(1, words)
    folder = WORK / "rockable" / "slope"
    folder.mkdir(parents=True, exist_ok=True)
    stones = {name: Stone(quarry, name, folder) for name in SHAPES}
    table = Table(path, ["code", "shape", "place", "orientation", "x", "y", "z", "along", "sideways", "zone", "time", "end", "cpu_s"], 4)
    for orientation in range(0, 64, every):
        for place in range(4):
            for name in SHAPES:
                for code in codes:
                    if table.key((code, name, place, orientation)) in table.done:
                        continue
                    begun = processor_time()
                    row = (quarry.fall("recommended", name, place, orientation) if code == "scree" else
                           trajectory(quarry, stones[name], place, orientation, code))
                    table.add(code, name, place, orientation, *row, round(processor_time() - begun, 1))


def places(path):
    """Starts are the same: intervals of 90 % of the mean difference are those of pairs."""
    groups = {}
    for row in read(path):
        groups.setdefault(row["code"], {})[row["shape"], row["place"], row["orientation"]] = row
    print("code,count,along_mean,along_sd,sideways_mean,sideways_sd,blue,gray,red,off,less_scree,low,high,d_along,p_along,cpu_s")
    for code, rows in groups.items():
        along, sideways = ([float(r[what]) for r in rows.values()] for what in ("along", "sideways"))
        shares = [mean([float(r["zone"] == zone) for r in rows.values()]) for zone in (*ZONES, "off")]
        both = [key for key in rows if key in groups["scree"]]
        apart = [float(rows[key]["along"]) - float(groups["scree"][key]["along"]) for key in both]
        d = kolmogorov([float(rows[key]["along"]) for key in both], [float(groups["scree"][key]["along"]) for key in both])
        beside = [mean(apart), *bootstrap(mean, apart), d, kolmogorov_p(d, len(both), len(both))] if code != "scree" else [""] * 5
        show(code, len(rows), mean(along), deviation(along), mean(sideways), deviation(sideways), *shares, *beside,
             mean([float(r["cpu_s"]) for r in rows.values()]))


if __name__ == "__main__":
    if len(sys.argv) > 4 and sys.argv[1] == "run":
        run(sys.argv[2], sys.argv[3], sys.argv[4:])
    elif len(sys.argv) > 4 and sys.argv[1] == "slope":
        slopes(sys.argv[2], int(sys.argv[3]), sys.argv[4:])
    elif len(sys.argv) == 3 and sys.argv[1] in ("compare", "places"):
        {"compare": compare, "places": places}[sys.argv[1]](sys.argv[2])
    else:
        sys.exit(__doc__)
