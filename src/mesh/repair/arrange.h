/* Facets cut where they meet, so that none meets another beyond what they share: the arrangement of
 * a surface that crosses, touches and overlaps itself. */
#pragma once

#include "base/progress.h"
#include "mesh/mesh.h"

typedef struct scree_arrangement {
  scree_mesh mesh; /* no two facets on the same vertices, none without area; owned */
  /* By facet: how often it counts, as it is wound; negative: turned round. Never 0. Where the
   * facets that went in close, so do these: at each edge the facets running one way count as often
   * as those running the other. */
  int32_t *weights;
} scree_arrangement;

/* Cuts the facets of a verified mesh. Vertices and facets move by no more than a few times 1e-11 of
 * the bounding box diagonal (1e-13 of the largest coordinate where that is more). *reason is NULL,
 * or why it could not be done, as the end of a sentence; the arrangement is then empty. */
scree_status scree_arrange(const scree_mesh *mesh, const scree_progress *progress,
                           scree_arrangement *arrangement, const char **reason, scree_error *error);
/* How many pairs of facets may meet in a mesh that is cut: as many as it has facets, so that the
 * cost stays in proportion; some seconds' worth are always allowed. */
static inline size_t scree_arrange_limit(const scree_mesh *mesh) {
  const size_t least = 50000;
  return mesh->triangle_count > least ? mesh->triangle_count : least;
}
extern const char scree_arrange_too_many[]; /* the reason where there are more */

void scree_arrangement_free(scree_arrangement *arrangement);
