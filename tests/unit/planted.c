/* Every kind of defect that check counts and repair mends, planted in a clean body: repair gives
 * back the clean body's measures; and neither the order of the facets nor a turn, a move far from
 * the origin or another unit changes what is found, what is done and what comes out. */
#include "base/rng.h"
#include "base/vec.h"
#include "mesh/mesh.h"
#include "support/check.h"
#include "support/shapes.h"

/* Coordinates are multiples of this, so that moves and turns by right angles are exact. */
#define GRID 0x1p-20

typedef struct planted {
  const char *name;
  scree_mesh mesh;
  scree_defect defect; /* there must be some */
  double area, volume; /* of the clean body */
  double tolerance;    /* relative, of these */
  bool exactly; /* what is found follows from vertices that lie in a plane or on an edge exactly:
                   rounding changes it */
} planted;

enum { MOST = 32 };

typedef struct list {
  planted items[MOST];
  int count;
} list;

static scree_measures measures_of(const scree_mesh *mesh) {
  scree_measures m;
  scree_error error;
  CHECK_OK(scree_mesh_measure(mesh, &m, &error), error);
  return m;
}

static void snap(scree_mesh *mesh) {
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    mesh->positions[i] = rint(mesh->positions[i] / GRID) * GRID;
}

/* A rough body of 320 facets without symmetry. */
static scree_mesh body(void) {
  scree_mesh mesh = shape_icosphere(1, 2);
  scree_rng rng = {.seed = 71};
  shape_shake(&mesh, 0.01, &rng);
  snap(&mesh);
  return mesh;
}

/* Takes the mesh over. */
static void add(list *l, const char *name, scree_mesh mesh, scree_defect defect, double area,
                double volume, double tolerance, bool exactly) {
  assert_true(l->count < MOST);
  l->items[l->count++] = (planted){name, mesh, defect, area, volume, tolerance, exactly};
}

/* Both in one mesh, welded; frees them. */
static scree_mesh join(scree_mesh a, scree_mesh b) {
  scree_mesh both = shape_join(&a, &b), welded = shape_weld(&both, NULL);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
  scree_mesh_free(&both);
  return welded;
}

static scree_mesh moved(scree_mesh mesh, double x, double y, double z) {
  shape_move(&mesh, (vec3){x, y, z});
  return mesh;
}

static scree_mesh turned(scree_mesh mesh) {
  for (size_t t = 0; t < mesh.triangle_count; t++) shape_flip(&mesh, t);
  return mesh;
}

/* The mesh with one vertex and some facets more; frees it. extra: three vertices a facet, of which
 * the new one is mesh.vertex_count. */
static scree_mesh extended(scree_mesh mesh, vec3 vertex, const uint32_t *extra, size_t count) {
  scree_mesh more = shape_make(mesh.vertex_count + 1, mesh.triangle_count + count);
  memcpy(more.positions, mesh.positions, 24 * mesh.vertex_count);
  vec3_store(more.positions + 3 * mesh.vertex_count, vertex);
  memcpy(more.triangles, mesh.triangles, 12 * mesh.triangle_count);
  memcpy(more.triangles + 3 * mesh.triangle_count, extra, 12 * count);
  scree_mesh_free(&mesh);
  return more;
}

static vec3 at(const scree_mesh *mesh, uint32_t v) {
  return vec3_load(mesh->positions + 3 * (size_t)v);
}

/* ---- One by one ---- */

static void plant_facets(list *l) {
  scree_mesh mesh = body();
  scree_measures clean = measures_of(&mesh);
  uint32_t n = (uint32_t)mesh.vertex_count, c[3];
  memcpy(c, mesh.triangles + 3 * 40, sizeof c);
  vec3 middle = vec3_lerp(at(&mesh, c[0]), at(&mesh, c[1]), 0.5);
  add(l, "a vertex of no facet", extended(mesh, middle, c, 0), SCREE_DEFECT_UNUSED_VERTEX,
      clean.area, clean.volume, 1e-12, false);
  add(l, "a coordinate that is no number",
      extended(body(), (vec3){0, NAN, 0}, (const uint32_t[]){c[0], c[1], n}, 1),
      SCREE_DEFECT_BAD_COORDINATE, clean.area, clean.volume, 1e-12, false);
  add(l, "a doubled facet", extended(body(), middle, c, 1), SCREE_DEFECT_DUPLICATE_FACET,
      clean.area, clean.volume, 1e-12, false);
  add(l, "a doubled facet, turned",
      extended(body(), middle, (const uint32_t[]){c[1], c[0], c[2]}, 1),
      SCREE_DEFECT_DUPLICATE_FACET, clean.area, clean.volume, 1e-12, false);
  /* the facet in two, and one without area between it and the facet behind the edge */
  mesh = extended(body(), middle, (const uint32_t[]){n, c[1], c[2], c[0], c[1], n}, 2);
  mesh.triangles[3 * 40 + 1] = n;
  add(l, "a facet without area", mesh, SCREE_DEFECT_DEGENERATE_FACET, clean.area, clean.volume,
      1e-9, true);
  mesh = extended(body(), middle, (const uint32_t[]){n, c[1], c[2]}, 1);
  mesh.triangles[3 * 40 + 1] = n;
  add(l, "a T-junction", mesh, SCREE_DEFECT_BOUNDARY_EDGE, clean.area, clean.volume, 1e-9, true);
  mesh = body();
  for (size_t t = 0; t < mesh.triangle_count; t += 7) shape_flip(&mesh, t);
  add(l, "facets turned", mesh, SCREE_DEFECT_INCONSISTENT_EDGE, clean.area, clean.volume, 1e-12,
      false);
  add(l, "inside out", turned(body()), SCREE_DEFECT_INSIDE_OUT_SHELL, clean.area, clean.volume,
      1e-12, false);
  mesh = extended(body(), vec3_scale(at(&mesh, c[2]), 1.5), (const uint32_t[]){c[0], c[1], n}, 1);
  add(l, "a fin", mesh, SCREE_DEFECT_NON_MANIFOLD_EDGE, clean.area, clean.volume, 1e-12, false);
  mesh = body();
  mesh.triangle_count -= 1;
  add(l, "a facet missing", mesh, SCREE_DEFECT_HOLE, clean.area, clean.volume, 1e-12, false);
  mesh = shape_icosphere(1, 3);
  snap(&mesh);
  clean = measures_of(&mesh);
  double *p = mesh.positions + 3 * 20; /* pulled through the far side */
  vec3_store(p, vec3_scale(vec3_load(p), -1.375));
  add(l, "a spike through the far side", mesh, SCREE_DEFECT_CROSSING_PAIR, clean.area, clean.volume,
      0.1, false);
}

static void plant_seams(list *l) {
  scree_mesh mesh = body(), loose = shape_make(3 * mesh.triangle_count, mesh.triangle_count);
  scree_measures clean = measures_of(&mesh);
  for (size_t i = 0; i < 3 * mesh.triangle_count; i++) {
    memcpy(loose.positions + 3 * i, mesh.positions + 3 * (size_t)mesh.triangles[i], 24);
    loose.triangles[i] = (uint32_t)i;
  }
  add(l, "loose facets", loose, SCREE_DEFECT_BOUNDARY_EDGE, clean.area, clean.volume, 1e-12, true);
  scree_mesh open = shape_make(3 * mesh.triangle_count, mesh.triangle_count);
  memcpy(open.positions, loose.positions, 72 * mesh.triangle_count);
  memcpy(open.triangles, loose.triangles, 12 * mesh.triangle_count);
  for (size_t t = 0; t < mesh.triangle_count; t++) /* the upper part a little off */
    if (open.positions[9 * t + 2] + open.positions[9 * t + 5] + open.positions[9 * t + 8] > 0.5)
      for (size_t k = 0; k < 3; k++) open.positions[9 * t + 3 * k] += 32 * GRID;
  add(l, "a seam", shape_weld(&open, NULL), SCREE_DEFECT_BOUNDARY_EDGE, clean.area, clean.volume,
      1e-3, true);
  scree_mesh_free(&open);
  scree_mesh_free(&mesh);
  mesh = shape_grid_box(1, 1, 1, 4);
  size_t kept = 0; /* a square of eight facets within a face: they fill flat */
  for (size_t t = 0; t < mesh.triangle_count; t++) {
    bool gone = true;
    for (int k = 0; k < 3; k++) {
      vec3 q = scree_mesh_corner(&mesh, t, k);
      gone &= q.z == 1 && q.x >= 0.25 && q.x <= 0.75 && q.y >= 0.25 && q.y <= 0.75;
    }
    if (!gone) memmove(mesh.triangles + 3 * kept++, mesh.triangles + 3 * t, 12);
  }
  assert_int_equal(mesh.triangle_count - kept, 8);
  mesh.triangle_count = kept;
  add(l, "a window in a face", mesh, SCREE_DEFECT_HOLE, 6, 1, 1e-9, false);
}

static void plant_shells(list *l) {
  scree_mesh one = body();
  scree_measures clean = measures_of(&one);
  add(l, "debris", join(one, moved(shape_box(0.125, 0.125, 0.125), 2, 1, 1)),
      SCREE_DEFECT_EXTRA_BODY, clean.area, clean.volume, 1e-12, false);
  add(l, "a shell within", join(body(), moved(shape_box(0.5, 0.5, 0.5), -0.25, -0.25, -0.25)),
      SCREE_DEFECT_NESTED_SHELL, clean.area, clean.volume, 1e-12, false);
  add(l, "a cavity, all inside out",
      turned(join(body(), turned(moved(shape_box(0.5, 0.5, 0.5), -0.25, -0.25, -0.25)))),
      SCREE_DEFECT_INSIDE_OUT_SHELL, clean.area + 1.5, clean.volume - 0.125, 1e-12, false);
  add(l, "boxes that cross", join(shape_box(1, 1, 1), moved(shape_box(1, 1, 1), 0.5, 0.25, 0.125)),
      SCREE_DEFECT_CROSSING_PAIR, 12 - 2 * (0.5 * 0.75 + 0.75 * 0.875 + 0.875 * 0.5),
      2 - 0.5 * 0.75 * 0.875, 1e-6, false);
  add(l, "boxes face on face", join(shape_box(1, 1, 1), moved(shape_box(1, 1, 1), 1, 0.25, 0.125)),
      SCREE_DEFECT_OVERLAPPING_PAIR, 12 - 2 * 0.75 * 0.875, 2, 1e-6, true);
  add(l, "a box's corner on a face",
      join(shape_box(1, 1, 1), moved(shape_tetrahedron(1, 1, 1), 1, 0.25, 0.25)),
      SCREE_DEFECT_TOUCHING_PAIR, 0, 1 + 1.0 / 6, 1e-3, true);
  add(l, "boxes sharing an edge", join(shape_box(1, 1, 1), moved(shape_box(1, 1, 1), 1, 1, 0)),
      SCREE_DEFECT_NON_MANIFOLD_EDGE, 12, 2, 1e-3, true);
  add(l, "boxes sharing a corner", join(shape_box(1, 1, 1), moved(shape_box(1, 1, 1), 1, 1, 1)),
      SCREE_DEFECT_NON_MANIFOLD_VERTEX, 12, 2, 1e-3, true);
  scree_mesh room = moved(shape_box(1, 1, 1), 1, 0, 0); /* less the wall at x = 1 */
  size_t kept = 0;
  for (size_t t = 0; t < room.triangle_count; t++) {
    bool wall = true;
    for (int k = 0; k < 3; k++) wall &= scree_mesh_corner(&room, t, k).x == 1;
    if (!wall) memmove(room.triangles + 3 * kept++, room.triangles + 3 * t, 12);
  }
  room.triangle_count = kept;
  add(l, "boxes with one wall between", join(shape_box(1, 1, 1), room),
      SCREE_DEFECT_NON_MANIFOLD_EDGE, 10, 2, 1e-9, false);
}

static list plant_all(void) {
  list l = {.count = 0};
  plant_facets(&l);
  plant_seams(&l);
  plant_shells(&l);
  return l;
}

static void free_all(list *l) {
  for (int i = 0; i < l->count; i++) scree_mesh_free(&l->items[i].mesh);
}

/* ---- What must not change ---- */

typedef struct outcome {
  scree_check check;
  scree_repair_report report;
  scree_measures measures; /* of the repaired mesh */
} outcome;

static outcome work(const scree_mesh *mesh, const char *name) {
  outcome o;
  scree_mesh repaired;
  scree_error error;
  CHECK_OK(scree_mesh_check(mesh, NULL, NULL, &o.check, &error), error);
  if (scree_mesh_repair(mesh, NULL, NULL, &repaired, &o.report, &error) != SCREE_OK)
    fail_msg("%s: %s", name, error.message);
  assert_true(o.report.after.usable);
  o.measures = measures_of(&repaired);
  scree_mesh_free(&repaired);
  return o;
}

/* An area of 0 is not known. */
static void expect_clean(const planted *p, const scree_measures *m, double scale,
                         double tolerance) {
  double area = p->area * scale * scale, volume = p->volume * pow(scale, 3);
  if (p->area > 0 && !(fabs(m->area - area) <= tolerance * area))
    fail_msg("%s: area %.17g, expected %.17g", p->name, m->area, area);
  if (!(fabs(m->volume - volume) <= tolerance * volume))
    fail_msg("%s: volume %.17g, expected %.17g", p->name, m->volume, volume);
}

static void expect_found(const planted *p, const outcome *a, const outcome *b) {
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++)
    if (a->check.defects[i] != b->check.defects[i])
      fail_msg("%s: %zu %s, then %zu", p->name, a->check.defects[i],
               scree_defect_name((scree_defect)i), b->check.defects[i]);
  assert_int_equal(a->check.shell_count, b->check.shell_count);
  assert_int_equal(a->check.volume_known, b->check.volume_known);
}

static void expect_done(const planted *p, const outcome *a, const outcome *b) {
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++)
    if (a->report.done[i] != b->report.done[i] &&
        /* of a facet and its reverse the first in canonical order stays, and may have to be turned
         */
        !(i == SCREE_REPAIR_TURN && p->defect == SCREE_DEFECT_DUPLICATE_FACET))
      fail_msg("%s: %zu %s, then %zu", p->name, a->report.done[i],
               scree_repair_action_name((scree_repair_action)i), b->report.done[i]);
}

static scree_mesh transformed(const scree_mesh *mesh, mat3 matrix, double scale, vec3 offset) {
  scree_mesh copy;
  scree_error error;
  for (int i = 0; i < 9; i++) matrix.m[i / 3][i % 3] *= scale;
  CHECK_OK(scree_mesh_copy(mesh, &copy, &error), error);
  shape_transform(&copy, &matrix, offset);
  return copy;
}

static const mat3 as_is = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

static void clean_again(void **state) {
  (void)state;
  list l = plant_all();
  bool seen[SCREE_DEFECT_COUNT] = {false};
  for (int i = 0; i < l.count; i++) {
    outcome o = work(&l.items[i].mesh, l.items[i].name);
    if (!o.check.defects[l.items[i].defect]) fail_msg("%s: not found", l.items[i].name);
    expect_clean(&l.items[i], &o.measures, 1, l.items[i].tolerance);
    for (int k = 0; k < SCREE_DEFECT_COUNT; k++) seen[k] |= o.check.defects[k] > 0;
  }
  for (int k = 0; k < SCREE_DEFECT_COUNT; k++)
    if (!seen[k] && k != SCREE_DEFECT_CAVITY && /* no defect: kept */
        k != SCREE_DEFECT_SHARP_EDGE)           /* tests/unit/repair.c */
      fail_msg("no %s were planted", scree_defect_name((scree_defect)k));
  free_all(&l);
}

/* Another order, a right angle, 2^20 of its own size away, another unit: no digit is lost. */
static void no_digit_lost(void **state) {
  (void)state;
  const mat3 right[] = {as_is,
                        {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}},
                        {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}},
                        {{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}}};
  scree_rng rng = {.seed = 72};
  list l = plant_all();
  for (int i = 0; i < l.count; i++) {
    planted *p = &l.items[i];
    outcome first = work(&p->mesh, p->name);
    for (int n = 0; n < 8; n++) {
      double scale = ldexp(1, n % 3 == 0 ? 0 : n % 3 == 1 ? -10 : 10);
      vec3 far =
          n < 4 ? (vec3){0, 0, 0} : (vec3){-0x1p20 * scale, 0x1p19 * scale, 3 * 0x1p18 * scale};
      scree_mesh other = transformed(&p->mesh, right[n % 4], scale, far);
      for (size_t t = other.triangle_count; t > 1; t--) { /* another order */
        size_t u = scree_rng_below(&rng, (uint32_t)t);
        uint32_t keep[3];
        memcpy(keep, other.triangles + 3 * u, 12);
        memcpy(other.triangles + 3 * u, other.triangles + 3 * (t - 1), 12);
        memcpy(other.triangles + 3 * (t - 1), keep, 12);
      }
      outcome o = work(&other, p->name);
      expect_found(p, &first, &o);
      if (n < 4) expect_done(p, &first, &o);
      /* parts taken apart draw back by up to 1 % of their edges there */
      double tolerance = n < 4 ? 0 : p->tolerance < 1e-3 ? 1e-6 : 0.03;
      expect_clean(p, &o.measures, scale, fmax(p->tolerance, tolerance));
      scree_mesh_free(&other);
    }
  }
  free_all(&l);
}

/* Any turn, any unit, a hundred of its own size away: coordinates are rounded. */
static void rounded(void **state) {
  (void)state;
  scree_rng rng = {.seed = 73};
  list l = plant_all();
  for (int i = 0; i < l.count; i++) {
    planted *p = &l.items[i];
    outcome first = work(&p->mesh, p->name);
    for (int n = 0; n < 4; n++) {
      double scale = pow(10, -3 * (n % 2));
      vec3 far = vec3_scale(scree_rng_direction(&rng), 100 * scale * (n / 2));
      scree_mesh other = transformed(&p->mesh, quat_to_mat3(scree_rng_rotation(&rng)), scale, far);
      outcome o = work(&other, p->name);
      if (!p->exactly) {
        expect_found(p, &first, &o);
        expect_done(p, &first, &o);
      }
      /* faces on each other may have come apart by a rounding: two bodies */
      if (p->defect == SCREE_DEFECT_OVERLAPPING_PAIR) p->area = 0;
      expect_clean(p, &o.measures, scale, fmax(p->tolerance, 1e-9));
      scree_mesh_free(&other);
    }
  }
  free_all(&l);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(clean_again), cmocka_unit_test(no_digit_lost),
                                     cmocka_unit_test(rounded)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
