/* The candidates of a pair: which of its features could touch. */
#pragma once

#include "world/state/scratch.h"

/* Evaluated for the first time, or since a jump. */
static inline bool scree_pair_is_new(const scree_pair *p) {
  return p->list.path <= p->list.travel;
}
/* How far behind a sheet a point of a new pair may be and still belong to the body's side. */
static inline double scree_pair_clearance(const scree_pair *p, const scree_particle *a,
                                          uint32_t point) {
  return a->point_radii[point] + p->law.smoothing + 0.25 * p->law.thin;
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

/* Which feature pairs could touch within the skin; fills sleeping, keeps active. */
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
