/* The witnesses of the stray, carried through batches, against the level as it is; what thinning
 * leaves; others for coarse levels, and what their weights do. */
#include "support/decimator.h"
#include "support/shapes.h"

/* Docs: so many of the mean distances with which the scan's vertices began are usual noise. */
#define ROUGH 5

static double distance_from(const scree_halfmesh *s, uint32_t triangle, vec3 p) {
  vec3 at[3], point;
  double corners[9];
  scree_corners(s, triangle, at);
  for (int i = 0; i < 3; i++) vec3_store(corners + 3 * i, at[i]);
  return sqrt(scree_triangle_closest(corners, p, &point));
}

/* Every witness once, with a triangle that is there, at the distance it says, which is not less
 * than that from the whole level; returns their mean distance and the largest. */
static void check_witnesses(const scree_decimator *d, double *mean, double *worst) {
  const scree_halfmesh *s = &d->s;
  const scree_memory *m = &d->memory;
  scree_memory now = {0};
  scree_error error;
  size_t seen = 0;
  bool *found = calloc(m->count, sizeof *found);
  CHECK_OK(scree_memory_keep(s, NULL, 0, &now, &error), error); /* the level, as a tree */
  *mean = *worst = 0;
  for (uint32_t t = 0; t < s->triangle_count; t++) {
    if (scree_is_gone(s, t)) continue;
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next, seen++) {
      const scree_witness *w = &m->witnesses[j];
      double distance = sqrt(w->distance2);
      scree_bvh_hit hit = {.distance2 = INFINITY};
      assert_false(found[j]);
      found[j] = true;
      CHECK_NEAR(distance_from(s, t, w->at), distance, SCREE_SAME_DISTANCE);
      assert_true(scree_bvh_closest(&now.surface, w->at, &hit));
      assert_true(sqrt(hit.distance2) <= distance + SCREE_SAME_DISTANCE);
      *mean += distance / (double)m->left;
      *worst = fmax(*worst, distance);
    }
  }
  assert_int_equal(seen, m->left);
  free(found);
  scree_memory_free(&now);
}

static scree_mesh shaken_sphere(void) { /* 81,920 triangles */
  scree_rng rng = {.seed = 31};
  scree_mesh mesh = shape_icosphere(0.03, 6);
  shape_shake(&mesh, 1e-4, &rng);
  return mesh;
}

static void witnesses_go_with_the_batches(void **state) {
  (void)state;
  scree_error error;
  double mean, worst;
  scree_mesh mesh = shaken_sphere();
  scree_decimator d = begin_decimation(&mesh, &scree_volume_coster, &error);
  CHECK_OK(scree_decimate_in_batches(&d), error);
  assert_true(d.s.live_triangle_count <= SCREE_GREEDY_COUNT);
  assert_int_equal(d.memory.left, mesh.vertex_count);
  assert_true(d.memory.roughness == 0);
  check_witnesses(&d, &mean, &worst);
  CHECK_NEAR(scree_memory_usual(&d.memory, false), 10 * mean, 1e-9 * mean);
  CHECK_NEAR(scree_memory_usual(&d.memory, true), 9 * mean, 1e-9 * mean);
  CHECK_NEAR(scree_memory_worst(&d.memory), worst, 1e-9 * worst);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

static int by_x(const void *a, const void *b) {
  double x = ((const vec3 *)a)->x, y = ((const vec3 *)b)->x;
  return (x > y) - (x < y);
}

/* Every witness lies where a vertex of the mesh given does, and no two at the same. */
static void check_places(const scree_decimator *d) {
  const scree_memory *m = &d->memory;
  vec3 *given = calloc(d->mesh->vertex_count, sizeof *given);
  bool *seen = calloc(d->mesh->vertex_count, sizeof *seen);
  for (size_t v = 0; v < d->mesh->vertex_count; v++)
    given[v] = scree_into_box(&d->s, vec3_load(d->mesh->positions + 3 * v));
  qsort(given, d->mesh->vertex_count, sizeof *given, by_x);
  for (size_t j = 0; j < m->count; j++) {
    vec3 at = m->witnesses[j].at;
    const vec3 *found = bsearch(&at, given, d->mesh->vertex_count, sizeof at, by_x);
    assert_non_null(found);
    assert_true(vec3_norm(vec3_sub(*found, at)) == 0);
    assert_false(seen[found - given]);
    seen[found - given] = true;
  }
  free(given);
  free(seen);
}

/* Kept late: the vertices that went before are witnesses too, at most one in a hundred not
 * at its nearest triangle. */
static void what_went_before_is_remembered(void **state) {
  (void)state;
  scree_error error;
  double mean, worst;
  size_t farther = 0;
  scree_rng rng = {.seed = 36};
  scree_mesh mesh = shape_icosphere(0.03, 7); /* 327,680 triangles */
  shape_shake(&mesh, 5e-5, &rng);
  scree_decimator d = begin_decimation(&mesh, &scree_volume_coster, &error);
  d.options.stop_count = SCREE_KEPT_LATE + 1;
  d.first_triangle_count = SCREE_LARGE_COUNT + 1;
  CHECK_OK(scree_decimate_in_batches(&d), error);
  assert_true(d.s.live_triangle_count < mesh.triangle_count / 3);
  assert_false(scree_memory_is_kept(&d.memory));
  scree_memory_free(&d.memory); /* or the surface would be an earlier one */
  d.first_triangle_count = mesh.triangle_count;
  CHECK_OK(scree_decimate_keep(&d), error);
  assert_int_equal(d.memory.left, mesh.vertex_count);
  check_places(&d);
  check_witnesses(&d, &mean, &worst);
  CHECK_NEAR(d.memory.roughness, mean, 1e-9 * mean);
  CHECK_NEAR(scree_memory_usual(&d.memory, false), (10 - ROUGH) * mean, 1e-9 * mean);
  for (size_t j = 0; j < d.memory.count; j++) {
    scree_bvh_hit hit = {.distance2 = INFINITY};
    assert_true(scree_bvh_closest(&d.memory.surface, d.memory.witnesses[j].at, &hit));
    farther += sqrt(d.memory.witnesses[j].distance2) > sqrt(hit.distance2) + 1e-12;
  }
  assert_true(farther <= d.memory.count / 100);
  d.options.stop_count = 0;
  CHECK_OK(scree_decimate_in_batches(&d), error);
  check_witnesses(&d, &mean, &worst);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

/* The surface is kept before its witnesses, and stays what it was then. */
static void surface_is_kept_before_its_witnesses(void **state) {
  (void)state;
  scree_rng rng = {.seed = 34};
  scree_error error;
  double mean, worst;
  scree_mesh mesh = shape_icosphere(0.03, 7); /* 327,680 triangles */
  shape_shake(&mesh, 5e-5, &rng);
  scree_decimator d = begin_decimation(&mesh, &scree_volume_coster, &error);
  d.options.stop_count = SCREE_SURFACE_COUNT + 1;
  CHECK_OK(scree_decimate_in_batches(&d), error);
  assert_false(scree_memory_has_surface(&d.memory));
  d.options.stop_count = SCREE_KEPT_COUNT + 1;
  CHECK_OK(scree_decimate_in_batches(&d), error);
  assert_true(scree_memory_has_surface(&d.memory));
  assert_false(scree_memory_is_kept(&d.memory));
  size_t kept = d.memory.surface.triangle_count;
  assert_in_range(kept, d.s.live_triangle_count, SCREE_SURFACE_COUNT);
  d.options.stop_count = SCREE_KEPT_COUNT / 2;
  CHECK_OK(scree_decimate_in_batches(&d), error);
  assert_int_equal(d.memory.left, mesh.vertex_count);
  assert_int_equal(d.memory.surface.triangle_count, kept);
  check_witnesses(&d, &mean, &worst);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

/* Against the distances of the new vertex and of so many places on every new edge, evenly spread,
 * each by itself. */
static void check_on_edges(const scree_decimator *d, const scree_ring *ring, vec3 target,
                           uint32_t places) {
  scree_bvh_hit hit = {.distance2 = INFINITY};
  scree_memory bare = d->memory; /* as while there are no witnesses */
  bare.first = NULL;
  assert_true(scree_bvh_closest(&bare.surface, target, &hit));
  double worst2 = hit.distance2;
  for (uint32_t i = 0; i < ring->count; i++) {
    vec3 end = d->s.vertex[d->s.half[ring->edge[i]].from].at;
    for (uint32_t k = 1; k <= places; k++) {
      hit.distance2 = INFINITY;
      assert_true(
          scree_bvh_closest(&bare.surface, vec3_lerp(target, end, k / (places + 1.0)), &hit));
      worst2 = fmax(worst2, hit.distance2);
    }
  }
  assert_true(scree_memory_stays_within(&bare, &d->s, ring, target, places, 1.001 * worst2));
  assert_false(scree_memory_stays_within(&bare, &d->s, ring, target, places, 0.999 * worst2));
}

/* What batches ask against the stray that single collapses find. */
static void limits_are_those_of_the_stray(void **state) {
  (void)state;
  scree_rng rng = {.seed = 35};
  scree_error error;
  scree_hints hints;
  const uint32_t places[] = {1, SCREE_EDGE_PLACES, SCREE_MOST_EDGE_PLACES};
  size_t tried = 0;
  scree_mesh mesh = shaken_sphere();
  scree_decimator d = begin_decimation(&mesh, &scree_volume_coster, &error);
  d.single_from = SCREE_GREEDY_COUNT;
  CHECK_OK(scree_decimate_in_batches(&d), error);
  for (uint32_t h = 0; h < 3 * d.s.triangle_count; h += 29) {
    uint32_t edges[SCREE_RING_MAX];
    scree_ring ring = {.edge = edges};
    if (scree_is_gone(&d.s, h / 3) || !scree_ring_gather(&d.s, h, &ring)) continue;
    vec3 target =
        vec3_lerp(d.s.vertex[ring.a].at, d.s.vertex[ring.b].at, 2 * scree_rng_uniform(&rng) - 0.5);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
      scree_no_hints(&hints);
      double stray2 =
          scree_memory_stray(&d.memory, &d.s, &ring, target, places[i], 0, INFINITY, &hints);
      if (!(stray2 > 0)) continue;
      assert_true(
          scree_memory_stays_within(&d.memory, &d.s, &ring, target, places[i], 1.001 * stray2));
      assert_false(
          scree_memory_stays_within(&d.memory, &d.s, &ring, target, places[i], 0.999 * stray2));
      check_on_edges(&d, &ring, target, places[i]);
      tried++;
    }
  }
  assert_true(tried > 300);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

static bool is_witness(const scree_decimator *d, uint32_t vertex) {
  vec3 at = scree_into_box(&d->s, vec3_load(d->mesh->positions + 3 * (size_t)vertex));
  for (size_t j = 0; j < d->memory.count; j++)
    if (vec3_norm(vec3_sub(d->memory.witnesses[j].at, at)) == 0) return true;
  return false;
}

/* Of a large scan those that are there and the last eighth of those that went. */
static void few_are_remembered_of_large_scans(void **state) {
  (void)state;
  scree_error error;
  double mean, worst;
  scree_mesh mesh = shaken_sphere();
  scree_decimator d = begin_decimation(&mesh, &scree_volume_coster, &error);
  CHECK_OK(scree_decimate_in_batches(&d), error);
  scree_memory_free(&d.memory);
  d.first_triangle_count = SCREE_LARGE_COUNT + 1;
  CHECK_OK(scree_decimate_keep(&d), error);
  const scree_record *r = &d.record;
  size_t last = r->count / 8;
  assert_int_equal(d.memory.left, d.s.live_vertex_count + last);
  for (size_t i = 0; i < r->count; i += 97)
    assert_int_equal(is_witness(&d, r->gone[i]), i >= r->count - last);
  check_places(&d);
  check_witnesses(&d, &mean, &worst);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

/* Against the distance of the ends from all triangles of the surface after the collapse. */
static void ends_are_near_or_not(void **state) {
  (void)state;
  scree_rng rng = {.seed = 33};
  scree_error error;
  size_t near_count = 0, tried = 0;
  scree_mesh mesh = shape_icosphere(1, 2);
  shape_shake(&mesh, 0.1, &rng);
  for (uint32_t h = 0; h < 3 * mesh.triangle_count; h += 7) {
    scree_halfmesh s;
    scree_ring ring = {.edge = (uint32_t[SCREE_RING_MAX]){0}};
    CHECK_OK(scree_halfmesh_build(&mesh, &s, &error), error);
    assert_true(scree_ring_gather(&s, h, &ring));
    vec3 a = s.vertex[ring.a].at, b = s.vertex[ring.b].at;
    vec3 target = vec3_scale(vec3_add(a, b), 0.5 + 0.1 * scree_rng_uniform(&rng));
    double most = 0.1 * scree_rng_uniform(&rng), off_a = INFINITY, off_b = INFINITY;
    bool near = scree_ends_stay_within(&s, &ring, target, most * most);
    uint32_t *edges = malloc(ring.count * sizeof *edges);
    memcpy(edges, ring.edge, ring.count * sizeof *edges);
    scree_collapse_apply(&s, &ring, target);
    for (uint32_t i = 0; i < ring.count; i++) {
      off_a = fmin(off_a, distance_from(&s, edges[i] / 3, a));
      off_b = fmin(off_b, distance_from(&s, edges[i] / 3, b));
    }
    assert_int_equal(near, fmax(off_a, off_b) <= most);
    near_count += near;
    tried++;
    free(edges);
    scree_halfmesh_free(&s);
  }
  assert_in_range(near_count, tried / 10, tried - tried / 10);
  scree_mesh_free(&mesh);
}

/* All witnesses at one triangle: in the order of their distances, those of even rank stay. */
static void every_second_goes(void **state) {
  (void)state;
  scree_rng rng = {.seed = 32};
  scree_error error;
  scree_memory m = {0};
  scree_halfmesh s;
  scree_mesh mesh = shape_icosphere(1, 3);
  CHECK_OK(scree_halfmesh_build(&mesh, &s, &error), error);
  CHECK_OK(scree_memory_keep(&s, NULL, 0, &m, &error), error);
  double all[642], sum = 0;
  assert_int_equal(m.count, 642);
  memset(m.first, 0xff, s.triangle_count * sizeof *m.first);
  for (uint32_t j = 0; j < 642; j++) {
    all[j] = m.witnesses[j].distance2 = scree_rng_uniform(&rng) + 1e-3;
    m.witnesses[j].next = m.first[0];
    m.first[0] = j;
  }
  scree_memory_thin(&m, &s, 24, 0); /* 1,280 triangles: not crowded */
  assert_int_equal(m.left, 642);
  s.live_triangle_count = 20;
  scree_memory_thin(&m, &s, 48, 0); /* 642 not above 960 */
  assert_int_equal(m.left, 642);
  scree_memory_thin(&m, &s, 24, 642); /* crowded, but no more than are to stay */
  assert_int_equal(m.left, 642);
  scree_memory_thin(&m, &s, 24, 641); /* 642 above 480, 321 not */
  assert_int_equal(m.left, 321);
  double before = INFINITY;
  size_t count = 0;
  for (uint32_t j = m.first[0]; j != SCREE_NONE; j = m.witnesses[j].next, count++) {
    double distance2 = m.witnesses[j].distance2;
    size_t rank = 0;
    for (size_t k = 0; k < 642; k++) rank += all[k] > distance2;
    assert_int_equal(rank, 2 * count);
    assert_true(distance2 <= before);
    before = distance2;
    sum += sqrt(distance2);
  }
  assert_int_equal(count, 321);
  CHECK_NEAR(scree_memory_usual(&m, false), 10 * sum / 321, 1e-12);
  s.live_triangle_count = 1280;
  scree_memory_free(&m);
  scree_halfmesh_free(&s);
  scree_mesh_free(&mesh);
}

/* 100 triangles or so, each vertex of the scan that went a witness or not. */
static scree_decimator coarse(const scree_mesh *mesh, scree_error *error) {
  scree_decimator d = begin_decimation(mesh, &scree_volume_coster, error);
  d.options.stop_count = 100;
  CHECK_OK(scree_decimate_in_batches(&d), *error);
  CHECK_OK(scree_decimate_one_by_one(&d), *error);
  assert_true(d.s.live_triangle_count <= 100);
  return d;
}

/* Each of every so many that went, at the nearest of all triangles; together those of a triangle
 * weigh as much as its share of the area. */
static void witnesses_are_spread(void **state) {
  (void)state;
  scree_error error;
  scree_mesh mesh = shaken_sphere();
  scree_decimator d = coarse(&mesh, &error);
  const scree_record *r = &d.record;
  const scree_memory *m = &d.memory;
  CHECK_OK(scree_decimate_spread(&d, &d.record, d.record.count), error);
  assert_int_equal(m->count, SCREE_SPREAD_COUNT);
  assert_int_equal(m->left, SCREE_SPREAD_COUNT);
  double sum = 0, weights = 0, unit = m->area / (double)m->count;
  for (uint32_t t = 0; t < d.s.triangle_count; t++) {
    vec3 at[3];
    double of_triangle = 0;
    if (scree_is_gone(&d.s, t)) continue;
    for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) {
      const scree_witness *w = &m->witnesses[j];
      double distance = sqrt(w->distance2), least = INFINITY;
      size_t place = (size_t)(((double)j + 0.5) * (double)r->count / (double)m->count);
      vec3 p = scree_into_box(&d.s, vec3_load(mesh.positions + 3 * (size_t)r->gone[place]));
      assert_true(vec3_norm(vec3_sub(w->at, p)) == 0);
      for (uint32_t k = 0; k < d.s.triangle_count; k++)
        if (!scree_is_gone(&d.s, k)) least = fmin(least, distance_from(&d.s, k, w->at));
      CHECK_NEAR(distance, least, SCREE_SAME_DISTANCE);
      CHECK_NEAR(distance_from(&d.s, t, w->at), least, SCREE_SAME_DISTANCE);
      of_triangle += (double)w->weight;
      sum += (double)w->weight * distance;
    }
    scree_corners(&d.s, t, at);
    double area = 0.5 * vec3_norm(vec3_triangle_normal(at[0], at[1], at[2]));
    assert_true(of_triangle > 0);
    CHECK_NEAR(of_triangle * unit, area, 1e-6 * area);
    weights += of_triangle;
  }
  CHECK_NEAR(m->weight, weights, 1e-9 * weights);
  CHECK_NEAR(scree_memory_mean(m), sum / weights, 1e-12);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

/* After vertices moved, by little and by much: the nearest of its triangle and those beside. */
static void witnesses_follow(void **state) {
  (void)state;
  scree_rng rng = {.seed = 35};
  scree_error error;
  size_t stayed = 0, went = 0;
  scree_mesh mesh = shaken_sphere();
  scree_decimator d = coarse(&mesh, &error);
  scree_halfmesh *s = &d.s;
  scree_memory *m = &d.memory;
  CHECK_OK(scree_decimate_spread(&d, &d.record, d.record.count), error);
  uint32_t *held = malloc(m->count * sizeof *held);
  uint32_t *lists = malloc(s->triangle_count * sizeof *lists);
  uint32_t *triangle = malloc(m->count * sizeof *triangle);
  for (int round = 0; round < 6; round++) {
    for (uint32_t t = 0; t < s->triangle_count; t++)
      for (uint32_t j = scree_is_gone(s, t) ? SCREE_NONE : m->first[t]; j != SCREE_NONE;
           j = m->witnesses[j].next)
        held[j] = t;
    for (uint32_t v = 0; v < s->vertex_count; v++)
      for (int k = 0; k < 3; k++) {
        vec3 off = {scree_rng_uniform(&rng) - 0.5, scree_rng_uniform(&rng) - 0.5,
                    scree_rng_uniform(&rng) - 0.5};
        s->vertex[v].at = vec3_mad(s->vertex[v].at, off, 0.01 * (1 << round) / 3);
      }
    for (uint32_t t = 0; t < s->triangle_count; t++)
      if (scree_is_gone(s, t)) m->first[t] = SCREE_NONE;
    scree_memory_follow(m, s, lists, triangle);
    for (uint32_t t = 0; t < s->triangle_count; t++)
      for (uint32_t j = m->first[t]; j != SCREE_NONE; j = m->witnesses[j].next) {
        const scree_witness *w = &m->witnesses[j];
        double least = distance_from(s, held[j], w->at);
        for (uint32_t h = 3 * held[j]; h < 3 * held[j] + 3; h++)
          least = fmin(least, distance_from(s, s->half[h].twin / 3, w->at));
        CHECK_NEAR(sqrt(w->distance2), least, SCREE_SAME_DISTANCE);
        CHECK_NEAR(distance_from(s, t, w->at), least, SCREE_SAME_DISTANCE);
        stayed += t == held[j];
        went += t != held[j];
      }
  }
  assert_int_equal(stayed + went, 6 * m->count);
  assert_true(went > m->count / 10);
  free(held);
  free(lists);
  free(triangle);
  scree_decimator_free(&d);
  scree_mesh_free(&mesh);
}

/* Each witness of weight v twice, with v/3 and 2 v/3. */
static void split_witnesses(scree_memory *m, const scree_halfmesh *s) {
  size_t count = m->count;
  scree_witness *twice = scree_alloc(2 * count, sizeof *twice);
  for (uint32_t j = 0; j < count; j++) {
    twice[j] = twice[count + j] = m->witnesses[j];
    twice[j].weight /= 3;
    twice[count + j].weight -= twice[j].weight;
  }
  for (uint32_t t = 0; t < s->triangle_count; t++)
    for (uint32_t *at = &m->first[t]; !scree_is_gone(s, t) && *at != SCREE_NONE;) {
      uint32_t j = *at, next = twice[j].next;
      twice[j].next = (uint32_t)count + j;
      twice[count + j].next = next;
      at = &twice[count + j].next;
    }
  scree_free(m->witnesses);
  m->witnesses = twice;
  m->count = m->left = 2 * count;
}

/* What the witnesses say counts by their weights: one that stands in two parts says the same. */
static void weights_add_up(void **state) {
  (void)state;
  scree_rng rng = {.seed = 34};
  scree_error error;
  scree_mesh mesh = shaken_sphere();
  scree_decimator d = coarse(&mesh, &error), split = coarse(&mesh, &error);
  size_t tried = 0;
  CHECK_OK(scree_decimate_spread(&d, &d.record, d.record.count), error);
  CHECK_OK(scree_decimate_spread(&split, &split.record, split.record.count), error);
  split_witnesses(&split.memory, &split.s);
  double mean = scree_memory_mean(&d.memory);
  CHECK_NEAR(scree_memory_mean(&split.memory), mean, 1e-7 * mean);
  for (uint32_t v = 0; v < d.s.vertex_count; v++) {
    uint32_t edges[SCREE_RING_MAX];
    scree_ring fan = {.edge = edges};
    scree_pull a, b;
    scree_relaxation of_a, of_b;
    double worst_a, worst_b;
    if (d.s.vertex[v].outgoing == SCREE_NONE || !scree_ring_gather_fan(&d.s, v, &fan)) continue;
    assert_true(scree_pull_find(&d.memory, &d.s, &fan, &a));
    assert_true(scree_pull_find(&split.memory, &split.s, &fan, &b));
    CHECK_NEAR(vec3_norm(vec3_sub(a.free, b.free)), 0, 1e-6 * vec3_norm(a.free));
    CHECK_NEAR(a.n_per_n, b.n_per_n, 1e-6 * a.n_per_n);
    CHECK_NEAR(a.sum, b.sum, 1e-6 * a.sum);
    vec3 x = vec3_mad(a.from, a.n, 0.1 * scree_rng_uniform(&rng));
    double growth = scree_memory_growth(&d.memory, &d.s, &fan, x, 0, &worst_a);
    CHECK_NEAR(scree_memory_growth(&split.memory, &split.s, &fan, x, 0, &worst_b), growth,
               1e-6 * (fabs(growth) + a.sum));
    assert_true(worst_a == worst_b);
    scree_relax_alone(&a, &fan, &of_a);
    scree_relax_alone(&b, &fan, &of_b);
    for (double share = 0.25; share <= 1; share += 0.25) {
      vec3 place;
      scree_relax_places(&of_a, 1, share, &place);
      assert_int_equal(scree_relax_gains(&d.memory, &d.s, &of_a, 1, &place),
                       scree_relax_gains(&split.memory, &split.s, &of_b, 1, &place));
    }
    tried++;
  }
  assert_true(tried > 30);
  scree_decimator_free(&d);
  scree_decimator_free(&split);
  scree_mesh_free(&mesh);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(witnesses_go_with_the_batches),
                                     cmocka_unit_test(what_went_before_is_remembered),
                                     cmocka_unit_test(surface_is_kept_before_its_witnesses),
                                     cmocka_unit_test(limits_are_those_of_the_stray),
                                     cmocka_unit_test(few_are_remembered_of_large_scans),
                                     cmocka_unit_test(ends_are_near_or_not),
                                     cmocka_unit_test(every_second_goes),
                                     cmocka_unit_test(witnesses_are_spread),
                                     cmocka_unit_test(witnesses_follow),
                                     cmocka_unit_test(weights_add_up)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
