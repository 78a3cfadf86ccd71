"""A pile in YADE: every particle as a polyhedron where and how it lies, with its velocities.

    scree export run.scree -o pile                          (or examples/pile.py)
    PYTHONPATH=examples PILE=pile yade -n -x examples/pile_to_yade.py      (Debian: yade; without -x to go on by hand)

YADE's polyhedra are convex: a particle that is not becomes its convex hull, and so do its mass and inertia. Neighbours
that hook into each other then overlap. Spheres become spheres, clumps clumps. The floor is the plane z = 0."""
import os

from pile_reader import read_pile, rotation, turn
from yade import polyhedra_utils

pile = read_pile(os.environ.get("PILE", "pile"))
material = PolyhedraMat(density=pile["bodies"][0]["mass"] / pile["shapes"][pile["bodies"][0]["shape"]]["volume"],
                        young=1e7, poisson=0.3, frictionAngle=0.46)
O.materials.append(material)
O.materials.append(FrictMat(density=material.density, young=1e7, poisson=0.3, frictionAngle=0.46))


def set_motion(body, one):
    spin = Vector3(*one["angular_velocity"])
    offset = body.state.pos - Vector3(*one["position"])  # the hull's centre is another than the particle's
    body.state.vel, body.state.angVel = Vector3(*one["velocity"]) + spin.cross(offset), spin


def corners_in_space(one, vertices):
    matrix = rotation(one["orientation"])
    return [Vector3(*(a + b for a, b in zip(turn(matrix, v), one["position"]))) for v in vertices]


for one in pile["bodies"]:
    shape = pile["shapes"][one["shape"]]
    if shape["kind"] == "mesh":
        # the hull of the corners where they are: YADE finds its centre and principal axes
        body = polyhedra_utils.polyhedra(material, v=corners_in_space(one, shape["vertices"]))
        O.bodies.append(body)
        set_motion(body, one)
    else:
        centres = corners_in_space(one, [s["centre"] for s in shape["spheres"]])
        balls = [sphere(c, s["radius"], material=O.materials[1]) for c, s in zip(centres, shape["spheres"])]
        if len(balls) == 1:
            O.bodies.append(balls[0])
            set_motion(balls[0], one)
        else:
            number, _ = O.bodies.appendClumped(balls)
            set_motion(O.bodies[number], one)
particle_count = len(O.bodies)
for body in O.bodies:
    if isinstance(body.shape, Polyhedra):
        print(f"particle {body.id}: hull of {body.state.mass:.4g} kg, particle {pile['bodies'][body.id]['mass']:.4g} kg")
O.bodies.append(utils.wall(0, axis=2, sense=1, material=material))

O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop([Ig2_Polyhedra_Polyhedra_PolyhedraGeom(), Ig2_Wall_Polyhedra_PolyhedraGeom(),
                     Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
                    [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys(), Ip2_FrictMat_FrictMat_FrictPhys()],
                    [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric(), Law2_ScGeom_FrictPhys_CundallStrack()]),
    NewtonIntegrator(damping=0.2, gravity=Vector3(*pile["gravity"])),
]
O.dt = 2e-6
O.run(200, True)
print(f"{particle_count} bodies of {len(pile['bodies'])} particles, {O.interactions.countReal()} contacts after "
      f"{O.iter} steps of {O.dt:g} s")
