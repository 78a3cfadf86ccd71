/* Digit by digit from the lowest. For every digit the items are cut into a few slices: each counts
 * its own, and knows from the others' counts where its items of each digit go. */
#include "base/radix.h"

#include "base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DIGIT = 11, RADIX = 1 << DIGIT, SLICES = 4 };
/* Fewer are not worth waking anybody. */
enum { SLICED_FROM = 4096 };
enum { INSERTION_MOST = 48 }; /* above, qsort wins */

typedef struct sorting {
  const scree_keyed *from;
  scree_keyed *to;
  int shift;
  uint32_t place[SLICES][RADIX]; /* counts, then where the next item of the digit goes */
} sorting;

static uint32_t digit_of(const sorting *s, size_t i) {
  return s->from[i].key >> s->shift & (RADIX - 1);
}

static void count_slice(void *context, scree_block block) {
  sorting *s = context;
  memset(s->place[block.index], 0, sizeof s->place[block.index]);
  for (size_t i = block.begin; i < block.end; i++) s->place[block.index][digit_of(s, i)]++;
}

static void move_slice(void *context, scree_block block) {
  sorting *s = context;
  for (size_t i = block.begin; i < block.end; i++)
    s->to[s->place[block.index][digit_of(s, i)]++] = s->from[i];
}

scree_keyed *scree_radix_sort(scree_keyed *items, scree_keyed *swap, size_t count, int bits) {
  sorting s = {.from = items, .to = swap};
  if (count == 0) return items;
  size_t size = count < SLICED_FROM ? count : count / SLICES + 1;
  size_t slices = scree_block_count(count, size);
  for (; s.shift < bits; s.shift += DIGIT) {
    uint32_t sum = 0;
    scree_parallel_for(count, size, count_slice, &s);
    for (size_t digit = 0; digit < RADIX; digit++)
      for (size_t slice = 0; slice < slices; slice++) {
        uint32_t of_digit = s.place[slice][digit];
        s.place[slice][digit] = sum;
        sum += of_digit;
      }
    scree_parallel_for(count, size, move_slice, &s);
    s.from = s.to;
    s.to = s.from == items ? swap : items;
  }
  return s.to == items ? swap : items;
}

static int compare_keys(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

void scree_sort_keys(uint64_t *keys, size_t count) {
  if (count > INSERTION_MOST) {
    qsort(keys, count, sizeof *keys, compare_keys);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    uint64_t key = keys[i];
    size_t j = i;
    for (; j > 0 && keys[j - 1] > key; j--) keys[j] = keys[j - 1];
    keys[j] = key;
  }
}

static int compare_numbers(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

void scree_sort_numbers(double *values, size_t count) {
  if (count > 0) qsort(values, count, sizeof *values, compare_numbers);
}

double scree_quantile(const double *ascending, size_t count, double share) {
  if (count == 0) return NAN;
  double at = share * (double)(count - 1);
  size_t i = (size_t)at, next = i + 1 < count ? i + 1 : i;
  return ascending[i] + (at - (double)i) * (ascending[next] - ascending[i]);
}
