/* What a collapse costs and where its vertex goes: the two methods. */
#pragma once

#include "simplify/halfmesh.h"

typedef struct scree_candidate {
  double cost;  /* the order of collapses, without the deviation's part; INFINITY: not possible */
  vec3 target;  /* in the unit box */
  double error; /* mean square move of the surface, in units of the box squared */
  double area;  /* doubled, of the triangles around; volume only */
} scree_candidate;

/* Other places where the best is not allowed or far from the scan: the middle and the ends of the
 * edge, as near as the method lets. */
enum { SCREE_FALLBACK_COUNT = 3 };

typedef struct scree_coster {
  /* Fills the sums of v from the triangles around v. Volume: after every change of them; qecd: once
   * at the start. */
  void (*sum)(scree_halfmesh *s, uint32_t v);
  /* The best place for each edge. Many at once: cheaper than one by one, and the same bits. */
  void (*evaluate)(const scree_halfmesh *s, const uint32_t *half_edges, size_t count,
                   scree_candidate *candidates);
  /* The cost at another place, fallback in [0, SCREE_FALLBACK_COUNT). */
  void (*fall_back)(const scree_halfmesh *s, uint32_t half_edge, int fallback,
                    scree_candidate *candidate);
  /* What the sums of the survivor are after the collapse; NULL: found anew by sum. */
  void (*merge)(scree_halfmesh *s, uint32_t survivor, uint32_t gone);
} scree_coster;

extern const scree_coster scree_volume_coster, scree_qecd_coster;
