/* Outlines of heaps: of a file, of a picture's silhouette, of a height field. An outline is
 * measured as the solid that it makes when turned about the heap's axis, each side for itself, so
 * that all ways of a height field are those of an outline too. */
#include "base/alloc.h"
#include "base/curve_file.h"
#include "base/radix.h"
#include "heap/repose.h"
#include "scree.h"

#include <math.h>

enum { CELLS_ACROSS = 400, SIDES = 4, GREYS = 256 };
static const double least_parted = 0.8; /* of the variance of greys, between dark and bright */
static const double edge_share = 0.05;  /* of a picture's columns, at either side: the ground */
static const double floor_share = 0.1;  /* of the height: how uneven the floor may be */
static const double most_slope = 0.5;   /* of that ground: what is steeper is a flank */

void scree_outline_free(scree_outline *outline) {
  if (!outline) return;
  scree_free(outline->x);
  scree_free(outline->z);
  *outline = (scree_outline){0};
}

static scree_status make_outline(size_t count, scree_outline *outline, scree_error *error) {
  *outline = (scree_outline){count, scree_alloc(count, sizeof(double)),
                             scree_alloc(count, sizeof(double)), 0};
  if (outline->x && outline->z) return SCREE_OK;
  scree_outline_free(outline);
  return scree_fail_memory(error, 2 * count * sizeof(double), "an outline");
}

scree_status scree_outline_read(const char *path, double unit_m, scree_outline *outline,
                                scree_error *error) {
  scree_curve_file c;
  SCREE_TRY(scree_curve_file_read(path, &c, error));
  scree_status status = scree_curve_file_convert(&c, 0, "m", unit_m, path, error);
  if (status == SCREE_OK) status = scree_curve_file_convert(&c, 1, "m", unit_m, path, error);
  if (status == SCREE_OK)
    *outline = (scree_outline){c.count, c.x, c.y, 0};
  else
    scree_curve_file_free(&c);
  return status;
}

scree_status scree_outline_of_field(const scree_height_field *field, double axis,
                                    scree_outline *outline, scree_error *error) {
  SCREE_TRY(make_outline(field->columns, outline, error));
  for (size_t i = 0; i < field->columns; i++) {
    outline->x[i] = field->x + ((double)i + 0.5) * field->cell - axis;
    outline->z[i] = 0;
    for (size_t j = 0; j < field->rows; j++)
      outline->z[i] = fmax(outline->z[i], field->height[j * field->columns + i]);
  }
  return SCREE_OK;
}

/* ---- measuring ---- */

/* The mean place, weighted by the square of the height. */
static double axis_of(const scree_outline *o) {
  double weight = 0, sum = 0;
  for (size_t i = 0; i + 1 < o->count; i++) {
    double z = fmax(0, 0.5 * (o->z[i] + o->z[i + 1])), w = z * z * (o->x[i + 1] - o->x[i]);
    weight += w;
    sum += w * 0.5 * (o->x[i] + o->x[i + 1]);
  }
  return weight > 0 ? sum / weight : 0.5 * (o->x[0] + o->x[o->count - 1]);
}

/* Straight between points; 0 beyond the ends. */
static double height_at(const scree_outline *o, double x) {
  if (x < o->x[0] || x > o->x[o->count - 1]) return 0;
  SCREE_FIND_FIRST(high, 1, o->count - 1, o->x[high] <= x)
  size_t low = high - 1;
  double part = (x - o->x[low]) / (o->x[high] - o->x[low]);
  return fmax(0, o->z[low] + part * (o->z[high] - o->z[low]));
}

/* A flank is measured from a share of the height on: both ends of the outline lie below it. */
static scree_status check_ends(const scree_outline *o, double share, scree_error *error) {
  double peak = 0;
  for (size_t i = 0; i < o->count; i++) peak = fmax(peak, o->z[i]);
  for (size_t i = 0; i < o->count; i += o->count - 1)
    if (o->z[i] > share * peak)
      return scree_fail(error, SCREE_BAD_FILE,
                        "the outline ends %.4g m high at x = %.4g m, and flanks are measured from "
                        "%.4g m on: it has to reach the floor, z = 0, on both sides",
                        o->z[i], o->x[i], share * peak);
  return SCREE_OK;
}

scree_status scree_outline_measure(const scree_outline *outline, double cell,
                                   const scree_repose_options *options, scree_repose *repose,
                                   scree_error *error) {
  scree_repose_options used = options ? *options : scree_default_repose_options();
  SCREE_CLEANUP(scree_height_field_free) scree_height_field field = {0};
  double axis = axis_of(outline),
         half = fmax(axis - outline->x[0], outline->x[outline->count - 1] - axis);
  if (cell == 0) cell = 2 * half / CELLS_ACROSS;
  SCREE_TRY(check_ends(outline, fmax(used.band_low, floor_share), error));
  SCREE_TRY(scree_height_field_create(axis, 0, half + cell, cell, &field, error));
  for (size_t j = 0; j < field.rows; j++)
    for (size_t i = 0; i < field.columns; i++) {
      double dx = field.x + ((double)i + 0.5) * cell - axis,
             dy = field.y + ((double)j + 0.5) * cell;
      field.height[j * field.columns + i] = height_at(outline, axis + copysign(hypot(dx, dy), dx));
    }
  used.sector_count = SIDES;
  used.silhouette_count = 1;
  return scree_repose_measure(&field, &used, repose, error);
}

/* ---- pictures ---- */

typedef struct picture {
  size_t width, height;
  char *heap;     /* of every pixel, rows from the top: SCREE_IN or SCREE_OUT */
  double *top;    /* of every column: rows above the heap, NaN where it is not */
  double *bottom; /* rows above what is below it; then the height over the ground */
  double ruler;   /* pixels; 0: none was seen */
} picture;

/* The threshold that parts greys best (Otsu 1979), and how much of their variance lies between the
 * two classes. */
static double part_greys(const size_t *histogram, double *parted) {
  double n = 0, sum = 0, squares = 0, below = 0, below_sum = 0, best = -1, threshold = 0;
  for (int g = 0; g < GREYS; g++) {
    double count = (double)histogram[g];
    n += count;
    sum += count * g;
    squares += count * g * g;
  }
  for (int g = 0; g + 1 < GREYS; g++) {
    below += (double)histogram[g];
    below_sum += (double)histogram[g] * g;
    if (below == 0 || below == n) continue;
    double apart = below_sum / below - (sum - below_sum) / (n - below);
    double between = below * (n - below) * apart * apart / (n * n);
    if (between > best) {
      best = between;
      threshold = g;
    }
  }
  double variance = squares / n - sum * sum / (n * n);
  *parted = variance > 0 ? best / variance : 0;
  return threshold;
}

/* What is unlike most of the uppermost row. */
static scree_status find_silhouette(const uint8_t *rgb, picture *p, scree_error *error) {
  size_t histogram[GREYS] = {0}, n = p->width * p->height, bright = 0;
  double parted;
  for (int pass = 0; pass < 2; pass++) {
    double threshold = pass ? part_greys(histogram, &parted) : 0;
    for (size_t i = 0; i < n; i++) {
      const uint8_t *c = rgb + 3 * i;
      int grey = (299 * c[0] + 587 * c[1] + 114 * c[2]) / 1000;
      if (pass)
        p->heap[i] = grey <= threshold ? SCREE_IN : SCREE_OUT;
      else
        histogram[grey]++;
    }
  }
  if (parted < least_parted)
    return scree_fail(
        error, SCREE_BAD_FILE,
        "no silhouette: dark and bright explain %.0f %% of the greys' variance, at least %g %% are "
        "needed; light the heap from behind, or paint it black on white",
        100 * parted, 100 * least_parted);
  for (size_t i = 0; i < p->width; i++) bright += p->heap[i] == SCREE_OUT;
  for (size_t i = 0; 2 * bright < p->width && i < n; i++)
    p->heap[i] = p->heap[i] == SCREE_IN ? SCREE_OUT : SCREE_IN;
  return SCREE_OK;
}

/* What lies beside a heap is told by these: what is no grain, in shares of the heap; what is
 * straight, of a box.
 */
static const double thing_area = 0.03, thing_height = 0.3, bar_fill = 0.85;
static const double grain_width = 4; /* of its height, at most */
/* Heights that are ground, in shares of the peak; how long a bar at the foot is, of the width. */
static const double flat_share = 0.03, bar_share = 0.03, bar_rows = 3;

/* How long a piece is that fills its box, as a bar does; 0: it does not. */
static double bar_of(const picture *p, const size_t *pixels, size_t count) {
  size_t low[2] = {SIZE_MAX, SIZE_MAX}, high[2] = {0};
  for (size_t k = 0; k < count; k++) {
    const size_t at[2] = {pixels[k] % p->width, pixels[k] / p->width};
    for (int a = 0; a < 2; a++) {
      low[a] = at[a] < low[a] ? at[a] : low[a];
      high[a] = at[a] > high[a] ? at[a] : high[a];
    }
  }
  double wide = (double)(high[0] - low[0] + 1), tall = (double)(high[1] - low[1] + 1),
         long_side = fmax(wide, tall);
  bool bar = fmin(wide, tall) >= bar_rows && long_side >= bar_share * (double)p->width &&
             (double)count >= bar_fill * wide * tall;
  return bar ? long_side : 0;
}

/* Only the largest piece stays: specks and dust go, and a ruler that lies apart. */
static scree_status find_columns(picture *p, scree_error *error) {
  const size_t width = p->width, n = width * p->height;
  size_t most = 0;
  double of_most = 0;
  SCREE_SCRATCH(size_t, pixels, n, error);
  for (size_t i = 0; i < n; i++) {
    if (p->heap[i] != SCREE_IN) continue;
    size_t count = scree_flood(p->heap, width, p->height, i, pixels);
    double bar = bar_of(p, pixels, count);
    p->ruler = fmax(p->ruler, count > most ? of_most : bar); /* what was the largest is not */
    if (count <= most) continue;
    of_most = bar;
    most = count;
    for (size_t c = 0; c < width; c++) p->top[c] = p->bottom[c] = NAN;
    for (size_t k = 0; width > 0 && k < count; k++) {
      size_t column = pixels[k] % width;
      double row = (double)(pixels[k] / width);
      p->top[column] = fmin(p->top[column], row);
      p->bottom[column] = fmax(p->bottom[column], row + 1);
    }
  }
  for (size_t c = 0; c < width; c++)
    if (p->top[c] == 0)
      return scree_fail(error, SCREE_BAD_FILE,
                        "the heap reaches the picture's upper edge in column %zu", c + 1);
  return SCREE_OK;
}

typedef struct ground {
  double at, slope; /* row = at + slope column */
} ground;

/* The ground: where the silhouette goes from edge to edge, its top beside the heap; else its lower
 * side. */
static scree_status find_ground(const picture *p, ground *g, scree_error *error) {
  size_t edge = (size_t)(edge_share * (double)p->width) + 1;
  bool left = !isnan(p->top[0]), right = !isnan(p->top[p->width - 1]);
  if (left != right)
    return scree_fail(error, SCREE_BAD_FILE, "the heap is cut off at the picture's %s edge",
                      left ? "left" : "right");
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (size_t c = 0; c < p->width; c++) {
    double row = left ? p->top[c] : p->bottom[c], column = (double)c + 0.5;
    if (isnan(row) || (left && c >= edge && c + edge < p->width)) continue;
    n += 1;
    x += column;
    y += row;
    xx += column * column;
    xy += column * row;
  }
  double determinant = n * xx - x * x;
  if (!(determinant > 0))
    return scree_fail(error, SCREE_BAD_FILE, "no heap: its silhouette is a single column");
  g->slope = (n * xy - x * y) / determinant;
  g->at = (y - g->slope * x) / n;
  if (fabs(g->slope) > most_slope)
    return scree_fail(error, SCREE_BAD_FILE,
                      "no ground: the line from edge to edge rises by %.2f; the picture must show "
                      "the ground at both sides of the heap",
                      fabs(g->slope));
  return SCREE_OK;
}

/* A run of columns that stand out of the ground. */
typedef struct run {
  size_t begin, end;
  double area, peak;
} run;

static run next_run(const picture *p, size_t from, double flat) {
  run r = {from, from, 0, 0};
  while (r.begin < p->width && !(p->bottom[r.begin] > flat)) r.begin++;
  for (r.end = r.begin; r.end < p->width && p->bottom[r.end] > flat; r.end++) {
    r.area += p->bottom[r.end];
    r.peak = fmax(r.peak, p->bottom[r.end]);
  }
  return r;
}

static void flatten(picture *p, const ground *g, size_t begin, size_t end) {
  for (size_t c = begin; c < end; c++) {
    p->top[c] = g->at + g->slope * ((double)c + 0.5);
    p->bottom[c] = 0;
  }
}

/* Columns of a level step at an end of the heap: a bar that lies against its foot. */
static size_t step_at(const picture *p, const run *heap, bool right) {
  size_t count = 0, all = heap->end - heap->begin;
  double level = p->bottom[right ? heap->end - 2 : heap->begin + 1];
  while (count < all) {
    double h = p->bottom[right ? heap->end - 1 - count : heap->begin + count];
    if (count > 1 && fabs(h - level) > fmax(1.5, 0.1 * level)) break;
    count++;
  }
  bool bar = level >= bar_rows && level < thing_height * heap->peak && count < all &&
             (double)count >= bar_share * (double)p->width;
  return bar ? count : 0;
}

/* What stands on the ground beside the heap, and is more than a grain: a ruler goes, all else is
 * told. */
static scree_status clear_ground(picture *p, const ground *g, scree_error *error) {
  double peak = 0;
  run heap = {0};
  for (size_t c = 0; c < p->width; c++) {
    p->bottom[c] = isnan(p->top[c]) ? 0 : g->at + g->slope * ((double)c + 0.5) - p->top[c];
    peak = fmax(peak, p->bottom[c]);
  }
  double flat = fmax(1.5, flat_share * peak);
  for (run r = next_run(p, 0, flat); r.begin < p->width; r = next_run(p, r.end, flat))
    if (r.area > heap.area) heap = r;
  for (run r = next_run(p, 0, flat); r.begin < p->width; r = next_run(p, r.end, flat)) {
    double wide = (double)(r.end - r.begin);
    if (r.begin == heap.begin || (r.area < thing_area * heap.area &&
                                  r.peak < thing_height * heap.peak && wide < grain_width * r.peak))
      continue;
    if (r.area < bar_fill * wide * r.peak)
      return scree_fail(
          error, SCREE_BAD_FILE,
          "something else lies beside the heap, in columns %zu to %zu of %zu: take it "
          "away, or cut it off; a ruler must lie or stand straight",
          r.begin + 1, r.end, p->width);
    p->ruler = fmax(p->ruler, fmax(wide, r.peak));
    flatten(p, g, r.begin, r.end);
  }
  for (int right = 0; right < 2 && heap.end - heap.begin > 2; right++) {
    size_t step = step_at(p, &heap, right);
    if (!step) continue;
    p->ruler = fmax(p->ruler, (double)step);
    flatten(p, g, right ? heap.end - step : heap.begin, right ? heap.end : heap.begin + step);
  }
  return SCREE_OK;
}

/* Turned so that the ground is level; of what falls on one pixel the highest counts. */
static scree_status draw_outline(const picture *p, const ground *g, double pixel,
                                 scree_outline *outline, scree_error *error) {
  double length = hypot(1, g->slope), cosine = 1 / length, sine = g->slope / length;
  size_t columns = (size_t)((double)p->width * length + (double)p->height) + 1, count = 0;
  SCREE_SCRATCH(double, highest, columns, error);
  for (size_t i = 0; i < columns; i++) highest[i] = NAN;
  for (size_t c = 0; c < p->width; c++) {
    if (isnan(p->top[c])) continue;
    double x = (double)c + 0.5, down = p->top[c] - g->at;
    double along = x * cosine + down * sine;
    double up = x * sine - down * cosine;
    size_t i = (size_t)fmax(0, along);
    if (i < columns) highest[i] = fmax(highest[i], up);
  }
  for (size_t i = 0; i < columns; i++) count += !isnan(highest[i]);
  SCREE_TRY(make_outline(count, outline, error));
  for (size_t i = 0, made = 0; i < columns; i++) {
    if (isnan(highest[i])) continue;
    outline->x[made] = ((double)i + 0.5) * pixel;
    outline->z[made++] = highest[i] * pixel;
  }
  double axis = axis_of(outline);
  for (size_t i = 0; i < count; i++) outline->x[i] -= axis;
  return SCREE_OK;
}

scree_status scree_outline_trace(const uint8_t *rgb, size_t width, size_t height, double pixel,
                                 scree_outline *outline, scree_error *error) {
  ground g = {0};
  if (!(pixel > 0) || width < 8 || height < 8)
    return scree_fail(
        error, SCREE_BAD_ARGUMENT,
        "a picture of %zu x %zu pixels of %g m: must be 8 x 8 at least, and its scale positive",
        width, height, pixel);
  SCREE_SCRATCH(char, heap, width *height, error);
  SCREE_SCRATCH(double, top, 2 * width, error);
  picture p = {width, height, heap, top, top + width, 0};
  SCREE_TRY(find_silhouette(rgb, &p, error));
  SCREE_TRY(find_columns(&p, error));
  SCREE_TRY(find_ground(&p, &g, error));
  SCREE_TRY(clear_ground(&p, &g, error));
  SCREE_TRY(draw_outline(&p, &g, pixel, outline, error));
  outline->ruler = p.ruler * pixel;
  return SCREE_OK;
}
