/* Changes to the mesh under repair. */
#include "base/array.h"
#include "base/radix.h"
#include "mesh/repair/repair.h"

#include <stdlib.h>
#include <string.h>

enum {
  GROWTH = 64, /* times the facets that came in; more, and the rounds run away */
  LEAST_LIMIT = 4096
};

bool scree_repair_add_vertex(scree_repair *r, const double *position, uint32_t *index) {
  scree_mesh *m = &r->mesh;
  double copy[3] = {position[0], position[1], position[2]}; /* may lie in the array that moves */
  void *items = m->positions;
  if (m->vertex_count >= UINT32_MAX - 1) return false;
  bool room =
      scree_array_reserve(&items, &r->vertex_capacity, m->vertex_count + 1, 3 * sizeof(double));
  m->positions = items;
  if (!room) return false;
  memcpy(m->positions + 3 * m->vertex_count, copy, sizeof copy);
  *index = (uint32_t)m->vertex_count++;
  return true;
}

bool scree_repair_reserve(scree_repair *r, size_t more) {
  scree_mesh *m = &r->mesh;
  void *items = m->triangles;
  if (m->triangle_count + more > (UINT32_MAX - 1) / 3) return false;
  bool room = scree_array_reserve(&items, &r->triangle_capacity, m->triangle_count + more,
                                  3 * sizeof(uint32_t));
  m->triangles = items;
  return room;
}

bool scree_repair_add_facet(scree_repair *r, uint32_t a, uint32_t b, uint32_t c) {
  if (!scree_repair_reserve(r, 1)) return false;
  uint32_t *corner = r->mesh.triangles + 3 * r->mesh.triangle_count++;
  corner[0] = a, corner[1] = b, corner[2] = c;
  return true;
}

size_t scree_facets_drop(scree_mesh *m, const bool *marked) {
  size_t kept = 0, before = m->triangle_count;
  for (size_t t = 0; t < before; t++) {
    if (marked[t]) continue;
    if (kept != t) memcpy(m->triangles + 3 * kept, m->triangles + 3 * t, 3 * sizeof(uint32_t));
    kept++;
  }
  m->triangle_count = kept;
  return before - kept;
}

scree_status scree_repair_growth(const scree_repair *r, size_t triangle_count, scree_error *error) {
  size_t limit = r->came_in < LEAST_LIMIT / GROWTH ? LEAST_LIMIT : GROWTH * r->came_in;
  if (triangle_count <= limit) return SCREE_OK;
  return scree_fail(
      error, SCREE_BAD_MESH,
      "the mesh cannot be repaired: each mending asks for more, and its %zu triangles "
      "have become %zu; at most %zu are tried",
      r->came_in, triangle_count, limit);
}

scree_status scree_repair_no_memory(scree_error *error) {
  return scree_fail_memory(error, 0, "the repair");
}

/* ---- Duplicates ---- */

typedef struct corner_key {
  uint32_t low, middle, high, facet;
} corner_key;

SCREE_ORDER_BY4(compare_corner_keys, corner_key, low, middle, high, facet)

static corner_key key_of(const scree_mesh *mesh, size_t t) {
  const uint32_t *c = mesh->triangles + 3 * t;
  uint32_t low = c[0] < c[1] ? c[0] : c[1], high = c[0] < c[1] ? c[1] : c[0], middle = c[2];
  if (middle < low) {
    uint32_t keep = low;
    low = middle, middle = keep;
  } else if (middle > high) {
    uint32_t keep = high;
    high = middle, middle = keep;
  }
  return (corner_key){low, middle, high, (uint32_t)t};
}

scree_status scree_facets_drop_doubles(scree_mesh *mesh, size_t *dropped, scree_error *error) {
  size_t count = mesh->triangle_count;
  SCREE_SCRATCH(corner_key, keys, count, error);
  SCREE_SCRATCH_ZERO(bool, marked, count, error);
  for (size_t t = 0; t < count; t++) keys[t] = key_of(mesh, t);
  qsort(keys, count, sizeof *keys, compare_corner_keys);
  for (size_t i = 1; i < count; i++)
    if (keys[i].low == keys[i - 1].low && keys[i].middle == keys[i - 1].middle &&
        keys[i].high == keys[i - 1].high)
      marked[keys[i].facet] = true;
  *dropped = scree_facets_drop(mesh, marked);
  return SCREE_OK;
}
