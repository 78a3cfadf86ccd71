#include "base/error.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const char *scree_version(void) {
  return SCREE_VERSION;
}

const char *scree_status_text(scree_status status) {
  static const char *const texts[] = {
#define STATUS_TEXT(name, text) text,
      SCREE_STATUS_LIST(STATUS_TEXT)
#undef STATUS_TEXT
  };
  return (unsigned)status < SCREE_STATUS_COUNT ? texts[status] : "unknown status";
}

void scree_make_printable(char *text, char instead) {
  for (char *c = text; *c; c++) {
    unsigned char first = (unsigned char)c[0], second = (unsigned char)c[1];
    if (first < ' ' || first == 127)
      c[0] = instead;
    else if (first == 0xc2 && second >= 0x80 && second < 0xa0) /* U+0080 to U+009F */
      c[0] = c[1] = instead;
  }
}

void scree_add_text(char *text, size_t size, const char *format, ...) {
  size_t used = strlen(text);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text + used, size - used, format, arguments);
  va_end(arguments);
}

scree_status scree_fail_text(scree_error *error, scree_status status, const char *format, ...) {
  if (error) {
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    /* names and values from files come in as they are: one line, nothing a terminal obeys */
    scree_make_printable(error->message, '?');
  }
  return status;
}

#ifdef SCREE_ASSERTIONS
void scree_assert_failed(const char *condition, const char *file, int line) {
  fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  abort();
}
#endif
