/* The scan of a real heap has any orientation, a floor around it, holes and noise. The floor is the
 * plane that carries the heap: much of the surface lies in it, and all but strays of the rest on
 * one side. Planes through three random points of the surface, drawn by area, are asked for that
 * (random sample consensus, Fischler and Bolles 1981); one more comes from the sum of the facets'
 * area vectors, which for a surface whose rim lies in a plane is normal to it, whatever it spans.
 * The best is fitted to its points by least squares, again and again without those that lie
 * farther off than noise does. */
#include "base/alloc.h"
#include "base/box.h"
#include "base/eigen.h"
#include "base/radix.h"
#include "base/rng.h"
#include "heap/repose.h"
#include "scree.h"

#include <math.h>

enum {
  POINTS = 4096,      /* of the surface, drawn by area */
  FIRST_POINTS = 256, /* that rule out most planes */
  TRIES = 20000,
  ROUNDS = 30,
  CELLS_ACROSS = 600,
  MOST_SWEEPS = 1000
};
static const double thickness = 0.01;    /* of a floor as tried, in diagonals of the scan */
static const double least_floor = 0.05;  /* share of the surface that lies in it */
static const double most_below = 0.02;   /* share that may hang below it: strays */
static const double noise_width = 2.5;   /* in standard deviations: what is fitted to */
static const double floor_noise = 3;     /* what is lower than as many is floor */
static const double least_height = 1e-6; /* in widths of the field: rounding is lower */
static const double over_relaxation = 1.9;

typedef struct plane {
  vec3 normal;
  double offset; /* points p of it: normal . p = offset */
} plane;

static double height_of(const plane *p, vec3 point) {
  return vec3_dot(p->normal, point) - p->offset;
}

static void corners_of(const scree_mesh *mesh, size_t triangle, vec3 p[3]) {
  for (size_t k = 0; k < 3; k++)
    p[k] = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * triangle + k]);
}

/* Points by area, and the sum of the area vectors. */
static scree_status draw_points(const scree_mesh *mesh, vec3 *points, vec3 *sum,
                                scree_error *error) {
  size_t n = mesh->triangle_count;
  double area = 0;
  SCREE_SCRATCH(double, until, n, error);
  *sum = (vec3){0, 0, 0};
  for (size_t t = 0; t < n; t++) {
    vec3 p[3];
    corners_of(mesh, t, p);
    vec3 twice = vec3_triangle_normal(p[0], p[1], p[2]);
    *sum = vec3_add(*sum, twice);
    until[t] = area += vec3_norm(twice);
  }
  scree_rng rng = {.seed = 1};
  for (size_t i = 0; i < POINTS; i++) {
    double wanted = area * scree_rng_uniform(&rng), u = sqrt(scree_rng_uniform(&rng)),
           v = scree_rng_uniform(&rng);
    SCREE_FIND_FIRST(low, 0, n - 1, until[low] <= wanted)
    vec3 p[3];
    corners_of(mesh, low, p);
    points[i] = vec3_add(vec3_scale(p[0], 1 - u),
                         vec3_add(vec3_scale(p[1], u * (1 - v)), vec3_scale(p[2], u * v)));
  }
  return area > 0 ? SCREE_OK : scree_fail(error, SCREE_BAD_MESH, "none of its facets has an area");
}

/* The share of points in the plane; 0 where too many lie on either side. Turns the plane so that
 * the rest is above. */
static double share_in(plane *p, const vec3 *points, size_t count, double width) {
  size_t in = 0, below = 0, above = 0;
  for (size_t i = 0; i < count; i++) {
    double h = height_of(p, points[i]);
    in += fabs(h) <= width;
    below += h < -width;
    above += h > width;
  }
  if (below > above) {
    *p = (plane){vec3_neg(p->normal), -p->offset};
    below = above;
  }
  return (double)below > most_below * (double)count ? 0 : (double)in / (double)count;
}

static bool plane_through(vec3 a, vec3 b, vec3 c, plane *p) {
  vec3 normal = vec3_triangle_normal(a, b, c);
  double length = vec3_norm(normal);
  if (!(length > 0)) return false;
  p->normal = vec3_scale(normal, 1 / length);
  p->offset = vec3_dot(p->normal, a);
  return true;
}

/* Keeps the better of both. */
static void try_plane(plane p, const vec3 *points, double width, plane *best, double *best_share) {
  if (share_in(&p, points, FIRST_POINTS, width) < 0.5 * *best_share) return;
  double share = share_in(&p, points, POINTS, width);
  if (share <= *best_share) return;
  *best = p;
  *best_share = share;
}

/* Least squares through the points within `width` of the plane; their root mean square, NaN where
 * they are too few. */
static double fit_plane(plane *p, const vec3 *points, double width) {
  vec3 mean = {0, 0, 0};
  double count = 0;
  for (size_t i = 0; i < POINTS; i++)
    if (fabs(height_of(p, points[i])) <= width) {
      mean = vec3_add(mean, points[i]);
      count++;
    }
  if (count < 3) return NAN;
  mean = vec3_scale(mean, 1 / count);
  mat3 moment = {{{0}}}, axes;
  for (size_t i = 0; i < POINTS; i++) {
    if (fabs(height_of(p, points[i])) > width) continue;
    vec3 d = vec3_sub(points[i], mean);
    const double part[3] = {d.x, d.y, d.z};
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) moment.m[a][b] += part[a] * part[b] / count;
  }
  double values[3];
  scree_eigen_symmetric(&moment, values, &axes);
  vec3 normal = vec3_unit(vec3_load(axes.m[0]));
  if (vec3_dot(normal, p->normal) < 0) normal = vec3_neg(normal);
  *p = (plane){normal, vec3_dot(normal, mean)};
  return values[0] > 0 ? sqrt(values[0]) : 0;
}

static scree_status find_floor(const vec3 *points, vec3 sum, double diagonal, plane *best,
                               scree_ground *ground, scree_error *error) {
  double width = thickness * diagonal, share = 0;
  scree_rng rng = {.seed = 2};
  for (int i = 0; i < TRIES; i++) {
    plane p;
    size_t a = scree_rng_below(&rng, POINTS), b = scree_rng_below(&rng, POINTS),
           c = scree_rng_below(&rng, POINTS);
    if (plane_through(points[a], points[b], points[c], &p))
      try_plane(p, points, width, best, &share);
  }
  if (vec3_norm(sum) > 0)
    for (int i = 0; i < POINTS; i++) {
      plane p = {vec3_unit(sum), vec3_dot(vec3_unit(sum), points[i])};
      try_plane(p, points, width, best, &share);
    }
  if (share < least_floor)
    return scree_fail(
        error, SCREE_BAD_MESH,
        "no floor that carries a heap: no plane has %g %% of the surface in it and all else on one "
        "side; leave the floor around the heap in the scan, and cut off what is below it",
        100 * least_floor);
  double rms = fit_plane(best, points, width);
  for (int round = 0; round < ROUNDS; round++) {
    double next = fit_plane(best, points, fmax(noise_width * rms, 1e-9 * diagonal));
    if (isnan(next)) break;
    rms = next;
  }
  size_t in = 0;
  for (size_t i = 0; i < POINTS; i++) in += fabs(height_of(best, points[i])) <= width;
  ground->share = (double)in / POINTS;
  ground->rms = rms;
  return SCREE_OK;
}

/* ---- holes and specks ---- */

size_t scree_flood(char *mark, size_t columns, size_t rows, size_t seed, size_t *cells) {
  size_t count = 0, done = 0;
  cells[count++] = seed;
  mark[seed] = SCREE_DONE;
  while (done < count) {
    size_t i = cells[done++], column = i % columns, row = i / columns;
    const size_t next[4] = {column ? i - 1 : i, column + 1 < columns ? i + 1 : i,
                            row ? i - columns : i, row + 1 < rows ? i + columns : i};
    for (int k = 0; k < 4; k++) {
      if (mark[next[k]] != SCREE_IN) continue;
      mark[next[k]] = SCREE_DONE;
      cells[count++] = next[k];
    }
  }
  return count;
}

/* What is not covered and hangs together with the field's edge, all round of which nothing was
 * scanned, has nothing on it. The rest are holes: they get the surface of a soap film over their
 * rims, every cell the mean of its four neighbours, by successive over-relaxation. Answers their
 * share of the heap's cells. */
static double fill_holes(scree_height_field *f, char *mark, size_t *cells, double low) {
  size_t count = 0, covered = 0, filled = 0, n = f->columns * f->rows;
  for (size_t i = 0; i < n; i++) mark[i] = f->height[i] > -INFINITY ? SCREE_OUT : SCREE_IN;
  scree_flood(mark, f->columns, f->rows, 0, cells);
  for (size_t i = 0; i < n; i++) {
    covered += f->height[i] > low;
    if (mark[i] != SCREE_OUT) f->height[i] = 0;
    if (mark[i] == SCREE_IN) cells[count++] = i;
  }
  for (int sweep = 0; sweep < MOST_SWEEPS && count; sweep++) {
    double most = 0;
    for (size_t k = 0; k < count; k++) {
      double *h = &f->height[cells[k]];
      double change = 0.25 * (h[-1] + h[1] + h[-(ptrdiff_t)f->columns] + h[f->columns]) - *h;
      *h += over_relaxation * change;
      most = fmax(most, fabs(change));
    }
    if (most < 1e-4 * f->cell) break;
  }
  for (size_t k = 0; k < count; k++) filled += f->height[cells[k]] > low;
  return filled ? (double)filled / (double)(filled + covered) : 0;
}

/* Keeps of what is higher than the floor's noise the piece of the largest volume, which is the
 * heap. */
static void keep_heap(scree_height_field *f, char *mark, size_t *cells, double low) {
  size_t n = f->columns * f->rows, best = n;
  double most = 0;
  for (size_t i = 0; i < n; i++) mark[i] = f->height[i] > low ? SCREE_IN : SCREE_OUT;
  for (size_t i = 0; i < n; i++) {
    if (mark[i] != SCREE_IN) continue;
    double volume = 0;
    size_t count = scree_flood(mark, f->columns, f->rows, i, cells);
    for (size_t k = 0; k < count; k++) volume += f->height[cells[k]];
    if (volume <= most) continue;
    most = volume;
    best = i;
  }
  for (size_t i = 0; i < n; i++) mark[i] = f->height[i] > low ? SCREE_IN : SCREE_OUT;
  if (best < n) scree_flood(mark, f->columns, f->rows, best, cells);
  for (size_t i = 0; i < n; i++)
    if (mark[i] != SCREE_DONE) f->height[i] = 0;
}

static scree_status tidy(scree_height_field *f, scree_ground *ground, scree_error *error) {
  size_t n = f->columns * f->rows;
  double low = fmax(floor_noise * ground->rms, least_height * (double)f->columns * f->cell);
  SCREE_SCRATCH(char, mark, n, error);
  SCREE_SCRATCH(size_t, cells, n, error);
  ground->filled = fill_holes(f, mark, cells, low);
  keep_heap(f, mark, cells, low);
  return SCREE_OK;
}

/* The turn that brings the normal upright, by the shorter way. */
static quat upright(vec3 normal) {
  vec3 axis = vec3_cross(normal, (vec3){0, 0, 1});
  double sine = vec3_norm(axis), angle = atan2(sine, normal.z);
  if (!(sine > 0)) return normal.z > 0 ? (quat){1, 0, 0, 0} : (quat){0, 1, 0, 0};
  return quat_from_rotation_vector(vec3_scale(axis, angle / sine));
}

static scree_status make_field(const scree_mesh *mesh, const plane *p, double cell,
                               scree_ground *ground, scree_height_field *field,
                               scree_error *error) {
  quat q = upright(p->normal);
  mat3 turn = quat_to_mat3(q);
  vec3 low = {INFINITY, INFINITY, 0}, high = {-INFINITY, -INFINITY, 0};
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    vec3 v = mat3_mul_vec(&turn, vec3_load(mesh->positions + 3 * i));
    low = vec3_min(low, v);
    high = vec3_max(high, v);
  }
  double half = 0.5 * fmax(high.x - low.x, high.y - low.y);
  if (cell == 0) cell = 2 * half / CELLS_ACROSS;
  SCREE_CLEANUP(scree_height_field_free) scree_height_field made = {0};
  SCREE_TRY(scree_height_field_create(0.5 * (low.x + high.x), 0.5 * (low.y + high.y),
                                      half + 2 * cell, cell, &made, error));
  for (size_t i = 0; i < made.columns * made.rows; i++) made.height[i] = -INFINITY;
  const double origin[3] = {0, 0, 0}, turned[4] = {q.w, q.x, q.y, q.z};
  scree_height_field_add_mesh(&made, mesh, origin, turned, p->offset);
  SCREE_TRY(tidy(&made, ground, error));
  vec3_store(ground->up, p->normal);
  ground->offset = p->offset;
  *field = made;
  made = (scree_height_field){0};
  return SCREE_OK;
}

scree_status scree_height_field_scan(const scree_mesh *scan, double cell, scree_ground *ground,
                                     scree_height_field *field, scree_error *error) {
  plane best = {{0, 0, 1}, 0};
  const scree_box box = scree_box_of_points(scan->positions, scan->vertex_count);
  vec3 sum;
  scree_ground found = {0};
  if (!(cell >= 0))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "cells of %g m: must not be below 0", cell);
  if (scan->triangle_count == 0) return scree_fail(error, SCREE_BAD_MESH, "no facet in it");
  SCREE_SCRATCH(vec3, points, POINTS, error);
  SCREE_TRY(draw_points(scan, points, &sum, error));
  SCREE_TRY(find_floor(points, sum, vec3_distance(box.low, box.high), &best, &found, error));
  SCREE_TRY(make_field(scan, &best, cell, &found, field, error));
  *ground = found;
  return SCREE_OK;
}
