/* Equipment of sheets, as a process engineer draws it: a drum with lifters, a bin with baffles, a
 * screw in a trough, a hopper. Plates that stand on others are sheets of their own. Stones, cubes
 * and balls in them run to the end: none is lost through a wall, and the ledger closes. With `full`
 * ten times as long. */
#include "support/law.h"

#include "support/plates.h"
#include "support/shapes.h"

enum { MOST_QUADS = 256, BODIES = 18, KINDS = 3, STEPS = 100 };
static const double pi = 3.14159265358979, radius = 6e-3, wide = 0.05; /* m; half the equipment */
static const double ledger_share = 3e-3; /* of all that changed its form */
static double longer = 1;

/* Sheets, side by side in one mesh. */
typedef struct sheets {
  scree_mesh mesh;
  size_t count;
} sheets;

static void add_sheet(sheets *to, const vec3 *corners, size_t quads) {
  scree_mesh sheet = plates_of(corners, quads), both;
  if (to->count++ == 0) {
    to->mesh = sheet;
    return;
  }
  both = shape_join(&to->mesh, &sheet);
  scree_mesh_free(&to->mesh);
  scree_mesh_free(&sheet);
  to->mesh = both;
}

static vec3 around(double r, double angle, double along) {
  return (vec3){r * cos(angle), along, r * sin(angle)};
}

/* Part of a tube about the y axis. */
static void add_shell(sheets *to, double r, double from, double until, int sides) {
  vec3 quads[4 * MOST_QUADS];
  for (int i = 0; i < sides; i++) {
    double a = from + (until - from) * i / sides, b = from + (until - from) * (i + 1) / sides;
    quads[4 * i] = around(r, a, -wide), quads[4 * i + 1] = around(r, b, -wide);
    quads[4 * i + 2] = around(r, b, wide), quads[4 * i + 3] = around(r, a, wide);
  }
  add_sheet(to, quads, (size_t)sides);
}

static sheets make_drum(void) {
  sheets s = {.count = 0};
  add_shell(&s, 0.06, 0, 2 * pi, 24);
  for (int k = 0; k < 6; k++) { /* every second the other way round */
    double angle = 2 * pi * k / 6, side = k % 2 ? 1 : -1;
    const vec3 lifter[4] = {around(0.06, angle, -side * wide), around(0.06, angle, side * wide),
                            around(0.042, angle + 0.2, side * wide),
                            around(0.042, angle + 0.2, -side * wide)};
    add_sheet(&s, lifter, 1);
  }
  return s;
}

/* Five sides of a box, their normals outward, and two slopes that stand on its sides. */
static sheets make_bin(void) {
  const double w = wide, h = 0.06;
  const vec3 a = {-w, -w, -h}, b = {w, -w, -h}, c = {w, w, -h}, d = {-w, w, -h}, e = {-w, -w, h},
             f = {w, -w, h}, g = {w, w, h}, i = {-w, w, h};
  const vec3 box[20] = {a, d, c, b, a, b, f, e, b, c, g, f, c, d, i, g, d, a, e, i},
             one[4] = {{-w, -w, 0.01}, {-w, w, 0.01}, {0, w, -0.02}, {0, -w, -0.02}},
             other[4] = {{w, -w, -0.01}, {w, w, -0.01}, {0.01, w, -0.045}, {0.01, -w, -0.045}};
  sheets s = {.count = 0};
  add_sheet(&s, box, 5);
  add_sheet(&s, one, 1);
  add_sheet(&s, other, 1);
  return s;
}

static sheets make_trough(void) {
  sheets s = {.count = 0};
  add_shell(&s, 0.06, pi, 2 * pi, 12);
  return s;
}

/* One turn about the y axis, as thin as a sheet, with room for a body between it and the trough,
 * and before the ends: what a screw pinches there, at less than the angle of friction, it
 * presses as hard as it takes (a_pinched_sphere_holds_and_is_named). */
static sheets make_screw(void) {
  enum { TURNS = 24 };
  const double half = wide - 2.5 * radius;
  vec3 quads[4 * TURNS];
  sheets s = {.count = 0};
  for (int i = 0; i < TURNS; i++) {
    double a = 2 * pi * i / TURNS, b = 2 * pi * (i + 1) / TURNS, p = half * (2.0 * i / TURNS - 1),
           q = half * (2.0 * (i + 1) / TURNS - 1);
    quads[4 * i] = around(0.01, a, p), quads[4 * i + 1] = around(0.044, a, p);
    quads[4 * i + 2] = around(0.044, b, q), quads[4 * i + 3] = around(0.01, b, q);
  }
  add_sheet(&s, quads, TURNS);
  return s;
}

/* Four slopes to a square opening, each a sheet; two of them wound the other way. */
static sheets make_hopper(void) {
  const double w = 0.055, o = 0.018, h = 0.05;
  sheets s = {.count = 0};
  const double corners[5][2] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}, {-1, -1}};
  for (int k = 0; k < 4; k++) {
    const double x[2] = {corners[k][0], corners[k + 1][0]},
                 y[2] = {corners[k][1], corners[k + 1][1]};
    const vec3 slope[8] = {{w * x[0], w * y[0], h},      {w * x[1], w * y[1], h},
                           {o * x[1], o * y[1], -h / 4}, {o * x[0], o * y[0], -h / 4},
                           {w * x[0], w * y[0], 0.15},   {w * x[1], w * y[1], 0.15},
                           {w * x[1], w * y[1], h},      {w * x[0], w * y[0], h}},
               turned[8] = {slope[3], slope[2], slope[1], slope[0],
                            slope[7], slope[6], slope[5], slope[4]};
    add_sheet(&s, k % 2 ? turned : slope, 2);
  }
  return s;
}

/* Whether a body may be there. */
static bool is_in_tube(vec3 p) {
  return hypot(p.x, p.z) < 0.06;
}
static bool is_in_trough(vec3 p) {
  return p.z > 0 || hypot(p.x, p.z) < 0.06;
}
static bool is_in_bin(vec3 p) {
  return fabs(p.x) < wide && fabs(p.y) < wide && p.z > -0.06;
}
static bool is_in_hopper(vec3 p) {
  double slope = (0.055 - 0.018) / 0.0625, half = 0.018 + slope * fmax(p.z + 0.0125, 0);
  return p.z < -0.0125 || (fabs(p.x) < fmin(half, 0.055) && fabs(p.y) < fmin(half, 0.055));
}

typedef struct equipment {
  const char *name;
  sheets (*make)(void), (*make_other)(void);
  bool (*holds)(vec3 p);
  double turns, other_turns; /* rad/s, about the y axis */
  double low;                /* where the bodies begin */
  bool ends;                 /* it has planes for ends */
} equipment;

static void add_equipment(scree_world *world, sheets (*make)(void), double turns) {
  scree_error error;
  sheets s = make();
  scree_wall wall = {.kind = SCREE_WALL_MESH,
                     .material = 1,
                     .axis = {0, 0, 1},
                     .angular_velocity = {0, turns, 0},
                     .mesh = &s.mesh};
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  scree_mesh_free(&s.mesh);
}

static void run(const equipment *e) {
  scree_error error;
  scree_rng rng = {.seed = 53};
  law_setup setup = law_default();
  setup.gravity = 9.81;
  setup.stiffness = 4e6;
  setup.steps_per_contact = 20;
  scree_world *world = law_world(&setup);
  add_equipment(world, e->make, e->turns);
  if (e->make_other) add_equipment(world, e->make_other, e->other_turns);
  for (int k = 0; e->ends && k < 2; k++) {
    double side = k ? 1 : -1;
    scree_wall end = {.kind = SCREE_WALL_PLANE,
                      .material = 1,
                      .position = {0, side * wide, 0},
                      .axis = {0, -side, 0}};
    CHECK_OK(scree_world_add_wall(world, &end, NULL, &error), error);
  }
  const double side = 2 * radius / sqrt(3);
  scree_particle *kinds[KINDS] = {law_sphere(radius), shape_particle(shape_box(side, side, side)),
                                  shape_particle(plates_stone(radius, &rng))};
  for (int i = 0; i < BODIES; i++) {
    quat q = scree_rng_rotation(&rng);
    scree_body body = {
        .position = {0.016 * (i % 3 - 1), 0.016 * (i / 3 % 3 - 1), e->low + 0.016 * (i / 9)},
        .velocity = {0, 0, -0.5},
        .orientation = {q.w, q.x, q.y, q.z}};
    law_body(world, kinds[i % KINDS], body);
  }
  scree_observation o;
  double before = law_ledger(world, &o), off = 0;
  size_t lost = 0;
  while (scree_world_time(world) < 0.15 * longer) {
    law_step(world, STEPS);
    off = fmax(off, fabs(law_ledger(world, &o) - before));
    for (size_t i = 0; i < BODIES; i++) {
      scree_body body;
      scree_world_get_body(world, i, &body);
      lost += !e->holds(vec3_load(body.position));
    }
  }
  double changed = o.dissipated_dashpot + o.dissipated_friction + o.kinetic + o.rotational;
  print_message("%s\n", e->name);
  LAW_NEAR("-", "moments at which a body was beyond a wall", (double)lost, 0, 0);
  LAW_BELOW("L17", "ledger over all that changed its form", off / changed, ledger_share);
  for (int k = 0; k < KINDS; k++) scree_particle_free(kinds[k]);
  scree_world_free(world);
}

static void bodies_stay_in_equipment(void **state) {
  (void)state;
  const equipment all[] = {
      {"drum with lifters", make_drum, NULL, is_in_tube, 4, 0, -0.01, true},
      {"bin with baffles", make_bin, NULL, is_in_bin, 0, 0, 0.03, false},
      {"screw in a trough", make_trough, make_screw, is_in_trough, 0, 4, 0.065, true},
      {"hopper of sheets", make_hopper, NULL, is_in_hopper, 0, 0, 0.06, false},
  };
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) run(&all[i]);
}

/* A wedge of ten degrees closes on a sphere that rests on the floor. With less friction than the
 * tangent of half its angle it slips out. With more it is held, with whatever force that takes,
 * and its springs harden, which is counted; the run ends when the wedge has gone through it. */
static void a_pinched_sphere_holds_and_is_named(void **state) {
  (void)state;
  const double slope = 10 * pi / 180;
  for (int holds = 0; holds < 2; holds++) {
    scree_error error;
    law_setup setup = law_default();
    setup.stiffness = 4e6;
    setup.friction = (holds ? 1.5 : 0.5) * tan(0.5 * slope);
    scree_world *world = law_world(&setup);
    scree_particle *sphere = law_sphere(radius);
    law_floor(world);
    const double along = radius / tan(0.5 * slope); /* of the wedge, to where the sphere touches */
    scree_wall lid = {.kind = SCREE_WALL_PLANE,
                      .material = 1,
                      .position = {-along, 0, 1e-5},
                      .axis = {sin(slope), 0, -cos(slope)},
                      .velocity = {0, 0, -0.02}};
    CHECK_OK(scree_world_add_wall(world, &lid, NULL, &error), error);
    law_body(world, sphere, (scree_body){.position = {0, 0, radius}, .orientation = {1, 0, 0, 0}});
    scree_observation o;
    double before = law_ledger(world, &o);
    while (scree_world_time(world) < 0.2) law_step(world, 100);
    double missed = fabs(law_ledger(world, &o) - before) / o.wall_work;
    assert_int_equal(o.hardened_count, holds ? 2 : 0);
    assert_true(holds ? o.stiffness_missing > 2 : o.stiffness_missing == 0);
    LAW_BELOW("L17", holds ? "a sphere that is held: ledger" : "one that slips out", missed, 1e-3);
    scree_status status = SCREE_OK;
    while (!status && scree_world_time(world) < 1) status = scree_world_step(world, 100, &error);
    assert_int_equal(status, holds ? SCREE_DIVERGED : SCREE_OK);
    if (holds) {
      print_message("%s\n", error.message);
      assert_non_null(strstr(error.message, "body 0 is pinched between wall"));
    }
    scree_world_free(world);
    scree_particle_free(sphere);
  }
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "full") == 0) longer = 10;
  const struct CMUnitTest tests[] = {cmocka_unit_test(bodies_stay_in_equipment),
                                     cmocka_unit_test(a_pinched_sphere_holds_and_is_named)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
