/* The report's file of levels: read back by a plain decoder here, every level from it is the
 * curve's own to half a step of the grid; limits hold; damage and failing memory are told. */
#include "report/page_parts.h"
#include "report/program.h"

#include "base/alloc.h"
#include "base/codec.h"
#include "base/file.h"
#include "support/alloc_fail.h"
#include "support/check.h"
#include "support/shapes.h"

#include <meshoptimizer.h>
#include <unistd.h>

static char path[] = "/tmp/scree-levels-XXXXXX";

typedef struct packed {
  uint32_t vertex_count, triangle_count;
  uint16_t *points;    /* 4 per vertex */
  uint32_t *triangles; /* 3 per triangle */
} packed;

typedef struct file {
  char *bytes;
  scree_codec in;
  double low[3], step;
  packed base, scan;
  uint32_t collapse_count, *pairs;
  uint16_t *moves;
} file;

static uint32_t u32(file *f) {
  uint32_t value = 0;
  scree_code_u32(&f->in, &value);
  return value;
}

static const unsigned char *buffer(file *f, size_t *size) {
  *size = u32(f);
  const unsigned char *at = f->in.source + f->in.position;
  f->in.position += *size;
  assert_true(f->in.position <= f->in.count);
  return at;
}

static packed read_mesh(file *f) {
  packed m = {.vertex_count = u32(f)};
  m.triangle_count = u32(f);
  m.points = calloc(m.vertex_count, 8);
  m.triangles = calloc(m.triangle_count, 12);
  size_t size;
  const unsigned char *bytes = buffer(f, &size);
  bool none = m.vertex_count == 0 && size == 0;
  assert_true(none || !meshopt_decodeVertexBuffer(m.points, m.vertex_count, 8, bytes, size));
  bytes = buffer(f, &size);
  if (none) return m;
  assert_int_equal(
      meshopt_decodeIndexBuffer(m.triangles, 3 * (size_t)m.triangle_count, 4, bytes, size), 0);
  return m;
}

static file read_levels(void) {
  file f = {0};
  size_t size;
  scree_error error;
  CHECK_OK(scree_file_read(path, 0, &f.bytes, &size, &error), error);
  CHECK_OK(scree_levels_check(f.bytes, size, path, &error), error);
  f.in = (scree_codec){
      .source = (const unsigned char *)f.bytes, .count = size, .position = 40, .loading = true};
  scree_code_reals(&f.in, f.low, 3);
  scree_code_real(&f.in, &f.step);
  u32(&f);
  size_t trace = u32(&f);
  f.in.position += 8 * 5 * trace;
  size_t measured = u32(&f);
  f.in.position += 8 * 11 * measured;
  f.base = read_mesh(&f);
  f.collapse_count = u32(&f);
  f.pairs = calloc(f.collapse_count + 1, 8);
  f.moves = calloc(f.collapse_count + 1, 8);
  const unsigned char *bytes = buffer(&f, &size);
  assert_int_equal(meshopt_decodeVertexBuffer(f.pairs, f.collapse_count, 8, bytes, size), 0);
  bytes = buffer(&f, &size);
  assert_int_equal(meshopt_decodeVertexBuffer(f.moves, f.collapse_count, 8, bytes, size), 0);
  f.scan = read_mesh(&f);
  assert_int_equal(f.in.position, f.in.count);
  return f;
}

static void free_levels(file *f) {
  scree_free(f->bytes);
  free(f->base.points);
  free(f->base.triangles);
  free(f->scan.points);
  free(f->scan.triangles);
  free(f->pairs);
  free(f->moves);
}

/* One collapse after the other on the triangles themselves: slow and plain. */
static void collapse(file *f, uint32_t i) {
  uint32_t kept = f->pairs[2 * i], gone = f->pairs[2 * i + 1], left = 0;
  for (int k = 0; k < 3; k++)
    f->base.points[4 * kept + k] = (uint16_t)(f->base.points[4 * kept + k] + f->moves[4 * i + k]);
  for (uint32_t t = 0; t < f->base.triangle_count; t++) {
    uint32_t c[3];
    for (int k = 0; k < 3; k++)
      c[k] = f->base.triangles[3 * t + k] == gone ? kept : f->base.triangles[3 * t + k];
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
    memcpy(f->base.triangles + 3 * left++, c, sizeof c);
  }
  assert_int_equal(f->base.triangle_count - left, f->moves[4 * i + 3]);
  f->base.triangle_count = left;
}

static int by_size(const void *a, const void *b) {
  const double *x = a, *y = b;
  for (int k = 0; k < 9; k++)
    if (fabs(x[k] - y[k]) > 1e-9) return x[k] < y[k] ? -1 : 1;
  return 0;
}

/* Corners of all triangles, rounded to the file's grid, each beginning at its least corner. */
static double *soup(const packed *m, const scree_mesh *mesh, const file *f) {
  size_t count = m ? m->triangle_count : mesh->triangle_count;
  double *all = calloc(count + 1, 9 * sizeof *all);
  for (size_t t = 0; t < count; t++) {
    double c[3][3];
    int first = 0;
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        c[i][k] = m ? m->points[4 * m->triangles[3 * t + (size_t)i] + k]
                    : floor((mesh->positions[3 * mesh->triangles[3 * t + (size_t)i] + (size_t)k] -
                             f->low[k]) /
                                f->step +
                            0.5);
    for (int i = 1; i < 3; i++) {
      int k = 0;
      while (k < 2 && c[i][k] == c[first][k]) k++;
      if (c[i][k] < c[first][k]) first = i;
    }
    for (int i = 0; i < 3; i++) memcpy(all + 9 * t + 3 * i, c[(first + i) % 3], sizeof c[0]);
  }
  qsort(all, count, 9 * sizeof *all, by_size);
  return all;
}

static void check_same(const file *f, const packed *m, const scree_curve *curve, size_t level) {
  scree_mesh mesh;
  scree_error error;
  CHECK_OK(scree_curve_mesh(curve, level, &mesh, &error), error);
  assert_int_equal(m->triangle_count, mesh.triangle_count);
  double *a = soup(m, NULL, f), *b = soup(NULL, &mesh, f);
  for (size_t i = 0; i < 9 * mesh.triangle_count; i++) CHECK_NEAR(a[i], b[i], 1e-9);
  free(a);
  free(b);
  scree_mesh_free(&mesh);
}

static scree_mesh made(int kind) {
  scree_rng rng = {0};
  scree_mesh mesh = kind == 0   ? shape_icosphere(0.03, 4)
                    : kind == 1 ? shape_sheet(0.01, 40)
                    : kind == 2 ? shape_torus(0.05, 0.02, 60, 40)
                                : shape_tetrahedron(1, 2, 3);
  if (kind == 0 || kind == 2) shape_shake(&mesh, 1e-5, &rng);
  return mesh;
}

typedef struct object {
  scree_mesh mesh;
  scree_curve *curve; /* borrows the mesh: an object is not copied */
  scree_choice choice;
} object;

static void choose(object *o) {
  scree_error error;
  scree_simplify_options simplify = scree_default_simplify_options();
  CHECK_OK(scree_curve_build(&o->mesh, &simplify, NULL, &o->curve, &error), error);
  CHECK_OK(scree_choose(o->curve, NULL, NULL, NULL, &o->choice, &error), error);
}

static void free_object(object *o) {
  scree_curve_free(o->curve);
  scree_choice_free(&o->choice);
  scree_mesh_free(&o->mesh);
}

static void every_level_is_the_curves(void **state) {
  (void)state;
  for (int kind = 0; kind < 4; kind++) {
    object o = {.mesh = made(kind)};
    scree_error error;
    choose(&o);
    CHECK_OK(scree_levels_write(o.curve, &o.choice, 30000, path, true, &error), error);
    file f = read_levels();
    size_t level = scree_curve_collapse_count(o.curve) - f.collapse_count;
    check_same(&f, &f.scan, o.curve, scree_curve_find(o.curve, f.scan.triangle_count));
    check_same(&f, &f.base, o.curve, level);
    for (uint32_t i = 0; i < f.collapse_count; i++) {
      collapse(&f, i);
      if (++level % 97 == 0 || i + 1 == f.collapse_count) check_same(&f, &f.base, o.curve, level);
    }
    assert_int_equal(level, scree_curve_collapse_count(o.curve));
    free_levels(&f);
    free_object(&o);
  }
}

static void the_limit_holds_and_is_used(void **state) {
  (void)state;
  object o = {.mesh = shape_icosphere(0.05, 5)};
  scree_rng rng = {0};
  scree_error error;
  shape_shake(&o.mesh, 2e-5, &rng);
  choose(&o);
  size_t shown = 0;
  for (size_t limit = 100000; limit < 300000; limit = limit * 3 / 2) {
    CHECK_OK(scree_levels_write(o.curve, &o.choice, limit, path, true, &error), error);
    file f = read_levels();
    assert_in_range(f.in.count, limit / 2, limit + 40);
    assert_true(f.scan.triangle_count > shown || shown == o.mesh.triangle_count);
    shown = f.scan.triangle_count;
    free_levels(&f);
    if (shown == o.mesh.triangle_count) break;
  }
  assert_int_equal(shown, o.mesh.triangle_count);
  free_object(&o);
}

/* The bytes before base64 of all parts, and how many there are. */
static size_t parts_in(const char *text, size_t *count) {
  size_t bytes = 0;
  *count = 0;
  while ((text = strstr(text, "<script "))) {
    const char *start = strchr(text, '>') + 1, *end = strchr(start, '<');
    size_t digits = (size_t)(end - start);
    bytes += digits / 4 * 3 - (end[-1] == '=') - (end[-2] == '=');
    text = end;
    ++*count;
  }
  return bytes;
}

static char *put_parts(size_t copies, size_t room) {
  char folder[sizeof path], *text = NULL, *name;
  const char *id;
  size_t size;
  scree_error error;
  scree_page_parts parts = {0};
  snprintf(folder, sizeof folder, "%s", path);
  name = strrchr(folder, '/');
  *name++ = 0;
  for (size_t i = 0; i < copies; i++) {
    CHECK_OK(scree_page_part_add(&parts, SCREE_PART_LEVELS, folder, name, &id, &error), error);
    assert_non_null(id);
  }
  CHECK_OK(scree_page_part_add(&parts, SCREE_PART_PILE, folder, "none", &id, &error), error);
  assert_null(id);
  FILE *stream = open_memstream(&text, &size);
  CHECK_OK(scree_page_parts_put(&parts, stream, room, &error), error);
  fclose(stream);
  scree_page_parts_free(&parts);
  return text;
}

static void several_share_the_room(void **state) {
  (void)state;
  object o = {.mesh = shape_icosphere(0.05, 5)};
  scree_error error;
  choose(&o);
  CHECK_OK(scree_levels_write(o.curve, &o.choice, 200000, path, true, &error), error);
  file whole = read_levels(), bare;
  size_t size = whole.in.count;
  char *bytes;
  CHECK_OK(scree_file_read(path, 0, &bytes, &size, &error), error);
  size_t left = scree_levels_drop_scan(bytes, size);
  assert_true(left < 0.9 * (double)size);
  CHECK_OK(scree_levels_check(bytes, left, "x", &error), error);
  assert_int_equal(scree_levels_drop_scan(bytes, left), left);
  for (size_t cut = 0; cut < left; cut += 97)
    assert_int_equal(scree_levels_drop_scan(bytes, cut), cut); /* as it is, and nothing outside */
  for (size_t room = 0; room < 4 * size; room += size / 5) {
    size_t count, expected = 0, whole_count = 0, used;
    while (expected < 3 && (expected + 1) * left <= room) expected++;
    while (expected == 3 && whole_count < 3 &&
           (whole_count + 1) * size + (2 - whole_count) * left <= room)
      whole_count++;
    char *text = put_parts(3, room);
    used = parts_in(text, &count);
    assert_int_equal(count, expected);
    assert_int_equal(used, whole_count * size + (expected - whole_count) * left);
    free(text);
  }
  FILE *stream = fopen(path, "wb"); /* the same levels from what is left */
  assert_int_equal(fwrite(bytes, 1, left, stream), left);
  fclose(stream);
  bare = read_levels();
  assert_int_equal(bare.scan.triangle_count, 0);
  assert_int_equal(bare.collapse_count, whole.collapse_count);
  assert_memory_equal(bare.pairs, whole.pairs, 8 * (size_t)whole.collapse_count);
  assert_memory_equal(bare.moves, whole.moves, 8 * (size_t)whole.collapse_count);
  scree_free(bytes);
  free_levels(&bare);
  free_levels(&whole);
  free_object(&o);
}

static scree_status write_levels(void *context, scree_error *error) {
  const object *o = context;
  return scree_levels_write(o->curve, &o->choice, 30000, path, true, error);
}

static void failing_memory_is_told(void **state) {
  (void)state;
  object o = {.mesh = shape_icosphere(0.05, 2)};
  choose(&o);
  check_allocation_failures(write_levels, &o);
  free_object(&o);
}

static void damage_is_told(void **state) {
  (void)state;
  object o = {.mesh = shape_icosphere(1, 2)};
  scree_error error;
  char *bytes;
  size_t size;
  choose(&o);
  CHECK_OK(scree_levels_write(o.curve, &o.choice, 30000, path, true, &error), error);
  assert_int_equal(scree_levels_write(o.curve, &o.choice, 30000, path, false, &error),
                   SCREE_EXISTS);
  CHECK_OK(scree_file_read(path, 0, &bytes, &size, &error), error);
  CHECK_OK(scree_levels_check(bytes, size, "x", &error), error);
  for (size_t cut = 0; cut < size; cut += cut < 50 ? 1 : 101)
    assert_int_equal(scree_levels_check(bytes, cut, "x", &error), SCREE_BAD_FILE);
  for (size_t i = 0; i < size; i += i < 50 ? 1 : 101) {
    bytes[i] ^= 4;
    assert_int_equal(scree_levels_check(bytes, size, "x", &error), SCREE_BAD_FILE);
    bytes[i] ^= 4;
  }
  scree_free(bytes);
  free_object(&o);
}

int main(void) {
  int descriptor = mkstemp(path);
  if (descriptor < 0) return 1;
  close(descriptor);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_level_is_the_curves), cmocka_unit_test(the_limit_holds_and_is_used),
      cmocka_unit_test(several_share_the_room), cmocka_unit_test(failing_memory_is_told),
      cmocka_unit_test(damage_is_told)};
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  unlink(path);
  return failed;
}
