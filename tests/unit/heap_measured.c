/* Heaps that users have: scans of cones turned at random, with noise, holes and floors of every
 * size; their outlines; silhouettes painted at a tilt with specks; and what is none of these. */
#include "base/alloc.h"
#include "base/vec.h"
#include "report/program.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/shapes.h"

static const double degree = 57.29577951308232;

/* ---- scans ---- */

typedef struct scanned {
  double angle_deg, noise, half_width; /* m; the cone's base is 0.15 m */
  int holes;
  bool closed;
} scanned;

/* An open sheet over a square, or with `closed` also its lower side; turned at random. */
static scree_mesh scan_of(const scanned *s, scree_rng *rng) {
  double slope = tan(s->angle_deg / degree);
  scree_mesh sheet = shape_sheet(0, 150), mesh = sheet;
  for (size_t i = 0; i < sheet.vertex_count; i++) {
    double *p = sheet.positions + 3 * i;
    p[0] = s->half_width * (2 * p[0] - 1);
    p[1] = s->half_width * (2 * p[1] - 1);
    p[2] = fmax(0, slope * (0.15 - hypot(p[0] - 0.02, p[1] + 0.01)));
  }
  shape_shake(&sheet, s->noise, rng);
  for (int hole = 0; hole < s->holes; hole++) {
    double turn = 6.283 * scree_rng_uniform(rng);
    vec3 at = {0.02 + 0.09 * cos(turn), -0.01 + 0.09 * sin(turn), 0};
    size_t kept = 0;
    for (size_t t = 0; t < sheet.triangle_count; t++) {
      vec3 corner = vec3_load(sheet.positions + 3 * (size_t)sheet.triangles[3 * t]);
      if (hypot(corner.x - at.x, corner.y - at.y) < 0.02) continue;
      memmove(sheet.triangles + 3 * kept++, sheet.triangles + 3 * t, 3 * sizeof(uint32_t));
    }
    sheet.triangle_count = kept;
  }
  if (s->closed) {
    scree_mesh plate = shape_sheet(0, 2);
    for (size_t i = 0; i < plate.vertex_count; i++)
      for (int k = 0; k < 2; k++)
        plate.positions[3 * i + k] = s->half_width * (2 * plate.positions[3 * i + k] - 1);
    mesh = shape_join(&sheet, &plate);
    scree_mesh_free(&sheet);
    scree_mesh_free(&plate);
  } else {
    mesh = sheet;
  }
  mat3 turn = quat_to_mat3(scree_rng_rotation(rng));
  shape_transform(&mesh, &turn, vec3_scale(scree_rng_direction(rng), 3));
  return mesh;
}

static scree_repose measured(const scree_mesh *mesh, scree_ground *ground) {
  scree_height_field field;
  scree_repose repose;
  scree_error error;
  CHECK_OK(scree_height_field_scan(mesh, 0, ground, &field, &error), error);
  CHECK_OK(scree_repose_measure(&field, NULL, &repose, &error), error);
  scree_height_field_free(&field);
  return repose;
}

static void check_scan(const scanned *s, uint64_t seed, double tolerance) {
  scree_rng rng = {.seed = seed};
  scree_mesh mesh = scan_of(s, &rng);
  scree_ground ground;
  scree_repose r = measured(&mesh, &ground);
  assert_true(r.heap);
  CHECK_NEAR(r.sector_deg, s->angle_deg, tolerance);
  CHECK_NEAR(r.cone_deg, s->angle_deg, tolerance);
  CHECK_NEAR(r.silhouette_deg, s->angle_deg, 2 * tolerance);
  CHECK_NEAR(r.volume_deg, s->angle_deg, 3 * tolerance);
  CHECK_NEAR(r.base_radius, 0.15, 0.005);
  assert_true(r.run_out < 0.17);
  CHECK_NEAR(ground.rms, s->noise, 0.4 * s->noise + 1e-6);
  assert_true((ground.filled > 0.001) == (s->holes > 0));
  scree_mesh_free(&mesh);
}

static void cones_turned_at_random_give_their_angle(void **state) {
  (void)state;
  scree_rng rng = {.seed = 5};
  for (uint64_t i = 0; i < 8; i++) {
    scanned s = {15 + 25 * scree_rng_uniform(&rng), 0, 0.18 + 0.2 * scree_rng_uniform(&rng), 0,
                 i % 2 == 1};
    check_scan(&s, 100 + i, 0.2);
  }
}

static void noise_and_holes_cost_little(void **state) {
  (void)state;
  scree_rng rng = {.seed = 6};
  for (uint64_t i = 0; i < 8; i++) {
    scanned s = {15 + 20 * scree_rng_uniform(&rng), 1e-3, 0.18 + 0.15 * scree_rng_uniform(&rng), 10,
                 false};
    check_scan(&s, 200 + i, 0.6);
  }
}

/* Half of the flank's middle is missing: the soap film over a hole of a cone's flank. */
static void what_is_not_scanned_outside_is_floor(void **state) {
  (void)state;
  const scanned s = {30, 0, 0.16, 0, false};
  scree_rng rng = {.seed = 9};
  scree_mesh mesh = scan_of(&s, &rng);
  scree_ground ground;
  scree_repose whole = measured(&mesh, &ground);
  mesh.triangle_count -= mesh.triangle_count / 60; /* a strip of the floor at one side */
  scree_repose cut = measured(&mesh, &ground);
  CHECK_NEAR(cut.cone_deg, whole.cone_deg, 1e-3);
  assert_true(ground.filled == 0);
  scree_mesh_free(&mesh);
}

static void a_scan_without_a_floor_is_told(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(0.1, 4);
  scree_ground ground;
  scree_height_field field = {0};
  scree_error error;
  assert_int_equal(scree_height_field_scan(&ball, 0, &ground, &field, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "leave the floor around the heap in the scan"));
  assert_null(field.height);
  assert_int_equal(scree_height_field_scan(&ball, 1e-9, &ground, &field, &error), SCREE_BAD_MESH);
  ball.triangle_count = 0;
  assert_int_equal(scree_height_field_scan(&ball, 0, &ground, &field, &error), SCREE_BAD_MESH);
  scree_mesh_free(&ball);
}

/* ---- outlines ---- */

static scree_status read_text(const char *text, scree_outline *outline, scree_error *error) {
  put_in_folder("outline.csv", text);
  return scree_outline_read(in_folder("outline.csv"), 1e-3, outline, error);
}

static void outlines_have_units_and_two_flanks(void **state) {
  (void)state;
  static const char *const texts[] = {"x [cm], z [mm]\n-20,0\n0,100\r\n25,0\n",
                                      "# a comment\n-200 0\n0 100\n\n250 0\n",
                                      "place (cm);height (mm)\n-20;0\n0;100\n25;0\n"};
  for (int i = 0; i < 3; i++) {
    scree_outline outline;
    scree_error error;
    scree_repose r;
    CHECK_OK(read_text(texts[i], &outline, &error), error);
    assert_int_equal(outline.count, 3);
    CHECK_NEAR(outline.x[0], -0.2, 1e-12);
    CHECK_NEAR(outline.z[1], 0.1, 1e-12);
    CHECK_OK(scree_outline_measure(&outline, 0, NULL, &r, &error), error);
    double left = degree * atan(0.5), right = degree * atan(0.4), mean = 0.5 * (left + right);
    CHECK_NEAR(r.silhouette_deg, mean, 0.3);
    CHECK_NEAR(r.silhouette_sd_deg, (left - right) / sqrt(2), 0.5);
    CHECK_NEAR(r.sector_deg, mean, 0.3);
    CHECK_NEAR(r.cone_deg, mean, 0.5);
    assert_int_equal(r.flank_count, 2);
    assert_int_equal(r.sector_total, 4);
    scree_outline_free(&outline);
  }
}

static void outlines_that_are_none_are_told_by_their_line(void **state) {
  (void)state;
  static const struct {
    const char *text, *told;
  } bad[] = {{"x,z\n0,1\n1,2\n", "needs three points, not 2"},
             {"0,1\n1,2\n1,3\n2,0\n", "line 3: 1 does not come after 1"},
             {"0,1\n1,2\n2\n", "line 3: needs two numbers"},
             {"x [s], z [mm]\n0,1\n1,2\n2,0\n", "the unit 's' of column 1 is none of m"},
             {"0,1\n1,1e999\n2,0\n", "line 2: a number that is not finite"},
             {"x [mm],y [mm],z [mm]\n0,0,1\n1,0,2\n2,0,0\n", "line 2: has more than two numbers"},
             {"", "needs three points, not 0"}};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    scree_outline outline = {0};
    scree_error error;
    assert_int_equal(read_text(bad[i].text, &outline, &error), SCREE_BAD_FILE);
    if (!strstr(error.message, bad[i].told)) fail_msg("%s: %s", bad[i].text, error.message);
    assert_null(outline.x);
  }
}

/* One of which a flank was not recorded, and one whose heights are above another place than the
 * floor, have no angle; noise of the floor is none. */
static void cut_outlines_are_told(void **state) {
  (void)state;
  scree_rng rng = {3, 1, 0};
  for (int i = 0; i < 200; i++) {
    double foot = 0.4 * scree_rng_uniform(&rng), x[5] = {-2, -1, 0, 1, 2},
           z[5] = {foot, 0.5 * scree_rng_uniform(&rng), 1, 0.5 * scree_rng_uniform(&rng), 0};
    scree_outline outline = {5, x, z, 0};
    scree_error error;
    scree_repose r;
    scree_status status = scree_outline_measure(&outline, 0, NULL, &r, &error);
    assert_int_equal(status == SCREE_BAD_FILE, foot > 0.2);
    if (foot > 0.2) assert_non_null(strstr(error.message, "high at x = -2 m, and flanks"));
  }
}

/* ---- pictures ---- */

enum { WIDTH = 900, HEIGHT = 600 };

typedef struct painted {
  double angle_deg, tilt_deg;
  bool ground, bright; /* the ground goes from edge to edge; the heap is brighter than the sky */
  double base;         /* of the heap's radius, in pixels */
  int specks;
  int bar[4]; /* a bar beside the heap: from and to a column, from and to a row over the ground */
  bool other; /* not a bar but a wedge */
} painted;

static scree_image paint(const painted *p, scree_rng *rng) {
  scree_image image = {WIDTH, HEIGHT, scree_alloc((size_t)3 * WIDTH * HEIGHT, 1)};
  assert_non_null(image.pixels);
  double c = cos(p->tilt_deg / degree), s = sin(p->tilt_deg / degree),
         slope = tan(p->angle_deg / degree);
  for (int row = 0; row < HEIGHT; row++)
    for (int column = 0; column < WIDTH; column++) {
      double dx = column + 0.5 - 440, dy = 480 - (row + 0.5);
      double along = dx * c - dy * s, up = dx * s + dy * c;
      bool in = up < slope * (p->base - fabs(along)) && (p->ground ? 1 : up > 0);
      in = in || (p->ground && up < 0);
      bool beside = column >= p->bar[0] && column < p->bar[1] && dy >= p->bar[2] && dy < p->bar[3];
      in = in || (beside && (!p->other || dy < column - p->bar[0]));
      uint8_t grey = (uint8_t)((in == p->bright ? 200 : 40) + scree_rng_below(rng, 30));
      memset(image.pixels + 3 * (row * WIDTH + column), grey, 3);
    }
  for (int i = 0; i < p->specks; i++)
    memset(image.pixels + 3 * scree_rng_below(rng, (uint64_t)WIDTH * HEIGHT), i % 2 ? 20 : 230, 3);
  return image;
}

static void silhouettes_give_the_angle_at_any_tilt(void **state) {
  (void)state;
  scree_rng rng = {.seed = 7};
  for (int i = 0; i < 16; i++) {
    painted p = {.angle_deg = 20 + 20 * scree_rng_uniform(&rng),
                 .tilt_deg = 8 * scree_rng_uniform(&rng) - 4,
                 .ground = i % 2,
                 .bright = i / 2 % 2,
                 .base = 250 + 80 * scree_rng_uniform(&rng),
                 .specks = i < 8 ? 0 : 300};
    scree_image image = paint(&p, &rng), read;
    scree_outline outline;
    scree_repose r;
    scree_error error;
    scree_status status = scree_image_write_png(&image, in_folder("heap.png"), true, &error);
    if (status == SCREE_UNSUPPORTED) {
      read = image;
    } else {
      CHECK_OK(status, error);
      CHECK_OK(scree_image_read_png(in_folder("heap.png"), &read, &error), error);
      assert_memory_equal(read.pixels, image.pixels, (size_t)3 * WIDTH * HEIGHT);
      scree_image_free(&read);
    }
    CHECK_OK(scree_outline_trace(image.pixels, WIDTH, HEIGHT, 1e-3, &outline, &error), error);
    CHECK_OK(scree_outline_measure(&outline, 0, NULL, &r, &error), error);
    CHECK_NEAR(r.silhouette_deg, p.angle_deg, 0.3);
    CHECK_NEAR(r.cone_deg, p.angle_deg, 0.3);
    CHECK_NEAR(r.base_radius, 1e-3 * p.base, 0.004);
    scree_outline_free(&outline);
    scree_image_free(&image);
  }
}

/* A ruler that stands or lies beside the heap, against its foot or apart, is found and left out;
 * anything else there is told. */
static void a_ruler_beside_the_heap_is_found(void **state) {
  (void)state;
  static const struct {
    int bar[4], length;
    bool ground;
  } cases[] = {{{760, 770, 0, 200}, 200, true},
               {{690, 840, 0, 6}, 150, true},
               {{640, 840, 0, 12}, 0, true}, /* its end is under the heap: no length is asked */
               {{600, 800, 400, 410}, 200, false}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    scree_rng rng = {.seed = 9 + i};
    painted p = {.angle_deg = 28, .ground = cases[i].ground, .base = 240};
    memcpy(p.bar, cases[i].bar, sizeof p.bar);
    scree_image image = paint(&p, &rng);
    scree_outline outline;
    scree_repose r;
    scree_error error;
    CHECK_OK(scree_outline_trace(image.pixels, WIDTH, HEIGHT, 1e-3, &outline, &error), error);
    CHECK_OK(scree_outline_measure(&outline, 0, NULL, &r, &error), error);
    CHECK_NEAR(r.silhouette_deg, p.angle_deg, 0.5);
    if (!(outline.ruler > 0)) fail_msg("no ruler in case %zu", i);
    if (cases[i].length) CHECK_NEAR(outline.ruler, 1e-3 * cases[i].length, 2e-3);
    scree_outline_free(&outline);
    p.other = true;
    p.bar[3] = 120;
    scree_image_free(&image);
    if (!p.ground) continue;
    image = paint(&p, &rng);
    scree_status status = scree_outline_trace(image.pixels, WIDTH, HEIGHT, 1e-3, &outline, &error);
    if (status == SCREE_OK) scree_outline_free(&outline);
    if (i == 1) assert_int_equal(status, SCREE_BAD_FILE);
    if (i == 1) assert_non_null(strstr(error.message, "something else lies beside the heap"));
    scree_image_free(&image);
  }
}

static void pictures_that_are_no_silhouette_are_told(void **state) {
  (void)state;
  scree_rng rng = {.seed = 8};
  painted p = {.angle_deg = 30, .ground = true, .base = 300};
  scree_image image = paint(&p, &rng);
  scree_outline outline = {0};
  scree_error error;
  size_t count = (size_t)3 * WIDTH * HEIGHT;
  assert_int_equal(scree_outline_trace(image.pixels, WIDTH, HEIGHT, 0, &outline, &error),
                   SCREE_BAD_ARGUMENT);
  /* columns 300 and on: the left flank is cut off, and without ground nothing tells where it is */
  scree_image_free(&image);
  p.ground = false;
  image = paint(&p, &rng);
  for (int row = 0; row < HEIGHT; row++)
    memmove(image.pixels + 3 * row * (WIDTH - 300), image.pixels + 3 * (row * WIDTH + 300),
            3 * (WIDTH - 300));
  assert_int_equal(scree_outline_trace(image.pixels, WIDTH - 300, HEIGHT, 1e-3, &outline, &error),
                   SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "cut off at the picture's left edge"));
  for (size_t i = 0; i < count; i++) image.pixels[i] = (uint8_t)scree_rng_below(&rng, 256);
  for (size_t i = 0; i < count; i++) image.pixels[i] = (uint8_t)(100 + image.pixels[i] / 64);
  assert_int_equal(scree_outline_trace(image.pixels, WIDTH, HEIGHT, 1e-3, &outline, &error),
                   SCREE_BAD_FILE);
  memset(image.pixels, 255, count);
  assert_int_equal(scree_outline_trace(image.pixels, WIDTH, HEIGHT, 1e-3, &outline, &error),
                   SCREE_BAD_FILE);
  assert_non_null(strstr(error.message, "no silhouette"));
  assert_null(outline.x);
  scree_image_free(&image);
}

static void files_that_are_no_png_are_told(void **state) {
  (void)state;
  static const char head[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\1\0\0\0\1\0\0\x8\2\0\0\0";
  scree_image image = {0};
  scree_error error;
  for (size_t size = 0; size < sizeof head; size += 6) {
    FILE *file = fopen(in_folder("broken.png"), "wb");
    assert_non_null(file);
    (void)fwrite(head, 1, size, file);
    (void)fclose(file);
    scree_status status = scree_image_read_png(in_folder("broken.png"), &image, &error);
    assert_true(status != SCREE_OK && error.message[0] && !image.pixels);
  }
}

/* ---- memory ---- */

static scree_status scan(void *context, scree_error *error) {
  scree_ground ground;
  scree_height_field field = {0};
  scree_status status = scree_height_field_scan(context, 0.01, &ground, &field, error);
  scree_height_field_free(&field);
  return status;
}

static scree_status read_outline(void *context, scree_error *error) {
  scree_outline outline = {0};
  scree_repose r;
  scree_status status = scree_outline_read(context, 1e-3, &outline, error);
  if (status == SCREE_OK) status = scree_outline_measure(&outline, 0.01, NULL, &r, error);
  scree_outline_free(&outline);
  return status;
}

static scree_status trace(void *context, scree_error *error) {
  const scree_image *image = context;
  scree_outline outline = {0};
  scree_status status =
      scree_outline_trace(image->pixels, image->width, image->height, 1e-3, &outline, error);
  scree_outline_free(&outline);
  return status;
}

static scree_status of_field(void *context, scree_error *error) {
  scree_outline outline = {0};
  scree_status status = scree_outline_of_field(context, 0, &outline, error);
  scree_outline_free(&outline);
  return status;
}

static scree_status read_png(void *context, scree_error *error) {
  scree_image image = {0};
  scree_status status = scree_image_read_png(context, &image, error);
  scree_image_free(&image);
  return status;
}

static scree_status write_json(void *context, scree_error *error) {
  const scree_repose_options options = scree_default_repose_options();
  const scree_heap_entry entry = {"heap.off", "scan",   "scree pile heap.off",
                                  context,    &options, NULL};
  return scree_heap_json_write(&entry, in_folder("heap.json"), true, error);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  const scanned s = {30, 0, 0.2, 0, false};
  const painted p = {.angle_deg = 30, .ground = true, .base = 300};
  scree_rng rng = {.seed = 10};
  scree_mesh mesh = scan_of(&s, &rng);
  scree_image image = paint(&p, &rng);
  scree_outline outline;
  scree_height_field field;
  scree_repose r = {.heap = true};
  scree_error error;
  CHECK_OK(read_text("-200,0\n0,100\n250,0\n", &outline, &error), error);
  scree_outline_free(&outline);
  CHECK_OK(scree_height_field_create(0, 0, 1, 0.1, &field, &error), error);
  assert_true(check_allocation_failures(scan, &mesh) >= 4);
  assert_true(
      check_allocation_failures(read_outline, (void *)(uintptr_t)in_folder("outline.csv")) >= 4);
  assert_true(check_allocation_failures(trace, &image) >= 5);
  assert_true(check_allocation_failures(of_field, &field) == 2);
  assert_true(check_allocation_failures(write_json, &r) >= 1);
  if (scree_image_write_png(&image, in_folder("heap.png"), true, &error) == SCREE_OK)
    assert_true(check_allocation_failures(read_png, (void *)(uintptr_t)in_folder("heap.png")) >= 2);
  scree_height_field_free(&field);
  scree_image_free(&image);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cones_turned_at_random_give_their_angle),
      cmocka_unit_test(noise_and_holes_cost_little),
      cmocka_unit_test(what_is_not_scanned_outside_is_floor),
      cmocka_unit_test(a_scan_without_a_floor_is_told),
      cmocka_unit_test(outlines_have_units_and_two_flanks),
      cmocka_unit_test(outlines_that_are_none_are_told_by_their_line),
      cmocka_unit_test(cut_outlines_are_told),
      cmocka_unit_test(silhouettes_give_the_angle_at_any_tilt),
      cmocka_unit_test(a_ruler_beside_the_heap_is_found),
      cmocka_unit_test(pictures_that_are_no_silhouette_are_told),
      cmocka_unit_test(files_that_are_no_png_are_told),
      cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
