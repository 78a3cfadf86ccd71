/* Meshes for tests: closed forms, and surfaces of every quality. All are freed with
 * scree_mesh_free; a failed allocation ends the test. */
#pragma once

#include "base/rng.h"
#include "scree.h"

/* Room for the given counts, not filled. */
scree_mesh shape_make(size_t vertex_count, size_t triangle_count);

/* Outward, 12 triangles, from the origin to (x, y, z). */
scree_mesh shape_box(double x, double y, double z);
/* The same box with each face cut in n x n squares of two triangles, welded. */
scree_mesh shape_grid_box(double x, double y, double z, size_t n);
/* Corners at the origin and at x, y, z on the axes. */
scree_mesh shape_tetrahedron(double x, double y, double z);
/* An icosahedron, each face cut in four `level` times, pushed out to the radius: 20 * 4^level
 * triangles about the origin. */
scree_mesh shape_icosphere(double radius, int level);
/* Genus 1, about the z axis; 2 * around * across triangles. */
scree_mesh shape_torus(double big_radius, double small_radius, size_t around, size_t across);
/* An open n x n square sheet of side 1 at height z, up. */
scree_mesh shape_sheet(double z, size_t n);
/* Triangles between few vertices on a small integer grid: shared edges of every kind, repeated
 * vertices, flat and duplicate facets. */
scree_mesh shape_random_tangle(scree_rng *rng);

/* a and b side by side in one mesh, not welded. */
scree_mesh shape_join(const scree_mesh *a, const scree_mesh *b);
/* Every vertex p becomes matrix p + offset. */
void shape_transform(scree_mesh *mesh, const mat3 *matrix, vec3 offset);
void shape_move(scree_mesh *mesh, vec3 offset);
/* Adds a normal deviate of this size to every coordinate. */
void shape_shake(scree_mesh *mesh, double size, scree_rng *rng);
/* Every vertex is nearer to the origin, or farther, by up to this share of its distance: a surface
 * that is seen whole from there still cannot meet itself. */
void shape_roughen(scree_mesh *mesh, double share, scree_rng *rng);
/* The facets as a reader hands them on, in an order and each from a corner of the rng's (NULL: as
 * they are), welded exactly. */
scree_mesh shape_weld(const scree_mesh *mesh, scree_rng *rng);
/* A particle of the mesh, which is freed. */
scree_particle *shape_particle(scree_mesh mesh);
/* Turns facet t round. */
void shape_flip(scree_mesh *mesh, size_t triangle);
