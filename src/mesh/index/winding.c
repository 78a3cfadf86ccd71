/* The line through the point along the axis is followed through the tree. Facets are told to
 * contain the point, seen along the axis, by exact predicates, and to lie before or behind it by
 * plain arithmetic; where that is too close, by exact predicates again, or by nobody. Facets that
 * lie in the plane of the one asked are told by the caller and count together. */
#include "mesh/index/winding.h"

#include "mesh/predicates.h"

#include <math.h>

/* Heights that differ by less than this share of the largest coordinate may be in either order. */
#define HEIGHT_ROUNDING 1e-13

double scree_winding_rounding(const scree_facet_tree *tree) {
  const scree_box *box = &tree->tree.nodes[0].box;
  vec3 reach = vec3_max(vec3_neg(box->low), box->high);
  double largest = fmax(0, fmax(reach.x, fmax(reach.y, reach.z)));
  return HEIGHT_ROUNDING * largest;
}

static const double *corner_of(const scree_mesh *mesh, uint32_t facet, int k) {
  return mesh->positions + 3 * (size_t)mesh->triangles[3 * (size_t)facet + (size_t)k];
}

static int seen_side(const scree_view *f) {
  double p[3][2];
  for (int k = 0; k < 3; k++) p[k][0] = f->corner[k][f->u], p[k][1] = f->corner[k][f->v];
  return scree_orient2(p[0], p[1], p[2]);
}

scree_view scree_view_of_corners(const double *a, const double *b, const double *c) {
  scree_view f = {.corner = {a, b, c}};
  vec3 n =
      vec3_triangle_normal(vec3_load(f.corner[0]), vec3_load(f.corner[1]), vec3_load(f.corner[2]));
  f.axis = vec3_greatest(vec3_abs(n));
  f.u = (f.axis + 1) % 3;
  f.v = (f.axis + 2) % 3;
  f.side = seen_side(&f);
  return f;
}

double scree_view_height(const scree_view *f, scree_seen p) {
  const double *a = f->corner[0], *b = f->corner[1], *c = f->corner[2];
  double bx = b[f->u] - a[f->u], by = b[f->v] - a[f->v], cx = c[f->u] - a[f->u],
         cy = c[f->v] - a[f->v], px = p.x - a[f->u], py = p.y - a[f->v];
  double det = bx * cy - by * cx, s = (px * cy - py * cx) / det, t = (bx * py - by * px) / det;
  return a[f->axis] + s * (b[f->axis] - a[f->axis]) + t * (c[f->axis] - a[f->axis]);
}

scree_view scree_view_of(const scree_mesh *mesh, uint32_t facet) {
  return scree_view_of_corners(corner_of(mesh, facet, 0), corner_of(mesh, facet, 1),
                               corner_of(mesh, facet, 2));
}

/* +1 or -1: the facet covers (x, y) as seen along f's axis, its normal along or against it; 0: it
 * does not; 2: the point lies on its rim. */
static int covers(const scree_view *f, const scree_mesh *mesh, uint32_t facet, scree_seen p) {
  double seen[3][2];
  const double at[2] = {p.x, p.y};
  for (int k = 0; k < 3; k++) {
    const double *c = corner_of(mesh, facet, k);
    seen[k][0] = c[f->u], seen[k][1] = c[f->v];
  }
  int s[3];
  for (int k = 0; k < 3; k++) s[k] = scree_orient2(seen[k], seen[(k + 1) % 3], at);
  bool left = s[0] >= 0 && s[1] >= 0 && s[2] >= 0, right = s[0] <= 0 && s[1] <= 0 && s[2] <= 0;
  if (!left && !right) return 0;
  if (s[0] && s[1] && s[2]) return s[0];
  /* a facet seen edge on covers nothing, but may hide behind its rim */
  return scree_orient2(seen[0], seen[1], seen[2]) ? 2 : 0;
}

static bool in_plane(const scree_winding *w, uint32_t facet, uint32_t other) {
  if (facet == other) return true;
  if (!w->partners) return false;
  for (uint32_t i = w->first[facet]; i < w->first[facet + 1]; i++)
    if (w->partners[i] == (other << 1 | 1)) return true;
  return false;
}

int scree_view_side_of(const scree_view *t, const scree_view *u) {
  int above = 0, below = 0;
  for (int k = 0; k < 3; k++) {
    int side = scree_orient3(t->corner[0], t->corner[1], t->corner[2], u->corner[k]);
    above += side > 0;
    below += side < 0;
  }
  return above && below ? 0 : above ? 1 : -1;
}

/* Whether g, which covers p like f, lies above it along the axis: +1, -1; 0: nobody can tell.
 * g_side is that of its normal along the axis. */
static int order_at(const scree_winding *w, const scree_view *f, const scree_view *g, int g_side,
                    scree_seen p) {
  double height = scree_view_height(f, p), other = scree_view_height(g, p);
  vec3 n = vec3_triangle_normal(vec3_load(g->corner[0]), vec3_load(g->corner[1]),
                                vec3_load(g->corner[2]));
  double upright = fabs(vec3_along(n, f->axis));
  double rounding = w->rounding * (1 + vec3_norm(n) / upright);
  if (other > height + rounding) return 1;
  if (other < height - rounding) return -1;
  int side = scree_view_side_of(f, g);
  return side ? side * f->side : -scree_view_side_of(g, f) * g_side;
}

/* Whether the line through p along f's axis meets the box. */
static bool is_over(const scree_box *box, const scree_view *f, scree_seen p) {
  const double *low = &box->low.x, *high = &box->high.x;
  return low[f->u] <= p.x && high[f->u] >= p.x && low[f->v] <= p.y && high[f->v] >= p.y;
}

bool scree_winding_look(const scree_winding *w, uint32_t facet, const scree_view *f, scree_seen p,
                        scree_sides *found) {
  const scree_tree *tree = &w->tree->tree;
  int in = 0;
  scree_tree_walk walk;
  *found = (scree_sides){.owner = true};
  scree_tree_start(&walk, tree);
  for (const scree_tree_node *n; (n = scree_tree_next(&walk));) {
    if (!is_over(&n->box, f, p) || scree_tree_enter(&walk, n)) continue;
    for (uint32_t i = n->first; i < n->first + n->count; i++) {
      uint32_t other = tree->order[i];
      int side = covers(f, w->tree->mesh, other, p);
      if (side == 2) return false;
      if (!side) continue;
      int count = w->weights ? side * w->weights[other] : side;
      scree_view g = *f;
      for (int k = 0; k < 3; k++) g.corner[k] = corner_of(w->tree->mesh, other, k);
      if (in_plane(w, facet, other)) {
        in += count;
        if (other < facet) found->owner = false;
        continue;
      }
      int order = order_at(w, f, &g, side, p);
      if (!order) return false;
      if (order > 0) found->above += count;
    }
  }
  found->below = found->above + in;
  return true;
}
