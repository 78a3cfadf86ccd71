"""The angle-of-repose experiment: its settings, runs, and their results."""
import ctypes
import os
import pathlib
import weakref

from . import _library as c
from ._library import call, lib
from ._values import column, from_struct, table
from ._world import Owner, Particle, World


class Experiment:
    """Settings of the experiment: a preset (demo, small or paper), over it a YAML file as `scree repose
    --print` writes it, over that single fields by their keys in the file:

        Experiment("small", {"particles": 100, "cylinder.diameter": 0.25})
        e["contact.friction_particle"] = 0.4"""

    def __init__(self, preset="demo", fields=(), path=None):
        self._struct = c.scree_experiment()
        call("experiment_preset", preset.encode(), self._struct)
        weakref.finalize(self, lib["experiment_free"], self._struct)
        if path is not None:
            call("experiment_read", os.fsencode(path), self._struct)
        for key, value in dict(fields).items():
            self[key] = value

    def keys(self):
        found = []
        while lib["experiment_key"](len(found)) is not None:
            found.append(lib["experiment_key"](len(found)).decode())
        return found

    def __getitem__(self, key):
        text = ctypes.create_string_buffer(64)
        if not lib["experiment_get"](self._struct, key.encode(), text, len(text)):
            raise KeyError(key)
        word = text.value.decode()
        if word in ("true", "false"):
            return word == "true"
        try:
            return int(word)
        except ValueError:
            pass
        try:
            return float(word)
        except ValueError:
            return word

    def __setitem__(self, key, value):
        text = str(value).lower() if isinstance(value, bool) else str(value)
        call("experiment_set", self._struct, key.encode(), text.encode())


class Run:
    """A run of the experiment: as repose() leaves it, or as it stands in a checkpoint or frame."""

    def __init__(self, path):
        handle = ctypes.c_void_p()
        call("run_load", os.fsencode(path), handle)
        self._take(handle)

    def _take(self, handle):
        self._handle = handle
        self._owner = Owner("run_free", handle)
        self.world = World._within(lib["run_world"](handle), self._owner)
        return self

    is_frame = property(lambda self: lib["run_is_frame"](self._handle))
    phase = property(lambda self: lib["phase_name"](lib["run_phase"](self._handle)).decode())

    def measure(self):
        """The heap: repose (angles in degrees, NaN where there is none), packing_fraction, coordination, ..."""
        result = c.scree_run_result()
        call("run_measure", self._handle, result)
        return from_struct(result)

    def series(self):
        """The state over time, a point each: time, kinetic, mean_rotation, ..."""
        count = ctypes.c_size_t()
        points = lib["run_series"](self._handle, count)
        found = [from_struct(points[i]) for i in range(count.value)]
        for point in found:
            point.phase = lib["phase_name"](point.phase).decode()
        return found

    def costs(self):
        """time_step (s), step_count, particle_steps, wall_seconds, processor_seconds, piece_count,
        largest_overlap (m)."""
        costs = c.scree_run_costs()
        lib["run_get_costs"](self._handle, costs)
        return from_struct(costs)

    def shapes(self):
        """Name and source of each shape; body_shapes() says which body has which."""
        found = []
        for i in range(lib["run_shape_count"](self._handle)):
            shape = c.scree_run_shape()
            lib["run_get_shape"](self._handle, i, shape)
            found.append(tuple((text or b"").decode(errors="replace") for text in (shape.name, shape.source)))
        return found

    def body_shapes(self):
        """The number of the shape of every body."""
        return column([lib["run_body_shape"](self._handle, i) for i in range(len(self.world))])

    def write_json(self, path, overwrite=False):
        """Result, experiment, shapes, costs and series (docs/reference/formats.md): with this as result.json in its folder,
        `report` shows the run."""
        result = c.scree_run_result()
        call("run_measure", self._handle, result)
        entry = c.scree_heap_entry(run=self._handle, result=ctypes.pointer(result))
        call("heap_json_write", entry, os.fsencode(path), overwrite)


class Motion:
    """Where every body of a run was: `time` (s) and `cylinder_height` (m) of each frame; `poses`, frames x bodies x 7
    values: position (m) and quaternion w x y z, NaN where a body is not in. path: motion.scree, or the run's
    folder."""

    def __init__(self, path):
        path = pathlib.Path(path)
        self._struct = c.scree_motion()
        call("motion_read", os.fsencode(path / "motion.scree" if path.is_dir() else path), self._struct)
        weakref.finalize(self, lib["motion_free"], self._struct)
        frames, bodies = self._struct.frame_count, self._struct.body_count
        self.body_count = bodies
        self.time = column(self._struct.time[:frames])
        self.cylinder_height = column(self._struct.cylinder_height[:frames])
        flat = table(self._struct.poses, frames * bodies, 7, self)
        if hasattr(flat, "reshape"):
            self.poses = flat.reshape(frames, bodies, 7)
        else:
            rows = flat.tolist()
            self.poses = [rows[f * bodies:(f + 1) * bodies] for f in range(frames)]

    def __len__(self):
        return self._struct.frame_count


def repose(shapes, experiment=None, folder=None, resume=False, overwrite=False, progress=None):
    """Pours the shapes into a heap and waits for its end; a Run. shapes: closed Meshes or Particles, of a dictionary
    by name or as a list; they are mixed in equal shares. experiment: an Experiment; None: the preset demo. folder gets
    checkpoint.scree, last.scree and motion.scree; with resume the run goes on from the checkpoint in it.
    progress(phase, fraction) cancels by returning False: the checkpoint is written, and Error has the status
    CANCELLED."""
    named = dict(shapes) if hasattr(shapes, "items") else {f"shape-{i}": shape for i, shape in enumerate(shapes)}
    particles = [shape if isinstance(shape, Particle) else Particle(shape) for shape in named.values()]
    rows = (c.scree_run_shape * max(1, len(particles)))()
    for row, name, particle in zip(rows, named, particles):
        row.particle, row.density_factor, row.name = particle._handle, 1, str(name).encode()
    experiment = experiment or Experiment()
    call("experiment_check", experiment._struct)
    problems = []

    def watch(_context, state):
        try:
            now = state.contents
            return progress is None or progress(lib["phase_name"](now.now.phase).decode(), now.fraction) is not False
        except BaseException as problem:  # must not pass through C
            problems.append(problem)
            return False

    job = c.scree_run_job(experiment=ctypes.pointer(experiment._struct), shapes=rows, shape_count=len(particles),
                          folder=os.fsencode(folder) if folder is not None else None, motion=True, resume=resume,
                          overwrite=overwrite, watch=c.WATCH(watch))
    handle = ctypes.c_void_p()
    try:
        call("run_complete", job, handle)
    except c.Error:
        if problems:
            raise problems[0] from None
        raise
    return Run.__new__(Run)._take(handle)


def report(folders, path, overwrite=False):
    """One page for the browser of folders with results (`scree report`)."""
    folders = [folders] if isinstance(folders, (str, os.PathLike)) else list(folders)
    names = (ctypes.c_char_p * max(1, len(folders)))(*[os.fsencode(f) for f in folders])
    call("page_write", names, len(folders), os.fsencode(path), overwrite)
