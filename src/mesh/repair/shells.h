/* The separate shells of a mesh, and how they lie in each other. */
#pragma once

#include "mesh/adjacency.h"
#include "mesh/index/intersect.h"

typedef enum scree_shell_kind {
  SCREE_SHELL_OPEN,       /* bounds no volume: an edge is not used equally often both ways */
  SCREE_SHELL_BODY,       /* outward, in empty space */
  SCREE_SHELL_CAVITY,     /* inward, in material */
  SCREE_SHELL_NESTED,     /* in material already, and no cavity: adds nothing to the union */
  SCREE_SHELL_INSIDE_OUT, /* inward, in empty space */
} scree_shell_kind;

typedef struct scree_shell {
  uint32_t first_facet; /* the lowest */
  size_t facet_count;
  bool closed;        /* every edge is used equally often both ways */
  bool met;           /* it crosses, touches or overlaps another */
  double area;        /* m^2 */
  double volume;      /* m^3, signed; about first_facet's first corner where the shell is open */
  long long around;   /* the winding number of the other closed shells around it, but for those
                         that it meets */
  long long depth;    /* how many of them it lies in */
  uint32_t outermost; /* of these, the one that lies in none; SCREE_NO_SHELL: it lies in none */
} scree_shell;

#define SCREE_NO_SHELL UINT32_MAX

typedef struct scree_shells {
  uint32_t *label; /* of each facet: its shell, or SCREE_NO_SHELL where it names a vertex twice */
  scree_shell *items; /* by first_facet */
  size_t count;
} scree_shells;

/* Finds the facets connected through shared edges; as if no shell lay in another. O(N). */
scree_status scree_shells_find(const scree_mesh *mesh, const scree_adjacency *adjacency,
                               scree_shells *shells, scree_error *error);
void scree_shells_free(scree_shells *shells);
/* Whether all are. */
bool scree_shells_closed(const scree_shells *shells);

/* Which shells meet which. */
typedef struct scree_shell_pairs {
  uint64_t *keys; /* ascending, each once: the lower shell << 32 | the higher */
  size_t count;
} scree_shell_pairs;

/* Those whose facets do. Free keys with scree_free. */
scree_status scree_shell_pairs_find(const scree_shells *shells, const scree_meetings *found,
                                    scree_shell_pairs *pairs, scree_error *error);

/* Fills `met`, and `around`, `depth` and `outermost` of the closed shells, by shooting a ray from a
 * vertex of each that no other shell has, where there is one. A shell that meets another lies in
 * part within it and in part without, so the two are not asked about each other: with all pairs
 * that meet, the answer is exact and the same from whatever side. Without (NULL), that of shells
 * that cross is the answer for one of their vertices. O(log N + crossings) each. */
scree_status scree_shells_wind(scree_shells *shells, const scree_shell_pairs *pairs,
                               const scree_facet_tree *tree, scree_error *error);

scree_shell_kind scree_shell_kind_of(const scree_shell *shell);
