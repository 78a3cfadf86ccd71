#include "report/plot.h"

#include <math.h>
#include <stdlib.h>

static const double TICK_SLACK = 1e-9; /* of the range: an end that is a tick is drawn */
enum { MAJOR_STEPS_WANTED = 6, LABELLED_DECADES = 8, LEAST_LABELS = 3 };

static void add(scree_ticks *ticks, double value) {
  if (ticks->count >= SCREE_TICK_LIMIT) return;
  ticks->value[ticks->count] = value;
  ticks->label[ticks->count][0] = 0;
  ticks->count++;
}

static void label_log(char *label, size_t size, int digit, int exponent) {
  if (exponent >= -1 && exponent <= 1)
    snprintf(label, size, "%g", digit * pow(10, exponent));
  else if (digit == 1)
    snprintf(label, size, "10^{%s%d}", exponent < 0 ? "\u2212" : "", abs(exponent));
  else
    snprintf(label, size, "%d\u00b710^{%s%d}", digit, exponent < 0 ? "\u2212" : "", abs(exponent));
}

static size_t make_log(double low, double high, scree_ticks *ticks) {
  size_t labels = 0;
  double decades = log10(high / low);
  int first = (int)floor(log10(low) - TICK_SLACK), last = (int)floor(log10(high) + TICK_SLACK);
  int step = 1 + (last - first) / LABELLED_DECADES;
  bool many_labels = decades < 2;
  bool minors = decades <= 12;
  for (int exponent = first; exponent <= last; exponent++)
    for (int digit = 1; digit <= (minors ? 9 : 1); digit++) {
      double value = digit * pow(10, exponent);
      if (value < low * (1 - TICK_SLACK) || value > high * (1 + TICK_SLACK)) continue;
      add(ticks, value);
      bool major = digit == 1 && exponent % step == 0;
      if (!major && !(many_labels && (digit == 2 || digit == 5))) continue;
      label_log(ticks->label[ticks->count - 1], sizeof ticks->label[0], digit, exponent);
      labels++;
    }
  return labels;
}

static void make_linear(double low, double high, scree_ticks *ticks) {
  double raw = (high - low) / MAJOR_STEPS_WANTED, power = pow(10, floor(log10(raw)));
  double ratio = raw / power, step = power * (ratio <= 1   ? 1
                                              : ratio <= 2 ? 2
                                              : ratio <= 5 ? 5
                                                           : 10);
  int parts = ratio > 1 && ratio <= 2 ? 4 : 5;
  double minor = step / parts, slack = TICK_SLACK * (high - low);
  long first = (long)ceil((low - slack) / minor), last = (long)floor((high + slack) / minor);
  for (long i = first; i <= last; i++) {
    add(ticks, (double)i * minor);
    if (i % parts) continue;
    double value = (double)i * minor;
    snprintf(ticks->label[ticks->count - 1], sizeof ticks->label[0], "%s%.6g",
             value < 0 ? "\u2212" : "", fabs(value));
  }
}

void scree_ticks_make(scree_scale scale, double low, double high, scree_ticks *ticks) {
  ticks->count = 0;
  if (!(low < high) || !isfinite(low) || !isfinite(high)) return;
  if (scale == SCREE_SCALE_LOG && low > 0) {
    /* within a decade 1, 2 and 5 are too few to read a value by: even steps, as on a linear axis */
    if (make_log(low, high, ticks) >= LEAST_LABELS || high > 10 * low) return;
    ticks->count = 0;
    make_linear(low, high, ticks);
  } else if (scale == SCREE_SCALE_LINEAR) {
    make_linear(low, high, ticks);
  }
}
