#include "base/alloc.h"
#include "scree.h"
#include "support/check.h"
#include "support/scene.h"

#include <unistd.h>

/* An octahedron about the origin. */
static scree_mesh octahedron(double size) {
  static const double corners[] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
  static const uint32_t faces[] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                   2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  scree_mesh mesh = {scree_alloc(18, sizeof(double)), scree_alloc(24, sizeof(uint32_t)), 6, 8};
  for (int i = 0; i < 18; i++) mesh.positions[i] = size * corners[i];
  memcpy(mesh.triangles, faces, sizeof faces);
  return mesh;
}

static scree_status render_one(const scree_render_item *item, const scree_render_options *options,
                               scree_image *image, scree_error *error) {
  scree_render_cell cell = {item, 1, "caption <b>"};
  return scree_render(&cell, 1, options, NULL, image, error);
}

static void pictures_do_not_depend_on_threads_or_place(void **state) {
  (void)state;
  scree_mesh mesh = octahedron(0.05);
  scree_render_item item = {.mesh = &mesh, .color = {0.5f, 0.5f, 0.5f}};
  scree_render_options options = scree_default_render_options();
  options.width = options.height = 96;
  options.samples = 4;
  options.edges = true;
  scree_image one, other, far;
  scree_error error;
  scree_set_threads(1);
  scree_status status = render_one(&item, &options, &one, &error);
  if (status == SCREE_UNSUPPORTED) {
    scree_mesh_free(&mesh);
    print_message("skipped: %s\n", error.message);
    skip();
  }
  CHECK_OK(status, error);
  scree_set_threads(5);
  CHECK_OK(render_one(&item, &options, &other, &error), error);
  scree_set_threads(0);
  assert_memory_equal(one.pixels, other.pixels, 3 * 96 * 96);
  /* the body is in the middle, the corners are white */
  assert_true(one.pixels[3 * (30 * 96 + 48)] < 220);
  assert_int_equal(one.pixels[0], 255);
  /* far from the origin the picture is the same but for rounding of the moved coordinates */
  item.position[0] = 1e5;
  CHECK_OK(render_one(&item, &options, &far, &error), error);
  size_t different = 0;
  for (size_t i = 0; i < 3 * 96 * 96; i++) different += abs(one.pixels[i] - far.pixels[i]) > 40;
  assert_true(different < 200);
  scree_image_free(&one);
  scree_image_free(&other);
  scree_image_free(&far);
  scree_mesh_free(&mesh);
}

/* Two views of one thing, each pixel of its own random numbers: with many rays alike all over. The
 * lower faces see a part of the sky: what stopped where the first rays agree left specks. */
static void rays_of_other_pixels_find_the_same(void **state) {
  (void)state;
  enum { SIDE = 102, CELL = 96 };
  scree_mesh mesh = octahedron(0.05);
  scree_render_item item = {.mesh = &mesh, .color = {0.5f, 0.5f, 0.5f}};
  scree_render_cell cells[] = {{&item, 1, NULL}, {&item, 1, NULL}};
  scree_render_options options = scree_default_render_options();
  options.width = 2 * SIDE;
  options.height = SIDE;
  options.samples = 200;
  scree_image image;
  scree_error error;
  scree_status status = scree_render(cells, 2, &options, NULL, &image, &error);
  if (status != SCREE_UNSUPPORTED) {
    CHECK_OK(status, error);
    int worst = 0;
    for (size_t i = 0; i < 3 * CELL * CELL; i++) {
      const uint8_t *one = image.pixels + 3 * (i / 3 / CELL * 2 * SIDE + i / 3 % CELL) + i % 3;
      int off = abs(one[0] - one[3 * SIDE]);
      worst = off > worst ? off : worst;
    }
    print_message("%d steps of 255 off at most\n", worst);
    assert_true(worst < 25);
    scree_image_free(&image);
  }
  scree_mesh_free(&mesh);
}

static void png_is_written_whole(void **state) {
  (void)state;
  uint8_t pixels[3 * 4] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 9, 9, 9};
  scree_image image = {2, 2, pixels};
  char path[] = "/tmp/scree_png_XXXXXX";
  scree_error error;
  int fd = mkstemp(path);
  assert_true(fd >= 0);
  close(fd);
  assert_int_equal(scree_image_write_png(&image, path, false, &error), SCREE_EXISTS);
  CHECK_OK(scree_image_write_png(&image, path, true, &error), error);
  FILE *file = fopen(path, "rb");
  unsigned char head[8];
  assert_int_equal(fread(head, 1, 8, file), 8);
  fclose(file);
  assert_memory_equal(head, "\x89PNG\r\n\x1a\n", 8);
  unlink(path);
}

static void options_out_of_range_are_refused(void **state) {
  (void)state;
  scree_mesh mesh = octahedron(1);
  scree_render_item item = {.mesh = &mesh};
  scree_render_options options = scree_default_render_options();
  scree_image image;
  scree_error error;
  options.width = 3;
  assert_int_equal(render_one(&item, &options, &image, &error), SCREE_BAD_ARGUMENT);
  assert_string_equal(error.message, "picture size 3 x 900: each side must be 64 to 20000");
  options = scree_default_render_options();
  options.samples = 0;
  assert_int_equal(render_one(&item, &options, &image, &error), SCREE_BAD_ARGUMENT);
  scree_mesh_free(&mesh);
}

/* Of a ball at rest on a plate, in a wide tube that stands on nothing. */
static const char tube_text[] =
    "shapes: {ball: {sphere: 0.1}}\n"
    "geometry:\n"
    "  plate: {box: [0.6, 0.6, 0.05], at: [0, 0, -0.025]}\n"
    "  tube: {cylinder: {radius: 0.15, length: 0.5}, at: [0, 0, 0.05]}\n"
    "inlets: {feed: {box: {min: [-0.051, -0.051, 0], max: [0.051, 0.051, 0.102]}, count: 1, "
    "shapes: ball}}\n"
    "time: 0.01\n";

static size_t blue_pixels(const scree_image *image) {
  size_t count = 0;
  for (size_t i = 0; i < image->width * image->height; i++)
    count += image->pixels[3 * i + 2] > 1.6 * image->pixels[3 * i];
  return count;
}

/* From wherever one looks the tube is cut before the ball, and the plate is whole. */
static void walls_that_hide_are_cut(void **state) {
  (void)state;
  scree_scene *scene = create(tube_text);
  run_to_end(scene);
  for (double azimuth = 0; azimuth < 360; azimuth += 50) {
    scree_render_options options = scree_default_render_options();
    scree_image image, alone;
    scree_error error;
    options.width = options.height = 200;
    options.samples = 1;
    options.azimuth_deg = azimuth;
    options.focus[2] = 0.05;
    options.focus_radius = 0.3;
    scree_status status = scree_scene_picture(scene, &options, NULL, &image, &error);
    if (status == SCREE_UNSUPPORTED) skip();
    CHECK_OK(status, error);
    CHECK_OK(scree_world_picture(scree_scene_view(scene), &options, NULL, &alone, &error), error);
    assert_in_range(blue_pixels(&image), 0.85 * (double)blue_pixels(&alone),
                    1.15 * (double)blue_pixels(&alone));
    assert_true(blue_pixels(&alone) > 500);
    scree_image_free(&image);
    scree_image_free(&alone);
  }
  scree_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pictures_do_not_depend_on_threads_or_place),
      cmocka_unit_test(rays_of_other_pixels_find_the_same),
      cmocka_unit_test(png_is_written_whole),
      cmocka_unit_test(options_out_of_range_are_refused),
      cmocka_unit_test(walls_that_hide_are_cut),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
