#include "base/unit.h"

#include <stdlib.h>
#include <string.h>

enum { METRE, KILOGRAM, SECOND, RADIAN, DIMENSIONS };

/* Its size is over/under: a quotient of whole numbers rounds once, so that 10 mm are 0.01 m. */
typedef struct symbol {
  const char *name;
  double over, under;
  int powers[DIMENSIONS];
} symbol;

#define PI 3.14159265358979323846

static const symbol symbols[] = {
    {"1", 1, 1, {0}},
    {"%", 1, 100, {0}},
    {"m", 1, 1, {1}},
    {"km", 1e3, 1, {1}},
    {"cm", 1, 1e2, {1}},
    {"mm", 1, 1e3, {1}},
    {"um", 1, 1e6, {1}},
    {"\xc2\xb5m", 1, 1e6, {1}},
    {"nm", 1, 1e9, {1}},
    {"in", 254, 1e4, {1}},
    {"inch", 254, 1e4, {1}},
    {"ft", 3048, 1e4, {1}},
    {"l", 1, 1e3, {3}},
    {"kg", 1, 1, {0, 1}},
    {"g", 1, 1e3, {0, 1}},
    {"mg", 1, 1e6, {0, 1}},
    {"t", 1e3, 1, {0, 1}},
    {"lb", 45359237, 1e8, {0, 1}},
    {"s", 1, 1, {0, 0, 1}},
    {"ms", 1, 1e3, {0, 0, 1}},
    {"us", 1, 1e6, {0, 0, 1}},
    {"min", 60, 1, {0, 0, 1}},
    {"h", 3600, 1, {0, 0, 1}},
    {"d", 86400, 1, {0, 0, 1}},
    {"Hz", 1, 1, {0, 0, -1}},
    {"kHz", 1e3, 1, {0, 0, -1}},
    {"rad", 1, 1, {0, 0, 0, 1}},
    {"mrad", 1, 1e3, {0, 0, 0, 1}},
    {"deg", PI, 180, {0, 0, 0, 1}},
    {"\xc2\xb0", PI, 180, {0, 0, 0, 1}},
    {"rev", 2 * PI, 1, {0, 0, 0, 1}},
    {"rpm", 2 * PI, 60, {0, 0, -1, 1}},
    {"N", 1, 1, {1, 1, -2}},
    {"mN", 1, 1e3, {1, 1, -2}},
    {"kN", 1e3, 1, {1, 1, -2}},
    {"MN", 1e6, 1, {1, 1, -2}},
    {"Pa", 1, 1, {-1, 1, -2}},
    {"kPa", 1e3, 1, {-1, 1, -2}},
    {"MPa", 1e6, 1, {-1, 1, -2}},
    {"GPa", 1e9, 1, {-1, 1, -2}},
    {"bar", 1e5, 1, {-1, 1, -2}},
    {"J", 1, 1, {2, 1, -2}},
    {"uJ", 1, 1e6, {2, 1, -2}},
    {"mJ", 1, 1e3, {2, 1, -2}},
    {"kJ", 1e3, 1, {2, 1, -2}},
    {"MJ", 1e6, 1, {2, 1, -2}},
    {"W", 1, 1, {2, 1, -3}},
    {"mW", 1, 1e3, {2, 1, -3}},
    {"kW", 1e3, 1, {2, 1, -3}},
};

static const symbol *find(const char *name, size_t length) {
  for (size_t i = 0; i < sizeof symbols / sizeof *symbols; i++)
    if (strlen(symbols[i].name) == length && !strncmp(symbols[i].name, name, length))
      return &symbols[i];
  return NULL;
}

/* `3`, `^3`, `-1`, `^-1` behind a symbol; 1 where there is none. */
static int read_power(const char **at) {
  const char *digits = *at + (**at == '^');
  char *end;
  long power = strtol(digits, &end, 10);
  if (end == digits || *digits == ' ' || *digits == '+') return 1;
  *at = end;
  return power > 9 || power < -9 ? 0 : (int)power;
}

/* One factor, to that power. */
static bool multiply(symbol *unit, const symbol *s, int power) {
  if (power == 0) return false;
  for (int i = 0; i < abs(power); i++) {
    unit->over *= power > 0 ? s->over : s->under;
    unit->under *= power > 0 ? s->under : s->over;
  }
  for (int k = 0; k < DIMENSIONS; k++) unit->powers[k] += power * s->powers[k];
  return true;
}

static bool parse(const char *text, symbol *unit) {
  static const char ends[] = "0123456789^-*/ ";
  *unit = (symbol){text, 1, 1, {0}};
  bool below = false;
  for (const char *at = text + strspn(text, " "); *at;) {
    size_t length = *at == '1' ? 1 : strcspn(at, ends);
    const symbol *s = find(at, length);
    if (!s) return false;
    at += length;
    int power = *s->name == '1' ? 1 : read_power(&at);
    if (!multiply(unit, s, below ? -power : power)) return false;
    at += strspn(at, " ");
    below = *at == '/';
    if (*at != '/' && *at != '*') continue;
    at += 1 + strspn(at + 1, " ");
    if (!*at) return false;
  }
  return true;
}

scree_unit_answer scree_unit_convert(const char *unit, const char *wanted, double *value) {
  symbol from, to;
  if (!strcmp(unit, wanted)) return SCREE_UNIT_FITS;
  if (!*unit || !parse(unit, &from)) return SCREE_UNIT_UNKNOWN;
  if (!parse(wanted, &to) || memcmp(from.powers, to.powers, sizeof to.powers) != 0)
    return SCREE_UNIT_DIFFERS;
  *value = *value * (from.over * to.under) / (from.under * to.over);
  return SCREE_UNIT_FITS;
}
