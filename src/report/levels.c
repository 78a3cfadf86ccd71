/* Levels of one object for the report, small enough to send: the scan, and a finest level with the
 * collapses that lead from it down. Positions lie on a grid of
 * 16 bits; where a collapse puts a vertex is told by the steps on that grid from where the vertex
 * was. Both, and the triangles, go through meshoptimizer's codecs, which web/src/levels.js reads
 * with the same library's JavaScript.
 *
 * What fits is found by trying: the levels get their share first, the scan what is left of
 * byte_limit, and where the scan needs more, the first level of the curve that does not. */
#include "report/page_parts.h"
#include "report/program.h"

#include "base/owned.h"
#include "base/seal.h"
#include "report/pack.h"

#include <string.h>

static const scree_seal seal = {"screeLVL", "file of scree's levels", "levels", 3};

/* How the limit is shared: found on scans of 80,000 to 762,008 triangles, see
 * docs/reference/formats.md. */
static const double levels_share = 0.32;         /* of the bytes: base and collapses */
static const double bytes_per_base_triangle = 8; /* with its collapses */
static const double bytes_per_scan_triangle = 3; /* first guess */
static const size_t least_base_triangles = 500;  /* however small the limit */
static const size_t most_base_triangles =
    150000; /* a browser redraws them while the slider moves */
static const double retry_margin = 0.97;
enum { MOST_TRIES = 6 };

typedef struct levels {
  scree_packing pack;
  const scree_curve *curve;
} levels;

static void free_levels(levels *l) {
  scree_free(l->pack.out.bytes);
}

/* ---- the grid ---- */

/* Holds the scan and every place that a collapse puts a vertex to. */
static void find_grid(levels *l, const scree_mesh *scan) {
  double low[3], high[3];
  scree_pack_box(scan, low, high);
  for (size_t i = 0; i < scree_curve_collapse_count(l->curve); i++) {
    scree_collapse collapse;
    scree_curve_collapse(l->curve, i, &collapse);
    scree_pack_stretch(collapse.position, low, high);
  }
  scree_pack_grid(&l->pack, low, high);
}

/* ---- the parts ---- */

/* Pairs of kept and gone, in the vertices of the packed base, and the steps on the grid. */
typedef struct steps {
  levels *l;
  const uint32_t *number; /* of the given mesh's vertices in the base */
  const uint32_t *place;  /* of these in the file */
  uint32_t *pairs;
  scree_grid_point *moves, *now;
  size_t count;
} steps;

static void put_collapse(steps *s, size_t index) {
  scree_collapse c;
  scree_curve_collapse(s->l->curve, index, &c);
  uint32_t v = s->number[c.kept];
  scree_grid_point to = scree_pack_point(&s->l->pack, c.position), *move = &s->moves[s->count];
  for (int k = 0; k < 3; k++) move->x[k] = (uint16_t)(to.x[k] - s->now[v].x[k]);
  move->extra = (uint16_t)c.triangle_count;
  s->now[v] = to;
  s->pairs[2 * s->count] = s->place[v];
  s->pairs[2 * s->count++ + 1] = s->place[s->number[c.gone]];
}

/* Collapses from base_level on. */
static scree_status put_collapses(levels *l, size_t base_level, const scree_mesh *base,
                                  const uint32_t *number, const uint32_t *place) {
  size_t last = scree_curve_collapse_count(l->curve), count = last - base_level;
  SCREE_SCRATCH(uint32_t, pairs, 2 * count + 1, l->pack.error);
  SCREE_SCRATCH(scree_grid_point, moves, count + 1, l->pack.error);
  SCREE_SCRATCH(scree_grid_point, now, base->vertex_count, l->pack.error);
  steps s = {l, number, place, pairs, moves, now, 0};
  for (size_t v = 0; v < base->vertex_count; v++)
    now[v] = scree_pack_point(&l->pack, base->positions + 3 * v);
  for (size_t i = base_level; i < last; i++) put_collapse(&s, i);
  scree_pack_u32(&l->pack, s.count);
  SCREE_TRY(scree_pack_vertices(&l->pack, pairs, s.count, 2 * sizeof *pairs));
  return scree_pack_vertices(&l->pack, moves, s.count, sizeof *moves);
}

static scree_status put_levels(levels *l, size_t base_level) {
  SCREE_OWNED(scree_replay, replay);
  const scree_mesh *base;
  SCREE_TRY(scree_replay_start(l->curve, &replay, l->pack.error));
  SCREE_TRY(scree_replay_step(replay, base_level, &base, l->pack.error));
  SCREE_SCRATCH(uint32_t, place, base->vertex_count, l->pack.error);
  SCREE_TRY(scree_pack_mesh(&l->pack, base, place));
  return put_collapses(l, base_level, base, scree_replay_numbering(replay), place);
}

/* The scan where it fits into room bytes, else the finest level that does. */
static scree_status put_scan(levels *l, const scree_mesh *scan, size_t room) {
  size_t start = l->pack.out.count, target = scan->triangle_count;
  if ((double)target * bytes_per_scan_triangle > 1.3 * (double)room)
    target = (size_t)((double)room / bytes_per_scan_triangle);
  for (int i = 0;; i++) {
    SCREE_CLEANUP(scree_mesh_free) scree_mesh level = {0};
    bool whole = target >= scan->triangle_count;
    if (!whole)
      SCREE_TRY(
          scree_curve_mesh(l->curve, scree_curve_find(l->curve, target), &level, l->pack.error));
    SCREE_TRY(scree_pack_mesh(&l->pack, whole ? scan : &level, NULL));
    size_t used = l->pack.out.count - start;
    if (used <= room || i == MOST_TRIES) return SCREE_OK;
    l->pack.out.count = start;
    target = (size_t)(retry_margin * (double)target * (double)room / (double)used);
  }
}

/* The dense curve: rows of triangle count, area, volume, eps_s, worst eps_s, from coarse to fine,
 * without rows that repeat a level. */
static void put_trace(levels *l, const scree_choice *choice) {
  size_t count = 0;
  for (int counting = 1; counting >= 0; counting--) {
    if (!counting) scree_pack_u32(&l->pack, count);
    for (size_t i = 0; i < choice->trace_count; i++) {
      const scree_choice_level *at = &choice->trace[i];
      if (i > 0 && at->level_index == choice->trace[i - 1].level_index) continue;
      count++;
      if (counting) continue;
      double row[] = {(double)at->triangle_count, at->area, at->volume, at->eps_s, at->worst_eps_s};
      scree_code_reals(&l->pack.out, row, sizeof row / sizeof *row);
    }
  }
}

/* Measures of the scan and of the choices, in the order paper, robust, recommended. */
static scree_status put_measures(levels *l, const scree_mesh *scan, const scree_choice *choice) {
  const scree_pick *picks[] = {&choice->paper, &choice->robust, &choice->recommended};
  enum { PICKS = sizeof picks / sizeof *picks };
  scree_pack_u32(&l->pack, PICKS + 1);
  for (int i = -1; i < PICKS; i++) {
    SCREE_CLEANUP(scree_mesh_free) scree_mesh level = {0};
    const scree_mesh *of = i >= 0 ? &level : scan;
    scree_measures m;
    if (i >= 0) SCREE_TRY(scree_curve_mesh(l->curve, picks[i]->level_index, &level, l->pack.error));
    SCREE_TRY(scree_mesh_measure(of, &m, l->pack.error));
    double row[] = {(double)of->triangle_count, m.area, m.volume};
    scree_code_reals(&l->pack.out, row, sizeof row / sizeof *row);
    scree_code_reals(&l->pack.out, m.oriented_dimensions, 3);
    scree_code_reals(&l->pack.out, m.principal_moments, 3);
    scree_code_real(&l->pack.out, &m.sphericity);
    scree_code_real(&l->pack.out, &m.convexity);
  }
  return SCREE_OK;
}

/* The finest level whose share of the limit holds it with the collapses after it. */
static size_t choose_base(const scree_curve *curve, double room) {
  size_t level = scree_curve_collapse_count(curve);
  for (; level > 0; level--) {
    scree_level finer;
    scree_curve_level(curve, level - 1, &finer);
    if (finer.triangle_count > most_base_triangles ||
        (finer.triangle_count > least_base_triangles &&
         bytes_per_base_triangle * (double)finer.triangle_count > room))
      break;
  }
  return level;
}

static scree_status pack(levels *l, const scree_mesh *scan, const scree_choice *choice,
                         size_t byte_limit) {
  find_grid(l, scan);
  scree_code_reals(&l->pack.out, l->pack.low, 3);
  scree_code_real(&l->pack.out, &l->pack.step);
  scree_pack_u32(&l->pack, scan->triangle_count);
  put_trace(l, choice);
  SCREE_TRY(put_measures(l, scan, choice));
  SCREE_TRY(put_levels(l, choose_base(l->curve, levels_share * (double)byte_limit)));
  size_t used = l->pack.out.count - SCREE_SEAL_BYTES;
  return put_scan(l, scan, byte_limit > used ? byte_limit - used : 0);
}

/* ---- the file ---- */

scree_status scree_levels_write(const scree_curve *curve, const scree_choice *choice,
                                size_t byte_limit, const char *path, bool overwrite,
                                scree_error *error) {
  SCREE_CLEANUP(free_levels) levels l = {.curve = curve, .pack = {.error = error}};
  SCREE_CLEANUP(scree_mesh_free) scree_mesh scan = {0};
  SCREE_TRY(scree_curve_mesh(curve, 0, &scan, error));
  scree_seal_begin(&l.pack.out);
  SCREE_TRY(pack(&l, &scan, choice, byte_limit));
  SCREE_TRY(scree_seal_end(&l.pack.out, &seal, error));
  return scree_seal_write(l.pack.out.bytes, l.pack.out.count, path, overwrite, error);
}

scree_status scree_levels_check(const char *bytes, size_t byte_count, const char *name,
                                scree_error *error) {
  scree_codec in = {.source = (const unsigned char *)bytes, .count = byte_count, .loading = true};
  return scree_seal_check(&in, &seal, name, error);
}

static void skip(scree_codec *in, size_t count) {
  if (count > in->count - in->position)
    in->failed = true;
  else
    in->position += count;
}

static uint32_t read_u32(scree_codec *in) {
  uint32_t value = 0;
  scree_code_u32(in, &value);
  return value;
}

static void skip_packed(scree_codec *in, int buffer_count) {
  for (int i = 0; i < buffer_count; i++) skip(in, read_u32(in));
}

size_t scree_levels_drop_scan(char *bytes, size_t byte_count) {
  enum { GRID = 32, ROW = 40, MEASURE = 88, MESH_COUNTS = 8, NO_MESH = 16 };
  scree_codec in = {.source = (const unsigned char *)bytes, .count = byte_count, .loading = true};
  skip(&in, SCREE_SEAL_BYTES + GRID + sizeof(uint32_t));
  skip(&in, (size_t)read_u32(&in) * ROW);
  skip(&in, (size_t)read_u32(&in) * MEASURE);
  skip(&in, MESH_COUNTS);
  skip_packed(&in, 2);
  read_u32(&in); /* collapses */
  skip_packed(&in, 2);
  size_t start = in.position;
  if (in.failed || byte_count - start < NO_MESH) return byte_count;
  memset(bytes + start, 0, NO_MESH); /* no vertices, no triangles, nothing packed of either */
  scree_codec left = {.bytes = (unsigned char *)bytes, .count = start + NO_MESH};
  (void)scree_seal_end(&left, &seal, NULL);
  return left.count;
}
