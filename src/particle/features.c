/* Contact features of a mesh: faces with pseudonormals, corners, straight convex edges.
 *
 * Features follow the shape, not its tessellation. An edge is bent when its two faces turn by more
 * than `flat_angle`. A vertex without bent edges lies inside a flat region, one with exactly two
 * bent edges in line lies inside a straight edge: neither can touch anything before the corners and
 * edges around it do, so neither is a feature, and the edge runs on through it. A vertex with only
 * concave edges lies in a pit and is none either. Every other vertex is a corner. Convex edges that
 * turn by more than `sharp_angle` are features; below that the corners alone carry the shape (an
 * edge of length s and turn b bulges by s b / 8: under 11 um for 10 mm).
 *
 * Pseudonormals: sum of the face normals over an edge; sum of the face normals times the corner
 * angles at a vertex (Baerentzen and Aanaes 2005): the sign of (p - c).pseudonormal at the closest
 * point c tells inside from outside. */
#include "particle/particle.h"

#include "base/alloc.h"
#include "base/radix.h"
#include "mesh/mesh.h"
#include "mesh/repair/repair.h"

#include <stdlib.h>
#include <string.h>

enum { LEAF = 2 }; /* features of a leaf of their trees */

static const double flat_angle = 2e-5;             /* rad; sagitta 0.05 um over 10 mm; above the
                                                      noise of single-precision coordinates */
static const double sharp_angle = 0.5 * 0.0174533; /* rad; design value, see above */
static const double folded = 1e-6; /* length of the sum of two normals; of a knife without angle */

typedef struct half_edge {
  uint32_t low, high; /* vertices, low < high */
  uint32_t face;
  uint8_t place;    /* edge 0 (01), 1 (12) or 2 (20) of the face */
  uint8_t reversed; /* runs from high to low */
} half_edge;

typedef struct mesh_edge {
  uint32_t low, high, face1, face2; /* face2 == face1 at a border */
  double turn;                      /* angle between the normals, positive where convex */
} mesh_edge;

typedef struct vertex_bends {
  uint32_t bent, convex; /* how many */
  uint32_t edge[2];      /* the first two bent edges */
} vertex_bends;

typedef struct extraction {
  scree_particle *particle;
  half_edge *halves;
  mesh_edge *edges;
  size_t edge_count;
  vertex_bends *bends;
  bool *visited; /* edges already in a chain */
} extraction;

/* The position of a vertex: of the core, where there is one. */
static vec3 position_of(const scree_particle *p, uint32_t v) {
  return vec3_load(&(p->core ? p->core : p->mesh.positions)[3 * (size_t)v]);
}

static scree_status check_indices(const scree_mesh *mesh, scree_error *error) {
  if (mesh->triangle_count == 0 || mesh->vertex_count == 0)
    return scree_fail(error, SCREE_BAD_MESH, "particle: the mesh has no triangles");
  if (mesh->vertex_count > UINT32_MAX / 8 || mesh->triangle_count > UINT32_MAX / 8)
    return scree_fail(error, SCREE_LIMIT, "particle: %zu triangles; at most %u",
                      mesh->triangle_count, UINT32_MAX / 8);
  size_t stray = scree_mesh_stray_corner(mesh);
  if (stray != SIZE_MAX)
    return scree_fail(error, SCREE_BAD_MESH,
                      "particle: triangle %zu names vertex %u of a mesh of %zu vertices", stray / 3,
                      mesh->triangles[stray], mesh->vertex_count);
  for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
    if (!isfinite(mesh->positions[i]))
      return scree_fail(error, SCREE_BAD_MESH, "particle: vertex %zu has a coordinate of %g", i / 3,
                        mesh->positions[i]);
  return SCREE_OK;
}

static scree_status make_faces(scree_particle *p, scree_error *error) {
  const scree_mesh *mesh = &p->mesh;
  for (size_t f = 0; f < mesh->triangle_count; f++) {
    const uint32_t *t = &mesh->triangles[3 * f];
    scree_face *face = &p->faces[f];
    face->corner = position_of(p, t[0]);
    face->along1 = vec3_sub(position_of(p, t[1]), face->corner);
    face->along2 = vec3_sub(position_of(p, t[2]), face->corner);
    vec3 n = vec3_cross(face->along1, face->along2);
    face->d11 = vec3_norm2(face->along1);
    face->d22 = vec3_norm2(face->along2);
    face->d12 = vec3_dot(face->along1, face->along2);
    double area2 = vec3_norm2(n), longest2 = scree_max(face->d11, face->d22);
    if (!(area2 > 1e-20 * longest2 * longest2))
      return scree_fail(
          error, SCREE_BAD_MESH,
          "triangle %zu at (%.6g, %.6g, %.6g) m has no area (%g m2, longest edge %g m)", f,
          face->corner.x, face->corner.y, face->corner.z, 0.5 * sqrt(area2), sqrt(longest2));
    face->inverse = 1 / area2;
    face->normal = vec3_scale(n, 1 / sqrt(area2));
  }
  return SCREE_OK;
}

SCREE_ORDER_BY3(compare_halves, half_edge, low, high, face)

static void list_halves(const scree_mesh *mesh, half_edge *halves) {
  for (size_t f = 0; f < mesh->triangle_count; f++)
    for (int e = 0; e < 3; e++) {
      uint32_t a = mesh->triangles[3 * f + (size_t)e],
               b = mesh->triangles[3 * f + (size_t)((e + 1) % 3)];
      halves[3 * f + (size_t)e] =
          (half_edge){a < b ? a : b, a < b ? b : a, (uint32_t)f, (uint8_t)e, (uint8_t)(a > b)};
    }
  qsort(halves, 3 * mesh->triangle_count, sizeof *halves, compare_halves);
}

/* Signed angle between the normals of two faces over an edge: positive where convex. */
static double turn_over(const scree_particle *p, const half_edge *a, const half_edge *b) {
  vec3 n1 = p->faces[a->face].normal, n2 = p->faces[b->face].normal;
  vec3 along = vec3_unit(vec3_sub(position_of(p, a->high), position_of(p, a->low)));
  double sine = vec3_dot(vec3_cross(n1, n2), along);
  if (a->reversed) sine = -sine;
  return scree_atan2(sine, vec3_dot(n1, n2));
}

static scree_status fail_wall(const scree_particle *p, const half_edge *edge, const char *what,
                              scree_error *error) {
  vec3 a = position_of(p, edge->low), b = position_of(p, edge->high);
  return scree_fail(error, SCREE_BAD_MESH,
                    "wall: %s at the edge from (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g) m; "
                    "scree_wall_mend makes a wall of any facets",
                    what, a.x, a.y, a.z, b.x, b.y, b.z);
}

static scree_status pair_halves(extraction *x, bool is_wall, scree_error *error) {
  scree_particle *p = x->particle;
  size_t half_count = 3 * p->mesh.triangle_count;
  for (size_t i = 0; i < half_count;) {
    const half_edge *a = &x->halves[i], *b = a;
    size_t same = 1;
    while (i + same < half_count && a[same].low == a->low && a[same].high == a->high) same++;
    if (same > 2 && is_wall) return fail_wall(p, a, "three facets or more meet", error);
    if (same > 2)
      return scree_fail(error, SCREE_BAD_MESH,
                        "particle: the edge between vertices %u and %u belongs to %zu triangles",
                        a->low, a->high, same);
    if (same == 1 && !is_wall)
      return scree_fail(error, SCREE_BAD_MESH,
                        "particle: the mesh is open at the edge between vertices %u and %u of "
                        "triangle %u",
                        a->low, a->high, a->face);
    if (same == 2) {
      b = a + 1;
      if (a->reversed == b->reversed && is_wall)
        return fail_wall(p, a, "two facets are wound against each other", error);
      if (a->reversed == b->reversed)
        return scree_fail(error, SCREE_BAD_MESH,
                          "particle: triangles %u and %u are wound against each other", a->face,
                          b->face);
      if (!is_wall && scree_normals_are_sharp(p->faces[a->face].normal, p->faces[b->face].normal))
        return scree_fail(error, SCREE_BAD_MESH,
                          "particle: triangles %u and %u make an edge of less than %g degrees",
                          a->face, b->face, SCREE_LEAST_EDGE_DEG);
    }
    mesh_edge *edge = &x->edges[x->edge_count++];
    *edge = (mesh_edge){a->low, a->high, a->face, b->face, same == 2 ? turn_over(p, a, b) : 3.0};
    if (same == 1) p->sheet = true;
    vec3 sum = vec3_add(p->faces[a->face].normal, p->faces[b->face].normal);
    if (same == 1) sum = (vec3){0, 0, 0}; /* a rim has no sides */
    p->face_signs[a->face].edge[a->place] = p->face_signs[b->face].edge[b->place] = sum;
    i += same;
  }
  return SCREE_OK;
}

/* The parts of the surface that hang together, over edges of two faces, are numbered by their first
 * faces. */
static void number_sheets(extraction *x) {
  scree_face_signs *signs = x->particle->face_signs;
  for (uint32_t f = 0; f < x->particle->face_count; f++) signs[f].sheet = f;
  for (size_t e = 0; e < x->edge_count; e++) {
    uint32_t one = x->edges[e].face1, other = x->edges[e].face2;
    while (signs[one].sheet != one) one = signs[one].sheet = signs[signs[one].sheet].sheet;
    while (signs[other].sheet != other)
      other = signs[other].sheet = signs[signs[other].sheet].sheet;
    signs[one < other ? other : one].sheet = one < other ? one : other;
  }
  uint32_t count = 0;
  for (uint32_t f = 0; f < x->particle->face_count; f++)
    signs[f].sheet = signs[f].sheet == f ? count++ : signs[signs[f].sheet].sheet;
}

static scree_status make_corner_signs(scree_particle *p, scree_error *error) {
  const scree_mesh *mesh = &p->mesh;
  vec3 *sums = scree_alloc_zero(mesh->vertex_count, sizeof *sums);
  if (!sums) return scree_fail_memory(error, mesh->vertex_count * sizeof *sums, "pseudonormals");
  for (int pass = 0; pass < 2; pass++)
    for (size_t f = 0; f < mesh->triangle_count; f++)
      for (int c = 0; c < 3; c++) {
        const uint32_t *t = &mesh->triangles[3 * f];
        if (pass == 1) {
          p->face_signs[f].corner[c] = sums[t[c]];
          continue;
        }
        vec3 at = position_of(p, t[c]), u = vec3_sub(position_of(p, t[(c + 1) % 3]), at),
             v = vec3_sub(position_of(p, t[(c + 2) % 3]), at);
        double angle = scree_atan2(vec3_norm(vec3_cross(u, v)), vec3_dot(u, v));
        sums[t[c]] = vec3_mad(sums[t[c]], p->faces[f].normal, angle);
      }
  scree_free(sums);
  return SCREE_OK;
}

static void count_bends(extraction *x) {
  for (size_t e = 0; e < x->edge_count; e++) {
    const mesh_edge *edge = &x->edges[e];
    if (fabs(edge->turn) <= flat_angle) continue;
    const uint32_t ends[2] = {edge->low, edge->high};
    for (int i = 0; i < 2; i++) {
      vertex_bends *bends = &x->bends[ends[i]];
      if (bends->bent < 2) bends->edge[bends->bent] = (uint32_t)e;
      bends->bent++;
      bends->convex += edge->turn > 0 || x->particle->sheet; /* convex from one of two sides */
    }
  }
}

static vec3 direction_from(const extraction *x, uint32_t edge_index, uint32_t vertex) {
  const mesh_edge *edge = &x->edges[edge_index];
  uint32_t other = edge->low == vertex ? edge->high : edge->low;
  return vec3_unit(vec3_sub(position_of(x->particle, other), position_of(x->particle, vertex)));
}

/* Whether the vertex lies inside a straight edge. */
static bool is_straight(const extraction *x, uint32_t vertex) {
  const vertex_bends *bends = &x->bends[vertex];
  if (bends->bent != 2 || bends->convex != 2) return false;
  vec3 u = direction_from(x, bends->edge[0], vertex), v = direction_from(x, bends->edge[1], vertex);
  return vec3_dot(u, v) < 0 && vec3_norm(vec3_cross(u, v)) < flat_angle;
}

static bool is_corner(const extraction *x, uint32_t vertex) {
  return x->bends[vertex].convex > 0 && !is_straight(x, vertex);
}

/* In the plane of the only face of a rim, away from it. */
static vec3 rim_outward(const extraction *x, const mesh_edge *edge) {
  const scree_mesh *mesh = &x->particle->mesh;
  const uint32_t *t = &mesh->triangles[3 * (size_t)edge->face1];
  vec3 low = position_of(x->particle, edge->low),
       along = vec3_unit(vec3_sub(position_of(x->particle, edge->high), low));
  for (int k = 0; k < 3; k++) {
    if (t[k] == edge->low || t[k] == edge->high) continue;
    vec3 inward = vec3_sub(position_of(x->particle, t[k]), low);
    return vec3_unit(vec3_mad(vec3_scale(inward, -1), along, vec3_dot(inward, along)));
  }
  return (vec3){0, 0, 1};
}

/* Corners on a rim have no sides either. */
static void clear_rim_signs(extraction *x) {
  scree_particle *p = x->particle;
  for (size_t e = 0; e < x->edge_count; e++) {
    const mesh_edge *edge = &x->edges[e];
    if (edge->face1 == edge->face2)
      x->bends[edge->low].edge[1] = x->bends[edge->high].edge[1] = UINT32_MAX;
  }
  for (size_t f = 0; f < p->face_count; f++)
    for (int c = 0; c < 3; c++)
      if (x->bends[p->mesh.triangles[3 * f + (size_t)c]].edge[1] == UINT32_MAX)
        p->face_signs[f].corner[c] = (vec3){0, 0, 0};
  memset(x->bends, 0, p->mesh.vertex_count * sizeof *x->bends);
}

/* Follows a straight edge from `vertex` on; returns where it ends. */
static uint32_t follow(extraction *x, uint32_t edge_index, uint32_t vertex) {
  size_t first = edge_index;
  while (is_straight(x, vertex)) {
    const vertex_bends *bends = &x->bends[vertex];
    uint32_t next = bends->edge[0] == edge_index ? bends->edge[1] : bends->edge[0];
    if (next == first) break;
    x->visited[next] = true;
    vertex = x->edges[next].low == vertex ? x->edges[next].high : x->edges[next].low;
    edge_index = next;
  }
  return vertex;
}

static void make_points_and_edges(extraction *x) {
  scree_particle *p = x->particle;
  const scree_mesh *mesh = &p->mesh;
  for (uint32_t v = 0; v < mesh->vertex_count; v++)
    if (is_corner(x, v)) {
      p->points[p->point_count] = position_of(p, v);
      p->point_radii[p->point_count++] = p->radius;
    }
  for (uint32_t e = 0; e < x->edge_count; e++) {
    const mesh_edge *edge = &x->edges[e];
    double turn = p->sheet ? fabs(edge->turn) : edge->turn;
    if (turn <= sharp_angle || x->visited[e]) continue;
    x->visited[e] = true;
    vec3 start = position_of(p, follow(x, e, edge->low)),
         end = position_of(p, follow(x, e, edge->high)), along = vec3_sub(end, start);
    if (p->sheet && edge->face1 == edge->face2) {
      p->edges[p->edge_count++] = scree_rim_edge(start, end, rim_outward(x, edge));
      continue;
    }
    double half = scree_min(0.5 * turn + scree_cone_slack, 1.57);
    vec3 sum = vec3_add(p->faces[edge->face1].normal, p->faces[edge->face2].normal);
    if (vec3_norm(sum) < folded) sum = rim_outward(x, edge);
    if (edge->turn < 0) sum = vec3_neg(sum); /* of a sheet: convex from behind */
    p->edges[p->edge_count++] = (scree_edge){start,
                                             end,
                                             vec3_unit(along),
                                             vec3_norm(along),
                                             {vec3_unit(sum), scree_cos(half), scree_sin(half)},
                                             0};
  }
}

static void free_extraction(extraction *x) {
  scree_free(x->halves);
  scree_free(x->edges);
  scree_free(x->bends);
  scree_free(x->visited);
}

scree_status scree_particle_extract_features(scree_particle *p, bool is_wall, scree_error *error) {
  const scree_mesh *mesh = &p->mesh;
  SCREE_TRY(check_indices(mesh, error));
  size_t halves = 3 * mesh->triangle_count;
  p->face_count = mesh->triangle_count;
  SCREE_TRY_ALLOC(p->faces, p->face_count, error);
  SCREE_TRY_ALLOC(p->face_signs, p->face_count, error);
  SCREE_TRY_ALLOC(p->points, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(p->point_radii, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(p->edges, halves, error);
  SCREE_CLEANUP(free_extraction) extraction x = {.particle = p};
  SCREE_TRY_ALLOC(x.halves, halves, error);
  SCREE_TRY_ALLOC(x.edges, halves, error);
  SCREE_TRY_ALLOC_ZERO(x.bends, mesh->vertex_count, error);
  SCREE_TRY_ALLOC_ZERO(x.visited, halves, error);
  SCREE_TRY(make_faces(p, error));
  double inset = p->radius - p->measures.rounding;
  if (inset > 0) SCREE_TRY(scree_particle_make_core(p, inset, error));
  if (p->core) SCREE_TRY(make_faces(p, error));
  list_halves(mesh, x.halves);
  SCREE_TRY(pair_halves(&x, is_wall, error));
  number_sheets(&x);
  SCREE_TRY(make_corner_signs(p, error));
  if (p->sheet) clear_rim_signs(&x);
  count_bends(&x);
  make_points_and_edges(&x);
  return SCREE_OK;
}

static scree_box box_of_face(const void *particle, size_t i) {
  const scree_face *face = &((const scree_particle *)particle)->faces[i];
  vec3 b = vec3_add(face->corner, face->along1), c = vec3_add(face->corner, face->along2);
  return scree_box_join(scree_box_of(face->corner, b), (scree_box){c, c});
}

static scree_box box_of_edge(const void *particle, size_t i) {
  const scree_edge *edge = &((const scree_particle *)particle)->edges[i];
  return scree_box_of(edge->start, edge->end);
}

static scree_box box_of_point(const void *particle, size_t i) {
  const scree_particle *p = particle;
  return scree_box_grown((scree_box){p->points[i], p->points[i]}, p->point_radii[i]);
}

static scree_status add_edge_cones(scree_particle *p, scree_error *error) {
  SCREE_SCRATCH(scree_cone, cones, p->edge_count, error);
  for (size_t e = 0; e < p->edge_count; e++) cones[e] = p->edges[e].normals;
  return scree_tree_add_cones(&p->edge_tree, cones, error);
}

scree_status scree_particle_build_trees(scree_particle *p, scree_error *error) {
  const scree_boxed items[3] = {
      {p->face_count, box_of_face, p, LEAF, SCREE_SPLIT_HALVES},
      {p->edge_count, box_of_edge, p, LEAF, SCREE_SPLIT_HALVES},
      {p->point_count, box_of_point, p, LEAF, SCREE_SPLIT_HALVES},
  };
  scree_tree *trees[3] = {&p->face_tree, &p->edge_tree, &p->point_tree};
  p->box = scree_box_empty();
  for (int what = 0; what < 3; what++) {
    SCREE_TRY(scree_tree_build(&items[what], trees[what], error));
    if (items[what].count == 0) continue;
    scree_box box = trees[what]->nodes[0].box;
    p->box = scree_box_join(p->box, what == 0 ? scree_box_grown(box, p->radius) : box);
  }
  return add_edge_cones(p, error);
}
