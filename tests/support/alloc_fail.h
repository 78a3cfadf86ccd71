/* Allocation-failure tests: a fallible call is repeated with its 1st, 2nd, 3rd ... allocation
 * failing, until it succeeds. Each failure must be SCREE_OUT_OF_MEMORY with a sentence, and leak
 * nothing.
 *
 *   static scree_status weld(void *context, scree_error *error) {
 *     scree_mesh mesh = {0};
 *     scree_status status = scree_mesh_weld(context, 4, 0, &mesh, NULL, error);
 *     scree_mesh_free(&mesh);                  frees a success; must be harmless after a failure
 *     return status;
 *   }
 *   check_allocation_failures(weld, corners);
 */
#pragma once

#include "scree.h"

typedef scree_status fallible_call(void *context, scree_error *error);

/* Fails the cmocka test where the promise is broken. Answers the number of allocations the call
 * makes. Work that would take too long for all of them is sampled: above 200, every n/100-th is
 * failed. */
size_t check_allocation_failures(fallible_call *call, void *context);

/* The same for a call of which a part only informs onlookers and may be left undone: an allocation
 * refused may also end in success. */
size_t check_allocation_failures_survivable(fallible_call *call, void *context);
