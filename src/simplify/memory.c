/* The surface kept, and how what lies near a place of it is found. */
#include "simplify/memory.h"

#include "base/parallel.h"

#include <string.h>

/* Of sqrt(area / triangles). A sphere's volume in a tetrahedron needs 0.57, in an octahedron 0.37.
 */
#define STAND_OFF 0.5
/* Triangles walked over towards a place before one begins anew in its cell, and then before the
 * tree is asked. */
enum { FIRST_STEPS = 8, MOST_STEPS = 32 };
/* Cells along the longest side of the surface's box: at most, and their square for a triangle. */
#define MOST_CELLS         128.0
#define CELLS_PER_TRIANGLE 0.125
enum { WAY_BLOCK = 4096 };
/* Of a sum of a few products in single precision, the rounding of its factors with it, in units of
 * the products' sizes: several times what it can be. */
#define WAY_ERROR 1e-6

void scree_memory_free(scree_memory *m) {
  scree_bvh_free(&m->surface);
  scree_free(m->ways);
  scree_free(m->starts.triangle);
  scree_free(m->near);
  scree_free(m->witnesses);
  scree_free(m->first);
  *m = (scree_memory){0};
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
    g->triangle[scree_start_cell(g, vec3_scale(sum, 1.0 / 3))] = i;
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

double scree_memory_walk(const scree_memory *m, vec3 x, uint32_t *near) {
  float at[3] = {(float)x.x, (float)x.y, (float)x.z}, bound;
  if (walk(m, at, FIRST_STEPS, near, &bound)) return (double)bound;
  uint32_t start = m->starts.triangle[scree_start_cell(&m->starts, x)];
  if (start != SCREE_NONE) *near = start;
  walk(m, at, MOST_STEPS, near, &bound);
  return (double)bound;
}

bool scree_memory_find_farther(const scree_memory *m, vec3 x, double least, uint32_t near,
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
  double bound = scree_memory_walk(m, x, near);
  if (bound * bound <= least) return false;
  bool is_farther = scree_memory_find_farther(m, x, least, *near, hit);
  *near = hit->index;
  return is_farther;
}

bool scree_memory_allows(const scree_memory *m, size_t triangle_count, vec3 x) {
  double most = STAND_OFF * STAND_OFF * m->area / (double)triangle_count;
  uint32_t near = m->starts.triangle[scree_start_cell(&m->starts, x)];
  scree_bvh_hit hit;
  if (near == SCREE_NONE) return scree_bvh_closest(&m->surface, x, &(scree_bvh_hit){most, x, 0});
  return !find_farther(m, x, most, &near, &hit);
}

double scree_memory_farther(const scree_memory *m, vec3 x, double least, uint32_t *near) {
  scree_bvh_hit hit;
  return find_farther(m, x, least, near, &hit) ? hit.distance2 : least;
}
