/* The least-volume box has two adjacent faces flush with edges of the hull (O'Rourke 1985, "Finding
 * minimal enclosing boxes"); its exact search is cubic in the edges. Here, as in the local step of
 * Chang, Gorissen and Melchior 2011 ("Fast oriented bounding box optimization on the rotation group
 * SO(3,R)"), a box is improved by keeping one axis and laying the least-area rectangle around the
 * projection along it (rotating calipers; Freeman and Shapira 1975: one side is flush with an edge
 * of the 2D hull), for each axis in turn until none gains; then by small turns about its axes.
 * Starts are the normals of the hull's faces, largest first, the given axes, the coordinate axes,
 * and for hulls of few edges the common normals of all pairs of edges. So the result is exact for
 * boxes, prisms and the regular tetrahedron, the least of all boxes flush with a face where the
 * hull has few faces, and else a local minimum, in practice within a few per cent of the least
 * volume. Starts are worked on side by side, each by one worker, and compared in their order. */
#include "mesh/measure/bounds.h"

#include "base/array.h"
#include "base/eigen.h"
#include "base/parallel.h"
#include "base/radix.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum {
  FACE_STARTS = 64,           /* face normals tried at most */
  EDGE_LIMIT = 60,            /* hull triangles' edges; above, no pairs of edges are tried */
  DESCENTS = 12,              /* best starts that are improved */
  ROUNDS = 32,                /* of improvement; a handful in practice */
  PROJECTION_BUDGET = 1 << 22 /* points projected over all starts: about a second */
};
#define FACING_SLOP    1e-14 /* of two sides, see set_facings */
#define SAME_DIRECTION 1e-9  /* 1 - cosine below which two normals are one start */
#define GAIN           1e-12 /* relative, below which a round has not improved the box */
#define FIRST_TURN     0.4   /* rad */
#define LAST_TURN      1e-3

typedef struct point2 {
  double x, y;
} point2;

/* A triangle's normal, not of unit length, and the most by which rounding may change its product
 * with a unit vector. */
typedef struct facing {
  vec3 normal;
  double slop;
} facing;

/* A direction to start from. */
typedef struct start {
  vec3 axis;
  mat3 axes;
  double rank; /* low is good: minus the area of the face, later the volume of the box */
} start;

/* One worker's: the hull, and room. */
typedef struct fitter {
  const scree_hull *hull;
  const facing *facings; /* of the hull's triangles */
  unsigned char *sides;  /* of each corner: which it shows, see gather_outline */
  point2 *projected, *outline;
} fitter;

SCREE_ORDER_BY2(compare_points, point2, x, y)

static double turn(point2 a, point2 b, point2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* Andrew's monotone chain, counter-clockwise, without the last point repeated. */
static size_t hull2(point2 *points, size_t count, point2 *outline) {
  qsort(points, count, sizeof *points, compare_points);
  size_t n = 0;
  for (size_t i = 0; i < count; i++) {
    while (n >= 2 && turn(outline[n - 2], outline[n - 1], points[i]) <= 0) n--;
    outline[n++] = points[i];
  }
  size_t lower = n + 1;
  for (size_t i = count - 1; i-- > 0;) {
    while (n >= lower && turn(outline[n - 2], outline[n - 1], points[i]) <= 0) n--;
    outline[n++] = points[i];
  }
  return n > 1 ? n - 1 : n;
}

/* The direction of one side of the least-area rectangle around a convex outline. The farthest point
 * in each of three directions only moves forward as the edge does. */
static point2 best_side(const point2 *outline, size_t n) {
  point2 best = {1, 0};
  double least = INFINITY;
  size_t far[3] = {0, 0, 0};
  for (size_t i = 0; i < n; i++) {
    point2 p = outline[i], q = outline[(i + 1) % n];
    double x = q.x - p.x, y = q.y - p.y;
    double length = sqrt(x * x + y * y); /* unlike hypot the same bits everywhere */
    if (length == 0) continue;
    point2 u = {x / length, y / length};
    const point2 direction[3] = {u, {-u.y, u.x}, {-u.x, -u.y}};
    double reach[3];
    for (int d = 0; d < 3; d++) {
      if (d > 0 && i == 0) far[d] = far[d - 1];
      for (size_t step = 0; step < n; step++) {
        point2 here = outline[far[d] % n], next = outline[(far[d] + 1) % n];
        if ((next.x - here.x) * direction[d].x + (next.y - here.y) * direction[d].y <= 0) break;
        far[d]++;
      }
      point2 at = outline[far[d] % n];
      reach[d] = (at.x - p.x) * direction[d].x + (at.y - p.y) * direction[d].y;
    }
    double area = (reach[0] + reach[2]) * reach[1];
    if (area < least) least = area, best = u;
  }
  return best;
}

enum { FRONT = 1, BACK = 2 };

/* Projects the corners that may lie on the outline seen along w: where all triangles about a corner
 * face the same way for sure, it projects inside. Without triangles all may. */
static size_t gather_outline(fitter *f, vec3 u, vec3 v, vec3 w) {
  const scree_hull *hull = f->hull;
  size_t count = 0;
  memset(f->sides, hull->triangle_count ? 0 : FRONT | BACK, hull->point_count);
  for (size_t t = 0; t < hull->triangle_count; t++) {
    double height = vec3_dot(f->facings[t].normal, w), slop = f->facings[t].slop;
    int shown = (height < -slop ? 0 : FRONT) | (height > slop ? 0 : BACK);
    for (size_t k = 0; k < 3; k++) f->sides[hull->triangles[3 * t + k]] |= (unsigned char)shown;
  }
  for (size_t i = 0; i < hull->point_count; i++)
    if (f->sides[i] == (FRONT | BACK))
      f->projected[count++] = (point2){vec3_dot(hull->points[i], u), vec3_dot(hull->points[i], v)};
  return count;
}

/* Keeps direction w; turns the other two into those of the least rectangle. */
static mat3 fit_about(fitter *f, vec3 w) {
  vec3 u, v;
  vec3_frame(w, &u, &v);
  size_t n = hull2(f->projected, gather_outline(f, u, v, w), f->outline);
  point2 side = best_side(f->outline, n);
  vec3 first = vec3_unit(vec3_add(vec3_scale(u, side.x), vec3_scale(v, side.y)));
  mat3 axes;
  vec3_store(axes.m[0], first);
  vec3_store(axes.m[1], vec3_cross(w, first));
  vec3_store(axes.m[2], w);
  return axes;
}

static void extents(const scree_hull *hull, const mat3 *axes, vec3 *low, vec3 *high) {
  *low = (vec3){INFINITY, INFINITY, INFINITY};
  *high = vec3_neg(*low);
  for (size_t i = 0; i < hull->point_count; i++) {
    vec3 p = mat3_mul_vec(axes, hull->points[i]);
    *low = vec3_min(*low, p);
    *high = vec3_max(*high, p);
  }
}

/* Volume; for flat point sets, where it is 0, a multiple of the area of the face decides. */
static double cost(const scree_hull *hull, const mat3 *axes) {
  vec3 low, high;
  extents(hull, axes, &low, &high);
  vec3 d = vec3_sub(high, low);
  double surface = d.x * d.y + d.y * d.z + d.z * d.x;
  return d.x * d.y * d.z + 1e-14 * surface * sqrt(surface);
}

static double descend(fitter *f, mat3 *axes) {
  double least = cost(f->hull, axes);
  for (int round = 0, idle = 0; round < ROUNDS && idle < 3; round++) {
    mat3 tried = fit_about(f, vec3_load(axes->m[round % 3]));
    double found = cost(f->hull, &tried);
    bool better = found < least * (1 - GAIN);
    idle = better ? 0 : idle + 1;
    if (!better) continue;
    /* keep the rows in place, so that round % 3 goes through all of them */
    for (int i = 0; i < 3; i++) {
      int from = (i - round % 3 + 5) % 3;
      for (int k = 0; k < 3; k++) axes->m[i][k] = tried.m[from][k];
    }
    least = found;
  }
  return least;
}

/* Small turns about the box's own axes, ever smaller, then a descent: gets off the ridges on which
 * a descent stops. */
static double settle(fitter *f, mat3 *axes) {
  double least = descend(f, axes);
  for (double step = FIRST_TURN; step > LAST_TURN; step /= 2)
    for (int axis = 0; axis < 3; axis++)
      for (int way = -1; way <= 1; way += 2) {
        vec3 r = {axis == 0 ? way * step : 0, axis == 1 ? way * step : 0,
                  axis == 2 ? way * step : 0};
        mat3 turn = quat_to_mat3(quat_from_rotation_vector(r)), tried = mat3_mul(&turn, axes);
        if (cost(f->hull, &tried) >= least * (1 - GAIN)) continue;
        *axes = tried;
        least = descend(f, axes);
      }
  return least;
}

/* ---- Starts ---- */

typedef struct start_list {
  start *items;
  size_t count, capacity;
} start_list;

SCREE_ORDER_BY(compare_starts, start, rank)

static bool push_direction(start_list *list, vec3 direction, double rank) {
  double length = vec3_norm(direction);
  return length == 0 ||
         SCREE_PUSH(list, (start){.axis = vec3_scale(direction, 1 / length), .rank = rank});
}

/* The normals of the largest faces, each once. */
static bool push_faces(start_list *list, const scree_hull *hull) {
  start_list faces = {0};
  bool pushed = true;
  for (size_t t = 0; t < hull->triangle_count && pushed; t++) {
    const uint32_t *c = hull->triangles + 3 * t;
    vec3 normal = vec3_triangle_normal(hull->points[c[0]], hull->points[c[1]], hull->points[c[2]]);
    pushed = push_direction(&faces, normal, -vec3_norm(normal));
  }
  if (faces.count) qsort(faces.items, faces.count, sizeof *faces.items, compare_starts);
  for (size_t i = 0; i < faces.count && list->count < FACE_STARTS && pushed; i++) {
    bool known = false;
    for (size_t k = 0; k < list->count && !known; k++)
      known = fabs(vec3_dot(list->items[k].axis, faces.items[i].axis)) > 1 - SAME_DIRECTION;
    if (!known) pushed = SCREE_PUSH(list, faces.items[i]);
  }
  scree_free(faces.items);
  return pushed;
}

static vec3 hull_edge(const scree_hull *hull, size_t h) {
  size_t next = h % 3 == 2 ? h - 2 : h + 1;
  return vec3_sub(hull->points[hull->triangles[next]], hull->points[hull->triangles[h]]);
}

/* The common normals of all pairs of edges; each edge comes twice, once from either side. */
static bool push_edge_pairs(start_list *list, const scree_hull *hull) {
  size_t edge_count = 3 * hull->triangle_count;
  bool pushed = true;
  if (edge_count > EDGE_LIMIT) return true;
  for (size_t i = 0; i < edge_count; i++)
    for (size_t j = 0; j < i && pushed; j++)
      if (hull->triangles[i] < hull->triangles[i % 3 == 2 ? i - 2 : i + 1])
        pushed = push_direction(list, vec3_cross(hull_edge(hull, i), hull_edge(hull, j)), 0);
  return pushed;
}

static bool push_starts(start_list *list, const scree_hull *hull, const mat3 *axes) {
  bool pushed = push_faces(list, hull) && push_edge_pairs(list, hull);
  size_t budget = PROJECTION_BUDGET / (hull->point_count + 1);
  if (list->count > budget) list->count = budget;
  for (int i = 0; i < 3 && pushed; i++) {
    vec3 unit = {i == 0, i == 1, i == 2};
    pushed = push_direction(list, unit, 0) && push_direction(list, vec3_load(axes->m[i]), 0);
  }
  return pushed;
}

/* ---- The whole ---- */

static void consider(const scree_hull *hull, const mat3 *axes, double *least, mat3 *best) {
  double found = cost(hull, axes);
  if (found < *least) *least = found, *best = *axes;
}

/* What the workers share. */
typedef struct searcher {
  fitter *fitters; /* one for each worker */
  start *starts;
} searcher;

static void fit_starts(void *context, scree_block block) {
  const searcher *s = context;
  fitter *f = &s->fitters[block.worker];
  for (size_t i = block.begin; i < block.end; i++) {
    s->starts[i].axes = fit_about(f, s->starts[i].axis);
    s->starts[i].rank = cost(f->hull, &s->starts[i].axes);
  }
}

static void settle_starts(void *context, scree_block block) {
  const searcher *s = context;
  for (size_t i = block.begin; i < block.end; i++)
    settle(&s->fitters[block.worker], &s->starts[i].axes);
}

static mat3 search(fitter *fitters, start_list *list, const mat3 *axes) {
  const mat3 one = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const scree_hull *hull = fitters->hull;
  searcher s = {fitters, list->items};
  double least = INFINITY;
  mat3 best = one;
  size_t settled = list->count < DESCENTS ? list->count : DESCENTS;
  scree_parallel_for(list->count, 1, fit_starts, &s);
  qsort(list->items, list->count, sizeof *list->items, compare_starts);
  scree_parallel_for(settled, 1, settle_starts, &s);
  for (size_t i = 0; i < settled; i++) consider(hull, &list->items[i].axes, &least, &best);
  consider(hull, axes, &least, &best);
  consider(hull, &one, &least, &best);
  return best;
}

/* Rows in descending order of size, signs canonical. */
static scree_minimum_box finish(const scree_hull *hull, const mat3 *axes) {
  scree_minimum_box box = {.axes = *axes};
  vec3 low, high;
  extents(hull, axes, &low, &high);
  double size[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2 - i; j++)
      if (size[order[j + 1]] > size[order[j]]) {
        int swap = order[j];
        order[j] = order[j + 1];
        order[j + 1] = swap;
      }
  box.center = mat3_tmul_vec(axes, vec3_scale(vec3_add(low, high), 0.5));
  box.size = (vec3){size[order[0]], size[order[1]], size[order[2]]};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) box.axes.m[i][k] = axes->m[order[i]][k];
  scree_frame_canonical(&box.axes);
  return box;
}

/* The error of a normal is below 8 half-units of the product of its two sides, and that of its
 * product with a unit vector below 16: a sixth of FACING_SLOP. */
static void set_facings(const scree_hull *hull, facing *facings) {
  for (size_t t = 0; t < hull->triangle_count; t++) {
    const uint32_t *c = hull->triangles + 3 * t;
    vec3 p = vec3_sub(hull->points[c[1]], hull->points[c[0]]),
         q = vec3_sub(hull->points[c[2]], hull->points[c[0]]);
    facings[t] = (facing){vec3_cross(p, q), FACING_SLOP * vec3_norm(p) * vec3_norm(q) + DBL_MIN};
  }
}

typedef struct fitters {
  fitter *items;
  int count;
} fitters;

static void free_fitters(fitters *f) {
  for (int i = 0; i < f->count; i++) {
    scree_free(f->items[i].sides);
    scree_free(f->items[i].projected);
    scree_free(f->items[i].outline);
  }
  scree_free(f->items);
}

static scree_status make_fitters(const scree_hull *hull, const facing *facings, fitters *made,
                                 scree_error *error) {
  int count = scree_worker_count();
  SCREE_TRY_ALLOC_ZERO(made->items, (size_t)count, error);
  while (made->count < count) {
    fitter *f = &made->items[made->count++];
    f->hull = hull;
    f->facings = facings;
    SCREE_TRY_ALLOC(f->sides, hull->point_count, error);
    SCREE_TRY_ALLOC(f->projected, hull->point_count, error);
    SCREE_TRY_ALLOC(f->outline, 2 * hull->point_count + 2, error);
  }
  return SCREE_OK;
}

scree_status scree_minimum_box_fit(const scree_hull *hull, const mat3 *axes, scree_minimum_box *box,
                                   scree_error *error) {
  SCREE_CLEANUP(free_fitters) fitters f = {0};
  SCREE_CLEANUP(scree_free_at) start_list list = {0};
  SCREE_SCRATCH(facing, facings, hull->triangle_count, error);
  set_facings(hull, facings);
  SCREE_TRY(make_fitters(hull, facings, &f, error));
  if (!push_starts(&list, hull, axes))
    return scree_fail_memory(error, (list.count + 1) * sizeof *list.items, "directions of boxes");
  mat3 best = search(f.items, &list, axes);
  *box = finish(hull, &best);
  return SCREE_OK;
}
