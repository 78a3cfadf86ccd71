/* Patches: the many collapses of the finest levels, each patch of the surface by one thread alone.
 *
 * A patch is a stretch of a curve through all vertices (order.h). A vertex with a neighbour in
 * another patch is on its border and stays, and so do the triangles around: collapses of edges
 * between two other vertices touch nothing that another patch reads or changes. So patches can be
 * decimated side by side, in any order, and what is done in one after the other can be merged with
 * what was done elsewhere: every prefix is a level. From pass to pass the patches lie elsewhere. */
#ifndef SCREE_SIMPLIFY_PATCH_H
#define SCREE_SIMPLIFY_PATCH_H

#include "simplify/decimate.h"

/* Vertices of a patch: what belongs to them stays in a processor's own cache. */
enum { SCREE_PATCH = 4096 };

/* Passes over patches of so many vertices while the surface is closed and the levels fine
 * (cheapest.h) or of very many triangles; no surface may be kept (memory.h) until they are not.
 * What cannot be decided within a patch (whether the surface would meet itself) waits for the
 * batches.
 */
scree_status scree_decimate_in_patches(scree_decimator *d, size_t patch);

#endif
