#include "mesh/repair/searched.h"
#include "base/alloc.h"
#include "mesh/repair/repair.h"

#include <math.h>

void scree_searched_free(scree_searched *searched) {
  scree_mesh_free(&searched->mesh);
  scree_free(searched->met);
  *searched = (scree_searched){.met = NULL};
}

/* ---- Canonical order ---- */

static bool is_before(const double *a, const double *b) {
  for (int k = 0; k < 3; k++)
    if (a[k] != b[k]) return a[k] < b[k];
  return false;
}

/* Whether vertices are distinct and sorted, no zero is negative, no coordinate is bad. */
static bool vertices_are_canonical(const scree_mesh *mesh) {
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    const double *p = mesh->positions + 3 * v;
    if (scree_vertex_is_bad(p) || (v && !is_before(p - 3, p))) return false;
    for (int k = 0; k < 3; k++)
      if (p[k] == 0 && signbit(p[k])) return false;
  }
  return true;
}

static int compare_corners(const uint32_t *a, const uint32_t *b) {
  for (int k = 0; k < 3; k++)
    if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
  return 0;
}

static bool triangles_are_canonical(const scree_mesh *mesh) {
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const uint32_t *c = mesh->triangles + 3 * t, *before = t ? c - 3 : c;
    if (c[1] <= c[0] || c[2] <= c[0] || c[1] == c[2]) return false;
    if (t && compare_corners(c, before) < 0) return false;
  }
  return true;
}

bool scree_is_canonical(const scree_mesh *mesh) {
  return vertices_are_canonical(mesh) && triangles_are_canonical(mesh);
}

/* ---- Which facets were there ---- */

#define GONE UINT32_MAX

/* By vertex, which of the old ones it is, or GONE. Both are sorted. */
static void match_vertices(const scree_mesh *old, const scree_mesh *mesh, uint32_t *match) {
  for (size_t v = 0, o = 0; v < mesh->vertex_count; v++) {
    const double *p = mesh->positions + 3 * v;
    while (o < old->vertex_count && is_before(old->positions + 3 * o, p)) o++;
    bool same = o < old->vertex_count && !is_before(p, old->positions + 3 * o);
    match[v] = same ? (uint32_t)o : GONE;
  }
}

scree_status scree_searched_settled(const scree_searched *searched, const scree_mesh *mesh,
                                    bool *settled, bool *known, scree_error *error) {
  const scree_mesh *old = &searched->mesh;
  *known = searched->met && scree_is_canonical(mesh);
  if (!*known) return SCREE_OK;
  SCREE_SCRATCH(uint32_t, match, mesh->vertex_count, error);
  match_vertices(old, mesh, match);
  for (size_t t = 0, o = 0; t < mesh->triangle_count; t++) {
    const uint32_t *c = mesh->triangles + 3 * t, was[3] = {match[c[0]], match[c[1]], match[c[2]]};
    settled[t] = false;
    if (was[0] == GONE || was[1] == GONE || was[2] == GONE) continue;
    while (o < old->triangle_count && compare_corners(old->triangles + 3 * o, was) < 0) o++;
    settled[t] = o < old->triangle_count && !searched->met[o] &&
                 compare_corners(old->triangles + 3 * o, was) == 0;
  }
  return SCREE_OK;
}

/* Keeps a copy of the mesh, of which all pairs that meet are found. */
static scree_status learn(scree_searched *searched, const scree_mesh *mesh,
                          const scree_meetings *found, scree_error *error) {
  scree_searched_free(searched);
  if (found->truncated || !scree_is_canonical(mesh)) return SCREE_OK;
  SCREE_TRY(scree_mesh_copy(mesh, &searched->mesh, error));
  SCREE_TRY_ALLOC_ZERO(searched->met, mesh->triangle_count, error);
  for (size_t i = 0; i < found->count; i++)
    searched->met[found->items[i].first] = searched->met[found->items[i].second] = true;
  return SCREE_OK;
}

scree_status scree_searched_meetings(scree_searched *searched, const scree_mesh *mesh,
                                     scree_facet_tree *tree, size_t limit,
                                     const scree_progress *progress, scree_meetings *found,
                                     scree_error *error) {
  SCREE_SCRATCH(bool, settled, mesh->triangle_count, error);
  bool known = false;
  if (searched) SCREE_TRY(scree_searched_settled(searched, mesh, settled, &known, error));
  if (known || !tree) {
    SCREE_TRY(scree_mesh_meetings(mesh, known ? settled : NULL, limit, progress, found, error));
  } else {
    if (!tree->mesh) SCREE_TRY(scree_facet_tree_build(mesh, tree, error));
    SCREE_TRY(scree_facet_meetings(tree, limit, progress, found, error));
  }
  return searched ? learn(searched, mesh, found, error) : SCREE_OK;
}
