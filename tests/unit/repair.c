/* Repair: a defect planted in a clean surface and repaired gives back the clean surface's measures;
 * the order of the facets, a move, a turn or a scale changes nothing; what is sound stays as it is.
 */
#include "base/alloc.h"
#include "base/rng.h"
#include "base/vec.h"
#include "fuzz/meshes.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

typedef struct outcome {
  scree_mesh mesh;
  scree_repair_report report;
  scree_measures measures;
} outcome;

static outcome repair_with(const scree_mesh *mesh, const scree_repair_options *options) {
  outcome o;
  scree_error error;
  CHECK_OK(scree_mesh_repair(mesh, options, NULL, &o.mesh, &o.report, &error), error);
  CHECK_OK(scree_mesh_measure(&o.mesh, &o.measures, &error), error);
  /* what is called repaired passes the check, asked again */
  scree_check check;
  CHECK_OK(scree_mesh_check(&o.mesh, NULL, NULL, &check, &error), error);
  assert_true(check.usable && o.report.after.usable);
  assert_string_equal(check.verdict, o.report.after.verdict);
  return o;
}

static outcome repair(const scree_mesh *mesh) {
  return repair_with(mesh, NULL);
}

static void free_outcome(outcome *o) {
  scree_mesh_free(&o->mesh);
}

static scree_measures measures_of(const scree_mesh *mesh) {
  scree_measures m;
  scree_error error;
  CHECK_OK(scree_mesh_measure(mesh, &m, &error), error);
  return m;
}

/* The same surface: area and volume within the tolerance, relative. */
static void expect_same(const outcome *o, const scree_measures *clean, double tolerance) {
  CHECK_NEAR(o->measures.area, clean->area, tolerance * clean->area);
  CHECK_NEAR(o->measures.volume, clean->volume, tolerance * clean->volume);
}

static void expect_same_mesh(const scree_mesh *a, const scree_mesh *b) {
  assert_int_equal(a->vertex_count, b->vertex_count);
  assert_int_equal(a->triangle_count, b->triangle_count);
  assert_memory_equal(a->positions, b->positions, 24 * a->vertex_count);
  assert_memory_equal(a->triangles, b->triangles, 12 * a->triangle_count);
}

static size_t sum_of_actions(const scree_repair_report *report) {
  size_t sum = 0;
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++) sum += report->done[i];
  return sum;
}

/* A rough closed body without symmetry. */
static scree_mesh body(void) {
  scree_mesh mesh = shape_icosphere(1, 3);
  scree_rng rng = {.seed = 51};
  shape_shake(&mesh, 0.01, &rng);
  return mesh;
}

static void shuffle(scree_mesh *mesh, scree_rng *rng) {
  for (size_t t = mesh->triangle_count; t > 1; t--) {
    size_t other = scree_rng_below(rng, t), turn = scree_rng_below(rng, 3);
    uint32_t *a = mesh->triangles + 3 * (t - 1), *b = mesh->triangles + 3 * other;
    uint32_t keep[3] = {a[0], a[1], a[2]};
    memcpy(a, b, sizeof keep);
    for (size_t k = 0; k < 3; k++) b[k] = keep[(k + turn) % 3];
  }
}

static void append_facet(scree_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
  /* the shapes leave no room: a new array of the library's allocator */
  uint32_t *more = scree_alloc(3 * (mesh->triangle_count + 1), sizeof *more);
  assert_non_null(more);
  memcpy(more, mesh->triangles, 12 * mesh->triangle_count);
  more[3 * mesh->triangle_count] = a;
  more[3 * mesh->triangle_count + 1] = b;
  more[3 * mesh->triangle_count + 2] = c;
  scree_free(mesh->triangles);
  mesh->triangles = more;
  mesh->triangle_count++;
}

static void sound_stays(void **state) {
  (void)state;
  scree_mesh mesh = body();
  scree_rng rng = {.seed = 52};
  outcome first = repair(&mesh);
  assert_true(first.report.before.usable);
  assert_int_equal(sum_of_actions(&first.report), 0);
  shuffle(&mesh, &rng);
  outcome again = repair(&mesh);
  expect_same_mesh(&first.mesh, &again.mesh);
  free_outcome(&again);
  again = repair(&first.mesh);
  expect_same_mesh(&first.mesh, &again.mesh);
  free_outcome(&again);
  free_outcome(&first);
  scree_mesh_free(&mesh);
}

/* ---- Defects ---- */

static void turned_and_doubled(void **state) {
  (void)state;
  scree_mesh mesh = body();
  scree_measures clean = measures_of(&mesh);
  for (size_t t = 0; t < mesh.triangle_count; t += 7) shape_flip(&mesh, t);
  for (uint32_t t = 0; t < 90; t += 9) {
    const uint32_t *c = mesh.triangles + 3 * (size_t)t;
    append_facet(&mesh, c[0], t % 2 ? c[1] : c[2], t % 2 ? c[2] : c[1]);
  }
  append_facet(&mesh, 5, 5, 9);
  outcome o = repair(&mesh);
  expect_same(&o, &clean, 1e-12);
  assert_int_equal(o.report.done[SCREE_REPAIR_DROP_DUPLICATE], 10);
  assert_int_equal(o.report.done[SCREE_REPAIR_DROP_DEGENERATE], 1);
  assert_in_range(o.report.done[SCREE_REPAIR_TURN], 80, 200);
  free_outcome(&o);
  /* the whole of it inside out */
  for (size_t t = 0; t < mesh.triangle_count; t++) shape_flip(&mesh, t);
  o = repair(&mesh);
  expect_same(&o, &clean, 1e-12);
  free_outcome(&o);
  scree_mesh_free(&mesh);
}

static void loose_facets(void **state) {
  (void)state;
  scree_mesh mesh = body(), loose = shape_make(3 * mesh.triangle_count, mesh.triangle_count);
  scree_measures clean = measures_of(&mesh);
  scree_rng rng = {.seed = 53};
  for (int variant = 0; variant < 3; variant++) {
    for (size_t c = 0; c < 3 * mesh.triangle_count; c++) {
      for (size_t k = 0; k < 3; k++)
        loose.positions[3 * c + k] = mesh.positions[3 * (size_t)mesh.triangles[c] + k];
      loose.triangles[c] = (uint32_t)c;
    }
    /* exact, then within rounding, then within the tolerance */
    double noise = variant == 0 ? 0 : variant == 1 ? 1e-9 : 1e-5;
    shape_shake(&loose, noise, &rng);
    outcome o = repair(&loose);
    expect_same(&o, &clean, 1e-4);
    assert_int_equal(o.report.done[variant ? SCREE_REPAIR_CLOSE_SEAM : SCREE_REPAIR_WELD],
                     variant ? 3 * mesh.triangle_count
                             : 3 * mesh.triangle_count - mesh.vertex_count);
    free_outcome(&o);
  }
  scree_mesh_free(&loose);
  scree_mesh_free(&mesh);
}

static void holes(void **state) {
  (void)state;
  scree_mesh mesh = shape_grid_box(2, 2, 2, 8);
  scree_measures clean = measures_of(&mesh);
  scree_rng rng = {.seed = 54};
  shuffle(&mesh, &rng);
  mesh.triangle_count -= 12; /* facets missing here and there */
  outcome o = repair(&mesh);
  CHECK_NEAR(o.measures.volume, clean.volume, 0.02 * clean.volume);
  assert_in_range(o.report.done[SCREE_REPAIR_FILL_FACET], 12, 12);
  free_outcome(&o);
  scree_mesh_free(&mesh);
  /* a hole in a flat face is filled flat, with what is asked for; larger ones are refused */
  mesh = shape_grid_box(2, 2, 2, 8);
  size_t kept = 0;
  for (size_t t = 0; t < mesh.triangle_count; t++) {
    double top = 0;
    for (int k = 0; k < 3; k++) top += mesh.positions[3 * (size_t)mesh.triangles[3 * t + k] + 2];
    if (top == 6) continue;
    memmove(mesh.triangles + 3 * kept++, mesh.triangles + 3 * t, 12);
  }
  mesh.triangle_count = kept;
  o = repair(&mesh);
  expect_same(&o, &clean, 1e-12);
  assert_int_equal(o.report.done[SCREE_REPAIR_FILL_HOLE], 1);
  assert_int_equal(o.report.done[SCREE_REPAIR_FILL_FACET], 30);
  free_outcome(&o);
  scree_repair_options options = scree_default_repair_options();
  options.hole_share = 0.1;
  scree_error error;
  scree_mesh none = {0};
  assert_int_equal(scree_mesh_repair(&mesh, &options, NULL, &none, NULL, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "32 boundary edges, 1 hole"));
  assert_null(none.positions);
  options.hole_share = 0.2;
  o = repair_with(&mesh, &options);
  expect_same(&o, &clean, 1e-12);
  free_outcome(&o);
  scree_mesh_free(&mesh);
}

/* More edges than are triangulated exactly: cut ear by ear. */
static void large_hole(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 5);
  scree_measures clean = measures_of(&mesh);
  size_t kept = 0;
  for (size_t t = 0; t < mesh.triangle_count; t++) {
    if (mesh.positions[3 * (size_t)mesh.triangles[3 * t] + 2] > 0.4) continue;
    memmove(mesh.triangles + 3 * kept++, mesh.triangles + 3 * t, 12);
  }
  mesh.triangle_count = kept;
  scree_repair_options options = scree_default_repair_options();
  options.flat_holes = true;
  outcome o = repair_with(&mesh, &options);
  assert_true(o.report.done[SCREE_REPAIR_FILL_FACET] > 158);
  /* a cap of height 0.6 is missing: pi h^2 (3 - h) / 3 */
  CHECK_NEAR(o.measures.volume, clean.volume - 0.905, 0.1);
  free_outcome(&o);
  scree_mesh_free(&mesh);
}

static void t_junctions(void **state) {
  (void)state;
  scree_mesh fine = shape_grid_box(1, 1, 1, 6), coarse = shape_box(1, 1, 1);
  scree_mesh mesh = shape_join(&fine, &coarse);
  size_t kept = 0;
  for (size_t t = 0; t < mesh.triangle_count; t++) {
    bool top = true;
    for (int k = 0; k < 3; k++)
      top = top && mesh.positions[3 * (size_t)mesh.triangles[3 * t + k] + 2] == 1;
    if (top != (t < fine.triangle_count)) continue;
    memmove(mesh.triangles + 3 * kept++, mesh.triangles + 3 * t, 12);
  }
  mesh.triangle_count = kept;
  scree_rng rng = {.seed = 55};
  for (int n = 0; n < 4; n++) {
    outcome o = repair(&mesh);
    CHECK_NEAR(o.measures.volume, pow(8, n), 1e-9 * pow(8, n));
    assert_int_equal(o.report.done[SCREE_REPAIR_SPLIT_T_JUNCTION], 20);
    free_outcome(&o);
    quat q = scree_rng_rotation(&rng);
    mat3 turn = quat_to_mat3(q);
    for (int i = 0; i < 9; i++) turn.m[i / 3][i % 3] *= 2;
    shape_transform(&mesh, &turn, (vec3){0.3, -0.1, 0.7});
  }
  scree_mesh_free(&mesh);
  scree_mesh_free(&fine);
  scree_mesh_free(&coarse);
}

/* A label that lies on a body, flat or slightly bent, is dropped; a flat side of the body is not,
 * and with no debris to drop the label stays and cannot be mended. */
static void labels(void **state) {
  (void)state;
  scree_mesh body = shape_grid_box(3, 3, 3, 6), label = shape_sheet(0, 8);
  scree_repair_options keep = scree_default_repair_options();
  scree_measures clean = measures_of(&body);
  scree_error error;
  scree_mesh none;
  keep.debris_share = 0;
  for (size_t i = 0; i < 3 * label.vertex_count; i++)
    label.positions[i] = 0.5 + 2 * label.positions[i];
  for (int bent = 0; bent < 2; bent++) {
    for (size_t v = 0; v < label.vertex_count; v++) {
      double *p = label.positions + 3 * v;
      p[2] = 3.001 + bent * 1e-3 * (p[0] - 1.5) * (p[0] - 1.5);
    }
    scree_mesh mesh = shape_join(&body, &label);
    outcome o = repair(&mesh);
    expect_same(&o, &clean, 1e-12);
    assert_int_equal(o.report.done[SCREE_REPAIR_DROP_DEBRIS], 1);
    assert_int_equal(scree_mesh_repair(&mesh, &keep, NULL, &none, NULL, &error), SCREE_BAD_MESH);
    free_outcome(&o);
    scree_mesh_free(&mesh);
  }
  scree_mesh_free(&body);
  scree_mesh_free(&label);
}

/* Boxes that share an edge, or a corner, come apart and keep their volumes but for a hair. */
static void touching_boxes(void **state) {
  (void)state;
  for (int corner = 0; corner < 2; corner++) {
    scree_mesh a = shape_grid_box(1, 1, 1, 3), b = shape_grid_box(1, 1, 1, 3);
    shape_move(&b, (vec3){1, 1, corner ? 1 : 0});
    scree_mesh mesh = shape_join(&a, &b);
    outcome o = repair(&mesh);
    CHECK_NEAR(o.measures.volume, 2, 1e-3);
    assert_int_equal(o.report.after.defects[SCREE_DEFECT_EXTRA_BODY], 1);
    assert_int_equal(o.report.done[SCREE_REPAIR_SPLIT_EDGE], corner ? 0 : 3);
    if (corner) assert_int_equal(o.report.done[SCREE_REPAIR_SPLIT_VERTEX], 1);
    free_outcome(&o);
    scree_mesh_free(&mesh);
    scree_mesh_free(&a);
    scree_mesh_free(&b);
  }
}

static void fins(void **state) {
  (void)state;
  scree_mesh mesh = body();
  scree_measures clean = measures_of(&mesh);
  mesh.positions = scree_resize(mesh.positions, 3 * (mesh.vertex_count + 1), sizeof(double));
  assert_non_null(mesh.positions);
  memcpy(mesh.positions + 3 * mesh.vertex_count++, (double[]){3, 2, 1}, 24);
  const uint32_t *c = mesh.triangles + 30;
  append_facet(&mesh, c[0], c[1], (uint32_t)mesh.vertex_count - 1);
  outcome o = repair(&mesh);
  expect_same(&o, &clean, 1e-12);
  assert_int_equal(o.report.done[SCREE_REPAIR_DROP_FIN], 1);
  free_outcome(&o);
  scree_mesh_free(&mesh);
}

/* An open surface with a fin: the fin goes, the surface stays, whose hole is filled. */
static void fin_on_an_open_surface(void **state) {
  (void)state;
  scree_mesh mesh = body();
  mesh.triangle_count -= 4;
  size_t kept = mesh.triangle_count;
  const uint32_t *c = mesh.triangles + 3 * (size_t)100;
  uint32_t a = c[0], b = c[1], far = mesh.triangles[3 * (size_t)900];
  append_facet(&mesh, a, b, far);
  outcome o = repair(&mesh);
  assert_int_equal(o.report.done[SCREE_REPAIR_DROP_FIN], 1);
  assert_true(o.mesh.triangle_count >= kept);
  free_outcome(&o);
  scree_mesh_free(&mesh);
}

/* Two boxes glued with one wall between them, and a ball with a disc across it, each turned: what
 * stays is the outside. */
static void membranes(void **state) {
  (void)state;
  scree_rng rng = {.seed = 57};
  for (int round = 0; round < 20; round++) {
    scree_mesh mesh = shape_grid_box(2, 1, 1, 2);
    scree_measures clean = measures_of(&mesh);
    uint32_t rim[8], rim_count = 0, centre = UINT32_MAX;
    /* the loop of vertices at x = 1, in order of angle, and a fan from the middle of the wall */
    for (uint32_t v = 0; v < mesh.vertex_count; v++)
      if (mesh.positions[3 * v] == 1) rim[rim_count++] = v;
    assert_int_equal(rim_count, 8);
    for (int i = 0; i < 8; i++)
      for (int j = i + 1; j < 8; j++) {
        const double *p = mesh.positions + 3 * rim[i], *q = mesh.positions + 3 * rim[j];
        if (atan2(p[2] - 0.5, p[1] - 0.5) <= atan2(q[2] - 0.5, q[1] - 0.5)) continue;
        uint32_t keep = rim[i];
        rim[i] = rim[j], rim[j] = keep;
      }
    scree_mesh dot = shape_make(1, 0), both = shape_join(&mesh, &dot);
    centre = (uint32_t)mesh.vertex_count;
    memcpy(both.positions + 3 * centre, (double[3]){1.2, 0.5, 0.5}, 24);
    for (int i = 0; i < 8; i++) append_facet(&both, rim[i], rim[(i + 1) % 8], centre);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    shape_transform(&both, &turn, (vec3){1, 2, 3});
    outcome o = repair(&both);
    expect_same(&o, &clean, 1e-12);
    assert_int_equal(o.report.done[SCREE_REPAIR_DROP_MEMBRANE], 8);
    assert_int_equal(o.report.before.defects[SCREE_DEFECT_NON_MANIFOLD_EDGE], 8);
    free_outcome(&o);
    scree_mesh_free(&mesh);
    scree_mesh_free(&dot);
    scree_mesh_free(&both);
  }
}

/* A caller's mesh may hold coordinates that no reader lets in: their facets go, the holes are
 * filled. */
static void coordinates_that_are_no_numbers(void **state) {
  (void)state;
  static const double bad[] = {NAN, INFINITY, -INFINITY, 1e300};
  scree_mesh clean = shape_icosphere(1, 3);
  scree_measures before = measures_of(&clean);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    scree_mesh mesh;
    scree_error error;
    size_t at_vertex = 0, vertex = 7 + i;
    CHECK_OK(scree_mesh_copy(&clean, &mesh, &error), error);
    for (size_t k = 0; k < 3 * mesh.triangle_count; k++) at_vertex += mesh.triangles[k] == vertex;
    mesh.positions[3 * vertex + i % 3] = bad[i];
    outcome o = repair(&mesh);
    assert_int_equal(o.report.before.defects[SCREE_DEFECT_BAD_COORDINATE], 1);
    assert_int_equal(o.report.done[SCREE_REPAIR_DROP_BAD], at_vertex);
    assert_int_equal(o.report.done[SCREE_REPAIR_FILL_HOLE], 1);
    assert_int_equal(o.mesh.vertex_count, clean.vertex_count - 1);
    expect_same(&o, &before, 0.01);
    free_outcome(&o);
    scree_mesh_free(&mesh);
  }
  scree_mesh_free(&clean);
}

static void debris_and_cavities(void **state) {
  (void)state;
  scree_mesh outer = shape_grid_box(4, 4, 4, 4), cavity = shape_icosphere(0.15, 2);
  scree_mesh speck = shape_icosphere(0.05, 1);
  for (size_t t = 0; t < cavity.triangle_count; t++) shape_flip(&cavity, t);
  double hollow = -measures_of(&cavity).volume;
  shape_move(&cavity, (vec3){2, 2, 2});
  shape_move(&speck, (vec3){5, 1, 1});
  scree_mesh two = shape_join(&outer, &cavity), mesh = shape_join(&two, &speck);
  scree_repair_options keep = scree_default_repair_options();
  keep.cavity_share = 0;
  outcome o = repair_with(&mesh, &keep);
  CHECK_NEAR(o.measures.volume, 64 - hollow, 1e-9);
  assert_int_equal(o.report.done[SCREE_REPAIR_DROP_DEBRIS], 1);
  free_outcome(&o);
  /* inside out as a whole, the cavity stays one */
  for (size_t t = 0; t < mesh.triangle_count; t++) shape_flip(&mesh, t);
  o = repair_with(&mesh, &keep);
  CHECK_NEAR(o.measures.volume, 64 - hollow, 1e-9);
  assert_int_equal(o.report.done[SCREE_REPAIR_INVERT_SHELL], 3);
  assert_int_equal(o.report.after.defects[SCREE_DEFECT_CAVITY], 1);
  free_outcome(&o);
  scree_repair_options options = scree_default_repair_options();
  options.debris_share = 0;
  o = repair_with(&mesh, &options);
  assert_int_equal(o.report.after.defects[SCREE_DEFECT_EXTRA_BODY], 1);
  free_outcome(&o);
  options.keep_largest = options.drop_cavities = true;
  o = repair_with(&mesh, &options);
  CHECK_NEAR(o.measures.volume, 64, 1e-9);
  assert_int_equal(o.report.after.shell_count, 1);
  free_outcome(&o);
  scree_mesh_free(&mesh);
  scree_mesh_free(&two);
  scree_mesh_free(&outer);
  scree_mesh_free(&cavity);
  scree_mesh_free(&speck);
}

static void nested_is_swallowed(void **state) {
  (void)state;
  scree_mesh outer = shape_grid_box(4, 4, 4, 4), inner = shape_box(1, 1, 1);
  shape_move(&inner, (vec3){1.2, 1.3, 1.4});
  scree_mesh mesh = shape_join(&outer, &inner);
  outcome o = repair(&mesh);
  CHECK_NEAR(o.measures.volume, 64, 1e-9);
  assert_int_equal(o.report.done[SCREE_REPAIR_DROP_NESTED], 1);
  free_outcome(&o);
  scree_mesh_free(&mesh);
  /* overlapping ones become one, unless that is not wanted */
  shape_move(&inner, (vec3){2.4, 0, 0});
  mesh = shape_join(&outer, &inner);
  o = repair(&mesh);
  CHECK_NEAR(o.measures.volume, 64.6, 1e-9);
  assert_int_equal(o.report.done[SCREE_REPAIR_MERGE_SHELL], 2);
  free_outcome(&o);
  scree_repair_options options = scree_default_repair_options();
  options.merge_shells = false;
  scree_error error;
  scree_mesh none;
  assert_int_equal(scree_mesh_repair(&mesh, &options, NULL, &none, NULL, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "1 overlapping shell pair"));
  scree_mesh_free(&mesh);
  scree_mesh_free(&outer);
  scree_mesh_free(&inner);
}

/* A block with a hole, a small box through its wall, one that stands alone. What meets is one body:
 * the small box is neither debris nor dropped for the largest; alone it is both. */
static void parts_that_meet_are_one(void **state) {
  (void)state;
  scree_mesh block = shape_grid_box(4, 4, 4, 4), stud = shape_box(0.4, 0.4, 0.4);
  scree_repair_options options = scree_default_repair_options();
  scree_error error;
  options.debris_share = 0.05;
  shape_move(&stud, (vec3){3.8, 1.1, 1.2});
  scree_mesh two = shape_join(&block, &stud);
  shape_move(&stud, (vec3){3, 0, 0});
  scree_mesh mesh = shape_join(&two, &stud);
  memmove(mesh.triangles, mesh.triangles + 3, 12 * --mesh.triangle_count);
  for (int largest = 0; largest < 2; largest++) {
    options.keep_largest = largest;
    options.merge_shells = true;
    outcome o = repair_with(&mesh, &options);
    CHECK_NEAR(o.measures.volume, 64 + 0.2 * 0.16, 1e-9);
    assert_int_equal(o.report.done[SCREE_REPAIR_MERGE_SHELL], 2);
    assert_int_equal(o.report.done[SCREE_REPAIR_DROP_DEBRIS], 1);
    free_outcome(&o);
    options.merge_shells = false;
    o = repair_with(&mesh, &options);
    CHECK_NEAR(o.measures.volume, 64, 1e-9);
    assert_int_equal(o.report.done[SCREE_REPAIR_DROP_DEBRIS], 2);
    free_outcome(&o);
  }
  /* one that cannot be merged, since it is wound inward, goes where it is not wanted */
  options = scree_default_repair_options();
  for (size_t t = block.triangle_count; t < two.triangle_count; t++) shape_flip(&two, t);
  options.debris_share = 0;
  scree_mesh none;
  assert_int_equal(scree_mesh_repair(&two, &options, NULL, &none, NULL, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "wound inward"));
  options.keep_largest = true;
  outcome o = repair_with(&two, &options);
  CHECK_NEAR(o.measures.volume, 64, 1e-9);
  free_outcome(&o);
  scree_mesh_free(&mesh);
  scree_mesh_free(&two);
  scree_mesh_free(&block);
  scree_mesh_free(&stud);
}

/* How far the surface is told to have moved is what the whole of both says. */
static void expect_move(const scree_mesh *given, const outcome *o) {
  const scree_distance_options how = {.sample_count = 20000};
  scree_distance d;
  scree_error error;
  CHECK_OK(scree_mesh_distance(given, &o->mesh, &how, NULL, &d, &error), error);
  double mean = fmax(d.forward.mean, d.backward.mean);
  CHECK_NEAR(o->report.moved_most, d.hausdorff, 0.01 * d.hausdorff);
  CHECK_NEAR(o->report.moved_mean, mean, 0.01 * mean);
}

/* Where noise has folded the surface everywhere, no way of mending is left. */
static void noise(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 4), none;
  scree_rng rng = {.seed = 52};
  scree_error error;
  shape_shake(&mesh, 0.04, &rng);
  assert_int_equal(scree_mesh_repair(&mesh, NULL, NULL, &none, NULL, &error), SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "where they cross, one is wound inward"));
  scree_mesh_free(&mesh);
}

/* A vertex pulled through the other side of its own surface. */
static void spike(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 4);
  scree_measures clean = measures_of(&mesh);
  vec3 p = vec3_load(mesh.positions + 3 * 40);
  vec3_store(mesh.positions + 3 * 40, vec3_scale(p, -1.3));
  outcome o = repair(&mesh);
  assert_true(o.report.before.defects[SCREE_DEFECT_CROSSING_PAIR] > 0);
  assert_true(o.report.done[SCREE_REPAIR_MERGE_SHELL] ||
              o.report.done[SCREE_REPAIR_CUT_INTERSECTION]);
  expect_same(&o, &clean, 0.01);
  expect_move(&mesh, &o);
  double volume = o.measures.volume;
  free_outcome(&o);
  /* the same wound inward is the same body, whether folds are cut or merged */
  for (size_t t = 0; t < mesh.triangle_count; t++) shape_flip(&mesh, t);
  for (int folds = 0; folds < 2; folds++) {
    scree_repair_options options = scree_default_repair_options();
    options.merge_folds = folds;
    o = repair_with(&mesh, &options);
    if (!folds) expect_same(&o, &clean, 0.01); /* merged, the spike's hole stays */
    CHECK_NEAR(o.measures.volume, volume, folds ? 0.03 * volume : 1e-9);
    CHECK_NEAR(o.report.volume_before, volume, 0.01 * volume);
    CHECK_NEAR(o.report.volume_after, o.measures.volume, 1e-12);
    CHECK_NEAR(o.report.area_after, o.measures.area, 1e-12);
    free_outcome(&o);
  }
  scree_mesh_free(&mesh);
}

/* Two neighbours pulled out: a fin too thin for contact, which is cut off; or refused, where so
 * much may not be lost. */
static void sharp_edges(void **state) {
  (void)state;
  scree_mesh mesh = shape_icosphere(1, 4), repaired;
  scree_measures clean = measures_of(&mesh);
  scree_repair_options options = scree_default_repair_options();
  scree_error error;
  for (int k = 0; k < 2; k++) {
    double *p = mesh.positions + 3 * (size_t)mesh.triangles[300 + k];
    vec3_store(p, vec3_scale(vec3_load(p), 3));
  }
  outcome o = repair(&mesh);
  assert_int_equal(o.report.before.defects[SCREE_DEFECT_SHARP_EDGE], 1);
  assert_string_equal(o.report.before.verdict, "not usable as a particle: 1 sharp edge");
  assert_true(o.report.done[SCREE_REPAIR_CUT_INTERSECTION] > 0);
  expect_same(&o, &clean, 0.01);
  free_outcome(&o);
  options.volume_change = 1e-4;
  assert_int_equal(scree_mesh_repair(&mesh, &options, NULL, &repaired, NULL, &error),
                   SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "a repair would change the volume by"));
  scree_mesh_free(&mesh);
}

/* A plate of any outline whose faces come together within a twentieth of its radius. */
static scree_mesh blade(uint32_t rim, double height, scree_rng *rng) {
  scree_mesh m = shape_make(3 * rim + 2, 6 * (size_t)rim);
  for (uint32_t i = 0; i < rim; i++) {
    double angle = 2 * acos(-1) * i / rim, radius = 0.9 + 0.2 * scree_rng_uniform(rng),
           x = radius * cos(angle), y = radius * sin(angle);
    vec3_store(m.positions + 9 * (size_t)i, (vec3){x, y, 0});
    vec3_store(m.positions + 9 * (size_t)i + 3, (vec3){0.95 * x, 0.95 * y, height});
    vec3_store(m.positions + 9 * (size_t)i + 6, (vec3){0.95 * x, 0.95 * y, -height});
    const uint32_t a = 3 * i, b = 3 * ((i + 1) % rim), top = 3 * rim, bottom = top + 1,
                   corners[18] = {a, b, b + 1, a, b + 1, a + 1, a + 1, b + 1, top,
                                  b, a, a + 2, b, a + 2, b + 2, b + 2, a + 2, bottom};
    memcpy(m.triangles + 18 * (size_t)i, corners, sizeof corners);
  }
  vec3_store(m.positions + 9 * (size_t)rim, (vec3){0, 0, height});
  vec3_store(m.positions + 9 * (size_t)rim + 3, (vec3){0, 0, -height});
  return m;
}

/* A point over a base with thin arms: its ridges are sharp and meet there. */
static scree_mesh arrow(uint32_t arms) {
  scree_mesh m = shape_make(2 * arms + 2, 4 * (size_t)arms);
  for (uint32_t i = 0; i < 2 * arms; i++) {
    double angle = acos(-1) * i / arms, radius = i % 2 ? 0.02 : 1;
    vec3_store(m.positions + 3 * (size_t)i, (vec3){radius * cos(angle), radius * sin(angle), 0});
    const uint32_t j = (i + 1) % (2 * arms), corners[6] = {i, j, 2 * arms, j, i, 2 * arms + 1};
    memcpy(m.triangles + 6 * (size_t)i, corners, sizeof corners);
  }
  vec3_store(m.positions + 6 * (size_t)arms, (vec3){0, 0, 1});
  vec3_store(m.positions + 6 * (size_t)arms + 3, (vec3){0, 0, 0});
  return m;
}

static void expect_blunt(const scree_mesh *mesh, size_t edge_count, double volume_change) {
  scree_measures before = measures_of(mesh);
  scree_repair_options options = scree_default_repair_options();
  options.volume_change = volume_change;
  outcome o = repair_with(mesh, &options);
  assert_int_equal(o.report.before.defects[SCREE_DEFECT_SHARP_EDGE], edge_count);
  assert_int_equal(o.report.done[SCREE_REPAIR_BLUNT], edge_count);
  assert_int_equal(o.report.done[SCREE_REPAIR_CUT_INTERSECTION], 0);
  expect_same(&o, &before, volume_change);
  free_outcome(&o);
}

/* Rims all round are made blunt, of bodies and of cavities, and edges that meet at a point. */
static void sharp_rims(void **state) {
  (void)state;
  scree_rng rng = {.seed = 71};
  for (int k = 0; k < 30; k++) {
    uint32_t rim = 20 + (uint32_t)scree_rng_below(&rng, 100);
    scree_mesh plate = blade(rim, 2e-4 + 4e-4 * scree_rng_uniform(&rng), &rng);
    expect_blunt(&plate, rim, 0.01);
    if (k < 10) {
      scree_mesh box = shape_box(3, 3, 0.05), both;
      for (size_t t = 0; t < plate.triangle_count; t++) shape_flip(&plate, t);
      shape_move(&plate, (vec3){1.5, 1.5, 0.02});
      both = shape_join(&box, &plate);
      expect_blunt(&both, rim, 0.01);
      scree_mesh_free(&both);
      scree_mesh_free(&box);
    }
    scree_mesh_free(&plate);
  }
  for (uint32_t arms = 3; arms < 7; arms++) {
    scree_mesh mesh = arrow(arms);
    expect_blunt(&mesh, arms, 0.15);
    scree_mesh_free(&mesh);
  }
}

/* Filled from the smallest on, as long as all of them stay below the share. */
static void small_cavities(void **state) {
  (void)state;
  scree_mesh mesh = shape_grid_box(4, 4, 4, 4);
  double sizes[] = {0.1, 0.3, 0.1, 0.2}, filled = 0; /* of 64 */
  for (int i = 0; i < 4; i++) {
    scree_mesh cavity = shape_box(sizes[i], sizes[i], sizes[i]), both;
    for (size_t t = 0; t < cavity.triangle_count; t++) shape_flip(&cavity, t);
    shape_move(&cavity, (vec3){0.5 + 0.7 * i, 2, 2});
    both = shape_join(&mesh, &cavity);
    scree_mesh_free(&mesh);
    scree_mesh_free(&cavity);
    mesh = both;
    if (sizes[i] < 0.3) filled += pow(sizes[i], 3);
  }
  scree_repair_options options = scree_default_repair_options();
  options.cavity_share = 0.011 / 64;
  outcome o = repair_with(&mesh, &options);
  assert_int_equal(o.report.done[SCREE_REPAIR_FILL_CAVITY], 3);
  CHECK_NEAR(o.report.filled_volume, filled, 1e-12);
  CHECK_NEAR(o.measures.volume, 64 - 0.027, 1e-9);
  free_outcome(&o);
  options.cavity_share = 0;
  o = repair_with(&mesh, &options);
  CHECK_NEAR(o.measures.volume, 64 - 0.027 - filled, 1e-9);
  free_outcome(&o);
  scree_mesh_free(&mesh);
}

/* ---- Invariance ---- */

static void same_whatever_order(void **state) {
  (void)state;
  scree_rng rng = {.seed = 56};
  int repaired = 0;
  for (int n = 0; n < 150; n++) {
    scree_mesh mesh = shape_random_tangle(&rng), first, again;
    scree_error error;
    scree_status status = scree_mesh_repair(&mesh, NULL, NULL, &first, NULL, &error);
    shuffle(&mesh, &rng);
    assert_int_equal(scree_mesh_repair(&mesh, NULL, NULL, &again, NULL, &error), status);
    if (status == SCREE_OK) {
      expect_same_mesh(&first, &again);
      scree_mesh_free(&first);
      scree_mesh_free(&again);
      repaired++;
    }
    scree_mesh_free(&mesh);
  }
  print_message("%d of 150 tangles repaired\n", repaired);
}

static void moved_turned_scaled(void **state) {
  (void)state;
  scree_rng rng = {.seed = 57};
  scree_mesh mesh = body();
  for (size_t t = 0; t < mesh.triangle_count; t += 11) shape_flip(&mesh, t);
  mesh.triangle_count -= 5;
  outcome first = repair(&mesh);
  for (int n = 0; n < 6; n++) {
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    double scale = pow(10, 3 - n);
    for (int i = 0; i < 9; i++) turn.m[i / 3][i % 3] *= scale;
    scree_mesh moved;
    scree_error error;
    CHECK_OK(scree_mesh_copy(&mesh, &moved, &error), error);
    shape_transform(&moved, &turn, vec3_scale(scree_rng_direction(&rng), 10 * scale));
    outcome o = repair(&moved);
    for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++)
      assert_int_equal(o.report.done[i], first.report.done[i]);
    CHECK_NEAR(o.measures.area, first.measures.area * scale * scale, 1e-9 * o.measures.area);
    CHECK_NEAR(o.measures.volume, first.measures.volume * pow(scale, 3), 1e-9 * o.measures.volume);
    free_outcome(&o);
    scree_mesh_free(&moved);
  }
  free_outcome(&first);
  scree_mesh_free(&mesh);
}

/* What needs nothing stays; what cannot be repaired as well; the rest is replaced by what a copy
 * would be. */
static void prepare_in_place(scree_mesh *mesh) {
  scree_error error;
  scree_repair_report report;
  scree_repair_options options = scree_default_repair_options();
  scree_mesh made, canonical;
  CHECK_OK(scree_mesh_repair(mesh, &options, NULL, &canonical, NULL, &error), error);
  const double *positions = canonical.positions;
  CHECK_OK(scree_mesh_prepare(&canonical, &options, NULL, &canonical, &report, &error), error);
  CHECK_OK(scree_mesh_prepare(&canonical, NULL, NULL, &canonical, NULL, &error), error);
  assert_ptr_equal(canonical.positions, positions);
  assert_true(report.before.usable && report.after.usable);
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++) assert_int_equal(report.done[i], 0);
  canonical.triangle_count--;
  CHECK_OK(scree_mesh_prepare(&canonical, &options, NULL, &made, NULL, &error), error);
  assert_int_equal(scree_mesh_prepare(&canonical, NULL, NULL, &canonical, NULL, &error),
                   SCREE_BAD_MESH);
  assert_ptr_equal(canonical.positions, positions);
  CHECK_OK(scree_mesh_prepare(&canonical, &options, NULL, &canonical, &report, &error), error);
  assert_false(report.before.usable);
  assert_int_equal(canonical.triangle_count, made.triangle_count);
  assert_int_equal(canonical.vertex_count, made.vertex_count);
  assert_memory_equal(canonical.triangles, made.triangles,
                      3 * made.triangle_count * sizeof *made.triangles);
  assert_memory_equal(canonical.positions, made.positions,
                      3 * made.vertex_count * sizeof *made.positions);
  scree_mesh_free(&canonical);
  scree_mesh_free(&made);
}

static void prepare(void **state) {
  (void)state;
  scree_error error;
  scree_repair_report report;
  scree_repair_options options = scree_default_repair_options();
  scree_mesh mesh = body(), ready;
  CHECK_OK(scree_mesh_prepare(&mesh, NULL, NULL, &ready, &report, &error), error);
  assert_true(report.before.usable && report.after.usable);
  prepare_in_place(&ready);
  scree_mesh_free(&ready);
  mesh.triangle_count--;
  assert_int_equal(scree_mesh_prepare(&mesh, NULL, NULL, &ready, &report, &error), SCREE_BAD_MESH);
  assert_string_equal(error.message,
                      "the mesh is not usable as a particle: 3 boundary edges, 1 hole");
  CHECK_OK(scree_mesh_prepare(&mesh, &options, NULL, &ready, &report, &error), error);
  assert_int_equal(report.done[SCREE_REPAIR_FILL_HOLE], 1);
  scree_mesh_free(&ready);
  options.seam_tolerance = NAN;
  assert_int_equal(scree_mesh_prepare(&mesh, &options, NULL, &ready, &report, &error),
                   SCREE_BAD_ARGUMENT);
  scree_mesh_free(&mesh);
}

/* ---- Memory ---- */

static scree_status call_check(void *context, scree_error *error) {
  scree_check check;
  return scree_mesh_check(context, NULL, NULL, &check, error);
}

/* Facets over many magnitudes that split each other for ever: refused before it takes a minute. */
static void runs_away(void **state) {
  (void)state;
  static const uint8_t bytes[] = {
      3,   36,  0,   48,  0,   0,   156, 100, 0,   30,  99,  12,  27,  96,  24,  21,  92,  36,  12,
      87,  48,  1,   80,  58,  247, 72,  68,  237, 63,  77,  230, 53,  84,  227, 42,  90,  227, 30,
      95,  232, 18,  98,  240, 6,   99,  251, 250, 99,  5,   238, 98,  16,  226, 95,  24,  214, 90,
      29,  203, 84,  29,  193, 77,  26,  184, 68,  19,  176, 58,  9,   169, 48,  255, 164, 36,  244,
      160, 24,  235, 157, 12,  229, 156, 0,   226, 157, 244, 229, 160, 232, 235, 164, 220, 244, 169,
      208, 255, 176, 198, 9,   184, 188, 19,  193, 179, 26,  203, 172, 29,  214, 166, 29,  226, 161,
      24,  238, 158, 16,  250, 157, 5,   6,   157, 251, 18,  158, 240, 30,  161, 232, 42,  166, 227,
      53,  172, 227, 63,  179, 230, 72,  188, 237, 80,  198, 247, 87,  255, 255, 255, 255, 255, 255,
      255, 255, 255, 255, 208, 1,   92,  220, 12,  96,  232, 21,  99,  244, 27,  0,   2,   1,   0,
      3,   2,   0,   4,   3,   0,   5,   4,   17,  15,  255, 39,  237, 243, 21,  39,  11,  42,  9,
      252, 220, 12,  233, 236, 216, 3,   236, 216, 3,   248, 216, 233, 248, 216, 233, 0,   6,   5,
      0,   7,   6,   0,   8,   7,   0,   9,   8,   0,   10,  9,   0,   11,  10,  0,   12,  11,  0,
      13,  12,  0,   14,  13,  0,   15,  14,  236, 19,  3,   236, 238, 3,   248, 238, 233, 248, 238,
      28,  0,   16,  15,  0,   17,  16,  0,   18};
  static fuzz_mesh heap;
  scree_mesh mesh;
  scree_error error;
  scree_repair_options options = scree_default_repair_options();
  options.hole_share = 1;
  options.keep_largest = true;
  options.debris_share = 0;
  fuzz_mesh_decode(bytes, sizeof bytes, &heap);
  assert_int_equal(scree_mesh_repair(&heap.mesh, &options, NULL, &mesh, NULL, &error),
                   SCREE_BAD_MESH);
  assert_non_null(strstr(error.message, "each mending asks for more, and its 42 triangles"));
}

static scree_status call_prepare(void *context, scree_error *error) {
  scree_repair_options options = scree_default_repair_options();
  scree_mesh ready = {0};
  scree_status status = scree_mesh_prepare(context, &options, NULL, &ready, NULL, error);
  scree_mesh_free(&ready);
  return status;
}

/* A mesh with some of everything, so that every stage runs. */
static void out_of_memory(void **state) {
  (void)state;
  scree_mesh ball = shape_icosphere(1, 3), box = shape_grid_box(1, 1, 1, 2);
  vec3 p = vec3_load(ball.positions + 3 * 7);
  vec3_store(ball.positions + 3 * 7, vec3_scale(p, -1.2));
  shape_move(&box, (vec3){3, 0, 0});
  scree_mesh two = shape_join(&ball, &box);
  shape_move(&box, (vec3){1, 1, 0});
  scree_mesh mesh = shape_join(&two, &box);
  shape_flip(&mesh, 3);
  uint32_t c[3];
  memcpy(c, mesh.triangles + 3 * (size_t)1290, sizeof c);
  append_facet(&mesh, c[0], c[1], c[2]);
  append_facet(&mesh, c[0], c[1], 3);
  mesh.triangles[6] = mesh.triangles[7];
  assert_true(check_allocation_failures(call_check, &mesh) > 10);
  assert_true(check_allocation_failures(call_prepare, &mesh) > 50);
  scree_mesh_free(&mesh);
  scree_mesh_free(&two);
  scree_mesh_free(&ball);
  scree_mesh_free(&box);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(sound_stays),
                                     cmocka_unit_test(turned_and_doubled),
                                     cmocka_unit_test(loose_facets),
                                     cmocka_unit_test(holes),
                                     cmocka_unit_test(large_hole),
                                     cmocka_unit_test(t_junctions),
                                     cmocka_unit_test(labels),
                                     cmocka_unit_test(touching_boxes),
                                     cmocka_unit_test(fins),
                                     cmocka_unit_test(fin_on_an_open_surface),
                                     cmocka_unit_test(membranes),
                                     cmocka_unit_test(debris_and_cavities),
                                     cmocka_unit_test(coordinates_that_are_no_numbers),
                                     cmocka_unit_test(nested_is_swallowed),
                                     cmocka_unit_test(parts_that_meet_are_one),
                                     cmocka_unit_test(noise),
                                     cmocka_unit_test(spike),
                                     cmocka_unit_test(sharp_edges),
                                     cmocka_unit_test(sharp_rims),
                                     cmocka_unit_test(small_cavities),
                                     cmocka_unit_test(same_whatever_order),
                                     cmocka_unit_test(moved_turned_scaled),
                                     cmocka_unit_test(runs_away),
                                     cmocka_unit_test(prepare),
                                     cmocka_unit_test(out_of_memory)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
