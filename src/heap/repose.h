/* Shared by what measures heaps; the interface is in scree/heap.h. */
#pragma once

#include "base/error.h"

/* That of no heap: all angles and lengths NaN, all counts 0. */
scree_repose scree_no_repose(void);
