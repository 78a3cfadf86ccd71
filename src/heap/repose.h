/* Shared by what measures heaps; the interface is in scree/heap.h. */
#ifndef SCREE_HEAP_REPOSE_H
#define SCREE_HEAP_REPOSE_H

#include "base/error.h"

/* That of no heap: all angles and lengths NaN, all counts 0. */
scree_repose scree_no_repose(void);

#endif
