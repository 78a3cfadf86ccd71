"""Particles and worlds."""
import ctypes
import math
import os
import types
import weakref

from . import _library as c
from ._library import call, lib
from ._mesh import Mesh
from ._values import c_array, column, from_struct, index_of, metres, set_fields, table, vector, whole


class Particle:
    """A rigid shape: of a closed mesh, a sphere, or a clump of spheres. Its frame has its origin in the centre of
    mass and its axes along the principal axes."""

    def __init__(self, mesh, **options):
        """Option rounding, m."""
        settings = set_fields(lib["default_particle_options"](), options, "Particle")
        self._take("particle_from_mesh", mesh._struct, settings)

    def _take(self, name, *arguments):
        handle = ctypes.c_void_p()
        call(name, *arguments, handle)
        self._handle = handle
        self._finalizer = weakref.finalize(self, lib["particle_free"], handle)
        return self

    @classmethod
    def sphere(cls, radius):
        return cls.__new__(cls)._take("particle_sphere", radius)

    @classmethod
    def clump(cls, centres, radii, like=None):
        """like: a particle whose volume, centre and inertia the clump takes over."""
        where, count = c_array(ctypes.c_double, centres, 3)
        sizes, size_count = c_array(ctypes.c_double, radii)
        if count != size_count:
            raise ValueError(f"{count} centres, but {size_count} radii")
        return cls.__new__(cls)._take("particle_clump", where, sizes, count, like._handle if like else None)

    @classmethod
    def clump_of(cls, mesh, count, progress=None):
        """A clump of so many spheres, 1 to 300, or as many as the mesh has use for, with the mesh's volume, centre and
        inertia. A mesh of about 2,000 triangles has all the detail that spheres show."""
        with c.Progress(progress) as p:
            return cls.__new__(cls)._take("clump_fit", mesh._struct, whole(count, "count"), p)

    def measure(self):
        """The fields of scree_particle_measures: volume, size, centre, orientation, inertia, ..."""
        measures = c.scree_particle_measures()
        lib["particle_measure"](self._handle, measures)
        return from_struct(measures, {"kind": c.PARTICLE_KINDS})

    def mesh(self):
        """A copy of the mesh in the particle's frame; no triangles for spheres and clumps."""
        copy = c.scree_mesh()
        call("mesh_copy", lib["particle_mesh"](self._handle), copy)
        return Mesh._of(copy)


class World:
    """Bodies under gravity, touching each other and walls. Options are those of scree_world_options; law "linear" or
    "hysteretic"."""

    def __init__(self, law="linear", **options):
        settings = set_fields(lib["default_world_options"](), options, "World")
        settings.law = index_of(law, c.LAWS, "law")
        self._handle = ctypes.c_void_p()
        call("world_create", settings, self._handle)
        self._finalizer = weakref.finalize(self, lib["world_free"], self._handle)

    @classmethod
    def load(cls, path):
        """From a checkpoint of save()."""
        world = cls.__new__(cls)
        world._handle = ctypes.c_void_p()
        call("world_load", os.fsencode(path), world._handle)
        world._finalizer = weakref.finalize(world, lib["world_free"], world._handle)
        return world

    @classmethod
    def _within(cls, handle, owner):
        """One that belongs to something else, which lives as long as the world is in use."""
        world = cls.__new__(cls)
        world._handle, world._owner = ctypes.c_void_p(handle), owner
        return world

    def save(self, path, overwrite=False):
        call("world_save", self._handle, os.fsencode(path), overwrite)

    def add_material(self, wall=False, **values):
        """Its index. stiffness (N/m2), density (kg/m3), restitution, friction, rolling_friction,
        surface_energy (J/m2), poisson (of the law hertz); wall: the defaults of walls."""
        material = lib["default_wall_material" if wall else "default_material"]()
        return self._add("world_add_material", set_fields(material, values, "a material"))

    def set_contact(self, a, b, restitution, friction):
        """Between two materials."""
        a, b = whole(a, "a material"), whole(b, "a material")
        call("world_set_contact", self._handle, a, b, restitution, friction)

    def set_pair(self, a, b, **values):
        """Between two materials: restitution, friction, rolling_friction, pull_off (N), surface_energy (J/m2); what is
        not given stays. All of them."""
        a, b, contact = whole(a, "a material"), whole(b, "a material"), c.scree_material_contact()
        call("world_get_pair", self._handle, a, b, contact)
        call("world_set_pair", self._handle, a, b, set_fields(contact, values, "a pair"))
        return from_struct(contact)

    def add_wall(self, kind, material, mesh=None, **values):
        """Its index. kind plane, disc, cylinder or mesh; position, axis, radius, length, velocity,
        angular_velocity; surface_velocity and surface_angular_velocity of a belt; two_sided: a closed mesh too is a
        sheet. One that is wound inwards holds what is in it."""
        wall = c.scree_wall(kind=index_of(kind, c.WALL_KINDS, "wall"), axis=(0, 0, 1))
        set_fields(wall, {"material": material, **values}, "a wall")
        if mesh is not None:
            wall.mesh = ctypes.pointer(mesh._struct)
        return self._add("world_add_wall", wall)

    def set_wall_velocity(self, index, velocity=(0, 0, 0), angular_velocity=(0, 0, 0)):
        self._check(index, "world_wall_count", "wall")
        call("world_set_wall_velocity", self._handle, index, vector(velocity, "velocity", c.double3),
             vector(angular_velocity, "angular_velocity", c.double3))

    def set_wall_surface(self, index, velocity=(0, 0, 0), angular_velocity=(0, 0, 0)):
        """Of its surface, while the wall itself stays: a belt, a roller."""
        self._check(index, "world_wall_count", "wall")
        call("world_set_wall_surface", self._handle, index, vector(velocity, "velocity", c.double3),
             vector(angular_velocity, "angular_velocity", c.double3))

    def set_wall_motion(self, index, *motions):
        """From now on, each a dictionary: law constant, sine, positions or speeds; turns (about the axis through
        `through`, else along it), axis, speed, amplitude, frequency, phase, table ([[t, value], ...]), from, until."""
        self._check(index, "world_wall_count", "wall")
        structs, tables = (c.scree_wall_motion * max(1, len(motions)))(), []
        for i, given in enumerate(motions):
            values = dict(given)
            struct = lib["default_wall_motion"]()
            struct.law = index_of(values.pop("law", "constant"), c.MOTION_LAWS, "law")
            rows, struct.row_count = c_array(ctypes.c_double, values.pop("table", []), 2) if "table" in values else (None, 0)
            struct.table = ctypes.cast(rows, ctypes.POINTER(ctypes.c_double))
            tables.append(rows)
            structs[i] = set_fields(struct, values, "a motion")
        call("world_set_wall_motion", self._handle, index, structs, len(motions))

    def wall_power(self, index):
        """What the wall does on bodies: W in the last step, and J since the start."""
        self._check(index, "world_wall_count", "wall")
        power, energy = ctypes.c_double(), ctypes.c_double()
        lib["world_wall_power"](self._handle, index, power, energy)
        return power.value, energy.value

    def wall_force(self, index):
        """Force and torque about its position on the wall in the last step."""
        self._check(index, "world_wall_count", "wall")
        force, torque = c.double3(), c.double3()
        lib["world_wall_force"](self._handle, index, force, torque)
        return column(force), column(torque)

    def add_body(self, particle, material, **state):
        """Its index. position (m), orientation (w x y z), velocity (m/s), angular_velocity (rad/s)."""
        body = set_fields(lib["default_body"](), state, "a body")
        index = ctypes.c_size_t()
        call("world_add_body", self._handle, particle._handle, whole(material, "a material"), body, index)
        return index.value

    def _add(self, name, struct):
        index = ctypes.c_size_t()
        call(name, self._handle, struct, index)
        return index.value

    def _check(self, index, count_name, what):
        count = lib[count_name](self._handle)
        if not 0 <= index < count:
            raise IndexError(f"{what} {index} of {count}")

    def __len__(self):
        """All bodies ever added."""
        return lib["world_body_count"](self._handle)

    def live(self):
        """Indices of the bodies that are in."""
        return [i for i in range(len(self)) if not lib["world_body_removed"](self._handle, i)]

    def body(self, index):
        """position, orientation, velocity, angular_velocity; mass, material."""
        self._check(index, "world_body_count", "body")
        state = c.scree_body()
        lib["world_get_body"](self._handle, index, state)
        body = from_struct(state)
        body.mass = lib["world_body_mass"](self._handle, index)
        body.material = lib["world_body_material"](self._handle, index)
        return body

    def set_body(self, index, **state):
        self._check(index, "world_body_count", "body")
        body = c.scree_body()
        lib["world_get_body"](self._handle, index, body)
        call("world_set_body", self._handle, index, set_fields(body, state, "a body"))

    def set_body_force(self, index, force=(0, 0, 0), torque=(0, 0, 0)):
        """N through its centre and N m, in every step until they are set anew."""
        self._check(index, "world_body_count", "body")
        call("world_set_body_force", self._handle, index, vector(force, "force", c.double3),
             vector(torque, "torque", c.double3))

    def bodies(self):
        """position, orientation, velocity and angular_velocity of all bodies ever added, a row each."""
        count, widths = len(self), {"position": 3, "orientation": 4, "velocity": 3, "angular_velocity": 3}
        arrays = [(ctypes.c_double * max(1, count * width))() for width in widths.values()]
        lib["world_get_bodies"](self._handle, 0, count, *arrays)
        return types.SimpleNamespace(**{
            name: table(ctypes.cast(array, ctypes.POINTER(ctypes.c_double)), count, width, array)
            for array, (name, width) in zip(arrays, widths.items())})

    def remove_body(self, index):
        self._check(index, "world_body_count", "body")
        lib["world_remove_body"](self._handle, index)

    def positions(self):
        """Of the live bodies, a row each, m."""
        rows = self.bodies().position
        return column([[rows[i, k] for k in range(3)] for i in self.live()])

    def step(self, count=1):
        """Advances by whole steps; Error with status DIVERGED where the run leaves its model."""
        call("world_step", self._handle, whole(count, "a number of steps"))

    def run(self, duration):
        """Advances by a time in seconds, rounded up to whole steps."""
        advance(self, self.step, duration)

    time = property(lambda self: lib["world_time"](self._handle))
    step_count = property(lambda self: lib["world_step_count"](self._handle))
    time_step = property(lambda self: lib["world_time_step"](self._handle, None))

    @property
    def hash(self):
        """Names the state, 32 hexadecimal digits."""
        checksum = lib["world_hash"](self._handle)
        return f"{checksum.high:016x}{checksum.low:016x}"

    def observe(self):
        """Energies, momenta, coordination, counts: the fields of scree_observation."""
        observation = c.scree_observation()
        lib["world_observe"](self._handle, observation)
        return from_struct(observation)

    def contacts(self):
        """Every touching feature: body, other, wall, position, normal, force, overlap, share."""
        found = []

        def visit(_context, contact):
            found.append(from_struct(contact.contents))
            return True

        call("world_visit_contacts", self._handle, c.VISITOR(visit), None)
        return found

    def write_vtp(self, path, view="surfaces", overwrite=False):
        """For ParaView: surfaces, points, contacts or walls."""
        call("world_vtp_write", self._handle, index_of(view, c.VIEWS, "view"), os.fsencode(path), overwrite)

    def export(self, folder, unit="mm", overwrite=False):
        """pile.json, bodies.csv and an STL per shape."""
        options = lib["default_export_options"]()
        options.unit_m, options.overwrite = metres(unit), overwrite
        call("world_export", self._handle, options, os.fsencode(folder))


class Owner:
    """Of a C object: it is freed when neither the Python object nor its world is in use."""

    def __init__(self, free, handle):
        weakref.finalize(self, lib[free], handle)


def advance(world, step, duration):
    """step(count), in pieces between which Ctrl-C works."""
    if not (math.isfinite(duration) and duration >= 0):
        raise ValueError(f"a duration is {duration} s; finite and at least 0")
    end = world.time + duration
    while world.time < end:
        step(min(1000, max(1, int((end - world.time) / world.time_step + 0.999999))))


def write_pvd(path, files, times, overwrite=False):
    """A series for ParaView: .pvd, or .vtp.series by the path's ending."""
    names = (ctypes.c_char_p * max(1, len(files)))(*[os.fsencode(f) for f in files])
    when, count = c_array(ctypes.c_double, times)
    if count != len(files):
        raise ValueError(f"{len(files)} files, but {count} times")
    call("pvd_write", names, when, count, os.fsencode(path), overwrite)
