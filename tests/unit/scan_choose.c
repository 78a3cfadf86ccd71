/* The folder of real scans from file to choice, as `scree measure` and `scree choose` go: measure,
 * prepare, decimate, choose, with the outcome that each must have. What can be chosen from is
 * looked at: the chosen levels and some others are closed, manifold and wound outward, have the
 * area and volume that the record says, keep the volume, and have no fold, no degenerate facet and
 * no self-intersection that the prepared scan did not have. What cannot is refused in one sentence
 * with the reasons. */
#include "base/alloc.h"
#include "base/vec.h"
#include "mesh/index/intersect.h"
#include "support/check.h"

typedef struct expectation {
  const char *file;
  const char *sentence; /* NULL: a choice is made; else a part of what is said instead */
} expectation;

static const expectation files[] = {
    {"gen01_ascii_upper_tabs_scinot.stl", NULL},
    {"gen02_ascii_crlf_three_solids.stl", NULL},
    {"gen03_bin_header_solid_facet_normal.stl", NULL},
    {"gen04_bin_truncated_mid_facet.stl", "binary STL cut off"},
    {"gen05_bin_count_too_small.stl", NULL},
    {"gen06_bin_nan_inf.stl", "coordinates must be finite"},
    {"gen07_bin_far_from_origin.stl", NULL},
    {"gen08_bin_flips_dups_degenerates.stl", NULL},
    {"gen09_bin_tjunctions.stl", NULL},
    {"gen10_bin_zero_triangles.stl", "binary STL with no facets"},
    {"gen11_bin_colour_viscam.stl", NULL},
    {"gen12_bin_colour_materialise.stl", NULL},
    {"gen13_bin_cavity_debris_overlap.stl", NULL},
    {"imu_adis16480.stl", NULL},
    {"penkesu_screen_case.stl", NULL},
    {"rock_complexshape.stl", NULL},
    {"ugly_3dsmax.stl", NULL},
    {"ugly_angle_block.stl", NULL},
    {"ugly_busted_zero_normals.stl", NULL},
    {"ugly_featuretype.stl", NULL},
    {"ugly_halfdonut_solid_plus1byte.stl", NULL},
    {"ugly_multibody_ascii.stl", NULL},
    {"ugly_soup.stl", "300 boundary edges, 100 holes, 1248 crossing pairs"},
    {"ugly_spider_ascii.stl", NULL},
    {"scan_birdbath_sfm.ply", "a repair would change the volume by 13 %"},
    {"stone_073ac.ply", NULL},
    {"stone_0_320.ply", NULL},
    {"stone_E22.ply", NULL},
    {"ugly_cycloidal.ply", "24367 crossing pairs"},
    {"asteroid_phobos_seam.obj", NULL},
    {"rock_chrono4.obj", NULL},
    {"ycb_power_drill.obj", NULL},
};

/* Above 50,000 triangles that a choice is made of: only where asked for (the slow test). */
static const expectation large_files[] = {
    {"scan_bunny_holes.stl", NULL},   {"scan_hammer_raw.obj", NULL},
    {"scan_nefertiti_70k.obj", NULL}, {"organic_scorpion_100k.obj", NULL},
    {"scan_turbineblade.ply", NULL},  {"weee_cam1.ply", NULL},
    {"weee_flip2.ply", NULL},         {"weee_slab2.ply", NULL},
};

/* Edges over which normals lie more than 150 degrees apart, facets without area, and pairs that
 * meet (counted to a limit only). */
typedef struct faults {
  size_t folds, degenerate, meetings;
} faults;

typedef struct side {
  uint32_t low, high, triangle;
} side;

static int compare_sides(const void *x, const void *y) {
  const side *a = x, *b = y;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  return a->high < b->high ? -1 : a->high > b->high;
}

static vec3 area_vector(const scree_mesh *mesh, size_t t) {
  const uint32_t *c = mesh->triangles + 3 * t;
  return vec3_triangle_normal(vec3_load(mesh->positions + 3 * (size_t)c[0]),
                              vec3_load(mesh->positions + 3 * (size_t)c[1]),
                              vec3_load(mesh->positions + 3 * (size_t)c[2]));
}

static size_t count_folds(const scree_mesh *mesh) {
  size_t count = 3 * mesh->triangle_count, folds = 0;
  side *sides = malloc(count * sizeof *sides);
  for (size_t h = 0; h < count; h++) {
    uint32_t u = mesh->triangles[h], v = mesh->triangles[h % 3 == 2 ? h - 2 : h + 1];
    sides[h] = (side){u < v ? u : v, u < v ? v : u, (uint32_t)(h / 3)};
  }
  qsort(sides, count, sizeof *sides, compare_sides);
  for (size_t i = 0; i + 1 < count; i++) {
    if (compare_sides(&sides[i], &sides[i + 1]) != 0) continue;
    vec3 n = area_vector(mesh, sides[i].triangle), m = area_vector(mesh, sides[i + 1].triangle);
    folds += vec3_dot(n, m) < -0.86602540378 * vec3_norm(n) * vec3_norm(m);
  }
  free(sides);
  return folds;
}

static faults find_faults(const scree_mesh *mesh) {
  scree_meetings met = {0};
  scree_topology topology;
  scree_error error;
  CHECK_OK(scree_mesh_topology(mesh, &topology, &error), error);
  CHECK_OK(scree_mesh_meetings(mesh, NULL, 1000, NULL, &met, &error), error);
  scree_free(met.items);
  return (faults){count_folds(mesh), topology.degenerate_facet_count, met.count};
}

static void check_level(const char *file, const scree_curve *curve, size_t index,
                        const scree_topology *scan, const faults *most) {
  scree_mesh mesh;
  scree_error error;
  scree_level level, first;
  scree_topology now;
  double area, volume;
  scree_curve_level(curve, index, &level);
  scree_curve_level(curve, 0, &first);
  CHECK_OK(scree_curve_mesh(curve, index, &mesh, &error), error);
  CHECK_OK(scree_mesh_topology(&mesh, &now, &error), error);
  CHECK_OK(scree_mesh_area_volume(&mesh, &area, &volume, &error), error);
  faults found = find_faults(&mesh);
  if (mesh.triangle_count != level.triangle_count || !now.closed || !now.manifold ||
      !now.oriented || now.shell_count != scan->shell_count || now.genus != scan->genus ||
      now.inward_shell_count != scan->inward_shell_count)
    fail_msg("%s: %zu triangles: no longer what it was", file, level.triangle_count);
  if (found.folds > most->folds || found.degenerate > most->degenerate ||
      found.meetings > most->meetings)
    fail_msg(
        "%s: %zu triangles: %zu folds, %zu degenerate facets, %zu meetings; scan %zu, %zu, %zu",
        file, level.triangle_count, found.folds, found.degenerate, found.meetings, most->folds,
        most->degenerate, most->meetings);
  CHECK_NEAR(area, level.area, 1e-9 * area);
  CHECK_NEAR(volume, level.volume, 1e-9 * fabs(volume));
  CHECK_NEAR(level.volume, first.volume, 1e-10 * fabs(first.volume));
  scree_mesh_free(&mesh);
}

/* Levels of the choice, and Rp 1e-1 to the floor. */
static void check_curve(const char *file, const scree_mesh *mesh, const scree_curve *curve,
                        const scree_choice *choice) {
  scree_topology scan;
  scree_error error;
  CHECK_OK(scree_mesh_topology(mesh, &scan, &error), error);
  assert_true(scan.closed && scan.manifold && scan.oriented);
  faults most = find_faults(mesh);
  assert_int_equal(choice->triangle_count, mesh->triangle_count);
  assert_true(choice->robust.ip > 0 && choice->robust.ip < 1 && choice->paper.ip < 1);
  check_level(file, curve, choice->robust.level_index, &scan, &most);
  check_level(file, curve, choice->paper.level_index, &scan, &most);
  for (size_t count = mesh->triangle_count / 10; count > 3; count /= 10)
    check_level(file, curve, scree_curve_find(curve, count), &scan, &most);
  check_level(file, curve, scree_curve_level_count(curve) - 1, &scan, &most);
}

/* From the file to the choice: on failure error says why. */
static scree_status go(const char *file, const char *path, scree_error *error) {
  scree_scan scan = {0};
  scree_mesh mesh = {0};
  scree_curve *curve = NULL;
  scree_choice choice = {0};
  scree_measures measures;
  scree_repair_options repair = scree_default_repair_options();
  scree_simplify_options simplify = scree_default_simplify_options();
  scree_status status = scree_scan_read(path, NULL, &scan, error);
  if (status != SCREE_OK) return status;
  CHECK_OK(scree_mesh_measure(&scan.mesh, &measures, error), *error);
  assert_true(measures.area > 0 && isfinite(measures.volume));
  status = scree_mesh_prepare(&scan.mesh, &repair, NULL, &mesh, NULL, error);
  if (status == SCREE_OK) {
    CHECK_OK(scree_curve_build(&mesh, &simplify, NULL, &curve, error), *error);
    CHECK_OK(scree_choose(curve, &mesh, NULL, NULL, &choice, error), *error);
    check_curve(file, &mesh, curve, &choice);
    scree_choice_free(&choice);
    scree_curve_free(curve);
    scree_mesh_free(&mesh);
  }
  scree_scan_free(&scan);
  return status;
}

static void check_files(const expectation *expected, size_t count) {
  if (!scan_data_folder()) {
    skip();
    return; /* for the compiler: skip does not come back */
  }
  size_t read = 0;
  for (size_t i = 0; i < count; i++) {
    const expectation *e = &expected[i];
    char path[1000];
    scree_error error = {0};
    if (!scan_data_path(e->file, path, sizeof path)) continue;
    read++;
    scree_status status = go(e->file, path, &error);
    if (!e->sentence && status == SCREE_OK) continue;
    if (!e->sentence) fail_msg("%s: '%s', expected a choice", e->file, error.message);
    if ((status != SCREE_BAD_FILE && status != SCREE_BAD_MESH) ||
        !strstr(error.message, e->sentence) || strchr(error.message, '\n'))
      fail_msg("%s: %d '%s', expected '%s'", e->file, status, error.message, e->sentence);
  }
  if (read == 0) fail_msg("none of the scans is in %s", SCREE_SCAN_DATA);
}

static void every_file_to_its_outcome(void **state) {
  (void)state;
  check_files(files, sizeof files / sizeof *files);
}

static void every_large_file_to_its_outcome(void **state) {
  (void)state;
  check_files(large_files, sizeof large_files / sizeof *large_files);
}

/* With the argument `large`, the large files; without, the others. */
int main(int count, char **arguments) {
  const struct CMUnitTest small[] = {cmocka_unit_test(every_file_to_its_outcome)};
  const struct CMUnitTest large[] = {cmocka_unit_test(every_large_file_to_its_outcome)};
  if (count > 1 && strcmp(arguments[1], "large") == 0)
    return cmocka_run_group_tests(large, NULL, NULL);
  return cmocka_run_group_tests(small, NULL, NULL);
}
