/* Decimation by edge collapses in the order of their cost.
 *
 *   passes:    rank all edges side by side, collapse the cheapest that are allowed; again, while
 *              that is worth its parallel loops. On the way the surface becomes the reference
 *              surface: the scan itself where it is not larger.
 *   samples:   the vertices of the reference surface that went become samples of the distance.
 *   in order:  a queue of all edges; the cheapest is judged, and collapsed if it is allowed and
 *              still the cheapest. Costs are found anew whenever a quarter of the triangles has
 *              gone. Where nothing is allowed any more the guards become more lenient, twice.
 *              This part may be done again in other orders, for which costs are raised by a share
 *              drawn for each edge (scree_tune.shift).
 *
 * The whole cost of a collapse (cost/volume.c has E and A) is
 *
 *     E + drift A D^4 + C (D / F)^6
 *
 * D the deviation from the scan (cost/deviation.h): its second part weighs D against the size of
 * the triangles, the third against what is usual for the level, C the cost that a tenth of the
 * edges do not exceed and F some times the mean distance of the samples. To find D is dear; it is
 * found when the edge's turn comes, and only as far as it decides.
 *
 * Garland and Heckbert 1997, "Surface simplification using quadric error metrics": greedy collapses
 * in the order of a quadratic cost. Lindstrom and Turk 1998, "Fast and memory efficient polygonal
 * simplification": E, and places that keep the volume (cost/volume.c). Klein, Liebich and Strasser
 * 1996, "Mesh reduction with error control": samples (cost/deviation.h). Hoppe 1996, "Progressive
 * meshes": the record. */
#include "simplify/decimate.h"

#include "base/parallel.h"
#include "base/radix.h"
#include "simplify/tuning.h"

#include <stdlib.h>

enum { SUM_BLOCK = 1024 };
/* A tenth of the edges are cheaper than what is usual. */
enum { USUAL_SHARE = 10 };

/* ---- The run ---- */

/* The surface as it is becomes the reference surface, and passes go on as long as they are worth
 * their parallel loops. */
static scree_status take_samples(scree_decimator *d) {
  SCREE_TRY(scree_decimate_refresh(d));
  SCREE_TRY(scree_halfmesh_copy(&d->s, &d->samples.scan, d->error));
  SCREE_TRY(scree_decimate_in_passes(d, SCREE_PASS_LEAST));
  SCREE_TRY(scree_decimate_refresh(d));
  SCREE_TRY(scree_samples_start(&d->samples, d->error));
  return scree_samples_find(&d->s, &d->tree, &d->samples, d->error);
}

static scree_status keep_fork(scree_decimator *d) {
  d->fork.collapse_count = d->record.count;
  SCREE_TRY(scree_halfmesh_copy(&d->s, &d->fork.s, d->error));
  return scree_samples_copy(&d->samples, &d->s, &d->fork.samples, d->error);
}

static scree_status go_to_end(scree_decimator *d) {
  while (d->leniency < SCREE_LENIENCIES && d->s.live_triangle_count > d->options.stop_count) {
    size_t done;
    SCREE_TRY(scree_decimate_refresh(d));
    bool forks = !d->fork.s.vertex && d->order == 0 && scree_has_samples(&d->samples);
    if (forks && d->s.live_triangle_count <= SCREE_FORK_MOST) SCREE_TRY(keep_fork(d));
    SCREE_TRY(scree_decimate_in_order(d, &done));
    if (done == 0) d->leniency++;
  }
  return SCREE_OK;
}

scree_status scree_decimate(scree_decimator *d) {
  const bool by_cost_alone = d->coster->merge;
  SCREE_TRY(scree_decimate_in_passes(d, by_cost_alone ? SCREE_PASS_LEAST : SCREE_REFERENCE_MOST));
  if (!by_cost_alone) SCREE_TRY(take_samples(d));
  return go_to_end(d);
}

/* ---- Start and end ---- */

static void sum_block(void *context, scree_block block) {
  scree_decimator *d = context;
  for (size_t v = block.begin; v < block.end; v++)
    if (d->s.vertex[v].outgoing != SCREE_NONE) d->coster->sum(&d->s, (uint32_t)v);
}

/* The sums of all vertices. */
static scree_status sum_all(scree_decimator *d) {
  SCREE_TRY_ALLOC(d->s.sums, d->s.vertex_count, d->error);
  scree_parallel_for(d->s.vertex_count, SUM_BLOCK, sum_block, d);
  return SCREE_OK;
}

/* Area and volume, by blocks of triangles. */
typedef struct measuring {
  const scree_halfmesh *s;
  struct {
    scree_sum area, volume;
  } * blocks;
} measuring;

enum { MEASURE_BLOCK = 8192 };

static void measure_block(void *context, scree_block block) {
  const measuring *m = context;
  scree_sum area = {0}, volume = {0};
  for (size_t t = block.begin; t < block.end; t++) scree_add_triangle(m->s, t, &area, &volume);
  m->blocks[block.index].area = area;
  m->blocks[block.index].volume = volume;
}

static scree_status measure_surface(const scree_halfmesh *s, scree_sum *area, scree_sum *volume,
                                    scree_error *error) {
  measuring m = {.s = s};
  size_t count = scree_block_count(s->triangle_count, MEASURE_BLOCK);
  SCREE_TRY_ALLOC(m.blocks, count, error);
  scree_parallel_for(s->triangle_count, MEASURE_BLOCK, measure_block, &m);
  for (size_t i = 0; i < count; i++) {
    scree_sum_merge(area, m.blocks[i].area);
    scree_sum_merge(volume, m.blocks[i].volume);
  }
  scree_free(m.blocks);
  return SCREE_OK;
}

static void set_error_limit(scree_decimator *d) {
  double limit = d->options.error_limit / d->s.scale;
  d->error_limit = limit > 0 ? limit * limit : INFINITY;
}

scree_status scree_decimator_start(scree_decimator *d, const scree_mesh *mesh,
                                   const scree_simplify_options *options, scree_error *error) {
  *d = (scree_decimator){.options = *options,
                         .first_triangle_count = mesh->triangle_count,
                         .usual_far = INFINITY,
                         .expect = scree_tune.expect,
                         .error = error};
  d->coster = options->method == SCREE_METHOD_QECD ? &scree_qecd_coster : &scree_volume_coster;
  SCREE_TRY(scree_halfmesh_build(mesh, NULL, &d->s, error));
  set_error_limit(d);
  SCREE_TRY(measure_surface(&d->s, &d->area, &d->volume, error));
  d->s.area = scree_sum_value(d->area);
  SCREE_TRY(scree_collapse_record_allocate(&d->record, d->s.live_vertex_count, error));
  SCREE_TRY(sum_all(d));
  return scree_surface_tree_make(&d->s, &d->tree, error);
}

scree_status scree_decimate_from(scree_decimator *d, const scree_fork *fork, int order,
                                 const scree_simplify_options *options, scree_error *error) {
  *d = (scree_decimator){.coster = &scree_volume_coster,
                         .options = *options,
                         .first_triangle_count = fork->s.live_triangle_count,
                         .usual_far = INFINITY,
                         .expect = scree_tune.expect,
                         .order = order,
                         .error = error};
  SCREE_TRY(scree_halfmesh_copy(&fork->s, &d->s, error));
  SCREE_TRY(scree_samples_copy(&fork->samples, &d->s, &d->samples, error));
  set_error_limit(d);
  SCREE_TRY(scree_collapse_record_allocate(&d->record, d->s.live_vertex_count, error));
  SCREE_TRY(sum_all(d));
  SCREE_TRY(scree_surface_tree_make(&d->s, &d->tree, error));
  return go_to_end(d);
}

void scree_fork_free(scree_fork *fork) {
  scree_halfmesh_free(&fork->s);
  scree_samples_free(&fork->samples);
}

void scree_decimator_free(scree_decimator *d) {
  scree_fork_free(&d->fork);
  scree_halfmesh_free(&d->s);
  scree_collapse_record_free(&d->record);
  scree_surface_tree_free(&d->tree);
  scree_markers_free(&d->markers);
  scree_samples_free(&d->samples);
}

/* What is still to do at so many triangles, in those that go one by one: passes take less time for
 * each. */
static double work_left(double count) {
  static const double FASTER = 8;
  double one_by_one = scree_smaller(count, SCREE_PASS_LEAST);
  return one_by_one + (count - one_by_one) / FASTER;
}

bool scree_decimate_tick(scree_decimator *d) {
  double all = work_left((double)d->first_triangle_count);
  double end = work_left((double)d->options.stop_count);
  double left = work_left((double)d->s.live_triangle_count);
  return scree_tick(&d->ticker, "decimating", all > end ? (all - left) / (all - end) : 0);
}

static scree_status squeeze(scree_decimator *d) {
  SCREE_SCRATCH(uint32_t, vertices, d->s.vertex_count, d->error);
  SCREE_SCRATCH(uint32_t, triangles, d->s.triangle_count, d->error);
  if (scree_has_samples(&d->samples)) scree_samples_compact(&d->samples, &d->s);
  scree_halfmesh_compact(&d->s, vertices, triangles);
  scree_halfmesh_give_back(&d->s);
  return scree_markers_find(&d->s, &d->markers, d->error);
}

scree_status scree_decimate_refresh(scree_decimator *d) {
  SCREE_TRY(squeeze(d));
  scree_surface_tree_fit(&d->tree, &d->s);
  return scree_has_samples(&d->samples) ? scree_samples_average(&d->samples, d->error) : SCREE_OK;
}

double scree_decimate_set_usual(scree_decimator *d, double *costs, size_t count, double share) {
  scree_sort_numbers(costs, count);
  if (scree_has_samples(&d->samples) && d->samples.mean > 0) {
    d->usual_cost = costs[count / USUAL_SHARE];
    d->usual_far = scree_tune.usual * d->samples.mean;
  }
  return costs[(size_t)(share * (double)(count - 1))];
}

/* ---- One edge ---- */

/* What a deviation adds to the cost of a collapse with that area around. */
static double penalty(const scree_decimator *d, double area, double far) {
  double r = far / d->usual_far, square = far * far;
  return scree_tune.drift * area * square * square + d->usual_cost * r * r * r * r * r * r;
}

/* About the least deviation that adds so much. */
static double deviation_for(const scree_decimator *d, double area, double cost) {
  double drift = pow(cost / (scree_tune.drift * area), 1.0 / 4);
  double usual = d->usual_cost > 0 ? d->usual_far * pow(cost / d->usual_cost, 1.0 / 6) : INFINITY;
  return fmin(1, fmin(drift, usual));
}

/* The cost with the deviation's part, of the fan as it is set; above `most` a lower bound, at least
 * `most`. */
static double whole_cost(const scree_decimator *d, const scree_fan *f, const scree_candidate *c,
                         double most) {
  if (!scree_has_samples(&d->samples)) return c->cost;
  double from = deviation_for(d, c->area, scree_tune.heed * c->cost);
  double grown = scree_deviation_growth(&d->samples, &d->s, f->at);
  if (scree_larger(grown, scree_deviation_bound(&d->samples, &d->s, f)) <= from) return c->cost;
  double rest = most - c->cost;
  double to = most < INFINITY ? deviation_for(d, c->area, rest > 0 ? rest : 0) : INFINITY;
  double far = scree_larger(scree_deviation_find(&d->samples, &d->s, f, from, to), grown);
  if (far <= from) return c->cost;
  double cost = c->cost + penalty(d, c->area, far);
  return far <= to ? cost : scree_larger(most, cost);
}

/* Tries one place; the fan is set to it. */
static void try_place(const scree_decimator *d, const scree_candidate *c, double most, scree_fan *f,
                      scree_verdict *v) {
  if (!(c->cost < INFINITY) || c->error > d->error_limit || scree_shape_is_spike(&d->s, c->target))
    return;
  scree_fan_set(f, c->target);
  if (!scree_shape_allows(&d->s, f, d->leniency)) return;
  double cost = whole_cost(d, f, c, fmin(v->cost, most));
  if (!(cost < v->cost)) return;
  v->cost = cost;
  v->target = c->target;
  v->error = c->error;
}

SCREE_ORDER_BY(by_cost, scree_candidate, cost)

scree_verdict scree_decimate_judge(const scree_decimator *d, uint32_t h, double most,
                                   scree_fan *f) {
  static const double NEAR = 2; /* another place is hardly worth its time for less */
  scree_verdict v = {.cost = INFINITY};
  scree_candidate best, others[SCREE_FALLBACK_COUNT];
  d->coster->evaluate(&d->s, &h, 1, &best);
  v.plain = best.cost;
  if (best.cost > most) v.cost = best.cost;
  if (best.cost > most || !scree_fan_of_edge(&d->s, h, f) || !scree_fan_keeps_topology(&d->s, f))
    return v;
  try_place(d, &best, most, f, &v);
  if (!(v.cost < NEAR * best.cost)) {
    for (int k = 0; k < SCREE_FALLBACK_COUNT; k++) d->coster->fall_back(&d->s, h, k, &others[k]);
    qsort(others, SCREE_FALLBACK_COUNT, sizeof *others, by_cost);
    for (int k = 0; k < SCREE_FALLBACK_COUNT && !(v.cost < NEAR * others[k].cost); k++)
      if (others[k].cost < most)
        try_place(d, &others[k], most, f, &v);
      else
        v.cost = fmin(v.cost, others[k].cost); /* it may be allowed */
  }
  if (v.cost < INFINITY) scree_fan_set(f, v.target);
  return v;
}

bool scree_decimate_is_crowded(const scree_halfmesh *s, uint32_t v) {
  uint32_t first = s->vertex[v].outgoing, h = first, count = 0;
  do {
    h = scree_turn(s, h);
  } while (++count <= SCREE_FAN_MAX && h != first && h != SCREE_NONE);
  return count > SCREE_FAN_MAX;
}

void scree_decimate_renew(scree_decimator *d, uint32_t v) {
  if (!d->coster->merge && !scree_decimate_is_crowded(&d->s, v)) d->coster->sum(&d->s, v);
}

static void record_collapse(scree_decimator *d, const scree_fan *f, double error) {
  scree_collapse_record *r = &d->record;
  const scree_halfmesh *s = &d->s;
  const size_t i = r->count++;
  r->kept[i] = s->vertex[f->a].origin | (f->d == SCREE_NONE ? SCREE_ONE_TRIANGLE : 0);
  r->gone[i] = s->vertex[f->b].origin;
  r->position[i] = vec3_mad(s->centre, f->at, s->scale);
  scree_fan_measure(s, f, &r->area[i], &r->volume[i]);
  r->error[i] = (float)error;
}

void scree_decimate_collapse(scree_decimator *d, const scree_fan *f, double error) {
  record_collapse(d, f, error);
  scree_fan_collapse(&d->s, f);
  if (d->coster->merge) d->coster->merge(&d->s, f->a, f->b);
  d->s.live_vertex_count--;
  d->s.live_triangle_count -= f->d == SCREE_NONE ? 1 : 2;
  scree_markers_follow(&d->markers, f);
  for (uint32_t i = 0; i < f->count; i++) {
    scree_bounds b = scree_fan_bounds(f, i);
    scree_surface_tree_grow(&d->tree, f->edge[i] / 3, &b, f->after[i]);
  }
}
