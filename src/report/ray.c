#include "report/ray.h"

#include "base/alloc.h"

#include SCREE_RAY_QUERIES /* ray_embree3.inc or ray_embree4.inc */
#include <math.h>
#include <string.h>

struct scree_ray_scene {
  RTCDevice device;
  RTCScene scene;
};

scree_status scree_ray_scene_create(scree_ray_scene **scene, scree_error *error) {
  scree_ray_scene *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "a scene");
  made->device = rtcNewDevice(NULL);
  made->scene = made->device ? rtcNewScene(made->device) : NULL;
  if (!made->scene) {
    scree_ray_scene_free(made);
    return scree_fail(error, SCREE_UNSUPPORTED, "the ray tracer does not start on this machine");
  }
  rtcSetSceneFlags(made->scene, RTC_SCENE_FLAG_ROBUST);
  *scene = made;
  return SCREE_OK;
}

void scree_ray_scene_free(scree_ray_scene *scene) {
  if (!scene) return;
  if (scene->scene) rtcReleaseScene(scene->scene);
  if (scene->device) rtcReleaseDevice(scene->device);
  scree_free(scene);
}

scree_status scree_ray_scene_add(scree_ray_scene *scene, const float *positions,
                                 size_t vertex_count, const uint32_t *triangles,
                                 size_t triangle_count, scree_error *error) {
  RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           3 * sizeof(float), vertex_count);
  void *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          3 * sizeof(uint32_t), triangle_count);
  if (!vertices || !indices) {
    rtcReleaseGeometry(geometry);
    return scree_fail_memory(error, 12 * (vertex_count + triangle_count), "a picture's triangles");
  }
  memcpy(vertices, positions, 3 * sizeof(float) * vertex_count);
  memcpy(indices, triangles, 3 * sizeof(uint32_t) * triangle_count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene->scene, geometry);
  rtcReleaseGeometry(geometry);
  return SCREE_OK;
}

scree_status scree_ray_scene_commit(scree_ray_scene *scene, scree_error *error) {
  rtcCommitScene(scene->scene);
  if (rtcGetDeviceError(scene->device) != RTC_ERROR_NONE)
    return scree_fail(error, SCREE_OUT_OF_MEMORY, "out of memory for the ray tracer's hierarchy");
  return SCREE_OK;
}

static struct RTCRay make_ray(const float origin[3], const float direction[3], float reach) {
  return (struct RTCRay){.org_x = origin[0],
                         .org_y = origin[1],
                         .org_z = origin[2],
                         .dir_x = direction[0],
                         .dir_y = direction[1],
                         .dir_z = direction[2],
                         .tfar = reach,
                         .mask = 0xFFFFFFFFu};
}

scree_ray_hit scree_ray_first(const scree_ray_scene *scene, const float origin[3],
                              const float direction[3]) {
  struct RTCRayHit query = {.ray = make_ray(origin, direction, INFINITY),
                            .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
  intersect(scene->scene, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return (scree_ray_hit){.t = INFINITY};
  return (scree_ray_hit){query.ray.tfar,   {query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z},
                         query.hit.u,      query.hit.v,
                         query.hit.primID, query.hit.geomID};
}

bool scree_ray_blocked(const scree_ray_scene *scene, const float origin[3],
                       const float direction[3], float reach) {
  struct RTCRay ray = make_ray(origin, direction, reach);
  occlude(scene->scene, &ray);
  return ray.tfar < 0;
}
