/* Bodies cut into cells, convex or not: pieces are closed, fill the body, and have the same facets
 * where they meet. The oracles know nothing of cells: which pieces wind round a point, and which
 * facets of the pieces are each other's reverse. */
#include "base/rng.h"
#include "base/vec.h"
#include "mesh/measure/solid_angle.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/curve.h"
#include "support/shapes.h"

/* ---- what must hold of all ---- */

typedef struct facet {
  double corners[9]; /* from the least corner on, as sorted */
  int turn;          /* +1: as in its piece; -1: turned round */
  size_t piece;
} facet;

static int compare_corners(const void *a, const void *b) {
  const double *p = a, *q = b;
  for (int k = 0; k < 3; k++)
    if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
  return 0;
}

static int compare_facets(const void *a, const void *b) {
  return memcmp(a, b, sizeof(double[9]));
}

/* The same facet, from either side, comes out with the same corners. */
static facet facet_of(const scree_mesh *mesh, size_t t, size_t piece) {
  facet f = {.piece = piece, .turn = 1};
  size_t order[3] = {0, 1, 2};
  const double *p[3];
  for (size_t k = 0; k < 3; k++) p[k] = mesh->positions + 3 * mesh->triangles[3 * t + k];
  for (int i = 0; i < 2; i++)
    for (int k = 0; k < 2; k++)
      if (compare_corners(p[order[k]], p[order[k + 1]]) > 0) {
        size_t swap = order[k];
        order[k] = order[k + 1];
        order[k + 1] = swap;
        f.turn = -f.turn;
      }
  for (size_t k = 0; k < 3; k++) memcpy(f.corners + 3 * k, p[order[k]], 3 * sizeof(double));
  return f;
}

static double facet_area(const facet *f) {
  vec3 a = vec3_load(f->corners), b = vec3_load(f->corners + 3), c = vec3_load(f->corners + 6);
  return vec3_norm(vec3_triangle_normal(a, b, c)) / 2;
}

/* Facets of two pieces are each other's reverse; what they have of area is that of the faces, but
 * for those that were left out; the others are the body's surface. */
static void check_facets(const scree_mesh *body, const scree_fracture *f) {
  size_t count = 0, n = 0;
  double surface, inner = 0, outer = 0, faces = 0;
  scree_error error;
  for (size_t p = 0; p < f->piece_count; p++) count += f->pieces[p].triangle_count;
  facet *all = malloc((count + 1) * sizeof *all);
  assert_non_null(all);
  for (size_t p = 0; p < f->piece_count; p++)
    for (size_t t = 0; t < f->pieces[p].triangle_count; t++)
      all[n++] = facet_of(&f->pieces[p], t, p);
  qsort(all, count, sizeof *all, compare_facets);
  for (size_t k = 0; k < count; k++) {
    bool twin = k + 1 < count && compare_facets(&all[k], &all[k + 1]) == 0;
    if (!twin) {
      outer += facet_area(&all[k]);
      continue;
    }
    assert_true(all[k].turn == -all[k + 1].turn && all[k].piece != all[k + 1].piece);
    inner += facet_area(&all[k++]);
    assert_true(k + 1 >= count || compare_facets(&all[k], &all[k + 1]) != 0);
  }
  free(all);
  for (size_t i = 0; i < f->face_count; i++) faces += f->faces[i].area;
  CHECK_OK(scree_mesh_area_volume(body, &surface, NULL, &error), error);
  CHECK_NEAR(outer, surface, 1e-9 * surface);
  CHECK_NEAR(faces, inner, (f->small_face_count ? 1e-3 : 1e-9) * inner);
}

static void check_pieces(const scree_mesh *body, const scree_fracture *f) {
  double volume, sum = 0, each;
  scree_error error;
  for (size_t p = 0; p < f->piece_count; p++) {
    scree_topology t;
    CHECK_OK(scree_mesh_topology(&f->pieces[p], &t, &error), error);
    if (!t.closed || !t.manifold || !t.oriented || t.unused_vertex_count)
      fail_msg("piece %zu of %zu is no closed surface", p, f->piece_count);
    CHECK_OK(scree_mesh_area_volume(&f->pieces[p], NULL, &each, &error), error);
    assert_true(each > 0);
    sum += each;
  }
  CHECK_OK(scree_mesh_area_volume(body, NULL, &volume, &error), error);
  CHECK_NEAR(sum, volume, 1e-9 * volume);
}

static bool is_in(const scree_mesh *mesh, vec3 p) {
  return scree_winding_about(mesh, 0, mesh->triangle_count, p) > 0.5;
}

/* Every point of the body is in one piece, none outside in any. */
static void check_points(const scree_mesh *body, const scree_fracture *f, size_t count) {
  scree_rng rng = {3, 0, 0};
  scree_measures m;
  scree_error error;
  CHECK_OK(scree_mesh_measure(body, &m, &error), error);
  for (size_t k = 0; k < count; k++) {
    double p[3];
    size_t in = 0;
    for (int a = 0; a < 3; a++)
      p[a] = m.box_min[a] + m.dimensions[a] * (1.1 * scree_rng_uniform(&rng) - 0.05);
    for (size_t i = 0; i < f->piece_count; i++) in += is_in(&f->pieces[i], vec3_load(p));
    assert_int_equal(in, is_in(body, vec3_load(p)));
  }
}

/* Faces lead from piece to piece, and the section of each is that of a plane figure. */
static void check_faces(const scree_fracture *f) {
  for (size_t i = 0; i < f->face_count; i++) {
    const scree_fracture_face *j = &f->faces[i];
    vec3 n = vec3_load(j->normal), axis = vec3_load(j->axis);
    assert_true(j->a < f->piece_count && j->b < f->piece_count && j->a != j->b);
    CHECK_NEAR(vec3_norm(n), 1, 1e-12);
    CHECK_NEAR(vec3_norm(axis), 1, 1e-12);
    CHECK_NEAR(vec3_dot(n, axis), 0, 1e-9);
    assert_true(j->second_moments[0] >= j->second_moments[1] && j->distance > 0);
    /* of all figures of this area the disc has the least polar moment; none reaches less than what
     * its moment asks for */
    double polar = j->second_moments[0] + j->second_moments[1];
    assert_true(polar >= j->area * j->area / 6.2831853071795865 * (1 - 1e-9));
    assert_true(j->reach[0] * j->reach[0] * j->area >= j->second_moments[0] * (1 - 1e-9));
    assert_true(j->reach[1] * j->reach[1] * j->area >= j->second_moments[1] * (1 - 1e-9));
  }
}

static scree_fracture broken(const scree_mesh *body, size_t cells, uint64_t seed) {
  scree_fracture_options o = scree_default_fracture_options();
  scree_fracture f = {0};
  scree_error error;
  o.cell_count = cells;
  o.seed = seed;
  CHECK_OK(scree_mesh_fracture(body, &o, NULL, &f, &error), error);
  return f;
}

static scree_fracture check_broken(const scree_mesh *body, size_t cells, uint64_t seed) {
  scree_fracture f = broken(body, cells, seed);
  check_pieces(body, &f);
  check_facets(body, &f);
  check_faces(&f);
  return f;
}

/* ---- bodies ---- */

/* A ball with a cavity that few cells have a part of. */
static scree_mesh hollow_ball(void) {
  scree_mesh outside = shape_icosphere(1, 2), inside = shape_icosphere(0.4, 1);
  for (size_t t = 0; t < inside.triangle_count; t++) shape_flip(&inside, t);
  scree_mesh both = shape_join(&outside, &inside);
  scree_mesh_free(&outside);
  scree_mesh_free(&inside);
  return both;
}

static scree_mesh body_of(int kind) {
  switch (kind) {
  case 0:
    return shape_box(3, 2, 1);
  case 1:
    return shape_grid_box(1, 1, 1, 5);
  case 2:
    return shape_icosphere(1, 2);
  case 3:
    return shape_torus(1, 0.3, 24, 12);
  case 4:
    return hollow_ball();
  case 5:
    return shape_tetrahedron(1, 2, 3);
  default:
    return shape_box(10, 10, 0.2);
  }
}

static void bodies_are_filled(void **state) {
  (void)state;
  static const size_t counts[] = {1, 2, 3, 10, 60, 200};
  for (int kind = 0; kind < 7; kind++)
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
      scree_mesh body = body_of(kind);
      scree_fracture f = check_broken(&body, counts[k], 7 + k);
      if (counts[k] <= 10) check_points(&body, &f, 200);
      assert_true(f.piece_count >= (counts[k] + 1) / 2);
      scree_fracture_free(&f);
      scree_mesh_free(&body);
    }
}

/* Two cells of a long bar meet in its section, more or less across. */
static void a_section_is_the_bars(void **state) {
  (void)state;
  scree_mesh bar = shape_grid_box(1, 2, 40, 3);
  scree_fracture f = check_broken(&bar, 2, 1);
  assert_int_equal(f.piece_count, 2);
  assert_int_equal(f.face_count, 1);
  CHECK_NEAR(f.faces[0].area, 2, 0.02);
  CHECK_NEAR(f.faces[0].second_moments[0], 1 * 8. / 12, 0.02);
  CHECK_NEAR(f.faces[0].second_moments[1], 2 * 1. / 12, 0.01);
  CHECK_NEAR(fabs(f.faces[0].axis[1]), 1, 0.01);
  CHECK_NEAR(f.faces[0].reach[0], 1, 0.02);
  CHECK_NEAR(f.faces[0].reach[1], 0.5, 0.02);
  CHECK_NEAR(f.faces[0].distance, 20, 1);
  scree_fracture_free(&f);
  scree_mesh_free(&bar);
}

/* Spread of volumes, share of the mean. */
static double uneven(const scree_fracture *f) {
  double sum = 0, squares = 0, each;
  for (size_t p = 0; p < f->piece_count; p++) {
    (void)scree_mesh_area_volume(&f->pieces[p], NULL, &each, NULL);
    sum += each;
    squares += each * each;
  }
  double n = (double)f->piece_count, mean = sum / n;
  return sqrt(squares / n - mean * mean) / mean;
}

static void relaxed_cells_are_alike(void **state) {
  (void)state;
  scree_fracture_options o = scree_default_fracture_options();
  scree_mesh body = shape_box(1, 1, 1);
  scree_fracture f;
  scree_error error;
  o.rounds = 0;
  CHECK_OK(scree_mesh_fracture(&body, &o, NULL, &f, &error), error);
  double drawn = uneven(&f);
  scree_fracture_free(&f);
  f = broken(&body, 60, 1);
  assert_true(uneven(&f) < 0.6 * drawn);
  scree_fracture_free(&f);
  scree_mesh_free(&body);
}

/* Means over the pieces: of their size along x over that along z, and of volumes near the origin
 * and far from it. */
static void means(const scree_fracture *f, double *ratio, double *low, double *high) {
  double counts[2] = {0, 0}, sums[2] = {0, 0};
  scree_error error;
  *ratio = 0;
  for (size_t p = 0; p < f->piece_count; p++) {
    scree_measures m;
    CHECK_OK(scree_mesh_measure(&f->pieces[p], &m, &error), error);
    *ratio += m.dimensions[0] / m.dimensions[2] / (double)f->piece_count;
    bool far = vec3_norm(vec3_load(m.centroid)) > 0.6;
    counts[far]++;
    sums[far] += m.volume;
  }
  *low = sums[0] / counts[0];
  *high = sums[1] / counts[1];
}

static void grain_and_dense_places(void **state) {
  (void)state;
  double ratio, low, high;
  scree_mesh body = shape_box(1, 1, 1);
  scree_error error;
  scree_fracture f;
  scree_fracture_options o = scree_default_fracture_options();
  o.cell_count = 100;
  o.grain[0] = 1, o.grain[2] = 0;
  o.grain_stretch = 4;
  CHECK_OK(scree_mesh_fracture(&body, &o, NULL, &f, &error), error);
  check_pieces(&body, &f);
  check_facets(&body, &f);
  means(&f, &ratio, &low, &high);
  assert_true(ratio > 2);
  scree_fracture_free(&f);
  o = scree_default_fracture_options();
  o.near_distance = 0.2;
  CHECK_OK(scree_mesh_fracture(&body, &o, NULL, &f, &error), error);
  check_pieces(&body, &f);
  means(&f, &ratio, &low, &high);
  assert_true(low < 0.6 * high);
  scree_fracture_free(&f);
  scree_mesh_free(&body);
}

static void same_seed_same_bits(void **state) {
  (void)state;
  scree_mesh body = shape_torus(1, 0.3, 24, 12);
  scree_fracture a = broken(&body, 40, 5), b = broken(&body, 40, 5), c = broken(&body, 40, 6);
  assert_int_equal(a.piece_count, b.piece_count);
  for (size_t p = 0; p < a.piece_count; p++) {
    assert_int_equal(a.pieces[p].vertex_count, b.pieces[p].vertex_count);
    assert_memory_equal(a.pieces[p].positions, b.pieces[p].positions,
                        a.pieces[p].vertex_count * 3 * sizeof(double));
  }
  assert_memory_equal(a.faces, b.faces, a.face_count * sizeof *a.faces);
  assert_true(a.pieces[0].positions[0] != c.pieces[0].positions[0] ||
              a.pieces[0].vertex_count != c.pieces[0].vertex_count);
  scree_fracture_free(&a);
  scree_fracture_free(&b);
  scree_fracture_free(&c);
  scree_mesh_free(&body);
}

/* Where particles are made of the pieces, none is refused for a sharp edge or a flat facet. */
static void pieces_are_particles(void **state) {
  (void)state;
  for (int kind = 0; kind < 7; kind++) {
    scree_mesh body = body_of(kind);
    scree_fracture f = broken(&body, 60, 11);
    for (size_t p = 0; p < f.piece_count; p++) {
      scree_check check;
      scree_error error;
      CHECK_OK(scree_mesh_check(&f.pieces[p], NULL, NULL, &check, &error), error);
      if (!check.usable) fail_msg("body %d, piece %zu: %s", kind, p, check.verdict);
    }
    scree_fracture_free(&f);
    scree_mesh_free(&body);
  }
}

static void refused(const scree_mesh *body, const scree_fracture_options *o, scree_status status,
                    const char *words) {
  scree_fracture f = {0};
  scree_error error;
  assert_int_equal(scree_mesh_fracture(body, o, NULL, &f, &error), status);
  if (!strstr(error.message, words)) fail_msg("'%s' lacks '%s'", error.message, words);
  assert_null(f.pieces);
}

static void bad_input_is_told(void **state) {
  (void)state;
  scree_fracture_options o = scree_default_fracture_options();
  scree_mesh body = shape_box(1, 1, 1), sheet = shape_sheet(0, 4);
  refused(&sheet, &o, SCREE_BAD_MESH, "16 boundary edges");
  for (size_t t = 0; t < body.triangle_count; t++) shape_flip(&body, t);
  refused(&body, &o, SCREE_BAD_MESH, "volume is -1e+09 mm3");
  for (size_t t = 0; t < body.triangle_count; t++) shape_flip(&body, t);
  o.cell_count = 0;
  refused(&body, &o, SCREE_BAD_ARGUMENT, "0 cells");
  o = scree_default_fracture_options();
  o.grain_stretch = 0.5;
  refused(&body, &o, SCREE_BAD_ARGUMENT, "grain of 0.5");
  o = scree_default_fracture_options();
  o.least_volume = 2;
  refused(&body, &o, SCREE_BAD_ARGUMENT, "least volume 2");
  o = scree_default_fracture_options();
  o.near_distance = -1;
  refused(&body, &o, SCREE_BAD_ARGUMENT, "near");
  o = scree_default_fracture_options();
  for (size_t k = 0; k < 3 * body.vertex_count; k++) body.positions[k] += 1e12;
  refused(&body, &o, SCREE_BAD_MESH, "rounding of the coordinates");
  scree_mesh_free(&body);
  scree_mesh_free(&sheet);
}

static scree_status break_box(void *context, scree_error *error) {
  scree_fracture_options o = scree_default_fracture_options();
  scree_fracture f = {0};
  o.cell_count = 5;
  scree_status status = scree_mesh_fracture(context, &o, NULL, &f, error);
  scree_fracture_free(&f);
  return status;
}

static void no_memory_is_told(void **state) {
  (void)state;
  scree_mesh body = shape_box(1, 2, 3);
  check_allocation_failures(break_box, &body);
  scree_mesh_free(&body);
}

/* ---- scans ---- */

/* What is closed, or can be made so, with at most so many triangles. */
static bool load_scan(const char *path, size_t triangles, scree_mesh *mesh) {
  scree_scan scan = {0};
  scree_repair_options repair = scree_default_repair_options();
  scree_error error;
  repair.hole_share = 1;
  scree_status status = scree_scan_read(path, NULL, &scan, &error);
  if (status == SCREE_OK)
    status = scree_mesh_prepare(&scan.mesh, &repair, NULL, &scan.mesh, NULL, &error);
  if (status != SCREE_OK) {
    print_message("left out: %s\n", error.message);
    scree_scan_free(&scan);
    return false;
  }
  scree_curve *curve = curve_of(&scan.mesh, SCREE_METHOD_VOLUME);
  CHECK_OK(scree_curve_mesh(curve, scree_curve_find(curve, triangles), mesh, &error), error);
  scree_curve_free(curve);
  scree_scan_free(&scan);
  return true;
}

static void scans_are_filled(void **state) {
  (void)state;
  static const char *const names[] = {"imu_adis16480.stl",    "penkesu_screen_case.stl",
                                      "stone_0_320.ply",      "stone_E22.ply",
                                      "rock_chrono4.obj",     "ugly_3dsmax.stl",
                                      "ycb_power_drill.obj",  "ugly_angle_block.stl",
                                      "stone_073ac.ply",      "asteroid_phobos_seam.obj",
                                      "rock_complexshape.stl"};
  if (!scan_data_folder()) {
    skip();
    return;
  }
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    char path[1000];
    scree_mesh body;
    if (!scan_data_path(names[i], path, sizeof path) || !load_scan(path, 1000, &body)) continue;
    scree_fracture f = check_broken(&body, 50, i);
    print_message("%s: %zu triangles, %zu pieces, %zu cells apart, %zu joined, %zu restarts\n",
                  names[i], body.triangle_count, f.piece_count, f.apart_count, f.joined_count,
                  f.restart_count);
    scree_fracture_free(&f);
    scree_mesh_free(&body);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bodies_are_filled),       cmocka_unit_test(a_section_is_the_bars),
      cmocka_unit_test(relaxed_cells_are_alike), cmocka_unit_test(grain_and_dense_places),
      cmocka_unit_test(same_seed_same_bits),     cmocka_unit_test(pieces_are_particles),
      cmocka_unit_test(bad_input_is_told),       cmocka_unit_test(no_memory_is_told),
      cmocka_unit_test(scans_are_filled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
