/* Sorting of numbers, and by a number of 32 bits; finding in what is sorted. */
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef struct scree_keyed {
  uint32_t key, index;
} scree_keyed;

/* Sorts by key, of which only the lowest `bits` bits may be set; those of equal key keep their
 * order. Uses both arrays, and answers the one that holds the outcome. O(count), parallel. */
scree_keyed *scree_radix_sort(scree_keyed *items, scree_keyed *swap, size_t count, int bits);

/* Ascending: by insertion where there are few, as round a vertex. */
void scree_sort_keys(uint64_t *keys, size_t count);
/* Ascending. */
void scree_sort_numbers(double *values, size_t count);
/* A quantile of ascending numbers, between neighbours as on a straight line; NaN of none. */
double scree_quantile(const double *ascending, size_t count, double share);

/* Declares i: the first of [low, high) of which `before`, which speaks of i and holds up to some
 * item alone, does not hold; high where there is none. */
#define SCREE_FIND_FIRST(i, low, high, before)                                                     \
  size_t i = (low);                                                                                \
  for (size_t low_ = i, high_ = (high); low_ < high_; i = low_) {                                  \
    i = low_ + (high_ - low_) / 2;                                                                 \
    if (before)                                                                                    \
      low_ = i + 1;                                                                                \
    else                                                                                           \
      high_ = i;                                                                                   \
  }

/* Define a comparison for qsort, of structs by one to four members, the first that differs. */
#define SCREE_ORDER_BY(name, type, m)                                                              \
  static int name(const void *a, const void *b) {                                                  \
    const type *x = a, *y = b;                                                                     \
    return SCREE_ORDER(m, 0);                                                                      \
  }
#define SCREE_ORDER_BY2(name, type, m, n)                                                          \
  static int name(const void *a, const void *b) {                                                  \
    const type *x = a, *y = b;                                                                     \
    return SCREE_ORDER(m, SCREE_ORDER(n, 0));                                                      \
  }
#define SCREE_ORDER_BY3(name, type, m, n, o)                                                       \
  static int name(const void *a, const void *b) {                                                  \
    const type *x = a, *y = b;                                                                     \
    return SCREE_ORDER(m, SCREE_ORDER(n, SCREE_ORDER(o, 0)));                                      \
  }
#define SCREE_ORDER_BY4(name, type, m, n, o, p)                                                    \
  static int name(const void *a, const void *b) {                                                  \
    const type *x = a, *y = b;                                                                     \
    return SCREE_ORDER(m, SCREE_ORDER(n, SCREE_ORDER(o, SCREE_ORDER(p, 0))));                      \
  }
#define SCREE_ORDER(m, other) (x->m < y->m ? -1 : x->m > y->m ? 1 : (other))
