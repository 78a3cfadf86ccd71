/* Sorting by radix against a sort that compares. */
#include "base/radix.h"
#include "base/rng.h"
#include "scree.h"
#include "support/check.h"

#include <stdlib.h>
#include <string.h>

/* Equal keys in the order given: that of the index. */
static int compare(const void *a, const void *b) {
  const scree_keyed *x = a, *y = b;
  if (x->key != y->key) return x->key < y->key ? -1 : 1;
  return (x->index > y->index) - (x->index < y->index);
}

static void check_sort(size_t count, int bits, int threads, scree_rng *rng) {
  size_t bytes = (count + 1) * sizeof(scree_keyed);
  scree_keyed *items = malloc(bytes), *swap = malloc(bytes), *expected = malloc(bytes);
  assert_non_null(items);
  for (size_t i = 0; i < count; i++)
    items[i] = (scree_keyed){(uint32_t)(scree_rng_next(rng) >> (64 - bits)), (uint32_t)i};
  memcpy(expected, items, bytes);
  qsort(expected, count, sizeof *expected, compare);
  scree_set_threads(threads);
  const scree_keyed *sorted = scree_radix_sort(items, swap, count, bits);
  if (count > 0) assert_memory_equal(sorted, expected, count * sizeof *sorted);
  scree_set_threads(0);
  free(items);
  free(swap);
  free(expected);
}

static void keys_come_in_order_and_equal_ones_stay(void **state) {
  (void)state;
  static const size_t counts[] = {0, 1, 2, 3, 100, 4095, 4096, 4097, 50000};
  static const int bits[] = {1, 5, 11, 12, 22, 23, 30, 32};
  scree_rng rng = {.seed = 7};
  for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
    for (size_t k = 0; k < sizeof bits / sizeof *bits; k++)
      for (int threads = 1; threads <= 3; threads++) check_sort(counts[i], bits[k], threads, &rng);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(keys_come_in_order_and_equal_ones_stay)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
