/* Short handles: the shortest loops that part nothing when the surface is cut along them are cut,
 * and both rims capped.
 *
 * A spanning tree of the facets, and one of the vertices over the edges that it does not cross,
 * leave two edges a handle (Eppstein 2003, "Dynamic generators of topologically embedded graphs").
 * Each closes a ring of facets, of which a random number stands on every edge it crosses. Along a
 * loop that parts the surface these cancel (exclusive or); along others they do not, but by an
 * accident of 2^-64. Such a loop has an edge with a number, so the shortest one is found by looking
 * round the ends of these edges, no farther than half of what is allowed. Loops that touch no other
 * and whose numbers are independent are cut at once: together they part nothing either. */
#include "base/array.h"
#include "base/rng.h"
#include "mesh/repair/repair.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LOOP_MOST = 32, BALL_MOST = 1024, BASIS = 64 };
/* The rims part by this share of the loop's length, so that they do not touch. */
static const double PARTING = 0.01;

typedef struct loop {
  double length;
  uint64_t number;
  uint32_t count, vertex[LOOP_MOST];
} loop;

/* A vertex of the tree of shortest ways from a root. */
typedef struct node {
  uint32_t vertex, parent; /* parent: node; of the root itself */
  double distance;
  uint64_t number; /* of the way from the root */
  bool settled;
} node;

typedef struct search {
  const scree_mesh *mesh;
  scree_adjacency adjacency;
  uint64_t *number;   /* per half-edge */
  uint32_t *outgoing; /* per vertex */
  uint32_t *slot;     /* per vertex: its node, or NONE */
  double longest;
  node *ball;
  size_t ball_count;
  struct {
    loop *items;
    size_t count, capacity;
  } loops;
} search;

#define NONE UINT32_MAX

static void search_free(search *s) {
  scree_adjacency_free(&s->adjacency);
  SCREE_FREE_ALL(s->number, s->outgoing, s->slot, s->ball, s->loops.items);
}

/* The next edge from the same vertex. */
static uint32_t turn(const search *s, uint32_t h) {
  return s->adjacency.ring[scree_half_edge_previous(h)];
}

static double length_of(const search *s, uint32_t h) {
  return vec3_distance(scree_mesh_vertex(s->mesh, scree_half_edge_from(s->mesh, h)),
                       scree_mesh_vertex(s->mesh, scree_half_edge_to(s->mesh, h)));
}

/* ---- The numbers ---- */

/* Breadth first over the facets: through[t] is the half-edge of t that leads to its parent, NONE
 * of a root. */
static void span_facets(const search *s, bool *seen, uint32_t *queue, uint32_t *through) {
  size_t end = 0, at = 0;
  for (uint32_t root = 0; root < s->mesh->triangle_count; root++) {
    if (seen[root]) continue;
    seen[root] = true;
    through[root] = NONE;
    for (queue[end++] = root; at < end; at++)
      for (uint32_t h = 3 * queue[at]; h < 3 * queue[at] + 3; h++) {
        uint32_t twin = s->adjacency.ring[h], next = twin / 3;
        if (seen[next]) continue;
        seen[next] = true;
        through[next] = twin;
        queue[end++] = next;
      }
  }
}

static void put_number(search *s, uint32_t h, uint64_t number) {
  s->number[h] = s->number[s->adjacency.ring[h]] = number;
}

static scree_status find_numbers(search *s, scree_error *error) {
  size_t facets = s->mesh->triangle_count;
  SCREE_SCRATCH(uint32_t, queue, facets, error);
  SCREE_SCRATCH(uint32_t, through, facets, error);
  SCREE_SCRATCH(uint32_t, parent, s->mesh->vertex_count, error);
  SCREE_SCRATCH_ZERO(uint64_t, below, facets, error);
  SCREE_SCRATCH_ZERO(bool, seen, facets, error);
  SCREE_TRY_ALLOC_ZERO(s->number, 3 * facets, error);
  span_facets(s, seen, queue, through);
  for (uint32_t v = 0; v < s->mesh->vertex_count; v++) parent[v] = v;
  for (size_t e = 0; e < s->adjacency.edge_count; e++) {
    uint32_t h = s->adjacency.edges[e], g = s->adjacency.ring[h];
    uint32_t a = scree_half_edge_from(s->mesh, h), b = scree_half_edge_to(s->mesh, h);
    if (through[h / 3] == h || through[g / 3] == g) continue;
    if (scree_find_root(parent, a) != scree_find_root(parent, b)) {
      scree_join(parent, a, b);
      continue;
    }
    uint64_t number = scree_rng_bits(1, 0, e);
    put_number(s, h, number);
    below[h / 3] ^= number;
    below[g / 3] ^= number;
  }
  for (size_t i = facets; i-- > 0;) {
    uint32_t t = queue[i], h = through[t];
    if (h == NONE) continue;
    put_number(s, h, below[t]);
    below[s->adjacency.ring[h] / 3] ^= below[t];
  }
  return SCREE_OK;
}

/* ---- Loops ---- */

static void reach(search *s, uint32_t vertex, uint32_t from, double distance, uint64_t number) {
  uint32_t *slot = &s->slot[vertex];
  if (distance > s->longest / 2) return;
  if (*slot == NONE) {
    if (s->ball_count == BALL_MOST) return;
    *slot = (uint32_t)s->ball_count++;
    s->ball[*slot] = (node){.vertex = vertex, .distance = INFINITY};
  }
  node *n = &s->ball[*slot];
  if (!(distance < n->distance)) return;
  *n = (node){vertex, from, distance, number, false};
}

/* All vertices within half of the longest loop, by their distance along edges. */
static void grow_ball(search *s, uint32_t root) {
  s->ball_count = 0;
  reach(s, root, 0, 0, 0);
  for (;;) {
    uint32_t nearest = NONE;
    for (uint32_t i = 0; i < s->ball_count; i++)
      if (!s->ball[i].settled &&
          (nearest == NONE || s->ball[i].distance < s->ball[nearest].distance))
        nearest = i;
    if (nearest == NONE) return;
    node n = s->ball[nearest];
    s->ball[nearest].settled = true;
    uint32_t first = s->outgoing[n.vertex], h = first;
    do {
      reach(s, scree_half_edge_to(s->mesh, h), nearest, n.distance + length_of(s, h),
            n.number ^ s->number[h]);
      h = turn(s, h);
    } while (h != first);
  }
}

/* The loop that edge u-v closes, without the way that both have in common; its length 0: too many
 * vertices. */
static loop trace(const search *s, uint32_t u, uint32_t v) {
  loop l = {.length = 0};
  uint32_t back[LOOP_MOST], backs = 0;
  while (u != v) {
    bool first = s->ball[u].distance >= s->ball[v].distance;
    uint32_t *at = first ? &u : &v;
    if (l.count + backs + 1 >= LOOP_MOST) return (loop){.length = 0};
    if (first)
      l.vertex[l.count++] = s->ball[*at].vertex;
    else
      back[backs++] = s->ball[*at].vertex;
    *at = s->ball[*at].parent;
  }
  l.vertex[l.count++] = s->ball[u].vertex;
  while (backs > 0) l.vertex[l.count++] = back[--backs];
  for (uint32_t i = 0; i < l.count; i++)
    l.length += vec3_distance(scree_mesh_vertex(s->mesh, l.vertex[i]),
                              scree_mesh_vertex(s->mesh, l.vertex[(i + 1) % l.count]));
  return l;
}

/* The shortest loop through the root that parts nothing, where it is short enough. */
static scree_status look_round(search *s, uint32_t root, scree_error *error) {
  uint32_t u = 0, v = 0;
  uint64_t number = 0;
  double best = s->longest * (1 + 1e-12);
  grow_ball(s, root);
  for (uint32_t i = 0; i < s->ball_count; i++) {
    uint32_t first = s->outgoing[s->ball[i].vertex], h = first;
    do {
      uint32_t k = s->slot[scree_half_edge_to(s->mesh, h)];
      if (k != NONE && k > i) {
        double length = s->ball[i].distance + s->ball[k].distance + length_of(s, h);
        uint64_t of = s->ball[i].number ^ s->ball[k].number ^ s->number[h];
        if (of && length < best) best = length, number = of, u = i, v = k;
      }
      h = turn(s, h);
    } while (h != first);
  }
  loop found = number ? trace(s, u, v) : (loop){.length = 0};
  found.number = number;
  for (size_t i = 0; i < s->ball_count; i++) s->slot[s->ball[i].vertex] = NONE;
  return found.length > 0 && !SCREE_PUSH(&s->loops, found)
             ? scree_fail_memory(error, s->loops.count * sizeof found, "loops")
             : SCREE_OK;
}

static int by_length(const void *a, const void *b) {
  const loop *x = a, *y = b;
  if (x->length != y->length) return x->length > y->length ? 1 : -1;
  return memcmp(x->vertex, y->vertex, sizeof x->vertex);
}

static scree_status find_loops(search *s, scree_error *error) {
  size_t vertices = s->mesh->vertex_count;
  SCREE_TRY(scree_adjacency_build(s->mesh, &s->adjacency, error));
  SCREE_TRY(find_numbers(s, error));
  SCREE_TRY_ALLOC(s->outgoing, vertices, error);
  SCREE_TRY_ALLOC(s->slot, vertices, error);
  SCREE_TRY_ALLOC(s->ball, BALL_MOST, error);
  SCREE_SCRATCH_ZERO(bool, roots, vertices, error);
  memset(s->slot, 0xff, vertices * sizeof *s->slot);
  for (uint32_t h = 0; h < 3 * s->mesh->triangle_count; h++) {
    s->outgoing[s->mesh->triangles[h]] = h;
    if (s->number[h]) roots[s->mesh->triangles[h]] = true;
  }
  for (uint32_t v = 0; v < vertices; v++)
    if (roots[v]) SCREE_TRY(look_round(s, v, error));
  if (s->loops.count) qsort(s->loops.items, s->loops.count, sizeof *s->loops.items, by_length);
  return SCREE_OK;
}

/* Brings to the front, in their order, the loops that touch none before, not by an edge either, and
 * are independent of them. */
static scree_status choose_loops(search *s, scree_error *error) {
  uint64_t basis[BASIS] = {0};
  size_t kept = 0;
  SCREE_SCRATCH_ZERO(bool, taken, s->mesh->vertex_count, error);
  for (size_t i = 0; i < s->loops.count; i++) {
    const loop l = s->loops.items[i];
    uint64_t rest = l.number;
    bool free = true;
    for (uint32_t k = 0; k < l.count; k++) free &= !taken[l.vertex[k]];
    for (int bit = BASIS; free && bit-- > 0;)
      if (rest >> bit & 1 && basis[bit]) rest ^= basis[bit];
    if (!free || !rest) continue;
    int top = BASIS - 1;
    while (!(rest >> top & 1)) top--;
    basis[top] = rest;
    for (uint32_t k = 0; k < l.count; k++) {
      uint32_t first = s->outgoing[l.vertex[k]], h = first;
      do {
        taken[scree_half_edge_to(s->mesh, h)] = true;
        h = turn(s, h);
      } while (h != first);
    }
    s->loops.items[kept++] = l;
  }
  s->loops.count = kept;
  return SCREE_OK;
}

/* ---- The cut ---- */

static uint32_t edge_to(const search *s, uint32_t from, uint32_t to) {
  uint32_t h = s->outgoing[from];
  while (scree_half_edge_to(s->mesh, h) != to) h = turn(s, h);
  return h;
}

static void add_facet(scree_mesh *m, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t *corner = m->triangles + 3 * m->triangle_count++;
  corner[0] = a, corner[1] = b, corner[2] = c;
}

static uint32_t add_vertex(scree_mesh *m, vec3 at) {
  vec3_store(m->positions + 3 * m->vertex_count, at);
  return (uint32_t)m->vertex_count++;
}

/* The facets on the right of the loop get vertices of their own; *way sums up where they lie. */
static void part_sides(const search *s, const loop *l, scree_mesh *m, const uint32_t *right,
                       vec3 *way) {
  for (uint32_t i = 0; i < l->count; i++) {
    uint32_t v = l->vertex[i], next = edge_to(s, v, l->vertex[(i + 1) % l->count]),
             last = edge_to(s, v, l->vertex[(i + l->count - 1) % l->count]);
    bool on_right = false;
    uint32_t h = next;
    do {
      on_right |= h == last;
      vec3 from = scree_mesh_vertex(s->mesh, v),
           to = scree_mesh_vertex(s->mesh, scree_half_edge_to(s->mesh, scree_half_edge_next(h)));
      *way = vec3_mad(*way, vec3_sub(to, from), on_right ? 1 : -1);
      if (on_right) m->triangles[h] = right[i];
      h = turn(s, h);
    } while (h != next);
  }
}

/* turned: the rim runs the other way. */
static void cap(scree_mesh *m, const uint32_t *rim, uint32_t count, bool turned, vec3 middle) {
  if (count < 3) return;
  uint32_t apex = count > 3 ? add_vertex(m, middle) : rim[0];
  for (uint32_t i = count > 3 ? 0 : 1; i < (count > 3 ? count : 2); i++) {
    uint32_t a = rim[i], b = rim[(i + 1) % count];
    add_facet(m, turned ? a : b, turned ? b : a, apex);
  }
}

static void cut_loop(const search *s, const loop *l, scree_mesh *m) {
  uint32_t right[LOOP_MOST];
  vec3 middle = {0, 0, 0}, way = {0, 0, 0};
  for (uint32_t i = 0; i < l->count; i++) {
    vec3 at = scree_mesh_vertex(s->mesh, l->vertex[i]);
    middle = vec3_mad(middle, at, 1.0 / l->count);
    right[i] = add_vertex(m, at);
  }
  part_sides(s, l, m, right, &way);
  vec3 step = vec3_scale(vec3_unit(way), PARTING * l->length);
  for (uint32_t i = 0; i < l->count; i++) {
    vec3 at = scree_mesh_vertex(s->mesh, l->vertex[i]);
    vec3_store(m->positions + 3 * (size_t)l->vertex[i], vec3_sub(at, step));
    vec3_store(m->positions + 3 * (size_t)right[i], vec3_add(at, step));
  }
  cap(m, l->vertex, l->count, false, vec3_sub(middle, step));
  cap(m, right, l->count, true, vec3_add(middle, step));
}

static void tell_loops(const search *s, scree_handles *told) {
  for (size_t i = 0; i < s->loops.count; i++) {
    const loop *l = &s->loops.items[i];
    if (l->length > told->length) {
      vec3 middle = {0, 0, 0};
      for (uint32_t k = 0; k < l->count; k++)
        middle = vec3_mad(middle, scree_mesh_vertex(s->mesh, l->vertex[k]), 1.0 / l->count);
      told->length = l->length;
      vec3_store(told->place, middle);
    }
    told->count++;
  }
}

/* What a scan tells no better: so many mean edges, as long as that is little beside the body, as it
 * is not where the mesh is coarse. */
static double longest_loop(const scree_mesh *mesh, double edges) {
  static const double SMALL = 0.1; /* of the diameter of the sphere of as much area */
  double sum = 0, area = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++)
    for (int k = 0; k < 3; k++)
      sum += vec3_distance(scree_mesh_corner(mesh, t, k), scree_mesh_corner(mesh, t, (k + 1) % 3));
  for (size_t t = 0; t < mesh->triangle_count; t++)
    area += vec3_norm(scree_facet_normal(mesh, t)) / 2;
  return fmin(edges * sum / (3 * (double)mesh->triangle_count),
              SMALL * sqrt(area / 3.14159265358979323846));
}

scree_status scree_handles_cut(const scree_mesh *mesh, double edges, scree_mesh *cut,
                               scree_handles *told, scree_error *error) {
  SCREE_CLEANUP(search_free) search s = {.mesh = mesh, .longest = longest_loop(mesh, edges)};
  SCREE_CLEANUP(scree_mesh_free) scree_mesh made = {0};
  size_t vertices = 0;
  SCREE_TRY(find_loops(&s, error));
  SCREE_TRY(choose_loops(&s, error));
  for (size_t i = 0; i < s.loops.count; i++) vertices += s.loops.items[i].count + 2;
  SCREE_TRY(scree_mesh_make(mesh->vertex_count + vertices, mesh->triangle_count + 2 * vertices,
                            &made, error));
  memcpy(made.positions, mesh->positions, 3 * mesh->vertex_count * sizeof *mesh->positions);
  memcpy(made.triangles, mesh->triangles, 3 * mesh->triangle_count * sizeof *mesh->triangles);
  made.vertex_count = mesh->vertex_count;
  made.triangle_count = mesh->triangle_count;
  for (size_t i = 0; i < s.loops.count; i++) cut_loop(&s, &s.loops.items[i], &made);
  tell_loops(&s, told);
  *cut = made;
  made = (scree_mesh){0};
  return SCREE_OK;
}
