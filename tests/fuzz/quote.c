/* Any text in every language that is written, read back: by our own readers of JSON, YAML and
 * tables; of the others by what may not stand in them. */
#include "base/quote.h"

#include "base/alloc.h"
#include "base/rows.h"
#include "base/yaml.h"
#include "fuzz/fuzz.h"
#include "report/json.h"

#include <string.h>

enum { MOST = 1000 };

static char text[MOST + 1], quoted[20 * MOST], row[20 * MOST + 16];

static void as(scree_quoting quoting) {
  scree_quote_text(quoting, text, quoted, sizeof quoted);
}

static void check_yaml(bool is_text) {
  scree_yaml root;
  scree_error error;
  int length = snprintf(row, sizeof row, "[%s]", quoted);
  FUZZ_CHECK(scree_yaml_parse(row, (size_t)length, "row", &root, &error) == SCREE_OK);
  FUZZ_CHECK(root.item_count == 1 && root.items[0].kind == SCREE_YAML_SCALAR);
  FUZZ_CHECK(!is_text || !strcmp(root.items[0].text, text));
  scree_yaml_free(&root);
}

/* Line ends within quotes are no matter of our reader. */
static void check_csv(bool is_text) {
  scree_text_rows rows;
  scree_error error;
  bool there;
  if (strpbrk(text, "\r\n")) return;
  int length = snprintf(row, sizeof row, "%s,1", quoted);
  FUZZ_CHECK(scree_rows_open(&rows, "row", row, (size_t)length, &error) == SCREE_OK);
  rows.separator = ',';
  FUZZ_CHECK(scree_rows_next(&rows, &there) == SCREE_OK && there && !rows.comment);
  FUZZ_CHECK(rows.count == 2);
  FUZZ_CHECK(!is_text || !strcmp(rows.cells[0], text));
}

/* Within single quotes but for what stands for one. */
static void check_single(const char *instead) {
  const char *p = quoted;
  if (*p != '\'') return;
  for (p++; *p; p++)
    if (*p == '\'') {
      if (!p[1]) return;
      FUZZ_CHECK(!strncmp(p, instead, strlen(instead)));
      p += strlen(instead) - 1;
    }
  FUZZ_CHECK(false);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  bool is_text = true;
  scree_error error;
  size_t length = size < MOST ? size : MOST;
  memcpy(text, data, length);
  text[length] = 0;
  for (const char *p = text; *p && is_text; p += scree_utf8_length(p))
    is_text = scree_utf8_length(p) > 0 && (unsigned char)*p >= 32 && *p != 127 &&
              (unsigned char)*p != 0xc2; /* nor C1 */
  for (int q = 0; q < SCREE_QUOTING_COUNT; q++) {
    as((scree_quoting)q);
    for (const char *p = quoted; *p && q != SCREE_QUOTE_SHELL; p += scree_utf8_length(p))
      FUZZ_CHECK(scree_utf8_length(p) > 0);
    if (q == SCREE_QUOTE_YAML || q == SCREE_QUOTE_JSON) check_yaml(is_text);
    if (q == SCREE_QUOTE_CSV) check_csv(is_text);
    if (q == SCREE_QUOTE_JSON)
      FUZZ_CHECK(scree_json_check(row, strlen(row), "row", &error) == SCREE_OK);
    if (q == SCREE_QUOTE_XML || q == SCREE_QUOTE_HTML) FUZZ_CHECK(!strpbrk(quoted, "<>\"'"));
    if (q == SCREE_QUOTE_SHELL) check_single("'\\''");
    if (q == SCREE_QUOTE_GNUPLOT) check_single("''");
    if (q == SCREE_QUOTE_COMMENT || q == SCREE_QUOTE_NAME) FUZZ_CHECK(!strpbrk(quoted, "\r\n\\"));
  }
  fuzz_taken += is_text && length > 0;
  return 0;
}
