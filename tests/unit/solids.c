/* Meshes of geometry that is described by numbers: closed, wound outwards, of the right volume. */
#include "scene/geometry/kind.h"

#include "base/rng.h"
#include "mesh/repair/soup.h"
#include "support/check.h"

#include <stdarg.h>

static const double pi = 3.14159265358979323846;

static double between(scree_rng *rng, double low, double high) {
  return low + (high - low) * scree_rng_uniform(rng);
}

/* Of geometry as a scene's file has it. */
SCREE_PRINTF(2, 3)
static scree_mesh mesh_of(const scree_geometry_kind *kind, const char *format, ...) {
  char text[300];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  scree_arena arena = {0};
  scree_error error;
  scree_yaml root;
  scree_plan_geometry geometry;
  const scree_reader reader = {"test", &arena, &error, ""};
  scree_mesh mesh;
  CHECK_OK(scree_yaml_parse(text, strlen(text), "test", &root, &error), error);
  CHECK_OK(scree_record_read(&reader, &root, &scree_plan_geometry_record, &geometry), error);
  CHECK_OK(kind->mesh(&geometry, &mesh, &error), error);
  scree_yaml_free(&root);
  scree_arena_free(&arena);
  return mesh;
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
    const double bend = 5 * nx * pitch / pi;
    char bending[60] = "";
    if (bent) snprintf(bending, sizeof bending, ", bend: %.17g", bend);
    scree_mesh mesh = mesh_of(&scree_geometry_sieve,
                              "sieve: {size: [%.17g, %.17g, %.17g], hole: %.17g, pitch: %.17g%s}",
                              nx * pitch, ny * pitch, thick, hole, pitch, bending);
    const double r = 0.5 * hole / cos(pi / 16), ring = 8 * r * r * sin(pi / 8),
                 flat = nx * ny * thick * (pitch * pitch - ring);
    const double around = bent ? 1 + 0.5 * thick / bend : 1;
    CHECK_NEAR(volume_of(&mesh, 1), flat * around, (bent ? 0.05 : 1e-9) * flat);
  }
}

static void screws(void **state) {
  (void)state;
  scree_rng rng = {.seed = 2};
  for (int i = 0; i < 50; i++) {
    const double radius = between(&rng, 0.02, 0.2), shaft = between(&rng, 0.1, 0.7) * radius,
                 pitch = between(&rng, 0.5, 2) * radius, length = between(&rng, 0.5, 6) * pitch,
                 thickness = between(&rng, 0.05, 0.3) * fmin(pitch, length);
    const vec3 axis = scree_rng_direction(&rng);
    scree_mesh mesh = mesh_of(&scree_geometry_screw,
                              "screw: {axis: [%.17g, %.17g, %.17g], radius: %.17g, shaft: %.17g, "
                              "pitch: %.17g, length: %.17g, thickness: %.17g}",
                              axis.x, axis.y, axis.z, radius, shaft, pitch, length, thickness);
    const double inner = 0.9 * shaft, turns = (length - thickness) / pitch,
                 flight = pi * (radius * radius - inner * inner) * thickness * turns,
                 all = flight + pi * shaft * shaft * length;
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
    const double radius = between(&rng, 0.02, 0.2), width = between(&rng, 0.1, 1);
    const vec3 span = vec3_scale(u, between(&rng, 0.01, 2));
    scree_mesh mesh = mesh_of(&scree_geometry_loop,
                              "loop: {axis: [%.17g, %.17g, %.17g], span: [%.17g, %.17g, %.17g], "
                              "radius: %.17g, width: %.17g}",
                              axis.x, axis.y, axis.z, span.x, span.y, span.z, radius, width);
    double area = 0, within = 0;
    for (size_t t = 0; t < mesh.triangle_count; t++) {
      const vec3 a = scree_mesh_corner(&mesh, t, 0),
                 n = vec3_triangle_normal(a, scree_mesh_corner(&mesh, t, 1),
                                          scree_mesh_corner(&mesh, t, 2));
      area += 0.5 * vec3_norm(n);
      within += 0.5 * vec3_dot(n, a);
    }
    const double length = 2 * vec3_norm(span) + 2 * pi * radius,
                 inside = pi * radius * radius + 2 * radius * vec3_norm(span);
    CHECK_NEAR(area, length * width, 1e-3 * length * width);
    CHECK_NEAR(within, 2 * inside * width, 4e-3 * inside * width);
    scree_mesh_free(&mesh);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sieves), cmocka_unit_test(screws),
                                     cmocka_unit_test(loops)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
