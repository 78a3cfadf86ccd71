/* Distance fields after Quilez, "Distance functions" (iquilezles.org/articles/distfunctions): the
 * rounded rectangle, the extrusion with filleted edges, the capsule and the torus are exact; the
 * blend is his quadratic polynomial smooth minimum, whose gradient is a mean of the two gradients
 * and therefore no longer than 1. A taper replaces the side distance d by (d - t z) / sqrt(1 +
 * t^2), again of unit gradient.
 *
 * Points are evaluated in batches, one solid after the other, so that the inner loops are plain
 * arithmetic over arrays, which compilers turn into vector code without changing a bit. */
#include "sample/shape.h"

#include <string.h>

#define MM       1e-3
#define DEGREE   (3.14159265358979323846 / 180)
#define FAR_AWAY 1e3 /* metres; outside, farther than anything */

static inline double max2(double a, double b) {
  return a > b ? a : b;
}
static inline double min2(double a, double b) {
  return a < b ? a : b;
}

/* ---- From the drawing ---- */

static mat3 axis_turn(int axis, double angle) {
  double c = scree_cos(angle), s = scree_sin(angle);
  int u = (axis + 1) % 3, v = (axis + 2) % 3;
  mat3 turn = {{{0}}};
  turn.m[axis][axis] = 1;
  turn.m[u][u] = turn.m[v][v] = c;
  turn.m[u][v] = -s;
  turn.m[v][u] = s;
  return turn;
}

static mat3 turn_of(vec3 deg, bool *turned) {
  mat3 x = axis_turn(0, deg.x * DEGREE), y = axis_turn(1, deg.y * DEGREE),
       z = axis_turn(2, deg.z * DEGREE), yx = mat3_mul(&y, &x);
  *turned = deg.x != 0 || deg.y != 0 || deg.z != 0;
  return mat3_mul(&z, &yx);
}

static bool add_part(scree_shape *shape, const scree_piece_mm *line) {
  if (shape->part_count == SCREE_SHAPE_PARTS) return false;
  scree_part *part = &shape->parts[shape->part_count++];
  *part = (scree_part){.op = line->op, .blend = line->blend * MM, .stretch = 1};
  part->at = vec3_scale(line->at, MM);
  part->turn = turn_of(line->turn_deg, &part->turned);
  if (line->bend_deg != 0) {
    part->bent = true;
    part->bend_half_angle = 0.5 * line->bend_deg * DEGREE;
    part->bend_radius = line->bend_length * MM / (line->bend_deg * DEGREE);
    /* lengths at height z above the bent plane grow by R / (R - z); the box of a bent phone is
     * far lower than R / 3 */
    part->stretch = 1.5;
  }
  shape->blend_max = max2(shape->blend_max, part->blend);
  return true;
}

/* Where a point of the unbent part goes. */
static vec3 bend_forward(const scree_part *part, vec3 p) {
  double limit = part->bend_half_angle * part->bend_radius;
  double arc = min2(max2(p.y, -limit), limit), beyond = p.y - arc;
  double angle = arc / part->bend_radius, c = scree_cos(angle), s = scree_sin(angle);
  double r = part->bend_radius - p.z;
  return (vec3){p.x, r * s + beyond * c, part->bend_radius - r * c + beyond * s};
}

/* Grows the shape's box by the box of one solid (its corners, and for a bent part the points
 * between them). */
static void grow_box(scree_shape *shape, const scree_shape_piece *solid) {
  const scree_part *part = &shape->parts[solid->part];
  vec3 h = solid->half;
  if (solid->kind == SCREE_PIECE_TORUS) h = (vec3){h.x + h.y, h.x + h.y, h.y};
  if (solid->kind == SCREE_PIECE_CAPSULE) h = (vec3){h.x, h.x, h.z + h.x};
  double open = fabs(solid->taper) * h.z;
  h.x += open;
  h.y += open;
  for (int i = 0; i < 27; i++) {
    vec3 p = {h.x * (i % 3 - 1), h.y * (i / 3 % 3 - 1), h.z * (i / 9 - 1)};
    p = vec3_add(solid->at, mat3_mul_vec(&solid->turn, p));
    if (part->bent) p = bend_forward(part, p);
    p = vec3_add(part->at, mat3_mul_vec(&part->turn, p));
    shape->low = vec3_min(shape->low, p);
    shape->high = vec3_max(shape->high, p);
  }
}

/* Puts copy i of a ring where it belongs: in the plane of the solid's own x and y. */
static void place_on_ring(const scree_piece_mm *line, int i, scree_shape_piece *solid) {
  mat3 spin = axis_turn(2, 360.0 * i / line->ring_copies * DEGREE);
  vec3 arm = {line->ring_radius * MM, 0, 0};
  solid->turn = mat3_mul(&solid->turn, &spin);
  solid->turned = true;
  solid->at = vec3_add(solid->at, mat3_mul_vec(&solid->turn, arm));
}

static bool add_solid(scree_shape *shape, const scree_piece_mm *line) {
  int nx = line->copies_x > 1 ? line->copies_x : 1, ny = line->copies_y > 1 ? line->copies_y : 1;
  if (line->ring_copies > 1) nx = line->ring_copies;
  for (int i = 0; i < nx * ny; i++) {
    if (shape->piece_count == SCREE_SHAPE_PIECES || shape->part_count == 0) return false;
    scree_shape_piece *solid = &shape->pieces[shape->piece_count++];
    *solid = (scree_shape_piece){
        .kind = line->kind,
        .op = line->op,
        .part = (uint16_t)(shape->part_count - 1),
        .half = vec3_scale(line->half, MM),
        .corner = line->corner * MM,
        .fillet = line->fillet * MM,
        .taper = line->taper,
        .taper_cosine = 1 / sqrt(1 + line->taper * line->taper),
        .scale = 1 / sqrt(1 + fabs(line->taper) / sqrt(1 + line->taper * line->taper)),
        .blend = line->blend * MM};
    vec3 offset = {(i % nx - 0.5 * (nx - 1)) * line->pitch_x,
                   (i / nx - 0.5 * (ny - 1)) * line->pitch_y, 0};
    solid->turn = turn_of(line->turn_deg, &solid->turned);
    solid->at = vec3_scale(vec3_add(line->at, offset), MM);
    if (line->ring_copies > 1) place_on_ring(line, i, solid);
    shape->blend_max = max2(shape->blend_max, solid->blend);
    if (solid->op == SCREE_PIECE_JOIN) grow_box(shape, solid);
  }
  return true;
}

bool scree_shape_build(const scree_piece_mm *lines, size_t line_count, scree_shape *shape) {
  memset(shape, 0, sizeof *shape);
  shape->low = (vec3){FAR_AWAY, FAR_AWAY, FAR_AWAY};
  shape->high = vec3_neg(shape->low);
  for (size_t i = 0; i < line_count; i++) {
    bool added = lines[i].kind == SCREE_PIECE_PART ? add_part(shape, &lines[i])
                                                   : add_solid(shape, &lines[i]);
    if (!added) return false;
  }
  /* a blend swells the surface by at most a quarter of its width */
  double swell = 0.25 * shape->blend_max;
  shape->low = vec3_sub(shape->low, (vec3){swell, swell, swell});
  shape->high = vec3_add(shape->high, (vec3){swell, swell, swell});
  return shape->piece_count > 0;
}

/* ---- Into the frames ---- */

static void into_frame(vec3 at, const mat3 *turn, bool turned, const scree_points *from,
                       size_t count, scree_points *to) {
  if (!turned) {
    for (size_t i = 0; i < count; i++) {
      to->x[i] = from->x[i] - at.x;
      to->y[i] = from->y[i] - at.y;
      to->z[i] = from->z[i] - at.z;
    }
    return;
  }
  const mat3 t = *turn;
  for (size_t i = 0; i < count; i++) {
    double x = from->x[i] - at.x, y = from->y[i] - at.y, z = from->z[i] - at.z;
    to->x[i] = t.m[0][0] * x + t.m[1][0] * y + t.m[2][0] * z;
    to->y[i] = t.m[0][1] * x + t.m[1][1] * y + t.m[2][1] * z;
    to->z[i] = t.m[0][2] * x + t.m[1][2] * y + t.m[2][2] * z;
  }
}

/* Undoes the bend: the neutral plane z = 0 is an arc of radius R about (y, z) = (0, R) for angles
 * up to the half angle, straight beyond. */
static void unbend(const scree_part *part, size_t count, scree_points *points) {
  double radius = part->bend_radius, limit = part->bend_half_angle, c = scree_cos(limit),
         s = scree_sin(limit);
  for (size_t i = 0; i < count; i++) {
    double y = points->y[i], z = points->z[i], side = y < 0 ? -1 : 1;
    double angle = scree_atan2(fabs(y), radius - z);
    if (angle < limit) {
      points->y[i] = side * angle * radius;
      points->z[i] = radius - sqrt(y * y + (radius - z) * (radius - z));
    } else {
      double u = fabs(y) - radius * s, w = z - radius * (1 - c);
      points->y[i] = side * (limit * radius + c * u + s * w);
      points->z[i] = c * w - s * u;
    }
  }
}

static void into_part(const scree_part *part, const scree_points *from, size_t count,
                      scree_points *to) {
  into_frame(part->at, &part->turn, part->turned, from, count, to);
  if (part->bent) unbend(part, count, to);
}

/* ---- Distances ---- */

static void slab_distance(const scree_shape_piece *s, const scree_points *p, size_t count,
                          double *d) {
  double r = s->corner, f = s->fillet, inner_x = s->half.x - r, inner_y = s->half.y - r,
         inner_z = s->half.z - f, taper = s->taper, cosine = s->taper_cosine, scale = s->scale;
  for (size_t i = 0; i < count; i++) {
    double ax = fabs(p->x[i]) - inner_x, ay = fabs(p->y[i]) - inner_y;
    double px = max2(ax, 0), py = max2(ay, 0);
    double side = sqrt(px * px + py * py) + min2(max2(ax, ay), 0) - r;
    double u = (side - taper * p->z[i]) * cosine + f, v = fabs(p->z[i]) - inner_z;
    double pu = max2(u, 0), pv = max2(v, 0);
    d[i] = (min2(max2(u, v), 0) + sqrt(pu * pu + pv * pv) - f) * scale;
  }
}

static void capsule_distance(const scree_shape_piece *s, const scree_points *p, size_t count,
                             double *d) {
  double h = s->half.z, r = s->half.x;
  for (size_t i = 0; i < count; i++) {
    double x = p->x[i], y = p->y[i], z = max2(fabs(p->z[i]) - h, 0);
    d[i] = sqrt(x * x + y * y + z * z) - r;
  }
}

static void torus_distance(const scree_shape_piece *s, const scree_points *p, size_t count,
                           double *d) {
  for (size_t i = 0; i < count; i++) {
    double x = p->x[i], y = p->y[i], z = p->z[i], q = sqrt(x * x + y * y) - s->half.x;
    d[i] = sqrt(q * q + z * z) - s->half.y;
  }
}

static void solid_distance(const scree_shape_piece *solid, const scree_points *points, size_t count,
                           scree_points *scratch, double *d) {
  into_frame(solid->at, &solid->turn, solid->turned, points, count, scratch);
  if (solid->kind == SCREE_PIECE_CAPSULE)
    capsule_distance(solid, scratch, count, d);
  else if (solid->kind == SCREE_PIECE_TORUS)
    torus_distance(solid, scratch, count, d);
  else
    slab_distance(solid, scratch, count, d);
}

/* a := a op b. sign turns the smooth minimum into the smooth maximum: max(a, b) = -min(-a, -b). */
static void combine(scree_piece_op op, double blend, size_t count, const double *b, double *a) {
  double sign_a = op == SCREE_PIECE_JOIN ? 1 : -1, sign_b = op == SCREE_PIECE_KEEP ? -1 : 1;
  if (blend <= 0) {
    for (size_t i = 0; i < count; i++) a[i] = sign_a * min2(sign_a * a[i], sign_b * b[i]);
    return;
  }
  double quarter = 0.25 / blend;
  for (size_t i = 0; i < count; i++) {
    double u = sign_a * a[i], v = sign_b * b[i], h = max2(blend - fabs(u - v), 0);
    a[i] = sign_a * (min2(u, v) - h * h * quarter);
  }
}

void scree_shape_distance(const scree_shape *shape, const scree_shape_list *list,
                          const scree_points *points, size_t count, double *distance) {
  scree_points local, scratch;
  double of_part[SCREE_SHAPE_BATCH], of_solid[SCREE_SHAPE_BATCH];
  for (size_t i = 0; i < count; i++) distance[i] = FAR_AWAY;
  for (size_t at = 0; at < list->count;) {
    uint16_t part_index = shape->pieces[list->pieces[at]].part;
    const scree_part *part = &shape->parts[part_index];
    into_part(part, points, count, &local);
    for (size_t i = 0; i < count; i++) of_part[i] = FAR_AWAY;
    for (; at < list->count && shape->pieces[list->pieces[at]].part == part_index; at++) {
      const scree_shape_piece *solid = &shape->pieces[list->pieces[at]];
      solid_distance(solid, &local, count, &scratch, of_solid);
      combine(solid->op, solid->blend, count, of_solid, of_part);
    }
    if (part->stretch != 1)
      for (size_t i = 0; i < count; i++) of_part[i] /= part->stretch;
    combine(part->op, part->blend, count, of_part, distance);
  }
}

/* ---- Pruning ---- */

void scree_shape_list_all(const scree_shape *shape, scree_shape_list *list) {
  list->count = shape->piece_count;
  for (size_t i = 0; i < shape->piece_count; i++) list->pieces[i] = (uint16_t)i;
}

/* A solid farther than the margin from the whole ball adds nothing there and takes nothing away;
 * one to keep that holds the ball with the same margin takes nothing away either. Leaving it out
 * changes the field only where it is larger than the margin less the solid's own blend; the blends
 * that follow carry such a change down by no more than their widths. So the margin is the band, the
 * solid's blend and those of all later solids that are near: the list is made from its end. */
void scree_shape_prune(const scree_shape *shape, vec3 centre, double radius, double band,
                       scree_shape_list *list) {
  double margin = radius + band;
  scree_points point, local, scratch;
  size_t part_now = SIZE_MAX;
  point.x[0] = centre.x;
  point.y[0] = centre.y;
  point.z[0] = centre.z;
  list->count = 0;
  for (size_t i = shape->piece_count; i-- > 0;) {
    const scree_shape_piece *solid = &shape->pieces[i];
    const scree_part *part = &shape->parts[solid->part];
    if (solid->part != part_now) {
      into_part(part, &point, 1, &local);
      margin += part->blend;
    }
    part_now = solid->part;
    double d, limit = (margin + solid->blend) * part->stretch;
    solid_distance(solid, &local, 1, &scratch, &d);
    if (solid->op == SCREE_PIECE_KEEP ? d < -limit : d > limit) continue;
    margin += solid->blend;
    list->pieces[list->count++] = (uint16_t)i;
  }
  for (size_t a = 0, b = list->count; a + 1 < b; a++) {
    uint16_t swap = list->pieces[a];
    list->pieces[a] = list->pieces[--b];
    list->pieces[b] = swap;
  }
}
