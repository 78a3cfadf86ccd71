#include "simplify/fan.h"

static bool push(scree_fan *f, uint32_t h) {
  if (f->count == SCREE_FAN_MAX) return false;
  f->edge[f->count++] = h;
  return true;
}

/* Triangles counter-clockwise after outgoing half-edge g up to the one with `stop`; *open: met a
 * boundary. */
static bool push_turning_left(const scree_halfmesh *s, scree_fan *f, uint32_t g, uint32_t stop,
                              bool *open) {
  for (;;) {
    g = scree_turn(s, g);
    *open = g == SCREE_NONE;
    if (*open || g == stop) return true;
    if (!push(f, scree_next(g))) return false;
  }
}

/* Triangles clockwise before g up to a boundary, listed counter-clockwise. */
static bool push_turning_right(const scree_halfmesh *s, scree_fan *f, uint32_t g) {
  uint32_t begin = f->count;
  while (s->half[g].twin != SCREE_NONE) {
    g = scree_next(s->half[g].twin);
    if (!push(f, scree_next(g))) return false;
  }
  for (uint32_t i = begin, j = f->count; i + 1 < j; i++) {
    uint32_t swapped = f->edge[i];
    f->edge[i] = f->edge[--j];
    f->edge[j] = swapped;
  }
  return true;
}

static void name(const scree_halfmesh *s, uint32_t h, scree_fan *f) {
  uint32_t twin = s->half[h].twin;
  f->half_edge = h;
  f->a = s->half[h].from;
  f->b = scree_to(s, h);
  f->c = s->half[scree_previous(h)].from;
  f->d = twin == SCREE_NONE ? SCREE_NONE : s->half[scree_previous(twin)].from;
  f->count = 0;
}

static void place(const scree_halfmesh *s, scree_fan *f) {
  vec3 a = s->vertex[f->a].at, b = s->vertex[f->b].at;
  for (uint32_t i = 0; i < f->count; i++) {
    f->from[i] = s->vertex[s->half[f->edge[i]].from].at;
    f->to[i] = s->vertex[scree_to(s, f->edge[i])].at;
    f->before[i] = vec3_triangle_normal(i < f->a_count ? a : b, f->from[i], f->to[i]);
  }
}

bool scree_fan_of_edge(const scree_halfmesh *s, uint32_t h, scree_fan *f) {
  uint32_t twin = s->half[h].twin;
  bool open;
  name(s, h, f);
  uint32_t at_d = twin == SCREE_NONE ? SCREE_NONE : scree_next(twin); /* a -> d */
  if (!push_turning_left(s, f, h, at_d, &open)) return false;
  if (open && twin != SCREE_NONE && !push_turning_right(s, f, at_d)) return false;
  f->a_count = f->count;
  open = true;
  if (twin != SCREE_NONE && !push_turning_left(s, f, twin, scree_next(h), &open)) return false;
  if (open && !push_turning_right(s, f, scree_next(h))) return false;
  place(s, f);
  return true;
}

bool scree_fan_of_vertex(const scree_halfmesh *s, uint32_t v, scree_fan *f) {
  uint32_t h = s->vertex[v].outgoing;
  bool open;
  f->half_edge = h;
  f->a = f->b = v;
  f->c = f->d = SCREE_NONE;
  f->count = 0;
  bool room = push(f, scree_next(h)) && push_turning_left(s, f, h, h, &open);
  f->a_count = f->count;
  if (!room || open) return false;
  place(s, f);
  return true;
}

void scree_fan_set(scree_fan *f, vec3 at) {
  f->at = at;
  for (uint32_t i = 0; i < f->count; i++)
    f->after[i] = vec3_triangle_normal(at, f->from[i], f->to[i]);
}

scree_bounds scree_fan_bounds(const scree_fan *f, uint32_t i) {
  scree_bounds b = scree_bounds_empty();
  scree_bounds_add(&b, f->at);
  scree_bounds_add(&b, f->from[i]);
  scree_bounds_add(&b, f->to[i]);
  return b;
}

void scree_fan_measure(const scree_halfmesh *s, const scree_fan *f, double *area, double *volume) {
  vec3 a = s->vertex[f->a].at, b = s->vertex[f->b].at;
  double doubled = 0, six = 0;
  for (uint32_t i = 0; i < f->count; i++) {
    doubled += vec3_norm(f->after[i]) - vec3_norm(f->before[i]);
    six += vec3_dot(f->before[i], vec3_sub(f->at, i < f->a_count ? a : b));
  }
  for (uint32_t k = f->count; k < scree_fan_triangle_count(f); k++) {
    vec3 n = scree_normal_of(s, scree_fan_triangle(s, f, k));
    doubled -= vec3_norm(n);
    six += vec3_dot(n, vec3_sub(f->at, a));
  }
  *area = 0.5 * doubled;
  *volume = six / 6;
}

/* The corners of these edges of the ring beside c and d, as vertices of the mesh given. */
static uint32_t list_neighbours(const scree_halfmesh *s, const scree_fan *f, uint32_t begin,
                                uint32_t end, uint32_t *origins) {
  uint32_t count = 0, last = SCREE_NONE;
  for (uint32_t i = 2 * begin; i < 2 * end; i++) {
    uint32_t e = f->edge[i / 2], v = i % 2 ? scree_to(s, e) : s->half[e].from;
    if (v != last && v != f->c && v != f->d) origins[count++] = s->vertex[v].origin;
    last = v;
  }
  return count;
}

bool scree_fan_keeps_topology(const scree_halfmesh *s, const scree_fan *f) {
  if ((s->flags[f->a] | s->flags[f->b]) & SCREE_VERTEX_LOCKED) return false;
  if (f->count < 3 && s->half[f->half_edge].twin != SCREE_NONE && !scree_on_boundary(s, f->a) &&
      !scree_on_boundary(s, f->b))
    return false;
  if (f->count == 0) return false;
  uint32_t h = f->half_edge, twin = s->half[h].twin;
  if (twin != SCREE_NONE && scree_on_boundary(s, f->a) && scree_on_boundary(s, f->b)) return false;
  /* a triangle that hangs on by the edge alone would leave its apex without triangles */
  if (s->half[scree_next(h)].twin == SCREE_NONE && s->half[scree_previous(h)].twin == SCREE_NONE)
    return false;
  if (twin != SCREE_NONE && s->half[scree_next(twin)].twin == SCREE_NONE &&
      s->half[scree_previous(twin)].twin == SCREE_NONE)
    return false;
  uint32_t origin_c = s->vertex[f->c].origin,
           origin_d = f->d == SCREE_NONE ? SCREE_NONE : s->vertex[f->d].origin;
  if (origin_c == origin_d) return false;
  uint32_t of_a[SCREE_FAN_MAX + 1], of_b[SCREE_FAN_MAX + 1];
  uint32_t a_count = list_neighbours(s, f, 0, f->a_count, of_a);
  uint32_t b_count = list_neighbours(s, f, f->a_count, f->count, of_b);
  for (uint32_t i = 0; i < a_count; i++) {
    if (of_a[i] == origin_c || of_a[i] == origin_d) return false;
    for (uint32_t j = 0; j < b_count; j++)
      if (of_a[i] == of_b[j]) return false;
  }
  for (uint32_t j = 0; j < b_count; j++)
    if (of_b[j] == origin_c || of_b[j] == origin_d) return false;
  return true;
}

/* Joins the neighbours across the two other sides of the triangle of h, which goes. The apex may
 * need another outgoing half-edge. */
static void close_gap(scree_halfmesh *s, uint32_t h) {
  uint32_t next = scree_next(h), previous = scree_previous(h);
  uint32_t x = s->half[next].twin, y = s->half[previous].twin, apex = s->half[previous].from;
  if (x != SCREE_NONE) s->half[x].twin = y;
  if (y != SCREE_NONE) s->half[y].twin = x;
  if (s->vertex[apex].outgoing == previous)
    s->vertex[apex].outgoing = x != SCREE_NONE ? x : scree_next(y);
  for (uint32_t i = 0; i < 3; i++) s->half[h - h % 3 + i].from = SCREE_NONE;
}

void scree_fan_collapse(scree_halfmesh *s, const scree_fan *f) {
  uint32_t twin = s->half[f->half_edge].twin;
  for (uint32_t i = f->a_count; i < f->count; i++) s->half[scree_previous(f->edge[i])].from = f->a;
  close_gap(s, f->half_edge);
  if (twin != SCREE_NONE) close_gap(s, twin);
  s->vertex[f->a].at = f->at;
  s->vertex[f->a].outgoing = scree_previous(f->edge[0]);
  for (uint32_t i = 0; i < f->count; i++)
    if (s->half[scree_previous(f->edge[i])].twin == SCREE_NONE)
      s->vertex[f->a].outgoing = scree_previous(f->edge[i]);
  s->vertex[f->b].outgoing = SCREE_NONE;
  s->flags[f->a] |= s->flags[f->b] & SCREE_VERTEX_MARKER;
}
