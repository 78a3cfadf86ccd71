# YADE's polyhedra (convex, force from the overlapping volume) on a scene of bench_world dump:
#
#   yade -n -x yade.py SCENE SECONDS [TIME_STEP]       time step in s, default 1e-5
#
# The bodies begin where scree has them at rest, sink for a thousand steps until the law bears them,
# and are then timed for about SECONDS of CPU. One line among YADE's own, as the other peers print
# it: engine, bodies, time step, steps, CPU s, particle-steps per second, simulated s per CPU s.
import math
import sys
import time

from yade import polyhedra_utils

scene_path, seconds = sys.argv[1], float(sys.argv[2])
time_step = float(sys.argv[3]) if len(sys.argv) > 3 else 1e-5
numbers = iter(open(scene_path).read().split())


def reals(count):
    return [float(next(numbers)) for _ in range(count)]


def whole(count):
    return [int(next(numbers)) for _ in range(count)]


radius, friction, restitution = reals(3)
shape_count, body_count = whole(2)
shapes = []
for _ in range(shape_count):
    mass = reals(4)[0]
    vertex_count, triangle_count = whole(2)
    corners = [tuple(reals(3)) for _ in range(vertex_count)]
    whole(3 * triangle_count)  # the hull is YADE's own
    shapes.append((mass, corners))

# a stiffness in N/m3: the base of a box under scree's E L presses as deep
grain = PolyhedraMat(density=1, young=1e8 / 0.02, poisson=0.3, frictionAngle=math.atan(friction))
wall = PolyhedraMat(density=1, young=1e8 / 0.02, poisson=0.3, frictionAngle=math.atan(friction))
first = None
for _ in range(body_count):
    shape = whole(1)[0]
    x, y, z, w, qx, qy, qz = reals(7)
    mass, corners = shapes[shape]
    body = polyhedra_utils.polyhedra(grain, v=corners)
    factor = mass / body.state.mass
    body.state.mass *= factor
    body.state.inertia *= factor
    # YADE turns the shape into its principal axes, about its centre
    turn = Quaternion(w, qx, qy, qz)
    body.state.pos = Vector3(x, y, z) + turn * body.state.pos
    body.state.ori = turn * body.state.ori
    O.bodies.append(body)

O.bodies.append(utils.wall(0, axis=2, sense=1, material=wall))
sides, height, pi = 48, 2.0, math.pi
outer = radius / math.cos(pi / sides)
ring = [(outer * math.cos(2 * pi * i / sides), outer * math.sin(2 * pi * i / sides)) for i in range(sides)]
for (ax, ay), (bx, by) in zip(ring, ring[1:] + ring[:1]):
    O.bodies.append(utils.facet([(ax, ay, 0), (bx, by, 0), (ax, ay, height)], material=wall))
    O.bodies.append(utils.facet([(bx, by, 0), (bx, by, height), (ax, ay, height)], material=wall))

O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb(), Bo1_Facet_Aabb()], verletDist=2e-3),
    InteractionLoop(
        [Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom(), Ig2_Facet_Polyhedra_PolyhedraGeom()],
        [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
        [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()],
    ),
    NewtonIntegrator(gravity=(0, 0, -9.81), damping=0.3),
]
O.dt = time_step


O.run(1000, True)
steps, start = 0, time.process_time()
while time.process_time() - start < seconds:
    O.run(10, True)
    steps += 10
used = time.process_time() - start
if not all(body.state.vel.norm() < 1 for body in O.bodies if isinstance(body.shape, Polyhedra)):
    sys.exit("yade: the scene flew apart")
rate = body_count * steps / used
print(f"YADE polyhedra,{body_count},{time_step:g},{steps},{used:.3f},{rate:.0f},{steps * time_step / used:.4g}")
