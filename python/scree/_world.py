"""Particles and worlds."""
from __future__ import annotations

import ctypes
import itertools
import math
import os
from typing import Any, Sequence

from . import _mesh, _picture
from ._library import Handle, lib
from ._mesh import Mesh, Progress, Shared, write_code
from ._records import CodeWritten, MaterialContact, Observation, ParticleMeasures
from ._saved import Saved
from ._values import Record, c_array, column, metres, record, set_fields, table


class Particle(Shared):
    """A rigid shape: of a closed mesh, a sphere, or a clump of spheres; not to be changed. Its frame has its origin in the
    centre of mass and its axes along the principal axes."""

    def __init__(self, mesh: Mesh, **options: Any) -> None:
        """Option rounding, m."""
        self._c = lib.particle_from_mesh(mesh, options)

    @classmethod
    def sphere(cls, radius: float) -> Particle:
        return cls._of(lib.particle_sphere(radius))

    @classmethod
    def clump(cls, centres: Any, radii: Sequence[float], like: Particle | None = None) -> Particle:
        """like: a particle whose volume, centre and inertia the clump takes over."""
        where, count = c_array(ctypes.c_double, centres, 3)
        sizes, size_count = c_array(ctypes.c_double, radii)
        if count != size_count:
            raise ValueError(f"{count} centres, but {size_count} radii")
        return cls._of(lib.particle_clump(where, sizes, count, like))

    @classmethod
    def clump_of(cls, mesh: Mesh, count: int, progress: Progress = None) -> Particle:
        """A clump of so many spheres, 1 to 300, or as many as the mesh has use for, with the mesh's volume, centre and
        inertia. A mesh of about 2,000 triangles has all the detail that spheres show."""
        return cls._of(lib.clump_fit(mesh, count, progress))

    def export(self, code: str, folder: str | os.PathLike | None = None, *, density: float = 2000, particles: int = 50,
               pieces: int = 64, young: float = 0, overwrite: bool = True) -> CodeWritten:
        """Files and scripts for another code, as Mesh.export; by default into the folder particle-CODE."""
        return write_code(self, code, folder, None, density=density, particles=particles, pieces=pieces, young=young,
                          overwrite=overwrite)

    def measure(self) -> ParticleMeasures:
        """The fields of scree_particle_measures: volume, size, centre, orientation, inertia, ..."""
        return record(lib.particle_measure(self))

    def mesh(self) -> Mesh:
        """A copy of the mesh in the particle's frame; no triangles for spheres and clumps."""
        return Mesh._of(lib.mesh_copy(lib.particle_mesh(self)))

    def __reduce__(self) -> tuple:
        """By a checkpoint of a world with this one body."""
        return _particle_in, (_world_of(self),)

    def __repr__(self) -> str:
        measures = self.measure()
        return f"<scree.Particle: {measures.kind} of size {measures.size:.4g} m>"

    def _repr_html_(self) -> str:
        return _picture.html(self, lambda options: lib.world_picture(_world_of(self), options, None), self.measure())


_mesh.Particle = Particle  # type: ignore[misc]  # which stands before this file


class World(Saved):
    """Bodies under gravity, touching each other and walls. Options are those of scree_world_options; law "linear",
    "hysteretic" or "hertz".

    One thread at a time: while a thread is in step or run, another's calls raise RuntimeError; `time` and `step_count` alone
    may be read. copy.copy and pickle make a world of its own by a checkpoint, which goes on with the same bits."""

    def __init__(self, law: str = "linear", **options: Any) -> None:
        self._c = lib.world_create({"law": law, **options})

    @classmethod
    def _within(cls, pointer, owner):
        """One that belongs to something else, which lives as long as the world is in use."""
        world = cls.__new__(cls)
        world._c = Handle("world", pointer, within=owner)
        return world

    @classmethod
    def load(cls, path: str | os.PathLike) -> World:
        """From a checkpoint of save()."""
        return cls._of(lib.world_load(path))

    def save(self, path: str | os.PathLike, overwrite: bool = True) -> None:
        lib.world_save(self, path, overwrite)

    def add_material(self, wall: bool = False, **values: Any) -> int:
        """Its index. young (N/m2), density (kg/m3), restitution, friction, rolling_friction,
        surface_energy (J/m2), poisson (of the law hertz); wall: the defaults of walls."""
        return lib.world_add_material(self, set_fields(lib.default_wall_material(), values, "material") if wall else values)

    def set_contact(self, a: int, b: int, restitution: float, friction: float) -> None:
        """Between two materials."""
        lib.world_set_contact(self, a, b, restitution, friction)

    def set_pair(self, a: int, b: int, **values: float) -> MaterialContact:
        """Between two materials: restitution, friction, rolling_friction, pull_off (N), surface_energy (J/m2); what is
        not given stays. All of them."""
        contact = set_fields(lib.world_get_pair(self, a, b), values, "pair")
        lib.world_set_pair(self, a, b, contact)
        return record(contact)

    def add_wall(self, kind: str, material: int, mesh: Mesh | None = None, **values: Any) -> int:
        """Its index. kind plane, disc, cylinder or mesh; position, axis, radius, length, velocity,
        angular_velocity; surface_velocity, surface_angular_velocity and surface_loop of a belt; two_sided: a closed mesh too is a
        sheet. One that is wound inwards holds what is in it."""
        given: dict[str, Any] = {"kind": kind, "material": material, "axis": (0, 0, 1), **values}
        return lib.world_add_wall(self, given if mesh is None else {**given, "mesh": mesh})

    def set_wall_velocity(self, index: int, velocity: Sequence[float] = (0, 0, 0),
                          angular_velocity: Sequence[float] = (0, 0, 0)) -> None:
        lib.world_set_wall_velocity(self, self._wall(index), velocity, angular_velocity)

    def set_wall_surface(self, index: int, velocity: Sequence[float] = (0, 0, 0),
                         angular_velocity: Sequence[float] = (0, 0, 0), loop: Sequence[float] = (0, 0, 0)) -> None:
        """Of its surface, while the wall itself stays: a belt, a roller, a mesh that runs round."""
        lib.world_set_wall_surface(self, self._wall(index), velocity, angular_velocity, loop)

    def set_wall_motion(self, index: int, *motions: dict[str, Any]) -> None:
        """From now on, each a dictionary: law constant, sine, positions or speeds; turns (about the axis through
        `through`, else along it), axis, speed, amplitude, frequency, phase, table ([[t, value], ...]), from, until."""
        structs = (lib.type("wall_motion") * max(1, len(motions)))()
        for i, given in enumerate(motions):
            values = {**given}
            rows, count = c_array(ctypes.c_double, values.pop("table"), 2) if "table" in given else (None, 0)
            struct = lib.filled("scree_wall_motion", values)
            struct.table, struct.row_count = ctypes.cast(rows, ctypes.POINTER(ctypes.c_double)), count
            structs[i] = struct
        lib.world_set_wall_motion(self, self._wall(index), structs, len(motions))

    def wall_power(self, index: int) -> tuple[float, float]:
        """What the wall does on bodies: W in the last step, and J since the start."""
        return lib.world_wall_power(self, self._wall(index))

    def wall_force(self, index: int) -> tuple[Any, Any]:
        """Force and torque about its position on the wall in the last step."""
        return lib.world_wall_force(self, self._wall(index))

    def add_body(self, particle: Particle, material: int, **state: Any) -> int:
        """Its index. position (m), orientation (w x y z), velocity (m/s), angular_velocity (rad/s)."""
        return lib.world_add_body(self, particle, material, state)

    def add_joint(self, a: int, b: int | None = None, face: Record | None = None, young: float = 0, **values: Any) -> int:
        """Its index. Holds two bodies, or one where it is (b None): by a face of Mesh.fracture and Young's modulus (Pa), and
        the fields of scree_joint, as tension, cohesion, friction, toughness, damping."""
        joint = lib.default_joint()
        if face is not None:
            lib.joint_of_face(vars(face), young, joint)
        ends = {"a": self._body(a), "b": ctypes.c_size_t(-1).value if b is None else self._body(b)}
        return lib.world_add_joint(self, set_fields(joint, {**values, **ends}, "joint"))

    def joints(self) -> list[Record]:
        """a, b, state, mode, position, force, moment, load (1: it breaks), energy, fracture (J), broke_at (s)."""
        return [record(lib.world_observe_joint(self, k)) for k in range(lib.world_joint_count(self))]

    def fragments(self) -> Any:
        """By body: the number of what hangs together."""
        numbers = (ctypes.c_size_t * max(1, len(self)))()
        lib.world_fragments(self, numbers)
        return column(numbers[:len(self)])

    def _wall(self, index):
        return _below(index, lib.world_wall_count(self), "wall")

    def _body(self, index):
        return _below(index, len(self), "body")

    def __len__(self) -> int:
        """All bodies ever added."""
        return lib.world_body_count(self)

    def live(self) -> list[int]:
        """Indices of the bodies that are in."""
        return [i for i, removed in enumerate(of_each(lib.world_body_removed, self, len(self))) if not removed]

    def body(self, index: int) -> Record:
        """position, orientation, velocity, angular_velocity; mass, material."""
        body = record(lib.world_get_body(self, self._body(index)))
        body.mass, body.material = lib.world_body_mass(self, index), lib.world_body_material(self, index)
        return body

    def set_body(self, index: int, **state: Any) -> None:
        body = lib.world_get_body(self, self._body(index))
        lib.world_set_body(self, index, set_fields(body, state, "body"))

    def set_body_force(self, index: int, force: Sequence[float] = (0, 0, 0), torque: Sequence[float] = (0, 0, 0)) -> None:
        """N through its centre and N m, in every step until they are set anew."""
        lib.world_set_body_force(self, self._body(index), force, torque)

    def bodies(self) -> Record:
        """Of all bodies ever added, a row each: position, orientation, velocity and angular_velocity; mass (kg), material;
        inside, whether it has not been removed. Row i is body i."""
        with self._c.turn.taken():
            count, widths = len(self), {"position": 3, "orientation": 4, "velocity": 3, "angular_velocity": 3}
            arrays = [(ctypes.c_double * max(1, count * width))() for width in widths.values()]
            lib.world_get_bodies(self, 0, count, *arrays)
            return Record(**{name: table(ctypes.cast(array, ctypes.POINTER(ctypes.c_double)), count, width, array)
                             for array, (name, width) in zip(arrays, widths.items())},
                          mass=column(of_each(lib.world_body_mass, self, count)),
                          material=column(of_each(lib.world_body_material, self, count)),
                          inside=column([not removed for removed in of_each(lib.world_body_removed, self, count)]))

    def remove_body(self, index: int) -> None:
        lib.world_remove_body(self, self._body(index))

    def positions(self) -> Any:
        """Of the live bodies, a row each, m."""
        rows, live = self.bodies().position, self.live()
        return rows[live] if hasattr(rows, "dtype") else [list(map(float, (rows[i, k] for k in range(3)))) for i in live]

    def set_backend(self, name: str) -> None:
        """"cpu", "cuda" or "cuda:1": where it is stepped from now on, with the same bits."""
        with self._c.turn.taken(steps=True):
            lib.world_set_backend(self, name)

    def step(self, count: int = 1) -> None:
        """Advances by whole steps; Error with status DIVERGED where the run leaves its model."""
        with self._c.turn.taken(steps=True):
            lib.world_step(self, count)

    def run(self, duration: float) -> None:
        """Advances by a time in seconds, rounded up to whole steps."""
        if not (math.isfinite(duration) and duration >= 0):
            raise ValueError(f"a duration is {duration} s; finite and at least 0")
        with self._c.turn.taken(steps=True):
            end = self.time + duration
            while self.time < end:  # in pieces, between which Ctrl-C works
                self.step(min(1000, max(1, int((end - self.time) / self.time_step + 0.999999))))

    @property
    def time(self) -> float:
        """s"""
        return lib.world_time.c(self._c.pointer)

    @property
    def step_count(self) -> int:
        return lib.world_step_count.c(self._c.pointer)

    @property
    def time_step(self) -> float:
        """s"""
        return lib.world_time_step(self, None)

    @property
    def hash(self) -> str:
        """Names the state, 32 hexadecimal digits."""
        checksum = lib.world_hash(self)
        return f"{checksum.high:016x}{checksum.low:016x}"

    def observe(self) -> Observation:
        """Energies, momenta, coordination, counts: the fields of scree_observation."""
        return record(lib.world_observe(self))

    def contacts(self) -> list[Record]:
        """Every touching feature: body, other, wall, position, normal, force, overlap, weight."""
        found = []

        def visit(_context, contact):
            found.append(record(contact.contents))
            return True

        lib.world_visit_contacts(self, visit, None)
        return found

    def write_vtp(self, path: str | os.PathLike, view: str = "surfaces", overwrite: bool = True) -> None:
        """For ParaView: surfaces, points, contacts or walls."""
        lib.world_vtp_write(self, view, path, overwrite)

    def export(self, folder: str | os.PathLike, unit: str | float = "mm", overwrite: bool = True) -> None:
        """pile.json, bodies.csv and an STL per shape."""
        lib.world_export(self, {"unit_m": metres(unit), "overwrite": overwrite}, folder)

    def __repr__(self) -> str:
        return f"<scree.World of {len(self)} bodies at {self.time:.6g} s>"

    def _repr_html_(self) -> str:
        return _picture.html(self, lambda options: lib.world_picture(self, options, None), self.observe())


def of_each(function, owner, count):
    """function(owner, 0), (owner, 1), ... below count, for many: by the bare C function."""
    with owner._c.turn.taken():
        return list(map(function.c, itertools.repeat(owner._c.pointer), range(count)))


def _below(index, count, what):
    if not 0 <= index < count:
        raise IndexError(f"{what} {index} of {count}")
    return index


def _world_of(particle):
    world = World(gravity=(0, 0, 0))
    world.add_body(particle, world.add_material())
    return world


def _particle_in(world):
    return Particle._of(Handle("particle", lib.world_body_particle(world, 0), within=world._c))


def write_pvd(path: str | os.PathLike, files: Sequence[str | os.PathLike], times: Sequence[float],
              overwrite: bool = True) -> None:
    """A series for ParaView: .pvd, or .vtp.series by the path's ending."""
    names = (ctypes.c_char_p * max(1, len(files)))(*[os.fsencode(f) for f in files])
    when, count = c_array(ctypes.c_double, times)
    if count != len(files):
        raise ValueError(f"{len(files)} files, but {count} times")
    lib.pvd_write(names, when, count, path, overwrite)
