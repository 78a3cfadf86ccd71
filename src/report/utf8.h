/* File names are bytes; JSON and pictures want UTF-8. */
#pragma once

#include <stddef.h>

/* The length in bytes of the UTF-8 character at text (not at its end), 0 where there is none: stray
 * or missing bytes, overlong forms, surrogates, values above U+10FFFF. */
static inline size_t scree_utf8_length(const char *text) {
  const unsigned char *t = (const unsigned char *)text;
  if (t[0] < 0x80) return 1;
  size_t length = t[0] >= 0xc2 && t[0] <= 0xdf ? 2 : (t[0] & 0xf0) == 0xe0 ? 3 : 4;
  if (length == 4 && (t[0] < 0xf0 || t[0] > 0xf4)) return 0;
  for (size_t i = 1; i < length; i++)
    if ((t[i] & 0xc0) != 0x80) return 0;
  if (t[0] == 0xe0 && t[1] < 0xa0) return 0;
  if (t[0] == 0xed && t[1] > 0x9f) return 0;
  if (t[0] == 0xf0 && t[1] < 0x90) return 0;
  if (t[0] == 0xf4 && t[1] > 0x8f) return 0;
  return length;
}
