/* Loops over lanes: plain C that the compiler turns into vector instructions. A function marked
 * SCREE_LANES is compiled for AVX2 and AVX-512 as well, chosen when the program starts; as nothing
 * contracts and no sum is reordered, all give the same bits. It is static, for clang calls
 * one of another file by its plain name, which there is none of; and names must differ in the whole
 * library, for clang gives the chooser of a static function external linkage. */
#pragma once

#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__OPTIMIZE__) &&                      \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) &&                             \
    !defined(__clang_analyzer__)
#if defined(__clang__)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __clang_major__ < 14
#define SCREE_LANES
#endif
#endif
#else
#define SCREE_LANES
#endif

#ifndef SCREE_LANES
#define SCREE_LANES __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#endif

/* A part of such a function that must be compiled with it. */
#define SCREE_LANES_INLINE static inline __attribute__((always_inline))
