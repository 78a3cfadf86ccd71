/* Convex pieces by greedy cuts: the part whose hull has most volume beyond its own is cut by the
 * plane that leaves the least volume in both hulls (compare Mamou and Ghorbel 2009, and Wei et al.
 * 2022, who cut voxels or sampled surfaces). The parts are exact: the cutting is a fracture's. As a
 * plane lies between any two of them, their hulls do not meet, and volume and inertia of all are
 * plain sums. */
#include "base/array.h"
#include "base/progress.h"
#include "mesh/fracture/halve.h"
#include "mesh/measure/bounds.h"
#include "mesh/measure/hull.h"
#include "mesh/mesh.h"
#include "particle/mass.h"

/* Planes looked at along an axis, and how often the step around the best is halved then. A plane
 * through vertices counts them to both sides, and one beside them is found: nearer than a cut is
 * moved by would be too near. */
enum { PLANES = 15, ROUNDS = 12 };

typedef struct part {
  scree_mesh solid, hull;
  double excess;
  bool stuck; /* it cannot be cut */
} part;

typedef struct cutting {
  scree_convex_options options;
  double size;
  scree_solid whole;
  struct {
    part *items;
    size_t count, capacity;
  } parts;
  vec3 *points; /* of a side: the part's vertices and where its edges meet the plane */
} cutting;

scree_convex_options scree_default_convex_options(void) {
  return (scree_convex_options){.tolerance = 0.02, .most = 64};
}

void scree_convex_free(scree_convex *convex) {
  for (size_t p = 0; p < convex->piece_count; p++) scree_mesh_free(&convex->pieces[p]);
  scree_free(convex->pieces);
  *convex = (scree_convex){.pieces = NULL};
}

static double along(vec3 p, int axis) {
  return (const double[]){p.x, p.y, p.z}[axis];
}

/* Takes the solid over. */
static scree_status add_part(cutting *c, scree_mesh *solid, scree_error *error) {
  part made = {.solid = *solid};
  double hull, own;
  if (!SCREE_RESERVE(&c->parts, c->parts.count + 1)) return scree_fail_memory(error, 0, "pieces");
  SCREE_TRY(scree_hull_mesh((const vec3 *)(const void *)made.solid.positions,
                            made.solid.vertex_count, &made.hull, error));
  scree_status status = scree_mesh_area_volume(&made.hull, NULL, &hull, error);
  if (status == SCREE_OK) status = scree_mesh_area_volume(&made.solid, NULL, &own, error);
  if (status != SCREE_OK) {
    scree_mesh_free(&made.hull);
    return status;
  }
  made.excess = hull - own;
  c->parts.items[c->parts.count++] = made;
  *solid = (scree_mesh){0};
  return SCREE_OK;
}

/* Volume of the hulls of what lies on both sides of a plane across an axis. */
static scree_status sides(cutting *c, const scree_mesh *m, int axis, double at, double *volume,
                          scree_error *error) {
  *volume = 0;
  for (int side = 0; side < 2; side++) {
    SCREE_CLEANUP(scree_hull_free) scree_hull hull = {0};
    double sign = side ? 1 : -1;
    size_t count = 0;
    for (size_t v = 0; v < m->vertex_count; v++)
      if (sign * (along(scree_mesh_vertex(m, v), axis) - at) >= 0)
        c->points[count++] = scree_mesh_vertex(m, v);
    for (size_t k = 0; k < 3 * m->triangle_count; k++) {
      uint32_t from = m->triangles[k], to = m->triangles[k % 3 == 2 ? k - 2 : k + 1];
      vec3 p = scree_mesh_vertex(m, from), q = scree_mesh_vertex(m, to);
      double a = along(p, axis) - at, b = along(q, axis) - at;
      if (from < to && (a < 0) != (b < 0))
        c->points[count++] = vec3_mad(p, vec3_sub(q, p), a / (a - b));
    }
    if (count < 4) continue;
    SCREE_TRY(scree_hull_build(c->points, count, &hull, error));
    *volume += hull.volume;
  }
  return SCREE_OK;
}

typedef struct plane {
  int axis;
  double at, volume;
} plane;

static scree_status look(cutting *c, const scree_mesh *m, int axis, double at, plane *best,
                         scree_error *error) {
  double volume;
  SCREE_TRY(sides(c, m, axis, at, &volume, error));
  if (volume < best->volume) *best = (plane){axis, at, volume};
  return SCREE_OK;
}

static scree_status best_plane(cutting *c, const scree_mesh *m, plane *best, scree_error *error) {
  vec3 low, high;
  scree_mesh_bounds(m, &low, &high);
  *best = (plane){0, 0, INFINITY};
  SCREE_TRY_ALLOC(c->points, m->vertex_count + 3 * m->triangle_count / 2 + 1, error);
  for (int axis = 0; axis < 3; axis++)
    for (int k = 1; k <= PLANES; k++) {
      double share = (double)k / (PLANES + 1);
      SCREE_TRY(look(c, m, axis, along(low, axis) * (1 - share) + along(high, axis) * share, best,
                     error));
    }
  double step = (along(high, best->axis) - along(low, best->axis)) / (PLANES + 1);
  for (int round = 0; round < ROUNDS; round++) {
    double middle = best->at;
    step /= 2;
    SCREE_TRY(look(c, m, best->axis, middle - step, best, error));
    SCREE_TRY(look(c, m, best->axis, middle + step, best, error));
  }
  return SCREE_OK;
}

/* In place of the part, both sides; a part that cannot be cut, or into too many, stays. */
static scree_status cut(cutting *c, size_t index, scree_error *error) {
  SCREE_CLEANUP(scree_fracture_free) scree_fracture halves = {.pieces = NULL};
  const scree_mesh *solid = &c->parts.items[index].solid;
  scree_error refused;
  plane best;
  scree_status status = best_plane(c, solid, &best, error);
  scree_free(c->points);
  c->points = NULL;
  SCREE_TRY(status);
  vec3 normal = {best.axis == 0, best.axis == 1, best.axis == 2};
  vec3 at = scree_mesh_vertex(solid, 0);
  at = vec3_mad(at, normal, best.at - along(at, best.axis));
  status = scree_mesh_halve(solid, at, normal, c->size, &halves, &refused);
  size_t first = c->parts.count;
  for (size_t p = 0; status == SCREE_OK && halves.piece_count > 1 && p < halves.piece_count; p++)
    status = add_part(c, &halves.pieces[p], &refused);
  if (status == SCREE_OK && halves.piece_count > 1 && c->parts.count - 1 <= c->options.most) {
    scree_mesh_free(&c->parts.items[index].solid);
    scree_mesh_free(&c->parts.items[index].hull);
    c->parts.items[index] = c->parts.items[--c->parts.count];
    return SCREE_OK;
  }
  while (c->parts.count > first) {
    scree_mesh_free(&c->parts.items[--c->parts.count].solid);
    scree_mesh_free(&c->parts.items[c->parts.count].hull);
  }
  c->parts.items[index].stuck = true;
  return status == SCREE_OUT_OF_MEMORY ? scree_fail_memory(error, 0, "pieces") : SCREE_OK;
}

static double norm2(const mat3 *m) {
  double sum = 0;
  for (int i = 0; i < 9; i++) sum += m->m[i / 3][i % 3] * m->m[i / 3][i % 3];
  return sum;
}

/* The inertia tensor of second moments about a point that lies `off` from the centre. */
static mat3 inertia(const scree_solid *s, vec3 off) {
  mat3 second = s->second, made;
  double o[] = {off.x, off.y, off.z}, trace = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) second.m[i][j] += s->volume * o[i] * o[j];
  for (int i = 0; i < 3; i++) trace += second.m[i][i];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) made.m[i][j] = (i == j ? trace : 0) - second.m[i][j];
  return made;
}

/* Both about the mesh's centre. */
static void compare(const cutting *c, scree_convex *out) {
  double volume = 0;
  mat3 sum = {{{0}}}, whole = inertia(&c->whole, (vec3){0, 0, 0});
  for (size_t p = 0; p < c->parts.count; p++) {
    scree_solid s = scree_solid_of_mesh(&c->parts.items[p].hull);
    mat3 one = inertia(&s, vec3_sub(s.centre, c->whole.centre));
    for (int i = 0; i < 9; i++) sum.m[i / 3][i % 3] += one.m[i / 3][i % 3];
    volume += s.volume;
  }
  for (int i = 0; i < 9; i++) sum.m[i / 3][i % 3] -= whole.m[i / 3][i % 3];
  out->volume_error = volume / c->whole.volume - 1;
  out->inertia_error = sqrt(norm2(&sum) / norm2(&whole));
  out->within = fmax(fabs(out->volume_error), out->inertia_error) <= c->options.tolerance;
}

static scree_status cut_all(cutting *c, scree_ticker *ticker, scree_convex *out,
                            scree_error *error) {
  for (;;) {
    size_t worst = SIZE_MAX, count = c->parts.count;
    compare(c, out);
    for (size_t p = 0; p < count; p++)
      if (!c->parts.items[p].stuck &&
          (worst == SIZE_MAX || c->parts.items[p].excess > c->parts.items[worst].excess))
        worst = p;
    if (out->within || count >= c->options.most || worst == SIZE_MAX) return SCREE_OK;
    if (!scree_tick(ticker, "convex pieces", (double)count / (double)c->options.most))
      return scree_fail(error, SCREE_CANCELLED, "cancelled");
    SCREE_TRY(cut(c, worst, error));
  }
}

scree_status scree_mesh_convex(const scree_mesh *mesh, const scree_convex_options *options,
                               const scree_progress *progress, scree_convex *convex,
                               scree_error *error) {
  cutting c = {.options = options ? *options : scree_default_convex_options()};
  scree_ticker ticker = {progress, 0};
  scree_convex made = {.pieces = NULL};
  scree_topology t;
  scree_mesh solid;
  vec3 low, high;
  if (!(c.options.tolerance >= 0) || c.options.most < 1 || c.options.most > 1024)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "tolerance %g and %zu pieces: must be at least 0, and 1 to 1024",
                      c.options.tolerance, c.options.most);
  SCREE_TRY(scree_mesh_topology(mesh, &t, error));
  c.whole = scree_solid_of_mesh(mesh);
  if (!t.closed || !t.oriented || !(c.whole.volume > 0))
    return scree_fail(error, SCREE_BAD_MESH,
                      "has no convex pieces: the surface is open or inside out; repair it first");
  scree_mesh_bounds(mesh, &low, &high);
  c.size = vec3_norm(vec3_sub(high, low));
  SCREE_TRY(scree_mesh_copy(mesh, &solid, error));
  scree_status status = add_part(&c, &solid, error);
  if (status != SCREE_OK) scree_mesh_free(&solid);
  if (status == SCREE_OK) status = cut_all(&c, &ticker, &made, error);
  if (status == SCREE_OK && !(made.pieces = scree_alloc(c.parts.count, sizeof *made.pieces)))
    status = scree_fail_memory(error, 0, "pieces");
  for (size_t p = 0; p < c.parts.count; p++) {
    scree_mesh_free(&c.parts.items[p].solid);
    if (status == SCREE_OK)
      made.pieces[made.piece_count++] = c.parts.items[p].hull;
    else
      scree_mesh_free(&c.parts.items[p].hull);
  }
  scree_free(c.parts.items);
  if (status == SCREE_OK) *convex = made;
  return status;
}
