/* The distance of a witness from the patch that replaces its triangle bounds its distance from the
 * level from above, as Klein, Liebich and Strasser, "Mesh reduction with error control"
 * (Visualization 1996), have it for all vertices of the mesh given. */
#include "simplify/stray.h"

#include <string.h>

/* Of sqrt(area / triangles). A sphere's volume in a tetrahedron needs 0.57, in an octahedron 0.37.
 */
#define STAND_OFF 0.5
/* In the unit box: distances that differ by no more are the same. */
#define ROUNDING 1e-12

void scree_memory_free(scree_memory *m) {
  scree_bvh_free(&m->surface);
  scree_free(m->witnesses);
  scree_free(m->first);
  *m = (scree_memory){0};
}

static void add_witness(scree_memory *m, vec3 at, uint32_t triangle) {
  m->witnesses[m->count] = (scree_witness){at, 0, m->first[triangle]};
  m->first[triangle] = (uint32_t)m->count++;
}

/* The squared distance up to which others are the same as this one. */
static double past_rounding(double distance2) {
  double distance = sqrt(distance2) + ROUNDING;
  return distance * distance;
}

/* Each vertex with the first of its triangles. */
static void add_vertices(scree_memory *m, const scree_halfmesh *s, uint8_t *seen) {
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    uint32_t v = s->half[h].from;
    if (v == SCREE_NONE || seen[v]) continue;
    seen[v] = 1;
    add_witness(m, s->vertex[v].at, h / 3);
  }
}

scree_status scree_memory_keep(const scree_halfmesh *s, scree_memory *m, scree_error *error) {
  scree_mesh mesh = {.vertex_count = s->vertex_count};
  uint8_t *seen = scree_alloc_zero(s->vertex_count, 1);
  scree_status status = SCREE_OUT_OF_MEMORY;
  *m = (scree_memory){0};
  SCREE_ALLOC_OR(mesh.positions, 3 * s->vertex_count, error, done);
  SCREE_ALLOC_OR(mesh.triangles, 3 * s->live_triangle_count, error, done);
  SCREE_ALLOC_OR(m->witnesses, s->live_vertex_count, error, done);
  SCREE_ALLOC_OR(m->first, s->triangle_count, error, done);
  if (!seen) {
    scree_fail_memory(error, s->vertex_count, "the witnesses");
    goto done;
  }
  for (size_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, at);
    m->area += 0.5 * vec3_norm(vec3_triangle_normal(at[0], at[1], at[2]));
    for (size_t i = 0; i < 3; i++)
      mesh.triangles[3 * mesh.triangle_count + i] = s->half[3 * t + i].from;
    mesh.triangle_count++;
  }
  for (size_t v = 0; v < s->vertex_count; v++) vec3_store(mesh.positions + 3 * v, s->vertex[v].at);
  memset(m->first, 0xff, s->triangle_count * sizeof *m->first);
  add_vertices(m, s, seen);
  status = scree_bvh_build(&mesh, &m->surface, error);
done:
  scree_free(seen);
  scree_mesh_free(&mesh);
  if (status != SCREE_OK) scree_memory_free(m);
  return status;
}

bool scree_memory_allows(const scree_memory *m, size_t triangle_count, vec3 x) {
  double size2 = m->area / (double)triangle_count;
  return scree_bvh_closest(&m->surface, x, &(scree_bvh_hit){STAND_OFF * STAND_OFF * size2, x, 0});
}

/* The squared distance of x from the surface kept, if above `least`. */
static double farther(const scree_memory *m, vec3 x, double least) {
  scree_bvh_hit hit = {.distance2 = least};
  if (scree_bvh_closest(&m->surface, x, &hit)) return least;
  hit.distance2 = INFINITY;
  scree_bvh_closest(&m->surface, x, &hit);
  return hit.distance2 > least ? hit.distance2 : least;
}

/* The corners of the ring's triangle i, with its moving corner at x. */
static void corners_at(const scree_halfmesh *s, const scree_ring *r, uint32_t i, vec3 x,
                       double *corners) {
  vec3_store(corners, x);
  vec3_store(corners + 3, s->vertex[s->half[r->edge[i]].from].at);
  vec3_store(corners + 6, s->vertex[scree_to(s, r->edge[i])].at);
}

static void new_corners(const scree_halfmesh *s, const scree_ring *r, vec3 target,
                        double (*corners)[9]) {
  for (uint32_t i = 0; i < r->count; i++) corners_at(s, r, i, target, corners[i]);
}

/* Triangle k of those around: the ring's, then the edge's own. */
static uint32_t triangle_around(const scree_halfmesh *s, const scree_ring *r, uint32_t k) {
  uint32_t h = k < r->count    ? r->edge[k]
               : k == r->count ? r->half_edge
                               : s->half[r->half_edge].twin;
  return h / 3;
}

static uint32_t count_around(const scree_ring *r) {
  return r->count + (r->d == SCREE_NONE ? 1 : 2);
}

/* The squared distance of p from the triangles, or something not above `enough`. */
static double distance_from(double (*corners)[9], uint32_t count, uint32_t begin, vec3 p,
                            double enough) {
  double least = INFINITY;
  vec3 point;
  for (uint32_t i = 0; i < count && least > enough; i++) {
    double distance2 = scree_triangle_closest(corners[(begin + i) % count], p, &point);
    if (distance2 < least) least = distance2;
  }
  return least;
}

double scree_memory_stray(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                          vec3 target, double least) {
  double worst = least, corners[SCREE_RING_MAX][9];
  new_corners(s, r, target, corners);
  for (uint32_t k = 0; k < count_around(r); k++)
    for (uint32_t j = m->first[triangle_around(s, r, k)]; j != SCREE_NONE;) {
      const scree_witness *w = &m->witnesses[j];
      double enough = fmax(worst, past_rounding(w->distance2));
      double distance2 = distance_from(corners, r->count, k, w->at, enough);
      if (distance2 > enough) worst = distance2;
      j = w->next;
    }
  worst = farther(m, target, worst);
  for (uint32_t i = 0; i < r->count; i++)
    worst = farther(m, vec3_lerp(target, s->vertex[s->half[r->edge[i]].from].at, 0.5), worst);
  return worst;
}

double scree_memory_worst(const scree_memory *m) {
  double worst = 0;
  for (size_t i = 0; i < m->count; i++) worst = fmax(worst, m->witnesses[i].distance2);
  return worst;
}

/* The triangle of the ring whose new form is nearest to the witness; of equally near ones the first
 * of the mesh. */
static uint32_t nearest_triangle(const scree_ring *r, double (*corners)[9], scree_witness *w) {
  double distance2[SCREE_RING_MAX], least = INFINITY;
  uint32_t nearest = SCREE_NONE;
  vec3 point;
  for (uint32_t i = 0; i < r->count; i++) {
    distance2[i] = scree_triangle_closest(corners[i], w->at, &point);
    least = fmin(least, distance2[i]);
  }
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] <= past_rounding(least) && r->edge[i] / 3 < nearest) nearest = r->edge[i] / 3;
  w->distance2 = least;
  return nearest;
}

void scree_memory_move(scree_memory *m, const scree_halfmesh *s, const scree_ring *r, vec3 target) {
  double corners[SCREE_RING_MAX][9];
  uint32_t moving = SCREE_NONE;
  new_corners(s, r, target, corners);
  for (uint32_t k = 0; k < count_around(r); k++) {
    uint32_t *first = &m->first[triangle_around(s, r, k)];
    while (*first != SCREE_NONE) {
      uint32_t j = *first;
      *first = m->witnesses[j].next;
      m->witnesses[j].next = moving;
      moving = j;
    }
  }
  while (moving != SCREE_NONE) {
    scree_witness *w = &m->witnesses[moving];
    uint32_t j = moving, triangle = nearest_triangle(r, corners, w);
    moving = w->next;
    w->next = m->first[triangle];
    m->first[triangle] = j;
  }
}

/* The squared distance of x from the segment between the ring's ends: mostly the answer, at little
 * cost. */
static double distance_from_edge(const scree_halfmesh *s, const scree_ring *r, vec3 x) {
  vec3 e = vec3_sub(s->vertex[r->b].at, s->vertex[r->a].at), y = vec3_sub(x, s->vertex[r->a].at);
  double t = vec3_dot(y, e) / vec3_norm2(e);
  return vec3_norm2(vec3_mad(y, e, t > 1 ? -1 : t > 0 ? -t : 0));
}

bool scree_stays_within(const scree_halfmesh *s, const scree_ring *r, vec3 target, double most) {
  double corners[SCREE_RING_MAX][9];
  if (distance_from_edge(s, r, target) <= most) return true;
  for (uint32_t i = 0; i < r->count; i++)
    corners_at(s, r, i, s->vertex[i < r->a_count ? r->a : r->b].at, corners[i]);
  return distance_from(corners, r->count, 0, target, most) <= most;
}
