/* scree_number_parse against strtod, bit for bit. */
#include "base/number.h"
#include "base/rng.h"
#include "support/check.h"

#include <locale.h>

static scree_rng rng;

static uint64_t bits_of(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

static void check_same(const char *text) {
  double got = 0, expected = strtod(text, NULL);
  size_t length = strlen(text);
  const char *end = scree_number_parse(text, text + length, &got);
  if (end != text + length || bits_of(got) != bits_of(expected)) {
    print_error("'%.200s': %.17g, expected %.17g (read %td of %zu bytes)\n", text, got, expected,
                end ? end - text : -1, length);
    fail();
  }
}

static void random_spellings(void **state) {
  (void)state;
  char text[1200];
  for (int round = 0; round < 1000000; round++) {
    size_t n = 0;
    if (scree_rng_below(&rng, 2)) text[n++] = scree_rng_below(&rng, 4) ? '-' : '+';
    int before = (int)scree_rng_below(&rng, 12),
        behind = (int)scree_rng_below(&rng, scree_rng_below(&rng, 100) ? 14 : 900);
    if (before + behind == 0) before = 1;
    for (int i = 0; i < before; i++) text[n++] = (char)('0' + scree_rng_below(&rng, 10));
    if (behind || scree_rng_below(&rng, 2)) text[n++] = '.';
    for (int i = 0; i < behind; i++) text[n++] = (char)('0' + scree_rng_below(&rng, 10));
    text[n] = 0;
    if (scree_rng_below(&rng, 2))
      snprintf(text + n, 16, "%c%d", scree_rng_below(&rng, 2) ? 'e' : 'E',
               (int)scree_rng_below(&rng, scree_rng_below(&rng, 2) ? 700 : 60) -
                   (int)scree_rng_below(&rng, 400));
    check_same(text);
  }
}

/* Every double printed with enough digits, and with too many, comes back. */
static void random_doubles(void **state) {
  (void)state;
  char text[1400];
  for (int round = 0; round < 500000; round++) {
    uint64_t bits = scree_rng_next(&rng);
    double value;
    memcpy(&value, &bits, sizeof value);
    if (!isfinite(value)) continue;
    snprintf(text, sizeof text, "%.*e", 14 + (int)scree_rng_below(&rng, 8), value);
    check_same(text);
    snprintf(text, sizeof text, "%.9g", (double)(float)(scree_rng_uniform(&rng) * 100));
    check_same(text);
  }
}

/* The exact middle between neighbours, and the decimal just above and below it. */
static void ties(void **state) {
  (void)state;
  char text[1400];
  for (int round = 0; round < 20000; round++) {
    int exponent = (int)scree_rng_below(&rng, 1900) - 950;
    if (round & 1) exponent = (int)scree_rng_below(&rng, 20) - 1074;
    uint64_t m = (scree_rng_next(&rng) >> 11) | ((uint64_t)1 << 52);
    if (round & 1) m >>= scree_rng_below(&rng, 53);
    /* 54 bits: exact where long double has 64, nearly a tie elsewhere */
    long double middle = ldexpl(2.0L * (long double)m + 1, exponent - 1);
    if (snprintf(text, sizeof text, "%.1100Le", middle) >= (int)sizeof text) fail();
    check_same(text);
    char *mark = strchr(text, 'e');
    mark[-1] = (char)('0' + 1 + scree_rng_below(&rng, 9));
    check_same(text);
    text[2 + scree_rng_below(&rng, 30)] ^= 1;
    check_same(text);
  }
}

static void special_values(void **state) {
  (void)state;
  static const char *const texts[] = {
      "0",
      "-0",
      "0.0e999",
      "1e309",
      "1e-400",
      "1e99999999999999999999",
      "1e-99999999999999999999",
      "4.9406564584124654e-324",
      "2.4703282292062327e-324",
      "2.4703282292062328e-324",
      "2.2250738585072011e-308",
      "2.2250738585072014e-308",
      "1.7976931348623157e308",
      "1.7976931348623158e308",
      "1.7976931348623159e308",
      "179769313486231580793e289",
      "9007199254740993",
      "9007199254740992.99999999999999999999",
      "9223372036854775808",
      "00000000000000000000000000000000000001.5",
      "0.00000000000000000000000000000000000000000015",
      "0000000000000000000000000000000000000",
      "7.0e-10",
      ".5",
      "5.",
      "+1e1",
      "18446744073709551616",
  };
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) check_same(texts[i]);
}

static void what_is_no_number(void **state) {
  (void)state;
  static const char *const texts[] = {"", "+", "-", ".", "e5", "nan", "inf", "-inf", "x1", "--1"};
  double value = 42;
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    assert_null(scree_number_parse(texts[i], texts[i] + strlen(texts[i]), &value));
    assert_true(value == 42);
  }
  /* stops where the number ends, and before `end` */
  static const struct {
    const char *text;
    size_t length, read;
    double value;
  } prefixes[] = {{"1e", 2, 1, 1},   {"1e+", 3, 1, 1},     {"1,5", 3, 1, 1},
                  {"0x10", 4, 1, 0}, {"12345", 3, 3, 123}, {"1.5D1x", 6, 5, 15}};
  for (size_t i = 0; i < sizeof prefixes / sizeof *prefixes; i++) {
    const char *text = prefixes[i].text;
    assert_ptr_equal(scree_number_parse(text, text + prefixes[i].length, &value),
                     text + prefixes[i].read);
    assert_true(value == prefixes[i].value);
  }
}

static void written_and_read_back(void **state) {
  (void)state;
  char text[SCREE_NUMBER_SIZE];
  const char *locales[] = {"de_DE.UTF-8", "C"}; /* a decimal comma where it is installed */
  for (int l = 0; l < 2; l++) {
    setlocale(LC_NUMERIC, locales[l]);
    for (int round = 0; round < 100000; round++) {
      uint64_t bits = scree_rng_next(&rng);
      double value, back;
      memcpy(&value, &bits, sizeof value);
      if (round & 1) value = round * 1e-3;
      if (!isfinite(value)) continue;
      size_t length = scree_number_format(value, text);
      assert_ptr_equal(scree_number_parse(text, text + length, &back), text + length);
      assert_true(bits_of(back) == bits_of(value));
      float narrow = (float)value;
      if (!isfinite(narrow)) continue;
      length = scree_number_format_float(narrow, text);
      assert_ptr_equal(scree_number_parse(text, text + length, &back), text + length);
      assert_true((float)back == narrow);
    }
  }
  assert_int_equal(scree_number_format(0.1, text), 3);
}

int main(void) {
  rng = (scree_rng){7, 1, 0};
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(random_spellings),
      cmocka_unit_test(random_doubles),
      cmocka_unit_test(ties),
      cmocka_unit_test(special_values),
      cmocka_unit_test(what_is_no_number),
      cmocka_unit_test(written_and_read_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
