/* Text is cut into runs at the marks _{ and ^{ and }. Marks do not nest. */
#include "report/plot.h"

#include "base/quote.h"

#include <stdbool.h>
#include <string.h>

/* Appends one character of text to out (of size bytes, used of them taken) where it fits whole, and
 * moves text behind it. A control character has no glyph: a space stands for it; a byte that is no
 * UTF-8 becomes U+FFFD. Returns false where it does not fit. */
static bool put(char *out, size_t *used, size_t size, const char **text) {
  size_t length = scree_utf8_length(*text), step = length ? length : 1;
  const char *from = length ? *text : "\ufffd";
  if (length == 0) length = strlen(from);
  if (length == 1 && (unsigned char)*from < 0x20) from = " ";
  if (*used + length >= size) return false;
  memcpy(out + *used, from, length);
  *used += length;
  *text += step;
  return true;
}

static bool at_mark(const char *text) {
  return (*text == '_' || *text == '^') && text[1] == '{' && strchr(text, '}');
}

const char *scree_text_run_next(const char *text, scree_text_run *r) {
  size_t used = 0;
  r->kind = 0;
  if (at_mark(text)) {
    r->kind = *text;
    text += 2;
  }
  while (*text) {
    if (r->kind && *text == '}') {
      text++;
      break;
    }
    if (!r->kind && at_mark(text)) break;
    if (!put(r->text, &used, SCREE_RUN_BYTES, &text)) break; /* the rest comes in the next run */
  }
  r->text[used] = 0;
  return text;
}

void scree_text_plain(const char *text, char *buffer, size_t size) {
  size_t used = 0;
  scree_text_run r;
  while (*text) {
    text = scree_text_run_next(text, &r);
    if (r.kind && used + 1 < size) buffer[used++] = r.kind;
    const char *c = r.text;
    while (*c && put(buffer, &used, size, &c)) continue;
  }
  buffer[used] = 0;
}
