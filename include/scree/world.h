/* World: bodies, walls, contacts, time. */
#ifndef SCREE_WORLD_H
#define SCREE_WORLD_H

#include "scree/particle.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Bodies under gravity, touching each other and walls by the law of docs/background/physics.md. A
 * world is one thread's at a time, for reading too: what is read may first have to come back from a
 * device. */
typedef struct scree_world scree_world;

typedef enum scree_law {
  SCREE_LAW_LINEAR,     /* spring, dashpot, Coulomb slider: the paper's */
  SCREE_LAW_HYSTERETIC, /* Walton and Braun 1986: loading K, unloading K/e2, no dashpot */
  SCREE_LAW_HERTZ, /* Hertz and Mindlin, damped as by Tsuji and others 1992, where a sphere or a
                      clump touches anything; two meshes touch by the linear law */
  SCREE_LAW_COUNT
} scree_law;

/* What mu_r b F limits of rolling resistance: the whole couple; or its spring alone, to which a
 * dashpot is added until it is there, as in LIGGGHTS's EPSD: heaps of spheres are 6 % steeper. */
typedef enum scree_rolling { SCREE_ROLLING_COUPLE, SCREE_ROLLING_EPSD } scree_rolling;

typedef struct scree_world_options {
  double gravity[3];        /* m/s2; default 0 0 -9.81 */
  scree_law law;            /* default linear (Katagiri and Koyanaka 2020) */
  double steps_per_contact; /* N, dt = (pi/2) sqrt(m/K)/N for the lightest and stiffest pair;
                               at least 15; default 20, 40 for energy to 2 % */
  double time_step;         /* s; 0 (default): by steps_per_contact; else at most that of N = 15 */
  double stiffness_factor; /* multiplies every stiffness, for speed; default 1. Overlaps grow by its
                              inverse, the time step by its inverse root */
  double tangential_ratio; /* tangential over normal stiffness, in (0, 1]; default 1 (Rocky) */
  double size;             /* m, the L of K = E L; 0 (default): each pair its smaller body's */
  double smoothing;        /* l0 over L; default 4e-5, 2 um at 50 mm: overlaps this close share */
  double sharing;          /* kappa, in [0, 0.5]; default 0.1: deeper contacts share more widely */
  scree_rolling rolling;   /* default SCREE_ROLLING_COUPLE */
  double overlap_limit;    /* over L; default 0.1, 5 mm at 50 mm: beyond it springs harden
                              (scree_world_get_hardening); at four times that meshes part
                              (depenetration_count), else the run stops with SCREE_DIVERGED. Walls
                              may be thinner: a point keeps to the side that it came from */
  double skin;             /* over L; default 0.02: reach of the candidate lists. Speed only */
  double floor_height;     /* m; bodies whose centre falls below are removed; default -infinity */
  double period[3];        /* m, along x, y and z: what leaves at one side enters at the other; 0
                              (default): no period. At least three times the diameter of the largest
                              body's bounding sphere; walls must look the same one period on:
                              planes along it, endless cylinders about it */
  double period_from[3];   /* m, where a period begins: the places of bodies are told from there on
                              to a period further; default 0 */
} scree_world_options;
SCREE_API scree_world_options scree_default_world_options(void);

typedef struct scree_material {
  double young;            /* N/m2, the E of K = E L; default 1e8; 1e11 for walls (the paper); of
                              SCREE_LAW_HERTZ Young's modulus */
  double density;          /* kg/m3; default 2000 (not in the paper) */
  double restitution;      /* in (0, 1]; default 0.3 (the paper) */
  double friction;         /* at least 0; default 0.5 (the paper) */
  double rolling_friction; /* at least 0; default 0: rolls freely */
  double surface_energy;   /* J/m2, at least 0; default 0: does not stick */
  double poisson;          /* in [0, 0.5]; default 0.3; of SCREE_LAW_HERTZ */
} scree_material;
SCREE_API scree_material scree_default_material(void);
SCREE_API scree_material scree_default_wall_material(void);

/* options may be NULL; they are copied. */
SCREE_API scree_status scree_world_create(const scree_world_options *options, scree_world **world,
                                          scree_error *error);
SCREE_API void scree_world_free(scree_world *world);
SCREE_API void scree_world_get_options(const scree_world *world, scree_world_options *options);

/* Between two materials: the lower of each property, unless given by
 * scree_world_set_contact or scree_world_set_pair. At most 64 materials. */
SCREE_API scree_status scree_world_add_material(scree_world *world, const scree_material *material,
                                                size_t *index, scree_error *error);
SCREE_API scree_status scree_world_set_contact(scree_world *world, size_t material_a,
                                               size_t material_b, double restitution,
                                               double friction, scree_error *error);

/* What two materials do to each other. */
typedef struct scree_material_contact {
  double restitution, friction; /* as of scree_material */
  double rolling_friction; /* mu_r: bodies resist rolling with a torque of up to mu_r b F, 1/b the
                              sum of 1/b of both, how far a centre is from where they press, along
                              the normal, r of a sphere (docs/background/physics.md) */
  double pull_off;         /* N with which any two that touch hold each other; default 0 */
  double surface_energy;   /* J/m2, w: holds with 3/2 pi w R besides, the pull-off force of Johnson,
                              Kendall and Roberts 1971; 1/R the sum of both sides' 1/r, where r of
                              what is no sphere is half its size (scree_particle_measures) and a wall
                              has none */
} scree_material_contact;
/* Read, edit, set: so what is not edited stays as it is. The pair is any two of the world's
 * materials, or one with itself. */
SCREE_API scree_status scree_world_get_pair(const scree_world *world, size_t material_a,
                                            size_t material_b, scree_material_contact *contact,
                                            scree_error *error);
SCREE_API scree_status scree_world_set_pair(scree_world *world, size_t material_a,
                                            size_t material_b,
                                            const scree_material_contact *contact,
                                            scree_error *error);

typedef enum scree_wall_kind {
  SCREE_WALL_PLANE,    /* through position, solid behind, normal along axis */
  SCREE_WALL_DISC,     /* the plane cut off at radius, a sheet met from both sides */
  SCREE_WALL_CYLINDER, /* a sheet; from position along axis over length (0: endless). The rims of
                          discs and cylinders are polygons of 720 points and edges, which touch
                          faces and edges as those of a body do */
  SCREE_WALL_MESH, /* any consistently wound triangles, two at an edge or, where a sheet ends, one.
                      An open one is a sheet, a closed one solid behind its facets: one that is
                      wound inwards holds what is in it */
} scree_wall_kind;

typedef struct scree_wall {
  scree_wall_kind kind;
  size_t material;
  double position[3]; /* m; for a mesh: where its origin goes */
  double axis[3];     /* of any length; a mesh is turned so that its z axis points along it */
  double radius;      /* m, disc and cylinder */
  double length;      /* m, cylinder; 0: endless */
  const scree_mesh *mesh;
  bool two_sided;             /* a closed mesh too is a sheet, with bodies on both sides */
  double velocity[3];         /* m/s, prescribed; may be changed at any time */
  double angular_velocity[3]; /* rad/s about position */
  /* Of its surface while the wall itself stays where it is, as of a belt or a roller: m/s, and
   * rad/s about position, in space as the wall stands now; they turn with it. What points out of
   * the surface does not count. */
  double surface_velocity[3], surface_angular_velocity[3];
  /* Of a mesh that is a belt round pulleys: its surface runs about this direction, right-handed,
   * with its length as speed, m/s. A facet of normal n moves along surface_loop x n, from either
   * side; one that is square to the direction, as a solid belt's flank, stands. */
  double surface_loop[3];
} scree_wall;

SCREE_API scree_status scree_world_add_wall(scree_world *world, const scree_wall *wall,
                                            size_t *index, scree_error *error);
SCREE_API size_t scree_world_wall_count(const scree_world *world);
/* The wall as it stands now; its mesh, if any, is the world's. */
SCREE_API void scree_world_get_wall(const scree_world *world, size_t index, scree_wall *wall);
/* How its own frame is turned now (w x y z): the mesh's axes into space. */
SCREE_API void scree_world_wall_orientation(const scree_world *world, size_t index,
                                            double orientation[4]);
SCREE_API scree_status scree_world_set_wall_velocity(scree_world *world, size_t index,
                                                     const double velocity[3],
                                                     const double angular_velocity[3],
                                                     scree_error *error);
/* As of scree_wall. */
SCREE_API scree_status scree_world_set_wall_surface(scree_world *world, size_t index,
                                                    const double velocity[3],
                                                    const double angular_velocity[3],
                                                    const double loop[3], scree_error *error);

/* How a wall moves: a way along a direction or an angle about an axis, as a function of time. */
typedef enum scree_motion_law {
  SCREE_MOTION_CONSTANT,  /* at `speed` */
  SCREE_MOTION_SINE,      /* amplitude sin(2 pi frequency (t - from) + phase) */
  SCREE_MOTION_POSITIONS, /* straight between the rows of `table`; held before and after */
  SCREE_MOTION_SPEEDS,    /* the speed is; held before and after */
  SCREE_MOTION_CRANK, /* a sliding crank's: amplitude cos(q) + sqrt(rod^2 - amplitude^2 sin(q)^2),
                         q = 2 pi frequency (t - from) + phase */
} scree_motion_law;

typedef struct scree_wall_motion {
  scree_motion_law law;
  bool turns;                         /* about the axis through `through`; else along it */
  double axis[3];                     /* of any length above 0, in space */
  double through[3];                  /* m, a point of the axis about which it turns */
  double speed;                       /* m/s or rad/s */
  double amplitude, frequency, phase; /* m or rad; Hz; rad */
  double rod;                         /* m, of a crank: longer than the amplitude, its radius */
  double radius; /* m; above 0: it is carried round two wheels of this radius, of which one is at
                    `through` and the other further by `span`, square to the axis or 0; right-handed
                    about the axis, by m and m/s. It stands as a way of `start` from the beginning
                    of the strand that leads to the other wheel has turned it; one whose first
                    motion was of that kind already goes on from where that is */
  double span[3], start; /* m */
  const double *table;   /* row_count rows of a time (s, growing) and a value (m, m/s,
                            rad or rad/s) */
  size_t row_count;
  double from, until; /* s of the world's time; before and after it holds still */
} scree_wall_motion;
/* At rest along z from time 0 on, without an end. */
SCREE_API scree_wall_motion scree_default_wall_motion(void);

/* The wall moves so from now on, instead of by its velocity; no motions let it stand. Where it is
 * at any time is a closed function of time: each motion in turn moves the wall and all that the
 * motions before it have done, by what its law has come to since now. A pan that swings on a
 * turning table: first the swing, then the turn. Motions and tables are copied. */
SCREE_API scree_status scree_world_set_wall_motion(scree_world *world, size_t index,
                                                   const scree_wall_motion *motions, size_t count,
                                                   scree_error *error);

/* Force and torque about its position, N and N m, on the wall from all bodies in the last step. */
SCREE_API void scree_world_wall_force(const scree_world *world, size_t index, double force[3],
                                      double torque[3]);
/* What the wall, moving or by its surface, does on bodies: W in the last step, and J since the
 * start. */
SCREE_API void scree_world_wall_power(const scree_world *world, size_t index, double *power,
                                      double *energy);

typedef struct scree_body {
  double position[3];         /* m, centre of mass */
  double orientation[4];      /* w x y z, unit; particle's axes into space */
  double velocity[3];         /* m/s */
  double angular_velocity[3]; /* rad/s, in space */
} scree_body;

/* A body at rest at the origin with its axes along space's. */
SCREE_API scree_body scree_default_body(void);
/* Bodies may be added at any time, also between steps; index counts up and stays. One that lies in
 * another body or in a wall shows in the next step's status, with both named and how deep. state
 * may be NULL. */
SCREE_API scree_status scree_world_add_body(scree_world *world, scree_particle *particle,
                                            size_t material, const scree_body *state, size_t *index,
                                            scree_error *error);
/* Gives a body another density (kg/m3, above 0) than its material's: mass and inertia follow, its
 * velocities stay, its contacts begin anew. */
SCREE_API scree_status scree_world_set_body_density(scree_world *world, size_t index,
                                                    double density, scree_error *error);
/* All ever added, removed ones included. */
SCREE_API size_t scree_world_body_count(const scree_world *world);
SCREE_API bool scree_world_body_removed(const scree_world *world, size_t index);
SCREE_API void scree_world_get_body(const scree_world *world, size_t index, scree_body *state);
/* The same of `count` bodies from `first` on, into arrays of 3, 4, 3 and 3 numbers a body; NULL for
 * what is not asked for. A removed body's are those it was removed with. */
SCREE_API void scree_world_get_bodies(const scree_world *world, size_t first, size_t count,
                                      double *positions, double *orientations, double *velocities,
                                      double *angular_velocities);
/* A force through its centre (N) and a torque (N m), in space, that act on a body in every step
 * until they are set anew; zero ends them. Their work is booked in the ledger. */
SCREE_API scree_status scree_world_set_body_force(scree_world *world, size_t index,
                                                  const double force[3], const double torque[3],
                                                  scree_error *error);
/* Puts a body into another state. SCREE_BAD_ARGUMENT, as of scree_world_add_body, where a value is
 * not finite or the orientation has no length; the body then stays as it is. */
SCREE_API scree_status scree_world_set_body(scree_world *world, size_t index,
                                            const scree_body *state, scree_error *error);
SCREE_API scree_particle *scree_world_body_particle(const scree_world *world, size_t index);
SCREE_API size_t scree_world_body_material(const scree_world *world, size_t index);
SCREE_API double scree_world_body_mass(const scree_world *world, size_t index);
/* Takes a body out; its index stays and is not used again. */
SCREE_API void scree_world_remove_body(scree_world *world, size_t index);

/* Where this world is stepped from now on, by the names of scree_set_backend, with the same bits.
 * It may go from one to the other at any time, but not from one device to another. */
SCREE_API scree_status scree_world_set_backend(scree_world *world, const char *name,
                                               scree_error *error);
/* Advances by step_count steps. SCREE_DIVERGED, with step, body and cause in the message, when the
 * run leaves the model's range: two are pressed through each other, a body moves by more than the
 * overlap limit in one step or two past each other by more than the thinner's thinnest wall, bodies
 * put into each other by more than their roundings, a value that is not finite. The world then
 * stands as after the last good step, readable, and refuses to go on. Same bits for every number of
 * threads. Once warm, a step allocates nothing. About 1 to 2 us per body and step at rest on one
 * core. */
SCREE_API scree_status scree_world_step(scree_world *world, size_t step_count, scree_error *error);
SCREE_API double scree_world_time(const scree_world *world);
SCREE_API uint64_t scree_world_step_count(const scree_world *world);
/* s; with what there is in the world now. The reason, when not NULL, becomes one sentence. */
SCREE_API double scree_world_time_step(const scree_world *world, char reason[256]);

/* The state of the whole, at the time of the last force evaluation; velocities are taken at the
 * same moment (the mean of before and after the kick), so that energies balance. */
typedef struct scree_observation {
  double time;                                    /* s */
  double kinetic, rotational, potential, elastic; /* J; potential of gravity, zero at the origin */
  double dissipated_dashpot,
      dissipated_friction;                 /* J since the start; hysteresis counts as dashpot */
  double fracture;                         /* J that breaking joints freed since the start */
  double wall_work;                        /* J done on bodies by moving walls since the start */
  double applied_work;                     /* J by forces of scree_world_set_body_force */
  double momentum[3], angular_momentum[3]; /* N s; N m s about the origin */
  double mean_rotation;                    /* rad/s, mean of |omega| (the paper's Fig. 7) */
  double largest_overlap;                  /* m, in the last step */
  double highest_speed;                    /* m/s */
  double coordination;                     /* mean number of touching bodies and walls */
  size_t body_count, removed_count;        /* that are in the world; that were taken out */
  size_t broken_joints;                    /* since the start */
  size_t pair_count;                       /* touching pairs of bodies, and of body and wall */
  size_t depenetrating_pairs;   /* of them, those that held each other and are being moved apart */
  size_t contact_count;         /* touching features */
  uint64_t depenetration_count; /* how often two bodies that held each other had to be moved apart
                             since the start (docs/background/physics.md); 0 in most runs */
  uint64_t hardened_count;      /* how often two bodies were pressed beyond the overlap limit, where
                             their spring hardens, since the start */
  double stiffness_missing; /* by this factor stiffer no spring would have hardened; 0: none did */
} scree_observation;
/* How often bodies of two materials were pressed beyond their overlap limit, where their spring
 * hardens, since the start; the largest overlap over the limit; and the factor by which stiffer
 * springs would have kept them within: by what impacts bore of energy, or lasting contacts of
 * force. */
typedef struct scree_world_hardening {
  uint64_t count;
  double deepest, stiffness_missing;
} scree_world_hardening;
SCREE_API scree_world_hardening scree_world_get_hardening(const scree_world *world,
                                                          size_t material_a, size_t material_b);
/* Cost one pass over the bodies. */
SCREE_API void scree_world_observe(const scree_world *world, scree_observation *observation);

/* One touching feature of the last step. */
typedef struct scree_contact {
  size_t body, other; /* other: a body, or with `wall` a wall */
  bool wall;
  double position[3];     /* m */
  double normal[3];       /* towards `body` */
  double force[3];        /* N, on `body`, normal and tangential */
  double overlap, weight; /* m; part of the pair's spring, at most 1/(1 - kappa) in all */
} scree_contact;
/* Calls for every touching feature in a fixed order, from a fresh evaluation of forces at the
 * present positions, with the mean of the last step where a pair takes it in parts; changes
 * nothing. False from the callback ends it. */
typedef bool scree_contact_visitor(void *context, const scree_contact *contact);
SCREE_API scree_status scree_world_visit_contacts(const scree_world *world,
                                                  scree_contact_visitor *visit, void *context,
                                                  scree_error *error);

/* Where the time went since creation: seconds of wall clock per stage, and counts. */
typedef struct scree_timings {
  double broad, candidates, contacts, bodies, total; /* s; candidates is part of contacts */
  uint64_t steps, broad_builds, list_builds, feature_evaluations, closest_queries, pair_evaluations;
} scree_timings;
SCREE_API void scree_world_timings(const scree_world *world, scree_timings *timings);

/* Names the state: every bit of positions, velocities, contact memory and time. */
SCREE_API scree_checksum scree_world_hash(const scree_world *world);

/* Writes a checkpoint (docs/reference/formats.md): everything in the world, its particles included,
 * so that the file stands alone; timings are not in it. It is complete under its name or not there
 * ("-" is stdout). Without overwrite an existing file is refused with SCREE_EXISTS. Needs memory
 * for the file's size: about 100 bytes a triangle of each particle, 500 a body, 1 to 3 KB a pair.
 */
SCREE_API scree_status scree_world_save(const scree_world *world, const char *path, bool overwrite,
                                        scree_error *error);
/* Reads a checkpoint ("-" is stdin); free *world with scree_world_free. Every later step has the
 * same bits as in the world that was saved, for any number of threads. Particles are the world's
 * own (scree_world_body_particle); a removed body keeps its. SCREE_BAD_FILE, with file and reason,
 * for what is no checkpoint, is of another version, is cut short or has a bit changed anywhere. */
SCREE_API scree_status scree_world_load(const char *path, scree_world **world, scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
