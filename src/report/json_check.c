/* Recursive descent. A function gets where a part begins and answers where it ends, or NULL with
 * `at` where it went wrong. The 0 behind the bytes stops every loop. */
#include "report/json.h"

#include <string.h>

typedef struct checker {
  const char *at; /* of the first thing that is wrong */
  int depth;
} checker;

static const char *value(checker *c, const char *p);

static const char *wrong(checker *c, const char *p) {
  c->at = p;
  return NULL;
}

static const char *space(const char *p) {
  return p + strspn(p, " \t\r\n");
}

static const char *string(checker *c, const char *p) {
  if (*p != '"') return wrong(c, p);
  for (p++; *p != '"'; p++) {
    if ((unsigned char)*p < 0x20) return wrong(c, p);
    if (*p != '\\') continue;
    p++;
    if (*p == 'u' && strspn(p + 1, "0123456789abcdefABCDEF") >= 4)
      p += 4;
    else if (!*p || !strchr("\"\\/bfnrt", *p))
      return wrong(c, p);
  }
  return p + 1;
}

static const char *digits(checker *c, const char *p) {
  size_t count = strspn(p, "0123456789");
  return count ? p + count : wrong(c, p);
}

static const char *number(checker *c, const char *p) {
  if (*p == '-') p++;
  p = *p == '0' ? p + 1 : digits(c, p);
  if (p && *p == '.') p = digits(c, p + 1);
  if (p && (*p == 'e' || *p == 'E')) p = digits(c, p + 1 + (p[1] == '+' || p[1] == '-'));
  return p;
}

/* Members of an object or elements of an array, from behind the bracket. */
static const char *members(checker *c, const char *p, char closing) {
  p = space(p);
  if (*p == closing) return p + 1;
  for (;;) {
    if (closing == '}') {
      p = string(c, space(p));
      if (!p) return NULL;
      p = space(p);
      if (*p++ != ':') return wrong(c, p - 1);
    }
    p = value(c, p);
    if (!p) return NULL;
    p = space(p);
    if (*p == closing) return p + 1;
    if (*p++ != ',') return wrong(c, p - 1);
  }
}

static const char *value(checker *c, const char *p) {
  static const char *const words[] = {"true", "false", "null"};
  p = space(p);
  if (*p == '{' || *p == '[') {
    if (++c->depth > SCREE_JSON_DEPTH) return wrong(c, p);
    p = members(c, p + 1, *p == '{' ? '}' : ']');
    c->depth--;
    return p;
  }
  if (*p == '"') return string(c, p);
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (!strncmp(p, words[i], strlen(words[i]))) return p + strlen(words[i]);
  return number(c, p);
}

scree_status scree_json_check(const char *bytes, size_t byte_count, const char *name,
                              scree_error *error) {
  checker c = {.at = bytes};
  const char *end = value(&c, bytes);
  if (end && space(end) == bytes + byte_count) return SCREE_OK;
  if (end) c.at = space(end);
  size_t line = 1, column = 1;
  for (const char *p = bytes; p < c.at; p++) {
    column = *p == '\n' ? 1 : column + 1;
    line += *p == '\n';
  }
  return scree_fail(error, SCREE_BAD_FILE, "%s: line %zu, column %zu: is no JSON", name, line,
                    column);
}
