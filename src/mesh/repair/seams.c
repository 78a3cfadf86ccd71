/* Closing what is open only by rounding or by careless drawing: boundary vertices a little apart,
 * vertices lying on boundary edges, facets without area.
 *
 * Seams. Boundary vertices are united in groups linked by steps within a distance that grows from
 * rounding size to the tolerance, tenfold each time. A distance is taken only if it leaves fewer
 * boundary edges, makes no edge of three or more facets and collapses no facet; and no vertex goes
 * farther than a quarter of the shortest boundary edge at it.
 *
 * T-junctions. A boundary edge that other boundary vertices lie on is split there, its facet with
 * it.
 *
 * A facet without area either has its neighbours apart by nothing (a vertex twice: a seam), or has
 * a vertex on its longest edge (a T-junction): dropped, it leaves just that behind. */
#include "base/alloc.h"
#include "mesh/repair/repair.h"
#include "mesh/repair/rim.h"

#include <string.h>

enum {
  SEAM_STEPS = 6,                /* distances tried, the last the tolerance */
  NEAR_LIMIT = 64 * 1024 * 1024, /* comparisons in a sweep, then the stage gives up */
  PASSES = 32,                   /* of T-junctions: a facet has at most one edge split in each */
};

/* A vertex counts as on an edge within this share of the diagonal, and of the edge's length. */
#define ON_EDGE_DIAGONAL 1e-6
#define ON_EDGE_LENGTH   1e-3

scree_status scree_repair_flat(scree_repair *r, scree_error *error) {
  SCREE_SCRATCH(bool, marked, r->mesh.triangle_count, error);
  for (size_t t = 0; t < r->mesh.triangle_count; t++) marked[t] = scree_facet_is_flat(&r->mesh, t);
  r->report.done[SCREE_REPAIR_DROP_DEGENERATE] += scree_facets_drop(&r->mesh, marked);
  return SCREE_OK;
}

static vec3 place(const scree_repair *r, uint32_t v) {
  return vec3_load(r->mesh.positions + 3 * (size_t)v);
}

/* ---- Seams ---- */

/* Joins boundary vertices within the distance; false where none are, or the sweep is too long. */
static bool join_near(const scree_repair *r, const scree_rim *b, double distance,
                      uint32_t *parent) {
  size_t work = 0;
  bool any = false;
  for (size_t i = 0; i < b->vertex_count; i++)
    for (size_t j = i + 1; j < b->vertex_count; j++) {
      if (b->vertices[j].at - b->vertices[i].at > distance) break;
      if (++work > NEAR_LIMIT) return false;
      uint32_t v = b->vertices[i].vertex, w = b->vertices[j].vertex;
      double most = fmin(distance, 0.25 * fmin(b->reach[v], b->reach[w]));
      if (vec3_distance(place(r, v), place(r, w)) > most) continue;
      scree_join(parent, v, w);
      any = true;
    }
  return any;
}

/* The corners as they would be; false where a facet would collapse. */
static bool remap(const scree_repair *r, uint32_t *parent, uint32_t *corners) {
  for (size_t c = 0; c < 3 * r->mesh.triangle_count; c++)
    corners[c] = scree_find_root(parent, r->mesh.triangles[c]);
  for (size_t t = 0; t < r->mesh.triangle_count; t++)
    if (scree_names_twice(corners + 3 * t)) return false;
  return true;
}

/* Looks for the rim anew where the distance is taken. */
static scree_status try_distance(scree_repair *r, scree_rim *b, double distance, uint32_t *corners,
                                 scree_error *error) {
  scree_mesh *m = &r->mesh;
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_SCRATCH(uint32_t, parent, m->vertex_count, error);
  for (size_t v = 0; v < m->vertex_count; v++) parent[v] = (uint32_t)v;
  if (!join_near(r, b, distance, parent) || !remap(r, parent, corners)) return SCREE_OK;
  scree_mesh joined = {m->positions, corners, m->vertex_count, m->triangle_count};
  SCREE_TRY(scree_adjacency_build(&joined, &adjacency, error));
  size_t open, crowded;
  scree_rim_count(&adjacency, &open, &crowded);
  if (open >= b->edge_count || crowded > b->crowded_count) return SCREE_OK;
  memcpy(m->triangles, corners, 3 * m->triangle_count * sizeof *corners);
  r->report.done[SCREE_REPAIR_CLOSE_SEAM] += b->edge_count - open;
  r->report.seam_distance = distance;
  scree_rim_free(b);
  return scree_rim_find(m, b, error);
}

scree_status scree_repair_seams(scree_repair *r, scree_error *error) {
  double tolerance = r->options->seam_tolerance;
  if (tolerance <= 0) return SCREE_OK;
  SCREE_CLEANUP(scree_rim_free) scree_rim b = {0};
  SCREE_SCRATCH(uint32_t, corners, 3 * r->mesh.triangle_count, error);
  SCREE_TRY(scree_rim_find(&r->mesh, &b, error));
  for (int step = 0; step < SEAM_STEPS && b.edge_count; step++) {
    double distance = tolerance * r->diagonal * pow(10, step + 1 - SEAM_STEPS);
    SCREE_TRY(try_distance(r, &b, distance, corners, error));
  }
  return SCREE_OK;
}

/* ---- T-junctions ---- */

static scree_status pass(scree_repair *r, size_t *split_count, scree_error *error) {
  const scree_junction_rule rule = {ON_EDGE_DIAGONAL * r->diagonal, ON_EDGE_LENGTH, NEAR_LIMIT};
  SCREE_CLEANUP(scree_free_at) scree_junctions found = {0};
  SCREE_TRY(scree_junctions_find(&r->mesh, &rule, &found, error));
  SCREE_TRY(scree_repair_growth(r, r->mesh.triangle_count + found.count, error));
  if (!scree_repair_reserve(r, found.count)) return scree_repair_no_memory(error);
  *split_count = scree_junctions_split(&r->mesh, &found);
  return SCREE_OK;
}

scree_status scree_repair_t_junctions(scree_repair *r, scree_error *error) {
  size_t split_count = 1;
  for (int i = 0; i < PASSES && split_count; i++) {
    SCREE_TRY(pass(r, &split_count, error));
    r->report.done[SCREE_REPAIR_SPLIT_T_JUNCTION] += split_count;
  }
  return SCREE_OK;
}
