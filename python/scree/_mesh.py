"""Meshes: from files and samples, measured, compared, decimated, written."""
from __future__ import annotations

import ctypes
import math
import os
from typing import Any, Callable, Optional

from . import _picture
from ._library import lib
from ._values import Record, c_array, column, index_of, metres, record, table

Progress = Optional[Callable[[str, float], Optional[bool]]]
CHOICES = ("recommended", "paper", "robust", "plain", "smooth", "cost")


class Shared:
    """What is not to be changed: copies have the same C object, which lives as long as one of them."""

    @classmethod
    def _of(cls, c):
        made = cls.__new__(cls)
        made._c = c
        return made

    def __copy__(self):
        twin = type(self).__new__(type(self))
        twin.__dict__.update(self.__dict__)
        return twin

    def __deepcopy__(self, memo):
        return self.__copy__()


class Mesh(Shared):
    """An indexed triangle mesh in metres, not to be changed. `source` says where it came from."""

    source: str | None = None
    format: str | None = None
    warning: str = ""
    checksum: Record = Record(high=0, low=0)

    def __init__(self, positions: Any = None, triangles: Any = None, *, weld: bool = False) -> None:
        """Of rows of three coordinates and rows of three vertex indices. weld unites equal positions and puts
        everything in scree's canonical order."""
        kind = lib.type("mesh")
        if positions is None:
            self._c = kind()
            return
        points, point_count = c_array(ctypes.c_double, positions, 3)
        corners, count = c_array(ctypes.c_uint32, triangles, 3)
        if any(corner >= point_count for corner in corners[:3 * count]):
            raise ValueError(f"a triangle names a vertex beyond the {point_count} given")
        broken = next((k for k, x in enumerate(points) if not math.isfinite(x)), None)
        if broken is not None:
            raise ValueError(f"vertex {broken // 3} has a coordinate that is not finite: {points[broken]}")
        if weld:
            loose = (ctypes.c_double * (9 * count))()
            for k, corner in enumerate(corners[:3 * count]):
                loose[3 * k:3 * k + 3] = points[3 * corner:3 * corner + 3]
            self._c = lib.mesh_weld(loose, count, 0.0)[0]
        else:
            self._c = lib.mesh_copy(kind(points, corners, point_count, count))

    @classmethod
    def _of(cls, c, source=None):
        mesh = super()._of(c)
        mesh.source = source
        return mesh

    def __reduce__(self) -> tuple:
        """By its arrays."""
        c, facts = self._c, {name: value for name, value in vars(self).items() if name != "_c"}
        return _mesh_again, (ctypes.string_at(c.positions, 24 * c.vertex_count),
                             ctypes.string_at(c.triangles, 12 * c.triangle_count), facts)

    def as_wall(self) -> tuple[Mesh, Record]:
        """Any facets as a wall for World.add_wall, and what was mended: welded, split where an edge ran past a vertex,
        without facets that have no area or lie on others, parted where three facets meet, wound one way."""
        made, mending = lib.wall_mend(self)
        return Mesh._of(made, self.source), record(mending)

    @property
    def vertex_count(self) -> int:
        return self._c.vertex_count

    @property
    def triangle_count(self) -> int:
        return self._c.triangle_count

    @property
    def positions(self) -> Any:
        """vertex_count x 3, m; not copied."""
        return table(self._c.positions, self.vertex_count, 3, self._c)

    @property
    def triangles(self) -> Any:
        """triangle_count x 3 vertex indices, counter-clockwise from outside; not copied."""
        return table(self._c.triangles, self.triangle_count, 3, self._c)

    def __repr__(self) -> str:
        return f"<scree.Mesh of {self.triangle_count} triangles from {self.source or 'memory'}>"

    def _repr_html_(self) -> str:
        return _picture.html(self, lambda options: lib.render(*_picture.scene_of((self, None)), options, None),
                             Record(triangles=self.triangle_count, vertices=self.vertex_count))

    def write(self, path: str | os.PathLike, unit: str | float = "mm", overwrite: bool = False,
              comment: str | None = None) -> None:
        """STL, PLY, OBJ, OFF or 3MF by the path's ending."""
        lib.mesh_write(self, path, {"unit_m": metres(unit), "overwrite": overwrite, "comment": comment})

    def write_vtp(self, path: str | os.PathLike, reference: Mesh | None = None, overwrite: bool = False) -> None:
        """For ParaView, with the areas of the triangles and, where a reference mesh is given, the distance to it."""
        lib.mesh_vtp_write(self, reference, path, overwrite)

    def export(self, path: str | os.PathLike, json_path: str | os.PathLike | None = None, *, unit: str | float = "mm",
               **options: Any) -> Record:
        """For a DEM code: options density (kg/m3), centre, principal, overwrite. Answers rotation, translation,
        mass, inertia, bounding_radius and measures of what was written; json_path gets them too."""
        facts = {"unit_m": metres(unit), "source": self.source, "checksum": vars(self.checksum)}
        return record(lib.particle_export(self, {**options, **facts}, path, json_path))

    def measure(self) -> Record:
        """Area, volume, centroid, inertia and so on, SI: the fields of scree_measures."""
        return record(lib.mesh_measure(self))

    def topology(self) -> Record:
        """Counts of edges, shells, defects; closed, manifold, oriented: the fields of scree_topology."""
        return record(lib.mesh_topology(self))

    def check(self, progress: Progress = None, **options: Any) -> Record:
        """Whether it can serve as a particle: usable, verdict, defects by name, volume. Option intersections: False
        skips the exact test, which takes most of the time."""
        return _check(lib.mesh_check(self, options, progress))

    def repair(self, progress: Progress = None, **options: Any) -> tuple[Mesh, Record]:
        """A repaired mesh, and what was done: done by name, before, after. Options seam_tolerance, hole_edges,
        fill_large_holes, debris_share, drop_cavities, keep_largest, cut_intersections, merge_shells (shells that cross,
        overlap or touch become one), merge_folds, intersections, cavity_share, volume_change: scree_repair_options in scree/check.h."""
        repaired, report = lib.mesh_repair(self, options, progress)
        told = record(report)
        told.before, told.after = _check(report.before), _check(report.after)
        told.done = {lib.repair_action_name(i): n for i, n in enumerate(report.done)}
        return Mesh._of(repaired, self.source), told

    def distance(self, other: Mesh, progress: Progress = None, **options: Any) -> Record:
        """Mean, RMS and Hausdorff distance to another mesh and back; options sample_count, hausdorff_gap, one_way."""
        return record(lib.mesh_distance(self, other, options, progress))

    def distance_field(self, reference: Mesh) -> Any:
        """The distance of every vertex from the reference's surface, m."""
        values = (ctypes.c_double * max(1, self.vertex_count))()
        lib.mesh_distance_field(self, reference, values)
        return column(values[:self.vertex_count])

    def curve(self, method: str = "volume", progress: Progress = None, **options: Any) -> Curve:
        """Decimates through every count; options stop_count, error_limit."""
        return Curve(self, method, progress, **options)

    def simplify(self, count: int | None = None, rp: float | None = None, method: str = "volume",
                 progress: Progress = None) -> Mesh:
        """The first level with at most `count` triangles, or rp times the mesh's."""
        if (count is None) == (rp is None):
            raise TypeError("simplify needs a count or an rp")
        if rp is not None and not 0 < rp <= 1:
            raise ValueError(f"rp is {rp}; above 0, at most 1")
        target = count if rp is None else lib.choice_target(rp, self.triangle_count)
        curve = Curve(self, method, progress, stop_count=target)
        return curve.mesh(curve.find(target))

    def choose(self, method: str = "volume", progress: Progress = None, **options: Any) -> Choice:
        """The triangle count to use: a Choice, whose mesh() is the simplified mesh. The mesh is taken as it is: repair() first
        what check() does not call usable, as the program does."""
        return Curve(self, method, progress).choose(progress, **options)


def _mesh_again(positions, triangles, facts):
    points = (ctypes.c_double * (len(positions) // 8)).from_buffer_copy(positions)
    corners = (ctypes.c_uint32 * (len(triangles) // 4)).from_buffer_copy(triangles)
    mesh = Mesh._of(lib.mesh_copy(lib.type("mesh")(points, corners, len(points) // 3, len(corners) // 3)))
    vars(mesh).update(facts)
    return mesh


def _check(struct):
    check = record(struct)
    check.defects = {lib.defect_name(i): n if lib.defect_is_counted(struct, i) else None
                     for i, n in enumerate(struct.defects)}
    check.volume = struct.volume if struct.volume_known else None
    return check


class Curve(Shared):
    """The record of one decimation; level 0 is the mesh, level i the mesh after i collapses. It is not pickled."""

    def __init__(self, mesh: Mesh, method: str = "volume", progress: Progress = None, **options: Any) -> None:
        self.source_mesh, self._c = mesh, lib.curve_build(mesh, {"method": method, **options}, progress)
        self._c.borrowed = mesh._c  # the record's mesh; it goes after the record

    def __reduce__(self):
        raise TypeError("a Curve is not pickled: pickle its source_mesh and decimate again, or pickle meshes of its levels")

    @property
    def facts(self) -> Record:
        return record(lib.curve_get_facts(self))

    def __len__(self) -> int:
        return lib.curve_level_count(self)

    def __getitem__(self, index: int) -> Record:
        """triangle_count, rp, area, volume, quadric_error of a level."""
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"level {index} of {count}")
        return record(lib.curve_level(self, index % count))

    def find(self, target: int) -> int:
        """The index of the first level with at most `target` triangles, or the last."""
        return lib.curve_find(self, target)

    def mesh(self, index: int, fit: bool = False) -> Mesh:
        """The level's mesh; with fit its vertices move to where the surface is nearer to the scan."""
        if not 0 <= index < len(self):
            raise IndexError(f"level {index} of {len(self)}")
        return Mesh._of((lib.curve_fit if fit else lib.curve_mesh)(self, index), self.source_mesh.source)

    def choose(self, progress: Progress = None, reference: str = "scan", tolerances: dict[str, float] | None = None,
               **options: Any) -> Choice:
        """Options weight, rp_min, rp_max, per_decade, area_only; tolerances by name as shares, such as {"widths": 0.02}."""
        return Choice(self, progress, reference, tolerances, **options)


class Choice(Shared, Record):
    """recommended, paper, robust, plain, smooth and cost, each with rp, triangle_count, level_index, eps_s, ip, and fewest and
    most triangles with an ip within a tenth of it; errors of the recommended level by name, shares, and limited_by, the one
    that decides; levels (the grid) and trace (the dense curve) as lists; noise; best, the grid level of the least error by
    name. It is pickled without its curve, but with the mesh of the recommended level."""

    def __init__(self, curve: Curve, progress: Progress = None, reference: str = "scan",
                 tolerances: dict[str, float] | None = None, **options: Any) -> None:
        settings = lib.filled("scree_choice_options", {"reference": reference, **options})
        names = [lib.shape_error_name(i) for i in range(len(settings.tolerances))]
        for name, share in (tolerances or {}).items():
            settings.tolerances[index_of(name, names, "tolerance")] = share
        choice = lib.choose(curve, curve.source_mesh, settings, progress)
        super().__init__(**vars(record(choice)))
        self.levels = [_level(choice.levels[i], names) for i in range(choice.level_count)]
        self.trace = [_level(choice.trace[i], names) for i in range(choice.trace_count)]
        self.best = {name: i for name, i in zip(names, choice.best) if i < choice.level_count}
        self.errors = {}
        if choice.fidelity:
            self.errors = {name: lib.fidelity_error(choice.fidelity, choice.recommended_row, i)
                           for i, name in enumerate(names)}
            self.limited_by = names[choice.limited_by.value]
        del self.recommended_row
        self.curve = curve

    def mesh(self, which: str = "recommended") -> Mesh:
        """The mesh of one of the choices."""
        index_of(which, CHOICES, "choice")
        if self.curve is None and which == "recommended":
            return self._recommended
        if self.curve is None:
            raise ValueError(f"the mesh '{which}' is not there: a choice is pickled with the recommended one alone")
        return self.curve.mesh(getattr(self, which).level_index)

    def __reduce__(self) -> tuple:
        return _choice_again, ({**vars(self), "curve": None, "_recommended": self.mesh()},)

    def __repr__(self) -> str:
        return f"<scree.Choice of {self.recommended.triangle_count} of {self.triangle_count} triangles>"

    def _repr_html_(self) -> str:
        def draw(options):
            level = self.mesh()
            return lib.render(*_picture.scene_of((self.curve.source_mesh, "scan"), (level, f"{level.triangle_count} triangles")),
                              options, None)

        return _picture.html(self, draw, Record(triangles=self.recommended.triangle_count, rp=self.recommended.rp,
                                                limited_by=self.limited_by, **self.errors))


def _choice_again(facts):
    choice = Choice.__new__(Choice)
    vars(choice).update(facts)
    return choice


def _level(struct, names):
    level = record(struct)
    level.errors = dict(zip(names, struct.errors))
    return level


def load(path: str | os.PathLike, unit: str | float | None = None, weld: float = 0.0, **sample_options: Any) -> Mesh:
    """Reads STL, PLY, OBJ, OFF (3MF, glTF); or makes a built-in sample by "sample:NAME". Without a unit it is the
    one that the file states, as files of scree do, else mm. The mesh carries source, format and checksum of what
    was read, and warning: in what the file contradicts itself, "" in nothing."""
    path = os.fspath(path)
    if isinstance(path, str) and path.startswith("sample:"):
        return sample(path[len("sample:"):], **sample_options)
    if sample_options:
        raise TypeError(f"{', '.join(sample_options)}: options of samples only; of a file unit and weld are")
    scan = lib.scan_read(path, {"unit_m": metres(unit or "mm"), "weld_tolerance": weld, "ignore_comment_unit": unit is not None})
    mesh, facts = Mesh._of(scan.mesh, os.fsdecode(path)), record(scan)
    mesh.format, mesh.warning, mesh.checksum = facts.format, facts.warning, facts.checksum
    return mesh


def sample(name: str, progress: Progress = None, **options: Any) -> Mesh:
    """A built-in sample; options resolution and noise in metres, seed."""
    made = Mesh._of(lib.sample_make(name, options, progress), "sample:" + name)
    made.format = "sample"
    return made


def samples() -> dict[str, str]:
    """Names and descriptions of the built-in samples."""
    return {name: lib.sample_description(i) for i, name in enumerate(lib.names("sample_name"))}
