#include "mesh/measure/bounds.h"

void scree_mesh_bounds(const scree_mesh *mesh, vec3 *low, vec3 *high) {
  *low = (vec3){INFINITY, INFINITY, INFINITY};
  *high = vec3_neg(*low);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
    vec3 p = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[c]);
    *low = vec3_min(*low, p);
    *high = vec3_max(*high, p);
  }
}

/* splitmix64's finalizer (Steele, Lea, Flood 2014). */
static uint64_t mix(uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

bool scree_mesh_is_cycle(const scree_mesh *mesh) {
  uint64_t sum[2] = {0, 0};
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    const uint32_t *c = mesh->triangles + 3 * t;
    for (int k = 0; k < 3; k++) {
      uint32_t from = c[k], to = c[(k + 1) % 3];
      bool up = from < to;
      uint64_t pair = up ? (uint64_t)from << 32 | to : (uint64_t)to << 32 | from;
      uint64_t one = mix(pair + 0x9e3779b97f4a7c15u), two = mix(pair ^ 0xd1b54a32d192ed03u);
      if (from == to) continue;
      sum[0] += up ? one : -one;
      sum[1] += up ? two : -two;
    }
  }
  return sum[0] == 0 && sum[1] == 0;
}
