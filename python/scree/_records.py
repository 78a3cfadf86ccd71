"""Results by name and type: made by tools/python-records.py of the public headers, which say what each value is. Arrays
are numpy arrays where numpy is there, else lists."""
from __future__ import annotations

from typing import Any

from ._values import Fields, KINDS


class Checksum(Fields):
    high: int
    low: int


class CutPlane(Fields):
    normal: Any
    offset: float


class Check(Fields):
    triangle_count: int
    vertex_count: int
    shell_count: int
    size: Any
    defects: dict[str, int | None]
    intersections_known: bool
    too_many_pairs: bool
    volume_known: bool
    volume: float | None
    usable: bool
    verdict: str


class RepairReport(Fields):
    done: dict[str, int]
    seam_distance: float
    area_before: float
    area_after: float
    volume_before: float
    volume_after: float
    guessed_area: float
    refused_share: float
    filled_volume: float
    handle_length: float
    handle_place: Any
    moved_mean: float
    moved_most: float
    moved_place: Any
    plane: CutPlane
    before: Check
    after: Check


class Pick(Fields):
    rp: float
    level_index: int
    triangle_count: int
    area: float
    volume: float
    eps_s: float
    ip: float
    worst_eps_s: float
    robust_ip: float
    fewest: int
    most: int


class ChoiceLevel(Fields):
    rp: float
    level_index: int
    triangle_count: int
    rp_reached: float
    reached: bool
    area: float
    volume: float
    eps_s: float
    ip: float
    worst_eps_s: float
    robust_ip: float
    errors: dict[str, float]


class Noise(Fields):
    found: bool
    area: float
    fraction: float
    level_index: int
    triangle_count: int


class ClumpGap(Fields):
    mean: float
    maximum: float


class Clump(Fields):
    sphere_count: int
    iou: float
    union_volume: float
    volume_error: float
    centroid_error: float
    inertia_error: float
    to_mesh: ClumpGap
    from_mesh: ClumpGap
    roughness: float
    slope_deg: float
    outside: float
    useless_count: int
    volume_criterion: float
    distance_criterion: float


class Measures(Fields):
    closed: bool
    inward: bool
    has_volume: bool
    area: float
    volume: float
    centroid: Any
    inertia: Any
    principal_moments: Any
    principal_axes: Any
    equivalent_diameter: float
    sphericity: float
    box_min: Any
    box_max: Any
    dimensions: Any
    oriented_dimensions: Any
    oriented_axes: Any
    oriented_center: Any
    hull_area: float
    hull_volume: float
    convexity: float


class Topology(Fields):
    vertex_count: int
    unused_vertex_count: int
    edge_count: int
    facet_count: int
    shell_count: int
    inward_shell_count: int
    boundary_edge_count: int
    boundary_count: int
    non_manifold_edge_count: int
    non_manifold_vertex_count: int
    inconsistent_edge_count: int
    degenerate_facet_count: int
    duplicate_facet_count: int
    euler_characteristic: int
    genus: int
    closed: bool
    manifold: bool
    oriented: bool


class Deviation(Fields):
    mean: float
    rms: float
    maximum: float
    maximum_bound: float
    at: Any
    sample_count: int


class Distance(Fields):
    forward: Deviation
    backward: Deviation
    hausdorff: float
    hausdorff_bound: float


class Descriptors(Fields):
    elongation: float
    flatness: float
    zingg: str
    krumbein_sphericity: float
    roundness: float
    angularity: float
    inscribed_radius: float
    inscribed_centre: Any
    bounding_radius: float
    bounding_centre: Any


class WallMending(Fields):
    welded: int
    flat: int
    joined: int
    doubled: int
    parted: int
    turned: int


class ParticleMeasures(Fields):
    kind: str
    volume: float
    size: float
    centre: Any
    orientation: Any
    inertia: Any
    bounding_radius: float
    thickness: float
    rounding: float
    triangle_count: int
    point_count: int
    edge_count: int


class Exported(Fields):
    rotation: Any
    translation: Any
    mass: float
    inertia: Any
    bounding_radius: float
    measures: Measures


class CodeWritten(Fields):
    piece_count: int
    volume_error: float
    inertia_error: float


class CurveFacts(Fields):
    method: str
    triangle_count: int
    floor_count: int
    shell_count: int
    boundary_edge_count: int
    locked_vertex_count: int
    closed: bool


class Level(Fields):
    triangle_count: int
    rp: float
    area: float
    volume: float
    quadric_error: float


class Observation(Fields):
    time: float
    kinetic: float
    rotational: float
    potential: float
    elastic: float
    dissipated_dashpot: float
    dissipated_friction: float
    fracture: float
    wall_work: float
    applied_work: float
    momentum: Any
    angular_momentum: Any
    mean_rotation: float
    largest_overlap: float
    highest_speed: float
    coordination: float
    body_count: int
    removed_count: int
    broken_joints: int
    pair_count: int
    depenetrating_pairs: int
    contact_count: int
    depenetration_count: int
    hardened_count: int
    stiffness_missing: float


class MaterialContact(Fields):
    restitution: float
    friction: float
    rolling_friction: float
    pull_off: float
    surface_energy: float


KINDS.update({
    "scree_checksum": Checksum,
    "scree_cut_plane": CutPlane,
    "scree_check": Check,
    "scree_repair_report": RepairReport,
    "scree_pick": Pick,
    "scree_choice_level": ChoiceLevel,
    "scree_noise": Noise,
    "scree_clump_gap": ClumpGap,
    "scree_clump": Clump,
    "scree_measures": Measures,
    "scree_topology": Topology,
    "scree_deviation": Deviation,
    "scree_distance": Distance,
    "scree_descriptors": Descriptors,
    "scree_wall_mending": WallMending,
    "scree_particle_measures": ParticleMeasures,
    "scree_exported": Exported,
    "scree_code_written": CodeWritten,
    "scree_curve_facts": CurveFacts,
    "scree_level": Level,
    "scree_observation": Observation,
    "scree_material_contact": MaterialContact,
})
