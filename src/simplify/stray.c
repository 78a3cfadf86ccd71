#include "simplify/stray.h"

#include "base/parallel.h"

#include <string.h>

/* In which the farthest place is looked for. */
enum { FARTHEST_BLOCKS = 16 };

/* The least of the squared distances of p from these triangles. */
static double distance2_from(const scree_eight *eights, size_t eight_count, vec3 p) {
  double distance2[SCREE_RING_MAX], least = INFINITY;
  scree_eights_closest(eights, eight_count, p, distance2);
  for (size_t i = 0; i < SCREE_EIGHT * eight_count; i++)
    if (distance2[i] < least) least = distance2[i];
  return least;
}

/* No point of triangle k of those around is farther from the new ones: its distance from one of
 * them is largest at a corner. Of the edge's own triangles it is one at their apex, mostly. */
static double shift(const scree_halfmesh *s, const scree_ring *r, double (*corners)[9],
                    uint32_t k) {
  vec3 a = s->vertex[r->a].at, b = s->vertex[r->b].at, point;
  if (k < r->count) return sqrt(scree_triangle_closest(corners[k], k < r->a_count ? a : b, &point));
  bool at_c = k == r->count, around_a = r->a_count > 0;
  vec3 apex = s->vertex[at_c ? r->c : r->d].at;
  const double *one = corners[at_c == around_a ? 0 : around_a ? r->a_count - 1 : r->count - 1];
  double of_ends =
      fmax(scree_triangle_closest(one, a, &point), scree_triangle_closest(one, b, &point));
  return sqrt(fmax(of_ends, scree_triangle_closest(one, apex, &point)));
}

/* Witnesses of one triangle side by side. */
typedef struct witness_crowd {
  scree_points points;
  double before[SCREE_POINTS]; /* their squared distances now */
} witness_crowd;

/* Takes the next witnesses from j on, but for those nearer than `safe2`; answers what is left. */
static uint32_t gather_crowd(const scree_memory *m, uint32_t j, double safe2, witness_crowd *c) {
  c->points.count = 0;
  while (j != SCREE_NONE && c->points.count < SCREE_POINTS) {
    const scree_witness *w = &m->witnesses[j];
    j = w->next;
    if (w->distance2 < safe2) continue;
    c->before[c->points.count] = w->distance2;
    scree_points_add(&c->points, w->at);
  }
  return j;
}

/* The largest squared distance of a witness of the ring's triangles from the new ones, where it
 * grows and is above `worst`; or the first that is above `most`. The triangle whose place the
 * witness's own had is mostly near enough. */
static double stray_of_witnesses(const scree_memory *m, const scree_halfmesh *s,
                                 const scree_ring *r, vec3 target, double worst, double most) {
  double corners[SCREE_RING_MAX][9];
  scree_eight eights[SCREE_RING_MAX / SCREE_EIGHT];
  size_t eight_count = scree_eight_count(r->count);
  witness_crowd c;
  if (worst > most) return worst;
  scree_memory_ask(m, s, r);
  scree_ring_corners(s, r, target, corners);
  scree_eights_fill(corners, r->count, eights);
  for (uint32_t k = 0; k < scree_ring_triangle_count(r); k++) {
    uint32_t j = m->first[scree_ring_triangle(s, r, k)];
    if (j == SCREE_NONE) continue;
    double safe2 = 0; /* those that are no farther off now do not get beyond `worst` */
    if (m->witnesses[j].next != SCREE_NONE && m->witnesses[j].distance2 < worst) {
      double room = sqrt(worst) - shift(s, r, corners, k);
      safe2 = room > 0 ? room * room : 0;
      if (m->witnesses[j].distance2 < safe2) continue; /* it is the farthest */
    }
    while (j != SCREE_NONE) {
      j = gather_crowd(m, j, safe2, &c);
      scree_points_closest(corners[k % r->count], &c.points);
      for (int i = 0; i < c.points.count; i++) {
        double near = c.points.distance2[i];
        if (near <= worst || near <= scree_past_rounding(c.before[i])) continue;
        double distance2 = distance2_from(
            eights, eight_count, (vec3){c.points.at[0][i], c.points.at[1][i], c.points.at[2][i]});
        if (distance2 > fmax(worst, scree_past_rounding(c.before[i]))) worst = distance2;
        if (worst > most) return worst;
      }
    }
  }
  return worst;
}

/* The places on an edge, as shares of twelfths, middles first: along an edge over a hollow the
 * surface is farthest off somewhere in between. Each with the place before it that is next to it;
 * -1: the target. */
static const struct {
  int twelfths, beside;
} places[SCREE_MOST_EDGE_PLACES] = {{6, -1}, {4, 0}, {8, 0}, {2, 1}, {10, 2}, {1, 3},
                                    {3, 1},  {5, 0}, {7, 0}, {9, 2}, {11, 4}};

static double share_of_place(uint32_t k) {
  return places[k].twelfths / 12.0;
}

static vec3 place_on_edge(const scree_halfmesh *s, const scree_ring *r, vec3 target, uint32_t i,
                          uint32_t k) {
  vec3 end = s->vertex[s->half[r->edge[i]].from].at;
  return vec3_lerp(target, end, share_of_place(k));
}

/* Where to begin looking for place k of the edges, if that is not known: in its cell. All are asked
 * for at once. */
static void begin_places(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                         vec3 target, uint32_t k, scree_hints *hints) {
  uint32_t cell[SCREE_RING_MAX], first = 1 + k * r->count;
  uint32_t begin = hints->known > first ? hints->known - first : 0;
  for (uint32_t i = begin; i < r->count; i++) {
    cell[i] = scree_start_cell(&m->starts, place_on_edge(s, r, target, i, k));
    __builtin_prefetch(&m->starts.triangle[cell[i]]);
  }
  for (uint32_t i = begin; i < r->count; i++) {
    uint32_t *near = &hints->near[first + i];
    *near = m->starts.triangle[cell[i]];
    if (*near == SCREE_NONE)
      *near = places[k].beside < 0 ? hints->near[0]
                                   : hints->near[1 + (uint32_t)places[k].beside * r->count + i];
    __builtin_prefetch(&m->ways[*near]);
  }
}

/* The same of the new vertex and of the first `count` places on each new edge, from the surface
 * kept. In hints, place k of edge i has the number 1 + k * (edges) + i, the new vertex 0. */
static double stray_of_edges(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                             vec3 target, uint32_t count, double worst, double most,
                             scree_hints *hints) {
  uint32_t *near = hints->near, number = 1, known = hints->known;
  if (worst > most) return worst;
  if (hints->farthest > 0 && known > 0) {
    uint32_t place = hints->farthest - 1;
    vec3 x = place_on_edge(s, r, target, place % r->count, place / r->count);
    worst = scree_memory_farther(m, x, worst, &near[place + 1]);
    if (worst > most) return worst;
  }
  if (known == 0) near[0] = m->near[r->a];
  worst = scree_memory_farther(m, target, worst, &near[0]);
  for (uint32_t k = 0; k < count && worst <= most; k++) {
    begin_places(m, s, r, target, k, hints);
    for (uint32_t i = 0; i < r->count && worst <= most; i++, number++) {
      double found =
          scree_memory_farther(m, place_on_edge(s, r, target, i, k), worst, &near[number]);
      if (found > worst) hints->farthest = number;
      worst = found;
    }
  }
  if (number > hints->known) hints->known = number;
  return worst;
}

double scree_memory_stray(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                          vec3 target, uint32_t places_on_edge, double least, double most,
                          scree_hints *hints) {
  double worst = stray_of_witnesses(m, s, r, target, least, most);
  return stray_of_edges(m, s, r, target, places_on_edge, worst, most, hints);
}

double scree_memory_edges_stray(const scree_memory *m, const scree_halfmesh *s,
                                const scree_ring *fan, vec3 x, double least, scree_hints *hints) {
  return stray_of_edges(m, s, fan, x, SCREE_EDGE_PLACES, least, INFINITY, hints);
}

bool scree_memory_edges_within(const scree_memory *m, const scree_halfmesh *s,
                               const scree_ring *fan, vec3 x, double most, scree_hints *hints) {
  return stray_of_edges(m, s, fan, x, SCREE_EDGE_PLACES, most, most, hints) <= most;
}

bool scree_memory_stays_within(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                               vec3 target, uint32_t places_on_edge, double most) {
  scree_hints hints;
  scree_no_hints(&hints);
  double worst = stray_of_edges(m, s, r, target, places_on_edge, most, most, &hints);
  if (worst > most || !scree_memory_is_kept(m)) return worst <= most;
  return stray_of_witnesses(m, s, r, target, most, most) <= most;
}

double scree_memory_growth(const scree_memory *m, const scree_halfmesh *s, const scree_ring *r,
                           vec3 target, double least, double *worst) {
  double corners[SCREE_RING_MAX][9], growth = 0, most = least;
  scree_eight eights[SCREE_RING_MAX / SCREE_EIGHT];
  size_t eight_count = scree_eight_count(r->count);
  scree_hints hints;
  scree_no_hints(&hints);
  scree_memory_ask(m, s, r);
  scree_ring_corners(s, r, target, corners);
  scree_eights_fill(corners, r->count, eights);
  for (uint32_t k = 0; k < scree_ring_triangle_count(r); k++)
    for (uint32_t j = m->first[scree_ring_triangle(s, r, k)]; j != SCREE_NONE;
         j = m->witnesses[j].next) {
      double distance2 = distance2_from(eights, eight_count, m->witnesses[j].at);
      growth +=
          (double)m->witnesses[j].weight * (sqrt(distance2) - sqrt(m->witnesses[j].distance2));
      most = fmax(most, distance2);
    }
  *worst = scree_memory_edges_stray(m, s, r, target, most, &hints);
  return growth;
}

double scree_memory_vertex_stray(const scree_memory *m, const scree_halfmesh *s, uint32_t v,
                                 double least) {
  uint32_t near = m->near[v];
  return scree_memory_farther(m, s->vertex[v].at, least, &near);
}

double scree_memory_edge_stray(const scree_memory *m, const scree_halfmesh *s, uint32_t h,
                               double least) {
  uint32_t from = s->half[h].from, near = m->near[from];
  vec3 at = s->vertex[from].at, to = s->vertex[scree_to(s, h)].at;
  for (uint32_t k = 0; k < SCREE_EDGE_PLACES; k++)
    least = scree_memory_farther(m, vec3_lerp(at, to, share_of_place(k)), least, &near);
  return least;
}

/* Whether x is farther off than `least`; what was found before of a place nearby mostly tells that
 * it is not. */
static bool is_far_place(const scree_memory *m, vec3 x, double least, scree_place_hint *hint,
                         scree_bvh_hit *hit) {
  double moved = sqrt(vec3_norm2(vec3_sub(x, hint->at))), bound = hint->within + moved;
  if (bound * bound <= least) return false;
  hint->at = x;
  hint->within = scree_memory_walk(m, x, &hint->near);
  if (hint->within * hint->within <= least) return false;
  bool far = scree_memory_find_farther(m, x, least, hint->near, hit);
  hint->within = sqrt(hit->distance2);
  hint->near = hit->index;
  return far;
}

/* Half-edges by blocks. */
typedef struct far_search {
  const scree_memory *m;
  const scree_halfmesh *s;
  double least;
  bool hinted;
  scree_place_hint (*hints)[SCREE_LEVEL_PLACES];
  scree_far_place *far; /* those of a block from its first place on */
  size_t *counts;       /* per block */
} far_search;

/* Lists those of half-edge h; answers how many. */
static size_t list_far_of(const far_search *q, uint32_t h, scree_far_place *far) {
  const scree_memory *m = q->m;
  const scree_halfmesh *s = q->s;
  size_t count = 0;
  scree_bvh_hit hit;
  uint32_t from = s->half[h].from, twin = s->half[h].twin;
  if (from == SCREE_NONE) return 0;
  vec3 at = s->vertex[from].at, end = s->vertex[scree_to(s, h)].at;
  scree_place_hint *hint = q->hints[h];
  for (uint32_t k = 0; k < SCREE_LEVEL_PLACES && !q->hinted; k++)
    hint[k] = (scree_place_hint){at, INFINITY, m->near[from]};
  if (s->vertex[from].outgoing == h && is_far_place(m, at, q->least, &hint[0], &hit))
    far[count++] = (scree_far_place){h, 0, at, hit.point, hit.distance2};
  for (uint32_t k = 0; k < SCREE_EDGE_PLACES && h < twin; k++) {
    double share = share_of_place(k);
    vec3 x = vec3_lerp(at, end, share);
    if (!q->hinted) hint[1 + k].near = hint[1 + places[k].beside].near;
    if (is_far_place(m, x, q->least, &hint[1 + k], &hit))
      far[count++] = (scree_far_place){h, share, x, hit.point, hit.distance2};
  }
  return count;
}

static void list_far_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const far_search *q = context;
  scree_far_place *far = q->far + SCREE_LEVEL_PLACES * begin;
  size_t count = 0;
  for (size_t h = begin; h < end; h++) count += list_far_of(q, (uint32_t)h, far + count);
  q->counts[block] = count;
}

size_t scree_memory_far_places(const scree_memory *m, const scree_halfmesh *s, double least,
                               bool hinted, scree_place_hint (*hints)[SCREE_LEVEL_PLACES],
                               scree_far_place *far) {
  size_t counts[FARTHEST_BLOCKS], half_edges = 3 * s->triangle_count, count = 0;
  size_t block = half_edges / FARTHEST_BLOCKS + 1;
  far_search q = {m, s, least, hinted, hints, far, counts};
  scree_parallel_for(half_edges, block, list_far_block, &q);
  for (size_t i = 0; i < scree_block_count(half_edges, block); i++) {
    memmove(far + count, far + SCREE_LEVEL_PLACES * block * i, counts[i] * sizeof *far);
    count += counts[i];
  }
  return count;
}

/* Triangles by blocks. */
typedef struct looking {
  const scree_memory *m;
  const scree_halfmesh *s;
  double worst[FARTHEST_BLOCKS];
} looking;

static void look_at_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  looking *l = context;
  const scree_halfmesh *s = l->s;
  double worst = l->worst[block];
  for (uint32_t h = 3 * (uint32_t)begin; h < 3 * end; h++) {
    uint32_t from = s->half[h].from, twin = s->half[h].twin;
    if (from == SCREE_NONE) continue;
    if (s->vertex[from].outgoing == h) worst = scree_memory_vertex_stray(l->m, s, from, worst);
    if (h < twin) worst = scree_memory_edge_stray(l->m, s, h, worst);
  }
  l->worst[block] = worst;
}

double scree_memory_farthest(const scree_memory *m, const scree_halfmesh *s) {
  looking l = {.m = m, .s = s};
  double worst = scree_memory_witness_stray(m, s);
  for (int i = 0; i < FARTHEST_BLOCKS; i++) l.worst[i] = worst;
  scree_parallel_for(s->triangle_count, s->triangle_count / FARTHEST_BLOCKS + 1, look_at_block, &l);
  for (int i = 0; i < FARTHEST_BLOCKS; i++) worst = fmax(worst, l.worst[i]);
  return worst;
}

/* The squared distance of x from the segment between the ring's ends: mostly the answer, at little
 * cost. */
static double distance_from_edge(const scree_halfmesh *s, const scree_ring *r, vec3 x) {
  vec3 e = vec3_sub(s->vertex[r->b].at, s->vertex[r->a].at), y = vec3_sub(x, s->vertex[r->a].at);
  double t = vec3_dot(y, e) / vec3_norm2(e);
  return vec3_norm2(vec3_mad(y, e, t > 1 ? -1 : t > 0 ? -t : 0));
}

/* Whether some new triangle, looked for from `begin` on, is that near to p. */
static bool is_near_new(const scree_halfmesh *s, const scree_ring *r, vec3 target, uint32_t begin,
                        vec3 p, double most) {
  for (uint32_t k = 0; k < r->count; k++) {
    double corners[9];
    vec3 point;
    scree_ring_corners_at(s, r, (begin + k) % r->count, target, corners);
    if (scree_triangle_closest(corners, p, &point) <= most) return true;
  }
  return false;
}

bool scree_ends_stay_within(const scree_halfmesh *s, const scree_ring *r, vec3 target,
                            double most) {
  return is_near_new(s, r, target, 0, s->vertex[r->a].at, most) &&
         is_near_new(s, r, target, r->a_count, s->vertex[r->b].at, most);
}

bool scree_stays_within(const scree_halfmesh *s, const scree_ring *r, vec3 target, double most) {
  double corners[9];
  if (distance_from_edge(s, r, target) <= most) return true;
  for (uint32_t i = 0; i < r->count; i++) {
    vec3 point;
    scree_ring_corners_at(s, r, i, s->vertex[i < r->a_count ? r->a : r->b].at, corners);
    if (scree_triangle_closest(corners, target, &point) <= most) return true;
  }
  return false;
}
