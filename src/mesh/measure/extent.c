/* The width along d is max d.x - min d.x over the body, the sum of its support function at d and
 * -d. It is well posed: where no point of either surface is farther than h from the other, no width
 * differs by more than 2 h. The sides of a least box are not, for its axes turn on round bodies.
 *
 * Directions are the nodes of an octahedron whose edges are cut in SCREE_EXTENT_STEPS, of each pair
 * of opposite ones one: at most 9 degrees from any other direction. */
#include "mesh/measure/extent.h"

#include "base/lanes.h"

#include <math.h>
#include <stdlib.h>

/* Whether the node stands for itself and its opposite: its last coordinate that is not 0 is above
 * 0, and it is no axis, which come first. */
static bool is_kept(int i, int j, int k) {
  enum { N = SCREE_EXTENT_STEPS };
  if (abs(i) + abs(j) + k != N || abs(i) == N || abs(j) == N || k == N) return false;
  return k > 0 || j > 0;
}

static void set_direction(scree_extent *extent, size_t i, vec3 d) {
  extent->x[i] = d.x;
  extent->y[i] = d.y;
  extent->z[i] = d.z;
}

void scree_extent_start(scree_extent *extent, const double frame[3][3]) {
  enum { N = SCREE_EXTENT_STEPS };
  vec3 axes[3] = {vec3_load(frame[0]), vec3_load(frame[1]), vec3_load(frame[2])};
  size_t count = 3;
  for (size_t i = 0; i < 3; i++) set_direction(extent, i, axes[i]);
  for (int i = -N; i <= N; i++)
    for (int j = -N; j <= N; j++)
      for (int k = 0; k <= N; k++)
        if (is_kept(i, j, k))
          set_direction(
              extent, count++,
              vec3_unit(vec3_mad(vec3_mad(vec3_scale(axes[0], i), axes[1], j), axes[2], k)));
  for (size_t i = 0; i < SCREE_EXTENT_COUNT; i++)
    extent->low[i] = INFINITY, extent->high[i] = -INFINITY;
}

SCREE_LANES static void widen_extent(scree_extent *extent, vec3 p) {
  for (int i = 0; i < SCREE_EXTENT_COUNT; i++) {
    double along = scree_extent_along(extent, i, p);
    extent->low[i] = along < extent->low[i] ? along : extent->low[i];
    extent->high[i] = along > extent->high[i] ? along : extent->high[i];
  }
}

void scree_extent_add(scree_extent *extent, vec3 p) {
  widen_extent(extent, p);
}

void scree_extent_of_mesh(scree_extent *extent, const double frame[3][3], const scree_mesh *mesh) {
  scree_extent_start(extent, frame);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
    scree_extent_add(extent, vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[c]));
}

int scree_extent_end(const scree_extent *extent, vec3 p) {
  int end = 0;
  double least = INFINITY;
  for (int i = 0; i < SCREE_EXTENT_COUNT; i++) {
    double along = scree_extent_along(extent, i, p), width = scree_extent_width(extent, i),
           above = extent->high[i] - along, below = along - extent->low[i];
    if (above < least * width) least = above / width, end = i;
    if (below < least * width) least = below / width, end = ~i;
  }
  return end;
}

SCREE_LANES static bool is_beyond_extent(const scree_extent *extent, vec3 p) {
  long long beyond = 0;
  for (int i = 0; i < SCREE_EXTENT_COUNT; i++) {
    double along = scree_extent_along(extent, i, p);
    beyond |= (along > extent->high[i]) | (along < extent->low[i]);
  }
  return beyond;
}

double scree_extent_beyond(const scree_extent *extent, vec3 p, double size) {
  double most = 0;
  if (!is_beyond_extent(extent, p)) return 0;
  for (int i = 0; i < SCREE_EXTENT_COUNT; i++) {
    double along = scree_extent_along(extent, i, p), above = along - extent->high[i],
           below = extent->low[i] - along, beyond = above > below ? above : below;
    if (beyond <= 0) continue;
    most = fmax(most, beyond * fmax(1, size / scree_extent_width(extent, i)));
  }
  return most;
}
