/* A build without Embree. */
#include "report/ray.h"

#include "base/error.h"

scree_status scree_ray_scene_create(scree_ray_scene **scene, scree_error *error) {
  (void)scene;
  return scree_fail(error, SCREE_UNSUPPORTED, "this build has no ray tracer (Embree) for pictures");
}
void scree_ray_scene_free(scree_ray_scene *scene) {
  (void)scene;
}
scree_status scree_ray_scene_add(scree_ray_scene *scene, const float *positions,
                                 size_t vertex_count, const uint32_t *triangles,
                                 size_t triangle_count, scree_error *error) {
  (void)scene, (void)positions, (void)vertex_count, (void)triangles, (void)triangle_count;
  return scree_fail(error, SCREE_UNSUPPORTED, "this build has no ray tracer (Embree) for pictures");
}
scree_status scree_ray_scene_commit(scree_ray_scene *scene, scree_error *error) {
  (void)scene;
  return scree_fail(error, SCREE_UNSUPPORTED, "this build has no ray tracer (Embree) for pictures");
}
scree_ray_hit scree_ray_first(const scree_ray_scene *scene, const float origin[3],
                              const float direction[3]) {
  (void)scene, (void)origin, (void)direction;
  return (scree_ray_hit){.t = __builtin_inff()};
}
bool scree_ray_blocked(const scree_ray_scene *scene, const float origin[3],
                       const float direction[3], float reach) {
  (void)scene, (void)origin, (void)direction, (void)reach;
  return false;
}
