#include "report/pack.h"

#include "base/alloc.h"

#include <math.h>
#include <meshoptimizer.h>
#include <pthread.h>
#include <string.h>

/* ---- the grid ---- */

void scree_pack_stretch(const double *p, double low[3], double high[3]) {
  for (int k = 0; k < 3; k++) {
    low[k] = fmin(low[k], p[k]);
    high[k] = fmax(high[k], p[k]);
  }
}

void scree_pack_box(const scree_mesh *mesh, double low[3], double high[3]) {
  for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
  for (size_t v = 0; v < mesh->vertex_count; v++)
    scree_pack_stretch(mesh->positions + 3 * v, low, high);
}

void scree_pack_grid(scree_packing *p, const double low[3], const double high[3]) {
  memcpy(p->low, low, sizeof p->low);
  p->step = fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2])) / 65535;
}

scree_grid_point scree_pack_point(const scree_packing *p, const double *position) {
  scree_grid_point g = {.extra = 0};
  for (int k = 0; k < 3; k++) {
    double cell = p->step > 0 ? (position[k] - p->low[k]) / p->step + 0.5 : 0;
    g.x[k] = cell <= 0 ? 0 : cell >= 65535 ? 65535 : (uint16_t)cell;
  }
  return g;
}

/* ---- buffers through the codecs ---- */

void scree_pack_u32(scree_packing *p, size_t value) {
  uint32_t narrow = (uint32_t)value;
  scree_code_u32(&p->out, &narrow);
}

static void put_buffer(scree_packing *p, unsigned char *bytes, size_t count) {
  scree_pack_u32(p, count);
  scree_code_bytes(&p->out, bytes, count);
}

/* The versions that the JavaScript reads; a setting of the library as a whole. */
static void set_versions(void) {
  meshopt_encodeVertexVersion(0);
  meshopt_encodeIndexVersion(1);
}

static pthread_once_t versions = PTHREAD_ONCE_INIT;

scree_status scree_pack_vertices(scree_packing *p, const void *vertices, size_t count,
                                 size_t size) {
  pthread_once(&versions, set_versions);
  size_t bound = meshopt_encodeVertexBufferBound(count, size);
  SCREE_SCRATCH(unsigned char, bytes, bound, p->error);
  put_buffer(p, bytes, meshopt_encodeVertexBuffer(bytes, bound, vertices, count, size));
  return SCREE_OK;
}

static scree_status put_indices(scree_packing *p, const uint32_t *indices, size_t count,
                                size_t vertex_count) {
  pthread_once(&versions, set_versions);
  size_t bound = meshopt_encodeIndexBufferBound(count, vertex_count);
  SCREE_SCRATCH(unsigned char, bytes, bound, p->error);
  put_buffer(p, bytes, meshopt_encodeIndexBuffer(bytes, bound, indices, count));
  return SCREE_OK;
}

scree_status scree_pack_mesh(scree_packing *p, const scree_mesh *mesh, uint32_t *place) {
  size_t corner_count = 3 * mesh->triangle_count, vertex_count = mesh->vertex_count;
  SCREE_SCRATCH(uint32_t, order, vertex_count, p->error);
  SCREE_SCRATCH(uint32_t, corners, corner_count, p->error);
  SCREE_SCRATCH(scree_grid_point, points, vertex_count, p->error);
  if (p->keeps_order)
    memcpy(corners, mesh->triangles, corner_count * sizeof *corners);
  else
    meshopt_optimizeVertexCache(corners, mesh->triangles, corner_count, vertex_count);
  size_t used = meshopt_optimizeVertexFetchRemap(order, corners, corner_count, vertex_count);
  meshopt_remapIndexBuffer(corners, corners, corner_count, order);
  for (size_t v = 0; v < vertex_count; v++)
    if (order[v] != UINT32_MAX) points[order[v]] = scree_pack_point(p, mesh->positions + 3 * v);
  if (place) memcpy(place, order, vertex_count * sizeof *place);
  scree_pack_u32(p, used);
  scree_pack_u32(p, mesh->triangle_count);
  SCREE_TRY(scree_pack_vertices(p, points, used, sizeof *points));
  return put_indices(p, corners, corner_count, used);
}
