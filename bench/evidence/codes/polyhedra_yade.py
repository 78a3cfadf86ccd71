"""yade -n -x polyhedra_yade.py CASE.json: polyhedra from a lifted box, by YADE's law of the overlapping volume. Prints a row a body:
place and orientation (w x y z). The case: corners, bodies, slabs (centre, size), young (N/m3), friction, damping, whether it damps
gravity too, gravity, step, lift, speed, time."""
import json
import math
import sys

from yade import polyhedra_utils

case = json.load(open(sys.argv[1]))
material = PolyhedraMat(density=2500, young=case["young"], poisson=0.3, frictionAngle=math.atan(case["friction"]))
grains, turns = [], []
for x, y, z, w, qx, qy, qz in case["bodies"]:
    body = polyhedra_utils.polyhedra(material, v=case["corners"])
    turns.append(body.state.ori)  # into principal axes
    body.state.pos = Vector3(x, y, z)
    body.state.ori = Quaternion(w, qx, qy, qz) * body.state.ori
    grains.append(O.bodies.append(body))
slabs = []
for centre, size in case["slabs"]:
    corners = [[sign * 0.5 * s for sign, s in zip(signs, size)] for signs in
               [(a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)]]
    body = polyhedra_utils.polyhedra(material, v=corners, fixed=True)
    body.state.pos = Vector3(*centre)
    slabs.append(O.bodies.append(body))
O.bodies.append(utils.wall(0, axis=2, sense=1, material=material))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb()], verletDist=2e-3),
    InteractionLoop(
        [Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
        [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
        [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()],
    ),
    NewtonIntegrator(gravity=case["gravity"], damping=case["damping"], dampGravity=case["damp_gravity"]),
]
O.dt = case["step"]
O.run(round(case["lift"] / O.dt), True)
rest = round((case["time"] - case["lift"]) / O.dt)
for slab in slabs:
    O.bodies[slab].state.vel = Vector3(0, 0, case["speed"])
if rest:  # 0 would be for ever
    O.run(rest, True)
for k, turn in zip(grains, turns):
    state = O.bodies[k].state
    turned = state.ori * turn.inverse()
    print("body", *state.pos, turned[3], turned[0], turned[1], turned[2])
