/* A vertex that lies on an edge without being its end is a T-junction: one side of the edge has
 * been split there and the other has not. The facet that runs past is split too. So is the one that
 * a dropped sliver leaves behind. Only edges of one facet are looked at: the others have what they
 * need. */
#include "mesh/repair/soup_tidy.h"

#include "base/array.h"
#include "mesh/adjacency.h"
#include "mesh/weld_near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double share = 2e-6; /* of the diagonal: 2 um in 1 m, far below any body */
static const double ulp = 1.2e-7; /* of a coordinate in single precision, as STL has them */
enum { PASSES = 8 };              /* an edge of each corner, and of what these leave */

double scree_soup_tolerance(const scree_mesh *mesh) {
  vec3 low = {INFINITY, INFINITY, INFINITY}, high = vec3_neg(low);
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    vec3 p = vec3_load(mesh->positions + 3 * v);
    low = vec3_min(low, p);
    high = vec3_max(high, p);
  }
  vec3 far = vec3_max(vec3_neg(low), high);
  double largest = scree_larger(far.x, scree_larger(far.y, far.z));
  return scree_larger(share * vec3_distance(low, high), 4 * ulp * largest);
}

void scree_soup_drop(scree_mesh *mesh, const uint8_t *gone) {
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++)
    if (!gone[t])
      memmove(mesh->triangles + 3 * count++, mesh->triangles + 3 * t, 3 * sizeof(uint32_t));
  mesh->triangle_count = count;
}

/* ---- vertices ---- */

static scree_status weld(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                         scree_error *error) {
  scree_mesh welded = {0};
  vec3 low = vec3_load(mesh->positions), high = low;
  for (size_t v = 1; v < mesh->vertex_count; v++) {
    low = vec3_min(low, vec3_load(mesh->positions + 3 * v));
    high = vec3_max(high, vec3_load(mesh->positions + 3 * v));
  }
  double diagonal = vec3_distance(low, high);
  if (!(diagonal > 0)) return SCREE_OK; /* all of it is flat */
  scree_status status = scree_mesh_copy(mesh, &welded, error);
  if (status == SCREE_OK) status = scree_weld_near(&welded, tolerance / diagonal, error);
  if (status == SCREE_OK && welded.vertex_count < mesh->vertex_count) {
    mending->welded = mesh->vertex_count - welded.vertex_count;
    mending->flat = mesh->triangle_count - welded.triangle_count;
    scree_mesh kept = *mesh;
    *mesh = welded;
    welded = kept;
  }
  scree_mesh_free(&welded);
  return status;
}

/* Over its longest edge, m. */
static double height_of(const scree_mesh *mesh, size_t t) {
  vec3 c[3];
  double longest = 0;
  for (int k = 0; k < 3; k++) c[k] = scree_mesh_corner(mesh, t, k);
  for (int k = 0; k < 3; k++) longest = scree_larger(longest, vec3_distance(c[k], c[(k + 1) % 3]));
  double area2 = vec3_norm(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
  return longest > 0 ? area2 / longest : 0;
}

static scree_status drop_flat(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                              scree_error *error) {
  uint8_t *gone = scree_alloc_zero(mesh->triangle_count, 1);
  if (!gone) return scree_fail_memory(error, mesh->triangle_count, "a wall's facets");
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    gone[t] = scree_names_twice(mesh->triangles + 3 * t) || height_of(mesh, t) <= tolerance;
    mending->flat += gone[t];
  }
  scree_soup_drop(mesh, gone);
  scree_free(gone);
  return SCREE_OK;
}

/* ---- junctions ---- */

typedef struct junction {
  uint32_t half, vertex;
  double along; /* share of the edge */
} junction;

typedef struct junctions {
  junction *items;
  size_t count, capacity;
} junctions;

typedef struct rim_vertex {
  double at; /* along the axis in which they are sorted */
  uint32_t vertex;
} rim_vertex;

static int by_place(const void *a, const void *b) {
  const rim_vertex *x = a, *y = b;
  if (x->at != y->at) return x->at < y->at ? -1 : 1;
  return x->vertex < y->vertex ? -1 : x->vertex > y->vertex;
}

static int by_half(const void *a, const void *b) {
  const junction *x = a, *y = b;
  if (x->half != y->half) return x->half < y->half ? -1 : 1;
  return x->along < y->along ? -1 : x->along > y->along;
}

static bool is_rim(const scree_adjacency *adjacency, uint32_t half) {
  return adjacency->ring[half] == half;
}

static int longest_axis(const scree_mesh *mesh) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
    low[i % 3] = scree_smaller(low[i % 3], mesh->positions[i]);
    high[i % 3] = scree_larger(high[i % 3], mesh->positions[i]);
  }
  int axis = 0;
  for (int k = 1; k < 3; k++)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  return axis;
}

/* The vertices of edges of one facet, by place; free *list. */
static scree_status list_rim(const scree_mesh *mesh, const scree_adjacency *adjacency, int axis,
                             rim_vertex **list, size_t *count, scree_error *error) {
  uint8_t *marked = scree_alloc_zero(mesh->vertex_count, 1);
  *list = scree_alloc(mesh->vertex_count, sizeof **list);
  *count = 0;
  if (!marked || !*list) {
    scree_free(marked);
    scree_free(*list);
    return scree_fail_memory(error, mesh->vertex_count * sizeof **list, "a wall's rims");
  }
  for (uint32_t h = 0; h < 3 * mesh->triangle_count; h++)
    if (is_rim(adjacency, h))
      marked[scree_half_edge_from(mesh, h)] = marked[scree_half_edge_to(mesh, h)] = 1;
  for (uint32_t v = 0; v < mesh->vertex_count; v++)
    if (marked[v])
      (*list)[(*count)++] = (rim_vertex){mesh->positions[3 * (size_t)v + (size_t)axis], v};
  qsort(*list, *count, sizeof **list, by_place);
  scree_free(marked);
  return SCREE_OK;
}

/* Which of them lie on the edge. */
static bool look_along(const scree_mesh *mesh, uint32_t half, int axis, double tolerance,
                       const rim_vertex *list, size_t count, junctions *found) {
  uint32_t from = scree_half_edge_from(mesh, half), to = scree_half_edge_to(mesh, half);
  vec3 a = vec3_load(mesh->positions + 3 * (size_t)from),
       way = vec3_sub(vec3_load(mesh->positions + 3 * (size_t)to), a);
  double ends[2] = {mesh->positions[3 * (size_t)from + (size_t)axis],
                    mesh->positions[3 * (size_t)to + (size_t)axis]};
  double low = scree_smaller(ends[0], ends[1]) - tolerance,
         high = scree_larger(ends[0], ends[1]) + tolerance, length2 = vec3_norm2(way);
  size_t first = 0, past = count;
  while (first < past) {
    size_t middle = first + (past - first) / 2;
    if (list[middle].at < low)
      first = middle + 1;
    else
      past = middle;
  }
  for (size_t i = first; i < count && list[i].at <= high; i++) {
    uint32_t v = list[i].vertex;
    vec3 p = vec3_sub(vec3_load(mesh->positions + 3 * (size_t)v), a);
    double s = vec3_dot(p, way) / length2;
    if (v == from || v == to || !(s > 0 && s < 1)) continue;
    if (vec3_norm(vec3_mad(p, way, -s)) > tolerance) continue;
    if (!SCREE_PUSH(found, (junction){half, v, s})) return false;
  }
  return true;
}

/* Splits one edge of each facet that has some; `found` is in order. False when memory is out. */
static bool split_facets(scree_mesh *mesh, const junctions *found, size_t *joined) {
  uint32_t *grown =
      scree_resize(mesh->triangles, mesh->triangle_count + found->count, 3 * sizeof *grown);
  if (!grown) return false;
  mesh->triangles = grown;
  uint32_t last = UINT32_MAX; /* facet */
  for (size_t i = 0; i < found->count;) {
    uint32_t half = found->items[i].half, facet = half / 3, next = scree_half_edge_next(half),
             end = grown[next], top = grown[scree_half_edge_previous(half)];
    for (; i < found->count && found->items[i].half == half; i++) {
      if (facet == last) continue; /* in the next pass */
      uint32_t at = found->items[i].vertex;
      bool first = i == 0 || found->items[i - 1].half != half;
      uint32_t *fan = grown + 3 * mesh->triangle_count;
      if (first)
        grown[next] = at;
      else
        fan[-2] = at;
      fan[0] = at, fan[1] = end, fan[2] = top;
      mesh->triangle_count++;
      (*joined)++;
    }
    last = facet;
  }
  return true;
}

static scree_status join_once(scree_mesh *mesh, double tolerance, size_t *joined,
                              scree_error *error) {
  scree_adjacency adjacency;
  rim_vertex *list = NULL;
  size_t count;
  junctions found = {0};
  int axis = longest_axis(mesh);
  scree_status status = scree_adjacency_build(mesh, &adjacency, error);
  if (status != SCREE_OK) return status;
  status = list_rim(mesh, &adjacency, axis, &list, &count, error);
  bool good = status == SCREE_OK;
  for (uint32_t h = 0; good && h < 3 * mesh->triangle_count; h++)
    if (is_rim(&adjacency, h)) good = look_along(mesh, h, axis, tolerance, list, count, &found);
  if (good) {
    scree_free(list);
    if (found.count) qsort(found.items, found.count, sizeof *found.items, by_half);
    good = split_facets(mesh, &found, joined);
  }
  if (!good && status == SCREE_OK)
    status = scree_fail_memory(error, found.count * sizeof *found.items, "a wall's facets");
  scree_free(found.items);
  scree_adjacency_free(&adjacency);
  return status;
}

/* ---- doubles ---- */

typedef struct corners {
  uint32_t sorted[3], facet;
} corners;

static int by_corners(const void *a, const void *b) {
  const corners *x = a, *y = b;
  for (int k = 0; k < 3; k++)
    if (x->sorted[k] != y->sorted[k]) return x->sorted[k] < y->sorted[k] ? -1 : 1;
  return x->facet < y->facet ? -1 : x->facet > y->facet;
}

static corners corners_of(const scree_mesh *mesh, uint32_t facet) {
  corners c = {.facet = facet};
  memcpy(c.sorted, mesh->triangles + 3 * (size_t)facet, sizeof c.sorted);
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2 - i; k++)
      if (c.sorted[k] > c.sorted[k + 1]) {
        uint32_t kept = c.sorted[k];
        c.sorted[k] = c.sorted[k + 1];
        c.sorted[k + 1] = kept;
      }
  return c;
}

static scree_status drop_doubles(scree_mesh *mesh, scree_wall_mending *mending,
                                 scree_error *error) {
  size_t count = mesh->triangle_count;
  corners *all = scree_alloc(count, sizeof *all);
  uint8_t *gone = scree_alloc_zero(count, 1);
  scree_status status = SCREE_OK;
  if (!all || !gone) {
    status = scree_fail_memory(error, count * sizeof *all, "a wall's facets");
  } else {
    for (uint32_t f = 0; f < count; f++) all[f] = corners_of(mesh, f);
    qsort(all, count, sizeof *all, by_corners);
    for (size_t i = 1; i < count; i++)
      if (!memcmp(all[i].sorted, all[i - 1].sorted, sizeof all[i].sorted)) {
        gone[all[i].facet] = 1;
        mending->doubled++;
      }
    scree_soup_drop(mesh, gone);
  }
  scree_free(all);
  scree_free(gone);
  return status;
}

scree_status scree_soup_join(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error) {
  for (int pass = 0; pass < PASSES; pass++) {
    size_t before = mending->joined;
    scree_status status = join_once(mesh, tolerance, &mending->joined, error);
    if (status != SCREE_OK || mending->joined == before) return status;
  }
  return SCREE_OK;
}

scree_status scree_soup_tidy(scree_mesh *mesh, double tolerance, scree_wall_mending *mending,
                             scree_error *error) {
  scree_status status = weld(mesh, tolerance, mending, error);
  if (status == SCREE_OK) status = drop_flat(mesh, tolerance, mending, error);
  if (status == SCREE_OK) status = drop_doubles(mesh, mending, error); /* which have no rims */
  if (status == SCREE_OK) status = scree_soup_join(mesh, tolerance, mending, error);
  return status == SCREE_OK ? drop_doubles(mesh, mending, error) : status;
}
