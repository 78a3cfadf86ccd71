/* L18: eighty decimated devices poured into a cylinder and left. */
#include "support/law.h"

#include "base/vec.h"
#include "particle/particle.h"

static scree_particle *device(const char *name, size_t triangles) {
  scree_error error;
  scree_mesh mesh, level;
  scree_curve *curve = NULL;
  scree_particle *particle = NULL;
  scree_sample_options o = scree_default_sample_options();
  scree_simplify_options simplify = scree_default_simplify_options();
  o.resolution = 2e-3;
  o.noise = 0;
  CHECK_OK(scree_sample_make(name, &o, NULL, &mesh, &error), error);
  CHECK_OK(scree_curve_build(&mesh, &simplify, NULL, &curve, &error), error);
  CHECK_OK(scree_curve_mesh(curve, scree_curve_find(curve, triangles), &level, &error), error);
  CHECK_OK(scree_particle_from_mesh(&level, NULL, &particle, &error), error);
  scree_curve_free(curve);
  scree_mesh_free(&mesh);
  scree_mesh_free(&level);
  return particle;
}

/* By how much a vertex may reach out of the rounded core that touches, m. */
static double reach_of(const scree_particle *particle, size_t vertex) {
  if (!particle->core) return 0;
  vec3 own = vec3_load(particle->mesh.positions + 3 * vertex),
       core = vec3_load(particle->core + 3 * vertex);
  return fmax(0, vec3_distance(own, core) - particle->radius);
}

/* How far the farthest vertex lies outside a cylinder of this radius or below its disc, and beyond
 * what it reaches out of the core, m. */
static double farthest_out(const scree_world *world, double radius) {
  double out = -INFINITY;
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    const scree_particle *particle = scree_world_body_particle(world, i);
    const scree_mesh *mesh = &particle->mesh;
    mat3 turn = quat_to_mat3(
        (quat){body.orientation[0], body.orientation[1], body.orientation[2], body.orientation[3]});
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      vec3 at = vec3_add(vec3_load(body.position),
                         mat3_mul_vec(&turn, vec3_load(mesh->positions + 3 * v)));
      out = fmax(out, fmax(hypot(at.x, at.y) - radius, -at.z) - reach_of(particle, v));
    }
  }
  return out;
}

/* The farthest that any body has moved from where it was, m. */
static double farthest_way(const scree_world *world, const scree_body *before) {
  double way = 0;
  for (size_t i = 0; i < scree_world_body_count(world); i++) {
    scree_body body;
    scree_world_get_body(world, i, &body);
    way = fmax(way, vec3_norm(vec3_sub(vec3_load(body.position), vec3_load(before[i].position))));
  }
  return way;
}

/* So many of each of three devices of 0.1 kg, as the note's scales have it, into a cylinder of
 * 0.6 m. At other levels than these one or another may come to lie on two points and rock for half
 * a minute. */
static scree_scene *make_drop(const double counts[3], const char *steps_per_contact) {
  static const struct {
    const char *name;
    size_t triangles;
  } devices[3] = {{"fp-1", 120}, {"fp-3", 70}, {"sp-1", 120}};
  const char *const fields[][2] = {
      {"width", "0.6"}, {"density", "1100"}, {"contact.steps", steps_per_contact}, {"still", "0"}};
  scree_poured poured[3];
  char count[16];
  scree_error error;
  scree_scene_file *file;
  scree_shape_store *store;
  scree_scene *scene;
  CHECK_OK(scree_scene_file_template("drop", &file, &error), error);
  CHECK_OK(scree_shape_store_create(&store, &error), error);
  for (int i = 0; i < 3; i++) {
    scree_particle *particle = device(devices[i].name, devices[i].triangles);
    poured[i] = (scree_poured){devices[i].name, "file", devices[i].name, counts[i]};
    CHECK_OK(scree_shape_store_give(store, devices[i].name, particle, &error), error);
    scree_particle_free(particle);
  }
  CHECK_OK(scree_scene_file_pour(file, poured, 3, &error), error);
  snprintf(count, sizeof count, "%g", counts[0] + counts[1] + counts[2]);
  CHECK_OK(scree_scene_file_set(file, "particles", count, &error), error);
  CHECK_OK(scree_scene_file_set(file, "time", "100", &error), error);
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
    CHECK_OK(scree_scene_file_set(file, fields[i][0], fields[i][1], &error), error);
  CHECK_OK(scree_scene_create_from(file, store, NULL, &scene, &error), error);
  scree_scene_file_free(file);
  scree_shape_store_free(store);
  return scene;
}

/* What the energies miss of what came in. */
static double missing(scree_scene *scene, scree_observation *seen) {
  scree_scene_book book;
  double sum = law_ledger(scree_scene_world(scene), seen);
  scree_scene_get_book(scene, &book);
  return fabs(sum / book.entered_energy - 1);
}

static void poured_and_left(void **state) {
  (void)state;
  scree_error error;
  const double counts[3] = {30, 25, 25}, radius = 0.3;
  scree_scene *scene = make_drop(counts, "20");
  const scree_world *world = scree_scene_view(scene);
  scree_observation seen;
  double end = INFINITY, ledger = 0, quiet = 0;
  do { /* a device that is about to tip over is slow as well, but not for long */
    CHECK_OK(scree_scene_advance(scene, 500, &error), error);
    ledger = fmax(ledger, missing(scene, &seen));
    if (seen.body_count < 80 || seen.pair_count == 0 || seen.kinetic + seen.rotational >= 1e-7)
      quiet = seen.time;
    if (seen.body_count == 80) end = fmin(end, seen.time + 8);
  } while (seen.time < end && seen.time < quiet + 0.5);
  print_message("%.2f s, %zu pairs touch\n", seen.time, seen.pair_count);
  LAW_NEAR("L18", "devices in the heap", (double)seen.body_count, 80, 0);
  LAW_BELOW("L18", "kinetic energy (J)", seen.kinetic + seen.rotational, 1e-6);
  LAW_BELOW("L18", "largest overlap (m)", seen.largest_overlap, 1e-5);
  LAW_BELOW("L18", "farthest vertex outside the walls (m)", farthest_out(world, radius), 1e-5);
  LAW_BELOW("L17", "ledger at N = 20, of what came in", ledger, 8e-3);
  /* left alone it stays what it is */
  scree_body before[80];
  for (size_t i = 0; i < 80; i++) scree_world_get_body(world, i, &before[i]);
  double kinetic = 0;
  for (end = seen.time + 2; seen.time < end;) {
    CHECK_OK(scree_scene_advance(scene, 500, &error), error);
    scree_world_observe(world, &seen);
    kinetic = fmax(kinetic, seen.kinetic + seen.rotational);
  }
  LAW_BELOW("L18", "kinetic energy in two seconds more (J)", kinetic, 1e-6);
  LAW_BELOW("L18", "farthest way of a body in them (m)", farthest_way(world, before), 1e-4);
  LAW_BELOW("L18", "largest overlap after them (m)", seen.largest_overlap, 1e-5);
  LAW_BELOW("L18", "farthest vertex outside after them (m)", farthest_out(world, radius), 1e-5);
  scree_scene_free(scene);
}

/* Worst error of the ledger while 30 devices fall in, at these steps per contact. */
static double drop_error(const char *steps_per_contact) {
  const double counts[3] = {10, 10, 10};
  scree_error error;
  scree_scene *scene = make_drop(counts, steps_per_contact);
  scree_scene_book book;
  scree_observation seen;
  double worst = 0;
  do {
    CHECK_OK(scree_scene_advance(scene, 500, &error), error);
    worst = fmax(worst, missing(scene, &seen));
  } while (seen.time < 0.7);
  scree_scene_get_book(scene, &book);
  assert_true(seen.dissipated_dashpot > 0.2 * book.entered_energy);
  scree_scene_free(scene);
  return worst;
}

/* What the ledger misses is the integration's error, of second order in the time step. */
static void ledger_is_of_second_order(void **state) {
  (void)state;
  double coarse = drop_error("20"), fine = drop_error("40");
  LAW_BELOW("L17", "ledger of a drop at N = 20", coarse, 5e-3);
  LAW_BELOW("L17", "the same at N = 40", fine, 1e-3);
  LAW_BELOW("L17", "N = 40 over N = 20; 1/4 expected, in another drop", fine / coarse, 0.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(poured_and_left),
                                     cmocka_unit_test(ledger_is_of_second_order)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
