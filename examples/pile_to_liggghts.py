"""A pile of clumps for LIGGGHTS: every particle as a multisphere, with its own mass and inertia, where and how it lies,
with its velocities.

    scree drop phone.stl=50 --clump 20 -o drop
    scree export drop/checkpoint.scree -o pile
    python3 pile_to_liggghts.py pile liggghts           writes liggghts/in.pile and liggghts/clump-K.txt
    cd liggghts && liggghts -in in.pile                 (Debian: liggghts)

in.pile inserts the particles one by one, writes their spheres to pile.dump, and goes on for some steps under gravity
on the plane z = 0. LIGGGHTS takes the spheres' common centre for the centre of mass, so that is where a particle is
inserted. Other walls are not carried over."""
from __future__ import annotations

import math
import pathlib
import sys
from typing import Any, Iterable, Sequence

from pile_reader import read_pile, rotation, turn

HEAD = """units si
atom_style granular
atom_modify map array
boundary f f f
newton off
communicate single vel yes
region box block {box} units box
create_box 1 box
neighbor {skin} bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype 1e7
fix m2 all property/global poissonsRatio peratomtype 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 1 0.3
fix m4 all property/global coefficientFriction peratomtypepair 1 0.5
pair_style gran model hertz tangential history
pair_coeff * *
timestep 1.0e-6
fix gravity all gravity {g} vector 0 0 -1
fix floor all wall/gran model hertz tangential history primitive type 1 zplane 0.0
"""
TEMPLATE = """fix shape{k} all particletemplate/multisphere 15485863 atom_type 1 density constant {density} \
nspheres {count} ntry 100000 spheres file clump-{k}.txt scale 1.0 type {type} mass {mass} inertia_tensor {inertia} use_volume
fix mix{k} all particledistribution/discrete 15485867 1 shape{k} 1.0
"""
INSERT = """region at{i} sphere {position} {tiny} volume_limit 1e-30 units box
fix in{i} all insert/pack seed 32452843 distributiontemplate mix{shape} insert_every once overlapcheck no all_in no \
vel constant {velocity} omega constant {spin} orientation constant {orientation} region at{i} particles_in_region 1
"""
TAIL = """fix move all multisphere
run 1
dump all all custom 1 pile.dump id x y z radius
dump_modify all sort id format "%d %.12g %.12g %.12g %.12g"
run 0
undump all
thermo 100
thermo_style custom step atoms ke
run 200
"""


def centre_of(spheres: Sequence[Sequence[float]]) -> list[float]:
    """Of the volume that they cover together, by a lattice."""
    low = [min(s[i] - s[3] for s in spheres) for i in range(3)]
    high = [max(s[i] + s[3] for s in spheres) for i in range(3)]
    steps = 30
    inside: list[list[float]] = []
    for index in range(steps**3):
        numbers = index % steps, index // steps % steps, index // steps**2
        p = [l + (n + 0.5) * (h - l) / steps for l, h, n in zip(low, high, numbers)]
        if any(math.dist(p, s[:3]) < s[3] for s in spheres):
            inside.append(p)
    return [sum(p[i] for p in inside) / len(inside) for i in range(3)]


def words(values: Iterable[float]) -> str:
    return " ".join(f"{v:.12g}" for v in values)


def template(pile: dict[str, Any], k: int, density: float, folder: pathlib.Path) -> str:
    """The file of spheres and the lines that declare shape k."""
    shape = pile["shapes"][k]
    if shape["mesh_file"]:
        sys.exit(f"shape {k} is a mesh, of which LIGGGHTS knows nothing: pour clumps (scree drop --clump 20)")
    spheres = [(*s["centre"], s["radius"]) for s in shape["spheres"]]
    shape["spheres_centre"] = centre_of(spheres)
    (folder / f"clump-{k}.txt").write_text("".join(words(s) + "\n" for s in spheres))
    xx, yy, zz = (density * m for m in shape["inertia_per_density"])
    return TEMPLATE.format(k=k, density=density, count=len(spheres), type=k + 1, mass=density * shape["volume"],
                           inertia=words([xx, 0, 0, yy, 0, zz]))


def main(folder: str, target: str) -> None:
    pile, output = read_pile(folder), pathlib.Path(target)
    bodies, reach = pile["bodies"], max(s["bounding_radius"] for s in pile["shapes"])
    ends: list[float] = []
    for axis in range(3):
        where = [b["position"][axis] for b in bodies]
        ends += [min(where) - 4 * reach, max(where) + 4 * reach]
    output.mkdir(parents=True, exist_ok=True)
    text = HEAD.format(box=words(ends), skin=0.1 * reach, g=-pile["gravity"][2])
    for k in sorted({b["shape"] for b in bodies}):
        one = next(b for b in bodies if b["shape"] == k)
        text += template(pile, k, one["mass"] / pile["shapes"][k]["volume"], output)
    for i, body in enumerate(bodies):
        offset = turn(rotation(body["orientation"]), pile["shapes"][body["shape"]]["spheres_centre"])
        text += INSERT.format(i=i, shape=body["shape"], tiny=1e-6 * reach,
                              position=words(x + y for x, y in zip(body["position"], offset)),
                              velocity=words(body["velocity"]), spin=words(body["angular_velocity"]),
                              orientation=words(body["orientation"]))
    (output / "in.pile").write_text(text + TAIL)
    print(f"{len(bodies)} multispheres in {output / 'in.pile'}")


if __name__ == "__main__":
    main(*sys.argv[1:])
