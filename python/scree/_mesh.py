"""Meshes: from files and samples, measured, compared, decimated, written."""
from __future__ import annotations

import ctypes
import math
import os
import pathlib
import warnings
from typing import TYPE_CHECKING, Any, Callable, Literal, Optional, overload

from . import _picture
from ._library import lib
from ._records import (Check, Checksum, ChoiceLevel, Clump, CodeWritten, CurveFacts, Descriptors, Distance, Exported, Level, Measures, Noise,
                       Pick, RepairReport, Topology, WallMending)
from ._values import Fields, Record, c_array, column, given, index_of, metres, numpy, record, table

if TYPE_CHECKING:
    from ._world import Particle

Progress = Optional[Callable[[str, float], Optional[bool]]]
Code = Literal["lammps", "liggghts", "yade", "pfc", "chrono", "edem", "mfix", "deme", "rockable", "exadem", "mujoco", "blender"]
CHOICES = ("recommended", "paper", "robust")


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
    checksum: Checksum = Checksum(high=0, low=0)

    def __init__(self, positions: Any = None, triangles: Any = None, *, weld: bool = False) -> None:
        """Of rows of three coordinates and rows of three vertex indices; or of a file or sample, as load() of it. weld unites
        equal positions and puts everything in scree's canonical order."""
        kind = lib.type("mesh")
        if isinstance(positions, (str, os.PathLike)):
            vars(self).update(vars(load(positions)))
            return
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

    def as_wall(self) -> tuple[Mesh, WallMending]:
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

    vertices, faces = positions, triangles

    @property
    def volume(self) -> float:
        """m3; below 0 where the facets are seen from outside."""
        return lib.mesh_area_volume(self)[1]

    @property
    def area(self) -> float:
        """m2."""
        return lib.mesh_area_volume(self)[0]

    @property
    def bounds(self) -> Any:
        """The lowest and the highest x, y, z, m."""
        if numpy:
            return numpy.array([self.positions.min(axis=0), self.positions.max(axis=0)])
        axes = list(zip(*(row for row in self.positions.tolist())))
        return [[min(axis) for axis in axes], [max(axis) for axis in axes]]

    def plot(self, path: str | os.PathLike | None = None, width: int = 800, height: int = 600) -> _picture.Picture:
        """A picture, which a notebook shows; written to a .png where a path is given."""
        return _picture.Picture(lambda options: lib.render(*_picture.scene_of((self, None)), options, None), width, height, path)

    def __repr__(self) -> str:
        return f"<scree.Mesh of {self.triangle_count} triangles from {self.source or 'memory'}>"

    def _repr_html_(self) -> str:
        return _picture.html(self, lambda options: lib.render(*_picture.scene_of((self, None)), options, None),
                             Record(triangles=self.triangle_count, vertices=self.vertex_count))

    def write(self, path: str | os.PathLike, unit: str | float = "mm", overwrite: bool = True,
              comment: str | None = None) -> None:
        """STL, PLY, OBJ, OFF or 3MF by the path's ending."""
        lib.mesh_write(self, path, {"unit_m": metres(unit), "overwrite": overwrite, "comment": comment})

    def write_vtp(self, path: str | os.PathLike, reference: Mesh | None = None, overwrite: bool = True) -> None:
        """For ParaView, with the areas of the triangles and, where a reference mesh is given, the distance to it."""
        lib.mesh_vtp_write(self, reference, path, overwrite)

    @overload
    def export(self, target: Code, second: str | os.PathLike | None = None, *, density: float = 2000,  # type: ignore[misc]
               particles: int = 50, pieces: int = 64, young: float = 0, overwrite: bool = True) -> CodeWritten: ...
    @overload
    def export(self, target: str | os.PathLike, second: str | os.PathLike | None = None, *, unit: str | float = "mm",
               density: float = 2000, centre: bool = False, principal: bool = False, overwrite: bool = True) -> Exported: ...
    def export(self, target: str | os.PathLike, second: str | os.PathLike | None = None, *, unit: str | float = "mm",
               **options: Any) -> Any:
        """For another code, by its name (codes() lists them): files and scripts in the folder `second`, by default
        NAME-CODE. Of those that take clumps alone, export a Particle.clump_of(). `particles` fall in its heap, young is the
        Young's modulus of its scripts, Pa (0: soft), `pieces` the most convex pieces.
        Or into a mesh file, with unit, centre and principal; `second` is a JSON with the same as what is answered: rotation,
        translation, mass, inertia, bounding_radius and measures of what was written."""
        if not pathlib.PurePath(os.fspath(target)).suffix:
            return write_code(lib.particle_from_mesh(self, {}), os.fspath(target), second, self.source, **options)
        facts = {"unit_m": metres(unit), "source": self.source, "checksum": vars(self.checksum)}
        return record(lib.particle_export(self, {"overwrite": True, **options, **facts}, target, second))

    def clumps(self, progress: Progress = None, *, most: int | None = None, method: str | None = None,
               outside: float | None = None, seed: int | None = None) -> Clumps:
        """Clumps of spheres of every count up to `most`, with what each is worth. A mesh of some 2,000 triangles will do."""
        return Clumps(self, progress, **given(most=most, method=method, outside=outside, seed=seed))

    def measure(self) -> Measures:
        """Area, volume, centroid, inertia and so on, SI: the fields of scree_measures."""
        return record(lib.mesh_measure(self))

    def topology(self) -> Topology:
        """Counts of edges, shells, defects; closed, manifold, oriented: the fields of scree_topology."""
        return record(lib.mesh_topology(self))

    def describe(self) -> Descriptors:
        """Elongation, flatness, roundness and so on of a closed mesh: the fields of scree_descriptors."""
        return record(lib.mesh_describe(self, lib.mesh_measure(self)))

    def check(self, progress: Progress = None, *, intersections: bool | None = None) -> Check:
        """Whether it can serve as a particle: usable, verdict, defects by name, volume. intersections=False skips the exact
        test, which takes most of the time."""
        return _check(lib.mesh_check(self, given(intersections=intersections), progress))

    def repair(self, progress: Progress = None, *, seam_tolerance: float | None = None, hole_share: float | None = None,
               flat_holes: bool | None = None, debris_share: float | None = None, drop_cavities: bool | None = None,
               keep_largest: bool | None = None, cut_intersections: bool | None = None, merge_shells: bool | None = None,
               merge_folds: bool | None = None, intersections: bool | None = None, cavity_share: float | None = None,
               volume_change: float | None = None, **more: Any) -> tuple[Mesh, RepairReport]:
        """A repaired mesh, and what was done: done by name, before, after. merge_shells: shells that cross, overlap or touch
        become one. All options are told at scree_repair_options in scree/check.h."""
        options = given(seam_tolerance=seam_tolerance, hole_share=hole_share, flat_holes=flat_holes,
                        debris_share=debris_share, drop_cavities=drop_cavities, keep_largest=keep_largest,
                        cut_intersections=cut_intersections, merge_shells=merge_shells, merge_folds=merge_folds,
                        intersections=intersections, cavity_share=cavity_share, volume_change=volume_change)
        repaired, report = lib.mesh_repair(self, {**options, **more}, progress)
        told = record(report)
        told.before, told.after = _check(report.before), _check(report.after)
        told.done = {lib.repair_action_name(i): n for i, n in enumerate(report.done)}
        return Mesh._of(repaired, self.source), told

    def fracture(self, cells: int = 60, progress: Progress = None, **options: Any) -> tuple[list[Mesh], list[Record]]:
        """Pieces that fill a closed mesh, and the faces where two meet (for World.add_joint): a, b, centre, normal, axis, area,
        second_moments, reach, distance. Options seed, rounds, near, near_distance, grain, grain_stretch, least_volume."""
        made = lib.mesh_fracture(self, {"cell_count": cells, **options}, progress)
        return ([Mesh._of(lib.mesh_copy(made.pieces[i]), self.source) for i in range(made.piece_count)],
                [record(made.faces[i]) for i in range(made.face_count)])

    def thicken(self, thickness: float) -> Mesh:
        """An open surface as a sheet so many metres thick, half to each side."""
        return Mesh._of(lib.mesh_thicken(self, thickness), self.source)

    def distance(self, other: Mesh, progress: Progress = None, *, sample_count: int | None = None,
                 hausdorff_gap: float | None = None, one_way: bool | None = None) -> Distance:
        """Mean, RMS and Hausdorff distance to another mesh and back."""
        options = given(sample_count=sample_count, hausdorff_gap=hausdorff_gap, one_way=one_way)
        return record(lib.mesh_distance(self, other, options, progress))

    def distance_field(self, reference: Mesh) -> Any:
        """The distance of every vertex from the reference's surface, m."""
        values = (ctypes.c_double * max(1, self.vertex_count))()
        lib.mesh_distance_field(self, reference, values)
        return column(values[:self.vertex_count])

    def distance_grid(self, cells: int = 64, margin: float = 0.1) -> Grid:
        """Signed distances, negative inside, of a closed mesh on a grid with so many cells along its longest side and a rim of
        `margin` of that. Needs numpy."""
        if numpy is None:
            raise RuntimeError("distance_grid needs numpy")
        low, high = self.bounds
        step = float((high - low).max() / cells)
        origin = low - margin * cells * step
        shape = tuple(int(n) + 1 for n in numpy.ceil((high - low + 2 * margin * cells * step) / step))
        surface = lib.surface_create(self)

        def at(offset, counts):
            points = numpy.stack(numpy.meshgrid(*(o + step * (numpy.arange(n) + offset) for o, n in zip(origin, counts)),
                                                indexing="ij"), axis=-1).reshape(-1, 3)
            block, count = c_array(ctypes.c_double, points, 3)
            values = (ctypes.c_double * count)()
            lib.surface_signed_distances(surface, block, count, values)
            return numpy.frombuffer(values).reshape(counts).copy()

        distances = at(0, shape)
        middles = at(0.5, tuple(n - 1 for n in shape))
        mean = sum(distances[i:n or None, j:m or None, k:o or None] for i, n in ((0, -1), (1, 0)) for j, m in ((0, -1), (1, 0))
                   for k, o in ((0, -1), (1, 0))) / 8
        near = abs(middles) < 2 * step
        return Grid(distances=distances, origin=origin, spacing=step, error=float(abs(mean - middles)[near].max()),
                    mean_error=float(abs(mean - middles)[near].mean()))

    def curve(self, method: str = "volume", progress: Progress = None, *, stop_count: int | None = None,
              error_limit: float | None = None) -> Curve:
        """Decimates through every count, or down to stop_count or error_limit."""
        return Curve(self, method, progress, **given(stop_count=stop_count, error_limit=error_limit))

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

    def choose(self, method: str = "volume", progress: Progress = None, *, reference: str | None = None,
               tolerances: dict[str, float] | None = None, weight: float | None = None, rp_min: float | None = None,
               rp_max: float | None = None, per_decade: int | None = None, area_only: bool | None = None,
               fine_errors: bool | None = None) -> Choice:
        """The triangle count to use: a Choice, whose mesh() is the simplified mesh. The mesh is taken as it is: repair() first
        what check() does not call usable, as the program does. Tolerances are shares by name, as {"widths": 0.02, "mean": 0.002}."""
        return Curve(self, method, progress).choose(
            progress, tolerances=tolerances,
            **given(reference=reference, weight=weight, rp_min=rp_min, rp_max=rp_max, per_decade=per_decade, area_only=area_only,
                    fine_errors=fine_errors))


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
    def facts(self) -> CurveFacts:
        return record(lib.curve_get_facts(self))

    def __len__(self) -> int:
        return lib.curve_level_count(self)

    def __getitem__(self, index: int) -> Level:
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

    def choose(self, progress: Progress = None, reference: str | None = None,
               tolerances: dict[str, float] | None = None, weight: float | None = None, rp_min: float | None = None,
               rp_max: float | None = None, per_decade: int | None = None, area_only: bool | None = None,
               fine_errors: bool | None = None) -> Choice:
        """As Mesh.choose."""
        return Choice(self, progress, reference or "scan", tolerances,
                      **given(weight=weight, rp_min=rp_min, rp_max=rp_max, per_decade=per_decade, area_only=area_only,
                              fine_errors=fine_errors))


class Choice(Shared, Fields):
    """answer, the sentence; recommended, paper and robust, each with rp, triangle_count, level_index, eps_s, ip (Ip = eps_s +
    Nr/Nm), and fewest and most triangles with an ip within a tenth of it; errors of the recommended level by name, shares,
    limited_by, the one that decides, and largest_over_tolerance; levels (the grid) and trace (the dense curve) as lists; noise;
    best, the grid level of the least error by name. It is pickled without its curve, but with the mesh of the recommended level."""

    answer: str
    recommended: Pick
    paper: Pick
    robust: Pick
    triangle_count: int
    area: float
    volume: float
    errors: dict[str, float]
    limited_by: str
    largest_over_tolerance: float
    levels: list[ChoiceLevel]
    trace: list[ChoiceLevel]
    noise: Noise
    best: dict[str, int]
    order: str
    curve: Curve | None
    _recommended: Mesh

    def __init__(self, curve: Curve, progress: Progress = None, reference: str = "scan",
                 tolerances: dict[str, float] | None = None, **options: Any) -> None:
        settings = lib.filled("scree_choice_options", {"reference": reference, **options})
        names = [lib.shape_error_name(i) for i in range(len(settings.tolerances))]
        for name, share in (tolerances or {}).items():
            short = "mean" if name == "mean_distance" else name
            settings.tolerances[index_of(short, ["mean" if n == "mean_distance" else n for n in names], "tolerance")] = share
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
        del self.recommended_row  # type: ignore[attr-defined]
        self.answer = lib.choice_sentence(choice, settings)
        self.curve = curve

    def mesh(self, which: str = "recommended") -> Mesh:
        """The mesh of one of the choices."""
        index_of(which, CHOICES, "choice")
        if self.curve is None and which == "recommended":
            return self._recommended
        if self.curve is None:
            raise ValueError(f"the mesh '{which}' is not there: a choice is pickled with the recommended one alone")
        lib.curve_reorder(self.curve, self.order)
        return self.curve.mesh(getattr(self, which).level_index)

    def export(self, code: Code, folder: str | os.PathLike | None = None, which: str = "recommended", *, density: float = 2000,
               particles: int = 50, pieces: int = 64, young: float = 0, overwrite: bool = True) -> CodeWritten:
        """One of the choices for another code, as Mesh.export: choice.export("deme")."""
        return write_code(lib.particle_from_mesh(self.mesh(which), {}), code, folder, self.mesh(which).source, density=density,
                          particles=particles, pieces=pieces, young=young, overwrite=overwrite)

    def plot(self, path: str | os.PathLike | None = None, width: int = 1000, height: int = 500) -> _picture.Picture:
        """The scan and the recommended mesh, as Mesh.plot."""
        return _picture.Picture(self._draw, width, height, path)

    def _draw(self, options):
        level, scan = self.mesh(), self.curve.source_mesh
        return lib.render(*_picture.scene_of((scan, "scan"), (level, f"{level.triangle_count} triangles")), options, None)

    def __str__(self) -> str:
        return self.answer

    def __reduce__(self) -> tuple:
        return _choice_again, ({**vars(self), "curve": None, "_recommended": self.mesh()},)

    def __repr__(self) -> str:
        return f"<scree.Choice of {self.recommended.triangle_count} of {self.triangle_count} triangles>"

    def _repr_html_(self) -> str:
        return _picture.html(self, self._draw, Record(triangles=self.recommended.triangle_count, rp=self.recommended.rp,
                                                limited_by=self.limited_by, **self.errors))


def _choice_again(facts):
    choice = Choice.__new__(Choice)
    vars(choice).update(facts)
    return choice


def _level(struct, names):
    level = record(struct)
    level.errors = dict(zip(names, struct.errors))
    return level


class Clumps(Shared):
    """Clumps of one body by their count; `recommended` is that by volume. clumps[i] tells what a clump is worth, particle() is
    one with the body's mass and inertia."""

    def __init__(self, mesh: Mesh, progress: Progress = None, **options: Any) -> None:
        self._c = lib.clumps_make(mesh, options, progress)

    def __reduce__(self):
        raise TypeError("Clumps are not pickled: pickle their mesh and fit again, or pickle particles of them")

    def __len__(self) -> int:
        return self._c.clump_count

    def __getitem__(self, index: int) -> Clump:
        if not -len(self) <= index < len(self):
            raise IndexError(f"clump {index} of {len(self)}")
        return record(self._c.clumps[index % len(self)])

    @property
    def recommended(self) -> Clump:
        return self[self._c.recommended]

    def particle(self, count: int | None = None) -> Particle:
        """The clump of so many spheres, or the recommended one."""
        clump = self._c.clumps[self._c.recommended] if count is None else lib.clumps_of_count(self, count)
        return Particle._of(lib.clump_particle(self, clump))

    def write(self, path: str | os.PathLike, count: int | None = None, unit: str | float = "mm", overwrite: bool = True) -> None:
        """The spheres as a table x,y,z,radius."""
        clump = self._c.clumps[self._c.recommended] if count is None else lib.clumps_of_count(self, count)
        lib.spheres_write(self, clump, metres(unit), path, overwrite)


class Grid(Fields):
    """Signed distances, m, at origin + spacing * (i, j, k). error, mean_error: the largest and the mean difference between
    what is interpolated trilinearly in the middle of a cell and the distance there, of cells within two spacings of the surface.
    As distances change by no more than the way, no point of a cell is off by more than sqrt(3)/2 spacings."""

    distances: Any
    origin: Any
    spacing: float
    error: float
    mean_error: float

    def __repr__(self):
        return f"<scree.Grid of {' x '.join(map(str, self.distances.shape))} signed distances, {self.spacing:.3g} m apart>"

    def write(self, path: str | os.PathLike) -> None:
        """As .npz, which numpy.load reads: the fields by their names."""
        numpy.savez_compressed(path, **vars(self))


def codes() -> dict[str, str]:
    """The codes that export() writes for, and what they take: "mesh", "clump" or "mesh, clump"; the first is best."""
    found = {}
    for i, name in enumerate(lib.names("code_name")):
        kinds = [kind for kind in ("clump", "mesh") if lib.code_takes(i, kind)]
        best = lib.code_kind(i)
        found[name] = ", ".join(sorted(kinds, key=lambda kind: kind != best.words[best.value]))
    return found


def write_code(particle, code, folder, source, pieces=64, particles=50, overwrite=True, **options):
    index = index_of(code, list(codes()), "code")
    name = pathlib.PurePath((source or "particle").removeprefix("sample:")).stem
    where = pathlib.Path(folder if folder is not None else f"{name}-{code}")
    where.mkdir(parents=True, exist_ok=True)
    convex = {"tolerance": lib.default_convex_options().tolerance, "most": pieces}
    return record(lib.code_write(particle, index, {"name": name, "count": particles, "overwrite": overwrite, "convex": convex,
                                                   **options}, where))


def load(path: str | os.PathLike, unit: str | float | None = None, weld: float = 0.0, **sample_options: Any) -> Mesh:
    """Reads STL, PLY, OBJ, OFF (3MF, glTF); or makes a built-in sample by "sample:NAME". Without a unit it is the
    one that the file states, as files of scree do, else mm; a size that is usually a wrong unit is warned of. The mesh carries source, format and checksum of what
    was read, and warning: in what the file contradicts itself, "" in nothing."""
    path = os.fspath(path)
    if isinstance(path, str) and path.startswith("sample:"):
        return sample(path[len("sample:"):], **sample_options)
    if sample_options:
        raise TypeError(f"{', '.join(sample_options)}: options of samples only; of a file unit and weld are")
    scan = lib.scan_read(path, {"unit_m": metres(unit or "mm"), "weld_tolerance": weld, "ignore_comment_unit": unit is not None})
    mesh, facts = Mesh._of(scan.mesh, os.fsdecode(path)), record(scan)
    mesh.format, mesh.warning, mesh.checksum = facts.format, facts.warning, facts.checksum
    size = max(high - low for low, high in zip(*mesh.bounds))
    if not (1e-3 if unit is None else 1e-4) <= size <= 10:
        warnings.warn(f"{os.fsdecode(path)}: {size:.3g} m across: is the unit right? unit= says another one", stacklevel=2)
    return mesh


def sample(name: str, progress: Progress = None, **options: Any) -> Mesh:
    """A built-in sample; options resolution and noise in metres, seed."""
    made = Mesh._of(lib.sample_make(name, options, progress), "sample:" + name)
    made.format = "sample"
    return made


def samples() -> dict[str, str]:
    """Names and descriptions of the built-in samples."""
    return {name: lib.sample_description(i) for i, name in enumerate(lib.names("sample_name"))}
