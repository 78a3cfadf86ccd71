/* Whether points are inside closed surfaces, by a ray, against the winding number by solid angles
 * (van Oosterom and Strackee 1983). */
#include "base/rng.h"
#include "particle/closest.h"
#include "support/check.h"
#include "support/shapes.h"
#include "support/solids.h"

static double winding_number(const scree_particle *particle, vec3 p) {
  double turns = 0;
  for (size_t f = 0; f < particle->face_count; f++) {
    const scree_face *face = &particle->faces[f];
    vec3 a = vec3_sub(face->corner, p), b = vec3_add(a, face->along1),
         c = vec3_add(a, face->along2);
    double na = vec3_norm(a), nb = vec3_norm(b), nc = vec3_norm(c);
    double top = vec3_dot(a, vec3_cross(b, c));
    double bottom = na * nb * nc + vec3_dot(a, b) * nc + vec3_dot(b, c) * na + vec3_dot(c, a) * nb;
    turns += scree_atan2(top, bottom);
  }
  return turns / (2 * 3.14159265358979323846);
}

/* Points that are within rounding of the surface may be either. */
static void check_point(const scree_particle *particle, vec3 p) {
  double turns = winding_number(particle, p);
  if (fabs(turns - 0.5) > 0.4) assert_int_equal(scree_is_inside(particle, p), turns > 0.5);
}

static vec3 random_point(const scree_box *box, scree_rng *rng) {
  vec3 s = vec3_sub(box->high, box->low);
  return (vec3){box->low.x + s.x * scree_rng_uniform(rng),
                box->low.y + s.y * scree_rng_uniform(rng),
                box->low.z + s.z * scree_rng_uniform(rng)};
}

/* A ray from here along the library's passes through a vertex, or an edge, or begins beside them.
 */
static vec3 awkward_point(const scree_particle *particle, scree_rng *rng) {
  const scree_mesh *mesh = &particle->mesh;
  const uint32_t *t = &mesh->triangles[3 * (scree_rng_next(rng) % mesh->triangle_count)];
  vec3 a = vec3_load(&mesh->positions[3 * (size_t)t[0]]),
       b = vec3_load(&mesh->positions[3 * (size_t)t[1]]), along = {0.35355339, 0.21650635, 1};
  double share = scree_rng_next(rng) % 2 ? 0 : scree_rng_uniform(rng),
         way = scree_rng_uniform(rng) * particle->measures.size;
  return vec3_mad(vec3_mad(a, vec3_sub(b, a), share), along, -way);
}

static void the_ray_agrees_with_the_winding_number(void **state) {
  (void)state;
  scree_mesh meshes[] = {shape_box(0.03, 0.02, 0.01),        shape_grid_box(0.02, 0.02, 0.02, 5),
                         shape_icosphere(0.02, 3),           shape_torus(0.02, 0.008, 24, 12),
                         solid_tray(0.05, 0.04, 0.02, 1e-3), solid_hook(0.04, 0.01, 0.01),
                         solid_notch(0.04, 0.4, 0.02)};
  scree_rng rng = {.seed = 5};
  for (size_t i = 0; i < sizeof meshes / sizeof *meshes; i++) {
    scree_particle *particle;
    scree_error error;
    CHECK_OK(scree_particle_from_mesh(&meshes[i], NULL, &particle, &error), error);
    size_t inside = 0;
    for (int k = 0; k < 2000; k++) {
      vec3 p = random_point(&particle->box, &rng);
      check_point(particle, p);
      inside += scree_is_inside(particle, p);
      check_point(particle, awkward_point(particle, &rng));
    }
    assert_true(inside > 20 && inside < 1990);
    scree_particle_free(particle);
    scree_mesh_free(&meshes[i]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_ray_agrees_with_the_winding_number)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
