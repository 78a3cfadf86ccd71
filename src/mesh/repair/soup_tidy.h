/* The steps of soup.c that only look at places: welding, junctions, doubles. */
#pragma once

#include "mesh/repair/soup.h"

/* m: what lies closer than this is at one place. */
double scree_soup_tolerance(const scree_mesh *mesh);
/* Welds, drops what is flat, sets vertices into edges that run past them, drops facets that name
 * the same vertices as others. Vertices keep their order where none is welded. */
scree_status scree_soup_tidy(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error);
/* Sets vertices into edges of one facet that run past them. */
scree_status scree_soup_join(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error);
