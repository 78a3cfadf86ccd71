/* A place where two facets meet belongs to a feature of each: a corner, an edge or the inside. What
 * lies within the tolerance of a corner belongs to the corner, else what lies within that of an
 * edge to the edge. Points on edges are computed from the edges in the order of their vertices, so
 * that all pairs of facets with the same two edges get the same bits. */
#include "mesh/repair/arrange_sites.h"

#include "base/array.h"
#include "base/radix.h"
#include "mesh/predicates.h"

#include <stdlib.h>

/* Edges nearer to parallel than this (the sine squared) cross nowhere in particular. */
#define PARALLEL 1e-24

static vec3 at(const scree_site_facet *f, int k) {
  return vec3_load(f->p[k % 3]);
}

static bool has_vertex(const scree_site_facet *f, uint32_t v) {
  return f->v[0] == v || f->v[1] == v || f->v[2] == v;
}

static double distance_to_line(vec3 p, vec3 a, vec3 b) {
  vec3 d = vec3_sub(b, a);
  double length = vec3_norm(d);
  return length > 0 ? vec3_norm(vec3_cross(vec3_sub(p, a), d)) / length : vec3_distance(p, a);
}

bool scree_site_is_flat(const double *const p[3], double tolerance, int *longest) {
  double most = -1;
  for (int k = 0; k < 3; k++) {
    double length = vec3_distance(vec3_load(p[k]), vec3_load(p[(k + 1) % 3]));
    if (length > most) most = length, *longest = k;
  }
  int k = *longest;
  return distance_to_line(vec3_load(p[(k + 2) % 3]), vec3_load(p[k]), vec3_load(p[(k + 1) % 3])) <
         tolerance;
}

/* The feature of f that p lies on, or -1. */
static int feature_at(const scree_site_facet *f, vec3 p, double tolerance) {
  for (int k = 0; k < 3; k++)
    if (vec3_distance(p, at(f, k)) < tolerance) return k;
  for (int k = 0; k < 3; k++) {
    vec3 a = at(f, k), b = at(f, k + 1), d = vec3_sub(b, a);
    double along = vec3_dot(vec3_sub(p, a), d);
    if (along > 0 && along < vec3_norm2(d) && distance_to_line(p, a, b) < tolerance)
      return SCREE_SITE_EDGE + k;
  }
  if (f->flat) return -1;
  vec3 n = vec3_unit(vec3_triangle_normal(at(f, 0), at(f, 1), at(f, 2)));
  if (!(fabs(vec3_dot(vec3_sub(p, at(f, 0)), n)) < tolerance)) return -1;
  for (int k = 0; k < 3; k++)
    if (!(vec3_dot(vec3_cross(vec3_sub(at(f, k + 1), at(f, k)), vec3_sub(p, at(f, k))), n) > 0))
      return -1;
  return SCREE_SITE_WITHIN;
}

static void add(scree_site *sites, int *count, vec3 p, uint32_t vertex, int t_feature,
                int u_feature) {
  if (*count == SCREE_SITES) return;
  scree_site *s = &sites[(*count)++];
  vec3_store(s->at, p);
  s->vertex = vertex;
  s->t_feature = (uint8_t)t_feature;
  s->u_feature = (uint8_t)u_feature;
}

static void add_corners(const scree_site_facet *t, const scree_site_facet *u, double tolerance,
                        bool swapped, scree_site *sites, int *count) {
  for (int k = 0; k < 3; k++) {
    int other = -1;
    for (int j = 0; j < 3; j++)
      if (t->v[k] == u->v[j]) other = j;
    bool shared = other >= 0;
    if (shared && swapped) continue; /* known already */
    if (!shared) other = feature_at(u, at(t, k), tolerance);
    if (other < 0) continue;
    if (swapped)
      add(sites, count, at(t, k), t->v[k], other, k);
    else
      add(sites, count, at(t, k), t->v[k], k, other);
  }
}

/* An edge, from its lower vertex to its higher. */
typedef struct line {
  uint32_t low, high;
  vec3 from, to;
} line;

static line line_of(const scree_site_facet *f, int k) {
  uint32_t a = f->v[k], b = f->v[(k + 1) % 3];
  return a < b ? (line){a, b, at(f, k), at(f, k + 1)} : (line){b, a, at(f, k + 1), at(f, k)};
}

/* Where two edges cross, as a point of the first. */
static bool cross_at(line e, line f, double tolerance, vec3 *p) {
  vec3 d = vec3_sub(e.to, e.from), g = vec3_sub(f.to, f.from), w = vec3_sub(f.from, e.from);
  double dd = vec3_norm2(d), gg = vec3_norm2(g), cross = vec3_norm2(vec3_cross(d, g));
  if (!(cross > PARALLEL * dd * gg)) return false;
  vec3 n = vec3_cross(d, g);
  double s = vec3_dot(vec3_cross(w, g), n) / cross, r = vec3_dot(vec3_cross(w, d), n) / cross;
  double margin_s = tolerance / sqrt(dd), margin_r = tolerance / sqrt(gg);
  if (!(s > margin_s && s < 1 - margin_s && r > margin_r && r < 1 - margin_r)) return false;
  *p = vec3_mad(e.from, d, s);
  return vec3_distance(*p, vec3_mad(f.from, g, r)) < tolerance;
}

static void add_crossings(const scree_site_facet *t, const scree_site_facet *u, double tolerance,
                          scree_site *sites, int *count) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      line e = line_of(t, i), f = line_of(u, j);
      if (e.low == f.low || e.low == f.high || e.high == f.low || e.high == f.high) continue;
      bool first = e.low < f.low || (e.low == f.low && e.high < f.high);
      vec3 p;
      if (cross_at(first ? e : f, first ? f : e, tolerance, &p))
        add(sites, count, p, UINT32_MAX, SCREE_SITE_EDGE + i, SCREE_SITE_EDGE + j);
    }
}

/* Whether the line from a to b goes through the inside of f, exactly. */
static bool goes_through(const scree_site_facet *f, const double *a, const double *b) {
  int turn = 0;
  for (int k = 0; k < 3; k++) {
    int side = scree_orient3(a, b, f->p[k], f->p[(k + 1) % 3]);
    if (side == 0 || (turn && side != turn)) return false;
    turn = side;
  }
  return true;
}

/* Edges of t that go through the inside of u. */
static void add_piercings(const scree_site_facet *t, const scree_site_facet *u, double tolerance,
                          bool swapped, scree_site *sites, int *count) {
  int side[3];
  if (u->flat) return;
  for (int k = 0; k < 3; k++) side[k] = scree_orient3(u->p[0], u->p[1], u->p[2], t->p[k]);
  vec3 n = vec3_triangle_normal(at(u, 0), at(u, 1), at(u, 2));
  for (int k = 0; k < 3; k++) {
    int next = (k + 1) % 3;
    if (side[k] * side[next] >= 0 || !goes_through(u, t->p[k], t->p[next])) continue;
    line e = line_of(t, k);
    if (has_vertex(u, e.low) || has_vertex(u, e.high)) continue;
    double from = vec3_dot(n, vec3_sub(e.from, at(u, 0)));
    double to = vec3_dot(n, vec3_sub(e.to, at(u, 0))), margin = tolerance * vec3_norm(n);
    if (fabs(from) < margin && fabs(to) < margin) continue; /* it lies in the plane */
    double share = from != to ? from / (from - to) : 0.5;
    vec3 p = vec3_lerp(e.from, e.to, share < 0 ? 0 : share > 1 ? 1 : share);
    if (vec3_distance(p, e.from) < tolerance || vec3_distance(p, e.to) < tolerance) continue;
    if (feature_at(u, p, tolerance) != SCREE_SITE_WITHIN) continue;
    if (swapped)
      add(sites, count, p, UINT32_MAX, SCREE_SITE_WITHIN, SCREE_SITE_EDGE + k);
    else
      add(sites, count, p, UINT32_MAX, SCREE_SITE_EDGE + k, SCREE_SITE_WITHIN);
  }
}

int scree_sites_find(const scree_site_facet *t, const scree_site_facet *u, double tolerance,
                     scree_site *sites) {
  int count = 0;
  add_corners(t, u, tolerance, false, sites, &count);
  add_corners(u, t, tolerance, true, sites, &count);
  add_crossings(t, u, tolerance, sites, &count);
  add_piercings(t, u, tolerance, false, sites, &count);
  add_piercings(u, t, tolerance, true, sites, &count);
  return count;
}

/* ---- Facets near each other ---- */

/* Whether all corners of u that are none of t's lie beyond the plane of t, on one side. */
static bool is_beyond(const scree_mesh *mesh, uint32_t t, uint32_t u, double tolerance) {
  const uint32_t *v = mesh->triangles + 3 * (size_t)t, *w = mesh->triangles + 3 * (size_t)u;
  vec3 p = scree_mesh_corner(mesh, t, 0);
  vec3 n = vec3_triangle_normal(p, scree_mesh_corner(mesh, t, 1), scree_mesh_corner(mesh, t, 2));
  double margin = tolerance * vec3_norm(n);
  int above = 0, below = 0, shared = 0;
  for (int k = 0; k < 3; k++) {
    if (w[k] == v[0] || w[k] == v[1] || w[k] == v[2]) {
      shared++;
      continue;
    }
    double height = vec3_dot(n, vec3_sub(scree_mesh_corner(mesh, u, k), p));
    above += height > margin;
    below += height < -margin;
  }
  return shared < 3 && (above + shared == 3 || below + shared == 3);
}

/* Whether all corners of u that are none of t's lie beyond one edge of t as seen along t's normal,
 * and those that are t's at its ends: what the pieces of one cut facet are to each other. */
static bool is_beside(const scree_mesh *mesh, uint32_t t, uint32_t u, double tolerance) {
  const uint32_t *v = mesh->triangles + 3 * (size_t)t, *w = mesh->triangles + 3 * (size_t)u;
  vec3 p[3], n;
  for (int k = 0; k < 3; k++) p[k] = scree_mesh_corner(mesh, t, k);
  n = vec3_triangle_normal(p[0], p[1], p[2]);
  for (int k = 0; k < 3; k++) {
    int next = (k + 1) % 3, beyond = 0;
    vec3 inward = vec3_cross(n, vec3_sub(p[next], p[k]));
    double margin = tolerance * vec3_norm(inward);
    for (int j = 0; j < 3; j++)
      beyond += w[j] == v[k] || w[j] == v[next] ||
                (w[j] != v[(k + 2) % 3] &&
                 vec3_dot(inward, vec3_sub(scree_mesh_corner(mesh, u, j), p[k])) < -margin);
    if (beyond == 3) return true;
  }
  return false;
}

static bool list_leaf(const scree_facet_tree *tree, const scree_tree_node *n, uint32_t t,
                      const scree_box *box, double tolerance, scree_facet_pairs *pairs) {
  for (uint32_t i = n->first; i < n->first + n->count; i++) {
    uint32_t u = tree->tree.order[i];
    if (u <= t) continue;
    scree_box other = scree_facet_box(tree->mesh, u);
    if (!scree_box_meets(box, &other) || is_beyond(tree->mesh, t, u, tolerance) ||
        is_beyond(tree->mesh, u, t, tolerance) || is_beside(tree->mesh, t, u, tolerance) ||
        is_beside(tree->mesh, u, t, tolerance))
      continue;
    if (!SCREE_PUSH(pairs, (scree_facet_pair){t, u})) return false;
  }
  return true;
}

SCREE_ORDER_BY2(compare_pairs, scree_facet_pair, first, second)

bool scree_near_pairs(const scree_facet_tree *tree, double tolerance, scree_facet_pairs *pairs) {
  size_t first = pairs->count;
  for (uint32_t t = 0; t < tree->mesh->triangle_count; t++) {
    scree_box grown = scree_box_grown(scree_facet_box(tree->mesh, t), tolerance);
    scree_tree_walk walk;
    scree_tree_start(&walk, &tree->tree);
    for (const scree_tree_node *n; (n = scree_tree_next(&walk));) {
      if (!scree_box_meets(&grown, &n->box) || scree_tree_enter(&walk, n)) continue;
      if (!list_leaf(tree, n, t, &grown, tolerance, pairs)) return false;
    }
  }
  if (pairs->count > first)
    qsort(pairs->items + first, pairs->count - first, sizeof *pairs->items, compare_pairs);
  return true;
}
