#include "simplify/guard/apart.h"

#include "base/alloc.h"
#include "mesh/measure/solid_angle.h"

scree_status scree_markers_find(const scree_halfmesh *s, scree_markers *markers,
                                scree_error *error) {
  if (s->shell_count < 2) return SCREE_OK;
  if (!markers->vertex) SCREE_TRY_ALLOC(markers->vertex, s->shell_count, error);
  markers->count = 0;
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->flags[v] & SCREE_VERTEX_MARKER && s->vertex[v].outgoing != SCREE_NONE)
      markers->vertex[markers->count++] = v;
  return SCREE_OK;
}

void scree_markers_free(scree_markers *markers) {
  scree_free(markers->vertex);
  *markers = (scree_markers){0};
}

void scree_markers_follow(scree_markers *markers, const scree_fan *fan) {
  for (size_t i = 0; i < markers->count; i++)
    if (markers->vertex[i] == fan->b) markers->vertex[i] = fan->a;
}

/* Half the solid angle of a triangle seen from p. */
static double half_angle(vec3 p, vec3 a, vec3 b, vec3 c) {
  return scree_half_solid_angle(vec3_sub(a, p), vec3_sub(b, p), vec3_sub(c, p));
}

static bool is_of_fan(const scree_halfmesh *s, const scree_fan *f, uint32_t v) {
  if (v == f->a || v == f->b || v == f->c || v == f->d) return true;
  for (uint32_t i = 0; i < f->count; i++)
    if (s->half[f->edge[i]].from == v || scree_to(s, f->edge[i]) == v) return true;
  return false;
}

/* What the fan's triangles, before less after, wind round p: a whole number of turns where the fan
 * is closed. */
static double turns(const scree_halfmesh *s, const scree_fan *f, vec3 p) {
  vec3 a = s->vertex[f->a].at, b = s->vertex[f->b].at;
  double sum = 0;
  if (f->c != SCREE_NONE) sum += half_angle(p, a, b, s->vertex[f->c].at);
  if (f->d != SCREE_NONE) sum += half_angle(p, b, a, s->vertex[f->d].at);
  for (uint32_t i = 0; i < f->count; i++)
    sum += half_angle(p, i < f->a_count ? a : b, f->from[i], f->to[i]) -
           half_angle(p, f->at, f->from[i], f->to[i]);
  return sum / (2 * 3.14159265358979323846);
}

static bool lies_within(const scree_bounds *b, vec3 p) {
  return p.x >= (double)b->low[0] && p.x <= (double)b->high[0] && p.y >= (double)b->low[1] &&
         p.y <= (double)b->high[1] && p.z >= (double)b->low[2] && p.z <= (double)b->high[2];
}

bool scree_markers_stay(const scree_markers *markers, const scree_halfmesh *s, const scree_fan *f,
                        const scree_bounds *bounds) {
  for (size_t i = 0; i < markers->count; i++) {
    vec3 p = s->vertex[markers->vertex[i]].at;
    if (!lies_within(bounds, p) || is_of_fan(s, f, markers->vertex[i])) continue;
    if (fabs(turns(s, f, p)) > 0.5) return false;
  }
  return true;
}
