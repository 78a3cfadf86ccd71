/* Building the half-edges: vertices and triangles in an order that keeps neighbours together
 * (morton.h), outgoing half-edges of each vertex by counting sort, twins by search among them
 * (about six). An edge is sound if it has exactly one half-edge each way; with one alone it is
 * boundary; anything else is non-manifold or wound inconsistently: its half-edges get no twin and
 * its ends are locked. */
#include "simplify/halfmesh.h"

#include "base/parallel.h"
#include "mesh/mesh.h"
#include "simplify/morton.h"

#include <string.h>

enum { BLOCK = 4096 };
/* A flag of vertices while building. */
enum { SEVERAL_FANS = 128 };

typedef struct builder {
  const scree_mesh *mesh;
  scree_halfmesh *surface;
  uint32_t *order;   /* vertex v of the surface is order[v] of the mesh */
  uint32_t *start;   /* per vertex, into fan; vertex_count + 1 */
  uint32_t *rank;    /* of the mesh's vertices in the order */
  uint32_t *next[2]; /* per vertex: where what the first and the second half of the triangles have
                        of it goes */
  uint32_t *fan;     /* half-edges by the vertex they leave */
  uint32_t *fan_to;  /* the vertices that these lead to */
  size_t fan_count;  /* vertices after the cut */
  uint32_t *root;    /* union-find over vertices, for shells */
  size_t joined;     /* how often two sets became one */
} builder;

static void free_builder(builder *b) {
  scree_free(b->order);
  scree_free(b->start);
  scree_free(b->fan);
  scree_free(b->fan_to);
  scree_free(b->root);
}

void scree_halfmesh_free(scree_halfmesh *s) {
  scree_free(s->vertex);
  scree_free(s->half);
  scree_free(s->flags);
  scree_free(s->sums);
  *s = (scree_halfmesh){0};
}

/* What is found of a part of the mesh: its box, and whether something in it is wrong. */
typedef struct part {
  vec3 low, high;
  bool bad;
} part;

enum { PARTS = 64 };

typedef struct checking {
  const scree_mesh *mesh;
  part parts[PARTS];
} checking;

static void check_parts(void *context, scree_block block) {
  checking *c = context;
  const scree_mesh *mesh = c->mesh;
  const size_t triangles = mesh->triangle_count, vertices = mesh->vertex_count;
  for (size_t i = block.begin; i < block.end; i++) {
    part found = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, false};
    for (size_t t = triangles * i / PARTS; t < triangles * (i + 1) / PARTS; t++) {
      const uint32_t *v = mesh->triangles + 3 * t;
      found.bad |=
          (v[0] >= vertices) | (v[1] >= vertices) | (v[2] >= vertices) | scree_names_twice(v);
    }
    for (size_t v = vertices * i / PARTS; v < vertices * (i + 1) / PARTS; v++) {
      vec3 p = vec3_load(mesh->positions + 3 * v);
      found.bad |= !isfinite(p.x) | !isfinite(p.y) | !isfinite(p.z);
      found.low = vec3_min(found.low, p);
      found.high = vec3_max(found.high, p);
    }
    c->parts[i] = found;
  }
}

/* A facet that names a vertex twice has no place in the surface, and levels could not be counted.
 */
static scree_status refuse(const scree_mesh *mesh, scree_error *error) {
  SCREE_TRY(scree_mesh_verify(mesh, error));
  size_t t = 0;
  while (!scree_names_twice(mesh->triangles + 3 * t)) t++;
  const uint32_t *c = mesh->triangles + 3 * t;
  return scree_fail(error, SCREE_BAD_MESH,
                    "triangle %zu names vertex %u twice; repair the mesh first", t,
                    c[0] == c[1] ? c[0] : c[2]);
}

static scree_status check_mesh(const scree_mesh *mesh, vec3 *low, vec3 *high, scree_error *error) {
  checking c = {.mesh = mesh};
  bool bad = false;
  if (mesh->triangle_count == 0)
    return scree_fail(error, SCREE_BAD_MESH, "the mesh has no triangles to decimate");
  if (mesh->triangle_count > SCREE_NONE / 3 - 1 || mesh->vertex_count > SCREE_NONE - 1)
    return scree_fail(error, SCREE_LIMIT, "%zu triangles are above decimation's limit of %u",
                      mesh->triangle_count, SCREE_NONE / 3 - 1);
  scree_parallel_for(PARTS, 1, check_parts, &c);
  *low = c.parts[0].low;
  *high = c.parts[0].high;
  for (size_t i = 0; i < PARTS; i++) {
    bad |= c.parts[i].bad;
    *low = vec3_min(*low, c.parts[i].low);
    *high = vec3_max(*high, c.parts[i].high);
  }
  return bad ? refuse(mesh, error) : SCREE_OK;
}

/* The box: its centre, and the power of two not below its longest side. */
static scree_status choose_box(scree_halfmesh *s, const scree_halfmesh *other, vec3 low, vec3 high,
                               scree_error *error) {
  if (other) {
    s->scale = other->scale;
    s->centre = other->centre;
    s->low = other->low;
    s->high = other->high;
    return SCREE_OK;
  }
  double extent = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
  if (!(extent > 0) || !isfinite(extent))
    return scree_fail(error, SCREE_BAD_MESH, "the mesh has an extent of %g m: nothing to decimate",
                      extent);
  int exponent;
  frexp(extent, &exponent);
  s->scale = ldexp(1, exponent);
  s->centre = vec3_scale(vec3_add(low, high), 0.5);
  s->low = scree_into_box(s, low);
  s->high = scree_into_box(s, high);
  return SCREE_OK;
}

static uint32_t least_of(uint32_t a, uint32_t b, uint32_t c) {
  uint32_t ab = a < b ? a : b;
  return ab < c ? ab : c;
}

/* ---- Counting sorts: each half of the triangles by itself ---- */

static void clear_counts(builder *b) {
  size_t size = b->mesh->vertex_count * sizeof *b->next[0];
  for (int half = 0; half < 2; half++) memset(b->next[half], 0, size);
}

/* Counts become places, and start where each vertex begins. */
static void sum_counts(builder *b) {
  uint32_t sum = 0;
  for (size_t v = 0; v < b->mesh->vertex_count; v++) {
    uint32_t first = b->next[0][v], second = b->next[1][v];
    b->start[v] = b->next[0][v] = sum;
    b->next[1][v] = sum += first;
    sum += second;
  }
  b->start[b->mesh->vertex_count] = sum;
}

/* Both count into next[half] of the builder, and go by triangles. */
static void sort_by_vertex(builder *b, scree_block_function *count, scree_block_function *fill) {
  size_t triangles = b->mesh->triangle_count;
  clear_counts(b);
  scree_parallel_for(triangles, triangles / 2 + 1, count, b);
  sum_counts(b);
  scree_parallel_for(triangles, triangles / 2 + 1, fill, b);
}

/* The lowest corner of a triangle of the mesh, by rank. */
static uint32_t lowest_corner(const builder *b, size_t triangle) {
  const uint32_t *corner = b->mesh->triangles + 3 * triangle;
  return least_of(b->rank[corner[0]], b->rank[corner[1]], b->rank[corner[2]]);
}

static void count_triangles(void *context, scree_block block) {
  const builder *b = context;
  for (size_t t = block.begin; t < block.end; t++) b->next[block.index][lowest_corner(b, t)]++;
}

static void fill_triangles(void *context, scree_block block) {
  const builder *b = context;
  for (size_t t = block.begin; t < block.end; t++) {
    const uint32_t *corner = b->mesh->triangles + 3 * t;
    scree_half_edge *made =
        b->surface->half + 3 * (size_t)b->next[block.index][lowest_corner(b, t)]++;
    for (int i = 0; i < 3; i++) made[i] = (scree_half_edge){b->rank[corner[i]], SCREE_NONE};
  }
}

/* Triangles in the order of their lowest vertex; corners have the surface's numbers. */
static void place_triangles(builder *b) {
  sort_by_vertex(b, count_triangles, fill_triangles);
}

static void count_fans(void *context, scree_block block) {
  const builder *b = context;
  for (size_t h = 3 * block.begin; h < 3 * block.end; h++)
    b->next[block.index][b->surface->half[h].from]++;
}

static void fill_fans(void *context, scree_block block) {
  const builder *b = context;
  const scree_half_edge *edge = b->surface->half;
  for (size_t h = 3 * block.begin; h < 3 * block.end; h += 3)
    for (size_t i = 0; i < 3; i++) {
      uint32_t at = b->next[block.index][edge[h + i].from]++;
      b->fan[at] = (uint32_t)(h + i);
      b->fan_to[at] = edge[i < 2 ? h + i + 1 : h].from;
    }
}

/* The half-edges of each vertex. */
static void sort_fans(builder *b) {
  sort_by_vertex(b, count_fans, fill_fans);
}

static void rank_vertices(void *context, scree_block block) {
  const builder *b = context;
  for (size_t v = block.begin; v < block.end; v++) b->rank[b->order[v]] = (uint32_t)v;
}

/* Neighbours are near in memory. */
static scree_status place_in_order(builder *b, vec3 centre, scree_error *error) {
  const scree_mesh *mesh = b->mesh;
  SCREE_TRY_ALLOC(b->order, mesh->vertex_count, error);
  SCREE_TRY(scree_order_vertices(mesh, centre, b->order, error));
  scree_parallel_for(mesh->vertex_count, BLOCK, rank_vertices, b);
  place_triangles(b);
  return SCREE_OK;
}

/* How many half-edges go from u to v, and the last of them. */
static uint32_t count_from_to(const builder *b, uint32_t u, uint32_t v, uint32_t *found) {
  uint32_t count = 0;
  for (uint32_t i = b->start[u]; i < b->start[u + 1]; i++)
    if (b->fan_to[i] == v) {
      *found = b->fan[i];
      count++;
    }
  return count;
}

/* Several threads may write the same byte, all the same value. */
static void lock(scree_halfmesh *s, uint32_t v) {
  __atomic_store_n(&s->flags[v], SCREE_VERTEX_LOCKED, __ATOMIC_RELAXED);
}

/* An edge is looked at from its lower end if a half-edge leaves from there, else from the other. */
static void find_twins(void *context, scree_block block) {
  builder *b = context;
  scree_halfmesh *s = b->surface;
  for (uint32_t u = (uint32_t)block.begin; u < block.end; u++)
    for (uint32_t i = b->start[u]; i < b->start[u + 1]; i++) {
      uint32_t h = b->fan[i], v = b->fan_to[i], twin = SCREE_NONE, self;
      uint32_t back = count_from_to(b, v, u, &twin);
      if (back > 0 && v < u) continue;
      if (back > 1 || u == v || count_from_to(b, u, v, &self) > 1) {
        lock(s, u);
        lock(s, v);
      } else if (back == 1) {
        s->half[h].twin = twin;
        s->half[twin].twin = h;
      }
    }
}

/* Turns clockwise from h to the boundary, or back to h. */
static uint32_t first_of_fan(const scree_halfmesh *s, uint32_t h) {
  for (uint32_t g = h;;) {
    if (s->half[g].twin == SCREE_NONE) return g;
    g = scree_next(s->half[g].twin);
    if (g == h) return h;
  }
}

/* Names the half-edges of the fan that begins with `first`; answers how many they are. */
static uint32_t name_fan(scree_halfmesh *s, uint32_t first, uint32_t number) {
  uint32_t count = 0, g = first;
  do {
    s->half[g].from = number;
    count++;
    g = scree_turn(s, g);
  } while (g != SCREE_NONE && g != first);
  return count;
}

/* Gives every further fan of a vertex, where half-edges of a first fan do not reach all, a number
 * of its own. */
static void cut_vertex(builder *b, uint32_t v) {
  scree_halfmesh *s = b->surface;
  uint32_t begin = b->start[v], end = b->start[v + 1];
  for (uint32_t i = begin; i < end; i++) s->half[b->fan[i]].from = SCREE_NONE;
  for (uint32_t i = begin; i < end; i++)
    if (s->half[b->fan[i]].from == SCREE_NONE)
      name_fan(s, first_of_fan(s, b->fan[i]), i == begin ? v : (uint32_t)b->fan_count++);
}

/* Marks the vertices of several fans. */
static void find_cuts(void *context, scree_block block) {
  builder *b = context;
  scree_halfmesh *s = b->surface;
  for (uint32_t v = (uint32_t)block.begin; v < block.end; v++) {
    uint32_t valence = b->start[v + 1] - b->start[v];
    if (valence > 0 && name_fan(s, first_of_fan(s, b->fan[b->start[v]]), v) < valence)
      s->flags[v] = SCREE_VERTEX_LOCKED | SEVERAL_FANS;
  }
}

/* Vertex v of the mesh: its first fan keeps the number. */
static void place_vertices(void *context, scree_block block) {
  builder *b = context;
  scree_halfmesh *s = b->surface;
  for (uint32_t v = (uint32_t)block.begin; v < block.end; v++) {
    scree_vertex *made = &s->vertex[v];
    *made = (scree_vertex){.outgoing = SCREE_NONE, .origin = b->order[v]};
    if (b->start[v] == b->start[v + 1]) continue;
    vec3 p = vec3_load(b->mesh->positions + 3 * (size_t)made->origin);
    made->at = scree_into_box(s, p);
    made->outgoing = first_of_fan(s, b->fan[b->start[v]]);
  }
}

/* The further fans' vertices, copies of v. */
static void place_copies(builder *b, uint32_t v) {
  scree_halfmesh *s = b->surface;
  s->flags[v] = SCREE_VERTEX_LOCKED;
  for (uint32_t i = b->start[v]; i < b->start[v + 1]; i++) {
    uint32_t number = s->half[b->fan[i]].from;
    if (number == v) continue;
    s->vertex[number] = s->vertex[v];
    s->vertex[number].outgoing = first_of_fan(s, b->fan[i]);
    s->flags[number] = SCREE_VERTEX_LOCKED;
  }
}

/* ---- Shells: union-find by all threads, roots the lowest of their shell ---- */

/* What a thread writes is an ancestor, lower than v; that another has found a lower one does no
 * harm. */
static uint32_t find_root(uint32_t *root, uint32_t v) {
  for (;;) {
    uint32_t above = __atomic_load_n(&root[v], __ATOMIC_RELAXED);
    if (above == v) return v;
    uint32_t next = __atomic_load_n(&root[above], __ATOMIC_RELAXED);
    if (next != above) __atomic_store_n(&root[v], next, __ATOMIC_RELAXED);
    v = next;
  }
}

/* Whether u and v lay in different sets. */
static bool join(uint32_t *root, uint32_t u, uint32_t v) {
  while ((u = find_root(root, u)) != (v = find_root(root, v))) {
    uint32_t low = u < v ? u : v, high = u < v ? v : u, expected = high;
    if (__atomic_compare_exchange_n(&root[high], &expected, low, false, __ATOMIC_RELAXED,
                                    __ATOMIC_RELAXED))
      return true;
  }
  return false;
}

static void add_to(size_t *sum, size_t count) {
  __atomic_fetch_add(sum, count, __ATOMIC_RELAXED);
}

static void join_block(void *context, scree_block block) {
  builder *b = context;
  scree_halfmesh *s = b->surface;
  size_t boundary = 0, joined = 0;
  for (uint32_t h = (uint32_t)(3 * block.begin); h < 3 * block.end; h++) {
    uint32_t twin = s->half[h].twin;
    boundary += twin == SCREE_NONE;
    if (twin > h) joined += join(b->root, s->half[h].from, scree_to(s, h));
  }
  add_to(&s->boundary_edge_count, boundary);
  add_to(&b->joined, joined);
}

static void count_block(void *context, scree_block block) {
  builder *b = context;
  scree_halfmesh *s = b->surface;
  size_t vertices = 0, locked = 0;
  for (size_t v = block.begin; v < block.end; v++) {
    if (s->vertex[v].outgoing == SCREE_NONE) continue;
    vertices++;
    locked += s->flags[v] & SCREE_VERTEX_LOCKED;
    if (b->root[v] == v) s->flags[v] |= SCREE_VERTEX_MARKER;
  }
  add_to(&s->live_vertex_count, vertices);
  add_to(&s->locked_vertex_count, locked);
}

static void count_facts(builder *b) {
  scree_halfmesh *s = b->surface;
  for (uint32_t v = 0; v < s->vertex_count; v++) b->root[v] = v;
  scree_parallel_for(s->triangle_count, BLOCK, join_block, b);
  scree_parallel_for(s->vertex_count, BLOCK, count_block, b);
  s->shell_count = s->live_vertex_count - b->joined;
  s->closed = s->boundary_edge_count == 0;
  s->live_triangle_count = s->triangle_count;
}

/* Half-edges and their twins. */
static scree_status build_edges(builder *b, vec3 low, vec3 high, scree_error *error) {
  const scree_mesh *mesh = b->mesh;
  scree_halfmesh *s = b->surface;
  size_t half_edges = 3 * mesh->triangle_count;
  SCREE_TRY_ALLOC(s->half, half_edges, error);
  /* one block, for a large one costs fewer page faults */
  SCREE_TRY_ALLOC(b->start, 4 * mesh->vertex_count + 1, error);
  b->next[0] = b->start + mesh->vertex_count + 1;
  b->next[1] = b->next[0] + mesh->vertex_count;
  b->rank = b->next[1] + mesh->vertex_count;
  SCREE_TRY(place_in_order(b, vec3_scale(vec3_add(low, high), 0.5), error));
  SCREE_TRY_ALLOC(b->fan, half_edges, error);
  SCREE_TRY_ALLOC(b->fan_to, half_edges, error);
  SCREE_TRY_ALLOC(s->flags, mesh->vertex_count, error);
  memset(s->flags, 0, mesh->vertex_count);
  sort_fans(b);
  scree_parallel_for(mesh->vertex_count, BLOCK, find_twins, b);
  scree_free(b->fan_to);
  b->fan_to = NULL;
  return SCREE_OK;
}

/* Vertices, one per fan. */
static scree_status build_vertices(builder *b, scree_error *error) {
  scree_halfmesh *s = b->surface;
  size_t given = b->mesh->vertex_count;
  b->fan_count = given;
  scree_parallel_for(given, BLOCK, find_cuts, b);
  for (uint32_t v = 0; v < given; v++)
    if (s->flags[v] & SEVERAL_FANS) cut_vertex(b, v);
  s->vertex_count = b->fan_count;
  SCREE_TRY_ALLOC(s->vertex, s->vertex_count, error);
  uint8_t *grown;
  SCREE_TRY_BLOCK(grown, scree_resize(s->flags, s->vertex_count, 1), s->vertex_count, error);
  s->flags = grown;
  scree_parallel_for(given, BLOCK, place_vertices, b);
  for (uint32_t v = 0; v < given; v++)
    if (s->flags[v] & SEVERAL_FANS) place_copies(b, v);
  return SCREE_OK;
}

scree_status scree_halfmesh_build(const scree_mesh *mesh, const scree_halfmesh *other,
                                  scree_halfmesh *surface, scree_error *error) {
  SCREE_CLEANUP(scree_halfmesh_free) scree_halfmesh made = {.triangle_count = mesh->triangle_count};
  SCREE_CLEANUP(free_builder) builder b = {.mesh = mesh, .surface = &made};
  vec3 low = {0, 0, 0}, high = low;
  SCREE_TRY(check_mesh(mesh, &low, &high, error));
  SCREE_TRY(choose_box(&made, other, low, high, error));
  SCREE_TRY(build_edges(&b, low, high, error));
  SCREE_TRY(build_vertices(&b, error));
  scree_free(b.fan);
  b.fan = NULL;
  SCREE_TRY_ALLOC(b.root, made.vertex_count, error);
  count_facts(&b);
  *surface = made;
  made = (scree_halfmesh){0};
  return SCREE_OK;
}

scree_status scree_halfmesh_copy(const scree_halfmesh *s, scree_halfmesh *copy,
                                 scree_error *error) {
  *copy = *s;
  copy->vertex = NULL, copy->half = NULL, copy->flags = NULL, copy->sums = NULL;
  SCREE_TRY_ALLOC(copy->vertex, s->vertex_count, error);
  SCREE_TRY_ALLOC(copy->half, 3 * s->triangle_count, error);
  SCREE_TRY_ALLOC(copy->flags, s->vertex_count, error);
  memcpy(copy->vertex, s->vertex, s->vertex_count * sizeof *copy->vertex);
  memcpy(copy->half, s->half, 3 * s->triangle_count * sizeof *copy->half);
  memcpy(copy->flags, s->flags, s->vertex_count);
  return SCREE_OK;
}

typedef struct compaction {
  scree_halfmesh *s;
  uint32_t *vertex, *triangle; /* new numbers */
  size_t vertex_count, triangle_count;
} compaction;

/* Entries get the new numbers where they are. */
static void renumber_triangles(void *context, scree_block block) {
  const compaction *c = context;
  for (size_t h = 3 * block.begin; h < 3 * block.end; h++) {
    scree_half_edge *half = &c->s->half[h];
    if (half->from == SCREE_NONE) continue;
    half->from = c->vertex[half->from];
    if (half->twin != SCREE_NONE) half->twin = 3 * c->triangle[half->twin / 3] + half->twin % 3;
  }
}

static void renumber_vertices(void *context, scree_block block) {
  const compaction *c = context;
  for (size_t v = block.begin; v < block.end; v++) {
    uint32_t *h = &c->s->vertex[v].outgoing;
    if (*h != SCREE_NONE) *h = 3 * c->triangle[*h / 3] + *h % 3;
  }
}

static void number_triangles(compaction *c) {
  for (size_t t = 0; t < c->s->triangle_count; t++)
    if (!scree_is_gone(c->s, t)) c->triangle[t] = (uint32_t)c->triangle_count++;
}

static void number_vertices(compaction *c) {
  for (size_t v = 0; v < c->s->vertex_count; v++)
    if (c->s->vertex[v].outgoing != SCREE_NONE) c->vertex[v] = (uint32_t)c->vertex_count++;
}

static void move_triangles(scree_halfmesh *s) {
  for (size_t t = 0, to = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    for (size_t i = 0; i < 3 && t != to; i++) s->half[3 * to + i] = s->half[3 * t + i];
    to++;
  }
}

static void move_vertices(scree_halfmesh *s) {
  for (size_t v = 0, to = 0; v < s->vertex_count; v++) {
    if (s->vertex[v].outgoing == SCREE_NONE) continue;
    if (v != to) {
      s->vertex[to] = s->vertex[v];
      s->flags[to] = s->flags[v];
      if (s->sums) memcpy(s->sums[to], s->sums[v], sizeof s->sums[v]);
    }
    to++;
  }
}

/* Block 0: triangles, block 1: vertices. */
static void number_block(void *context, scree_block block) {
  if (block.begin == 0)
    number_triangles(context);
  else
    number_vertices(context);
}

static void move_block(void *context, scree_block block) {
  if (block.begin == 0)
    move_triangles(((compaction *)context)->s);
  else
    move_vertices(((compaction *)context)->s);
}

void scree_halfmesh_compact(scree_halfmesh *s, uint32_t *vertex_scratch,
                            uint32_t *triangle_scratch) {
  compaction c = {.s = s, .vertex = vertex_scratch, .triangle = triangle_scratch};
  scree_parallel_for(2, 1, number_block, &c);
  scree_parallel_for(s->triangle_count, BLOCK, renumber_triangles, &c);
  scree_parallel_for(s->vertex_count, BLOCK, renumber_vertices, &c);
  scree_parallel_for(2, 1, move_block, &c);
  s->vertex_count = s->live_vertex_count = c.vertex_count;
  s->triangle_count = s->live_triangle_count = c.triangle_count;
}

void scree_halfmesh_give_back(const scree_halfmesh *s) {
  scree_discard_tail(s->vertex, s->vertex_count * sizeof *s->vertex);
  scree_discard_tail(s->half, 3 * s->triangle_count * sizeof *s->half);
  if (s->sums) scree_discard_tail(s->sums, s->vertex_count * sizeof *s->sums);
}
