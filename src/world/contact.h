/* A pair's contact: its features, their overlaps, the law, the step of the pair. */
#pragma once

#include "world/constants.h"
#include "world/world.h"

/* One touching feature, in the frame of b. */
typedef struct scree_contact_point {
  vec3 at, normal; /* normal towards a */
  double overlap, taper, weight;
  double gap_gradient; /* how much the overlap falls as a moves along the normal */
  vec3 fading;         /* along which the taper falls as a moves, 1/m */
  vec3 force;          /* on a */
  bool of_depth;       /* of an edge inside: without friction or memory */
  scree_anchor *anchor;
} scree_contact_point;

typedef struct scree_contact_list {
  scree_contact_point *items;
  size_t count, capacity;
} scree_contact_list;

/* m/s, at most, with which bodies that lie in each other are moved apart (law.c). */
static inline double scree_depenetration_speed(const scree_pair_law *law) {
  return law->limit / (passage_patience * law->contact_time);
}

/* What a pair's evaluation adds to the ledger, J, and what is wrong with it. */
typedef struct scree_pair_work {
  double later_dashpot, later_tangential; /* second half of the last step */
  double dashpot, tangential;             /* first half of this */
  double lost;                            /* in the hysteretic spring */
  double let_go;                          /* by springs whose references start anew */
  double wall;                            /* of a wall on the body */
  double start_depth;                     /* in each other from the start, m; 0: none */
  bool too_fast, beyond_limit, begins_depenetration, passed;
} scree_pair_work;

/* Whether a pair asks for depths: from the start; of edges that lie deeper than `above`, m. */
typedef struct scree_depth_question {
  bool start, edges;
  double above;
} scree_depth_question;

/* Whether there is anything to be found before the law. */
static inline bool scree_asks_depths(const scree_depth_question *question) {
  return question->start || question->edges;
}

/* The deepest point of an edge: the way along it, the depth (below 0 outside) and its slope. */
typedef struct scree_depth {
  double s, depth;
  vec3 slope;
} scree_depth;

/* A pair in hand: where its lists and its bodies are, and what is found out about it in a step. A
 * worker has one, a device one for every pair that is awake. */
struct scree_scratch {
  scree_pools *pools;
  scree_neighbours *neighbours; /* of the pair */
  scree_feature_pair *features; /* its awake ones */
  scree_further *further;
  scree_contact_list contacts;
  size_t contacts_needed; /* by a pair that found too little room */
  size_t first_contact;   /* of a device: in the pool of contacts */
  size_t first_depth;     /* likewise, among the depths that were found for it */
  uint64_t feature_evaluations, closest_queries, list_builds;
  uint64_t depth_queries;
  double candidate_seconds;
  double nap;               /* feature pairs that cannot touch for longer go to sleep */
  double least_gap;         /* of the feature pairs */
  const scree_frame *a, *b; /* where the pair's two are */
  scree_frame own[2];       /* these where they are the pair's alone */
  scree_frame relative;     /* a in the frame of b */
  double drift, step;       /* s, of their last drift and of the coming one */
  uint32_t substeps;        /* of the coming step */
  uint32_t to_sleep;        /* feature pairs that go to sleep */
  bool any_inside;          /* a feature pair is */
  bool slept;               /* the pair did, until this step */
  bool depenetrating, was_depenetrating; /* as it was then */
  scree_depth_question question;
  scree_list_state before; /* of the pair, when the step began */
  scree_pair_wrench last;  /* the pair's of the last step */
  scree_pair_work work;
  double spring_work;    /* J, of the pair's spring since the last look */
  double overlap_before; /* m, at it */
  scree_anchor no_anchor;
};

/* pool.c: a larger place for the pair's feature pairs, or for the sleeping feature pairs of the
 * neighbours in hand; false where the pool has too little room. */
bool scree_grow_features(scree_scratch *scratch, scree_pair *pair, uint32_t needed);
bool scree_grow_sleeping(scree_scratch *scratch, uint32_t needed);
/* Room for the contacts of the pair in hand, which are found anew. */
bool scree_reserve_contacts(scree_scratch *scratch, size_t needed);
static inline bool scree_reserve_features(scree_scratch *scratch, scree_pair *pair,
                                          uint32_t needed) {
  return needed <= pair->active.capacity || scree_grow_features(scratch, pair, needed);
}
static inline bool scree_reserve_sleeping(scree_scratch *scratch, uint32_t needed) {
  return needed <= scratch->neighbours->sleeping.capacity || scree_grow_sleeping(scratch, needed);
}
/* Where the pair's lists are; before its evaluation. */
static inline void scree_take_in_hand(scree_scratch *s, scree_pools *pools, const scree_pair *pair,
                                      scree_neighbours *neighbours) {
  s->pools = pools;
  s->neighbours = neighbours;
  s->features = pools->features + pair->active.first;
  s->further = pools->further + pair->active.first;
}
/* The sleeping feature pairs of the neighbours in hand. */
static inline scree_sleeping_feature *scree_sleeping_features(const scree_scratch *s) {
  return s->pools->sleeping_features + s->neighbours->sleeping.first;
}

/* The contact radius of features of one of the two, a mesh; a wall has no say in it. */
static inline double scree_pair_contact_radius(const scree_world *w, const scree_pair *p,
                                               bool of_b) {
  const scree_particle *a = w->bodies.particle[p->a], *b = scree_pair_shape_b(w, p);
  if (p->wall) return of_b ? b->radius : a->radius;
  return of_b ? scree_contact_radius(b, a) : scree_contact_radius(a, b);
}

/* Evaluated for the first time, or since a jump. */
static inline bool scree_pair_is_new(const scree_pair *p) {
  return p->list.path <= p->list.travel;
}
/* How far behind a sheet a point of a new pair may be and still belong to the body's side. */
static inline double scree_pair_clearance(const scree_pair *p, const scree_particle *a,
                                          uint32_t point) {
  return a->point_radii[point] + p->law.smoothing + 0.25 * p->law.thin;
}

/* How far apart, beyond the contact radii, edges may lie that the last step's overlap can make
 * count: those that come in behind a corner are tapered, and deeper than they are felt. 0 at rest.
 */
static inline double scree_pair_edge_reach(const scree_pair *p) {
  double beyond = p->overlap - p->law.reach;
  return beyond > 0 ? 2 * beyond : 0;
}

/* Reach of the lists of slow pairs, m. */
static inline double scree_pair_skin(const scree_world *w, const scree_pair *p) {
  return w->options.skin / w->options.smoothing * p->law.smoothing;
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

/* candidates.c: which feature pairs could touch within the skin; fills sleeping, keeps active. */
bool scree_pair_list(const scree_world *world, scree_pair *pair, scree_scratch *scratch);

/* The same in pieces, for many threads: entries, each some features against the other body, count
 * what they find, and write it from where the counts of those before end. */
typedef struct scree_listing {
  const scree_world *world;
  scree_pair *pair;
  const scree_particle *a, *b; /* b: of an analytic wall its rims, or NULL */
  const scree_frame *relative;
  scree_scratch *scratch;
  double skin;
  uint64_t awake[4]; /* bits of names of feature pairs that are */
  bool analytic;
  bool full; /* the pool of sleeping feature pairs */
  uint64_t closest_queries;
  scree_sleeping_feature *to; /* what is found is written here; NULL: it goes to the neighbours */
  uint32_t count, room;       /* of what was found; how much of it is written */
} scree_listing;
/* False where the two are too far apart for any. */
bool scree_listing_begin(scree_listing *listing, const scree_world *world, scree_pair *pair,
                         scree_scratch *scratch);
size_t scree_listing_count(const scree_listing *listing); /* of entries */
void scree_listing_take(scree_listing *listing, size_t entry);

/* narrow.c: the touching features of one feature pair, appended to contacts; returns its gap, the
 * way it must move before it can touch (0 or less: it does, or nearly). relative: a in the frame of
 * b. */
double scree_feature_contact(const scree_world *world, const scree_pair *pair,
                             scree_feature_pair *feature, const scree_frame *relative,
                             scree_scratch *scratch);
/* A touch between spheres or rounded surfaces: normal n, towards a, from the point c of b. values:
 * distance of the rounded centre of a along n, contact radii of a and of b, taper. The
 * gap; nothing is appended, and the anchor forgets, where that is not below 0. */
static inline double scree_add_contact(scree_scratch *scratch, const scree_pair *pair, vec3 c,
                                       vec3 n, const double values[4], scree_anchor *anchor) {
  double distance = values[0], above = values[1], below = values[2], taper = values[3];
  double overlap = above + below - distance, gap = -overlap - pair->law.smoothing;
  if (gap >= 0 || !(taper > 0)) {
    anchor->weight = 0;
    return gap;
  }
  scree_contact_point *contact = &scratch->contacts.items[scratch->contacts.count++];
  contact->at = vec3_mad(c, n, 0.5 * (distance - above + below));
  contact->normal = n;
  contact->gap_gradient = 1;
  contact->fading = (vec3){0, 0, 0};
  contact->of_depth = false;
  contact->overlap = overlap;
  contact->taper = taper;
  contact->anchor = anchor;
  return gap;
}
/* edges.c: the same for two edges. */
double scree_edge_contact(const scree_world *world, const scree_pair *pair,
                          scree_feature_pair *feature, const scree_frame *relative,
                          scree_scratch *scratch);
static inline double scree_smooth_step(double from, double to, double x) {
  double t = (x - from) / (to - from);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return t * t * (3 - 2 * t);
}
static inline double scree_smooth_slope(double from, double to, double x) {
  double t = (x - from) / (to - from);
  return t <= 0 || t >= 1 ? 0 : 6 * t * (1 - t) / (to - from);
}

/* Whether edges of one of the two may lie inside the other: other pairs know no depth, and never
 * part. b: NULL for none. */
static inline bool scree_knows_depths(const scree_particle *a, const scree_particle *b) {
  return a->face_count && b && scree_has_features(b);
}
/* depth.c: adds contacts for edges inside the other body where features may feel less; notes bodies
 * that lie in each other from the start. First what is to be found, then finding it, in one piece
 * or with many threads: entries, each an edge or a point. */
void scree_pair_ask_depths(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
void scree_pair_find_depths(const scree_world *world, scree_pair *pair, scree_scratch *scratch,
                            scree_pair_work *work);
size_t scree_depth_count(const scree_world *world, const scree_pair *pair,
                         const scree_scratch *scratch);
scree_depth scree_depth_of(const scree_world *world, const scree_pair *pair,
                           const scree_scratch *scratch, size_t entry);
void scree_pair_take_depths(const scree_world *world, scree_pair *pair, const scree_depth *found,
                            scree_scratch *scratch, scree_pair_work *work);
/* The edges that lie deeper in the other body than `above`, as contacts, the deepest SCREE_DEPTHS
 * of them; the depth of the deepest, m, or `above`. */
enum { SCREE_DEPTHS = 32 };
double scree_depth_contacts(const scree_world *world, scree_pair *pair, const scree_frame *relative,
                            double above, scree_scratch *scratch);

/* The way, in the frame of b, out of which b's rims lead from the places where they lie in a, each
 * as far as it is deep. 0 where none does. */
vec3 scree_separation_off_rims(const scree_world *world, const scree_pair *pair,
                               const scree_frame *relative);

/* seam.c: the area of b's surface inside a as a vector, outward, in the frame of b, m2: the way in
 * which the common volume falls fastest as a moves. 0 where the surfaces do not cross. */
vec3 scree_separation_direction(const scree_particle *a, const scree_particle *b,
                                const scree_frame *relative);
/* Whether they do; a stands `relative` to b. */
bool scree_surfaces_cross(const scree_particle *a, const scree_particle *b,
                          const scree_frame *relative);

/* The smooth maximum m of overlaps, t, and the denominator of the contact weights (law.c). */
typedef struct scree_smooth_maximum {
  double value, cutoff, denominator;
} scree_smooth_maximum;
/* law.c: from the overlaps and tapers of contacts; false when the pair does not touch. */
bool scree_solve_smooth_maximum(const scree_contact_point *contacts, size_t count, double l0,
                                double kappa, scree_smooth_maximum *result);

/* Power of the dashpots and of the tangential forces with the velocities of the last drift. */
typedef struct scree_powers {
  double dashpot, tangential;
} scree_powers;
/* law.c: smooth maximum, forces, memory. Fills the pair's results. */
scree_powers scree_pair_apply_law(const scree_world *world, scree_pair *pair,
                                  const scree_frame *relative, scree_scratch *scratch);

/* contact.c: the work of the second half of the last step, where the two are, the spring's work. */
void scree_pair_begin_work(const scree_world *world, const scree_pair *pair,
                           scree_scratch *scratch);
/* Of the wall on the body in half a step, by the pair's wrench and the wall's last drift. */
double scree_half_work_of_wall(const scree_world *world, const scree_pair *pair);
/* What goes lost when the hysteretic spring is loaded beyond its largest overlap so far. */
double scree_hysteresis_loss(const scree_pair *pair, double before);

/* The whole of a pair's step, its lists being in hand. False where a pool, or the
 * scratch, has too little room: the pair is as before, but for lists that are made again. */
bool scree_pair_evaluate(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
/* The contact at the present places, without what follows of it: the first part of the step. */
bool scree_pair_narrow_phase(const scree_world *world, scree_pair *pair, scree_scratch *scratch);

/* a's orientation in the frame of b. */
quat scree_pair_turned(const scree_world *world, const scree_pair *pair);

/* watch.c: whether one of the two has come through the other; in scratch->work. */
void scree_pair_watch(const scree_world *world, scree_pair *pair, scree_scratch *scratch);

/* The parts of both, one after another. How the two have moved: */
void scree_pair_relate(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
/* Whether its lists are to be made anew. */
bool scree_pair_needs_list(const scree_pair *pair);
/* Items wake; room for what they find. False where there is too little. */
bool scree_pair_wake(scree_pair *pair, scree_scratch *scratch);
/* Then the pair is as it was before the step. */
void scree_pair_step_back(scree_pair *pair, const scree_scratch *scratch);
/* The contacts of feature pair i. */
void scree_pair_visit_feature(const scree_world *world, const scree_pair *pair, uint32_t i,
                              scree_scratch *scratch);
/* After those of all feature pairs: what they found, and which depths are to be found (depth.c).
 * With these, the law. And what comes after it. */
void scree_pair_meet(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
void scree_pair_contact_law(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
void scree_pair_leave(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
/* The contact in the midst of a step, at the places in scratch; its work is kept in the pair. */
void scree_pair_narrow_phase_between(const scree_world *world, scree_pair *pair,
                                     scree_scratch *scratch);

/* substep.c: into how many parts the coming step is cut for this pair. */
uint32_t scree_substep_count(const scree_world *world, const scree_pair *pair,
                             const scree_frame *relative, const scree_scratch *scratch);
/* Pose and motion of a, or b, as this pair sees it, which moved it in sub-steps. */
scree_frame scree_owed_frame(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch, bool of_b);
/* J, of the pair's spring since the last look, as the others did other than was foreseen. */
double scree_unforeseen_work(const scree_world *world, const scree_pair *pair,
                             const scree_scratch *scratch);
/* Force and moment of all but the pair on a, or b, in the last step; of a wall none. */
scree_wrench scree_wrench_of_others(const scree_world *world, const scree_pair *pair,
                                    const scree_scratch *scratch, bool of_b);
/* After scree_pair_narrow_phase: the rest of the step's parts; the wrench is their mean. */
void scree_pair_follow(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
