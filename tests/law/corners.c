/* Bodies thrown into the inner corners of walls and against their outer ones come back, whatever
 * the angle, the facets and their winding, open or closed: none is found beyond the wall, and the
 * ledger closes. With `full` twenty times as many. */
#include "support/law.h"

#include "support/plates.h"
#include "support/shapes.h"

enum { TRIES = 60, SHAPES = 4, MOMENTS = 200 };
static const double degree = 3.14159265358979 / 180, radius = 6e-3, speed = 2, reach = 0.12;
static const double ledger_share = 1e-3; /* of what came in, which few may exceed */
static const double worst_share = 0.03, may_exceed = 0.01; /* the latter: of the throws */
static int more = 1;

static const plates_body_kind kinds[SHAPES] = {PLATES_BALL, PLATES_CUBE, PLATES_STONE,
                                               PLATES_CLUMP};

/* A throw at a corner: from between its planes, or from around its edge. */
typedef struct throw_ {
  plates_corner corner;
  bool inner, turned;
  size_t facets;
  int shape;
} throw_;

static throw_ random_throw(scree_rng *rng) {
  throw_ t = {.inner = scree_rng_below(rng, 2), .shape = (int)scree_rng_below(rng, SHAPES)};
  t.corner = (plates_corner){.angle = degree * (20 + 150 * scree_rng_uniform(rng)),
                             .length = 0.2,
                             .width = 0.4,
                             .closed = scree_rng_below(rng, 2)};
  if (t.inner && t.corner.closed) t.corner.thick = 0.02;
  t.turned = !t.corner.closed && scree_rng_below(rng, 2);
  t.facets = (size_t)(4 * pow(1000, scree_rng_uniform(rng)));
  return t;
}

static void describe(const throw_ *t, uint64_t number, char text[160]) {
  static const char *const names[SHAPES] = {"ball", "cube", "stone", "clump"};
  snprintf(text, 160, "throw %llu: a %s at an %s corner of %.0f degrees, %s%s, %zu facets",
           (unsigned long long)number, names[t->shape], t->inner ? "inner" : "outer",
           t->corner.angle / degree, t->corner.closed ? "closed" : "open",
           t->turned ? ", turned" : "", t->facets);
}

static scree_body start_of(const throw_ *t, scree_rng *rng) {
  vec3 out = plates_bisector(&t->corner), to = {0, 0, 0}, aside = {1, 0, 0};
  double away = 1.4 * radius / sin(0.5 * t->corner.angle);
  if (!t->inner) {
    out = vec3_neg(out);
    away = 1.6 * radius;
    to = vec3_scale(vec3_cross(out, aside), 0.7 * radius * (2 * scree_rng_uniform(rng) - 1));
  }
  vec3 v = vec3_mad(vec3_scale(out, -1), scree_rng_direction(rng), t->inner ? 0.6 : 0.2),
       at = vec3_mad(to, out, away);
  quat q = scree_rng_rotation(rng);
  scree_body body = {.orientation = {q.w, q.x, q.y, q.z}};
  vec3_store(body.position, at);
  vec3_store(body.velocity, vec3_scale(vec3_unit(v), speed));
  vec3_store(body.angular_velocity, vec3_scale(scree_rng_direction(rng), 30));
  return body;
}

/* Whether the body's middle is where none may be: beyond a plane, or between them. */
static bool is_beyond(const throw_ *t, const scree_body *body) {
  double heights[2];
  plates_heights(&t->corner, vec3_load(body->position), heights);
  if (t->inner) return heights[0] < 0.2 * radius || heights[1] < 0.2 * radius;
  return heights[0] > 0 && heights[1] > 0;
}

static bool is_far(const scree_body *body) {
  return vec3_norm(vec3_load(body->position)) > reach;
}

typedef struct tally {
  size_t failures, off; /* off: the ledger, by more than its share */
  double worst;
} tally;

static void throw_one(uint64_t number, tally *all) {
  scree_rng rng = {.seed = 50, .stream = number};
  throw_ t = random_throw(&rng);
  law_setup setup = law_default();
  setup.stiffness = 1e7;
  scree_error error;
  scree_world *world = law_world(&setup);
  scree_mesh mesh = plates_make_corner(&t.corner);
  plates_split(&mesh, t.facets, &rng);
  if (t.turned) plates_turn(&mesh);
  scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = &mesh};
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  scree_particle *particle = plates_body(kinds[t.shape], radius, &rng);
  scree_body body = start_of(&t, &rng);
  size_t index = law_body(world, particle, body);
  char text[160];
  describe(&t, number, text);
  scree_observation o;
  scree_world_observe(world, &o);
  double came_in = o.kinetic + o.rotational, before = law_ledger(world, &o), off = 0;
  size_t steps = (size_t)(0.1 / scree_world_time_step(world, NULL) / MOMENTS) + 1;
  bool good = true;
  for (int i = 0; i < MOMENTS && good && !is_far(&body); i++) {
    good = scree_world_step(world, steps, &error) == SCREE_OK;
    if (!good) print_message("%s: %s\n", text, error.message);
    if (!good) break;
    scree_world_get_body(world, index, &body);
    off = fmax(off, fabs(law_ledger(world, &o) - before) / came_in);
    if (is_beyond(&t, &body)) good = false, print_message("%s: is beyond\n", text);
  }
  if (off > ledger_share) print_message("%s: the ledger is off by %.2g\n", text, off);
  all->worst = fmax(all->worst, off);
  all->off += off > ledger_share;
  all->failures += !good;
  scree_particle_free(particle);
  scree_world_free(world);
  scree_mesh_free(&mesh);
}

static void bodies_come_back_from_corners(void **state) {
  (void)state;
  tally all = {0};
  const size_t tries = (size_t)TRIES * (size_t)more;
  for (uint64_t i = 0; i < tries; i++) throw_one(i, &all);
  LAW_NEAR("-", "beyond the wall, or stopped", (double)all.failures, 0, 0);
  LAW_BELOW("L17", "share whose ledger is off", (double)all.off / (double)tries, may_exceed);
  LAW_BELOW("L17", "ledger over what came in, worst", all.worst, worst_share);
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "full") == 0) more = 20;
  const struct CMUnitTest tests[] = {cmocka_unit_test(bodies_come_back_from_corners)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
