/* A level whose vertices are moved to where its surface is nearer to the scan.
 *
 * The samples are all vertices of the scan, each with the area around it, each in the list of the
 * level's triangle that it is nearest to (cost/deviation.h). In each sweep one vertex after the
 * other is taken to where the sum of its samples' distances by area becomes less: one step of
 * weighted least squares, weights one over the distance (Weiszfeld 1937), across the triangle for a
 * sample above it, else towards the sample. All guards of decimation hold, and no vertex makes the
 * deviation both larger and unusual. Then all vertices are moved along their normals by one length,
 * which brings the volume back. If in the end the distance, measured at other places of the scan,
 * is no less, or the volume could not be brought back, the level stays as it was. */
#include "base/parallel.h"
#include "mesh/index/closest.h"
#include "mesh/mesh.h"
#include "simplify/cost/deviation.h"
#include "simplify/curve.h"
#include "simplify/guard/apart.h"
#include "simplify/tuning.h"

/* A step must make the sum less by this. */
#define WORTH 1e-3
/* In the unit box: samples that are no farther in the mean lie on the surface. */
#define ROUNDING 1e-14
/* The volume's relative error, above rounding. */
#define VOLUME_KEPT 1e-13

typedef struct fit {
  scree_halfmesh s; /* the level */
  scree_surface_tree tree;
  scree_markers markers;
  scree_samples samples;
  double *area;  /* per vertex of the scan: of the triangles around */
  double volume; /* six times, to be kept */
  scree_fan fan;
  scree_gathered gathered;
} fit;

static void fit_free(fit *f) {
  scree_halfmesh_free(&f->s);
  scree_surface_tree_free(&f->tree);
  scree_markers_free(&f->markers);
  scree_samples_free(&f->samples);
  scree_free(f->area);
  scree_free(f->gathered.items);
}

/* ---- Start ---- */

/* The level's surface, in the box of the scan and with its names. */
static scree_status build_level(fit *f, const scree_curve *curve, const scree_mesh *level,
                                const uint32_t *numbering, scree_error *error) {
  const scree_halfmesh *scan = &f->samples.scan;
  scree_halfmesh *s = &f->s;
  SCREE_TRY(scree_halfmesh_build(level, scan, s, error));
  SCREE_SCRATCH(uint32_t, name, level->vertex_count, error);
  for (uint32_t v = 0; v < curve->mesh->vertex_count; v++)
    if (numbering[v] != SCREE_NONE) name[numbering[v]] = v;
  for (size_t v = 0; v < s->vertex_count; v++) s->vertex[v].origin = name[s->vertex[v].origin];
  s->area = scan->area;
  return SCREE_OK;
}

static scree_status find_areas(fit *f, scree_error *error) {
  const scree_halfmesh *scan = &f->samples.scan;
  SCREE_TRY_ALLOC_ZERO(f->area, scan->vertex_count, error);
  for (size_t h = 0; h < 3 * scan->triangle_count; h++)
    f->area[scan->half[h].from] += vec3_norm(scree_normal_of(scan, h / 3));
  return SCREE_OK;
}

static double six_volumes(const scree_halfmesh *s) {
  scree_sum area = {0}, volume = {0};
  for (size_t t = 0; t < s->triangle_count; t++) scree_add_triangle(s, t, &area, &volume);
  return 6 * scree_sum_value(volume);
}

static scree_status fit_start(fit *f, const scree_curve *curve, const scree_mesh *level,
                              const uint32_t *numbering, scree_error *error) {
  scree_halfmesh *scan = &f->samples.scan;
  SCREE_TRY(scree_halfmesh_build(curve->mesh, NULL, scan, error));
  scan->area = curve->area / (scan->scale * scan->scale);
  SCREE_TRY(scree_samples_start(&f->samples, error));
  SCREE_TRY(build_level(f, curve, level, numbering, error));
  SCREE_TRY(scree_surface_tree_make(&f->s, &f->tree, error));
  SCREE_TRY(scree_markers_find(&f->s, &f->markers, error));
  SCREE_TRY(scree_samples_find(&f->s, &f->tree, &f->samples, error));
  f->volume = six_volumes(&f->s);
  return find_areas(f, error);
}

/* ---- One vertex ---- */

/* The fan's triangle that is nearest to p; *nearest is looked at first. */
static double to_fan(const scree_fan *f, vec3 p, uint32_t *nearest) {
  double best = INFINITY;
  for (uint32_t k = 0, i = *nearest; k < f->count; k++, i = i + 1 < f->count ? i + 1 : 0) {
    const vec3 corner[3] = {f->at, f->from[i], f->to[i]};
    double d = scree_distance2(corner, p);
    if (d < best) best = d, *nearest = i;
  }
  return best;
}

static double sum_of_areas(const fit *f) {
  double sum = 0;
  for (size_t k = 0; k < f->gathered.count; k++) sum += f->area[f->gathered.items[k].sample];
  return sum;
}

/* The sum of the gathered samples' distances from the fan as it is set, by area. */
static double sum_of_distances(const fit *f) {
  const scree_samples *p = &f->samples;
  double sum = 0;
  for (size_t k = 0; k < f->gathered.count; k++) {
    uint32_t v = f->gathered.items[k].sample, nearest = f->gathered.items[k].start;
    sum += f->area[v] * sqrt(to_fan(&f->fan, p->scan.vertex[v].at, &nearest));
  }
  return sum;
}

/* Normal equations of the step: H step = g. */
typedef struct equations {
  vec3 row[3]; /* of H */
  vec3 g;
} equations;

/* One sample at p, of that area. */
static void add_sample(equations *q, const scree_fan *f, vec3 p, double area, double least) {
  uint32_t i = 0;
  vec3 at;
  to_fan(f, p, &i);
  const double corners[9] = {f->at.x,      f->at.y,    f->at.z,    f->from[i].x, f->from[i].y,
                             f->from[i].z, f->to[i].x, f->to[i].y, f->to[i].z};
  double distance = sqrt(scree_triangle_closest(corners, p, &at)), n2 = vec3_norm2(f->after[i]);
  if (!(n2 > 0)) return;
  vec3 rest = vec3_triangle_normal(at, f->from[i], f->to[i]), to = vec3_sub(p, at);
  double share = vec3_dot(rest, f->after[i]) / n2; /* of the vertex in the point */
  vec3 across = vec3_scale(f->after[i], 1 / sqrt(n2));
  bool above = fabs(vec3_dot(across, to)) >= (1 - 1e-9) * distance;
  vec3 along = above ? across : vec3_scale(to, 1 / distance);
  double weight = area * share / scree_larger(distance, least);
  q->g = vec3_mad(q->g, along, weight * vec3_dot(along, to));
  q->row[0] = vec3_mad(q->row[0], along, weight * share * along.x);
  q->row[1] = vec3_mad(q->row[1], along, weight * share * along.y);
  q->row[2] = vec3_mad(q->row[2], along, weight * share * along.z);
}

/* Where the fan's vertex, as it is set, would be better. */
static vec3 better_place(const fit *f) {
  const scree_samples *p = &f->samples;
  equations q = {0};
  for (size_t k = 0; k < f->gathered.count; k++) {
    uint32_t v = f->gathered.items[k].sample;
    add_sample(&q, &f->fan, p->scan.vertex[v].at, f->area[v], scree_tune.near * p->mean);
  }
  double hold = scree_tune.hold * (q.row[0].x + q.row[1].y + q.row[2].z);
  q.row[0].x += hold, q.row[1].y += hold, q.row[2].z += hold;
  vec3 across = vec3_cross(q.row[1], q.row[2]);
  double determinant = vec3_dot(q.row[0], across);
  if (!(determinant > 0)) return f->fan.at;
  vec3 step = {vec3_dot(q.g, across), vec3_dot(q.g, vec3_cross(q.row[2], q.row[0])),
               vec3_dot(q.g, vec3_cross(q.row[0], q.row[1]))};
  return vec3_mad(f->fan.at, step, 1 / determinant);
}

/* Moves the fan's vertex to where the fan is set, if the guards allow; its samples were gathered.
 */
static bool move(fit *f) {
  const scree_surroundings around = {&f->s, &f->tree, &f->markers};
  scree_fan *fan = &f->fan;
  if (scree_shape_is_spike(&f->s, fan->at) || !scree_shape_allows(&f->s, fan, 0) ||
      !scree_apart(&around, fan))
    return false;
  scree_samples_settle(&f->samples, fan, &f->gathered);
  f->s.vertex[fan->a].at = fan->at;
  for (uint32_t i = 0; i < fan->count; i++) {
    scree_bounds b = scree_fan_bounds(fan, i);
    scree_surface_tree_grow(&f->tree, fan->edge[i] / 3, &b, fan->after[i]);
  }
  return true;
}

/* The fan of a vertex that may move, set to where it is, and its samples. False: it stays. */
static bool take_vertex(fit *f, uint32_t v, bool *out_of_memory) {
  if (f->s.vertex[v].outgoing == SCREE_NONE || f->s.flags[v] & SCREE_VERTEX_LOCKED ||
      !scree_fan_of_vertex(&f->s, v, &f->fan))
    return false;
  scree_fan_set(&f->fan, f->s.vertex[v].at);
  if (!scree_samples_gather(&f->samples, &f->s, &f->fan, &f->gathered)) *out_of_memory = true;
  return !*out_of_memory;
}

static double find_deviation(const fit *f, double from) {
  return scree_deviation_find(&f->samples, &f->s, &f->fan, from, INFINITY);
}

static void improve(fit *f, uint32_t v, bool *out_of_memory) {
  double usual = 0.5 * scree_tune.usual * f->samples.mean;
  if (!take_vertex(f, v, out_of_memory) || f->gathered.count < f->fan.count) return;
  double sum = sum_of_distances(f);
  if (sum <= ROUNDING * sum_of_areas(f)) return;
  vec3 place = better_place(f);
  scree_fan_set(&f->fan, place);
  if (!(sum_of_distances(f) < (1 - WORTH) * sum)) return;
  double far = find_deviation(f, usual);
  if (far > usual) {
    scree_fan_set(&f->fan, f->s.vertex[v].at);
    if (far > find_deviation(f, 0)) return;
    scree_fan_set(&f->fan, place);
  }
  move(f);
}

/* ---- The volume ---- */

/* What moving the vertex along this changes of six volumes, per length of it. */
static vec3 area_vector(const scree_fan *fan) {
  vec3 sum = {0, 0, 0};
  for (uint32_t i = 0; i < fan->count; i++) sum = vec3_add(sum, fan->after[i]);
  return sum;
}

/* All vertices go by one length. */
static void inflate(fit *f, double missing, bool *out_of_memory) {
  double all = 0;
  for (uint32_t v = 0; v < f->s.vertex_count; v++)
    if (take_vertex(f, v, out_of_memory)) all += vec3_norm(area_vector(&f->fan));
  for (uint32_t v = 0; v < f->s.vertex_count && all > 0; v++) {
    if (!take_vertex(f, v, out_of_memory)) continue;
    vec3 place = vec3_mad(f->fan.at, vec3_unit(area_vector(&f->fan)), missing / all);
    scree_fan_set(&f->fan, place);
    move(f);
  }
}

/* One vertex takes up what is missing. */
static void take_up(fit *f, double missing, bool *out_of_memory) {
  for (uint32_t v = 0; v < f->s.vertex_count; v++) {
    if (!take_vertex(f, v, out_of_memory)) continue;
    vec3 along = area_vector(&f->fan);
    if (!(vec3_norm2(along) > 0)) continue;
    scree_fan_set(&f->fan, vec3_mad(f->fan.at, along, missing / vec3_norm2(along)));
    if (move(f)) return;
  }
}

/* False: the volume could not be kept. */
static bool restore_volume(fit *f, bool *out_of_memory) {
  double missing = 0;
  if (!f->s.closed) return true;
  for (int k = 0; k < 4; k++) {
    missing = f->volume - six_volumes(&f->s);
    if (fabs(missing) <= VOLUME_KEPT * fabs(f->volume)) return true;
    if (k < 2)
      inflate(f, missing, out_of_memory);
    else
      take_up(f, missing, out_of_memory);
  }
  return fabs(f->volume - six_volumes(&f->s)) <= VOLUME_KEPT * fabs(f->volume);
}

/* ---- The pass ---- */

/* Sums of distances by blocks of the scan's triangles. */
typedef struct summing {
  const fit *f;
  double *blocks;
} summing;

enum { BLOCK = 4096 };

static void sum_block(void *context, scree_block block) {
  const summing *m = context;
  const fit *f = m->f;
  const scree_halfmesh *scan = &f->samples.scan;
  uint32_t nearest = SCREE_NONE;
  double sum = 0;
  for (size_t t = block.begin; t < block.end; t++) {
    vec3 at[3];
    scree_corners(scan, t, at);
    vec3 middle = vec3_scale(vec3_add(vec3_add(at[0], at[1]), at[2]), 1.0 / 3);
    double d2 = scree_surface_tree_distance(&f->tree, &f->s, middle, 0, &nearest);
    sum += vec3_norm(vec3_triangle_normal(at[0], at[1], at[2])) * sqrt(d2);
  }
  m->blocks[block.index] = sum;
}

/* The sum over the scan, by area: of the middles of its triangles, which the fit does not see, so
 * that a level fitted to the noise of the vertices is found out. */
static scree_status sum_over_scan(const fit *f, double *sum, scree_error *error) {
  size_t count = scree_block_count(f->samples.scan.triangle_count, BLOCK);
  SCREE_SCRATCH(double, blocks, count, error);
  summing m = {f, blocks};
  scree_parallel_for(f->samples.scan.triangle_count, BLOCK, sum_block, &m);
  *sum = 0;
  for (size_t i = 0; i < count; i++) *sum += blocks[i];
  return SCREE_OK;
}

/* False: the volume could not be kept. */
static bool sweep(fit *f, bool *out_of_memory) {
  for (uint32_t v = 0; v < f->s.vertex_count && !*out_of_memory; v++) improve(f, v, out_of_memory);
  return restore_volume(f, out_of_memory);
}

/* *better: the level is nearer to the scan than it was. */
static scree_status run(fit *f, bool *better, scree_error *error) {
  bool out_of_memory = false, kept = true;
  double before, after;
  SCREE_TRY(sum_over_scan(f, &before, error));
  for (int k = 0; k < scree_tune.sweeps && kept; k++) kept = sweep(f, &out_of_memory);
  if (out_of_memory)
    return scree_fail_memory(error, f->gathered.count * sizeof *f->gathered.items, "samples");
  SCREE_TRY(sum_over_scan(f, &after, error));
  *better = kept && after < before;
  return SCREE_OK;
}

/* What moved, to the mesh of the level. */
static void write_back(const fit *f, const uint32_t *numbering, scree_mesh *level) {
  const scree_halfmesh *s = &f->s;
  for (size_t v = 0; v < s->vertex_count; v++) {
    if (s->vertex[v].outgoing == SCREE_NONE) continue;
    double *at = level->positions + 3 * (size_t)numbering[s->vertex[v].origin];
    vec3 moved = vec3_sub(s->vertex[v].at, scree_into_box(s, vec3_load(at)));
    if (vec3_norm2(moved) > 0) vec3_store(at, vec3_mad(s->centre, s->vertex[v].at, s->scale));
  }
}

scree_status scree_curve_fit(const scree_curve *curve, size_t level_index, scree_mesh *mesh,
                             scree_error *error) {
  SCREE_OWNED(scree_replay, replay);
  SCREE_CLEANUP(fit_free) fit f = {0};
  const scree_mesh *level;
  bool better;
  SCREE_TRY(scree_replay_start(curve, &replay, error));
  SCREE_TRY(scree_replay_step(replay, level_index, &level, error));
  SCREE_TRY(fit_start(&f, curve, level, scree_replay_numbering(replay), error));
  SCREE_TRY(run(&f, &better, error));
  SCREE_TRY(scree_mesh_copy(level, mesh, error));
  if (better) write_back(&f, scree_replay_numbering(replay), mesh);
  return SCREE_OK;
}
