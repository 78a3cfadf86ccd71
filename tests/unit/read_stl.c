/* STL: every trap of the format, and the sentences for what is no STL. */
#include "base/alloc.h"
#include "mesh/io/read.h"
#include "support/check.h"

typedef struct buffer {
  unsigned char bytes[300000];
  size_t count;
} buffer;

static buffer file;

static void put(const void *bytes, size_t count) {
  assert_true(file.count + count <= sizeof file.bytes);
  memcpy(file.bytes + file.count, bytes, count);
  file.count += count;
}
static void put_text(const char *text) {
  put(text, strlen(text));
}

static const float tetrahedron[4][9] = {{0, 0, 0, 0, 1, 0, 1, 0, 0},
                                        {0, 0, 0, 1, 0, 0, 0, 0, 1},
                                        {0, 0, 0, 0, 0, 1, 0, 1, 0},
                                        {1, 0, 0, 0, 1, 0, 0, 0, 1}};

/* A binary STL of a unit tetrahedron whose header begins with the text. */
static void make_binary(const char *header, uint32_t count) {
  unsigned char start[84] = {0};
  for (size_t i = 0; header[i]; i++) start[i] = (unsigned char)header[i];
  memcpy(start + 80, &count, 4);
  file.count = 0;
  put(start, sizeof start);
  for (int f = 0; f < 4; f++) {
    unsigned char facet[50] = {0};
    memcpy(facet + 12, tetrahedron[f], 36);
    facet[48] = 0x80;
    put(facet, sizeof facet);
  }
}

static scree_status parse(scree_scan *scan, scree_error *error) {
  return scree_scan_parse(file.bytes, file.count, "made.stl", NULL, scan, error);
}

static void expect_tetrahedron(const char *format) {
  scree_scan scan = {0};
  scree_error error;
  CHECK_OK(parse(&scan, &error), error);
  assert_string_equal(scan.format, format);
  assert_int_equal(scan.facet_count, 4);
  assert_int_equal(scan.mesh.triangle_count, 4);
  assert_int_equal(scan.mesh.vertex_count, 4);
  static const double expected[] = {0, 0, 0, 0, 0, 1e-3, 0, 1e-3, 0, 1e-3, 0, 0};
  assert_memory_equal(scan.mesh.positions, expected, sizeof expected);
  assert_int_equal(scan.byte_count, file.count);
  scree_scan_free(&scan);
}

static void expect_error(scree_status status, const char *part) {
  scree_scan scan = {0};
  scree_error error = {0};
  scree_status got = parse(&scan, &error);
  if (got != status || !strstr(error.message, part) ||
      strncmp(error.message, "made.stl: ", 10) != 0) {
    print_error("status %d, '%s'; expected %d with '%s'\n", got, error.message, status, part);
    fail();
  }
  assert_null(scan.mesh.positions);
}

static void binary(void **state) {
  (void)state;
  make_binary("", 4);
  expect_tetrahedron("STL binary");
  make_binary("solid", 4);
  expect_tetrahedron("STL binary");
  make_binary("solid potato\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", 4);
  expect_tetrahedron("STL binary");
  make_binary("COLOR=\xff\x80\x01\xff,MATERIAL=", 4);
  expect_tetrahedron("STL binary");
  make_binary("solid", 4);
  put("", 1);
  expect_tetrahedron("STL binary");
}

static void expect_warning(const char *part) {
  scree_scan scan = {0};
  scree_error error;
  CHECK_OK(parse(&scan, &error), error);
  if (!strstr(scan.warning, part)) fail_msg("the warning is '%s'", scan.warning);
  scree_scan_free(&scan);
}

/* Attributes behind each facet, as its word says: of one length or of several, few facets or more
 * than some bytes of padding. */
static void binary_with_attributes(void **state) {
  (void)state;
  static const unsigned lengths[][4] = {
      {4, 4, 4, 4}, {1, 0, 7, 300}, {50, 50, 50, 50}, {0, 0, 0, 3}};
  for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
    char filler[300], told[60];
    unsigned sum = 0;
    memset(filler, 'a', sizeof filler);
    make_binary("", 4);
    const buffer plain = file;
    file.count = 84;
    for (size_t f = 0; f < 4; f++) {
      unsigned char facet[50];
      memcpy(facet, plain.bytes + 84 + 50 * f, 50);
      facet[48] = (unsigned char)lengths[i][f], facet[49] = (unsigned char)(lengths[i][f] >> 8);
      put(facet, 50), put(filler, lengths[i][f]);
      sum += lengths[i][f];
    }
    expect_tetrahedron("STL binary");
    snprintf(told, sizeof told, "%u bytes of attributes behind the facets are passed over", sum);
    expect_warning(told);
  }
}

static void put_ascii(const char *end) {
  file.count = 0;
  put_text("solid a\n");
  for (int f = 0; f < 4; f++) {
    char text[300];
    const float *c = tetrahedron[f];
    int n = snprintf(text, sizeof text,
                     "facet normal 0 0 0\nouter loop\nvertex %g %g %g\nvertex %g %g %g\nvertex %g "
                     "%g %g\n%s loop\n%s facet\n",
                     (double)c[0], (double)c[1], (double)c[2], (double)c[3], (double)c[4],
                     (double)c[5], (double)c[6], (double)c[7], (double)c[8], end, end);
    for (char *gap; *end == 'e' && !strchr(end, ' ') && (gap = strstr(text, "end "));)
      memmove(gap + 3, gap + 4, strlen(gap + 4) + 1), n--;
    put(text, (size_t)n);
  }
}

/* `end solid` and its like; NUL bytes behind the last, which many writers of blocks leave. */
static void ascii_endings(void **state) {
  (void)state;
  static const char nuls[6000];
  put_ascii("end"), put_text("endsolid a\n");
  expect_tetrahedron("STL ASCII");
  put_ascii("end "), put_text("end solid a\n");
  expect_tetrahedron("STL ASCII");
  put_ascii("END "), put_text("End  Solid\n");
  expect_tetrahedron("STL ASCII");
  for (size_t count = 1; count <= sizeof nuls; count *= 5) {
    char told[60];
    put_ascii("end"), put_text("endsolid a\n"), put(nuls, count);
    expect_tetrahedron("STL ASCII");
    snprintf(told, sizeof told, "ASCII STL, followed by %zu NUL bytes", count);
    expect_warning(told);
  }
  put_ascii("end"), put(nuls, 100);
  expect_error(SCREE_BAD_FILE, "it is cut off");
  put_ascii("end"), put_text("end of it\n");
  expect_error(SCREE_BAD_FILE, "found 'end'");
}

static void others_by_name(void **state) {
  (void)state;
  static const char *const known[][2] = {{"ISO-10303-21;\nHEADER;\n", "a STEP file"},
                                         {"LASF\0\0\1\2", "a LAS file"},
                                         {"ASTM-E57", "an E57 file"},
                                         {"# .PCD v0.7\nVERSION .7\n", "a PCD file"},
                                         {"BLENDER-v300", "a Blender file"},
                                         {"#VRML V2.0 utf8\n", "a VRML file"},
                                         {"# vtk DataFile Version 3.0\n", "a VTK file"}};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
    char padding[200] = {0};
    file.count = 0;
    put_text(known[i][0]);
    if (i == 1 || i == 2 || i == 4) put(padding, sizeof padding);
    expect_error(SCREE_BAD_FILE, known[i][1]);
  }
}

static void turn_bytes(unsigned char *p) {
  for (int i = 0; i < 2; i++) {
    unsigned char keep = p[i];
    p[i] = p[3 - i], p[3 - i] = keep;
  }
}

/* Facets that fill the file exactly are read, whatever the count says, unless it says more. */
static void binary_miscounted(void **state) {
  (void)state;
  static const uint32_t counts[] = {0, 3, 0xffffffff};
  for (int i = 0; i < 3; i++) {
    make_binary("", counts[i]);
    expect_tetrahedron("STL binary");
    expect_warning("but 4 fill the file exactly");
  }
  make_binary("", 4);
  expect_warning("");
  for (size_t at = 80; at < file.count; at += at == 80 ? 4 : 50)
    for (size_t k = 0; k < (at == 80 ? 1 : 12); k++) turn_bytes(file.bytes + at + 4 * k);
  expect_tetrahedron("STL binary big endian");
  expect_warning("big-endian");
  float bad = NAN;
  memcpy(file.bytes + 84 + 12, &bad, 4);
  turn_bytes(file.bytes + 84 + 12);
  expect_error(SCREE_BAD_FILE, "corner 1 (byte 96) lies at (nan, 0, 0)");
}

static void binary_wrong(void **state) {
  (void)state;
  make_binary("solid", 5);
  expect_error(SCREE_BAD_FILE, "say 5 facets, which take 334 bytes, but the file has 284");
  make_binary("", 3);
  put("", 1);
  expect_error(SCREE_BAD_FILE, "wrong count");
  make_binary("", 0xfffffffe);
  expect_error(SCREE_BAD_FILE, "4294967294 facets");
  make_binary("", 0);
  file.count = 84;
  expect_error(SCREE_BAD_FILE, "no facets");
  make_binary("", 4);
  float bad = NAN;
  memcpy(file.bytes + 84 + 50 + 12 + 12 + 8, &bad, 4);
  expect_error(SCREE_BAD_FILE, "facet 2 of 4, corner 2 (byte 158) lies at (1, 0, nan)");
  file.count = 60;
  expect_error(SCREE_BAD_FILE, "too short: 60 bytes");
  make_binary("", 4);
  for (int f = 0; f < 4; f++) memset(file.bytes + 84 + 50 * f, 0, 50);
  expect_error(SCREE_BAD_MESH, "all 4 facets are degenerate");
}

/* The tetrahedron as text: the keywords and separators given. */
static void put_solid(const char *const words[7], const char *space, const char *line,
                      const char *numbers[2]) {
  for (int f = 0; f < 4; f++) {
    put_text(words[0]), put_text(space), put_text(words[1]);
    for (int i = 0; i < 3; i++) put_text(space), put_text("-nan(ind)");
    put_text(line), put_text(words[2]), put_text(space), put_text(words[3]), put_text(line);
    for (int k = 0; k < 9; k++) {
      if (k % 3 == 0) put_text(words[4]);
      put_text(space), put_text(numbers[tetrahedron[f][k] != 0]);
      if (k % 3 == 2) put_text(line);
    }
    put_text(words[5]), put_text(line), put_text(words[6]), put_text(line);
  }
}

static const char *const lower[7] = {"facet",  "normal",  "outer",   "loop",
                                     "vertex", "endloop", "endfacet"};
static const char *const upper[7] = {"FACET",  "Normal",  "OUTER",   "LOOP",
                                     "VERTEX", "ENDLOOP", "EndFacet"};

static void ascii(void **state) {
  (void)state;
  const char *lines[] = {"\n", "\r\n", "\r", " \n\n\t", " "};
  const char *spellings[][2] = {
      {"0", "1"}, {"0.0E+00", "+1.000E+00"}, {"-0", "10e-1"}, {".0", "1."}, {"0d0", "0.1D+01"}};
  for (int l = 0; l < 5; l++)
    for (int n = 0; n < 5; n++) {
      file.count = 0;
      if (n % 2) put("\xef\xbb\xbf", 3);
      put_text(l % 2 ? "SOLID a name with spaces" : "solid"), put_text(l == 4 ? "\n" : lines[l]);
      put_solid(n % 2 ? upper : lower, l % 2 ? "\t  " : " ", lines[l], spellings[n]);
      put_text("endsolid another name"), put_text(l % 2 ? "" : lines[l]);
      expect_tetrahedron("STL ASCII");
    }
  const char *numbers[] = {"0", "1"};
  file.count = 0; /* all on one line */
  put_text("solid a b facet c "), put_solid(lower, " ", " ", numbers);
  /* the normal is no number here, so the name would swallow the facet */
  expect_error(SCREE_BAD_FILE, "cut off");
  file.count = 0;
  put_text("solid facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop "
           "endfacet endsolid");
  scree_scan scan;
  scree_error error;
  CHECK_OK(parse(&scan, &error), error);
  assert_int_equal(scan.facet_count, 1);
  scree_scan_free(&scan);
}

static void ascii_several_solids_and_a_long_name(void **state) {
  (void)state;
  const char *numbers[] = {"0", "1"};
  file.count = 0;
  put_text("solid ");
  memset(file.bytes + file.count, 'x', 200000);
  file.count += 200000;
  put_text("\nendsolid\nsolid two\n"), put_solid(lower, " ", "\n", numbers);
  put_text("endsolid two\n");
  expect_tetrahedron("STL ASCII");
}

static void ascii_wrong(void **state) {
  (void)state;
  const char *numbers[] = {"0", "1"}, *wrong[] = {"0", "1e999"}, *words[] = {"0", "nan"},
             *comma[] = {"0", "1,5"};
  file.count = 0, put_text("solid\n"), put_solid(lower, " ", "\n", wrong);
  expect_error(SCREE_BAD_FILE, "line 5: y is '1e999'");
  file.count = 0, put_text("solid\r\n"), put_solid(lower, " ", "\r\n", words);
  expect_error(SCREE_BAD_FILE, "line 5: y is 'nan'");
  file.count = 0, put_text("solid\r"), put_solid(lower, " ", "\r", comma);
  expect_error(SCREE_BAD_FILE, "line 5: y is '1,5'");
  file.count = 0, put_text("solid\n"), put_solid(lower, " ", "\n", numbers);
  expect_error(SCREE_BAD_FILE, "line 30: the file ends after 4 facets without `endsolid`");
  file.count -= 40;
  expect_error(SCREE_BAD_FILE, "cut off");
  file.count = 0, put_text("solid empty\nendsolid empty\n");
  expect_error(SCREE_BAD_FILE, "no facets");
  file.count = 0, put_text("solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2\nvertex");
  expect_error(SCREE_BAD_FILE, "line 5: z is 'vertex'");
  file.count = 0, put_text("solid\nendsolid\nrubbish\n");
  expect_error(SCREE_BAD_FILE, "line 3: behind `endsolid` there is 'rubbish' (first byte 0x72)");
  file.count = 0, put_text("solid\n");
  for (int i = 0; i < 10; i++) put_solid(lower, " ", "\n", numbers);
  put_text("endsolid\n\x1a");
  expect_error(SCREE_BAD_FILE, "line 283: behind `endsolid` there is '?' (first byte 0x1a)");
}

/* ---- files, which are welded as they are read ---- */

enum { MANY = 5 * 1024 }; /* facets: more than a piece holds */

/* A strip of triangles, at one corner of which something else may stand. */
static void make_strip(size_t odd, float coordinate) {
  make_binary("a strip", MANY);
  file.count = 84;
  for (size_t f = 0; f < MANY; f++) {
    unsigned char facet[50] = {0};
    float x = (float)(f / 2), y = f % 2 ? 1 : 0,
          corners[9] = {x, 0, 0, x + 1, y, 0, x + (1 - y), 1, 0.01f * x};
    if (f == odd) corners[4] = coordinate;
    memcpy(facet + 12, corners, sizeof corners);
    put(facet, sizeof facet);
  }
}

/* From the disk everything is as from memory. */
static void expect_the_same_from_disk(void) {
  static const char path[] = "made.stl";
  scree_scan parsed = {0}, read = {0};
  scree_error error, read_error;
  FILE *stream = fopen(path, "wb");
  assert_true(stream && fwrite(file.bytes, 1, file.count, stream) == file.count);
  fclose(stream);
  scree_status status = parse(&parsed, &error);
  assert_int_equal(scree_scan_read(path, NULL, &read, &read_error), status);
  remove(path);
  if (status != SCREE_OK) {
    assert_string_equal(error.message, read_error.message);
    assert_null(read.mesh.positions);
    return;
  }
  assert_string_equal(read.format, parsed.format);
  assert_int_equal(read.facet_count, parsed.facet_count);
  assert_int_equal(read.solid_count, parsed.solid_count);
  assert_int_equal(read.degenerate_count, parsed.degenerate_count);
  assert_int_equal(read.byte_count, parsed.byte_count);
  assert_int_equal(read.ignored_byte_count, parsed.ignored_byte_count);
  assert_memory_equal(&read.checksum, &parsed.checksum, sizeof read.checksum);
  assert_int_equal(read.mesh.vertex_count, parsed.mesh.vertex_count);
  assert_int_equal(read.mesh.triangle_count, parsed.mesh.triangle_count);
  assert_memory_equal(read.mesh.positions, parsed.mesh.positions,
                      3 * parsed.mesh.vertex_count * sizeof(double));
  assert_memory_equal(read.mesh.triangles, parsed.mesh.triangles,
                      3 * parsed.mesh.triangle_count * sizeof(uint32_t));
  scree_scan_free(&parsed);
  scree_scan_free(&read);
}

static void from_disk(void **state) {
  (void)state;
  make_strip(MANY, 0);
  expect_the_same_from_disk();
  put("xyz", 3); /* padding: not as long as the count says */
  expect_the_same_from_disk();
  make_strip(MANY - 1, NAN);
  expect_the_same_from_disk();
  make_strip(4096, 1e30f);
  expect_the_same_from_disk();
  make_strip(MANY, 0);
  file.count -= 7;
  expect_the_same_from_disk();
  make_binary("ply", 4); /* a PLY by its first word, whatever its length */
  expect_the_same_from_disk();
  make_binary("\xef\xbb\xbfply\n", 4);
  expect_the_same_from_disk();
  make_binary("solid", 4);
  expect_the_same_from_disk();
  make_binary("flat", 4);
  memset(file.bytes + 84, 0, 200);
  expect_the_same_from_disk();
  file.count = 84;
  memset(file.bytes + 80, 0, 4);
  expect_the_same_from_disk();
  file.count = 0;
  expect_the_same_from_disk();
}

static void no_mesh_at_all(void **state) {
  (void)state;
  file.count = 0;
  expect_error(SCREE_BAD_FILE, "empty");
  put_text("\n <!DOCTYPE HTML><html>");
  expect_error(SCREE_BAD_FILE, "HTML");
  file.count = 0, put("\x1f\x8b\x08\x00\x00", 5);
  expect_error(SCREE_BAD_FILE, "gzip");
  file.count = 0, put_text("dear reader\n");
  expect_error(SCREE_BAD_FILE, "'dear'");
  file.count = 0, put_text(" \n");
  expect_error(SCREE_BAD_FILE, "white space");
  scree_scan scan;
  scree_error error;
  assert_int_equal(scree_scan_read("/nonexistent/file.stl", NULL, &scan, &error), SCREE_IO);
  scree_read_options options = scree_default_read_options();
  options.unit_m = 0;
  assert_int_equal(scree_scan_parse("", 0, "x", &options, &scan, &error), SCREE_BAD_ARGUMENT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(binary),
      cmocka_unit_test(binary_wrong),
      cmocka_unit_test(binary_miscounted),
      cmocka_unit_test(binary_with_attributes),
      cmocka_unit_test(ascii_endings),
      cmocka_unit_test(others_by_name),
      cmocka_unit_test(ascii),
      cmocka_unit_test(ascii_several_solids_and_a_long_name),
      cmocka_unit_test(ascii_wrong),
      cmocka_unit_test(no_mesh_at_all),
      cmocka_unit_test(from_disk),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
