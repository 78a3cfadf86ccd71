/* Assemblies of scenes: parts that face each other hold by the area where they do, come apart at
 * the energy of a hand calculation, and are told where they overlap or nothing holds them; sheets
 * of cells bend as plates do. */
#include "base/vec.h"
#include "report/program.h"
#include "support/alloc_fail.h"
#include "support/law.h"
#include "support/scene.h"
#include "support/shapes.h"

/* ---- faces ---- */

static scree_mesh box_at(vec3 sides, vec3 low) {
  scree_mesh mesh = shape_box(sides.x, sides.y, sides.z);
  shape_move(&mesh, low);
  return mesh;
}

/* A plate and a block that stands on it 0.01 mm above, reaching over one rim; both turned. */
static void faces_are_where_parts_meet(void **state) {
  (void)state;
  const mat3 turn = quat_to_mat3(quat_from_rotation_vector((vec3){0.4, -0.8, 1.1}));
  scree_mesh plate = box_at((vec3){0.04, 0.03, 0.002}, (vec3){0, 0, 0}),
             block = box_at((vec3){0.01, 0.02, 0.006}, (vec3){0.035, 0.004, 0.00201}),
             *both[] = {&plate, &block};
  for (int m = 0; m < 2; m++)
    for (size_t v = 0; v < both[m]->vertex_count; v++)
      vec3_store(both[m]->positions + 3 * v,
                 mat3_mul_vec(&turn, vec3_load(both[m]->positions + 3 * v)));
  const scree_facing_part parts[] = {{&plate, "plate", 0}, {&block, "block", 1}};
  scree_fracture f = {0};
  scree_error error;
  CHECK_OK(scree_parts_face(parts, 2, 1e-4, &f, &error), error);
  assert_int_equal(f.face_count, 1);
  vec3 n = mat3_mul_vec(&turn, (vec3){0, 0, 1}),
       centre = mat3_mul_vec(&turn, (vec3){0.0375, 0.014, 0.002005});
  const scree_fracture_face *face = f.faces;
  LAW_RELATIVE("J11", "area where two parts face, m2", face->area, 0.005 * 0.02, 1e-9);
  LAW_BELOW("J11", "its centre and normal, off by m",
            vec3_distance(vec3_load(face->centre), centre) +
                1e-2 * vec3_distance(vec3_load(face->normal), n),
            1e-10);
  LAW_RELATIVE("J11", "second moment along, m4", face->second_moments[0], 0.005 * pow(0.02, 3) / 12,
               1e-9);
  LAW_RELATIVE("J11", "from middle to middle, m", face->distance, 0.004, 0.01);
  scree_fracture_free(&f);
  CHECK_OK(scree_parts_face(parts, 2, 0.9e-5, &f, &error), error); /* too far apart */
  assert_int_equal(f.face_count, 0);
  scree_fracture_free(&f);
  /* along an edge alone, where rounding leaves some area */
  scree_mesh_free(&block);
  block = box_at((vec3){0.04, 0.03, 0.002}, (vec3){0.04 - 1e-15, 0, 0.002});
  scree_mesh_free(&plate);
  plate = box_at((vec3){0.04, 0.03, 0.002}, (vec3){0, 0, 0});
  CHECK_OK(scree_parts_face(parts, 2, 1e-4, &f, &error), error);
  assert_int_equal(f.face_count, 0);
  scree_fracture_free(&f);
  scree_mesh_free(&plate);
  scree_mesh_free(&block);
}

/* A shaft in a bore, and studs on a plate: as many faces as there are places. */
static void faces_are_apart_where_places_are(void **state) {
  (void)state;
  scree_mesh plate = box_at((vec3){0.06, 0.06, 0.004}, (vec3){0, 0, 0}), feet = {0};
  double corners[4 * 12 * 9];
  size_t n = 0;
  for (int k = 0; k < 4; k++) {
    scree_mesh foot = box_at((vec3){0.006, 0.006, 0.01},
                             (vec3){0.01 + 0.03 * (k % 2), 0.01 + 0.03 * (k / 2), 0.004});
    for (size_t t = 0; t < 3 * foot.triangle_count; t++, n += 3)
      memcpy(corners + n, foot.positions + 3 * foot.triangles[t], 3 * sizeof *corners);
    scree_mesh_free(&foot);
  }
  scree_error error;
  CHECK_OK(scree_mesh_weld(corners, 48, 0, &feet, NULL, &error), error);
  const scree_facing_part parts[] = {{&plate, "plate", 0}, {&feet, "feet", 1}};
  scree_fracture f = {0};
  CHECK_OK(scree_parts_face(parts, 2, 1e-4, &f, &error), error);
  assert_int_equal(f.face_count, 4);
  for (int k = 0; k < 4; k++) CHECK_NEAR(f.faces[k].area, 0.006 * 0.006, 1e-12);
  scree_fracture_free(&f);
  scree_mesh_free(&plate);
  scree_mesh_free(&feet);
}

/* ---- a battery ---- */

static const char device[] =
    "time: 1\n"
    "gravity: [0, 0, 0]\n"
    "materials: {m: {young: 1e8, density: 1000}}\n"
    "shapes:\n"
    "  device:\n"
    "    parts:\n"
    "      case: {box: [0.08, 0.05, 0.004], density: 20000}\n"
    "      stud_a: {box: [0.004, 0.004, 0.004], at: [0.03, 0.015, 0.004]}\n"
    "      stud_b: {box: [0.004, 0.004, 0.004], at: [-0.03, 0.015, 0.004]}\n"
    "      stud_c: {box: [0.004, 0.004, 0.004], at: [0.03, -0.015, 0.004]}\n"
    "      stud_d: {box: [0.004, 0.004, 0.004], at: [-0.03, -0.015, 0.004]}\n"
    "      battery: {box: [0.07, 0.04, 0.004], at: [0, 0, %g], density: 2500}\n"
    "    joints:\n"
    "      tension: 1e8\n"
    "      young: 1e8\n"
    "      damping: 0\n"
    "      %s\n"
    "inlets: {i: {box: {min: [-0.1, -0.1, 0], max: [0.1, 0.1, 0.1]}, shapes: device, count: 1, "
    "orientation: fixed}}\n"
    "sensors: {all: {fragments: {part: battery}}}\n";
static const char weak_battery[] = "pairs: [{between: [battery, 'stud_*'], tension: 2e4}]";
enum { BATTERY = 5 };

/* Whether it has fallen out where it leaves with this share of the energy that it takes: four bars
 * in a row each of a stud's joints, drawn to the strength, by the reduced mass of both sides. */
static bool falls_out(double share) {
  const double area = 0.004 * 0.004, force = 4 * area * 2e4, stiffness = 4 * 1e8 * area / 0.008,
               mass = 0.07 * 0.04 * 0.004 * 2500,
               others = 0.08 * 0.05 * 0.004 * 20000 + 4 * 0.004 * area * 1000,
               reduced = mass * others / (mass + others), energy = force * force / (2 * stiffness),
               speed = sqrt(2 * share * energy / reduced);
  char text[3000];
  snprintf(text, sizeof text, device, 0.008, weak_battery);
  scree_scene *scene = create(text);
  run_until(scene, 1e-6);
  scree_world *world = (scree_world *)(uintptr_t)scree_scene_view(scene);
  assert_int_equal(scree_world_body_count(world), 6);
  assert_int_equal(now_of(scene, "all.count"), 1);
  scree_body body;
  scree_world_get_body(world, BATTERY, &body);
  body.velocity[2] = speed;
  law_place(world, BATTERY, &body);
  run_until(scene, 2 * 6.2831853 * sqrt(reduced / stiffness));
  size_t of[6], count = scree_world_fragments(world, of);
  double liberated = now_of(scene, "all.liberated");
  assert_int_equal(count, now_of(scene, "all.count"));
  assert_true(count == 1 || count == 2); /* studs stay with the case */
  CHECK_NEAR(liberated, count == 2 ? 1 : 0, 0);
  scree_scene_free(scene);
  return count == 2;
}

static void a_battery_falls_out(void **state) {
  (void)state;
  double low = 0.5, high = 2;
  assert_true(!falls_out(low) && falls_out(high));
  for (int k = 0; k < 7; k++) {
    double middle = sqrt(low * high);
    *(falls_out(middle) ? &high : &low) = middle;
  }
  LAW_NEAR("J12", "energy at which a battery falls out, share", sqrt(low * high), 1, 0.1);
}

/* ---- counted ---- */

static const char falling[] =
    "time: 2\n"
    "gravity: [0, 0, 0]\n"
    "materials: {m: {young: 1e8, density: 1000}}\n"
    "shapes:\n"
    "  pair:\n"
    "    parts:\n"
    "      low: {box: [0.02, 0.02, 0.02]}\n"
    "      high: {box: [0.02, 0.02, 0.02], at: [0, 0, 0.02]}\n"
    "    joints: {tension: 1e4}\n"
    "inlets: {i: {box: {min: [-0.03, -0.03, 0.1], max: [0.03, 0.03, 0.2]}, shapes: pair, count: 1, "
    "orientation: fixed, velocity: [0, 0, -1]}}\n"
    "outlets: {out: {box: {min: [-1, -1, -1], max: [1, 1, -0.1]}}}\n"
    "stop: {empty: true}\n"
    "sensors:\n"
    "  gate: {flow: {through: [0, 0, 0], normal: [0, 0, -1]}}\n"
    "  all: {region: {box: {min: [-1, -1, -1], max: [1, 1, 1]}}}\n"
    "  fast: {speed: {}}\n"
    "  stay: {residence: {}}\n";

/* Parts that hang together count as one, with all their mass; apart each for itself. */
static void count_falling(bool apart) {
  const double mass = 2 * 0.02 * 0.02 * 0.02 * 1000, count = apart ? 2 : 1;
  scree_scene_book b;
  scree_scene *scene = create(falling);
  run_until(scene, 1e-6);
  scree_body body = body_of(scene, 1);
  body.velocity[2] -= apart ? -0.5 : 0;
  law_place((scree_world *)(uintptr_t)scree_scene_view(scene), 1, &body);
  run_until(scene, 0.01);
  scree_scene_get_book(scene, &b);
  assert_int_equal(b.entered_count, 1);
  assert_int_equal(b.inside_count, count);
  CHECK_NEAR(now_of(scene, "all.count"), count, 0);
  CHECK_NEAR(now_of(scene, "fast.count"), count, 0);
  CHECK_NEAR(now_of(scene, "all.mass"), mass, 1e-12);
  run_to_end(scene);
  scree_scene_get_book(scene, &b);
  assert_string_equal(scree_scene_end(scene), "empty");
  if (!apart) CHECK_NEAR(b.left_energy, b.entered_energy, 1e-9 * b.entered_energy);
  assert_int_equal(b.inside_count, 0);
  assert_int_equal(b.left_count, count);
  CHECK_NEAR(b.left_mass, mass, 1e-12);
  CHECK_NEAR(now_of(scene, "gate.count"), count, 0);
  CHECK_NEAR(now_of(scene, "gate.mass"), mass, 1e-12);
  CHECK_NEAR(now_of(scene, "stay.count"), count, 0);
  scree_words words;
  scree_scene_words(scene, NULL, NULL, &words);
  assert_int_equal(strstr(words.answer, "1 particles came in and came apart, 0 ") != NULL, apart);
  scree_scene_free(scene);
}

static void what_hangs_together_counts_as_one(void **state) {
  (void)state;
  count_falling(false);
  count_falling(true);
}

/* ---- a cable ---- */

/* There and back, its halves so near that they lie in each other: each sphere holds the next alone,
 * and the ends are the path's. */
static void a_cable_follows_its_path(void **state) {
  (void)state;
  static const char text[] = "time: 1\n"
                             "gravity: [0, 0, 0]\n"
                             "materials: {m: {young: 1e8, density: 1000}}\n"
                             "shapes:\n"
                             "  wire:\n"
                             "    cable: {diameter: 0.004, path: [{at: [0, 0, 0]}, {at: [0.1, 0, "
                             "0]}, {at: [0.1, 0.003, 0]}, "
                             "{at: [0, 0.003, 0]}]}\n"
                             "    joints: {tension: 1e6}\n"
                             "inlets: {i: {box: {min: [-0.1, -0.1, -0.1], max: [0.1, 0.1, 0.1]}, "
                             "shapes: wire, count: 1}}\n";
  const double pi = 3.14159265358979, length = 0.203, steps = 76; /* of 4/3 of the radius */
  scree_error error;
  scree_scene *scene = create(text);
  CHECK_OK(scree_scene_advance(scene, 200, &error), error);
  const scree_world *world = scree_scene_view(scene);
  size_t bodies = scree_world_body_count(world), held = 0;
  assert_int_equal(bodies, steps + 1);
  for (size_t k = 0; k < scree_world_joint_count(world); k++) {
    scree_joint_observation j;
    scree_world_observe_joint(world, k, &j);
    if (!(j.area > 0)) continue;
    assert_int_equal(j.b, j.a + 1);
    CHECK_NEAR(j.area, pi * 0.002 * 0.002, 1e-12);
    held++;
  }
  assert_int_equal(held, steps);
  vec3 first = vec3_load(body_of(scene, 0).position),
       last = vec3_load(body_of(scene, bodies - 1).position);
  CHECK_NEAR(vec3_distance(first, last), 0.003, 1e-9);
  scree_scene_book b;
  scree_scene_get_book(scene, &b);
  assert_int_equal(b.inside_count, 1);
  CHECK_NEAR(b.inside_mass / (1000 * pi * 0.002 * 0.002 * length * (steps + 1) / steps), 1, 2e-3);
  scree_observation o;
  scree_world_observe(world, &o);
  assert_true(o.highest_speed < 1e-9); /* nothing pushes */
  scree_scene_free(scene);
}

/* ---- a sheet ---- */

/* A strip of cells, clamped where x = 0, under its weight: the deflection of Euler and Bernoulli.
 */
static void a_sheet_of_cells_bends(void **state) {
  (void)state;
  const double length = 0.1, width = 0.02, thickness = 0.002, young = 1e8, density = 1000,
               moment = width * pow(thickness, 3) / 12,
               load = 1e-3 * 8 * young * moment / pow(length, 4) * length, /* N/m: 1e-3 of length */
      g = load / (density * width * thickness);
  double positions[] = {0, 0, 0, length, 0, 0, length, width, 0, 0, width, 0};
  uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  const scree_mesh flat = {positions, triangles, 4, 2};
  scree_mesh solid;
  scree_fracture f = {0};
  scree_fracture_options o = scree_default_fracture_options();
  scree_error error;
  law_setup s = law_default();
  s.gravity = g;
  s.density = density;
  CHECK_OK(scree_mesh_thicken(&flat, thickness, &solid, &error), error);
  double volume;
  CHECK_OK(scree_mesh_area_volume(&solid, NULL, &volume, &error), error);
  CHECK_NEAR(volume, length * width * thickness, 1e-15);
  o.cell_count = 40;
  CHECK_OK(scree_mesh_fracture(&solid, &o, NULL, &f, &error), error);
  scree_world *world = law_world(&s);
  scree_joint joint = scree_default_joint();
  joint.damping = 0;
  size_t tip = 0;
  double end = 0;
  for (size_t p = 0; p < f.piece_count; p++) {
    scree_particle *piece;
    scree_particle_measures m;
    scree_body body = scree_default_body();
    double low = INFINITY, high = -INFINITY;
    CHECK_OK(scree_particle_from_mesh(&f.pieces[p], NULL, &piece, &error), error);
    scree_particle_measure(piece, &m);
    memcpy(body.position, m.centre, sizeof body.position);
    memcpy(body.orientation, m.orientation, sizeof body.orientation);
    law_body(world, piece, body);
    scree_particle_free(piece);
    if (m.centre[0] > end) tip = p, end = m.centre[0];
    for (size_t v = 0; v < f.pieces[p].vertex_count; v++)
      if (fabs(f.pieces[p].positions[3 * v]) < 1e-9) {
        low = fmin(low, f.pieces[p].positions[3 * v + 1]);
        high = fmax(high, f.pieces[p].positions[3 * v + 1]);
      }
    if (!(high > low)) continue;
    joint.a = p, joint.b = SCREE_SPACE;
    vec3_store(joint.centre, (vec3){0, (low + high) / 2, 0});
    vec3_store(joint.normal, (vec3){-1, 0, 0});
    vec3_store(joint.axis, (vec3){0, 1, 0});
    scree_joint_of_rectangle(SCREE_SECTION_SHEET, young, 0, high - low, thickness, m.centre[0],
                             &joint);
    CHECK_OK(scree_world_add_joint(world, &joint, NULL, &error), error);
  }
  for (size_t k = 0; k < f.face_count; k++) {
    joint.a = f.faces[k].a, joint.b = f.faces[k].b;
    scree_joint_of_face(&f.faces[k], young, &joint);
    scree_joint_of_rectangle(SCREE_SECTION_SHEET, young, 0, f.faces[k].area / thickness, thickness,
                             f.faces[k].distance, &joint);
    CHECK_OK(scree_world_add_joint(world, &joint, NULL, &error), error);
  }
  const double slowest =
                   3.516 / (length * length) * sqrt(young * moment / (density * width * thickness)),
               kept = exp(-2 * slowest * 20 * scree_world_time_step(world, NULL));
  for (double t = 0; t < 2 * 6.2831853 / slowest; t += 20 * scree_world_time_step(world, NULL)) {
    law_step(world, 20);
    for (size_t i = 0; i < f.piece_count; i++) {
      scree_body body;
      scree_world_get_body(world, i, &body);
      for (int k = 0; k < 3; k++) body.velocity[k] *= kept, body.angular_velocity[k] *= kept;
      law_place(world, i, &body);
    }
  }
  scree_body body;
  scree_world_get_body(world, tip, &body);
  double x = end / length, /* of a cantilever under its weight */
      beam = load * pow(length, 4) / (24 * young * moment) * x * x * (6 - 4 * x + x * x);
  LAW_RELATIVE("J14", "a clamped strip of 40 cells under its weight, m", -body.position[2], beam,
               0.05);
  scree_world_free(world);
  scree_fracture_free(&f);
  scree_mesh_free(&solid);
}

/* ---- checkpoints ---- */

static void a_device_that_breaks_goes_on_with_the_same_bits(void **state) {
  (void)state;
  static const char text[] =
      "time: 0.03\n"
      "materials: {m: {young: 1e7, density: 1000}, steel: {young: 1e8}}\n"
      "shapes:\n"
      "  device:\n"
      "    material: m\n"
      "    parts:\n"
      "      case: {box: [0.04, 0.03, 0.006], fracture: {cells: 6, tension: 2e4, weibull: 5}}\n"
      "      battery: {box: [0.03, 0.02, 0.006], at: [0, 0, 0.006], density: 3000}\n"
      "    joints: {tension: 1e4}\n"
      "geometry: {floor: {plane: [0, 0, 1], material: steel}}\n"
      "inlets: {i: {box: {min: [-0.1, -0.1, 0.001], max: [0.1, 0.1, 0.1]}, shapes: device, count: "
      "3, "
      "velocity: [0, 0, -4]}}\n"
      "sensors: {all: {fragments: {part: battery}}}\n";
  scree_error error;
  scree_scene *one = create(text), *two = create(text), *loaded;
  scree_set_threads(1);
  run_to_end(one);
  scree_set_threads(2);
  run_until(two, 0.012);
  CHECK_OK(scree_scene_save(two, "device.tmp", true, &error), error);
  CHECK_OK(scree_scene_load("device.tmp", &loaded, &error), error);
  remove("device.tmp");
  run_to_end(two);
  run_to_end(loaded);
  scree_set_threads(0);
  scree_checksum a = scree_world_hash(scree_scene_view(one)),
                 b = scree_world_hash(scree_scene_view(two)),
                 c = scree_world_hash(scree_scene_view(loaded));
  assert_memory_equal(&a, &b, sizeof a);
  assert_memory_equal(&a, &c, sizeof a);
  assert_true(now_of(one, "all.count") > 3 && now_of(one, "all.broken") > 0);
  assert_true(now_of(one, "all.liberated") == now_of(loaded, "all.liberated"));
  scree_scene_free(one);
  scree_scene_free(two);
  scree_scene_free(loaded);
}

/* ---- what is wrong ---- */

static void refuse_device(double height, const char *joints, const char *words) {
  char text[3000];
  scree_error error;
  scree_scene_file *file = NULL;
  scree_scene *scene = NULL;
  snprintf(text, sizeof text, device, height, joints);
  scree_status status = scree_scene_file_parse(text, strlen(text), "device.yaml", &file, &error);
  if (status == SCREE_OK) status = scree_scene_create(file, NULL, &scene, &error);
  scree_scene_file_free(file);
  assert_true(status != SCREE_OK);
  if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
}

static void wrong_assemblies_are_told(void **state) {
  (void)state;
  refuse_device(0.007, "gap: 1e-4", "'battery' lie 1 mm deep in each other");
  refuse_device(0.0082, "gap: 1e-4", "nothing holds 'battery'");
  refuse_device(0.008, "pairs: [{between: [battery, case], tension: 1e4}]", "a joint without area");
  refuse_device(0.008, "pairs: [{between: [battery, stud_a], tension: 0}]", "tension");
  refuse_device(0.008, "loose: [nobody]", "there is no part 'nobody'");
}

static scree_status face_two(void *context, scree_error *error) {
  const scree_mesh *sheet = context;
  scree_fracture f = {0};
  scree_mesh lower = {0}, upper = {0};
  scree_status status = scree_mesh_thicken(sheet, 0.1, &lower, error);
  if (!status) status = scree_mesh_copy(&lower, &upper, error);
  for (size_t v = 0; !status && v < upper.vertex_count; v++) upper.positions[3 * v + 2] += 0.1;
  const scree_facing_part parts[] = {{&lower, "lower", 0}, {&upper, "upper", 1}};
  if (!status) status = scree_parts_face(parts, 2, 1e-3, &f, error);
  if (!status) assert_int_equal(f.face_count, 1);
  scree_fracture_free(&f);
  scree_mesh_free(&lower);
  scree_mesh_free(&upper);
  return status;
}

static void no_memory_is_told(void **state) {
  (void)state;
  double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  uint32_t triangles[] = {0, 1, 2};
  scree_mesh sheet = {positions, triangles, 3, 1};
  check_allocation_failures(face_two, &sheet);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(faces_are_where_parts_meet),
      cmocka_unit_test(faces_are_apart_where_places_are),
      cmocka_unit_test(a_battery_falls_out),
      cmocka_unit_test(what_hangs_together_counts_as_one),
      cmocka_unit_test(a_cable_follows_its_path),
      cmocka_unit_test(a_sheet_of_cells_bends),
      cmocka_unit_test(a_device_that_breaks_goes_on_with_the_same_bits),
      cmocka_unit_test(wrong_assemblies_are_told),
      cmocka_unit_test(no_memory_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
