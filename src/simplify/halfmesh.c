/* Building the half-edges: outgoing half-edges of each vertex by counting sort, twins by search
 * among them (about six). An edge is sound if it has exactly one half-edge each way; with one alone
 * it is boundary; anything else is non-manifold or wound inconsistently: its half-edges get no twin
 * and its ends are locked. */
#include "simplify/halfmesh.h"

#include "base/parallel.h"

#include <string.h>

enum { BLOCK = 4096 };

typedef struct builder {
  const scree_mesh *mesh;
  scree_halfmesh *surface;
  uint32_t *start;  /* per vertex, into fan; vertex_count + 1 */
  uint32_t *fan;    /* half-edges by the vertex they leave */
  size_t fan_count; /* vertices after the cut */
  uint32_t *root;   /* union-find over vertices, for shells */
} builder;

void scree_halfmesh_free(scree_halfmesh *s) {
  scree_free(s->position);
  scree_free(s->outgoing);
  scree_free(s->origin);
  scree_free(s->flags);
  scree_free(s->sums);
  scree_free(s->from);
  scree_free(s->twin);
  scree_free(s->refused);
  *s = (scree_halfmesh){0};
}

static scree_status check_mesh(const scree_mesh *mesh, vec3 *low, vec3 *high, scree_error *error) {
  if (mesh->triangle_count == 0)
    return scree_fail(error, SCREE_BAD_MESH, "the mesh has no triangles to decimate");
  if (mesh->triangle_count > SCREE_NONE / 3 - 1 || mesh->vertex_count > SCREE_NONE - 1)
    return scree_fail(error, SCREE_LIMIT, "%zu triangles are above decimation's limit of %u",
                      mesh->triangle_count, SCREE_NONE / 3 - 1);
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
    if (mesh->triangles[i] >= mesh->vertex_count)
      return scree_fail(error, SCREE_BAD_MESH, "triangle %zu names vertex %u of %zu", i / 3,
                        mesh->triangles[i], mesh->vertex_count);
  *low = *high = vec3_load(mesh->positions);
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    vec3 p = vec3_load(mesh->positions + 3 * v);
    if (!(isfinite(p.x) && isfinite(p.y) && isfinite(p.z)))
      return scree_fail(error, SCREE_BAD_MESH, "vertex %zu is not finite: (%g, %g, %g)", v, p.x,
                        p.y, p.z);
    *low = vec3_min(*low, p);
    *high = vec3_max(*high, p);
  }
  return SCREE_OK;
}

/* The box: its centre, and the power of two not below its longest side. */
static scree_status choose_box(scree_halfmesh *s, vec3 low, vec3 high, scree_error *error) {
  double extent = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
  if (!(extent > 0) || !isfinite(extent))
    return scree_fail(error, SCREE_BAD_MESH, "the mesh has an extent of %g m: nothing to decimate",
                      extent);
  int exponent;
  frexp(extent, &exponent);
  s->scale = ldexp(1, exponent);
  s->centre = vec3_scale(vec3_add(low, high), 0.5);
  return SCREE_OK;
}

static void sort_fans(builder *b) {
  const scree_mesh *mesh = b->mesh;
  size_t half_edges = 3 * mesh->triangle_count;
  memset(b->start, 0, (mesh->vertex_count + 1) * sizeof *b->start);
  for (size_t h = 0; h < half_edges; h++) b->start[mesh->triangles[h] + 1]++;
  for (size_t v = 0; v < mesh->vertex_count; v++) b->start[v + 1] += b->start[v];
  for (size_t h = 0; h < half_edges; h++) b->fan[b->start[mesh->triangles[h]]++] = (uint32_t)h;
  memmove(b->start + 1, b->start, mesh->vertex_count * sizeof *b->start);
  b->start[0] = 0;
}

/* How many half-edges go from u to v, and the last of them. */
static uint32_t count_from_to(const builder *b, uint32_t u, uint32_t v, uint32_t *found) {
  uint32_t count = 0;
  for (uint32_t i = b->start[u]; i < b->start[u + 1]; i++)
    if (b->mesh->triangles[scree_next(b->fan[i])] == v) {
      *found = b->fan[i];
      count++;
    }
  return count;
}

static void find_twins(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  builder *b = context;
  scree_halfmesh *s = b->surface;
  for (size_t h = begin; h < end; h++) {
    uint32_t u = b->mesh->triangles[h], v = b->mesh->triangles[scree_next((uint32_t)h)];
    uint32_t twin = SCREE_NONE, self = SCREE_NONE;
    uint32_t back = count_from_to(b, v, u, &twin), same = count_from_to(b, u, v, &self);
    if (same == 1 && back <= 1 && u != v) {
      s->twin[h] = twin;
    } else {
      s->twin[h] = SCREE_NONE;
      /* several threads may write the same byte, all the same value */
      __atomic_store_n(&s->flags[u], SCREE_VERTEX_LOCKED, __ATOMIC_RELAXED);
      __atomic_store_n(&s->flags[v], SCREE_VERTEX_LOCKED, __ATOMIC_RELAXED);
    }
  }
}

/* Turns clockwise from h to the boundary, or back to h. */
static uint32_t first_of_fan(const scree_halfmesh *s, uint32_t h) {
  for (uint32_t g = h;;) {
    if (s->twin[g] == SCREE_NONE) return g;
    g = scree_next(s->twin[g]);
    if (g == h) return h;
  }
}

/* Gives every fan its own vertex: from[] is set, copies of a vertex are locked. The first fan of
 * vertex v keeps the number v, further ones get numbers from vertex_count on (counted here, written
 * when there is room). */
static void number_fans(builder *b, bool write) {
  const scree_mesh *mesh = b->mesh;
  scree_halfmesh *s = b->surface;
  size_t next_number = mesh->vertex_count;
  for (uint32_t v = 0; v < mesh->vertex_count; v++) {
    uint32_t begin = b->start[v], end = b->start[v + 1], seen = 0;
    if (write) s->outgoing[v] = SCREE_NONE;
    for (uint32_t i = begin; i < end && seen < end - begin; i++) {
      uint32_t h = b->fan[i];
      if (s->from[h] != SCREE_NONE) continue;
      uint32_t number = seen == 0 ? v : (uint32_t)next_number++;
      uint32_t first = first_of_fan(s, h), g = first;
      do {
        s->from[g] = number;
        seen++;
        g = scree_turn(s, g);
      } while (g != SCREE_NONE && g != first);
      if (!write) continue;
      s->outgoing[number] = first;
      s->origin[number] = v;
      if (number != v) s->flags[number] = s->flags[v] = SCREE_VERTEX_LOCKED;
    }
  }
  b->fan_count = next_number;
}

static uint32_t find_root(uint32_t *root, uint32_t v) {
  while (root[v] != v) v = root[v] = root[root[v]];
  return v;
}

static void count_facts(builder *b) {
  scree_halfmesh *s = b->surface;
  size_t boundary = 0, locked = 0, vertices = 0, joined = 0;
  for (uint32_t v = 0; v < s->vertex_count; v++) b->root[v] = v;
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    boundary += s->twin[h] == SCREE_NONE;
    uint32_t u = find_root(b->root, s->from[h]), v = find_root(b->root, scree_to(s, h));
    if (u == v) continue;
    joined++;
    if (u < v) b->root[v] = u;
    if (v < u) b->root[u] = v;
  }
  for (size_t v = 0; v < s->vertex_count; v++) {
    if (s->outgoing[v] == SCREE_NONE) continue;
    vertices++;
    locked += s->flags[v] & SCREE_VERTEX_LOCKED;
  }
  s->shell_count = vertices - joined;
  s->boundary_edge_count = boundary;
  s->locked_vertex_count = locked;
  s->closed = boundary == 0;
  s->live_vertex_count = vertices;
  s->live_triangle_count = s->triangle_count;
}

static scree_status allocate_vertices(scree_halfmesh *s, size_t count, const uint8_t *flags,
                                      size_t flag_count, scree_error *error) {
  SCREE_ALLOC_OR(s->position, count, error, out_of_memory);
  SCREE_ALLOC_OR(s->outgoing, count, error, out_of_memory);
  SCREE_ALLOC_OR(s->origin, count, error, out_of_memory);
  SCREE_ALLOC_OR(s->sums, count, error, out_of_memory);
  uint8_t *grown = scree_alloc_zero(count, 1);
  if (!grown) {
    scree_fail_memory(error, count, "vertex flags");
    goto out_of_memory;
  }
  memcpy(grown, flags, flag_count);
  scree_free(s->flags);
  s->flags = grown;
  s->vertex_count = count;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static void place_vertices(builder *b) {
  scree_halfmesh *s = b->surface;
  for (size_t v = 0; v < s->vertex_count; v++) {
    if (s->outgoing[v] == SCREE_NONE) continue;
    vec3 p = vec3_load(b->mesh->positions + 3 * (size_t)s->origin[v]);
    s->position[v] = vec3_scale(vec3_sub(p, s->centre), 1 / s->scale);
  }
}

scree_status scree_halfmesh_build(const scree_mesh *mesh, scree_halfmesh *surface,
                                  scree_error *error) {
  scree_halfmesh made = {.triangle_count = mesh->triangle_count};
  builder b = {.mesh = mesh, .surface = &made};
  vec3 low = {0, 0, 0}, high = low;
  scree_status status = check_mesh(mesh, &low, &high, error);
  if (status == SCREE_OK) status = choose_box(&made, low, high, error);
  if (status != SCREE_OK) return status;
  size_t half_edges = 3 * mesh->triangle_count;
  status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(made.from, half_edges, error, done);
  SCREE_ALLOC_OR(made.twin, half_edges, error, done);
  SCREE_ALLOC_OR(made.flags, mesh->vertex_count, error, done);
  SCREE_ALLOC_OR(b.start, mesh->vertex_count + 1, error, done);
  SCREE_ALLOC_OR(b.fan, half_edges, error, done);
  memset(made.flags, 0, mesh->vertex_count);
  memset(made.from, 0xff, half_edges * sizeof *made.from);
  sort_fans(&b);
  scree_parallel_for(half_edges, BLOCK, find_twins, &b);
  number_fans(&b, false);
  status = allocate_vertices(&made, b.fan_count, made.flags, mesh->vertex_count, error);
  if (status != SCREE_OK) goto done;
  memset(made.from, 0xff, half_edges * sizeof *made.from);
  number_fans(&b, true);
  place_vertices(&b);
  scree_free(b.fan);
  b.fan = NULL;
  status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(b.root, made.vertex_count, error, done);
  SCREE_ALLOC_OR(made.refused, half_edges, error, done);
  memset(made.refused, 0, half_edges);
  count_facts(&b);
  *surface = made;
  made = (scree_halfmesh){0};
  status = SCREE_OK;
done:
  scree_free(b.start);
  scree_free(b.fan);
  scree_free(b.root);
  scree_halfmesh_free(&made);
  return status;
}

static void move_vertex(scree_halfmesh *s, size_t to, size_t v) {
  s->position[to] = s->position[v];
  s->outgoing[to] = s->outgoing[v];
  s->origin[to] = s->origin[v];
  s->flags[to] = s->flags[v];
  memcpy(s->sums[to], s->sums[v], sizeof s->sums[v]);
}

void scree_halfmesh_compact(scree_halfmesh *s, uint32_t *vertex_scratch,
                            uint32_t *triangle_scratch) {
  uint32_t vertices = 0, triangles = 0;
  for (size_t v = 0; v < s->vertex_count; v++)
    if (s->outgoing[v] != SCREE_NONE) vertex_scratch[v] = vertices++;
  for (size_t t = 0; t < s->triangle_count; t++)
    if (s->from[3 * t] != SCREE_NONE) triangle_scratch[t] = triangles++;
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (s->from[3 * t] == SCREE_NONE) continue;
    size_t to = 3 * (size_t)triangle_scratch[t];
    for (size_t i = 0; i < 3; i++) {
      uint32_t twin = s->twin[3 * t + i];
      s->from[to + i] = vertex_scratch[s->from[3 * t + i]];
      s->twin[to + i] = twin == SCREE_NONE ? twin : 3 * triangle_scratch[twin / 3] + twin % 3;
      s->refused[to + i] = s->refused[3 * t + i];
    }
  }
  for (size_t v = 0; v < s->vertex_count; v++) {
    if (s->outgoing[v] == SCREE_NONE) continue;
    uint32_t h = s->outgoing[v];
    s->outgoing[v] = 3 * triangle_scratch[h / 3] + h % 3;
    if (vertex_scratch[v] != v) move_vertex(s, vertex_scratch[v], v);
  }
  s->vertex_count = s->live_vertex_count = vertices;
  s->triangle_count = s->live_triangle_count = triangles;
}
