/* Decimal to binary in three steps, each only where the one before cannot decide:
 *
 * 1. At most 2^53 and a power of ten up to 10^22: one exact product or quotient (Clinger 1990, "How
 *    to read floating point numbers accurately").
 * 2. The first 19 digits w times a 128-bit power of five 5^q = 5^(28k) 5^r, the first factor from a
 *    table, the second exact. All cuts go down, so the true value lies in [m, m + slack) with m the
 *    top 128 bits: the rounding is certain unless half a unit lies inside (the idea of Lemire 2021,
 *    "Number parsing at a gigabyte per second", with a table of 25 rows instead of 650).
 * 3. Whole numbers compared: all digits (the first 800 and whether more follow) against the middle
 *    between the two candidates. */
#include "base/number.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

__extension__ typedef unsigned __int128 uint128;

enum {
  TABLE_STEP = 28,       /* 5^27 is the largest power of five below 2^63 */
  TABLE_FIRST = -13,     /* times TABLE_STEP: 5^-364 */
  W_DIGITS = 19,         /* digits that always fit 64 bits */
  EXACT_DIGITS = 800,    /* more than the 767 that can decide a double */
  SMALLEST_POWER = -345, /* below: 10^19 10^q < 2^-1075, rounds to 0 */
  LARGEST_POWER = 308,
  EXPONENT_LIMIT = 1 << 24,
};

/* 5^(28 k) = (high 2^64 + low) 2^exponent, cut to 128 bits, for k = TABLE_FIRST ... 11. */
static const struct {
  uint64_t high, low;
  int exponent;
} power_table[] = {
    {0xe1afa13afbd14d6d, 0x82189c09a3a1ec21, -973}, {0xe3e27a444d8d98b7, 0xfd1b1b2308169b25, -908},
    {0xe61acf033d1a45df, 0x6fb92487298e33bd, -843}, {0xe858ad248f5c22c9, 0xd1b3400f8f9cff68, -778},
    {0xea9c227723ee8bcb, 0x465e15a979c1cadc, -713}, {0xece53cec4a314ebd, 0xa4f8bf5635246428, -648},
    {0xef340a98172aace4, 0x86fb897116c87c34, -583}, {0xf18899b1bc3f8ca1, 0xdc44e6c3cb279ac1, -518},
    {0xf3e2f893dec3f126, 0x5a89dba3c3efccfa, -453}, {0xf64335bcf065d37d, 0x4d4617b5ff4a16d5, -388},
    {0xf8a95fcf88747d94, 0x75a44c6397ce912a, -323}, {0xfb158592be068d2e, 0xeed6e2f0f0d56712, -258},
    {0xfd87b5f28300ca0d, 0x8bca9d6e188853fc, -193}, {0x8000000000000000, 0x0000000000000000, -127},
    {0x813f3978f8940984, 0x4000000000000000, -62},  {0x82818f1281ed449f, 0xbff8f10e7a8921a4, 3},
    {0x83c7088e1aab65db, 0x792667c6da79e0fa, 68},   {0x850fadc09923329e, 0x03e2cf6bc604ddb0, 133},
    {0x865b86925b9bc5c2, 0x0b8a2392ba45a9b2, 198},  {0x87aa9aff79042286, 0x90fb44d2f05d0842, 263},
    {0x88fcf317f22241e2, 0x441fece3bdf81f03, 328},  {0x8a5296ffe33cc92f, 0x82bd6b70d99aaa6f, 393},
    {0x8bab8eefb6409c1a, 0x1ad089b6c2f7548e, 458},  {0x8d07e33455637eb2, 0xdb0b487b6423e1e8, 523},
    {0x8e679c2f5e44ff8f, 0x570f09eaa7ea7648, 588},
};

/* What was read, before rounding: the digits first..end (from the first that is not 0, perhaps with
 * a point between) as a whole number, times 10^scale. */
typedef struct decimal {
  const char *first, *end;
  int64_t digit_count;
  int64_t scale;
} decimal;

static bool is_digit(char c) {
  return (unsigned char)(c - '0') < 10;
}

/* ---- whole numbers ---- */

enum { LIMBS = 64 }; /* 4096 bits: 801 digits, or 5^1130 times 54 bits, need 2800 */

typedef struct big {
  uint64_t limb[LIMBS];
  int count;
} big;

static void big_multiply_add(big *b, uint64_t factor, uint64_t addend) {
  uint64_t carry = addend;
  for (int i = 0; i < b->count; i++) {
    uint128 t = (uint128)b->limb[i] * factor + carry;
    b->limb[i] = (uint64_t)t;
    carry = (uint64_t)(t >> 64);
  }
  if (carry && b->count < LIMBS) b->limb[b->count++] = carry;
}

static void big_multiply_power5(big *b, int64_t power) {
  const uint64_t five27 = 7450580596923828125u;
  for (; power >= 27; power -= 27) big_multiply_add(b, five27, 0);
  for (; power > 0; power--) big_multiply_add(b, 5, 0);
}

static void big_shift_left(big *b, int64_t bits) {
  for (; bits >= 63; bits -= 63) big_multiply_add(b, (uint64_t)1 << 63, 0);
  if (bits > 0) big_multiply_add(b, (uint64_t)1 << bits, 0);
}

static int big_compare(const big *a, const big *b) {
  if (a->count != b->count) return a->count < b->count ? -1 : 1;
  for (int i = a->count - 1; i >= 0; i--)
    if (a->limb[i] != b->limb[i]) return a->limb[i] < b->limb[i] ? -1 : 1;
  return 0;
}

/* The sign of d - (2 m + 1) 2^(exponent - 1). */
static int compare_with_middle(const decimal *d, uint64_t m, int exponent) {
  big left = {{0}, 0}, right = {{2 * m + 1}, 1};
  int used = 0;
  bool more = false;
  for (const char *p = d->first; p < d->end; p++) {
    if (*p == '.') continue;
    if (used < EXACT_DIGITS) {
      big_multiply_add(&left, 10, (uint64_t)(*p - '0'));
      used++;
    } else
      more |= *p != '0';
  }
  int64_t power = d->scale + (d->digit_count - used);
  if (more) {
    big_multiply_add(&left, 10, 1);
    power--;
  }
  if (power >= 0)
    big_multiply_power5(&left, power);
  else
    big_multiply_power5(&right, -power);
  int64_t shift = power - (exponent - 1);
  if (shift >= 0)
    big_shift_left(&left, shift);
  else
    big_shift_left(&right, -shift);
  return big_compare(&left, &right);
}

/* ---- rounding ---- */

static double from_bits(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

/* w 10^power lies in [m, m + slack) 2^exponent, with the top bit of m set; w > 0; `more` says that
 * the true value may exceed w 10^power by up to 10^power. */
typedef struct bracket {
  uint128 m, slack;
  int exponent;
} bracket;

static bracket bracket_of(uint64_t w, int power, bool more) {
  int k = (power + 100 * TABLE_STEP) / TABLE_STEP - 100, rest = power - k * TABLE_STEP;
  uint64_t high = power_table[k - TABLE_FIRST].high, low = power_table[k - TABLE_FIRST].low;
  int exponent = power_table[k - TABLE_FIRST].exponent + power;
  uint64_t five = 1;
  for (int i = 0; i < rest; i++) five *= 5;
  int shift = __builtin_clzll(five);
  five <<= shift;
  exponent -= shift;
  /* 5^power = a 2^..., a cut to 128 bits: below by less than 4 */
  uint128 a = (uint128)high * five + (((uint128)low * five) >> 64);
  exponent += 64;
  if (!(a >> 127)) { /* one bit lost below: counted in the slack */
    a <<= 1;
    exponent--;
  }
  int zeros = __builtin_clzll(w);
  uint64_t v = w << zeros;
  exponent -= zeros;
  uint128 m = (uint128)v * (uint64_t)(a >> 64) + (((uint128)v * (uint64_t)a) >> 64);
  exponent += 64;
  uint128 slack = 8;
  if (more) slack += (a >> (64 - zeros)) + 1;
  if (!(m >> 127)) {
    m <<= 1;
    slack *= 2;
    exponent--;
  }
  return (bracket){m, slack, exponent};
}

/* Steps 2 and 3 for a value that is not zero. */
static double round_decimal(const decimal *d, uint64_t w, int64_t power, bool more) {
  if (power < SMALLEST_POWER) return 0;
  if (power > LARGEST_POWER) return from_bits((uint64_t)2047 << 52);
  bracket b = bracket_of(w, (int)power, more);
  int lead = b.exponent + 127;
  if (lead > 1023) return from_bits((uint64_t)2047 << 52);
  int cut = 75 + (lead < -1022 ? -1022 - lead : 0); /* bits below the last kept */
  uint64_t kept;
  bool up;
  if (cut > 128) { /* below half of the least positive value, if only just */
    if (cut > 129 || b.m <= ~(uint128)0 - b.slack) return 0;
    kept = 0;
    up = compare_with_middle(d, 0, -1074) > 0;
  } else {
    uint128 half = (uint128)1 << (cut - 1);
    kept = cut == 128 ? 0 : (uint64_t)(b.m >> cut);
    uint128 below = cut == 128 ? b.m : b.m & (half - 1 + half);
    if (below > half)
      up = true;
    else if (below + b.slack < half)
      up = false;
    else {
      int sign = compare_with_middle(d, kept, b.exponent + cut);
      up = sign > 0 || (sign == 0 && (kept & 1));
    }
  }
  kept += up;
  uint64_t biased = lead < -1022 ? 0 : (uint64_t)(lead + 1022);
  return from_bits((biased << 52) + kept);
}

/* Step 1 where it applies. */
static double round_number(const decimal *d, uint64_t w, int64_t power, bool more) {
  static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  if (w == 0) return 0;
  if (!more && w <= (uint64_t)1 << 53 && power >= -22 && power <= 22)
    return power < 0 ? (double)w / tens[-power] : (double)w * tens[power];
  return round_decimal(d, w, power, more);
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

/* The first W_DIGITS digits of d, and whether a later one is not 0. */
static uint64_t first_digits(const decimal *d, bool *more) {
  uint64_t w = 0;
  int used = 0;
  *more = false;
  for (const char *p = d->first; p < d->end; p++) {
    if (*p == '.') continue;
    if (used++ < W_DIGITS)
      w = w * 10 + (uint64_t)(*p - '0');
    else
      *more |= *p != '0';
  }
  return w;
}

const char *scree_number_parse(const char *begin, const char *end, double *value) {
  const char *p = begin;
  bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) p++;
  const char *start = p, *point = NULL;
  uint64_t w = 0; /* wraps beyond 19 digits, and is then read again */
  for (; p < end && is_digit(*p); p++) w = w * 10 + (uint64_t)(*p - '0');
  if (p < end && *p == '.') {
    point = p++;
    for (; p < end && is_digit(*p); p++) w = w * 10 + (uint64_t)(*p - '0');
  }
  int64_t digit_count = p - start - (point != NULL);
  if (digit_count == 0) return NULL;
  decimal d = {start, p, digit_count, point ? -(int64_t)(p - point - 1) : 0};
  int64_t exponent;
  const char *behind = read_exponent(p, end, &exponent);
  d.scale += exponent;
  int64_t power = d.scale;
  bool more = false;
  if (digit_count > W_DIGITS) {
    while (d.first < d.end && (*d.first == '0' || *d.first == '.')) {
      d.digit_count -= *d.first == '0';
      d.first++;
    }
    w = first_digits(&d, &more);
    if (d.digit_count > W_DIGITS) power += d.digit_count - W_DIGITS;
  }
  double magnitude = round_number(&d, w, power, more);
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
