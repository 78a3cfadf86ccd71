"""Pouring shapes into a container."""
import ctypes
import os

from . import _library as c
from ._library import call, lib
from ._values import from_struct, index_of, set_fields, whole
from ._world import Owner, Particle, World, advance


class Pour:
    """Any shapes, poured layer by layer from above into a cylinder or a box, as `scree drop` does:

        pour = Pour([(phone, 100), (Particle.sphere(0.02), 50)], width=0.3, particles={"friction": 0.4})
        pour.run(2)
        pour.world.observe().coordination

    shapes: a closed Mesh or a Particle with its count, each. container: cylinder, or box; its width and depth, m, and
    drop_height, entry_speed, seed: see scree_pour_options. world, particles, walls: dictionaries of the fields of
    scree_world_options and scree_material. `world` is the World; body i is the i-th to have entered."""

    def __init__(self, shapes, container="cylinder", law="linear", **options):
        settings = set_fields(lib["default_pour_options"](), options, "Pour")
        settings.container = index_of(container, c.CONTAINERS, "container")
        settings.world.law = index_of(law, c.LAWS, "law")
        shapes = [(shape if isinstance(shape, Particle) else Particle(shape), count) for shape, count in shapes]
        rows = (c.scree_pour_shape * max(1, len(shapes)))(
            *[(particle._handle, whole(count, "a number of particles")) for particle, count in shapes])
        handle = ctypes.c_void_p()
        call("pour_create", rows, len(shapes), settings, handle)
        self._take(handle)

    def _take(self, handle):
        self._handle = handle
        self._owner = Owner("pour_free", handle)
        self.world = World._within(lib["pour_world"](handle), self._owner)
        return self

    @classmethod
    def load(cls, path):
        """From a checkpoint of save(), or of `scree drop`; goes on with the same bits."""
        handle = ctypes.c_void_p()
        call("pour_load", os.fsencode(path), handle)
        return cls.__new__(cls)._take(handle)

    def save(self, path, overwrite=False):
        call("pour_save", self._handle, os.fsencode(path), overwrite)

    def __len__(self):
        """All particles; `len(pour.world)` are those that have entered."""
        return lib["pour_particle_count"](self._handle)

    def step(self, count=1):
        """As World.step, letting in layers when they are due."""
        call("pour_advance", self._handle, whole(count, "a number of steps"))

    def run(self, duration):
        """Advances by a time in seconds, rounded up to whole steps."""
        advance(self.world, self.step, duration)

    def record(self, path, interval):
        """From now on where every body is goes to a file that Motion reads, at every interval of simulated time, s."""
        call("pour_record", self._handle, os.fsencode(path), interval)

    def end_record(self):
        """Records the present moment, and closes the file."""
        call("pour_record_end", self._handle)

    def shape_of(self, body):
        """Which of the shapes a body is."""
        if not 0 <= body < len(self):
            raise IndexError(f"body {body} of {len(self)}")
        return lib["pour_shape_of"](self._handle, body)

    def options(self):
        """The options with every default filled in."""
        options = c.scree_pour_options()
        lib["pour_get_options"](self._handle, options)
        return from_struct(options, {"container": c.CONTAINERS})

    filling_time = property(lambda self: lib["pour_filling_time"](self._handle), doc="s: when the last layer enters")
    entered_energy = property(lambda self: lib["pour_entered_energy"](self._handle),
                              doc="J: kinetic and potential energy that the particles brought with them")
