/* Which part of a surface may be far from another: down its tree, past all boxes of which no point
 * can be farther than asked for. The distance changes no faster than the position, so that nothing
 * in a box is farther than its middle and half its diagonal. */
#include "base/array.h"
#include "mesh/measure/surface.h"
#include "mesh/mesh.h"

typedef SCREE_LIST(uint32_t) facet_list;

static bool may_be_farther(const scree_box *box, const scree_surface *to, double than,
                           uint32_t *near) {
  double middle = scree_surface_nearest(to, vec3_lerp(box->low, box->high, 0.5), near);
  return middle + vec3_distance(box->low, box->high) / 2 > than;
}

static scree_status list_facets(const scree_surface *from, const scree_surface *to, double than,
                                facet_list *facets, scree_error *error) {
  uint32_t near = 0;
  scree_tree_walk walk;
  scree_tree_start(&walk, &from->bvh.tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    if (!may_be_farther(&node->box, to, than, &near) || scree_tree_enter(&walk, node)) continue;
    for (uint32_t i = node->first; i < node->first + node->count; i++)
      SCREE_TRY_PUSH(facets, error, i);
  }
  return SCREE_OK;
}

scree_status scree_surface_farther_part(const scree_surface *from, const scree_surface *to,
                                        double than, scree_mesh *part, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) facet_list facets = {0};
  SCREE_TRY(list_facets(from, to, than, &facets, error));
  SCREE_TRY(scree_mesh_make(3 * facets.count, facets.count, part, error));
  for (size_t i = 0; i < facets.count; i++) {
    scree_bvh_corners(&from->bvh, facets.items[i], part->positions + 9 * i);
    for (size_t k = 3 * i; k < 3 * i + 3; k++) part->triangles[k] = (uint32_t)k;
  }
  return SCREE_OK;
}
