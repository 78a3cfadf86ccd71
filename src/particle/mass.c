/* Mass properties.
 *
 * A closed mesh is the signed sum of the tetrahedra (0, v0, v1, v2) (Lien and Kajiya 1984). With
 * D = v0.(v1 x v2) and s = v0 + v1 + v2:
 *   V = sum D / 6,   c = sum D s / (24 V),   C = sum D (s s^T + sum_a v_a v_a^T) / 120.
 * Coordinates are taken about the first vertex and the sums are compensated, so that a body far
 * from the origin loses nothing. The inertia is tr(C) 1 - C. Its principal frame comes from cyclic
 * Jacobi rotations (Golub and Van Loan, 8.5).
 *
 * The union of spheres is integrated along lines parallel to z: the chord of each line with the
 * union is exact, the lines stand on a grid of 512 cells along the longer side. */
#include "particle/mass.h"

#include "base/alloc.h"
#include "base/sum.h"

enum { SPHERE_GRID = 512 };

/* Moments of order 0, 1 and 2 (xx yy zz xy xz yz) about a shifted origin. */
typedef struct moments {
  scree_sum volume, first[3], second[6];
} moments;

static const int second_index[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

static scree_solid solid_from_moments(const moments *m, vec3 origin) {
  scree_solid solid = {.volume = scree_sum_value(m->volume)};
  if (!(solid.volume > 0)) return solid;
  double c[3], cc[6];
  for (int i = 0; i < 3; i++) c[i] = scree_sum_value(m->first[i]) / solid.volume;
  for (int k = 0; k < 6; k++) {
    int i = second_index[k][0], j = second_index[k][1];
    cc[k] = scree_sum_value(m->second[k]) - solid.volume * c[i] * c[j];
    solid.second.m[i][j] = solid.second.m[j][i] = cc[k];
  }
  solid.centre = vec3_add(origin, vec3_load(c));
  return solid;
}

scree_solid scree_solid_of_mesh(const scree_mesh *mesh) {
  moments m = {0};
  vec3 origin = vec3_load(mesh->positions);
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    double v[3][3], s[3];
    for (int a = 0; a < 3; a++)
      vec3_store(v[a], vec3_sub(vec3_load(&mesh->positions[3 * mesh->triangles[3 * t + (size_t)a]]),
                                origin));
    for (int i = 0; i < 3; i++) s[i] = v[0][i] + v[1][i] + v[2][i];
    double d = vec3_dot(vec3_load(v[0]), vec3_cross(vec3_load(v[1]), vec3_load(v[2])));
    scree_sum_add(&m.volume, d / 6);
    for (int i = 0; i < 3; i++) scree_sum_add(&m.first[i], d * s[i] / 24);
    for (int k = 0; k < 6; k++) {
      int i = second_index[k][0], j = second_index[k][1];
      double vv = v[0][i] * v[0][j] + v[1][i] * v[1][j] + v[2][i] * v[2][j];
      scree_sum_add(&m.second[k], d * (s[i] * s[j] + vv) / 120);
    }
  }
  return solid_from_moments(&m, origin);
}

typedef struct chord {
  double low, high;
} chord;

/* Adds the line at (x, y) of cross-section `area` covered from z0 to z1. */
static void add_chord(moments *m, const double xy[2], double area, chord z) {
  double z1 = z.high - z.low, z2 = (z.high * z.high - z.low * z.low) / 2,
         z3 = (z.high * z.high * z.high - z.low * z.low * z.low) / 3;
  double x = xy[0], y = xy[1];
  const double first[3] = {x * z1, y * z1, z2},
               second[6] = {x * x * z1, y * y * z1, z3, x * y * z1, x * z2, y * z2};
  scree_sum_add(&m->volume, area * z1);
  for (int i = 0; i < 3; i++) scree_sum_add(&m->first[i], area * first[i]);
  for (int k = 0; k < 6; k++) scree_sum_add(&m->second[k], area * second[k]);
}

/* The union of sorted chords, merged on the way. */
static void add_line(moments *m, const double xy[2], double area, chord *chords, size_t count) {
  for (size_t i = 1; i < count; i++) { /* few: insertion sort */
    chord moved = chords[i];
    size_t j = i;
    for (; j > 0 && chords[j - 1].low > moved.low; j--) chords[j] = chords[j - 1];
    chords[j] = moved;
  }
  for (size_t i = 0; i < count;) {
    chord merged = chords[i++];
    for (; i < count && chords[i].low <= merged.high; i++)
      merged.high = scree_max(merged.high, chords[i].high);
    add_chord(m, xy, area, merged);
  }
}

scree_solid scree_solid_of_spheres(const double *centres, const double *radii, size_t count) {
  vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < count; i++) {
    vec3 c = vec3_load(&centres[3 * i]), r = {radii[i], radii[i], radii[i]};
    low = vec3_min(low, vec3_sub(c, r));
    high = vec3_max(high, vec3_add(c, r));
  }
  moments m = {0};
  vec3 origin = vec3_scale(vec3_add(low, high), 0.5), size = vec3_sub(high, low);
  chord *chords = scree_alloc(count, sizeof *chords);
  if (!chords) return (scree_solid){0};
  double step = scree_max(size.x, size.y) / SPHERE_GRID;
  size_t nx = (size_t)ceil(size.x / step), ny = (size_t)ceil(size.y / step);
  for (size_t iy = 0; iy < ny; iy++)
    for (size_t ix = 0; ix < nx; ix++) {
      double xy[2] = {low.x - origin.x + ((double)ix + 0.5) * step,
                      low.y - origin.y + ((double)iy + 0.5) * step};
      size_t hits = 0;
      for (size_t i = 0; i < count; i++) {
        double x = centres[3 * i] - origin.x - xy[0], y = centres[3 * i + 1] - origin.y - xy[1],
               z = centres[3 * i + 2] - origin.z, h2 = radii[i] * radii[i] - x * x - y * y;
        if (h2 > 0) chords[hits++] = (chord){z - sqrt(h2), z + sqrt(h2)};
      }
      add_line(&m, xy, step * step, chords, hits);
    }
  scree_free(chords);
  return solid_from_moments(&m, origin);
}

/* One Jacobi rotation that zeroes a[p][q] and is collected in v. */
static void rotate_away(mat3 *a, mat3 *v, int p, int q) {
  if (a->m[p][q] == 0) return;
  double theta = (a->m[q][q] - a->m[p][p]) / (2 * a->m[p][q]);
  double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
  double c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < 3; k++) {
    double x = a->m[k][p], y = a->m[k][q];
    a->m[k][p] = c * x - s * y;
    a->m[k][q] = s * x + c * y;
  }
  for (int k = 0; k < 3; k++) {
    double x = a->m[p][k], y = a->m[q][k];
    a->m[p][k] = c * x - s * y;
    a->m[q][k] = s * x + c * y;
  }
  for (int k = 0; k < 3; k++) {
    double x = v->m[k][p], y = v->m[k][q];
    v->m[k][p] = c * x - s * y;
    v->m[k][q] = s * x + c * y;
  }
}

quat quat_from_mat3(const mat3 *r) {
  double d[4] = {r->m[0][0] + r->m[1][1] + r->m[2][2], r->m[0][0] - r->m[1][1] - r->m[2][2],
                 r->m[1][1] - r->m[0][0] - r->m[2][2], r->m[2][2] - r->m[0][0] - r->m[1][1]};
  double q01 = r->m[2][1] - r->m[1][2], q02 = r->m[0][2] - r->m[2][0],
         q03 = r->m[1][0] - r->m[0][1], q12 = r->m[0][1] + r->m[1][0],
         q13 = r->m[0][2] + r->m[2][0], q23 = r->m[1][2] + r->m[2][1];
  int largest = 0;
  for (int i = 1; i < 4; i++)
    if (d[i] > d[largest]) largest = i;
  quat q = largest == 0   ? (quat){1 + d[0], q01, q02, q03}
           : largest == 1 ? (quat){q01, 1 + d[1], q12, q13}
           : largest == 2 ? (quat){q02, q12, 1 + d[2], q23}
                          : (quat){q03, q13, q23, 1 + d[3]};
  return quat_unit(q);
}

void scree_solid_principal(const scree_solid *solid, vec3 *moments_out, quat *orientation) {
  mat3 a = solid->second, v = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  double scale = a.m[0][0] + a.m[1][1] + a.m[2][2];
  for (int sweep = 0; sweep < 50; sweep++) {
    double off = fabs(a.m[0][1]) + fabs(a.m[0][2]) + fabs(a.m[1][2]);
    if (off <= 1e-15 * scale) break;
    rotate_away(&a, &v, 0, 1);
    rotate_away(&a, &v, 0, 2);
    rotate_away(&a, &v, 1, 2);
  }
  /* Moments tr(C) - C_ii ascend as C_ii descends. */
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 3; i++)
    for (int j = i + 1; j < 3; j++)
      if (a.m[order[j]][order[j]] > a.m[order[i]][order[i]]) {
        int swapped = order[i];
        order[i] = order[j];
        order[j] = swapped;
      }
  double c[3];
  mat3 r;
  for (int i = 0; i < 3; i++) {
    c[i] = a.m[order[i]][order[i]];
    for (int k = 0; k < 3; k++) r.m[k][i] = v.m[k][order[i]];
  }
  vec3 x = {r.m[0][0], r.m[1][0], r.m[2][0]}, y = {r.m[0][1], r.m[1][1], r.m[2][1]},
       z = vec3_cross(x, y);
  r.m[0][2] = z.x, r.m[1][2] = z.y, r.m[2][2] = z.z; /* right-handed */
  *moments_out = (vec3){c[1] + c[2], c[0] + c[2], c[0] + c[1]};
  *orientation = quat_from_mat3(&r);
}
