/* L8: what hits fast must neither pass through nor stick. Two bodies meet head-on at 7.7 and 15.4
 * m/s, with random shifts and turns about the meeting that is named. Afterwards they must have come
 * apart, with no corner of one inside the other. */
#include "support/law.h"

#include "support/hits.h"
#include "support/shapes.h"
#include "support/solids.h"

enum { TRIES = 60, SQUARE_TRIES = 600, SHARP_TRIES = 200 };

static const double degree = 3.14159265358979323846 / 180;

static void nothing_passes_or_sticks(void **state) {
  (void)state;
  const quat none = {1, 0, 0, 0};
  quat quarter = quat_from_rotation_vector((vec3){0, 0, 90 * degree}),
       on_edge = quat_from_rotation_vector((vec3){45 * degree, 0, 0}),
       crossed = quat_mul(quarter, on_edge),
       on_corner = quat_from_rotation_vector((vec3){45 * degree, 35 * degree, 0}),
       notch_up = quat_from_rotation_vector((vec3){90 * degree, 0, 0}),
       hook_down = quat_from_rotation_vector((vec3){-90 * degree, 0, 0});
  scree_particle *bar = shape_particle(shape_box(0.1, 0.012, 0.012)),
                 *cube = shape_particle(shape_box(0.04, 0.04, 0.04)),
                 *plate = shape_particle(shape_grid_box(0.1, 0.06, 0.015, 3)),
                 *notch = shape_particle(solid_notch(0.06, 30 * degree, 0.05)),
                 *hook = shape_particle(solid_hook(0.06, 0.014, 0.02)),
                 *stick = shape_particle(shape_box(0.01, 0.08, 0.01));
  const law_meeting meetings[] = {
      {"crossed edges of bars", bar, bar, crossed, on_edge, 0.003, 0.2, 0},
      {"crossed bars, faces", bar, bar, quarter, none, 0.003, 0.2, 0},
      {"corner on face", cube, plate, on_corner, none, 0.003, 0.3, 0},
      {"plate on plate", plate, plate, none, none, 0.003, 0.02, 0},
      {"plate on plate, squarely", plate, plate, none, none, 0, 0, 0},
      {"bar into notch", stick, notch, none, notch_up, 0.004, 0.2, 0},
      {"edge of a cube into notch", cube, notch, on_edge, notch_up, 0.004, 0.2, 0},
      {"hooks", hook, hook, hook_down, notch_up, 0.01, 0.3, 0.02},
      {"hooks, any way", hook, hook, none, none, 0.02, 3.1, 0},
  };
  for (size_t i = 0; i < sizeof meetings / sizeof *meetings; i++)
    for (int fast = 0; fast < 2; fast++) {
      law_outcome out = {0};
      uint64_t tries = meetings[i].upper == plate && meetings[i].shift > 0 ? SQUARE_TRIES : TRIES;
      for (uint64_t k = 0; k < tries; k++) law_meet(&meetings[i], fast ? 15.4 : 7.7, k, &out);
      char what[80];
      snprintf(what, sizeof what, "%s, %g m/s: passed through", meetings[i].name,
               fast ? 15.4 : 7.7);
      LAW_NEAR("L8", what, (double)out.through, 0, 0);
      LAW_NEAR("L8", "stuck", (double)out.stuck, 0, 0);
      LAW_NEAR("L8", "stopped beyond the overlap limit", (double)out.stopped, 0, 0);
    }
  scree_particle *all[] = {bar, cube, plate, notch, hook, stick};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) scree_particle_free(all[i]);
}

/* Walls thinner than the overlap: a corner that has come out on their other side must be pushed
 * back the way it came. */
static void a_thin_wall_is_not_pierced(void **state) {
  (void)state;
  const quat none = {1, 0, 0, 0},
             on_corner = quat_from_rotation_vector((vec3){45 * degree, 35 * degree, 0}),
             open_down = quat_from_rotation_vector((vec3){180 * degree, 0, 0});
  scree_particle *cube = shape_particle(shape_box(0.04, 0.04, 0.04)),
                 *tray = shape_particle(solid_tray(0.1, 0.06, 0.015, 0.0006));
  const law_meeting meetings[] = {
      {"corner into a thin tray", cube, tray, on_corner, none, 0.003, 0.3, 0},
      {"corner onto a thin tray's bottom", cube, tray, on_corner, open_down, 0.003, 0.3, 0},
  };
  for (size_t i = 0; i < sizeof meetings / sizeof *meetings; i++) {
    law_outcome out = {0};
    for (uint64_t k = 0; k < TRIES; k++) law_meet(&meetings[i], 6, k, &out);
    LAW_NEAR("L8", meetings[i].name, (double)out.through, 0, 0);
    LAW_NEAR("L8", "stuck", (double)out.stuck, 0, 0);
    LAW_NEAR("L8", "stopped beyond the overlap limit", (double)out.stopped, 0, 0);
  }
  scree_particle_free(cube);
  scree_particle_free(tray);
}

/* Edges that a step takes past each other over more than their roundings. */
static void crossed_edges_are_not_lost_between_steps(void **state) {
  (void)state;
  const quat quarter = quat_from_rotation_vector((vec3){0, 0, 90 * degree}),
             on_edge = quat_from_rotation_vector((vec3){45 * degree, 0, 0});
  scree_particle *bar = shape_particle(shape_box(0.1, 0.012, 0.012));
  const law_meeting meeting = {
      "crossed edges of bars", bar, bar, quat_mul(quarter, on_edge), on_edge, 0.003, 0.2, 0};
  law_outcome out = {.follow = true};
  for (uint64_t k = 0; k < TRIES; k++) law_meet(&meeting, 25, k, &out);
  LAW_NEAR("L8", "crossed edges of bars, 25 m/s: passed through", (double)out.through, 0, 0);
  LAW_NEAR("L8", "stuck", (double)out.stuck, 0, 0);
  LAW_NEAR("L8", "stopped beyond the overlap limit", (double)out.stopped, 0, 0);
  LAW_BELOW("L8", "lay unfelt inside the other, m", out.unfelt, 0);
  scree_particle_free(bar);
}

/* A cube without thin walls, so fast that it is on one side of a thin tray's bottom in one step and
 * on the other in the next, at rest itself or moving. */
static void what_passes_a_thin_wall_between_steps_stops(void **state) {
  (void)state;
  scree_particle *cube = shape_particle(shape_box(0.04, 0.04, 0.04)),
                 *tray = shape_particle(solid_tray(0.1, 0.06, 0.015, 0.0006));
  const law_setup setup = law_default();
  for (int moves = 0; moves < 2; moves++) {
    scree_world *world = law_world(&setup);
    scree_body body = scree_default_body();
    law_body(world, cube, body);
    size_t lower = law_body(world, tray, body);
    double dt = scree_world_time_step(world, NULL), speed = 1e-3 / dt;
    body.velocity[2] = moves ? -speed : 0;
    body.position[2] = 0.05;
    law_place(world, 0, &body);
    body.velocity[2] = moves ? 0 : speed;
    body.position[2] = 0;
    law_place(world, lower, &body);
    scree_error error;
    assert_int_equal(scree_world_step(world, 200, &error), SCREE_DIVERGED);
    print_message("%s\n", error.message);
    assert_non_null(strstr(error.message, "body 0 moved past body 1 by more than "));
    scree_world_free(world);
  }
  scree_particle_free(cube);
  scree_particle_free(tray);
}

/* Sharp edges that meet fast: whatever features miss their depth makes felt. */
static void sharp_edges_are_felt(void **state) {
  (void)state;
  const double thin = 0.0008, slope = thin / tan(60 * degree),
               triangle[] = {0, 0, 0.04, 0, 0.04, 0.04},
               flange[] = {0,           0,    0.03, 0, 0.03, 0.03 - thin, 0.04 - slope,
                           0.03 - thin, 0.04, 0.03, 0, 0.03};
  const quat none = {1, 0, 0, 0}, up = quat_from_rotation_vector((vec3){0, 90 * degree, 0}),
             down = quat_mul(quat_from_rotation_vector((vec3){0, 0, 50 * degree}),
                             quat_from_rotation_vector((vec3){0, -90 * degree, 0}));
  scree_particle *prism = shape_particle(solid_prism(triangle, 3, 0.08)),
                 *angle = shape_particle(solid_prism(flange, 6, 0.03));
  const law_meeting meetings[] = {
      {"prisms of 45 degrees", prism, prism, none, none, 0.02, 3.1, 0},
      {"rims of flanges of 0.8 mm", angle, angle, up, down, 0.012, 0.5, 0},
  };
  for (size_t i = 0; i < sizeof meetings / sizeof *meetings; i++) {
    law_outcome out = {.follow = true};
    for (uint64_t k = 0; k < SHARP_TRIES; k++) law_meet(&meetings[i], 15.4, k, &out);
    LAW_NEAR("L8", meetings[i].name, (double)out.through, 0, 0);
    LAW_NEAR("L8", "stuck", (double)out.stuck, 0, 0);
    LAW_NEAR("L8", "lay unfelt inside the other, m", out.unfelt, 0, 0);
    LAW_NEAR("L8", "stopped", (double)out.stopped, 0, 0);
  }
  scree_particle_free(prism);
  scree_particle_free(angle);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_passes_or_sticks),
                                     cmocka_unit_test(a_thin_wall_is_not_pierced),
                                     cmocka_unit_test(crossed_edges_are_not_lost_between_steps),
                                     cmocka_unit_test(sharp_edges_are_felt),
                                     cmocka_unit_test(what_passes_a_thin_wall_between_steps_stops)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
