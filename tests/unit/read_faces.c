/* PLY, OBJ and OFF: every spelling of one cube, and the sentences for broken ones. */
#include "base/alloc.h"
#include "base/rng.h"
#include "mesh/io/polygon.h"
#include "mesh/io/read.h"
#include "support/alloc_fail.h"
#include "support/check.h"

static char file[20000];
static size_t file_size;

static void begin(const char *text) {
  file_size = strlen(text);
  memcpy(file, text, file_size);
}
static void put(const void *bytes, size_t count) {
  assert_true(file_size + count <= sizeof file);
  memcpy(file + file_size, bytes, count);
  file_size += count;
}
static void put_text(const char *text) {
  put(text, strlen(text));
}

static const int cube_vertices[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                        {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int cube_faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};

static double volume_of(const scree_mesh *mesh) {
  double volume = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const double *a = mesh->positions + 3 * (size_t)mesh->triangles[3 * t],
                 *b = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + 1],
                 *c = mesh->positions + 3 * (size_t)mesh->triangles[3 * t + 2];
    volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0])) /
              6;
  }
  return volume;
}

static void expect_cube(const char *format) {
  scree_scan scan = {0};
  scree_error error;
  CHECK_OK(scree_scan_parse(file, file_size, "made", NULL, &scan, &error), error);
  assert_string_equal(scan.format, format);
  assert_true(scan.unit_m == 1e-3);
  assert_int_equal(scan.mesh.vertex_count, 8);
  assert_int_equal(scan.mesh.triangle_count, 12);
  assert_int_equal(scan.facet_count, 12 + scan.degenerate_count);
  CHECK_NEAR(volume_of(&scan.mesh), 1e-9, 1e-24);
  scree_scan_free(&scan);
}

static void expect_error(const char *part) {
  scree_scan scan = {0};
  scree_error error = {0};
  scree_status status = scree_scan_parse(file, file_size, "made", NULL, &scan, &error);
  if (status == SCREE_OK || !strstr(error.message, part) ||
      strncmp(error.message, "made: ", 6) != 0) {
    print_error("%d: '%s'; expected '%s'\n", status, error.message, part);
    fail();
  }
  assert_null(scan.mesh.positions);
}

/* ---- PLY ---- */

/* A value of a PLY type in the byte order wanted, or as text. */
static void put_value(double value, const char *type, char order) {
  if (order == 'a') {
    char text[40];
    snprintf(text, sizeof text, "%.17g ", value);
    put_text(text);
    return;
  }
  unsigned char bytes[8];
  size_t size = 0;
#define PUT_AS(name, ctype)                                                                        \
  if (!strcmp(type, name)) {                                                                       \
    ctype typed = (ctype)value;                                                                    \
    memcpy(bytes, &typed, size = sizeof typed);                                                    \
  }
  PUT_AS("char", int8_t)
  PUT_AS("uint8", uint8_t)
  PUT_AS("short", int16_t)
  PUT_AS("uint16", uint16_t)
  PUT_AS("int", int32_t)
  PUT_AS("uint", uint32_t)
  PUT_AS("float", float)
  PUT_AS("float64", double)
#undef PUT_AS
  assert_true(size > 0);
  for (size_t i = 0; i < size / 2 && order == 'b'; i++) {
    unsigned char swapped = bytes[i];
    bytes[i] = bytes[size - 1 - i];
    bytes[size - 1 - i] = swapped;
  }
  put(bytes, size);
}

/* A cube as PLY: types, byte order, line end; faces first if asked, strips instead of faces if
 * asked. */
typedef struct ply_style {
  char order; /* a, l, b */
  const char *coordinate, *count, *index, *line_end;
  bool faces_first, strips;
} ply_style;

static void put_ply_vertices(const ply_style *s) {
  for (int v = 0; v < 8; v++) {
    put_value(7, "short", s->order);
    for (int i = 2; i >= 0; i--) put_value(cube_vertices[v][i], s->coordinate, s->order);
    put_value(3, "uint8", s->order);
    for (int i = 0; i < 3; i++) put_value(i, "float", s->order);
  }
}

static void put_ply_faces(const ply_style *s) {
  if (s->strips) { /* around the sides, and the lids */
    static const int strips[] = {4, 0, 5, 1, 6, 2, 7, 3, 4, 0, -1, 0, 3, 1, 2, -1, 4, 5, 7, 6};
    put_value(20, s->count, s->order);
    for (int i = 0; i < 20; i++) put_value(strips[i], s->index, s->order);
    return;
  }
  for (int f = 0; f < 6; f++) {
    put_value(0.5, "float64", s->order);
    put_value(4, s->count, s->order);
    for (int i = 0; i < 4; i++) put_value(cube_faces[f][i], s->index, s->order);
  }
}

static void make_ply(const ply_style *s) {
  char vertices[400], faces[300], header[1000];
  const char *e = s->line_end;
  snprintf(vertices, sizeof vertices,
           "element vertex 8%sproperty short tag%sproperty %s z%sproperty %s y%sproperty %s x%s"
           "property list uint8 float extra%s",
           e, e, s->coordinate, e, s->coordinate, e, s->coordinate, e, e);
  if (s->strips)
    snprintf(faces, sizeof faces, "element tristrips 1%sproperty list %s %s vertex_indices%s", e,
             s->count, s->index, e);
  else
    snprintf(faces, sizeof faces,
             "element face 6%sproperty float64 quality%sproperty list %s %s vertex_index%s", e, e,
             s->count, s->index, e);
  snprintf(header, sizeof header,
           "ply%sformat %s 1.0%scomment made by a test%sobj_info none%s%s%selement nothing 5%s"
           "end_header%s",
           e,
           s->order == 'a'   ? "ascii"
           : s->order == 'l' ? "binary_little_endian"
                             : "binary_big_endian",
           e, e, e, s->faces_first ? faces : vertices, s->faces_first ? vertices : faces, e, e);
  begin(header);
  if (s->faces_first) put_ply_faces(s);
  put_ply_vertices(s);
  if (!s->faces_first) put_ply_faces(s);
}

static const char *ply_format(char order) {
  return order == 'a'   ? "PLY ASCII"
         : order == 'l' ? "PLY binary little endian"
                        : "PLY binary big endian";
}

static void ply_in_every_style(void **state) {
  (void)state;
  static const char *const coordinates[] = {"float", "float64", "uint8", "char", "int"};
  static const char *const counts[] = {"uint8", "int", "short", "uint16"};
  static const char *const indices[] = {"int", "uint", "short", "uint8", "float64"};
  static const char *const line_ends[] = {"\n", "\r\n", "\r"};
  for (int style = 0; style < 1800; style++) {
    ply_style s = {"alb"[style % 3],
                   coordinates[style / 3 % 5],
                   counts[style / 15 % 4],
                   indices[style / 60 % 5],
                   line_ends[style / 300 % 3],
                   style >= 900,
                   style / 7 % 2};
    if (s.strips && s.index[0] == 'u') s.index = "char";
    make_ply(&s);
    expect_cube(ply_format(s.order));
  }
}

/* Cut anywhere, a file is refused. Only behind the last value of text it may still be whole. */
static void ply_cut_anywhere(void **state) {
  (void)state;
  for (int style = 0; style < 3; style++) {
    ply_style s = {"alb"[style], "float", "uint8", "int", "\n", false, false};
    make_ply(&s);
    size_t whole = file_size;
    for (file_size = 1; file_size + 2 < whole; file_size++) expect_error("");
  }
}

/* What fills a file up is too short for a triangle. */
static void ply_with_a_tail(void **state) {
  (void)state;
  for (int style = 1; style < 3; style++) {
    ply_style s = {"alb"[style], "float", "uint8", "int", "\n", false, false};
    make_ply(&s);
    size_t whole = file_size;
    for (int more = 0; more < 30; more++) {
      file_size = whole;
      for (int i = 0; i < more; i++) put_text(i % 2 ? "\1" : "\n");
      if (more < 13)
        expect_cube(ply_format(s.order));
      else
        expect_error("follow the rows that the header tells of");
    }
  }
}

/* Normals and qualities of nothing are written so; they mean nothing here. */
static void ply_with_ignored_nans(void **state) {
  (void)state;
  static const char *const values[] = {"nan",       "-nan",    "inf",   "-Infinity",
                                       "-nan(ind)", "1.#QNAN", "1e999", "0.5"};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    char line[100];
    begin("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float nx\n"
          "property float y\nproperty float z\nproperty list uchar float weights\n"
          "element face 6\nproperty list uchar int vertex_indices\nproperty float quality\n"
          "end_header\n");
    for (int v = 0; v < 8; v++) {
      snprintf(line, sizeof line, "%d %s %d %d 2 1 %s\n", cube_vertices[v][0], values[i],
               cube_vertices[v][1], cube_vertices[v][2], values[i]);
      put_text(line);
    }
    for (int f = 0; f < 6; f++) {
      snprintf(line, sizeof line, "4 %d %d %d %d %s\n", cube_faces[f][0], cube_faces[f][1],
               cube_faces[f][2], cube_faces[f][3], values[i]);
      put_text(line);
    }
    expect_cube("PLY ASCII");
  }
}

static void ply_broken(void **state) {
  (void)state;
  begin("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n");
  put_text(
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n");
  size_t header = file_size;
  put_text("0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  expect_error("line 13: face 1 of 1: 3 is not the number of a vertex");
  file_size = header, put_text("0 0 0\n1 0 0\n0 1 0\n3 0.5 1 2\n");
  expect_error("line 13: face 1 of 1: 0.5 is not the number of a vertex: there are 3, from 0 on");
  file_size = header, put_text("0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n\n3 0 2 1\n");
  expect_error("line 15: more follows the rows that the header tells of: a count is wrong");
  file_size = header, put_text("0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n");
  expect_error("line 11: a value should be a finite number, found 'nan'");
  file_size = header, put_text("0 0 0\n1 0 1e40\n0 1 0\n3 0 1 2\n");
  expect_error("line 11: vertex 2 of 3: a coordinate is 1e+40");
  file_size = header, put_text("0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n");
  expect_error("line 13: face 1 of 1: a list of -3 values");
  begin("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n");
  put_text("property float y\nproperty float z\nend_header\n0 0 0\n");
  expect_error("the file is cut off");
  begin("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n");
  expect_error("has no x, y and z");
  begin("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n0 0 0\n");
  expect_error("no facets (1 vertices)");
  begin("ply\nformat octal 1.0\n");
  expect_error("line 2: the format should be");
  begin("ply\nformat ascii 1.0\nelement face 4e9\nproperty list int long x\n");
  expect_error("line 4: a property's type");
  begin("ply\nelement vertex 0\nend_header\n");
  expect_error("names no format");
  begin("ply\nformat ascii 1.0\nend_header\n");
  expect_error("no element 'vertex'");
}

/* ---- OBJ ---- */

static void obj(void **state) {
  (void)state;
  static const char *const line_ends[] = {"\n", "\r\n", "\r", " # end\n", "\t\\\n\n"};
  for (int style = 0; style < 40; style++) {
    const char *end = line_ends[style % 5];
    char line[100];
    begin(style % 2 ? "\xef\xbb\xbf# a cube\nmtllib a b.mtl\no cube\n" : "\n\ng\n");
    for (int v = 0; v < 8; v++) {
      snprintf(line, sizeof line, "v  %d\t%d %d.0e0%s%s", cube_vertices[v][0], cube_vertices[v][1],
               cube_vertices[v][2], style / 5 % 2 ? " 1.0 0.5 0.5" : "",
               style % 5 == 4 ? "\n" : end);
      put_text(line);
    }
    put_text("vt 0 0\nvn 0 0 1\ns off\nusemtl what f 1 2 3\nl 1 2\n");
    for (int f = 0; f < 6; f++) {
      put_text("f");
      for (int i = 0; i < 4; i++) {
        int index = cube_faces[f][i] + (style / 10 % 2 ? -8 : 1);
        static const char *const behind[] = {"", "/1", "//1", "/1/1"};
        snprintf(line, sizeof line, " %d%s", index, behind[(style + f) % 4]);
        put_text(line);
        if (style % 5 == 4 && i == 1) put_text(" \\\n");
      }
      put_text(end);
      put_text("\n");
    }
    expect_cube("OBJ");
  }
  begin("f 1 2 3 4\nf 4 3 2 1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"); /* vertices behind */
  scree_scan scan = {0};
  scree_error error;
  CHECK_OK(scree_scan_parse(file, file_size, "made", NULL, &scan, &error), error);
  assert_int_equal(scan.facet_count, 4);
  scree_scan_free(&scan);
}

static void obj_broken(void **state) {
  (void)state;
  begin("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  expect_error("line 4: a face has vertex 4, but the file has 3");
  begin("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n");
  expect_error("line 4: corner '-4' of a face is no vertex; there are 3 so far");
  begin("v 0 0 0\nf 0 1 1\n");
  expect_error("line 2: corner '0'");
  begin("v 0 0 0\nf 1 1x 1\n");
  expect_error("line 2: corner '1x'");
  begin("v 0 0 0\nf 99999999999999999999 1 1\n");
  expect_error("line 2: corner '99999999999999999999'");
  begin("v 0 0 0\r\nf 1 1\r\n");
  expect_error("no facets");
  begin("v 0 0 0\nv 0 nan 0\n");
  expect_error("line 2: y is 'nan'");
  begin("v 0 0 0\nv 0 1");
  expect_error("line 2: a vertex with 2 coordinates; it needs 3");
  begin("v 0 0 0\nv 1 2\nv 3 4 5\n");
  expect_error("line 2: a vertex with 2 coordinates; it needs 3");
  begin("v 0 0 0\nv\t # 1 2 3\n");
  expect_error("line 2: a vertex with 0 coordinates; it needs 3");
  begin("v 0 0 0\nv\n");
  expect_error("line 2: a vertex with 0 coordinates; it needs 3");
  begin("v 0 0 0\nv 1 2 \\\nx\n");
  expect_error("line 3: z is 'x'");
  begin("v 0 0 0\n");
  expect_error("no facets");
}

/* Lines and points among the faces are counted and left out, alike in every format; a file of
 * nothing else has no facets. */
static void faces_of_two_corners(void **state) {
  (void)state;
  static const char *const heads[][2] = {
      {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
       "property float z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n0 1 0\n",
       "3 0 1 2\n2 0 1\n1 2\n"},
      {"OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n", "3 0 1 2\n2 0 1\n1 2\n"},
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\nf\nf 3\n"}};
  for (size_t i = 0; i < 3; i++) {
    scree_scan scan = {0};
    scree_error error;
    begin(heads[i][0]);
    put_text(heads[i][1]);
    CHECK_OK(scree_scan_parse(file, file_size, "made", NULL, &scan, &error), error);
    assert_int_equal(scan.mesh.triangle_count, 1);
    assert_int_equal(scan.facet_count, 3);
    assert_int_equal(scan.degenerate_count, 2);
    scree_scan_free(&scan);
    begin(heads[i][0]);
    put_text(i < 2 ? "2 0 1\n1 2\n0\n" : "f 1 2\nf 3\nf\n");
    expect_error("with no facets (3 vertices)");
  }
}

/* ---- OFF ---- */

/* A cube whose rows have so many values more than the header tells of. */
static void put_long_rows(int vertex_extra, int face_extra) {
  char line[60];
  begin("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
        "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n");
  for (int v = 0; v < 8; v++) {
    snprintf(line, sizeof line, "%d %d %d", cube_vertices[v][0], cube_vertices[v][1],
             cube_vertices[v][2]);
    put_text(line);
    for (int i = 0; i < vertex_extra; i++) put_text(" 1");
    put_text("\n");
  }
  for (int f = 0; f < 6; f++) {
    snprintf(line, sizeof line, "4 %d %d %d %d", cube_faces[f][0], cube_faces[f][1],
             cube_faces[f][2], cube_faces[f][3]);
    put_text(line);
    for (int i = 0; i < face_extra; i++) put_text(" 0.5");
    put_text(f % 2 ? "\r\n" : "\n");
  }
}

static void ply_with_long_rows(void **state) {
  (void)state;
  for (int extra = 1; extra < 9; extra++) {
    scree_scan scan;
    scree_error error = {.status = SCREE_OK};
    put_long_rows(extra / 3, extra % 3);
    expect_cube("PLY ASCII");
    CHECK_OK(scree_scan_parse(file, file_size, "made", NULL, &scan, &error), error);
    assert_int_equal(error.status, SCREE_OK);
    assert_non_null(strstr(scan.warning, extra < 3 ? "face 1 of 6" : "vertex 1 of 8"));
    scree_scan_free(&scan);
  }
  put_long_rows(2, 0);
  *strstr(strstr(file, "0 1 1 1"), " 1 1") = '\n'; /* and one with too few */
  expect_error("line 14: vertex 5 of 8: fewer values");
}

static void off(void **state) {
  (void)state;
  static const char *const words[] = {"OFF", "COFF", "NOFF", "off", "STCNOFF"};
  static const char *const tails[] = {"", " 0.1 0.2 0.3 1", " 0 0 1", " # what",
                                      " 0 0 1 1 0 0 1 0 0"};
  static const char *const counts[] = {"\n8 6 12\n",          " 8 6 12\n",
                                       "\n# counts\n\n8 6\n", "\n8\n6\n12 # e\n",
                                       "\n8 6 # vf\n12\n",    " 8\n\n6\n# e\n 12 \n",
                                       "\r8\r6\r12\r",        "8 6 12\n"};
  for (int style = 0; style < 240; style++) {
    char line[100];
    begin(style % 2 ? "# first\n" : "");
    put_text(words[style % 5]), put_text(counts[style % 8]);
    for (int v = 0; v < 8; v++) {
      snprintf(line, sizeof line, "%d %d %d%s%s", cube_vertices[v][0], cube_vertices[v][1],
               cube_vertices[v][2], tails[style % 5], style / 3 % 2 ? "\r\n" : "\n");
      put_text(line);
      if (v == 4) put_text("# in between\n\n");
    }
    for (int f = 0; f < 6; f++) {
      snprintf(line, sizeof line, "4 %d %d %d %d%s\n", cube_faces[f][0], cube_faces[f][1],
               cube_faces[f][2], cube_faces[f][3], style % 2 ? " 255 0 0" : "");
      put_text(line);
    }
    expect_cube("OFF");
  }
}

static void off_broken(void **state) {
  (void)state;
  begin("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  expect_error("line 6: a corner of a face should be a whole number from 0 to 2, found '3'");
  begin("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n# end\n3 0 2 1\n");
  expect_error("line 8: more follows the last of the header's 1 faces: a count is wrong");
  begin("OFF\n3000000 1 0\n0 0 0\n");
  expect_error(
      "line 2: the number of vertices is 3000000, more than the rest of the file has room");
  begin("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n");
  expect_error("line 6: the file ends after 0 of 1 faces");
  begin("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1");
  expect_error("line 7: the file ends after 1 of 2 faces");
  begin("OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1\n3 0 2 1\n");
  expect_error("line 7: too few numbers here");
  begin("OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 1\n3 0 2 1\n");
  expect_error(
      "line 8: the file ends after 2 of 3 faces; one that begins here took numbers of the");
  begin("OFF\n4 1 0\n0 0 0\n1 0\n0 1 0\n0 0 1\n3 0 1 2\n");
  expect_error("line 4: the file ends after 0 of 1 faces");
  begin("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n99999999 0 1 2\n");
  expect_error(
      "line 6: the number of corners is 99999999, more than the rest of the file has room");
  begin("OFF BINARY\n");
  expect_error("binary OFF");
  begin("OFF\n1 0 0\n0 0 0\n");
  expect_error("no facets");
  begin("OFF\n1 -1 0\n0 0 0\n");
  expect_error("the number of faces");
}

/* ---- polygons ---- */

/* A random star-shaped polygon in a random plane: its triangles have its area, and none is turned.
 */
static void concave_polygons(void **state) {
  (void)state;
  scree_rng rng = {3, 1, 0};
  for (int round = 0; round < 3000; round++) {
    uint32_t count = 4 + (uint32_t)scree_rng_below(&rng, 60), corners[64];
    double positions[3 * 64];
    mat3 turn = quat_to_mat3(scree_rng_rotation(&rng));
    vec3 area = {0, 0, 0}, normal = mat3_mul_vec(&turn, (vec3){0, 0, 1});
    for (uint32_t i = 0; i < count; i++) {
      double angle = 2 * 3.14159265358979 * i / count, radius = 1 + 9 * scree_rng_uniform(&rng);
      vec3 p = mat3_mul_vec(&turn, (vec3){radius * cos(angle), radius * sin(angle), 100});
      vec3_store(positions + 3 * (size_t)i, p);
      corners[i] = i;
    }
    for (uint32_t i = 0; i < count; i++)
      area = vec3_add(area, vec3_cross(vec3_load(positions + 3 * (size_t)i),
                                       vec3_load(positions + 3 * (size_t)((i + 1) % count))));
    scree_face_list list = {0};
    scree_error error;
    assert_true(scree_face_list_add(&list, corners, count));
    CHECK_OK(scree_face_list_triangulate(&list, positions, "made", &error), error);
    assert_int_equal(list.triangles.count, 3 * (count - 2));
    double sum = 0;
    for (size_t t = 0; t < list.triangles.count; t += 3) {
      vec3 p[3];
      for (size_t k = 0; k < 3; k++)
        p[k] = vec3_load(positions + 3 * (size_t)list.triangles.items[t + k]);
      double part = vec3_dot(vec3_triangle_normal(p[0], p[1], p[2]), normal);
      assert_true(part > -1e-9);
      sum += part;
    }
    CHECK_NEAR(sum, vec3_dot(area, normal), 1e-9 * (1 + sum));
    scree_face_list_free(&list);
  }
}

static scree_status parse_file(void *context, scree_error *error) {
  (void)context;
  scree_scan scan = {0};
  scree_status status = scree_scan_parse(file, file_size, "made", NULL, &scan, error);
  scree_scan_free(&scan);
  return status;
}

static void memory_runs_out(void **state) {
  (void)state;
  ply_style s = {'l', "float", "uint8", "int", "\n", false, false};
  make_ply(&s);
  assert_true(check_allocation_failures(parse_file, NULL) > 10);
  s.strips = true;
  make_ply(&s);
  check_allocation_failures(parse_file, NULL);
  begin("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .2 .2 0\nf 1 2 3\nf 1 2 3 4 5\n");
  check_allocation_failures(parse_file, NULL);
  begin("OFF 4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n4 0 1 2 3\n");
  check_allocation_failures(parse_file, NULL);
  begin("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        "endfacet\nendsolid\n");
  check_allocation_failures(parse_file, NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ply_in_every_style),
      cmocka_unit_test(ply_cut_anywhere),
      cmocka_unit_test(ply_broken),
      cmocka_unit_test(obj),
      cmocka_unit_test(obj_broken),
      cmocka_unit_test(off),
      cmocka_unit_test(ply_with_long_rows),
      cmocka_unit_test(ply_with_a_tail),
      cmocka_unit_test(ply_with_ignored_nans),
      cmocka_unit_test(off_broken),
      cmocka_unit_test(concave_polygons),
      cmocka_unit_test(faces_of_two_corners),
      cmocka_unit_test(memory_runs_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
