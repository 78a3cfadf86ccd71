"""Scenes: the user's own equipment, from one YAML file."""
import ctypes
import math
import os
import types

from . import _library as c
from ._library import call, lib
from ._values import column, from_struct, whole
from ._world import Owner, World


class Scene:
    """What a scene's file describes (docs/reference/scenes.md), as `scree run` runs it:

        scene = scree.Scene("drum.yaml", {"geometry.shell.motion.0.rotate.speed": 3})
        scene.run(2)                        # up to 2 s of simulated time; without a time to its end
        scene.sensors["torque.power"]       # every number that is followed, now
        scene.bodies().position             # an array, a row a body

    fields: any fields of the file and their values. `world` is the World, to look at and to push bodies in."""

    def __init__(self, path, fields=()):
        file = ctypes.c_void_p()
        call("scene_file_read", os.fsencode(path), file)
        owner = Owner("scene_file_free", file)
        for field, value in dict(fields).items():
            call("scene_file_set", file, field.encode(), _yaml(value).encode())
        handle = ctypes.c_void_p()
        call("scene_create", file, None, handle)
        del owner
        self._take(handle)

    def _take(self, handle):
        self._handle = handle
        self._owner = Owner("scene_free", handle)
        self._hooks = []
        self.world = World._within(lib["scene_world"](handle), self._owner)
        self.columns = _names("scene_column_name", handle)
        return self

    @classmethod
    def load(cls, path):
        """From a checkpoint of save(), or of `scree run`; goes on with the same bits."""
        handle = ctypes.c_void_p()
        call("scene_load", os.fsencode(path), handle)
        return cls.__new__(cls)._take(handle)

    def save(self, path, overwrite=False):
        call("scene_save", self._handle, os.fsencode(path), overwrite)

    @staticmethod
    def template(name):
        """The text of a template, such as "drum"; templates() are their names."""
        text = lib["scene_template"](name.encode())
        if text is None:
            raise ValueError(f"no template '{name}'; there are {', '.join(Scene.templates())}")
        return text.decode()

    @staticmethod
    def templates():
        return _names("scene_template_name")

    end = property(lambda self: (lib["scene_end"](self._handle) or b"").decode() or None,
                   doc="Why it has ended, such as \"the time is over\"; None: it has not.")
    time = property(lambda self: self.world.time, doc="s")
    duration = property(lambda self: lib["scene_duration"](self._handle), doc="s: the scene's own time")
    shapes = property(lambda self: _names("scene_shape_name", self._handle), doc="Names.")
    geometry = property(lambda self: _names("scene_geometry_name", self._handle), doc="Names.")

    def geometry_note(self, index):
        """What the meshes of a geometry are as walls, and what was mended of them, a line each; None: nothing to tell."""
        names = self.geometry
        if not 0 <= whole(index, "a geometry") < len(names):
            raise IndexError(f"geometry {index} of {len(names)}")
        note = lib["scene_geometry_note"](self._handle, index)
        return note.decode() if note else None

    def every(self, interval, function):
        """run() calls function(scene) between steps, once every `interval` of simulated time, s; what it raises ends
        run()."""
        if not (math.isfinite(interval) and interval > 0):
            raise ValueError(f"an interval is {interval} s; finite and above 0")
        if not callable(function):
            raise TypeError(f"{function!r} cannot be called")
        self._hooks.append([interval, self.time, function])

    def step(self, count=1):
        """Advances by at most so many steps; stops where the scene ends."""
        call("scene_advance", self._handle, whole(count, "a number of steps"))

    def run(self, until=math.inf):
        """Advances to a time, s, or to the scene's end; between steps it calls the hooks of every() that are due."""
        step = self.world.time_step
        if math.isnan(until):
            raise ValueError(f"until {until} s: a time, or nothing for the scene's end")
        while self.end is None and self.time < until:
            for hook in self._hooks:
                if self.time >= hook[1]:
                    hook[1] += hook[0] * (1 + math.floor((self.time - hook[1]) / hook[0]))
                    hook[2](self)
            due = min([until, *(hook[1] for hook in self._hooks)])
            left = (due - self.time) / step
            self.step(min(1000, max(1, math.ceil(left - 1e-6))) if math.isfinite(left) else 1000)
        return self

    @property
    def sensors(self):
        """Every number that is followed, by its name, now; NaN where there is none."""
        values = (ctypes.c_double * len(self.columns))()
        call("scene_measure", self._handle, values)
        return dict(zip(self.columns, values))

    def units(self):
        """The unit of each column, by its name; "" for a pure number."""
        return dict(zip(self.columns, _names("scene_column_unit", self._handle)))

    def series(self):
        """All columns over time, a row at every output.series: by name, an array each."""
        count = ctypes.c_size_t()
        rows, width = lib["scene_series"](self._handle, count), len(self.columns)
        return {name: column([rows[i * width + k] for i in range(count.value)]) for k, name in enumerate(self.columns)}

    def bodies(self):
        """position, orientation, velocity and angular_velocity of all bodies that ever entered, a row each; shape, the
        number of its shape; inside, whether it is."""
        bodies = self.world.bodies()
        bodies.shape = column([lib["scene_body_shape"](self._handle, i) for i in range(len(self.world))])
        inside = set(self.world.live())
        bodies.inside = column([i in inside for i in range(len(self.world))])
        return bodies

    def book(self):
        """What came in, is inside, went out: counts, masses (kg), energies (J); ledger."""
        book = c.scree_scene_book()
        lib["scene_get_book"](self._handle, book)
        return from_struct(book)

    def inlets(self):
        """By name: count, mass (kg) and how many wait."""
        found = {}
        for i, name in enumerate(_names("scene_inlet_name", self._handle)):
            mass, waiting = ctypes.c_double(), ctypes.c_size_t()
            count = lib["scene_inlet_count"](self._handle, i, mass, waiting)
            found[name] = types.SimpleNamespace(count=count, mass=mass.value, waiting=waiting.value)
        return found

    def outlets(self):
        """By name: count and mass (kg); None is the domain's rim."""
        found = {}
        for i, name in enumerate([*_names("scene_outlet_name", self._handle), None]):
            mass = ctypes.c_double()
            found[name] = types.SimpleNamespace(count=lib["scene_outlet_count"](self._handle, i, mass), mass=mass.value)
        return found

    def __str__(self):
        return lib["scene_text"](self._handle).decode()


def _names(function, *handle):
    found = []
    while lib[function](*handle, len(found)) is not None:
        found.append(lib[function](*handle, len(found)).decode())
    return found


def _yaml(value):
    """A value as YAML: numbers, texts, lists and dictionaries of these."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_yaml(inner)}" for key, inner in value.items()) + "}"
    if isinstance(value, (list, tuple)) or hasattr(value, "tolist") and not isinstance(value, float):
        value = value.tolist() if hasattr(value, "tolist") else value
        return "[" + ", ".join(_yaml(inner) for inner in value) + "]" if isinstance(value, (list, tuple)) else str(value)
    return str(value)
