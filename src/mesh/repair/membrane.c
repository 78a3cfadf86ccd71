/* Membranes: sheets within a surface that hang on it with edges of 3, 5, ... facets all round, so
 * that it is closed with and without them: the wall between two boxes that were glued, a disc
 * across a ball. What counts is the outside: each connected piece that has such an edge keeps the
 * facets that are reached from outside, and loses the others.
 *
 * The outside is walked over sides of facets: from a side one goes on to the neighbour's side over
 * an edge of two facets, and over an edge of more to the side of the facet that is met first when
 * turning about the edge (as in Attene, "A lightweight approach to repairing digitized polygon
 * meshes", Vis. Comput. 26 (2010)). The walk starts where a ray from far away first hits the piece.
 *
 * A piece that has a boundary, or an edge with more facets than are sorted, is left alone. */
#include "base/alloc.h"
#include "mesh/repair/repair.h"

enum { PIECE_OPEN = 1, PIECE_ODD = 2, PIECE_CROWDED = 4 };
enum { SIDE_FRONT = 1, SIDE_BACK = 2 };

typedef struct walk {
  const scree_mesh *mesh;
  const scree_adjacency *adjacency;
  uint32_t *piece; /* by facet: union-find over edges */
  uint8_t *traits; /* by piece's root */
  uint8_t *seen;   /* by facet: its sides reached */
  uint32_t *stack; /* facet << 1 | its back; every side goes there once */
  size_t depth;
} walk;

static void find_pieces(walk *w) {
  scree_join_over_edges(w->mesh, w->adjacency, false, w->piece);
  for (size_t e = 0; e < w->adjacency->edge_count; e++) {
    uint32_t first = w->adjacency->edges[e];
    size_t count = scree_edge_facet_count(w->adjacency, first);
    uint8_t *traits = &w->traits[scree_find_root(w->piece, first / 3)];
    if (count == 1) *traits |= PIECE_OPEN;
    if (count > 1 && count % 2) *traits |= PIECE_ODD;
    if (count > SCREE_EDGE_FACETS) *traits |= PIECE_CROWDED;
  }
}

static void reach(walk *w, uint32_t facet, bool back) {
  uint8_t side = back ? SIDE_BACK : SIDE_FRONT;
  if (w->seen[facet] & side) return;
  w->seen[facet] |= side;
  w->stack[w->depth++] = facet << 1 | back;
}

/* From a side of h's facet over its edge. */
static void cross_edge(walk *w, uint32_t h, bool back) {
  scree_spoke spokes[SCREE_EDGE_FACETS];
  uint32_t g = w->adjacency->ring[h];
  if (w->adjacency->ring[g] == h) {
    bool agree = scree_half_edge_from(w->mesh, g) != scree_half_edge_from(w->mesh, h);
    reach(w, g / 3, agree ? back : !back);
    return;
  }
  uint32_t first = h;
  for (uint32_t i = g; i != h; i = w->adjacency->ring[i])
    if (i < first) first = i;
  int count = (int)scree_edge_facet_count(w->adjacency, h), at = 0;
  scree_repair_spokes(w->mesh, w->adjacency, first, spokes, count);
  while (spokes[at].half_edge != h) at++;
  int turn = spokes[at].along != back ? 1 : -1;
  const scree_spoke *next = &spokes[(at + turn + count) % count];
  /* the side that looks back at h */
  reach(w, next->half_edge / 3, (next->along ? 1 : -1) == turn);
}

/* Where the line along x through the facet's middle leaves the piece for the last time. */
static uint32_t outermost(walk *w, uint32_t facet) {
  const scree_mesh *m = w->mesh;
  vec3 middle =
      vec3_scale(vec3_add(vec3_add(scree_mesh_corner(m, facet, 0), scree_mesh_corner(m, facet, 1)),
                          scree_mesh_corner(m, facet, 2)),
                 1.0 / 3);
  uint32_t root = scree_find_root(w->piece, facet), best = facet;
  double farthest = middle.x;
  for (uint32_t t = 0; t < m->triangle_count; t++) {
    if (scree_find_root(w->piece, t) != root) continue;
    vec3 p = vec3_sub(scree_mesh_corner(m, t, 0), middle),
         q = vec3_sub(scree_mesh_corner(m, t, 1), middle),
         r = vec3_sub(scree_mesh_corner(m, t, 2), middle);
    double a = q.y * r.z - q.z * r.y, b = r.y * p.z - r.z * p.y, c = p.y * q.z - p.z * q.y;
    double sum = a + b + c;
    bool inside = (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
    if (!inside) continue;
    double x = middle.x + (a * p.x + b * q.x + c * r.x) / sum;
    if (x > farthest) farthest = x, best = t;
  }
  return best;
}

static double seen_area(const scree_mesh *m, uint32_t t, bool *back) {
  vec3 n = scree_facet_normal(m, t);
  *back = n.x < 0;
  return fabs(n.x);
}

/* Walks the outside of the pieces that have membranes; largest[root] is the facet to start at. */
static void walk_outside(walk *w, uint32_t *largest) {
  bool back, other;
  for (uint32_t t = 0; t < w->mesh->triangle_count; t++) {
    uint32_t root = scree_find_root(w->piece, t);
    if (root == t) largest[t] = t;
    if (seen_area(w->mesh, t, &back) > seen_area(w->mesh, largest[root], &other)) largest[root] = t;
  }
  for (uint32_t root = 0; root < w->mesh->triangle_count; root++) {
    if (w->piece[root] != root || w->traits[root] != PIECE_ODD) continue;
    uint32_t start = outermost(w, largest[root]);
    seen_area(w->mesh, start, &back);
    reach(w, start, back);
    while (w->depth > 0) {
      uint32_t now = w->stack[--w->depth], facet = now >> 1;
      for (uint32_t h = 3 * facet; h < 3 * facet + 3; h++) cross_edge(w, h, now & 1);
    }
  }
}

static void mark_membranes(walk *w, bool *marked) {
  for (uint32_t t = 0; t < w->mesh->triangle_count; t++)
    marked[t] = w->traits[scree_find_root(w->piece, t)] == PIECE_ODD && !w->seen[t];
}

scree_status scree_repair_membranes(scree_repair *r, scree_error *error) {
  size_t count = r->mesh.triangle_count;
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_TRY(scree_adjacency_build(&r->mesh, &adjacency, error));
  SCREE_SCRATCH(uint32_t, piece, count, error);
  SCREE_SCRATCH_ZERO(uint8_t, traits, count, error);
  SCREE_SCRATCH_ZERO(uint8_t, seen, count, error);
  SCREE_SCRATCH(uint32_t, stack, 2 * count, error);
  SCREE_SCRATCH(uint32_t, largest, count, error);
  SCREE_SCRATCH(bool, marked, count, error);
  walk w = {&r->mesh, &adjacency, piece, traits, seen, stack, 0};
  find_pieces(&w);
  walk_outside(&w, largest);
  mark_membranes(&w, marked);
  r->report.done[SCREE_REPAIR_DROP_MEMBRANE] += scree_facets_drop(&r->mesh, marked);
  return SCREE_OK;
}
