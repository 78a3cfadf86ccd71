/* The world's own structures. Only src/world sees them; docs/background/physics.md has the
 * equations. */
#pragma once

#include "base/array.h"
#include "base/codec.h"
#include "base/prefetch.h"
#include "particle/particle.h"
#include "world/state/pair.h"
#include "world/state/spheres.h"

#include <stdatomic.h>

enum { SCREE_MATERIALS = 64 };
static const uint32_t scree_none = UINT32_MAX; /* of an index: there is none */

/* Pose and motion of a body or wall, as the contact code reads it. */
typedef struct scree_frame {
  vec3 position, velocity, spin; /* spin: angular velocity in space; both of the last drift */
  vec3 velocity_now, spin_now;   /* half a step on, by the last forces: for the dashpots */
  mat3 rotation;                 /* own axes into space */
} scree_frame;

typedef struct scree_material_pair {
  scree_material_contact given;
  double damping_ratio, hertz_damping; /* eta; alpha, 0 where the law is not Hertz's */
} scree_material_pair;

typedef struct scree_world_wall {
  scree_wall given; /* position and velocity kept up to date */
  scree_frame frame;
  quat orientation;
  scree_particle *surface; /* faces of a mesh wall, or rims of a disc or cylinder; NULL: none */
  double travel, path;     /* most that its points within reach move in the last or the coming step;
                              the sum of what they moved */
  double path_at_build;    /* when the pairs were made; below 0: it is new */
  double reach;            /* from its position: farther out there is none of it, or no body */
  double slack;            /* by which it may move before the pairs must be made again */
  vec3 force, torque;      /* on the wall in the last step, about its position */
  vec3 surface_velocity, surface_spin, surface_loop; /* of a belt, in the wall's own frame */
  uint64_t summed;     /* the step whose forces these are (scree_wall_sum) */
  double power, work;  /* done on bodies: W in that step; J until then */
  double energy;       /* the part of that work that was done on those that are no more near */
  vec3 start_position; /* when its motions were set */
  quat start_orientation;
  size_t motion_count; /* its own in world->motions, after those of the walls before it */
} scree_world_wall;

/* A motion of a wall (motion.c); its axis has length 1. */
typedef struct scree_motion_state {
  uint32_t law;
  bool turns;
  vec3 axis, through, span;
  double speed, amplitude, frequency, phase, rod, radius, start, from, until;
  double origin;    /* what its law was at when it was set */
  size_t row_count; /* its own in world->motion_rows, after those of the motions before it */
} scree_motion_state;

typedef struct scree_motion_row {
  double time, value;
  double sum; /* of speeds: the way since the first row */
} scree_motion_row;

/* Force and torque of scree_world_set_body_force. */
typedef struct scree_applied {
  scree_wrench now, last; /* last: of the last step */
  double work;            /* J, done so far */
} scree_applied;

/* Work, J: of dashpots and of tangential forces on two neighbours, and of a wall on a body. Each
 * enters its own while they are neighbours, then it is the first body's or the wall's. So no step
 * adds anything up. */
typedef struct scree_balance {
  double dashpot, tangential, wall;
} scree_balance;

/* Bodies, one array per field; those of the same index are one body. */
typedef struct scree_bodies {
  scree_frame *frame;
  quat *orientation;
  vec3 *momentum; /* angular momentum in space, about the centre */
  vec3 *inertia;  /* principal moments */
  vec3 *force, *torque;
  double *mass;
  double *travel;         /* most any of its points moved in the last step */
  double *path;           /* sum of travel */
  scree_applied *applied; /* NULL: there never were any */
  scree_balance *balance; /* with those that are no more its neighbours; without walls' */
  vec3 *turn; /* angular velocity in the body's own frame after the coming kick (scratch) */
  scree_particle **particle;
  uint8_t *material;
  bool *removed;
  size_t count, capacity, removed_count;
} scree_bodies;

/* The lists of all pairs, one array a kind. A list that outgrows its place takes one behind `used`,
 * in a step by many threads at once. Where that is beyond the capacity the pair is evaluated again,
 * from the beginning, after the pools have grown (pool.c). */
enum { SCREE_FIRST_FEATURES = 2, SCREE_FIRST_SLEEPING = 8 }; /* places of a list that begins */
typedef struct scree_pools {
  scree_feature_pair *features;
  scree_further *further; /* of the feature pairs */
  scree_sleeping_feature *sleeping_features;
  uint64_t feature_capacity, sleeping_capacity;
  atomic_uint_least64_t features_used, sleeping_used;
  /* of a device, whose threads have no scratch of their own; else NULL */
  struct scree_contact_point *contacts;
  uint64_t contact_capacity;
  atomic_uint_least64_t contacts_used;
} scree_pools;

/* What is wrong after a step: the first neighbours of which it is, or scree_none. */
typedef struct scree_trouble {
  uint32_t start, pressed, too_fast, passed;
  double start_depth; /* how deep those lie in each other from the start, m */
} scree_trouble;

/* What two materials were pressed beyond the overlap limit, where springs harden, since the start.
 */
typedef struct scree_hardening {
  uint32_t count;            /* how often it began */
  uint64_t deepest, missing; /* bits of the largest overlap over the limit, and of the largest
                                scree_stiffness_missing */
} scree_hardening;

/* What is noted of the pairs of a step. */
typedef struct scree_tally {
  scree_trouble trouble;
  uint64_t largest_overlap; /* the bits of the number, which is not negative, m */
  uint32_t depenetrations;  /* begun */
  uint32_t hardened;        /* springs that were: what of them stands in materials.hardened */
} scree_tally;

/* How far some blocks of the neighbours have come in a step. */
typedef struct scree_pair_progress {
  uint32_t awake, done; /* of those that are awake */
  uint32_t given;       /* pairs that fell asleep */
  scree_tally tally;
} scree_pair_progress;

/* What the step reads of all neighbours, in their order. */
typedef struct scree_slot {
  double wake;   /* while they are asleep; -infinity while they are awake */
  uint32_t a, b; /* places in wake_threshold */
} scree_slot;

typedef struct scree_broad scree_broad;
typedef struct scree_scratch scree_scratch; /* contact.h */

/* Makes a checkpoint of `what`, a world or what stands around one; the caller frees the bytes. */
typedef scree_status scree_packer(const void *what, unsigned char **bytes, size_t *byte_count,
                                  scree_error *error);

/* ---- joints ---- */

/* Of a joint's material, Pa; friction and N/m beside. */
typedef struct scree_joint_strength {
  double tension, cohesion, friction, toughness;
} scree_joint_strength;

/* J since the start. */
typedef struct scree_joint_spent {
  double fracture, rubbed, damped;
} scree_joint_spent;

/* From pa on, numbers alone: a checkpoint takes them as they stand. */
typedef struct scree_world_joint {
  uint32_t a, b; /* b: scree_none for space */
  uint8_t state, mode;
  bool silent;             /* it does nothing any more, nor did it in the last step */
  vec3 pa, pb;             /* the face's centre in each body's frame */
  quat fa, fb;             /* the section's frame in each body's */
  vec3 stiffness, turning; /* along x, the normal, and y, z in the section; about them */
  vec3 damping, turning_damping;
  vec3 moduli;
  double area, reach[2];
  scree_joint_strength strength;
  double anchor[2];    /* of a cracked one's tangential spring, along y and z */
  double energy, load; /* J and share of strength, of the last step */
  scree_joint_spent spent;
  double broke_at;          /* s; NaN: it has not */
  vec3 force, moment;       /* of the last step, on b, in the joint's frame, without dashpots */
  scree_wrench dashpot;     /* of the last step, on b, in the joint's frame */
  scree_pair_wrench wrench; /* of the last step, all */
} scree_world_joint;

/* begin, sides, fragment: by body where the joints it has are in `sides`, 2 * joint + (1 for b);
 * these; the lowest body that hangs together with it. */
typedef struct scree_joints {
  SCREE_LIST(scree_world_joint) all;
  SCREE_LIST(uint32_t) begin;
  SCREE_LIST(uint32_t) sides;
  SCREE_LIST(uint32_t) fragment;
  bool stale;          /* joints or bodies were added */
  atomic_bool changed; /* a joint's state, in this step */
  double frequency;    /* rad/s, of the stiffest body; 0: not known */
  size_t stiffest;     /* that body */
} scree_joints;

/* Parts of the state: of some a device may have a newer copy than these arrays (remote.h). */
enum {
  SCREE_PART_REMOVED = 1, /* who is removed: never newer there */
  SCREE_PART_POSES = 2,   /* frames and orientations of bodies */
  SCREE_PART_BODIES = 4,  /* all else of them */
  SCREE_PART_WALLS = 8,
  SCREE_PART_LISTS = 16, /* neighbours, pairs and all that belongs to them */
  SCREE_PART_JOINTS = 32,
  SCREE_ALL_PARTS = 63
};

/* Materials, what they are to each other, and what springs between them came to. */
typedef struct scree_materials {
  scree_material items[SCREE_MATERIALS];
  size_t count;
  scree_material_pair contacts[SCREE_MATERIALS][SCREE_MATERIALS];
  scree_hardening hardened[SCREE_MATERIALS * (SCREE_MATERIALS + 1) / 2]; /* scree_hardened_at */
} scree_materials;

/* Who is near whom, but for two spheres: made by the broad phase, and kept until it ends. Arrays
 * are of the neighbours where nothing else is said. */
typedef struct scree_neighbour_list {
  struct {
    scree_neighbours *items; /* sorted by a, then bodies before walls, then b */
    size_t count, capacity;
  } neighbours;
  struct {
    uint32_t *items; /* indices into pairs; scree_none: asleep, or new */
    size_t count, capacity;
  } pair_of;
  struct {
    scree_balance *items;
    size_t count, capacity;
  } ledger;
  struct {
    scree_slot *items;
    size_t count, capacity;
  } slots;
  struct {
    double *items;
    size_t count, capacity;
  } wake_threshold; /* of the bodies, then of the walls, path + 2 travel: who sleeps until then is
                       looked at */
  struct {
    uint64_t *items;
    size_t count, capacity;
  } touching; /* one bit for two neighbours: the bodies look for their forces here */
  struct {
    uint64_t *items;
    size_t count, capacity;
  } keys; /* of the broad phase */
  struct {
    uint32_t *items; /* 2 * neighbours + (1 for the b side), grouped by body, ascending */
    size_t count, capacity;
  } sides, acting;      /* acting: scratch, those that touch */
  uint32_t *side_begin; /* bodies.capacity + 1 */
  struct {
    uint32_t *items; /* those of the neighbours that are a body and a wall */
    size_t count, capacity;
  } wall_pairs;
  double *body_path_at_build; /* path of each body when it was made; below 0: put elsewhere */
  double margin;              /* by which bodies' boxes were grown, m */
  size_t body_count;          /* for which it was made */
  bool stale;
} scree_neighbour_list;

/* What a step needs room for, and leaves nothing in. */
typedef struct scree_workspace {
  scree_scratch *scratch; /* one per worker */
  int scratch_count;
  size_t *offenders; /* of the gathering, by block */
  struct {
    uint32_t *items; /* indices of neighbours, from where their blocks begin; behind, pairs given */
    size_t count, capacity;
  } awake;
  struct {
    scree_pair_progress *items;
    size_t count, capacity;
  } progress;
} scree_workspace;

/* Where the world is stepped. */
typedef struct scree_residence {
  const struct scree_backend *backend; /* NULL: what scree_set_backend chose */
  int device;
  double alone_seconds;                 /* of the last steps by one thread (cpu.c) */
  const struct scree_remote *remote;    /* of who has on_device (remote.h) */
  struct scree_device_world *on_device; /* cuda_state.h; NULL: it never was on one */
  struct scree_sums *sums;              /* of a device: what the parts of an observation come to */
} scree_residence;

struct scree_world {
  scree_world_options options;
  scree_materials materials;
  scree_bodies bodies;
  struct {
    scree_world_wall *items;
    size_t count, capacity;
  } walls;
  struct {
    scree_motion_state *items; /* in the walls' order */
    size_t count, capacity;
  } motions;
  struct {
    scree_motion_row *items; /* in the motions' order */
    size_t count, capacity;
  } motion_rows;
  scree_neighbour_list list;
  struct {
    scree_pair *items; /* awake, or spare */
    size_t count, capacity;
  } pairs;
  struct {
    uint32_t *items; /* pairs of no neighbours; the last is taken first */
    size_t capacity;
    atomic_int_least64_t count; /* below 0 when a step asked for more than there were */
  } spare_pairs;
  scree_pools pools;
  scree_spheres spheres; /* pairs of two are there, and no neighbours */
  scree_broad *broad;
  scree_joints joints;
  scree_workspace workspace;
  double time, time_step;
  double hit_speed; /* m/s, of Hertz's hits, which the automatic step follows; 0: 1 */
  bool time_step_stale;
  uint64_t step_count, depenetration_count;
  double largest_overlap;
  bool diverged;
  scree_error failure;
  size_t failed_wall; /* 1 and the index of the wall that the failure names; 0: none */
  struct {            /* scree_world_keep; path NULL: nothing is kept */
    char *path;
    scree_packer *pack;
    const void *what;
    uint64_t interval, step; /* steps; of the state that `bytes` hold */
    unsigned char *bytes;    /* a checkpoint; NULL before the first */
    size_t byte_count;
  } kept;
  scree_timings timings;
  scree_residence residence;
};

/* The place of two materials in materials.hardened. */
static inline size_t scree_hardened_at(size_t a, size_t b) {
  const size_t low = a < b ? a : b, high = a < b ? b : a;
  return high * (high + 1) / 2 + low;
}
/* The pair of these neighbours; NULL: they are asleep, or new. */
static inline scree_pair *scree_pair_of(const scree_world *world, size_t neighbours) {
  uint32_t pair = world->list.pair_of.items[neighbours];
  return pair == scree_none ? NULL : &world->pairs.items[pair];
}
static inline bool scree_pair_touches(const scree_world *world, size_t pair) {
  return world->list.touching.items[pair / 64] >> pair % 64 & 1;
}
static inline void scree_mark_touching(scree_world *world, size_t pair, bool touching) {
  uint64_t bit = (uint64_t)1 << pair % 64;
  atomic_uint_least64_t *word = (atomic_uint_least64_t *)&world->list.touching.items[pair / 64];
  if (touching)
    atomic_fetch_or_explicit(word, bit, memory_order_relaxed);
  else
    atomic_fetch_and_explicit(word, ~bit, memory_order_relaxed);
}
static inline void scree_set_body_wake_threshold(scree_world *world, size_t i) {
  world->list.wake_threshold.items[i] = world->bodies.path[i] + 2 * world->bodies.travel[i];
}
static inline void scree_set_wall_wake_threshold(scree_world *world, size_t w) {
  const scree_world_wall *wall = &world->walls.items[w];
  world->list.wake_threshold.items[world->bodies.count + w] = wall->path + 2 * wall->travel;
}
static inline const scree_frame *scree_pair_frame_b(const scree_world *w, const scree_pair *p) {
  return p->wall ? &w->walls.items[p->b].frame : &w->bodies.frame[p->b];
}
/* Radii of the largest body: two boxes with their margins then meet in one image only. */
enum { SCREE_LEAST_PERIOD = 6 };
static inline bool scree_world_is_periodic(const scree_world *world) {
  const double *period = world->options.period;
  return period[0] > 0 || period[1] > 0 || period[2] > 0;
}
/* A place in the period that begins at period_from. */
static inline vec3 scree_world_fold(const scree_world *world, vec3 p) {
  const scree_world_options *o = &world->options;
  if (!scree_world_is_periodic(world)) return p;
  double at[3] = {p.x, p.y, p.z};
  for (int k = 0; k < 3; k++)
    if (o->period[k] > 0) at[k] -= o->period[k] * floor((at[k] - o->period_from[k]) / o->period[k]);
  return vec3_load(at);
}
/* d, or where the world is periodic the nearest of its images. */
static inline vec3 scree_nearest_image(const scree_world *w, vec3 d) {
  const double *period = w->options.period;
  if (period[0] > 0) d.x -= period[0] * floor(d.x / period[0] + 0.5);
  if (period[1] > 0) d.y -= period[1] * floor(d.y / period[1] + 0.5);
  if (period[2] > 0) d.z -= period[2] * floor(d.z / period[2] + 0.5);
  return d;
}
/* From b to a. Where bodies are is not folded into one period, so that nothing ever jumps. */
static inline vec3 scree_pair_between(const scree_world *w, const scree_pair *p,
                                      const scree_frame *a, const scree_frame *b) {
  vec3 d = vec3_sub(a->position, b->position);
  return p->wall ? d : scree_nearest_image(w, d);
}
/* A body of it was removed since its last step. */
static inline bool scree_pair_is_removed(const scree_world *w, const scree_pair *p) {
  return w->bodies.removed[p->a] || (!p->wall && w->bodies.removed[p->b]);
}
static inline bool scree_wall_is_analytic(const scree_world_wall *wall) {
  return wall->given.kind != SCREE_WALL_MESH;
}
/* The shape of side b; for an analytic wall its rims, NULL for none. */
static inline const scree_particle *scree_shape_of(const scree_world *w, uint32_t b, bool wall) {
  return wall ? w->walls.items[b].surface : w->bodies.particle[b];
}
static inline const scree_particle *scree_pair_shape_b(const scree_world *w, const scree_pair *p) {
  return scree_shape_of(w, p->b, p->wall);
}
/* walls.c: where it is now, until the next step, and its faces. */
const scree_world_wall *scree_world_wall_at(const scree_world *world, size_t index);
/* Gives a body without neighbours yet an orientation that scree_world_get_body told, to the bit. */
void scree_body_keep_orientation(scree_world *world, size_t index, const double told[4]);
/* Lets two worlds with the same walls keep one surface of each. */
void scree_world_share_walls(scree_world *world, const scree_world *like);
/* Else it sleeps until the bodies' paths have grown. */
static inline bool scree_pair_stays_awake(const scree_pair *p) {
  return p->active.count > 0 || p->depth > 0 || p->depenetrating || p->substeps.count > 1 ||
         p->touching;
}

/* For runs that may leave the model's range: from now on a checkpoint of the state is kept in
 * memory every step_interval steps, and where scree_world_step fails (SCREE_DIVERGED, no memory, a
 * device that is lost) the last one is written to path, replacing what is there, and named in the
 * message. Loaded, it goes on with the same bits, into the same failure where that was the world's:
 * one to look closely at what happened. path NULL: no longer.
 * Not part of checkpoints. Cost: a checkpoint's memory, and the time of making one (about 10 ms for
 * a thousand bodies) every interval. */
scree_status scree_world_keep(scree_world *world, const char *path, uint64_t step_interval,
                              scree_error *error);
