/* Witnesses. The distance of one from the patch that replaces its triangle bounds its distance from
 * the level from above, as Klein, Liebich and Strasser, "Mesh reduction with error control"
 * (Visualization 1996), have it for all vertices of the mesh given. */
#include "simplify/memory.h"

#include "base/lanes.h"
#include "base/parallel.h"
#include "base/sum.h"

#include <string.h>

/* What is usual for the largest distance, in mean ones. */
#define USUAL_MEANS 10.0
/* ... and where the level is held close. */
#define CLOSE_MEANS 9.0
/* ... less so many of those with which the scan's vertices began. */
#define ROUGH_MEANS 5.0
/* How witnesses that were dropped are known. */
#define DROPPED (-1.0)
/* Witnesses that move together, and how many of them side by side. */
enum { MOVED_AT_ONCE = 512, MOVED_BLOCK = 32 };
/* Blocks of witnesses that one thread sums up. */
enum { MEAN_BLOCKS = 16 };
/* Triangles whose witnesses one thread sorts or lets follow at a time. */
enum { FOLLOWED_AT_ONCE = 64 };
/* Squared areas that differ by no more of themselves are the same. */
#define SAME_SIZE 1e-9

/* The farthest of a triangle's is its first. */
static void enlist(scree_memory *m, uint32_t j, uint32_t triangle) {
  uint32_t *at = &m->first[triangle];
  if (*at != SCREE_NONE && m->witnesses[*at].distance2 > m->witnesses[j].distance2)
    at = &m->witnesses[*at].next;
  m->witnesses[j].next = *at;
  *at = j;
}

static void add_witness(scree_memory *m, vec3 at, uint32_t triangle) {
  m->witnesses[m->count] = (scree_witness){.at = at, .weight = 1};
  enlist(m, (uint32_t)m->count++, triangle);
  m->left++;
  m->weight++;
}

/* Sums of distances by blocks of witnesses. */
typedef struct mean_sums {
  const scree_memory *m;
  scree_sum sums[MEAN_BLOCKS];
} mean_sums;

static void sum_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  mean_sums *q = context;
  scree_sum sum = {0};
  for (size_t i = begin; i < end; i++)
    if (q->m->witnesses[i].distance2 != DROPPED)
      scree_sum_add(&sum, (double)q->m->witnesses[i].weight * sqrt(q->m->witnesses[i].distance2));
  q->sums[block] = sum;
}

double scree_memory_mean(const scree_memory *m) {
  mean_sums q = {.m = m};
  size_t size = m->count / MEAN_BLOCKS + 1;
  scree_sum sum = {0};
  scree_parallel_for(m->count, size, sum_block, &q);
  for (size_t i = 0; i < scree_block_count(m->count, size); i++) scree_sum_merge(&sum, q.sums[i]);
  return scree_sum_value(sum) / m->weight;
}

double scree_memory_worst(const scree_memory *m) {
  double worst = 0;
  for (size_t i = 0; i < m->count; i++)
    if (m->witnesses[i].distance2 > worst) worst = m->witnesses[i].distance2;
  return sqrt(worst);
}

double scree_memory_witness_stray(const scree_memory *m, const scree_halfmesh *s) {
  double worst = 0;
  for (size_t t = 0; t < s->triangle_count; t++)
    if (m->first[t] != SCREE_NONE) worst = fmax(worst, m->witnesses[m->first[t]].distance2);
  return worst;
}

double scree_memory_usual(const scree_memory *m, bool close) {
  if (!(scree_memory_worst(m) > SCREE_SAME_DISTANCE)) return 0;
  double mean = scree_memory_mean(m), means = close ? CLOSE_MEANS : USUAL_MEANS;
  return fmax(means * mean - ROUGH_MEANS * m->roughness, mean);
}

/* Each vertex with the largest of its triangles, so that the order of facets does not decide; of
 * equally large ones with the first. */
static scree_status add_vertices(scree_memory *m, const scree_halfmesh *s, scree_error *error) {
  double *size2 = scree_alloc_zero(s->vertex_count, sizeof *size2);
  uint32_t *largest = scree_alloc(s->vertex_count, sizeof *largest);
  scree_status status = SCREE_OUT_OF_MEMORY;
  if (!size2 || !largest) {
    scree_fail_memory(error, s->vertex_count * sizeof *size2, "the witnesses");
    goto done;
  }
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, at);
    double n2 = vec3_norm2(vec3_triangle_normal(at[0], at[1], at[2]));
    for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
      uint32_t v = s->half[h].from;
      if (size2[v] > 0 && !(n2 > (1 + SAME_SIZE) * size2[v])) continue;
      size2[v] = n2;
      largest[v] = t;
    }
  }
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) add_witness(m, s->vertex[v].at, largest[v]);
  status = SCREE_OK;
done:
  scree_free(size2);
  scree_free(largest);
  return status;
}

static void add_placed(scree_memory *m, size_t count) {
  for (uint32_t j = 0; j < count; j++) {
    m->witnesses[j].weight = 1;
    enlist(m, j, m->witnesses[j].next);
  }
  m->count = m->left = count;
  m->weight = (double)count;
  m->roughness = scree_memory_mean(m);
}

scree_status scree_memory_keep(const scree_halfmesh *s, scree_witness *placed, size_t placed_count,
                               scree_memory *m, scree_error *error) {
  scree_status status = SCREE_OK;
  if (!scree_memory_has_surface(m)) status = scree_memory_keep_surface(s, m, error);
  m->witnesses = placed;
  if (status != SCREE_OK) goto failed;
  status = SCREE_OUT_OF_MEMORY;
  if (!placed) SCREE_ALLOC_OR(m->witnesses, s->live_vertex_count, error, failed);
  SCREE_ALLOC_OR(m->first, s->triangle_count, error, failed);
  memset(m->first, 0xff, s->triangle_count * sizeof *m->first);
  status = SCREE_OK;
  if (placed)
    add_placed(m, placed_count);
  else
    status = add_vertices(m, s, error);
failed:
  if (status != SCREE_OK) scree_memory_free(m);
  return status;
}

/* Two sorted lists into one; of equally far ones those of a first. */
static uint32_t merge(const scree_memory *m, uint32_t a, uint32_t b) {
  uint32_t first = SCREE_NONE, *end = &first;
  while (a != SCREE_NONE && b != SCREE_NONE) {
    uint32_t *next = m->witnesses[a].distance2 >= m->witnesses[b].distance2 ? &a : &b;
    *end = *next;
    end = &m->witnesses[*next].next;
    *next = *end;
  }
  *end = a != SCREE_NONE ? a : b;
  return first;
}

/* By distance, the largest first. */
static uint32_t sort_list(const scree_memory *m, uint32_t first) {
  uint32_t sorted[32], next; /* of 2^i each, or none */
  memset(sorted, 0xff, sizeof sorted);
  for (uint32_t j = first; j != SCREE_NONE; j = next) {
    int i = 0;
    uint32_t run = j;
    next = m->witnesses[j].next;
    m->witnesses[j].next = SCREE_NONE;
    for (; sorted[i] != SCREE_NONE; i++) {
      run = merge(m, run, sorted[i]);
      sorted[i] = SCREE_NONE;
    }
    sorted[i] = run;
  }
  uint32_t all = SCREE_NONE;
  for (int i = 0; i < 32; i++) all = merge(m, all, sorted[i]);
  return all;
}

static void sort_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const scree_memory *m = context;
  for (size_t t = begin; t < end; t++)
    if (m->first[t] != SCREE_NONE) m->first[t] = sort_list(m, m->first[t]);
}

/* Of the triangle's witnesses, sorted, every second. */
static void thin_list(scree_memory *m, uint32_t first) {
  for (uint32_t j = first, next; j != SCREE_NONE; j = next) {
    uint32_t dropped = m->witnesses[j].next;
    next = dropped;
    if (dropped == SCREE_NONE) continue;
    m->witnesses[j].next = next = m->witnesses[dropped].next;
    m->witnesses[dropped].distance2 = DROPPED;
    m->weight -= (double)m->witnesses[dropped].weight;
    m->left--;
  }
}

void scree_memory_thin(scree_memory *m, const scree_halfmesh *s, size_t crowd, size_t least) {
  size_t most = crowd * s->live_triangle_count;
  if (most < least) most = least;
  while (m->left > most) {
    scree_parallel_for(s->triangle_count, FOLLOWED_AT_ONCE, sort_block, m);
    for (size_t t = 0; t < s->triangle_count; t++)
      if (!scree_is_gone(s, t)) thin_list(m, m->first[t]);
  }
}

scree_status scree_memory_squeeze(scree_memory *m, const scree_halfmesh *s, scree_error *error) {
  scree_witness *kept;
  uint32_t count = 0;
  SCREE_ALLOC_OR(kept, m->left, error, out_of_memory);
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    for (uint32_t *j = &m->first[t]; *j != SCREE_NONE; j = &kept[count++].next) {
      kept[count] = m->witnesses[*j];
      *j = count;
    }
  }
  scree_free(m->witnesses);
  m->witnesses = kept;
  m->count = count;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_memory_compact(scree_memory *m, const scree_halfmesh *s) {
  size_t triangles = 0, vertices = 0;
  for (size_t t = 0; t < s->triangle_count && m->first; t++)
    if (!scree_is_gone(s, t)) m->first[triangles++] = m->first[t];
  for (size_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) m->near[vertices++] = m->near[v];
}

/* The new triangles of a ring. */
typedef struct fan {
  scree_eight eights[SCREE_RING_MAX / SCREE_EIGHT];
  size_t eight_count;
} fan;

static double size2_of(const fan *f, uint32_t i) {
  return f->eights[i / SCREE_EIGHT].n2[i % SCREE_EIGHT];
}

/* The triangle whose new form is nearest to the witness. Equally near ones are usual, for the
 * nearest point often lies on an edge: of these the largest, so that the order of facets does not
 * decide; of equally large ones the first of the mesh. */
static uint32_t nearest_triangle(const scree_ring *r, const fan *f, scree_witness *w) {
  double distance2[SCREE_RING_MAX], least = INFINITY, largest = 0;
  uint32_t nearest = SCREE_NONE;
  scree_eights_closest(f->eights, f->eight_count, w->at, distance2);
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] < least) least = distance2[i];
  double near = scree_past_rounding(least);
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] <= near && size2_of(f, i) > largest) largest = size2_of(f, i);
  for (uint32_t i = 0; i < r->count; i++)
    if (distance2[i] <= near && size2_of(f, i) >= (1 - SAME_SIZE) * largest &&
        r->edge[i] / 3 < nearest)
      nearest = r->edge[i] / 3;
  w->distance2 = least;
  return nearest;
}

/* Witnesses that get another triangle, as many as fit. */
typedef struct removal {
  const scree_memory *m;
  const scree_ring *ring;
  fan fan;
  uint32_t count, witness[MOVED_AT_ONCE], triangle[MOVED_AT_ONCE];
} removal;

static void find_nearest(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  removal *q = context;
  for (size_t i = begin; i < end; i++)
    q->triangle[i] = nearest_triangle(q->ring, &q->fan, &q->m->witnesses[q->witness[i]]);
}

static void move_gathered(scree_memory *m, removal *q) {
  scree_parallel_for(q->count, MOVED_BLOCK, find_nearest, q);
  for (uint32_t i = 0; i < q->count; i++) enlist(m, q->witness[i], q->triangle[i]);
  q->count = 0;
}

void scree_memory_move(scree_memory *m, const scree_halfmesh *s, const scree_ring *r, vec3 target) {
  removal q;
  double corners[SCREE_RING_MAX][9];
  uint32_t moving[SCREE_RING_MAX + 2], around = scree_ring_triangle_count(r);
  q.m = m;
  q.ring = r;
  q.count = 0;
  scree_ring_corners(s, r, target, corners);
  scree_eights_fill(corners, r->count, q.fan.eights);
  q.fan.eight_count = scree_eight_count(r->count);
  scree_memory_ask(m, s, r);
  scree_memory_walk(m, target, &m->near[r->a]);
  for (uint32_t k = 0; k < around; k++) {
    uint32_t *first = &m->first[scree_ring_triangle(s, r, k)];
    moving[k] = *first;
    *first = SCREE_NONE;
  }
  for (uint32_t k = 0; k < around; k++)
    for (uint32_t j = moving[k]; j != SCREE_NONE; j = m->witnesses[j].next) {
      if (q.count == MOVED_AT_ONCE) move_gathered(m, &q);
      q.witness[q.count++] = j;
    }
  move_gathered(m, &q);
}

/* By the area of their triangles, which they share; in parts of what one has on the average. */
static void weigh(scree_memory *m, const scree_halfmesh *s) {
  double unit = m->area / (double)m->count;
  m->weight = 0;
  for (size_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    double count = 0;
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) count++;
    if (!(count > 0)) continue;
    scree_corners(s, t, at);
    double area = 0.5 * vec3_norm(vec3_triangle_normal(at[0], at[1], at[2]));
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) {
      m->witnesses[j].weight = (float)(area / (count * unit));
      m->weight += (double)m->witnesses[j].weight;
    }
  }
}

void scree_memory_replace(scree_memory *m, const scree_halfmesh *s, scree_witness *witnesses,
                          size_t count) {
  removal q;
  double corners[SCREE_RING_MAX][9];
  uint32_t edges[SCREE_RING_MAX];
  scree_ring all = {.edge = edges};
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    vec3 at[3];
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, at);
    for (size_t k = 0; k < 3; k++) vec3_store(corners[all.count] + 3 * k, at[k]);
    edges[all.count++] = 3 * t;
  }
  q.m = m;
  q.ring = &all;
  q.count = 0;
  scree_eights_fill(corners, all.count, q.fan.eights);
  q.fan.eight_count = scree_eight_count(all.count);
  scree_free(m->witnesses);
  m->witnesses = witnesses;
  m->count = m->left = count;
  memset(m->first, 0xff, s->triangle_count * sizeof *m->first);
  for (uint32_t j = 0; j < count; j++) {
    if (q.count == MOVED_AT_ONCE) move_gathered(m, &q);
    q.witness[q.count++] = j;
  }
  move_gathered(m, &q);
  weigh(m, s);
}

/* How deep inside the triangle the nearest points lie, across its edges; none: on one of them. */
SCREE_LANES static void depth_lanes(const double *corners, const scree_points *p, double *depth,
                                    int count) {
  vec3 a = vec3_load(corners), b = vec3_load(corners + 3), c = vec3_load(corners + 6);
  vec3 n = vec3_unit(vec3_triangle_normal(a, b, c));
  double per_ab = 1 / vec3_norm(vec3_sub(b, a)), per_bc = 1 / vec3_norm(vec3_sub(c, b)),
         per_ca = 1 / vec3_norm(vec3_sub(a, c));
  for (int i = 0; i < count; i++) {
    vec3 x = {p->nearest[0][i], p->nearest[1][i], p->nearest[2][i]};
    vec3 xa = vec3_sub(a, x), xb = vec3_sub(b, x), xc = vec3_sub(c, x);
    double ab = per_ab * vec3_dot(n, vec3_cross(xa, xb)),
           bc = per_bc * vec3_dot(n, vec3_cross(xb, xc)),
           ca = per_ca * vec3_dot(n, vec3_cross(xc, xa));
    double least = ab < bc ? ab : bc;
    least = ca < least ? ca : least;
    depth[i] = least > 0 ? least : 0;
  }
}

/* Whether the triangles beside this one, the first, lie beyond planes upright on it. */
static bool faces_all(const scree_eight *around, size_t count) {
  bool faces = true;
  for (size_t i = 1; i < count; i++)
    faces &= around->n[0][0] * around->n[0][i] + around->n[1][0] * around->n[1][i] +
                 around->n[2][0] * around->n[2][i] >
             0;
  return faces;
}

/* Of a triangle, the first, and those beside it: as above, but that a witness stays where that is
 * as near as any. */
static size_t nearest_beside(const scree_eight *around, const double *distance2, size_t count) {
  double least = distance2[0];
  size_t nearest = SIZE_MAX;
  for (size_t i = 1; i < count; i++) least = distance2[i] < least ? distance2[i] : least;
  double near = scree_past_rounding(least);
  if (distance2[0] <= near) return 0;
  for (size_t i = 1; i < count; i++)
    if (distance2[i] <= near && (nearest == SIZE_MAX || around->n2[i] > around->n2[nearest]))
      nearest = i;
  return nearest;
}

/* Witnesses of one triangle that are to follow. */
typedef struct following {
  scree_memory *m;
  uint32_t *triangle; /* per witness: where it goes */
  uint32_t beside[4]; /* the triangle, and those beside it */
  double corners[4][9];
  size_t count;
  scree_eight around; /* these */
  bool faces;         /* all beside it */
  scree_points points;
  uint32_t witness[SCREE_POINTS];
} following;

/* Deep inside, farther from all edges than from the witness, nothing beyond them is nearer. */
static void follow_gathered(following *f) {
  double depth[SCREE_POINTS], distance2[SCREE_EIGHT];
  scree_points_closest(f->corners[0], &f->points);
  depth_lanes(f->corners[0], &f->points, depth, f->points.count);
  for (int i = 0; i < f->points.count; i++) {
    scree_witness *w = &f->m->witnesses[f->witness[i]];
    size_t nearest = 0;
    w->distance2 = f->points.distance2[i];
    if (!f->faces || !(depth[i] * depth[i] > (1 + SAME_SIZE) * w->distance2)) {
      scree_eights_closest(&f->around, 1, w->at, distance2);
      nearest = nearest_beside(&f->around, distance2, f->count);
      w->distance2 = distance2[nearest];
    }
    f->triangle[f->witness[i]] = f->beside[nearest];
  }
  f->points.count = 0;
}

/* Those of triangle t. */
static void follow_from(following *f, const scree_halfmesh *s, uint32_t t) {
  const scree_memory *m = f->m;
  f->beside[0] = t;
  f->count = 1;
  for (uint32_t h = 3 * t; h < 3 * t + 3; h++)
    if (s->half[h].twin != SCREE_NONE) f->beside[f->count++] = s->half[h].twin / 3;
  for (size_t i = 0; i < f->count; i++) {
    vec3 at[3];
    scree_corners(s, f->beside[i], at);
    for (size_t k = 0; k < 3; k++) vec3_store(f->corners[i] + 3 * k, at[k]);
  }
  scree_eights_fill(f->corners, f->count, &f->around);
  f->faces = faces_all(&f->around, f->count);
  for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) {
    f->witness[f->points.count] = j;
    scree_points_add(&f->points, m->witnesses[j].at);
    if (f->points.count == SCREE_POINTS) follow_gathered(f);
  }
  if (f->points.count > 0) follow_gathered(f);
}

typedef struct following_all {
  scree_memory *m;
  const scree_halfmesh *s;
  uint32_t *triangle;
} following_all;

static void follow_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const following_all *all = context;
  following f = {.m = all->m, .triangle = all->triangle};
  for (size_t t = begin; t < end; t++)
    if (all->m->first[t] != SCREE_NONE) follow_from(&f, all->s, (uint32_t)t);
}

void scree_memory_follow(scree_memory *m, const scree_halfmesh *s, uint32_t *lists,
                         uint32_t *triangle) {
  following_all all = {m, s, triangle};
  scree_parallel_for(s->triangle_count, FOLLOWED_AT_ONCE, follow_block, &all);
  memcpy(lists, m->first, s->triangle_count * sizeof *lists);
  memset(m->first, 0xff, s->triangle_count * sizeof *m->first);
  for (size_t t = 0; t < s->triangle_count; t++)
    for (uint32_t j = lists[t], next; j != SCREE_NONE; j = next) {
      next = m->witnesses[j].next;
      enlist(m, j, triangle[j]);
    }
}
