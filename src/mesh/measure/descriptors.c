/* Shape descriptors as people report them of grains.
 *
 * Elongation and flatness are ratios of the sides of the least-volume box, and Zingg's classes
 * (1935) part at 2/3. Curvatures are those of the polyhedron at its vertices (Meyer et al. 2003):
 * the integral of the mean curvature at a vertex is a quarter of the sum of l theta over its edges,
 * with l the length and theta the turn of the normal, that of the Gaussian curvature is the missing
 * angle.
 *
 * The smallest ball around: the farthest point joins the points that hold the ball, until none is
 * outside (a dual simplex method on at most four points). The largest ball inside: cubes are
 * halved, the one with the largest bound first, until the bound is near or, where a whole region
 * holds the centres of equal balls, enough were seen; then the best climbs to the top nearby. Which
 * cubes are inside is told by the winding number, summed over a tree in which far nodes count as
 * one dipole each (Barill et al. 2018, "Fast winding numbers for soups and clouds"). */
#include "base/array.h"
#include "mesh/adjacency.h"
#include "mesh/index/bvh.h"
#include "mesh/measure/bounds.h"
#include "mesh/measure/solid_angle.h"

#include <string.h>

static const double pi = 3.14159265358979323846;
static const double zingg_limit = 2. / 3;
static const double inscribed_accuracy = 2e-3; /* of the radius, before it climbs */
enum { MOST_CUBES = 4000, MOST_PIVOTS = 1000, CLIMB_HALVINGS = 24 };

/* ---- The smallest ball around points ---- */

typedef struct ball {
  vec3 centre;
  double radius2;
} ball;

/* The smallest ball with all of these up to four points on its surface; false: there is none. */
static bool ball_through(const vec3 *p, size_t count, ball *b) {
  double m[3][4] = {{0}};
  vec3 side[3];
  size_t n = count - 1;
  for (size_t i = 0; i < n; i++) side[i] = vec3_sub(p[i + 1], p[0]);
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 0; k < n; k++) m[i][k] = 2 * vec3_dot(side[i], side[k]);
    m[i][3] = vec3_dot(side[i], side[i]);
  }
  for (size_t i = 0; i < n; i++) { /* Gram's matrix: no pivots */
    if (!(m[i][i] > 1e-12 * m[i][3])) return false;
    for (size_t k = 0; k < n; k++) {
      if (k == i) continue;
      double f = m[k][i] / m[i][i];
      for (size_t c = 0; c < 4; c++) m[k][c] -= f * m[i][c];
    }
  }
  vec3 to = {0, 0, 0};
  for (size_t i = 0; i < n; i++) to = vec3_mad(to, side[i], m[i][3] / m[i][i]);
  *b = (ball){vec3_add(p[0], to), vec3_dot(to, to)};
  return true;
}

static bool holds(const ball *b, vec3 p) {
  vec3 d = vec3_sub(p, b->centre);
  return vec3_dot(d, d) <= b->radius2 * (1 + 1e-12);
}

/* The smallest ball around up to five points, and which hold it. */
static ball ball_around(vec3 *points, size_t *count) {
  ball best = {points[0], INFINITY};
  vec3 kept[4];
  size_t kept_count = 0;
  for (unsigned set = 1; set < 1u << *count; set++) {
    vec3 chosen[5];
    size_t number = 0;
    for (size_t i = 0; i < *count; i++)
      if (set >> i & 1) chosen[number++] = points[i];
    ball b;
    if (number > 4 || !ball_through(chosen, number, &b) || b.radius2 >= best.radius2) continue;
    bool all = true;
    for (size_t i = 0; i < *count && all; i++) all = holds(&b, points[i]);
    if (!all) continue;
    best = b;
    kept_count = number;
    memcpy(kept, chosen, number * sizeof *kept);
  }
  if (kept_count > 0) memcpy(points, kept, kept_count * sizeof *points);
  if (kept_count > 0) *count = kept_count;
  return best;
}

static size_t farthest_vertex(const scree_mesh *mesh, vec3 from) {
  size_t best = 0;
  double best2 = -1;
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
    vec3 d = vec3_sub(scree_mesh_corner(mesh, c / 3, (int)(c % 3)), from);
    if (vec3_dot(d, d) > best2) best2 = vec3_dot(d, d), best = mesh->triangles[c];
  }
  return best;
}

static ball bounding_ball(const scree_mesh *mesh) {
  vec3 points[5];
  size_t count = 1;
  points[0] = scree_mesh_corner(mesh, 0, 0);
  ball b = {points[0], 0};
  for (int i = 0; i < MOST_PIVOTS; i++) {
    vec3 far = vec3_load(mesh->positions + 3 * farthest_vertex(mesh, b.centre));
    if (holds(&b, far) || count > 4) break;
    points[count++] = far;
    b = ball_around(points, &count);
  }
  return b;
}

/* ---- What is inside ---- */

/* A node's facets as one: what they have of area along each axis, where, and how far they reach. */
typedef struct dipole {
  vec3 moment, centre;
  double area, reach;
} dipole;

typedef struct inside_tree {
  scree_bvh bvh;
  dipole *dipoles; /* of its nodes */
} inside_tree;

static void inside_tree_free(inside_tree *t) {
  scree_bvh_free(&t->bvh);
  scree_free(t->dipoles);
}

/* The centre is a sum, weighted by area, until all are in. */
static void add_to_dipole(dipole *to, vec3 moment, vec3 centre, double area) {
  to->moment = vec3_add(to->moment, moment);
  to->centre = vec3_mad(to->centre, centre, area);
  to->area += area;
}

static dipole dipole_of(const inside_tree *t, const scree_tree_node *node) {
  dipole d = {.area = 0};
  for (uint32_t i = node->first; node->count && i < node->first + node->count; i++) {
    vec3 normal = vec3_scale(scree_facet_normal(&t->bvh.mesh, i), 0.5), sum = {0, 0, 0};
    for (int k = 0; k < 3; k++) sum = vec3_add(sum, scree_mesh_corner(&t->bvh.mesh, i, k));
    add_to_dipole(&d, normal, vec3_scale(sum, 1. / 3), vec3_norm(normal));
  }
  for (uint32_t k = 0; !node->count && k < 2; k++) {
    const dipole *part = &t->dipoles[node->first + k];
    add_to_dipole(&d, part->moment, part->centre, part->area);
  }
  d.centre = d.area > 0 ? vec3_scale(d.centre, 1 / d.area) : node->box.low;
  for (int corner = 0; corner < 8; corner++) {
    const vec3 *low = &node->box.low, *high = &node->box.high;
    vec3 at = {corner & 1 ? low->x : high->x, corner & 2 ? low->y : high->y,
               corner & 4 ? low->z : high->z};
    d.reach = fmax(d.reach, vec3_distance(at, d.centre));
  }
  return d;
}

static scree_status inside_tree_build(const scree_mesh *mesh, inside_tree *t, scree_error *error) {
  SCREE_TRY(scree_bvh_build(mesh, &t->bvh, error));
  SCREE_TRY_ALLOC(t->dipoles, t->bvh.tree.node_count, error);
  for (size_t n = t->bvh.tree.node_count; n-- > 0;) /* children lie behind their parent */
    t->dipoles[n] = dipole_of(t, &t->bvh.tree.nodes[n]);
  return SCREE_OK;
}

static bool is_inside(const inside_tree *t, vec3 p) {
  static const double FAR = 2; /* of the reach: a dipole is within some per cent */
  double angle = 0;
  scree_tree_walk walk;
  scree_tree_start(&walk, &t->bvh.tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    const dipole *d = &t->dipoles[node - t->bvh.tree.nodes];
    vec3 way = vec3_sub(d->centre, p);
    double far = vec3_norm(way);
    if (far > FAR * d->reach)
      angle += vec3_dot(d->moment, way) / (far * far * far);
    else if (!scree_tree_enter(&walk, node))
      angle += 4 * pi * scree_winding_about(&t->bvh.mesh, node->first, node->count, p);
  }
  return angle > 2 * pi;
}

/* ---- The largest ball inside ---- */

typedef struct cube {
  vec3 centre;
  double half, bound; /* no point in it is farther from the surface */
  bool inside;        /* as a whole */
} cube;

typedef struct cubes {
  cube *items;
  size_t count, capacity;
} cubes;

static void sift_down(cubes *h, size_t i) {
  for (;;) {
    size_t child = 2 * i + 1;
    if (child >= h->count) return;
    if (child + 1 < h->count && h->items[child + 1].bound > h->items[child].bound) child++;
    if (h->items[child].bound <= h->items[i].bound) return;
    cube moved = h->items[i];
    h->items[i] = h->items[child];
    h->items[child] = moved;
    i = child;
  }
}

static bool push_cube(cubes *h, cube c) {
  if (!SCREE_PUSH(h, c)) return false;
  for (size_t i = h->count - 1; i > 0 && h->items[(i - 1) / 2].bound < h->items[i].bound;
       i = (i - 1) / 2) {
    cube moved = h->items[i];
    h->items[i] = h->items[(i - 1) / 2];
    h->items[(i - 1) / 2] = moved;
  }
  return true;
}

static cube pop_cube(cubes *h) {
  cube top = h->items[0];
  h->items[0] = h->items[--h->count];
  sift_down(h, 0);
  return top;
}

static double distance_from(const scree_bvh *tree, vec3 p) {
  scree_bvh_hit hit = {.distance2 = INFINITY};
  scree_bvh_closest(tree, p, &hit);
  return sqrt(hit.distance2);
}

/* Looks at a cube: a better ball at its middle, and whether it may hold a better one still. */
static bool look(const inside_tree *tree, cube c, cubes *heap, ball *best) {
  double d = distance_from(&tree->bvh, c.centre), radius = sqrt(best->radius2),
         reach = c.half * sqrt(3);
  if (!c.inside && d > reach) { /* the surface does not pass through it */
    c.inside = is_inside(tree, c.centre);
    if (!c.inside) return true;
  }
  c.bound = d + reach;
  if (d > radius && (c.inside || is_inside(tree, c.centre))) *best = (ball){c.centre, d * d};
  return c.bound <= radius * (1 + inscribed_accuracy) || push_cube(heap, c);
}

/* Along the axes by halved steps. A step within the ball stays inside the body. */
static void climb(const scree_bvh *tree, ball *best) {
  double radius = sqrt(best->radius2), step = radius / 4;
  for (int halvings = 0; halvings < CLIMB_HALVINGS;) {
    bool moved = false;
    for (int k = 0; k < 6; k++) {
      double way = k % 2 ? -step : step;
      vec3 next = vec3_add(
          best->centre, (vec3){k / 2 == 0 ? way : 0, k / 2 == 1 ? way : 0, k / 2 == 2 ? way : 0});
      double d = distance_from(tree, next);
      if (d <= radius) continue;
      radius = d;
      best->centre = next;
      moved = true;
    }
    if (!moved) halvings++, step /= 2;
  }
  best->radius2 = radius * radius;
}

static scree_status inscribed_ball(const scree_mesh *mesh, ball *best, scree_error *error) {
  SCREE_CLEANUP(inside_tree_free) inside_tree tree = {0};
  cubes heap = {0};
  vec3 low, high;
  SCREE_TRY(inside_tree_build(mesh, &tree, error));
  scree_mesh_bounds(mesh, &low, &high);
  vec3 size = vec3_sub(high, low);
  double half = 0.5 * fmax(size.x, fmax(size.y, size.z));
  *best = (ball){vec3_lerp(low, high, 0.5), 0};
  bool ok = look(&tree, (cube){best->centre, half, INFINITY, false}, &heap, best);
  for (size_t n = 0; ok && heap.count > 0 && n < MOST_CUBES; n++) {
    cube c = pop_cube(&heap);
    if (c.bound <= sqrt(best->radius2) * (1 + inscribed_accuracy)) break;
    for (int i = 0; ok && i < 8; i++) {
      double h = c.half / 2;
      vec3 way = {i & 1 ? h : -h, i & 2 ? h : -h, i & 4 ? h : -h};
      ok = look(&tree, (cube){vec3_add(c.centre, way), h, INFINITY, c.inside}, &heap, best);
    }
  }
  if (ok) climb(&tree.bvh, best);
  scree_free(heap.items);
  return ok ? SCREE_OK : scree_fail_memory(error, 0, "the largest ball inside");
}

/* ---- Curvature ---- */

/* Sums at a vertex: area, integral of the mean curvature, angles of its facets. */
typedef struct corner {
  double area, mean, angle;
} corner;

static void add_facets(const scree_mesh *mesh, corner *corners) {
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    double area = vec3_norm(scree_facet_normal(mesh, t)) / 2;
    for (int k = 0; k < 3; k++) {
      vec3 p = scree_mesh_corner(mesh, t, k),
           a = vec3_sub(scree_mesh_corner(mesh, t, (k + 1) % 3), p),
           b = vec3_sub(scree_mesh_corner(mesh, t, (k + 2) % 3), p);
      corner *c = &corners[mesh->triangles[3 * t + (size_t)k]];
      c->area += area / 3;
      c->angle += atan2(vec3_norm(vec3_cross(a, b)), vec3_dot(a, b));
    }
  }
}

/* Half-edge h and its twin g: positive where the surface is convex. */
static void add_edge(const scree_mesh *mesh, uint32_t h, uint32_t g, corner *corners) {
  vec3 m = scree_facet_normal(mesh, h / 3), n = scree_facet_normal(mesh, g / 3);
  vec3 along = vec3_sub(
      scree_mesh_corner(mesh, scree_half_edge_next(h) / 3, (int)(scree_half_edge_next(h) % 3)),
      scree_mesh_corner(mesh, h / 3, (int)(h % 3)));
  double length = vec3_norm(along);
  vec3 turn = vec3_cross(m, n);
  if (!(length > 0)) return;
  double angle = atan2(vec3_dot(turn, along) / length, vec3_dot(m, n));
  corners[scree_half_edge_from(mesh, h)].mean += length * angle / 4;
  corners[scree_half_edge_to(mesh, h)].mean += length * angle / 4;
}

static scree_status sum_corners(const scree_mesh *mesh, corner *corners, scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_TRY(scree_adjacency_build(mesh, &adjacency, error));
  add_facets(mesh, corners);
  for (size_t e = 0; e < adjacency.edge_count; e++) {
    uint32_t h = adjacency.edges[e], g = adjacency.ring[h];
    if (g != h && adjacency.ring[g] == h) add_edge(mesh, h, g, corners);
  }
  return SCREE_OK;
}

static void set_curvatures(const corner *corners, size_t count, scree_descriptors *d) {
  double willmore = 0, area = 0, round = 0, inner = 1 / d->inscribed_radius;
  for (size_t v = 0; v < count; v++) {
    const corner *c = &corners[v];
    if (!(c->area > 0)) continue;
    double mean = c->mean / c->area, gauss = (2 * pi - c->angle) / c->area;
    double largest = mean + sqrt(fmax(mean * mean - gauss, 0));
    willmore += c->mean * mean;
    if (!(largest > inner)) continue;
    area += c->area;
    round += c->area * inner / largest;
  }
  d->angularity = willmore / (4 * pi);
  d->roundness = area > 0 ? round / area : 1;
}

const char *scree_zingg_name(scree_zingg zingg) {
  static const char *const names[] = {"equant", "oblate", "prolate", "bladed"};
  return (size_t)zingg < sizeof names / sizeof *names ? names[zingg] : NULL;
}

static void set_form(const scree_measures *m, scree_descriptors *d) {
  const double *size = m->oriented_dimensions;
  d->elongation = size[1] / size[0];
  d->flatness = size[2] / size[1];
  bool thick = d->flatness > zingg_limit, wide = d->elongation > zingg_limit;
  d->zingg = thick && wide ? SCREE_EQUANT
             : wide        ? SCREE_OBLATE
             : thick       ? SCREE_PROLATE
                           : SCREE_BLADED;
  d->krumbein_sphericity = cbrt(size[1] * size[2] / (size[0] * size[0]));
}

scree_status scree_mesh_describe(const scree_mesh *mesh, const scree_measures *measures,
                                 scree_descriptors *descriptors, scree_error *error) {
  scree_descriptors d = {0};
  ball inside;
  SCREE_TRY(scree_mesh_verify(mesh, error));
  if (!measures->closed || measures->inward || !measures->has_volume)
    return scree_fail(error, SCREE_BAD_MESH,
                      "the surface is %s: a body's shape is that of a closed surface; `scree "
                      "repair` may help",
                      measures->inward ? "inside out" : "not closed");
  ball around = bounding_ball(mesh);
  d.bounding_radius = sqrt(around.radius2);
  vec3_store(d.bounding_centre, around.centre);
  set_form(measures, &d);
  SCREE_TRY(inscribed_ball(mesh, &inside, error));
  d.inscribed_radius = sqrt(inside.radius2);
  vec3_store(d.inscribed_centre, inside.centre);
  SCREE_SCRATCH_ZERO(corner, corners, mesh->vertex_count, error);
  SCREE_TRY(sum_corners(mesh, corners, error));
  set_curvatures(corners, mesh->vertex_count, &d);
  *descriptors = d;
  return SCREE_OK;
}
