/* How far a point is from a wall.
 *
 * A wall's frame has its origin in `position` and its z axis along `axis`. Distances are signed,
 * positive on the side of the bodies. A plane is solid behind; discs and cylinders are sheets, met
 * from either side: a point belongs to the side where it was last seen clear of the sheet. */
#include "world/state/walls.h"

#include "particle/closest.h"

static const double square_flank = 1e-6; /* sine squared: a belt's flank, which stands */

vec3 scree_belt_velocity(const scree_world_wall *wall, vec3 at, vec3 n) {
  vec3 v = vec3_add(wall->surface_velocity, vec3_cross(wall->surface_spin, at));
  const double speed2 = vec3_norm2(wall->surface_loop);
  v = vec3_mad(v, n, -vec3_dot(v, n));
  if (!(speed2 > 0)) return v;
  vec3 way = vec3_cross(wall->surface_loop, n);
  const double sine2 = vec3_norm2(way) / speed2;
  if (sine2 < square_flank) return v;
  if (wall->surface->sheet) { /* from behind its facets' normals point the other way */
    const uint32_t root = 0;
    uint32_t face = 0;
    scree_nearest_face(wall->surface, &root, 1, at, INFINITY, &face);
    if (vec3_dot(wall->surface->faces[face].normal, n) < 0) way = vec3_neg(way);
  }
  return vec3_mad(v, way, 1 / sqrt(sine2));
}

double scree_wall_extent(const scree_world_wall *wall) {
  const scree_wall *given = &wall->given;
  if (given->kind == SCREE_WALL_DISC) return given->radius;
  if (given->kind == SCREE_WALL_CYLINDER && given->length > 0)
    return sqrt(given->radius * given->radius + given->length * given->length);
  if (given->kind != SCREE_WALL_MESH) return INFINITY;
  const scree_box *box = &wall->surface->box;
  return vec3_norm(vec3_max(vec3_neg(box->low), box->high));
}

double scree_wall_side(const scree_world_wall *wall, vec3 p) {
  const scree_wall *given = &wall->given;
  if (given->kind == SCREE_WALL_DISC) return p.z >= 0 ? 1 : -1;
  if (given->kind == SCREE_WALL_CYLINDER)
    return p.x * p.x + p.y * p.y <= given->radius * given->radius ? 1 : -1;
  return 1;
}

bool scree_wall_spans(const scree_world_wall *wall, vec3 p) {
  const scree_wall *given = &wall->given;
  if (given->kind == SCREE_WALL_DISC) return p.x * p.x + p.y * p.y <= given->radius * given->radius;
  if (given->kind == SCREE_WALL_CYLINDER)
    return given->length == 0 || (p.z >= 0 && p.z <= given->length);
  return true;
}

static double cylinder_distance(const scree_wall *wall, vec3 p, double side, vec3 *closest,
                                vec3 *normal) {
  double rho = sqrt(p.x * p.x + p.y * p.y);
  vec3 outward = rho > 0 ? (vec3){p.x / rho, p.y / rho, 0} : (vec3){1, 0, 0};
  double z = p.z;
  if (wall->length > 0) z = z < 0 ? 0 : z > wall->length ? wall->length : z;
  *closest = (vec3){outward.x * wall->radius, outward.y * wall->radius, z};
  *normal = vec3_scale(outward, -side);
  if (z == p.z) return side * (wall->radius - rho);
  vec3 away = vec3_sub(p, *closest); /* past the rim */
  double d = vec3_norm(away);
  *normal = vec3_scale(away, 1 / d);
  return d;
}

double scree_wall_distance(const scree_world_wall *wall, vec3 p, double side, vec3 *closest,
                           vec3 *normal) {
  const scree_wall *given = &wall->given;
  if (given->kind == SCREE_WALL_CYLINDER) return cylinder_distance(given, p, side, closest, normal);
  *closest = (vec3){p.x, p.y, 0};
  *normal = (vec3){0, 0, side};
  if (given->kind == SCREE_WALL_PLANE) return p.z;
  double rho = sqrt(p.x * p.x + p.y * p.y);
  if (rho <= given->radius) return side * p.z;
  *closest = (vec3){p.x / rho * given->radius, p.y / rho * given->radius, 0};
  vec3 away = vec3_sub(p, *closest);
  double d = vec3_norm(away);
  *normal = vec3_scale(away, 1 / d);
  return d;
}

double scree_wall_distance_from(const scree_world_wall *wall, vec3 p, double *side, vec3 *closest,
                                vec3 *normal) {
  const double from = *side, here = scree_wall_side(wall, p);
  *side = here;
  if (from != 0 && from != here) {
    double d = scree_wall_distance(wall, p, from, closest, normal);
    if (d < 0) return *side = from, d;
  }
  return scree_wall_distance(wall, p, here, closest, normal);
}

double scree_wall_first_side(const scree_world_wall *wall, vec3 p, vec3 centre, double clearance) {
  double side = scree_wall_side(wall, p), own = scree_wall_side(wall, centre);
  if (own == side || !scree_wall_spans(wall, centre)) return side;
  vec3 closest, normal;
  double d = scree_wall_distance(wall, p, own, &closest, &normal);
  return d < 0 && d > -clearance ? own : side;
}
