/* The public face: building the record, reading levels, rebuilding their meshes.
 *
 * A level is rebuilt from the record alone: vertex `gone` of each collapse becomes `kept`, whose
 * position is the last one written; a triangle lives while its corners are three. Going through
 * the collapses backwards, the vertex that `kept` finally became is known when it is asked for, so
 * that no search is needed. The coarsest levels of method `volume` stand in the record as a whole.
 */
#include "base/array.h"
#include "base/parallel.h"
#include "base/sum.h"
#include "simplify/patch.h"

#include <math.h>
#include <string.h>

struct scree_curve {
  const scree_mesh *mesh;
  scree_record record;
  scree_curve_facts facts;
  uint32_t *counts;    /* triangles per level, NULL where every collapse takes two */
  double area, volume; /* of level 0 */
};

struct scree_replay {
  const scree_curve *curve;
  size_t level, move; /* the moves before are done */
  uint32_t *root;     /* of the given mesh's vertices */
  double *position;   /* of the given mesh's vertices, at the level */
  uint32_t *corner;   /* triangles of the level, in the given mesh's vertices */
  size_t triangle_count;
  scree_mesh mesh;
  uint32_t *number; /* of the given mesh's vertices, in mesh */
};

const char *scree_method_name(scree_method method) {
  return method == SCREE_METHOD_QECD ? "qecd" : "volume";
}

scree_simplify_options scree_default_simplify_options(void) {
  return (scree_simplify_options){.method = SCREE_METHOD_VOLUME};
}

void scree_whole_level_free(scree_whole_level *level) {
  scree_free(level->origin);
  scree_free(level->position);
  scree_free(level->triangle);
}

void scree_record_free(scree_record *r) {
  scree_free(r->kept);
  scree_free(r->gone);
  scree_free(r->position);
  scree_free(r->area);
  scree_free(r->volume);
  scree_free(r->error);
  scree_free(r->moves.items);
  for (size_t i = 0; i < r->whole.count; i++) scree_whole_level_free(&r->whole.items[i]);
  scree_free(r->whole.items);
  *r = (scree_record){0};
}

scree_status scree_record_allocate(scree_record *r, size_t capacity, scree_error *error) {
  r->capacity = capacity;
  SCREE_ALLOC_OR(r->kept, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->gone, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->position, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->area, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->volume, capacity, error, out_of_memory);
  SCREE_ALLOC_OR(r->error, capacity, error, out_of_memory);
  return SCREE_OK;
out_of_memory:
  scree_record_free(r);
  return SCREE_OUT_OF_MEMORY;
}

void scree_decimator_free(scree_decimator *d) {
  scree_halfmesh_free(&d->s);
  scree_grid_free(&d->grid);
  scree_memory_free(&d->memory);
  scree_anchors_free(&d->anchors);
  scree_record_free(&d->record);
}

void scree_record_write(scree_decimator *d, size_t i, const scree_ring *ring,
                        const scree_change *change, double error) {
  scree_record *r = &d->record;
  bool one = d->s.half[ring->half_edge].twin == SCREE_NONE;
  r->kept[i] = d->s.vertex[ring->a].origin | (one ? SCREE_ONE_TRIANGLE : 0);
  r->gone[i] = d->s.vertex[ring->b].origin;
  r->position[i] = vec3_mad(d->s.centre, change->target, d->s.scale);
  r->area[i] = change->area;
  r->volume[i] = change->volume;
  r->error[i] = (float)error;
}

scree_status scree_record_place(scree_decimator *d, uint32_t vertex, vec3 at) {
  scree_record *r = &d->record;
  scree_move move = {(uint32_t)(r->count - 1), d->s.vertex[vertex].origin,
                     vec3_mad(d->s.centre, at, d->s.scale)};
  return SCREE_PUSH(&r->moves, move)
             ? SCREE_OK
             : scree_fail_memory(d->error, r->moves.count * sizeof move, "the record");
}

scree_status scree_record_move(scree_decimator *d, const scree_ring *fan,
                               const scree_change *change) {
  scree_record *r = &d->record;
  r->area[r->count - 1] += change->area;
  r->volume[r->count - 1] += change->volume;
  return scree_record_place(d, fan->a, change->target);
}

/* Seconds that are still to come at so many triangles, as measured on scans of 100,000 to 900,000:
 * the coarse levels of `volume`, which are tried out and settled, take as long as all finer ones.
 */
static double work_left(const scree_decimator *d, double count) {
  static const double PER_TRIANGLE = 6e-6, COARSE = 7000, SETTLED = 20;
  double fine = PER_TRIANGLE * count;
  return d->options.method == SCREE_METHOD_VOLUME ? fine + log1p(fmin(count, COARSE) / SETTLED)
                                                  : fine;
}

bool scree_decimate_tick_at(const scree_decimator *d, size_t triangle_count, scree_ticker *ticker) {
  double all = work_left(d, (double)d->first_triangle_count);
  double end = work_left(d, (double)d->options.stop_count);
  double left = work_left(d, (double)triangle_count);
  return scree_tick(ticker, "decimating", all > end ? (all - left) / (all - end) : 0);
}

bool scree_decimate_tick(const scree_decimator *d, scree_ticker *ticker) {
  return scree_decimate_tick_at(d, d->s.live_triangle_count, ticker);
}

void scree_curve_free(scree_curve *curve) {
  if (!curve) return;
  scree_record_free(&curve->record);
  scree_free(curve->counts);
  scree_free(curve);
}

/* Area and volume, by blocks of triangles. */
typedef struct measuring {
  const scree_halfmesh *s;
  struct {
    scree_sum area, volume;
  } * blocks;
} measuring;

enum { MEASURE_BLOCK = 8192 };

static void measure_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)worker;
  const measuring *m = context;
  scree_sum area = {0}, volume = {0};
  for (size_t t = begin; t < end; t++) scree_add_triangle(m->s, t, &area, &volume);
  m->blocks[block].area = area;
  m->blocks[block].volume = volume;
}

static scree_status measure_surface(const scree_halfmesh *s, scree_sum *area, scree_sum *volume,
                                    scree_error *error) {
  measuring m = {.s = s};
  size_t count = scree_block_count(s->triangle_count, MEASURE_BLOCK);
  SCREE_ALLOC_OR(m.blocks, count, error, out_of_memory);
  scree_parallel_for(s->triangle_count, MEASURE_BLOCK, measure_block, &m);
  for (size_t i = 0; i < count; i++) {
    scree_sum_merge(area, m.blocks[i].area);
    scree_sum_merge(volume, m.blocks[i].volume);
  }
  scree_free(m.blocks);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

/* NULL: the level is told by collapses. */
static const scree_whole_level *whole_at(const scree_curve *curve, size_t level) {
  const scree_record *r = &curve->record;
  return level > r->count ? &r->whole.items[level - r->count - 1] : NULL;
}

static size_t count_at(const scree_curve *curve, size_t level) {
  const scree_whole_level *whole = whole_at(curve, level);
  if (whole) return whole->triangle_count;
  return curve->counts ? curve->counts[level] : curve->mesh->triangle_count - 2 * level;
}

/* Turns the changes into the levels' values, in metres. */
static scree_status accumulate(scree_curve *curve, scree_sum area, scree_sum volume, double scale,
                               scree_error *error) {
  scree_record *r = &curve->record;
  double worst = 0;
  curve->area = scree_sum_value(area) * scale * scale;
  curve->volume = scree_sum_value(volume) * scale * scale * scale;
  uint32_t count = (uint32_t)curve->mesh->triangle_count;
  bool all_two = true;
  for (size_t i = 0; i < r->count; i++) {
    scree_sum_add(&area, r->area[i]);
    scree_sum_add(&volume, r->volume[i]);
    r->area[i] = scree_sum_value(area) * scale * scale;
    r->volume[i] = scree_sum_value(volume) * scale * scale * scale;
    double move = sqrt((double)r->error[i]) * scale;
    worst = move > worst ? move : worst;
    r->error[i] = (float)worst;
    all_two &= !(r->kept[i] & SCREE_ONE_TRIANGLE);
  }
  for (size_t i = 0; i < r->whole.count; i++)
    r->whole.items[i].error = (float)(sqrt((double)r->whole.items[i].error) * scale);
  if (all_two) return SCREE_OK;
  SCREE_ALLOC_OR(curve->counts, r->count + 1, error, out_of_memory);
  curve->counts[0] = count;
  for (size_t i = 0; i < r->count; i++)
    curve->counts[i + 1] = count -= r->kept[i] & SCREE_ONE_TRIANGLE ? 1 : 2;
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

size_t scree_record_above(const scree_decimator *d, size_t triangle_count) {
  const scree_record *r = &d->record;
  size_t count = d->first_triangle_count;
  for (size_t i = 0; i < r->count; i++) {
    count -= r->kept[i] & SCREE_ONE_TRIANGLE ? 1 : 2;
    if (count <= triangle_count) return i;
  }
  return r->count;
}

/* Drops collapses beyond the first level that is low enough. */
static void cut_at_stop(scree_decimator *d) {
  size_t above = scree_record_above(d, d->options.stop_count);
  if (above < d->record.count) d->record.count = above + 1;
}

/* Gives back what is worth copying the rest. */
static scree_status record_shrink(scree_record *r, scree_error *error) {
  if (r->count > r->capacity / 16 * 15) return SCREE_OK;
  struct {
    void **block;
    size_t size;
  } fields[] = {
      {(void **)&r->kept, sizeof *r->kept},         {(void **)&r->gone, sizeof *r->gone},
      {(void **)&r->position, sizeof *r->position}, {(void **)&r->area, sizeof *r->area},
      {(void **)&r->volume, sizeof *r->volume},     {(void **)&r->error, sizeof *r->error}};
  for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
    void *moved = scree_resize(*fields[i].block, r->count, fields[i].size);
    if (!moved) return scree_fail_memory(error, r->count * fields[i].size, "the record");
    *fields[i].block = moved;
  }
  r->capacity = r->count;
  return SCREE_OK;
}

enum { SUM_BLOCK = 1024 };

static void sum_block(void *context, size_t begin, size_t end, size_t block, int worker) {
  (void)block, (void)worker;
  scree_decimator *d = context;
  for (size_t v = begin; v < end; v++) {
    if (d->s.vertex[v].outgoing == SCREE_NONE) continue;
    d->coster->sum(&d->s, (uint32_t)v);
    d->s.flags[v] &= (uint8_t)~SCREE_VERTEX_STALE;
  }
}

scree_status scree_decimate_sum(scree_decimator *d) {
  if (d->s.sums) return SCREE_OK;
  SCREE_ALLOC_OR(d->s.sums, d->s.vertex_count, d->error, out_of_memory);
  scree_parallel_for(d->s.vertex_count, SUM_BLOCK, sum_block, d);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

static scree_status decimate(scree_decimator *d) {
  scree_status status = SCREE_OK;
  if (scree_is_large(d)) status = scree_decimate_in_patches(d, SCREE_PATCH);
  if (status == SCREE_OK) status = scree_decimate_in_batches(d);
  if (status == SCREE_OK) status = scree_decimate_one_by_one(d);
  if (status == SCREE_CANCELLED)
    return scree_fail(d->error, SCREE_CANCELLED, "decimation was cancelled at %zu triangles",
                      d->s.live_triangle_count);
  return status;
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

scree_status scree_curve_build(const scree_mesh *mesh, const scree_simplify_options *options,
                               const scree_progress *progress, scree_curve **curve,
                               scree_error *error) {
  const scree_simplify_options defaults = scree_default_simplify_options();
  if (!options) options = &defaults;
  scree_status status = check_options(options, error);
  if (status != SCREE_OK) return status;
  scree_decimator d = {.options = *options, .ticker = {.progress = progress}, .error = error};
  scree_sum area = {0}, volume = {0};
  d.coster = options->method == SCREE_METHOD_QECD ? &scree_qecd_coster : &scree_volume_coster;
  scree_curve *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "the curve");
  status = scree_halfmesh_build(mesh, &d.s, error);
  if (status != SCREE_OK) goto finished;
  d.mesh = mesh;
  d.first_triangle_count = mesh->triangle_count;
  bool late = scree_is_large(&d) && !d.coster->merge;
  d.single_from = late ? SCREE_GREEDY_LATE : SCREE_GREEDY_COUNT;
  double limit = options->error_limit / d.s.scale;
  d.error_limit = limit > 0 ? limit * limit : INFINITY;
  made->mesh = mesh;
  made->facts = (scree_curve_facts){.method = options->method,
                                    .triangle_count = mesh->triangle_count,
                                    .shell_count = d.s.shell_count,
                                    .boundary_edge_count = d.s.boundary_edge_count,
                                    .locked_vertex_count = d.s.locked_vertex_count,
                                    .closed = d.s.closed};
  status = measure_surface(&d.s, &area, &volume, error);
  d.s.area = scree_sum_value(area);
  if (status == SCREE_OK) status = scree_record_allocate(&d.record, d.s.live_vertex_count, error);
  if (status == SCREE_OK) status = decimate(&d);
  if (status != SCREE_OK) goto finished;
  cut_at_stop(&d);
  status = record_shrink(&d.record, error);
  if (status != SCREE_OK) goto finished;
  made->record = d.record;
  d.record = (scree_record){0};
  status = accumulate(made, area, volume, d.s.scale, error);
  if (status == SCREE_OK)
    made->facts.floor_count = count_at(made, scree_curve_level_count(made) - 1);
finished:
  scree_decimator_free(&d);
  if (status == SCREE_OK)
    *curve = made;
  else
    scree_curve_free(made);
  return status;
}

static void scale_places(vec3 *position, size_t count, double scale) {
  for (size_t i = 0; i < count; i++) position[i] = vec3_scale(position[i], scale);
}

static void scale_curve(scree_curve *curve, double scale) {
  scree_record *r = &curve->record;
  double square = scale * scale, cube = square * scale;
  curve->area *= square;
  curve->volume *= cube;
  scale_places(r->position, r->count, scale);
  for (size_t i = 0; i < r->count; i++) {
    r->area[i] *= square;
    r->volume[i] *= cube;
    r->error[i] = (float)((double)r->error[i] * scale);
  }
  for (size_t i = 0; i < r->moves.count; i++) scale_places(&r->moves.items[i].position, 1, scale);
  for (size_t i = 0; i < r->whole.count; i++) {
    scree_whole_level *level = &r->whole.items[i];
    scale_places(level->position, level->vertex_count, scale);
    level->area *= square;
    level->volume *= cube;
    level->error = (float)((double)level->error * scale);
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
  return curve->record.count + 1 + curve->record.whole.count;
}

void scree_curve_level(const scree_curve *curve, size_t index, scree_level *level) {
  const scree_record *r = &curve->record;
  const scree_whole_level *whole = whole_at(curve, index);
  size_t count = count_at(curve, index);
  *level = (scree_level){.triangle_count = count,
                         .rp = (double)count / (double)curve->mesh->triangle_count,
                         .area = curve->area,
                         .volume = curve->volume};
  if (index == 0) return;
  level->area = whole ? whole->area : r->area[index - 1];
  level->volume = whole ? whole->volume : r->volume[index - 1];
  level->quadric_error = (double)(whole ? whole->error : r->error[index - 1]);
}

size_t scree_curve_find(const scree_curve *curve, size_t target) {
  size_t low = 0, high = scree_curve_level_count(curve) - 1; /* the answer lies in [low, high] */
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (count_at(curve, middle) <= target)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

size_t scree_curve_collapse_count(const scree_curve *curve) {
  return curve->record.count;
}

void scree_curve_collapse(const scree_curve *curve, size_t index, scree_collapse *collapse) {
  const scree_record *r = &curve->record;
  *collapse = (scree_collapse){.kept = r->kept[index] & ~SCREE_ONE_TRIANGLE,
                               .gone = r->gone[index],
                               .triangle_count = r->kept[index] & SCREE_ONE_TRIANGLE ? 1 : 2};
  vec3_store(collapse->position, r->position[index]);
}

/* The first of the moves that does not come before collapse `index`. */
static size_t first_move(const scree_moves *moves, size_t index) {
  size_t low = 0, high = moves->count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (moves->items[middle].index < index)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

size_t scree_curve_move_count(const scree_curve *curve, size_t index) {
  const scree_moves *moves = &curve->record.moves;
  return first_move(moves, index + 1) - first_move(moves, index);
}

void scree_curve_move(const scree_curve *curve, size_t index, size_t number,
                      scree_vertex_move *move) {
  const scree_moves *moves = &curve->record.moves;
  const scree_move *m = &moves->items[first_move(moves, index) + number];
  move->vertex = m->vertex;
  vec3_store(move->position, m->position);
}

const uint32_t *scree_replay_numbering(const scree_replay *replay) {
  return replay->number;
}

void scree_replay_free(scree_replay *replay) {
  if (!replay) return;
  scree_free(replay->root);
  scree_free(replay->position);
  scree_free(replay->corner);
  scree_free(replay->number);
  scree_mesh_free(&replay->mesh);
  scree_free(replay);
}

scree_status scree_replay_start(const scree_curve *curve, scree_replay **replay,
                                scree_error *error) {
  const scree_mesh *mesh = curve->mesh;
  scree_replay *made = scree_alloc_zero(1, sizeof *made);
  if (!made) return scree_fail_memory(error, sizeof *made, "the replay");
  made->curve = curve;
  made->triangle_count = mesh->triangle_count;
  SCREE_ALLOC_OR(made->root, mesh->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(made->number, mesh->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(made->position, 3 * mesh->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(made->corner, 3 * mesh->triangle_count, error, out_of_memory);
  for (uint32_t v = 0; v < mesh->vertex_count; v++) made->root[v] = v;
  memcpy(made->position, mesh->positions, 3 * mesh->vertex_count * sizeof *made->position);
  memcpy(made->corner, mesh->triangles, 3 * mesh->triangle_count * sizeof *made->corner);
  *replay = made;
  return SCREE_OK;
out_of_memory:
  scree_replay_free(made);
  return SCREE_OUT_OF_MEMORY;
}

static void replay_collapses(scree_replay *r, size_t level) {
  const scree_record *record = &r->curve->record;
  for (size_t i = level; i-- > r->level;)
    r->root[record->gone[i]] = r->root[record->kept[i] & ~SCREE_ONE_TRIANGLE];
  const scree_moves *moves = &record->moves;
  for (size_t i = r->level; i < level; i++) {
    vec3_store(r->position + 3 * (size_t)(record->kept[i] & ~SCREE_ONE_TRIANGLE),
               record->position[i]);
    for (; r->move < moves->count && moves->items[r->move].index == i; r->move++)
      vec3_store(r->position + 3 * (size_t)moves->items[r->move].vertex,
                 moves->items[r->move].position);
  }
  size_t count = 0;
  for (size_t t = 0; t < r->triangle_count; t++) {
    uint32_t c0 = r->root[r->corner[3 * t]], c1 = r->root[r->corner[3 * t + 1]],
             c2 = r->root[r->corner[3 * t + 2]];
    if (level > 0 && (c0 == c1 || c1 == c2 || c2 == c0)) continue;
    r->corner[3 * count] = c0;
    r->corner[3 * count + 1] = c1;
    r->corner[3 * count + 2] = c2;
    count++;
  }
  r->triangle_count = count;
}

/* The level's mesh with its own vertices, in the order of the mesh given. */
static scree_status number_vertices(scree_replay *r, scree_mesh *mesh, scree_error *error) {
  size_t vertex_count = r->curve->mesh->vertex_count, used = 0;
  scree_mesh made = {.triangle_count = r->triangle_count};
  memset(r->number, 0xff, vertex_count * sizeof *r->number);
  for (size_t i = 0; i < 3 * r->triangle_count; i++) r->number[r->corner[i]] = 0;
  for (size_t v = 0; v < vertex_count; v++)
    if (r->number[v] == 0) r->number[v] = (uint32_t)used++;
  made.vertex_count = used;
  SCREE_ALLOC_OR(made.positions, 3 * used, error, out_of_memory);
  SCREE_ALLOC_OR(made.triangles, 3 * r->triangle_count, error, out_of_memory);
  for (size_t v = 0; v < vertex_count; v++)
    if (r->number[v] != SCREE_NONE)
      memcpy(made.positions + 3 * (size_t)r->number[v], r->position + 3 * v, 3 * sizeof(double));
  for (size_t i = 0; i < 3 * r->triangle_count; i++) made.triangles[i] = r->number[r->corner[i]];
  *mesh = made;
  return SCREE_OK;
out_of_memory:
  scree_mesh_free(&made);
  return SCREE_OUT_OF_MEMORY;
}

static scree_status copy_whole(scree_replay *r, const scree_whole_level *w, scree_mesh *mesh,
                               scree_error *error) {
  scree_mesh made = {.vertex_count = w->vertex_count, .triangle_count = w->triangle_count};
  memset(r->number, 0xff, r->curve->mesh->vertex_count * sizeof *r->number);
  SCREE_ALLOC_OR(made.positions, 3 * w->vertex_count, error, out_of_memory);
  SCREE_ALLOC_OR(made.triangles, 3 * w->triangle_count, error, out_of_memory);
  for (size_t v = 0; v < w->vertex_count; v++) {
    vec3_store(made.positions + 3 * v, w->position[v]);
    r->number[w->origin[v]] = (uint32_t)v;
  }
  memcpy(made.triangles, w->triangle, w->triangle_count * sizeof *w->triangle);
  *mesh = made;
  return SCREE_OK;
out_of_memory:
  scree_mesh_free(&made);
  return SCREE_OUT_OF_MEMORY;
}

scree_status scree_replay_step(scree_replay *replay, size_t level_index, const scree_mesh **mesh,
                               scree_error *error) {
  size_t last = scree_curve_level_count(replay->curve) - 1;
  if (level_index < replay->level || level_index > last)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "level %zu is not within [%zu, %zu]", level_index,
                      replay->level, last);
  const scree_whole_level *whole = whole_at(replay->curve, level_index);
  scree_mesh made;
  if (!whole) replay_collapses(replay, level_index);
  scree_status status =
      whole ? copy_whole(replay, whole, &made, error) : number_vertices(replay, &made, error);
  if (status != SCREE_OK) return status;
  scree_mesh_free(&replay->mesh);
  replay->mesh = made;
  replay->level = level_index;
  *mesh = &replay->mesh;
  return SCREE_OK;
}

scree_status scree_curve_mesh(const scree_curve *curve, size_t level_index, scree_mesh *mesh,
                              scree_error *error) {
  scree_replay *replay = NULL;
  const scree_mesh *level;
  scree_status status = scree_replay_start(curve, &replay, error);
  if (status == SCREE_OK) status = scree_replay_step(replay, level_index, &level, error);
  if (status == SCREE_OK) {
    *mesh = replay->mesh;
    replay->mesh = (scree_mesh){0};
  }
  scree_replay_free(replay);
  return status;
}
