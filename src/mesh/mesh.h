/* What every function that takes a mesh from outside asks first. */
#pragma once

#include "base/box.h"
#include "base/error.h"

/* Room for a mesh, not filled. */
scree_status scree_mesh_make(size_t vertex_count, size_t triangle_count, scree_mesh *mesh,
                             scree_error *error);

/* SCREE_BAD_MESH where an index is out of range or a coordinate is not finite, SCREE_LIMIT where
 * corners cannot be numbered in 32 bits. O(N), parallel. */
scree_status scree_mesh_verify(const scree_mesh *mesh, scree_error *error);

/* The first corner that names no vertex, or SIZE_MAX. The highest is looked for first, and then
 * which: a loop without branches. */
static inline size_t scree_mesh_stray_corner(const scree_mesh *mesh) {
  size_t corner_count = 3 * mesh->triangle_count;
  uint32_t highest = 0;
  for (size_t c = 0; c < corner_count; c++)
    highest = mesh->triangles[c] > highest ? mesh->triangles[c] : highest;
  for (size_t c = 0; c < corner_count && highest >= mesh->vertex_count; c++)
    if (mesh->triangles[c] >= mesh->vertex_count) return c;
  return SIZE_MAX;
}

/* Whether a triangle's corners are not three vertices but two or one. */
static inline bool scree_names_twice(const uint32_t *c) {
  return (c[0] == c[1]) | (c[1] == c[2]) | (c[2] == c[0]);
}

/* Turns a triangle the other way round. */
static inline void scree_corners_turn(uint32_t *corners) {
  uint32_t second = corners[1];
  corners[1] = corners[2];
  corners[2] = second;
}

/* Whether the height of a triangle over its longest edge is not above the rounding of its
 * coordinates: an exact zero would be lost when units are converted. */
bool scree_facet_is_flat(const scree_mesh *mesh, size_t triangle);

static inline vec3 scree_mesh_vertex(const scree_mesh *mesh, size_t vertex) {
  return vec3_load(mesh->positions + 3 * vertex);
}
/* Corner k (0, 1, 2) of a triangle. */
static inline vec3 scree_mesh_corner(const scree_mesh *mesh, size_t triangle, int k) {
  return scree_mesh_vertex(mesh, mesh->triangles[3 * triangle + (size_t)k]);
}

/* Twice the area along the outward normal. */
static inline vec3 scree_facet_normal(const scree_mesh *mesh, size_t triangle) {
  return vec3_triangle_normal(scree_mesh_corner(mesh, triangle, 0),
                              scree_mesh_corner(mesh, triangle, 1),
                              scree_mesh_corner(mesh, triangle, 2));
}

static inline scree_box scree_facet_box(const scree_mesh *mesh, size_t triangle) {
  vec3 p = scree_mesh_corner(mesh, triangle, 0), q = scree_mesh_corner(mesh, triangle, 1),
       r = scree_mesh_corner(mesh, triangle, 2);
  return scree_box_join(scree_box_of(p, q), (scree_box){r, r});
}

/* The same as the trees ask for it (base/tree.h). */
static inline scree_box scree_box_of_facet(const void *mesh, size_t triangle) {
  return scree_facet_box(mesh, triangle);
}
