#include "simplify/cost/deviation.h"

#include "base/array.h"
#include "base/parallel.h"
#include "base/radix.h"
#include "mesh/measure/bounds.h"
#include "simplify/morton.h"
#include "simplify/tuning.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = 1024 };
/* Squared distances, and areas, that differ by rounding alone. */
#define EQUAL 1e-9
#define PI    3.141592653589793
/* In place of a distance. */
#define NOT_YET (-1.0F)
#define DROPPED (-2.0F)

void scree_samples_free(scree_samples *p) {
  if (!p->borrows) {
    scree_halfmesh_free(&p->scan);
    scree_surface_tree_free(&p->scan_tree);
    scree_free(p->end);
  }
  scree_free(p->of);
  scree_free(p->first);
  scree_free(p->worst);
  scree_free(p->next);
  scree_free(p->far);
  *p = (scree_samples){0};
}

scree_status scree_samples_copy(const scree_samples *p, const scree_halfmesh *surface,
                                scree_samples *copy, scree_error *error) {
  *copy = *p;
  copy->borrows = true;
  copy->of = copy->first = copy->next = NULL, copy->worst = copy->far = NULL;
#define COPY(field, count)                                                                         \
  SCREE_TRY_ALLOC(copy->field, count, error);                                                      \
  memcpy(copy->field, p->field, (count) * sizeof *copy->field);
  COPY(of, surface->vertex_count)
  COPY(first, surface->triangle_count)
  COPY(worst, surface->triangle_count)
  COPY(next, p->scan.vertex_count)
  COPY(far, p->scan.vertex_count)
  return SCREE_OK;
}

/* ---- Finding them ---- */

typedef struct finding {
  const scree_halfmesh *s;
  const scree_surface_tree *tree;
  scree_samples *samples;
  bool *stays; /* per vertex of the scan: the surface has it as it was */
} finding;

/* The largest of the triangles about the nearest that are as near, whatever their order. */
static uint32_t largest_about(const scree_halfmesh *s, uint32_t nearest, vec3 p, double distance2) {
  vec3 corner[3];
  double area2 = 0;
  uint32_t largest = nearest;
  for (uint32_t k = 3 * nearest; k < 3 * nearest + 3; k++) {
    uint32_t first = s->vertex[s->half[k].from].outgoing, h = first;
    do {
      scree_corners(s, h / 3, corner);
      double n2 = vec3_norm2(vec3_triangle_normal(corner[0], corner[1], corner[2]));
      if (n2 > (1 + EQUAL) * area2 && scree_distance2(corner, p) <= (1 + EQUAL) * distance2) {
        area2 = n2;
        largest = h / 3;
      }
      h = scree_turn(s, h);
    } while (h != first && h != SCREE_NONE);
  }
  return largest;
}

static void find_block(void *context, scree_block block) {
  const finding *f = context;
  scree_samples *p = f->samples;
  uint32_t nearest = SCREE_NONE; /* that of the one before is near */
  for (size_t v = block.begin; v < block.end; v++) {
    p->far[v] = NOT_YET;
    if (f->stays[v] || p->scan.vertex[v].outgoing == SCREE_NONE) continue;
    double d2 = scree_surface_tree_distance(f->tree, f->s, p->scan.vertex[v].at, 0, &nearest);
    p->far[v] = (float)sqrt(d2);
    p->next[v] = largest_about(f->s, nearest, p->scan.vertex[v].at, d2);
  }
}

/* The surface's vertices are named by those of the scan; what still is where it was stays. */
static scree_status match(finding *f, scree_error *error) {
  const scree_halfmesh *s = f->s, *scan = &f->samples->scan;
  uint32_t origins = 0; /* of the mesh's vertices in the reference surface */
  for (size_t v = 0; v < scan->vertex_count; v++)
    if (scan->vertex[v].origin >= origins) origins = scan->vertex[v].origin + 1;
  SCREE_SCRATCH(uint32_t, number, origins, error);
  for (uint32_t v = (uint32_t)scan->vertex_count; v-- > 0;) number[scan->vertex[v].origin] = v;
  memset(f->stays, 0, scan->vertex_count * sizeof *f->stays);
  for (size_t v = 0; v < s->vertex_count; v++) {
    if (s->vertex[v].outgoing == SCREE_NONE) continue;
    uint32_t same = f->samples->of[v] = number[s->vertex[v].origin];
    vec3 moved = vec3_sub(s->vertex[v].at, scan->vertex[same].at);
    f->stays[same] = vec3_norm2(moved) == 0;
  }
  return SCREE_OK;
}

/* To the front of the triangle's list, or behind its first, which deviates most. */
static void list_sample(scree_samples *p, uint32_t t, uint32_t v) {
  float deviation = (float)scree_deviation_of(p, v, (double)p->far[v]);
  uint32_t *link = &p->first[t];
  if (*link != SCREE_NONE && deviation <= p->worst[t]) link = &p->next[*link];
  p->worst[t] = fmaxf(p->worst[t], deviation);
  p->next[v] = *link;
  *link = v;
}

/* From the last on, so that lists ascend but for their first. */
static void link_all(scree_samples *p, const scree_halfmesh *s) {
  memset(p->first, 0xff, s->triangle_count * sizeof *p->first);
  memset(p->worst, 0, s->triangle_count * sizeof *p->worst);
  for (uint32_t v = (uint32_t)p->scan.vertex_count; v-- > 0;) {
    if (p->far[v] < 0) continue;
    list_sample(p, p->next[v], v);
  }
}

static void end_block(void *context, scree_block block) {
  const scree_samples *p = context;
  for (size_t v = block.begin; v < block.end; v++)
    p->end[v] = (int8_t)scree_extent_end(&p->extent, p->scan.vertex[v].at);
}

/* The axes of the least box, in which widths of levels are judged: of a flat body none is wide
 * along its thickness, as it may be a degree from there. */
static scree_status find_frame(const scree_positions *places, vec3 middle, mat3 *frame,
                               scree_error *error) {
  scree_principal_frame principal;
  SCREE_CLEANUP(scree_hull_free) scree_hull hull = {0};
  scree_minimum_box box;
  SCREE_TRY(scree_principal_frame_find(places, middle, &principal, error));
  SCREE_SCRATCH(vec3, points, places->count, error);
  for (size_t v = 0; v < places->count; v++)
    points[v] = vec3_sub(vec3_load(places->at + v * places->stride), middle);
  SCREE_TRY(scree_hull_build(points, places->count, &hull, error));
  SCREE_TRY(scree_minimum_box_fit(&hull, &principal.axes, &box, error));
  *frame = box.axes;
  return SCREE_OK;
}

static scree_status measure_extent(scree_samples *p, scree_error *error) {
  const scree_halfmesh *scan = &p->scan;
  const scree_positions places = {&scan->vertex->at.x, sizeof *scan->vertex / sizeof(double),
                                  scan->vertex_count};
  mat3 frame;
  SCREE_TRY(find_frame(&places, vec3_lerp(scan->low, scan->high, 0.5), &frame, error));
  scree_extent_start(&p->extent, (const double(*)[3])frame.m);
  for (size_t v = 0; v < scan->vertex_count; v++) scree_extent_add(&p->extent, scan->vertex[v].at);
  for (int i = 0; i < SCREE_EXTENT_COUNT; i++)
    p->weight[i] = scree_larger(1, scree_tune.grow * sqrt(scan->area / PI) /
                                       scree_extent_width(&p->extent, i));
  SCREE_TRY_ALLOC(p->end, scan->vertex_count, error);
  scree_parallel_for(scan->vertex_count, BLOCK, end_block, p);
  return SCREE_OK;
}

scree_status scree_samples_start(scree_samples *p, scree_error *error) {
  SCREE_TRY(scree_surface_tree_make(&p->scan, &p->scan_tree, error));
  return measure_extent(p, error);
}

scree_status scree_samples_find(const scree_halfmesh *surface, const scree_surface_tree *tree,
                                scree_samples *p, scree_error *error) {
  SCREE_SCRATCH(bool, stays, p->scan.vertex_count, error);
  finding f = {.s = surface, .tree = tree, .samples = p, .stays = stays};
  size_t count = p->scan.vertex_count;
  SCREE_TRY_ALLOC(p->of, surface->vertex_count, error);
  SCREE_TRY_ALLOC(p->first, surface->triangle_count, error);
  SCREE_TRY_ALLOC(p->worst, surface->triangle_count, error);
  SCREE_TRY_ALLOC(p->next, count, error);
  SCREE_TRY_ALLOC(p->far, count, error);
  SCREE_TRY(match(&f, error));
  scree_parallel_for(count, BLOCK, find_block, &f);
  link_all(p, surface);
  return scree_samples_average(p, error);
}

typedef struct averaging {
  const scree_samples *samples;
  struct {
    double sum;
    size_t count;
  } * blocks;
} averaging;

static void average_block(void *context, scree_block block) {
  const averaging *a = context;
  double sum = 0;
  size_t count = 0;
  for (size_t v = block.begin; v < block.end; v++)
    if (a->samples->far[v] >= 0) sum += (double)a->samples->far[v], count++;
  a->blocks[block.index].sum = sum;
  a->blocks[block.index].count = count;
}

scree_status scree_samples_average(scree_samples *p, scree_error *error) {
  averaging a = {.samples = p};
  size_t blocks = scree_block_count(p->scan.vertex_count, BLOCK);
  SCREE_TRY_ALLOC(a.blocks, blocks, error);
  scree_parallel_for(p->scan.vertex_count, BLOCK, average_block, &a);
  double sum = 0;
  p->count = 0;
  for (size_t i = 0; i < blocks; i++) sum += a.blocks[i].sum, p->count += a.blocks[i].count;
  p->mean = p->count > 0 ? sum / (double)p->count : 0;
  scree_free(a.blocks);
  return SCREE_OK;
}

void scree_samples_compact(scree_samples *p, const scree_halfmesh *s) {
  size_t count = 0;
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    p->first[count] = p->first[t];
    p->worst[count++] = p->worst[t];
  }
  count = 0;
  for (size_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) p->of[count++] = p->of[v];
}

/* ---- About one collapse ---- */

static bool gather(scree_gathered *g, uint32_t sample, uint32_t start) {
  return SCREE_PUSH(g, (struct scree_sample){.sample = sample, .start = start});
}

bool scree_samples_gather(const scree_samples *p, const scree_halfmesh *s, const scree_fan *f,
                          scree_gathered *g) {
  bool room = true;
  g->count = 0;
  if (p->far[p->of[f->a]] == NOT_YET) room &= gather(g, p->of[f->a], 0);
  if (f->b != f->a && p->far[p->of[f->b]] == NOT_YET) room &= gather(g, p->of[f->b], 0);
  for (uint32_t k = 0; k < scree_fan_triangle_count(f); k++)
    for (uint32_t v = p->first[scree_fan_triangle(s, f, k)]; v != SCREE_NONE; v = p->next[v])
      room &= gather(g, v, k < f->count ? k : 0);
  return room;
}

/* The squared distance of p from the fan as it is set or, where that is at most `enough`, of any of
 * its triangles; *nearest is looked at first, and becomes the one found. */
static double to_fan(const scree_fan *f, vec3 p, double enough, uint32_t *nearest) {
  double best = INFINITY;
  for (uint32_t k = 0, i = *nearest; k < f->count && best > enough;
       k++, i = i + 1 < f->count ? i + 1 : 0) {
    const vec3 corner[3] = {f->at, f->from[i], f->to[i]};
    double d = scree_distance2(corner, p);
    if (d < best) best = d, *nearest = i;
  }
  return best;
}

/* The fan's triangle that is nearest to p; of those that are equally near, at a common edge or at
 * the new vertex, the largest, whatever their order. */
static uint32_t nearest_of_fan(const scree_fan *f, vec3 p, double *distance2) {
  double best = INFINITY, area2 = 0;
  uint32_t nearest = 0;
  for (uint32_t i = 0; i < f->count; i++) {
    const vec3 corner[3] = {f->at, f->from[i], f->to[i]};
    double d = scree_distance2(corner, p), n2 = vec3_norm2(f->after[i]);
    if (d > (1 + EQUAL) * best || (d > (1 - EQUAL) * best && n2 <= (1 + EQUAL) * area2)) continue;
    best = scree_smaller(d, best);
    area2 = n2;
    nearest = i;
  }
  *distance2 = best;
  return nearest;
}

/* The squared distance of p from the scan or, where that is at most `enough`, of a part of it:
 * first of the triangles about the nearest of a list of samples. */
static double to_scan(const scree_samples *p, vec3 at, uint32_t first_sample, uint32_t nearest,
                      double enough) {
  const scree_halfmesh *scan = &p->scan;
  double best = vec3_norm2(vec3_sub(at, scan->vertex[nearest].at));
  for (uint32_t v = first_sample; v != SCREE_NONE && best > enough; v = p->next[v]) {
    double d = vec3_norm2(vec3_sub(at, scan->vertex[v].at));
    if (d < best) best = d, nearest = v;
  }
  if (best <= enough) return best;
  uint32_t first = scan->vertex[nearest].outgoing, h = first, hint = h / 3;
  do {
    vec3 corner[3];
    scree_corners(scan, h / 3, corner);
    double d = scree_distance2(corner, at);
    if (d <= enough) return d;
    if (d < best) best = d, hint = h / 3;
    h = scree_turn(scan, h);
  } while (h != first && h != SCREE_NONE);
  return scree_surface_tree_distance(&p->scan_tree, scan, at, enough, &hint);
}

double scree_deviation_bound(const scree_samples *p, const scree_halfmesh *s, const scree_fan *f) {
  double worst = 0, rise2 = 0;
  for (uint32_t k = 0; k < scree_fan_triangle_count(f); k++) {
    uint32_t t = scree_fan_triangle(s, f, k);
    vec3 at[3];
    scree_corners(s, t, at);
    vec3 n = vec3_triangle_normal(at[0], at[1], at[2]);
    double along = vec3_dot(n, vec3_sub(f->at, at[0])), n2 = vec3_norm2(n);
    rise2 = scree_larger(rise2, n2 > 0 ? along * along / n2 : 0);
    worst = scree_larger(worst, (double)p->worst[t]);
  }
  return worst + sqrt(rise2);
}

static double weight_at(const scree_samples *p, uint32_t v) {
  return p->weight[p->end[v] < 0 ? ~p->end[v] : p->end[v]];
}

/* `far - depth` bounds the share of the width that is lost. */
double scree_deviation_of(const scree_samples *p, uint32_t v, double far) {
  double depth = scree_extent_depth(&p->extent, p->end[v], p->scan.vertex[v].at);
  return scree_larger(far, (far - depth) * weight_at(p, v));
}

/* How far the sample may be for no more than this deviation. */
static double far_for(const scree_samples *p, uint32_t v, double deviation) {
  double depth = scree_extent_depth(&p->extent, p->end[v], p->scan.vertex[v].at);
  return scree_smaller(deviation, depth + deviation / weight_at(p, v));
}

double scree_deviation_growth(const scree_samples *p, const scree_halfmesh *s, vec3 at) {
  return scree_extent_beyond(&p->extent, at, scree_tune.grow * sqrt(s->area / PI));
}

/* The greatest deviation so far, and squared, and what is asked of that. */
typedef struct search {
  double deviation, deviation2, most2;
} search;

/* Takes one sample into account; start: the fan's triangle to look at first. */
static void heed_sample(const scree_samples *p, const scree_fan *f, uint32_t v, uint32_t start,
                        search *w) {
  double enough = far_for(p, v, w->deviation),
         far2 = to_fan(f, p->scan.vertex[v].at, enough * enough, &start);
  if (far2 <= enough * enough) return;
  double lost = scree_deviation_of(p, v, sqrt(far2));
  w->deviation2 = scree_larger(w->deviation2, lost * lost);
  w->deviation = sqrt(w->deviation2);
}

/* The samples about the fan: first the ends, and of every list the first, which is the farthest. */
static void heed_samples(const scree_samples *p, const scree_halfmesh *s, const scree_fan *f,
                         search *w) {
  const uint32_t ends[2] = {p->of[f->a], p->of[f->b]}, count = scree_fan_triangle_count(f);
  for (int k = 0; k < 1 + (f->b != f->a); k++)
    if (p->far[ends[k]] == NOT_YET) heed_sample(p, f, ends[k], 0, w);
  for (int rest = 0; rest < 2; rest++)
    for (uint32_t k = 0; k < count && w->deviation2 <= w->most2; k++) {
      uint32_t v = p->first[scree_fan_triangle(s, f, k)], start = k < f->count ? k : 0;
      if (v != SCREE_NONE && !rest) heed_sample(p, f, v, start, w);
      while (rest && v != SCREE_NONE && (v = p->next[v]) != SCREE_NONE && w->deviation2 <= w->most2)
        heed_sample(p, f, v, start, w);
    }
}

double scree_deviation_find(const scree_samples *p, const scree_halfmesh *s, const scree_fan *f,
                            double from, double to) {
  search w = {sqrt(from * from), from * from, to * to};
  heed_samples(p, s, f, &w);
  if (w.deviation2 <= w.most2)
    w.deviation2 = scree_larger(
        w.deviation2, to_scan(p, f->at, p->first[f->edge[0] / 3], p->of[f->a], w.deviation2));
  for (uint32_t i = 0; i < f->count && w.deviation2 <= w.most2; i++) {
    uint32_t near = p->of[s->half[f->edge[i]].from], first = p->first[f->edge[i] / 3];
    w.deviation2 = scree_larger(
        w.deviation2, to_scan(p, vec3_lerp(f->at, f->from[i], 0.5), first, near, w.deviation2));
  }
  return sqrt(w.deviation2);
}

SCREE_ORDER_BY2(by_distance, struct scree_sample, far, sample)

/* Drops every fourth of those that tell little, in the order of distance: it does not hang on
 * their numbers, and what is left has about the same distances. */
static void thin(scree_samples *p, scree_gathered *g) {
  size_t left = 0, near = 0;
  for (size_t k = 0; k < g->count; k++) g->items[k].far = p->far[g->items[k].sample];
  qsort(g->items, g->count, sizeof *g->items, by_distance);
  for (size_t k = 0; k < g->count; k++) {
    struct scree_sample item = g->items[k];
    if (item.far >= 0 && (double)item.far < 2 * p->mean && near++ % 4 == 3)
      p->far[item.sample] = DROPPED;
    else
      g->items[left++] = item;
  }
  g->count = left;
}

void scree_samples_settle(scree_samples *p, const scree_fan *f, const scree_gathered *g) {
  for (uint32_t i = 0; i < f->count; i++) {
    p->first[f->edge[i] / 3] = SCREE_NONE;
    p->worst[f->edge[i] / 3] = 0;
  }
  for (size_t k = 0; k < g->count; k++) {
    uint32_t v = g->items[k].sample;
    double distance2;
    uint32_t t = f->edge[nearest_of_fan(f, p->scan.vertex[v].at, &distance2)] / 3;
    p->far[v] = (float)sqrt(distance2);
    list_sample(p, t, v);
  }
}

bool scree_samples_move(scree_samples *p, const scree_halfmesh *s, const scree_fan *f,
                        scree_gathered *g) {
  if (!scree_samples_gather(p, s, f, g)) return false;
  if (g->count > (size_t)scree_tune.crowd * f->count) thin(p, g);
  scree_samples_settle(p, f, g);
  return true;
}
