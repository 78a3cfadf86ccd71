/* The tree splits by area. Nearest-point queries go down the nearer child first and skip boxes
 * farther than the best found. Rays: boxes by slabs (Kay and Kajiya 1986), triangles by Moller and
 * Trumbore (1997). */
#include "mesh/index/bvh.h"

#include "base/alloc.h"
#include "mesh/mesh.h"

enum { LEAF = 4 };

static scree_status copy_mesh(const scree_mesh *mesh, const uint32_t *order, scree_mesh *copy,
                              scree_error *error) {
  size_t corner_count = 3 * mesh->triangle_count;
  SCREE_SCRATCH(uint32_t, number, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(copy->triangles, corner_count, error);
  memset(number, 0xff, mesh->vertex_count * sizeof *number);
  for (size_t c = 0; c < corner_count; c++) {
    uint32_t *v = &number[mesh->triangles[3 * (size_t)order[c / 3] + c % 3]];
    if (*v == UINT32_MAX) *v = (uint32_t)copy->vertex_count++;
    copy->triangles[c] = *v;
  }
  copy->triangle_count = mesh->triangle_count;
  SCREE_TRY_ALLOC(copy->positions, 3 * copy->vertex_count, error);
  for (size_t v = 0; v < mesh->vertex_count; v++)
    if (number[v] != UINT32_MAX)
      memcpy(copy->positions + 3 * (size_t)number[v], mesh->positions + 3 * v,
             3 * sizeof *mesh->positions);
  return SCREE_OK;
}

scree_status scree_bvh_build(const scree_mesh *mesh, scree_bvh *bvh, scree_error *error) {
  const scree_boxed triangles = {mesh->triangle_count, scree_box_of_facet, mesh, LEAF,
                                 SCREE_SPLIT_AREA};
  SCREE_CLEANUP(scree_bvh_free) scree_bvh made = {0};
  SCREE_TRY(scree_tree_build(&triangles, &made.tree, error));
  SCREE_TRY(copy_mesh(mesh, made.tree.order, &made.mesh, error));
  *bvh = made;
  memset(&made, 0, sizeof made); /* it is the caller's now */
  return SCREE_OK;
}

void scree_bvh_free(scree_bvh *bvh) {
  if (!bvh) return;
  scree_tree_free(&bvh->tree);
  scree_mesh_free(&bvh->mesh);
  *bvh = (scree_bvh){0};
}

bool scree_bvh_closest(const scree_bvh *bvh, vec3 p, scree_bvh_hit *hit) {
  bool found = false;
  scree_tree_search search;
  if (bvh->tree.item_count == 0) return false;
  scree_tree_search_below(&search, &bvh->tree, 0, p);
  for (const scree_tree_node *leaf; (leaf = scree_tree_nearer(&search, hit->distance2));)
    for (uint32_t i = leaf->first; i < leaf->first + leaf->count; i++) {
      vec3 point;
      double corners[9];
      scree_bvh_corners(bvh, i, corners);
      double distance2 = scree_triangle_closest(corners, p, &point);
      if (distance2 >= hit->distance2) continue;
      *hit = (scree_bvh_hit){distance2, point, i};
      found = true;
    }
  return found;
}

/* ---- Rays ---- */

/* How far, in barycentric coordinates, a ray may pass beside a triangle and still meet it: so that
 * rounding leaves no gap between neighbours. */
static const double RIM = 1e-9;

/* The distance to one triangle, INFINITY beside it; *normal is along its outward one. */
static double meet_triangle(vec3 from, vec3 along, const double *corners, vec3 *normal) {
  vec3 origin = vec3_load(corners), e = vec3_sub(vec3_load(corners + 3), origin),
       f = vec3_sub(vec3_load(corners + 6), origin), h = vec3_cross(along, f);
  double det = vec3_dot(e, h);
  if (det == 0) return INFINITY;
  vec3 g = vec3_sub(from, origin), q = vec3_cross(g, e);
  double u = vec3_dot(g, h) / det, v = vec3_dot(along, q) / det;
  if (!(u >= -RIM && v >= -RIM && u + v <= 1 + RIM)) return INFINITY;
  *normal = vec3_cross(e, f);
  return vec3_dot(f, q) / det;
}

double scree_ray_meet(const scree_bvh *bvh, vec3 from, vec3 along, double least, double *facing) {
  double nearest = INFINITY;
  scree_tree_walk walk;
  scree_tree_start(&walk, &bvh->tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    double low = least, high = nearest;
    if (!scree_box_cut(&node->box, from, along, &low, &high) || scree_tree_enter(&walk, node))
      continue;
    for (uint32_t i = node->first; i < node->first + node->count; i++) {
      vec3 normal = {0, 0, 0};
      double corners[9];
      scree_bvh_corners(bvh, i, corners);
      double t = meet_triangle(from, along, corners, &normal);
      if (!(t > least && t < nearest)) continue;
      nearest = t;
      *facing = vec3_dot(vec3_unit(normal), along);
    }
  }
  return nearest;
}
