"""yade -n -x orifice_yade.py CASE.json: spheres through a hole, by YADE's linear spring and dashpot. Prints rows of time, spheres in the bin and in
the box above the hole. The case: spheres (places), diameter, facets, kn (N/m), damping of pairs and walls (N s/m), friction, step, every
(steps), least (spheres, where it ends), box (least and most corner)."""
import json
import math
import sys

from yade import utils

case = json.load(open(sys.argv[1]))
pair, wall = case["damping"]


def material(damping):  # a contact has a*b/(a + b) of both
    return O.materials.append(ViscElMat(kn=2 * case["kn"], ks=2 * case["kn"], cn=damping, cs=0, density=2500, frictionAngle=math.atan(case["friction"])))


grain = material(2 * pair)
rigid = material(1 / (1 / wall - 0.5 / pair))
grains = O.bodies.append([utils.sphere(p, case["diameter"] / 2, material=grain) for p in case["spheres"]])
O.bodies.append([utils.facet(f, material=rigid, fixed=True) for f in case["facets"]])
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], verletDist=0.1 * case["diameter"]),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()], [Law2_ScGeom_ViscElPhys_Basic()]),
    NewtonIntegrator(gravity=(0, 0, -9.81), damping=0),
]
O.dt = case["step"]
low, high = case["box"]
for rows in range(1000):
    O.run(case["every"], True)
    places = {k: O.bodies[k].state.pos for k in grains}
    inside = sum(p[2] > 0 for p in places.values())
    bed = sum(all(a < x < b for a, x, b in zip(low, p, high)) for p in places.values())
    print("row", O.time, inside, bed, flush=True)
    if inside <= case["least"]:
        break
    for k in [k for k, p in places.items() if p[2] < -0.03]:
        O.bodies.erase(k)
        grains.remove(k)
