/* Bodies on the rims of open walls, which they fall onto and slide over, which lift them, are drawn
 * up along them and pressed down on them. The ledger closes, nothing is left in a sheet, and none
 * hangs that nothing holds. The material is soft, a tenth of the default, so that rims press deep.
 * With `full` ten times as many. */
#include "support/law.h"

#include "base/rng.h"
#include "base/vec.h"
#include "particle/closest.h"
#include "support/shapes.h"

enum { SIDES = 24, CUTS = 64, SAMPLES = 16 };
static const double pi = 3.14159265358979;
static const double half_width = 0.06, tall = 0.12, radius = 0.05, thickness = 3e-3;
static const double stiffness = 1e7;
/* Of the size: no body may be left deeper in a sheet than sharp corners reach out of their cores.
 */
static const double in_wall = 0.004;
static int more = 1;

typedef enum wall_kind { FLAT, ROUND, TUBE, WALLS } wall_kind; /* two meshes, and a cylinder */
typedef enum motion { FALL, SLIDE, LIFT, DRAW, PRESS, MOTIONS } motion;
static const char *const wall_names[WALLS] = {"two triangles", "open prism", "cylinder"},
                         *const motion_names[MOTIONS] = {"falls", "slides", "is lifted",
                                                         "is let go below", "is pressed"};

/* ---- shapes ---- */

static scree_mesh flat_sheet(void) {
  const double w = half_width, corners[] = {-w, 0, -tall, w, 0, -tall, w, 0, 0, -w, 0, 0};
  static const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  scree_mesh mesh = shape_make(4, 2);
  memcpy(mesh.positions, corners, sizeof corners);
  memcpy(mesh.triangles, triangles, sizeof triangles);
  return mesh;
}

/* Rings of `sides` corners, ring k of (radius, height) in `profile`; joined to the next, and the
 * last to the first where it is closed. */
static scree_mesh ring_mesh(uint32_t sides, const double (*profile)[2], uint32_t rings,
                            bool closed) {
  uint32_t bands = closed ? rings : rings - 1;
  scree_mesh mesh = shape_make((size_t)sides * rings, (size_t)2 * sides * bands);
  uint32_t *to = mesh.triangles;
  for (uint32_t i = 0; i < sides; i++) {
    double angle = 2 * pi * (i + 0.5) / sides;
    for (uint32_t k = 0; k < rings; k++) {
      double *p = &mesh.positions[3 * (rings * i + k)];
      p[0] = profile[k][0] * cos(angle), p[1] = profile[k][0] * sin(angle), p[2] = profile[k][1];
    }
    uint32_t a = rings * i, b = rings * ((i + 1) % sides);
    for (uint32_t k = 0; k < bands; k++, to += 6) {
      uint32_t n = (k + 1) % rings;
      const uint32_t two[6] = {a + k, b + k, a + n, b + k, b + n, a + n};
      memcpy(to, two, sizeof two);
    }
  }
  return mesh;
}

static scree_mesh round_sheet(double r) {
  const double profile[][2] = {{r, -tall}, {r, 0}};
  return ring_mesh(SIDES, profile, 2, false);
}

static scree_mesh square_frame(void) {
  const double outer = 0.04 / sqrt(2), inner = 0.028 / sqrt(2),
               profile[][2] = {{inner, 0}, {outer, 0}, {outer, thickness}, {inner, thickness}};
  return ring_mesh(4, profile, 4, true);
}

/* A sample of 22 mm at 60 triangles. */
static scree_mesh decimated(const char *name) {
  scree_error error;
  scree_mesh mesh, level;
  scree_curve *curve = NULL;
  double area, volume;
  scree_sample_options o = scree_default_sample_options();
  const scree_simplify_options by = scree_default_simplify_options();
  o.resolution = 1.5e-3;
  o.noise = 0;
  CHECK_OK(scree_sample_make(name, &o, NULL, &mesh, &error), error);
  CHECK_OK(scree_mesh_area_volume(&mesh, &area, &volume, &error), error);
  double factor = 0.022 / cbrt(6 * volume / pi);
  for (size_t i = 0; i < 3 * mesh.vertex_count; i++) mesh.positions[i] *= factor;
  CHECK_OK(scree_curve_build(&mesh, &by, NULL, &curve, &error), error);
  CHECK_OK(scree_curve_mesh(curve, scree_curve_find(curve, 60), &level, &error), error);
  scree_curve_free(curve);
  scree_mesh_free(&mesh);
  return level;
}

/* ---- how deep a body and a sheet are in each other, by every edge against every triangle ---- */

typedef struct placed {
  const scree_mesh *mesh;
  vec3 at[256]; /* vertices in space */
} placed;

static vec3 corner_of(const placed *p, size_t triangle, size_t k) {
  return p->at[p->mesh->triangles[3 * triangle + k % 3]];
}

/* Where the way d from a passes through a triangle, as a share of it; false for nowhere. */
static bool pierces(vec3 a, vec3 d, const placed *p, size_t triangle, double *share) {
  vec3 o = corner_of(p, triangle, 0), e1 = vec3_sub(corner_of(p, triangle, 1), o),
       e2 = vec3_sub(corner_of(p, triangle, 2), o), h = vec3_cross(d, e2);
  double det = vec3_dot(e1, h); /* Moeller and Trumbore 1997 */
  if (det == 0) return false;
  vec3 s = vec3_sub(a, o), q = vec3_cross(s, e1);
  double u = vec3_dot(s, h) / det, v = vec3_dot(d, q) / det;
  *share = vec3_dot(e2, q) / det;
  return u >= 0 && v >= 0 && u + v <= 1 && *share >= 0 && *share <= 1;
}

static double distance_to_segment(vec3 a, vec3 b, vec3 x) {
  vec3 d = vec3_sub(b, a);
  double s = vec3_dot(vec3_sub(x, a), d) / vec3_norm2(d);
  return vec3_distance(x, vec3_mad(a, d, fmin(fmax(s, 0), 1)));
}

static double distance_to(const placed *p, vec3 x) {
  double best = INFINITY;
  for (size_t t = 0; t < p->mesh->triangle_count; t++) {
    vec3 a = corner_of(p, t, 0), u = vec3_sub(corner_of(p, t, 1), a),
         n = vec3_unit(vec3_cross(u, vec3_sub(corner_of(p, t, 2), a)));
    bool over = true; /* it */
    for (size_t k = 0; k < 3; k++) {
      vec3 from = corner_of(p, t, k), to = corner_of(p, t, k + 1);
      over &= vec3_dot(vec3_cross(n, vec3_sub(to, from)), vec3_sub(x, from)) >= 0;
      best = fmin(best, distance_to_segment(from, to, x));
    }
    if (over) best = fmin(best, fabs(vec3_dot(vec3_sub(x, a), n)));
  }
  return best;
}

static bool is_rim(const scree_mesh *mesh, uint32_t from, uint32_t to) {
  for (size_t t = 0; t < mesh->triangle_count; t++)
    for (size_t k = 0; k < 3; k++)
      if (mesh->triangles[3 * t + k] == to && mesh->triangles[3 * t + (k + 1) % 3] == from)
        return false;
  return true;
}

/* From an edge of a body. */
static double distance_to_rim(const placed *sheet, vec3 a, vec3 way) {
  double best = INFINITY, length = vec3_norm(way), s, t;
  vec3 along = vec3_unit(way);
  const uint32_t *corners = sheet->mesh->triangles;
  for (size_t i = 0; i < 3 * sheet->mesh->triangle_count; i++) {
    uint32_t from = corners[i], to = corners[i % 3 == 2 ? i - 2 : i + 1];
    if (!is_rim(sheet->mesh, from, to)) continue;
    vec3 start = sheet->at[from], rim = vec3_sub(sheet->at[to], start), rim_along = vec3_unit(rim);
    scree_closest_on_segments(a, along, length, start, rim_along, vec3_norm(rim), &s, &t);
    best = fmin(best, vec3_distance(vec3_mad(a, along, s), vec3_mad(start, rim_along, t)));
  }
  return best;
}

static double farthest(const placed *sheet, vec3 a, vec3 way, double from, double to) {
  double most = 0;
  for (int j = 0; j <= SAMPLES; j++)
    most = fmax(most, distance_to(sheet, vec3_mad(a, way, from + (to - from) * j / SAMPLES)));
  return most;
}

static int ascending(const void *x, const void *y) {
  double a = *(const double *)x, b = *(const double *)y;
  return (a > b) - (a < b);
}

/* An edge that passes through the sheet is as deep in it as it reaches out on either side, or as it
 * is from the rim: moved by that it is off the sheet. */
static double depth_of_edge(vec3 a, vec3 way, const placed *sheet) {
  double cut[CUTS + 2] = {0}, deepest = 0;
  size_t n = 1;
  for (size_t t = 0; t < sheet->mesh->triangle_count && n < CUTS; t++)
    n += pierces(a, way, sheet, t, &cut[n]);
  cut[n] = 1;
  qsort(cut, n + 1, sizeof *cut, ascending);
  for (size_t i = 1; i < n; i++) {
    double reach = fmin(farthest(sheet, a, way, cut[i - 1], cut[i]),
                        farthest(sheet, a, way, cut[i], cut[i + 1]));
    deepest = fmax(deepest, fmin(reach, distance_to_rim(sheet, a, way)));
  }
  return deepest;
}

/* The points of an edge of the sheet that lie inside the body. */
static double depth_in_body(vec3 a, vec3 way, const placed *body) {
  double deepest = 0, share;
  bool any = false;
  for (size_t t = 0; t < body->mesh->triangle_count; t++) any |= pierces(a, way, body, t, &share);
  for (int j = 0; any && j <= CUTS; j++) {
    vec3 x = vec3_mad(a, way, (double)j / CUTS);
    const vec3 far = {17.31, 5.77, 11.93};
    size_t passed = 0;
    for (size_t t = 0; t < body->mesh->triangle_count; t++)
      passed += pierces(x, far, body, t, &share);
    if (passed % 2) deepest = fmax(deepest, distance_to(body, x));
  }
  return deepest;
}

static double depth_in_each_other(const placed *body, const placed *sheet) {
  double deepest = 0;
  for (size_t t = 0; t < body->mesh->triangle_count; t++)
    for (size_t k = 0; k < 3; k++) {
      vec3 a = corner_of(body, t, k), way = vec3_sub(corner_of(body, t, k + 1), a);
      deepest = fmax(deepest, depth_of_edge(a, way, sheet));
    }
  for (size_t t = 0; t < sheet->mesh->triangle_count; t++)
    for (size_t k = 0; k < 3; k++) {
      vec3 a = corner_of(sheet, t, k), way = vec3_sub(corner_of(sheet, t, k + 1), a);
      deepest = fmax(deepest, depth_in_body(a, way, body));
    }
  return deepest;
}

static void place(placed *p, const scree_mesh *mesh, const double position[3], const double *turn) {
  mat3 rotation = quat_to_mat3((quat){turn[0], turn[1], turn[2], turn[3]});
  p->mesh = mesh;
  assert_true(mesh->vertex_count <= sizeof p->at / sizeof *p->at);
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    vec3 x = mat3_mul_vec(&rotation, vec3_load(&mesh->positions[3 * v]));
    p->at[v] = vec3_add(x, vec3_load(position));
  }
}

/* Of body 0 in wall 0, over its size; 0 for a wall that is no mesh. */
static double share_in_wall(const scree_world *world) {
  scree_wall wall;
  scree_body body;
  scree_particle_measures m;
  static placed of_body, of_wall;
  const double upright[4] = {1, 0, 0, 0};
  scree_world_get_wall(world, 0, &wall);
  if (wall.kind != SCREE_WALL_MESH) return 0;
  scree_world_get_body(world, 0, &body);
  const scree_particle *particle = scree_world_body_particle(world, 0);
  scree_particle_measure(particle, &m);
  place(&of_body, scree_particle_mesh(particle), body.position, body.orientation);
  place(&of_wall, wall.mesh, wall.position, upright);
  return depth_in_each_other(&of_body, &of_wall) / m.size;
}

/* ---- one body and one wall ---- */

typedef struct run {
  scree_world *world;
  wall_kind kind;
  motion how;
  double up, lower_rim; /* m/s; of the wall when its position is 0 */
  double until;
  double before, came_in, potential, work, worst;
  bool presses, rises;
} run;

static scree_world *make_world(vec3 gravity) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  vec3_store(o.gravity, gravity);
  scree_world *world = NULL;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  scree_material m = scree_default_material();
  m.young = stiffness;
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  m.young = 1e3 * stiffness;
  CHECK_OK(scree_world_add_material(world, &m, NULL, &error), error);
  return world;
}

static double lowest_of(const scree_particle *particle, const double turn[4]) {
  static placed p;
  const double origin[3] = {0};
  double lowest = INFINITY;
  place(&p, scree_particle_mesh(particle), origin, turn);
  for (size_t v = 0; v < p.mesh->vertex_count; v++) lowest = fmin(lowest, p.at[v].z);
  return lowest;
}

/* The rims of a wall are at z = 0 and below; a body comes over one of them, at random. */
static run begin(wall_kind kind, const scree_mesh *mesh, scree_particle *particle, motion how,
                 uint64_t number) {
  scree_error error;
  scree_rng rng = {.seed = number};
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  double angle = kind == FLAT ? 0.5 * pi : 2 * pi * scree_rng_uniform(&rng), r = m.bounding_radius,
         beside = 2 * scree_rng_uniform(&rng) - 1, pace = scree_rng_uniform(&rng),
         up = 0.1 + 0.2 * scree_rng_uniform(&rng),
         along = kind == FLAT ? half_width * (2 * scree_rng_uniform(&rng) - 1) : 0;
  const vec3 out = {cos(angle), sin(angle), 0};
  vec3 gravity = {0, 0, -9.81}, velocity = {0, 0, 0};
  if (how == DRAW) gravity = vec3_mad(gravity, out, 4);
  quat q = scree_rng_rotation(&rng);
  scree_body body = {.orientation = {q.w, q.x, q.y, q.z}};
  double lying = 1e-4 - lowest_of(particle, body.orientation), offset = 0.5 * r * beside,
         height = how == FALL ? r + 2e-3 : lying, at = how == PRESS ? tall + 2 * r + 2e-3 : 0;
  if (how == FALL) velocity.z = -0.6 - 2.4 * pace;
  if (how == SLIDE) velocity = vec3_scale(out, 1.2 + 2.4 * pace), height = 0.8 * r * beside;
  if (how == SLIDE || how == DRAW) offset = -(r + 2e-3);
  if (how == DRAW) at = tall - 0.01;
  if (how == LIFT) at = -2e-3;
  run it = {.world = make_world(gravity), .kind = kind, .how = how, .up = up, .until = 1};
  if (how >= LIFT) it.until = (how == PRESS ? 0.4 + 2 * r / up : 0.2) + 0.1 / up;
  scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = mesh};
  it.lower_rim = -tall;
  if (kind == TUBE) {
    wall.kind = SCREE_WALL_CYLINDER, wall.radius = radius, wall.length = tall;
    it.lower_rim = 0, at -= tall;
  }
  wall.position[2] = at;
  wall.velocity[2] = how == LIFT || how == DRAW ? up : 0;
  CHECK_OK(scree_world_add_wall(it.world, &wall, NULL, &error), error);
  if (how >= LIFT) law_floor(it.world);
  vec3 side = {-out.y, out.x, 0},
       from = vec3_mad(vec3_scale(out, offset + (kind == FLAT ? 0 : radius)), side, along);
  from.z = height;
  vec3_store(body.position, from);
  vec3_store(body.velocity, velocity);
  law_body(it.world, particle, body);
  return it;
}

/* The wall comes down until its rim presses by a twentieth of the body's size, then goes up. */
static void lead_wall(run *it, const scree_observation *o) {
  scree_error error;
  scree_wall wall;
  scree_particle_measures m;
  const double still[3] = {0}, down[3] = {0, 0, -it->up}, up[3] = {0, 0, it->up};
  scree_world_get_wall(it->world, 0, &wall);
  scree_particle_measure(scree_world_body_particle(it->world, 0), &m);
  bool deep = o->largest_overlap > 0.05 * m.size || wall.position[2] + it->lower_rim < 2e-4;
  if (!it->presses && o->time > 0.2) {
    it->presses = true;
    CHECK_OK(scree_world_set_wall_velocity(it->world, 0, down, still, &error), error);
  } else if (it->presses && !it->rises && deep) {
    it->rises = true;
    CHECK_OK(scree_world_set_wall_velocity(it->world, 0, up, still, &error), error);
  }
}

static void follow(run *it) {
  scree_observation o;
  scree_particle_measures m;
  scree_particle_measure(scree_world_body_particle(it->world, 0), &m);
  law_step(it->world, 1);
  it->before = law_ledger(it->world, &o);
  it->potential = o.potential, it->work = o.wall_work;
  it->came_in = o.kinetic + scree_world_body_mass(it->world, 0) * 9.81 * m.size;
  for (scree_body body = {.position = {0}};
       scree_world_time(it->world) < it->until && body.position[2] > -tall - 0.05;) {
    law_step(it->world, 50);
    double now = law_ledger(it->world, &o);
    it->came_in += fmax(0, it->potential - o.potential) + fabs(o.wall_work - it->work);
    it->potential = o.potential, it->work = o.wall_work;
    it->worst = fmax(it->worst, fabs(now - it->before) / it->came_in);
    scree_world_get_body(it->world, 0, &body);
    if (it->how == PRESS) lead_wall(it, &o);
  }
}

static bool count_on_wall(void *context, const scree_contact *contact) {
  *(size_t *)context += contact->wall && contact->other == 0;
  return true;
}

/* Whether it is on the wall's rim, in the end, and not on the floor. */
static bool hangs(const run *it) {
  scree_error error;
  scree_body body;
  scree_particle_measures m;
  size_t touches = 0;
  scree_particle_measure(scree_world_body_particle(it->world, 0), &m);
  scree_world_get_body(it->world, 0, &body);
  CHECK_OK(scree_world_visit_contacts(it->world, count_on_wall, &touches, &error), error);
  return touches > 0 && (it->how < LIFT || body.position[2] > 1.3 * m.bounding_radius);
}

typedef struct tally {
  double mean, worst, deepest;
  size_t runs, hanging;
} tally;

static void try_many(wall_kind kind, const scree_mesh *mesh, scree_particle *particle, motion how,
                     bool may_hang, tally *t) {
  static const int tries[MOTIONS] = {8, 8, 2, 2, 6};
  for (int i = 0; i < tries[how] * more; i++) {
    run it = begin(kind, mesh, particle, how, 1000 + (uint64_t)i);
    follow(&it);
    t->mean += it.worst;
    t->worst = fmax(t->worst, it.worst);
    t->deepest = fmax(t->deepest, share_in_wall(it.world));
    t->hanging += !may_hang && hangs(&it);
    t->runs++;
    scree_world_free(it.world);
  }
}

static void bodies_on_rims(void **state) {
  (void)state;
  scree_mesh walls[WALLS] = {flat_sheet(), round_sheet(radius), {0}};
  scree_particle *shapes[] = {
      shape_particle(decimated("dc-2")), shape_particle(shape_box(0.04, 0.03, 0.0015)),
      shape_particle(shape_box(0.03, 0.02, 0.015)), shape_particle(square_frame())};
  enum { SHAPES = sizeof shapes / sizeof *shapes };
  for (int how = 0; how < MOTIONS; how++)
    for (int kind = 0; kind < WALLS; kind++) {
      tally t = {0};
      for (int s = 0; s < (how == PRESS ? 1 : SHAPES); s++) {
        /* a frame is caught by its hole, and a round rim holds what lies across it */
        bool may = s == SHAPES - 1 || (how != PRESS && kind != FLAT);
        try_many((wall_kind)kind, &walls[kind], shapes[s], (motion)how, may, &t);
      }
      print_message("%s, a body %s, %zu times\n", wall_names[kind], motion_names[how], t.runs);
      if (how != PRESS) { /* what two springs shoot away keeps no ledger */
        LAW_BELOW("L17", "ledger over what came in, worst", t.worst, kind == TUBE ? 5e-2 : 3e-2);
        LAW_BELOW("L17", "the same, mean", t.mean / (double)t.runs, 1.5e-3);
      }
      LAW_BELOW("-", "depth in the sheet in the end, over the size", t.deepest, in_wall);
      LAW_NEAR("-", "hang", (double)t.hanging, 0, 0);
    }
  for (int s = 0; s < SHAPES; s++) scree_particle_free(shapes[s]);
  scree_mesh_free(&walls[FLAT]);
  scree_mesh_free(&walls[ROUND]);
}

/* A pour into an open prism. In it edges that lie across each other's bodies turn until they have a
 * normal in common: they may not claim at once what lies between them. */
static void a_pour_wins_nothing(void **state) {
  (void)state;
  enum { LAYER = 3, BODIES = 48 };
  const double wide = 0.08;
  scree_error error;
  scree_mesh mesh = round_sheet(wide);
  scree_particle *device = shape_particle(decimated("dc-2"));
  scree_world *world = make_world((vec3){0, 0, -9.81});
  scree_wall wall = {.kind = SCREE_WALL_MESH, .material = 1, .axis = {0, 0, 1}, .mesh = &mesh};
  wall.position[2] = tall + 2e-4;
  CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  law_floor(world);
  scree_rng rng = {.seed = 1005};
  scree_rng_uniform(&rng);
  for (int i = 0; i < BODIES; i++) {
    quat q = scree_rng_rotation(&rng);
    double angle = 2.0944 * (i % LAYER) + 0.5 * (i / LAYER);
    scree_body body = {
        .position = {0.5 * wide * cos(angle), 0.5 * wide * sin(angle), 0.03 + 0.052 * (i / LAYER)},
        .orientation = {q.w, q.x, q.y, q.z},
        .velocity = {0, 0, -1}};
    law_body(world, device, body);
  }
  scree_observation o;
  law_step(world, 1);
  double before = law_ledger(world, &o), came_in = o.kinetic, start = o.potential, worst = 0;
  while (scree_world_time(world) < 0.21 * more) {
    law_step(world, 100);
    double now = law_ledger(world, &o);
    worst = fmax(worst, fabs(now - before) / (came_in + start - o.potential));
  }
  LAW_BELOW("L17", "pour into an open prism: ledger over what came in", worst, 5e-3);
  scree_world_free(world);
  scree_particle_free(device);
  scree_mesh_free(&mesh);
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "full") == 0) more = 10;
  const struct CMUnitTest tests[] = {cmocka_unit_test(bodies_on_rims),
                                     cmocka_unit_test(a_pour_wins_nothing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
