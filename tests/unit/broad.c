/* The broad phase against all pairs: bodies and a mesh wall, sizes over three decades, at rest and
 * in flight. Listed must be whoever's boxes and balls meet, and nobody's that are farther apart
 * than the margin. */
#include "world/broad/broad.h"
#include "base/rng.h"
#include "support/check.h"
#include "support/shapes.h"

#include "particle/closest.h"

enum { SHAPES = 3, SIZES = 13 };
static const double smallest = 1e-3, ratio = 1.7782794100389228; /* 10^(1/4): 1 mm to 1 m */

typedef struct shapes {
  scree_particle *items[SHAPES][SIZES];
} shapes;

static void make_shapes(shapes *s) {
  scree_error error;
  double size = smallest;
  for (int k = 0; k < SIZES; k++, size *= ratio) {
    CHECK_OK(scree_particle_sphere(0.5 * size, &s->items[0][k], &error), error);
    s->items[1][k] = shape_particle(shape_box(size, 0.6 * size, 0.2 * size));
    s->items[2][k] = shape_particle(shape_box(0.3 * size, 0.3 * size, size));
  }
}

static void free_shapes(shapes *s) {
  for (int i = 0; i < SHAPES; i++)
    for (int k = 0; k < SIZES; k++) scree_particle_free(s->items[i][k]);
}

static scree_world *make_world(void) {
  scree_error error;
  scree_world_options o = scree_default_world_options();
  scree_world *world = NULL;
  o.gravity[2] = 0;
  CHECK_OK(scree_world_create(&o, &world, &error), error);
  const scree_material material = scree_default_material();
  CHECK_OK(scree_world_add_material(world, &material, NULL, &error), error);
  return world;
}

static scree_body random_state(scree_rng *rng, double room) {
  scree_body body = scree_default_body();
  quat q = scree_rng_rotation(rng);
  const double orientation[4] = {q.w, q.x, q.y, q.z};
  memcpy(body.orientation, orientation, sizeof orientation);
  for (int k = 0; k < 3; k++) body.position[k] = room * (scree_rng_uniform(rng) - 0.5);
  return body;
}

static scree_box box_of(const scree_world *world, size_t i) {
  const scree_frame *frame = &world->bodies.frame[i];
  return scree_box_moved(&world->bodies.particle[i]->box, &frame->rotation, frame->position);
}

static bool is_listed(const scree_world *world, size_t a, size_t b, bool wall) {
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    const scree_neighbours *n = &world->list.neighbours.items[k];
    if (n->a == a && n->b == b && n->wall == wall) return true;
  }
  return false;
}

static bool balls_meet(const scree_world *world, size_t i, size_t j, double margin) {
  const scree_bodies *b = &world->bodies;
  return vec3_distance(b->frame[i].position, b->frame[j].position) <=
         b->particle[i]->measures.bounding_radius + b->particle[j]->measures.bounding_radius +
             margin;
}

/* Counts the pairs whose boxes and balls meet. */
static size_t check_bodies(const scree_world *world) {
  double margin = world->list.margin;
  size_t meeting = 0, bodies = world->bodies.count;
  unsigned char *listed = calloc(bodies * bodies, 1);
  assert_non_null(listed);
  for (size_t k = 0; k < world->list.neighbours.count; k++) {
    const scree_neighbours *n = &world->list.neighbours.items[k], *before = n - 1;
    if (k > 0)
      assert_true(before->a < n->a || (before->a == n->a && before->wall < n->wall) ||
                  (before->a == n->a && before->wall == n->wall && before->b < n->b));
    if (!n->wall) listed[n->a * bodies + n->b] = 1;
  }
  const scree_sphere_list *list = &world->spheres.list;
  for (size_t k = 0; k < list->pairs.count; k++) { /* two spheres */
    const scree_sphere_pair *two = &list->pairs.items[k], *before = two - 1;
    const size_t a = list->body[two->a], b = list->body[two->b];
    if (k > 0) assert_true(before->a < two->a || (before->a == two->a && before->b < two->b));
    assert_true(two->a < two->b);
    unsigned char *is = &listed[(a < b ? a : b) * bodies + (a < b ? b : a)];
    assert_false(*is);
    *is = 1;
  }
  for (size_t a = 0; a < bodies; a++)
    for (size_t b = a + 1; b < bodies; b++) {
      if (world->bodies.removed[a] || world->bodies.removed[b]) continue;
      scree_box x = box_of(world, a), y = box_of(world, b), wide = scree_box_grown(x, 3 * margin);
      bool meet = scree_box_meets(&x, &y) && balls_meet(world, a, b, 0);
      if (meet) assert_true(listed[a * bodies + b]);
      if (listed[a * bodies + b])
        assert_true(scree_box_meets(&wide, &y) && balls_meet(world, a, b, 3 * margin));
      meeting += meet;
    }
  free(listed);
  return meeting;
}

static void all_sizes(void **state) {
  (void)state;
  shapes s;
  make_shapes(&s);
  scree_rng rng = {.seed = 7};
  scree_error error;
  for (int round = 0; round < 6; round++) {
    scree_world *world = make_world();
    /* rounds with many small and few large, and with as many of each */
    for (int i = 0; i < 500; i++) {
      double u = scree_rng_uniform(&rng);
      int k = (int)(SIZES * (round % 2 ? u * u * u * u : u));
      scree_body body = random_state(&rng, round % 3 ? 0.3 : 3);
      CHECK_OK(scree_world_add_body(world, s.items[i % SHAPES][k], 0, &body, NULL, &error), error);
    }
    for (int change = 0; change < 3; change++) {
      CHECK_OK(scree_broad_update(world, &error), error);
      assert_true(check_bodies(world) > 10);
      for (int i = 0; i < 50; i++) {
        size_t which = (size_t)(500 * scree_rng_uniform(&rng));
        scree_body body = random_state(&rng, 0.3);
        if (i % 5 == 0)
          scree_world_remove_body(world, which);
        else
          CHECK_OK(scree_world_set_body(world, which, &body, &error), error);
      }
    }
    scree_world_free(world);
  }
  free_shapes(&s);
}

/* Bodies that fly: what the list leaves out may not come to meet before it is made again. */
static void in_flight(void **state) {
  (void)state;
  shapes s;
  make_shapes(&s);
  scree_rng rng = {.seed = 8};
  scree_error error;
  scree_world *world = make_world();
  for (int i = 0; i < 216; i++) {
    scree_body body = random_state(&rng, 0.5);
    double where[3] = {i % 6, i / 6 % 6, i / 36};
    for (int k = 0; k < 3; k++) {
      body.position[k] = 0.045 * where[k];
      body.velocity[k] = 10 * (scree_rng_uniform(&rng) - 0.5);
      body.angular_velocity[k] = 20 * (scree_rng_uniform(&rng) - 0.5);
    }
    CHECK_OK(scree_world_add_body(world, s.items[i % SHAPES][3 + i % 4], 0, &body, NULL, &error),
             error);
  }
  size_t meeting = 0;
  for (int k = 0; k < 60; k++) {
    CHECK_OK(scree_world_step(world, 100, &error), error);
    CHECK_OK(scree_broad_update(world, &error), error); /* else of the step's beginning */
    meeting += check_bodies(world);
  }
  print_message("%zu meetings\n", meeting);
  assert_true(meeting > 50);
  scree_timings timings;
  scree_world_timings(world, &timings);
  assert_true(timings.broad_builds > 3 && timings.broad_builds < timings.steps / 4);
  scree_world_free(world);
  free_shapes(&s);
}

/* By every face. */
static double distance_to_mesh(const scree_world *world, size_t body, size_t wall) {
  const scree_world_wall *w = &world->walls.items[wall];
  vec3 p = mat3_tmul_vec(&w->frame.rotation,
                         vec3_sub(world->bodies.frame[body].position, w->frame.position));
  double best = INFINITY;
  for (size_t f = 0; f < w->surface->face_count; f++) {
    int region;
    best = fmin(best, vec3_distance(p, scree_closest_on_face(&w->surface->faces[f], p, &region)));
  }
  return best;
}

/* A hollow wall: bodies in its middle are no neighbours of it, unless they are put into its solid.
 */
static void mesh_walls(void **state) {
  (void)state;
  shapes s;
  make_shapes(&s);
  scree_rng rng = {.seed = 9};
  scree_error error;
  scree_world *world = make_world();
  scree_mesh ball = shape_icosphere(0.5, 3);
  scree_wall wall = {.kind = SCREE_WALL_MESH, .axis = {0, 1, 1}, .mesh = &ball};
  for (int k = 0; k < 2; k++, wall.position[0] = 0.4) {
    wall.angular_velocity[2] = k;
    CHECK_OK(scree_world_add_wall(world, &wall, NULL, &error), error);
  }
  for (int i = 0; i < 400; i++) {
    scree_body body = random_state(&rng, 1.2);
    CHECK_OK(scree_world_add_body(world, s.items[i % SHAPES][2 + i % 9], 0, &body, NULL, &error),
             error);
  }
  CHECK_OK(scree_broad_update(world, &error), error);
  double margin = world->list.margin;
  size_t near = 0, inside = 0, far = 0;
  for (size_t i = 0; i < 400; i++)
    for (size_t w = 0; w < 2; w++) {
      const scree_world_wall *to = &world->walls.items[w];
      vec3 p = mat3_tmul_vec(&to->frame.rotation,
                             vec3_sub(world->bodies.frame[i].position, to->frame.position));
      double radius = world->bodies.particle[i]->measures.bounding_radius,
             distance = distance_to_mesh(world, i, w);
      bool listed = is_listed(world, i, w, true), in = scree_is_inside(to->surface, p);
      scree_box box = box_of(world, i),
                walls = scree_box_moved(&to->surface->box, &to->frame.rotation, to->frame.position);
      bool meets = scree_box_meets(&box, &walls), touches = meets && distance < radius;
      if (touches || in) assert_true(listed);
      if (!in && distance > radius + 2 * margin) assert_false(listed);
      near += touches;
      inside += in;
      far += !listed;
    }
  print_message("%zu near, %zu inside, %zu left out\n", near, inside, far);
  assert_true(near > 50 && inside > 50 && far > 50);
  for (size_t i = 0; i < 400; i++) world->bodies.path[i] = 1; /* they have moved: out of date */
  CHECK_OK(scree_broad_update(world, &error), error);
  for (size_t i = 0; i < 400; i++)
    for (size_t w = 0; w < 2; w++)
      if (distance_to_mesh(world, i, w) >
          world->bodies.particle[i]->measures.bounding_radius + 2 * margin)
        assert_false(is_listed(world, i, w, true));
  scree_world_free(world);
  scree_mesh_free(&ball);
  free_shapes(&s);
}

/* Balls on a floor, and a disc and a box, which start far away and come by fast, or leave. Answers
 * how often lists were made. */
static uint64_t pass_walls(double speed, bool each_step, size_t steps, scree_checksum *hash) {
  shapes s;
  make_shapes(&s);
  scree_error error;
  scree_world *world = make_world();
  const scree_wall floor = {.kind = SCREE_WALL_PLANE, .axis = {0, 0, 1}};
  CHECK_OK(scree_world_add_wall(world, &floor, NULL, &error), error);
  scree_mesh box = shape_box(0.02, 0.02, 0.02);
  scree_wall walls[2] = {{.kind = SCREE_WALL_DISC, .axis = {1, 0, 1}, .radius = 0.02},
                         {.kind = SCREE_WALL_MESH, .axis = {0, 0, 1}, .mesh = &box}};
  for (int w = 0; w < 2; w++) {
    walls[w].position[w] = 0.5;
    walls[w].position[2] = 0.02;
    walls[w].velocity[w] = -speed;
    walls[w].angular_velocity[2] = 20;
    CHECK_OK(scree_world_add_wall(world, &walls[w], NULL, &error), error);
  }
  for (int i = 0; i < 49; i++) {
    scree_body body = scree_default_body();
    body.position[0] = 0.006 * (i % 7 - 3);
    body.position[1] = 0.006 * (i / 7 - 3);
    body.position[2] = 0.0028;
    CHECK_OK(scree_world_add_body(world, s.items[0][3], 0, &body, NULL, &error), error);
  }
  for (size_t k = 0; k < steps; k++) {
    world->list.stale |= each_step;
    CHECK_OK(scree_world_step(world, 1, &error), error);
  }
  *hash = scree_world_hash(world);
  scree_timings timings;
  scree_world_timings(world, &timings);
  scree_world_free(world);
  scree_mesh_free(&box);
  free_shapes(&s);
  return timings.broad_builds;
}

/* They end no list while they are far, and are in those of whom they meet. */
static void far_walls(void **state) {
  (void)state;
  scree_checksum once, always;
  uint64_t leaving = pass_walls(-5, false, 2000, &once);
  print_message("%llu lists beside walls that leave\n", (unsigned long long)leaving);
  assert_true(leaving <= 4);
  pass_walls(5, false, 6000, &once);
  pass_walls(5, true, 6000, &always);
  assert_memory_equal(&once, &always, sizeof once);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(all_sizes),
      cmocka_unit_test(in_flight),
      cmocka_unit_test(mesh_walls),
      cmocka_unit_test(far_walls),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
