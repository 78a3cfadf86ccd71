/* The angle of repose of a height field, three ways that fail differently: sector lines follow the
 * flank that the eye sees, the cone uses every cell of the flank at once, and silhouettes are what
 * a camera beside the experiment would measure. A flank is where the height lies within a band of
 * the heap's own height (20 to 80 %): the toe of stray particles and the rounded top stay out.
 *
 * Which cells belong to the flank is asked of the fitted line or cone itself, never of a cell's own
 * height nor of one sector's: on a heap a few particles high these stray from the mean surface by
 * as much as the band is wide, and who leaves out what is too high or too low for the band fits a
 * flank that is too flat. Everything between the flank's ends counts, gaps between particles down
 * to the floor included. */
#include "heap/repose.h"

#include "base/alloc.h"
#include "base/vec.h"

#include <math.h>
#include <string.h>

static const double degree = 57.295779513082320877;
static const double pi = 3.14159265358979323846;
static const double bin_cells = 2;      /* width of a radial bin, in cells, at least */
static const double bin_sizes = 0.25;   /* and in particle sizes */
static const double sector_sizes = 2;   /* width of a sector in the middle of the flank, at least */
static const double fewest_bins = 3;    /* a line needs as many */
static const double fewest_sectors = 8; /* of that width round the heap: else it is too small */
static const double least_share = 0.5;  /* of sectors and flanks that must give a line */
static const double largest_length = 1e30; /* m */
static const double sizes_of_a_heap = 1.5; /* lower, in particle sizes, is a layer and not a heap */
enum { CONE_ROUNDS = 50, CHOICES = 6 };

scree_repose_options scree_default_repose_options(void) {
  return (scree_repose_options){
      .sector_count = 36, .silhouette_count = 18, .band_low = 0.2, .band_high = 0.8};
}

scree_repose scree_no_repose(void) {
  scree_repose r = {0};
  r.sector_deg = r.sector_sd_deg = r.cone_deg = r.cone_rms = NAN;
  r.silhouette_deg = r.silhouette_sd_deg = r.spread_deg = r.volume_deg = r.volume_se_deg = NAN;
  r.height = r.peak = r.base_radius = r.run_out = NAN;
  return r;
}

/* ---- straight lines ---- */

/* Running sums of a weighted least-squares line y = a + b x. */
typedef struct line_fit {
  double n, weight, x, y, xx, xy;
} line_fit;

static void line_add(line_fit *f, double x, double y, double weight) {
  f->n += 1;
  f->weight += weight;
  f->x += weight * x;
  f->y += weight * y;
  f->xx += weight * x * x;
  f->xy += weight * x * y;
}

/* False where fewer than three points or all at one x. */
static bool line_solve(const line_fit *f, double *intercept, double *slope) {
  double determinant = f->weight * f->xx - f->x * f->x;
  if (f->n < fewest_bins || !(determinant > 1e-12 * f->weight * f->xx)) return false;
  *slope = (f->weight * f->xy - f->x * f->y) / determinant;
  *intercept = (f->y - *slope * f->x) / f->weight;
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

/* ---- profiles ---- */

/* Sums over the cells of a bin; their mean height is z / weight, at the distance r / weight. */
typedef struct bin {
  double weight, r, z;
} bin;

/* Mean heights against the distance from the axis in several directions; the last row, and the only
 * one that is smooth, is the mean of all. */
typedef struct profiles {
  bin *bins; /* (count + 1) rows of bin_count */
  size_t count;
} profiles;

typedef struct heap {
  const scree_height_field *field;
  const scree_repose_options *options;
  scree_repose *result;
  size_t bin_count;
  double bin_width;
  profiles sectors, outlines; /* outlines: a row for each flank */
} heap;

static bin *profile_of(const heap *h, const profiles *p, size_t row) {
  return p->bins + row * h->bin_count;
}
static double bin_mean(const bin *b) {
  return b->weight > 0 ? b->z / b->weight : 0;
}

/* Mean height within a particle size of the axis, or in the innermost bin. */
static double top_height(const heap *h, const bin *profile) {
  double bins = floor(h->options->particle_size / h->bin_width), weight = 0, z = 0;
  for (size_t i = 0; i < h->bin_count && (i == 0 || (double)i < bins); i++) {
    weight += profile[i].weight;
    z += profile[i].z;
  }
  return weight > 0 ? z / weight : 0;
}

typedef struct flank {
  double from, to;         /* m: distances from the axis */
  double intercept, slope; /* h = intercept + slope r */
} flank;

/* The line through all bins between the flank's ends. */
static bool fit_line(const heap *h, const bin *profile, flank *f) {
  line_fit fit = {0};
  for (size_t i = 0; i < h->bin_count; i++) {
    if (profile[i].weight == 0) continue;
    double r = profile[i].r / profile[i].weight;
    if (r >= f->from && r <= f->to) line_add(&fit, r, bin_mean(&profile[i]), profile[i].weight);
  }
  return line_solve(&fit, &f->intercept, &f->slope);
}

/* The flank of a smooth profile: at first from where it falls below the band's upper end to where
 * it falls below the lower one; then where the line itself lies in the band. */
static bool find_flank(const heap *h, const bin *profile, double height, flank *f) {
  double low = h->options->band_low * height, high = h->options->band_high * height;
  size_t begin = 0, end;
  while (begin < h->bin_count && bin_mean(&profile[begin]) > high) begin++;
  for (end = begin; end < h->bin_count && bin_mean(&profile[end]) >= low;) end++;
  *f = (flank){(double)begin * h->bin_width, (double)end * h->bin_width, 0, 0};
  for (int choice = 0; choice < CHOICES; choice++) {
    if (!fit_line(h, profile, f) || !(f->slope < 0)) return false;
    f->from = (high - f->intercept) / f->slope;
    f->to = (low - f->intercept) / f->slope;
  }
  return fit_line(h, profile, f) && f->slope < 0;
}

/* Each direction's line between the ends that the mean of all has. One that rises counts with its
 * negative angle: without it the mean would be too steep. */
static size_t measure_lines(const heap *h, const profiles *p, flank ends, double *mean_deg,
                            double *sd_deg) {
  spread angles = {0};
  for (size_t row = 0; row < p->count; row++)
    if (fit_line(h, profile_of(h, p, row), &ends)) spread_add(&angles, -degree * atan(ends.slope));
  *mean_deg = spread_mean(&angles);
  *sd_deg = spread_sd(&angles);
  return angles.count;
}

/* ---- what all ways share ---- */

static double cell_x(const scree_height_field *f, size_t i) {
  return f->x + ((double)i + 0.5) * f->cell;
}
static double cell_y(const scree_height_field *f, size_t j) {
  return f->y + ((double)j + 0.5) * f->cell;
}

/* The axis is weighted by the square of the height: strays far out would pull it otherwise. */
static void measure_extent(heap *h) {
  const scree_height_field *f = h->field;
  double volume = 0, weight = 0, mx = 0, my = 0, peak = 0;
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double z = f->height[j * f->columns + i];
      volume += z;
      weight += z * z;
      mx += z * z * cell_x(f, i);
      my += z * z * cell_y(f, j);
      peak = fmax(peak, z);
    }
  h->result->envelope_volume = volume * f->cell * f->cell;
  h->result->peak = peak;
  h->result->axis[0] = weight > 0 ? mx / weight : 0;
  h->result->axis[1] = weight > 0 ? my / weight : 0;
}

static void add_cell(bin *b, double r, double z) {
  b->weight += 1;
  b->r += r;
  b->z += z;
}

/* Sums over radial bins, in sectors and all round. */
static void fill_sectors(heap *h, size_t count) {
  const scree_height_field *f = h->field;
  h->sectors.count = count;
  memset(h->sectors.bins, 0, (count + 1) * h->bin_count * sizeof *h->sectors.bins);
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double dx = cell_x(f, i) - h->result->axis[0], dy = cell_y(f, j) - h->result->axis[1];
      double r = hypot(dx, dy), z = f->height[j * f->columns + i];
      if (z > 0) h->result->run_out = fmax(h->result->run_out, r);
      size_t index = (size_t)fmin(r / h->bin_width, (double)h->bin_count);
      size_t sector = (size_t)((atan2(dy, dx) / (2 * pi) + 0.5) * (double)count);
      if (index >= h->bin_count) continue;
      if (sector >= count) sector = count - 1;
      add_cell(&profile_of(h, &h->sectors, sector)[index], r, z);
      add_cell(&profile_of(h, &h->sectors, count)[index], r, z);
    }
}

/* A cone of this volume, with its centroid as high: tan = sqrt(pi H^3 / 3 V), H = 4 z. From the
 * rings' means, since roughness would raise the centroid of the cells; without those of a sector
 * where one is given, as if the others stood there too. */
static double volume_angle(const heap *h, const bin *rings, const bin *without) {
  double volume = 0, moment = 0, area = h->field->cell * h->field->cell;
  for (size_t i = 0; i < h->bin_count; i++) {
    bin left = rings[i];
    if (without && left.weight > without[i].weight) {
      left.weight -= without[i].weight;
      left.z -= without[i].z;
    }
    double z = bin_mean(&left);
    volume += z * rings[i].weight * area;
    moment += 0.5 * z * z * rings[i].weight * area;
  }
  double height = volume > 0 ? 4 * moment / volume : 0;
  return height > 0 ? degree * atan(sqrt(pi * height * height * height / (3 * volume))) : NAN;
}

/* Its standard error by the jackknife over sectors (Efron 1982). */
static double volume_error(const heap *h) {
  const bin *rings = profile_of(h, &h->sectors, h->sectors.count);
  spread angles = {0};
  for (size_t row = 0; row < h->sectors.count; row++)
    spread_add(&angles, volume_angle(h, rings, profile_of(h, &h->sectors, row)));
  double n = (double)angles.count;
  return (n - 1) / sqrt(n) * spread_sd(&angles);
}

/* ---- way 1: sectors ---- */

/* As many sectors as asked for, or as the flank has room for where they are two particles wide. */
static size_t count_sectors(const heap *h, const flank *f) {
  double size = h->options->particle_size;
  if (!(size > 0)) return h->options->sector_count;
  double room = floor(pi * (f->from + f->to) / (sector_sizes * size));
  room = fmin(room, (double)h->options->sector_count);
  return room > 1 ? (size_t)room : 1;
}

static void measure_sectors(heap *h, flank *f) {
  scree_repose *r = h->result;
  fill_sectors(h, h->options->sector_count);
  const bin *rings = profile_of(h, &h->sectors, h->sectors.count);
  r->height = top_height(h, rings);
  r->volume_deg = volume_angle(h, rings, NULL);
  r->sector_deg = r->sector_sd_deg = r->base_radius = r->volume_se_deg = NAN;
  if (!find_flank(h, rings, r->height, f)) return;
  r->base_radius = -f->intercept / f->slope;
  r->sector_total = count_sectors(h, f);
  fill_sectors(h, r->sector_total);
  r->sector_count = measure_lines(h, &h->sectors, *f, &r->sector_deg, &r->sector_sd_deg);
  r->volume_se_deg = volume_error(h);
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

/* One Gauss-Newton step over the cells where `chooser` lies in the band; returns the RMS misfit
 * before it, NaN if it fails. */
static double improve_cone(const heap *h, const cone *chooser, cone *c) {
  const scree_height_field *f = h->field;
  double low = h->options->band_low * h->result->height,
         high = h->options->band_high * h->result->height;
  double normal[4][4] = {{0}}, gradient[4] = {0}, misfit2 = 0, cells = 0;
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double x = cell_x(f, i), y = cell_y(f, j);
      double level = chooser->apex - chooser->slope * hypot(x - chooser->x, y - chooser->y);
      if (level < low || level > high) continue;
      double dx = x - c->x, dy = y - c->y, r = hypot(dx, dy), inverse = r > 0 ? 1 / r : 0;
      double row[4] = {c->slope * dx * inverse, c->slope * dy * inverse, 1, -r};
      double misfit = f->height[j * f->columns + i] - (c->apex - c->slope * r);
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

static bool close_to(const cone *a, const cone *b) {
  return fabs(a->slope - b->slope) < 1e-9 * fabs(a->slope) &&
         fabs(a->apex - b->apex) < 1e-9 * fabs(a->apex);
}

/* Fitted to the cells that the cone before puts on the flank, a few times over. */
static void measure_cone(heap *h, const flank *rings) {
  scree_repose *result = h->result;
  double rms = NAN;
  result->cone_deg = result->cone_rms = NAN;
  if (isnan(result->base_radius)) return;
  cone c = {result->axis[0], result->axis[1], rings->intercept, -rings->slope};
  for (int choice = 0; choice < CHOICES; choice++) {
    cone chooser = c;
    for (int round = 0; round < CONE_ROUNDS; round++) {
      cone before = c;
      rms = improve_cone(h, &chooser, &c);
      if (isnan(rms) || !(c.slope > 0)) return;
      if (close_to(&c, &before)) break;
    }
    if (close_to(&c, &chooser)) break;
  }
  result->cone_deg = degree * atan(c.slope);
  result->cone_rms = rms;
  result->cone_apex[0] = c.x;
  result->cone_apex[1] = c.y;
  result->cone_apex[2] = c.apex;
}

/* ---- way 3: silhouettes ---- */

/* Greatest heights along lines of sight, against the distance across, to either side. */
static void fill_outline(heap *h, size_t direction) {
  const scree_height_field *f = h->field;
  double angle = pi * (double)direction / (double)h->options->silhouette_count;
  double cx = cos(angle), cy = sin(angle);
  bin *sides[] = {profile_of(h, &h->outlines, 2 * direction),
                  profile_of(h, &h->outlines, 2 * direction + 1)};
  for (size_t j = 0; j < f->rows; j++)
    for (size_t i = 0; i < f->columns; i++) {
      double z = f->height[j * f->columns + i];
      if (z <= 0) continue;
      double across =
          (cell_x(f, i) - h->result->axis[0]) * cx + (cell_y(f, j) - h->result->axis[1]) * cy;
      size_t index = (size_t)fmin(fabs(across) / h->bin_width, (double)h->bin_count);
      if (index >= h->bin_count) continue;
      bin *b = &sides[across < 0][index];
      b->z = fmax(b->z, z);
    }
}

static void measure_silhouettes(heap *h) {
  scree_repose *r = h->result;
  bin *mean = profile_of(h, &h->outlines, h->outlines.count);
  flank f;
  for (size_t k = 0; k < h->options->silhouette_count; k++) fill_outline(h, k);
  for (size_t row = 0; row < h->outlines.count; row++)
    for (size_t i = 0; i < h->bin_count; i++) {
      bin *b = &profile_of(h, &h->outlines, row)[i];
      b->weight = 1;
      b->r = ((double)i + 0.5) * h->bin_width;
      add_cell(&mean[i], b->r, b->z);
    }
  r->silhouette_deg = r->silhouette_sd_deg = NAN;
  if (find_flank(h, mean, top_height(h, mean), &f))
    r->flank_count = measure_lines(h, &h->outlines, f, &r->silhouette_deg, &r->silhouette_sd_deg);
}

/* ---- the verdict ---- */

/* Why there is no heap to speak of, or none large enough for a number; empty where there is. */
static void judge(const heap *h, char *reason, size_t size_of_reason) {
  const scree_repose *r = h->result;
  double size = h->options->particle_size;
  size_t flanks = 2 * h->options->silhouette_count;
  reason[0] = 0;
  if (r->peak == 0)
    snprintf(reason, size_of_reason, "nothing lies on the floor");
  else if (size > 0 && r->height < sizes_of_a_heap * size)
    snprintf(reason, size_of_reason, "%.1f mm high, less than %g particle sizes of %.1f mm",
             1e3 * r->height, sizes_of_a_heap, 1e3 * size);
  else if (isnan(r->cone_deg))
    snprintf(reason, size_of_reason, "no cone fits the flank");
  else if ((double)r->sector_total < fmin(fewest_sectors, (double)h->options->sector_count))
    snprintf(reason, size_of_reason,
             "too small: in the middle of its flank less than %g particle sizes round",
             sector_sizes * fewest_sectors);
  else if ((double)r->sector_count < least_share * (double)r->sector_total)
    snprintf(reason, size_of_reason, "only %zu of %zu sectors have a flank", r->sector_count,
             r->sector_total);
  else if ((double)r->flank_count < least_share * (double)flanks)
    snprintf(reason, size_of_reason, "only %zu of %zu outlines from the side have a flank",
             r->flank_count, flanks);
}

/* Where there is no heap the angles are taken back: a number there would be taken for one. */
static void conclude(heap *h) {
  scree_repose *r = h->result;
  judge(h, r->reason, sizeof r->reason);
  r->heap = r->reason[0] == 0;
  if (!r->heap) {
    r->sector_deg = r->sector_sd_deg = r->cone_deg = r->cone_rms = NAN;
    r->volume_deg = r->volume_se_deg = NAN;
    r->silhouette_deg = r->silhouette_sd_deg = NAN;
  }
  r->spread_deg = fmax(r->sector_deg, fmax(r->cone_deg, r->silhouette_deg)) -
                  fmin(r->sector_deg, fmin(r->cone_deg, r->silhouette_deg));
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

/* Cubes of what is accepted are still finite. */
static scree_status check_field(const scree_height_field *f, scree_error *error) {
  const double corner[3] = {f->x, f->y, f->cell};
  for (size_t i = 0, count = f->columns * f->rows; i < count + 3; i++) {
    double length = i < count ? f->height[i] : corner[i - count];
    if (!(fabs(length) <= largest_length))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "a height field with a height or corner of %g m; at most %g", length,
                        largest_length);
  }
  return SCREE_OK;
}

scree_status scree_repose_measure(const scree_height_field *field,
                                  const scree_repose_options *options, scree_repose *repose,
                                  scree_error *error) {
  const scree_repose_options defaults = scree_default_repose_options();
  if (!options) options = &defaults;
  scree_status status = check_options(options, error);
  if (status == SCREE_OK) status = check_field(field, error);
  if (status != SCREE_OK) return status;
  scree_repose result = {0};
  flank rings = {0};
  heap h = {.field = field,
            .options = options,
            .result = &result,
            .outlines = {.count = 2 * options->silhouette_count}};
  h.bin_width = fmax(bin_cells * field->cell, bin_sizes * options->particle_size);
  h.bin_count =
      (size_t)(hypot((double)field->columns, (double)field->rows) * field->cell / h.bin_width) + 1;
  size_t rows = options->sector_count + 1 + h.outlines.count + 1;
  h.sectors.bins = scree_alloc_zero(rows * h.bin_count, sizeof(bin));
  if (!h.sectors.bins)
    return scree_fail_memory(error, rows * h.bin_count * sizeof(bin), "the profiles of a heap");
  h.outlines.bins = h.sectors.bins + (options->sector_count + 1) * h.bin_count;
  measure_extent(&h);
  measure_sectors(&h, &rings);
  measure_cone(&h, &rings);
  measure_silhouettes(&h);
  conclude(&h);
  scree_free(h.sectors.bins);
  *repose = result;
  return SCREE_OK;
}
