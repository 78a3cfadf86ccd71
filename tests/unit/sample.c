/* The built-in samples: what every one of them promises, at reduced resolution; the distance fields
 * they are made of; the test solids against closed forms. */
#include "sample/device.h"
#include "sample/test_solid.h"

#include "base/file.h"
#include "base/rng.h"
#include "mesh/adjacency.h"
#include "scree.h"
#include "support/alloc_fail.h"
#include "support/check.h"

static const double pi = 3.14159265358979323846;

static scree_mesh make(const char *name, double resolution_mm, double noise_mm, uint64_t seed) {
  scree_sample_options options = {resolution_mm * 1e-3, noise_mm * 1e-3, seed};
  scree_error error;
  scree_mesh mesh;
  CHECK_OK(scree_sample_make(name, &options, NULL, &mesh, &error), error);
  return mesh;
}

static scree_checksum checksum(const scree_mesh *mesh) {
  scree_checksum of_positions =
      scree_checksum_of(mesh->positions, 3 * mesh->vertex_count * sizeof *mesh->positions);
  scree_checksum of_triangles =
      scree_checksum_of(mesh->triangles, 3 * mesh->triangle_count * sizeof *mesh->triangles);
  return (scree_checksum){of_positions.high ^ of_triangles.high, of_positions.low};
}

/* ---- Every device ---- */

static void devices_are_fit_for_particles(void **state) {
  (void)state;
  static const double resolutions_mm[] = {1.2, 2, 4};
  for (size_t i = 0; i < SCREE_SAMPLE_DEVICES; i++)
    for (int r = 0; r < 3; r++) {
      const char *name = scree_sample_name(i);
      scree_mesh mesh = make(name, resolutions_mm[r], r == 1 ? 0 : 0.02, 1);
      scree_check check;
      scree_error error;
      CHECK_OK(scree_mesh_check(&mesh, NULL, NULL, &check, &error), error);
      if (!check.usable || check.defects[SCREE_DEFECT_UNUSED_VERTEX] != 0) {
        print_error("%s at %g mm: %s\n", name, resolutions_mm[r], check.verdict);
        fail();
      }
      assert_true(check.volume > 0);
      scree_mesh_free(&mesh);
    }
}

/* The cosine between facets that share an edge, at worst. */
static double worst_fold(const scree_mesh *mesh) {
  double worst = 1;
  scree_adjacency adjacency;
  scree_error error;
  CHECK_OK(scree_adjacency_build(mesh, &adjacency, &error), error);
  for (uint32_t h = 0; h < 3 * mesh->triangle_count; h++) {
    vec3 n[2];
    for (int side = 0; side < 2; side++) {
      const uint32_t *corner = mesh->triangles + 3 * ((side ? adjacency.ring[h] : h) / 3);
      n[side] = vec3_unit(vec3_triangle_normal(vec3_load(mesh->positions + 3 * corner[0]),
                                               vec3_load(mesh->positions + 3 * corner[1]),
                                               vec3_load(mesh->positions + 3 * corner[2])));
    }
    if (vec3_dot(n[0], n[1]) < worst) worst = vec3_dot(n[0], n[1]);
  }
  scree_adjacency_free(&adjacency);
  return worst;
}

static void devices_are_one_body_without_folds(void **state) {
  (void)state;
  /* Euler's number: strap eyes are handles, and so is the clamshell's slit beside its hinge. */
  static const int euler[SCREE_SAMPLE_DEVICES] = {0, 2, 2, 0, -2, -2, 2, 2, 2};
  for (size_t i = 0; i < SCREE_SAMPLE_DEVICES; i++) {
    scree_mesh mesh = make(scree_sample_name(i), 0.5, 0.03, 3);
    scree_topology topology;
    scree_error error;
    CHECK_OK(scree_mesh_topology(&mesh, &topology, &error), error);
    assert_int_equal(topology.shell_count, 1);
    assert_int_equal((int)mesh.vertex_count - (int)topology.edge_count + (int)mesh.triangle_count,
                     euler[i]);
    assert_true(worst_fold(&mesh) >= -0.866); /* 150 degrees */
    scree_mesh_free(&mesh);
  }
}

static void names_have_descriptions(void **state) {
  (void)state;
  assert_true(scree_sample_count() >= SCREE_SAMPLE_DEVICES + 3);
  for (size_t i = 0; i < scree_sample_count(); i++) {
    assert_true(strlen(scree_sample_name(i)) >= 3);
    assert_true(strlen(scree_sample_description(i)) >= 10);
  }
  assert_null(scree_sample_name(scree_sample_count()));
  assert_null(scree_sample_description(scree_sample_count()));
}

static void same_bits_for_any_threads(void **state) {
  (void)state;
  scree_checksum first = {0, 0};
  for (int threads = 1; threads <= 3; threads++) {
    scree_set_threads(threads);
    scree_mesh mesh = make("dc-2", 1.6, 0.02, 7);
    scree_checksum sum = checksum(&mesh);
    if (threads == 1) first = sum;
    assert_int_equal(sum.high, first.high);
    assert_int_equal(sum.low, first.low);
    scree_mesh_free(&mesh);
  }
  scree_set_threads(0);
}

static void seeds_change_the_noise_only(void **state) {
  (void)state;
  scree_mesh clean = make("fp-2", 1.5, 0, 1), clean_too = make("fp-2", 1.5, 0, 2),
             one = make("fp-2", 1.5, 0.02, 1), two = make("fp-2", 1.5, 0.02, 2);
  assert_int_equal(checksum(&clean).low, checksum(&clean_too).low);
  assert_true(checksum(&one).low != checksum(&two).low);
  assert_int_equal(one.vertex_count, clean.vertex_count);
  assert_memory_equal(one.triangles, clean.triangles, 12 * clean.triangle_count);
  double sum = 0;
  for (size_t v = 0; v < 3 * clean.vertex_count; v++) {
    double d = one.positions[v] - clean.positions[v];
    assert_true(fabs(d) < 8 * 0.02e-3);
    sum += d * d;
  }
  double rms = sqrt(sum / (double)clean.vertex_count);
  assert_true(rms > 0.018e-3 && rms < 0.035e-3);
  scree_mesh_free(&clean);
  scree_mesh_free(&clean_too);
  scree_mesh_free(&one);
  scree_mesh_free(&two);
}

/* ---- Closed forms ---- */

static void sphere_converges(void **state) {
  (void)state;
  const double radius = 25e-3, exact_area = 4 * pi * radius * radius,
               exact_volume = exact_area * radius / 3;
  double before_area = 0, before_volume = 0;
  for (int i = 0; i < 4; i++) {
    scree_mesh mesh = make("sphere", 4.5 / (1 << i), 0.02, 1);
    double area, volume;
    scree_error error;
    CHECK_OK(scree_mesh_area_volume(&mesh, &area, &volume, &error), error);
    for (size_t v = 0; v < mesh.vertex_count; v++)
      CHECK_NEAR(vec3_norm(vec3_load(mesh.positions + 3 * v)), radius, 1e-7 * radius);
    double area_error = 1 - area / exact_area, volume_error = 1 - volume / exact_volume;
    assert_true(area_error > 0 && volume_error > 0);
    if (i) { /* halving the spacing quarters both */
      CHECK_NEAR(before_area / area_error, 4, 0.5);
      CHECK_NEAR(before_volume / volume_error, 4, 0.5);
    }
    before_area = area_error;
    before_volume = volume_error;
    scree_mesh_free(&mesh);
  }
}

static void check_solid(const char *name, const scree_mesh *mesh, double area, double volume,
                        double tolerance) {
  double got_area, got_volume;
  scree_error error;
  scree_check check;
  CHECK_OK(scree_mesh_area_volume(mesh, &got_area, &got_volume, &error), error);
  CHECK_NEAR(got_area / area, 1, tolerance);
  CHECK_NEAR(got_volume / volume, 1, tolerance);
  CHECK_OK(scree_mesh_check(mesh, NULL, NULL, &check, &error), error);
  if (!check.usable) print_error("%s: %s\n", name, check.verdict);
  assert_true(check.usable);
  assert_int_equal(check.defects[SCREE_DEFECT_UNUSED_VERTEX], 0);
}

static void boxes_are_exact(void **state) {
  (void)state;
  const double edge = 69.12e-3;
  scree_mesh mesh = make("box-12", 0.27, 0.02, 1);
  assert_int_equal(mesh.triangle_count, 12);
  assert_int_equal(mesh.vertex_count, 8);
  check_solid("box-12", &mesh, 6 * edge * edge, edge * edge * edge, 1e-14);
  scree_mesh_free(&mesh);
  for (size_t cells = 1; cells < 20; cells++) {
    scree_error error;
    CHECK_OK(scree_sample_box(edge, cells, &mesh, &error), error);
    assert_int_equal(mesh.triangle_count, 12 * cells * cells);
    check_solid("box", &mesh, 6 * edge * edge, edge * edge * edge, 1e-13);
    scree_mesh_free(&mesh);
  }
  mesh = make("box", 0.27, 0.02, 1);
  assert_int_equal(mesh.triangle_count, 786432);
  scree_mesh_free(&mesh);
}

static void icospheres_converge(void **state) {
  (void)state;
  const double radius = 25e-3, area = 4 * pi * radius * radius;
  for (int level = 0; level <= 6; level++) {
    char name[32];
    snprintf(name, sizeof name, "icosphere-%d", level);
    scree_mesh mesh = make(name, 0.27, 0.02, 1);
    assert_int_equal(mesh.triangle_count, (size_t)20 << (2 * level));
    assert_int_equal(mesh.vertex_count, mesh.triangle_count / 2 + 2);
    check_solid(name, &mesh, area, area * radius / 3, 0.56 / (double)(1 << (2 * level)));
    scree_mesh_free(&mesh);
  }
  scree_mesh mesh = make("icosphere", 1, 0, 1);
  double length = 0;
  for (size_t t = 0; t < mesh.triangle_count; t++)
    length += vec3_distance(vec3_load(mesh.positions + 3 * mesh.triangles[3 * t]),
                            vec3_load(mesh.positions + 3 * mesh.triangles[3 * t + 1]));
  length /= (double)mesh.triangle_count;
  assert_true(length <= 1e-3 && length > 0.5e-3);
  scree_mesh_free(&mesh);
}

/* ---- Distance fields ---- */

static const scree_device *device_at(size_t i) {
  return i < 3   ? &scree_feature_phones[i]
         : i < 6 ? &scree_cameras[i - 3]
                 : &scree_smartphones[i - 6];
}

static vec3 random_point(scree_rng *rng, const scree_shape *shape) {
  vec3 size = vec3_sub(shape->high, shape->low);
  return (vec3){shape->low.x + size.x * (1.1 * scree_rng_uniform(rng) - 0.05),
                shape->low.y + size.y * (1.1 * scree_rng_uniform(rng) - 0.05),
                shape->low.z + size.z * (1.1 * scree_rng_uniform(rng) - 0.05)};
}

static void fill_around(scree_rng *rng, vec3 centre, double radius, size_t count,
                        scree_points *points) {
  for (size_t i = 0; i < count; i++) {
    vec3 p = vec3_mad(centre, scree_rng_direction(rng), radius * scree_rng_uniform(rng));
    points->x[i] = p.x;
    points->y[i] = p.y;
    points->z[i] = p.z;
  }
}

static vec3 point_at(const scree_points *points, size_t i) {
  return (vec3){points->x[i], points->y[i], points->z[i]};
}

/* No field grows faster than the distance, and pruning changes none where it is small. */
static void fields_are_bounds_and_prune_safely(void **state) {
  (void)state;
  enum { CENTRES = 400, POINTS = 24 };
  const double radius = 2e-3, band = 0.5e-3;
  scree_shape *shape = malloc(sizeof *shape);
  scree_rng rng = {11, 0, 0};
  assert_non_null(shape);
  for (size_t d = 0; d < SCREE_SAMPLE_DEVICES; d++) {
    assert_true(scree_shape_build(device_at(d)->lines, device_at(d)->line_count, shape));
    scree_shape_list all, pruned;
    scree_shape_list_all(shape, &all);
    size_t kept = 0;
    for (int c = 0; c < CENTRES; c++) {
      scree_points points;
      double whole[POINTS], part[POINTS];
      vec3 centre = random_point(&rng, shape);
      fill_around(&rng, centre, radius, POINTS, &points);
      scree_shape_distance(shape, &all, &points, POINTS, whole);
      scree_shape_prune(shape, centre, radius, band, &pruned);
      scree_shape_distance(shape, &pruned, &points, POINTS, part);
      kept += pruned.count;
      for (size_t i = 0; i < POINTS; i++) {
        assert_int_equal(whole[i] < 0, part[i] < 0);
        if (fabs(whole[i]) < band) assert_true(whole[i] == part[i]);
        double gap = vec3_distance(point_at(&points, i), point_at(&points, 0));
        if (fabs(whole[i] - whole[0]) > gap * (1 + 1e-9) + 1e-15) {
          vec3 a = point_at(&points, i), b = point_at(&points, 0);
          print_error("%s: the field grows by %g over %g m from (%g, %g, %g) to (%g, %g, %g)\n",
                      device_at(d)->name, whole[i] - whole[0], gap, b.x, b.y, b.z, a.x, a.y, a.z);
          fail();
        }
      }
    }
    assert_true(kept < CENTRES * shape->piece_count / 2); /* pruning prunes */
  }
  free(shape);
}

/* ---- What can go wrong ---- */

static scree_status try(const char *name, double resolution, double noise, scree_error *error) {
  scree_sample_options options = {resolution, noise, 1};
  scree_mesh mesh = {0};
  scree_status status = scree_sample_make(name, &options, NULL, &mesh, error);
  assert_null(mesh.positions);
  return status;
}

static void bad_arguments_are_refused(void **state) {
  (void)state;
  scree_error error;
  const char *const unknown[] = {
      "", "fp-4", "FP-1", "icosphere-", "icosphere-12", "icosphere-01", "icosphere-1x", "box-13"};
  for (size_t i = 0; i < sizeof unknown / sizeof *unknown; i++)
    assert_int_equal(try(unknown[i], 1e-3, 0, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "'box-13' is no sample"));
  assert_int_equal(try("fp-1", 0.01e-3, 0, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(try("fp-1", 6e-3, 0, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(try("fp-1", NAN, 0, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(try("fp-1", 1e-3, -1e-6, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(try("fp-1", 1e-3, NAN, &error), SCREE_BAD_ARGUMENT);
  assert_int_equal(try("fp-1", 1e-3, 0.26e-3, &error), SCREE_BAD_ARGUMENT);
  assert_non_null(strstr(error.message, "0.26 mm"));
}

static bool refuse(void *context, const char *phase, double fraction) {
  (void)phase, (void)fraction;
  return ++*(int *)context < 2;
}

static void cancelling_leaves_nothing(void **state) {
  (void)state;
  int calls = 0;
  scree_progress progress = {refuse, &calls, 0};
  scree_sample_options options = {0.5e-3, 0, 1};
  scree_mesh mesh = {0};
  scree_error error;
  size_t used = scree_memory_used();
  assert_int_equal(scree_sample_make("sp-1", &options, &progress, &mesh, &error), SCREE_CANCELLED);
  assert_int_equal(calls, 2);
  assert_null(mesh.positions);
  assert_int_equal(scree_memory_used(), used);
}

static scree_status make_sample(void *name, scree_error *error) {
  scree_sample_options options = {4e-3, 0.02e-3, 1};
  scree_mesh mesh = {0};
  scree_status status = scree_sample_make(name, &options, NULL, &mesh, error);
  scree_mesh_free(&mesh);
  return status;
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  char *names[] = {"sp-3", "box", "icosphere"};
  for (int i = 0; i < 3; i++)
    assert_true(check_allocation_failures(make_sample, names[i]) >= (i ? 2 : 10));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(devices_are_fit_for_particles),
      cmocka_unit_test(devices_are_one_body_without_folds),
      cmocka_unit_test(names_have_descriptions),
      cmocka_unit_test(same_bits_for_any_threads),
      cmocka_unit_test(seeds_change_the_noise_only),
      cmocka_unit_test(sphere_converges),
      cmocka_unit_test(boxes_are_exact),
      cmocka_unit_test(icospheres_converge),
      cmocka_unit_test(fields_are_bounds_and_prune_safely),
      cmocka_unit_test(bad_arguments_are_refused),
      cmocka_unit_test(cancelling_leaves_nothing),
      cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
