#include "cli/grid.h"

#include <string.h>

/* "1e-5:1e-1:9" as three numbers. */
static bool split(const char *text, double numbers[3]) {
  for (int i = 0; i < 3; i++) {
    char part[32];
    size_t length = strcspn(text, ":");
    if (length == 0 || length >= sizeof part) return false;
    memcpy(part, text, length);
    part[length] = 0;
    text += length;
    if (*text != (i < 2 ? ':' : 0)) return false;
    text += i < 2;
    if (!(i < 2 ? cli_fraction_from_text : cli_real_from_text)(part, &numbers[i])) return false;
  }
  return true;
}

scree_status cli_parse_grid(const cli_verb *verb, const char *text, cli_grid *grid) {
  double n[3];
  if (!split(text, n) || !(n[0] >= 1e-12 && n[0] <= n[1] && n[1] <= 1) ||
      !(n[2] >= 1 && n[2] <= 1000) || n[2] != (double)(int)n[2])
    return cli_misuse(
        verb,
        "--grid '%s': must be MIN:MAX:N with 1e-12 <= MIN <= MAX <= 1 and a whole N from 1 to 1000",
        text);
  *grid = (cli_grid){n[0], n[1], (int)n[2]};
  return SCREE_OK;
}
