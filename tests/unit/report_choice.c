/* Figures, JSON and CSV: files are what they claim to be, JSON is judged by a strict checker of our
 * own, numbers read back the same. */
#include "base/alloc.h"
#include "base/file.h"
#include "base/number.h"
#include "base/rng.h"
#include "choice/criterion.h"
#include "report/csv.h"
#include "report/json.h"
#include "report/plot.h"
#include "report/program.h"
#include "support/check.h"
#include "support/folder.h"

#include <unistd.h>

static char *content(const char *path, size_t *size) {
  char *bytes;
  scree_error error;
  CHECK_OK(scree_file_read(path, 0, &bytes, size, &error), error);
  return bytes;
}

/* ---- a strict JSON checker: RFC 8259, nothing more ---- */

static const char *value(const char *p);

static const char *space(const char *p) {
  while (*p == ' ' || *p == '\n' || *p == '\t' || *p == '\r') p++;
  return p;
}
static const char *string(const char *p) {
  if (*p++ != '"') return NULL;
  while (*p != '"') {
    if ((unsigned char)*p < 0x20) return NULL;
    if (*p == '\\') {
      p++;
      if (*p == 'u') {
        for (int i = 1; i <= 4; i++)
          if (!strchr("0123456789abcdefABCDEF", p[i]) || !p[i]) return NULL;
        p += 4;
      } else if (!*p || !strchr("\"\\/bfnrt", *p)) {
        return NULL;
      }
    }
    p++;
  }
  return p + 1;
}
static const char *number(const char *p) {
  if (*p == '-') p++;
  if (*p == '0')
    p++;
  else if (*p >= '1' && *p <= '9')
    while (*p >= '0' && *p <= '9') p++;
  else
    return NULL;
  if (*p == '.') {
    if (!(p[1] >= '0' && p[1] <= '9')) return NULL;
    for (p++; *p >= '0' && *p <= '9';) p++;
  }
  if (*p == 'e' || *p == 'E') {
    p++;
    if (*p == '+' || *p == '-') p++;
    if (!(*p >= '0' && *p <= '9')) return NULL;
    while (*p >= '0' && *p <= '9') p++;
  }
  return p;
}
static const char *members(const char *p, char closing) {
  p = space(p + 1);
  if (*p == closing) return p + 1;
  for (;;) {
    if (closing == '}') {
      p = string(space(p));
      if (!p) return NULL;
      p = space(p);
      if (*p++ != ':') return NULL;
    }
    p = value(space(p));
    if (!p) return NULL;
    p = space(p);
    if (*p == closing) return p + 1;
    if (*p++ != ',') return NULL;
  }
}
static const char *value(const char *p) {
  if (*p == '{') return members(p, '}');
  if (*p == '[') return members(p, ']');
  if (*p == '"') return string(p);
  if (!strncmp(p, "true", 4) || !strncmp(p, "null", 4)) return p + 4;
  if (!strncmp(p, "false", 5)) return p + 5;
  return number(p);
}
static bool is_json(const char *text) {
  const char *end = value(space(text));
  return end && !*space(end);
}

static void the_checker_refuses(void **state) {
  (void)state;
  const char *const bad[] = {"",      "[1,]",  "{\"a\":}", "[01]",        "[1.]", "[nan]",
                             "{a:1}", "[1 2]", "[\"\n\"]", "[\"\\x\"]",   "[1]]", "[.5]",
                             "[",     "{",     "[tru]",    "[\"\\u12\"]", "[1e]", "[-]"};
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) assert_false(is_json(bad[i]));
  assert_true(is_json("[1, -2.5e-7, {\"a\": [], \"b\": {}}, null, true, \"\\u0041\\n\"]"));
}

static void json_is_valid_whatever_the_texts(void **state) {
  (void)state;
  scree_rng rng = {5, 5, 0};
  for (int trial = 0; trial < 300; trial++) {
    char text[64], key[16];
    for (int i = 0; i < 63; i++) text[i] = (char)(1 + scree_rng_below(&rng, 255));
    for (int i = 0; i < 15; i++) key[i] = (char)(1 + scree_rng_below(&rng, 255));
    text[63] = key[15] = 0;
    FILE *stream = fopen(in_folder("any.json"), "w");
    scree_json json = scree_json_start(stream);
    scree_json_array(&json, NULL);
    scree_json_text(&json, NULL, text);
    scree_json_object(&json, NULL);
    scree_json_text(&json, key, NULL);
    scree_json_number(&json, "nan", NAN);
    scree_json_number(&json, "inf", -INFINITY);
    scree_json_row_array(&json, "row");
    scree_json_end(&json);
    scree_json_row_object(&json, "empty");
    scree_json_end(&json);
    scree_json_bool(&json, "yes", true);
    scree_json_end(&json);
    scree_json_count(&json, NULL, UINT64_MAX);
    scree_json_end(&json);
    fclose(stream);
    size_t size;
    char *bytes = content(in_folder("any.json"), &size);
    assert_true(is_json(bytes));
    assert_non_null(strstr(bytes, "\"nan\": null"));
    assert_non_null(strstr(bytes, "18446744073709551615"));
    scree_free(bytes);
  }
  FILE *stream = fopen(in_folder("any.json"), "w");
  scree_json json = scree_json_start(stream);
  scree_json_text(&json, NULL, "a\"b\\c\n<script>\xff\xc3\xa4");
  fclose(stream);
  size_t size;
  char *bytes = content(in_folder("any.json"), &size);
  assert_string_equal(bytes, "\"a\\\"b\\\\c\\u000a\\u003cscript\\u003e\\ufffd\xc3\xa4\"");
  scree_free(bytes);
}

static void numbers_read_back_the_same(void **state) {
  (void)state;
  scree_rng rng = {6, 6, 0};
  char buffer[SCREE_NUMBER_SIZE];
  for (int trial = 0; trial < 20000; trial++) {
    uint64_t bits = scree_rng_next(&rng);
    double x;
    memcpy(&x, &bits, 8);
    if (!isfinite(x)) continue;
    scree_number_format(x, buffer);
    assert_true(strtod(buffer, NULL) == x);
    assert_true(number(buffer) && !*number(buffer));
  }
  scree_number_format(0.1, buffer);
  assert_string_equal(buffer, "0.1");
  scree_number_format(1e-5, buffer);
  assert_string_equal(buffer, "1e-05");
}

static size_t labels_in(const scree_ticks *t) {
  size_t count = 0;
  for (size_t i = 0; i < t->count; i++) count += t->label[i][0] != 0;
  return count;
}

static void ticks_are_where_they_belong(void **state) {
  (void)state;
  scree_ticks t;
  scree_ticks_make(SCREE_SCALE_LOG, 1e-5, 1e-1, &t);
  assert_int_equal(t.count, 4 * 9 + 1);
  assert_string_equal(t.label[0], "10^{\u22125}");
  assert_string_equal(t.label[1], "");
  CHECK_NEAR(t.value[1] / 2e-5, 1, 1e-12);
  assert_string_equal(t.label[36], "0.1");
  scree_ticks_make(SCREE_SCALE_LOG, 1.5, 30, &t);
  assert_string_equal(t.label[0], "2");
  scree_ticks_make(SCREE_SCALE_LINEAR, 0, 1, &t);
  assert_string_equal(t.label[0], "0");
  CHECK_NEAR(t.value[t.count - 1], 1, 1e-12);
  scree_ticks_make(SCREE_SCALE_LINEAR, -0.013, 0.021, &t);
  assert_true(t.count > 10);
  scree_ticks_make(SCREE_SCALE_LOG, 33, 78, &t); /* a study's times */
  assert_true(labels_in(&t) >= 4);
  scree_ticks_make(SCREE_SCALE_LOG, 110, 190, &t); /* no 1, 2, 5 in it */
  assert_true(labels_in(&t) >= 4);
  scree_ticks_make(SCREE_SCALE_LOG, 3, 99, &t); /* 5, 10, 20, 50 */
  assert_int_equal(labels_in(&t), 4);
  scree_rng rng = {8, 8, 0};
  for (int trial = 0; trial < 5000; trial++) {
    double low = exp(40 * (scree_rng_uniform(&rng) - 0.5)),
           high = low * (1 + exp(30 * (scree_rng_uniform(&rng) - 0.5)));
    for (int scale = 0; scale < 2; scale++) {
      scree_ticks_make((scree_scale)scale, low, high, &t);
      for (size_t i = 0; i < t.count; i++) {
        double slack = 1e-6 * (high - low) + 1e-9 * high;
        assert_true(t.value[i] >= low - slack && t.value[i] <= high + slack);
        assert_true(i == 0 || t.value[i] > t.value[i - 1]);
      }
      assert_true(labels_in(&t) >= 2 || high < 1.001 * low); /* by one alone no value is read */
    }
  }
  scree_ticks_make(SCREE_SCALE_LOG, 0, 1, &t);
  assert_int_equal(t.count, 0);
  scree_ticks_make(SCREE_SCALE_LINEAR, NAN, 1, &t);
  assert_int_equal(t.count, 0);
}

/* ---- a report of made-up objects ---- */

enum { OBJECTS = 9 };
static const char *const names[OBJECTS] = {"fp-1", "fp-2", "fp-3", "dc-1", "dc-2",
                                           "dc-3", "sp-1", "sp-2", "sp-3"};

static scree_level_row made_up_row(const void *context, size_t index) {
  int object = *(const int *)context;
  double scan = 400000 + 60000.0 * object, n = scan - 2.0 * (double)index;
  double c = object < 3 ? 4 : object < 6 ? 9 : 0.8;
  double wiggle = 0.3 * sin(3 * log(n) + object), decay = n / scan * 3;
  double noise = 0.02 * decay * decay / (1 + decay * decay);
  double area = 0.016 * (1 - c / (n + 10) * (1 + wiggle) + (object % 2 ? noise : 0));
  return (scree_level_row){(size_t)n, area, 1e-4 * (1 - 0.2 / n)};
}

typedef struct made_up {
  int object[OBJECTS];
  scree_choice choices[OBJECTS];
  scree_choice_entry entries[OBJECTS];
  scree_choice_options options;
  scree_set_choice set;
  scree_choice_report report;
} made_up;

static void make_report(made_up *m, size_t count) {
  scree_error error;
  m->options = scree_default_choice_options();
  for (size_t k = 0; k < count; k++) {
    m->object[k] = (int)k;
    scree_level_table table = {(400000 + 60000 * k - 8) / 2 + 1, made_up_row, &m->object[k]};
    CHECK_OK(scree_choice_from_table(&table, &m->options, &m->choices[k], &error), error);
    m->entries[k] = (scree_choice_entry){.name = names[k],
                                         .file = names[k],
                                         .format = "binary STL",
                                         .unit_m = 1e-3,
                                         .choice = &m->choices[k]};
  }
  CHECK_OK(scree_choose_set(m->choices, count, &m->set, &error), error);
  m->report = (scree_choice_report){.entries = m->entries,
                                    .entry_count = count,
                                    .set = &m->set,
                                    .options = &m->options,
                                    .command_line = "scree choose 'a \"b\".stl'"};
}
static void free_report(made_up *m) {
  for (size_t k = 0; k < m->report.entry_count; k++) scree_choice_free(&m->choices[k]);
  scree_set_choice_free(&m->set);
}

static size_t count_of(const char *text, const char *word) {
  size_t count = 0;
  for (const char *p = text; (p = strstr(p, word)); p++) count++;
  return count;
}

/* The numbers of the first row that has this choice; empty cells are NaN. */
static void read_row(const char *table, const char *choice, double values[9]) {
  const char *at = strstr(table, choice);
  assert_non_null(at);
  while (at > table && at[-1] != '\n') at--;
  at = strchr(at, ','); /* behind the file's name */
  for (int i = 0; i < 9; i++) {
    assert_int_equal(*at, ',');
    char *end;
    values[i] = strtod(at + 1, &end);
    if (end == at + 1) values[i] = NAN;
    at = end;
  }
}

static void check_robust_row(const char *table, const made_up *m) {
  double v[9]; /* scan's count, rp, count, area, volume, eps_s, ip, worst_eps_s, robust_ip */
  const scree_choice *c = &m->choices[0];
  const scree_pick *p = &c->robust;
  read_row(table, ",robust,", v);
  assert_true(v[0] == (double)c->triangle_count && v[1] == p->rp);
  assert_true(v[2] == (double)p->triangle_count && v[3] == p->area && v[4] == p->volume);
  assert_true(v[5] == p->eps_s && v[6] == p->ip && v[7] == p->worst_eps_s && v[8] == p->robust_ip);
  CHECK_NEAR(v[6], p->eps_s + p->rp, 1e-12);
  CHECK_NEAR(v[8], p->worst_eps_s + p->rp, 1e-12);
}

static void check_set_rows(const char *table, const made_up *m) {
  double v[9];
  read_row(table, ",set paper,", v);
  assert_true(isnan(v[0]) && isnan(v[2]) && v[1] == m->set.paper.rp && v[6] == m->set.paper.ip);
}

static void json_and_csv_of_a_choice(void **state) {
  (void)state;
  made_up m;
  scree_error error;
  size_t size;
  make_report(&m, 3);
  m.entries[1].file = "odd, \"name\" <b>.stl";
  CHECK_OK(scree_choice_json_write(&m.report, in_folder("choice.json"), false, &error), error);
  char *bytes = content(in_folder("choice.json"), &size);
  assert_true(is_json(bytes));
  assert_int_equal(count_of(bytes, "\"file\": "), 3);
  assert_int_equal(count_of(bytes, "\"set\": true"), 1);
  assert_int_equal(count_of(bytes, "\"levels\": ["), 4);
  assert_int_equal(count_of(bytes, "\"worst_eps_s\""), 3 * (37 + 2)); /* levels; paper and robust */
  assert_int_equal(count_of(bytes, "\"version\""), 4);
  scree_free(bytes);
  assert_int_equal(scree_choice_json_write(&m.report, in_folder("choice.json"), false, &error),
                   SCREE_EXISTS);
  CHECK_OK(scree_choice_csv_write(&m.report, in_folder("choice.csv"), false, &error), error);
  bytes = content(in_folder("choice.csv"), &size);
  assert_int_equal(count_of(bytes, "\n"), 1 + 3 * (37 + 1) + 1);
  assert_int_equal(count_of(bytes, ",paper,"), 3);
  assert_int_equal(count_of(bytes, ",robust,"), 3);
  assert_int_equal(count_of(bytes, "\"odd, \"\"name\"\" <b>.stl\""), 37 + 1);
  check_robust_row(bytes, &m);
  check_set_rows(bytes, &m);
  scree_free(bytes);
  CHECK_OK(scree_choice_curve_csv_write(&m.entries[0], in_folder("curve.csv"), false, &error),
           error);
  bytes = content(in_folder("curve.csv"), &size);
  assert_true(count_of(bytes, "\n") > 500 && count_of(bytes, "\n") < 1003);
  scree_free(bytes);
  free_report(&m);
}

static void figures_are_what_they_claim(void **state) {
  (void)state;
  made_up m;
  scree_error error;
  size_t size;
  const size_t counts[] = {1, OBJECTS};
  for (int i = 0; i < 2; i++) {
    make_report(&m, counts[i]);
    const char *const endings[] = {"png", "svg", "pdf", "csv", "gnuplot"};
    const char *const magic[] = {"\x89PNG\r\n\x1a\n", "<?xml", "%PDF-1.", "panel,series",
                                 "# gnuplot"};
    for (int k = 0; k < 5; k++) {
      char name[64];
      snprintf(name, sizeof name, "figure-%zu.%s", counts[i], endings[k]);
      CHECK_OK(scree_choice_figure_write(&m.report, in_folder(name), false, &error), error);
      char *bytes = content(in_folder(name), &size);
      assert_true(size > 500);
      assert_memory_equal(bytes, magic[k], strlen(magic[k]));
      if (k == 1) assert_non_null(strstr(bytes, "</svg>"));
      if (k == 0) assert_memory_equal(bytes + size - 8, "IEND\xae\x42\x60\x82", 8);
      scree_free(bytes);
    }
    assert_int_equal(scree_choice_figure_write(&m.report, in_folder("a.gif"), true, &error),
                     SCREE_BAD_ARGUMENT);
    free_report(&m);
  }
}

static void plots_stand_empty_and_odd_data(void **state) {
  (void)state;
  scree_error error;
  const double x[] = {1, 2, NAN, 4, 5, 6, -3, 1e300},
               y[] = {1e-300, 0, 2, -5, INFINITY, 3, 1, 1e300}, low[] = {0, -1, 1, NAN, 1, 2, 0, 1},
               high[] = {1, 2, 3, 4, 5, 6, 7, INFINITY};
  const scree_series series[] = {
      {"odd_{sub}", x, y, low, high, 8, 1 | 2 | 4 | 8, 3, 0},
      {NULL, NULL, NULL, NULL, NULL, 0, 1 | 2 | 4 | 8, SCREE_STYLE_INK, SCREE_MARKER_STAR}};
  for (int scale = 0; scale < 2; scale++)
    for (size_t count = 0; count <= 2; count++) {
      const scree_panel panel = {.title = "unclosed _{ and \x01 control, \xff bad byte",
                                 .x = {"x", (scree_scale)scale, 0, 0},
                                 .y = {NULL, (scree_scale)scale, 0, 0},
                                 .series = series + (count == 1),
                                 .series_count = count};
      const scree_panel panels[3] = {panel, panel, panel};
      const scree_figure figure = {.panels = panels, .panel_count = 3, .columns = 2};
      CHECK_OK(scree_figure_write(&figure, in_folder("odd"), true, &error), error);
    }
  const scree_figure none = {0};
  assert_int_equal(scree_figure_write(&none, in_folder("none.png"), true, &error),
                   SCREE_BAD_ARGUMENT);
}

/* Error bars and bands, for studies; SCREE_TEST_FOLDER=DIR keeps them to look at. */
static void bars_and_bands(void **state) {
  (void)state;
  scree_error error;
  double x[12], y[12], low[12], high[12], z[12];
  for (int i = 0; i < 12; i++) {
    x[i] = 1e-5 * pow(10, i / 4.0);
    y[i] = 34 - 9 * exp(-i / 2.5);
    low[i] = y[i] - 1.5 * exp(-i / 6.0) - 0.2;
    high[i] = y[i] + 1.5 * exp(-i / 6.0) + 0.2;
    z[i] = 30 + 2 * sin(i);
  }
  const scree_series series[] = {{"mean \u00b1 SD of 10", x, y, low, high, 12,
                                  SCREE_DRAW_LINE | SCREE_DRAW_MARKERS | SCREE_DRAW_BARS, 0, 0},
                                 {"95 % band", x, z, low, high, 12,
                                  SCREE_DRAW_LINE | SCREE_DRAW_BAND | SCREE_DRAW_DASHED, 3, 0}};
  const scree_guide guide = {"chosen", 1e-3, false};
  const scree_panel panel = {.title = "repose angle",
                             .x = {"R_{p}", SCREE_SCALE_LOG, 0, 0},
                             .y = {"angle / \u00b0", SCREE_SCALE_LINEAR, 0, 0},
                             .series = series,
                             .series_count = 2,
                             .guides = &guide,
                             .guide_count = 1};
  const scree_figure figure = {.panels = &panel, .panel_count = 1};
  CHECK_OK(scree_figure_write(&figure, in_folder("bars"), true, &error), error);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_checker_refuses),
      cmocka_unit_test(json_is_valid_whatever_the_texts),
      cmocka_unit_test(numbers_read_back_the_same),
      cmocka_unit_test(ticks_are_where_they_belong),
      cmocka_unit_test(json_and_csv_of_a_choice),
      cmocka_unit_test(figures_are_what_they_claim),
      cmocka_unit_test(plots_stand_empty_and_odd_data),
      cmocka_unit_test(bars_and_bands),
  };
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
