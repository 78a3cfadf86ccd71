/* Machine parts that forces move, against closed forms: a plate on a spring, a pendulum, a motor, a
 * press; what bodies and parts exchange stays on the ledger; a checkpoint goes on with the same
 * bits. */
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"
#include "support/scene.h"

static const double g = 9.81, pi = 3.14159265358979;

#define BALL                                                                                       \
  "materials: {m: {young: 5e6, density: 2500, restitution: %g, friction: 0.3}}\n"                  \
  "shapes: {ball: {sphere: 0.02}}\n"

/* s, between the first and the last time that a column rises through a value, over how often. */
static double period_of(const scree_scene *scene, const char *name, double level) {
  double first = NAN, last = NAN;
  int count = -1;
  for (size_t i = 1; i < row_count(scene); i++) {
    double a = at_row(scene, name, i - 1) - level, b = at_row(scene, name, i) - level;
    if (!(a < 0 && b >= 0)) continue;
    double ta = at_row(scene, "time", i - 1), tb = at_row(scene, "time", i);
    last = ta + (tb - ta) * a / (a - b);
    if (count++ < 0) first = last;
  }
  assert_true(count >= 2);
  return (last - first) / count;
}

static const char alone[] = "shapes: {ball: {sphere: 0.02}}\n"
                            "inlets: {i: {box: {min: [5, 5, 5], max: [5.1, 5.1, 5.1]}, shapes: "
                            "ball, count: 1}}\n"
                            "output: {series: 0.002}\n";

/* It falls by 2 m g/k and swings about half of that. */
static void plate_on_a_spring(void **state) {
  (void)state;
  char text[1500];
  const double m = 3, k = 1200;
  snprintf(text, sizeof text,
           "time: 2\n%s"
           "geometry: {plate: {box: [0.1, 0.1, 0.01], slide: {along: [0, 0, 1], mass: 3, spring: "
           "1.2 N/mm}}}\n"
           "sensors: {p: {part: plate}, at: {position: plate}}\n",
           alone);
  scree_scene *scene = create(text);
  double lowest = 0;
  run_to_end(scene);
  for (size_t i = 0; i < row_count(scene); i++) {
    lowest = fmin(lowest, at_row(scene, "p.way", i));
    CHECK_NEAR(at_row(scene, "at.z", i), at_row(scene, "p.way", i), 1e-9);
    CHECK_NEAR(at_row(scene, "p.energy", i), 0, 1e-4 * m * g * m * g / k);
  }
  CHECK_NEAR(lowest, -2 * m * g / k, 1e-4 * m * g / k);
  CHECK_NEAR(period_of(scene, "p.way", -m * g / k), 2 * pi * sqrt(m / k), 1e-4);
  scree_scene_free(scene);
}

/* T = T0 (1 + a^2/16 + 11 a^4/3072 + 173 a^6/737280), from a at rest. */
static void pendulum(void **state) {
  (void)state;
  char text[1500];
  const double a = 1, length = 0.3, inertia = 0.2, mass = 2;
  snprintf(text, sizeof text,
           "time: 5\n%s"
           "geometry: {door: {box: [0.02, 0.2, 0.6], at: [%.9g, 0, %.9g], turn: {axis: [0, 1, 0], "
           "angle_deg: %.9g}, hinge: {axis: [0, 1, 0], through: [0, 0, 1], inertia: 0.2, mass: 2, "
           "centre: [%.9g, 0, %.9g]}}}\n"
           "sensors: {p: {part: door}, at: {position: door}}\n",
           alone, -length * sin(a), 1 - length * cos(a), a * 180 / pi, -length * sin(a),
           1 - length * cos(a));
  scree_scene *scene = create(text);
  run_to_end(scene);
  double t = 2 * pi * sqrt(inertia / (mass * g * length)) *
             (1 + a * a / 16 + 11 * pow(a, 4) / 3072 + 173 * pow(a, 6) / 737280);
  CHECK_NEAR(period_of(scene, "at.x", 0), t, 1e-3 * t);
  for (size_t i = 0; i < row_count(scene); i++) /* on its circle */
    CHECK_NEAR(hypot(at_row(scene, "at.x", i), at_row(scene, "at.z", i) - 1), length, 1e-7);
  scree_scene_free(scene);
}

/* Torque against a damper: u = T/c (1 - exp(-c t/I)); from the moment it is let go, to its end. */
static void motor(void **state) {
  (void)state;
  char text[1500];
  snprintf(text, sizeof text,
           "time: 1.5\n%s"
           "geometry: {rotor: {box: [0.1, 0.1, 0.1], hinge: {axis: [0, 0, 2], inertia: 0.05, "
           "torque: 0.8, damper: 0.1, from: 0.25, most: 5}}}\n"
           "sensors: {p: {part: rotor}}\n",
           alone);
  scree_scene *scene = create(text);
  run_to_end(scene);
  bool stopped = false;
  for (size_t i = 0; i < row_count(scene); i++) {
    double t = fmax(0, at_row(scene, "time", i) - 0.25), way = at_row(scene, "p.way", i);
    stopped = stopped || way > 4.99;
    if (!stopped) CHECK_NEAR(at_row(scene, "p.speed", i), 8 * (1 - exp(-t * 0.1 / 0.05)), 0.01);
    assert_true(way < 5 + 1e-9);
    double balance = at_row(scene, "p.energy", i) + at_row(scene, "p.lost", i);
    CHECK_NEAR(balance, at_row(scene, "p.work", i), 1e-3);
  }
  assert_true(stopped);
  scree_scene_free(scene);
}

/* A press holds a ball on the floor with its force within 1 %. */
static void press(void **state) {
  (void)state;
  char text[1500];
  snprintf(text, sizeof text,
           "time: 1\n" BALL
           "geometry: {floor: {plane: [0, 0, 1]}, plate: {box: [0.1, 0.1, 0.01], at: [0, 0, 0.06], "
           "slide: {along: [0, 0, -1], servo: {force: 5 N, speed: 0.1}}}}\n"
           "inlets: {i: {box: {min: [-0.0102, -0.0102, 0.0001], max: [0.0102, 0.0102, 0.0305]}, "
           "shapes: ball, count: 1}}\n"
           "sensors: {p: {part: plate}}\n",
           0.3);
  scree_scene *scene = create(text);
  run_to_end(scene);
  CHECK_NEAR(at_row(scene, "p.force", row_count(scene) - 1), -5, 0.05);
  CHECK_NEAR(at_row(scene, "p.way", row_count(scene) - 1), 0.035 + 2 * 5 / 5e4, 1e-4);
  scree_scene_free(scene);
}

/* Balls fall on a plate on a spring, as heavy as some of them: what they give it, it has. */
static const char bed[] =
    "time: 0.8\n" BALL "geometry:\n"
    "  plate: {box: [0.2, 0.2, 0.02], at: [0, 0, -0.01], slide: {along: [0, 0, 1], mass: 0.1, "
    "spring: 300, rest: 0.003, damper: 1}}\n"
    "  flap: {box: [0.3, 0.01, 0.2], at: [0, 0.11, 0.1], hinge: {axis: [1, 0, 0], through: [0, "
    "0.11, 0.2], inertia: 0.001, mass: 0.05, centre: [0, 0.11, 0.1]}}\n"
    "inlets: {i: {box: {min: [-0.08, -0.08, 0.01], max: [0.08, 0.08, 0.3]}, shapes: ball, count: "
    "%d, velocity: [0, 0.5, 0]}}\n"
    "sensors: {p: {part: plate}, f: {part: flap}}\n"
    "domain: {min: [-1, -1, -1], max: [1, 1, 1]}\n";

static void ledger(void **state) {
  (void)state;
  for (int damped = 0; damped < 2; damped++) {
    char text[2000];
    scree_scene_book book;
    snprintf(text, sizeof text, bed, damped ? 0.5 : 1.0, 30);
    scree_scene *scene = create(text);
    run_to_end(scene);
    scree_scene_get_book(scene, &book);
    double moved[2] = {0, 0};
    for (size_t row = 0; row < row_count(scene); row++) {
      moved[0] = fmax(moved[0], fabs(at_row(scene, "p.way", row)));
      moved[1] = fmax(moved[1], fabs(at_row(scene, "f.way", row)));
    }
    assert_true(moved[0] > 1e-3 && moved[1] > 1e-3);
    CHECK_NEAR(book.ledger, 0, 1e-2);
    scree_scene_free(scene);
  }
}

static void resumed(void **state) {
  (void)state;
  char text[2000];
  scree_error error;
  snprintf(text, sizeof text, bed, 0.5, 30);
  scree_scene *whole = create(text), *part = create(text), *again;
  run_to_end(whole);
  CHECK_OK(scree_scene_advance(part, 12345, &error), error);
  CHECK_OK(scree_scene_save(part, in_folder("part.scree"), true, &error), error);
  scree_scene_free(part);
  CHECK_OK(scree_scene_load(in_folder("part.scree"), &again, &error), error);
  run_to_end(again);
  scree_checksum a = scree_world_hash(scree_scene_view(whole)),
                 b = scree_world_hash(scree_scene_view(again));
  assert_memory_equal(&a, &b, sizeof a);
  size_t last = row_count(whole) - 1;
  assert_int_equal(row_count(again) - 1, last);
  CHECK_NEAR(at_row(again, "f.way", last), at_row(whole, "f.way", last), 0);
  scree_scene_free(whole);
  scree_scene_free(again);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(plate_on_a_spring),
      cmocka_unit_test(pendulum),
      cmocka_unit_test(motor),
      cmocka_unit_test(press),
      cmocka_unit_test(ledger),
      cmocka_unit_test(resumed),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
