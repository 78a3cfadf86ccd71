/* Polygons are cut by ear clipping (Meisters 1975, "Polygons have ears") in the coordinate plane
 * that their Newell normal faces most. A convex polygon becomes a fan, a convex quadrilateral two
 * triangles along its shorter diagonal. Where a polygon crosses itself, so that no corner is an
 * ear, the next one is cut off all the same: the count is always right, the surface as good as the
 * file.
 *
 * The worst case is cubic in the corners of one polygon; the steps over all polygons are counted
 * and refused above a limit. */
#include "mesh/io/polygon.h"

#include "base/array.h"
#include "base/vec.h"

#include <string.h>

static const uint64_t step_limit = 4000000000u; /* some ten seconds */

bool scree_face_list_add(scree_face_list *list, const uint32_t *corners, size_t count) {
  if (count < 3) {
    list->lost_count++;
    return true;
  }
  if (count > UINT32_MAX) return false;
  scree_index_list *target = count == 3 ? &list->triangles : &list->polygons;
  if (!SCREE_RESERVE(target, target->count + count + 1)) return false;
  if (count > 3) target->items[target->count++] = (uint32_t)count;
  memcpy(target->items + target->count, corners, count * sizeof *corners);
  target->count += count;
  return true;
}

void scree_face_list_free(scree_face_list *list) {
  scree_free(list->triangles.items);
  scree_free(list->polygons.items);
  *list = (scree_face_list){0};
}

typedef struct point {
  double u, v;
} point;

/* A polygon being cut: a ring of corners, counter-clockwise in the plane. */
typedef struct ring {
  const uint32_t *corners;
  point *points;
  uint32_t *next, *previous;
  bool *convex; /* strictly */
  size_t count, capacity;
  uint64_t steps;
} ring;

static void ring_free(ring *r) {
  SCREE_FREE_ALL(r->points, r->next, r->previous, r->convex);
}

static bool ring_reserve(ring *r, size_t count) {
  if (count <= r->capacity) return true;
  ring_free(r);
  *r = (ring){.steps = r->steps,
              .points = scree_alloc(count, sizeof *r->points),
              .next = scree_alloc(count, sizeof *r->next),
              .previous = scree_alloc(count, sizeof *r->previous),
              .convex = scree_alloc(count, sizeof *r->convex)};
  if (!r->points || !r->next || !r->previous || !r->convex) return false;
  r->capacity = count;
  return true;
}

/* Twice the signed area. */
static double area_of(point a, point b, point c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

static bool corner_is_convex(const ring *r, uint32_t i) {
  return area_of(r->points[r->previous[i]], r->points[i], r->points[r->next[i]]) > 0;
}

/* Newell's normal, relative to the first corner to keep digits far from the origin. */
static vec3 newell_normal(const double *positions, const uint32_t *corners, size_t count) {
  vec3 origin = vec3_load(positions + 3 * (size_t)corners[0]), sum = {0, 0, 0},
       last = vec3_sub(vec3_load(positions + 3 * (size_t)corners[count - 1]), origin);
  for (size_t i = 0; i < count; i++) {
    vec3 p = vec3_sub(vec3_load(positions + 3 * (size_t)corners[i]), origin);
    sum = vec3_add(sum, vec3_cross(last, p));
    last = p;
  }
  return sum;
}

/* Projects the polygon so that it runs counter-clockwise; answers how many corners are not strictly
 * convex. */
static size_t ring_begin(ring *r, const double *positions, const uint32_t *corners, size_t count) {
  vec3 n = newell_normal(positions, corners, count);
  double facing[3] = {n.x, n.y, n.z};
  size_t axis = fabs(n.x) > fabs(n.y) ? 0 : 1;
  if (fabs(n.z) > fabs(facing[axis])) axis = 2;
  size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (facing[axis] < 0) {
    size_t swapped = u;
    u = v;
    v = swapped;
  }
  r->corners = corners;
  r->count = count;
  for (size_t i = 0; i < count; i++) {
    const double *p = positions + 3 * (size_t)corners[i], *o = positions + 3 * (size_t)corners[0];
    r->points[i] = (point){p[u] - o[u], p[v] - o[v]};
    r->next[i] = (uint32_t)(i + 1 < count ? i + 1 : 0);
    r->previous[i] = (uint32_t)(i > 0 ? i - 1 : count - 1);
  }
  size_t not_convex = 0;
  for (uint32_t i = 0; i < count; i++) not_convex += !(r->convex[i] = corner_is_convex(r, i));
  r->steps += count;
  return not_convex;
}

/* An ear is a convex corner whose triangle holds no other corner; those at the same place as one of
 * its three (a hole joined by a double edge) do not count. */
static bool is_ear(ring *r, uint32_t i) {
  if (!r->convex[i]) return false;
  point a = r->points[r->previous[i]], b = r->points[i], c = r->points[r->next[i]];
  for (uint32_t j = r->next[r->next[i]]; j != r->previous[i]; j = r->next[j]) {
    r->steps++;
    point p = r->points[j];
    if (r->convex[j] || area_of(a, b, p) < 0 || area_of(b, c, p) < 0 || area_of(c, a, p) < 0)
      continue;
    if ((p.u == a.u && p.v == a.v) || (p.u == b.u && p.v == b.v) || (p.u == c.u && p.v == c.v))
      continue;
    return false;
  }
  return true;
}

static void put_triangle(const ring *r, scree_index_list *out, size_t a, size_t b, size_t c) {
  uint32_t *t = out->items + out->count;
  t[0] = r->corners[a];
  t[1] = r->corners[b];
  t[2] = r->corners[c];
  out->count += 3;
}

static void put_fan(const ring *r, size_t first, scree_index_list *out) {
  for (size_t i = 1; i + 1 < r->count; i++)
    put_triangle(r, out, first, (first + i) % r->count, (first + i + 1) % r->count);
}

/* Where the fan of a convex polygon starts: at the shorter diagonal of four corners. */
static size_t fan_start(const ring *r, const double *positions) {
  if (r->count != 4) return 0;
  vec3 p[4];
  for (int i = 0; i < 4; i++) p[i] = vec3_load(positions + 3 * (size_t)r->corners[i]);
  return vec3_distance(p[1], p[3]) < vec3_distance(p[0], p[2]);
}

/* Clips ears until three corners are left; false above the limit of steps. */
static bool clip_ears(ring *r, scree_index_list *out) {
  uint32_t i = 0;
  size_t left = r->count, tried = 0;
  while (left > 3) {
    if (r->steps > step_limit) return false;
    r->steps++;
    if (tried < left && !is_ear(r, i)) {
      i = r->next[i];
      tried++;
      continue;
    }
    uint32_t before = r->previous[i], after = r->next[i];
    put_triangle(r, out, before, i, after);
    r->next[before] = after;
    r->previous[after] = before;
    r->convex[before] = corner_is_convex(r, before);
    r->convex[after] = corner_is_convex(r, after);
    left--;
    tried = 0;
    i = after;
  }
  put_triangle(r, out, r->previous[i], i, r->next[i]);
  return true;
}

scree_status scree_face_list_triangulate(scree_face_list *list, const double *positions,
                                         const char *name, scree_error *error) {
  const scree_index_list *polygons = &list->polygons;
  size_t triangle_count = 0, most = 0;
  for (size_t at = 0; at < polygons->count; at += 1 + (size_t)polygons->items[at]) {
    size_t count = polygons->items[at];
    triangle_count += count - 2;
    if (count > most) most = count;
  }
  if (most < 4) return SCREE_OK;
  scree_index_list *out = &list->triangles;
  SCREE_CLEANUP(ring_free) ring r = {0};
  if (!SCREE_RESERVE(out, out->count + 3 * triangle_count) || !ring_reserve(&r, most))
    return scree_fail_memory(error, 3 * triangle_count * sizeof *out->items,
                             "the triangles of polygons");
  for (size_t at = 0; at < polygons->count;) {
    size_t count = polygons->items[at];
    if (ring_begin(&r, positions, polygons->items + at + 1, count) == 0)
      put_fan(&r, fan_start(&r, positions), out);
    else if (!clip_ears(&r, out))
      return scree_fail(error, SCREE_LIMIT,
                        "%s: its polygons (of up to %zu corners) are too intricate to be cut "
                        "into triangles in %llu steps",
                        name, most, (unsigned long long)step_limit);
    at += 1 + count;
  }
  return SCREE_OK;
}
