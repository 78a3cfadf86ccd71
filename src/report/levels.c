/* Levels of one object for the report, small enough to send: the scan, and a finest level with the
 * collapses that lead from it down. Positions lie on a grid of
 * 16 bits; where a collapse puts a vertex is told by the steps on that grid from where the vertex
 * was. Both, and the triangles, go through meshoptimizer's codecs, which web/src/levels.js reads
 * with the same library's JavaScript.
 *
 * What fits is found by trying: the levels get their share first, the scan what is left of
 * byte_limit, and where the scan needs more, the first level of the curve that does not. */
#include "report/levels.h"
#include "report/program.h"

#include "base/alloc.h"
#include "base/file.h"
#include "report/pack.h"

#include <math.h>
#include <string.h>

static const char magic[] = "screeLVL";
enum { VERSION = 3, BYTE_ORDER_MARK = 0x01020304, HEADER_BYTES = 40 };

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

/* ---- the grid ---- */

/* Holds the scan and every place that a collapse puts a vertex to. */
static void find_grid(levels *l, const scree_mesh *scan) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t v = 0; v < scan->vertex_count; v++)
    scree_pack_stretch(scan->positions + 3 * v, low, high);
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
  steps s = {.l = l, .number = number, .place = place};
  scree_status status = SCREE_OUT_OF_MEMORY;
  SCREE_ALLOC_OR(s.pairs, 2 * count + 1, l->pack.error, done);
  SCREE_ALLOC_OR(s.moves, count + 1, l->pack.error, done);
  SCREE_ALLOC_OR(s.now, base->vertex_count, l->pack.error, done);
  for (size_t v = 0; v < base->vertex_count; v++)
    s.now[v] = scree_pack_point(&l->pack, base->positions + 3 * v);
  for (size_t i = base_level; i < last; i++) put_collapse(&s, i);
  scree_pack_u32(&l->pack, s.count);
  status = scree_pack_vertices(&l->pack, s.pairs, s.count, 2 * sizeof *s.pairs);
  if (status == SCREE_OK) status = scree_pack_vertices(&l->pack, s.moves, s.count, sizeof *s.moves);
done:
  scree_free(s.pairs);
  scree_free(s.moves);
  scree_free(s.now);
  return status;
}

static scree_status put_levels(levels *l, size_t base_level) {
  scree_replay *replay = NULL;
  const scree_mesh *base;
  uint32_t *place = NULL;
  scree_status status = scree_replay_start(l->curve, &replay, l->pack.error);
  if (status == SCREE_OK) status = scree_replay_step(replay, base_level, &base, l->pack.error);
  if (status != SCREE_OK) goto done;
  place = scree_alloc(base->vertex_count, sizeof *place);
  if (!place) {
    status = scree_fail_memory(l->pack.error, base->vertex_count * sizeof *place, "packed levels");
    goto done;
  }
  status = scree_pack_mesh(&l->pack, base, place);
  if (status == SCREE_OK)
    status = put_collapses(l, base_level, base, scree_replay_numbering(replay), place);
done:
  scree_free(place);
  scree_replay_free(replay);
  return status;
}

/* The scan where it fits into room bytes, else the finest level that does. */
static scree_status put_scan(levels *l, const scree_mesh *scan, size_t room) {
  size_t start = l->pack.out.count, target = scan->triangle_count;
  if ((double)target * bytes_per_scan_triangle > 1.3 * (double)room)
    target = (size_t)((double)room / bytes_per_scan_triangle);
  for (int i = 0;; i++) {
    scree_mesh level = {0};
    scree_status status = SCREE_OK;
    if (target >= scan->triangle_count) {
      status = scree_pack_mesh(&l->pack, scan, NULL);
    } else {
      status =
          scree_curve_mesh(l->curve, scree_curve_find(l->curve, target), &level, l->pack.error);
      if (status == SCREE_OK) status = scree_pack_mesh(&l->pack, &level, NULL);
      scree_mesh_free(&level);
    }
    size_t used = l->pack.out.count - start;
    if (status != SCREE_OK || used <= room || i == MOST_TRIES) return status;
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

/* Measures of the scan and of the choices, in the order paper, robust, smooth, plain, recommended,
 * cost. */
static scree_status put_measures(levels *l, const scree_mesh *scan, const scree_choice *choice) {
  const scree_pick *picks[] = {&choice->paper, &choice->robust,      &choice->smooth,
                               &choice->plain, &choice->recommended, &choice->cost};
  enum { PICKS = sizeof picks / sizeof *picks };
  scree_pack_u32(&l->pack, PICKS + 1);
  for (int i = -1; i < PICKS; i++) {
    scree_mesh level = {0};
    scree_measures m;
    scree_status status = SCREE_OK;
    if (i >= 0) status = scree_curve_mesh(l->curve, picks[i]->level_index, &level, l->pack.error);
    if (status == SCREE_OK) status = scree_mesh_measure(i >= 0 ? &level : scan, &m, l->pack.error);
    double row[] = {(double)(i >= 0 ? level.triangle_count : scan->triangle_count),
                    m.area,
                    m.volume,
                    m.oriented_dimensions[0],
                    m.oriented_dimensions[1],
                    m.oriented_dimensions[2],
                    m.principal_moments[0],
                    m.principal_moments[1],
                    m.principal_moments[2],
                    m.sphericity,
                    m.convexity};
    scree_mesh_free(&level);
    if (status != SCREE_OK) return status;
    scree_code_reals(&l->pack.out, row, sizeof row / sizeof *row);
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
  size_t room = byte_limit > l->pack.out.count ? byte_limit - l->pack.out.count : 0;
  SCREE_TRY(put_scan(l, scan, room));
  if (!scree_codec_good(&l->pack.out))
    return scree_fail_memory(l->pack.error, l->pack.out.count, "packed levels");
  return SCREE_OK;
}

/* ---- the file ---- */

/* Free its bytes. */
static scree_codec header_of(const void *bytes, size_t count) {
  scree_codec header = {0};
  scree_checksum sum = scree_checksum_of(bytes, count);
  uint32_t version = VERSION, mark = BYTE_ORDER_MARK;
  uint64_t length = count;
  char text[8];
  memcpy(text, magic, sizeof text);
  scree_code_bytes(&header, text, sizeof text);
  scree_code_u32(&header, &version);
  scree_code_u32(&header, &mark);
  scree_code_u64(&header, &length);
  scree_code_u64(&header, &sum.high);
  scree_code_u64(&header, &sum.low);
  return header;
}

static scree_status write_file(levels *l, const char *path, bool overwrite) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, l->pack.error));
  scree_codec header = header_of(l->pack.out.bytes, l->pack.out.count);
  if (header.out_of_memory) {
    scree_output_discard(&output);
    scree_free(header.bytes);
    return scree_fail_memory(l->pack.error, HEADER_BYTES, "a header");
  }
  fwrite(header.bytes, 1, header.count, output.stream);
  fwrite(l->pack.out.bytes, 1, l->pack.out.count, output.stream);
  scree_free(header.bytes);
  return scree_output_commit(&output, l->pack.error);
}

scree_status scree_levels_write(const scree_curve *curve, const scree_choice *choice,
                                size_t byte_limit, const char *path, bool overwrite,
                                scree_error *error) {
  levels l = {.curve = curve, .pack = {.error = error}};
  scree_mesh scan;
  SCREE_TRY(scree_curve_mesh(curve, 0, &scan, error));
  scree_status status = pack(&l, &scan, choice, byte_limit);
  scree_mesh_free(&scan);
  if (status == SCREE_OK) status = write_file(&l, path, overwrite);
  scree_free(l.pack.out.bytes);
  return status;
}

scree_status scree_levels_check(const char *bytes, size_t byte_count, const char *name,
                                scree_error *error) {
  scree_codec in = {.source = (const unsigned char *)bytes, .count = byte_count, .loading = true};
  char text[8];
  uint32_t version = 0, mark = 0;
  uint64_t length = 0;
  scree_checksum sum = {0, 0};
  scree_code_bytes(&in, text, sizeof text);
  scree_code_u32(&in, &version);
  scree_code_u32(&in, &mark);
  scree_code_u64(&in, &length);
  scree_code_u64(&in, &sum.high);
  scree_code_u64(&in, &sum.low);
  if (in.failed || memcmp(text, magic, sizeof text) != 0 || mark != BYTE_ORDER_MARK)
    return scree_fail(error, SCREE_BAD_FILE, "%s: is no file of levels of scree's", name);
  if (version != VERSION)
    return scree_fail(error, SCREE_BAD_FILE, "%s: version %u; this scree reads %d", name,
                      (unsigned)version, VERSION);
  size_t left = byte_count - HEADER_BYTES;
  scree_checksum found = scree_checksum_of(bytes + HEADER_BYTES, left);
  if (length != left || found.high != sum.high || found.low != sum.low)
    return scree_fail(error, SCREE_BAD_FILE, "%s: is damaged: %zu bytes after the header", name,
                      left);
  return SCREE_OK;
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
  skip(&in, HEADER_BYTES + GRID + sizeof(uint32_t));
  skip(&in, (size_t)read_u32(&in) * ROW);
  skip(&in, (size_t)read_u32(&in) * MEASURE);
  skip(&in, MESH_COUNTS);
  skip_packed(&in, 2);
  read_u32(&in); /* collapses */
  skip_packed(&in, 2);
  size_t start = in.position;
  if (in.failed || byte_count - start < NO_MESH) return byte_count;
  memset(bytes + start, 0, NO_MESH); /* no vertices, no triangles, nothing packed of either */
  size_t left = start + NO_MESH;
  scree_codec header = header_of(bytes + HEADER_BYTES, left - HEADER_BYTES);
  if (scree_codec_good(&header)) memcpy(bytes, header.bytes, HEADER_BYTES);
  scree_free(header.bytes);
  return left;
}
