#include "base/alloc.h"
#include "scree.h"
#include "support/check.h"

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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pictures_do_not_depend_on_threads_or_place),
      cmocka_unit_test(png_is_written_whole),
      cmocka_unit_test(options_out_of_range_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
