/* Maps of pressure, shear and wear over the triangles of walls against closed forms: what stands on
 * a plate, a column, what slides; on plates split at random, that move, by any number of threads,
 * cut and resumed. */
#include "support/check.h"
#include "support/folder.h"
#include "support/plates.h"
#include "support/scene.h"
#include "support/threads.h"

static const double g = 9.81;

/* A square plate in the xy plane, split at random into some `facets`. */
static void write_plate(const char *name, double half, size_t facets, uint64_t seed) {
  scree_error error;
  scree_rng rng = {.seed = seed};
  const vec3 corners[4] = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  scree_mesh mesh = plates_of(corners, 1);
  plates_split(&mesh, facets, &rng);
  scree_write_options options = scree_default_write_options();
  options.overwrite = true;
  CHECK_OK(scree_mesh_write(&mesh, in_folder(name), &options, &error), error);
  scree_mesh_free(&mesh);
}

/* The map of the scene's first wall; *count numbers. Freed by the caller. */
static double *map_of(const scree_scene *scene, scree_wall_map map, size_t *count) {
  *count = scree_scene_wall_cells(scene, 0);
  double *values = malloc(*count * sizeof *values);
  assert_non_null(values);
  assert_true(scree_scene_wall_map(scene, 0, map, values));
  return values;
}

/* The map times area, summed over the triangles; *loaded: how many have any. */
static double total_of(const scree_scene *scene, scree_wall_map map, size_t *loaded) {
  size_t count;
  scree_wall wall;
  double *values = map_of(scene, map, &count), sum = 0;
  scree_world_get_wall(scree_scene_view(scene), 0, &wall);
  *loaded = 0;
  for (size_t t = 0; t < count; t++) {
    const uint32_t *k = wall.mesh->triangles + 3 * t;
    const double *p = wall.mesh->positions;
    vec3 n = vec3_triangle_normal(vec3_load(p + 3 * (size_t)k[0]), vec3_load(p + 3 * (size_t)k[1]),
                                  vec3_load(p + 3 * (size_t)k[2]));
    sum += values[t] * 0.5 * vec3_norm(n);
    *loaded += values[t] != 0;
  }
  free(values);
  return sum;
}

/* A bed in a shaft without friction presses on its floor with all its weight, and on each side. */
static scree_scene *bed_on(size_t facets, const char *motion) {
  char text[1600];
  write_plate("plate.stl", 0.06, facets, facets);
  snprintf(text, sizeof text,
           "time: 1\n"
           "materials: {m: {young: 1e6, density: 2000, restitution: 0.1, friction: 0.4}, glass: "
           "{young: 1e6}}\n"
           "pairs: [{between: [m, glass], friction: 0}]\n"
           "shapes: {ball: {sphere: 12 mm, material: m}, brick: {box: [0.01, 0.012, 0.016], "
           "material: m}}\n"
           "geometry:\n"
           "  floor: {file: plate.stl, unit: m, material: m%s}\n"
           "  shaft: {shaft: {width: 0.1, depth: 0.1}, material: glass}\n"
           "inlets: {i: {box: {min: [-0.04, -0.04, 0.004], max: [0.04, 0.04, 0.1]}, shapes: {ball: "
           "1, brick: 1}, count: 30}}\n"
           "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n"
           "sensors:\n"
           "  late: {wall: floor, from: 0.85}\n"
           "  all: {wall: floor}\n",
           motion);
  return create_at(text, in_folder("bed.yaml"));
}

static void weight(void **state) {
  (void)state;
  static const size_t facets[] = {2, 40, 900};
  double wear[3];
  for (int i = 0; i < 3; i++) {
    scree_scene *scene = bed_on(facets[i], "");
    run_to_end(scene);
    scree_scene_book b;
    size_t loaded;
    scree_scene_get_book(scene, &b);
    assert_int_equal(b.inside_count, 30);
    double held = total_of(scene, SCREE_MAP_PRESSURE, &loaded);
    print_message("%zu facets: %.6g of %.6g N on %zu\n", facets[i], held, b.inside_mass * g,
                  loaded);
    CHECK_NEAR(held, b.inside_mass * g, 1e-4 * held);
    assert_true(loaded > (i ? facets[i] < 100 ? 5 : 15 : 0));
    double sheared = total_of(scene, SCREE_MAP_SHEAR, &loaded);
    assert_true(sheared > 0 && sheared < 0.4 * held * (1 + 1e-9));
    wear[i] = now_of(scene, "all.wear");
    assert_true(now_of(scene, "late.wear") < 0.05 * wear[i] && wear[i] > 0); /* it rests */
    scree_scene_free(scene);
  }
  /* The same bodies on the same floor, however its facets lie, but for rounding, which chaos grows.
   */
  CHECK_NEAR(wear[1], wear[0], 0.3 * wear[0]);
  CHECK_NEAR(wear[2], wear[0], 0.3 * wear[0]);
}

/* One box slides and stops: while it slides the shear is mu times the pressure, whatever the
 * plate's facets and motion. `with`: of the plate. */
static scree_scene *slide_on(size_t facets, const char *motion, double push) {
  char text[1600];
  write_plate("plate.stl", 1, facets, facets + 7);
  snprintf(text, sizeof text,
           "time: 0.3\n"
           "materials: {m: {young: 1e6, density: 1000, restitution: 0.1, friction: 0.3}}\n"
           "pairs: [{between: [m, m], wear: 1e-10}]\n"
           "shapes: {box: {box: [0.06, 0.06, 0.02]}}\n"
           "geometry:\n"
           "  floor: {file: plate.stl, unit: m%s}\n"
           "inlets: {i: {box: {min: [0.059, 0.019, 0.0001], max: [0.121, 0.081, 0.0212]}, shapes: "
           "box, count: 1, orientation: fixed, velocity: [%g, 0, 0]}}\n"
           "domain: {min: [-3, -3, -3], max: [3, 3, 3]}\n"
           "sensors: {load: {wall: floor, from: 0.1}}\n",
           motion, push);
  return create_at(text, in_folder("slide.yaml"));
}

static void friction(void **state) {
  (void)state;
  static const struct {
    size_t facets;
    const char *motion;
    double push;
  } rows[] = {
      {2, "", 2},
      {300, "", 2},
      {300, ", surface_velocity: [-1, 2, 0]", 0},
      {300, ", motion: [{translate: {velocity: [1.5, 0, 0]}}]", 0},
      {300, ", motion: [{translate: {velocity: [0, 0, 0.5]}}]", 2},
      {300, ", motion: [{rotate: {axis: [0, 0, 1], through: [0.3, 0.4, 0], speed: 5}}]", 0},
  };
  const double load = 1000 * 0.06 * 0.06 * 0.02 * g;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    scree_scene *scene = slide_on(rows[i].facets, rows[i].motion, rows[i].push);
    run_to_end(scene);
    size_t loaded;
    double press = total_of(scene, SCREE_MAP_PRESSURE, &loaded),
           shear = total_of(scene, SCREE_MAP_SHEAR, &loaded),
           wear = total_of(scene, SCREE_MAP_WEAR, &loaded),
           worn = total_of(scene, SCREE_MAP_WORN, &loaded);
    print_message("%zu facets %s: pressed by %.6g of %.6g N on %zu, sheared by %.6g\n",
                  rows[i].facets, rows[i].motion, press, load, loaded, shear);
    CHECK_NEAR(press, load, 2e-3 * load);
    CHECK_NEAR(shear, 0.3 * press, 1e-3 * press);
    CHECK_NEAR(wear, now_of(scene, "load.wear"), 1e-9 * wear);
    CHECK_NEAR(worn, now_of(scene, "load.worn_volume"), 1e-9 * worn);
    CHECK_NEAR(worn, 1e-10 * wear / 0.3, 1e-3 * worn);
    assert_true(rows[i].facets == 2 || loaded > 1);
    scree_scene_free(scene);
  }
}

/* A plate that carries its load round: the map is the same on every facet as that at rest. */
static void carried(void **state) {
  (void)state;
  double *maps[2], highest = 0;
  size_t count, turned = 0;
  for (int i = 0; i < 2; i++) {
    scree_scene *scene = slide_on(
        40, i ? ", motion: [{rotate: {axis: [0, 0, 1], through: [0, 0, 0], speed: 1}}]" : "", 0);
    run_to_end(scene);
    maps[i] = map_of(scene, SCREE_MAP_PRESSURE, &count);
    scree_scene_free(scene);
  }
  for (size_t t = 0; t < count; t++) highest = fmax(highest, maps[0][t]);
  for (size_t t = 0; t < count; t++) {
    CHECK_NEAR(maps[1][t], maps[0][t], 0.01 * highest);
    turned += maps[0][t] != 0;
  }
  assert_in_range(turned, 1, 4); /* corners of a box */
  free(maps[0]);
  free(maps[1]);
}

/* Before the window there is no mean; of what nothing looks at there is no map. */
static void nothing(void **state) {
  (void)state;
  double value;
  scree_scene *scene = create(
      "time: 0.1\n"
      "shapes: {ball: {sphere: 0.01}}\n"
      "geometry: {disc: {disc: {radius: 0.1, normal: [0, 0, 1]}}, plane: {plane: [0, 0, 1], at: "
      "[0, "
      "0, -1]}, other: {disc: {radius: 0.1, normal: [0, 0, 1]}, at: [0, 0, -0.5]}}\n"
      "inlets: {i: {box: {min: [-0.01, -0.01, 0.0], max: [0.01, 0.01, 0.02]}, shapes: ball, count: "
      "1}}\n"
      "sensors: {d: {wall: disc, from: 0.05}, p: {wall: plane}}\n");
  assert_true(scree_scene_wall_map(scene, 0, SCREE_MAP_PRESSURE, &value) && isnan(value));
  assert_true(scree_scene_wall_map(scene, 1, SCREE_MAP_WEAR, &value) && isnan(value)); /* endless */
  assert_false(scree_scene_wall_map(scene, 2, SCREE_MAP_PRESSURE, &value));
  assert_true(isnan(now_of(scene, "d.highest_pressure")));
  run_to_end(scene);
  assert_true(scree_scene_wall_map(scene, 0, SCREE_MAP_PRESSURE, &value) && value >= 0);
  CHECK_NEAR(now_of(scene, "d.highest_pressure"), value, 0);
  assert_null(scree_wall_map_name(SCREE_MAP_COUNT));
  scree_scene_free(scene);
}

/* By other threads, saved and loaded at random moments: the same bits. */
static void resumed(void **state) {
  (void)state;
  scree_error error;
  scree_rng rng = {.seed = 5};
  const char *motion = ", motion: [{vibrate: {along: [1, 0, 1], amplitude: 1 mm, frequency: 20}}]";
  scree_scene *whole = bed_on(300, motion), *cut = bed_on(300, motion);
  use_threads(1);
  run_to_end(whole);
  use_threads(3);
  while (!scree_scene_end(cut)) {
    const char *path = in_folder("cut.scree");
    CHECK_OK(scree_scene_advance(cut, (size_t)scree_rng_below(&rng, 3000), &error), error);
    CHECK_OK(scree_scene_save(cut, path, true, &error), error);
    scree_scene_free(cut);
    CHECK_OK(scree_scene_load(path, &cut, &error), error);
  }
  use_threads(0);
  for (int m = 0; m < SCREE_MAP_COUNT; m++) {
    size_t count;
    double *a = map_of(whole, (scree_wall_map)m, &count),
           *b = map_of(cut, (scree_wall_map)m, &count);
    assert_memory_equal(a, b, count * sizeof *a);
    free(a);
    free(b);
  }
  scree_scene_free(whole);
  scree_scene_free(cut);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(weight),  cmocka_unit_test(friction), cmocka_unit_test(carried),
      cmocka_unit_test(nothing), cmocka_unit_test(resumed),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
