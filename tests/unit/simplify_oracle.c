/* Decimation against slow answers: the order of collapses, what one costs and where its vertex
 * goes, the deviation from the scan, and each guard. The oracles know a list of triangles and
 * nothing else; everything is computed from it anew, by other formulas than the engine's. */
#include "mesh/index/intersect.h"
#include "simplify/decimate.h"
#include "simplify/tuning.h"
#include "support/check.h"
#include "support/shapes.h"

/* ---- Surfaces to ask about ---- */

static scree_mesh bumpy(int level, double share, uint64_t seed) {
  scree_rng rng = {.seed = seed};
  scree_mesh mesh = shape_icosphere(0.03, level);
  shape_roughen(&mesh, share, &rng);
  return mesh;
}

/* Thin, with a hole: fans that nearly cancel, and edges that the link condition refuses. */
static scree_mesh thin_torus(void) {
  scree_rng rng = {.seed = 5};
  scree_mesh mesh = shape_torus(0.03, 0.004, 24, 6);
  shape_shake(&mesh, 2e-4, &rng);
  return mesh;
}

/* Its faces are flat, with gridlines, but no two edges are alike: equal costs have no order. */
static scree_mesh uneven_box(void) {
  scree_mesh mesh = shape_grid_box(0.1, 0.05, 0.02, 4);
  for (size_t v = 0; v < mesh.vertex_count; v++) {
    double *p = mesh.positions + 3 * v, away = 1 + 3 * p[0] + 5 * p[1] + 7 * p[2];
    for (int k = 0; k < 3; k++) p[k] /= away;
  }
  return mesh;
}

/* A decimator of the mesh, on its way by so many collapses in order. */
static void begin(scree_decimator *d, const scree_mesh *mesh, scree_method method, size_t collapses,
                  scree_error *error) {
  scree_simplify_options options = {.method = method,
                                    .stop_count = mesh->triangle_count - 2 * collapses};
  CHECK_OK(scree_decimator_start(d, mesh, &options, error), *error);
  CHECK_OK(scree_decimate_refresh(d), *error);
  if (method == SCREE_METHOD_VOLUME) {
    CHECK_OK(scree_halfmesh_copy(&d->s, &d->samples.scan, error), *error);
    CHECK_OK(scree_samples_start(&d->samples, error), *error);
    CHECK_OK(scree_samples_find(&d->s, &d->tree, &d->samples, error), *error);
  }
  for (size_t done = 1; done > 0 && d->s.live_triangle_count > options.stop_count;) {
    CHECK_OK(scree_decimate_refresh(d), *error);
    CHECK_OK(scree_decimate_in_order(d, &done), *error);
  }
  CHECK_OK(scree_decimate_refresh(d), *error);
}

static bool is_edge(const scree_halfmesh *s, uint32_t h) {
  return s->half[h].from != SCREE_NONE && (s->half[h].twin == SCREE_NONE || h < s->half[h].twin);
}

/* ---- The order ---- */

/* The engine's run with a driver that judges every edge before each collapse. */
typedef struct slow {
  scree_decimator d;
  bool *refused; /* per half-edge: until something about the edge changes */
  scree_gathered scratch;
} slow;

static void renew(slow *w, const scree_fan *f) {
  scree_halfmesh *s = &w->d.s;
  for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
    if (s->half[h].from == SCREE_NONE) continue;
    for (uint32_t i = 0; i < f->count; i++) {
      uint32_t u = s->half[f->edge[i]].from, v = scree_to(s, f->edge[i]);
      if (s->half[h].from == u || s->half[h].from == v || scree_to(s, h) == u ||
          scree_to(s, h) == v)
        w->refused[h] = false;
    }
  }
  for (uint32_t v = 0; v < s->vertex_count && !w->d.coster->merge; v++)
    if (s->vertex[v].outgoing != SCREE_NONE) w->d.coster->sum(s, v);
}

/* The cheapest edge that is allowed collapses; false: none is. */
static bool slow_step(slow *w) {
  scree_decimator *d = &w->d;
  scree_halfmesh *s = &d->s;
  const scree_surroundings around = {s, &d->tree, &d->markers};
  for (;;) {
    scree_fan f;
    scree_verdict best = {.cost = INFINITY};
    uint32_t edge = SCREE_NONE;
    for (uint32_t h = 0; h < 3 * s->triangle_count; h++) {
      if (!is_edge(s, h) || w->refused[h]) continue;
      scree_verdict v = scree_decimate_judge(d, h, INFINITY, &f);
      if (v.cost < best.cost) best = v, edge = h;
    }
    if (edge == SCREE_NONE) return false;
    scree_fan_of_edge(s, edge, &f);
    scree_fan_set(&f, best.target);
    w->refused[edge] = !scree_apart(&around, &f);
    if (w->refused[edge]) continue;
    if (scree_has_samples(&d->samples))
      assert_true(scree_samples_move(&d->samples, s, &f, &w->scratch));
    scree_decimate_collapse(d, &f, best.error);
    scree_surface_tree_fit(&d->tree, s);
    renew(w, &f);
    return true;
  }
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static void set_usual(scree_decimator *d) {
  double *costs = malloc(3 * d->s.triangle_count * sizeof *costs);
  size_t count = 0;
  for (uint32_t h = 0; h < 3 * d->s.triangle_count; h++) {
    scree_candidate c;
    if (!is_edge(&d->s, h)) continue;
    d->coster->evaluate(&d->s, &h, 1, &c);
    if (c.cost < INFINITY) costs[count++] = c.cost;
  }
  qsort(costs, count, sizeof *costs, by_size);
  if (count > 0 && d->samples.mean > 0) {
    d->usual_cost = costs[count / 10];
    d->usual_far = scree_tune.usual * d->samples.mean;
  }
  free(costs);
}

static void slow_run(slow *w, const scree_mesh *mesh, scree_method method, scree_error *error) {
  begin(&w->d, mesh, method, 0, error);
  scree_decimator *d = &w->d;
  w->refused = malloc(3 * mesh->triangle_count);
  while (d->leniency < SCREE_LENIENCIES) {
    CHECK_OK(scree_decimate_refresh(d), *error);
    memset(w->refused, 0, 3 * mesh->triangle_count);
    set_usual(d);
    size_t least = (size_t)(scree_tune.refresh * (double)d->s.live_triangle_count), done = 0;
    while (slow_step(w)) {
      done++;
      if (d->s.live_triangle_count <= least) break;
    }
    if (done == 0) d->leniency++;
  }
}

static void every_collapse_is_the_cheapest_allowed(void **state) {
  (void)state;
  for (int m = 0; m < 2; m++)
    for (int shape = 0; shape < 3; shape++) {
      scree_mesh mesh = shape == 0 ? bumpy(2, 0.1, 3) : shape == 1 ? thin_torus() : uneven_box();
      scree_method method = m == 0 ? SCREE_METHOD_VOLUME : SCREE_METHOD_QECD;
      scree_error error;
      scree_decimator fast;
      scree_simplify_options options = {.method = method};
      slow w = {.scratch = {0}};
      CHECK_OK(scree_decimator_start(&fast, &mesh, &options, &error), error);
      fast.expect = 0;
      CHECK_OK(scree_decimate(&fast), error);
      slow_run(&w, &mesh, method, &error);
      assert_int_equal(fast.record.count, w.d.record.count);
      for (size_t i = 0; i < fast.record.count; i++) {
        assert_int_equal(fast.record.kept[i], w.d.record.kept[i]);
        assert_int_equal(fast.record.gone[i], w.d.record.gone[i]);
        assert_memory_equal(&fast.record.position[i], &w.d.record.position[i], sizeof(vec3));
      }
      scree_decimator_free(&fast);
      scree_decimator_free(&w.d);
      scree_free(w.scratch.items);
      free(w.refused);
      scree_mesh_free(&mesh);
    }
}

/* ---- Cost and place ---- */

/* Solves the n x n system in place, with pivots. */
static void solve(double m[4][5], int n) {
  for (int i = 0; i < n; i++) {
    int pivot = i;
    for (int r = i + 1; r < n; r++)
      if (fabs(m[r][i]) > fabs(m[pivot][i])) pivot = r;
    for (int c = 0; c <= n; c++) {
      double swapped = m[i][c];
      m[i][c] = m[pivot][c];
      m[pivot][c] = swapped;
    }
    for (int r = 0; r < n; r++) {
      if (r == i) continue;
      double f = m[r][i] / m[i][i];
      for (int c = i; c <= n; c++) m[r][c] -= f * m[i][c];
    }
  }
  for (int i = 0; i < n; i++) m[i][n] /= m[i][i];
}

static bool has(const scree_halfmesh *s, size_t t, uint32_t v) {
  return s->half[3 * t].from == v || s->half[3 * t + 1].from == v || s->half[3 * t + 2].from == v;
}

/* Lagrange's multipliers over the triangles of both ends, each once. */
static void check_place(const scree_halfmesh *s, uint32_t h, const scree_candidate *c) {
  uint32_t a = s->half[h].from, b = scree_to(s, h);
  vec3 pa = s->vertex[a].at, e = vec3_sub(s->vertex[b].at, pa), sum = {0, 0, 0}, corner[3];
  double m[4][5] = {{0}}, squares = 0, level = 0, energy = 0, swept = 0;
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (!has(s, t, a) && !has(s, t, b)) continue;
    scree_corners(s, t, corner);
    vec3 n = scree_normal_of(s, t);
    double d = vec3_dot(n, vec3_sub(corner[0], pa)), v[4] = {n.x, n.y, n.z, d};
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 4; j++) m[i][j < 3 ? j : 4] += v[i] * v[j];
    squares += vec3_norm2(n);
    sum = vec3_add(sum, n);
    level += d;
    double tetrahedron = vec3_dot(n, vec3_sub(c->target, corner[0]));
    energy += tetrahedron * tetrahedron;
    swept += tetrahedron;
  }
  const double unit[3] = {sum.x / vec3_norm(sum), sum.y / vec3_norm(sum), sum.z / vec3_norm(sum)};
  for (int i = 0; i < 3; i++) m[i][3] = m[3][i] = unit[i] * squares; /* scaled as the rest */
  m[3][4] = level / vec3_norm(sum) * squares;
  solve(m, 4);
  double length = vec3_norm(e), tie = scree_tune.tie * squares * length * length;
  assert_true(fabs(swept) < 1e-12 * vec3_norm(sum) * length);
  CHECK_NEAR(c->cost, energy + tie, 1e-6 * (energy + tie));
  CHECK_NEAR(c->error, energy / squares, 1e-6 * c->error + 1e-18);
  /* where the surface decides */
  vec3 best = vec3_add(pa, (vec3){m[0][4], m[1][4], m[2][4]});
  double at_best = 0;
  for (size_t t = 0; t < s->triangle_count; t++)
    if (has(s, t, a) || has(s, t, b)) {
      scree_corners(s, t, corner);
      double tetrahedron = vec3_dot(scree_normal_of(s, t), vec3_sub(best, corner[0]));
      at_best += tetrahedron * tetrahedron;
    }
  assert_true(energy <= at_best * (1 + 1e-6) + 1e-5 * squares * length * length);
}

static void places_are_of_least_cost(void **state) {
  (void)state;
  for (int shape = 0; shape < 2; shape++) {
    scree_mesh mesh = shape == 0 ? bumpy(2, 0.1, 3) : thin_torus();
    scree_error error;
    scree_decimator d;
    size_t checked = 0;
    begin(&d, &mesh, SCREE_METHOD_VOLUME, 40, &error);
    for (uint32_t h = 0; h < 3 * d.s.triangle_count; h++) {
      scree_candidate c;
      if (!is_edge(&d.s, h)) continue;
      d.coster->evaluate(&d.s, &h, 1, &c);
      if (c.cost < INFINITY) check_place(&d.s, h, &c), checked++;
    }
    assert_true(checked > 200);
    scree_decimator_free(&d);
    scree_mesh_free(&mesh);
  }
}

/* ---- The deviation ---- */

static double distance_from_all(const scree_halfmesh *s, vec3 p) {
  double least = INFINITY;
  vec3 corner[3];
  for (size_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    scree_corners(s, t, corner);
    least = fmin(least, scree_distance2(corner, p));
  }
  return sqrt(least);
}

static double distance_from_fan(const scree_fan *f, vec3 p) {
  double least = INFINITY;
  for (uint32_t i = 0; i < f->count; i++) {
    const vec3 corner[3] = {f->at, f->from[i], f->to[i]};
    least = fmin(least, scree_distance2(corner, p));
  }
  return sqrt(least);
}

/* So far from the surface, in the direction in which the sample is nearest to an end of the scan:
 * the distance, or what is lost of the width. */
static double weighted(const scree_samples *p, const scree_halfmesh *s, uint32_t v, double far) {
  double least = INFINITY, lost = 0;
  for (int i = 0; i < SCREE_EXTENT_COUNT; i++) {
    double low = INFINITY, high = -INFINITY, at = 0;
    for (size_t k = 0; k < p->scan.vertex_count; k++) {
      double along = scree_extent_along(&p->extent, i, p->scan.vertex[k].at);
      low = fmin(low, along), high = fmax(high, along);
      if (k == v) at = along;
    }
    double width = high - low, depth = fmin(high - at, at - low);
    if (depth / width >= least) continue;
    least = depth / width;
    lost = (far - depth) * fmax(1, scree_tune.grow * sqrt(s->area / acos(-1)) / width);
  }
  return fmax(far, lost);
}

static double slow_deviation(const scree_decimator *d, const scree_fan *f) {
  const scree_samples *p = &d->samples;
  double worst = distance_from_all(&p->scan, f->at);
  const uint32_t ends[2] = {p->of[f->a], p->of[f->b]};
  for (int k = 0; k < 2; k++) /* now at the latest they are samples */
    worst =
        fmax(worst, weighted(p, &d->s, ends[k], distance_from_fan(f, p->scan.vertex[ends[k]].at)));
  for (uint32_t k = 0; k < scree_fan_triangle_count(f); k++)
    for (uint32_t v = p->first[scree_fan_triangle(&d->s, f, k)]; v != SCREE_NONE; v = p->next[v])
      worst = fmax(worst, weighted(p, &d->s, v, distance_from_fan(f, p->scan.vertex[v].at)));
  for (uint32_t i = 0; i < f->count; i++)
    worst = fmax(worst, distance_from_all(&p->scan, vec3_lerp(f->at, f->from[i], 0.5)));
  return worst;
}

/* Every vertex of the scan that is not in the surface in one list, at the distance it says, which
 * is not less than that from the whole level. */
static void check_samples(const scree_decimator *d) {
  const scree_samples *p = &d->samples;
  size_t listed = 0, in_surface = 0;
  vec3 corner[3];
  for (size_t t = 0; t < d->s.triangle_count; t++) {
    if (scree_is_gone(&d->s, t)) continue;
    double worst = 0;
    scree_corners(&d->s, t, corner);
    for (uint32_t v = p->first[t]; v != SCREE_NONE; v = p->next[v], listed++) {
      double far = sqrt(scree_distance2(corner, p->scan.vertex[v].at));
      CHECK_NEAR((double)p->far[v], far, 1e-6 * far + 1e-12);
      assert_true((double)p->far[v] >= (1 - 1e-6) * distance_from_all(&d->s, p->scan.vertex[v].at));
      worst = fmax(worst, weighted(p, &d->s, v, (double)p->far[v]));
    }
    CHECK_NEAR((double)p->worst[t], worst, 1e-6 * worst + 1e-12);
    uint32_t first = p->first[t];
    if (first != SCREE_NONE)
      CHECK_NEAR(weighted(p, &d->s, first, (double)p->far[first]), worst, 1e-6 * worst + 1e-12);
  }
  for (size_t v = 0; v < p->scan.vertex_count; v++) in_surface += p->far[v] == -1;
  assert_int_equal(listed + in_surface, p->scan.vertex_count);
}

static void deviations_are_found(void **state) {
  (void)state;
  for (int shape = 0; shape < 2; shape++) {
    scree_mesh mesh = shape == 0 ? bumpy(3, 0.05, 3) : thin_torus();
    scree_error error;
    scree_decimator d;
    size_t asked = 0;
    begin(&d, &mesh, SCREE_METHOD_VOLUME, mesh.triangle_count / 4, &error);
    check_samples(&d);
    for (uint32_t h = 0; h < 3 * d.s.triangle_count; h++) {
      scree_candidate c;
      scree_fan f;
      if (!is_edge(&d.s, h)) continue;
      d.coster->evaluate(&d.s, &h, 1, &c);
      if (!(c.cost < INFINITY) || !scree_fan_of_edge(&d.s, h, &f)) continue;
      scree_fan_set(&f, c.target);
      double found = scree_deviation_find(&d.samples, &d.s, &f, 0, INFINITY),
             exact = slow_deviation(&d, &f);
      CHECK_NEAR(found, exact, 1e-9 * exact + 1e-15);
      double bound = scree_deviation_find(&d.samples, &d.s, &f, 0, 0.9 * exact);
      assert_true(exact == 0 || (bound > 0.9 * exact && bound <= exact * (1 + 1e-9)));
      asked++;
    }
    assert_true(asked > 200);
    scree_decimator_free(&d);
    scree_mesh_free(&mesh);
  }
}

/* ---- The guards ---- */

/* A list of triangles with the edge collapsed; those that go name vertex 0 three times. */
typedef struct list {
  size_t vertex_count, triangle_count;
  vec3 *position;
  uint32_t *triangle;
} list;

static list list_of(const scree_halfmesh *s) {
  list l = {s->vertex_count, s->triangle_count, malloc(s->vertex_count * sizeof(vec3)),
            malloc(3 * s->triangle_count * sizeof(uint32_t))};
  for (size_t v = 0; v < s->vertex_count; v++) l.position[v] = s->vertex[v].at;
  for (size_t h = 0; h < 3 * s->triangle_count; h++) l.triangle[h] = s->half[h].from;
  return l;
}

static bool names(const list *l, size_t t, uint32_t v) {
  const uint32_t *c = l->triangle + 3 * t;
  return c[0] == v || c[1] == v || c[2] == v;
}

static bool is_gone(const list *l, size_t t) {
  return l->triangle[3 * t] == l->triangle[3 * t + 1];
}

static void collapse(list *l, uint32_t a, uint32_t b, vec3 x) {
  for (size_t t = 0; t < l->triangle_count; t++) {
    bool goes = names(l, t, a) && names(l, t, b);
    for (size_t i = 0; i < 3; i++) {
      uint32_t *v = &l->triangle[3 * t + i];
      *v = goes ? 0 : *v == b ? a : *v;
    }
  }
  l->position[a] = x;
}

static void free_list(list *l) {
  free(l->position);
  free(l->triangle);
}

static vec3 normal(const list *l, size_t t) {
  const uint32_t *c = l->triangle + 3 * t;
  return vec3_triangle_normal(l->position[c[0]], l->position[c[1]], l->position[c[2]]);
}

static size_t shared(const list *l, size_t t, size_t u) {
  size_t count = 0;
  for (size_t i = 0; i < 3; i++) count += names(l, u, l->triangle[3 * t + i]);
  return count;
}

static size_t meetings(const list *l) {
  size_t count = 0;
  for (size_t t = 0; t < l->triangle_count; t++)
    for (size_t u = 0; u < t; u++)
      count += !is_gone(l, t) && !is_gone(l, u) && shared(l, t, u) < 2 &&
               scree_triangles_meet(&l->position[0].x, l->triangle + 3 * t, l->triangle + 3 * u) !=
                   SCREE_MEET_NOT;
  return count;
}

/* The sharpest edge and the worst shape among triangles of a or b. */
static void find_worst(const list *l, uint32_t a, uint32_t b, double *fold, double *shape) {
  *fold = *shape = 1;
  for (size_t t = 0; t < l->triangle_count; t++) {
    if (is_gone(l, t) || !(names(l, t, a) || names(l, t, b))) continue;
    const uint32_t *c = l->triangle + 3 * t;
    double longest = 0;
    for (int i = 0; i < 3; i++)
      longest = fmax(longest, vec3_distance(l->position[c[i]], l->position[c[(i + 1) % 3]]));
    *shape = fmin(*shape, vec3_norm(normal(l, t)) / (longest * longest));
    for (size_t u = 0; u < l->triangle_count; u++)
      if (u != t && !is_gone(l, u) && shared(l, t, u) == 2)
        *fold = fmin(*fold, vec3_dot(vec3_unit(normal(l, t)), vec3_unit(normal(l, u))));
  }
}

static bool turns_too_far(const list *was, const list *is, uint32_t a, double least) {
  for (size_t t = 0; t < is->triangle_count; t++)
    if (!is_gone(is, t) && names(is, t, a) &&
        vec3_dot(vec3_unit(normal(was, t)), vec3_unit(normal(is, t))) < least)
      return true;
  return false;
}

/* The two apexes are all that both ends have as neighbours, and three triangles stay. */
static bool links_agree(const list *l, uint32_t a, uint32_t b) {
  size_t common = 0, staying = 0;
  uint8_t *next_to = calloc(l->vertex_count, 1);
  for (size_t t = 0; t < l->triangle_count; t++) {
    bool at_a = names(l, t, a), at_b = names(l, t, b);
    staying += at_a != at_b;
    for (size_t i = 0; i < 3; i++)
      next_to[l->triangle[3 * t + i]] |= (uint8_t)((at_a ? 1 : 0) | (at_b ? 2 : 0));
  }
  for (uint32_t v = 0; v < l->vertex_count; v++) common += v != a && v != b && next_to[v] == 3;
  free(next_to);
  return common == 2 && staying >= 3;
}

/* How often each guard said yes and no. */
typedef struct answers {
  size_t topology[2], shape[2], apart[2];
} answers;

static void ask_guards(const scree_decimator *d, const list *was, uint32_t h, vec3 x, int leniency,
                       answers *got) {
  scree_fan f;
  const scree_halfmesh *s = &d->s;
  const scree_surroundings around = {s, &d->tree, &d->markers};
  if (!scree_fan_of_edge(s, h, &f)) return;
  bool topology = scree_fan_keeps_topology(s, &f);
  assert_int_equal(topology, links_agree(was, f.a, f.b));
  got->topology[topology]++;
  if (!topology) return;
  list is = list_of(s);
  collapse(&is, f.a, f.b, x);
  scree_fan_set(&f, x);
  double fold, shape, old_fold, old_shape;
  find_worst(&is, f.a, f.a, &fold, &shape);
  find_worst(was, f.a, f.b, &old_fold, &old_shape);
  bool sound = !turns_too_far(was, &is, f.a, scree_tune.turn[leniency]) &&
               fold >= fmin(scree_tune.fold[leniency], old_fold) - 1e-12 &&
               shape >= fmin(scree_tune.shape[leniency], 0.5 * old_shape);
  bool allowed = scree_shape_allows(s, &f, leniency);
  /* none of these surfaces has a fold over 149 degrees or a triangle without area */
  assert_int_equal(allowed, sound);
  got->shape[allowed]++;
  bool apart = scree_apart(&around, &f);
  if (fold > -0.999) { /* else neighbours may overlap, which the fold tells */
    assert_int_equal(apart, meetings(&is) <= meetings(was));
    got->apart[apart]++;
  }
  free_list(&is);
}

static void guards_are_right(void **state) {
  (void)state;
  scree_rng rng = {.seed = 7};
  answers got = {{0}, {0}, {0}};
  for (int shape = 0; shape < 3; shape++) {
    scree_mesh mesh = shape == 0   ? bumpy(1, 0.2, 3)
                      : shape == 1 ? shape_torus(0.03, 0.01, 12, 3)
                                   : shape_grid_box(0.1, 0.05, 0.002, 3);
    scree_error error;
    scree_decimator d;
    begin(&d, &mesh, SCREE_METHOD_VOLUME, mesh.triangle_count / 8, &error);
    list was = list_of(&d.s);
    for (uint32_t h = 0; h < 3 * d.s.triangle_count; h++) {
      if (!is_edge(&d.s, h)) continue;
      vec3 p = d.s.vertex[d.s.half[h].from].at, q = d.s.vertex[scree_to(&d.s, h)].at;
      double reach = 3 * scree_rng_uniform(&rng) * vec3_distance(p, q);
      vec3 x = vec3_mad(vec3_lerp(p, q, 0.5), scree_rng_direction(&rng), reach);
      ask_guards(&d, &was, h, x, (int)(h % SCREE_LENIENCIES), &got);
    }
    free_list(&was);
    scree_decimator_free(&d);
    scree_mesh_free(&mesh);
  }
  for (int k = 0; k < 2; k++) assert_true(got.shape[k] > 50 && got.apart[k] > 50);
  assert_true(got.topology[0] > 3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_collapse_is_the_cheapest_allowed),
      cmocka_unit_test(places_are_of_least_cost),
      cmocka_unit_test(deviations_are_found),
      cmocka_unit_test(guards_are_right),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
