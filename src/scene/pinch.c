/* Geometry that closes on bodies: two pieces that face each other across a gap, at one moment wide
 * enough for a body, at another narrower than it. A wall presses as hard as it takes, so that no
 * stiffness keeps such a contact soft, but room does.
 *
 * Points of one piece are followed through moments of the run. Where the other is in front of such
 * a point, nearer than a body is large, the middle between them is looked at: at the moments at
 * which both are in opposite directions from there, how far are they apart? What goes with either
 * piece must have been in a gap that just holds it, so that nothing that passes by counts. */
#include "scene/motions.h"
#include "scene/scene.h"

#include "particle/closest.h"
#include "world/state/walls.h"

enum { MOMENTS = 24, POINTS = 4096, LEAST_POINTS = 32 }; /* of all pairs of walls; of one */
static const double facing = 0.7;                        /* cosine */
static const double most_room = 1.5; /* of the size: wider a gap does not hold a body */

/* Where a wall is. */
typedef struct place {
  const scree_world_wall *wall;
  vec3 position;
  mat3 rotation;
} place;

static place place_of(const scree_scene *scene, size_t wall, double time) {
  place p = {.wall = &scene->gallery->walls.items[wall]};
  scree_wall_place(scene->gallery, wall, time, &p.position, &p.rotation);
  return p;
}

/* The way from p to the nearest point of the wall, and the way out of the wall there, unit; 0: a
 * sheet. */
static vec3 way_to(const place *to, vec3 p, vec3 *out) {
  const uint32_t root = 0;
  const scree_particle *surface = to->wall->surface;
  vec3 local = mat3_tmul_vec(&to->rotation, vec3_sub(p, to->position)), closest, normal = {0, 0, 0};
  if (surface && surface->face_count) {
    uint32_t face;
    int region;
    scree_nearest_face(surface, &root, 1, local, INFINITY, &face);
    closest = scree_closest_on_face(&surface->faces[face], local, &region);
    if (!surface->sheet) normal = surface->faces[face].normal;
  } else {
    scree_wall_distance(to->wall, local, scree_wall_side(to->wall, local), &closest, &normal);
    if (to->wall->given.kind != SCREE_WALL_PLANE) normal = (vec3){0, 0, 0};
  }
  *out = mat3_mul_vec(&to->rotation, normal);
  return mat3_mul_vec(&to->rotation, vec3_sub(closest, local));
}

/* The gap across a point between two walls; 0 where they are not in opposite directions. */
static double gap_at(const place *one, const place *other, vec3 at) {
  vec3 out;
  const vec3 to_one = way_to(one, at, &out), to_other = way_to(other, at, &out);
  return vec3_dot(vec3_unit(to_one), vec3_unit(to_other)) < -facing
             ? vec3_norm(to_one) + vec3_norm(to_other)
             : 0;
}

typedef struct search {
  const scree_scene *scene;
  size_t geometry[2], wall[2];
  place at[2][MOMENTS];
  double gaps[2][MOMENTS]; /* m: where the middle goes with the one, or with the other */
  double most;             /* m, the largest shape's size */
  scree_scene_pinch worst;
} search;

/* The least gap in which a body of this size has been, whichever it went with; 0: none. */
static double gap_of(const search *s, double size) {
  double wide = INFINITY;
  for (int k = 0; k < 2; k++) {
    double least = INFINITY;
    for (int a = 0; a < MOMENTS; a++)
      if (s->gaps[k][a] >= size) least = fmin(least, s->gaps[k][a]);
    if (!(least < most_room * size)) return 0;
    wide = fmin(wide, least);
  }
  return wide;
}

/* Shapes that fit into the gap where it is wide, and not where it is narrow. */
static void look_at_shapes(search *s, double narrow) {
  const scree_scene *scene = s->scene;
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++) {
    const double size = scene->shapes[i].particle->measures.size, wide = gap_of(s, size),
                 share = scree_scene_pinch_share(scene, i, s->geometry),
                 overlap = (size - narrow) * share,
                 limit = scene->world->options.overlap_limit * size;
    if (!(wide > 0) || !(overlap > limit)) continue;
    if (s->worst.limit > 0 && overlap / limit <= s->worst.overlap / s->worst.limit) continue;
    s->worst = (scree_scene_pinch){
        i, {s->geometry[0], s->geometry[1]}, narrow, wide, overlap, limit, size - limit / share};
  }
}

static void look_from(search *s, vec3 local, vec3 normal) {
  const bool sheet = s->at[0][0].wall->surface->sheet;
  for (int b = 0; b < MOMENTS; b++) {
    const place *from = &s->at[0][b];
    vec3 out, p = vec3_add(from->position, mat3_mul_vec(&from->rotation, local)),
              way = way_to(&s->at[1][b], p, &out), n = vec3_unit(way),
              own = mat3_mul_vec(&from->rotation, normal);
    const double narrow = vec3_norm(way);
    if (!(narrow < s->most) || vec3_dot(out, n) > -facing * vec3_norm(out)) continue;
    if (!sheet && vec3_dot(own, n) < facing) continue;
    for (int k = 0; k < 2; k++) {
      const place *with = s->at[k];
      const vec3 middle = vec3_mad(p, way, 0.5),
                 in = mat3_tmul_vec(&with[b].rotation, vec3_sub(middle, with[b].position));
      for (int a = 0; a < MOMENTS; a++)
        s->gaps[k][a] = gap_at(&s->at[0][a], &s->at[1][a],
                               vec3_add(with[a].position, mat3_mul_vec(&with[a].rotation, in)));
    }
    look_at_shapes(s, narrow);
  }
}

/* Points spread over the faces. */
static void look_between(search *s, size_t points) {
  const scree_particle *surface = s->at[0][0].wall->surface;
  const size_t count = surface->face_count, each = (points + count - 1) / count,
               stride = count > points ? count / points : 1;
  for (size_t f = 0; f < count; f += stride)
    for (size_t k = 0; k < each; k++) {
      const scree_face *face = &surface->faces[f];
      double u = fmod(0.5 + 0.7548776662 * (double)k, 1),
             v = fmod(0.5 + 0.5698402910 * (double)k, 1);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      look_from(s, vec3_mad(vec3_mad(face->corner, face->along1, u), face->along2, v),
                face->normal);
    }
}

static bool moves(const scree_scene *scene, size_t geometry) {
  return scree_motions_fastest(scene, geometry) > 0;
}

bool scree_scene_pinches(const scree_scene *scene, double duration, scree_scene_pinch *pinch) {
  search s = {.scene = scene};
  const size_t count = scene->plan.geometry.count;
  size_t pairs = 0;
  for (size_t i = 0; i < SCREE_SCENE_SHAPES(scene); i++)
    s.most = fmax(s.most, scene->shapes[i].particle->measures.size);
  for (int look = 0; look < 2; look++) /* counts, then looks */
    for (size_t g = 0; g < count; g++)
      for (size_t h = 0; h < count; h++) {
        const scree_scene_geometry *one = &scene->geometry[g], *other = &scene->geometry[h];
        if (g == h || !(moves(scene, g) || moves(scene, h))) continue;
        if (!look) pairs += one->wall_count * other->wall_count;
        for (size_t i = 0; look && i < one->wall_count * other->wall_count; i++) {
          const size_t w[2] = {one->first_wall + i / other->wall_count,
                               other->first_wall + i % other->wall_count};
          s.geometry[0] = g, s.geometry[1] = h;
          for (int k = 0; k < 2 * MOMENTS; k++)
            s.at[k % 2][k / 2] =
                place_of(scene, w[k % 2], duration * fmod(0.6180339887 * (k / 2), 1));
          const scree_particle *surface = s.at[0][0].wall->surface;
          if (surface && surface->face_count)
            look_between(&s, POINTS / pairs > LEAST_POINTS ? POINTS / pairs : LEAST_POINTS);
        }
      }
  *pinch = s.worst;
  return s.worst.limit > 0;
}
