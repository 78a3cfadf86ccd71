/* The angle of repose of a height field, three ways that fail differently: sector lines follow the
 * flank that the eye sees, the cone uses every cell of the flank at once, and silhouettes are what
 * a camera beside the experiment would measure. A flank is where the height lies within a band of
 * the heap's own height (20 to 80 %): the toe of stray particles and the rounded top stay out. */
#include "base/alloc.h"
#include "base/vec.h"

#include <math.h>
#include <string.h>

static const double degree = 57.295779513082320877;
static const double pi = 3.14159265358979323846;
static const double bin_cells = 2;       /* width of a radial bin, in cells */
static const double fewest_bins = 3;     /* a line needs as many */
static const double least_share = 0.5;   /* of sectors and flanks that must give a line */
static const double sizes_of_a_heap = 2; /* lower, in particle sizes, is a layer and not a heap */
enum { CONE_ROUNDS = 50 };

scree_repose_options scree_default_repose_options(void) {
  return (scree_repose_options){
      .sector_count = 36, .silhouette_count = 18, .band_low = 0.2, .band_high = 0.8};
}

/* ---- straight lines ---- */

/* Running sums of a least-squares line y = a + b x. */
typedef struct line_fit {
  double n, x, y, xx, xy;
} line_fit;

static void line_add(line_fit *f, double x, double y) {
  f->n += 1;
  f->x += x;
  f->y += y;
  f->xx += x * x;
  f->xy += x * y;
}

/* False where fewer than three points or all at one x. */
static bool line_solve(const line_fit *f, double *intercept, double *slope) {
  double determinant = f->n * f->xx - f->x * f->x;
  if (f->n < fewest_bins || !(determinant > 1e-12 * f->n * f->xx)) return false;
  *slope = (f->n * f->xy - f->x * f->y) / determinant;
  *intercept = (f->y - *slope * f->x) / f->n;
  return true;
}

typedef struct spread {
  double sum, sum2;
  size_t count;
} spread;

static void spread_add(spread *s, double x) {
  s->sum += x;
  s->sum2 += x * x;
  s->count++;
}
static double spread_mean(const spread *s) {
  return s->count ? s->sum / (double)s->count : NAN;
}
static double spread_sd(const spread *s) {
  if (s->count < 2) return NAN;
  double n = (double)s->count, variance = (s->sum2 - s->sum * s->sum / n) / (n - 1);
  return variance > 0 ? sqrt(variance) : 0;
}

/* ---- what all ways share ---- */

typedef struct heap {
  const scree_height_field *field;
  const scree_repose_options *options;
  scree_repose *result;
  size_t bin_count;
  double bin_width;
  double *sum, *cells; /* (sector_count + 1) rows of bins; the last row is the whole ring */
} heap;

static double cell_x(const scree_height_field *f, size_t i) {
  return f->x + ((double)i + 0.5) * f->cell;
}
static double cell_y(const scree_height_field *f, size_t j) {
  return f->y + ((double)j + 0.5) * f->cell;
}

static void measure_extent(heap *h) {
  const scree_height_field *f = h->field;
  double volume = 0, mx = 0, my = 0, peak = 0;
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double z = f->height[j * f->columns + i];
      volume += z;
      mx += z * cell_x(f, i);
      my += z * cell_y(f, j);
      peak = fmax(peak, z);
    }
  h->result->envelope_volume = volume * f->cell * f->cell;
  h->result->peak = peak;
  h->result->axis[0] = volume > 0 ? mx / volume : 0;
  h->result->axis[1] = volume > 0 ? my / volume : 0;
}

/* Mean heights over radial bins, per sector and per ring. */
static void fill_bins(heap *h) {
  const scree_height_field *f = h->field;
  size_t sectors = h->options->sector_count;
  double run_out = 0;
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double dx = cell_x(f, i) - h->result->axis[0], dy = cell_y(f, j) - h->result->axis[1];
      double r = hypot(dx, dy), z = f->height[j * f->columns + i];
      if (z > 0) run_out = fmax(run_out, r);
      size_t bin = (size_t)(r / h->bin_width);
      double turn = atan2(dy, dx) / (2 * pi) + 0.5;
      size_t sector = (size_t)(turn * (double)sectors);
      if (sector >= sectors) sector = sectors - 1;
      if (bin >= h->bin_count) continue;
      h->sum[sector * h->bin_count + bin] += z;
      h->cells[sector * h->bin_count + bin] += 1;
      h->sum[sectors * h->bin_count + bin] += z;
      h->cells[sectors * h->bin_count + bin] += 1;
    }
  h->result->run_out = run_out;
}

static double bin_radius(const heap *h, size_t bin) {
  return ((double)bin + 0.5) * h->bin_width;
}

static bool in_band(const heap *h, double z) {
  return z >= h->options->band_low * h->result->height &&
         z <= h->options->band_high * h->result->height;
}

/* The line through the bins of one row that lie in the band, from the axis outwards to the first
 * bin below it: strays beyond the toe stay out. */
static bool flank_line(const heap *h, size_t row, double *intercept, double *slope) {
  line_fit fit = {0};
  for (size_t bin = 0; bin < h->bin_count; bin++) {
    double cells = h->cells[row * h->bin_count + bin];
    if (cells == 0) continue;
    double z = h->sum[row * h->bin_count + bin] / cells;
    if (z < h->options->band_low * h->result->height && fit.n > 0) break;
    if (in_band(h, z)) line_add(&fit, bin_radius(h, bin), z);
  }
  return line_solve(&fit, intercept, slope) && *slope < 0;
}

static void measure_rings(heap *h) {
  size_t ring = h->options->sector_count;
  double height = 0, intercept, slope;
  for (size_t bin = 0; bin < h->bin_count; bin++) {
    double cells = h->cells[ring * h->bin_count + bin];
    if (cells > 0) height = fmax(height, h->sum[ring * h->bin_count + bin] / cells);
  }
  h->result->height = height;
  h->result->base_radius = flank_line(h, ring, &intercept, &slope) ? -intercept / slope : NAN;
}

/* ---- way 1: sectors ---- */

static void measure_sectors(heap *h) {
  spread angles = {0};
  for (size_t sector = 0; sector < h->options->sector_count; sector++) {
    double intercept, slope;
    if (flank_line(h, sector, &intercept, &slope)) spread_add(&angles, degree * atan(-slope));
  }
  h->result->sector_deg = spread_mean(&angles);
  h->result->sector_sd_deg = spread_sd(&angles);
  h->result->sector_count = angles.count;
}

/* ---- way 2: a cone ---- */

/* Solves the symmetric 4x4 system a x = b in place by Cholesky; false where it is singular. */
static bool solve4(double a[4][4], double b[4]) {
  for (int i = 0; i < 4; i++)
    for (int j = 0; j <= i; j++) {
      double s = a[i][j];
      for (int k = 0; k < j; k++) s -= a[i][k] * a[j][k];
      if (i == j && !(s > 0)) return false;
      a[i][j] = i == j ? sqrt(s) : s / a[j][j];
    }
  for (int i = 0; i < 4; i++) {
    for (int k = 0; k < i; k++) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (int i = 3; i >= 0; i--) {
    for (int k = i + 1; k < 4; k++) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return true;
}

typedef struct cone {
  double x, y, apex, slope; /* h = apex - slope |r - (x, y)| */
} cone;

/* One Gauss-Newton step over the cells of the flank; returns the RMS misfit before it, NaN if it
 * fails. */
static double improve_cone(const heap *h, double farthest, cone *c) {
  const scree_height_field *f = h->field;
  double normal[4][4] = {{0}}, gradient[4] = {0}, misfit2 = 0, cells = 0;
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double z = f->height[j * f->columns + i];
      double x = cell_x(f, i), y = cell_y(f, j);
      if (!in_band(h, z) || hypot(x - h->result->axis[0], y - h->result->axis[1]) > farthest)
        continue;
      double dx = x - c->x, dy = y - c->y, r = hypot(dx, dy), inverse = r > 0 ? 1 / r : 0;
      double row[4] = {c->slope * dx * inverse, c->slope * dy * inverse, 1, -r};
      double misfit = z - (c->apex - c->slope * r);
      for (int p = 0; p < 4; p++) {
        for (int q = 0; q <= p; q++) normal[p][q] += row[p] * row[q];
        gradient[p] += row[p] * misfit;
      }
      misfit2 += misfit * misfit;
      cells += 1;
    }
  if (cells < 8 || !solve4(normal, gradient)) return NAN;
  *c =
      (cone){c->x + gradient[0], c->y + gradient[1], c->apex + gradient[2], c->slope + gradient[3]};
  return sqrt(misfit2 / cells);
}

/* Cells farther out than where the mean flank leaves the band are strays on the floor plate. */
static void measure_cone(heap *h) {
  scree_repose *result = h->result;
  double intercept, slope, rms = NAN;
  result->cone_deg = result->cone_rms = NAN;
  if (!flank_line(h, h->options->sector_count, &intercept, &slope)) return;
  double farthest = 1.15 * -intercept / slope;
  cone c = {result->axis[0], result->axis[1], intercept, -slope};
  for (int round = 0; round < CONE_ROUNDS; round++) {
    cone before = c;
    rms = improve_cone(h, farthest, &c);
    if (isnan(rms) || !(c.slope > 0)) return;
    if (fabs(c.slope - before.slope) < 1e-9 * c.slope && fabs(c.apex - before.apex) < 1e-9 * c.apex)
      break;
  }
  result->cone_deg = degree * atan(c.slope);
  result->cone_rms = rms;
  result->cone_apex[0] = c.x;
  result->cone_apex[1] = c.y;
  result->cone_apex[2] = c.apex;
}

/* ---- way 3: silhouettes ---- */

/* Greatest heights along lines of sight, against the distance across; bin_count bins on either
 * side. */
static void outline(const heap *h, double angle, double *profile) {
  const scree_height_field *f = h->field;
  double cx = cos(angle), cy = sin(angle);
  memset(profile, 0, 2 * h->bin_count * sizeof *profile);
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double z = f->height[j * f->columns + i];
      if (z <= 0) continue;
      double across =
          (cell_x(f, i) - h->result->axis[0]) * cx + (cell_y(f, j) - h->result->axis[1]) * cy;
      double bin = across / h->bin_width + (double)h->bin_count;
      if (bin < 0 || bin >= (double)(2 * h->bin_count)) continue;
      double *value = &profile[(size_t)bin];
      if (z > *value) *value = z;
    }
}

/* One flank of an outline, from its top outwards: side +1 or -1. */
static bool outline_flank(const heap *h, const double *profile, size_t top, int side,
                          double *angle_deg) {
  line_fit fit = {0};
  double peak = profile[top], intercept, slope;
  for (size_t step = 0;; step++) {
    if (side < 0 ? step > top : top + step >= 2 * h->bin_count) break;
    double z = profile[side < 0 ? top - step : top + step];
    if (z < h->options->band_low * peak) break;
    if (z <= h->options->band_high * peak) line_add(&fit, (double)step * h->bin_width, z);
  }
  if (!line_solve(&fit, &intercept, &slope) || !(slope < 0)) return false;
  *angle_deg = degree * atan(-slope);
  return true;
}

static void measure_silhouettes(heap *h, double *profile) {
  spread angles = {0};
  for (size_t k = 0; k < h->options->silhouette_count; k++) {
    outline(h, pi * (double)k / (double)h->options->silhouette_count, profile);
    size_t top = 0;
    for (size_t i = 0; i < 2 * h->bin_count; i++)
      if (profile[i] > profile[top]) top = i;
    double angle_deg;
    for (int side = -1; side <= 1; side += 2)
      if (outline_flank(h, profile, top, side, &angle_deg)) spread_add(&angles, angle_deg);
  }
  h->result->silhouette_deg = spread_mean(&angles);
  h->result->silhouette_sd_deg = spread_sd(&angles);
  h->result->flank_count = angles.count;
}

/* ---- the verdict ---- */

/* Says why there is no heap, and takes the angles back: a number there would be taken for one. */
static void judge(heap *h) {
  scree_repose *r = h->result;
  double size = h->options->particle_size;
  r->heap = false;
  if (r->peak == 0)
    snprintf(r->reason, sizeof r->reason, "nothing lies on the floor");
  else if (size > 0 && r->height < sizes_of_a_heap * size)
    snprintf(r->reason, sizeof r->reason, "%.1f mm high, less than %g particle sizes of %.1f mm",
             1e3 * r->height, sizes_of_a_heap, 1e3 * size);
  else if ((double)r->sector_count < least_share * (double)h->options->sector_count)
    snprintf(r->reason, sizeof r->reason, "only %zu of %zu sectors have a flank", r->sector_count,
             h->options->sector_count);
  else if (isnan(r->cone_deg))
    snprintf(r->reason, sizeof r->reason, "no cone fits the flank");
  else
    r->heap = true;
  if (r->heap) return;
  r->sector_deg = r->sector_sd_deg = r->cone_deg = r->cone_rms = NAN;
  r->silhouette_deg = r->silhouette_sd_deg = NAN;
}

static scree_status check_options(const scree_repose_options *o, scree_error *error) {
  if (o->sector_count < 1 || o->sector_count > 3600 || o->silhouette_count > 3600)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu sectors, %zu silhouettes: must be 1 to 3600",
                      o->sector_count, o->silhouette_count);
  if (!(o->band_low >= 0 && o->band_low < o->band_high && o->band_high <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "flank band %g to %g: must rise within 0 to 1",
                      o->band_low, o->band_high);
  return SCREE_OK;
}

scree_status scree_repose_measure(const scree_height_field *field,
                                  const scree_repose_options *options, scree_repose *repose,
                                  scree_error *error) {
  scree_status status = check_options(options, error);
  if (status != SCREE_OK) return status;
  scree_repose result = {0};
  heap h = {.field = field, .options = options, .result = &result};
  h.bin_width = bin_cells * field->cell;
  h.bin_count = (size_t)(hypot((double)field->columns, (double)field->rows) / bin_cells) + 1;
  size_t row_count = options->sector_count + 1;
  double *memory = scree_alloc_zero(2 * h.bin_count * (row_count + 1), sizeof *memory);
  if (!memory)
    return scree_fail_memory(error, 2 * h.bin_count * (row_count + 1) * sizeof *memory,
                             "the profiles of a heap");
  h.sum = memory;
  h.cells = memory + h.bin_count * row_count;
  measure_extent(&h);
  fill_bins(&h);
  measure_rings(&h);
  measure_sectors(&h);
  measure_cone(&h);
  measure_silhouettes(&h, memory + 2 * h.bin_count * row_count);
  judge(&h);
  scree_free(memory);
  *repose = result;
  return SCREE_OK;
}
