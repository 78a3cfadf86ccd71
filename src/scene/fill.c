/* Random sequential addition of oriented boxes in a cylinder or a box. Spheres and boxes both bound
 * a particle: it is enough that either pair is apart, which places round particles by their spheres
 * and long ones by their boxes. */
#include "scene/fill.h"

#include "base/alloc.h"
#include "base/math.h"
#include "base/rng.h"

/* Random numbers: one stream for the order, then one a layer. */
enum { ORDER_STREAM = 1, FIRST_LAYER_STREAM = 16 };
enum { TRIES = 400 };

/* Added to the projections: cross products of parallel axes vanish, and must not separate. */
static const double parallel_slack = 1e-9;

bool scree_oriented_boxes_apart(const scree_oriented_box *a, const scree_oriented_box *b) {
  const double ha[3] = {a->half.x, a->half.y, a->half.z};
  const double hb[3] = {b->half.x, b->half.y, b->half.z};
  vec3 between = vec3_sub(b->centre, a->centre);
  vec3 in_a = mat3_tmul_vec(&a->axes, between);
  const double t[3] = {in_a.x, in_a.y, in_a.z};
  mat3 at = mat3_transpose(&a->axes), r = mat3_mul(&at, &b->axes);
  double m[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) m[i][j] = fabs(r.m[i][j]) + parallel_slack;
  for (int i = 0; i < 3; i++) {
    double reach_a = ha[i] + hb[0] * m[i][0] + hb[1] * m[i][1] + hb[2] * m[i][2];
    if (fabs(t[i]) > reach_a) return true;
    double along_b = t[0] * r.m[0][i] + t[1] * r.m[1][i] + t[2] * r.m[2][i];
    double reach_b = hb[i] + ha[0] * m[0][i] + ha[1] * m[1][i] + ha[2] * m[2][i];
    if (fabs(along_b) > reach_b) return true;
  }
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      double along = t[i2] * r.m[i1][j] - t[i1] * r.m[i2][j];
      double reach = ha[i1] * m[i2][j] + ha[i2] * m[i1][j] + hb[j1] * m[i][j2] + hb[j2] * m[i][j1];
      if (fabs(along) > reach) return true;
    }
  return false;
}

void scree_placement_settle(scree_placement *p) {
  p->box.axes = quat_to_mat3(p->orientation);
  p->box.half = p->half;
  p->box.centre = vec3_add(p->position, mat3_mul_vec(&p->box.axes, p->box_centre));
}

bool scree_placements_apart(const scree_placement *a, const scree_placement *b) {
  double reach = a->radius + b->radius;
  return vec3_norm2(vec3_sub(a->position, b->position)) > reach * reach ||
         scree_oriented_boxes_apart(&a->box, &b->box);
}

void scree_placement_reach(const scree_placement *p, vec3 n, double *up, double *down) {
  vec3 local = mat3_tmul_vec(&p->box.axes, n);
  double half = fabs(local.x) * p->half.x + fabs(local.y) * p->half.y + fabs(local.z) * p->half.z;
  double middle = vec3_dot(n, vec3_sub(p->box.centre, p->position));
  *up = fmin(p->radius, middle + half);
  *down = fmin(p->radius, half - middle);
}

bool scree_placement_within(const scree_placement *p, vec3 from, vec3 axis, double radius) {
  vec3 d = vec3_sub(p->position, from);
  if (vec3_norm(vec3_mad(d, axis, -vec3_dot(d, axis))) + p->radius <= radius) return true;
  for (int corner = 0; corner < 8; corner++) {
    vec3 local = {corner & 1 ? p->half.x : -p->half.x, corner & 2 ? p->half.y : -p->half.y,
                  corner & 4 ? p->half.z : -p->half.z};
    vec3 c = vec3_sub(vec3_add(p->box.centre, mat3_mul_vec(&p->box.axes, local)), from);
    if (vec3_norm(vec3_mad(c, axis, -vec3_dot(c, axis))) > radius) return false;
  }
  return true;
}

static bool is_free(const scree_fill_layer *layer, const scree_placement *p,
                    const scree_placement *placed, size_t placed_count) {
  for (size_t i = placed_count; i-- > 0;)
    if (!scree_placements_apart(p, &placed[i])) return false;
  for (size_t i = layer->present_count; i-- > 0;)
    if (!scree_placements_apart(p, &layer->present[i])) return false;
  return true;
}

/* Half the extent of the box along space's z. */
static double half_height(const scree_oriented_box *box) {
  return fabs(box->axes.m[2][0]) * box->half.x + fabs(box->axes.m[2][1]) * box->half.y +
         fabs(box->axes.m[2][2]) * box->half.z;
}

static bool is_inside(const scree_oriented_box *box, const scree_fill_layer *layer) {
  double radius = layer->cylinder_radius;
  for (int corner = 0; corner < 8; corner++) {
    vec3 local = {corner & 1 ? box->half.x : -box->half.x, corner & 2 ? box->half.y : -box->half.y,
                  corner & 4 ? box->half.z : -box->half.z};
    vec3 p = vec3_add(box->centre, mat3_mul_vec(&box->axes, local));
    p.x -= layer->centre[0], p.y -= layer->centre[1];
    if (radius > 0 && p.x * p.x + p.y * p.y > radius * radius) return false;
    if (radius == 0 && (fabs(p.x) > layer->half[0] || fabs(p.y) > layer->half[1])) return false;
  }
  return true;
}

/* A random place across the layer. */
static void draw_place(const scree_fill_layer *layer, scree_rng *rng, double at[2]) {
  double first = scree_rng_uniform(rng), second = scree_rng_uniform(rng);
  if (layer->cylinder_radius > 0) {
    double r = layer->cylinder_radius * sqrt(first), a = 6.283185307179586 * second;
    at[0] = r * scree_cos(a), at[1] = r * scree_sin(a);
  } else {
    at[0] = layer->half[0] * (2 * first - 1), at[1] = layer->half[1] * (2 * second - 1);
  }
}

/* Whether its sphere is. */
static bool is_round_inside(const scree_fill_layer *layer, const scree_placement *p) {
  double x = p->position.x - layer->centre[0], y = p->position.y - layer->centre[1];
  if (layer->cylinder_radius > 0) return sqrt(x * x + y * y) + p->radius <= layer->cylinder_radius;
  return fabs(x) + p->radius <= layer->half[0] && fabs(y) + p->radius <= layer->half[1];
}

/* A random orientation, and a random place of the box's centre in the layer; false where the box
 * leaves the layer or its rim. */
static bool try_place(const scree_fill_layer *layer, scree_placement *p, scree_rng *rng) {
  p->orientation = scree_rng_rotation(rng);
  p->position = (vec3){0, 0, 0};
  scree_placement_settle(p);
  double at[2];
  draw_place(layer, rng, at);
  double share = scree_rng_uniform(rng);
  bool by_sphere = p->half.x >= p->radius && p->half.y >= p->radius && p->half.z >= p->radius;
  double extent = by_sphere ? p->radius : half_height(&p->box);
  if (2 * extent > layer->height) return false;
  vec3 centre = {layer->centre[0] + at[0], layer->centre[1] + at[1],
                 layer->bottom + extent + share * (layer->height - 2 * extent)};
  p->position = vec3_sub(centre, p->box.centre);
  p->box.centre = centre;
  return is_round_inside(layer, p) || is_inside(&p->box, layer);
}

size_t scree_fill_place(const scree_fill_layer *layer, scree_placement *placements, size_t count) {
  scree_rng rng = {.seed = layer->seed, .stream = FIRST_LAYER_STREAM + layer->layer_index};
  for (size_t i = 0; i < count; i++) {
    bool found = false;
    for (int try = 0; try < TRIES && !found; try++)
      found = try_place(layer, &placements[i], &rng) &&
              is_free(layer, &placements[i], placements, i) &&
              (!layer->is_clear || layer->is_clear(layer->context, &placements[i]));
    if (!found) return i;
  }
  return count;
}

size_t scree_fill_next_shape(const double *shares, size_t shape_count, const size_t *dealt) {
  double sum = 0, most = -INFINITY;
  size_t next = 0, count = 0;
  for (size_t k = 0; k < shape_count; k++) {
    sum += shares ? shares[k] : 1;
    count += dealt[k];
  }
  for (size_t k = 0; k < shape_count; k++) {
    double share = (shares ? shares[k] : 1) / sum,
           behind = share * (double)(count + 1) - (double)dealt[k];
    if (behind > most + 1e-9) most = behind, next = k;
  }
  return next;
}

scree_status scree_fill_order(uint64_t seed, const double *shares, size_t shape_count,
                              uint32_t *order, size_t count, scree_error *error) {
  scree_rng rng = {.seed = seed, .stream = ORDER_STREAM};
  size_t *dealt = scree_alloc_zero(shape_count, sizeof *dealt);
  if (!dealt) return scree_fail_memory(error, shape_count * sizeof *dealt, "an order");
  for (size_t i = 0; i < count; i++) {
    order[i] = (uint32_t)scree_fill_next_shape(shares, shape_count, dealt);
    dealt[order[i]]++;
  }
  scree_free(dealt);
  scree_rng_shuffle(&rng, order, count, sizeof *order);
  return SCREE_OK;
}
