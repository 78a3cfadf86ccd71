#include "clump/field.h"

#include "base/alloc.h"
#include "base/math.h"
#include "base/parallel.h"
#include "clump/lines.h"

/* What tunes the grid; lengths in the body's frame, where its volume is 1. */
static const double margin = 0.1, /* of the grid around the bounding box */
    bricks_per_cell_face = 2.4, /* cells near a surface of the area of one cell's face, measured */
    walls_cells = 4,            /* fine spacings that a wall shall have */
    usual_bricks = 10000,       /* for 100 spheres: spacing about 0.009 of a compact body's size */
    least_bricks = 2000,        /* for few */
    most_bricks = 24000;        /* 12 MB */
enum { MOST_NODES = 4000000, BLOCK = 64 };

static double choose_step(const scree_target *body, size_t most, double thickness) {
  double area = bricks_per_cell_face * body->area, each = scree_cbrt((double)most / 100);
  double bricks = fmax(least_bricks, usual_bricks * each * each);
  double usual = sqrt(area / bricks), least = sqrt(area / most_bricks);
  double wanted = fmax(fmin(usual, thickness * SCREE_FINER / walls_cells), least);
  double box = 1;
  const double low[3] = {body->low.x, body->low.y, body->low.z},
               high[3] = {body->high.x, body->high.y, body->high.z};
  for (int k = 0; k < 3; k++) box *= high[k] - low[k] + 2 * margin;
  return fmax(wanted, scree_cbrt(box / MOST_NODES));
}

static void lay_grid(const scree_target *body, scree_distance_field *f) {
  const double low[3] = {body->low.x, body->low.y, body->low.z},
               high[3] = {body->high.x, body->high.y, body->high.z};
  for (int k = 0; k < 3; k++) {
    f->low[k] = low[k] - margin;
    f->n[k] = (size_t)ceil((high[k] - low[k] + 2 * margin) / f->step) + 1;
  }
  f->per_step = 1 / f->step;
}

typedef struct job {
  const scree_target *body;
  scree_distance_field *field;
  const scree_lines *lines; /* through all fine nodes */
  const size_t *cells;      /* of each brick, its lowest node */
} job;

/* Signed distance at the fine node (i, j, k); *bound2 is a distance squared that is enough. */
static float node_distance(const job *j, const size_t at[3], double bound2) {
  const scree_distance_field *f = j->field;
  double fine = scree_distance_field_spacing(f);
  vec3 p = {f->low[0] + (double)at[0] * fine, f->low[1] + (double)at[1] * fine,
            f->low[2] + (double)at[2] * fine};
  scree_bvh_hit hit = {.distance2 = bound2};
  scree_bvh_closest(&j->body->tree, p, &hit);
  double d = sqrt(hit.distance2);
  return (float)(scree_lines_inside(j->lines, at[0] * j->lines->ny + at[1], p.z) ? -d : d);
}

/* What the node before is from the surface, and the way between, is an upper bound. */
static double bound_from(float before, double way) {
  double bound = (fabs((double)before) + way) * (1 + 1e-5);
  return bound * bound;
}

static void fill_rows(void *context, scree_block block) {
  const job *j = context;
  const scree_distance_field *f = j->field;
  for (size_t row = block.begin; row < block.end; row++)
    for (size_t k = 0; k < f->n[2]; k++) {
      size_t at[3] = {row / f->n[1] * SCREE_FINER, row % f->n[1] * SCREE_FINER, k * SCREE_FINER};
      float *value = f->values + row * f->n[2] + k;
      *value = node_distance(j, at, k ? bound_from(value[-1], f->step) : INFINITY);
    }
}

static void fill_bricks(void *context, scree_block block) {
  const job *j = context;
  const scree_distance_field *f = j->field;
  for (size_t b = block.begin; b < block.end; b++) {
    float *value = f->bricks[b];
    size_t cell = j->cells[b],
           origin[3] = {cell / f->n[2] / f->n[1], cell / f->n[2] % f->n[1], cell % f->n[2]};
    for (size_t i = 0; i < SCREE_BRICK_NODES; i++) {
      size_t at[3] = {i / SCREE_BRICK_SIDE / SCREE_BRICK_SIDE,
                      i / SCREE_BRICK_SIDE % SCREE_BRICK_SIDE, i % SCREE_BRICK_SIDE};
      double way =
          (i % SCREE_BRICK_SIDE ? 1 : SCREE_BRICK_SIDE + 1) * scree_distance_field_spacing(f);
      double bound2 = i ? bound_from(value[i - 1], way) : INFINITY;
      for (int k = 0; k < 3; k++) at[k] += origin[k] * SCREE_FINER;
      value[i] = node_distance(j, at, bound2);
    }
  }
}

/* Whether the surface may pass the coarse cell or come near it. */
static bool is_near(const scree_distance_field *f, const size_t at[3]) {
  if (at[0] + 1 >= f->n[0] || at[1] + 1 >= f->n[1] || at[2] + 1 >= f->n[2]) return false;
  const float *p = f->values + (at[0] * f->n[1] + at[1]) * f->n[2] + at[2];
  double reach = 0.87 * f->step; /* half a cell's diagonal */
  for (size_t c = 0; c < 8; c++) {
    float d = p[((c >> 2) * f->n[1] + (c >> 1 & 1)) * f->n[2] + (c & 1)];
    if (fabs((double)d) <= reach) return true;
  }
  return false;
}

/* Numbers the bricks, and lists their cells. */
static size_t number_bricks(scree_distance_field *f, size_t *cells) {
  size_t count = 0, node = 0;
  for (size_t i = 0; i < f->n[0]; i++)
    for (size_t j = 0; j < f->n[1]; j++)
      for (size_t k = 0; k < f->n[2]; k++, node++) {
        bool near = is_near(f, (size_t[3]){i, j, k});
        if (near) cells[count] = node;
        f->brick[node] = near ? (int32_t)count++ : -1;
      }
  return count;
}

static scree_status fill(const scree_target *body, scree_distance_field *f, scree_error *error) {
  size_t count = f->n[0] * f->n[1] * f->n[2];
  double fine = scree_distance_field_spacing(f);
  SCREE_CLEANUP(scree_lines_free)
  scree_lines lines = {.nx = (f->n[0] - 1) * SCREE_FINER + 1,
                       .ny = (f->n[1] - 1) * SCREE_FINER + 1,
                       .x0 = f->low[0] + 1.237e-6 * fine, /* off vertices on round numbers */
                       .y0 = f->low[1] + 2.311e-6 * fine,
                       .step = fine,
                       .cosine = 1};
  SCREE_TRY(scree_lines_cast(body, &lines, error));
  SCREE_TRY_ALLOC(f->values, count, error);
  SCREE_TRY_ALLOC(f->brick, count, error);
  SCREE_SCRATCH(size_t, cells, count, error);
  job j = {body, f, &lines, cells};
  scree_parallel_for(f->n[0] * f->n[1], BLOCK, fill_rows, &j);
  f->brick_count = number_bricks(f, cells);
  SCREE_TRY_ALLOC(f->bricks, f->brick_count, error);
  scree_parallel_for(f->brick_count, BLOCK, fill_bricks, &j);
  return SCREE_OK;
}

scree_status scree_distance_field_make(const scree_target *body, size_t most,
                                       scree_distance_field *field, scree_error *error) {
  SCREE_CLEANUP(scree_distance_field_free) scree_distance_field f = {0};
  SCREE_TRY(scree_target_thickness(body, &f.thickness, error));
  f.step = choose_step(body, most, f.thickness);
  lay_grid(body, &f);
  SCREE_TRY(fill(body, &f, error));
  *field = f;
  f = (scree_distance_field){0};
  return SCREE_OK;
}

void scree_distance_field_free(scree_distance_field *field) {
  scree_free(field->values);
  scree_free(field->brick);
  scree_free(field->bricks);
  *field = (scree_distance_field){0};
}

/* p: the value at the cell's lowest corner; dy and dx: how far its neighbours stand. */
static float between(const float *p, size_t dx, size_t dy, const float t[3]) {
  const float *q = p + dy, *r = p + dx, *s = r + dy;
  float a = p[0] + t[2] * (p[1] - p[0]), b = q[0] + t[2] * (q[1] - q[0]),
        c = r[0] + t[2] * (r[1] - r[0]), d = s[0] + t[2] * (s[1] - s[0]);
  a += t[1] * (b - a);
  c += t[1] * (d - c);
  return a + t[0] * (c - a);
}

float scree_distance_field_at(const scree_distance_field *f, const double p[3]) {
  float t[3], outside2 = 0;
  size_t at[3], fine[3];
  for (int k = 0; k < 3; k++) {
    float u = (float)((p[k] - f->low[k]) * f->per_step), most = (float)f->n[k] - 1.001f;
    float inside = u < 0 ? 0 : u > most ? most : u;
    outside2 += (u - inside) * (u - inside);
    at[k] = (uint32_t)(int32_t)inside;
    t[k] = inside - (float)(int32_t)inside;
  }
  size_t node = (at[0] * f->n[1] + at[1]) * f->n[2] + at[2];
  float rim = outside2 > 0 ? sqrtf(outside2) * (float)f->step : 0;
  if (f->brick[node] < 0) return rim + between(f->values + node, f->n[1] * f->n[2], f->n[2], t);
  for (int k = 0; k < 3; k++) {
    float u = t[k] * SCREE_FINER;
    fine[k] = (uint32_t)(int32_t)u;
    t[k] = u - (float)(int32_t)u;
  }
  size_t first = (fine[0] * SCREE_BRICK_SIDE + fine[1]) * SCREE_BRICK_SIDE + fine[2];
  return rim + between(f->bricks[f->brick[node]] + first, SCREE_BRICK_SIDE * SCREE_BRICK_SIDE,
                       SCREE_BRICK_SIDE, t);
}
