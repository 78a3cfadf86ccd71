"""A pile for LAMMPS: every particle as a body of style rounded/polyhedron, with its real triangles, where and how it
lies, with velocity and angular momentum.

    scree export run.scree -o pile                      (or examples/pile.py)
    python3 pile_to_lammps.py pile lammps               writes lammps/pile.data and lammps/in.pile
    cd lammps && lmp -in in.pile                        (Debian: lammps)

in.pile reads the pile, writes the corners as LAMMPS has them to corners.dump, and goes on for some steps under
gravity on the plane z = 0. LAMMPS takes the triangles of bodies that are not convex, but finds contacts as of convex
ones. Other walls than that plane are not carried over. LAMMPS reads at most 32 lines of 255 bytes a body (MAXBODY in
its read_data.cpp): enough for about 150 triangles."""
from __future__ import annotations

import pathlib
import sys
from typing import Any, Iterable, Sequence

from pile_reader import inertia_in_space, read_pile, rotation, turn

INPUT = """units si
atom_style body rounded/polyhedron {least} {most}
boundary f f f
comm_modify vel yes
neighbor {skin} bin
read_data pile.data
pair_style body/rounded/polyhedron 1.0 1.0 0.5 0.1 {cutoff}
pair_coeff * * 1.0e4 0.0
fix gravity all gravity {g} vector 0 0 -1
fix move all nve/body
timestep 1.0e-5
compute corners all body/local id 1 2 3
dump corners all local 1000000 corners.dump c_corners[1] c_corners[2] c_corners[3] c_corners[4]
dump_modify corners format line "%.0f %.12g %.12g %.12g"
thermo 100
thermo_style custom step atoms ke
fix floor all wall/body/polyhedron 1.0e4 1.0 1.0 zplane 0.0 NULL
run 100
"""


def edges_of(triangles: Iterable[Sequence[int]]) -> list[tuple[int, int]]:
    return sorted({(min(t[i], t[i - 1]), max(t[i], t[i - 1])) for t in triangles for i in range(3)})


def packed(values: Iterable[float], width: int = 250) -> list[str]:
    """The values in lines of at most so many bytes."""
    lines = [""]
    for word in (f"{value:.9g}" for value in values):
        if len(lines[-1]) + len(word) + 1 > width:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines


def body_lines(number: int, pile: dict[str, Any], body: dict[str, Any]) -> list[str]:
    """One entry of the section Bodies: corners relative to the centre, along the axes of space."""
    shape = pile["shapes"][body["shape"]]
    matrix, edges = rotation(body["orientation"]), edges_of(shape["triangles"])
    corners = [turn(matrix, vertex) for vertex in shape["vertices"]]
    values = [inertia_in_space(pile, body), *corners, *edges, *([*t, -1] for t in shape["triangles"]), [0.0]]
    lines = [f"{number} 3 {sum(map(len, values))}", f"{len(corners)} {len(edges)} {len(shape['triangles'])}"]
    lines += packed([x for row in values for x in row])
    if len(lines) - 2 > 31:
        sys.exit(f"shape {body['shape']} has {len(edges) * 2 // 3} triangles, more than LAMMPS reads of one body: "
                 "make the pile from a level of at most 150")
    return lines


def angular_momentum(pile: dict[str, Any], body: dict[str, Any]) -> list[float]:
    xx, yy, zz, xy, xz, yz = inertia_in_space(pile, body)
    return turn([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], body["angular_velocity"])


def main(folder: str, target: str) -> None:
    pile, output = read_pile(folder), pathlib.Path(target)
    bodies = [b for b in pile["bodies"] if pile["shapes"][b["shape"]]["mesh_file"]]
    if len(bodies) < len(pile["bodies"]):
        print(f"{len(pile['bodies']) - len(bodies)} spheres and clumps are left out")
    reach = max(s["bounding_radius"] for s in pile["shapes"])
    counts = [len(pile["shapes"][b["shape"]]["vertices"]) for b in bodies]
    lines = ["LAMMPS data file from scree: metres, kilograms, seconds", "", f"{len(bodies)} atoms",
             f"{len(bodies)} bodies", "1 atom types", ""]
    for axis, name in enumerate("xyz"):
        where = [b["position"][axis] for b in bodies]
        lines.append(f"{min(where) - 4 * reach!r} {max(where) + 4 * reach!r} {name}lo {name}hi")
    lines += ["", "Atoms", ""]
    lines += [" ".join(map(repr, [i, 1, 1, b["mass"], *b["position"]])) for i, b in enumerate(bodies, 1)]
    lines += ["", "Bodies", ""]
    for i, body in enumerate(bodies, 1):
        lines += body_lines(i, pile, body)
    lines += ["", "Velocities", ""]
    lines += [" ".join(map(repr, [i, *b["velocity"], *angular_momentum(pile, b)])) for i, b in enumerate(bodies, 1)]
    # twice the corners: LAMMPS makes room for as many edges and faces as that, and a closed surface of triangles has
    # three and two times as many as corners
    output.mkdir(parents=True, exist_ok=True)
    (output / "pile.data").write_text("\n".join(lines) + "\n")
    (output / "in.pile").write_text(INPUT.format(least=min(counts), most=2 * max(counts), cutoff=0.01 * reach,
                                                 skin=0.1 * reach, g=-pile["gravity"][2]))
    print(f"{len(bodies)} bodies in {output / 'pile.data'}")


if __name__ == "__main__":
    main(*sys.argv[1:])
