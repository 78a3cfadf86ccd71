#!/usr/bin/env python3
"""Bodies of Voronoi cells that joints hold: a Brazilian test, a drop weight, and whether scans stay as they are.

    PYTHONPATH=python python3 bench/joints.py brazil [SEEDS [CELLS]]
    PYTHONPATH=python python3 bench/joints.py drop [CELLS [SEEDS]]
    PYTHONPATH=python python3 bench/joints.py still COUNT [SCAN...]
    PYTHONPATH=python python3 bench/joints.py heap [BODIES [CELLS]]

brazil: a disc with flats of 0.16 rad to either side of the load, cells as thick as it is (a grain across: faces that are not upright
bend out of the plane, and the disc has three quarters of its strength), no scatter of strengths. Platens close so slowly that a wave crosses the disc sixty times until it splits. For each seed: 2P/(pi D t) over the strength at the greatest
force P, the share of broken area within 0.15 D of the loaded diameter, and whether left and right of it still hang together.

drop: a weight falls on a ball; the share of mass in fragments finer than a quarter of its size over energy by mass, and the fit
A (1 - exp(-b E)).

still: scans, or the samples, cut into 2 to 200 cells; no cell may move, nothing may break.

heap: balls of cells that joints hold, dropped into a box, against as many free cells: seconds a cell and step, and a second of
the world, once they lie."""
import math
import sys
import time

import scree

YOUNG, DENSITY, STRENGTH = 1e8, 2000, 2e5


def assemble(world, material, mesh, cells, seed, grain=1, **joint):
    """Its pieces as bodies, joined where they meet, and kept from touching where they are near, as a scene does."""
    pieces, faces = mesh.fracture(cells, seed=seed, grain=(0, 1, 0), grain_stretch=grain)
    first, near, boxes = len(world), mesh.measure().volume ** (1 / 3) / 400, []
    for piece in pieces:
        particle = scree.Particle(piece)
        measures = particle.measure()
        world.add_body(particle, material, position=measures.centre, orientation=measures.orientation)
        columns = list(zip(*piece.positions.tolist()))
        boxes.append([(min(c), max(c)) for c in columns])
    for face in faces:
        world.add_joint(first + face.a, first + face.b, face, YOUNG, **joint)
    joined = {(min(f.a, f.b), max(f.a, f.b)) for f in faces}
    for a in range(len(pieces)):
        for b in range(a + 1, len(pieces)):
            if (a, b) not in joined and all(p[0] < q[1] + near and q[0] < p[1] + near for p, q in zip(boxes[a], boxes[b])):
                world.add_joint(first + a, first + b)
    return pieces


def disc(diameter, thick, flat):
    """About the y axis, loaded along z."""
    def from_load(a):
        turned = (a - math.pi / 2) % math.pi
        return min(turned, math.pi - turned)

    angles = [a for a in (math.pi * k / 40 for k in range(80)) if from_load(a) > flat]
    angles += [s * math.pi / 2 + f for s in (1, 3) for f in (-flat, flat)]
    rim = [(diameter / 2 * math.cos(a), diameter / 2 * math.sin(a)) for a in sorted(angles)]
    n = len(rim)
    points = [(x, y, z) for y in (-thick / 2, thick / 2) for x, z in rim] + [(0, -thick / 2, 0), (0, thick / 2, 0)]
    triangles = []
    for i in range(n):
        k = (i + 1) % n
        triangles += [(2 * n, i, k), (2 * n + 1, n + k, n + i), (i, n + i, k), (k, n + i, n + k)]
    return scree.Mesh(points, triangles)


def split_disc(seed, cells, diameter=0.05, thick=0.001, flat=0.16):
    world = scree.World(gravity=(0, 0, 0))
    grain = world.add_material(young=YOUNG, density=DENSITY, restitution=0.1, friction=0.5)
    pieces = assemble(world, grain, disc(diameter, thick, flat), cells, seed, grain=20, tension=STRENGTH,
                      cohesion=3 * STRENGTH, friction=0.6, damping=0.3)
    half, least = diameter / 2 * math.cos(flat), STRENGTH * math.pi * diameter * thick / 2
    speed = 0.5 * 3 * STRENGTH / YOUNG / 60 * math.sqrt(YOUNG / DENSITY)
    plates = [world.add_wall("plane", grain, position=(0, 0, s * half * (1 + 1e-6)), axis=(0, 0, -s), velocity=(0, 0, -s * speed))
              for s in (1, -1)]
    most, split = 0, False
    for _ in range(4000):
        world.step(25)
        force = sum(abs(world.wall_force(p)[0][2]) for p in plates) / 2
        most, parts, places = max(most, force), world.fragments(), world.bodies().position
        sides = [{parts[i] for i in range(len(pieces)) if side * places[i, 0] > 0.2 * diameter} for side in (-1, 1)]
        split = not sides[0] & sides[1]
        if split or force < 0.3 * most and most > 0.5 * least:
            break
    broken = [j for j in world.joints() if j.mode != "not_broken"]
    area = sum(j.area for j in broken)
    near = sum(j.area for j in broken if abs(j.position[0]) < 0.15 * diameter)
    return most / least, near / area if area else math.nan, split, len(pieces)


def brazil(seeds=20, cells=300):
    ratios, splits = [], 0
    for seed in range(1, seeds + 1):
        begin = time.process_time()
        ratio, near, split, pieces = split_disc(seed, cells)
        ratios.append(ratio)
        splits += split
        print(f"seed {seed}: {pieces} pieces, 2P/(pi D t) {ratio:.3f} of the strength, {near:.0%} of what broke near the "
              f"diameter, {'split' if split else 'not split'}, {time.process_time() - begin:.0f} s", flush=True)
    mean = sum(ratios) / len(ratios)
    spread = math.sqrt(sum((r - mean) ** 2 for r in ratios) / max(1, len(ratios) - 1))
    print(f"mean {mean:.3f}, standard deviation {spread:.3f}, {splits} of {seeds} split")


def ball(diameter, steps=8):
    rows = [[(diameter / 2 * math.sin(math.pi * i / steps) * math.cos(math.pi * k / steps),
              diameter / 2 * math.sin(math.pi * i / steps) * math.sin(math.pi * k / steps),
              diameter / 2 * math.cos(math.pi * i / steps)) for k in range(2 * steps)] for i in range(1, steps)]
    points = [(0, 0, diameter / 2)] + [p for row in rows for p in row] + [(0, 0, -diameter / 2)]
    n, triangles, last = 2 * steps, [], len(points) - 1
    for k in range(n):
        m = (k + 1) % n
        triangles += [(0, 1 + k, 1 + m), (last, last - n + m, last - n + k)]
        for i in range(steps - 2):
            a, b = 1 + i * n, 1 + (i + 1) * n
            triangles += [(a + k, b + k, b + m), (a + k, b + m, a + m)]
    return scree.Mesh(points, triangles)


def strike(specific, cells, seed, diameter=0.03):
    """Of one ball on a floor, by a weight of ten times its mass."""
    world, mesh = scree.World(), ball(diameter)
    grain = world.add_material(young=YOUNG, density=DENSITY, restitution=0.3, friction=0.5)
    pieces = assemble(world, grain, mesh, cells, seed, tension=STRENGTH, cohesion=3 * STRENGTH, friction=0.6)
    world.add_wall("plane", grain, position=(0, 0, -diameter / 2 * (1 + 1e-6)), axis=(0, 0, 1))
    body = mesh.measure().volume
    steel = world.add_material(young=YOUNG, density=10 * DENSITY * body / (3 * diameter * 3 * diameter * diameter / 3))
    weight = scree.Particle(scree.Mesh([(3 * diameter * (x - .5), 3 * diameter * (y - .5), diameter / 3 * (z - .5))
                                        for z in (0, 1) for y in (0, 1) for x in (0, 1)],
                                       [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7),
                                        (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]))
    world.add_body(weight, steel, position=(0, 0, diameter * (0.5 + 1 / 6 + 1e-3)), velocity=(0, 0, -math.sqrt(specific / 5)))
    world.run(0.015)
    volumes = [piece.measure().volume for piece in pieces]
    parts, sums = world.fragments(), {}
    for part, volume in zip(parts, volumes):
        sums[part] = sums.get(part, 0) + volume
    return sum(v for v in sums.values() if v < body / 64) / body, world.observe().fracture / (DENSITY * body)


def drop(cells=200, seeds=2):
    energies, shares = [0.1, 0.2, 0.4, 0.8, 1.6, 3.2], []
    for energy in energies:
        found = [strike(energy, cells, seed) for seed in range(1, seeds + 1)]
        shares.append(sum(share for share, _ in found) / len(found))
        print(f"{energy} J/kg: {shares[-1]:.3f} finer than a quarter, {sum(f for _, f in found) / len(found):.3g} J/kg into breaks",
              flush=True)
    best = min(((sum((s - a * (1 - math.exp(-b * e))) ** 2 for s, e in zip(shares, energies)), a, b)
                for a in (k / 100 for k in range(1, 101)) for b in (10 ** (k / 40) for k in range(-120, 40))))
    print(f"A {best[1]:.2f}, b {best[2]:.3g} kg/J, off by {math.sqrt(best[0] / len(energies)):.3f} in the mean")


def still(count, *scans):
    names = scans or [f"sample:{name}" for name in scree.samples()]
    worst, moved, failed = 0, 0, 0
    for k in range(count):
        name, cells = names[k % len(names)], round(2 * 100 ** (((k * 7) % count) / max(1, count - 1)))
        mesh = scree.load(name)
        if not mesh.check().usable:
            mesh = mesh.repair()[0]
        mesh = mesh.simplify(min(mesh.triangle_count, 800))
        world = scree.World(gravity=(0, 0, 0))
        volume = mesh.measure().volume
        try:
            pieces = assemble(world, world.add_material(), mesh, cells, k + 1, tension=1e3)
            world.step(50)
        except scree.Error as wrong:
            failed += 1
            print(f"{name}, {cells} cells: {wrong}", flush=True)
            continue
        size = (6 * volume / math.pi) ** (1 / 3)
        speed = max(math.hypot(*v) for v in world.bodies().velocity.tolist()) * world.time_step / size
        worst = max(worst, speed, abs(sum(p.measure().volume for p in pieces) / volume - 1))
        if speed > 1e-9 or any(j.mode != "not_broken" for j in world.joints()):
            moved += 1
            print(f"{name}, {cells} cells: moves by {speed:.2g} of its size a step", flush=True)
    print(f"{count} assemblies: {moved} moved, {failed} were not made; at worst {worst:.1g} of the size a step, or of the volume")


def heap(bodies=6, cells=50, diameter=0.06):
    costs = []
    for joined in (False, True):
        world = scree.World(gravity=(0, 0, -9.81))
        grain = world.add_material(young=YOUNG, density=DENSITY, restitution=0.3, friction=0.5)
        for axis in ((0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)):
            world.add_wall("plane", grain, position=[-0.08 * x for x in axis], axis=axis)
        for k in range(bodies):
            moved = [(x + 0.036 * (-1) ** k, y + 0.036 * (-1) ** (k // 2), z + 0.07 * (k // 4))
                     for x, y, z in ball(diameter).positions.tolist()]
            mesh = scree.Mesh(moved, ball(diameter).triangles.tolist())
            if joined:
                assemble(world, grain, mesh, cells, k + 1, tension=1e9)
            for piece in [] if joined else mesh.fracture(cells, seed=k + 1)[0]:
                measures = scree.Particle(piece).measure()
                world.add_body(scree.Particle(piece), grain, position=measures.centre, orientation=measures.orientation)
        world.run(0.5)
        begin, steps = time.process_time(), 2000
        world.step(steps)
        cost, state = (time.process_time() - begin) / steps / len(world), world.observe()
        costs.append(cost / world.time_step)
        print(f"{'held by joints' if joined else 'free'}: {len(world)} cells, {1e6 * cost:.2f} us a cell and step of "
              f"{1e6 * world.time_step:.1f} us, {costs[-1]:.2f} s a cell and second, {state.pair_count} pairs touch", flush=True)
    print(f"held over free: {costs[1] / costs[0]:.2f}")


if __name__ == "__main__":
    what, given = {"heap": heap, "brazil": brazil, "drop": drop, "still": still}[sys.argv[1]], sys.argv[2:]
    what(*(int(word) if word.isdigit() else word for word in given))
