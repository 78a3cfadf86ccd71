/* What results say in words, and these as JSON. */
#include "report/json.h"
#include "report/program.h"

#include <math.h>

void scree_words_name(const char *name, char *to, size_t size) {
  snprintf(to, size, "%s", name);
  for (; *to; to++)
    if (*to == '_' || (*to == '.' && to[1] > '9')) *to = ' ';
}

int scree_words_decimals(double spread) {
  if (!(spread > 0) || !isfinite(spread)) return 3;
  return (int)fmax(0, fmin(9, 1 - floor(log10(spread))));
}

void scree_json_words(scree_json *json, const scree_words *w) {
  static const char *const names[] = {"answered", "not reached", "not enough"};
  SCREE_JSON_MEMBERS(json, AS("verdict", names[w->verdict]), OF(w, state),
                     AS("sentence", w->answer), OF(w, but), AS("next", *w->next ? w->next : NULL));
}
