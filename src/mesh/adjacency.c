/* Edges by counting sort: each half-edge goes to the bucket of its lower vertex; within a bucket
 * the pairs (higher vertex, half-edge), packed in 64 bits, are sorted. A bucket holds about six
 * pairs, so insertion sort does; a hub of thousands of facets falls back on qsort. Equal higher
 * vertices then stand together in ascending order of half-edge: one edge. */
#include "mesh/adjacency.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "base/radix.h"
#include "mesh/mesh.h"

#include <string.h>

enum { VERTEX_BLOCK = 1 << 14 }; /* vertices per parallel block */

typedef struct builder {
  const scree_mesh *mesh;
  uint32_t *start;  /* vertex_count + 1; bucket v is [start[v], start[v + 1]) */
  uint32_t *second; /* the same of what the second half of the triangles puts into it */
  uint64_t *pairs;  /* higher vertex << 32 | half-edge */
  size_t *block_edges;
  scree_adjacency *out;
} builder;

static void count_half(void *context, scree_block block) {
  const builder *b = context;
  uint32_t *count = block.index == 0 ? b->start : b->second;
  for (size_t c = 3 * block.begin; c < 3 * block.end; c += 3) {
    const uint32_t *corner = b->mesh->triangles + c;
    if (scree_names_twice(corner)) continue;
    for (int k = 0; k < 3; k++) {
      uint32_t from = corner[k], to = corner[(k + 1) % 3];
      count[from < to ? from : to]++;
    }
  }
}

/* From the end of each part of a bucket to its beginning. */
static void fill_half(void *context, scree_block block) {
  const builder *b = context;
  uint32_t *place = block.index == 0 ? b->start : b->second;
  for (size_t c = 3 * block.end; c > 3 * block.begin;) {
    c -= 3;
    const uint32_t *corner = b->mesh->triangles + c;
    bool part = !scree_names_twice(corner);
    for (int k = 2; k >= 0; k--) {
      uint32_t from = corner[k], to = corner[(k + 1) % 3], h = (uint32_t)c + (uint32_t)k;
      if (!part) {
        b->out->ring[h] = SCREE_NO_HALF_EDGE;
        continue;
      }
      uint32_t low = from < to ? from : to, high = from < to ? to : from;
      b->pairs[--place[low]] = (uint64_t)high << 32 | h;
    }
  }
}

/* Counts the bucket sizes, then places the pairs; on return start[v] is where bucket v begins. */
static void fill_buckets(builder *b) {
  size_t count = b->mesh->triangle_count, half = count / 2 + 1;
  uint32_t sum = 0;
  memset(b->start, 0, (b->mesh->vertex_count + 1) * sizeof *b->start);
  memset(b->second, 0, (b->mesh->vertex_count + 1) * sizeof *b->second);
  scree_parallel_for(count, half, count_half, b);
  for (size_t v = 0; v <= b->mesh->vertex_count; v++) {
    b->start[v] = sum += b->start[v];
    b->second[v] = sum += b->second[v];
  }
  scree_parallel_for(count, half, fill_half, b);
}

/* Sorts the buckets of a block of vertices, links the rings, and leaves the lowest half-edge of
 * each edge at the front of the block's pairs. */
static void link_block(void *context, scree_block block) {
  builder *b = context;
  uint32_t *ring = b->out->ring;
  size_t write = b->start[block.begin];
  for (size_t v = block.begin; v < block.end; v++) {
    size_t first = b->start[v], last = b->start[v + 1];
    scree_sort_keys(b->pairs + first, last - first);
    for (size_t i = first; i < last;) {
      uint32_t lowest = (uint32_t)b->pairs[i], high = (uint32_t)(b->pairs[i] >> 32);
      uint32_t h = lowest;
      for (i++; i < last && (uint32_t)(b->pairs[i] >> 32) == high; i++) {
        uint32_t next = (uint32_t)b->pairs[i];
        ring[h] = next;
        h = next;
      }
      ring[h] = lowest;
      b->pairs[write++] = lowest;
    }
  }
  b->block_edges[block.index] = write - b->start[block.begin];
}

static scree_status collect_edges(builder *b, size_t block_count, scree_error *error) {
  size_t edge_count = 0;
  for (size_t i = 0; i < block_count; i++) edge_count += b->block_edges[i];
  SCREE_TRY_ALLOC(b->out->edges, edge_count, error);
  scree_populate(b->out->edges, edge_count * sizeof *b->out->edges);
  uint32_t *edge = b->out->edges;
  for (size_t i = 0; i < block_count; i++) {
    const uint64_t *pair = b->pairs + b->start[i * VERTEX_BLOCK];
    for (size_t j = 0; j < b->block_edges[i]; j++) *edge++ = (uint32_t)pair[j];
  }
  b->out->edge_count = edge_count;
  return SCREE_OK;
}

scree_status scree_adjacency_build(const scree_mesh *mesh, scree_adjacency *adjacency,
                                   scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency made = {0};
  size_t block_count = scree_block_count(mesh->vertex_count, VERTEX_BLOCK);
  *adjacency = made;
  SCREE_TRY_ALLOC(made.ring, 3 * mesh->triangle_count, error);
  /* one block, for a large one costs fewer page faults */
  SCREE_SCRATCH(uint64_t, pairs, 3 * mesh->triangle_count + mesh->vertex_count + 1, error);
  SCREE_SCRATCH(size_t, block_edges, block_count, error);
  uint32_t *start = (uint32_t *)(pairs + 3 * mesh->triangle_count);
  builder b = {mesh, start, start + mesh->vertex_count + 1, pairs, block_edges, &made};
  fill_buckets(&b);
  scree_parallel_for(mesh->vertex_count, VERTEX_BLOCK, link_block, &b);
  SCREE_TRY(collect_edges(&b, block_count, error));
  *adjacency = made;
  made = (scree_adjacency){0};
  return SCREE_OK;
}

void scree_adjacency_free(scree_adjacency *adjacency) {
  if (!adjacency) return;
  scree_free(adjacency->ring);
  scree_free(adjacency->edges);
  *adjacency = (scree_adjacency){0};
}

void scree_join_over_edges(const scree_mesh *mesh, const scree_adjacency *adjacency, bool manifold,
                           uint32_t *parent) {
  const uint32_t *ring = adjacency->ring;
  for (size_t t = 0; t < mesh->triangle_count; t++) parent[t] = (uint32_t)t;
  for (size_t e = 0; e < adjacency->edge_count; e++) {
    uint32_t first = adjacency->edges[e];
    if (manifold && ring[ring[first]] != first) continue;
    for (uint32_t h = ring[first]; h != first; h = ring[h]) scree_join(parent, first / 3, h / 3);
  }
}
