#include "simplify/anchor.h"

#include "base/alloc.h"

scree_status scree_anchors_find(const scree_halfmesh *s, scree_anchors *anchors,
                                scree_error *error) {
  if (s->shell_count < 2) return SCREE_OK;
  if (!anchors->vertex) SCREE_ALLOC_OR(anchors->vertex, s->shell_count, error, out_of_memory);
  anchors->count = 0;
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->flags[v] & SCREE_VERTEX_ANCHOR && s->vertex[v].outgoing != SCREE_NONE)
      anchors->vertex[anchors->count++] = v;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_anchors_free(scree_anchors *anchors) {
  scree_free(anchors->vertex);
  *anchors = (scree_anchors){0};
}

void scree_anchors_follow(scree_anchors *anchors, const scree_ring *ring) {
  for (size_t i = 0; i < anchors->count; i++)
    if (anchors->vertex[i] == ring->b) anchors->vertex[i] = ring->a;
}

/* Half the solid angle of a triangle seen from p (van Oosterom and Strackee 1983). */
static double half_angle(vec3 p, vec3 a, vec3 b, vec3 c) {
  a = vec3_sub(a, p), b = vec3_sub(b, p), c = vec3_sub(c, p);
  double x = vec3_norm(a), y = vec3_norm(b), z = vec3_norm(c);
  return atan2(vec3_dot(a, vec3_cross(b, c)),
               x * y * z + vec3_dot(a, b) * z + vec3_dot(b, c) * x + vec3_dot(c, a) * y);
}

static bool is_of_ring(const scree_halfmesh *s, const scree_ring *r, uint32_t v) {
  if (v == r->a || v == r->b || v == r->c || v == r->d) return true;
  for (uint32_t i = 0; i < r->count; i++)
    if (s->half[r->edge[i]].from == v || scree_to(s, r->edge[i]) == v) return true;
  return false;
}

/* What the ring's triangles, before less after, wind round p: a whole number of turns where the
 * ring is closed. */
static double turns(const scree_halfmesh *s, const scree_ring *r, vec3 target, vec3 p) {
  vec3 a = s->vertex[r->a].at, b = s->vertex[r->b].at;
  double sum = 0;
  if (r->c != SCREE_NONE) sum += half_angle(p, a, b, s->vertex[r->c].at);
  if (r->d != SCREE_NONE) sum += half_angle(p, b, a, s->vertex[r->d].at);
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 from = s->vertex[s->half[r->edge[i]].from].at, to = s->vertex[scree_to(s, r->edge[i])].at;
    sum += half_angle(p, i < r->a_count ? a : b, from, to) - half_angle(p, target, from, to);
  }
  return sum / (2 * 3.14159265358979323846);
}

bool scree_anchors_stay(const scree_anchors *anchors, const scree_halfmesh *s, const scree_ring *r,
                        vec3 target) {
  for (size_t i = 0; i < anchors->count; i++) {
    uint32_t v = anchors->vertex[i];
    vec3 p = s->vertex[v].at;
    if (p.x < r->low.x || p.y < r->low.y || p.z < r->low.z || p.x > r->high.x || p.y > r->high.y ||
        p.z > r->high.z || is_of_ring(s, r, v))
      continue;
    if (fabs(turns(s, r, target, p)) > 0.5) return false;
  }
  return true;
}
