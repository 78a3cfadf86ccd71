/* Every reader of tables by every spelling of one table: separators, quotes, line ends, a byte
 * order mark, pandas' index, comments of others. */
#include "base/alloc.h"
#include "base/rows.h"
#include "scene/named_table.h"
#include "scree.h"
#include "support/check.h"
#include "support/folder.h"

enum { ROWS = 4, MOST_COLUMNS = 5, MOST_TEXT = 4000 };

/* ---- one table, spelt ---- */

typedef struct spelling {
  const char *separator, *line_end, *begin, *index, *comment;
  int quotes; /* 0: none, 1: of names, 2: of all */
  bool trailing, blank_lines;
} spelling;

static char text[MOST_TEXT];
static size_t text_size;

static void put(const char *piece) {
  size_t length = strlen(piece);
  assert_true(text_size + length < sizeof text);
  memcpy(text + text_size, piece, length + 1);
  text_size += length;
}

static void put_cell(const spelling *s, const char *cell, bool is_name, bool is_first) {
  bool quoted = s->quotes == 2 || (s->quotes == 1 && is_name);
  if (!is_first) put(s->separator);
  if (quoted) put("\"");
  put(cell);
  if (quoted) put("\"");
}

static void spell(const spelling *s, const char *const cells[ROWS][MOST_COLUMNS], int columns) {
  text_size = 0;
  put(s->begin);
  for (int i = 0; i < ROWS; i++) {
    char number[8];
    snprintf(number, sizeof number, "%d", i - 1);
    if (s->index) put_cell(s, i ? number : s->index, i == 0, true);
    for (int k = 0; k < columns; k++) put_cell(s, cells[i][k], i == 0, k == 0 && !s->index);
    if (s->trailing) put(s->separator);
    if (i == 1 && *s->comment == ' ') put(s->comment);
    put(s->line_end);
    if (s->blank_lines) put(s->line_end);
    if (*s->comment && *s->comment != ' ') put(s->comment), put(s->line_end);
  }
}

/* ---- the readers ---- */

/* Each gives its rows as so many numbers. */
typedef struct reader {
  const char *name;
  int columns, count;
  const char *cells[ROWS][MOST_COLUMNS];
  scree_status (*read)(double *values, scree_error *error);
} reader;

static const char *in_file(void) {
  const char *path = in_folder("table.csv");
  FILE *out = fopen(path, "wb");
  assert_non_null(out);
  assert_int_equal(fwrite(text, 1, text_size, out), text_size);
  fclose(out);
  return path;
}

static scree_status read_spheres(double *values, scree_error *error) {
  scree_particle *particle;
  scree_read_options options = scree_default_read_options();
  options.unit_m = 1;
  scree_status status = scree_particle_clump_read(in_file(), &options, &particle, error);
  if (status != SCREE_OK) return status;
  scree_particle_measures m;
  scree_particle_measure(particle, &m);
  values[0] = (double)m.point_count;
  values[1] = m.volume;
  scree_particle_free(particle);
  return SCREE_OK;
}

static scree_status read_named(const scree_named_column *known, int count, double *values,
                               const char **words, scree_error *error) {
  scree_named_table t;
  scree_status status = scree_named_open(&t, "table", text, text_size, known, count, error);
  for (bool there = true; status == SCREE_OK && there; values += 4)
    status = scree_named_row(&t, values, words, &there);
  return status;
}

static scree_status read_bodies(double *values, scree_error *error) {
  static const scree_named_column known[] = {{"x", "m"}, {"y", "m"}, {"z", "m"}, {"shape", NULL}};
  const char *words[4] = {NULL};
  scree_status status = read_named(known, 4, values, words, error);
  if (status == SCREE_OK) assert_string_equal(words[3], "round ball");
  return status;
}

static scree_status read_path(double *values, scree_error *error) {
  static const scree_named_column known[] = {{"x", "m"}, {"angle_x", "rad"}, {"t", "s"}};
  return read_named(known, 3, values, NULL, error);
}

static scree_status read_outline(double *values, scree_error *error) {
  scree_outline o;
  scree_status status = scree_outline_read(in_file(), 1, &o, error);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; i < o.count; i++) values[2 * i] = o.x[i], values[2 * i + 1] = o.z[i];
  scree_outline_free(&o);
  return SCREE_OK;
}

static const reader readers[] = {
    {"spheres",
     4,
     2,
     {{"x", "y", "z", "radius"},
      {"0", "0", "0", "0.5"},
      {"8", "0", "0", "1e-1"},
      {"-3.5", "6", "0", ".25"}},
     read_spheres},
    {"bodies",
     4,
     11,
     {{"x", "y", "z", "shape"},
      {"0", "0.5", "1", "round ball"},
      {"8", "0", "0", "round ball"},
      {"-3.5", "6", "0", "round ball"}},
     read_bodies},
    {"paths",
     3,
     11,
     {{"t", "x", "angle_x"}, {"0", "0.5", "1"}, {"1", "0", "2"}, {"2.5", "6", "0"}},
     read_path},
    {"outlines", 2, 6, {{"x", "z"}, {"-1.5", "0"}, {"0", ".75"}, {"1", "0"}}, read_outline}};
enum { READERS = sizeof readers / sizeof *readers };

static void expect_same(const reader *r, const spelling *s, const double *wanted) {
  scree_error error;
  double values[32] = {0};
  spell(s, r->cells, r->columns);
  char kept[MOST_TEXT];
  memcpy(kept, text, text_size + 1);
  scree_status status = r->read(values, &error);
  if (status != SCREE_OK) fail_msg("%s: %s\n%s", r->name, error.message, kept);
  for (int i = 0; i < r->count; i++)
    if (!(values[i] == wanted[i]))
      fail_msg("%s: number %d is %g, not %g\n%s", r->name, i, values[i], wanted[i], kept);
}

static const spelling plain = {",", "\n", "", NULL, "", 0, false, false};

static void every_spelling(void **state) {
  (void)state;
  static const char *const
      separators[] = {",", ";", "\t", ", ", " ; ", "  "},
      *const ends[] = {"\n", "\r\n", "\r"}, *const begins[] = {"", "\xef\xbb\xbf"},
      *const indices[] = {NULL, "", "Unnamed: 0"}, *const comments[] = {"",
                                                                        "# volume = 5.58",
                                                                        "% of another program",
                                                                        "// of a third",
                                                                        "  # behind a row",
                                                                        "#"};
  size_t count = 0;
  for (int i = 0; i < READERS; i++) {
    scree_error error;
    double wanted[32] = {0};
    spell(&plain, readers[i].cells, readers[i].columns);
    CHECK_OK(readers[i].read(wanted, &error), error);
    for (unsigned code = 0; code < 6 * 3 * 2 * 3 * 6 * 3 * 2; code++) {
      unsigned c = code;
      spelling s = {.separator = separators[c % 6]};
      s.line_end = ends[c / 6 % 3], c /= 18;
      s.begin = begins[c % 2], c /= 2;
      s.index = indices[c % 3], c /= 3;
      s.comment = comments[c % 6], c /= 6;
      s.quotes = (int)(c % 3), c /= 3;
      s.blank_lines = s.trailing = c % 2;
      bool blanks = !strcmp(s.separator, "  ");
      if (blanks && (s.quotes < 2) && (s.index || readers[i].read == read_bodies)) continue;
      expect_same(&readers[i], &s, wanted);
      count++;
    }
  }
  assert_true(count > 12000);
}

/* What cannot be read is told by its name, wherever it stands. */
static void told(void **state) {
  (void)state;
  scree_error error;
  for (int i = 0; i < READERS; i++) {
    const reader *r = &readers[i];
    double values[32];
    static const char *const separators[] = {";", "\t", "  "};
    for (int k = 0; k < 3; k++) { /* a decimal comma */
      spelling s = plain;
      s.separator = separators[k];
      s.quotes = k == 2 ? 2 : 0;
      spell(&s, r->cells, r->columns);
      for (char *c = strchr(text, '\n'); (c = strchr(c, '.'));) *c = ',';
      assert_int_equal(r->read(values, &error), SCREE_BAD_FILE);
      if (!strstr(error.message, "decimal comma") || !strstr(error.message, "line "))
        fail_msg("%s: %s", r->name, error.message);
    }
    for (int k = 0; k < 3; k++) { /* UTF-16, with and without its mark */
      spell(&plain, r->cells, r->columns);
      char wide[2 * MOST_TEXT];
      size_t size = 0;
      if (k < 2) memcpy(wide, k ? "\xfe\xff" : "\xff\xfe", size = 2);
      for (size_t n = 0; n < text_size; n++) {
        wide[size++] = k == 1 ? 0 : text[n];
        wide[size++] = k == 1 ? text[n] : 0;
      }
      assert_true(size < sizeof text);
      memcpy(text, wide, size);
      text[text_size = size] = 0;
      assert_int_equal(r->read(values, &error), SCREE_BAD_FILE);
      if (!strstr(error.message, "UTF-16; save it as UTF-8"))
        fail_msg("%s: %s", r->name, error.message);
    }
    static const char *const broken[][2] = {
        {"\"", "quote"}, {"\"a\"b", "quote"}, {"x\"y", "number"}};
    for (int k = 0; k < 3; k++) {
      spell(&plain, r->cells, r->columns);
      put(broken[k][0]);
      for (int n = 1; n < r->columns; n++) put(",1");
      assert_int_equal(r->read(values, &error), SCREE_BAD_FILE);
      if (!strstr(error.message, broken[k][1]) || !strstr(error.message, "line 5"))
        fail_msg("%s: %s", r->name, error.message);
    }
    spell(&plain, r->cells, r->columns);
    text[text_size - 3] = 0;
    assert_int_equal(r->read(values, &error), SCREE_BAD_FILE);
    if (!strstr(error.message, "is 0, which no text has"))
      fail_msg("%s: %s", r->name, error.message);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(every_spelling), cmocka_unit_test(told)};
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
