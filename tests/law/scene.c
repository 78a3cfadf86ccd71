/* Scenes against closed forms: a belt, a tilted plate, a shaken plate, a hopper that runs out, the
 * surface of a bed
 * (docs/background/verification.md). */
#include "support/scene.h"
#include "scree.h"

static const double g = 9.81;

/* What a box that was set on a belt of 0.6 m/s has slid away is m v^2 / 2, on the belt's upper face
 * alone; the volume is k m g times the way v^2/(2 mu g). */
static void check_wear(const scree_scene *scene) {
  const double half = 0.5 * 4 * 0.4; /* the upper face has two triangles */
  double wear[12], worn[12], all = now_of(scene, "load.wear"), above = 0, deepest = 0, lost = 0,
                             work = 0.5 * 500 * 0.06 * 0.06 * 0.02 * 0.6 * 0.6;
  scree_wall wall;
  scree_world_get_wall(scree_scene_view(scene), 0, &wall);
  assert_int_equal(scree_scene_wall_cells(scene, 0), 12);
  assert_true(scree_scene_wall_map(scene, 0, SCREE_MAP_WEAR, wear) &&
              scree_scene_wall_map(scene, 0, SCREE_MAP_WORN, worn));
  for (size_t t = 0; t < 12; t++) {
    bool top = true;
    for (int c = 0; c < 3; c++)
      top = top && wall.mesh->positions[3 * wall.mesh->triangles[3 * t + (size_t)c] + 2] > 0;
    if (!top) assert_true(wear[t] == 0 && worn[t] == 0);
    above += top ? wear[t] * half : 0;
    lost += top ? worn[t] * half : 0;
    deepest = fmax(deepest, worn[t]);
  }
  CHECK_NEAR(all, work, 0.1 * work); /* its landing is a few short hits */
  CHECK_NEAR(above, all, 1e-12);
  const double volume = 1e-9 * work / 0.3;
  CHECK_NEAR(lost, volume, 0.1 * volume);
  CHECK_NEAR(lost, 1e-9 * all / 0.3, 1e-3 * lost); /* all of it slips */
  print_message("worn volume %.4g of %.4g m3\n", lost, volume);
  CHECK_NEAR(now_of(scene, "load.worn_volume"), lost, 1e-12 * lost);
  CHECK_NEAR(now_of(scene, "load.worn_depth"), deepest, 0);
}

/* A box set on a belt slides until it has the belt's speed: v = mu g t, then v stays. */
static void belt(void **state) {
  (void)state;
  scree_scene *scene = create(
      "time: 1\n"
      "materials: {m: {young: 1e5, density: 500, restitution: 0.1, friction: 0.3}}\n"
      "pairs: [{between: [m, m], wear: 1e-9}]\n"
      "shapes: {box: {box: [0.06, 0.06, 0.02]}}\n"
      "geometry: {belt: {box: [4, 0.4, 0.1], at: [0, 0, -0.05], surface_velocity: [0.6, 0, 0]}}\n"
      "inlets: {i: {box: {min: [-0.031, -0.031, 0.0001], max: [0.031, 0.031, 0.0212]}, shapes: "
      "box, "
      "count: 1, orientation: fixed}}\n"
      "sensors: {load: {wall: belt}}\n");
  run_until(scene, 0.05); /* it has landed */
  double begin = body_of(scene, 0).velocity[0];
  run_until(scene, 0.15);
  double after = body_of(scene, 0).velocity[0];
  CHECK_NEAR((after - begin) / 0.1, 0.3 * g, 0.02 * 0.3 * g);
  run_until(scene, 0.6 / (0.3 * g) + 0.15);
  CHECK_NEAR(body_of(scene, 0).velocity[0], 0.6, 0.006);
  double x = body_of(scene, 0).position[0];
  run_until(scene, 0.9);
  double moved = body_of(scene, 0).position[0] - x, time = 0.9 - (0.6 / (0.3 * g) + 0.15);
  CHECK_NEAR(moved / time, 0.6, 0.003);
  check_wear(scene);
  scree_scene_free(scene);
}

/* A plate that is tilted lets a block go at tan(angle) = mu. */
static void tilted_plate(void **state) {
  (void)state;
  static const double mu[] = {0.2, 0.5};
  for (int i = 0; i < 2; i++) {
    char text[1000];
    snprintf(text, sizeof text,
             "time: 8\n"
             "materials: {m: {young: 1e6, density: 500, restitution: 0.1, friction: %g}}\n"
             "shapes: {block: {box: [0.06, 0.06, 0.01]}}\n"
             "geometry: {plate: {box: [1, 0.4, 0.1], at: [0, 0, -0.05], motion: [{rotate: {axis: "
             "[0, 1, 0], through: [0, 0, 0], speed: 0.1}, from: 0.2}]}}\n"
             "inlets: {i: {box: {min: [-0.031, -0.031, 0.0001], max: [0.031, 0.031, 0.0112]}, "
             "shapes: block, count: 1, orientation: fixed}}\n",
             mu[i]);
    scree_scene *scene = create(text);
    double angle = 0, slid = 0, begin = 0;
    run_until(scene, 0.2);
    begin = body_of(scene, 0).position[0];
    while (fabs(slid) < 1e-5 && angle < 1) {
      double turn[4];
      run_until(scene, scree_world_time(scree_scene_view(scene)) + 0.005);
      scree_body b = body_of(scene, 0);
      scree_world_wall_orientation(scree_scene_view(scene), 0, turn);
      angle = 2 * atan2(turn[2], turn[0]);
      slid = b.position[0] * cos(angle) - b.position[2] * sin(angle) - begin; /* along the plate */
    }
    CHECK_NEAR(angle * 57.29577951308232, atan(mu[i]) * 57.29577951308232, 0.5);
    scree_scene_free(scene);
  }
}

/* A plate that swings up and down throws a ball when it slows down faster than gravity would: with
 * A w^2 > g at z = g / w^2 above the middle, at the speed that the plate has there. */
static void shaken_plate(void **state) {
  (void)state;
  const double amplitude = 0.01, frequency = 12, w = 2 * 3.14159265358979 * frequency;
  scree_scene *scene =
      create("time: 1\n"
             "materials: {m: {young: 1e7, density: 1000, restitution: 0.05, friction: 0.3}}\n"
             "shapes: {ball: {sphere: 0.02}}\n"
             "geometry: {plate: {box: [0.2, 0.2, 0.1], at: [0, 0, -0.05], motion: [{vibrate: "
             "{along: [0, 0, "
             "1], amplitude: 0.01, frequency: 12, phase: -1.5707963267948966}, from: 0.3}]}}\n"
             "inlets: {i: {box: {min: [-0.0101, -0.0101, 0.00001], max: [0.0101, 0.0101, 0.0204]}, "
             "shapes: "
             "ball, count: 1}}\n");
  run_until(scene, 0.3);
  double rest = body_of(scene, 0).position[2], top = 0;
  while (scree_world_time(scree_scene_view(scene)) < 0.3 + 0.25) {
    run_until(scene, scree_world_time(scree_scene_view(scene)) + 2e-4);
    double z = body_of(scene, 0).position[2] - rest;
    if (z < top - 1e-3) break;
    top = fmax(top, z);
  }
  double leaves = g / (w * w), speed = w * sqrt(amplitude * amplitude - leaves * leaves);
  double height = amplitude + leaves + speed * speed / (2 * g); /* it began at its lowest */
  CHECK_NEAR(top, height, 0.01 * height);
  scree_scene_free(scene);
}

/* All that came into a hopper leaves it, whether its mesh is a sheet or a closed solid. */
static void discharge(void **state) {
  (void)state;
  static const char *const walls[] = {
      "funnel: {cylinder: {radius: 0.03, length: 0.1}, at: [0, 0, 0.02]}",
      "a: {box: [0.02, 0.1, 0.1], at: [-0.04, 0, 0.07]}, b: {box: [0.02, 0.1, 0.1], at: [0.04, 0, "
      "0.07]}, c: {box: [0.06, 0.02, 0.1], at: [0, -0.04, 0.07]}, d: {box: [0.06, 0.02, 0.1], at: "
      "[0, 0.04, 0.07]}"};
  for (int i = 0; i < 2; i++) {
    char text[1400];
    snprintf(
        text, sizeof text,
        "time: 2\n"
        "materials: {m: {young: 1e5, density: 1000, restitution: 0.3, friction: 0.3}}\n"
        "shapes: {ball: {sphere: 0.008}}\n"
        "geometry: {%s, gate: {box: [0.1, 0.1, 0.01], at: [0, 0, 0.014], motion: [{translate: "
        "{velocity: [1, 0, 0]}, from: 0.3}]}}\n"
        "inlets: {i: {cylinder: {at: [0, 0, 0.05], radius: 0.029, length: 0.07}, shapes: ball, "
        "count: 60}}\n"
        "outlets: {o: {box: {min: [-2, -2, -1], max: [4, 2, -0.05]}}}\n"
        "sensors: {f: {flow: {through: [0, 0, 0], normal: [0, 0, -1]}}}\n"
        "stop: {empty: true}\n",
        walls[i]);
    scree_scene *scene = create(text);
    run_until(scene, 3);
    scree_scene_book b;
    scree_scene_get_book(scene, &b);
    assert_string_equal(scree_scene_end(scene), "empty");
    assert_int_equal(b.left_count, 60);
    CHECK_NEAR(b.left_mass, b.entered_mass, 1e-12);
    CHECK_NEAR(b.ledger, 0, 1e-2);
    size_t rows, columns = scree_scene_column_count(scene), k = 0;
    const double *series = scree_scene_series(scene, &rows);
    while (strcmp(scree_scene_column_name(scene, k), "f.count") != 0) k++;
    CHECK_NEAR(series[(rows - 1) * columns + k], 60, 0);
    scree_scene_free(scene);
  }
}

typedef double vector[3];

/* Puts the bodies on a lattice that fills a lying drum up to a surface at the angle; answers how
 * many it took. NULL: only counts. */
static size_t fill_drum(scree_scene *scene, const vector axis, const vector up, double angle) {
  const double pitch = 0.01, radius = 0.1, surface = -0.02;
  const vector across = {up[1] * axis[2] - up[2] * axis[1], up[2] * axis[0] - up[0] * axis[2],
                         up[0] * axis[1] - up[1] * axis[0]};
  size_t count = 0;
  for (int i = -10; i <= 10; i++)
    for (int j = 0; j < 10; j++)
      for (int k = -2; k <= 2; k++) {
        double s = pitch * i, h = surface - 0.005 - pitch * j;
        if (s * s + h * h > radius * radius) continue;
        scree_body body = scree_default_body();
        scree_error error;
        for (int m = 0; m < 3; m++)
          body.position[m] = (s * cos(angle) - h * sin(angle)) * across[m] +
                             (s * sin(angle) + h * cos(angle)) * up[m] + pitch * k * axis[m];
        body.orientation[0] = cos(count), body.orientation[1] = sin(count);
        if (scene)
          CHECK_OK(scree_world_set_body(scree_scene_world(scene), count, &body, &error), error);
        count++;
      }
  return count;
}

/* The surface of balls and boxes in a drum is found at its angle, whatever the drum's axis and
 * whichever way is up. */
static void surface(void **state) {
  (void)state;
  static const struct {
    vector axis, up;
    double angle;
  } rows[] = {{{0, 1, 0}, {0, 0, 1}, 0},    {{0, 1, 0}, {0, 0, 1}, 0.4},
              {{0, -1, 0}, {0, 0, 1}, 0.4}, {{1, 0, 0}, {0, 0, 1}, -0.3},
              {{0, 0, 1}, {0, 1, 0}, 0.5},  {{0, 1, 0}, {0, 0, -1}, 0.2}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    const double *a = rows[i].axis, *u = rows[i].up;
    char text[800];
    snprintf(text, sizeof text,
             "time: 1\n"
             "gravity: [%g, %g, %g]\n"
             "shapes: {ball: {sphere: 0.01}, box: {box: [0.008, 0.008, 0.008]}}\n"
             "inlets: {i: {box: {min: [-1, -1, -1], max: [1, 1, 1]}, shapes: [ball, box], count: "
             "%zu}}\n"
             "sensors: {s: {slope: {axis: [%g, %g, %g]}}}\n",
             -g * u[0], -g * u[1], -g * u[2], fill_drum(NULL, a, u, 0), a[0], a[1], a[2]);
    scree_scene *scene = create(text);
    run_until(scene, 1e-9);
    fill_drum(scene, a, u, rows[i].angle);
    CHECK_NEAR(now_of(scene, "s.angle_deg"), 57.29577951308232 * rows[i].angle, 1);
    scree_scene_free(scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(belt),      cmocka_unit_test(tilted_plate), cmocka_unit_test(shaken_plate),
      cmocka_unit_test(discharge), cmocka_unit_test(surface),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
