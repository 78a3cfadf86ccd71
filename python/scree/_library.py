"""The shared library: where it lies, its structs as ctypes, its functions with their types.

The structs follow include/scree/*.h field by field; tests/python/layout.py has a C compiler say every size and
offset and compares."""
import ctypes
import ctypes.util
import os
import pathlib
from ctypes import (CFUNCTYPE, POINTER, Structure, c_bool, c_char, c_char_p, c_double, c_float, c_int, c_longlong, c_size_t,
                    c_uint32, c_uint64, c_void_p)

double3, double4, double33 = c_double * 3, c_double * 4, c_double * 3 * 3

STATUSES = ("OK", "BAD_ARGUMENT", "BAD_FILE", "BAD_MESH", "IO", "OUT_OF_MEMORY", "LIMIT", "CANCELLED", "EXISTS",
            "UNSUPPORTED", "NO_BACKEND", "DIVERGED")
METHODS = ("volume", "qecd")
REFERENCES = ("scan", "smooth")
SHAPE_ERRORS = ("area", "volume", "hausdorff", "mean_distance", "inertia", "widths", "thickness", "thinnest", "convexity",
                "normals")
PARTICLE_KINDS = ("mesh", "sphere", "clump")
LAWS = ("linear", "hysteretic", "hertz")
WALL_KINDS = ("plane", "disc", "cylinder", "mesh")
MOTION_LAWS = ("constant", "sine", "positions", "speeds")
VIEWS = ("surfaces", "points", "contacts", "walls")
DEFECT_COUNT, REPAIR_ACTION_COUNT = 18, 23


class scree_error(Structure):
    _fields_ = [("status", c_int), ("message", c_char * 1024)]


class scree_checksum(Structure):
    _fields_ = [("high", c_uint64), ("low", c_uint64)]


REPORT = CFUNCTYPE(c_bool, c_void_p, c_char_p, c_double)


class scree_progress(Structure):
    _fields_ = [("report", REPORT), ("context", c_void_p), ("interval", c_double)]


class scree_mesh(Structure):
    _fields_ = [("positions", POINTER(c_double)), ("triangles", POINTER(c_uint32)), ("vertex_count", c_size_t),
                ("triangle_count", c_size_t)]


class scree_read_options(Structure):
    _fields_ = [("unit_m", c_double), ("weld_tolerance", c_double), ("max_bytes", c_size_t),
                ("ignore_comment_unit", c_bool)]


class scree_scan(Structure):
    _fields_ = [("mesh", scree_mesh), ("checksum", scree_checksum), ("byte_count", c_size_t), ("unit_m", c_double),
                ("states_unit", c_bool), ("comment_unit_m", c_double), ("format", c_char * 32), ("facet_count", c_size_t), ("degenerate_count", c_size_t), ("solid_count", c_size_t),
                ("ignored_byte_count", c_size_t), ("warning", c_char * 192)]


class scree_write_options(Structure):
    _fields_ = [("format", c_int), ("unit_m", c_double), ("overwrite", c_bool), ("comment", c_char_p)]


class scree_measures(Structure):
    _fields_ = [("closed", c_bool), ("inward", c_bool), ("has_volume", c_bool), ("area", c_double),
                ("volume", c_double), ("centroid", double3), ("inertia", double33), ("principal_moments", double3),
                ("principal_axes", double33), ("equivalent_diameter", c_double), ("sphericity", c_double),
                ("box_min", double3), ("box_max", double3), ("dimensions", double3),
                ("oriented_dimensions", double3), ("oriented_axes", double33), ("oriented_center", double3),
                ("hull_area", c_double), ("hull_volume", c_double), ("convexity", c_double)]


class scree_topology(Structure):
    _fields_ = [(name, c_size_t) for name in (
        "vertex_count", "unused_vertex_count", "edge_count", "facet_count", "shell_count", "inward_shell_count",
        "boundary_edge_count", "boundary_count", "non_manifold_edge_count", "non_manifold_vertex_count",
        "inconsistent_edge_count", "degenerate_facet_count", "duplicate_facet_count")] + [
        ("euler_characteristic", c_longlong), ("genus", c_longlong), ("closed", c_bool), ("manifold", c_bool),
        ("oriented", c_bool)]


class scree_deviation(Structure):
    _fields_ = [("mean", c_double), ("rms", c_double), ("maximum", c_double), ("maximum_bound", c_double),
                ("at", double3), ("sample_count", c_size_t)]


class scree_distance(Structure):
    _fields_ = [("forward", scree_deviation), ("backward", scree_deviation), ("hausdorff", c_double),
                ("hausdorff_bound", c_double)]


class scree_distance_options(Structure):
    _fields_ = [("sample_count", c_size_t), ("hausdorff_gap", c_double), ("one_way", c_bool)]


class scree_check(Structure):
    _fields_ = [("triangle_count", c_size_t), ("vertex_count", c_size_t), ("shell_count", c_size_t),
                ("size", c_double * 3), ("defects", c_size_t * DEFECT_COUNT), ("intersections_known", c_bool),
                ("too_many_pairs", c_bool), ("volume_known", c_bool), ("volume", c_double), ("usable", c_bool), ("verdict", c_char * 512)]


class scree_check_options(Structure):
    _fields_ = [("intersections", c_bool)]


class scree_cut_plane(Structure):
    _fields_ = [("normal", double3), ("offset", c_double)]


class scree_repair_options(Structure):
    _fields_ = [("seam_tolerance", c_double), ("hole_edges", c_size_t), ("fill_large_holes", c_bool),
                ("flat_large_holes", c_bool), ("debris_share", c_double), ("drop_cavities", c_bool), ("keep_largest", c_bool),
                ("cut_intersections", c_bool), ("merge_shells", c_bool), ("merge_folds", c_bool),
                ("intersections", c_bool), ("cavity_share", c_double), ("volume_change", c_double), ("cut", c_int),
                ("plane", scree_cut_plane)]


class scree_repair_report(Structure):
    _fields_ = [("done", c_size_t * REPAIR_ACTION_COUNT), ("seam_distance", c_double), ("area_before", c_double),
                ("area_after", c_double), ("volume_before", c_double), ("volume_after", c_double),
                ("filled_volume", c_double), ("plane", scree_cut_plane), ("before", scree_check),
                ("after", scree_check)]


class scree_simplify_options(Structure):
    _fields_ = [("method", c_int), ("stop_count", c_size_t), ("error_limit", c_double)]


class scree_curve_facts(Structure):
    _fields_ = [("method", c_int), ("triangle_count", c_size_t), ("floor_count", c_size_t),
                ("shell_count", c_size_t), ("boundary_edge_count", c_size_t), ("locked_vertex_count", c_size_t),
                ("closed", c_bool)]


class scree_level(Structure):
    _fields_ = [("triangle_count", c_size_t), ("rp", c_double), ("area", c_double), ("volume", c_double),
                ("quadric_error", c_double)]


class scree_choice_options(Structure):
    _fields_ = [("weight", c_double), ("rp_min", c_double), ("rp_max", c_double), ("per_decade", c_int),
                ("reference", c_int), ("tolerances", c_double * len(SHAPE_ERRORS)),
                ("tolerance_lengths", c_double * len(SHAPE_ERRORS)), ("area_only", c_bool)]


class scree_choice_level(Structure):
    _fields_ = [("rp", c_double), ("level_index", c_size_t), ("triangle_count", c_size_t), ("rp_reached", c_double),
                ("reached", c_bool), ("area", c_double), ("volume", c_double), ("eps_s", c_double),
                ("ip", c_double), ("worst_eps_s", c_double), ("robust_ip", c_double), ("smooth_ip", c_double),
                ("errors", c_double * len(SHAPE_ERRORS))]


class scree_pick(Structure):
    _fields_ = [("rp", c_double), ("level_index", c_size_t), ("triangle_count", c_size_t), ("area", c_double),
                ("volume", c_double), ("eps_s", c_double), ("ip", c_double), ("level_eps_s", c_double),
                ("fewest", c_size_t), ("most", c_size_t)]


class scree_noise(Structure):
    _fields_ = [("found", c_bool), ("area", c_double), ("fraction", c_double), ("level_index", c_size_t),
                ("triangle_count", c_size_t)]


class scree_choice(Structure):
    _fields_ = [("triangle_count", c_size_t), ("floor_count", c_size_t), ("area", c_double), ("volume", c_double),
                ("reference_area", c_double), ("noise", scree_noise), ("levels", POINTER(scree_choice_level)),
                ("level_count", c_size_t), ("trace", POINTER(scree_choice_level)), ("trace_count", c_size_t),
                ("paper", scree_pick), ("robust", scree_pick), ("plain", scree_pick), ("paper_is_accident", c_bool),
                ("plain_is_accident", c_bool), ("smooth", scree_pick), ("finer_count", c_size_t),
                ("paper_finer_count", c_size_t), ("best", c_size_t * len(SHAPE_ERRORS)), ("fidelity", c_void_p),
                ("recommended", scree_pick), ("recommended_row", c_size_t), ("limited_by", c_int), ("cost", scree_pick)]


class scree_sample_options(Structure):
    _fields_ = [("resolution", c_double), ("noise", c_double), ("seed", c_uint64)]


class scree_particle_options(Structure):
    _fields_ = [("rounding", c_double)]


class scree_particle_measures(Structure):
    _fields_ = [("kind", c_int), ("volume", c_double), ("size", c_double), ("centre", double3),
                ("orientation", double4), ("inertia", double3), ("bounding_radius", c_double),
                ("thickness", c_double), ("rounding", c_double), ("triangle_count", c_size_t),
                ("point_count", c_size_t), ("edge_count", c_size_t)]


class scree_world_options(Structure):
    _fields_ = [("gravity", double3), ("law", c_int)] + [(name, c_double) for name in (
        "steps_per_contact", "time_step", "stiffness_factor", "tangential_ratio", "size", "smoothing", "sharing",
        "overlap_limit", "skin", "floor_height")] + [("period", double3), ("period_from", double3)]


class scree_material(Structure):
    _fields_ = [("stiffness", c_double), ("density", c_double), ("restitution", c_double), ("friction", c_double),
                ("rolling_friction", c_double), ("surface_energy", c_double), ("poisson", c_double)]


class scree_material_contact(Structure):
    _fields_ = [(name, c_double) for name in (
        "restitution", "friction", "rolling_friction", "pull_off", "surface_energy")]


class scree_wall_mending(Structure):
    _fields_ = [(name, c_size_t) for name in ("welded", "flat", "joined", "doubled", "parted", "turned")]


class scree_wall(Structure):
    _fields_ = [("kind", c_int), ("material", c_size_t), ("position", double3), ("axis", double3),
                ("radius", c_double), ("length", c_double), ("mesh", POINTER(scree_mesh)),
                ("two_sided", c_bool), ("velocity", double3), ("angular_velocity", double3),
                ("surface_velocity", double3), ("surface_angular_velocity", double3)]


class scree_wall_motion(Structure):
    _fields_ = [("law", c_int), ("turns", c_bool), ("axis", double3), ("through", double3)] + [
        (name, c_double) for name in ("speed", "amplitude", "frequency", "phase")] + [
            ("table", POINTER(c_double)), ("row_count", c_size_t), ("from", c_double), ("until", c_double)]


class scree_body(Structure):
    _fields_ = [("position", double3), ("orientation", double4), ("velocity", double3),
                ("angular_velocity", double3)]


class scree_observation(Structure):
    _fields_ = [(name, c_double) for name in (
        "time", "kinetic", "rotational", "potential", "elastic", "dissipated_dashpot", "dissipated_friction",
        "wall_work", "applied_work")] + [("momentum", double3), ("angular_momentum", double3)] + [(name, c_double) for name in (
            "mean_rotation", "largest_overlap", "highest_speed", "coordination")] + [(name, c_size_t) for name in (
                "body_count", "removed_count", "pair_count", "depenetrating_pairs", "contact_count")] + [("depenetration_count", c_uint64)]


class scree_contact(Structure):
    _fields_ = [("body", c_size_t), ("other", c_size_t), ("wall", c_bool), ("position", double3),
                ("normal", double3), ("force", double3), ("overlap", c_double), ("weight", c_double)]


class scree_export_options(Structure):
    _fields_ = [("density", c_double), ("unit_m", c_double), ("centre", c_bool), ("principal", c_bool),
                ("overwrite", c_bool), ("source", c_char_p), ("command_line", c_char_p),
                ("checksum", scree_checksum)]


class scree_exported(Structure):
    _fields_ = [("rotation", double33), ("translation", double3), ("mass", c_double), ("inertia", double33),
                ("bounding_radius", c_double), ("measures", scree_measures)]


class scree_repose(Structure):
    _fields_ = [("heap", c_bool), ("reason", c_char * 128), ("sector_deg", c_double), ("sector_sd_deg", c_double),
                ("sector_count", c_size_t), ("sector_total", c_size_t), ("cone_deg", c_double), ("cone_rms", c_double), ("cone_apex", double3),
                ("silhouette_deg", c_double), ("silhouette_sd_deg", c_double), ("flank_count", c_size_t),
                ("spread_deg", c_double), ("volume_deg", c_double), ("axis", c_double * 2), ("height", c_double), ("peak", c_double), ("base_radius", c_double),
                ("run_out", c_double), ("envelope_volume", c_double)]


class scree_pile(Structure):
    _fields_ = [("repose", scree_repose), ("body_count", c_size_t), ("packing_fraction", c_double), ("size", c_double)]


class scree_pile_settings(Structure):
    _fields_ = [("cell", c_double), ("sectors", c_size_t), ("band_low", c_double), ("band_high", c_double)]


class scree_poured(Structure):
    _fields_ = [("name", c_char_p), ("kind", c_char_p), ("value", c_char_p), ("share", c_double)]


class scree_scene_costs(Structure):
    _fields_ = [("body_steps", c_uint64), ("wall_seconds", c_double), ("processor_seconds", c_double),
                ("piece_count", c_uint64)]


class scree_scene_state(Structure):
    _fields_ = [("scene", c_void_p)] + [(name, c_double) for name in (
        "time", "fraction", "steps_per_second", "seconds_left")]


WATCH = CFUNCTYPE(c_bool, c_void_p, POINTER(scree_scene_state))


class scree_scene_job(Structure):
    _fields_ = [("file", c_void_p), ("folder", c_char_p), ("resume", c_bool), ("overwrite", c_bool), ("states", c_bool),
                ("no_motion", c_bool), ("store", c_void_p), ("progress", POINTER(scree_progress)), ("watch", WATCH),
                ("begun", c_void_p), ("frame", c_void_p), ("context", c_void_p)]


class scree_scene_entry(Structure):
    _fields_ = [("scene", c_void_p), ("file", c_char_p), ("stopped_because", c_char_p), ("command_line", c_char_p),
                ("seconds", c_double), ("measure", POINTER(scree_pile_settings))]


class scree_scene_book(Structure):
    _fields_ = [(name, c_size_t) for name in ("entered_count", "inside_count", "left_count", "waiting_count")] + [
        (name, c_double) for name in ("entered_mass", "inside_mass", "left_mass", "entered_energy", "left_energy",
                                      "ledger")]


class scree_motion(Structure):
    _fields_ = [("frame_count", c_size_t), ("body_count", c_size_t), ("time", POINTER(c_double)),
                ("poses", POINTER(c_float))]


class scree_calibration_progress(Structure):
    _fields_ = [(name, c_size_t) for name in ("rounds", "run_count", "done", "failed", "budget")] + [
        ("seconds", c_double), ("planning_seconds", c_double)]


class scree_calibration_result(Structure):
    _fields_ = [("title", c_char_p), ("version", c_char_p), ("stopped", c_char_p), ("is_search", c_bool),
                ("maximise", c_bool), ("confidence", c_double), ("seed", c_uint64),
                ("progress", scree_calibration_progress)] + [
        (name, c_size_t) for name in ("parameter_count", "trade_count", "answer_count", "advice_count", "sample_count",
                                      "history_count")] + [
        (name, c_void_p) for name in ("parameters", "trades", "answers", "advice")] + [
        ("samples", POINTER(c_double)), ("history", POINTER(c_double)), ("sought", c_char_p),
        ("setting_count", c_size_t), ("settings", c_void_p), ("failure_count", c_size_t), ("failures", c_void_p),
        ("memory", c_void_p)]


VISITOR = CFUNCTYPE(c_bool, c_void_p, POINTER(scree_contact))

_E, _H, _P = POINTER(scree_error), c_void_p, POINTER(scree_progress)  # error, opaque handle, progress
_M, _HH, _S = POINTER(scree_mesh), POINTER(c_void_p), c_char_p
_FALLIBLE = {  # argument types before the error
    "scan_read": (_S, POINTER(scree_read_options), POINTER(scree_scan)),
    "mesh_weld": (POINTER(c_double), c_size_t, c_double, _M, POINTER(c_size_t)),
    "mesh_copy": (_M, _M),
    "wall_mend": (_M, _M, POINTER(scree_wall_mending)),
    "mesh_write": (_M, _S, POINTER(scree_write_options)),
    "mesh_measure": (_M, POINTER(scree_measures)),
    "mesh_topology": (_M, POINTER(scree_topology)),
    "mesh_distance": (_M, _M, POINTER(scree_distance_options), _P, POINTER(scree_distance)),
    "mesh_distance_field": (_M, _M, POINTER(c_double)),
    "mesh_check": (_M, POINTER(scree_check_options), _P, POINTER(scree_check)),
    "mesh_repair": (_M, POINTER(scree_repair_options), _P, _M, POINTER(scree_repair_report)),
    "mesh_vtp_write": (_M, _M, _S, c_bool),
    "particle_export": (_M, POINTER(scree_export_options), _S, _S, POINTER(scree_exported)),
    "curve_build": (_M, POINTER(scree_simplify_options), _P, _HH),
    "curve_mesh": (_H, c_size_t, _M),
    "curve_fit": (_H, c_size_t, _M),
    "choose": (_H, _M, POINTER(scree_choice_options), _P, POINTER(scree_choice)),
    "sample_make": (_S, POINTER(scree_sample_options), _P, _M),
    "particle_from_mesh": (_M, POINTER(scree_particle_options), _HH),
    "particle_sphere": (c_double, _HH),
    "particle_clump": (POINTER(c_double), POINTER(c_double), c_size_t, _H, _HH),
    "clump_fit": (_M, c_size_t, _P, _HH),
    "world_create": (POINTER(scree_world_options), _HH),
    "world_add_material": (_H, POINTER(scree_material), POINTER(c_size_t)),
    "world_set_contact": (_H, c_size_t, c_size_t, c_double, c_double),
    "world_get_pair": (_H, c_size_t, c_size_t, POINTER(scree_material_contact)),
    "world_set_pair": (_H, c_size_t, c_size_t, POINTER(scree_material_contact)),
    "world_add_wall": (_H, POINTER(scree_wall), POINTER(c_size_t)),
    "world_set_wall_velocity": (_H, c_size_t, double3, double3),
    "world_set_wall_motion": (_H, c_size_t, POINTER(scree_wall_motion), c_size_t),
    "world_set_wall_surface": (_H, c_size_t, double3, double3),
    "world_set_body_force": (_H, c_size_t, double3, double3),
    "world_add_body": (_H, _H, c_size_t, POINTER(scree_body), POINTER(c_size_t)),
    "world_set_body": (_H, c_size_t, POINTER(scree_body)),
    "world_step": (_H, c_size_t),
    "world_visit_contacts": (_H, VISITOR, c_void_p),
    "world_save": (_H, _S, c_bool),
    "world_load": (_S, _HH),
    "world_vtp_write": (_H, c_int, _S, c_bool),
    "world_export": (_H, POINTER(scree_export_options), _S),
    "pvd_write": (POINTER(_S), POINTER(c_double), c_size_t, _S, c_bool),
    "calibration_read": (_S, _HH),
    "calibration_open": (_H, _S),
    "calibration_work": (_H, c_size_t, _H, _P),
    "calibration_analyse": (_H, POINTER(scree_calibration_result)),
    "calibration_report_write": (POINTER(scree_calibration_result), _S),
    "motion_read": (_S, POINTER(scree_motion)),
    "scene_file_read": (_S, _HH),
    "scene_file_template": (_S, _HH),
    "scene_file_pour": (_H, POINTER(scree_poured), c_size_t),
    "shape_store_create": (_HH,),
    "shape_store_give": (_H, _S, _H),
    "scene_file_set": (_H, _S, _S),
    "scene_create_from": (_H, _H, _P, _HH),
    "scene_complete": (POINTER(scree_scene_job), _HH),
    "scene_measure_pile": (_H, c_size_t, POINTER(scree_pile_settings), POINTER(scree_pile)),
    "scene_json_write": (POINTER(scree_scene_entry), _S, c_bool),
    "scene_advance": (_H, c_size_t),
    "scene_measure": (_H, POINTER(c_double)),
    "scene_save": (_H, _S, c_bool),
    "scene_load": (_S, _HH),
    "page_write": (POINTER(_S), c_size_t, _S, c_bool),
}
_PLAIN = {  # result, argument types
    "version": (_S, ()),
    "set_threads": (None, (c_int,)),
    "threads": (c_int, ()),
    "mesh_free": (None, (_M,)),
    "scan_free": (None, (POINTER(scree_scan),)),
    "default_read_options": (scree_read_options, ()),
    "default_write_options": (scree_write_options, ()),
    "default_check_options": (scree_check_options, ()),
    "default_repair_options": (scree_repair_options, ()),
    "default_distance_options": (scree_distance_options, ()),
    "default_simplify_options": (scree_simplify_options, ()),
    "default_choice_options": (scree_choice_options, ()),
    "default_sample_options": (scree_sample_options, ()),
    "default_particle_options": (scree_particle_options, ()),
    "default_world_options": (scree_world_options, ()),
    "default_material": (scree_material, ()),
    "default_wall_material": (scree_material, ()),
    "default_wall_motion": (scree_wall_motion, ()),
    "default_body": (scree_body, ()),
    "default_export_options": (scree_export_options, ()),
    "defect_name": (_S, (c_int,)),
    "defect_is_counted": (c_bool, (POINTER(scree_check), c_int)),
    "repair_action_name": (_S, (c_int,)),
    "curve_free": (None, (_H,)),
    "curve_get_facts": (scree_curve_facts, (_H,)),
    "curve_level_count": (c_size_t, (_H,)),
    "curve_level": (None, (_H, c_size_t, POINTER(scree_level))),
    "curve_find": (c_size_t, (_H, c_size_t)),
    "choice_target": (c_size_t, (c_double, c_size_t)),
    "fidelity_error": (c_double, (c_void_p, c_size_t, c_int)),
    "choice_free": (None, (POINTER(scree_choice),)),
    "sample_count": (c_size_t, ()),
    "sample_name": (_S, (c_size_t,)),
    "sample_description": (_S, (c_size_t,)),
    "particle_free": (None, (_H,)),
    "particle_measure": (None, (_H, POINTER(scree_particle_measures))),
    "particle_mesh": (_M, (_H,)),
    "world_free": (None, (_H,)),
    "world_get_wall": (None, (_H, c_size_t, POINTER(scree_wall))),
    "world_wall_count": (c_size_t, (_H,)),
    "world_wall_force": (None, (_H, c_size_t, double3, double3)),
    "world_wall_power": (None, (_H, c_size_t, POINTER(c_double), POINTER(c_double))),
    "world_get_bodies": (None, (_H, c_size_t, c_size_t) + 4 * (POINTER(c_double),)),
    "world_body_count": (c_size_t, (_H,)),
    "world_body_removed": (c_bool, (_H, c_size_t)),
    "world_get_body": (None, (_H, c_size_t, POINTER(scree_body))),
    "world_body_mass": (c_double, (_H, c_size_t)),
    "world_body_material": (c_size_t, (_H, c_size_t)),
    "world_remove_body": (None, (_H, c_size_t)),
    "world_time": (c_double, (_H,)),
    "world_step_count": (c_uint64, (_H,)),
    "world_time_step": (c_double, (_H, c_char_p)),
    "world_observe": (None, (_H, POINTER(scree_observation))),
    "world_hash": (scree_checksum, (_H,)),
    "motion_free": (None, (POINTER(scree_motion),)),
    "calibration_free": (None, (_H,)),
    "calibration_is_search": (c_bool, (_H,)),
    "calibration_result_free": (None, (POINTER(scree_calibration_result),)),
    "scene_file_free": (None, (_H,)),
    "scene_template_name": (_S, (c_size_t,)),
    "scene_template": (_S, (_S,)),
    "scene_free": (None, (_H,)),
    "shape_store_free": (None, (_H,)),
    "scene_end": (_S, (_H,)),
    "scene_phase": (_S, (_H,)),
    "scene_is_frame": (c_bool, (_H,)),
    "scene_get_costs": (scree_scene_costs, (_H,)),
    "scene_pile_name": (_S, (_H, c_size_t)),
    "scene_pile_settings": (scree_pile_settings, (_H, c_size_t)),
    "scene_shape_source": (_S, (_H, c_size_t)),
    "scene_duration": (c_double, (_H,)),
    "scene_text": (_S, (_H,)),
    "scene_world": (_H, (_H,)),
    "scene_shape_name": (_S, (_H, c_size_t)),
    "scene_geometry_name": (_S, (_H, c_size_t)),
    "scene_geometry_note": (_S, (_H, c_size_t)),
    "scene_inlet_name": (_S, (_H, c_size_t)),
    "scene_outlet_name": (_S, (_H, c_size_t)),
    "scene_body_shape": (c_size_t, (_H, c_size_t)),
    "scene_get_book": (None, (_H, POINTER(scree_scene_book))),
    "scene_inlet_count": (c_size_t, (_H, c_size_t, POINTER(c_double), POINTER(c_size_t))),
    "scene_outlet_count": (c_size_t, (_H, c_size_t, POINTER(c_double))),
    "scene_column_name": (_S, (_H, c_size_t)),
    "scene_column_unit": (_S, (_H, c_size_t)),
    "scene_series": (POINTER(c_double), (_H, POINTER(c_size_t))),
}


class Error(Exception):
    """What the library refused: the sentence, and `status`, such as "BAD_FILE"."""

    def __init__(self, status, message):
        super().__init__(message)
        self.status = status


def interface_version(version):
    """The part of a version that names the interface: 0.MINOR before 1.0, then MAJOR."""
    major, minor = version.strip().split(".")[:2]
    return f"0.{minor}" if major == "0" else major


def _candidates():
    """SCREE_LIBRARY; beside an installed module (PREFIX/lib/python3/dist-packages/scree and the like); the system's."""
    named = os.environ.get("SCREE_LIBRARY")
    if named:
        yield named
        return
    version = (pathlib.Path(__file__).parent / "VERSION")
    name = "libscree.so." + interface_version(version.read_text()) if version.exists() else "libscree.so"
    for folder in pathlib.Path(__file__).resolve().parents:
        for library in [folder / name, *sorted(folder.glob(f"lib*/{name}")), *sorted(folder.glob(f"lib*/*/{name}"))]:
            if library.exists():
                yield str(library)
    found = ctypes.util.find_library("scree")
    if found:
        yield found


def _load():
    for path in _candidates():
        try:
            return ctypes.CDLL(path)
        except OSError as problem:
            raise ImportError(f"scree: cannot load {path}: {problem}") from problem
    raise ImportError("scree: libscree.so was not found; install scree, or name the file in SCREE_LIBRARY")


_library = _load()
lib = {}
for _name, (_result, _arguments) in _PLAIN.items():
    lib[_name] = getattr(_library, "scree_" + _name)
    lib[_name].restype, lib[_name].argtypes = _result, _arguments
for _name, _arguments in _FALLIBLE.items():
    lib[_name] = getattr(_library, "scree_" + _name)
    lib[_name].restype, lib[_name].argtypes = c_int, (*_arguments, _E)

_version_file = pathlib.Path(__file__).parent / "VERSION"
if _version_file.exists() and _version_file.read_text().strip() != lib["version"]().decode():
    raise ImportError(f"scree: the module is of version {_version_file.read_text().strip()}, the library of "
                      f"{lib['version']().decode()}")


def call(name, *arguments):
    """A fallible function; raises Error."""
    error = scree_error()
    if lib[name](*arguments, ctypes.byref(error)) != 0:
        raise Error(STATUSES[error.status], error.message.decode(errors="replace"))


class Progress:
    """Passes progress to `report(phase, fraction)`, which cancels by returning False; lets Ctrl-C through. Used as
    `with Progress(report) as p: call(..., p, ...)`."""

    def __init__(self, report):
        self.report, self.problem = report, None

    def __enter__(self):
        self.struct = scree_progress(REPORT(self._tell), None, 0.2)
        return ctypes.byref(self.struct)

    def _tell(self, _context, phase, fraction):
        try:
            return self.report is None or self.report(phase.decode(), fraction) is not False
        except BaseException as problem:  # must not pass through C
            self.problem = problem
            return False

    def __exit__(self, kind, value, trace):
        if self.problem is not None:
            raise self.problem
        return False
