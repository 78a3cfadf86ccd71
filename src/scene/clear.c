/* Whether a body that is placed is clear of all walls. */
#include "particle/closest.h"
#include "scene/scene.h"

static bool clear_of_plane(const scree_wall *wall, const scree_placement *p) {
  double up, down;
  vec3 n = vec3_unit(vec3_load(wall->axis));
  scree_placement_reach(p, n, &up, &down);
  return vec3_dot(n, vec3_sub(p->position, vec3_load(wall->position))) > down;
}

static bool clear_of_disc(const scree_wall *wall, const scree_placement *p) {
  double up, down;
  vec3 n = vec3_unit(vec3_load(wall->axis)), d = vec3_sub(p->position, vec3_load(wall->position));
  double height = vec3_dot(n, d), away = vec3_norm(vec3_mad(d, n, -height));
  scree_placement_reach(p, n, &up, &down);
  return height > down || -height > up || away > wall->radius + p->radius;
}

static bool clear_of_cylinder(const scree_wall *wall, const scree_placement *p) {
  vec3 axis = vec3_unit(vec3_load(wall->axis)), from = vec3_load(wall->position);
  vec3 d = vec3_sub(p->position, from);
  double along = vec3_dot(d, axis), away = vec3_norm(vec3_mad(d, axis, -along));
  if (wall->length > 0 && (along < -p->radius || along > wall->length + p->radius)) return true;
  return away > wall->radius + p->radius || scree_placement_within(p, from, axis, wall->radius);
}

/* Whether a plane lies between the box, in its own frame, and the triangle: the thirteen candidates
 * of the separating axis theorem (Akenine-Moeller 2001). */
static bool box_clear_of_triangle(const vec3 c[3], vec3 half) {
  const double h[3] = {half.x, half.y, half.z};
  vec3 axes[13] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, vec3_triangle_normal(c[0], c[1], c[2])};
  for (int e = 0; e < 3; e++)
    for (int k = 0; k < 3; k++)
      axes[4 + 3 * e + k] = vec3_cross(axes[k], vec3_sub(c[(e + 1) % 3], c[e]));
  for (int i = 0; i < 13; i++) {
    double reach = h[0] * fabs(axes[i].x) + h[1] * fabs(axes[i].y) + h[2] * fabs(axes[i].z);
    double a = vec3_dot(axes[i], c[0]), b = vec3_dot(axes[i], c[1]), d = vec3_dot(axes[i], c[2]);
    if (fmin(a, fmin(b, d)) > reach || fmax(a, fmax(b, d)) < -reach) return true;
  }
  return false;
}

static bool box_clear_of_face(const scree_oriented_box *box, const scree_face *face) {
  const vec3 c[3] = {face->corner, vec3_add(face->corner, face->along1),
                     vec3_add(face->corner, face->along2)};
  vec3 seen[3];
  for (int i = 0; i < 3; i++) seen[i] = mat3_tmul_vec(&box->axes, vec3_sub(c[i], box->centre));
  return box_clear_of_triangle(seen, box->half);
}

/* Whether the box, in the surface's frame, is clear of its faces. */
static bool box_clear_of_faces(const scree_oriented_box *box, const scree_particle *surface) {
  const scree_tree *tree = &surface->face_tree;
  const scree_box own = {vec3_neg(box->half), box->half};
  const scree_box around = scree_box_moved(&own, &box->axes, box->centre);
  scree_tree_walk walk;
  scree_tree_start(&walk, tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    if (!scree_box_meets(&node->box, &around) || scree_tree_enter(&walk, node)) continue;
    for (uint32_t i = 0; i < node->count; i++)
      if (!box_clear_of_face(box, &surface->faces[tree->order[node->first + i]])) return false;
  }
  return true;
}

static bool clear_of_mesh(const scree_world_wall *wall, const scree_placement *p) {
  const mat3 *turn = &wall->frame.rotation;
  vec3 at = wall->frame.position, centre = mat3_tmul_vec(turn, vec3_sub(p->position, at));
  scree_oriented_box box = {mat3_tmul_vec(turn, vec3_sub(p->box.centre, at)), p->box.half,
                            mat3_tmul(turn, &p->box.axes)};
  if (scree_is_near(wall->surface, centre, p->radius) && !box_clear_of_faces(&box, wall->surface))
    return false;
  return wall->surface->sheet || !scree_is_inside(wall->surface, centre);
}

bool scree_scene_is_clear(const scree_scene *scene, const scree_placement *placement,
                          size_t *blocking) {
  for (size_t w = 0; w < scree_world_wall_count(scene->world); w++) {
    scree_wall wall;
    bool clear = true;
    scree_world_get_wall(scene->world, w, &wall);
    if (wall.kind == SCREE_WALL_PLANE) clear = clear_of_plane(&wall, placement);
    if (wall.kind == SCREE_WALL_DISC) clear = clear_of_disc(&wall, placement);
    if (wall.kind == SCREE_WALL_CYLINDER) clear = clear_of_cylinder(&wall, placement);
    if (wall.kind == SCREE_WALL_MESH)
      clear = clear_of_mesh(scree_world_wall_at(scene->world, w), placement);
    *blocking = w;
    if (!clear) return false;
  }
  return true;
}
