#pragma once
#include <stddef.h>
void abort(void);
void qsort(void *items, size_t count, size_t size, int (*compare)(const void *, const void *));
