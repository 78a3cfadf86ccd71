/* The core of a shape: its surface moved inwards, so that rounded again it stands out by less.
 *
 * A vertex moves to where the planes of its faces, each moved inwards, meet: the least squares
 * solution of n.x = -s over its faces, weighted by angles; of least length where they leave a
 * direction free. So faces stay flat and edges straight. */
#include "particle/particle.h"

#include "base/alloc.h"
#include "base/eigen.h"
#include "mesh/mesh.h"

static const double least_share = 1e-6;   /* of the planes' squares: less is no direction */
static const double longest = 2;          /* of s: sharp tips recede by no more */
static const double least_cosine = 0.999; /* faces keep their normals within 2.6 degrees */
enum { HALVINGS = 4 };

typedef struct vertex_planes {
  mat3 squares; /* sum of w n n^T */
  vec3 normals; /* sum of w n */
} vertex_planes;

static vec3 vertex_of(const double *positions, uint32_t v) {
  return vec3_load(&positions[3 * (size_t)v]);
}

static void add_plane(vertex_planes *v, vec3 n, double weight) {
  const double c[3] = {n.x, n.y, n.z};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) v->squares.m[i][j] += weight * c[i] * c[j];
  v->normals = vec3_mad(v->normals, n, weight);
}

static void add_planes(const scree_particle *p, vertex_planes *vertices) {
  const scree_mesh *mesh = &p->mesh;
  for (size_t f = 0; f < mesh->triangle_count; f++)
    for (int c = 0; c < 3; c++) {
      const uint32_t *t = &mesh->triangles[3 * f];
      vec3 at = vertex_of(mesh->positions, t[c]),
           u = vec3_sub(vertex_of(mesh->positions, t[(c + 1) % 3]), at),
           v = vec3_sub(vertex_of(mesh->positions, t[(c + 2) % 3]), at);
      double angle = scree_atan2(vec3_norm(vec3_cross(u, v)), vec3_dot(u, v));
      add_plane(&vertices[t[c]], p->faces[f].normal, angle);
    }
}

/* Outwards, for s = 1. */
static vec3 offset_of(const vertex_planes *v) {
  double values[3];
  mat3 axes;
  scree_eigen_symmetric(&v->squares, values, &axes);
  vec3 x = {0, 0, 0};
  for (int k = 0; k < 3; k++) {
    if (!(values[k] > least_share * values[2])) continue;
    vec3 axis = {axes.m[k][0], axes.m[k][1], axes.m[k][2]};
    x = vec3_mad(x, axis, vec3_dot(axis, v->normals) / values[k]);
  }
  double length = vec3_norm(x);
  return length > longest ? vec3_scale(x, longest / length) : x;
}

static bool faces_keep_their_normals(const scree_particle *p, const double *moved) {
  for (size_t f = 0; f < p->mesh.triangle_count; f++) {
    const uint32_t *t = &p->mesh.triangles[3 * f];
    vec3 at = vertex_of(moved, t[0]),
         n = vec3_cross(vec3_sub(vertex_of(moved, t[1]), at), vec3_sub(vertex_of(moved, t[2]), at));
    if (!(vec3_dot(n, p->faces[f].normal) > least_cosine * vec3_norm(n))) return false;
  }
  return true;
}

scree_status scree_particle_make_core(scree_particle *p, double by, scree_error *error) {
  const scree_mesh *mesh = &p->mesh;
  SCREE_SCRATCH_ZERO(vertex_planes, vertices, mesh->vertex_count, error);
  SCREE_SCRATCH(double, moved, 3 * mesh->vertex_count, error);
  add_planes(p, vertices);
  for (size_t v = 0; v < mesh->vertex_count; v++) vertices[v].normals = offset_of(&vertices[v]);
  for (int k = 0; k <= HALVINGS; k++, by *= 0.5) {
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      vec3 at = vertex_of(mesh->positions, (uint32_t)v);
      vec3_store(&moved[3 * v], vec3_mad(at, vertices[v].normals, -by));
    }
    if (!faces_keep_their_normals(p, moved)) continue;
    p->core = moved;
    moved = NULL;
    break;
  }
  return SCREE_OK;
}
