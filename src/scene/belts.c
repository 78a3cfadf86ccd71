/* The winding of belts: facets that face away from what their loop goes round.
 *
 * What runs are the facets that are less than half a right angle from the axis; joined over their
 * edges they are strips. Around a closed strip the normals N across the axis, weighted by area,
 * cancel, and the sum of N.p is twice the area within times the width: above 0 where they point
 * outwards, wherever the origin of p is. */
#include "scene/walls.h"

#include "base/alloc.h"
#include "mesh/adjacency.h"

static const double flank_cosine = 0.7, closed = 1e-3;

typedef struct strip {
  vec3 sum;
  double area, within;
} strip;

/* The normal across the axis with twice the area as its length; 0 of a flank. */
static vec3 running_normal(const scree_mesh *mesh, size_t facet, vec3 axis) {
  vec3 n = scree_facet_normal(mesh, facet);
  const double along = vec3_dot(n, axis);
  if (fabs(along) > flank_cosine * vec3_norm(n)) return (vec3){0, 0, 0};
  return vec3_mad(n, axis, -along);
}

static void join_strips(const scree_mesh *mesh, const scree_adjacency *adjacency, vec3 axis,
                        uint32_t *strip_of) {
  for (uint32_t h = 0; h < 3 * mesh->triangle_count; h++) {
    const uint32_t next = adjacency->ring[h];
    if (next == SCREE_NO_HALF_EDGE || next == h) continue;
    if (vec3_norm2(running_normal(mesh, h / 3, axis)) > 0 &&
        vec3_norm2(running_normal(mesh, next / 3, axis)) > 0)
      scree_join(strip_of, h / 3, next / 3);
  }
}

static void measure(const scree_mesh *mesh, vec3 axis, uint32_t *strip_of, strip *strips) {
  for (uint32_t t = 0; t < mesh->triangle_count; t++) {
    strip *s = &strips[scree_find_root(strip_of, t)];
    const vec3 n = running_normal(mesh, t, axis);
    s->sum = vec3_add(s->sum, n);
    s->area += vec3_norm(n);
    s->within += vec3_dot(n, scree_mesh_corner(mesh, t, 0));
  }
}

static scree_status refuse(const scree_mesh *mesh, size_t facet, const char *why,
                           scree_error *error) {
  const vec3 p = scree_mesh_corner(mesh, facet, 0);
  return scree_fail(error, SCREE_BAD_MESH, "belt: at (%.6g, %.6g, %.6g) m of the mesh %s", p.x, p.y,
                    p.z, why);
}

/* Winds one piece outwards. */
static scree_status wind(scree_pieces *pieces, size_t index, bool solid, const strip *strips,
                         scree_error *error) {
  const scree_piece *piece = &pieces->items[index];
  size_t outward = 0, inward = 0;
  for (size_t t = piece->first; t < piece->first + piece->count; t++) {
    const strip *s = &strips[t];
    if (!(s->area > 0)) continue;
    if (vec3_norm(s->sum) > closed * s->area)
      return refuse(&pieces->mesh, t,
                    "it is no closed loop about the axis; a belt that is drawn in part takes a "
                    "surface_velocity",
                    error);
    outward += s->within > 0;
    inward += !(s->within > 0);
    if ((outward && inward) || (solid && inward))
      return refuse(&pieces->mesh, t,
                    "the loop has an inner face too, which would run backwards; draw it as a sheet "
                    "without thickness, or filled",
                    error);
  }
  if (inward) scree_piece_turn(pieces, index);
  return SCREE_OK;
}

scree_status scree_scene_wind_belts(const scree_plan_belt *belt, scree_pieces *pieces,
                                    const bool *solid, scree_error *error) {
  const vec3 axis = vec3_unit(vec3_load(belt->axis));
  const size_t count = pieces->mesh.triangle_count;
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_TRY(scree_adjacency_build(&pieces->mesh, &adjacency, error));
  SCREE_SCRATCH(uint32_t, strip_of, count, error);
  SCREE_SCRATCH_ZERO(strip, strips, count, error);
  for (uint32_t t = 0; t < count; t++) strip_of[t] = t;
  join_strips(&pieces->mesh, &adjacency, axis, strip_of);
  measure(&pieces->mesh, axis, strip_of, strips);
  for (size_t i = 0; i < pieces->count; i++) SCREE_TRY(wind(pieces, i, solid[i], strips, error));
  return SCREE_OK;
}
