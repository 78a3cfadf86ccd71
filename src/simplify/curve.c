/* The public face: building the record, reading levels. */
#include "simplify/curve.h"

#include "base/radix.h"
#include "base/sum.h"
#include "mesh/mesh.h"
#include "simplify/decimate.h"
#include "simplify/flat_fan.h"

#include <math.h>

const char *scree_method_name(scree_method method) {
  return method == SCREE_METHOD_QECD ? "qecd" : "volume";
}

scree_simplify_options scree_default_simplify_options(void) {
  return (scree_simplify_options){.method = SCREE_METHOD_VOLUME};
}

void scree_curve_free(scree_curve *curve) {
  if (!curve) return;
  scree_collapse_record_free(&curve->record);
  for (int k = 0; k < SCREE_ORDER_COUNT; k++) scree_collapse_record_free(&curve->tails[k]);
  scree_fork_free(&curve->fork);
  scree_free(curve->counts);
  scree_free(curve->cut.triangles);
  scree_mesh_free(&curve->coarse);
  scree_free(curve);
}

static size_t count_at(const scree_curve *curve, size_t level) {
  return curve->counts ? curve->counts[level] : curve->mesh->triangle_count - 2 * level;
}

void scree_record_accumulate(scree_collapse_record *r, scree_sum area, scree_sum volume,
                             double worst, double scale) {
  for (size_t i = 0; i < r->count; i++) {
    scree_sum_add(&area, r->area[i]);
    scree_sum_add(&volume, r->volume[i]);
    r->area[i] = scree_sum_value(area) * scale * scale;
    r->volume[i] = scree_sum_value(volume) * scale * scale * scale;
    double move = sqrt((double)r->error[i]) * scale;
    worst = move > worst ? move : worst;
    r->error[i] = (float)worst;
  }
}

scree_status scree_curve_count_levels(scree_curve *curve, scree_error *error) {
  const scree_collapse_record *r = &curve->record;
  uint32_t count = (uint32_t)curve->mesh->triangle_count;
  bool all_two = true;
  for (size_t i = 0; i < r->count && all_two; i++)
    all_two = scree_collapse_record_triangles(r, i) == 2;
  scree_free(curve->counts);
  curve->counts = NULL;
  curve->facts.floor_count = count - 2 * r->count;
  if (all_two) return SCREE_OK;
  SCREE_TRY_ALLOC(curve->counts, r->count + 1, error);
  curve->counts[0] = count;
  for (size_t i = 0; i < r->count; i++)
    curve->counts[i + 1] = count -= scree_collapse_record_triangles(r, i);
  curve->facts.floor_count = count;
  return SCREE_OK;
}

/* Drops collapses beyond the first level that is low enough. */
static void cut_at_stop(scree_decimator *d) {
  scree_collapse_record *r = &d->record;
  size_t count = d->first_triangle_count, i = 0;
  while (i < r->count && count > d->options.stop_count)
    count -= scree_collapse_record_triangles(r, i++);
  r->count = i;
}

static scree_status check_options(const scree_simplify_options *options, scree_error *error) {
  if (options->method != SCREE_METHOD_VOLUME && options->method != SCREE_METHOD_QECD)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "decimation method %d is not known",
                      (int)options->method);
  if (!(options->error_limit >= 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the error limit %g m is not 0 or above",
                      options->error_limit);
  return SCREE_OK;
}

/* A mesh that is no good is left to be told by what follows. */
static scree_status cut_flat_fans(const scree_mesh *mesh, scree_curve *curve, scree_error *error) {
  uint32_t *triangles = NULL;
  curve->mesh = mesh;
  scree_status status = scree_mesh_verify(mesh, error);
  if (status != SCREE_OK) return status == SCREE_OUT_OF_MEMORY ? status : SCREE_OK;
  status = scree_flat_fans_cut(mesh, &triangles, error);
  if (status != SCREE_OK || !triangles) return status;
  curve->cut = *mesh;
  curve->cut.triangles = triangles;
  curve->mesh = &curve->cut;
  return SCREE_OK;
}

scree_status scree_curve_build(const scree_mesh *mesh, const scree_simplify_options *options,
                               const scree_progress *progress, scree_curve **curve,
                               scree_error *error) {
  const scree_simplify_options defaults = scree_default_simplify_options();
  if (!options) options = &defaults;
  SCREE_TRY(check_options(options, error));
  SCREE_CLEANUP(scree_decimator_free) scree_decimator d = {0};
  SCREE_OWNED(scree_curve, made);
  SCREE_TRY_ALLOC_ZERO(made, 1, error);
  SCREE_TRY(cut_flat_fans(mesh, made, error));
  SCREE_TRY(scree_decimator_start(&d, made->mesh, options, error));
  d.ticker.progress = progress;
  made->facts = (scree_curve_facts){.method = options->method,
                                    .triangle_count = mesh->triangle_count,
                                    .shell_count = d.s.shell_count,
                                    .boundary_edge_count = d.s.boundary_edge_count,
                                    .locked_vertex_count = d.s.locked_vertex_count,
                                    .closed = d.s.closed};
  scree_status status = scree_decimate(&d);
  if (status == SCREE_CANCELLED)
    scree_fail(error, SCREE_CANCELLED, "decimation was cancelled at %zu triangles",
               d.s.live_triangle_count);
  SCREE_TRY(status);
  cut_at_stop(&d);
  SCREE_TRY(scree_collapse_record_shrink(&d.record, error));
  made->record = d.record;
  d.record = (scree_collapse_record){0};
  made->area = scree_sum_value(d.area) * d.s.scale * d.s.scale;
  made->volume = scree_sum_value(d.volume) * d.s.scale * d.s.scale * d.s.scale;
  scree_record_accumulate(&made->record, d.area, d.volume, 0, d.s.scale);
  SCREE_TRY(scree_curve_count_levels(made, error));
  made->options = *options;
  made->scale = 1;
  made->fork = d.fork;
  made->fork.samples.borrows = false;
  d.samples.borrows = made->fork.s.vertex != NULL;
  d.fork = (scree_fork){0};
  *curve = made;
  made = NULL;
  return SCREE_OK;
}

static void scale_places(vec3 *position, size_t count, double scale) {
  for (size_t i = 0; i < count; i++) position[i] = vec3_scale(position[i], scale);
}

static void scale_curve(scree_curve *curve, double scale) {
  scree_collapse_record *r = &curve->record;
  double square = scale * scale, cube = square * scale;
  curve->scale *= scale;
  curve->area *= square;
  curve->volume *= cube;
  scale_places(r->position, r->count, scale);
  for (size_t i = 0; i < r->count; i++) {
    r->area[i] *= square;
    r->volume[i] *= cube;
    r->error[i] = (float)((double)r->error[i] * scale);
  }
}

scree_status scree_curve_build_scaled(scree_mesh *mesh, double scale,
                                      const scree_simplify_options *options,
                                      const scree_progress *progress, scree_curve **curve,
                                      scree_error *error) {
  scree_simplify_options used = options ? *options : scree_default_simplify_options();
  if (!(scale > 0 && isfinite(scale)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "the scale %g is not above 0 and finite", scale);
  used.error_limit /= scale;
  scree_status status = scree_curve_build(mesh, &used, progress, curve, error);
  if (status != SCREE_OK || scale == 1) return status;
  scree_mesh_scale(mesh, scale);
  scale_curve(*curve, scale);
  return SCREE_OK;
}

scree_curve_facts scree_curve_get_facts(const scree_curve *curve) {
  return curve->facts;
}

size_t scree_curve_level_count(const scree_curve *curve) {
  return curve->record.count + 1;
}

void scree_curve_level(const scree_curve *curve, size_t index, scree_level *level) {
  const scree_collapse_record *r = &curve->record;
  size_t count = count_at(curve, index);
  *level = (scree_level){.triangle_count = count,
                         .rp = (double)count / (double)curve->mesh->triangle_count,
                         .area = curve->area,
                         .volume = curve->volume};
  if (index == 0) return;
  level->area = r->area[index - 1];
  level->volume = r->volume[index - 1];
  level->quadric_error = (double)r->error[index - 1];
}

size_t scree_curve_find(const scree_curve *curve, size_t target) {
  SCREE_FIND_FIRST(i, 0, scree_curve_level_count(curve) - 1, count_at(curve, i) > target)
  return i;
}

size_t scree_curve_collapse_count(const scree_curve *curve) {
  return curve->record.count;
}

void scree_curve_collapse(const scree_curve *curve, size_t index, scree_collapse *collapse) {
  const scree_collapse_record *r = &curve->record;
  *collapse = (scree_collapse){.kept = scree_collapse_record_kept(r, index),
                               .gone = r->gone[index],
                               .triangle_count = scree_collapse_record_triangles(r, index)};
  vec3_store(collapse->position, r->position[index]);
}
