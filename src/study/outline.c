/* The highest point of a triangle at x lies on one of its edges: edges that cross x are enough. */
#include "study/outline.h"

#include "base/vec.h"

#include <math.h>

static double mesh_height(const scree_mesh *mesh, const scree_body *body, double x) {
  const double *q = body->orientation;
  mat3 turn = quat_to_mat3((quat){q[0], q[1], q[2], q[3]});
  double best = -INFINITY;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 p[3];
    for (size_t k = 0; k < 3; k++) {
      vec3 local = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + k]);
      p[k] = vec3_add(mat3_mul_vec(&turn, local), vec3_load(body->position));
    }
    for (size_t k = 0; k < 3; k++) {
      vec3 a = p[k], b = p[(k + 1) % 3];
      if (fmin(a.x, b.x) > x || fmax(a.x, b.x) < x) continue;
      double part = a.x == b.x ? 0 : (x - a.x) / (b.x - a.x);
      best = fmax(best, fmax(a.z + part * (b.z - a.z), a.x == b.x ? b.z : -INFINITY));
    }
  }
  return best;
}

static double spheres_height(scree_particle *particle, size_t count, const scree_body *body,
                             double x) {
  const double *q = body->orientation;
  mat3 turn = quat_to_mat3((quat){q[0], q[1], q[2], q[3]});
  double best = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    double local[3], radius;
    scree_particle_point(particle, i, local, &radius);
    vec3 centre = vec3_add(mat3_mul_vec(&turn, vec3_load(local)), vec3_load(body->position));
    double left = radius * radius - (x - centre.x) * (x - centre.x);
    if (left >= 0) best = fmax(best, centre.z + sqrt(left));
  }
  return best;
}

double scree_outline_height(const scree_world *world, double x) {
  double best = -INFINITY;
  for (size_t b = 0; b < scree_world_body_count(world); b++) {
    scree_body body;
    scree_particle_measures m;
    if (scree_world_body_removed(world, b)) continue;
    scree_particle *particle = scree_world_body_particle(world, b);
    scree_world_get_body(world, b, &body);
    scree_particle_measure(particle, &m);
    if (fabs(body.position[0] - x) > m.bounding_radius) continue;
    best = fmax(best, m.kind == SCREE_PARTICLE_MESH
                          ? mesh_height(scree_particle_mesh(particle), &body, x)
                          : spheres_height(particle, m.point_count, &body, x));
  }
  return best > -INFINITY ? best : 0;
}
