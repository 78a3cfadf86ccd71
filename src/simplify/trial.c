#include "simplify/trial.h"

#include "base/array.h"

#include <string.h>

scree_status scree_trial_allocate(scree_trial *t, const scree_decimator *d, scree_error *error) {
  const scree_halfmesh *s = &d->s;
  scree_moves *moves = &t->d.record.moves;
  SCREE_ALLOC_OR(t->d.s.half, 3 * s->triangle_count, error, out_of_memory);
  SCREE_ALLOC_OR(t->d.s.vertex, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(t->d.s.flags, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(t->d.memory.first, s->triangle_count, error, out_of_memory);
  SCREE_ALLOC_OR(t->d.memory.near, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(t->d.memory.witnesses, d->memory.count, error, out_of_memory);
  SCREE_ALLOC_OR(t->d.anchors.vertex, d->anchors.count, error, out_of_memory);
  SCREE_ALLOC_OR(t->step.stamp, s->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(t->step.touched, s->vertex_count, error, out_of_memory);
  if (!SCREE_RESERVE(moves, SCREE_MOST_ABOUT + 2))
    return scree_fail_memory(error, (SCREE_MOST_ABOUT + 2) * sizeof *moves->items, "moves");
  return scree_record_allocate(&t->d.record, 1, error);
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_trial_free(scree_trial *t) {
  scree_free(t->d.s.half);
  scree_free(t->d.s.vertex);
  scree_free(t->d.s.flags);
  scree_free(t->d.memory.first);
  scree_free(t->d.memory.near);
  scree_free(t->d.memory.witnesses);
  scree_free(t->d.anchors.vertex);
  scree_free(t->step.stamp);
  scree_free(t->step.touched);
  scree_record_free(&t->d.record);
}

/* All of the surface that a step changes. */
static void copy_surface(scree_decimator *to, const scree_decimator *from) {
  scree_halfmesh own = to->s;
  size_t triangles = from->s.triangle_count, vertices = from->s.vertex_count;
  to->s = from->s;
  to->s.half = own.half;
  to->s.vertex = own.vertex;
  to->s.flags = own.flags;
  memcpy(to->s.half, from->s.half, 3 * triangles * sizeof *to->s.half);
  memcpy(to->s.vertex, from->s.vertex, vertices * sizeof *to->s.vertex);
  memcpy(to->s.flags, from->s.flags, vertices * sizeof *to->s.flags);
  scree_memory held = to->memory;
  to->memory = from->memory;
  to->memory.first = held.first;
  to->memory.near = held.near;
  to->memory.witnesses = held.witnesses;
  memcpy(held.first, from->memory.first, triangles * sizeof *held.first);
  memcpy(held.near, from->memory.near, vertices * sizeof *held.near);
  memcpy(held.witnesses, from->memory.witnesses, from->memory.count * sizeof *held.witnesses);
  to->anchors.count = from->anchors.count;
  if (from->anchors.count > 0)
    memcpy(to->anchors.vertex, from->anchors.vertex,
           from->anchors.count * sizeof *to->anchors.vertex);
}

void scree_trial_start(scree_trial *t, const scree_step *from) {
  const scree_decimator *d = from->d;
  copy_surface(&t->d, d);
  t->d.mesh = d->mesh;
  t->d.coster = d->coster;
  t->d.options = d->options;
  t->d.error_limit = d->error_limit;
  t->d.rule = d->rule;
  t->d.first_triangle_count = d->first_triangle_count;
  t->d.grid = d->grid;
  t->d.record.count = t->d.record.moves.count = 0;
  t->step.d = &t->d;
  t->step.now = 0;
  t->step.relaxed_below = from->relaxed_below;
  t->step.farthest2 = from->farthest2;
  t->step.farthest_at = from->farthest_at;
  memset(t->step.stamp, 0, d->s.vertex_count * sizeof *t->step.stamp);
}

void scree_trial_take(const scree_trial *t, scree_step *step) {
  copy_surface(step->d, &t->d);
}
