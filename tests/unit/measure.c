/* Measures against closed forms to 1e-12, wherever the body lies, however it is turned, scaled or
 * sheared; the sums against long double; boxes and hulls against known least ones. */
#include "support/check.h"
#include "support/shapes.h"

#include "base/eigen.h"
#include "mesh/adjacency.h"
#include "mesh/measure/bounds.h"

#define PI    3.141592653589793
#define TIGHT 1e-12

static scree_measures measures_of(const scree_mesh *mesh) {
  scree_measures m;
  scree_error error;
  CHECK_OK(scree_mesh_measure(mesh, &m, &error), error);
  return m;
}

/* ---- Mass properties ---- */

/* Volume, centroid and second moment about the centroid, int x x' dV. */
typedef struct solid {
  double volume;
  vec3 centroid;
  mat3 second;
} solid;

static solid box_solid(double x, double y, double z) {
  double v = x * y * z, w = v / 12;
  return (solid){
      v, {x / 2, y / 2, z / 2}, {{{w * x * x, 0, 0}, {0, w * y * y, 0}, {0, 0, w * z * z}}}};
}

/* C = V/20 sum (v - c)(v - c)' over the corners v. */
static solid tetrahedron_solid(double x, double y, double z) {
  const double corner[4][3] = {{0, 0, 0}, {x, 0, 0}, {0, y, 0}, {0, 0, z}},
               c[3] = {x / 4, y / 4, z / 4};
  solid s = {x * y * z / 6, {c[0], c[1], c[2]}, {{{0}}}};
  for (int v = 0; v < 4; v++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        s.second.m[i][j] += s.volume / 20 * (corner[v][i] - c[i]) * (corner[v][j] - c[j]);
  return s;
}

/* The polyhedron itself, in long double, by another formula: int over each tetrahedron from the
 * origin of x x' from its corners and its mean, all from a . (b x c). */
static solid long_double_solid(const scree_mesh *mesh) {
  long double volume = 0, first[3] = {0}, second[3][3] = {{0}};
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const double *p[3];
    for (int k = 0; k < 3; k++)
      p[k] = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)k];
    long double d = 0;
    for (int k = 0; k < 3; k++) {
      int i = (k + 1) % 3, j = (k + 2) % 3;
      d += (long double)p[0][k] * ((long double)p[1][i] * p[2][j] - (long double)p[1][j] * p[2][i]);
    }
    volume += d / 6;
    for (int i = 0; i < 3; i++) {
      long double si = (long double)p[0][i] + p[1][i] + p[2][i];
      first[i] += d / 24 * si;
      for (int j = 0; j < 3; j++) {
        long double sum = si * ((long double)p[0][j] + p[1][j] + p[2][j]);
        for (int k = 0; k < 3; k++) sum += (long double)p[k][i] * p[k][j];
        second[i][j] += d / 120 * sum;
      }
    }
  }
  solid s = {(double)volume, {0, 0, 0}, {{{0}}}};
  long double c[3];
  for (int i = 0; i < 3; i++) c[i] = first[i] / volume;
  s.centroid = (vec3){(double)c[0], (double)c[1], (double)c[2]};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) s.second.m[i][j] = (double)(second[i][j] - volume * c[i] * c[j]);
  return s;
}

static double determinant(const mat3 *a) {
  return vec3_dot(vec3_load(a->m[0]), vec3_cross(vec3_load(a->m[1]), vec3_load(a->m[2])));
}

/* x -> a x + offset */
static solid map_solid(const solid *s, const mat3 *a, vec3 offset) {
  double stretch = fabs(determinant(a));
  mat3 transposed = mat3_transpose(a), half = mat3_mul(a, &s->second);
  solid mapped = {s->volume * stretch, vec3_add(mat3_mul_vec(a, s->centroid), offset),
                  mat3_mul(&half, &transposed)};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) mapped.second.m[i][j] *= stretch;
  return mapped;
}

/* size: of the body; lies: rounding of its coordinates, relative to size. */
static void check_solid(const scree_measures *m, const solid *s, double size, double tolerance) {
  double trace = s->second.m[0][0] + s->second.m[1][1] + s->second.m[2][2];
  CHECK_NEAR(fabs(m->volume), s->volume, tolerance * s->volume);
  CHECK_NEAR(m->centroid[0], s->centroid.x, tolerance * size);
  CHECK_NEAR(m->centroid[1], s->centroid.y, tolerance * size);
  CHECK_NEAR(m->centroid[2], s->centroid.z, tolerance * size);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      CHECK_NEAR(m->inertia[i][j], (i == j ? trace : 0) - s->second.m[i][j], tolerance * trace);
  CHECK_NEAR(m->equivalent_diameter, cbrt(6 * s->volume / PI), tolerance * size);
}

/* I = sum of moments times axis axis', and the axes are orthonormal and right-handed. */
static void check_axes(const scree_measures *m) {
  double scale = m->principal_moments[2];
  assert_true(m->principal_moments[0] <= m->principal_moments[1]);
  assert_true(m->principal_moments[1] <= m->principal_moments[2]);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double sum = 0, dot = 0;
      for (int k = 0; k < 3; k++) {
        sum += m->principal_moments[k] * m->principal_axes[k][i] * m->principal_axes[k][j];
        dot += m->principal_axes[i][k] * m->principal_axes[j][k];
      }
      CHECK_NEAR(sum, m->inertia[i][j], 1e-14 * scale);
      CHECK_NEAR(dot, i == j, 1e-14);
    }
  mat3 axes;
  memcpy(axes.m, m->principal_axes, sizeof axes.m);
  CHECK_NEAR(determinant(&axes), 1, 1e-14);
}

static mat3 random_map(scree_rng *rng) {
  mat3 turn = quat_to_mat3(scree_rng_rotation(rng)), back = quat_to_mat3(scree_rng_rotation(rng)),
       stretch = {{{0}}};
  for (int i = 0; i < 3; i++) stretch.m[i][i] = exp(scree_rng_normal(rng));
  mat3 half = mat3_mul(&stretch, &back);
  return mat3_mul(&turn, &half);
}

static void test_affine_solids(void **state) {
  (void)state;
  scree_rng rng = {.seed = 3};
  for (int i = 0; i < 600; i++) {
    scree_mesh mesh;
    solid s;
    if (i % 3 == 0) {
      mesh = shape_grid_box(1, 2, 0.5, 1 + (size_t)i % 5);
      s = box_solid(1, 2, 0.5);
    } else if (i % 3 == 1) {
      mesh = shape_tetrahedron(1, 0.5, 2);
      s = tetrahedron_solid(1, 0.5, 2);
    } else {
      mesh = shape_icosphere(1, 2);
      s = long_double_solid(&mesh);
    }
    mat3 map = random_map(&rng);
    vec3 offset = vec3_scale(scree_rng_direction(&rng), 3);
    s = map_solid(&s, &map, offset);
    shape_transform(&mesh, &map, offset);
    scree_measures m = measures_of(&mesh);
    double size = vec3_norm(vec3_load(m.dimensions));
    check_solid(&m, &s, size, TIGHT);
    check_axes(&m);
    assert_true(m.closed && !m.inward);
    scree_mesh_free(&mesh);
  }
}

static void test_box(void **state) {
  (void)state;
  scree_mesh mesh = shape_box(3, 1, 2);
  shape_move(&mesh, (vec3){4, 5, 6});
  scree_measures m = measures_of(&mesh);
  CHECK_NEAR(m.area, 22, 22 * TIGHT);
  CHECK_NEAR(m.hull_area, 22, 22 * TIGHT);
  CHECK_NEAR(m.convexity, 1, TIGHT);
  CHECK_NEAR(m.sphericity, pow(PI, 1.0 / 3) * pow(36, 2.0 / 3) / 22, TIGHT);
  const double sides[3] = {3, 1, 2}, moments[3] = {2.5, 5, 6.5}; /* V/12 (b^2 + c^2) */
  const double descending[3] = {3, 2, 1}, low[3] = {4, 5, 6};
  for (int k = 0; k < 3; k++) {
    CHECK_NEAR(m.dimensions[k], sides[k], TIGHT);
    CHECK_NEAR(m.box_min[k], low[k], TIGHT);
    CHECK_NEAR(m.box_max[k], low[k] + sides[k], TIGHT);
    CHECK_NEAR(m.oriented_dimensions[k], descending[k], TIGHT);
    CHECK_NEAR(m.oriented_center[k], low[k] + sides[k] / 2, TIGHT);
    CHECK_NEAR(m.principal_moments[k], moments[k], TIGHT);
  }
  for (size_t t = 0; t < mesh.triangle_count; t++) shape_flip(&mesh, t);
  scree_measures turned = measures_of(&mesh);
  assert_true(turned.inward && turned.closed);
  CHECK_NEAR(turned.volume, -6, TIGHT);
  CHECK_NEAR(turned.inertia[0][0], m.inertia[0][0], TIGHT);
  CHECK_NEAR(turned.centroid[2], m.centroid[2], TIGHT);
  CHECK_NEAR(turned.convexity, 1, TIGHT);
  scree_mesh_free(&mesh);
}

/* Coordinates that hold the body exactly lose nothing by lying far away. */
static void test_far_away(void **state) {
  (void)state;
  for (double far = 1; far < 1e12; far *= 64) {
    scree_mesh mesh = shape_grid_box(1, 2, 0.5, 4);
    shape_move(&mesh, (vec3){far, -2 * far, 3 * far});
    scree_measures m = measures_of(&mesh);
    solid s = box_solid(1, 2, 0.5);
    s.centroid = vec3_add(s.centroid, (vec3){far, -2 * far, 3 * far});
    check_solid(&m, &s, 2 + 2e-4 * far, TIGHT);
    CHECK_NEAR(m.oriented_dimensions[0], 2, TIGHT);
    CHECK_NEAR(m.convexity, 1, TIGHT);
    scree_mesh_free(&mesh);
  }
}

static void test_scales(void **state) {
  (void)state;
  scree_mesh unit = shape_icosphere(1, 3);
  scree_measures m = measures_of(&unit);
  for (double scale = 1e-24; scale < 1e26; scale *= 1e12) {
    scree_mesh mesh = shape_icosphere(scale, 3);
    scree_measures scaled = measures_of(&mesh);
    CHECK_NEAR(scaled.area / scale / scale, m.area, m.area * TIGHT);
    CHECK_NEAR(scaled.volume / scale / scale / scale, m.volume, m.volume * TIGHT);
    CHECK_NEAR(scaled.convexity, 1, TIGHT);
    CHECK_NEAR(scaled.sphericity, m.sphericity, TIGHT);
    CHECK_NEAR(scaled.oriented_dimensions[0] / scale, m.oriented_dimensions[0], 1e-6);
    scree_mesh_free(&mesh);
  }
  scree_mesh_free(&unit);
}

/* The ellipsoid's closed forms, which the icosphere approaches as h^2. */
static void test_ellipsoid(void **state) {
  (void)state;
  double worst[2];
  for (int level = 4; level <= 5; level++) {
    scree_mesh mesh = shape_icosphere(1, level);
    const mat3 stretch = {{{3, 0, 0}, {0, 2, 0}, {0, 0, 1}}};
    shape_transform(&mesh, &stretch, (vec3){0, 0, 0});
    scree_measures m = measures_of(&mesh);
    double v = 4 * PI / 3 * 6, moment = v / 5 * (2 * 2 + 1 * 1);
    worst[level - 4] = fmax(fabs(m.volume / v - 1), fabs(m.principal_moments[0] / moment - 1));
    scree_mesh_free(&mesh);
  }
  assert_true(worst[1] < 3e-3);
  CHECK_NEAR(worst[0] / worst[1], 4, 0.1);
}

static void test_sums(void **state) {
  (void)state;
  scree_rng rng = {.seed = 4};
  scree_mesh mesh = shape_icosphere(1, 6);
  shape_shake(&mesh, 0.002, &rng);
  solid s = long_double_solid(&mesh);
  long double area = 0;
  for (size_t t = 0; t < mesh.triangle_count; t++)
    area += vec3_norm(vec3_triangle_normal(scree_mesh_corner(&mesh, t, 0),
                                           scree_mesh_corner(&mesh, t, 1),
                                           scree_mesh_corner(&mesh, t, 2))) /
            2;
  scree_measures m = measures_of(&mesh);
  check_solid(&m, &s, 2, 1e-13);
  CHECK_NEAR(m.area, (double)area, 1e-14 * (double)area);
  double quick_area, quick_volume;
  scree_error error;
  CHECK_OK(scree_mesh_area_volume(&mesh, &quick_area, &quick_volume, &error), error);
  assert_true(quick_area == m.area && quick_volume == m.volume);
  scree_mesh_free(&mesh);
}

/* A box of 49,152 facets; before and behind them in the list, one 16,384 times as wide, outward and
 * inward. All terms are whole multiples of 9/2^28 m^3, of up to 59 bits, so that the compensated
 * sum is the box's volume exactly. Plain sums are wrong by 3 % of it in the blocks, by 1.6e-5 over
 * them. */
static void test_cancelling_sums(void **state) {
  (void)state;
  const double side = 0.375, wide = 6144;
  const vec3 corner = {96 + 15 / 512.0, -384 + 21 / 512.0, 768 + 27 / 512.0};
  scree_mesh out = shape_box(wide, wide, wide), in = shape_box(wide, wide, wide);
  scree_mesh small = shape_grid_box(side, side, side, 64);
  shape_move(&out, (vec3){-wide / 2, -wide / 2, -wide / 2});
  shape_move(&in, (vec3){-wide / 2, -wide / 2, -wide / 2});
  for (size_t t = 0; t < in.triangle_count; t++) shape_flip(&in, t);
  shape_move(&small, corner);
  scree_mesh two = shape_join(&out, &small), all = shape_join(&two, &in);
  scree_measures m = measures_of(&all);
  CHECK_NEAR(m.volume, side * side * side, TIGHT * side * side * side);
  double quick_area, quick_volume;
  scree_error error;
  CHECK_OK(scree_mesh_area_volume(&all, &quick_area, &quick_volume, &error), error);
  assert_true(quick_volume == m.volume);
  const double centre[3] = {corner.x + side / 2, corner.y + side / 2, corner.z + side / 2};
  for (int i = 0; i < 3; i++) CHECK_NEAR(m.centroid[i], centre[i], 1e-9 * wide);
  scree_mesh_free(&out), scree_mesh_free(&in), scree_mesh_free(&small);
  scree_mesh_free(&two), scree_mesh_free(&all);
}

static void test_threads(void **state) {
  (void)state;
  scree_rng rng = {.seed = 5};
  scree_mesh mesh = shape_icosphere(1, 6);
  shape_shake(&mesh, 0.01, &rng);
  scree_set_threads(1);
  scree_measures one = measures_of(&mesh);
  for (int threads = 2; threads <= 5; threads++) {
    scree_set_threads(threads);
    scree_measures more = measures_of(&mesh);
    assert_memory_equal(&one, &more, offsetof(scree_measures, convexity));
  }
  scree_set_threads(0);
  scree_mesh_free(&mesh);
}

/* ---- Closedness ---- */

static void test_cycles(void **state) {
  (void)state;
  scree_rng rng = {.seed = 6};
  scree_error error;
  size_t cycles = 0;
  for (int i = 0; i < 4000; i++) {
    scree_mesh mesh = i % 2 ? shape_random_tangle(&rng) : shape_tetrahedron(1, 1, 1);
    for (size_t t = 0; i % 2 == 0 && t < 4; t++)
      if (scree_rng_below(&rng, 5) == 0) shape_flip(&mesh, t);
    scree_adjacency adjacency;
    CHECK_OK(scree_adjacency_build(&mesh, &adjacency, &error), error);
    bool expected = true;
    for (size_t e = 0; e < adjacency.edge_count; e++) {
      uint32_t first = adjacency.edges[e], h = first;
      int balance = 0;
      do {
        balance += scree_half_edge_from(&mesh, h) < scree_half_edge_to(&mesh, h) ? 1 : -1;
        h = adjacency.ring[h];
      } while (h != first);
      if (balance) expected = false;
    }
    cycles += expected;
    assert_int_equal(scree_mesh_is_cycle(&mesh), expected);
    scree_adjacency_free(&adjacency);
    scree_mesh_free(&mesh);
  }
  assert_in_range(cycles, 500, 3500);
}

/* ---- Flat, open, bad ---- */

static void test_flat_sheet(void **state) {
  (void)state;
  scree_rng rng = {.seed = 7};
  for (int i = 0; i < 50; i++) {
    scree_mesh mesh = shape_sheet(0.25, 3);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    const mat3 stretch = {{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    shape_transform(&mesh, &stretch, (vec3){0, 0, 0});
    if (i) shape_transform(&mesh, &turn, (vec3){0, 0, 0});
    scree_measures m = measures_of(&mesh);
    assert_false(m.closed || m.has_volume || m.inward);
    CHECK_NEAR(m.area, 2, TIGHT);
    CHECK_NEAR(m.volume, 0, TIGHT);
    CHECK_NEAR(m.oriented_dimensions[0], 2, 1e-9);
    CHECK_NEAR(m.oriented_dimensions[1], 1, 1e-9);
    CHECK_NEAR(m.oriented_dimensions[2], 0, 1e-9);
    CHECK_NEAR(m.convexity, 0, 0);
    scree_mesh_free(&mesh);
  }
}

static void test_bad_meshes(void **state) {
  (void)state;
  scree_error error;
  scree_measures m = {.area = 77};
  scree_mesh empty = {0};
  assert_int_equal(scree_mesh_measure(&empty, &m, &error), SCREE_BAD_MESH);
  assert_string_equal(error.message, "the mesh has no triangles");
  scree_mesh mesh = shape_box(1, 1, 1);
  mesh.positions[4] = NAN;
  assert_int_equal(scree_mesh_measure(&mesh, &m, NULL), SCREE_BAD_MESH);
  assert_int_equal(scree_mesh_area_volume(&mesh, NULL, NULL, NULL), SCREE_BAD_MESH);
  CHECK_NEAR(m.area, 77, 0);
  scree_mesh_free(&mesh);
  /* all corners in one point, and on one line */
  for (int line = 0; line < 2; line++) {
    mesh = shape_box(line, 0, 0);
    m = measures_of(&mesh);
    CHECK_NEAR(m.oriented_dimensions[0], line, TIGHT);
    CHECK_NEAR(m.area, 0, 0);
    CHECK_NEAR(m.sphericity, 0, 0);
    assert_false(m.has_volume);
    scree_mesh_free(&mesh);
  }
}

/* ---- Hull and oriented box ---- */

static void test_convexity(void **state) {
  (void)state;
  /* a torus: V = 2 pi^2 R r^2; its hull adds two discs and the inner half is gone */
  scree_mesh torus = shape_torus(2, 0.5, 400, 200);
  scree_measures m = measures_of(&torus);
  double r = 0.5, big = 2;
  double hull = 2 * r * PI * big * big + PI * PI * r * r * big + 4 * PI / 3 * r * r * r;
  CHECK_NEAR(m.volume, 2 * PI * PI * big * r * r, 1e-3 * m.volume);
  CHECK_NEAR(m.hull_volume, hull, 1e-3 * hull);
  CHECK_NEAR(m.convexity, m.volume / m.hull_volume, TIGHT);
  scree_mesh_free(&torus);
  /* flat faces full of coplanar vertices */
  scree_rng rng = {.seed = 8};
  for (int i = 0; i < 20; i++) {
    scree_mesh box = shape_grid_box(1, 2, 3, 20);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    shape_transform(&box, &turn, (vec3){1, 2, 3});
    m = measures_of(&box);
    CHECK_NEAR(m.convexity, 1, TIGHT);
    CHECK_NEAR(m.oriented_dimensions[0], 3, 3 * TIGHT);
    CHECK_NEAR(m.oriented_dimensions[1], 2, 3 * TIGHT);
    CHECK_NEAR(m.oriented_dimensions[2], 1, 3 * TIGHT);
    scree_mesh_free(&box);
  }
}

/* The least box of a regular tetrahedron is a cube with no face flush (O'Rourke 1985). */
static void test_tetrahedron_box(void **state) {
  (void)state;
  scree_rng rng = {.seed = 9};
  for (int i = 0; i < 50; i++) {
    scree_mesh mesh = shape_tetrahedron(1, 1, 1);
    const double corners[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
    memcpy(mesh.positions, corners, sizeof corners);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    shape_transform(&mesh, &turn, (vec3){0, 0, 0});
    scree_measures m = measures_of(&mesh);
    for (int k = 0; k < 3; k++) CHECK_NEAR(m.oriented_dimensions[k], 2, 1e-9);
    scree_mesh_free(&mesh);
  }
}

/* Random points: against a fine search over rotations, the fit may be a few per cent larger. It
 * holds all points and is never larger than the axis-aligned box. */
static double box_volume(const vec3 *points, size_t count, const mat3 *axes) {
  vec3 low = {INFINITY, INFINITY, INFINITY}, high = vec3_neg(low);
  for (size_t i = 0; i < count; i++) {
    vec3 p = mat3_mul_vec(axes, points[i]);
    low = vec3_min(low, p);
    high = vec3_max(high, p);
  }
  return (high.x - low.x) * (high.y - low.y) * (high.z - low.z);
}

static double searched_volume(const vec3 *points, size_t count, scree_rng *rng) {
  double least = INFINITY;
  mat3 best = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int i = 0; i < 4000; i++) {
    mat3 axes = quat_to_mat3(scree_rng_rotation(rng));
    double volume = box_volume(points, count, &axes);
    if (volume < least) least = volume, best = axes;
  }
  for (double step = 0.1; step > 1e-4; step *= 0.99) {
    vec3 r = vec3_scale(scree_rng_direction(rng), step);
    mat3 turn = quat_to_mat3(quat_from_rotation_vector(r)), axes = mat3_mul(&best, &turn);
    double volume = box_volume(points, count, &axes);
    if (volume < least) least = volume, best = axes;
  }
  return least;
}

/* The least of the boxes that keep an axis of the fitted one and have a side along the line through
 * two points: over all pairs, of which those on the outline are some. */
static double turned_volume(const vec3 *points, size_t count, const mat3 *box) {
  double least = INFINITY;
  for (int axis = 0; axis < 3; axis++)
    for (size_t i = 0; i < count; i++)
      for (size_t j = 0; j < i; j++) {
        vec3 w = vec3_load(box->m[axis]), d = vec3_sub(points[i], points[j]);
        vec3 u = vec3_unit(vec3_mad(d, w, -vec3_dot(d, w)));
        mat3 axes;
        vec3_store(axes.m[0], u);
        vec3_store(axes.m[1], vec3_cross(w, u));
        vec3_store(axes.m[2], w);
        least = fmin(least, box_volume(points, count, &axes));
      }
  return least;
}

static void test_oriented_box(void **state) {
  (void)state;
  scree_rng rng = {.seed = 10};
  const mat3 one = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double worst = 0;
  for (int i = 0; i < 100; i++) {
    size_t count = 4 + scree_rng_below(&rng, 60);
    vec3 points[64];
    mat3 map = random_map(&rng);
    for (size_t k = 0; k < count; k++)
      points[k] = mat3_mul_vec(
          &map, (vec3){scree_rng_normal(&rng), scree_rng_normal(&rng), scree_rng_normal(&rng)});
    scree_hull hull;
    scree_minimum_box box;
    scree_error error;
    CHECK_OK(scree_hull_build(points, count, &hull, &error), error);
    CHECK_OK(scree_minimum_box_fit(&hull, &one, &box, &error), error);
    double volume = box.size.x * box.size.y * box.size.z;
    CHECK_NEAR(volume, box_volume(points, count, &box.axes), TIGHT * volume);
    for (size_t k = 0; k < count; k++) {
      vec3 p = mat3_mul_vec(&box.axes, vec3_sub(points[k], box.center));
      assert_true(fabs(p.x) <= box.size.x * 0.5000001 && fabs(p.y) <= box.size.y * 0.5000001 &&
                  fabs(p.z) <= box.size.z * 0.5000001);
    }
    assert_true(volume <= box_volume(points, count, &one) * (1 + TIGHT));
    assert_true(volume <= turned_volume(points, count, &box.axes) * (1 + 1e-6));
    worst = fmax(worst, volume / searched_volume(points, count, &rng));
    scree_hull_free(&hull);
  }
  print_message("worst oriented box / searched one: %.4f\n", worst);
  assert_true(worst < 1.05);
}

/* Every point lies behind every face, and every face turns outward. */
/* Two rings of very many corners, each in a plane to rounding, and one alone, which is flat; then
 * scattered points by both ways of many and of few. */
static void test_large_hulls(void **state) {
  enum { RING = 30000, BALL = 6000 };
  static vec3 points[2 * RING + 2];
  const mat3 turn = quat_to_mat3(quat_from_rotation_vector((vec3){0.3, -0.8, 0.5}));
  scree_rng rng = {.seed = 12};
  scree_error error = {0};
  scree_hull hull;
  (void)state;
  for (int i = 0; i < 2 * RING; i++) {
    double angle = 2 * PI * (i / 2) / RING;
    points[i] = mat3_mul_vec(&turn, (vec3){cos(angle), sin(angle), i % 2});
  }
  points[2 * RING] = (vec3){0, 0, 0};
  points[2 * RING + 1] = mat3_mul_vec(&turn, (vec3){0, 0, 1});
  CHECK_OK(scree_hull_build(points, 2 * RING + 2, &hull, &error), error);
  CHECK_NEAR(hull.volume, PI, 1e-7);
  CHECK_NEAR(hull.area, 4 * PI, 1e-6);
  scree_hull_free(&hull);
  for (int i = 0; i < RING; i++) points[i] = points[2 * i];
  CHECK_OK(scree_hull_build(points, RING, &hull, &error), error);
  assert_int_equal(hull.triangle_count, 0);
  assert_int_equal(hull.point_count, RING);
  scree_hull_free(&hull);
  for (int i = 0; i < BALL; i++) points[i] = scree_rng_direction(&rng);
  vec3 centre = {0, 0, 0};
  CHECK_OK(scree_hull_build(points, BALL / 2, &hull, &error), error);
  double volume = hull.volume, area = hull.area;
  scree_hull_free(&hull);
  for (int i = BALL / 2; i < BALL; i++) points[i] = vec3_lerp(centre, points[i - BALL / 2], 0.5);
  CHECK_OK(scree_hull_build(points, BALL, &hull, &error), error);
  CHECK_NEAR(hull.volume, volume, TIGHT);
  CHECK_NEAR(hull.area, area, TIGHT);
  scree_hull_free(&hull);
}

static void test_hull(void **state) {
  (void)state;
  scree_rng rng = {.seed = 11};
  for (int i = 0; i < 300; i++) {
    size_t count = 4 + scree_rng_below(&rng, 60);
    vec3 points[64];
    bool grid = i % 2;
    for (size_t k = 0; k < count; k++)
      points[k] = grid ? (vec3){(double)scree_rng_below(&rng, 3), (double)scree_rng_below(&rng, 3),
                                (double)scree_rng_below(&rng, 3)}
                       : scree_rng_direction(&rng);
    scree_hull hull;
    scree_error error;
    CHECK_OK(scree_hull_build(points, count, &hull, &error), error);
    for (size_t t = 0; t < hull.triangle_count; t++) {
      const uint32_t *c = hull.triangles + 3 * t;
      vec3 normal = vec3_triangle_normal(hull.points[c[0]], hull.points[c[1]], hull.points[c[2]]);
      for (size_t k = 0; k < count; k++)
        assert_true(vec3_dot(normal, vec3_sub(points[k], hull.points[c[0]])) < 1e-12);
    }
    scree_hull_free(&hull);
  }
}

static void test_eigen(void **state) {
  (void)state;
  scree_rng rng = {.seed = 12};
  for (int i = 0; i < 3000; i++) {
    double expected[3], values[3];
    for (int k = 0; k < 3; k++)
      expected[k] =
          i % 3 && k ? expected[0] * (1 + (i % 3 - 1) * 1e-9 * k) : scree_rng_normal(&rng);
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng)), diagonal = {{{0}}}, axes;
    for (int k = 0; k < 3; k++) diagonal.m[k][k] = expected[k];
    mat3 transposed = mat3_transpose(&turn), half = mat3_mul(&turn, &diagonal),
         matrix = mat3_mul(&half, &transposed);
    scree_eigen_symmetric(&matrix, values, &axes);
    double scale = fmax(fabs(values[0]), fabs(values[2])), trace = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
      vec3 axis = vec3_load(axes.m[k]), image = mat3_mul_vec(&matrix, axis);
      CHECK_NEAR(vec3_norm(vec3_mad(image, axis, -values[k])), 0, 4e-15 * scale);
      trace += expected[k], sum += values[k];
    }
    CHECK_NEAR(sum, trace, 1e-14 * scale);
    assert_true(values[0] <= values[1] && values[1] <= values[2]);
    CHECK_NEAR(determinant(&axes), 1, 1e-14);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_affine_solids),
      cmocka_unit_test(test_box),
      cmocka_unit_test(test_far_away),
      cmocka_unit_test(test_scales),
      cmocka_unit_test(test_ellipsoid),
      cmocka_unit_test(test_sums),
      cmocka_unit_test(test_cancelling_sums),
      cmocka_unit_test(test_threads),
      cmocka_unit_test(test_cycles),
      cmocka_unit_test(test_flat_sheet),
      cmocka_unit_test(test_bad_meshes),
      cmocka_unit_test(test_convexity),
      cmocka_unit_test(test_tetrahedron_box),
      cmocka_unit_test(test_oriented_box),
      cmocka_unit_test(test_hull),
      cmocka_unit_test(test_large_hulls),
      cmocka_unit_test(test_eigen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
