/* Places within a body, as far from its surface as there are: of spheres the centres, of a mesh
 * middles of chords, straight in from the middles of faces. The first is the deepest; each further
 * one is the farthest from those before, among those at least a quarter as deep. */
#include "particle/closest.h"

#include <stdint.h>

enum { CHORDS = 64 };
static const double shallow_share = 0.25;

typedef struct chosen_places {
  vec3 at[CHORDS + 1];
  double depth[CHORDS + 1];
  size_t count;
} chosen_places;

static void try_place(const scree_particle *p, vec3 at, chosen_places *places) {
  const uint32_t root = 0;
  uint32_t face;
  if (!scree_is_inside(p, at)) return;
  places->at[places->count] = at;
  places->depth[places->count++] = scree_nearest_face(p, &root, 1, at, INFINITY, &face);
}

static void find_chords(const scree_particle *p, chosen_places *places) {
  try_place(p, (vec3){0, 0, 0}, places);
  size_t stride = (p->face_count + CHORDS - 1) / CHORDS;
  for (size_t f = 0; f < p->face_count; f += stride) {
    const scree_face *face = &p->faces[f];
    vec3 middle = vec3_mad(face->corner, vec3_add(face->along1, face->along2), 1.0 / 3);
    const scree_ray_interval inwards = {middle, vec3_neg(face->normal), 0, INFINITY};
    uint32_t across;
    double length = scree_next_passage(p, &inwards, 0, f, &across);
    if (length < INFINITY) try_place(p, vec3_mad(middle, face->normal, -0.5 * length), places);
  }
}

static void take_spheres(const scree_particle *p, chosen_places *places) {
  size_t stride = (p->point_count + CHORDS - 1) / CHORDS;
  for (size_t i = 0; i < p->point_count; i += stride) {
    places->at[places->count] = p->points[i];
    places->depth[places->count++] = p->point_radii[i];
  }
}

static double distance_from_chosen(const scree_particle *p, vec3 at) {
  double least = INFINITY;
  for (uint32_t k = 0; k < p->inner_count; k++)
    least = scree_min(least, vec3_distance(at, p->inner[k]));
  return least;
}

void scree_particle_find_inner(scree_particle *p) {
  chosen_places places = {.count = 0};
  p->inner_count = 0;
  p->inner_depth = 0;
  if (p->face_count)
    find_chords(p, &places);
  else
    take_spheres(p, &places);
  for (size_t i = 0; i < places.count; i++)
    if (places.depth[i] > p->inner_depth) {
      p->inner_depth = places.depth[i];
      p->inner[0] = places.at[i];
      p->inner_count = 1;
    }
  while (p->inner_count > 0 && p->inner_count < SCREE_INNER_PLACES) {
    double farthest = p->inner_depth; /* nearer ones tell nothing new */
    size_t next = SIZE_MAX;
    for (size_t i = 0; i < places.count; i++) {
      if (places.depth[i] < shallow_share * p->inner_depth) continue;
      double distance = distance_from_chosen(p, places.at[i]);
      if (distance > farthest) farthest = distance, next = i;
    }
    if (next == SIZE_MAX) return;
    p->inner[p->inner_count++] = places.at[next];
  }
}
