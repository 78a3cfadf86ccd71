/* The distance of a witness from the patch that replaces its triangle bounds its distance from the
 * level from above, as Klein, Liebich and Strasser, "Mesh reduction with error control"
 * (Visualization 1996), have it for all vertices of the mesh given. */
#include "simplify/stray.h"

#include "base/sum.h"

#include <string.h>

/* Of sqrt(area / triangles). A sphere's volume in a tetrahedron needs 0.57, in an octahedron 0.37.
 */
#define STAND_OFF 0.5
/* What is usual for the largest distance, in mean ones. */
#define USUAL_MEANS 10.0
/* Of each new edge, equally far apart. Along an edge over a hollow the surface is farthest off
 * somewhere in between. */
enum { PLACES_ON_EDGE = 5 };
/* Witnesses per triangle above which half of them are dropped, and how these are known. */
enum { CROWD = 24 };
#define DROPPED (-1.0)
/* Squared areas that differ by no more of themselves are the same. */
#define SAME_SIZE 1e-9

void scree_memory_free(scree_memory *m) {
  scree_bvh_free(&m->surface);
  scree_free(m->witnesses);
  scree_free(m->first);
  *m = (scree_memory){0};
}

static void add_witness(scree_memory *m, vec3 at, uint32_t triangle) {
  m->witnesses[m->count] = (scree_witness){at, 0, m->first[triangle]};
  m->first[triangle] = (uint32_t)m->count++;
  m->left++;
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

/* The squared distance of x from the surface kept, if above `least`. *near: a triangle to begin
 * with, then the one found. */
static double farther(const scree_memory *m, vec3 x, double least, uint32_t *near) {
  if (scree_bvh_within(&m->surface, x, least, near)) return least;
  scree_bvh_hit hit = {.distance2 = INFINITY};
  scree_bvh_closest(&m->surface, x, &hit);
  *near = hit.index;
  return fmax(hit.distance2, least);
}

/* The corners of the ring's triangle i, with its moving corner at x. */
static void corners_at(const scree_halfmesh *s, const scree_ring *r, uint32_t i, vec3 x,
                       double *corners) {
  vec3_store(corners, x);
  vec3_store(corners + 3, s->vertex[s->half[r->edge[i]].from].at);
  vec3_store(corners + 6, s->vertex[scree_to(s, r->edge[i])].at);
}

void scree_ring_corners(const scree_halfmesh *s, const scree_ring *r, vec3 target,
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
  return r->count + (r->c != SCREE_NONE) + (r->d != SCREE_NONE);
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

/* The largest squared distance of a witness of the ring's triangles from the new ones, where it
 * grows and is above `worst`; or the first that is above `most`. */
static double stray_of_witnesses(const scree_memory *m, const scree_halfmesh *s,
                                 const scree_ring *r, vec3 target, double worst, double most) {
  double corners[SCREE_RING_MAX][9];
  scree_ring_corners(s, r, target, corners);
  for (uint32_t k = 0; k < count_around(r); k++)
    for (uint32_t j = m->first[triangle_around(s, r, k)]; j != SCREE_NONE && worst <= most;) {
      const scree_witness *w = &m->witnesses[j];
      double enough = fmax(worst, scree_past_rounding(w->distance2));
      double distance2 = distance_from(corners, r->count, k, w->at, enough);
      if (distance2 > enough) worst = distance2;
      j = w->next;
    }
  return worst;
}

/* The same of the new vertex and of so many places on each new edge, from the surface kept. */
static double stray_of_edges(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                             vec3 target, int places, double worst, double most) {
  uint32_t at_target = 0;
  if (worst <= most) worst = farther(m, target, worst, &at_target);
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 end = s->vertex[s->half[r->edge[i]].from].at;
    uint32_t near = at_target;
    for (int k = 1; k <= places && worst <= most; k++)
      worst = farther(m, vec3_lerp(target, end, (double)k / (places + 1)), worst, &near);
  }
  return worst;
}

double scree_memory_stray(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                          vec3 target, double least, double most) {
  double worst = stray_of_witnesses(m, s, r, target, least, most);
  return stray_of_edges(m, s, r, target, PLACES_ON_EDGE, worst, most);
}

double scree_memory_edges_stray(const scree_memory *m, const scree_halfmesh *s,
                                const scree_ring *fan, vec3 x, double least) {
  return stray_of_edges(m, s, fan, x, PLACES_ON_EDGE, least, INFINITY);
}

bool scree_memory_edges_within(const scree_memory *m, const scree_halfmesh *s,
                               const scree_ring *fan, vec3 x, double most) {
  return stray_of_edges(m, s, fan, x, PLACES_ON_EDGE, most, most) <= most;
}

bool scree_memory_stays_within(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                               vec3 target, double most) {
  double worst = stray_of_edges(m, s, r, target, 1, most, most);
  return worst <= most && stray_of_witnesses(m, s, r, target, most, most) <= most;
}

double scree_memory_usual(const scree_memory *m) {
  scree_sum sum = {0};
  double worst = 0;
  for (size_t i = 0; i < m->count; i++) {
    if (m->witnesses[i].distance2 == DROPPED) continue;
    double distance = sqrt(m->witnesses[i].distance2);
    scree_sum_add(&sum, distance);
    worst = fmax(worst, distance);
  }
  if (!(worst > SCREE_SAME_DISTANCE)) return 0;
  return fmax(USUAL_MEANS * scree_sum_value(sum) / (double)m->left, worst);
}

/* Of the triangle's witnesses every second in the order of their distances, the largest first. */
static void thin_list(scree_memory *m, uint32_t *first) {
  uint32_t sorted = SCREE_NONE, next;
  for (uint32_t j = *first; j != SCREE_NONE; j = next) {
    uint32_t *at = &sorted;
    next = m->witnesses[j].next;
    while (*at != SCREE_NONE && m->witnesses[*at].distance2 > m->witnesses[j].distance2)
      at = &m->witnesses[*at].next;
    m->witnesses[j].next = *at;
    *at = j;
  }
  *first = sorted;
  for (uint32_t j = sorted; j != SCREE_NONE; j = next) {
    uint32_t dropped = m->witnesses[j].next;
    next = dropped;
    if (dropped == SCREE_NONE) continue;
    m->witnesses[j].next = next = m->witnesses[dropped].next;
    m->witnesses[dropped].distance2 = DROPPED;
    m->left--;
  }
}

void scree_memory_thin(scree_memory *m, const scree_halfmesh *s) {
  while (m->left > CROWD * s->live_triangle_count)
    for (size_t t = 0; t < s->triangle_count; t++)
      if (!scree_is_gone(s, t)) thin_list(m, &m->first[t]);
}

void scree_memory_compact(scree_memory *m, const scree_halfmesh *s) {
  size_t count = 0;
  for (size_t t = 0; t < s->triangle_count; t++)
    if (!scree_is_gone(s, t)) m->first[count++] = m->first[t];
}

/* The triangle of the ring whose new form is nearest to the witness. Equally near ones are usual,
 * for the nearest point often lies on an edge: of these the largest, so that the order of facets
 * does not decide; of equally large ones the first of the mesh. */
static uint32_t nearest_triangle(const scree_ring *r, double (*corners)[9], const double *size2,
                                 scree_witness *w) {
  double distance2[SCREE_RING_MAX], least = INFINITY, largest = 0;
  uint32_t nearest = SCREE_NONE;
  vec3 point;
  for (uint32_t i = 0; i < r->count; i++) {
    distance2[i] = scree_triangle_closest(corners[i], w->at, &point);
    least = fmin(least, distance2[i]);
  }
  double near = scree_past_rounding(least);
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] <= near && size2[i] > largest) largest = size2[i];
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] <= near && size2[i] >= (1 - SAME_SIZE) * largest && r->edge[i] / 3 < nearest)
      nearest = r->edge[i] / 3;
  w->distance2 = least;
  return nearest;
}

static void new_sizes(const scree_ring *r, double (*corners)[9], double *size2) {
  for (uint32_t i = 0; i < r->count; i++)
    size2[i] = vec3_norm2(vec3_triangle_normal(vec3_load(corners[i]), vec3_load(corners[i] + 3),
                                               vec3_load(corners[i] + 6)));
}

void scree_memory_move(scree_memory *m, const scree_halfmesh *s, const scree_ring *r, vec3 target) {
  double corners[SCREE_RING_MAX][9], size2[SCREE_RING_MAX];
  uint32_t moving = SCREE_NONE;
  scree_ring_corners(s, r, target, corners);
  new_sizes(r, corners, size2);
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
    uint32_t j = moving, triangle = nearest_triangle(r, corners, size2, w);
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
