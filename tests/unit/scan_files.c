/* The folder of real scans: what reading each file must give. Triangles and degenerate facets of an
 * exact weld, or a part of the sentence of refusal. */
#include "scree.h"
#include "support/check.h"

typedef struct expectation {
  const char *file, *format; /* or the sentence */
  size_t triangle_count, vertex_count, degenerate_count, solid_count;
} expectation;

static const expectation files[] = {
    {"gen01_ascii_upper_tabs_scinot.stl", "STL ASCII", 320, 162, 0, 1},
    {"gen02_ascii_crlf_three_solids.stl", "STL ASCII", 24, 16, 0, 3},
    {"gen03_bin_header_solid_facet_normal.stl", "STL binary", 1280, 642, 0, 1},
    {"gen04_bin_truncated_mid_facet.stl",
     "binary STL cut off: bytes 80 to 83 say 1280 facets, which take 64084 bytes, but the file has "
     "45107 bytes, room for 900 facets",
     0, 0, 0, 0},
    {"gen05_bin_count_too_small.stl", "STL binary", 1280, 642, 0, 1},
    {"gen06_bin_nan_inf.stl",
     "facet 11 of 1280, corner 2 (byte 608) lies at (nan, 8.39418, 5.18789); coordinates must be "
     "finite and at most 1e+30 m in size",
     0, 0, 0, 0},
    {"gen07_bin_far_from_origin.stl", "STL binary", 1280, 642, 0, 1},
    {"gen08_bin_flips_dups_degenerates.stl", "STL binary", 1360, 657, 15, 1},
    {"gen09_bin_tjunctions.stl", "STL binary", 138, 85, 0, 1},
    {"gen10_bin_zero_triangles.stl", "binary STL with no facets: bytes 80 to 83 say 0", 0, 0, 0, 0},
    {"gen11_bin_colour_viscam.stl", "STL binary", 1280, 642, 0, 1},
    {"gen12_bin_colour_materialise.stl", "STL binary", 1280, 642, 0, 1},
    {"gen13_bin_cavity_debris_overlap.stl", "STL binary", 2160, 1110, 0, 1},
    {"imu_adis16480.stl", "STL ASCII", 7436, 3672, 0, 1},
    {"penkesu_screen_case.stl", "STL binary", 1994, 999, 0, 1},
    {"rock_complexshape.stl", "STL binary", 24236, 12113, 0, 1},
    {"scan_bunny_holes.stl", "STL binary", 69451, 34834, 0, 1},
    {"ugly_3dsmax.stl", "STL binary", 2000, 1042, 0, 1},
    {"ugly_angle_block.stl", "STL binary", 704, 398, 0, 1},
    {"ugly_busted_zero_normals.stl", "STL binary", 3878, 1941, 0, 1},
    {"ugly_featuretype.stl", "STL binary", 3476, 2010, 0, 1},
    {"ugly_halfdonut_solid_plus1byte.stl", "STL binary", 288, 144, 0, 1},
    {"ugly_multibody_ascii.stl", "STL ASCII", 32, 20, 0, 2},
    {"ugly_soup.stl", "STL binary", 100, 300, 0, 1},
    {"ugly_spider_ascii.stl", "STL ASCII", 1312, 722, 56, 1},
    {"scan_birdbath_sfm.ply", "PLY binary little endian", 35073, 18793, 6, 1},
    {"scan_turbineblade.ply", "PLY binary little endian", 199034, 99519, 0, 1},
    {"stone_073ac.ply", "PLY binary little endian", 26978, 13491, 0, 1},
    {"stone_0_320.ply", "PLY binary little endian", 320, 162, 0, 1},
    {"stone_E22.ply", "PLY binary little endian", 12530, 6267, 0, 1},
    {"ugly_cycloidal.ply", "PLY binary little endian", 43368, 21384, 0, 1},
    {"weee_cam1.ply", "PLY binary little endian", 571982, 285991, 0, 1},
    {"weee_flip2.ply", "PLY binary little endian", 404440, 202220, 0, 1},
    {"weee_slab2.ply", "PLY binary little endian", 469892, 234948, 0, 1},
    {"asteroid_phobos_seam.obj", "OBJ", 32040, 16380, 0, 1},
    {"organic_scorpion_100k.obj", "OBJ", 99990, 49997, 0, 1},
    {"rock_chrono4.obj", "OBJ", 1510, 757, 0, 1},
    {"scan_hammer_raw.obj", "OBJ", 60160, 30082, 0, 1},
    {"scan_nefertiti_70k.obj", "OBJ", 70000, 35002, 0, 1},
    {"ycb_power_drill.obj", "OBJ", 15728, 7866, 0, 1},

};

static void every_file(void **state) {
  (void)state;
  if (!scan_data_folder()) {
    skip();
    return; /* for the compiler: skip does not come back */
  }
  size_t read = 0;
  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    const expectation *e = &files[i];
    char path[1000];
    if (!scan_data_path(e->file, path, sizeof path)) continue;
    read++;
    scree_scan scan = {0};
    scree_error error = {0};
    scree_status status = scree_scan_read(path, NULL, &scan, &error);
    if (e->triangle_count == 0) {
      if (status != SCREE_BAD_FILE || !strstr(error.message, e->format) ||
          strncmp(error.message, path, strlen(path)) != 0)
        fail_msg("%s: %d '%s', expected '%s'", e->file, status, error.message, e->format);
      continue;
    }
    if (status != SCREE_OK) fail_msg("%s", error.message);
    if (strcmp(scan.format, e->format) != 0 || scan.mesh.triangle_count != e->triangle_count ||
        scan.mesh.vertex_count != e->vertex_count || scan.degenerate_count != e->degenerate_count ||
        scan.solid_count != e->solid_count)
      fail_msg("%s: %s, %zu triangles, %zu vertices, %zu degenerate, %zu solids", e->file,
               scan.format, scan.mesh.triangle_count, scan.mesh.vertex_count, scan.degenerate_count,
               scan.solid_count);
    scree_scan_free(&scan);
  }
  if (read == 0) fail_msg("none of the scans is in %s", SCREE_SCAN_DATA);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_file)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
