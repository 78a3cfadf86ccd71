/* What a fused structured-light scan adds to a surface, after the paper's set-up: 15 views around a
 * turntable in each of three postures (upright, inclined by 90 degrees, by 180).
 *
 * 1. Grazing views. One view measures the depth of a surface with an error that grows like 1/cos of
 *    the angle between normal and line of sight, up to 75 degrees, where it loses the stripes. The
 *    views are fused with weights 1/variance, so the fused error is
 *      coverage(n)^2 = W / sum over views of cos^2,   W the mean of that sum over all normals.
 * 2. Edges. A camera pixel on an edge sees both its sides; the error grows there, to at most twice.
 * 3. Correlation. Neighbouring pixels share stripes, filters and fusion. The field is a sum of two
 *    lattices of independent numbers, each blended by quadratic B-splines and divided by the root
 * of the sum of the squared weights, so that the variance is 1 at every point: a fine one (80 % of
 *    the variance, lattice 0.27 mm: points 0.27 mm apart correlate with about 0.4) and a coarse one
 *    (20 %, 3 mm: errors of registration and of the stripes' phase).
 *
 * The lattices are fixed in space and their numbers are counter-based, keyed on the lattice point:
 * the same place gets the same error at any resolution. */
#include "sample/scanner.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "base/rng.h"

enum { RINGS = 3, VIEWS_PER_RING = 15, HALVINGS = 8 };

static const double elevation = 20 * 3.14159265358979323846 / 180; /* of the camera */
static const double lost_cosine = 0.25881904510252074;             /* cos 75 degrees */
/* The mean over directions of the sum of cos^2: each of the 45 views contributes
 * (1 - lost_cosine^3) / 6. */
static const double mean_coverage = RINGS * VIEWS_PER_RING * (1 - 0.017337) / 6;
static const double edge_full = 0.094; /* 1 - cos of half of 50 degrees */
static const double upright = 0.2;     /* a triangle may lean this far (cosine) from its normals */

static const struct {
  double spacing, share; /* metres; of the variance */
} lattices[2] = {{0.27e-3, 0.8}, {3e-3, 0.2}};

/* ---- The field ---- */

/* Standard normal within the fourth moment's reach: the sum of four uniform 16-bit numbers. The
 * blend of 27 of them is as normal as anyone can measure. */
static double lattice_value(uint64_t seed, int lattice, const int64_t at[3]) {
  uint64_t key = ((uint64_t)at[0] & 0x1fffff) | ((uint64_t)at[1] & 0x1fffff) << 21 |
                 ((uint64_t)at[2] & 0x1fffff) << 42;
  uint64_t bits = scree_rng_bits(seed, key, (uint64_t)lattice);
  int64_t sum =
      (int64_t)((bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48));
  return (double)(sum - 131070) / 37837.22756292128; /* sqrt((2^32 - 1) / 3) */
}

/* The three B-spline weights of a coordinate, divided by the root of their squares' sum. */
static int64_t spline(double x, double weight[3]) {
  double nearest = floor(x + 0.5), f = x - nearest;
  weight[0] = 0.5 * (0.5 - f) * (0.5 - f);
  weight[1] = 0.75 - f * f;
  weight[2] = 0.5 * (0.5 + f) * (0.5 + f);
  double norm = sqrt(weight[0] * weight[0] + weight[1] * weight[1] + weight[2] * weight[2]);
  for (int i = 0; i < 3; i++) weight[i] /= norm;
  return (int64_t)nearest;
}

static double lattice_field(uint64_t seed, int lattice, vec3 p) {
  double w[3][3], spacing = lattices[lattice].spacing, sum = 0;
  const int64_t centre[3] = {spline(p.x / spacing, w[0]), spline(p.y / spacing, w[1]),
                             spline(p.z / spacing, w[2])};
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 3; j++)
      for (int i = 0; i < 3; i++) {
        const int64_t at[3] = {centre[0] + i - 1, centre[1] + j - 1, centre[2] + k - 1};
        sum += w[0][i] * w[1][j] * w[2][k] * lattice_value(seed, lattice, at);
      }
  return sum;
}

double scree_scanner_field(uint64_t seed, vec3 position) {
  double sum = 0;
  for (int l = 0; l < 2; l++) sum += sqrt(lattices[l].share) * lattice_field(seed, l, position);
  return sum;
}

double scree_scanner_correlation(double distance) {
  enum { PLACES = 64 };
  double sum = 0;
  for (int l = 0; l < 2; l++)
    for (int i = 0; i < PLACES; i++) {
      double a[3], b[3], x = (i + 0.5) / PLACES;
      int64_t at_a = spline(x, a), at_b = spline(x + distance / lattices[l].spacing, b);
      for (int64_t n = at_b - 1; n <= at_a + 1; n++)
        if (n >= at_a - 1 && n <= at_b + 1)
          sum += lattices[l].share * a[n - at_a + 1] * b[n - at_b + 1] / PLACES;
    }
  return sum;
}

/* ---- Grazing angles and edges ---- */

/* Unit vectors towards the camera. The object's y axis is the turntable's in the first posture, its
 * z axis in the second, and it stands on its head in the third. */
static void make_views(vec3 views[RINGS * VIEWS_PER_RING]) {
  double up = scree_sin(elevation), out = scree_cos(elevation);
  for (int v = 0; v < VIEWS_PER_RING; v++) {
    double turn = 2 * 3.14159265358979323846 * v / VIEWS_PER_RING;
    double a = out * scree_cos(turn), b = out * scree_sin(turn);
    views[v] = (vec3){a, up, b};
    views[VIEWS_PER_RING + v] = (vec3){a, b, up};
    views[2 * VIEWS_PER_RING + v] = (vec3){a, -up, b};
  }
}

static double coverage(const vec3 *views, vec3 normal) {
  double sum = 0;
  for (int v = 0; v < RINGS * VIEWS_PER_RING; v++) {
    double cosine = vec3_dot(views[v], normal);
    sum += cosine > lost_cosine ? cosine * cosine : 0;
  }
  return sqrt(mean_coverage / sum);
}

double scree_scanner_coverage(vec3 normal) {
  vec3 views[RINGS * VIEWS_PER_RING];
  make_views(views);
  return coverage(views, normal);
}

/* ---- On a mesh ---- */

typedef struct scan {
  const scree_scanner *scanner;
  scree_mesh *mesh;
  vec3 *normals, *moves; /* per vertex */
  double *edge;          /* per vertex: 1 - the worst cosine to a triangle around it */
  vec3 views[RINGS * VIEWS_PER_RING];
} scan;

static void corners(const scree_mesh *mesh, size_t t, vec3 p[3]) {
  for (int i = 0; i < 3; i++) p[i] = vec3_load(mesh->positions + 3 * mesh->triangles[3 * t + i]);
}

/* Area-weighted vertex normals and how far the triangles around lean from them. One thread: the
 * sums keep the triangles' order. */
static void survey(scan *s) {
  const scree_mesh *mesh = s->mesh;
  vec3 p[3];
  for (size_t v = 0; v < mesh->vertex_count; v++) {
    s->normals[v] = (vec3){0, 0, 0};
    s->edge[v] = 0;
  }
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    corners(mesh, t, p);
    vec3 normal = vec3_triangle_normal(p[0], p[1], p[2]);
    for (int i = 0; i < 3; i++) {
      vec3 *sum = &s->normals[mesh->triangles[3 * t + i]];
      *sum = vec3_add(*sum, normal);
    }
  }
  for (size_t v = 0; v < mesh->vertex_count; v++) s->normals[v] = vec3_unit(s->normals[v]);
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    corners(mesh, t, p);
    vec3 normal = vec3_unit(vec3_triangle_normal(p[0], p[1], p[2]));
    for (int i = 0; i < 3; i++) {
      uint32_t v = mesh->triangles[3 * t + i];
      double lean = 1 - vec3_dot(normal, s->normals[v]);
      if (lean > s->edge[v]) s->edge[v] = lean;
    }
  }
}

static void displace(void *context, scree_block block) {
  scan *s = context;
  for (size_t v = block.begin; v < block.end; v++) {
    vec3 normal = s->normals[v], p = vec3_load(s->mesh->positions + 3 * v);
    double edge = s->edge[v] < edge_full ? s->edge[v] / edge_full : 1;
    double size = vec3_norm2(normal) > 0 ? s->scanner->sigma * coverage(s->views, normal) : 0;
    s->moves[v] = vec3_scale(normal, size * (1 + edge) * scree_scanner_field(s->scanner->seed, p));
  }
}

/* The worst cosine between a triangle's normal and its vertices' clean normals. */
static double standing(const scan *s, const uint32_t *triangle, const vec3 p[3]) {
  vec3 normal = vec3_unit(vec3_triangle_normal(p[0], p[1], p[2]));
  double worst = 1;
  for (int i = 0; i < 3; i++) {
    double cosine = vec3_dot(normal, s->normals[triangle[i]]);
    if (cosine < worst) worst = cosine;
  }
  return worst;
}

/* Halves the moves of triangles that they would turn over; false where all stand. Which vertices
 * are halved depends on the moves before only. */
static bool restrain(scan *s, uint8_t *halve) {
  bool any = false;
  for (size_t t = 0; t < s->mesh->triangle_count; t++) {
    const uint32_t *triangle = s->mesh->triangles + 3 * t;
    vec3 clean[3], moved[3];
    corners(s->mesh, t, clean);
    for (int i = 0; i < 3; i++) moved[i] = vec3_add(clean[i], s->moves[triangle[i]]);
    double after = standing(s, triangle, moved);
    if (after > upright || after > 0.7 * standing(s, triangle, clean)) continue;
    for (int i = 0; i < 3; i++) halve[triangle[i]] = 1;
    any = true;
  }
  for (size_t v = 0; any && v < s->mesh->vertex_count; v++) {
    if (halve[v]) s->moves[v] = vec3_scale(s->moves[v], 0.5);
    halve[v] = 0;
  }
  return any;
}

scree_status scree_scanner_apply(const scree_scanner *scanner, scree_mesh *mesh,
                                 scree_error *error) {
  scan s = {.scanner = scanner, .mesh = mesh};
  SCREE_SCRATCH(vec3, normals, mesh->vertex_count, error);
  SCREE_SCRATCH(vec3, moves, mesh->vertex_count, error);
  SCREE_SCRATCH(double, edge, mesh->vertex_count, error);
  SCREE_SCRATCH_ZERO(uint8_t, halve, mesh->vertex_count, error);
  s.normals = normals, s.moves = moves, s.edge = edge;
  make_views(s.views);
  survey(&s);
  scree_parallel_for(mesh->vertex_count, 4096, displace, &s);
  for (int i = 0; i < HALVINGS && restrain(&s, halve); i++) {
  }
  for (size_t v = 0; v < mesh->vertex_count; v++)
    vec3_store(mesh->positions + 3 * v, vec3_add(vec3_load(mesh->positions + 3 * v), moves[v]));
  return SCREE_OK;
}
