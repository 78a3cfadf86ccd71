/* Many objects: one worker each, so that the decimations, which are mostly serial, run beside each
 * other. Nothing an object gives depends on the others until the set's choice, so the result does
 * not depend on the number of workers. The first failing object, by index, is the one reported,
 * or each where the job goes on without them.
 *
 * The set's choice is known only when all curves are; to write meshes by it, the curves are kept,
 * up to KEEP_BYTES in all. What does not fit is decimated a second time. */
#include "base/alloc.h"
#include "base/parallel.h"

#include <stdatomic.h>

static const size_t KEEP_BYTES = (size_t)2 << 30;
enum { KEPT_BYTES_PER_TRIANGLE = 64 }; /* record and mesh */

/* Parts of an object's time, measured on 100,000 to 900,000 triangles: loading takes from a
 * twentieth to two fifths, by what there is to repair; the choice none where it is by area only. */
static const double LOAD_PART = 0.15, CHOICE_PART = 0.2;

static double choice_part(const scree_choice_options *options) {
  return options->area_only ? 0 : CHOICE_PART;
}

typedef struct object {
  struct batch *batch;
  size_t index;
  scree_mesh mesh;
  scree_curve *curve;
  scree_status status;
  scree_error error;
  bool left_out;           /* failed in the first round, and the others go on */
  double base, part;       /* of the stage under way */
  _Atomic double fraction; /* done, of this object */
} object;

typedef struct batch {
  const scree_choice_job *job;
  const scree_progress *progress;
  scree_choice *choices;
  const scree_set_choice *set; /* NULL in the first round */
  object *objects;
  atomic_flag reporting;
  atomic_bool cancelled;
  atomic_size_t first_failed, kept_bytes;
} batch;

/* Progress of one object inside the whole; any worker may come here, one at a time goes on. */
static bool report(void *context, const char *phase, double fraction) {
  (void)phase;
  object *o = context;
  batch *b = o->batch;
  double mine = o->base + o->part * fraction;
  if (mine > atomic_load(&o->fraction)) atomic_store(&o->fraction, mine);
  if (b->progress && b->progress->report && !atomic_flag_test_and_set(&b->reporting)) {
    double sum = 0;
    for (size_t i = 0; i < b->job->count; i++) sum += atomic_load(&b->objects[i].fraction);
    const char *text = b->set ? "writing" : "decimating and choosing";
    if (!b->progress->report(b->progress->context, text, sum / (double)b->job->count))
      atomic_store(&b->cancelled, true);
    atomic_flag_clear(&b->reporting);
  }
  return !atomic_load(&b->cancelled) && atomic_load(&b->first_failed) > o->index;
}

static scree_progress enter_stage(object *o, double base, double part) {
  o->base = base;
  o->part = part;
  return (scree_progress){report, o, o->batch->progress ? o->batch->progress->interval : 0};
}

static void let_go(object *o) {
  scree_curve_free(o->curve);
  o->curve = NULL;
  scree_mesh_free(&o->mesh);
}

static scree_status load_and_decimate(object *o) {
  const scree_choice_job *job = o->batch->job;
  scree_progress progress = enter_stage(o, 0, LOAD_PART);
  double scale = 1;
  SCREE_TRY(job->load(job->context, o->index, &progress, &o->mesh, &scale, &o->error));
  progress = enter_stage(o, LOAD_PART, 1 - LOAD_PART - choice_part(&job->options));
  return scree_curve_build_scaled(&o->mesh, scale, &job->simplify, &progress, &o->curve, &o->error);
}

static scree_status choose_object(object *o) {
  batch *b = o->batch;
  SCREE_TRY(load_and_decimate(o));
  double part = choice_part(&b->job->options);
  scree_progress progress = enter_stage(o, 1 - part, part);
  scree_status status = scree_choose(o->curve, &o->mesh, &b->job->options, &progress,
                                     &b->choices[o->index], &o->error);
  size_t bytes = KEPT_BYTES_PER_TRIANGLE * o->mesh.triangle_count;
  bool fits = atomic_fetch_add(&b->kept_bytes, bytes) + bytes <= KEEP_BYTES || b->job->count == 1;
  if (!b->job->done || !fits) let_go(o);
  return status;
}

static scree_status finish_object(object *o) {
  batch *b = o->batch;
  scree_status status = SCREE_OK;
  if (!o->curve) status = load_and_decimate(o);
  if (status == SCREE_OK)
    status = scree_curve_reorder(o->curve, b->choices[o->index].order, &o->error);
  if (status == SCREE_OK)
    status =
        b->job->done(b->job->context, o->index, o->curve, &b->choices[o->index], b->set, &o->error);
  let_go(o);
  return status;
}

/* Memory that runs out is no fault of the object's: who meets the limit depends on the workers. */
static bool ends_all(const object *o) {
  bool own = o->status != SCREE_OUT_OF_MEMORY && o->status != SCREE_CANCELLED;
  return o->status != SCREE_OK && !(o->batch->job->failed && own && !o->batch->set);
}

static void work(void *context, scree_block block) {
  batch *b = context;
  for (size_t i = block.begin; i < block.end; i++) {
    object *o = &b->objects[i];
    if (o->left_out) continue;
    if (!report(o, "", 0)) {
      o->status = SCREE_CANCELLED;
      continue;
    }
    o->status = b->set ? finish_object(o) : choose_object(o);
    atomic_store(&o->fraction, 1);
    size_t first = atomic_load(&b->first_failed);
    while (ends_all(o) && o->index < first)
      if (atomic_compare_exchange_weak(&b->first_failed, &first, o->index)) break;
    if (o->status != SCREE_OK) let_go(o);
  }
}

static scree_status run_round(batch *b, scree_error *error) {
  for (size_t i = 0; i < b->job->count; i++)
    atomic_store(&b->objects[i].fraction, b->objects[i].left_out);
  scree_parallel_for(b->job->count, 1, work, b);
  size_t failed = atomic_load(&b->first_failed);
  if (atomic_load(&b->cancelled)) /* perhaps before an object began: none failed then */
    return scree_fail(error, SCREE_CANCELLED, "cancelled while choosing");
  if (failed == SIZE_MAX) return SCREE_OK;
  object *o = &b->objects[failed];
  if (error) *error = o->error;
  return o->status;
}

/* Tells of each object without a choice; the first one's error where there are no others. */
static scree_status leave_out(batch *b, scree_error *error) {
  const scree_choice_job *job = b->job;
  size_t left = job->count;
  for (size_t i = 0; i < job->count; i++) {
    object *o = &b->objects[i];
    o->left_out = o->status != SCREE_OK;
    if (!o->left_out) continue;
    job->failed(job->context, i, &o->error);
    left--;
  }
  if (left) return SCREE_OK;
  if (error) *error = b->objects[0].error;
  return b->objects[0].status;
}

/* The set's choice is of the objects that have one. */
static scree_status choose_set(const batch *b, scree_set_choice *set, scree_error *error) {
  size_t count = 0;
  SCREE_SCRATCH(scree_choice, chosen, b->job->count, error);
  for (size_t i = 0; i < b->job->count; i++)
    if (!b->objects[i].left_out) chosen[count++] = b->choices[i];
  return scree_choose_set(chosen, count, set, error);
}

static void free_batch(batch *b, bool failed) {
  for (size_t i = 0; i < b->job->count; i++) {
    let_go(&b->objects[i]);
    if (failed) scree_choice_free(&b->choices[i]);
  }
  scree_free(b->objects);
}

scree_status scree_choose_each(const scree_choice_job *job, const scree_progress *progress,
                               scree_choice *choices, scree_set_choice *set, scree_error *error) {
  if (job->count == 0) return scree_fail(error, SCREE_BAD_ARGUMENT, "no object to choose for");
  batch b = {.job = job, .progress = progress, .choices = choices};
  SCREE_TRY_ALLOC_ZERO(b.objects, job->count, error);
  atomic_flag_clear(&b.reporting);
  atomic_init(&b.first_failed, SIZE_MAX);
  for (size_t i = 0; i < job->count; i++) {
    b.objects[i].batch = &b;
    b.objects[i].index = i;
    choices[i] = (scree_choice){0};
  }
  scree_set_choice chosen = {0};
  scree_status status = run_round(&b, error);
  if (status == SCREE_OK) status = leave_out(&b, error);
  if (status == SCREE_OK) status = choose_set(&b, &chosen, error);
  b.set = &chosen;
  if (status == SCREE_OK && job->done) status = run_round(&b, error);
  free_batch(&b, status != SCREE_OK);
  if (status == SCREE_OK)
    *set = chosen;
  else
    scree_set_choice_free(&chosen);
  return status;
}
