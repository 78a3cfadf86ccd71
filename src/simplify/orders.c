/* The last part of a curve in other orders. What a decimation comes to hangs on the order of its
 * collapses: where costs are nearly equal, less than the noise of a scan turns it round, and all
 * that follows is another draw. Several draws tell how good a level may be (choice/choose.c). */
#include "simplify/curve.h"

#include "base/owned.h"
#include "base/parallel.h"

typedef struct drawing {
  const scree_curve *curve;
  scree_decimator decimators[SCREE_ORDER_COUNT];
  scree_status status[SCREE_ORDER_COUNT];
  scree_error errors[SCREE_ORDER_COUNT];
} drawing;

static void draw(void *context, scree_block block) {
  drawing *w = context;
  for (size_t k = block.begin + 1; k < block.end + 1; k++)
    w->status[k] = scree_decimate_from(&w->decimators[k], &w->curve->fork, (int)k,
                                       &w->curve->options, &w->errors[k]);
}

/* The level that the orders have in common. */
static void values_at_fork(const scree_curve *c, double scale, scree_sum *area, scree_sum *volume,
                           double *worst) {
  scree_level level;
  scree_curve_level(c, c->fork.collapse_count, &level);
  *area = (scree_sum){level.area / (scale * scale), 0};
  *volume = (scree_sum){level.volume / (scale * scale * scale), 0};
  *worst = level.quadric_error;
}

static scree_status take(scree_curve *curve, drawing *w, int k, scree_error *error) {
  scree_decimator *d = &w->decimators[k];
  scree_sum area, volume;
  double worst, scale = d->s.scale * curve->scale;
  if (w->status[k] != SCREE_OK) {
    if (error) *error = w->errors[k];
    return w->status[k];
  }
  values_at_fork(curve, scale, &area, &volume, &worst);
  for (size_t i = 0; i < d->record.count; i++)
    d->record.position[i] = vec3_scale(d->record.position[i], curve->scale);
  scree_record_accumulate(&d->record, area, volume, worst, scale);
  curve->tails[k] = d->record;
  d->record = (scree_collapse_record){0};
  return SCREE_OK;
}

static scree_status draw_all(scree_curve *curve, scree_error *error) {
  drawing *w;
  scree_status status = SCREE_OK;
  SCREE_TRY_ALLOC_ZERO(w, 1, error);
  w->curve = curve;
  scree_parallel_for(SCREE_ORDER_COUNT - 1, 1, draw, w);
  for (int k = 1; k < SCREE_ORDER_COUNT; k++) {
    if (status == SCREE_OK) status = take(curve, w, k, error);
    scree_decimator_free(&w->decimators[k]);
  }
  scree_free(w);
  return status;
}

scree_status scree_curve_reorder(scree_curve *curve, int order, scree_error *error) {
  size_t fork = curve->fork.collapse_count;
  if (order < 0 || order >= scree_curve_order_count(curve))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "order %d: the curve has %d", order,
                      scree_curve_order_count(curve));
  if (order == curve->order) return SCREE_OK;
  if (!curve->tails[1].kept) SCREE_TRY(draw_all(curve, error));
  if (!curve->tails[0].kept)
    SCREE_TRY(scree_collapse_record_put(&curve->tails[0], 0, &curve->record, fork, error));
  SCREE_TRY(scree_collapse_record_put(&curve->record, fork, &curve->tails[order], 0, error));
  curve->order = order;
  return scree_curve_count_levels(curve, error);
}

int scree_curve_order(const scree_curve *curve) {
  return curve->order;
}

bool scree_curve_is_below_fork(const scree_curve *curve, size_t level_index) {
  return level_index > curve->fork.collapse_count;
}

int scree_curve_order_count(const scree_curve *curve) {
  bool forks = curve->fork.s.vertex && curve->record.count > curve->fork.collapse_count;
  return forks ? SCREE_ORDER_COUNT : 1;
}

scree_status scree_curve_tail(const scree_curve *curve, size_t from, scree_curve **tail,
                              scree_error *error) {
  SCREE_OWNED(scree_replay, replay);
  SCREE_OWNED(scree_curve, made);
  const scree_mesh *level;
  SCREE_TRY(scree_replay_start(curve, &replay, error));
  SCREE_TRY(scree_replay_step(replay, from, &level, error));
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  SCREE_TRY(scree_mesh_copy(level, &made->coarse, error));
  made->mesh = &made->coarse;
  SCREE_TRY(scree_collapse_record_put(&made->record, 0, &curve->record, from, error));
  const uint32_t *number = scree_replay_numbering(replay);
  for (size_t i = 0; i < made->record.count; i++) {
    uint32_t one = made->record.kept[i] & SCREE_ONE_TRIANGLE;
    made->record.kept[i] = number[scree_collapse_record_kept(&made->record, i)] | one;
    made->record.gone[i] = number[made->record.gone[i]];
  }
  SCREE_TRY(scree_curve_count_levels(made, error));
  made->facts = curve->facts;
  *tail = made;
  made = NULL;
  return SCREE_OK;
}
