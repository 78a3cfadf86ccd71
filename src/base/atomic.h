/* Numbers that many threads change at once, on the processor and on a device. In which order they
 * do is left open, and nothing else is ordered by them. */
#pragma once

#include <stdint.h>

/* Answers what was there before. */
static inline uint32_t scree_atomic_add(uint32_t *at, uint32_t value) {
#ifdef __NVPTX__
  return (uint32_t)__nvvm_atom_add_gen_i((int *)at, (int)value);
#else
  return __atomic_fetch_add(at, value, __ATOMIC_RELAXED);
#endif
}

/* As a rule it is there already. */
static inline void scree_atomic_or(uint32_t *at, uint32_t bits) {
#ifdef __NVPTX__
  __nvvm_atom_or_gen_i((int *)at, (int)bits);
#else
  if ((__atomic_load_n(at, __ATOMIC_RELAXED) & bits) != bits)
    __atomic_fetch_or(at, bits, __ATOMIC_RELAXED);
#endif
}

/* The smaller of the two stays. */
static inline void scree_atomic_lower(uint32_t *at, uint32_t value) {
#ifdef __NVPTX__
  __nvvm_atom_min_gen_ui(at, value);
#else
  uint32_t old = __atomic_load_n(at, __ATOMIC_RELAXED);
  while (old > value &&
         !__atomic_compare_exchange_n(at, &old, value, 1, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}

/* The larger of the two stays. */
static inline void scree_atomic_raise(uint64_t *at, uint64_t value) {
#ifdef __NVPTX__
  __nvvm_atom_max_gen_ull((unsigned long long *)at, value);
#else
  uint64_t old = __atomic_load_n(at, __ATOMIC_RELAXED);
  while (old < value &&
         !__atomic_compare_exchange_n(at, &old, value, 1, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}
