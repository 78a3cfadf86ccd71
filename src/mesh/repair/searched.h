/* What is known of facets that meet, from search to search of a mesh that is being mended: facets
 * that were there before and met nothing do not meet each other. */
#pragma once

#include "mesh/index/intersect.h"

/* Zero: nothing is known. */
typedef struct scree_searched {
  scree_mesh mesh; /* the one searched last, in canonical order */
  bool *met;       /* by facet */
} scree_searched;

void scree_searched_free(scree_searched *searched);

/* Whether a weld would give back the same bits, where every vertex is in use. */
bool scree_is_canonical(const scree_mesh *mesh);

/* Sets, by facet of the mesh, whether it was searched and met nothing; not *known where nothing is,
 * or the mesh is not in canonical order. O(N). */
scree_status scree_searched_settled(const scree_searched *searched, const scree_mesh *mesh,
                                    bool *settled, bool *known, scree_error *error);
/* scree_mesh_meetings by what is known, which learns what is found; searched NULL: nothing is known
 * or learnt. tree, unless it is NULL: the mesh's, made where all is searched and it is not there.
 */
scree_status scree_searched_meetings(scree_searched *searched, const scree_mesh *mesh,
                                     scree_facet_tree *tree, size_t limit,
                                     const scree_progress *progress, scree_meetings *found,
                                     scree_error *error);
