/* From features to overlaps: for one feature pair the signed overlap, the normal, the contact
 * point.
 *
 * Point and surface. The overlap is the sum of the contact radii less the signed distance. While
 * the cores are apart by more than half the contact radii, the closest point is exact and its
 * direction is kept as the reference: the separation direction. Deeper, only faces that look that
 * way count (within about 80 degrees), and the depth is measured to the nearest of them. Without
 * this, plates that hit each other squarely and fast would be pushed out sideways, at corners where
 * the nearest face is the side. Where the point is sideways of all such faces, the closest point of
 * the whole surface takes over within half the contact radii: in a wedge no face that looks the
 * separation direction need be above it. A point that has come out on the other side of a thin wall
 * is held to the side it came from in the same way. In a notch up to two further faces count, those
 * onto which the point projects and whose normals differ by 15 (taper 0) to 25 degrees (taper 1):
 * a body in a V needs both to rest.
 *
 * Cached faces: the nearest faces of a point stay the nearest while its path is under half the
 * distance to the next one. */
#include "world/broad/candidates.h"
#include "world/contact/contact.h"
#include "world/state/walls.h"

#include "particle/closest.h"

static const double same_distance2 = 1 + 1e-9; /* squares of distances of one point */

typedef struct surface_contact {
  vec3 closest, normal;
  vec3 aside; /* from where the faces that look the separation direction end; 0 over or behind one
                 of them */
  double distance, taper;
  bool over;           /* the closest point is none of an edge */
  double gap_gradient; /* by how much the distance grows along the normal: 1, but where two are
                          blended */
} surface_contact;

/* ---- points against surfaces ---- */

/* A point of one body, in the frame of the surface of the other. */
typedef struct probe {
  const scree_particle *surface;
  const scree_pair *pair;
  scree_feature_pair *feature;
  vec3 p, velocity;           /* velocity: against the surface; of sheets only */
  double drift;               /* s, since the last look */
  const scree_particle *body; /* that has the point; of sheets only, which are walls */
  const mat3 *turned;         /* from its frame */
} probe;

static void refresh_faces(const scree_particle *surface, vec3 p, scree_feature_pair *feature,
                          double path, double slack) {
  scree_near near;
  scree_closest_faces(surface, p, INFINITY, slack, &near);
  int count = near.count < SCREE_CACHED_FACES ? near.count : SCREE_CACHED_FACES;
  double next = near.count > count ? near.distance[count] : near.next;
  for (int k = 0; k < count; k++) feature->face[k] = near.face[k];
  feature->face_count = (uint32_t)count;
  feature->valid = path + 0.5 * (next - near.distance[0]);
}

/* ---- sides of sheets ---- */

static uint16_t sheet_of(const scree_particle *surface, uint32_t face) {
  return (uint16_t)surface->face_signs[face].sheet;
}

/* Whether a face's normal points away from the side on which the feature is. On a sheet other than
 * that of the feature's side this is where the point is, or, of a point that is through a sheet,
 * where the reference points. */
static bool is_turned(const probe *x, uint32_t f) {
  const scree_feature_pair *feature = x->feature;
  const scree_face *face = &x->surface->faces[f];
  if (feature->side != 0 && feature->sheet == sheet_of(x->surface, f)) return feature->side < 0;
  vec3 out =
      feature->side == 0 || feature->inside ? feature->reference : vec3_sub(x->p, face->corner);
  return vec3_dot(face->normal, out) < 0;
}

/* The face through which the point came since the last look, or in the step before; false for
 * none. */
static bool find_passage(const probe *x, double distance, uint32_t *face) {
  double way = 2 * x->drift * vec3_norm(x->velocity);
  if (scree_pair_is_new(x->pair) || !(distance < way)) return false;
  vec3 along = vec3_unit(x->velocity);
  const scree_ray_interval back = {vec3_mad(x->p, along, -way), along, 0, way};
  return scree_next_passage(x->surface, &back, 0, SIZE_MAX, face) < INFINITY;
}

/* From the point to a place deep within its body, straight and not out of the body on the way; in
 * the frame of the surface. 0 where no such way is known. */
static vec3 way_into_body(const probe *x) {
  const scree_particle *body = x->body;
  const vec3 corner = body->points[x->feature->a];
  const double near = 1e-6 * body->measures.size;
  for (uint32_t i = 0; body->face_count && i < body->inner_count; i++) {
    vec3 way = vec3_sub(body->inner[i], corner);
    double length = vec3_norm(way);
    if (!(length > near)) continue;
    const scree_ray_interval inwards = {corner, vec3_scale(way, 1 / length), near, length};
    uint32_t face;
    if (!(scree_next_passage(body, &inwards, 0, SIZE_MAX, &face) < INFINITY))
      return mat3_mul_vec(x->turned, way);
  }
  return (vec3){0, 0, 0};
}

static double distance_to_rim(const scree_particle *sheet, vec3 place) {
  double nearest = INFINITY;
  for (size_t i = 0; i < sheet->edge_count; i++) {
    const scree_edge *edge = &sheet->edges[i];
    double s = scree_clamped(vec3_dot(vec3_sub(place, edge->start), edge->along), edge->length);
    if (scree_is_rim(edge))
      nearest = scree_min(nearest, vec3_distance(place, vec3_mad(edge->start, edge->along, s)));
  }
  return nearest;
}

/* Whether a sheet lies between the point and the inside of its body. */
typedef enum sheet_cut { NO_CUT, SHALLOW_CUT, DEEP_CUT } sheet_cut;

/* The point went round a rim and then came back over the sheet. It leaves by the sheet where that
 * is no farther than the rim; else the rim, which lies in the body, is felt. */
static sheet_cut find_cut(const probe *x, double distance, uint32_t *face) {
  vec3 way = way_into_body(x);
  double length = vec3_norm(way);
  if (!(length > 0)) return NO_CUT;
  const scree_ray_interval inwards = {x->p, vec3_scale(way, 1 / length), 0, length};
  double passage = scree_next_passage(x->surface, &inwards, 0, SIZE_MAX, face);
  if (!(passage < INFINITY)) return NO_CUT;
  if (distance_to_rim(x->surface, vec3_mad(x->p, inwards.along, passage)) < distance)
    return SHALLOW_CUT;
  vec3 normal = x->surface->faces[*face].normal;
  x->feature->side = vec3_dot(normal, way) < 0 ? -1 : 1;
  x->feature->reference = x->feature->side < 0 ? vec3_neg(normal) : normal;
  x->feature->has_reference = true;
  return DEEP_CUT;
}

/* It may come to either side. */
static bool is_of_rim(scree_feature_pair *feature, vec3 offset, vec3 *outward) {
  if (!feature->inside) feature->side = 0;
  *outward = offset;
  return true;
}

/* Whether the point is on its side of the sheet, and the way out there, which comes in as the
 * pseudonormal where the point is nearest. A side is a sign on the oriented sheet. The point keeps
 * it until it is seen to come through: where it comes nearer to another part without that, its side
 * is where it is. A rim has no sides: what goes round it may come to either. */
static bool is_on_its_side(const probe *x, vec3 offset, uint32_t face, vec3 *outward) {
  scree_feature_pair *feature = x->feature;
  if (vec3_norm2(*outward) == 0) return is_of_rim(feature, offset, outward);
  const int8_t side = vec3_dot(*outward, offset) < 0 ? -1 : 1;
  const uint16_t sheet = sheet_of(x->surface, face);
  uint32_t passed;
  if (!feature->inside && (feature->side != side || feature->sheet != sheet)) {
    feature->side = side;
    feature->sheet = sheet;
    if (find_passage(x, vec3_norm(offset), &passed)) {
      feature->side = vec3_dot(x->surface->faces[passed].normal, x->velocity) < 0 ? 1 : -1;
      feature->sheet = sheet_of(x->surface, passed);
      feature->inside = true;
    } else {
      sheet_cut cut = find_cut(x, vec3_norm(offset), &passed);
      if (cut == SHALLOW_CUT) return is_of_rim(feature, offset, outward);
      if (cut == DEEP_CUT) feature->sheet = sheet_of(x->surface, passed), feature->inside = true;
    }
  }
  const bool same = feature->sheet == sheet;
  if ((same ? feature->side : side) < 0) *outward = vec3_neg(*outward);
  return !same || feature->side == side;
}

/* Finds, among the faces that look along the reference within reach, closest point and normal of
 * the nearest, and by how much the point is sideways of the one behind which it is most nearly;
 * false for none. With `behind`, it must not be in front of a face. */
static bool find_facing(const probe *x, double reach, bool behind, surface_contact *out) {
  const scree_particle *surface = x->surface;
  const vec3 p = x->p;
  scree_tree_walk walk;
  double best2 = reach * reach, best_height = 0, least_aside2 = INFINITY;
  bool any = false;
  scree_tree_start(&walk, &surface->face_tree);
  for (const scree_tree_node *node; (node = scree_tree_next(&walk));) {
    if (scree_box_distance2(&node->box, p) > (least_aside2 > 0 ? reach * reach : best2) ||
        scree_tree_enter(&walk, node))
      continue;
    for (uint32_t k = 0; k < node->count; k++) {
      uint32_t f = surface->face_tree.order[node->first + k];
      const scree_face *face = &surface->faces[f];
      vec3 normal = face->normal;
      if (surface->sheet && is_turned(x, f)) normal = vec3_neg(normal);
      if (vec3_dot(normal, x->feature->reference) < point_facing_cosine) continue;
      int region;
      vec3 c = scree_closest_on_face(face, p, &region), offset = vec3_sub(p, c);
      double d2 = vec3_norm2(offset), height = vec3_dot(offset, normal);
      if (d2 >= reach * reach || (behind && height > 0)) continue;
      bool tied = any && d2 <= best2 * same_distance2 && best2 <= d2 * same_distance2;
      if (tied ? height > best_height : d2 < best2) {
        best2 = d2 < best2 ? d2 : best2;
        best_height = height;
        out->closest = c;
        out->normal = normal;
        out->over = region == SCREE_REGION_INSIDE;
        any = true;
      }
      vec3 aside =
          region == SCREE_REGION_INSIDE ? (vec3){0, 0, 0} : vec3_mad(offset, normal, -height);
      if (height <= 0 && vec3_norm2(aside) < least_aside2) {
        least_aside2 = vec3_norm2(aside);
        out->aside = aside;
      }
    }
  }
  if (any && !(least_aside2 < INFINITY)) { /* in front of all: sideways of the nearest */
    vec3 offset = vec3_sub(p, out->closest);
    out->aside = vec3_mad(offset, out->normal, -vec3_dot(offset, out->normal));
  }
  return any;
}

/* As the taper of a contact fades the other takes over. One distance, the weighted mean of both,
 * so that the force stays the slope of the energy; the taper changes by `change` along `aside`. */
static void pass_over(vec3 p, double change, const surface_contact *other,
                      surface_contact *contact) {
  double w = contact->taper, sideways = vec3_norm(contact->aside);
  vec3 slope = vec3_add(vec3_scale(contact->normal, w * contact->gap_gradient),
                        vec3_scale(other->normal, (1 - w) * other->gap_gradient));
  slope =
      vec3_mad(slope, contact->aside, change / sideways * (contact->distance - other->distance));
  contact->distance = w * contact->distance + (1 - w) * other->distance;
  contact->gap_gradient = vec3_norm(slope);
  contact->normal = vec3_unit(slope);
  contact->closest = vec3_mad(p, contact->normal, -contact->distance);
  contact->taper = 1;
}

/* Within half the contact radii from the faces that look the separation direction what is sideways
 * of them passes to the closest point of the whole surface. */
static void slide_off(vec3 p, double half, const surface_contact *closest,
                      surface_contact *contact) {
  pass_over(p, -scree_smooth_slope(0, half, vec3_norm(contact->aside)), closest, contact);
}

/* Below half the contact radii, or through a wall: depth along the reference. In front of the faces
 * that look that way the closest point of the whole surface takes over within half the contact
 * radii too, as far as that is not the same: where a point beside an edge sinks below the plane of
 * the face, both sides of it are `w` times 0. So does it inside, in the wall of a recess, as far
 * again: further on the depth is that to the faces, which are its floor's border. */
static bool deep_contact(const probe *x, bool pierced, bool outside, surface_contact *closest,
                         surface_contact *contact) {
  const scree_pair_law *law = &x->pair->law;
  const vec3 p = x->p;
  double half = 0.5 * law->reach, reach = 1.5 * most_pressed * law->limit + law->reach;
  if (!find_facing(x, reach, pierced, contact)) return false;
  vec3 offset = vec3_sub(p, contact->closest);
  double height = vec3_dot(offset, contact->normal), distance = vec3_norm(offset);
  bool in_front = height > 0,
       nearest = outside && in_front && contact->over && distance == closest->distance,
       along = in_front && (outside || distance < 2 * half);
  if (along && !outside) {
    surface_contact border = {.normal = vec3_scale(offset, -1 / distance), .aside = contact->aside};
    border.distance = -distance;
    border.gap_gradient = 1;
    border.taper = 1 - scree_smooth_step(0, half, vec3_norm(border.aside));
    if (border.taper < 1) slide_off(p, half, closest, &border);
    border.aside = offset;
    border.taper = scree_smooth_step(half, 2 * half, distance);
    pass_over(p, scree_smooth_slope(half, 2 * half, distance), closest, &border);
    *closest = border;
  }
  contact->taper = contact->gap_gradient = 1;
  contact->distance = nearest ? distance : outside || along ? height : -distance;
  if ((nearest || !(outside || along)) && distance > 1e-9 * half)
    contact->normal = vec3_scale(offset, 1 / contact->distance);
  if (nearest) return true;
  contact->closest = vec3_mad(p, contact->normal, -contact->distance);
  if (along) contact->aside = offset;
  contact->taper = 1 - scree_smooth_step(0, half, vec3_norm(contact->aside));
  return true;
}

/* Whether a place lies behind the plane of a contact: on the far side of an edge that is convex. */
static bool is_behind(vec3 place, const surface_contact *contact) {
  return vec3_dot(vec3_sub(place, contact->closest), contact->normal) < 0;
}

/* Further faces of a notch, onto which the point projects. */
static int notch_contacts(const probe *x, uint32_t nearest,
                          surface_contact contacts[SCREE_ANCHORS]) {
  const scree_particle *surface = x->surface;
  const scree_feature_pair *feature = x->feature;
  const vec3 p = x->p;
  int count = 1;
  for (uint32_t k = 0; k < feature->face_count && count < SCREE_ANCHORS; k++) {
    if (k == nearest) continue;
    const scree_face *face = &surface->faces[feature->face[k]];
    int region;
    vec3 c = scree_closest_on_face(face, p, &region), normal = face->normal;
    double d = vec3_dot(vec3_sub(p, c), normal);
    if (surface->sheet && d < 0) d = -d, normal = vec3_neg(normal);
    if (surface->sheet && is_behind(c, &contacts[0])) continue;
    double alike = vec3_dot(normal, contacts[0].normal);
    if (alike >= notch_cosines[0]) continue;
    if (region != SCREE_REGION_INSIDE || d <= 0) continue;
    double taper = 1 - scree_smooth_step(notch_cosines[1], notch_cosines[0], alike);
    contacts[count++] = (surface_contact){c, normal, {0, 0, 0}, d, taper, true, 1};
  }
  return count;
}

/* Contacts of the point with the surface, the nearest first. */
static int surface_contacts(const probe *x, surface_contact contacts[SCREE_ANCHORS]) {
  const scree_particle *surface = x->surface;
  scree_feature_pair *feature = x->feature;
  const vec3 p = x->p;
  const double half = 0.5 * x->pair->law.reach;
  uint32_t nearest = 0;
  int nearest_region = 0;
  double best2 = INFINITY;
  for (uint32_t k = 0; k < feature->face_count; k++) {
    int region;
    vec3 c = scree_closest_on_face(&surface->faces[feature->face[k]], p, &region);
    double d2 = vec3_norm2(vec3_sub(p, c));
    if (d2 >= best2) continue;
    best2 = d2;
    nearest = k;
    nearest_region = region;
    contacts[0].closest = c;
  }
  vec3 offset = vec3_sub(p, contacts[0].closest);
  vec3 outward = scree_outward(surface, feature->face[nearest], nearest_region);
  double d = sqrt(best2);
  bool outside = surface->sheet ? is_on_its_side(x, offset, feature->face[nearest], &outward)
                                : vec3_dot(offset, outward) >= 0;
  /* where the core of a thin shape is folded its pseudonormals lie: ask the whole surface */
  if (!outside && surface->measures.volume > 0) outside = !scree_is_inside(surface, p);
  bool deep = !outside || d < half;
  /* out on the other side of a wall that is thinner than the overlap: held while it is behind it */
  bool pierced = !deep && feature->inside &&
                 (vec3_dot(outward, feature->reference) < 0 ||
                  (surface->sheet && feature->sheet != sheet_of(surface, feature->face[nearest])));
  contacts[0].taper = contacts[0].gap_gradient = 1;
  contacts[0].distance = outside ? d : -d;
  contacts[0].normal = d > 1e-12 ? vec3_scale(offset, (outside ? 1 : -1) / d) : vec3_unit(outward);
  surface_contact out;
  if ((deep || pierced) && feature->has_reference &&
      deep_contact(x, pierced, outside, &contacts[0], &out) && (deep || out.taper > 0)) {
    feature->inside = !outside || out.taper > 0;
    if (out.taper < 1) slide_off(p, half, &contacts[0], &out);
    contacts[0] = out;
    return 1;
  }
  feature->inside = surface->sheet && !outside;
  if (!deep || !feature->has_reference) {
    feature->reference = contacts[0].normal;
    feature->has_reference = true;
  }
  return deep ? 1 : notch_contacts(x, nearest, contacts);
}

static scree_anchor *anchor_of(const scree_scratch *scratch, scree_feature_pair *feature, int k) {
  return k == 0 ? &feature->anchor : &scratch->further[feature - scratch->features].anchor[k - 1];
}

/* Gives each contact the memory of the last step whose normal is most like its own. */
static void match_anchors(const scree_scratch *scratch, scree_feature_pair *feature,
                          const vec3 *normals, int count) {
  scree_anchor *first = &feature->anchor;
  if (count == 1 && !feature->notched) { /* mostly */
    if (first->weight > 0 && !(vec3_dot(first->normal, normals[0]) > 0.5)) first->weight = 0;
    return;
  }
  scree_anchor old[SCREE_ANCHORS] = {*first};
  bool used[SCREE_ANCHORS] = {false};
  for (int k = 0; k < SCREE_ANCHORS; k++) {
    if (feature->notched) old[k] = *anchor_of(scratch, feature, k);
    *anchor_of(scratch, feature, k) = (scree_anchor){0};
  }
  feature->notched = count > 1;
  for (int j = 0; j < count; j++) {
    int best = -1;
    double best_dot = 0.5;
    for (int k = 0; k < SCREE_ANCHORS; k++) {
      if (used[k] || old[k].weight <= 0) continue;
      double dot = vec3_dot(old[k].normal, normals[j]);
      if (dot > best_dot) best_dot = dot, best = k;
    }
    if (best < 0) continue;
    used[best] = true;
    *anchor_of(scratch, feature, j) = old[best];
  }
}

static double point_surface_contact(const scree_world *world, const scree_pair *pair,
                                    scree_feature_pair *feature, const scree_frame *relative,
                                    scree_scratch *scratch) {
  bool forth = feature->kind == SCREE_FEATURE_POINT_FACE;
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  const scree_particle *from = forth ? a : b, *surface = forth ? b : a;
  uint32_t point = forth ? feature->a : feature->b;
  vec3 p = from->points[point];
  p = forth ? vec3_add(mat3_mul_vec(&relative->rotation, p), relative->position)
            : mat3_tmul_vec(&relative->rotation, vec3_sub(p, relative->position));
  if (feature->face_count == 0 || pair->list.path > feature->valid) {
    refresh_faces(surface, p, feature, pair->list.path,
                  scree_max(0.25 * pair->law.reach, 8 * pair->list.travel));
    scratch->counters.closest_queries++;
  }
  surface_contact contacts[SCREE_ANCHORS];
  probe x = {.surface = surface, .pair = pair, .feature = feature, .p = p, .drift = scratch->drift};
  if (surface->sheet) { /* that of a wall */
    x.velocity = vec3_add(relative->velocity, vec3_cross(relative->spin, p));
    x.body = from;
    x.turned = &relative->rotation;
  }
  int count = surface_contacts(&x, contacts);
  vec3 at[SCREE_ANCHORS], normals[SCREE_ANCHORS];
  for (int k = 0; k < count; k++) {
    at[k] = contacts[k].closest;
    normals[k] = contacts[k].normal;
    if (forth) continue;
    /* seen from b: from the point towards a's surface */
    at[k] = vec3_add(mat3_mul_vec(&relative->rotation, p), relative->position);
    normals[k] = vec3_neg(mat3_mul_vec(&relative->rotation, normals[k]));
  }
  match_anchors(scratch, feature, normals, count);
  double least = INFINITY, surface_radius = scree_pair_contact_radius(world, pair, forth),
         point_radius = from->face_count ? scree_pair_contact_radius(world, pair, !forth)
                                         : from->point_radii[point];
  for (int k = 0; k < count; k++) {
    const double values[4] = {contacts[k].distance, forth ? point_radius : surface_radius,
                              forth ? surface_radius : point_radius, contacts[k].taper};
    size_t added = scratch->contacts.count;
    double gap =
        scree_add_contact(scratch, pair, at[k], normals[k], values, anchor_of(scratch, feature, k));
    if (scratch->contacts.count > added)
      scratch->contacts.items[added].gap_gradient = contacts[k].gap_gradient;
    if (gap < least) least = gap;
  }
  return least;
}

/* ---- spheres and analytic walls ---- */

static double sphere_contact(const scree_world *world, const scree_pair *pair,
                             scree_feature_pair *feature, const scree_frame *relative,
                             scree_scratch *scratch) {
  const scree_particle *a = world->bodies.particle[pair->a], *b = scree_pair_shape_b(world, pair);
  vec3 p = vec3_add(mat3_mul_vec(&relative->rotation, a->points[feature->a]), relative->position);
  vec3 q = b->points[feature->b], offset = vec3_sub(p, q);
  double d = vec3_norm(offset);
  vec3 n = d > 0 ? vec3_scale(offset, 1 / d) : (vec3){0, 0, 1};
  const double values[4] = {d, a->point_radii[feature->a], b->point_radii[feature->b], 1};
  return scree_add_contact(scratch, pair, q, n, values, &feature->anchor);
}

static double wall_contact(const scree_world *world, const scree_pair *pair,
                           scree_feature_pair *feature, const scree_frame *relative,
                           scree_scratch *scratch) {
  const scree_particle *a = world->bodies.particle[pair->a];
  vec3 p = vec3_add(mat3_mul_vec(&relative->rotation, a->points[feature->a]), relative->position);
  const scree_world_wall *wall = &world->walls.items[pair->b];
  vec3 c, n;
  double side;
  if (feature->has_reference) {
    side = feature->reference.x; /* evaluated a step ago: through the sheet it cannot have come */
  } else if (scree_pair_is_new(pair)) {
    side = scree_wall_first_side(wall, p, relative->position,
                                 scree_pair_clearance(pair, a, feature->a));
  } else { /* the step that woke it may have taken it in */
    vec3 v = vec3_add(relative->velocity, vec3_cross(relative->spin, p));
    side = scree_wall_side_at(wall, vec3_mad(p, v, -2 * world->time_step));
  }
  double d = scree_wall_distance_from(wall, p, &side, &c, &n);
  feature->reference.x = side;
  feature->has_reference = true;
  const double values[4] = {d, a->point_radii[feature->a], 0, 1};
  return scree_add_contact(scratch, pair, c, n, values, &feature->anchor);
}

double scree_feature_contact(const scree_world *world, const scree_pair *pair,
                             scree_feature_pair *feature, const scree_frame *relative,
                             scree_scratch *scratch) {
  scratch->counters.feature_evaluations++;
  switch ((scree_feature_kind)feature->kind) {
  case SCREE_FEATURE_POINT_FACE:
  case SCREE_FEATURE_FACE_POINT:
    return point_surface_contact(world, pair, feature, relative, scratch);
  case SCREE_FEATURE_EDGE_EDGE:
    return scree_edge_contact(world, pair, feature, relative, scratch);
  case SCREE_FEATURE_POINT_POINT:
    return sphere_contact(world, pair, feature, relative, scratch);
  case SCREE_FEATURE_POINT_WALL:
    return wall_contact(world, pair, feature, relative, scratch);
  }
  return INFINITY;
}
