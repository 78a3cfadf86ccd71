/* Bodies from a table: what one scene writes another begins with, to the bit; units in the header;
 * each mistake is told with its line. */
#include "base/file.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/folder.h"

#include "scree.h"

#define SHAPES                                                                                     \
  "shapes: {ball: {sphere: 0.02}, brick: {box: [0.03, 0.02, 0.01]}, sand: {size: {distribution: "  \
  "[[10 mm, 1], [12 mm, 1]]}}}\n"                                                                  \
  "geometry: {floor: {plane: [0, 0, 1]}}\n"

static scree_status create(const char *text, scree_scene **scene, scree_error *error) {
  scree_scene_file *file = NULL;
  scree_error bad;
  CHECK_OK(scree_scene_file_parse(text, strlen(text), in_folder("s.yaml"), &file, &bad), bad);
  scree_status status = scree_scene_create(file, NULL, scene, error);
  scree_scene_file_free(file);
  return status;
}

static void handed_over(void **state) {
  (void)state;
  scree_error error;
  scree_scene *first, *second;
  CHECK_OK(create("time: 0.5\n" SHAPES
                  "inlets: {i: {box: {min: [0, 0, 0.01], max: [0.2, 0.2, 0.4]}, shapes: [ball, "
                  "brick, sand], count: 60}}\n",
                  &first, &error),
           error);
  while (!scree_scene_end(first)) CHECK_OK(scree_scene_advance(first, 5000, &error), error);
  CHECK_OK(scree_scene_bodies_write(first, in_folder("state.csv"), true, &error), error);
  CHECK_OK(create("time: 0.5\n" SHAPES "bodies: {file: state.csv}\n", &second, &error), error);
  const scree_world *a = scree_scene_view(first), *b = scree_scene_view(second);
  assert_int_equal(scree_world_body_count(a), 60);
  assert_int_equal(scree_world_body_count(b), 60);
  for (size_t i = 0; i < 60; i++) {
    scree_body p, q;
    scree_world_get_body(a, i, &p);
    scree_world_get_body(b, i, &q);
    assert_memory_equal(&p, &q, sizeof p);
    assert_int_equal(scree_scene_body_shape(first, i), scree_scene_body_shape(second, i));
  }
  while (!scree_scene_end(second)) CHECK_OK(scree_scene_advance(second, 5000, &error), error);
  scree_scene_book book;
  scree_scene_get_book(second, &book);
  assert_int_equal(book.inside_count, 60);
  CHECK_NEAR(book.ledger, 0, 1e-2);
  scree_scene_free(first);
  scree_scene_free(second);
}

static void tables(void **state) {
  (void)state;
  static const struct {
    const char *table, *says;
  } rows[] = {
      {"# a line\nshape, x [mm], y, z,qw,qx,qy,qz\nball, 100, 0.2, 0.3, 2, 0, 0, 0\r\n\n", NULL},
      {"shape,x,y,z,size [mm]\nsand,0,0,1,12\n", NULL},
      {"shape,x,y,z\nsand-12mm,0,0,1\n", NULL},
      {"", "no line of names"},
      {"x,y,z\n0,0,1\n", "line 1: needs a column shape"},
      {"shape,x,y\n", "line 1: needs columns x, y and z"},
      {"shape,x,y,zz\n", "line 1: no column 'zz'; there are x, y"},
      {"shape,x,y,z,x\n", "line 1: the column x stands here twice"},
      {"shape,x [kg],y,z\n", "line 1: the column x is in m, not 'kg'"},
      {"shape,x,y,z,qw\n", "line 1: an orientation needs"},
      {"shape,x,y,z\nball,0,0,1\nball,0,0\n", "line 3: fewer fields than names"},
      {"shape,x,y,z\nball,0,0,1,4\n", "line 2: more fields than names"},
      {"shape,x,y,z\nball,0,0,one\n", "line 2: z: 'one' is no number"},
      {"shape,x,y,z\nbal,0,0,1\n", "line 2: no shape 'bal'"},
      {"shape,x,y,z,size\nsand,0,0,1,0.011\n", "line 2: no shape 'sand' of that name and size"},
      {"shape,x,y,z,qw,qx,qy,qz\nball,0,0,1,0,0,0,0\n", "line 2: "},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_error error = {SCREE_OK, ""};
    scree_scene *scene = NULL;
    CHECK_OK(scree_text_write(rows[i].table, in_folder("state.csv"), true, &error), error);
    scree_status status =
        create("time: 0.5\n" SHAPES "bodies: {file: state.csv}\n", &scene, &error);
    if (rows[i].says) {
      assert_int_equal(status, SCREE_BAD_FILE);
      if (!strstr(error.message, rows[i].says)) fail_msg("%s: %s", rows[i].table, error.message);
    } else {
      CHECK_OK(status, error);
      assert_int_equal(scree_world_body_count(scree_scene_view(scene)), 1);
    }
    if (i == 0) {
      scree_body body;
      scree_world_get_body(scree_scene_view(scene), 0, &body);
      CHECK_NEAR(body.position[0], 0.1, 1e-15);
      CHECK_NEAR(body.orientation[0], 1, 1e-15);
    }
    scree_scene_free(scene);
  }
}

static scree_status write_bodies(void *context, scree_error *error) {
  return scree_scene_bodies_write(context, in_folder("memory.csv"), true, error);
}

static scree_status measure_residence(void *context, scree_error *error) {
  scree_residence residence;
  scree_status status = scree_scene_measure_residence(context, 0, &residence, error);
  if (status == SCREE_OK) scree_residence_free(&residence);
  return status;
}

static void out_of_memory(void **state) {
  (void)state;
  scree_error error;
  scree_scene *scene;
  CHECK_OK(scree_text_write("shape,x,y,z\nball,0,0,1\n", in_folder("state.csv"), true, &error),
           error);
  CHECK_OK(create("time: 0.5\n" SHAPES "bodies: {file: state.csv}\n"
                  "sensors: {stay: {residence: {}}}\n",
                  &scene, &error),
           error);
  check_allocation_failures(write_bodies, scene);
  check_allocation_failures(measure_residence, scene);
  scree_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(handed_over),
      cmocka_unit_test(tables),
      cmocka_unit_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
