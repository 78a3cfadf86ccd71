/* An order in which what is near in space is near in memory. */
#ifndef SCREE_SIMPLIFY_ORDER_H
#define SCREE_SIMPLIFY_ORDER_H

#include "base/alloc.h"
#include "base/vec.h"

/* Fills order with the vertices along a Morton curve through the box from low to high, which holds
 * them all; equal places keep their order. Depends on positions alone. O(n), parallel in part. */
scree_status scree_order_vertices(const scree_mesh *mesh, vec3 low, vec3 high, uint32_t *order,
                                  scree_error *error);

#endif
