"""Scenes: the user's own equipment, from one YAML file."""
import ctypes
import math
import os
import types

from . import _library as c
from ._library import call, lib
from ._values import column, from_struct, set_fields, whole
from ._world import Owner, Particle, World


class Scene:
    """What a scene's file describes (docs/reference/scenes.md), as `scree run` runs it:

        scene = scree.Scene("drum.yaml", {"geometry.shell.motion.0.rotate.speed": 3})
        scene.run(2)                        # up to 2 s of simulated time; without a time to its end
        scene.sensors["torque.power"]       # every number that is followed, now
        scene.bodies().position             # an array, a row a body

    fields: any fields and parameters of the file and their values. `world` is the World, to look at and to push bodies
    in."""

    def __init__(self, path, fields=()):
        file = ctypes.c_void_p()
        call("scene_file_read", os.fsencode(path), file)
        self._make(file, fields)

    @classmethod
    def template(cls, name, shapes=(), fields=()):
        """A template with shapes and fields of your own:

            scene = Scene.template("repose", {"phone": mesh, "ball": Particle.sphere(0.02)}, {"preset": "small"})

        name: one of templates(). shapes: by name a closed Mesh or a Particle, or one with its share by number, as
        (mesh, 2); those of the template where there are none. fields: as of a scene; a preset goes first."""
        file = ctypes.c_void_p()
        call("scene_file_template", name.encode(), file)
        self = cls.__new__(cls)
        self._make(file, fields, {str(key): shape for key, shape in dict(shapes).items()})
        return self

    @staticmethod
    def templates():
        """The templates, by name: their text, to start a file from."""
        return {name: lib["scene_template"](name.encode()).decode() for name in _names("scene_template_name")}

    def _make(self, file, fields, shapes=()):
        self._file, self._file_owner = file, Owner("scene_file_free", file)
        self._store = ctypes.c_void_p()
        call("shape_store_create", self._store)
        self._store_owner = Owner("shape_store_free", self._store)
        if shapes:
            self._pour(shapes)
        fields = dict(fields)
        for field in sorted(fields, key="preset".__ne__):  # what else is given stands over the preset
            call("scene_file_set", file, field.encode(), _yaml(fields[field]).encode())
        handle = ctypes.c_void_p()
        call("scene_create_from", file, self._store, None, handle)
        self._take(handle)

    def _pour(self, shapes):
        rows = (c.scree_poured * len(shapes))()
        for row, (name, shape) in zip(rows, shapes.items()):
            if not 0 < len(name) <= 64 or set(name) & set(".*"):
                raise ValueError(f"a shape is named '{name}': 1 to 64 letters, no point and no star")
            shape, share = shape if isinstance(shape, tuple) else (shape, 1)
            particle = shape if isinstance(shape, Particle) else Particle(shape)
            row.name, row.kind, row.value, row.share = name.encode(), b"file", name.encode(), share
            call("shape_store_give", self._store, name.encode(), particle._handle)
        call("scene_file_pour", self._file, rows, len(rows))

    def _take(self, handle):
        self._handle = handle
        self._owner = Owner("scene_free", handle)
        self._hooks = []
        self.world = World._within(lib["scene_world"](handle), self._owner)
        self.columns = _names("scene_column_name", handle)
        return self

    @classmethod
    def load(cls, path):
        """From a checkpoint of save(), or of `scree run`; goes on with the same bits. Or from a frame, which can be
        measured, and not gone on with."""
        handle = ctypes.c_void_p()
        call("scene_load", os.fsencode(path), handle)
        self = cls.__new__(cls)
        self._file = self._store = None
        return self._take(handle)

    def save(self, path, overwrite=False):
        call("scene_save", self._handle, os.fsencode(path), overwrite)

    def complete(self, folder=None, resume=False, overwrite=False, progress=None):
        """Runs the scene from its beginning to its end as `scree run -o` does; this is then how it stands. The folder gets
        checkpoint.scree, series.csv, motion.scree, last.scree, and at the end scene.yaml and result.json, of which
        report() makes a page. With resume it goes on from the checkpoint in the folder, where there is one.
        progress(phase, fraction) cancels by returning False: the checkpoint is written, and Error has the status
        CANCELLED."""
        if self._file is None:
            raise ValueError("a scene from a checkpoint has no beginning: run() goes on with it")
        problems = []

        def watch(_context, state):
            try:
                now = state.contents
                phase = (lib["scene_phase"](now.scene) or b"scene").decode()
                return progress is None or progress(phase, now.fraction) is not False
            except BaseException as problem:  # must not pass through C
                problems.append(problem)
                return False

        job = c.scree_scene_job(file=self._file, folder=os.fsencode(folder) if folder is not None else None, resume=resume,
                                overwrite=overwrite, states=True, store=self._store, watch=c.WATCH(watch))
        handle = ctypes.c_void_p()
        try:
            call("scene_complete", job, handle)
        except c.Error:
            if problems:
                raise problems[0] from None
            raise
        finally:
            if handle:
                self._take(handle)
        if folder is not None:
            with open(os.path.join(os.fsdecode(folder), "scene.yaml"), "w", encoding="utf-8") as text:
                text.write(str(self))
            self.write_json(os.path.join(os.fsdecode(folder), "result.json"), overwrite=True)
        return self

    def write_json(self, path, overwrite=False):
        """Why it ended, what it cost, piles, shapes and every column (docs/reference/formats.md): with this as result.json
        and its text as scene.yaml in its folder, `report` shows the scene."""
        entry = c.scree_scene_entry(scene=self._handle, seconds=self.costs().wall_seconds)
        call("scene_json_write", entry, os.fsencode(path), overwrite)

    def costs(self):
        """body_steps, wall_seconds, processor_seconds, piece_count, of all pieces between interruptions."""
        return from_struct(lib["scene_get_costs"](self._handle))

    def piles(self, **settings):
        """The piles of its sensors as they stand, by name: repose (angles in degrees, NaN where there is none),
        body_count, packing_fraction, size. settings: cell, sectors, band_low, band_high, for the scene's own."""
        found = {}
        for i, name in enumerate(_names("scene_pile_name", self._handle)):
            pile, how = c.scree_pile(), set_fields(lib["scene_pile_settings"](self._handle, i), settings, "a pile")
            call("scene_measure_pile", self._handle, i, how, pile)
            found[name] = from_struct(pile)
        return found

    end = property(lambda self: (lib["scene_end"](self._handle) or b"").decode() or None,
                   doc="Why it has ended, such as \"the time is over\"; None: it has not.")
    phase = property(lambda self: (lib["scene_phase"](self._handle) or b"").decode() or None, doc="None: it has none now.")
    is_frame = property(lambda self: lib["scene_is_frame"](self._handle))
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
