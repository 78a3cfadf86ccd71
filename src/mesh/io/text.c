#include "mesh/io/text.h"

#include "base/number.h"
#include "mesh/weld.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
static bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}
static bool is_space(char c) {
  return is_blank(c) || is_line_end(c);
}

void scree_text_skip_space(scree_text *t) {
  while (t->p < t->end && is_space(*t->p)) t->p++;
}

void scree_text_skip_blanks(scree_text *t) {
  while (t->p < t->end && is_blank(*t->p)) t->p++;
}

bool scree_text_at_line_end(const scree_text *t) {
  return t->p == t->end || is_line_end(*t->p);
}

void scree_text_skip_line(scree_text *t) {
  while (!scree_text_at_line_end(t)) t->p++;
  if (t->p < t->end && *t->p++ == '\r' && t->p < t->end && *t->p == '\n') t->p++;
}

scree_token scree_text_next(scree_text *t) {
  scree_text_skip_space(t);
  const char *begin = t->p;
  while (t->p < t->end && !is_space(*t->p)) t->p++;
  return (scree_token){begin, (size_t)(t->p - begin)};
}

bool scree_token_is(scree_token token, const char *word) {
  size_t i = 0;
  for (; i < token.length && word[i]; i++) {
    char c = token.begin[i];
    if (c >= 'A' && c <= 'Z') c = (char)(c + 'a' - 'A');
    if (c != word[i]) return false;
  }
  return i == token.length && !word[i];
}

/* Parses a number that white space, a line end or the end of the file must follow. */
static const char *whole_number(const scree_text *t, double *value) {
  const char *behind = scree_number_parse(t->p, t->end, value);
  return behind && (behind == t->end || is_space(*behind)) ? behind : NULL;
}

scree_status scree_text_number(scree_text *t, const char *what, double *value) {
  char quote[SCREE_QUOTE_SIZE];
  scree_text_skip_space(t);
  const char *behind = whole_number(t, value);
  if (!behind)
    return scree_text_fail(t, t->p, "%s should be a finite number, found %s", what,
                           scree_text_quote(t, t->p, quote));
  t->p = behind;
  return SCREE_OK;
}

scree_status scree_text_integer(scree_text *t, const char *what, int64_t low, int64_t high,
                                int64_t *value) {
  char quote[SCREE_QUOTE_SIZE];
  double number;
  scree_text_skip_space(t);
  const char *behind = whole_number(t, &number);
  if (!behind || number != floor(number) || number < (double)low || number > (double)high)
    return scree_text_fail(t, t->p, "%s should be a whole number from %lld to %lld, found %s", what,
                           (long long)low, (long long)high, scree_text_quote(t, t->p, quote));
  *value = (int64_t)number;
  t->p = behind;
  return SCREE_OK;
}

scree_status scree_text_coordinate(scree_text *t, int axis, double *value) {
  static const char *const axes[] = {"x", "y", "z"};
  char quote[SCREE_QUOTE_SIZE];
  scree_text_skip_space(t);
  const char *behind = whole_number(t, value);
  if (!behind || !(fabs(*value * t->unit_m) <= SCREE_COORDINATE_LIMIT))
    return scree_text_fail(t, t->p,
                           "%s is %s; coordinates must be finite numbers, at most %g m in size",
                           axes[axis], scree_text_quote(t, t->p, quote), SCREE_COORDINATE_LIMIT);
  t->p = behind;
  return SCREE_OK;
}

scree_status scree_text_position(scree_text *t, double position[3]) {
  for (int i = 0; i < 3; i++) SCREE_TRY(scree_text_coordinate(t, i, &position[i]));
  return SCREE_OK;
}

static size_t line_of(const scree_text *t, const char *at) {
  size_t line = 1;
  for (const char *p = t->begin; p < at; p++)
    line += *p == '\n' || (*p == '\r' && !(p + 1 < t->end && p[1] == '\n'));
  return line;
}

scree_status scree_text_fail(const scree_text *t, const char *at, const char *format, ...) {
  char sentence[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  return scree_fail(t->error, SCREE_BAD_FILE, "%s: line %zu: %s", t->name, line_of(t, at),
                    sentence);
}

const char *scree_text_quote(const scree_text *t, const char *at, char quote[SCREE_QUOTE_SIZE]) {
  if (at >= t->end) return "the end of the file";
  size_t n = 0;
  quote[n++] = '\'';
  for (; at < t->end && !is_space(*at); at++) {
    if (n + 6 > SCREE_QUOTE_SIZE) {
      memcpy(quote + n, "...", 3);
      n += 3;
      break;
    }
    quote[n++] = *at >= ' ' && *at <= '~' ? *at : '?';
  }
  quote[n++] = '\'';
  quote[n] = 0;
  return quote;
}
