/* What a collapse costs and where its vertex goes: the two methods. */
#ifndef SCREE_SIMPLIFY_COST_H
#define SCREE_SIMPLIFY_COST_H

#include "simplify/halfmesh.h"

typedef struct scree_candidate {
  double cost;  /* the order of collapses, without the stray's part; INFINITY: not possible */
  vec3 target;  /* in the unit box */
  double error; /* mean square move of the surface, in units of the box squared */
  double stray; /* weight of the stray's (stray.h) fourth power in the cost; 0: it does not count */
} scree_candidate;

/* A stray's part in the cost below this share of the rest is not looked for. */
#define SCREE_STRAY_SHARE 0.01

/* The squared stray that makes the whole cost `whole`, or the greatest that is not looked for. */
static inline double scree_stray_at(const scree_candidate *c, double whole) {
  double part = whole - c->cost, least = SCREE_STRAY_SHARE * c->cost;
  return sqrt((part > least ? part : least) / c->stray);
}

enum { SCREE_FALLBACK_COUNT = 3 };

typedef struct scree_coster {
  /* Fills the sums of v from the triangles around v. Volume: after every change of them; qecd: once
   * at the start. */
  void (*sum)(scree_halfmesh *s, uint32_t v);
  /* Many at once: cheaper than one by one, and the same bits. Without what `shape` adds. */
  void (*evaluate)(const scree_halfmesh *s, const uint32_t *half_edges, size_t count,
                   scree_candidate *candidates);
  /* Raises the cost by what the shape of the new triangles takes, which is dear to find: where that
   * is surely above `most`, to INFINITY; qecd only. */
  void (*shape)(const scree_halfmesh *s, uint32_t half_edge, double most,
                scree_candidate *candidate);
  /* The whole cost of another place, where the best is not allowed: fallback in [0,
   * SCREE_FALLBACK_COUNT), the middle and the ends of the edge, as near as the method lets. */
  void (*fall_back)(const scree_halfmesh *s, uint32_t half_edge, int fallback,
                    scree_candidate *candidate);
  /* What the sums of the survivor are after the collapse; qecd only. */
  void (*merge)(scree_halfmesh *s, uint32_t survivor, uint32_t gone);
} scree_coster;

extern const scree_coster scree_volume_coster, scree_qecd_coster;

#endif
