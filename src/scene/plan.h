/* What a scene's file says: plain records, in an arena. */
#pragma once

#include "base/schema.h"

#define SCREE_PLAN_UNITS "m|cm|mm|um|inch|ft|km"

typedef struct scree_plan_material {
  scree_place place;
  double young, density, restitution, friction, rolling_friction, surface_energy, poisson;
} scree_plan_material;

typedef struct scree_plan_pair {
  scree_place place;
  scree_texts between;
  double restitution, friction, rolling_friction, surface_energy, pull_off, wear;
} scree_plan_pair;

/* Rosin-Rammler: size d', spread n; lognormal: median, standard deviation of the logarithm. */
typedef struct scree_plan_rosin_rammler {
  scree_place place;
  double size, spread;
} scree_plan_rosin_rammler;

typedef struct scree_plan_lognormal {
  scree_place place;
  double median, deviation;
} scree_plan_lognormal;

/* One of distribution, rosin_rammler, lognormal, uniform. */
typedef struct scree_plan_size {
  scree_place place;
  scree_table distribution;
  scree_plan_rosin_rammler *rosin_rammler;
  scree_plan_lognormal *lognormal;
  bool uniform, cumulative;
  int by; /* 0 mass, 1 number */
  double least, most;
  size_t classes;
} scree_plan_size;

/* One of file, sample, sphere, clump (a table), box; a clump that is a count is one of the others'
 * surface. */
typedef struct scree_plan_shape {
  scree_place place;
  const char *file, *sample, *clump, *triangles, *rp, *material;
  double sphere, box[3], resolution, noise, density;
  uint64_t sample_seed;
  int unit, method, mass_from; /* mass_from: 0 mesh, 1 scan */
  bool repair;
  scree_plan_size *size;
  double scaled; /* m: to this size; NAN: as it is (of scree_plan_expand, as family) */
  size_t family; /* index among the families */
} scree_plan_shape;

/* Spheres of the clump that stands for the shape's surface; 0: its clump is a table, or none. */
size_t scree_plan_spheres(const scree_plan_shape *shape);

typedef struct scree_plan_turn {
  scree_place place;
  double axis[3], angle_deg;
} scree_plan_turn;

typedef struct scree_plan_disc {
  scree_place place;
  double normal[3], radius;
} scree_plan_disc;

/* Of geometry, and as the region of an inlet. */
typedef struct scree_plan_cylinder {
  scree_place place;
  double at[3], axis[3], radius, length;
} scree_plan_cylinder;

typedef struct scree_plan_box {
  scree_place place;
  double min[3], max[3];
} scree_plan_box;

typedef struct scree_plan_translate {
  scree_place place;
  double velocity[3], along[3];
  scree_table table, positions;
} scree_plan_translate;

typedef struct scree_plan_rotate {
  scree_place place;
  double axis[3], through[3], speed;
  double amplitude, frequency, phase; /* rad, Hz, rad: it rocks */
  scree_table table, positions;
} scree_plan_rotate;

typedef struct scree_plan_vibrate {
  scree_place place;
  double along[3], amplitude, frequency, phase;
} scree_plan_vibrate;

typedef struct scree_plan_crank {
  scree_place place;
  double along[3], radius, rod, speed, phase;
} scree_plan_crank;

/* The copies are carried along their way. */
typedef struct scree_plan_travel {
  scree_place place;
  double speed;
} scree_plan_travel;

/* Rows of time and value, one table for each of x, y, z and the angles about them. */
enum { SCREE_PATH_COLUMNS = 6 };
typedef struct scree_plan_path {
  scree_place place;
  const char *file;
  double through[3];
  scree_table tables[SCREE_PATH_COLUMNS]; /* without rows: not there */
  bool is_read;                           /* scree_scene_read_paths */
} scree_plan_path;

typedef struct scree_plan_motion {
  scree_place place;
  scree_plan_translate *translate;
  scree_plan_rotate *rotate;
  scree_plan_vibrate *vibrate;
  scree_plan_crank *crank;
  scree_plan_travel *round;
  scree_plan_path *path;
  double from, until;
  const char *during; /* a phase */
} scree_plan_motion;

/* Four endless planes about a vertical axis. */
typedef struct scree_plan_shaft {
  scree_place place;
  double width, depth;
} scree_plan_shaft;

/* Keeps a force (N) or torque (N m) on bodies; speed: m/s or rad/s, at most. */
typedef struct scree_plan_servo {
  scree_place place;
  double force, speed;
} scree_plan_servo;

/* What moves by forces along one coordinate, a slide (m) or a hinge (rad). */
typedef struct scree_plan_part {
  scree_place place;
  double axis[3], through[3], centre[3]; /* of a hinge: a point of its axis, the centre of mass */
  double mass, inertia, spring, rest, damper;
  double force, amplitude, frequency; /* of the drive; of a hinge a torque */
  double from, least, most;
  scree_plan_servo *servo;
} scree_plan_part;

/* A sheet round two wheels, of which one is at the geometry's origin. */
typedef struct scree_plan_loop {
  scree_place place;
  double axis[3], span[3], radius, width;
} scree_plan_loop;

/* A flight of a helix about its axis, from the geometry's origin on, and its shaft. */
typedef struct scree_plan_screw {
  scree_place place;
  double axis[3], radius, shaft, pitch, length, thickness;
} scree_plan_screw;

/* A plate with round holes in a square pattern, about the geometry's origin: size along x and y; or
 * bent about a line of that radius above it, along y. */
typedef struct scree_plan_sieve {
  scree_place place;
  double size[3], hole, pitch, bend;
} scree_plan_sieve;

/* The surface of closed loops about an axis runs along itself. */
typedef struct scree_plan_belt {
  scree_place place;
  double axis[3], speed;
} scree_plan_belt;

/* Copies at equal ways round two wheels `span` apart, of which one is at `through`, from the strand
 * that leads to the other on; without a span about the axis. */
typedef struct scree_plan_round {
  scree_place place;
  double axis[3], through[3], span[3], radius;
  size_t count;
} scree_plan_round;

/* One of file, box, plane, disc, cylinder, shaft, loop, screw, sieve. */
typedef struct scree_plan_geometry {
  scree_place place;
  scree_texts file;
  const char *material;
  int unit, side; /* side: 0 auto, 1 outside, 2 inside, 3 both */
  double box[3], plane[3], at[3], surface_velocity[3];
  scree_plan_disc *disc;
  scree_plan_cylinder *cylinder;
  scree_plan_shaft *shaft;
  scree_plan_loop *loop;
  scree_plan_screw *screw;
  scree_plan_sieve *sieve;
  scree_plan_belt *belt;
  scree_plan_turn *turn;
  scree_plan_round *copies;
  scree_records motion; /* of scree_plan_motion */
  scree_plan_part *slide, *hinge;
} scree_plan_geometry;

typedef struct scree_plan_layers {
  scree_place place;
  const char *in;    /* a geometry: what they cover */
  int packed, begin; /* 0 random, 1 grid; 0 at the bottom, 1 at the top */
  double pack_time, above, bottom, clearance;
} scree_plan_layers;

typedef struct scree_plan_inlet {
  scree_place place;
  scree_plan_layers *layers;
  scree_plan_box *box;
  scree_plan_cylinder *cylinder;
  scree_weights shapes;
  double rate, mass_rate, from, until, velocity[3];
  size_t count;
  int orientation; /* 0 random, 1 fixed */
} scree_plan_inlet;

typedef struct scree_plan_outlet {
  scree_place place;
  scree_plan_box *box;
  double from, until;
} scree_plan_outlet;

typedef struct scree_plan_domain {
  scree_place place;
  double min[3], max[3];
  scree_texts periodic;
} scree_plan_domain;

typedef struct scree_plan_flow {
  scree_place place;
  double through[3], normal[3], radius;
} scree_plan_flow;

typedef struct scree_plan_region {
  scree_place place;
  scree_plan_box *box;
} scree_plan_region;

typedef struct scree_plan_pile {
  scree_place place;
  double floor, cell, disc, reach, size, every;
  double band_low, band_high;
  size_t sectors;
  scree_texts during;
} scree_plan_pile;

typedef struct scree_plan_slope {
  scree_place place;
  double axis[3];
  scree_plan_box *box; /* NULL: all bodies */
} scree_plan_slope;

typedef struct scree_plan_segregation {
  scree_place place;
  double cells;
  int by; /* SCREE_BY_... */
} scree_plan_segregation;

typedef struct scree_plan_impacts {
  scree_place place;
  int by; /* 0 shape, 1 material */
  double least, most, threshold, window;
  size_t bins;
} scree_plan_impacts;

typedef struct scree_plan_grid {
  scree_place place;
  scree_plan_box *box;
  scree_plan_cylinder *cylinder;
  double cells[3], width, every;
  const char *with; /* a geometry */
} scree_plan_grid;

typedef struct scree_plan_residence {
  scree_place place;
  int by;                     /* SCREE_BY_... */
  const char *inlet, *outlet; /* NULL: any */
  size_t bins;
} scree_plan_residence;

/* One of them. */
typedef struct scree_plan_sensor {
  scree_place place;
  double from, until; /* s: what is gathered, and means; until NaN: to the end */
  scree_plan_flow *flow;
  scree_plan_region *region;
  const char *wall, *position, *part; /* of a geometry */
  scree_plan_pile *pile;
  scree_plan_slope *slope;
  scree_plan_segregation *segregation;
  scree_plan_residence *residence;
  scree_plan_impacts *impacts;
  scree_plan_grid *grid;
} scree_plan_sensor;

/* law: 0 Schiller and Naumann, 1 Stokes */
typedef struct scree_plan_drag {
  scree_place place;
  double density, viscosity, velocity[3];
  int law;
  bool buoyancy;
} scree_plan_drag;

/* One of force, acceleration, per_volume, drag. */
typedef struct scree_plan_force {
  scree_place place;
  scree_texts of;
  scree_plan_box *box;
  scree_plan_cylinder *cylinder;
  double from, until, force[3], acceleration[3], per_volume[3];
  scree_plan_drag *drag;
  int by; /* of the table: 0 x, 1 y, 2 z, 3 t */
  scree_table table;
} scree_plan_force;

typedef struct scree_plan_stop {
  scree_place place;
  double still, rest, filled, after;
  bool empty;
} scree_plan_stop;

typedef struct scree_plan_phase {
  scree_place place;
  double time, still, rest;
  bool filled, early;
  const char *clear; /* a geometry */
} scree_plan_phase;

typedef struct scree_plan_output {
  scree_place place;
  double frames, series, checkpoint, motion;
  int bodies; /* of frames: 0 instances, 1 surfaces */
} scree_plan_output;

typedef struct scree_plan_bodies {
  scree_place place;
  const char *file;
} scree_plan_bodies;

typedef struct scree_plan_contact {
  scree_place place;
  int law;
  double steps, stiffness_factor, tangential_ratio, time_step;
} scree_plan_contact;

/* A name for fields that are set together. */
typedef struct scree_scene_parameter {
  scree_place place;
  const char *name;
  scree_texts sets;
  double factor, least, most;
  double below, power; /* of the size of the largest shape over `below`, where it is less */
} scree_scene_parameter;

typedef struct scree_plan_preset {
  scree_place place;
  const char *name, *about;
  scree_values set;
} scree_plan_preset;

typedef struct scree_plan {
  scree_place place;
  const char *title, *preset;
  double time, gravity[3];
  uint64_t seed;
  size_t tick;
  scree_plan_contact *contact;
  scree_records families; /* the shapes of the file (scree_plan_expand) */
  scree_records materials, pairs, shapes, geometry, inlets, outlets, sensors, phases, forces;
  scree_records parameters, presets;
  scree_plan_domain *domain;
  scree_plan_bodies *bodies;
  scree_plan_stop *stop;
  scree_plan_output *output;
} scree_plan;

extern const scree_record scree_plan_record;
/* plan_check.c: of a whole scree_plan, whose records are good each. */
scree_status scree_plan_check(const scree_reader *reader, const void *plan);

/* sizes.c: a class of a distribution of sizes. */
typedef struct scree_size_class {
  double size, share; /* m, the diameter of the sphere of equal volume; by number, all together 1 */
} scree_size_class;
/* In the arena; of as much mass and number as the distribution has in them. NULL: no memory. */
scree_size_class *scree_plan_size_classes(const scree_plan_size *size, scree_arena *arena,
                                          size_t *count);
/* A shape of many sizes becomes one for each class, in inlets by its share. */
scree_status scree_plan_expand(scree_plan *plan, scree_arena *arena, scree_error *error);
extern const scree_record scree_plan_size_record;
/* plan_solids.c */
extern const scree_record scree_plan_loop_record, scree_plan_screw_record, scree_plan_sieve_record,
    scree_plan_belt_record, scree_plan_copies_record;
/* plan_motions.c */
extern const scree_record scree_plan_motion_record;
/* plan_parts.c */
extern const scree_record scree_plan_slide_record, scree_plan_hinge_record;
/* plan_forces.c */
extern const scree_record scree_plan_force_record;

/* Reads and checks it all but the files it names. */
scree_status scree_plan_read(const scree_reader *reader, const scree_yaml *root, scree_plan *plan);

/* The records by index. */
#define SCREE_PLAN_AT(plan, list, type, index) (&((const type *)(plan)->list.items)[index])

/* Index of the named record; its count where there is none. */
size_t scree_plan_find(const scree_records *records, size_t size, const char *name);
/* Metres of the unit. */
double scree_plan_unit(int unit);
