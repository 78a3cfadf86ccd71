/* What becomes of the scan's vertices when the surface is kept: each is a witness with the triangle
 * that is nearest to it, as far as that is found by going from fan to fan, from that of the vertex
 * which it became by collapses and on as long as there are nearer triangles.
 *
 * The witnesses of large scans lie densely where the surface was dear to take away. That is where
 * it goes astray, but the mean distance over them is not that of the scan, and coarse levels fitted
 * to them lie farther from it than they might. So for the last levels there are others, spread
 * evenly over all vertices that went, and weighed by area. */
#include "base/parallel.h"
#include "simplify/decimate.h"

enum { WITNESS_BLOCK = 1024 };
/* Of large scans one in so many of the vertices that went are looked for, for it takes time: the
 * last, which were the dearest to take away and so lie where the surface goes astray most. */
enum { LAST_OF_LARGE = 8 };
/* Squared cosines to the normal that differ from 1 by no more are 1. */
#define ABOVE 1e-9

typedef struct finding {
  const scree_decimator *d;
  uint32_t *place;  /* of what is looked for of the mesh given: the vertex that it became */
  uint32_t *origin; /* the vertices that are to be witnesses */
  uint32_t *end;    /* scratch, per vertex */
  scree_witness *witnesses;
  size_t count;
  size_t gone_begin; /* of the record: from here on it is looked through for those that went */
} finding;

static void find_places(finding *f) {
  const scree_halfmesh *s = &f->d->s;
  const scree_record *r = &f->d->record;
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) f->place[s->vertex[v].origin] = v;
  for (size_t i = r->count; i-- > f->gone_begin;)
    f->place[r->gone[i]] = f->place[r->kept[i] & ~SCREE_ONE_TRIANGLE];
}

/* Lists the vertices that are there and those of that part that went; sorted by their places, so
 * that what is asked for together lies together. */
static void list_origins(finding *f) {
  const scree_halfmesh *s = &f->d->s;
  const scree_record *r = &f->d->record;
  uint32_t count = 0;
  for (uint32_t v = 0; v < s->vertex_count; v++) f->end[v] = s->vertex[v].outgoing != SCREE_NONE;
  for (size_t i = f->gone_begin; i < r->count; i++) f->end[f->place[r->gone[i]]]++;
  for (uint32_t v = 0; v < s->vertex_count; v++) {
    count += f->end[v];
    f->end[v] = count;
  }
  for (size_t i = f->gone_begin; i < r->count; i++)
    f->origin[--f->end[f->place[r->gone[i]]]] = r->gone[i];
  for (uint32_t v = 0; v < s->vertex_count; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) f->origin[--f->end[v]] = s->vertex[v].origin;
  f->count = count;
}

/* The triangles at a vertex, a few of many at a time. */
enum { FAN_PART = 2 * SCREE_EIGHT };
typedef struct fan {
  uint32_t triangle[FAN_PART];
  double corners[FAN_PART][9];
  uint32_t count;
} fan;

/* Those from half-edge *h on; *h is where the rest begins, or NONE. */
static void gather_fan(const scree_halfmesh *s, uint32_t first, uint32_t *h, fan *f) {
  for (f->count = 0; f->count < FAN_PART && *h != SCREE_NONE; f->count++) {
    vec3 at[3];
    scree_corners(s, *h / 3, at);
    for (size_t i = 0; i < 3; i++) vec3_store(f->corners[f->count] + 3 * i, at[i]);
    f->triangle[f->count] = *h / 3;
    *h = scree_turn(s, *h);
    if (*h == first) *h = SCREE_NONE;
  }
}

/* Gives w the nearest triangle at vertex v, in w->next. Whether others may be nearer still: not
 * where what it has is as near, nor where w lies right above the triangle. */
static bool look_around(const scree_halfmesh *s, uint32_t v, scree_witness *w) {
  scree_eight eights[FAN_PART / SCREE_EIGHT];
  double distance2[FAN_PART];
  fan f;
  bool found = false;
  for (uint32_t first = s->vertex[v].outgoing, h = first; h != SCREE_NONE;) {
    gather_fan(s, first, &h, &f);
    scree_eights_fill(f.corners, f.count, eights);
    scree_eights_closest(eights, scree_eight_count(f.count), w->at, distance2);
    for (uint32_t i = 0; i < f.count; i++) {
      if (!(distance2[i] < w->distance2)) continue;
      vec3 a = vec3_load(f.corners[i]);
      vec3 n = vec3_triangle_normal(a, vec3_load(f.corners[i] + 3), vec3_load(f.corners[i] + 6));
      double height = vec3_dot(n, vec3_sub(w->at, a));
      w->distance2 = distance2[i];
      w->next = f.triangle[i];
      found = height * height < (1 - ABOVE) * distance2[i] * vec3_norm2(n);
    }
  }
  return found;
}

static void look_from(const scree_halfmesh *s, uint32_t v, scree_witness *w) {
  bool found = look_around(s, v, w);
  while (found) {
    uint32_t h = 3 * w->next, seen = v;
    found = false;
    for (uint32_t i = 0; i < 3; i++) {
      uint32_t corner = s->half[h + i].from;
      if (corner == seen || !look_around(s, corner, w)) continue;
      found = true;
      v = corner;
    }
  }
}

static void find_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  const finding *f = context;
  for (size_t i = begin; i < end; i++) {
    vec3 p = vec3_load(f->d->mesh->positions + 3 * (size_t)f->origin[i]);
    f->witnesses[i] = (scree_witness){.at = scree_into_box(&f->d->s, p), .distance2 = INFINITY};
    look_from(&f->d->s, f->place[f->origin[i]], &f->witnesses[i]);
  }
}

scree_status scree_decimate_keep(scree_decimator *d) {
  const scree_halfmesh *s = &d->s;
  finding f = {.d = d};
  scree_status status = SCREE_OUT_OF_MEMORY;
  if (d->record.count == 0 || d->coster->merge) /* they are the surface's own; not asked for */
    return scree_memory_keep(s, NULL, 0, &d->memory, d->error);
  size_t gone_count = scree_is_large(d) ? d->record.count / LAST_OF_LARGE : d->record.count;
  f.gone_begin = d->record.count - gone_count;
  SCREE_ALLOC_OR(f.place, d->mesh->vertex_count, d->error, done);
  SCREE_ALLOC_OR(f.origin, s->live_vertex_count + gone_count, d->error, done);
  SCREE_ALLOC_OR(f.end, s->vertex_count, d->error, done);
  find_places(&f);
  list_origins(&f);
  SCREE_ALLOC_OR(f.witnesses, f.count, d->error, done);
  scree_parallel_for(f.count, WITNESS_BLOCK, find_block, &f);
  status = scree_memory_keep(s, f.witnesses, f.count, &d->memory, d->error);
done:
  scree_free(f.place);
  scree_free(f.origin);
  scree_free(f.end);
  return status;
}

scree_status scree_decimate_spread(scree_decimator *d, const scree_record *record,
                                   size_t gone_count) {
  size_t count = gone_count < SCREE_SPREAD_COUNT ? gone_count : SCREE_SPREAD_COUNT;
  scree_witness *witnesses;
  SCREE_ALLOC_OR(witnesses, count, d->error, out_of_memory);
  for (size_t i = 0; i < count; i++) {
    uint32_t gone = record->gone[(2 * i + 1) * gone_count / (2 * count)];
    witnesses[i].at = scree_into_box(&d->s, vec3_load(d->mesh->positions + 3 * (size_t)gone));
  }
  scree_memory_replace(&d->memory, &d->s, witnesses, count);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}
