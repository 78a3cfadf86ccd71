/* Ray queries against instanced triangle meshes, in single precision, for pictures only. The one
 * file that knows Embree is ray.c; a build without it answers SCREE_UNSUPPORTED. */
#pragma once

#include "base/error.h"

typedef struct scree_ray_scene scree_ray_scene;

typedef struct scree_ray_hit {
  float t;           /* distance along the direction; infinite where nothing was hit */
  float normal[3];   /* geometric, not of unit length, in space */
  float u, v;        /* barycentric coordinates of the corners 1 and 2 */
  uint32_t triangle; /* in the item's mesh */
  uint32_t item;     /* in the order of scree_ray_scene_add */
} scree_ray_hit;

scree_status scree_ray_scene_create(scree_ray_scene **scene, scree_error *error);
void scree_ray_scene_free(scree_ray_scene *scene);
/* Adds triangles given in space as floats (3 * vertex_count), copied. */
scree_status scree_ray_scene_add(scree_ray_scene *scene, const float *positions,
                                 size_t vertex_count, const uint32_t *triangles,
                                 size_t triangle_count, scree_error *error);
/* After the last add, before the first query. */
scree_status scree_ray_scene_commit(scree_ray_scene *scene, scree_error *error);

/* The first hit along the ray; thread-safe. */
scree_ray_hit scree_ray_first(const scree_ray_scene *scene, const float origin[3],
                              const float direction[3]);
/* Whether anything lies between the origin and origin + direction * reach; thread-safe. */
bool scree_ray_blocked(const scree_ray_scene *scene, const float origin[3],
                       const float direction[3], float reach);
