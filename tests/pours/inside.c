/* Whether bodies of a world lie in each other, apart from all that the world itself knows: every
 * edge of every triangle of one against every triangle of the other.
 *
 *   inside WORLD...    exit 1 where two bodies lie deeper in each other than 0.5 % of the smaller's
 * size
 *
 * Where an edge passes through triangles the parts that lie inside are followed by points. Their
 * distances from the triangles are brute force. A body without any crossing lies inside where one
 * of its vertices does. */
#include "scree.h"

#include "base/vec.h"

#include <stdio.h>
#include <stdlib.h>

static const double allowed = 0.005; /* of the smaller body's size */
enum { POINTS = 24, MOST_CROSSINGS = 64 };

typedef struct placed {
  const scree_mesh *mesh;
  vec3 *at; /* vertices in space */
  vec3 low, high;
  double size;
} placed;

static vec3 corner_of(const placed *p, size_t triangle, size_t k) {
  return p->at[p->mesh->triangles[3 * triangle + k % 3]];
}

/* Where the segment from a to b passes through a triangle, as a share of it; false for nowhere. */
static bool pierces(vec3 a, vec3 b, const placed *p, size_t triangle, double *share) {
  vec3 o = corner_of(p, triangle, 0), e1 = vec3_sub(corner_of(p, triangle, 1), o),
       e2 = vec3_sub(corner_of(p, triangle, 2), o), d = vec3_sub(b, a), h = vec3_cross(d, e2);
  double det = vec3_dot(e1, h); /* Moeller and Trumbore 1997 */
  if (det == 0) return false;
  vec3 s = vec3_sub(a, o), q = vec3_cross(s, e1);
  double u = vec3_dot(s, h) / det, v = vec3_dot(d, q) / det, t = vec3_dot(e2, q) / det;
  *share = t;
  return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t <= 1;
}

/* By a ray in a direction that no mesh has. */
static bool is_inside(const placed *p, vec3 x) {
  vec3 far = vec3_add(x, (vec3){17.31, 5.77, 11.93});
  size_t passed = 0;
  for (size_t t = 0; t < p->mesh->triangle_count; t++) {
    double share;
    passed += pierces(x, far, p, t, &share);
  }
  return passed % 2;
}

static vec3 closest_on_segment(vec3 a, vec3 b, vec3 x) {
  vec3 d = vec3_sub(b, a);
  double s = vec3_dot(vec3_sub(x, a), d) / vec3_norm2(d);
  return vec3_mad(a, d, s < 0 ? 0 : s > 1 ? 1 : s);
}

static double distance_to(const placed *p, vec3 x) {
  double best = INFINITY;
  for (size_t t = 0; t < p->mesh->triangle_count; t++) {
    vec3 a = corner_of(p, t, 0), u = vec3_sub(corner_of(p, t, 1), a),
         v = vec3_sub(corner_of(p, t, 2), a), n = vec3_unit(vec3_cross(u, v));
    bool over = true; /* it */
    for (size_t k = 0; k < 3; k++) {
      vec3 from = corner_of(p, t, k), to = corner_of(p, t, k + 1);
      over &= vec3_dot(vec3_cross(n, vec3_sub(to, from)), vec3_sub(x, from)) >= 0;
      best = fmin(best, vec3_distance(x, closest_on_segment(from, to, x)));
    }
    if (over) best = fmin(best, fabs(vec3_dot(vec3_sub(x, a), n)));
  }
  return best;
}

static int ascending(const void *x, const void *y) {
  double a = *(const double *)x, b = *(const double *)y;
  return (a > b) - (a < b);
}

static double deepest_on(vec3 a, vec3 b, const placed *in) {
  double cut[MOST_CROSSINGS + 2], deepest = 0;
  size_t count = 0;
  cut[count++] = 0;
  for (size_t t = 0; t < in->mesh->triangle_count && count <= MOST_CROSSINGS; t++)
    count += pierces(a, b, in, t, &cut[count]);
  if (count == 1) return 0;
  cut[count++] = 1;
  qsort(cut, count, sizeof *cut, ascending);
  for (size_t i = 0; i + 1 < count; i++) {
    vec3 way = vec3_sub(b, a), middle = vec3_mad(a, way, 0.5 * (cut[i] + cut[i + 1]));
    if (!is_inside(in, middle)) continue;
    for (int k = 0; k <= POINTS; k++) {
      double share = cut[i] + (cut[i + 1] - cut[i]) * k / POINTS;
      deepest = fmax(deepest, distance_to(in, vec3_mad(a, way, share)));
    }
  }
  return deepest;
}

static bool apart(vec3 low, vec3 high, const placed *p) {
  return low.x > p->high.x || p->low.x > high.x || low.y > p->high.y || p->low.y > high.y ||
         low.z > p->high.z || p->low.z > high.z;
}

static double deepest_in(const placed *of, const placed *in) {
  double deepest = 0;
  for (size_t t = 0; t < of->mesh->triangle_count; t++)
    for (size_t k = 0; k < 3; k++) {
      vec3 a = corner_of(of, t, k), b = corner_of(of, t, k + 1);
      if (!apart(vec3_min(a, b), vec3_max(a, b), in)) deepest = fmax(deepest, deepest_on(a, b, in));
    }
  vec3 first = of->at[0];
  if (deepest == 0 && !apart(first, first, in) && is_inside(in, first))
    deepest = distance_to(in, first);
  return deepest;
}

static bool place(const scree_world *world, size_t body, placed *p) {
  const scree_particle *particle = scree_world_body_particle(world, body);
  scree_particle_measures measures;
  scree_particle_measure(particle, &measures);
  *p = (placed){.mesh = scree_particle_mesh(particle), .size = measures.size};
  if (scree_world_body_removed(world, body) || p->mesh->triangle_count == 0) return true;
  p->at = malloc(p->mesh->vertex_count * sizeof *p->at);
  if (!p->at) return false;
  scree_body state;
  scree_world_get_body(world, body, &state);
  const double *o = state.orientation;
  mat3 rotation = quat_to_mat3((quat){o[0], o[1], o[2], o[3]});
  p->low = (vec3){INFINITY, INFINITY, INFINITY}, p->high = vec3_neg(p->low);
  for (size_t v = 0; v < p->mesh->vertex_count; v++) {
    vec3 x = mat3_mul_vec(&rotation, vec3_load(&p->mesh->positions[3 * v]));
    p->at[v] = vec3_add(x, vec3_load(state.position));
    p->low = vec3_min(p->low, p->at[v]), p->high = vec3_max(p->high, p->at[v]);
  }
  return true;
}

/* How many pairs lie deeper in each other than is allowed. */
static size_t count_pairs(const placed *bodies, size_t count, double *worst) {
  size_t deep = 0;
  for (size_t i = 0; i < count; i++)
    for (size_t j = i + 1; j < count; j++) {
      const placed *a = &bodies[i], *b = &bodies[j];
      if (!a->at || !b->at || apart(a->low, a->high, b)) continue;
      double depth = fmax(deepest_in(a, b), deepest_in(b, a)) / fmin(a->size, b->size);
      *worst = fmax(*worst, depth);
      if (depth > allowed) printf("  bodies %zu and %zu: %.2f %% of the size\n", i, j, 100 * depth);
      deep += depth > allowed;
    }
  return deep;
}

static int look_at(const char *path) {
  scree_error error;
  scree_world *world;
  if (scree_world_load(path, &world, &error)) {
    fprintf(stderr, "inside: %s\n", error.message);
    return 2;
  }
  size_t count = scree_world_body_count(world), deep = 0;
  double worst = 0;
  placed *bodies = calloc(count + 1, sizeof *bodies);
  bool good = bodies != NULL;
  for (size_t i = 0; i < count && good; i++) good = place(world, i, &bodies[i]);
  if (good) deep = count_pairs(bodies, count, &worst);
  for (size_t i = 0; i < count && bodies; i++) free(bodies[i].at);
  free(bodies);
  scree_world_free(world);
  if (!good) fprintf(stderr, "inside: out of memory\n");
  printf("%s: %zu bodies, %zu pairs deeper in each other than %g %%, deepest %.3f %%\n", path,
         count, deep, 100 * allowed, 100 * worst);
  return good ? deep > 0 : 2;
}

int main(int argc, char **argv) {
  int worst = argc < 2 ? 2 : 0;
  for (int i = 1; i < argc; i++) {
    int status = look_at(argv[i]);
    if (status > worst) worst = status;
  }
  return worst;
}
