/* Where two facets meet, as vertices for both: the geometry of an arrangement
 * (mesh/repair/arrange.c). */
#pragma once

#include "mesh/index/facet_tree.h"

/* Features of a facet: corners 0 to 2, edges 3 to 5 (3 + k runs from corner k to k + 1), within. */
enum { SCREE_SITE_EDGE = 3, SCREE_SITE_WITHIN = 6, SCREE_SITES = 48 };

typedef struct scree_site {
  double at[3];
  uint32_t vertex; /* UINT32_MAX: a new one */
  uint8_t t_feature, u_feature;
} scree_site;

/* One of two facets. */
typedef struct scree_site_facet {
  uint32_t v[3];
  const double *p[3];
  bool flat; /* its height over the longest edge is below the tolerance: it has no inside */
} scree_site_facet;

/* Whether the height over the longest edge is below the tolerance; *longest is that edge. */
bool scree_site_is_flat(const double *const p[3], double tolerance, int *longest);

/* Lists the places where two facets come together, within the tolerance: corners, crossings of
 * edges, edges going through. Vertices that they share are among them. Which side of a facet a
 * corner lies on is told by exact predicates. Answers how many, at most SCREE_SITES. */
int scree_sites_find(const scree_site_facet *t, const scree_site_facet *u, double tolerance,
                     scree_site *sites);

typedef struct scree_facet_pair {
  uint32_t first, second;
} scree_facet_pair;

typedef struct scree_facet_pairs {
  scree_facet_pair *items;
  size_t count, capacity;
} scree_facet_pairs;

/* Appends all pairs of the tree's facets, ascending, that may come within the tolerance of each
 * other: neither lies wholly beyond the other's plane or one of its edges. False when memory is
 * out. O(N log N + pairs).
 */
bool scree_near_pairs(const scree_facet_tree *tree, double tolerance, scree_facet_pairs *pairs);
