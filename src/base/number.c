/* Decimal to binary: at most 2^53 and a power of ten up to 10^22 are one exact product or quotient
 * (Clinger 1990, "How to read floating point numbers accurately"), as most numbers of files are.
 * All others go to strtod as a whole number and an exponent, in which no locale has a say. */
#include "base/number.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  W_DIGITS = 19,      /* that always fit 64 bits */
  EXACT_DIGITS = 800, /* more than the 767 that can decide a double */
  EXPONENT_LIMIT = 1 << 24,
};

static bool is_digit(char c) {
  return (unsigned char)(c - '0') < 10;
}

/* The digits from first to end, perhaps with a point between, as a whole number, times 10^scale.
 * What follows the digits that can decide is one more, which says that there is something. */
static double round_by_library(const char *first, const char *end, int64_t scale) {
  char text[EXACT_DIGITS + 32];
  int used = 0;
  bool more = false;
  for (const char *p = first; p < end; p++) {
    if (*p == '.' || (used == 0 && *p == '0')) continue;
    if (used < EXACT_DIGITS) {
      text[used++] = *p;
    } else {
      more = more || *p != '0';
      scale++;
    }
  }
  if (more) {
    text[used++] = '1';
    scale--;
  }
  snprintf(text + used, 32, "e%lld", (long long)scale);
  return strtod(text, NULL);
}

/* The nearest number to w 10^power, where the digits are few. */
static bool round_exactly(uint64_t w, int64_t power, double *value) {
  static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  if (w > (uint64_t)1 << 53 || (w > 0 && (power < -22 || power > 22))) return false;
  *value = w == 0 ? 0 : power < 0 ? (double)w / tens[-power] : (double)w * tens[power];
  return true;
}

/* ---- reading ---- */

/* The exponent behind a number at p, if a whole one stands there; answers the first byte behind. */
static const char *read_exponent(const char *p, const char *end, int64_t *exponent) {
  *exponent = 0;
  if (p == end || ((*p | 0x20) != 'e' && (*p | 0x20) != 'd')) return p;
  const char *q = p + 1;
  bool negative = q < end && *q == '-';
  if (q < end && (*q == '-' || *q == '+')) q++;
  if (q == end || !is_digit(*q)) return p;
  int64_t value = 0;
  for (; q < end && is_digit(*q); q++)
    if (value < EXPONENT_LIMIT) value = value * 10 + (*q - '0');
  *exponent = negative ? -value : value;
  return q;
}

const char *scree_number_parse(const char *begin, const char *end, double *value) {
  const char *p = begin;
  bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) p++;
  const char *start = p, *point = NULL;
  uint64_t w = 0; /* wraps beyond 19 digits, and is not used then */
  for (; p < end && is_digit(*p); p++) w = w * 10 + (uint64_t)(*p - '0');
  if (p < end && *p == '.') {
    point = p++;
    for (; p < end && is_digit(*p); p++) w = w * 10 + (uint64_t)(*p - '0');
  }
  int64_t digit_count = p - start - (point != NULL), exponent;
  if (digit_count == 0) return NULL;
  const char *behind = read_exponent(p, end, &exponent);
  int64_t scale = exponent - (point ? p - point - 1 : 0);
  double magnitude;
  if (digit_count > W_DIGITS || !round_exactly(w, scale, &magnitude))
    magnitude = round_by_library(start, p, scale);
  *value = negative ? -magnitude : magnitude;
  return behind;
}

bool scree_number_read(const char *text, double *value) {
  const char *end = text + strlen(text);
  double read;
  if (scree_number_parse(text, end, &read) != end || !isfinite(read)) return false;
  *value = read;
  return true;
}

/* ---- writing ---- */

/* printf's text with a decimal point for whatever the locale put there. */
static size_t make_neutral(char *text) {
  static const char plain[] = "0123456789+-e";
  size_t length = 0;
  bool replaced = false;
  for (const char *p = text; *p; p++) {
    if (strchr(plain, *p))
      text[length++] = *p;
    else if (!replaced) {
      text[length++] = '.';
      replaced = true;
    }
  }
  text[length] = 0;
  return length;
}

size_t scree_number_format_digits(double value, int digits, char text[SCREE_NUMBER_SIZE]) {
  snprintf(text, SCREE_NUMBER_SIZE, "%.*g", digits, value);
  return make_neutral(text);
}

size_t scree_number_format(double value, char text[SCREE_NUMBER_SIZE]) {
  size_t length = 0;
  for (int digits = 15; digits <= 17; digits++) {
    length = scree_number_format_digits(value, digits, text);
    double back = 0;
    scree_number_parse(text, text + length, &back);
    if (back == value) break;
  }
  return length;
}

size_t scree_number_format_float(float value, char text[SCREE_NUMBER_SIZE]) {
  size_t length = 0;
  for (int digits = 6; digits <= 9; digits++) {
    length = scree_number_format_digits((double)value, digits, text);
    double back = 0;
    scree_number_parse(text, text + length, &back);
    if ((float)back == value) break;
  }
  return length;
}

/* What printf wrote, with a point whatever the locale. */
static const char *with_point(char *text) {
  char *comma = strchr(text, ',');
  if (comma) *comma = '.';
  return text;
}

const char *scree_rp_text(double rp, char text[SCREE_NUMBER_SIZE]) {
  int exponent = (int)floor(log10(rp) + 1e-9);
  double digits = rp / pow(10, exponent);
  if (digits >= 9.95) {
    digits /= 10;
    exponent++;
  }
  if (exponent >= -1)
    snprintf(text, SCREE_NUMBER_SIZE, "%.2f", rp);
  else
    snprintf(text, SCREE_NUMBER_SIZE, "%.1fe%d", digits, exponent);
  return with_point(text);
}

const char *scree_percent_text(double share, char text[SCREE_NUMBER_SIZE]) {
  double percent = 100 * share;
  int decimals = percent < 0.095 ? 3 : percent < 9.95 ? 2 : 0;
  snprintf(text, SCREE_NUMBER_SIZE, "%.*f%%", decimals, percent);
  return with_point(text);
}

const char *scree_count_text(size_t count, char text[SCREE_NUMBER_SIZE]) {
  char digits[SCREE_NUMBER_SIZE];
  int length = snprintf(digits, sizeof digits, "%zu", count), used = 0;
  for (int i = 0; i < length; i++) {
    if (i > 0 && (length - i) % 3 == 0) text[used++] = ',';
    text[used++] = digits[i];
  }
  text[used] = 0;
  return text;
}

const char *scree_seconds_text(double seconds, char text[SCREE_NUMBER_SIZE]) {
  double minutes = seconds / 60;
  if (minutes < 1.5)
    snprintf(text, SCREE_NUMBER_SIZE, "%.0f s", fmax(1, seconds));
  else if (minutes < 90)
    snprintf(text, SCREE_NUMBER_SIZE, "%.0f minutes", minutes);
  else
    snprintf(text, SCREE_NUMBER_SIZE, "%.3g hours", minutes / 60);
  return text;
}
