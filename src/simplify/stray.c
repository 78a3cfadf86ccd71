/* The distance of a witness from the patch that replaces its triangle bounds its distance from the
 * level from above, as Klein, Liebich and Strasser, "Mesh reduction with error control"
 * (Visualization 1996), have it for all vertices of the mesh given. */
#include "simplify/stray.h"

#include "base/lanes.h"
#include "base/parallel.h"
#include "base/prefetch.h"
#include "base/sum.h"

#include <string.h>

/* Of sqrt(area / triangles). A sphere's volume in a tetrahedron needs 0.57, in an octahedron 0.37.
 */
#define STAND_OFF 0.5
/* What is usual for the largest distance, in mean ones. */
#define USUAL_MEANS 10.0
/* ... and where the level is held close. */
#define CLOSE_MEANS 9.0
/* ... less so many of those with which the scan's vertices began. */
#define ROUGH_MEANS 5.0
/* Triangles walked over towards a place before one begins anew in its cell, and then before the
 * tree is asked. */
enum { FIRST_STEPS = 8, MOST_STEPS = 32 };
/* Cells along the longest side of the surface's box: at most, and their square for a triangle. */
#define MOST_CELLS         128.0
#define CELLS_PER_TRIANGLE 0.125
/* How witnesses that were dropped are known. */
#define DROPPED (-1.0)
/* Witnesses that move together, and how many of them side by side. */
enum { MOVED_AT_ONCE = 512, MOVED_BLOCK = 32 };
/* In which the farthest place is looked for. */
enum { FARTHEST_BLOCKS = 16 };
enum { WAY_BLOCK = 4096 };
/* Of a sum of a few products in single precision, the rounding of its factors with it, in units of
 * the products' sizes: several times what it can be. */
#define WAY_ERROR 1e-6
/* Squared areas that differ by no more of themselves are the same. */
#define SAME_SIZE 1e-9

void scree_memory_free(scree_memory *m) {
  scree_bvh_free(&m->surface);
  scree_free(m->ways);
  scree_free(m->starts.triangle);
  scree_free(m->near);
  scree_free(m->witnesses);
  scree_free(m->first);
  *m = (scree_memory){0};
}

/* The farthest of a triangle's is its first. */
static void enlist(scree_memory *m, uint32_t j, uint32_t triangle) {
  uint32_t *at = &m->first[triangle];
  if (*at != SCREE_NONE && m->witnesses[*at].distance2 > m->witnesses[j].distance2)
    at = &m->witnesses[*at].next;
  m->witnesses[j].next = *at;
  *at = j;
}

static void add_witness(scree_memory *m, vec3 at, uint32_t triangle) {
  m->witnesses[m->count] = (scree_witness){.at = at, .weight = 1};
  enlist(m, (uint32_t)m->count++, triangle);
  m->left++;
  m->weight++;
}

double scree_memory_mean(const scree_memory *m) {
  scree_sum sum = {0};
  for (size_t i = 0; i < m->count; i++)
    if (m->witnesses[i].distance2 != DROPPED)
      scree_sum_add(&sum, (double)m->witnesses[i].weight * sqrt(m->witnesses[i].distance2));
  return scree_sum_value(sum) / m->weight;
}

/* Each vertex with the first of its triangles. */
static scree_status add_vertices(scree_memory *m, const scree_halfmesh *s, scree_error *error) {
  uint8_t *seen = scree_alloc_zero(s->vertex_count, 1);
  if (!seen) return scree_fail_memory(error, s->vertex_count, "the witnesses");
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    uint32_t v = s->half[h].from;
    if (v == SCREE_NONE || seen[v]) continue;
    seen[v] = 1;
    add_witness(m, s->vertex[v].at, h / 3);
  }
  scree_free(seen);
  return SCREE_OK;
}

static void add_placed(scree_memory *m, size_t count) {
  for (uint32_t j = 0; j < count; j++) {
    m->witnesses[j].weight = 1;
    enlist(m, j, m->witnesses[j].next);
  }
  m->count = m->left = count;
  m->weight = (double)count;
  m->roughness = scree_memory_mean(m);
}

/* Which of the triangles kept lie beside each other, and at the level's vertices, which are theirs.
 * number: of the surface's triangles, their numbers in the mesh that the tree was made of; becomes
 * those in the tree. */
static void find_beside(scree_memory *m, const scree_halfmesh *s, uint32_t *number,
                        uint32_t *place) {
  for (uint32_t i = 0; i < m->surface.triangle_count; i++) place[m->surface.order[i]] = i;
  for (size_t t = 0; t < s->triangle_count; t++)
    if (!scree_is_gone(s, t)) number[t] = place[number[t]];
  for (size_t h = 0; h < 3 * s->triangle_count; h++) {
    if (scree_is_gone(s, h / 3)) continue;
    uint32_t twin = s->half[h].twin;
    m->ways[number[h / 3]].beside[h % 3] = twin == SCREE_NONE ? SCREE_NONE : number[twin / 3];
    m->near[s->half[h].from] = number[h / 3];
  }
}

/* Answers the sum of the sizes. */
static double set_linear(float *f, vec3 per_length, vec3 zero) {
  double rest = -vec3_dot(per_length, zero);
  f[0] = (float)per_length.x;
  f[1] = (float)per_length.y;
  f[2] = (float)per_length.z;
  f[3] = (float)rest;
  return fabs(per_length.x) + fabs(per_length.y) + fabs(per_length.z) + fabs(rest);
}

/* The shares, linear in the place, are those of its foot on the triangle's plane: wrong shares move
 * the foot along the sides, far if they are steep. */
static void way_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_memory *m = context;
  for (size_t i = begin; i < end; i++) {
    const double *corners = m->surface.corners + 9 * i;
    vec3 a = vec3_load(corners), ab = vec3_sub(vec3_load(corners + 3), a),
         ac = vec3_sub(vec3_load(corners + 6), a), n = vec3_cross(ab, ac);
    double n2 = vec3_norm2(n);
    scree_way *way = &m->ways[i];
    double second = set_linear(way->second, vec3_scale(vec3_cross(ac, n), 1 / n2), a),
           third = set_linear(way->third, vec3_scale(vec3_cross(n, ab), 1 / n2), a),
           height = set_linear(way->height, vec3_scale(n, 1 / sqrt(n2)), a);
    way->error = (float)(WAY_ERROR * (second * vec3_norm(ab) + third * vec3_norm(ac) + height));
  }
}

static uint32_t cell_along(double at, double low, double cells_per_length, uint32_t size) {
  double cell = (at - low) * cells_per_length;
  return cell > 0 ? cell < size ? (uint32_t)cell : size - 1 : 0;
}

static uint32_t start_cell(const scree_starts *g, vec3 x) {
  uint32_t i = cell_along(x.x, g->low.x, g->cells_per_length, g->size[0]),
           j = cell_along(x.y, g->low.y, g->cells_per_length, g->size[1]),
           k = cell_along(x.z, g->low.z, g->cells_per_length, g->size[2]);
  return (k * g->size[1] + j) * g->size[0] + i;
}

/* The last of the triangles whose middle is in a cell is there to begin with. */
static scree_status find_starts(scree_memory *m, const scree_halfmesh *s, scree_error *error) {
  scree_starts *g = &m->starts;
  vec3 extent = vec3_sub(s->high, s->low);
  double longest = fmax(extent.x, fmax(extent.y, extent.z));
  g->low = s->low;
  double cells = fmin(MOST_CELLS, sqrt(CELLS_PER_TRIANGLE * (double)m->surface.triangle_count));
  g->cells_per_length = longest > 0 ? cells / longest : 0;
  g->size[0] = (uint32_t)(extent.x * g->cells_per_length) + 1;
  g->size[1] = (uint32_t)(extent.y * g->cells_per_length) + 1;
  g->size[2] = (uint32_t)(extent.z * g->cells_per_length) + 1;
  size_t count = (size_t)g->size[0] * g->size[1] * g->size[2];
  SCREE_ALLOC_OR(g->triangle, count, error, out_of_memory);
  memset(g->triangle, 0xff, count * sizeof *g->triangle);
  for (uint32_t i = 0; i < m->surface.triangle_count; i++) {
    const double *corners = m->surface.corners + 9 * (size_t)i;
    vec3 sum =
        vec3_add(vec3_add(vec3_load(corners), vec3_load(corners + 3)), vec3_load(corners + 6));
    g->triangle[start_cell(g, vec3_scale(sum, 1.0 / 3))] = i;
  }
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

scree_status scree_memory_keep_surface(const scree_halfmesh *s, scree_memory *m,
                                       scree_error *error) {
  scree_mesh mesh = {.vertex_count = s->vertex_count};
  uint32_t *number = NULL, *place = NULL;
  scree_status status = SCREE_OUT_OF_MEMORY;
  *m = (scree_memory){0};
  SCREE_ALLOC_OR(mesh.positions, 3 * s->vertex_count, error, done);
  SCREE_ALLOC_OR(mesh.triangles, 3 * s->live_triangle_count, error, done);
  SCREE_ALLOC_OR(m->near, s->vertex_count, error, done);
  SCREE_ALLOC_OR(number, s->triangle_count, error, done);
  SCREE_ALLOC_OR(place, s->live_triangle_count, error, done);
  for (size_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, at);
    m->area += 0.5 * vec3_norm(vec3_triangle_normal(at[0], at[1], at[2]));
    for (size_t i = 0; i < 3; i++)
      mesh.triangles[3 * mesh.triangle_count + i] = s->half[3 * t + i].from;
    number[t] = (uint32_t)mesh.triangle_count++;
  }
  for (size_t v = 0; v < s->vertex_count; v++) vec3_store(mesh.positions + 3 * v, s->vertex[v].at);
  status = scree_bvh_build(&mesh, &m->surface, error);
  if (status != SCREE_OK) goto done;
  status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(m->ways, s->live_triangle_count, error, done);
  find_beside(m, s, number, place);
  scree_parallel_for(m->surface.triangle_count, WAY_BLOCK, way_block, m);
  status = find_starts(m, s, error);
done:
  scree_mesh_free(&mesh);
  scree_free(number);
  scree_free(place);
  if (status != SCREE_OK) scree_memory_free(m);
  return status;
}

scree_status scree_memory_keep(const scree_halfmesh *s, scree_witness *placed, size_t placed_count,
                               scree_memory *m, scree_error *error) {
  scree_status status = SCREE_OK;
  if (!scree_memory_has_surface(m)) status = scree_memory_keep_surface(s, m, error);
  m->witnesses = placed;
  if (status != SCREE_OK) goto failed;
  status = SCREE_OUT_OF_MEMORY;
  if (!placed) SCREE_ALLOC_OR(m->witnesses, s->live_vertex_count, error, failed);
  SCREE_ALLOC_OR(m->first, s->triangle_count, error, failed);
  memset(m->first, 0xff, s->triangle_count * sizeof *m->first);
  status = SCREE_OK;
  if (placed)
    add_placed(m, placed_count);
  else
    status = add_vertices(m, s, error);
failed:
  if (status != SCREE_OK) scree_memory_free(m);
  return status;
}

/* Goes over the edge beyond which x lies farthest, so many times at the most. True: x lies above
 * the triangle come to, or that is as near as it gets. *bound: no less than the distance of x from
 * it. */
static bool walk(const scree_memory *m, const float *at, int steps, uint32_t *triangle,
                 float *bound) {
  uint32_t last = SCREE_NONE, now = *triangle;
  *bound = INFINITY;
  for (int step = 0; step < steps; step++) {
    const scree_way *way = &m->ways[now];
    const float *p = way->second, *q = way->third, *n = way->height;
    *triangle = now;
    for (int k = 0; k < 3; k++)
      if (way->beside[k] != SCREE_NONE) __builtin_prefetch(&m->ways[way->beside[k]]);
    float second = p[0] * at[0] + p[1] * at[1] + p[2] * at[2] + p[3];
    float third = q[0] * at[0] + q[1] * at[1] + q[2] * at[2] + q[3], first = 1 - second - third;
    if ((first >= 0) & (second >= 0) & (third >= 0)) {
      *bound = fabsf(n[0] * at[0] + n[1] * at[1] + n[2] * at[2] + n[3]) + way->error;
      return true;
    }
    int edge = third <= first && third <= second ? 0 : first <= second ? 1 : 2;
    uint32_t next = way->beside[edge];
    if (next == SCREE_NONE || next == last) return true; /* back and forth over a crest */
    last = now;
    now = next;
  }
  *triangle = now;
  return false;
}

/* Of the triangles kept the one that x lies above, or one near to it, looked for from *near on,
 * then from x's cell. Answers a distance: x is no farther from it. */
static double walk_towards(const scree_memory *m, vec3 x, uint32_t *near) {
  float at[3] = {(float)x.x, (float)x.y, (float)x.z}, bound;
  if (walk(m, at, FIRST_STEPS, near, &bound)) return (double)bound;
  uint32_t start = m->starts.triangle[start_cell(&m->starts, x)];
  if (start != SCREE_NONE) *near = start;
  walk(m, at, MOST_STEPS, near, &bound);
  return (double)bound;
}

/* Whether x, which is near this triangle, is farther from the surface kept than `least`, squared;
 * then *hit is where it is nearest. */
static bool find_farther_from(const scree_memory *m, vec3 x, double least, uint32_t near,
                              scree_bvh_hit *hit) {
  hit->index = near;
  hit->distance2 = scree_triangle_closest(m->surface.corners + 9 * (size_t)near, x, &hit->point);
  if (hit->distance2 <= least) return false; /* else it is mostly farther */
  scree_bvh_closest(&m->surface, x, hit);
  return hit->distance2 > least;
}

/* The same, *near being a triangle to begin with, then one near x: mostly that is the answer, at
 * less cost than to look through the tree. */
static bool find_farther(const scree_memory *m, vec3 x, double least, uint32_t *near,
                         scree_bvh_hit *hit) {
  double bound = walk_towards(m, x, near);
  if (bound * bound <= least) return false;
  bool is_farther = find_farther_from(m, x, least, *near, hit);
  *near = hit->index;
  return is_farther;
}

bool scree_memory_allows(const scree_memory *m, size_t triangle_count, vec3 x) {
  double most = STAND_OFF * STAND_OFF * m->area / (double)triangle_count;
  uint32_t near = m->starts.triangle[start_cell(&m->starts, x)];
  scree_bvh_hit hit;
  if (near == SCREE_NONE) return scree_bvh_closest(&m->surface, x, &(scree_bvh_hit){most, x, 0});
  return !find_farther(m, x, most, &near, &hit);
}

/* The squared distance of x from the surface kept, if above `least`. */
static double farther(const scree_memory *m, vec3 x, double least, uint32_t *near) {
  scree_bvh_hit hit;
  return find_farther(m, x, least, near, &hit) ? hit.distance2 : least;
}

/* The corners of the ring's triangle i, with its moving corner at x. */
static void corners_at(const scree_halfmesh *s, const scree_ring *r, uint32_t i, vec3 x,
                       double *corners) {
  vec3_store(corners, x);
  vec3_store(corners + 3, s->vertex[s->half[r->edge[i]].from].at);
  vec3_store(corners + 6, s->vertex[scree_to(s, r->edge[i])].at);
}

void scree_ring_corners(const scree_halfmesh *s, const scree_ring *r, vec3 target,
                        double (*corners)[9]) {
  for (uint32_t i = 0; i < r->count; i++) corners_at(s, r, i, target, corners[i]);
}

/* Triangle k of those around: the ring's, then the edge's own. */
static uint32_t triangle_around(const scree_halfmesh *s, const scree_ring *r, uint32_t k) {
  uint32_t h = k < r->count    ? r->edge[k]
               : k == r->count ? r->half_edge
                               : s->half[r->half_edge].twin;
  return h / 3;
}

static uint32_t count_around(const scree_ring *r) {
  return r->count + (r->c != SCREE_NONE) + (r->d != SCREE_NONE);
}

/* The least of the squared distances of p from these triangles. */
static double distance2_from(const scree_four *fours, size_t four_count, vec3 p) {
  double distance2[SCREE_RING_MAX], least = INFINITY;
  scree_fours_closest(fours, four_count, p, distance2);
  for (size_t i = 0; i < SCREE_FOUR * four_count; i++)
    if (distance2[i] < least) least = distance2[i];
  return least;
}

/* No point of triangle k of those around is farther from the new ones: its distance from one of
 * them is largest at a corner. Of the edge's own triangles it is one at their apex, mostly. */
static double shift(const scree_halfmesh *s, const scree_ring *r, double (*corners)[9],
                    uint32_t k) {
  vec3 a = s->vertex[r->a].at, b = s->vertex[r->b].at, point;
  if (k < r->count) return sqrt(scree_triangle_closest(corners[k], k < r->a_count ? a : b, &point));
  bool at_c = k == r->count, around_a = r->a_count > 0;
  vec3 apex = s->vertex[at_c ? r->c : r->d].at;
  const double *one = corners[at_c == around_a ? 0 : around_a ? r->a_count - 1 : r->count - 1];
  double of_ends =
      fmax(scree_triangle_closest(one, a, &point), scree_triangle_closest(one, b, &point));
  return sqrt(fmax(of_ends, scree_triangle_closest(one, apex, &point)));
}

/* Asks for the witnesses of the triangles around: along all lists at once, for each tells only
 * where its next one is. */
SCREE_PREFETCHES void ask_for_witnesses(const scree_memory *m, const scree_halfmesh *s,
                                        const scree_ring *r) {
  uint32_t at[SCREE_RING_MAX + 3], count = 0, around = count_around(r);
  for (uint32_t k = 0; k < around; k++) {
    at[count] = m->first[triangle_around(s, r, k)];
    count += at[count] != SCREE_NONE;
  }
  while (count > 0) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
      at[left] = m->witnesses[at[i]].next;
      if (at[left] == SCREE_NONE) continue;
      __builtin_prefetch(&m->witnesses[at[left]]);
      left++;
    }
    count = left;
  }
}

/* Witnesses of one triangle side by side. */
typedef struct witness_crowd {
  scree_points points;
  double before[SCREE_POINTS]; /* their squared distances now */
} witness_crowd;

/* Takes the next witnesses from j on, but for those nearer than `safe2`; answers what is left. */
static uint32_t gather_crowd(const scree_memory *m, uint32_t j, double safe2, witness_crowd *c) {
  c->points.count = 0;
  while (j != SCREE_NONE && c->points.count < SCREE_POINTS) {
    const scree_witness *w = &m->witnesses[j];
    j = w->next;
    if (w->distance2 < safe2) continue;
    c->before[c->points.count] = w->distance2;
    scree_points_add(&c->points, w->at);
  }
  return j;
}

/* The largest squared distance of a witness of the ring's triangles from the new ones, where it
 * grows and is above `worst`; or the first that is above `most`. The triangle whose place the
 * witness's own had is mostly near enough. */
static double stray_of_witnesses(const scree_memory *m, const scree_halfmesh *s,
                                 const scree_ring *r, vec3 target, double worst, double most) {
  double corners[SCREE_RING_MAX][9];
  scree_four fours[SCREE_RING_MAX / SCREE_FOUR];
  size_t four_count = scree_four_count(r->count);
  witness_crowd c;
  if (worst > most) return worst;
  ask_for_witnesses(m, s, r);
  scree_ring_corners(s, r, target, corners);
  scree_fours_fill(corners, r->count, fours);
  for (uint32_t k = 0; k < count_around(r); k++) {
    uint32_t j = m->first[triangle_around(s, r, k)];
    if (j == SCREE_NONE) continue;
    double safe2 = 0; /* those that are no farther off now do not get beyond `worst` */
    if (m->witnesses[j].next != SCREE_NONE && m->witnesses[j].distance2 < worst) {
      double room = sqrt(worst) - shift(s, r, corners, k);
      safe2 = room > 0 ? room * room : 0;
      if (m->witnesses[j].distance2 < safe2) continue; /* it is the farthest */
    }
    while (j != SCREE_NONE) {
      j = gather_crowd(m, j, safe2, &c);
      scree_points_closest(corners[k % r->count], &c.points);
      for (int i = 0; i < c.points.count; i++) {
        double near = c.points.distance2[i];
        if (near <= worst || near <= scree_past_rounding(c.before[i])) continue;
        double distance2 = distance2_from(
            fours, four_count, (vec3){c.points.at[0][i], c.points.at[1][i], c.points.at[2][i]});
        if (distance2 > fmax(worst, scree_past_rounding(c.before[i]))) worst = distance2;
        if (worst > most) return worst;
      }
    }
  }
  return worst;
}

/* The places on an edge, as shares of sixths, middles first: along an edge over a hollow the
 * surface is farthest off somewhere in between. Each with the place before it that is next to it;
 * -1: the target. */
static const struct {
  int sixths, beside;
} places[SCREE_EDGE_PLACES] = {{3, -1}, {2, 0}, {4, 0}, {1, 1}, {5, 2}};

static vec3 place_on_edge(const scree_halfmesh *s, const scree_ring *r, vec3 target, uint32_t i,
                          uint32_t k) {
  vec3 end = s->vertex[s->half[r->edge[i]].from].at;
  return vec3_lerp(target, end, places[k].sixths / 6.0);
}

/* Where to begin looking for place k of the edges, if that is not known: in its cell. All are asked
 * for at once. */
static void begin_places(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                         vec3 target, uint32_t k, scree_hints *hints) {
  uint32_t cell[SCREE_RING_MAX], first = 1 + k * r->count;
  uint32_t begin = hints->known > first ? hints->known - first : 0;
  for (uint32_t i = begin; i < r->count; i++) {
    cell[i] = start_cell(&m->starts, place_on_edge(s, r, target, i, k));
    __builtin_prefetch(&m->starts.triangle[cell[i]]);
  }
  for (uint32_t i = begin; i < r->count; i++) {
    uint32_t *near = &hints->near[first + i];
    *near = m->starts.triangle[cell[i]];
    if (*near == SCREE_NONE)
      *near = places[k].beside < 0 ? hints->near[0]
                                   : hints->near[1 + (uint32_t)places[k].beside * r->count + i];
    __builtin_prefetch(&m->ways[*near]);
  }
}

/* The same of the new vertex and of the first `count` places on each new edge, from the surface
 * kept. In hints, place k of edge i has the number 1 + k * (edges) + i, the new vertex 0. */
static double stray_of_edges(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                             vec3 target, uint32_t count, double worst, double most,
                             scree_hints *hints) {
  uint32_t *near = hints->near, number = 1, known = hints->known;
  if (worst > most) return worst;
  if (hints->farthest > 0 && known > 0) {
    uint32_t place = hints->farthest - 1;
    vec3 x = place_on_edge(s, r, target, place % r->count, place / r->count);
    worst = farther(m, x, worst, &near[place + 1]);
    if (worst > most) return worst;
  }
  if (known == 0) near[0] = m->near[r->a];
  worst = farther(m, target, worst, &near[0]);
  for (uint32_t k = 0; k < count && worst <= most; k++) {
    begin_places(m, s, r, target, k, hints);
    for (uint32_t i = 0; i < r->count && worst <= most; i++, number++) {
      double found = farther(m, place_on_edge(s, r, target, i, k), worst, &near[number]);
      if (found > worst) hints->farthest = number;
      worst = found;
    }
  }
  if (number > hints->known) hints->known = number;
  return worst;
}

double scree_memory_stray(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                          vec3 target, double least, double most, scree_hints *hints) {
  double worst = stray_of_witnesses(m, s, r, target, least, most);
  return stray_of_edges(m, s, r, target, SCREE_EDGE_PLACES, worst, most, hints);
}

double scree_memory_edges_stray(const scree_memory *m, const scree_halfmesh *s,
                                const scree_ring *fan, vec3 x, double least, scree_hints *hints) {
  return stray_of_edges(m, s, fan, x, SCREE_EDGE_PLACES, least, INFINITY, hints);
}

bool scree_memory_edges_within(const scree_memory *m, const scree_halfmesh *s,
                               const scree_ring *fan, vec3 x, double most, scree_hints *hints) {
  return stray_of_edges(m, s, fan, x, SCREE_EDGE_PLACES, most, most, hints) <= most;
}

bool scree_memory_stays_within(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                               vec3 target, uint32_t places_on_edge, double most) {
  scree_hints hints;
  scree_no_hints(&hints);
  double worst = stray_of_edges(m, s, r, target, places_on_edge, most, most, &hints);
  if (worst > most || !scree_memory_is_kept(m)) return worst <= most;
  return stray_of_witnesses(m, s, r, target, most, most) <= most;
}

double scree_memory_growth(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                           vec3 target, double least, double *worst) {
  double corners[SCREE_RING_MAX][9], growth = 0, most = least;
  scree_four fours[SCREE_RING_MAX / SCREE_FOUR];
  size_t four_count = scree_four_count(r->count);
  scree_hints hints;
  scree_no_hints(&hints);
  ask_for_witnesses(m, s, r);
  scree_ring_corners(s, r, target, corners);
  scree_fours_fill(corners, r->count, fours);
  for (uint32_t k = 0; k < count_around(r); k++)
    for (uint32_t j = m->first[triangle_around(s, r, k)]; j != SCREE_NONE;
         j = m->witnesses[j].next) {
      double distance2 = distance2_from(fours, four_count, m->witnesses[j].at);
      growth +=
          (double)m->witnesses[j].weight * (sqrt(distance2) - sqrt(m->witnesses[j].distance2));
      most = fmax(most, distance2);
    }
  *worst = scree_memory_edges_stray(m, s, r, target, most, &hints);
  return growth;
}

double scree_memory_worst(const scree_memory *m) {
  double worst = 0;
  for (size_t i = 0; i < m->count; i++)
    if (m->witnesses[i].distance2 > worst) worst = m->witnesses[i].distance2;
  return sqrt(worst);
}

double scree_memory_witness_stray(const scree_memory *m, const scree_halfmesh *s) {
  double worst = 0;
  for (size_t t = 0; t < s->triangle_count; t++)
    if (m->first[t] != SCREE_NONE) worst = fmax(worst, m->witnesses[m->first[t]].distance2);
  return worst;
}

double scree_memory_vertex_stray(const scree_memory *m, const scree_halfmesh *s, uint32_t v,
                                 double least) {
  uint32_t near = m->near[v];
  return farther(m, s->vertex[v].at, least, &near);
}

double scree_memory_edge_stray(const scree_memory *m, const scree_halfmesh *s, uint32_t h,
                               double least) {
  uint32_t from = s->half[h].from, near = m->near[from];
  vec3 at = s->vertex[from].at, to = s->vertex[scree_to(s, h)].at;
  for (uint32_t k = 0; k < SCREE_EDGE_PLACES; k++)
    least = farther(m, vec3_lerp(at, to, places[k].sixths / 6.0), least, &near);
  return least;
}

/* Whether x is farther off than `least`, as find_farther; what was found before of a place nearby
 * mostly tells that it is not. */
static bool is_far_place(const scree_memory *m, vec3 x, double least, scree_place_hint *hint,
                         scree_bvh_hit *hit) {
  double moved = sqrt(vec3_norm2(vec3_sub(x, hint->at))), bound = hint->within + moved;
  if (bound * bound <= least) return false;
  hint->at = x;
  hint->within = walk_towards(m, x, &hint->near);
  if (hint->within * hint->within <= least) return false;
  bool far = find_farther_from(m, x, least, hint->near, hit);
  hint->within = sqrt(hit->distance2);
  hint->near = hit->index;
  return far;
}

size_t scree_memory_far_places(const scree_memory *m, const scree_halfmesh *s, double least,
                               bool hinted, scree_place_hint (*hints)[SCREE_LEVEL_PLACES],
                               scree_far_place *far) {
  size_t count = 0;
  scree_bvh_hit hit;
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    uint32_t from = s->half[h].from, twin = s->half[h].twin;
    if (from == SCREE_NONE || (twin < h && s->vertex[from].outgoing != h)) continue;
    vec3 at = s->vertex[from].at, end = s->vertex[scree_to(s, h)].at;
    scree_place_hint *hint = hints[h];
    if (!hinted) hint[0] = (scree_place_hint){at, INFINITY, m->near[from]};
    if (s->vertex[from].outgoing == h && is_far_place(m, at, least, &hint[0], &hit))
      far[count++] = (scree_far_place){h, 0, at, hit.point, hit.distance2};
    for (uint32_t k = 0; k < SCREE_EDGE_PLACES && h < twin; k++) {
      double share = places[k].sixths / 6.0;
      vec3 x = vec3_lerp(at, end, share);
      if (!hinted) hint[1 + k] = (scree_place_hint){x, INFINITY, hint[1 + places[k].beside].near};
      if (is_far_place(m, x, least, &hint[1 + k], &hit))
        far[count++] = (scree_far_place){h, share, x, hit.point, hit.distance2};
    }
  }
  return count;
}

/* Triangles by blocks. */
typedef struct looking {
  const scree_memory *m;
  const scree_halfmesh *s;
  double worst[FARTHEST_BLOCKS];
} looking;

static void look_at_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  looking *l = context;
  const scree_halfmesh *s = l->s;
  double worst = l->worst[block];
  for (uint32_t h = 3 * (uint32_t)begin; h < 3 * end; h++) {
    uint32_t from = s->half[h].from, twin = s->half[h].twin;
    if (from == SCREE_NONE) continue;
    if (s->vertex[from].outgoing == h) worst = scree_memory_vertex_stray(l->m, s, from, worst);
    if (h < twin) worst = scree_memory_edge_stray(l->m, s, h, worst);
  }
  l->worst[block] = worst;
}

double scree_memory_farthest(const scree_memory *m, const scree_halfmesh *s) {
  looking l = {.m = m, .s = s};
  double worst = scree_memory_witness_stray(m, s);
  for (int i = 0; i < FARTHEST_BLOCKS; i++) l.worst[i] = worst;
  scree_parallel_for(s->triangle_count, s->triangle_count / FARTHEST_BLOCKS + 1, look_at_block, &l);
  for (int i = 0; i < FARTHEST_BLOCKS; i++) worst = fmax(worst, l.worst[i]);
  return worst;
}

double scree_memory_usual(const scree_memory *m, bool close) {
  if (!(scree_memory_worst(m) > SCREE_SAME_DISTANCE)) return 0;
  double mean = scree_memory_mean(m), means = close ? CLOSE_MEANS : USUAL_MEANS;
  return fmax(means * mean - ROUGH_MEANS * m->roughness, mean);
}

/* Of the triangle's witnesses every second in the order of their distances, the largest first. */
static void thin_list(scree_memory *m, uint32_t *first) {
  uint32_t sorted = SCREE_NONE, next;
  for (uint32_t j = *first; j != SCREE_NONE; j = next) {
    uint32_t *at = &sorted;
    next = m->witnesses[j].next;
    while (*at != SCREE_NONE && m->witnesses[*at].distance2 > m->witnesses[j].distance2)
      at = &m->witnesses[*at].next;
    m->witnesses[j].next = *at;
    *at = j;
  }
  *first = sorted;
  for (uint32_t j = sorted; j != SCREE_NONE; j = next) {
    uint32_t dropped = m->witnesses[j].next;
    next = dropped;
    if (dropped == SCREE_NONE) continue;
    m->witnesses[j].next = next = m->witnesses[dropped].next;
    m->witnesses[dropped].distance2 = DROPPED;
    m->weight -= (double)m->witnesses[dropped].weight;
    m->left--;
  }
}

void scree_memory_thin(scree_memory *m, const scree_halfmesh *s, size_t crowd, size_t least) {
  size_t most = crowd * s->live_triangle_count;
  if (most < least) most = least;
  while (m->left > most)
    for (size_t t = 0; t < s->triangle_count; t++)
      if (!scree_is_gone(s, t)) thin_list(m, &m->first[t]);
}

scree_status scree_memory_squeeze(scree_memory *m, const scree_halfmesh *s, scree_error *error) {
  scree_witness *kept;
  uint32_t count = 0;
  SCREE_ALLOC_OR(kept, m->left, error, out_of_memory);
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    for (uint32_t *j = &m->first[t]; *j != SCREE_NONE; j = &kept[count++].next) {
      kept[count] = m->witnesses[*j];
      *j = count;
    }
  }
  scree_free(m->witnesses);
  m->witnesses = kept;
  m->count = count;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_memory_compact(scree_memory *m, const scree_halfmesh *s) {
  size_t triangles = 0, vertices = 0;
  for (size_t t = 0; t < s->triangle_count && m->first; t++)
    if (!scree_is_gone(s, t)) m->first[triangles++] = m->first[t];
  for (size_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) m->near[vertices++] = m->near[v];
}

/* The new triangles of a ring. */
typedef struct fan {
  scree_four fours[SCREE_RING_MAX / SCREE_FOUR];
  size_t four_count;
} fan;

static double size2_of(const fan *f, uint32_t i) {
  return f->fours[i / SCREE_FOUR].n2[i % SCREE_FOUR];
}

/* The triangle whose new form is nearest to the witness. Equally near ones are usual, for the
 * nearest point often lies on an edge: of these the largest, so that the order of facets does not
 * decide; of equally large ones the first of the mesh. */
static uint32_t nearest_triangle(const scree_ring *r, const fan *f, scree_witness *w) {
  double distance2[SCREE_RING_MAX], least = INFINITY, largest = 0;
  uint32_t nearest = SCREE_NONE;
  scree_fours_closest(f->fours, f->four_count, w->at, distance2);
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] < least) least = distance2[i];
  double near = scree_past_rounding(least);
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] <= near && size2_of(f, i) > largest) largest = size2_of(f, i);
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] <= near && size2_of(f, i) >= (1 - SAME_SIZE) * largest &&
        r->edge[i] / 3 < nearest)
      nearest = r->edge[i] / 3;
  w->distance2 = least;
  return nearest;
}

/* Witnesses that get another triangle, as many as fit. */
typedef struct removal {
  const scree_memory *m;
  const scree_ring *ring;
  fan fan;
  uint32_t count, witness[MOVED_AT_ONCE], triangle[MOVED_AT_ONCE];
} removal;

static void find_nearest(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  removal *q = context;
  for (size_t i = begin; i < end; i++)
    q->triangle[i] = nearest_triangle(q->ring, &q->fan, &q->m->witnesses[q->witness[i]]);
}

static void move_gathered(scree_memory *m, removal *q) {
  scree_parallel_for(q->count, MOVED_BLOCK, find_nearest, q);
  for (uint32_t i = 0; i < q->count; i++) enlist(m, q->witness[i], q->triangle[i]);
  q->count = 0;
}

void scree_memory_move(scree_memory *m, const scree_halfmesh *s, const scree_ring *r, vec3 target) {
  removal q;
  double corners[SCREE_RING_MAX][9];
  uint32_t moving[SCREE_RING_MAX + 2], around = count_around(r);
  q.m = m;
  q.ring = r;
  q.count = 0;
  scree_ring_corners(s, r, target, corners);
  scree_fours_fill(corners, r->count, q.fan.fours);
  q.fan.four_count = scree_four_count(r->count);
  ask_for_witnesses(m, s, r);
  walk_towards(m, target, &m->near[r->a]);
  for (uint32_t k = 0; k < around; k++) {
    uint32_t *first = &m->first[triangle_around(s, r, k)];
    moving[k] = *first;
    *first = SCREE_NONE;
  }
  for (uint32_t k = 0; k < around; k++)
    for (uint32_t j = moving[k]; j != SCREE_NONE; j = m->witnesses[j].next) {
      if (q.count == MOVED_AT_ONCE) move_gathered(m, &q);
      q.witness[q.count++] = j;
    }
  move_gathered(m, &q);
}

/* By the area of their triangles, which they share; in parts of what one has on the average. */
static void weigh(scree_memory *m, const scree_halfmesh *s) {
  double unit = m->area / (double)m->count;
  m->weight = 0;
  for (size_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    double count = 0;
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) count++;
    if (!(count > 0)) continue;
    scree_corners(s, t, at);
    double area = 0.5 * vec3_norm(vec3_triangle_normal(at[0], at[1], at[2]));
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) {
      m->witnesses[j].weight = (float)(area / (count * unit));
      m->weight += (double)m->witnesses[j].weight;
    }
  }
}

void scree_memory_replace(scree_memory *m, const scree_halfmesh *s, scree_witness *witnesses,
                          size_t count) {
  removal q;
  double corners[SCREE_RING_MAX][9];
  uint32_t edges[SCREE_RING_MAX];
  scree_ring all = {.edge = edges};
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, at);
    for (size_t k = 0; k < 3; k++) vec3_store(corners[all.count] + 3 * k, at[k]);
    edges[all.count++] = 3 * t;
  }
  q.m = m;
  q.ring = &all;
  q.count = 0;
  scree_fours_fill(corners, all.count, q.fan.fours);
  q.fan.four_count = scree_four_count(all.count);
  scree_free(m->witnesses);
  m->witnesses = witnesses;
  m->count = m->left = count;
  memset(m->first, 0xff, s->triangle_count * sizeof *m->first);
  for (uint32_t j = 0; j < count; j++) {
    if (q.count == MOVED_AT_ONCE) move_gathered(m, &q);
    q.witness[q.count++] = j;
  }
  move_gathered(m, &q);
  weigh(m, s);
}

/* How deep inside the triangle the nearest points lie, across its edges; none: on one of them. */
SCREE_LANES static void depth_lanes(const double *corners, const scree_points *p, double *depth,
                                    int count) {
  vec3 a = vec3_load(corners), b = vec3_load(corners + 3), c = vec3_load(corners + 6);
  vec3 n = vec3_unit(vec3_triangle_normal(a, b, c));
  double per_ab = 1 / vec3_norm(vec3_sub(b, a)), per_bc = 1 / vec3_norm(vec3_sub(c, b)),
         per_ca = 1 / vec3_norm(vec3_sub(a, c));
  for (int i = 0; i < count; i++) {
    vec3 x = {p->nearest[0][i], p->nearest[1][i], p->nearest[2][i]};
    vec3 xa = vec3_sub(a, x), xb = vec3_sub(b, x), xc = vec3_sub(c, x);
    double ab = per_ab * vec3_dot(n, vec3_cross(xa, xb)),
           bc = per_bc * vec3_dot(n, vec3_cross(xb, xc)),
           ca = per_ca * vec3_dot(n, vec3_cross(xc, xa));
    double least = ab < bc ? ab : bc;
    least = ca < least ? ca : least;
    depth[i] = least > 0 ? least : 0;
  }
}

/* Whether the triangles beside this one, the first, lie beyond planes upright on it. */
static bool faces_all(const scree_four *four, size_t count) {
  bool faces = true;
  for (size_t i = 1; i < count; i++)
    faces &= four->n[0][0] * four->n[0][i] + four->n[1][0] * four->n[1][i] +
                 four->n[2][0] * four->n[2][i] >
             0;
  return faces;
}

/* Of a triangle, the first, and those beside it: as above, but that a witness stays where that is
 * as near as any. */
static size_t nearest_beside(const scree_four *four, const double *distance2, size_t count) {
  double least = distance2[0];
  size_t nearest = SIZE_MAX;
  for (size_t i = 1; i < count; i++) least = distance2[i] < least ? distance2[i] : least;
  double near = scree_past_rounding(least);
  if (distance2[0] <= near) return 0;
  for (size_t i = 1; i < count; i++)
    if (distance2[i] <= near && (nearest == SIZE_MAX || four->n2[i] > four->n2[nearest]))
      nearest = i;
  return nearest;
}

/* Witnesses of one triangle that are to follow. */
typedef struct following {
  scree_memory *m;
  uint32_t beside[SCREE_FOUR]; /* the triangle, and those beside it */
  double corners[SCREE_FOUR][9];
  size_t count;
  scree_four four;
  bool faces; /* all beside it */
  scree_points points;
  uint32_t witness[SCREE_POINTS];
} following;

/* Deep inside, farther from all edges than from the witness, nothing beyond them is nearer. */
static void follow_gathered(following *f) {
  double depth[SCREE_POINTS], distance2[SCREE_FOUR];
  scree_points_closest(f->corners[0], &f->points);
  depth_lanes(f->corners[0], &f->points, depth, f->points.count);
  for (int i = 0; i < f->points.count; i++) {
    scree_witness *w = &f->m->witnesses[f->witness[i]];
    size_t nearest = 0;
    w->distance2 = f->points.distance2[i];
    if (!f->faces || !(depth[i] * depth[i] > (1 + SAME_SIZE) * w->distance2)) {
      scree_fours_closest(&f->four, 1, w->at, distance2);
      nearest = nearest_beside(&f->four, distance2, f->count);
      w->distance2 = distance2[nearest];
    }
    enlist(f->m, f->witness[i], f->beside[nearest]);
  }
  f->points.count = 0;
}

void scree_memory_follow(scree_memory *m, const scree_halfmesh *s, uint32_t *lists) {
  following f = {.m = m};
  memcpy(lists, m->first, s->triangle_count * sizeof *lists);
  memset(m->first, 0xff, s->triangle_count * sizeof *m->first);
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    if (lists[t] == SCREE_NONE) continue;
    f.beside[0] = t;
    f.count = 1;
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++)
      if (s->half[h].twin != SCREE_NONE) f.beside[f.count++] = s->half[h].twin / 3;
    for (size_t i = 0; i < f.count; i++) {
      vec3 at[3];
      scree_corners(s, f.beside[i], at);
      for (size_t k = 0; k < 3; k++) vec3_store(f.corners[i] + 3 * k, at[k]);
    }
    scree_fours_fill(f.corners, f.count, &f.four);
    f.faces = faces_all(&f.four, f.count);
    for (uint32_t j = lists[t], next; j != SCREE_NONE; j = next) {
      next = m->witnesses[j].next;
      f.witness[f.points.count] = j;
      scree_points_add(&f.points, m->witnesses[j].at);
      if (f.points.count == SCREE_POINTS) follow_gathered(&f);
    }
    if (f.points.count > 0) follow_gathered(&f);
  }
}

/* The squared distance of x from the segment between the ring's ends: mostly the answer, at little
 * cost. */
static double distance_from_edge(const scree_halfmesh *s, const scree_ring *r, vec3 x) {
  vec3 e = vec3_sub(s->vertex[r->b].at, s->vertex[r->a].at), y = vec3_sub(x, s->vertex[r->a].at);
  double t = vec3_dot(y, e) / vec3_norm2(e);
  return vec3_norm2(vec3_mad(y, e, t > 1 ? -1 : t > 0 ? -t : 0));
}

/* Whether some new triangle, looked for from `begin` on, is that near to p. */
static bool is_near_new(const scree_halfmesh *s, const scree_ring *r, vec3 target, uint32_t begin,
                        vec3 p, double most) {
  for (uint32_t k = 0; k < r->count; k++) {
    double corners[9];
    vec3 point;
    corners_at(s, r, (begin + k) % r->count, target, corners);
    if (scree_triangle_closest(corners, p, &point) <= most) return true;
  }
  return false;
}

bool scree_ends_stay_within(const scree_halfmesh *s, const scree_ring *r, vec3 target,
                            double most) {
  return is_near_new(s, r, target, 0, s->vertex[r->a].at, most) &&
         is_near_new(s, r, target, r->a_count, s->vertex[r->b].at, most);
}

bool scree_stays_within(const scree_halfmesh *s, const scree_ring *r, vec3 target, double most) {
  double corners[9];
  if (distance_from_edge(s, r, target) <= most) return true;
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 point;
    corners_at(s, r, i, s->vertex[i < r->a_count ? r->a : r->b].at, corners);
    if (scree_triangle_closest(corners, target, &point) <= most) return true;
  }
  return false;
}
