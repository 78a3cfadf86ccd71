/* Where parts face each other: of every two facets that look at each other the common area, as seen
 * along the mean of their normals, as far as the gap is small enough. Such patches hang together
 * where one facet is the same or its neighbour, and the other too; what does, and looks one way, is
 * a face.
 */
#include "base/array.h"
#include "base/radix.h"
#include "mesh/adjacency.h"
#include "mesh/fracture/section.h"
#include "mesh/index/bvh.h"
#include "mesh/mesh.h"

#include <stdlib.h>

/* Cosines: of normals that look at each other; of normals of one face. */
static const double opposite = -0.9, alike = 0.9;
/* Corners of what two triangles have in common, between two bounds of the gap. */
enum { MOST_CORNERS = 8, ALONG = 8 };

typedef struct patch {
  uint32_t a, b;         /* facets */
  vec3 normal;           /* from a to b, as long as the area */
  uint32_t first, count; /* of the corners */
  double area;
  bool taken;
} patch;

/* What is known of a part. */
typedef struct side {
  scree_bvh bvh;
  scree_adjacency adjacency;
  scree_box box;
} side;

typedef struct facing {
  const scree_facing_part *parts;
  side *sides;
  size_t count;
  double gap;
  SCREE_LIST(patch) patches; /* of one pair, ascending */
  SCREE_LIST(vec3) corners, triangles;
  SCREE_LIST(uint32_t) stack;
  SCREE_LIST(scree_fracture_face) faces;
} facing;

/* ---- two facets ---- */

typedef struct polygon {
  double at[MOST_CORNERS + 2][2];
  int count;
} polygon;

/* Keeps where c0 + cx x + cy y is not below 0. */
static void clip(polygon *p, double c0, double cx, double cy) {
  polygon kept = {.count = 0};
  for (int i = 0; i < p->count; i++) {
    const double *s = p->at[i], *e = p->at[(i + 1) % p->count];
    double hs = c0 + cx * s[0] + cy * s[1], he = c0 + cx * e[0] + cy * e[1], t = hs / (hs - he);
    if (hs >= 0) memcpy(kept.at[kept.count++], s, sizeof kept.at[0]);
    if ((hs >= 0) != (he >= 0)) {
      kept.at[kept.count][0] = s[0] + t * (e[0] - s[0]);
      kept.at[kept.count++][1] = s[1] + t * (e[1] - s[1]);
    }
    if (kept.count > MOST_CORNERS) break; /* of rounding alone */
  }
  *p = kept;
}

/* A plane as a height over (x, y): h[0] + h[1] x + h[2] y. */
static void height_of(vec3 normal, vec3 through, const vec3 axes[3], double h[3]) {
  double down = vec3_dot(normal, axes[2]);
  h[0] = vec3_dot(normal, through) / down;
  h[1] = -vec3_dot(normal, axes[0]) / down;
  h[2] = -vec3_dot(normal, axes[1]) / down;
}

static scree_status meet(facing *f, const scree_mesh *a, uint32_t t, vec3 na, const scree_mesh *b,
                         uint32_t u, vec3 nb, scree_error *error) {
  vec3 axes[3], o = scree_mesh_corner(a, t, 0);
  double ha[3], hb[3], c[3][2];
  polygon p = {.count = 3};
  axes[2] = vec3_unit(vec3_sub(na, nb));
  vec3_frame(axes[2], &axes[0], &axes[1]);
  for (int k = 0; k < 3; k++) {
    vec3 at = vec3_sub(scree_mesh_corner(a, t, k), o),
         other = vec3_sub(scree_mesh_corner(b, u, 2 - k), o);
    for (int i = 0; i < 2; i++)
      p.at[k][i] = vec3_dot(axes[i], at), c[k][i] = vec3_dot(axes[i], other);
  }
  for (int k = 0; k < 3; k++) { /* b's facet, turned round, runs counter-clockwise as a's */
    double x = c[(k + 1) % 3][0] - c[k][0], y = c[(k + 1) % 3][1] - c[k][1];
    clip(&p, y * c[k][0] - x * c[k][1], -y, x);
  }
  height_of(na, (vec3){0, 0, 0}, axes, ha);
  height_of(nb, vec3_sub(scree_mesh_corner(b, u, 0), o), axes, hb);
  clip(&p, f->gap - hb[0] + ha[0], ha[1] - hb[1], ha[2] - hb[2]);
  clip(&p, f->gap + hb[0] - ha[0], hb[1] - ha[1], hb[2] - ha[2]);
  patch made = {.a = t, .b = u, .first = (uint32_t)f->corners.count, .count = (uint32_t)p.count};
  if (p.count < 3) return SCREE_OK;
  for (int i = 0; i < p.count; i++) {
    double x = p.at[i][0], y = p.at[i][1],
           h = 0.5 * (ha[0] + hb[0] + (ha[1] + hb[1]) * x + (ha[2] + hb[2]) * y);
    vec3 at = vec3_mad(vec3_mad(vec3_mad(o, axes[0], x), axes[1], y), axes[2], h);
    SCREE_TRY_PUSH(&f->corners, error, at);
    const vec3 *q = f->corners.items + made.first;
    if (i > 1) made.normal = vec3_add(made.normal, vec3_triangle_normal(q[0], q[i - 1], q[i]));
  }
  made.normal = vec3_scale(made.normal, 0.5);
  made.area = vec3_norm(made.normal);
  if (!(made.area > 0)) return SCREE_OK;
  SCREE_TRY_PUSH(&f->patches, error, made);
  return SCREE_OK;
}

/* ---- two parts ---- */

SCREE_ORDER_BY2(compare_patches, patch, a, b)

static scree_status find_patches(facing *f, size_t i, size_t k, scree_error *error) {
  const scree_mesh *a = f->parts[i].mesh, *b = f->parts[k].mesh;
  const scree_tree *tree = &f->sides[k].bvh.tree;
  f->patches.count = f->corners.count = 0;
  for (uint32_t t = 0; t < a->triangle_count; t++) {
    scree_box box = scree_box_grown(scree_facet_box(a, t), f->gap);
    vec3 na = vec3_unit(scree_facet_normal(a, t));
    scree_tree_walk walk;
    scree_tree_start(&walk, tree);
    for (const scree_tree_node *n; (n = scree_tree_next(&walk));) {
      if (!scree_box_meets(&box, &n->box) || scree_tree_enter(&walk, n)) continue;
      for (uint32_t e = n->first; e < n->first + n->count; e++) {
        uint32_t u = tree->order[e];
        scree_box other = scree_facet_box(b, u);
        vec3 nb = vec3_unit(scree_facet_normal(b, u));
        if (scree_box_meets(&box, &other) && vec3_dot(na, nb) < opposite)
          SCREE_TRY(meet(f, a, t, na, b, u, nb, error));
      }
    }
  }
  if (f->patches.count > 1)
    qsort(f->patches.items, f->patches.count, sizeof *f->patches.items, compare_patches);
  return SCREE_OK;
}

/* The patch of these facets joins the face, if it looks the same way. */
static bool take(facing *f, uint32_t a, uint32_t b, vec3 way) {
  const patch key = {.a = a, .b = b};
  patch *p = f->patches.count
                 ? bsearch(&key, f->patches.items, f->patches.count, sizeof key, compare_patches)
                 : NULL;
  if (!p || p->taken || !(vec3_dot(p->normal, way) > alike * p->area)) return true;
  p->taken = true;
  for (uint32_t k = 2; k < p->count; k++) {
    const vec3 *q = f->corners.items + p->first;
    if (!SCREE_PUSH(&f->triangles, q[0]) || !SCREE_PUSH(&f->triangles, q[k - 1]) ||
        !SCREE_PUSH(&f->triangles, q[k]))
      return false;
  }
  return SCREE_PUSH(&f->stack, (uint32_t)(p - f->patches.items));
}

/* Half of what stands behind a face at its largest patch. */
static double half_behind(const facing *f, size_t part, vec3 at, vec3 in) {
  double cosine = 0, volume = 0,
         way = scree_ray_meet(&f->sides[part].bvh, vec3_mad(at, in, -f->gap), in, 2 * f->gap,
                              &cosine);
  if (isfinite(way)) return (way - f->gap) / 2;
  (void)scree_mesh_area_volume(f->parts[part].mesh, NULL, &volume, NULL);
  return cbrt(volume) / 2;
}

static scree_status add_face(facing *f, size_t i, size_t k, const patch *seed, scree_error *error) {
  scree_fracture_face face = {.a = (uint32_t)i, .b = (uint32_t)k};
  const vec3 *q = f->corners.items + seed->first;
  vec3 at = vec3_scale(vec3_add(vec3_add(q[0], q[1]), q[2]), 1. / 3);
  scree_section_describe(f->triangles.items, f->triangles.count / 3, &face);
  vec3 n = vec3_load(face.normal);
  face.distance = half_behind(f, i, at, vec3_neg(n)) + half_behind(f, k, at, n);
  SCREE_TRY_PUSH(&f->faces, error, face);
  return SCREE_OK;
}

/* Patches that hang together, the largest first. */
static scree_status gather_faces(facing *f, size_t i, size_t k, size_t *small, scree_error *error) {
  const uint32_t *ra = f->sides[i].adjacency.ring, *rb = f->sides[k].adjacency.ring;
  for (double largest = 0;;) {
    const patch *seed = NULL;
    for (size_t p = 0; p < f->patches.count; p++)
      if (!f->patches.items[p].taken && (!seed || f->patches.items[p].area > seed->area))
        seed = &f->patches.items[p];
    if (!seed) return SCREE_OK;
    if (!(largest > 0)) /* what is hardly any of the smaller facet is of rounding */
      largest = scree_larger(
          seed->area, scree_smaller(vec3_norm(scree_facet_normal(f->parts[i].mesh, seed->a)),
                                    vec3_norm(scree_facet_normal(f->parts[k].mesh, seed->b))));
    if (seed->area < scree_least_face * largest) {
      *small += 1;
      return SCREE_OK;
    }
    f->triangles.count = f->stack.count = 0;
    bool good = take(f, seed->a, seed->b, vec3_unit(seed->normal));
    while (good && f->stack.count > 0) {
      const patch p = f->patches.items[f->stack.items[--f->stack.count]];
      vec3 way = vec3_unit(seed->normal);
      for (size_t s = 0; s < 16 && good; s++) {
        size_t of_a = s % 4, of_b = s / 4; /* 3: the same */
        good = take(f, of_a < 3 ? ra[3 * (size_t)p.a + of_a] / 3 : p.a,
                    of_b < 3 ? rb[3 * (size_t)p.b + of_b] / 3 : p.b, way);
      }
    }
    if (!good) return scree_fail_memory(error, 0, "faces");
    SCREE_TRY(add_face(f, i, k, seed, error));
  }
}

/* ---- what lies in another ---- */

/* How deep a point lies in a part; 0: it does not. */
static double depth_in(const side *s, vec3 p) {
  scree_bvh_hit hit = {.distance2 = INFINITY};
  if (scree_box_distance2(&s->box, p) > 0 || !scree_bvh_holds(&s->bvh, p)) return 0;
  return scree_bvh_closest(&s->bvh, p, &hit) ? sqrt(hit.distance2) : 0;
}

/* At its corners, along its edges and in the middle of its facets. */
static double deepest_in(const side *s, const scree_mesh *mesh, vec3 *where) {
  double most = 0;
  for (size_t h = 0; h < 3 * mesh->triangle_count; h++) {
    vec3 a = scree_mesh_corner(mesh, h / 3, (int)(h % 3)),
         b = scree_mesh_corner(mesh, h / 3, (int)((h + 1) % 3)),
         c = scree_mesh_corner(mesh, h / 3, (int)((h + 2) % 3));
    for (int k = 0; k <= ALONG; k++) {
      vec3 p = k < ALONG ? vec3_lerp(a, b, (double)k / ALONG)
                         : vec3_scale(vec3_add(vec3_add(a, b), c), 1. / 3);
      double depth = depth_in(s, p);
      if (depth > most) most = depth, *where = p;
    }
  }
  return most;
}

static scree_status check_apart(const facing *f, size_t i, size_t k, scree_error *error) {
  vec3 p = {0, 0, 0}, q = {0, 0, 0};
  double in_k = deepest_in(&f->sides[k], f->parts[i].mesh, &p),
         in_i = deepest_in(&f->sides[i], f->parts[k].mesh, &q);
  if (in_i > in_k) in_k = in_i, p = q;
  if (in_k <= f->gap) return SCREE_OK;
  return scree_fail(
      error, SCREE_BAD_MESH,
      "parts '%.60s' and '%.60s' lie %.3g mm deep in each other at (%.4g, %.4g, %.4g) "
      "mm, more than the gap of %.3g mm",
      f->parts[i].name, f->parts[k].name, in_k * 1e3, p.x * 1e3, p.y * 1e3, p.z * 1e3,
      f->gap * 1e3);
}

/* ---- all ---- */

static scree_status work(facing *f, size_t *small, scree_error *error) {
  for (size_t i = 0; i < f->count; i++) {
    const scree_mesh *mesh = f->parts[i].mesh;
    f->sides[i].box = scree_box_of_points(mesh->positions, mesh->vertex_count);
    SCREE_TRY(scree_bvh_build(mesh, &f->sides[i].bvh, error));
    SCREE_TRY(scree_adjacency_build(mesh, &f->sides[i].adjacency, error));
  }
  for (size_t i = 0; i < f->count; i++)
    for (size_t k = i + 1; k < f->count; k++) {
      scree_box near = scree_box_grown(f->sides[i].box, f->gap);
      if (f->parts[i].group == f->parts[k].group || !scree_box_meets(&near, &f->sides[k].box))
        continue;
      SCREE_TRY(check_apart(f, i, k, error));
      SCREE_TRY(find_patches(f, i, k, error));
      SCREE_TRY(gather_faces(f, i, k, small, error));
    }
  return SCREE_OK;
}

scree_status scree_parts_face(const scree_facing_part *parts, size_t count, double gap,
                              scree_fracture *fracture, scree_error *error) {
  if (!(gap > 0 && isfinite(gap)))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a gap of %g m: must be above 0", gap);
  SCREE_SCRATCH_ZERO(side, sides, count, error);
  facing f = {.parts = parts, .sides = sides, .count = count, .gap = gap};
  f.faces.items = fracture->faces;
  f.faces.count = f.faces.capacity = fracture->face_count;
  scree_status status = work(&f, &fracture->small_face_count, error);
  fracture->faces = f.faces.items;
  fracture->face_count = f.faces.count;
  for (size_t i = 0; i < count; i++) {
    scree_bvh_free(&sides[i].bvh);
    scree_adjacency_free(&sides[i].adjacency);
  }
  SCREE_FREE_ALL(f.patches.items, f.corners.items, f.triangles.items, f.stack.items);
  return status;
}
