"""Scenes: the user's own equipment, from one YAML file."""
from __future__ import annotations

import ctypes
import math
import os
import pathlib
from typing import Any, Callable, Mapping

from . import _picture
from ._library import Callback, Error, lib
from ._mesh import Progress, Shared
from ._saved import Saved
from ._values import Record, column, record, set_fields, table, text_of
from ._world import Particle, World, of_each


class Scene(Saved):
    """What a scene's file describes (docs/reference/scenes.md), as `scree run` runs it:

        scene = scree.Scene("drum.yaml", {"geometry.shell.motion.0.rotate.speed": 3})
        scene.run(2)                        # up to 2 s of simulated time; without a time to its end
        scene.sensors["torque.power"]       # every number that is followed, now
        scene.bodies().position             # an array, a row a body

    fields: any fields and parameters of the file and their values. `world` is the World, to look at and to push bodies
    in. Threads, copies and pickles: as of World; hooks of every() go along."""

    def __init__(self, path: str | os.PathLike, fields: Mapping[str, Any] = {}) -> None:
        self._make(lib.scene_file_read(path), fields)

    @classmethod
    def template(cls, name: str, shapes: Mapping[str, Any] = {}, fields: Mapping[str, Any] = {}) -> Scene:
        """A template with shapes and fields of your own:

            scene = Scene.template("repose", {"phone": mesh, "ball": Particle.sphere(0.02)}, {"preset": "small"})

        name: one of templates(). shapes: by name a closed Mesh or a Particle, or one with its share by number, as
        (mesh, 2); those of the template where there are none. fields: as of a scene; a preset goes first."""
        made = cls.__new__(cls)
        made._make(lib.scene_file_template(name), fields, {str(key): shape for key, shape in dict(shapes).items()})
        return made

    @staticmethod
    def templates() -> dict[str, str]:
        """The templates, by name: their text, to start a file from."""
        return {name: lib.scene_template(name) for name in lib.names("scene_template_name")}

    def _make(self, file, fields, shapes={}):
        self._file, self._store = file, lib.shape_store_create()
        if shapes:
            self._pour(shapes)
        fields = dict(fields)
        for field in sorted(fields, key="preset".__ne__):  # what else is given stands over the preset
            lib.scene_file_set(file, field, _yaml(fields[field]))
        self._take(lib.scene_create_from(file, self._store, None))

    def _pour(self, shapes):
        rows = (lib.type("poured") * len(shapes))()
        for row, (name, shape) in zip(rows, shapes.items()):
            if not 0 < len(name) <= 64 or set(name) & set(".*"):
                raise ValueError(f"a shape is named '{name}': 1 to 64 letters, no point and no star")
            shape, share = shape if isinstance(shape, tuple) else (shape, 1)
            set_fields(row, {"name": name, "kind": "file", "value": name, "share": share}, "a shape")
            lib.shape_store_give(self._store, name, shape if isinstance(shape, Particle) else Particle(shape))
        lib.scene_file_pour(self._file, rows, len(rows))

    def _take(self, c):
        self._c, self._hooks = c, []
        self.world = World._within(lib.scene_world(c), c)
        self.columns = lib.names("scene_column_name", c)
        return self

    @classmethod
    def load(cls, path: str | os.PathLike) -> Scene:
        """From a checkpoint of save(), or of `scree run`; goes on with the same bits. Or from a frame, which can be
        measured, and not gone on with."""
        made = cls.__new__(cls)
        made._file = made._store = None
        return made._take(lib.scene_load(path))

    def save(self, path: str | os.PathLike, overwrite: bool = True) -> None:
        lib.scene_save(self, path, overwrite)

    def __reduce__(self) -> tuple:
        return (*super().__reduce__(), {"_hooks": [list(hook) for hook in self._hooks]})

    def complete(self, folder: str | os.PathLike | None = None, resume: bool = False, overwrite: bool = True,
                 progress: Progress = None) -> Scene:
        """Runs the scene from its beginning to its end as `scree run -o` does; this is then how it stands. The folder gets
        checkpoint.scree, series.csv, motion.scree, last.scree, and at the end scene.yaml and result.json, of which
        report() makes a page. With resume it goes on from the checkpoint in the folder, where there is one.
        progress(phase, fraction) cancels by returning False: the checkpoint is written, and Error has the status
        CANCELLED."""
        if self._file is None:
            raise ValueError("a scene from a checkpoint has no beginning: run() goes on with it")

        def report(_context, state):
            phase = lib.scene_phase(state.contents.scene) or "scene"
            return progress is None or progress(phase, state.contents.fraction) is not False

        watch, room = Callback(report), ctypes.c_void_p()
        job = lib.filled("scree_scene_job", {"resume": resume, "overwrite": overwrite, "states": True, "watch": watch})
        job.file, job.store = self._file.pointer, self._store.pointer
        job.folder = None if folder is None else os.fsencode(folder)
        with self._c.turn.taken(steps=True):
            try:
                lib.scene_complete(job, room)
            except Error:
                watch.raise_problem()
                raise
            finally:
                if room:  # also where it was cancelled
                    self._take(lib.handle("scene", room))
        if folder is not None:
            (pathlib.Path(folder) / "scene.yaml").write_text(str(self), encoding="utf-8")
            self.write_json(pathlib.Path(folder) / "result.json", overwrite=True)
        return self

    def write_json(self, path: str | os.PathLike, overwrite: bool = True) -> None:
        """Why it ended, what it cost, piles, shapes and every column (docs/reference/formats.md): with this as result.json
        and its text as scene.yaml in its folder, `report` shows the scene."""
        entry = lib.type("scene_entry")(scene=self._c.pointer, seconds=self.costs().wall_seconds)
        lib.scene_json_write(entry, path, overwrite)

    def costs(self) -> Record:
        """body_steps, wall_seconds, processor_seconds, piece_count, of all pieces between interruptions."""
        return record(lib.scene_get_costs(self))

    def piles(self, **settings: Any) -> dict[str, Record]:
        """The piles of its sensors as they stand, by name: repose (angles in degrees, NaN where there is none),
        body_count, packing_fraction, size. settings: cell, sectors, band_low, band_high, for the scene's own."""
        return {name: record(lib.scene_measure_pile(self, i, set_fields(lib.scene_pile_settings(self, i), settings, "pile")))
                for i, name in enumerate(lib.names("scene_pile_name", self))}

    def tables(self) -> dict[str, dict[str, Any]]:
        """What its sensors have besides columns, by name, as "stay.histogram": columns of numbers or names by their names."""
        found = {}
        for i, name in enumerate(lib.names("scene_table_name", self)):
            made = lib.scene_make_table(self, i)
            width = made.column_count
            values, texts = ((cells[:made.row_count * width] if cells else []) for cells in (made.values, made.texts))
            found[name] = {text_of(made.names[k]): [text_of(text) for text in texts[k::width]] if any(texts[k::width])
                           else column(values[k::width]) for k in range(width)}
        return found

    @property
    def phase(self) -> str | None:
        """None: it has none now."""
        return lib.scene_phase(self)

    @property
    def is_frame(self) -> bool:
        return lib.scene_is_frame(self)

    @property
    def end(self) -> str | None:
        """Why it has ended, such as "the time is over"; None: it has not."""
        return lib.scene_end(self)

    @property
    def time(self) -> float:
        """s"""
        return self.world.time

    @property
    def duration(self) -> float:
        """s: the scene's own time"""
        return lib.scene_duration(self)

    @property
    def shapes(self) -> list[str]:
        """Names."""
        return lib.names("scene_shape_name", self)

    @property
    def geometry(self) -> list[str]:
        """Names."""
        return lib.names("scene_geometry_name", self)

    def geometry_note(self, index: int) -> str | None:
        """What the meshes of a geometry are as walls, and what was mended of them, a line each; None: nothing to tell."""
        names = self.geometry
        if not 0 <= index < len(names):
            raise IndexError(f"geometry {index} of {len(names)}")
        return lib.scene_geometry_note(self, index)

    def every(self, interval: float, function: Callable[[Scene], Any]) -> None:
        """run() calls function(scene) between steps, once every `interval` of simulated time, s; what it raises ends
        run()."""
        if not (math.isfinite(interval) and interval > 0):
            raise ValueError(f"an interval is {interval} s; finite and above 0")
        if not callable(function):
            raise TypeError(f"{function!r} cannot be called")
        self._hooks.append([interval, self.time, function])

    def step(self, count: int = 1) -> None:
        """Advances by at most so many steps; stops where the scene ends."""
        with self._c.turn.taken(steps=True):
            lib.scene_advance(self, count)

    def run(self, until: float = math.inf) -> Scene:
        """Advances to a time, s, or to the scene's end; between steps it calls the hooks of every() that are due."""
        if math.isnan(until):
            raise ValueError(f"until {until} s: a time, or nothing for the scene's end")
        with self._c.turn.taken(steps=True):
            step = self.world.time_step
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
    def sensors(self) -> dict[str, float]:
        """Every number that is followed, by its name, now; NaN where there is none."""
        values = (ctypes.c_double * len(self.columns))()
        lib.scene_measure(self, values)
        return dict(zip(self.columns, values))

    def units(self) -> dict[str, str]:
        """The unit of each column, by its name; "" for a pure number."""
        return dict(zip(self.columns, lib.names("scene_column_unit", self)))

    def series(self) -> dict[str, Any]:
        """All columns over time, a row at every output.series: by name, an array each."""
        with self._c.turn.taken():
            rows, count = lib.scene_series(self)
            width = len(self.columns)
            flat = rows[:count * width] if count else []
        return {name: column(flat[k::width]) for k, name in enumerate(self.columns)}

    def bodies(self) -> Record:
        """Those of World.bodies, of all that ever entered, and shape, the number of its shape."""
        bodies = self.world.bodies()
        bodies.shape = column(of_each(lib.scene_body_shape, self, len(bodies.mass)))
        return bodies

    def book(self) -> Record:
        """What came in, is inside, went out: counts, masses (kg), energies (J); ledger."""
        return record(lib.scene_get_book(self))

    def inlets(self) -> dict[str, Record]:
        """By name: count, mass (kg) and how many wait."""
        return {name: Record(**dict(zip(("count", "mass", "waiting"), lib.scene_inlet_count(self, i))))
                for i, name in enumerate(lib.names("scene_inlet_name", self))}

    def outlets(self) -> dict[str | None, Record]:
        """By name: count and mass (kg); None is the domain's rim."""
        return {name: Record(**dict(zip(("count", "mass"), lib.scene_outlet_count(self, i))))
                for i, name in enumerate([*lib.names("scene_outlet_name", self), None])}

    def __str__(self) -> str:
        return lib.scene_text(self)

    def __repr__(self) -> str:
        return f"<scree.Scene of {len(self.world)} bodies at {self.time:.6g} s>"

    def _repr_html_(self) -> str:
        return _picture.html(self, lambda options: lib.scene_picture(self, options, None), Record(**self.sensors))


class Motion(Shared):
    """Where every wall and body of a scene was: `time` (s) of each frame; `poses`, frames x (walls, then bodies) x 7
    values: position (m) and quaternion w x y z, NaN where a body is not in. path: motion.scree, or its folder."""

    def __init__(self, path: str | os.PathLike) -> None:
        self.path = pathlib.Path(path)
        self._c = lib.motion_read(self.path / "motion.scree" if self.path.is_dir() else self.path)
        frames, self.body_count = self._c.frame_count, self._c.body_count
        self.time = column(self._c.time[:frames])
        flat = table(self._c.poses, frames * self.body_count, 7, self._c)
        if hasattr(flat, "reshape"):
            self.poses = flat.reshape(frames, self.body_count, 7)
        else:
            rows = flat.tolist()
            self.poses = [rows[f * self.body_count:(f + 1) * self.body_count] for f in range(frames)]

    def __len__(self) -> int:
        return self._c.frame_count

    def __reduce__(self) -> tuple:
        """By its path."""
        return Motion, (self.path,)


def _yaml(value):
    """A value as YAML: numbers, texts, lists and dictionaries of these."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_yaml(inner)}" for key, inner in value.items()) + "}"
    if hasattr(value, "tolist"):
        return _yaml(value.tolist())
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_yaml, value)) + "]"
    return str(value)
