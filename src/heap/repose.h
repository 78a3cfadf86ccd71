/* Shared by what measures heaps; the interface is in scree/heap.h. */
#pragma once

#include "base/error.h"

/* ground.c: of columns x rows marks those SCREE_IN that hang together with `seed`, which is one,
 * get SCREE_DONE: the first of `cells`, as many as it answers. */
enum { SCREE_OUT, SCREE_IN, SCREE_DONE };
size_t scree_flood(char *mark, size_t columns, size_t rows, size_t seed, size_t *cells);

/* That of no heap: all angles and lengths NaN, all counts 0. */
scree_repose scree_no_repose(void);
