"""Meshes: from files and samples, measured, compared, decimated, written."""
import ctypes
import os
import weakref

from . import _library as c
from ._library import call, lib
from ._values import c_array, column, from_struct, index_of, metres, set_fields, table, whole


class Mesh:
    """An indexed triangle mesh in metres, not to be changed. `source` says where it came from."""

    def __init__(self, positions=None, triangles=None, *, weld=False):
        """Of rows of three coordinates and rows of three vertex indices. weld unites equal positions and puts
        everything in scree's canonical order."""
        self.source, self.format, self.warning, self.checksum = None, None, "", c.scree_checksum()
        if positions is None:
            self._own(c.scree_mesh())
            return
        points, point_count = c_array(ctypes.c_double, positions, 3)
        corners, count = c_array(ctypes.c_uint32, triangles, 3)
        if any(corner >= point_count for corner in corners[:3 * count]):
            raise ValueError(f"a triangle names a vertex beyond the {point_count} given")
        made = c.scree_mesh()
        if weld:
            loose = (ctypes.c_double * (9 * count))()
            for k, corner in enumerate(corners[:3 * count]):
                loose[3 * k:3 * k + 3] = points[3 * corner:3 * corner + 3]
            call("mesh_weld", loose, count, 0.0, made, None)
        else:
            borrowed = c.scree_mesh(points, corners, point_count, count)
            call("mesh_copy", borrowed, made)
        self._own(made)

    def _own(self, struct):
        self._struct = struct
        self._finalizer = weakref.finalize(self, lib["mesh_free"], struct)

    @classmethod
    def _of(cls, struct, source=None):
        mesh = cls()
        mesh._own(struct)
        mesh.source = source
        return mesh

    def as_wall(self):
        """Any facets as a wall for World.add_wall, and what was mended: welded, split where an edge ran past a vertex,
        without facets that have no area or lie on others, parted where three facets meet, wound one way."""
        made, mending = c.scree_mesh(), c.scree_wall_mending()
        call("wall_mend", self._struct, made, mending)
        return Mesh._of(made, self.source), from_struct(mending)

    vertex_count = property(lambda self: self._struct.vertex_count)
    triangle_count = property(lambda self: self._struct.triangle_count)

    @property
    def positions(self):
        """vertex_count x 3, m; not copied."""
        return table(self._struct.positions, self.vertex_count, 3, self)

    @property
    def triangles(self):
        """triangle_count x 3 vertex indices, counter-clockwise from outside; not copied."""
        return table(self._struct.triangles, self.triangle_count, 3, self)

    def __repr__(self):
        return f"<scree.Mesh of {self.triangle_count} triangles from {self.source or 'memory'}>"

    def write(self, path, unit="mm", overwrite=False, comment=None):
        """STL, PLY, OBJ, OFF or 3MF by the path's ending."""
        options = lib["default_write_options"]()
        options.unit_m, options.overwrite = metres(unit), overwrite
        options.comment = comment.encode() if comment else None
        call("mesh_write", self._struct, os.fsencode(path), options)

    def write_vtp(self, path, reference=None, overwrite=False):
        """For ParaView, with the areas of the triangles and, where a reference mesh is given, the distance to it."""
        call("mesh_vtp_write", self._struct, reference._struct if reference else None, os.fsencode(path), overwrite)

    def export(self, path, json_path=None, *, unit="mm", **options):
        """For a DEM code: options density (kg/m3), centre, principal, overwrite. Answers rotation, translation,
        mass, inertia, bounding_radius and measures of what was written; json_path gets them too."""
        settings = set_fields(lib["default_export_options"](), options, "export")
        settings.unit_m, settings.checksum = metres(unit), self.checksum
        settings.source = self.source.encode() if self.source else None
        exported = c.scree_exported()
        call("particle_export", self._struct, settings, os.fsencode(path),
             os.fsencode(json_path) if json_path else None, exported)
        return from_struct(exported)

    def measure(self):
        """Area, volume, centroid, inertia and so on, SI: the fields of scree_measures."""
        measures = c.scree_measures()
        call("mesh_measure", self._struct, measures)
        return from_struct(measures)

    def topology(self):
        """Counts of edges, shells, defects; closed, manifold, oriented: the fields of scree_topology."""
        topology = c.scree_topology()
        call("mesh_topology", self._struct, topology)
        return from_struct(topology)

    def check(self, progress=None, **options):
        """Whether it can serve as a particle: usable, verdict, defects by name, volume. Option intersections: False
        skips the exact test, which takes most of the time."""
        settings = set_fields(lib["default_check_options"](), options, "check")
        check = c.scree_check()
        with c.Progress(progress) as p:
            call("mesh_check", self._struct, settings, p, check)
        return _check(check)

    def repair(self, progress=None, **options):
        """A repaired mesh, and what was done: done by name, before, after. Options seam_tolerance, hole_edges,
        fill_large_holes, debris_share, drop_cavities, keep_largest, cut_intersections, merge_shells (shells that cross,
        overlap or touch become one), merge_folds, intersections, cavity_share, volume_change: scree_repair_options in scree/check.h."""
        settings = set_fields(lib["default_repair_options"](), options, "repair")
        repaired, report = c.scree_mesh(), c.scree_repair_report()
        with c.Progress(progress) as p:
            call("mesh_repair", self._struct, settings, p, repaired, report)
        told = from_struct(report)
        told.before, told.after = _check(report.before), _check(report.after)
        told.done = {lib["repair_action_name"](i).decode(): n for i, n in enumerate(report.done)}
        return Mesh._of(repaired, self.source), told

    def distance(self, other, progress=None, **options):
        """Mean, RMS and Hausdorff distance to another mesh and back; options sample_count, hausdorff_gap, one_way."""
        settings = set_fields(lib["default_distance_options"](), options, "distance")
        distance = c.scree_distance()
        with c.Progress(progress) as p:
            call("mesh_distance", self._struct, other._struct, settings, p, distance)
        return from_struct(distance)

    def distance_field(self, reference):
        """The distance of every vertex from the reference's surface, m."""
        values = (ctypes.c_double * max(1, self.vertex_count))()
        call("mesh_distance_field", self._struct, reference._struct, values)
        return column(values[:self.vertex_count])

    def curve(self, method="volume", progress=None, **options):
        """Decimates through every count; options stop_count, error_limit."""
        return Curve(self, method, progress, **options)

    def simplify(self, count=None, rp=None, method="volume", progress=None):
        """The first level with at most `count` triangles, or rp times the mesh's."""
        if (count is None) == (rp is None):
            raise TypeError("simplify needs a count or an rp")
        if rp is not None and not 0 < rp <= 1:
            raise ValueError(f"rp is {rp}; above 0, at most 1")
        target = whole(count, "count") if rp is None else lib["choice_target"](rp, self.triangle_count)
        curve = Curve(self, method, progress, stop_count=target)
        return curve.mesh(curve.find(target))

    def choose(self, method="volume", progress=None, **options):
        """The triangle count to use: a Choice, whose mesh() is the simplified mesh."""
        return Curve(self, method, progress).choose(progress, **options)


def _check(struct):
    check = from_struct(struct)
    check.defects = {lib["defect_name"](i).decode(): n if lib["defect_is_counted"](struct, i) else None
                     for i, n in enumerate(struct.defects)}
    check.volume = struct.volume if struct.volume_known else None
    return check


class Curve:
    """The record of one decimation; level 0 is the mesh, level i the mesh after i collapses."""

    def __init__(self, mesh, method="volume", progress=None, **options):
        settings = set_fields(lib["default_simplify_options"](), options, "curve")
        settings.method = index_of(method, c.METHODS, "method")
        handle = ctypes.c_void_p()
        with c.Progress(progress) as p:
            call("curve_build", mesh._struct, settings, p, handle)
        self.source_mesh, self._handle = mesh, handle
        # the record borrows the mesh: its finalizer holds it until the record is gone
        self._finalizer = weakref.finalize(self, lambda h, m: lib["curve_free"](h), handle, mesh)

    @property
    def facts(self):
        return from_struct(lib["curve_get_facts"](self._handle), {"method": c.METHODS})

    def __len__(self):
        return lib["curve_level_count"](self._handle)

    def __getitem__(self, index):
        """triangle_count, rp, area, volume, quadric_error of a level."""
        count = len(self)
        if not -count <= index < count:
            raise IndexError(f"level {index} of {count}")
        level = c.scree_level()
        lib["curve_level"](self._handle, index % count, level)
        return from_struct(level)

    def find(self, target):
        """The index of the first level with at most `target` triangles, or the last."""
        return lib["curve_find"](self._handle, whole(target, "target"))

    def mesh(self, index, fit=False):
        """The level's mesh; with fit its vertices move to where the surface is nearer to the scan."""
        if not 0 <= index < len(self):
            raise IndexError(f"level {index} of {len(self)}")
        mesh = c.scree_mesh()
        call("curve_fit" if fit else "curve_mesh", self._handle, index, mesh)
        return Mesh._of(mesh, self.source_mesh.source)

    def choose(self, progress=None, reference="scan", tolerances=None, **options):
        """Options weight, rp_min, rp_max, per_decade, area_only; tolerances by name as shares, such as {"widths": 0.02}."""
        return Choice(self, progress, reference, tolerances, **options)


class Choice:
    """recommended, paper, robust, plain, smooth and cost, each with rp, triangle_count, level_index, eps_s, ip, and fewest and
    most triangles with an ip within a tenth of it; errors of the recommended level by name, shares, and limited_by, the one
    that decides; levels (the grid) and trace (the dense curve) as lists; noise; best, the grid level of the least error by
    name."""

    def __init__(self, curve, progress=None, reference="scan", tolerances=None, **options):
        settings = set_fields(lib["default_choice_options"](), options, "choose")
        settings.reference = index_of(reference, c.REFERENCES, "reference")
        for name, share in (tolerances or {}).items():
            settings.tolerances[index_of(name, c.SHAPE_ERRORS, "tolerance")] = share
        choice = c.scree_choice()
        with c.Progress(progress) as p:
            call("choose", curve._handle, curve.source_mesh._struct, settings, p, choice)
        try:
            self.__dict__.update(from_struct(choice).__dict__)
            self.levels = [_level(choice.levels[i]) for i in range(choice.level_count)]
            self.trace = [_level(choice.trace[i]) for i in range(choice.trace_count)]
            self.best = {name: i for name, i in zip(c.SHAPE_ERRORS, choice.best) if i < choice.level_count}
            self.errors = {}
            if choice.fidelity:
                self.errors = {name: lib["fidelity_error"](choice.fidelity, choice.recommended_row, i)
                               for i, name in enumerate(c.SHAPE_ERRORS)}
                self.limited_by = c.SHAPE_ERRORS[choice.limited_by]
        finally:
            lib["choice_free"](choice)
        del self.fidelity, self.recommended_row
        self.curve = curve

    def mesh(self, which="recommended"):
        """The mesh of one of the choices."""
        index_of(which, ("recommended", "paper", "robust", "plain", "smooth", "cost"), "choice")
        return self.curve.mesh(getattr(self, which).level_index)


def _level(struct):
    level = from_struct(struct)
    level.errors = dict(zip(c.SHAPE_ERRORS, struct.errors))
    return level


def load(path, unit=None, weld=0.0, **sample_options):
    """Reads STL, PLY, OBJ, OFF (3MF, glTF); or makes a built-in sample by "sample:NAME". Without a unit it is the
    one that the file states, as files of scree do, else mm. The mesh carries source, format and checksum of what
    was read, and warning: in what the file contradicts itself, "" in nothing."""
    path = os.fspath(path)
    if isinstance(path, str) and path.startswith("sample:"):
        return sample(path[len("sample:"):], **sample_options)
    if sample_options:
        raise TypeError(f"{', '.join(sample_options)}: options of samples only")
    options, scan = lib["default_read_options"](), c.scree_scan()
    options.unit_m, options.weld_tolerance = metres(unit or "mm"), weld
    options.ignore_comment_unit = unit is not None
    call("scan_read", os.fsencode(path), options, scan)
    mesh = Mesh._of(scan.mesh, os.fsdecode(path))
    mesh.format, mesh.warning = scan.format.decode(), scan.warning.decode()
    mesh.checksum = c.scree_checksum(scan.checksum.high, scan.checksum.low)
    return mesh


def sample(name, progress=None, **options):
    """A built-in sample; options resolution and noise in metres, seed."""
    settings = set_fields(lib["default_sample_options"](), options, "sample")
    mesh = c.scree_mesh()
    with c.Progress(progress) as p:
        call("sample_make", name.encode(), settings, p, mesh)
    made = Mesh._of(mesh, "sample:" + name)
    made.format = "sample"
    return made


def samples():
    """Names and descriptions of the built-in samples."""
    return {lib["sample_name"](i).decode(): lib["sample_description"](i).decode() for i in range(lib["sample_count"]())}
