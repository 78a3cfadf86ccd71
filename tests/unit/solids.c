/* Meshes of geometry that is described by numbers: closed, wound outwards, of the right volume. */
#include "scene/solids.h"

#include "base/rng.h"
#include "mesh/repair/soup.h"
#include "support/check.h"

static const double pi = 3.14159265358979323846;

static double between(scree_rng *rng, double low, double high) {
  return low + (high - low) * scree_rng_uniform(rng);
}

/* One piece, or `pieces`, closed and clean; the volume of all. */
static double volume_of(scree_mesh *mesh, size_t pieces) {
  scree_error error;
  scree_pieces made;
  double volume = 0;
  CHECK_OK(scree_pieces_make(mesh, &made, &error), error);
  assert_int_equal(made.count, pieces);
  for (size_t i = 0; i < pieces; i++) {
    assert_true(made.items[i].closed);
    assert_true(made.items[i].volume > 0);
    volume += made.items[i].volume;
  }
  const scree_wall_mending *m = &made.mending;
  assert_int_equal(m->welded + m->flat + m->joined + m->doubled + m->parted + m->turned, 0);
  scree_pieces_free(&made);
  scree_mesh_free(mesh);
  return volume;
}

static void sieves(void **state) {
  (void)state;
  scree_rng rng = {.seed = 1};
  for (int i = 0; i < 50; i++) {
    const double pitch = between(&rng, 0.005, 0.02), hole = between(&rng, 0.3, 0.95) * pitch,
                 nx = floor(between(&rng, 1, 12)), ny = floor(between(&rng, 1, 6)),
                 thick = between(&rng, 0.05, 0.5) * pitch;
    const bool bent = i % 2 && nx > 3;
    scree_plan_sieve plan = {.size = {nx * pitch, ny * pitch, thick},
                             .hole = hole,
                             .pitch = pitch,
                             .bend = bent ? 5 * nx * pitch / pi : NAN};
    scree_mesh mesh;
    scree_error error;
    CHECK_OK(scree_sieve_mesh(&plan, &mesh, &error), error);
    const double r = 0.5 * hole / cos(pi / 16), ring = 8 * r * r * sin(pi / 8),
                 flat = nx * ny * thick * (pitch * pitch - ring);
    const double around = bent ? 1 + 0.5 * thick / plan.bend : 1;
    CHECK_NEAR(volume_of(&mesh, 1), flat * around, (bent ? 0.05 : 1e-9) * flat);
  }
}

static void screws(void **state) {
  (void)state;
  scree_rng rng = {.seed = 2};
  for (int i = 0; i < 50; i++) {
    scree_plan_screw plan = {.radius = between(&rng, 0.02, 0.2)};
    plan.shaft = between(&rng, 0.1, 0.7) * plan.radius;
    plan.pitch = between(&rng, 0.5, 2) * plan.radius;
    plan.length = between(&rng, 0.5, 6) * plan.pitch;
    plan.thickness = between(&rng, 0.05, 0.3) * fmin(plan.pitch, plan.length);
    const vec3 axis = scree_rng_direction(&rng);
    vec3_store(plan.axis, axis);
    scree_mesh mesh;
    scree_error error;
    CHECK_OK(scree_screw_mesh(&plan, &mesh, &error), error);
    const double inner = 0.9 * plan.shaft, turns = (plan.length - plan.thickness) / plan.pitch,
                 flight = pi * (plan.radius * plan.radius - inner * inner) * plan.thickness * turns,
                 all = flight + pi * plan.shaft * plan.shaft * plan.length;
    CHECK_NEAR(volume_of(&mesh, 2), all, 0.01 * all); /* of polygons */
  }
}

/* The strip has twice the strand and the circle as its area, and its normals point outwards. */
static void loops(void **state) {
  (void)state;
  scree_rng rng = {.seed = 3};
  for (int i = 0; i < 50; i++) {
    const vec3 axis = scree_rng_direction(&rng);
    vec3 u, w;
    vec3_frame(axis, &u, &w);
    scree_plan_loop plan = {.radius = between(&rng, 0.02, 0.2), .width = between(&rng, 0.1, 1)};
    const vec3 span = vec3_scale(u, between(&rng, 0.01, 2));
    vec3_store(plan.axis, axis);
    vec3_store(plan.span, span);
    scree_mesh mesh;
    scree_error error;
    CHECK_OK(scree_loop_mesh(&plan, &mesh, &error), error);
    double area = 0, within = 0;
    for (size_t t = 0; t < mesh.triangle_count; t++) {
      const vec3 a = scree_mesh_corner(&mesh, t, 0),
                 n = vec3_triangle_normal(a, scree_mesh_corner(&mesh, t, 1),
                                          scree_mesh_corner(&mesh, t, 2));
      area += 0.5 * vec3_norm(n);
      within += 0.5 * vec3_dot(n, a);
    }
    const double length = 2 * vec3_norm(span) + 2 * pi * plan.radius,
                 inside = pi * plan.radius * plan.radius + 2 * plan.radius * vec3_norm(span);
    CHECK_NEAR(area, length * plan.width, 1e-3 * length * plan.width);
    CHECK_NEAR(within, 2 * inside * plan.width, 4e-3 * inside * plan.width);
    scree_mesh_free(&mesh);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sieves), cmocka_unit_test(screws),
                                     cmocka_unit_test(loops)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
