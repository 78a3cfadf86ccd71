/* How coarse levels are settled (simplify/settle.h): the step in all vertices against equations
 * that are put together and solved at full length, and the levels against those left as their
 * collapses made them. */
#include "mesh/intersect.h"
#include "mesh/mesh.h"
#include "simplify/ahead.h"
#include "simplify/ending.h"
#include "simplify/settle.h"
#include "support/decimator.h"
#include "support/shapes.h"

/* What the rules name (simplify/joint.c). */
#define LEAST_DISTANCE 0.1
#define NO_DISTANCE    0.05
#define LOOKED_ABOVE   0.5
#define FAR_SHARE      0.333

enum { KINDS = 4, BOX = 2 };

static scree_mesh two_spheres(void) {
  scree_mesh a = shape_icosphere(0.03, 4), b = shape_icosphere(0.02, 3);
  shape_move(&b, (vec3){0.06, 0.01, 0});
  scree_mesh both = shape_join(&a, &b);
  scree_mesh_free(&a);
  scree_mesh_free(&b);
  return both;
}

static scree_mesh bumpy(int kind) {
  scree_rng rng = {.seed = (uint64_t)kind + 1};
  scree_mesh mesh = kind == 0     ? shape_icosphere(0.03, 4)
                    : kind == 1   ? shape_torus(0.03, 0.011, 64, 28)
                    : kind == BOX ? shape_grid_box(0.06, 0.03, 0.01, 16)
                                  : two_spheres();
  shape_shake(&mesh, 4e-4, &rng);
  return mesh;
}

static scree_decimator decimated(const scree_mesh *mesh, size_t stop, scree_unsettled unsettled,
                                 scree_error *error) {
  scree_decimator d = begin_decimation(mesh, &scree_volume_coster, error);
  d.options.stop_count = stop;
  d.unsettled = unsettled;
  CHECK_OK(scree_decimate_one_by_one(&d), *error);
  return d;
}

/* ---- The step ---- */

typedef struct equations {
  size_t n;   /* three a vertex, and the pressure */
  double *m;  /* n x (n + 1) */
  double *ww; /* per vertex: weighted squares of its shares */
} equations;

/* `off` by so much; n: upright on the triangle, where less than that has no direction of its own.
 */
static void add(equations *q, const uint32_t v[3], const double share[3], vec3 off, vec3 n,
                double weight) {
  double along[3], upright[3], all2 = vec3_norm2(off) + vec3_norm2(n);
  vec3_store(along, off);
  vec3_store(upright, n);
  for (size_t i = 0; i < 3; i++) {
    q->ww[v[i]] += weight * share[i] * share[i];
    for (size_t a = 0; a < 3; a++) {
      double *row = q->m + (3 * v[i] + a) * (q->n + 1);
      row[q->n] += weight * share[i] * along[a];
      for (size_t k = 0; k < 3; k++)
        for (size_t b = 0; b < 3; b++)
          row[3 * v[k] + b] +=
              weight * share[i] * share[k] * (along[a] * along[b] + upright[a] * upright[b]) / all2;
    }
  }
}

static void corners_of(const scree_halfmesh *s, size_t t, double corners[9]) {
  vec3 at[3];
  scree_corners(s, t, at);
  for (size_t i = 0; i < 3; i++) vec3_store(corners + 3 * i, at[i]);
}

/* Of p, a point of the triangle. */
static void shares_of(const double corners[9], vec3 p, double share[3]) {
  vec3 at[3], n;
  for (size_t i = 0; i < 3; i++) at[i] = vec3_load(corners + 3 * i);
  n = vec3_triangle_normal(at[0], at[1], at[2]);
  for (size_t i = 0; i < 3; i++)
    share[i] =
        vec3_dot(n, vec3_triangle_normal(p, at[(i + 1) % 3], at[(i + 2) % 3])) / vec3_norm2(n);
}

static double nearest_kept(const scree_memory *m, vec3 x, vec3 *nearest) {
  *nearest = x;
  double least = INFINITY;
  for (size_t t = 0; t < m->surface.triangle_count; t++) {
    vec3 point;
    double distance2 = scree_triangle_closest(m->surface.corners + 9 * t, x, &point);
    if (!(distance2 < least)) continue;
    least = distance2;
    *nearest = point;
  }
  return least;
}

/* Calls `each` for every vertex and place on an edge. */
typedef void each_place(void *context, const uint32_t v[3], const double share[3], vec3 at);
static void for_places(const scree_halfmesh *s, each_place *each, void *context) {
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    if (s->half[h].from == SCREE_NONE) continue;
    uint32_t a = s->half[h].from, b = scree_to(s, h), v[3] = {a, b, a};
    for (int k = s->vertex[a].outgoing == h ? 0 : 1; k < (h < s->half[h].twin ? 6 : 1); k++) {
      double share[3] = {1 - k / 6.0, k / 6.0, 0};
      each(context, v, share, vec3_lerp(s->vertex[a].at, s->vertex[b].at, k / 6.0));
    }
  }
}

typedef struct places {
  const scree_memory *m;
  double far2, unit, sum;
  size_t count;
  equations *q;
} places;

static void find_far(void *context, const uint32_t v[3], const double share[3], vec3 at) {
  (void)v, (void)share;
  places *p = context;
  vec3 nearest;
  p->far2 = fmax(p->far2, nearest_kept(p->m, at, &nearest));
}

static void sum_far(void *context, const uint32_t v[3], const double share[3], vec3 at) {
  (void)v, (void)share;
  places *p = context;
  vec3 nearest;
  double distance2 = nearest_kept(p->m, at, &nearest);
  if (distance2 > LOOKED_ABOVE * p->far2) p->sum += pow(distance2 / p->far2, 4);
}

static void add_far(void *context, const uint32_t v[3], const double share[3], vec3 at) {
  places *p = context;
  vec3 nearest;
  double distance2 = nearest_kept(p->m, at, &nearest);
  if (!(distance2 > LOOKED_ABOVE * p->far2)) return;
  p->count++;
  add(p->q, v, share, vec3_sub(nearest, at), (vec3){0, 0, 0},
      p->unit * pow(distance2 / p->far2, 3));
}

/* By elimination with pivots. */
static void solve(equations *q) {
  for (size_t i = 0; i < q->n; i++) {
    size_t best = i;
    for (size_t k = i; k < q->n; k++)
      if (fabs(q->m[k * (q->n + 1) + i]) > fabs(q->m[best * (q->n + 1) + i])) best = k;
    for (size_t k = 0; k <= q->n && best != i; k++) {
      double swap = q->m[i * (q->n + 1) + k];
      q->m[i * (q->n + 1) + k] = q->m[best * (q->n + 1) + k];
      q->m[best * (q->n + 1) + k] = swap;
    }
    for (size_t k = 0; k < q->n; k++) {
      double factor = q->m[k * (q->n + 1) + i] / q->m[i * (q->n + 1) + i];
      for (size_t c = i; c <= q->n && k != i; c++)
        q->m[k * (q->n + 1) + c] -= factor * q->m[i * (q->n + 1) + c];
    }
  }
}

/* Fills and solves; far2 is that of the farthest place. Answers how many places are far. */
static size_t full_step(const scree_decimator *d, double damping, vec3 *step, double *far2,
                        double *merit) {
  const scree_halfmesh *s = &d->s;
  const scree_memory *m = &d->memory;
  equations q = {.n = 3 * s->vertex_count + 1};
  places p = {.m = m, .q = &q};
  double mean = 0, weights = 0;
  q.m = calloc(q.n * (q.n + 1), sizeof *q.m);
  q.ww = calloc(s->vertex_count, sizeof *q.ww);
  for (size_t t = 0; t < s->triangle_count; t++)
    for (uint32_t j = scree_is_gone(s, t) ? SCREE_NONE : m->first[t]; j != SCREE_NONE;
         j = m->witnesses[j].next) {
      mean += (double)m->witnesses[j].weight * sqrt(m->witnesses[j].distance2);
      weights += (double)m->witnesses[j].weight;
      p.far2 = fmax(p.far2, m->witnesses[j].distance2);
    }
  for_places(s, find_far, &p);
  for (size_t t = 0; t < s->triangle_count; t++)
    for (uint32_t j = scree_is_gone(s, t) ? SCREE_NONE : m->first[t]; j != SCREE_NONE;
         j = m->witnesses[j].next)
      p.sum += pow(m->witnesses[j].distance2 / p.far2, 4);
  for_places(s, sum_far, &p);
  double far_share = FAR_SHARE / p.sum;
  p.unit = far_share * mean / p.far2;
  mean /= weights;
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    double corners[9], share[3];
    uint32_t v[3];
    corners_of(s, t, corners);
    vec3 n =
        vec3_triangle_normal(vec3_load(corners), vec3_load(corners + 3), vec3_load(corners + 6));
    vec3 upright = vec3_scale(vec3_unit(n), NO_DISTANCE * mean);
    for (size_t i = 0; i < 3; i++) {
      v[i] = s->half[3 * t + i].from;
      double along[3] = {n.x, n.y, n.z};
      for (size_t a = 0; a < 3; a++) {
        q.m[(3 * v[i] + a) * (q.n + 1) + q.n - 1] += along[a];
        q.m[(q.n - 1) * (q.n + 1) + 3 * v[i] + a] += along[a];
      }
    }
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) {
      vec3 nearest;
      double distance = sqrt(scree_triangle_closest(corners, m->witnesses[j].at, &nearest));
      shares_of(corners, nearest, share);
      double weight = (double)m->witnesses[j].weight / fmax(distance, LEAST_DISTANCE * mean) +
                      p.unit * pow(distance * distance / p.far2, 3);
      add(&q, v, share, vec3_sub(m->witnesses[j].at, nearest), upright, weight);
    }
  }
  for_places(s, add_far, &p);
  for (size_t v = 0; v < s->vertex_count; v++)
    for (size_t a = 0; a < 3; a++) {
      double *diagonal = &q.m[(3 * v + a) * (q.n + 1) + 3 * v + a];
      *diagonal += s->vertex[v].outgoing == SCREE_NONE ? 1 : damping * q.ww[v];
    }
  solve(&q);
  for (size_t v = 0; v < s->vertex_count; v++) {
    double y[3];
    for (size_t a = 0; a < 3; a++)
      y[a] = q.m[(3 * v + a) * (q.n + 1) + q.n] / q.m[(3 * v + a) * (q.n + 1) + 3 * v + a];
    step[v] = vec3_load(y);
  }
  *far2 = p.far2;
  *merit = 2 * mean + far_share / 4 * mean * p.sum;
  free(q.m);
  free(q.ww);
  return p.count;
}

static double volume_at(const scree_halfmesh *s, const vec3 *at) {
  double sum = 0;
  for (size_t t = 0; t < s->triangle_count; t++)
    if (!scree_is_gone(s, t))
      sum += vec3_dot(at[s->half[3 * t].from],
                      vec3_cross(at[s->half[3 * t + 1].from], at[s->half[3 * t + 2].from]));
  return sum / 6;
}

static void weigh_at_random(scree_memory *m) {
  scree_rng rng = {.seed = 77};
  m->weight = 0; /* all are left: they were squeezed */
  for (size_t j = 0; j < m->count; j++)
    m->weight += (double)(m->witnesses[j].weight = (float)(0.2 + scree_rng_uniform(&rng)));
}

static void the_step_solves_the_equations(void **state) {
  (void)state;
  for (int kind = 0; kind < KINDS; kind++)
    for (size_t stop = 120; stop >= 30; stop /= 2) {
      scree_error error;
      scree_mesh mesh = bumpy(kind);
      scree_decimator d = decimated(&mesh, stop, SCREE_UNSETTLED_ALL, &error);
      size_t count = d.s.vertex_count;
      if (kind > 0) weigh_at_random(&d.memory);
      vec3 *full = calloc(count, sizeof *full), *at = calloc(count, sizeof *at);
      double far2, merit;
      scree_joint j;
      CHECK_OK(scree_joint_allocate(&j, &d.s, &error), error);
      for (size_t v = 0; v < count; v++) j.free[v] = d.s.vertex[v].outgoing != SCREE_NONE;
      for (double damping = 1e-3; damping < 1; damping *= 20) {
        double largest = 0, off = 0;
        size_t far_count = full_step(&d, damping, full, &far2, &merit);
        for (int expected = 0; expected < 3; expected++) {
          scree_joint_begin(&j, &d.memory, &d.s, (0.1 + 0.5 * expected) * far2);
          CHECK_NEAR(j.far2, far2, 1e-9 * far2);
          assert_int_equal(j.far_count, far_count);
        }
        scree_joint_look(&j, &d.memory, &d.s); /* again, with hints */
        assert_int_equal(j.far_count, far_count);
        CHECK_NEAR(scree_joint_merit(&j, &d.memory, &d.s), merit, 1e-9 * merit);
        assert_true(scree_joint_fill(&j, &d.memory, &d.s));
        assert_true(scree_joint_solve(&j, &d.s, 7)); /* the next is as if it had not been */
        assert_true(scree_joint_solve(&j, &d.s, damping));
        for (size_t v = 0; v < count; v++) {
          if (!j.free[v]) continue;
          largest = fmax(largest, vec3_norm(full[v]));
          off = fmax(off, vec3_norm(vec3_sub(full[v], j.step[v])));
        }
        assert_true(largest > 0);
        CHECK_NEAR(off / largest, 0, 0.02);
      }
      for (size_t v = 0; v < count; v++) at[v] = d.s.vertex[v].at;
      double volume = volume_at(&d.s, at);
      scree_joint_places(&j, &d.s, at);
      CHECK_NEAR(volume_at(&d.s, at), volume, 1e-7 * volume);
      scree_joint_free(&j);
      free(full);
      free(at);
      scree_decimator_free(&d);
      scree_mesh_free(&mesh);
    }
}

/* ---- Whether the surface meets itself ---- */

/* By all pairs. */
static bool meets_itself(const scree_halfmesh *s) {
  scree_mesh mesh = shape_make(s->vertex_count, s->live_triangle_count);
  scree_meetings found;
  scree_error error;
  size_t count = 0;
  for (size_t v = 0; v < s->vertex_count; v++) vec3_store(mesh.positions + 3 * v, s->vertex[v].at);
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    for (size_t i = 0; i < 3; i++) mesh.triangles[3 * count + i] = s->half[3 * t + i].from;
    count++;
  }
  assert_int_equal(count, s->live_triangle_count);
  CHECK_OK(scree_mesh_meetings(&mesh, SIZE_MAX, NULL, &found, &error), error);
  bool answer = found.count > 0;
  scree_free(found.items);
  scree_mesh_free(&mesh);
  return answer;
}

/* Vertices of coarse levels moved at random, some or all, a little or by an edge. */
static void meetings_are_seen(void **state) {
  (void)state;
  size_t clear = 0, not_clear = 0;
  scree_rng rng = {.seed = 5};
  for (int kind = 0; kind < KINDS; kind++)
    for (size_t stop = 600; stop >= 30; stop /= 4) {
      scree_error error;
      scree_mesh mesh = bumpy(kind);
      scree_decimator d = decimated(&mesh, stop, SCREE_UNSETTLED_ALL, &error);
      size_t count = d.s.vertex_count;
      vec3 *at = calloc(count, sizeof *at);
      bool *graph = calloc(count, sizeof *graph);
      scree_swept *swept = calloc(d.s.triangle_count, sizeof *swept);
      double edge = sqrt(d.s.area / (double)d.s.live_triangle_count);
      CHECK_OK(scree_grid_prepare(&d.grid, &error), error);
      for (size_t v = 0; v < count; v++) at[v] = d.s.vertex[v].at;
      for (int i = 0; i < 60; i++) {
        double far = edge * pow(0.8, i % 12);
        uint32_t some = i % 3 == 0 ? 1 : (uint32_t)(count / 4);
        for (size_t v = 0; v < count; v++) {
          d.s.vertex[v].at = at[v];
          if (i > 0 && scree_rng_below(&rng, some) == 0)
            d.s.vertex[v].at = vec3_mad(at[v], scree_rng_direction(&rng), far);
        }
        bool expected = !meets_itself(&d.s);
        assert_int_equal(scree_grid_clear_all(&d.grid, &d.s, graph, swept), expected);
        clear += expected;
        not_clear += !expected;
      }
      free(at);
      free(graph);
      free(swept);
      scree_decimator_free(&d);
      scree_mesh_free(&mesh);
    }
  print_message("%zu clear, %zu not\n", clear, not_clear);
  assert_true(clear > 100 && not_clear > 100);
}

/* ---- The levels ---- */

/* A level of the record, in metres. */
typedef struct level {
  uint32_t *root, *corners;
  vec3 *at;
  size_t count;
} level;

/* Of a closed mesh; NULL: its collapses tell it. */
static const scree_whole_level *whole_of(const scree_decimator *d, size_t collapses) {
  const scree_whole_levels *whole = &d->record.whole;
  size_t count = d->mesh->triangle_count - 2 * collapses;
  for (size_t i = 0; i < whole->count; i++)
    if (whole->items[i].triangle_count == count) return &whole->items[i];
  return NULL;
}

static void copy_whole(const scree_whole_level *w, level *l) {
  l->count = w->triangle_count;
  memcpy(l->corners, w->triangle, w->triangle_count * sizeof *w->triangle);
  memcpy(l->at, w->position, w->vertex_count * sizeof *w->position);
  for (size_t v = 1; v < w->vertex_count; v++) assert_true(w->origin[v] > w->origin[v - 1]);
}

static void rebuild(const scree_decimator *d, size_t collapses, level *l) {
  const scree_record *r = &d->record;
  const scree_mesh *mesh = d->mesh;
  const scree_whole_level *whole = whole_of(d, collapses);
  if (whole) {
    copy_whole(whole, l);
    return;
  }
  for (uint32_t v = 0; v < mesh->vertex_count; v++) {
    l->root[v] = v;
    l->at[v] = vec3_load(mesh->positions + 3 * (size_t)v);
  }
  for (size_t i = 0, k = 0; i < collapses; i++) {
    l->at[r->kept[i]] = r->position[i];
    for (; k < r->moves.count && r->moves.items[k].index == i; k++)
      l->at[r->moves.items[k].vertex] = r->moves.items[k].position;
  }
  for (size_t i = collapses; i-- > 0;) l->root[r->gone[i]] = l->root[r->kept[i]];
  l->count = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    uint32_t *c = l->corners + 3 * l->count;
    for (size_t i = 0; i < 3; i++) c[i] = l->root[mesh->triangles[3 * t + i]];
    l->count += c[0] != c[1] && c[1] != c[2] && c[2] != c[0];
  }
}

/* The mean distance of the mesh's vertices from the level, the largest, its volume and its area. */
typedef struct measures {
  double mean, farthest, volume, area;
} measures;

static measures measure(const scree_mesh *mesh, const level *l) {
  measures m = {0};
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    double least = INFINITY, corners[9];
    vec3 p = vec3_load(mesh->positions + 3 * v), point;
    for (size_t t = 0; t < l->count; t++) {
      for (size_t i = 0; i < 3; i++) vec3_store(corners + 3 * i, l->at[l->corners[3 * t + i]]);
      least = fmin(least, scree_triangle_closest(corners, p, &point));
    }
    m.mean += sqrt(least) / (double)mesh->vertex_count;
    m.farthest = fmax(m.farthest, sqrt(least));
  }
  for (size_t t = 0; t < l->count; t++) {
    vec3 a = l->at[l->corners[3 * t]], b = l->at[l->corners[3 * t + 1]],
         c = l->at[l->corners[3 * t + 2]];
    m.volume += vec3_dot(a, vec3_cross(b, c)) / 6;
    m.area += 0.5 * vec3_norm(vec3_triangle_normal(a, b, c));
  }
  return m;
}

/* Both decimations of a mesh, and room for a level of each. */
typedef struct both {
  scree_mesh mesh;
  scree_decimator left, d;
  level level;
  double first_area, gain, compared;
} both;

static void begin_both(both *b, int kind, scree_unsettled left, scree_unsettled unsettled,
                       scree_error *error) {
  *b = (both){.mesh = bumpy(kind)};
  level *l = &b->level;
  b->left = decimated(&b->mesh, 0, left, error);
  b->d = decimated(&b->mesh, 0, unsettled, error);
  l->root = malloc(b->mesh.vertex_count * sizeof *l->root);
  l->corners = malloc(3 * b->mesh.triangle_count * sizeof *l->corners);
  l->at = malloc(b->mesh.vertex_count * sizeof *l->at);
  rebuild(&b->d, 0, l);
  b->first_area = measure(&b->mesh, l).area;
}

static void free_both(both *b) {
  free(b->level.root);
  free(b->level.corners);
  free(b->level.at);
  scree_decimator_free(&b->left);
  scree_decimator_free(&b->d);
  scree_mesh_free(&b->mesh);
}

/* Compares the levels of so many collapses: what the mean distance is of that before. */
static double compare(both *b, size_t collapses) {
  const scree_record *r = &b->d.record;
  level *l = &b->level;
  rebuild(&b->left, collapses, l);
  size_t count = l->count;
  measures before = measure(&b->mesh, l);
  rebuild(&b->d, collapses, l);
  measures m = measure(&b->mesh, l);
  double area = 0, scale2 = b->d.s.scale * b->d.s.scale;
  assert_int_equal(l->count, count);
  CHECK_NEAR(m.volume, before.volume, 1e-12 * before.volume);
  const scree_whole_level *whole = whole_of(&b->d, collapses);
  for (size_t i = 0; i < collapses && !whole; i++) area += r->area[i];
  CHECK_NEAR(m.area, whole ? whole->area : b->first_area + area * scale2, 1e-12 * b->first_area);
  if (whole) CHECK_NEAR(m.volume, whole->volume, 1e-12 * fabs(m.volume));
  b->gain += log(m.mean / before.mean);
  b->compared++;
  return m.mean / before.mean;
}

/* Below, where the surface itself settled, the collapses before it are the same, and so is every
 * level until there. */
static void the_path_is_better(void **state) {
  (void)state;
  for (int kind = 0; kind < KINDS; kind++) {
    scree_error error;
    both b;
    begin_both(&b, kind, SCREE_UNSETTLED_ALL, SCREE_UNSETTLED_LEVELS, &error);
    size_t first = b.mesh.triangle_count > SCREE_PATH_COUNT
                       ? (b.mesh.triangle_count - SCREE_PATH_COUNT) / 2
                       : 0;
    for (size_t i = 0; i < first; i++) {
      assert_int_equal(b.left.record.kept[i], b.d.record.kept[i]);
      assert_int_equal(b.left.record.gone[i], b.d.record.gone[i]);
      assert_memory_equal(&b.left.record.position[i], &b.d.record.position[i], sizeof(vec3));
      assert_true(b.left.record.area[i] == b.d.record.area[i]);
    }
    assert_true(b.d.record.moves.count > b.left.record.moves.count);
    /* well after the first settling, and before the levels that look ahead */
    for (size_t n = SCREE_PATH_COUNT * 3 / 4; n > SCREE_AHEAD_COUNT; n -= n / 8)
      if (n < b.mesh.triangle_count * 3 / 4) compare(&b, (b.mesh.triangle_count - n) / 2);
    assert_true(b.compared > 10);
    double gain = exp(b.gain / b.compared);
    if (!(gain < 0.99)) fail_msg("shape %d: mean distances %g of those before", kind, gain);
    free_both(&b);
  }
}

static void levels_are_better_and_the_collapses_the_same(void **state) {
  (void)state;
  for (int kind = 0; kind < KINDS; kind++) {
    scree_error error;
    both b;
    begin_both(&b, kind, SCREE_UNSETTLED_LEVELS, SCREE_UNSETTLED_NONE, &error);
    const scree_record *left = &b.left.record, *r = &b.d.record;
    const scree_whole_levels *whole = &r->whole;
    size_t first = (b.mesh.triangle_count - SCREE_AHEAD_COUNT) / 2, last = left->count;
    /* collapses lead to the levels that look ahead, which then are whole */
    assert_int_equal(r->count, first - 1);
    assert_int_equal(left->whole.count, 0);
    assert_int_equal(whole->items[0].triangle_count, b.mesh.triangle_count - 2 * first);
    for (size_t i = 1; i < whole->count; i++)
      assert_int_equal(whole->items[i].triangle_count, whole->items[i - 1].triangle_count - 2);
    for (size_t i = 0; i < r->count; i++) {
      assert_int_equal(left->kept[i], r->kept[i]);
      assert_int_equal(left->gone[i], r->gone[i]);
      assert_memory_equal(&left->position[i], &r->position[i], sizeof(vec3));
      assert_true(left->area[i] == r->area[i]);
      assert_true(left->volume[i] == r->volume[i]);
    }
    for (size_t k = 0; k < r->moves.count; k++)
      assert_memory_equal(&left->moves.items[k], &r->moves.items[k], sizeof(scree_move));
    if (last > r->count + whole->count) last = r->count + whole->count;
    for (size_t i = first; i <= last; i += 4) {
      double ratio = compare(&b, i);
      if (ratio > 1.1) fail_msg("%zu triangles: mean distance %g times", b.level.count, ratio);
    }
    assert_true(b.compared > 10);
    double gain = exp(b.gain / b.compared);
    if (!(gain < (kind == BOX ? 1 : 0.96))) /* of the box it is mostly the noise */
      fail_msg("shape %d: mean distances %g of those before", kind, gain);
    free_both(&b);
  }
}

/* ---- Several ways ---- */

static const scree_rule two_rules[] = {{1, SCREE_LEAST_COARSE_TURN}, {0, -0.6}};

static scree_decimator ended(const scree_mesh *mesh, const scree_rule *by, size_t count, bool large,
                             scree_error *error) {
  size_t parting = large ? SCREE_PARTING_LATE : SCREE_PARTING_COUNT;
  scree_decimator d = begin_decimation(mesh, &scree_volume_coster, error);
  d.options.stop_count = parting;
  d.unsettled = SCREE_UNSETTLED_NONE;
  if (large) d.first_triangle_count += SCREE_LARGE_COUNT;
  CHECK_OK(scree_decimate_one_by_one(&d), *error);
  assert_true(d.s.live_triangle_count <= parting);
  d.options.stop_count = 0;
  CHECK_OK(scree_decimate_endings(&d, by, count), *error);
  return d;
}

static bool same_level(const scree_whole_level *a, const scree_whole_level *b) {
  if (!a || !b || a->vertex_count != b->vertex_count) return false;
  double far = 0;
  for (size_t v = 0; v < a->vertex_count; v++)
    far = fmax(far, vec3_norm(vec3_sub(a->position[v], b->position[v])));
  return !memcmp(a->triangle, b->triangle, a->triangle_count * sizeof *a->triangle) &&
         far <= 1e-9 * sqrt(a->area);
}

/* Every level is that of one way alone, both have their share, and on average the chosen are better
 * than the ways'. */
static void levels_are_the_best_way(void **state) {
  (void)state;
  for (int large = 0; large < 2; large++) {
    scree_error error;
    scree_mesh mesh = bumpy(0);
    scree_decimator d[3];
    size_t taken[2] = {0, 0};
    double gain[2] = {0, 0};
    level l = {.corners = malloc(3 * mesh.triangle_count * sizeof *l.corners),
               .at = malloc(mesh.vertex_count * sizeof *l.at)};
    d[0] = ended(&mesh, two_rules, 1, large, &error);
    d[1] = ended(&mesh, two_rules + 1, 1, large, &error);
    d[2] = ended(&mesh, two_rules, 2, large, &error);
    const scree_whole_levels *best = &d[2].record.whole;
    for (size_t i = 0; i < best->count; i++) {
      const scree_whole_level *of[3] = {NULL, NULL, &best->items[i]};
      double score[3];
      for (int k = 0; k < 2; k++)
        of[k] = whole_of(&d[k], (mesh.triangle_count - of[2]->triangle_count) / 2);
      bool same[2] = {same_level(of[2], of[0]), same_level(of[2], of[1])};
      if (!same[0] && !same[1]) fail_msg("%zu triangles: no way's", of[2]->triangle_count);
      if (!of[0] || !of[1] || (same[0] && same[1])) continue;
      taken[same[1]]++;
      for (int k = 0; k < 3; k++) {
        copy_whole(of[k], &l);
        measures m = measure(&mesh, &l);
        score[k] = scree_level_score(&d[0], m.mean, m.farthest);
      }
      for (int k = 0; k < 2; k++) gain[k] += log(score[2] / score[k]);
    }
    print_message("of %zu levels %zu and %zu, gains %g %g\n", best->count, taken[0], taken[1],
                  gain[0], gain[1]);
    assert_true(taken[0] > 4 && taken[1] > 4);
    assert_true(gain[0] + gain[1] < 0);
    for (int k = 0; k < 3; k++) scree_decimator_free(&d[k]);
    free(l.corners);
    free(l.at);
    scree_mesh_free(&mesh);
  }
}

/* ---- The scan turned ---- */

static scree_curve *curve_of(const scree_mesh *mesh, const scree_simplify_options *options) {
  scree_curve *curve;
  scree_error error;
  CHECK_OK(scree_curve_build(mesh, options, NULL, &curve, &error), error);
  return curve;
}

/* Answers the largest difference, relative. */
static double compare_areas(const scree_curve *curve, const scree_curve *turned, double scale) {
  double most = 0;
  size_t levels = scree_curve_level_count(curve);
  assert_int_equal(scree_curve_level_count(turned), levels);
  for (size_t i = 0; i < levels; i++) {
    scree_level a, b;
    scree_curve_level(curve, i, &a);
    scree_curve_level(turned, i, &b);
    assert_int_equal(a.triangle_count, b.triangle_count);
    most = fmax(most, fabs(b.area / (scale * scale) / a.area - 1));
  }
  return most;
}

/* Levels are the same but for rounding when the scan is turned, moved and scaled, which gives its
 * vertices other numbers: nothing may hang on these. Not so of the box, whose facets meet each
 * other: what a collapse may come to meet is looked for along the axes. */
static void levels_do_not_depend_on_how_the_scan_lies(void **state) {
  (void)state;
  static const struct {
    mat3 turn;
    vec3 move;
    double scale;
  } lies[] = {{{{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}, {0, 0, 0}, 1},
              {{{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}}, {0.1, -0.3, 0.2}, 1},
              {{{{480, 640, 0}, {-640, 480, 0}, {0, 0, 800}}}, {0, 0, 0}, 800}};
  for (int kind = 0; kind < BOX; kind++)
    for (scree_method method = SCREE_METHOD_VOLUME; method <= SCREE_METHOD_QECD; method++) {
      scree_simplify_options options = {.method = method};
      scree_mesh loose = bumpy(kind), mesh = shape_weld(&loose, NULL);
      scree_curve *curve = curve_of(&mesh, &options);
      for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        scree_mesh lying = bumpy(kind);
        shape_transform(&lying, &lies[i].turn, lies[i].move);
        scree_mesh turned = shape_weld(&lying, NULL);
        scree_curve *other = curve_of(&turned, &options);
        double most = compare_areas(curve, other, lies[i].scale);
        print_message("shape %d, method %d: %.1e\n", kind, (int)method, most);
        assert_true(most < 1e-7);
        scree_curve_free(other);
        scree_mesh_free(&lying);
        scree_mesh_free(&turned);
      }
      scree_curve_free(curve);
      scree_mesh_free(&loose);
      scree_mesh_free(&mesh);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_step_solves_the_equations),
      cmocka_unit_test(meetings_are_seen),
      cmocka_unit_test(the_path_is_better),
      cmocka_unit_test(levels_are_better_and_the_collapses_the_same),
      cmocka_unit_test(levels_are_the_best_way),
      cmocka_unit_test(levels_do_not_depend_on_how_the_scan_lies),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
