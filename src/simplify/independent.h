/* Which of many collapses are done together.
 *
 * Two collapses are independent if no end of the one edge is an end of the other or a neighbour of
 * one, and no vertex is apex of both. Of the candidates, at most one per vertex, those are taken
 * that a walk through all in the order of cost would take: each that is independent of those taken
 * before. Equal costs are ordered as if at random, but always the same way.
 *
 * It is found in parallel (after Luby, "A simple parallel algorithm for the maximal independent set
 * problem", SIAM J. Comput. 15, 1986): a candidate cheaper than all that it is not independent of
 * is taken in any case, and those fall out. What is left is looked at again, a few times. The dear
 * ones wait until all is decided among the cheap ones: most are ruled out by then. */
#ifndef SCREE_SIMPLIFY_INDEPENDENT_H
#define SCREE_SIMPLIFY_INDEPENDENT_H

#include "simplify/collapse.h"

/* Candidates come by blocks of so many vertices. */
enum { SCREE_CHOICE_BLOCK = 1024 };

/* A candidate: the edge from a to b, its apexes (d NONE: on a boundary). Once it is taken: a, and
 * its ring's triangles as scree_ring has them, from first_edge on. */
typedef union scree_contender {
  struct {
    uint32_t a, b, c, d;
  };
  struct {
    uint32_t taken, first_edge, a_count, count;
  };
} scree_contender;

typedef struct scree_choosing {
  scree_halfmesh *s;           /* an edge with a ring that is too long is noted as refused */
  const uint32_t *best;        /* per vertex: the half-edge from it that is its candidate */
  const double *cost;          /* per vertex: of that */
  scree_contender *contenders; /* those of block k from k * SCREE_CHOICE_BLOCK on; used up */
  struct scree_choice_count {
    /* of a block: candidates that wait for those of less cost, at its front; in question, after
     * them; taken, at its end */
    uint32_t waiting, left, taken;
    uint32_t just_taken;
  } * counts;
  uint32_t *leader, *apex_leader; /* per vertex: scratch, NONE before and after */
  uint8_t *marks;                 /* per vertex: scratch, 0 before */
  uint32_t *edges;                /* rings; room for one per triangle */
  size_t edge_count;
} scree_choosing;

/* Enters the candidates in question of a block; thread-safe. All must be, before the choice. */
void scree_choose_enter(const scree_choosing *c, size_t block);
/* No candidate that waits is cheaper than one in question. */
void scree_choose_independent(scree_choosing *c);

#endif
