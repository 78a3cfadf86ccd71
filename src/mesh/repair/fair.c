/* Large fillings: vertices as dense as those round the hole, and a surface that goes on smoothly.
 *
 * P. Liepa, "Filling holes in meshes", SGP 2003. The filling made of the hole's own vertices is
 * refined: each vertex has a size, the mean length of its edges, and a triangle whose corners lie
 * farther than size / sqrt 2 from its centre is cut into three there; edges are swapped to be
 * Delaunay in between. Then the new vertices are moved to where the surface bends least, which
 * takes the slope of the surroundings along the rim into account: the sum over new vertices and the
 * rim of A L^2 is least, where L, the Laplacian with the cotangents of the angles opposite, is
 * twice the mean curvature, and A the area of a vertex (Desbrun and others, SIGGRAPH 1999). Liepa
 * solves L^2 = 0 with weights of length, which is the same on even triangles only.
 *
 * What differs: refinement goes from coarse to fine, with the surface made smooth at every size, so
 * that the sizes are those of the surface as it bulges, and that each solution starts near its end
 * (conjugate gradients, as for other cascades). The weights are those of the shape before, twice at
 * each size. */
#include "base/array.h"
#include "base/radix.h"
#include "mesh/repair/repair.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum {
  MOST_VERTICES = 100000, /* of one filling: finer sizes are left out */
  COARSEST = 16,          /* edges of the rim to an edge of the first refinement */
  PASSES = 20,            /* of swapping, and of refining at one size */
  SOLUTIONS = 2,          /* at each size */
  ITERATIONS = 600        /* of each */
};
static const double residual_left = 1e-9; /* of the squared residual */
static const double largest_cotangent = 100;

typedef struct facet {
  uint32_t vertex[3];
  uint32_t next[3]; /* across the edge from corner k to corner k + 1; NONE: the rim */
} facet;

enum { NONE = UINT32_MAX };

/* The filling: vertices 0 to rim_count - 1 are the rim's. */
typedef struct patch {
  const scree_filling *filling;
  scree_repair *r;
  struct {
    vec3 *items;
    size_t count, capacity;
  } at;
  struct {
    double *items; /* by vertex, m */
    size_t count, capacity;
  } size;
  struct {
    facet *items;
    size_t count, capacity;
  } facets;
  struct outer {
    double weight, area; /* the sum of its weights, m2 */
    vec3 pull;           /* the sum of weights times positions, m */
  } * outer;             /* by rim vertex: its share in facets outside, which stays */
  size_t rim_count;
  double least_area; /* m2: smaller ones count as this */
} patch;

static void free_patch(patch *p) {
  SCREE_FREE_ALL(p->at.items, p->size.items, p->facets.items, p->outer);
}

static vec3 outer_position(const patch *p, uint32_t vertex) {
  return vec3_load(p->r->mesh.positions + 3 * (size_t)vertex);
}

/* Half the cotangent of the angle at a between b and c, that of a sliver bounded. */
static double half_cotangent(vec3 a, vec3 b, vec3 c) {
  vec3 u = vec3_sub(b, a), v = vec3_sub(c, a);
  double sine = vec3_norm(vec3_cross(u, v)), cosine = vec3_dot(u, v);
  return 0.5 * fmax(-largest_cotangent, fmin(largest_cotangent, cosine / fmax(sine, DBL_MIN)));
}

/* ---- The filling as it was made ---- */

/* What rim vertex i has of the facets outside, round from its edge on the rim to the other; and its
 * size. */
static void take_rim_vertex(patch *p, size_t i, double *size) {
  const scree_mesh *m = &p->r->mesh;
  const uint32_t *ring = p->filling->adjacency->ring;
  uint32_t h = p->filling->half_edge[i];
  vec3 here = outer_position(p, p->filling->vertex[i]);
  vec3 before = outer_position(p, scree_half_edge_from(m, h));
  double sum = vec3_distance(here, before), count = 1;
  struct outer *o = &p->outer[i];
  *o = (struct outer){0};
  for (size_t turns = 0; turns < 3 * m->triangle_count; turns++) {
    uint32_t g = scree_half_edge_next(h), other = ring[g];
    vec3 after = outer_position(p, scree_half_edge_to(m, g));
    double to_before = half_cotangent(after, here, before);
    double to_after = half_cotangent(before, here, after);
    o->pull = vec3_add(o->pull, vec3_scale(before, to_before));
    o->pull = vec3_add(o->pull, vec3_scale(after, to_after));
    o->weight += to_before + to_after;
    o->area += vec3_norm(vec3_triangle_normal(here, before, after)) / 6;
    sum += vec3_distance(here, after);
    count++;
    if (other == g || ring[other] != g || m->triangles[other] == m->triangles[g]) break;
    before = after;
    h = other;
  }
  *size = sum / count;
}

static scree_status take_rim(patch *p, scree_error *error) {
  p->rim_count = p->filling->count;
  p->least_area = 1e-24 * p->r->diagonal * p->r->diagonal;
  SCREE_TRY_ALLOC(p->outer, p->rim_count, error);
  for (size_t i = 0; i < p->rim_count; i++) {
    double size;
    take_rim_vertex(p, i, &size);
    if (!SCREE_PUSH(&p->at, outer_position(p, p->filling->vertex[i])) ||
        !SCREE_PUSH(&p->size, size))
      return scree_repair_no_memory(error);
  }
  return SCREE_OK;
}

/* Joins the facets along their common sides. */
static scree_status join_facets(patch *p, scree_error *error) {
  size_t count = p->facets.count;
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_SCRATCH(uint32_t, corners, 3 * count, error);
  scree_mesh mesh = {NULL, corners, p->rim_count, count};
  for (size_t i = 0; i < 3 * count; i++) corners[i] = p->facets.items[i / 3].vertex[i % 3];
  SCREE_TRY(scree_adjacency_build(&mesh, &adjacency, error));
  for (uint32_t h = 0; h < 3 * count; h++)
    if (adjacency.ring[h] != h) p->facets.items[h / 3].next[h % 3] = adjacency.ring[h] / 3;
  return SCREE_OK;
}

typedef struct name {
  uint32_t vertex, place;
} name;

SCREE_ORDER_BY(compare_names, name, vertex)

/* The mesh's facets from first_facet on, with the rim's vertices by their places. */
static scree_status take_facets(patch *p, scree_error *error) {
  const scree_mesh *m = &p->r->mesh;
  SCREE_SCRATCH(name, names, p->rim_count, error);
  for (uint32_t i = 0; i < p->rim_count; i++) names[i] = (name){p->filling->vertex[i], i};
  qsort(names, p->rim_count, sizeof *names, compare_names);
  if (!SCREE_RESERVE(&p->facets, m->triangle_count - p->filling->first_facet))
    return scree_repair_no_memory(error);
  for (size_t t = p->filling->first_facet; t < m->triangle_count; t++) {
    facet f = {.next = {NONE, NONE, NONE}};
    for (size_t k = 0; k < 3; k++) {
      name wanted = {m->triangles[3 * t + k], 0};
      const name *found = bsearch(&wanted, names, p->rim_count, sizeof *names, compare_names);
      f.vertex[k] = found ? found->place : 0; /* all are there: a filling has no others */
    }
    p->facets.items[p->facets.count++] = f;
  }
  return join_facets(p, error);
}

/* ---- Swapping ---- */

static int corner_to(const facet *f, uint32_t neighbour) {
  return f->next[0] == neighbour ? 0 : f->next[1] == neighbour ? 1 : 2;
}

static int corner_of(const facet *f, uint32_t vertex) {
  return f->vertex[0] == vertex ? 0 : f->vertex[1] == vertex ? 1 : 2;
}

/* Whether the filling has an edge from vertex a, a corner of facet t, to vertex b. */
static bool edge_in_patch(const patch *p, uint32_t t, uint32_t a, uint32_t b) {
  for (int way = 0; way < 2; way++) {
    uint32_t at = t;
    do {
      const facet *f = &p->facets.items[at];
      int k = corner_of(f, a);
      if (f->vertex[(k + 1) % 3] == b || f->vertex[(k + 2) % 3] == b) return true;
      at = f->next[way ? k : (k + 2) % 3];
    } while (at != NONE && at != t);
    if (at == t) return false;
  }
  return false;
}

static bool edge_exists(const patch *p, uint32_t t, uint32_t a, uint32_t b) {
  if (edge_in_patch(p, t, a, b)) return true;
  const uint32_t *outer = p->filling->vertex;
  return a < p->rim_count && b < p->rim_count &&
         scree_repair_edge_exists(&p->r->mesh, p->filling->adjacency, outer[a], outer[b]);
}

static vec3 doubled_area(const patch *p, uint32_t a, uint32_t b, uint32_t c) {
  return vec3_triangle_normal(p->at.items[a], p->at.items[b], p->at.items[c]);
}

static double angle_at(const patch *p, uint32_t a, uint32_t b, uint32_t c) {
  vec3 u = vec3_sub(p->at.items[b], p->at.items[a]), v = vec3_sub(p->at.items[c], p->at.items[a]);
  return atan2(vec3_norm(vec3_cross(u, v)), vec3_dot(u, v));
}

/* Whether the edge from corner k of facet t to the next should be swapped: the angles opposite to
 * it add up to more than two right ones, and what comes instead lies the same way up. */
static bool should_swap(const patch *p, uint32_t t, int k, uint32_t u, int j) {
  const double straight = 3.14159265358979324;
  const facet *f = &p->facets.items[t], *g = &p->facets.items[u];
  uint32_t a = f->vertex[k], b = f->vertex[(k + 1) % 3], c = f->vertex[(k + 2) % 3];
  uint32_t d = g->vertex[(j + 2) % 3];
  if (angle_at(p, c, a, b) + angle_at(p, d, a, b) <= straight + 1e-6) return false;
  vec3 up = vec3_add(doubled_area(p, a, b, c), doubled_area(p, b, a, d));
  if (!(vec3_dot(up, doubled_area(p, c, a, d)) > 0 && vec3_dot(up, doubled_area(p, c, d, b)) > 0))
    return false;
  return !edge_exists(p, t, c, d);
}

static void point_back(patch *p, uint32_t neighbour, uint32_t from, uint32_t to) {
  if (neighbour != NONE) {
    facet *f = &p->facets.items[neighbour];
    f->next[corner_to(f, from)] = to;
  }
}

static void swap_edge(patch *p, uint32_t t, int k, uint32_t u, int j) {
  facet *f = &p->facets.items[t], *g = &p->facets.items[u];
  uint32_t a = f->vertex[k], b = f->vertex[(k + 1) % 3], c = f->vertex[(k + 2) % 3];
  uint32_t d = g->vertex[(j + 2) % 3];
  uint32_t bc = f->next[(k + 1) % 3], ca = f->next[(k + 2) % 3];
  uint32_t ad = g->next[(j + 1) % 3], db = g->next[(j + 2) % 3];
  *f = (facet){{c, a, d}, {ca, ad, u}};
  *g = (facet){{c, d, b}, {t, db, bc}};
  point_back(p, ad, u, t);
  point_back(p, bc, t, u);
}

static size_t swap_all(patch *p) {
  size_t swapped = 0;
  for (uint32_t t = 0; t < p->facets.count; t++)
    for (int k = 0; k < 3; k++) {
      uint32_t u = p->facets.items[t].next[k];
      if (u == NONE || u < t) continue;
      int j = corner_to(&p->facets.items[u], t);
      if (!should_swap(p, t, k, u, j)) continue;
      swap_edge(p, t, k, u, j);
      swapped++;
      break;
    }
  return swapped;
}

static void relax(patch *p) {
  for (int pass = 0; pass < PASSES && swap_all(p) > 0; pass++) continue;
}

/* ---- Refining ---- */

/* Cuts facet t at its centre into three where it is large for its corners' sizes, which are
 * multiplied by `coarse`. */
static bool cut_facet(patch *p, uint32_t t, double coarse, bool *cut) {
  facet f = p->facets.items[t];
  vec3 centre = {0};
  double size = 0;
  *cut = false;
  for (int k = 0; k < 3; k++) {
    centre = vec3_add(centre, vec3_scale(p->at.items[f.vertex[k]], 1.0 / 3));
    size += p->size.items[f.vertex[k]] / 3;
  }
  for (int k = 0; k < 3; k++) {
    double reach = sqrt(2) * vec3_distance(centre, p->at.items[f.vertex[k]]);
    if (!(reach > coarse * size && reach > coarse * p->size.items[f.vertex[k]])) return true;
  }
  uint32_t v = (uint32_t)p->at.count, first = (uint32_t)p->facets.count;
  if (!SCREE_PUSH(&p->at, centre) || !SCREE_PUSH(&p->size, size) ||
      !SCREE_RESERVE(&p->facets, p->facets.count + 2))
    return false;
  p->facets.count += 2;
  const uint32_t part[3] = {t, first, first + 1};
  for (int k = 0; k < 3; k++) {
    p->facets.items[part[k]] = (facet){{f.vertex[k], f.vertex[(k + 1) % 3], v},
                                       {f.next[k], part[(k + 1) % 3], part[(k + 2) % 3]}};
    if (k > 0) point_back(p, f.next[k], t, part[k]);
  }
  *cut = true;
  return true;
}

static scree_status refine(patch *p, double coarse, scree_error *error) {
  for (int pass = 0; pass < PASSES; pass++) {
    bool any = false;
    size_t count = p->facets.count;
    for (uint32_t t = 0; t < count && p->at.count < MOST_VERTICES; t++) {
      bool cut;
      if (!cut_facet(p, t, coarse, &cut)) return scree_repair_no_memory(error);
      any |= cut;
    }
    relax(p);
    if (!any) break;
  }
  return SCREE_OK;
}

/* ---- Smoothing ---- */

/* The Laplacians of all vertices: row v has the entries from begin[v] to begin[v + 1], its own
 * first, and a constant from what lies outside. */
typedef struct laplacian {
  size_t *begin;
  uint32_t *column;
  double *entry, *area;
  vec3 *constant;
  size_t rows, capacity;
} laplacian;

static void free_laplacian(laplacian *l) {
  SCREE_FREE_ALL(l->begin, l->column, l->entry, l->area, l->constant);
}

/* Edges of the filling, each once: those at the rim, and of the others the facet of lower number's.
 */
static bool is_told_here(const patch *p, uint32_t t, int k) {
  uint32_t u = p->facets.items[t].next[k];
  return u == NONE || t < u;
}

static scree_status alloc_laplacian(const patch *p, laplacian *l, scree_error *error) {
  l->rows = p->at.count;
  SCREE_TRY_ALLOC_ZERO(l->begin, l->rows + 2, error);
  SCREE_TRY_ALLOC_ZERO(l->constant, l->rows, error);
  SCREE_TRY_ALLOC_ZERO(l->area, l->rows, error);
  for (uint32_t t = 0; t < p->facets.count; t++)
    for (int k = 0; k < 3; k++) {
      if (!is_told_here(p, t, k)) continue;
      l->begin[p->facets.items[t].vertex[k] + 2]++;
      l->begin[p->facets.items[t].vertex[(k + 1) % 3] + 2]++;
    }
  for (size_t v = 0; v < l->rows; v++) l->begin[v + 2] += l->begin[v + 1] + 1;
  l->capacity = l->begin[l->rows + 1];
  SCREE_TRY_ALLOC(l->column, l->capacity, error);
  SCREE_TRY_ALLOC(l->entry, l->capacity, error);
  return SCREE_OK;
}

static double weight_of_edge(const patch *p, uint32_t t, int k) {
  const facet *f = &p->facets.items[t];
  vec3 a = p->at.items[f->vertex[k]], b = p->at.items[f->vertex[(k + 1) % 3]];
  double weight = half_cotangent(p->at.items[f->vertex[(k + 2) % 3]], a, b);
  if (f->next[k] == NONE) return weight;
  const facet *g = &p->facets.items[f->next[k]];
  int j = corner_to(g, t);
  return weight + half_cotangent(p->at.items[g->vertex[(j + 2) % 3]], a, b);
}

static void add_entry(laplacian *l, uint32_t v, uint32_t w, double weight) {
  size_t place = l->begin[v + 1]++;
  l->column[place] = w;
  l->entry[place] = weight;
}

/* Row v from weights to the Laplacian times the root of the vertex's area. */
static void scale_row(const patch *p, laplacian *l, uint32_t v) {
  double weights = 0, area = l->area[v];
  vec3 constant = {0};
  for (size_t i = l->begin[v] + 1; i < l->begin[v + 1]; i++) weights += l->entry[i];
  if (v < p->rim_count) {
    weights += p->outer[v].weight;
    area += p->outer[v].area;
    constant = p->outer[v].pull;
  }
  double scale = 1 / sqrt(fmax(area, p->least_area));
  l->column[l->begin[v]] = v;
  l->entry[l->begin[v]] = -scale * weights;
  for (size_t i = l->begin[v] + 1; i < l->begin[v + 1]; i++) l->entry[i] *= scale;
  l->constant[v] = vec3_scale(constant, scale);
}

static scree_status build_laplacian(const patch *p, laplacian *l, scree_error *error) {
  SCREE_TRY(alloc_laplacian(p, l, error));
  for (size_t v = 0; v < l->rows; v++) l->begin[v + 1]++; /* the first is its own */
  for (uint32_t t = 0; t < p->facets.count; t++)
    for (int k = 0; k < 3; k++) {
      uint32_t a = p->facets.items[t].vertex[k], b = p->facets.items[t].vertex[(k + 1) % 3],
               c = p->facets.items[t].vertex[(k + 2) % 3];
      l->area[a] += vec3_norm(doubled_area(p, a, b, c)) / 6;
      if (!is_told_here(p, t, k)) continue;
      double weight = weight_of_edge(p, t, k);
      add_entry(l, a, b, weight);
      add_entry(l, b, a, weight);
    }
  for (uint32_t v = 0; v < l->rows; v++) scale_row(p, l, v);
  return SCREE_OK;
}

/* y = L x, with the constants or without. */
static void apply(const laplacian *l, const vec3 *x, bool whole, vec3 *y) {
  for (size_t v = 0; v < l->rows; v++) {
    vec3 sum = whole ? l->constant[v] : (vec3){0};
    for (size_t i = l->begin[v]; i < l->begin[v + 1]; i++)
      sum = vec3_add(sum, vec3_scale(x[l->column[i]], l->entry[i]));
    y[v] = sum;
  }
}

/* x = the transpose of L times y, 0 on the rim. */
static void apply_transposed(const laplacian *l, const vec3 *y, size_t rim_count, vec3 *x) {
  memset(x, 0, l->rows * sizeof *x);
  for (size_t v = 0; v < l->rows; v++)
    for (size_t i = l->begin[v]; i < l->begin[v + 1]; i++) {
      vec3 *to = &x[l->column[i]];
      *to = vec3_add(*to, vec3_scale(y[v], l->entry[i]));
    }
  memset(x, 0, rim_count * sizeof *x);
}

static double dot(const vec3 *a, const vec3 *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) sum += vec3_dot(a[i], b[i]);
  return sum;
}

typedef struct scratch {
  vec3 *residual, *towards, *step, *image;
  double *diagonal;
} scratch;

static void precondition(const scratch *s, size_t count) {
  for (size_t v = 0; v < count; v++) s->step[v] = vec3_scale(s->residual[v], 1 / s->diagonal[v]);
}

/* Conjugate gradients on the normal equations, preconditioned by their diagonal. */
static void solve(const laplacian *l, size_t rim_count, const scratch *s, vec3 *x) {
  size_t n = l->rows;
  for (size_t v = 0; v < n; v++) s->diagonal[v] = 0;
  for (size_t i = 0; i < l->capacity; i++) s->diagonal[l->column[i]] += l->entry[i] * l->entry[i];
  apply(l, x, true, s->image);
  apply_transposed(l, s->image, rim_count, s->residual);
  for (size_t v = 0; v < n; v++) s->residual[v] = vec3_neg(s->residual[v]);
  precondition(s, n);
  memcpy(s->towards, s->step, n * sizeof *s->step);
  double before = dot(s->residual, s->step, n), target = before * residual_left;
  for (int i = 0; i < ITERATIONS && before > target; i++) {
    apply(l, s->towards, false, s->image);
    double bend = dot(s->image, s->image, n);
    if (!(bend > 0)) return;
    double length = before / bend;
    for (size_t v = rim_count; v < n; v++) x[v] = vec3_add(x[v], vec3_scale(s->towards[v], length));
    apply_transposed(l, s->image, rim_count, s->step);
    for (size_t v = 0; v < n; v++)
      s->residual[v] = vec3_sub(s->residual[v], vec3_scale(s->step[v], length));
    precondition(s, n);
    double now = dot(s->residual, s->step, n);
    for (size_t v = 0; v < n; v++)
      s->towards[v] = vec3_add(s->step[v], vec3_scale(s->towards[v], now / before));
    before = now;
  }
}

static scree_status smooth(patch *p, scree_error *error) {
  SCREE_CLEANUP(free_laplacian) laplacian l = {.rows = 0};
  SCREE_TRY(build_laplacian(p, &l, error));
  SCREE_SCRATCH(vec3, residual, l.rows, error);
  SCREE_SCRATCH(vec3, towards, l.rows, error);
  SCREE_SCRATCH(vec3, step, l.rows, error);
  SCREE_SCRATCH(vec3, image, l.rows, error);
  SCREE_SCRATCH(double, diagonal, l.rows, error);
  scratch s = {residual, towards, step, image, diagonal};
  solve(&l, p->rim_count, &s, p->at.items);
  return SCREE_OK;
}

/* ---- The whole ---- */

static bool is_good(const patch *p) {
  double most = 10 * p->r->largest;
  for (size_t v = 0; v < p->at.count; v++)
    if (!(fabs(p->at.items[v].x) <= most && fabs(p->at.items[v].y) <= most &&
          fabs(p->at.items[v].z) <= most))
      return false;
  return true;
}

/* The filling in the mesh makes way for the patch. */
static scree_status put_back(patch *p, scree_error *error) {
  scree_mesh *m = &p->r->mesh;
  SCREE_SCRATCH(uint32_t, index, p->at.count, error);
  bool room = true;
  for (size_t v = 0; room && v < p->at.count; v++) {
    double at[3];
    vec3_store(at, p->at.items[v]);
    if (v < p->rim_count)
      index[v] = p->filling->vertex[v];
    else
      room = scree_repair_add_vertex(p->r, at, &index[v]);
  }
  m->triangle_count = p->filling->first_facet;
  for (size_t t = 0; room && t < p->facets.count; t++) {
    const uint32_t *v = p->facets.items[t].vertex;
    room = scree_repair_add_facet(p->r, index[v[0]], index[v[1]], index[v[2]]);
  }
  return room ? SCREE_OK : scree_repair_no_memory(error);
}

scree_status scree_repair_fair(scree_repair *r, const scree_filling *filling, bool *faired,
                               scree_error *error) {
  SCREE_CLEANUP(free_patch) patch p = {.filling = filling, .r = r};
  *faired = false;
  SCREE_TRY(take_rim(&p, error));
  SCREE_TRY(take_facets(&p, error));
  double coarse = 1;
  while (coarse * COARSEST < (double)filling->count) coarse *= 2;
  for (; coarse >= 1; coarse /= 2) {
    SCREE_TRY(refine(&p, coarse, error));
    for (int i = 0; i < SOLUTIONS; i++) {
      SCREE_TRY(smooth(&p, error));
      relax(&p);
    }
  }
  if (!is_good(&p) || p.at.count == p.rim_count) return SCREE_OK;
  SCREE_TRY(put_back(&p, error));
  *faired = true;
  return SCREE_OK;
}
