/* What a pass over all edges finds: the cheapest edge of every vertex, and up to which cost edges
 * are for this pass. For batches (batch.c) and patches (patch.c). */
#ifndef SCREE_SIMPLIFY_CHEAPEST_H
#define SCREE_SIMPLIFY_CHEAPEST_H

#include "base/prefetch.h"
#include "base/radix.h"
#include "simplify/decimate.h"

#include <string.h>

/* Vertices of a block; edges evaluated in one call. */
enum { SCREE_PASS_BLOCK = 1024, SCREE_SIDE_BY_SIDE = 64 };

typedef struct scree_cheapest {
  scree_decimator *d;
  scree_halfmesh *s; /* the decimator's surface, or with sums of its own (patch.c) */
  uint32_t *best;    /* per vertex: half-edge of its cheapest edge, or NONE */
  double *cost;      /* per vertex: of that; INFINITY: it has none */
  double limit;      /* the most for this pass */
  double low;        /* the cost that a low share of the edges does not exceed */
  uint32_t *bins;    /* twice two sets */
} scree_cheapest;

scree_status scree_cheapest_allocate(scree_cheapest *e, scree_decimator *d);
void scree_cheapest_free(scree_cheapest *e);

/* Finds the sums of all vertices that are stale; nothing to do with qecd, which keeps them. */
void scree_cheapest_refresh_sums(scree_cheapest *e);
/* Evaluates all edges that may be collapsed, each from one of its ends. Sums must be fresh. Edges
 * that were refused are looked at again where a triangle at their ends has changed since. */
void scree_cheapest_find(scree_cheapest *e);
/* The same of these vertices alone, in this thread. */
void scree_cheapest_find_of(scree_cheapest *e, const uint32_t *vertices, size_t count);
/* Sets the limit: a share of all that was found, most of it while the levels are fine. False: there
 * is nothing to collapse. */
bool scree_cheapest_set_limit(scree_cheapest *e);
/* What these edges, at most SCREE_SIDE_BY_SIDE, cost now, for the vertices that they come from. */
void scree_cheapest_renew(scree_cheapest *e, const uint32_t *half_edges, uint32_t count);

/* While more than a share of the scan's triangles is left: hardly a level that anybody asks for. */
bool scree_is_fine(const scree_decimator *d);

/* Items of equal key by the rest of their cost, where few are equal. Where many are (a regular grid
 * on a flat) the rest is rounding, and the order that they have serves as well. */
void scree_refine_order(scree_keyed *items, size_t count,
                        double (*cost)(const void *context, uint32_t index), const void *context);

/* The leading 32 bits below the sign: monotone in the cost. */
static inline uint32_t scree_key_of(double cost) {
  uint64_t bits;
  memcpy(&bits, &cost, sizeof bits);
  return (uint32_t)(bits >> 31);
}

/* Asks for these vertices and most of their triangles, which lie in the same order: before a loop
 * over them that would wait for one after the other. */
SCREE_PREFETCHES void scree_ask_for_block(const scree_halfmesh *s, size_t begin, size_t end) {
  enum { MOST = 16384 }; /* half-edges; more are no block */
  scree_prefetch(s->vertex + begin, (end - begin) * sizeof *s->vertex);
  while (begin < end && s->vertex[begin].outgoing == SCREE_NONE) begin++;
  while (begin < end && s->vertex[end - 1].outgoing == SCREE_NONE) end--;
  if (begin == end) return;
  uint32_t first = s->vertex[begin].outgoing, last = s->vertex[end - 1].outgoing;
  if (first < last && last - first <= MOST)
    scree_prefetch(s->half + first, (last - first) * sizeof *s->half);
}

#endif
