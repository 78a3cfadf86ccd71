/* A pair's contact: its features, their overlaps, the law, the step of the pair. */
#pragma once

#include "world/state/constants.h"
#include "world/state/scratch.h"

/* m/s, at most, with which bodies that lie in each other are moved apart (law.c). */
static inline double scree_depenetration_speed(const scree_pair_law *law) {
  return law->limit / (passage_patience * law->contact_time);
}

/* Whether the two are on their way out of each other. */
static inline bool scree_is_pushed(const scree_pair *pair) {
  return pair->depenetrating && vec3_norm2(pair->apart.direction) > 0;
}

/* Whether there is anything to be found before the law. */
static inline bool scree_asks_depths(const scree_depth_question *question) {
  return question->start || question->edges;
}

/* The deepest point of an edge: the way along it, the depth (below 0 outside) and its slope. */
typedef struct scree_depth {
  double s, depth;
  vec3 slope;
} scree_depth;

/* The contact radius of features of one of the two, a mesh; a wall has no say in it. */
static inline double scree_pair_contact_radius(const scree_world *w, const scree_pair *p,
                                               bool of_b) {
  const scree_particle *a = w->bodies.particle[p->a], *b = scree_pair_shape_b(w, p);
  if (p->wall) return of_b ? b->radius : a->radius;
  return of_b ? scree_contact_radius(b, a) : scree_contact_radius(a, b);
}

/* How far apart, beyond the contact radii, edges may lie that the last step's overlap can make
 * count: those that come in behind a corner are tapered, and deeper than they are felt. 0 at rest.
 */
static inline double scree_pair_edge_reach(const scree_pair *p) {
  double beyond = p->contact.overlap - p->law.reach;
  return beyond > 0 ? 2 * beyond : 0;
}

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
/* Work of the wall on the body in half a step, by the pair's wrench and the wall's last drift, J.
 */
double scree_half_work_of_wall(const scree_world *world, const scree_pair *pair);
/* Whether the pair's spring is hardened. */
void scree_note_pressed(const scree_world *world, const scree_pair *pair, scree_scratch *scratch,
                        scree_pair_work *work);
/* What goes lost when the hysteretic spring is loaded beyond its largest overlap so far. */
double scree_hysteresis_loss(const scree_pair *pair, double before);

/* The whole of a pair's step, its lists being in hand. False where a pool, or the
 * scratch, has too little room: the pair is as before, but for lists that are made again. */
bool scree_pair_evaluate(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
/* The contact at the present places, without what follows of it: the first part of the step. */
bool scree_pair_narrow_phase(const scree_world *world, scree_pair *pair, scree_scratch *scratch);

/* a's orientation in the frame of b. */
static inline quat scree_pair_turned(const scree_world *world, const scree_pair *pair) {
  quat b =
      pair->wall ? world->walls.items[pair->b].orientation : world->bodies.orientation[pair->b];
  return quat_mul(quat_conjugate(b), world->bodies.orientation[pair->a]);
}
/* Sum of the paths of its two. */
static inline double scree_bodies_path(const scree_world *world, const scree_pair *pair) {
  const double *path = world->bodies.path;
  return path[pair->a] + (pair->wall ? world->walls.items[pair->b].path : path[pair->b]);
}

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

/* substep.c: after scree_pair_narrow_phase: the rest of the step's parts; the wrench is their mean.
 */
void scree_pair_follow(const scree_world *world, scree_pair *pair, scree_scratch *scratch);
