/* Units behind numbers: `10 mm`, `60 rpm`, `0.2 t/h`. */
#pragma once

#include <stdbool.h>

typedef enum scree_unit_answer {
  SCREE_UNIT_FITS,
  SCREE_UNIT_UNKNOWN, /* no unit of ours */
  SCREE_UNIT_DIFFERS, /* of another dimension */
} scree_unit_answer;

/* A unit is factors with whole powers, as in `kg/m3`, `m/s^2`, `N m`, `1/min`: m, s, kg, N, Pa, J,
 * W, Hz, l, rad, deg, rpm and %, with the usual multiples. Turns the value in `unit` into one in
 * `wanted`, a unit too ("": a pure number). Angles are a dimension: 60 rpm are 6.28 rad/s, and no
 * rate in Hz or 1/s. */
scree_unit_answer scree_unit_convert(const char *unit, const char *wanted, double *value);
