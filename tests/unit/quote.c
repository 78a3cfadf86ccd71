/* Every row of the table of quoting, with every byte, read back by what it is written for: a shell,
 * libyaml, expat, and readers of the other languages by their rules. */
#include "base/quote.h"

#include "base/alloc.h"
#include "base/rng.h"
#include "base/yaml.h"
#include "report/json.h"
#include "report/plot.h"
#include "support/check.h"
#include "support/folder.h"

#include <ctype.h>
#include <expat.h>

enum { MOST = 400, TEXTS = 1200 };

/* ---- texts: every byte alone, within, at both ends, twice; words of the languages; at random ----
 */

static char texts[TEXTS][MOST];
static size_t text_count;

static void add_text(const char *text) {
  assert_true(text_count < TEXTS);
  snprintf(texts[text_count++], MOST, "%s", text);
}

static void make_texts(void) {
  static const char *const words[] = {"",
                                      "plain",
                                      "true",
                                      "True",
                                      "NO",
                                      "null",
                                      "~",
                                      "1",
                                      "-1.5e3",
                                      "0x1f",
                                      "1_000",
                                      "12:30",
                                      ".5",
                                      ".inf",
                                      "-",
                                      "--",
                                      "-o",
                                      "- a",
                                      "a: b",
                                      "a #b",
                                      "#a",
                                      " a",
                                      "a ",
                                      "\ta",
                                      "=1+1",
                                      "@a",
                                      "%a",
                                      "*a",
                                      "&a",
                                      "!a",
                                      "a\r\nb",
                                      "a'b\"c`d",
                                      "$(touch PWNED)",
                                      "`touch PWNED`.stl",
                                      "<touch PWNED",
                                      "'; touch PWNED; '",
                                      "\"; system(\"touch PWNED\"); \"",
                                      "_{a}",
                                      "a^{b",
                                      "{/Symbol a}",
                                      "a\\",
                                      "\\n",
                                      "]]>",
                                      "<!--",
                                      "-->",
                                      "</script>",
                                      "&amp;",
                                      "\xc3\xa9",
                                      "\xe2\x80\xa8x",
                                      "\xef\xbb\xbfx",
                                      "\xf0\x9f\xaa\xa8",
                                      "\xc2\x85",
                                      "\xc3",
                                      "\xed\xa0\x80",
                                      "\xef\xbf\xbe"};
  scree_rng rng = {69, 1, 0};
  text_count = 0;
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) add_text(words[i]);
  for (int b = 1; b < 256; b++) {
    char c = (char)b;
    const char shapes[][6] = {{c}, {'a', c, 'b'}, {c, 'a', c}, {c, c}};
    for (int k = 0; k < 4; k++) add_text(shapes[k]);
  }
  for (int i = 0; i < 100; i++) {
    char text[41] = {0};
    for (int k = 0; k < 40; k++) text[k] = (char)(1 + scree_rng_below(&rng, 255));
    add_text(text);
  }
}

static bool is_control(const char *c, size_t length) {
  unsigned char first = (unsigned char)c[0], second = (unsigned char)c[1];
  return length == 1 ? first < 32 || first == 127 : length == 2 && first == 0xc2 && second < 0xa0;
}

/* What must come back: bytes that are no UTF-8 are U+FFFD, controls that a language has no way to
 * say are `instead` (NULL: it has one). */
static const char *expected(const char *text, const char *instead, const char *kept) {
  static char made[8 * MOST];
  char *at = made;
  while (*text) {
    size_t length = scree_utf8_length(text);
    const char *put = length ? text : "\xef\xbf\xbd";
    size_t count = length ? length : 3;
    if (instead && length && is_control(text, length) && !(length == 1 && strchr(kept, *text)))
      put = instead, count = strlen(instead);
    memcpy(at, put, count);
    at += count;
    text += length ? length : 1;
  }
  *at = 0;
  return made;
}

static const char *quoted(scree_quoting quoting, const char *text) {
  static char made[16 * MOST];
  return scree_quote_text(quoting, text, made, sizeof made);
}

/* ---- readers ---- */

/* JSON is YAML: libyaml reads its escapes; and it is JSON by our own walker. */
static void reads_json(void **state) {
  (void)state;
  scree_error error;
  for (size_t i = 0; i < text_count; i++) {
    char row[16 * MOST + 8];
    scree_yaml root;
    snprintf(row, sizeof row, "[%s]", quoted(SCREE_QUOTE_JSON, texts[i]));
    CHECK_OK(scree_json_check(row, strlen(row), "row", &error), error);
    assert_null(strpbrk(row, "<>&"));
    CHECK_OK(scree_yaml_parse(row, strlen(row), "row", &root, &error), error);
    assert_string_equal(root.items[0].text, expected(texts[i], NULL, ""));
    scree_yaml_free(&root);
  }
}

static void reads_yaml(void **state) {
  (void)state;
  scree_error error;
  static const char *const forms[] = {"k: %s\n", "%s: k\n", "[%s, a]\n", "{a: %s}\n", "- %s\n"};
  for (size_t i = 0; i < text_count; i++)
    for (int f = 0; f < 5; f++) {
      char row[16 * MOST + 8];
      scree_yaml root;
      if (f == 1 && strlen(texts[i]) > 100) continue; /* a key's length is limited */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
      snprintf(row, sizeof row, forms[f], quoted(SCREE_QUOTE_YAML, texts[i]));
#pragma GCC diagnostic pop
      CHECK_OK(scree_yaml_parse(row, strlen(row), "row", &root, &error), error);
      assert_string_equal(f == 1 ? root.items[0].key : root.items[0].text,
                          expected(texts[i], NULL, ""));
      scree_yaml_free(&root);
    }
  /* no other reader takes a bare text for a number, a truth value or nothing */
  static const char *const bare[] = {"plain", "a-b_c.stl", "./x.stl", "/abs", "Yesterday"};
  static const char *const words[] = {"true", "False", "YES", "null", "1",     "1e5", "0x1",
                                      "",     ".inf",  "-a",  "~",    "12:30", ".5",  "2020-01-01"};
  for (size_t i = 0; i < sizeof bare / sizeof *bare; i++)
    assert_string_equal(quoted(SCREE_QUOTE_YAML, bare[i]), bare[i]);
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    assert_int_equal(*quoted(SCREE_QUOTE_YAML, words[i]), '"');
}

/* RFC 4180. */
static const char *read_csv(const char *p, char *field) {
  if (*p != '"') {
    while (*p != ',') *field++ = *p++;
  } else {
    for (p++; *p != '"' || p[1] == '"'; p++) {
      assert_true(*p != 0);
      if (*p == '"') p++;
      *field++ = *p;
    }
    p++;
  }
  *field = 0;
  assert_int_equal(*p, ',');
  return p + 1;
}

static void reads_csv(void **state) {
  (void)state;
  for (size_t i = 0; i < text_count; i++) {
    char row[16 * MOST + 8], field[16 * MOST];
    snprintf(row, sizeof row, "%s,end", quoted(SCREE_QUOTE_CSV, texts[i]));
    assert_string_equal(read_csv(row, field), "end");
    assert_string_equal(field, expected(texts[i], NULL, ""));
  }
}

typedef struct seen {
  char text[8 * MOST], attribute[8 * MOST];
} seen;

static void take_start(void *context, const char *name, const char **attributes) {
  (void)name;
  snprintf(((seen *)context)->attribute, sizeof((seen *)0)->attribute, "%s", attributes[1]);
}
static void take_text(void *context, const char *text, int length) {
  strncat(((seen *)context)->text, text, (size_t)length);
}

static void expect_xml(scree_quoting quoting, const char *text) {
  char row[32 * MOST];
  seen s = {.text = ""};
  const char *piece = quoted(quoting, text);
  snprintf(row, sizeof row, "<a b=\"%s\">%s</a>", piece, piece);
  XML_Parser parser = XML_ParserCreate("UTF-8");
  XML_SetUserData(parser, &s);
  XML_SetElementHandler(parser, take_start, NULL);
  XML_SetCharacterDataHandler(parser, take_text);
  if (XML_Parse(parser, row, (int)strlen(row), 1) != XML_STATUS_OK)
    fail_msg("%s: %s", row, XML_ErrorString(XML_GetErrorCode(parser)));
  XML_ParserFree(parser);
  bool is_xml = quoting == SCREE_QUOTE_XML;
  char wanted[8 * MOST];
  snprintf(wanted, sizeof wanted, "%s", expected(text, "\xef\xbf\xbd", is_xml ? "\n\r\t" : "\n\t"));
  for (char *bad; (bad = strstr(wanted, "\xef\xbf\xbe")) || (bad = strstr(wanted, "\xef\xbf\xbf"));)
    bad[2] = '\xbd';
  assert_string_equal(s.text, wanted);
  if (is_xml) assert_string_equal(s.attribute, wanted);
}

/* HTML's rules for these characters are XML's, but for the blanks of an attribute. */
static void reads_xml(void **state) {
  (void)state;
  for (size_t i = 0; i < text_count; i++) {
    expect_xml(SCREE_QUOTE_XML, texts[i]);
    expect_xml(SCREE_QUOTE_HTML, texts[i]);
    assert_null(strpbrk(quoted(SCREE_QUOTE_HTML, texts[i]), "<>\"'"));
  }
}

/* A real shell prints them all, with a NUL behind each. */
static void reads_shell(void **state) {
  (void)state;
  static char read[TEXTS * MOST];
  char command[1000];
  FILE *script = fopen(in_folder("words.sh"), "wb");
  assert_non_null(script);
  for (size_t i = 0; i < text_count; i++) {
    fputs("printf '%s\\0' ", script);
    scree_quote(script, SCREE_QUOTE_SHELL, texts[i]);
    putc('\n', script);
  }
  fclose(script);
  snprintf(command, sizeof command, "cd %s && sh words.sh", in_folder("."));
  FILE *pipe = popen(command, "r");
  assert_non_null(pipe);
  size_t count = fread(read, 1, sizeof read - 1, pipe);
  assert_int_equal(pclose(pipe), 0);
  const char *p = read;
  for (size_t i = 0; i < text_count; i++, p += strlen(p) + 1) assert_string_equal(p, texts[i]);
  assert_ptr_equal(p, read + count);
}

/* gnuplot: within single quotes only '' means something; enhanced text's signs behind a backslash
 * are themselves. */
static const char *read_gnuplot(const char *p, bool is_label, char *text) {
  assert_int_equal(*p++, '\'');
  for (; *p != '\'' || p[1] == '\''; p++) {
    assert_true((unsigned char)*p >= 32);
    if (*p == '\'') p++;
    if (is_label && *p == '\\') p++;
    *text++ = *p;
  }
  *text = 0;
  return p + 1;
}

static void reads_gnuplot(void **state) {
  (void)state;
  for (size_t i = 0; i < text_count; i++) {
    char row[16 * MOST + 8], text[16 * MOST];
    assert_string_equal(read_gnuplot(quoted(SCREE_QUOTE_GNUPLOT, texts[i]), false, text), "");
    assert_string_equal(text, expected(texts[i], " ", ""));
    snprintf(row, sizeof row, "'%s'", quoted(SCREE_QUOTE_GNUPLOT_LABEL, texts[i]));
    assert_string_equal(read_gnuplot(row, true, text), "");
    assert_string_equal(text, expected(texts[i], " ", ""));
    for (const char *c = row; *c; c++)
      if (strchr("_^@&~{}", *c)) assert_int_equal(c[-1], '\\');
  }
}

static void one_line_of_comment(void **state) {
  (void)state;
  for (size_t i = 0; i < text_count; i++) {
    const char *comment = quoted(SCREE_QUOTE_COMMENT, texts[i]);
    for (const char *c = comment; *c; c++) {
      assert_true(scree_utf8_length(c) > 0 || ((unsigned char)*c & 0xc0) == 0x80);
      assert_true((unsigned char)*c >= 32 && *c != 127 && *c != '\\');
    }
    const char *name = quoted(SCREE_QUOTE_NAME, texts[i]);
    for (const char *c = name; *c; c++)
      assert_true(*c == '_' || *c == '-' || *c == '.' || (*c < 127 && isalnum((unsigned char)*c)));
  }
}

/* Cut where there is no room, but whole characters between whole quotes. */
static void is_cut_whole(void **state) {
  (void)state;
  char small[12], whole[16 * MOST];
  for (int q = 0; q < SCREE_QUOTING_COUNT; q++)
    for (size_t i = 0; i < text_count; i++) {
      if (i % 40 == 0) {
        FILE *stream = fopen(in_folder("one"), "wb+");
        assert_non_null(stream);
        scree_quote(stream, (scree_quoting)q, texts[i]);
        rewind(stream);
        size_t count = fread(whole, 1, sizeof whole - 1, stream);
        whole[count] = 0;
        assert_string_equal(whole, quoted((scree_quoting)q, texts[i]));
        char *own = scree_quoted((scree_quoting)q, texts[i]);
        assert_string_equal(own, whole);
        scree_free(own);
        fclose(stream);
      }
      scree_quote_text((scree_quoting)q, texts[i], small, sizeof small);
      assert_true(strlen(small) < sizeof small);
      for (const char *c = small; q != SCREE_QUOTE_SHELL && *c; c += scree_utf8_length(c))
        assert_true(scree_utf8_length(c) > 0);
    }
}

/* A figure whose every text is hostile: gnuplot sees strings in single quotes and nothing that it
 * runs, wherever the figure lies. */
static void figure_runs_nothing(void **state) {
  (void)state;
  scree_error error;
  double x[] = {1, 2}, y[] = {1, 2};
  for (size_t i = 0; i < text_count; i += 7) {
    const char *text = texts[i];
    scree_series series = {.label = text, .x = x, .y = y, .count = 2, .draw = SCREE_DRAW_LINE};
    scree_panel panel = {
        .title = text, .x.label = text, .y.label = text, .series = &series, .series_count = 1};
    scree_figure figure = {.panels = &panel, .panel_count = 1, .note = text};
    CHECK_OK(scree_figure_write(&figure, in_folder("<touch `PWNED`.gnuplot"), true, &error), error);
    FILE *stream = fopen(in_folder("<touch `PWNED`.gnuplot"), "rb");
    char line[16 * MOST];
    bool has_data = false;
    assert_non_null(stream);
    while (fgets(line, sizeof line, stream)) {
      if (*line == '#') continue;
      has_data = has_data || strstr(line, "'./<touch `PWNED`.csv'");
      for (const char *c = line; *c; c++) { /* outside of strings nothing but our own words */
        if (*c == '\'') {
          char string[16 * MOST];
          c = read_gnuplot(c, false, string) - 1;
        } else {
          assert_true(*c != '`' && (*c != '"' || !strncmp(c, "\"10^{%L}\"", 9) || c[-1] == '}'));
        }
      }
    }
    fclose(stream);
    assert_true(has_data);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(reads_json),          cmocka_unit_test(reads_yaml),
      cmocka_unit_test(reads_csv),           cmocka_unit_test(reads_xml),
      cmocka_unit_test(reads_shell),         cmocka_unit_test(reads_gnuplot),
      cmocka_unit_test(one_line_of_comment), cmocka_unit_test(is_cut_whole),
      cmocka_unit_test(figure_runs_nothing)};
  make_texts();
  return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
