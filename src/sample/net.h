/* A closed manifold mesh of a shape. */
#pragma once

#include "base/error.h"
#include "base/progress.h"
#include "sample/shape.h"

/* Meshes the surface of a shape at the given spacing (metres): closed, manifold, outward, its
 * vertices on the surface and spread evenly over it. Triangles are about right-angled with legs of
 * one step where the surface lies along the lattice. Cost: linear in the number of triangles; the
 * same bits for any number of threads. SCREE_LIMIT where the spacing is too coarse for the shape's
 * details or needs too large a lattice. Free with scree_mesh_free. */
scree_status scree_net_mesh(const scree_shape *shape, double step, scree_ticker *ticker,
                            scree_mesh *mesh, scree_error *error);
