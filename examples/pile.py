"""From a scan to a pile for other programs, in Python: chooses the triangle count of a device, drops some of these
particles into a tube, and writes the pile for ParaView and as a folder that examples/pile_to_lammps.py,
pile_to_liggghts.py and pile_to_yade.py read.

    python3 examples/pile.py FOLDER [SCAN] [COUNT] [TRIANGLES]

SCAN: a file in mm, or sample:NAME. TRIANGLES: in place of the chosen count, for programs that take fewer (LAMMPS: 150)."""
from __future__ import annotations

import pathlib
import random
import sys
from typing import Any

import scree


def random_orientation(rng: random.Random) -> list[float]:
    q = [rng.gauss(0, 1) for _ in range(4)]
    norm = sum(x * x for x in q) ** 0.5
    return [x / norm for x in q]


def main(target: str, scan_name: str = "sample:fp-3", count: str = "6", triangles: str | None = None) -> None:
    folder, rng = pathlib.Path(target), random.Random(1)
    folder.mkdir(parents=True, exist_ok=True)
    options: dict[str, Any] = {"resolution": 2e-3, "noise": 0.2e-3} if scan_name.startswith("sample:") else {}
    scan = scree.load(scan_name, **options)
    choice = scan.choose()
    mesh = scan.simplify(int(triangles)) if triangles else choice.mesh()
    print(f"{scan_name}, of {scan.triangle_count} triangles: {choice.answer}")

    world = scree.World()
    plastic, steel = world.add_material(density=1500), world.add_material(wall=True)
    particle = scree.Particle(mesh)
    reach = particle.measure().bounding_radius
    world.add_wall("plane", steel)
    world.add_wall("cylinder", steel, radius=1.2 * reach)
    for i in range(int(count)):
        world.add_body(particle, plastic, position=(0, 0, (1.1 + 2.05 * i) * reach),
                       orientation=random_orientation(rng), velocity=(0, 0, -1))

    files, times = [], []
    for frame in range(int(count) + 4):
        for view in "surfaces", "points", "contacts":
            world.write_vtp(folder / f"{view}-{frame:04}.vtp", view)
        files.append(f"surfaces-{frame:04}.vtp")
        times.append(world.time)
        world.run(0.1)
    scree.write_pvd(folder / "pile.pvd", files, times)
    world.write_vtp(folder / "walls.vtp", "walls")
    world.export(folder / "pile", unit="m")
    state = world.observe()
    print(f"{state.body_count} particles after {world.time:.2f} s: {state.coordination:.2f} neighbours each, "
          f"{state.kinetic + state.rotational:.2g} J left of motion")


if __name__ == "__main__":
    main(*sys.argv[1:])
