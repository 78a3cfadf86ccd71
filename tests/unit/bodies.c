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
      {"shape,x,y,z\nball,0,0,one\n", "line 2: z is 'one', which is no number"},
      {"shape,x,y,z\nball,0,0,nan\n", "line 2: z is 'nan', which is no number"},
      {"shape,x,y,z [km]\nball,0,0,-1e10\n", "line 2: z is -1e+13 m: 1e9 at most"},
      {"shape;x;y;z\nball;0;0;0,1\n", "with a decimal comma"},
      {",shape,x,y,z\n0,ball,0,0,1\n", NULL},
      {"\xef\xbb\xbf\"shape\";\"x\";\"y\";\"z\"\r\n\"ball\";0;0;1\r\n", NULL},
      {"shape,x,y,z\nbal,0,0,1\n", "line 2: no shape 'bal'"},
      {"shape,x,y,z,size\nsand,0,0,1,0.011\n",
       "line 2: no shape 'sand' of size 11 mm, the nearest has 12 mm: other sizes are those that"},
      {"shape,x,y,z,size\nball,0,0,1,0.3\n", "line 2: no shape 'ball' of size 300 mm, the nearest"},
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

/* ---- where the bodies of a table begin ---- */

/* What is pressed in no deeper than springs bear is at rest; beyond that the worst is told, also
 * where the first step fails by it. Balls of 0.2 m on a floor. */
static void overlaps_are_told(void **state) {
  (void)state;
  static const struct {
    const char *rows, *says;
  } rows[] = {
      {"ball,0,0,0.2\nball,0.199,0,0.2\n", NULL},
      {"ball,0,0,0.1\nball,0.2,0,0.1\n", NULL},
      {"ball,0,0,0.2\nball,0.25,0,0.2\nball,0.41,0,0.2\n",
       "body 1, counted from 0, and body 2 overlap by 40 mm at"},
      {"ball,0,0,0.2\nball,0.02,0,0.2\n",
       "body 0, counted from 0, and body 1 overlap by 180 mm at"},
      {"ball,0,0,0.2\nball,3,0,0.05\n", "body 1, counted from 0, and 'floor' overlap by 50 mm at"},
      {"ball,0,0,-5\n", "body 0, counted from 0, and 'floor' overlap by 5.1e+03 mm"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_error error;
    scree_scene *scene;
    char table[200], remark[SCREE_REMARK], *found = NULL;
    snprintf(table, sizeof table, "shape,x,y,z\n%s", rows[i].rows);
    CHECK_OK(scree_text_write(table, in_folder("state.csv"), true, &error), error);
    CHECK_OK(create("time: 0.5\nshapes: {ball: {sphere: 0.2}}\ngeometry: {floor: {plane: [0, 0, "
                    "1]}}\nbodies: {file: state.csv}\n",
                    &scene, &error),
             error);
    for (size_t k = 0; !found && scree_scene_remark(scene, k, remark); k++)
      found = strstr(remark, "inside of each other");
    if (rows[i].says && !(found && strstr(remark, rows[i].says))) fail_msg("%s", remark);
    if (!rows[i].says && found) fail_msg("%s", remark);
    scree_scene_free(scene);
  }
}

static void put_facet(FILE *out, const double *a, const double *b, const double *c) {
  fprintf(out,
          "facet normal 0 0 0 outer loop vertex %g %g %g vertex %g %g %g vertex %g %g %g "
          "endloop endfacet\n",
          a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
}

/* A box of half sizes x, y, z about the origin, in m; its lower side alone where z is 0. */
static void put_box(const char *name, double x, double y, double z) {
  static const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  FILE *out = fopen(in_folder(name), "wb");
  double v[8][3];
  assert_non_null(out);
  for (int i = 0; i < 8; i++)
    v[i][0] = i & 1 ? x : -x, v[i][1] = i & 2 ? y : -y, v[i][2] = i & 4 ? z : -z;
  fputs("solid a\n", out);
  for (int q = 0; q < (z > 0 ? 6 : 1); q++) {
    const int *k = quads[q];
    put_facet(out, v[k[0]], v[k[1]], v[k[2]]);
    put_facet(out, v[k[0]], v[k[2]], v[k[3]]);
  }
  fputs("endsolid\n", out);
  fclose(out);
}

#define STARTS                                                                                     \
  "time: 0.02\nmaterials: {g: {young: 1e6, density: 2500}, s: {young: 2e9}}\n"                     \
  "shapes: {cube: {box: [0.01, 0.01, 0.01], material: g}, ball: {sphere: 0.01, material: g}}\n"    \
  "bodies: {file: state.csv}\ndomain: {min: [-9, -9, -9], max: [9, 9, 9]}\n"

/* A sheet through a body is told; one that a body only touches, or lies in by what contacts bear,
 * is not. Oracle: the height of the body's lowest point. */
static void pierced_by_a_sheet(void **state) {
  (void)state;
  static const double heights[] = {-0.006, -0.0051, -0.0045, 0,   0.004,
                                   0.0045, 0.0049,  0.0051,  0.02};
  put_box("sheet.stl", 0.1, 0.1, 0);
  for (int shape = 0; shape < 2; shape++)
    for (size_t i = 0; i < sizeof heights / sizeof *heights; i++) {
      scree_error error = {SCREE_OK, ""};
      scree_scene *scene = NULL;
      char table[100];
      snprintf(table, sizeof table, "shape,x,y,z\n%s,0.01,0.02,%g\n", shape ? "ball" : "cube",
               heights[i]);
      CHECK_OK(scree_text_write(table, in_folder("state.csv"), true, &error), error);
      scree_status status =
          create(STARTS "geometry: {w: {file: sheet.stl, unit: m, material: s}}\n", &scene, &error);
      bool pierced = fabs(heights[i]) < 0.0046;
      assert_int_equal(status == SCREE_OK, !pierced);
      if (pierced && !strstr(error.message, "the sheet 'w' passes through body 1, a '"))
        fail_msg("%s", error.message);
      scree_scene_free(scene);
    }
}

/* Closed geometry holds the bodies of a table as it holds those of an inlet. */
static void in_closed_geometry(void **state) {
  (void)state;
  static const char *const geometry[] = {"{file: drum.stl, unit: m, material: s}",
                                         "{box: [0.4, 0.4, 0.4], material: s}"};
  static const struct {
    const char *table;
    bool inside;
  } rows[] = {{"shape,x,y,z\ncube,0,0,0\nball,0.05,0,0\n", true},
              {"shape,x,y,z\ncube,0,0,0.3\nball,0.5,0,0\n", false}};
  put_box("drum.stl", 0.2, 0.2, 0.2);
  for (int g = 0; g < 2; g++)
    for (int i = 0; i < 2; i++) {
      scree_error error = {SCREE_OK, ""};
      scree_scene *scene = NULL;
      char text[800];
      CHECK_OK(scree_text_write(rows[i].table, in_folder("state.csv"), true, &error), error);
      snprintf(text, sizeof text, STARTS "geometry: {w: %s}\n", geometry[g]);
      CHECK_OK(create(text, &scene, &error), error);
      while (!scree_scene_end(scene)) CHECK_OK(scree_scene_advance(scene, 500, &error), error);
      scree_body body;
      scree_world_get_body(scree_scene_view(scene), 0, &body);
      CHECK_NEAR(body.position[2], rows[i].inside ? 0 : 0.3, 0.01); /* it falls, freely */
      scree_scene_free(scene);
    }
}

/* Tables that jump, of whatever motion, are refused; what a step can follow is not. */
static void jumps(void **state) {
  (void)state;
  static const struct {
    const char *motion;
    bool jumps;
  } rows[] = {
      {"translate: {along: [0, 0, 1], positions: [[0, 0], [0.1, 0], [0.1001, 0.3], [1, 0.3]]}",
       true},
      {"translate: {along: [0, 0, 1], positions: [[0, 0], [0.1, 0], [0.2, 0.3], [1, 0.3]]}", false},
      {"translate: {along: [0, 0, 1], table: [[0, 0], [1, 1e5]]}", true},
      {"path: {file: path.csv}", true},
      {"path: {file: slow.csv}", false}};
  scree_error error = {SCREE_OK, ""};
  CHECK_OK(scree_text_write("shape,x,y,z\ncube,0,0,0.1\n", in_folder("state.csv"), true, &error),
           error);
  CHECK_OK(scree_text_write("t,x\n0,0\n0.1,0\n0.10001,1\n", in_folder("path.csv"), true, &error),
           error);
  CHECK_OK(scree_text_write("t,x\n0,0\n0.1,0\n1,1\n", in_folder("slow.csv"), true, &error), error);
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_scene *scene = NULL;
    char text[900];
    snprintf(text, sizeof text,
             STARTS "geometry: {w: {box: [0.3, 0.3, 0.002], material: s, motion: [{%s}]}}\n",
             rows[i].motion);
    scree_status status = create(text, &scene, &error);
    if (rows[i].jumps != (status != SCREE_OK)) fail_msg("%s: %s", rows[i].motion, error.message);
    if (rows[i].jumps &&
        (!strstr(error.message, "m/s can be followed") || !strstr(error.message, "line ")))
      fail_msg("%s", error.message);
    scree_scene_free(scene);
  }
}

static scree_status write_bodies(void *context, scree_error *error) {
  return scree_scene_bodies_write(context, in_folder("memory.csv"), true, error);
}

static scree_status make_table(void *context, scree_error *error) {
  scree_scene_table table;
  scree_status status = scree_scene_make_table(context, 0, &table, error);
  if (status == SCREE_OK) scree_scene_table_free(&table);
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
  check_allocation_failures(make_table, scene);
  scree_scene_free(scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(handed_over),        cmocka_unit_test(tables),
      cmocka_unit_test(overlaps_are_told),  cmocka_unit_test(pierced_by_a_sheet),
      cmocka_unit_test(in_closed_geometry), cmocka_unit_test(jumps),
      cmocka_unit_test(out_of_memory),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
