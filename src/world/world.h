/* The world's own structures. Only src/world sees them; docs/background/physics.md has the
 * equations. */
#ifndef SCREE_WORLD_WORLD_H
#define SCREE_WORLD_WORLD_H

#include "base/codec.h"
#include "base/prefetch.h"
#include "particle/particle.h"

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
  double damping_ratio; /* eta */
} scree_material_pair;

/* Force on a and its moment about the centre of b. */
typedef struct scree_load {
  vec3 force, moment;
} scree_load;

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
  scree_load friction;     /* the tangential part of them, on the bodies */
  vec3 surface_velocity, surface_spin; /* of a belt, in the wall's own frame */
  double power, energy,
      energy_due;      /* done on bodies: W, J so far, J of the last step's later half */
  vec3 start_position; /* when its motions were set */
  quat start_orientation;
  size_t motion_count; /* its own in world->motions, after those of the walls before it */
} scree_world_wall;

/* A motion of a wall (motion.c); its axis has length 1. */
typedef struct scree_motion_state {
  uint32_t law;
  bool turns;
  vec3 axis, through;
  double speed, amplitude, frequency, phase, from, until;
  double origin;    /* what its law was at when it was set */
  size_t row_count; /* its own in world->motion_rows, after those of the motions before it */
} scree_motion_state;

typedef struct scree_motion_row {
  double time, value;
  double sum; /* of speeds: the way since the first row */
} scree_motion_row;

/* Force and torque of scree_world_set_body_force. */
typedef struct scree_applied {
  scree_load now, last; /* last: of the last step */
} scree_applied;

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
  vec3 *turn; /* angular velocity in the body's own frame after the coming kick (scratch) */
  scree_particle **particle;
  uint8_t *material;
  bool *removed;
  size_t count, capacity, removed_count;
} scree_bodies;

/* What a touching feature remembers: the anchored tangential spring. */
typedef struct scree_anchor {
  vec3 stretch; /* xi, in the frame of b */
  vec3 normal;  /* of the last step, in the frame of b */
  double share; /* of the last step; 0: no memory */
} scree_anchor;

typedef enum scree_item_kind {
  SCREE_ITEM_POINT_FACE,  /* point of a, surface of b */
  SCREE_ITEM_FACE_POINT,  /* surface of a, point of b */
  SCREE_ITEM_EDGE_EDGE,   /* edge of a, edge of b */
  SCREE_ITEM_POINT_POINT, /* spheres */
  SCREE_ITEM_POINT_WALL,  /* point of a, analytic wall */
} scree_item_kind;

/* A feature pair that cannot touch before the pair's path reaches `wake`. */
typedef struct scree_sleeper {
  double wake;
  uint32_t a, b;
  uint32_t kind;
} scree_sleeper;

enum { SCREE_CACHED_FACES = 4, SCREE_ANCHORS = 3 };

/* Whether the closest points of two edges lie within both. */
typedef enum scree_crossing {
  SCREE_CROSSING_NONE,
  SCREE_CROSSING_COUNTS,
  SCREE_CROSSING_REFUSED, /* which way it is out is not known */
} scree_crossing;

/* A feature pair that is evaluated every step: two cache lines. */
typedef struct scree_item {
  uint8_t kind;
  bool has_reference, inside;
  bool notched; /* it has further anchors */
  uint32_t a, b;
  union {
    uint32_t face_count; /* of a point: cached nearest faces */
    uint32_t crossing;   /* of edges: a scree_crossing, of the last step */
  };
  uint32_t face[SCREE_CACHED_FACES];
  union {
    double valid; /* of a point: path up to which no other face can be nearer */
    double held;  /* of edges: overlap that does not count (edges.c) */
  };
  vec3 reference; /* the way out, kept from the last time the cores were apart */
  double gap;     /* found in this step; 0: stay awake */
  scree_anchor anchor;
} scree_item;

/* The anchors of a point in a notch beyond the first: few items ever read them. */
typedef struct scree_further {
  scree_anchor anchor[SCREE_ANCHORS - 1];
} scree_further;

/* Force and torques about the centres of a and b (about its position for a wall), on a and on b;
 * the force on b is the opposite. */
typedef struct scree_wrench {
  vec3 force, torque_a, torque_b;
} scree_wrench;

/* A load in space as the ledger keeps it from one step to the next: the bodies do not feel its
 * rounding. */
typedef struct scree_kept_load {
  float force[3], moment[3];
} scree_kept_load;

/* What follows of the two bodies' sizes, masses and materials. */
typedef struct scree_pair_law {
  double stiffness, damping, friction; /* K, C, mu */
  double smoothing, reach, limit;      /* l0; rounding of both meshes; overlap limit */
  double thin;                         /* the limit, or half the thinnest wall where less */
  double contact_time;                 /* half period pi sqrt(m/K) */
  double restitution;                  /* e */
  double pull;                         /* N, with which they hold each other */
  double rolling, rolling_damping;     /* mu_r R, m; torque over angular velocity */
} scree_pair_law;

/* How far the list of items lasts; the pair has it while awake, its neighbours while asleep. */
typedef struct scree_list_state {
  double travel, path;   /* of the relative motion: last step, and sum; upper bounds */
  double next_item, end; /* on path */
  vec3 region; /* ball in the frame of b that holds what the list is about, until it ends */
  double region_radius; /* 0: none */
} scree_list_state;

/* Places [first, first + count) of a pool; there is room for `capacity`. */
typedef struct scree_range {
  uint32_t first, count, capacity;
} scree_range;

/* A pair that is awake. What every step touches comes first. Pairs lie together, apart from what is
 * kept of those asleep: a step comes to one pair of neighbours in five, and each would lie on a
 * page of its own. */
typedef struct scree_pair {
  _Alignas(64) uint32_t a;
  uint32_t b;
  bool wall;   /* b is a wall */
  bool asleep; /* no item can touch before the bodies' paths reach the neighbours' `wake` */
  bool touching;
  bool parting; /* is moved apart (law.c) */
  uint32_t contact_count;
  scree_wrench wrench; /* here: the bodies read it with what is above */
  scree_list_state list;
  double age;          /* since the touch began */
  scree_range active;  /* in the pool of items */
  uint32_t neighbours; /* index */
  double overlap;      /* m */
  scree_pair_law law;
  scree_kept_load dashpot, tangential; /* parts of the wrench, for the ledger */
  double elastic, tangential_elastic;  /* U of all springs, and of the tangential ones */
  double largest;                      /* m of this contact (hysteresis) */
  vec3 rolled;  /* the spring of rolling resistance, rad, in the frame of b */
  double depth; /* no edge lies deeper inside the other body; -INFINITY: not known */
} scree_pair;

/* Two bodies, or a body and a wall, whose boxes are near each other: what is kept of them while
 * they are asleep. */
typedef struct scree_neighbours {
  uint32_t a, b;
  bool wall;
  bool asleep; /* else awake, or new */
  scree_list_state list;
  double wake, asleep_since; /* on path[a] + path[b] */
  vec3 asleep_at;            /* a in the frame of b when they fell asleep */
  quat asleep_turned;
  scree_range sleeping; /* in the pool of sleepers; awake or not */
  scree_pair_law law;
} scree_neighbours;

/* The lists of all pairs, one array a kind. A list that outgrows its place takes one behind `used`,
 * in a step by many threads at once. Where that is beyond the capacity the pair is evaluated again,
 * from the beginning, after the pools have grown (pool.c). */
enum { SCREE_FIRST_ITEMS = 2, SCREE_FIRST_SLEEPERS = 8 }; /* places of a list that begins */
typedef struct scree_pools {
  scree_item *items;
  scree_further *further; /* of the items */
  scree_sleeper *sleepers;
  uint64_t item_capacity, sleeper_capacity;
  atomic_uint_least64_t items_used, sleepers_used;
  /* of a device, whose threads have no scratch of their own; else NULL */
  struct scree_touch *touches;
  uint64_t touch_capacity;
  atomic_uint_least64_t touches_used;
} scree_pools;

/* One touching feature, in the frame of b. */
typedef struct scree_touch {
  vec3 at, normal; /* normal towards a */
  double overlap, weight, share;
  double lever;  /* how much the overlap falls as a moves along the normal */
  vec3 fading;   /* along which the weight falls as a moves, 1/m */
  vec3 force;    /* on a */
  bool of_depth; /* of an edge inside: without friction or memory */
  scree_anchor *anchor;
} scree_touch;

typedef struct scree_touch_list {
  scree_touch *items;
  size_t count, capacity;
} scree_touch_list;

/* Scratch of one worker, and where the lists of the pair in hand lie. */
typedef struct scree_scratch {
  scree_pools *pools;
  scree_neighbours *neighbours; /* of the pair */
  scree_item *items;            /* its awake ones */
  scree_further *further;
  scree_touch_list touches;
  size_t touches_needed; /* by a pair that found too little room */
  uint64_t item_evaluations, closest_queries, list_builds;
  uint64_t depth_queries;
  double candidate_seconds;
  double least_gap; /* of the items */
  bool any_inside;  /* one of them is */
  scree_anchor no_anchor;
} scree_scratch;

/* What a pair's evaluation adds to the ledger, J, and what is wrong with it. */
typedef struct scree_pair_work {
  double later_dashpot, later_tangential; /* second half of the last step */
  double dashpot, tangential;             /* first half of this */
  double lost;                            /* in the hysteretic spring */
  double let_go;                          /* by springs whose references start anew */
  double start_depth;                     /* in each other from the start, m; 0: none */
  bool too_fast, beyond_limit, begins_parting;
} scree_pair_work;

/* What a block of pairs adds up, in their order; combined in block order. */
typedef struct scree_pair_sums {
  double dashpot, tangential;
  double largest_overlap;
  uint32_t beyond_limit, too_fast, start; /* the first neighbours, or scree_none */
  double start_depth;                     /* of that one, in each other from the start */
  uint64_t partings;                      /* begun */
} scree_pair_sums;

/* How far some blocks of the neighbours have come in a step. */
typedef struct scree_pair_progress {
  uint32_t awake, done; /* of those that are awake */
  uint32_t given;       /* pairs that fell asleep */
} scree_pair_progress;

/* What the step reads of all neighbours, in their order. */
typedef struct scree_slot {
  double wake;   /* while they are asleep; -infinity while they are awake */
  uint32_t a, b; /* places in world->due */
} scree_slot;

typedef struct scree_broad scree_broad;

/* Makes a checkpoint of `what`, a world or what stands around one; the caller frees the bytes. */
typedef scree_status scree_packer(const void *what, unsigned char **bytes, size_t *byte_count,
                                  scree_error *error);

struct scree_world {
  scree_world_options options;
  scree_material materials[SCREE_MATERIALS];
  scree_material_pair contacts[SCREE_MATERIALS][SCREE_MATERIALS];
  size_t material_count;
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
  struct {
    scree_neighbours *items; /* sorted by a, then bodies before walls, then b */
    size_t count, capacity;
  } neighbours;
  struct {
    uint32_t *items; /* of the neighbours, indices into pairs; scree_none: asleep, or new */
    size_t count, capacity;
  } pair_of;
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
  struct {
    scree_slot *items;
    size_t count, capacity;
  } slots; /* of the neighbours */
  struct {
    double *items;
    size_t count, capacity;
  } due; /* of the bodies, then of the walls, path + 2 travel: who sleeps until then is looked at */
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
  } sides, acting; /* acting: scratch, those that touch */
  struct {
    uint32_t *items; /* those of the neighbours that are a body and a wall */
    size_t count, capacity;
  } wall_pairs;
  size_t *side_begin; /* bodies.capacity + 1 */
  size_t *offenders;  /* scratch of the gathering, by block */
  scree_broad *broad;
  struct {
    scree_pair_sums *items;
    size_t count, capacity;
  } sums;
  struct {
    uint32_t *items; /* indices of neighbours, from where their blocks begin; behind, pairs given */
    size_t count, capacity;
  } awake;
  struct {
    scree_pair_progress *items;
    size_t count, capacity;
  } progress;
  scree_scratch *scratch; /* one per worker */
  int scratch_count;
  double
      *body_path_at_build; /* path of each body when the pairs were made; below 0: put elsewhere */
  bool pairs_stale;
  double time, time_step;
  bool time_step_stale;
  uint64_t step_count, parting_count;
  double work_dashpot, work_tangential, applied_work; /* done on bodies, so far */
  double largest_overlap;
  bool diverged;
  scree_error failure;
  struct { /* scree_world_keep; path NULL: nothing is kept */
    char *path;
    scree_packer *pack;
    const void *what;
    uint64_t interval, step; /* steps; of the state that `bytes` hold */
    unsigned char *bytes;    /* a checkpoint; NULL before the first */
    size_t byte_count;
  } kept;
  scree_timings timings;
  struct scree_device_world *on_device; /* cuda.c; NULL: it never was on one */
};

/* The pair of these neighbours; NULL: they are asleep, or new. */
static inline scree_pair *scree_pair_of(const scree_world *world, size_t neighbours) {
  uint32_t pair = world->pair_of.items[neighbours];
  return pair == scree_none ? NULL : &world->pairs.items[pair];
}
static inline bool scree_pair_touches(const scree_world *world, size_t pair) {
  return world->touching.items[pair / 64] >> pair % 64 & 1;
}
static inline void scree_mark_touching(scree_world *world, size_t pair, bool touching) {
  uint64_t bit = (uint64_t)1 << pair % 64, *word = &world->touching.items[pair / 64];
  *word = touching ? *word | bit : *word & ~bit;
}
static inline void scree_set_body_due(scree_world *world, size_t i) {
  world->due.items[i] = world->bodies.path[i] + 2 * world->bodies.travel[i];
}
static inline void scree_set_wall_due(scree_world *world, size_t w) {
  const scree_world_wall *wall = &world->walls.items[w];
  world->due.items[world->bodies.count + w] = wall->path + 2 * wall->travel;
}
static inline const scree_frame *scree_pair_frame_b(const scree_world *w, const scree_pair *p) {
  return p->wall ? &w->walls.items[p->b].frame : &w->bodies.frame[p->b];
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

/* material.c: eta of the clamped linear dashpot for a restitution in (0, 1]. */
double scree_damping_ratio(double restitution);

/* time_step.c */
double scree_world_choose_time_step(const scree_world *world, char reason[256]);
/* K of a pair of materials at size L. */
double scree_pair_stiffness(const scree_world *world, size_t material_a, size_t material_b,
                            double size);

/* broad.c: brings the list of pairs up to date when a body could have left its margin. */
scree_status scree_broad_update(scree_world *world, scree_error *error);
void scree_broad_free(scree_world *world);
/* For checkpoints: the margin of the present list of pairs, and a list that was loaded. */
double scree_broad_margin(const scree_world *world);
scree_status scree_broad_restore(scree_world *world, double margin, scree_error *error);

/* pair.c: neighbours a and b, new and set up. */
scree_neighbours scree_neighbours_new(const scree_world *world, uint32_t a, uint32_t b, bool wall);
/* After a change of the materials: stiffness, damping and so on of all neighbours and pairs. */
void scree_neighbours_set_up(scree_world *world);
/* world.c: room for forces on bodies, none at first. */
scree_status scree_bodies_make_applied(scree_bodies *bodies, scree_error *error);
/* After a jump: the body's contacts start anew. */
void scree_body_forget(scree_world *world, size_t body);
/* Half the particle's thinnest wall, m. */
double scree_thin_overlap(const scree_particle *particle);
/* As a pair of neighbours that are asleep or new; its place for items stays. */
void scree_pair_begin(scree_pair *pair, const scree_neighbours *neighbours, uint32_t index);
/* What is kept of a pair without awake items. */
void scree_pair_end(const scree_pair *pair, scree_neighbours *neighbours);
/* A spare pair, in a step by many threads at once; scree_none when there is none. */
uint32_t scree_pair_take(scree_world *world);
void scree_pair_give_back(scree_world *world, uint32_t pair);
/* More spare pairs, at least as many as a step asked for in vain; false when memory is out. */
bool scree_pairs_grow(scree_world *world);
/* Pairs lie in the order of their neighbours again, where many do not. */
void scree_pairs_tidy(scree_world *world);

/* A pair and its neighbours with pools of their own. Zeroed before the first use; free it. */
typedef struct scree_pair_copy {
  scree_pair pair;
  scree_neighbours neighbours;
  scree_pools pools;
  scree_scratch scratch;
} scree_pair_copy;
/* Of an awake pair; false when memory is out. */
bool scree_copy_pair(const scree_world *world, const scree_pair *pair, scree_pair_copy *copy);
/* Its step; the touches are in the copy's scratch. False when memory is out. */
bool scree_evaluate_copy(const scree_world *world, scree_pair_copy *copy);
void scree_free_pair_copy(scree_pair_copy *copy);

/* pool.c: a larger place for the pair's items, or for the sleepers of the neighbours in hand; false
 * where the pool has too little room. */
bool scree_grow_items(scree_scratch *scratch, scree_pair *pair, uint32_t needed);
bool scree_grow_sleepers(scree_scratch *scratch, uint32_t needed);
/* Room for the touches of the pair in hand, which are found anew. */
bool scree_reserve_touches(scree_scratch *scratch, size_t needed);
/* The lists packed in the order of their owners, with room for `extra` more, and for as much again.
 * False when memory is out; nothing has moved then. */
bool scree_pack_items(scree_pools *pools, scree_pair *pairs, size_t count, size_t extra);
bool scree_pack_sleepers(scree_pools *pools, scree_neighbours *neighbours, size_t count);
/* The pools that were asked for more than they have grow; false when memory is out. */
bool scree_pools_grow(scree_pools *pools, scree_pair *pairs, size_t pair_count,
                      scree_neighbours *neighbours, size_t neighbour_count);
void scree_pools_free(scree_pools *pools);
static inline bool scree_reserve_items(scree_scratch *scratch, scree_pair *pair, uint32_t needed) {
  return needed <= pair->active.capacity || scree_grow_items(scratch, pair, needed);
}
static inline bool scree_reserve_sleepers(scree_scratch *scratch, uint32_t needed) {
  return needed <= scratch->neighbours->sleeping.capacity || scree_grow_sleepers(scratch, needed);
}
/* Where the pair's lists are; before its evaluation. */
static inline void scree_take_in_hand(scree_scratch *s, scree_pools *pools, const scree_pair *pair,
                                      scree_neighbours *neighbours) {
  s->pools = pools;
  s->neighbours = neighbours;
  s->items = pools->items + pair->active.first;
  s->further = pools->further + pair->active.first;
}
/* The sleepers of the neighbours in hand. */
static inline scree_sleeper *scree_sleepers(const scree_scratch *s) {
  return s->pools->sleepers + s->neighbours->sleeping.first;
}

/* Evaluated for the first time, or since a jump. */
static inline bool scree_pair_is_new(const scree_pair *p) {
  return p->list.path <= p->list.travel;
}
/* Else it sleeps until the bodies' paths have grown. */
static inline bool scree_pair_stays_awake(const scree_pair *p) {
  return p->active.count > 0 || p->depth > 0;
}
/* How far behind a sheet a point of a new pair may be and still belong to the body's side. */
static inline double scree_pair_clearance(const scree_pair *p, const scree_particle *a,
                                          uint32_t point) {
  return a->point_radii[point] + p->law.smoothing + 0.25 * p->law.thin;
}

/* How far apart, beyond the roundings, edges may lie that the last step's overlap can make count:
 * those that come in behind a corner are tapered, and deeper than they are felt. 0 at rest. */
static inline double scree_pair_claim(const scree_pair *p) {
  double beyond = p->overlap - p->law.reach;
  return beyond > 0 ? 2 * beyond : 0;
}

/* Reach of the lists of slow pairs, m. */
static inline double scree_pair_skin(const scree_world *w, const scree_pair *p) {
  return w->options.skin / w->options.smoothing * p->law.smoothing;
}

/* A list of fast bodies should last this many steps. */
enum { SCREE_FAST_STEPS = 40 };

/* Whether one that reaches no farther than the skin would not. */
static inline bool scree_pair_is_fast(const scree_world *w, const scree_pair *p) {
  return SCREE_FAST_STEPS * p->list.travel > scree_pair_skin(w, p);
}

/* The smaller body of a pair, whose motion relative to the other is measured, and a ball around it
 * and a little beyond. */
static inline bool scree_pair_smaller_is_a(const scree_world *w, const scree_pair *p) {
  return p->wall || w->bodies.particle[p->a]->measures.bounding_radius <=
                        w->bodies.particle[p->b]->measures.bounding_radius;
}
static inline double scree_pair_radius(const scree_world *w, const scree_pair *p) {
  uint32_t smaller = scree_pair_smaller_is_a(w, p) ? p->a : p->b;
  return w->bodies.particle[smaller]->measures.bounding_radius + 4 * scree_pair_skin(w, p);
}

/* candidates.c: which items could touch within the skin; fills sleeping, keeps active. */
bool scree_pair_list(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                     scree_scratch *scratch);

/* touch.c: the touching features of one item, appended to touches; returns its gap, the way it must
 * move before it can touch (0 or less: it does, or nearly). relative: a in the frame of b. */
double scree_item_touch(const scree_world *world, const scree_pair *pair, scree_item *item,
                        const scree_frame *relative, scree_scratch *scratch);
/* A touch between spheres or rounded surfaces: normal n, towards a, from the point c of b. values:
 * distance of the rounding's centre of a along n, roundings of a and of b, weight. The gap; nothing
 * is appended, and the anchor forgets, where that is not below 0. */
double scree_add_touch(scree_scratch *scratch, const scree_pair *pair, vec3 c, vec3 n,
                       const double values[4], scree_anchor *anchor);
/* edges.c: the same for two edges. */
double scree_touch_edges(const scree_world *world, const scree_pair *pair, scree_item *item,
                         const scree_frame *relative, scree_scratch *scratch);
static inline double scree_smooth_step(double from, double to, double x) {
  double t = (x - from) / (to - from);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return t * t * (3 - 2 * t);
}
static inline double scree_smooth_slope(double from, double to, double x) {
  double t = (x - from) / (to - from);
  return t <= 0 || t >= 1 ? 0 : 6 * t * (1 - t) / (to - from);
}
/* Which side of an analytic wall p (wall frame) is on: 1 in front of the plane or disc, inside the
 * cylinder; -1 for the other side of a disc or cylinder. */
double scree_wall_side(const scree_world_wall *wall, vec3 p);
/* Whether a disc or cylinder lies straight below, above or beside p, not past a rim. */
bool scree_wall_spans(const scree_world_wall *wall, vec3 p);
/* The side of a point that is seen for the first time: the centre's, where the sheet spans it and p
 * is less than `clearance` behind; else its own. */
double scree_wall_first_side(const scree_world_wall *wall, vec3 p, vec3 centre, double clearance);
/* Signed distance of p (wall frame) on that side, with the closest point and the normal. */
double scree_wall_distance(const scree_world_wall *wall, vec3 p, double side, vec3 *closest,
                           vec3 *normal);

bool scree_wall_is_belt(const scree_world_wall *wall);
/* From now on. */
void scree_wall_set_velocity(scree_world *world, size_t index, vec3 velocity, vec3 spin);
/* Forces and torques on walls from the pairs of the last step. */
void scree_walls_sum_forces(scree_world *world);
/* The work of walls in this step: before they move, with the forces of the step; and after. */
void scree_walls_book(scree_world *world);
void scree_wall_book_later(scree_world_wall *wall, double time_step);
/* How far from its position a wall extends; INFINITY for planes and endless cylinders. */
double scree_wall_extent(const scree_world_wall *wall);
/* motion.c: every wall's drift. */
void scree_walls_advance(scree_world *world);

/* depth.c: adds touches for edges inside the other body where features may feel less; notes bodies
 * that lie in each other from the start. */
void scree_pair_feel_depths(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                            scree_scratch *scratch, scree_pair_work *work);
/* The edges that lie deeper in the other body than `above`, as touches, the deepest SCREE_DEPTHS of
 * them; the depth of the deepest, m, or `above`. */
enum { SCREE_DEPTHS = 32 };
double scree_touch_depths(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                          double above, scree_scratch *scratch);

/* seam.c: the area of b's surface inside a as a vector, outward, in the frame of b, m2: the way in
 * which the common volume falls fastest as a moves. 0 where the surfaces do not cross. */
vec3 scree_way_apart(const scree_world *world, const scree_pair *pair, const scree_frame *relative);

/* The smooth maximum m of overlaps, t, and the denominator of the shares (law.c). */
typedef struct scree_smooth_maximum {
  double value, cutoff, denominator;
} scree_smooth_maximum;
/* law.c: from the overlaps and weights of touches; false when the pair does not touch. */
bool scree_solve_smooth_maximum(const scree_touch *touches, size_t count, double l0, double kappa,
                                scree_smooth_maximum *result);

/* Power of the dashpots and of the tangential forces with the velocities of the last drift. */
typedef struct scree_powers {
  double dashpot, tangential;
} scree_powers;
/* law.c: smooth maximum, forces, memory. Fills the pair's results. */
scree_powers scree_pair_apply_law(const scree_world *world, scree_pair *pair,
                                  scree_touch_list *touches, const scree_frame *relative);

/* contact.c: the whole of a pair's step, its lists being in hand. False where a pool, or the
 * scratch, has too little room: the pair is as before, but for lists that are made again. */
bool scree_pair_evaluate(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                         scree_pair_work *work);

/* integrate.c */

/* Sums the forces on every body; false where the step would leave the model's range, with the
 * reason in world->failure. */
bool scree_world_gather(scree_world *world);
/* Kick, turn and drift of every body and wall; removal below the floor. */
void scree_world_advance(scree_world *world);
/* Angular velocity of body i for angular momentum `momentum` and rotation `rotation`. */
vec3 scree_spin_of(const scree_bodies *bodies, size_t i, const mat3 *rotation, vec3 momentum);

/* save.c: a checkpoint's bytes, free with scree_free; and back, `name` for messages. */
scree_status scree_world_pack(const scree_world *world, unsigned char **bytes, size_t *byte_count,
                              scree_error *error);
/* The same within a larger file: its count of bytes, and the bytes. */
scree_status scree_world_save_block(scree_codec *codec, const scree_world *world,
                                    scree_error *error);
scree_status scree_world_load_block(scree_codec *codec, const char *name, scree_world **world,
                                    scree_error *error);
scree_status scree_world_unpack(const unsigned char *bytes, size_t byte_count, const char *name,
                                scree_world **world, scree_error *error);

/* keep.c: scree_world_keep for what stands around the world, which outlives it. */
scree_status scree_world_keep_all(scree_world *world, const char *path, uint64_t step_interval,
                                  scree_packer *pack, const void *what, scree_error *error);
bool scree_world_keep_is_due(const scree_world *world);
/* Packs the state; after a failure writes what was packed last,
 * and says so in world->failure. */
scree_status scree_world_keep_state(scree_world *world, scree_error *error);
void scree_world_write_kept(scree_world *world);

#endif
