/* Exact triangle-triangle tests on signs of orientation determinants.
 *
 * Fast path: a plane through an edge of one triangle, upright on its own plane's dominant axis, or
 * the plane of one triangle, has the other strictly on its far side; all with the filters alone.
 *
 * Two triangles in different planes meet only on the line common to the planes. Where each has
 * corners strictly on both sides of the other's plane, each cuts an interval from that line, and
 * two more signs tell the order of the interval ends (O. Devillers and P. Guigue, "Faster
 * triangle-triangle intersection tests", INRIA RR-4488, 2002). Where one only rests a corner or an
 * edge on the other's plane, the question is asked of that corner or edge in the plane.
 *
 * In one plane, both convex: their interiors are apart exactly where an edge of one has the other
 * on its outer side, the closed triangles where it has it strictly there (separating axes); this is
 * asked in the projection along an axis that the plane is not parallel to.
 *
 * Triangles that share a vertex v have a convex intersection with v in it; what it has beyond v
 * reaches an edge that is opposite to v. Those that share an edge meet beyond it only when folded
 * flat. */
#include "mesh/index/intersect.h"

/* A pair prepared: corners with the shared ones in front, in the same order. */
typedef struct pair {
  const double *t[3], *u[3];
  int shared;
} pair;

static pair prepare(const double *positions, const uint32_t t[3], const uint32_t u[3]) {
  pair p = {.shared = 0};
  int t_order[3], u_order[3], rest = 0;
  bool u_used[3] = {false, false, false};
  for (int i = 0; i < 3; i++) {
    int match = -1;
    for (int j = 0; j < 3; j++)
      if (t[i] == u[j] && !u_used[j]) match = j;
    if (match >= 0) {
      u_used[match] = true;
      t_order[p.shared] = i;
      u_order[p.shared++] = match;
    } else {
      t_order[2 - rest++] = i;
    }
  }
  for (int j = 0, end = 2; j < 3; j++)
    if (!u_used[j]) u_order[end--] = j;
  for (int i = 0; i < 3; i++) {
    p.t[i] = positions + 3 * (size_t)t[t_order[i]];
    p.u[i] = positions + 3 * (size_t)u[u_order[i]];
  }
  return p;
}

/* ---- In the plane ---- */

/* The axis along which the triangle's projection is largest, by plain arithmetic. */
static int dominant_axis(const double *const t[3]) {
  double ax = t[1][0] - t[0][0], ay = t[1][1] - t[0][1], az = t[1][2] - t[0][2];
  double bx = t[2][0] - t[0][0], by = t[2][1] - t[0][1], bz = t[2][2] - t[0][2];
  double nx = fabs(ay * bz - az * by), ny = fabs(az * bx - ax * bz), nz = fabs(ax * by - ay * bx);
  return nx >= ny && nx >= nz ? 0 : ny >= nz ? 1 : 2;
}

/* A point dropped along an axis. */
typedef struct flat {
  double p[2];
} flat;

static flat drop(const double *p, int axis) {
  return (flat){{p[axis == 0 ? 1 : 0], p[axis == 2 ? 1 : 2]}};
}

static int turn(flat a, flat b, flat c) {
  return scree_orient2(a.p, b.p, c.p);
}

static void drop_triangle(const double *const t[3], int axis, flat out[3]) {
  for (int i = 0; i < 3; i++) out[i] = drop(t[i], axis);
}

/* An axis along which the triangle keeps an area, and its turning there; 0: it has no area. */
static int projection_of(const double *const t[3], int *axis) {
  flat f[3];
  int first = dominant_axis(t);
  for (int i = 0; i < 3; i++) {
    *axis = (first + i) % 3;
    drop_triangle(t, *axis, f);
    int turning = turn(f[0], f[1], f[2]);
    if (turning) return turning;
  }
  return 0;
}

/* How far an edge of triangle t keeps the points apart from it: 2 strictly, 1 with touching, 0 not
 * at all. */
static int apart_by_edges(const flat t[3], int turning, int count, const flat *points) {
  int best = 0;
  for (int i = 0; i < 3 && best < 2; i++) {
    int apart = 2;
    for (int j = 0; j < count && apart; j++) {
      int side = turning * turn(t[i], t[(i + 1) % 3], points[j]);
      apart = side > 0 ? 0 : side == 0 ? 1 : apart;
    }
    if (apart > best) best = apart;
  }
  return best;
}

/* Whether the closed segment a b and the closed triangle have a point in common. */
static bool segment_meets(const flat t[3], int turning, flat a, flat b) {
  flat ends[2] = {a, b};
  if (apart_by_edges(t, turning, 2, ends) == 2) return false;
  int sides[3];
  for (int i = 0; i < 3; i++) sides[i] = turn(a, b, t[i]);
  return !(sides[0] == sides[1] && sides[1] == sides[2] && sides[0]);
}

/* Both triangles in one plane. */
static scree_meet meet_coplanar(const pair *p) {
  int axis;
  int t_turning = projection_of(p->t, &axis);
  if (!t_turning) return SCREE_MEET_NOT;
  flat t[3], u[3];
  drop_triangle(p->t, axis, t);
  drop_triangle(p->u, axis, u);
  int u_turning = turn(u[0], u[1], u[2]);
  if (!u_turning) return SCREE_MEET_NOT;
  int apart = apart_by_edges(t, t_turning, 3, u);
  if (apart < 2) {
    int other = apart_by_edges(u, u_turning, 3, t);
    if (other > apart) apart = other;
  }
  if (apart == 0) return SCREE_MEET_OVERLAP;
  if (apart == 2 || p->shared >= 2) return SCREE_MEET_NOT;
  if (p->shared == 0) return SCREE_MEET_TOUCH;
  bool beyond = segment_meets(u, u_turning, t[1], t[2]) || segment_meets(t, t_turning, u[1], u[2]);
  return beyond ? SCREE_MEET_TOUCH : SCREE_MEET_NOT;
}

/* ---- In space ---- */

/* Signs of u's corners against the plane of t, as far as the filter or exact arithmetic tells. */
static void sides_of(const double *const t[3], const double *const u[3], int shared, int side[3]) {
  for (int i = 0; i < 3; i++) side[i] = i < shared ? 0 : scree_orient3(t[0], t[1], t[2], u[i]);
}

static bool straddles(const int side[3]) {
  bool above = side[0] > 0 || side[1] > 0 || side[2] > 0;
  bool below = side[0] < 0 || side[1] < 0 || side[2] < 0;
  return above && below;
}

/* Turns the corners so that the first is alone strictly on its side. */
static void apex_first(const double *const t[3], const int side[3], const double *out[3],
                       int *apex_side) {
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    if (!side[i] || side[j] == side[i] || side[k] == side[i]) continue;
    out[0] = t[i], out[1] = t[j], out[2] = t[k];
    *apex_side = side[i];
    return;
  }
}

static void exchange(const double *t[3]) {
  const double *keep = t[1];
  t[1] = t[2];
  t[2] = keep;
}

/* Each straddles the plane of the other: compare the intervals on the common line. */
static scree_meet meet_intervals(const pair *p, const int t_side[3], const int u_side[3]) {
  const double *t[3] = {p->t[0], p->t[1], p->t[2]}, *u[3] = {p->u[0], p->u[1], p->u[2]};
  int t_apex = 0, u_apex = 0;
  apex_first(p->t, t_side, t, &t_apex);
  apex_first(p->u, u_side, u, &u_apex);
  /* each apex on the side that the other's normal points to */
  if (t_apex < 0) exchange(u);
  if (u_apex < 0) exchange(t);
  int first = scree_orient3(t[0], t[1], u[0], u[1]);
  if (first > 0) return SCREE_MEET_NOT;
  int second = scree_orient3(t[0], t[2], u[2], u[0]);
  if (second > 0) return SCREE_MEET_NOT;
  return first && second ? SCREE_MEET_CROSS : SCREE_MEET_TOUCH;
}

/* t only rests on the plane of u, with one corner or one edge. */
static scree_meet meet_resting(const double *const t[3], const int t_side[3],
                               const double *const u[3], int shared) {
  int axis, count = 0;
  int turning = projection_of(u, &axis);
  if (!turning) return SCREE_MEET_NOT;
  flat f[3], ends[2], seen[3];
  drop_triangle(u, axis, f);
  drop_triangle(t, axis, seen);
  for (int i = shared; i < 3; i++)
    if (!t_side[i] && count < 2) ends[count++] = seen[i];
  if (count == 0) return SCREE_MEET_NOT;
  if (shared == 1) {
    /* the edge from the shared corner f[0] to ends[0] enters the wedge between f[1] and f[2] */
    bool enters =
        turning * turn(f[0], f[1], ends[0]) >= 0 && turning * turn(f[0], ends[0], f[2]) >= 0;
    return enters ? SCREE_MEET_TOUCH : SCREE_MEET_NOT;
  }
  return segment_meets(f, turning, ends[0], ends[count - 1]) ? SCREE_MEET_TOUCH : SCREE_MEET_NOT;
}

/* Both straddle and share corner 0: does an opposite edge pass through the other triangle? */
static bool opposite_edge_enters(const double *const t[3], const double *const u[3]) {
  int a = scree_orient3(t[1], t[2], u[0], u[1]);
  int b = scree_orient3(t[1], t[2], u[1], u[2]);
  int c = scree_orient3(t[1], t[2], u[2], u[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/* ---- The fast path ---- */

/* Whether an edge of t, in the projection along t's dominant axis, certainly has the corners of u
 * beyond it (shared ones on it, and then no other contact is possible on that side). */
static bool surely_beyond_edge(const double *const t[3], const double *const u[3], int shared) {
  int axis = dominant_axis(t);
  flat f[3], g[3];
  drop_triangle(t, axis, f);
  drop_triangle(u, axis, g);
  int turning = scree_orient2_sure(f[0].p, f[1].p, f[2].p);
  if (!turning) return false;
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    /* the shared corners must lie on the edge's line */
    bool usable = shared == 0 || (shared == 1 && (i == 0 || j == 0)) || (shared == 2 && i == 0);
    bool beyond = usable;
    for (int k = shared; k < 3 && beyond; k++)
      beyond = turning * scree_orient2_sure(f[i].p, f[j].p, g[k].p) < 0;
    if (beyond) return true;
  }
  return false;
}

/* Whether u certainly lies on one side of t's plane but for what they share. */
static bool surely_off_plane(const double *const t[3], const double *const u[3], int shared) {
  int side = scree_orient3_sure(t[0], t[1], t[2], u[shared]);
  for (int i = shared + 1; i < 3 && side; i++)
    if (scree_orient3_sure(t[0], t[1], t[2], u[i]) != side) side = 0;
  return side != 0;
}

static bool surely_apart(const pair *p) {
  if (p->shared == 3) return false;
  if (surely_off_plane(p->t, p->u, p->shared)) return true;
  if (p->shared < 2 && surely_off_plane(p->u, p->t, p->shared)) return true;
  return surely_beyond_edge(p->t, p->u, p->shared) || surely_beyond_edge(p->u, p->t, p->shared);
}

/* ---- The whole ---- */

scree_meet scree_triangles_meet(const double *positions, const uint32_t t[3], const uint32_t u[3]) {
  pair p = prepare(positions, t, u);
  if (surely_apart(&p)) return SCREE_MEET_NOT;
  int t_side[3], u_side[3];
  sides_of(p.t, p.u, p.shared, u_side);
  if (!u_side[0] && !u_side[1] && !u_side[2]) {
    sides_of(p.u, p.t, p.shared, t_side);
    return t_side[0] || t_side[1] || t_side[2] ? SCREE_MEET_NOT : meet_coplanar(&p);
  }
  if (p.shared >= 2) return SCREE_MEET_NOT;
  sides_of(p.u, p.t, p.shared, t_side);
  /* u has no area: its plane is none */
  if (!t_side[0] && !t_side[1] && !t_side[2]) return SCREE_MEET_NOT;
  if (!straddles(t_side)) return meet_resting(p.t, t_side, p.u, p.shared);
  if (!straddles(u_side)) return meet_resting(p.u, u_side, p.t, p.shared);
  if (p.shared == 0) return meet_intervals(&p, t_side, u_side);
  bool enters = opposite_edge_enters(p.t, p.u) || opposite_edge_enters(p.u, p.t);
  return enters ? SCREE_MEET_CROSS : SCREE_MEET_NOT;
}
