#include "support/plates.h"

#include "support/law.h"
#include "support/shapes.h"

scree_mesh plates_of(const vec3 *corners, size_t count) {
  scree_mesh loose = shape_make(4 * count, 2 * count);
  for (size_t i = 0; i < 4 * count; i++) vec3_store(loose.positions + 3 * i, corners[i]);
  for (uint32_t q = 0; q < count; q++) {
    const uint32_t a = 4 * q, two[6] = {a, a + 1, a + 2, a, a + 2, a + 3};
    memcpy(loose.triangles + 6 * (size_t)q, two, sizeof two);
  }
  scree_mesh welded = shape_weld(&loose, NULL);
  scree_mesh_free(&loose);
  return welded;
}

static vec3 vertex(const scree_mesh *mesh, uint32_t v) {
  return vec3_load(mesh->positions + 3 * (size_t)v);
}

/* The place of an edge in a triangle; 3 where it has none such. */
static size_t place_of(const uint32_t *triangle, uint32_t a, uint32_t b) {
  size_t k = 0;
  while (k < 3 && !((triangle[k] == a && triangle[(k + 1) % 3] == b) ||
                    (triangle[k] == b && triangle[(k + 1) % 3] == a)))
    k++;
  return k;
}

/* Edge k of a triangle runs through the new vertex: the part beyond is a triangle of its own. */
static void cut(scree_mesh *mesh, size_t t, size_t k, uint32_t middle) {
  uint32_t *own = mesh->triangles + 3 * t, *other = mesh->triangles + 3 * mesh->triangle_count++;
  other[0] = middle, other[1] = own[(k + 1) % 3], other[2] = own[(k + 2) % 3];
  own[(k + 1) % 3] = middle;
}

static void split_edge(scree_mesh *mesh, uint32_t a, uint32_t b, double share) {
  uint32_t middle = (uint32_t)mesh->vertex_count++;
  vec3 from = vertex(mesh, a), way = vec3_sub(vertex(mesh, b), from);
  vec3_store(mesh->positions + 3 * (size_t)middle, vec3_mad(from, way, share));
  for (size_t t = 0, count = mesh->triangle_count; t < count; t++) {
    size_t k = place_of(mesh->triangles + 3 * t, a, b);
    if (k < 3) cut(mesh, t, k, middle);
  }
}

void plates_split(scree_mesh *mesh, size_t facets, scree_rng *rng) {
  scree_mesh more = shape_make(mesh->vertex_count + facets + 2, mesh->triangle_count + facets + 4);
  memcpy(more.positions, mesh->positions, 3 * mesh->vertex_count * sizeof *more.positions);
  memcpy(more.triangles, mesh->triangles, 3 * mesh->triangle_count * sizeof *more.triangles);
  more.vertex_count = mesh->vertex_count;
  more.triangle_count = mesh->triangle_count;
  while (more.triangle_count < facets) { /* the longest edge, so that none is a sliver */
    const uint32_t *t = more.triangles + 3 * scree_rng_below(rng, more.triangle_count);
    size_t longest = 0;
    double length[3];
    for (size_t k = 0; k < 3; k++) {
      length[k] = vec3_distance(vertex(&more, t[k]), vertex(&more, t[(k + 1) % 3]));
      if (length[k] > length[longest]) longest = k;
    }
    split_edge(&more, t[longest], t[(longest + 1) % 3], 0.3 + 0.4 * scree_rng_uniform(rng));
  }
  scree_mesh_free(mesh);
  *mesh = more;
}

void plates_turn(scree_mesh *mesh) {
  for (size_t t = 0; t < mesh->triangle_count; t++) shape_flip(mesh, t);
}

/* From the axis along the plane that stands on the floor, and away from the space between. */
static vec3 along_of(const plates_corner *c) {
  return (vec3){0, -cos(c->angle), sin(c->angle)};
}
static vec3 away_of(const plates_corner *c) {
  return (vec3){0, sin(c->angle), cos(c->angle)};
}

vec3 plates_bisector(const plates_corner *c) {
  return (vec3){0, -cos(0.5 * c->angle), sin(0.5 * c->angle)};
}

void plates_heights(const plates_corner *c, vec3 p, double heights[2]) {
  heights[0] = p.z;
  heights[1] = -vec3_dot(p, away_of(c));
}

/* A quadrangle between two lines along x. */
static void band(vec3 *to, const plates_corner *c, vec3 a, vec3 b) {
  vec3 half = {0.5 * c->width, 0, 0};
  to[0] = vec3_sub(a, half), to[1] = vec3_add(a, half);
  to[2] = vec3_add(b, half), to[3] = vec3_sub(b, half);
}

/* Both ends of a prism over a quadrangle. */
static void ends(vec3 *to, const plates_corner *c, const vec3 at[4]) {
  vec3 half = {0.5 * c->width, 0, 0};
  for (int k = 0; k < 4; k++) {
    to[k] = vec3_add(at[3 - k], half);
    to[4 + k] = vec3_sub(at[(k + 1) % 4], half);
  }
}

scree_mesh plates_make_corner(const plates_corner *c) {
  const vec3 axis = {0, 0, 0}, floor = {0, -c->length, 0},
             wall = vec3_scale(along_of(c), c->length);
  vec3 corners[40];
  size_t count = 0;
  if (!c->closed || c->thick > 0) {
    band(corners, c, axis, floor);
    band(corners + 4, c, wall, axis);
    count = 2;
  }
  if (c->closed && c->thick > 0) {
    vec3 under = {0, -c->length, -c->thick}, behind = vec3_mad(wall, away_of(c), c->thick),
         edge = vec3_scale(plates_bisector(c), -c->thick / sin(0.5 * c->angle));
    band(corners + 8, c, floor, under);
    band(corners + 12, c, under, edge);
    band(corners + 16, c, edge, behind);
    band(corners + 20, c, behind, wall);
    ends(corners + 24, c, (vec3[4]){axis, floor, under, edge});
    ends(corners + 32, c, (vec3[4]){axis, edge, behind, wall});
    count = 10;
  } else if (c->closed) { /* the wedge between the two planes */
    vec3 middle = vec3_scale(vec3_add(floor, wall), 0.5);
    band(corners, c, floor, axis);
    band(corners + 4, c, axis, wall);
    band(corners + 8, c, wall, middle);
    band(corners + 12, c, middle, floor);
    ends(corners + 16, c, (vec3[4]){floor, axis, wall, middle});
    count = 6;
  }
  scree_error error;
  double area, volume;
  scree_mesh mesh = plates_of(corners, count);
  CHECK_OK(scree_mesh_area_volume(&mesh, &area, &volume, &error), error);
  if (c->closed && volume < 0) plates_turn(&mesh);
  return mesh;
}

scree_mesh plates_stone(double radius, scree_rng *rng) {
  scree_mesh stone = shape_icosphere(radius, 1);
  shape_roughen(&stone, 0.15, rng);
  return stone;
}

scree_particle *plates_body(plates_body_kind kind, double radius, scree_rng *rng) {
  scree_error error;
  scree_particle *particle = NULL;
  const double side = 2 * radius / sqrt(3),
               centres[9] = {-0.5 * radius, 0, 0, 0.4 * radius, 0, 0, 0, 0.4 * radius, 0},
               radii[3] = {0.5 * radius, 0.55 * radius, 0.5 * radius};
  if (kind == PLATES_PLATE)
    return shape_particle(shape_box(1.4 * radius, 1.4 * radius, 0.15 * radius));
  if (kind == PLATES_CUBE) return shape_particle(shape_box(side, side, side));
  if (kind == PLATES_STONE) return shape_particle(plates_stone(radius, rng));
  if (kind == PLATES_BALL) return law_sphere(radius);
  CHECK_OK(scree_particle_clump(centres, radii, 3, NULL, &particle, &error), error);
  return particle;
}
