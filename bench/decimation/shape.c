/* Test bodies for the benches, the same bits everywhere:
 *
 *   bench_shape phone COUNT OUT     a rounded box of 100 x 50 x 15 mm with 0.02 mm of normal noise,
 *                                   of about COUNT triangles (762008 is met exactly)
 *   bench_shape even COUNT OUT      the same, but noise in proportion to the spacing, 0.02 mm for
 *                                   762008 triangles: as rough at every size
 *   bench_shape clean COUNT OUT     the same without noise
 *   bench_shape cube COUNT OUT      a flat cube of 50 mm, about COUNT triangles (786432 exactly)
 *   bench_shape turned COUNT OUT    the same, turned about an oblique axis
 *
 * OUT ends in .stl (binary, single precision) or .ply (binary little endian, double precision).
 * The surface is the grid of a box of cells[0] x cells[1] x cells[2], each square cut in two. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  long cells[3];
  double size[3]; /* mm */
  double radius;  /* of the rounding, mm */
  double noise;   /* standard deviation along the normal, mm */
  int even;       /* whether that is for EVEN_COUNT triangles, and in proportion to the spacing */
  int turned;
} body;

enum { EVEN_COUNT = 762008 };

typedef struct {
  double *positions;
  uint32_t *triangles;
  size_t vertex_count, triangle_count;
} surface;

static long vertex_count_of(const long *n) {
  return 2 * (n[0] + 1) * (n[1] + 1) + 2 * (n[2] - 1) * (n[0] + n[1]);
}

/* The number of a lattice point on the surface: the bottom layer, then the ring of each layer
 * between, then the top layer. */
static uint32_t number(const long *n, long i, long j, long k) {
  const long layer = (n[0] + 1) * (n[1] + 1), ring = 2 * (n[0] + n[1]);
  long along;
  if (k == 0) return (uint32_t)(j * (n[0] + 1) + i);
  if (k == n[2]) return (uint32_t)(layer + (n[2] - 1) * ring + j * (n[0] + 1) + i);
  if (j == 0)
    along = i;
  else if (i == n[0])
    along = n[0] + j;
  else if (j == n[1])
    along = n[0] + n[1] + (n[0] - i);
  else
    along = 2 * n[0] + n[1] + (n[1] - j);
  return (uint32_t)(layer + (k - 1) * ring + along);
}

static double uniform(uint64_t key) {
  key += 0x9e3779b97f4a7c15u;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return ((double)((key ^ (key >> 31)) >> 11) + 0.5) * 0x1p-53;
}

static double normal(uint64_t key) {
  return sqrt(-2 * log(uniform(2 * key))) * cos(2 * 3.14159265358979323846 * uniform(2 * key + 1));
}

static void place(const body *b, const long *ijk, uint32_t vertex, double *p) {
  double inner[3], normal_of[3], length = 0, turn[3];
  for (int a = 0; a < 3; a++) {
    const double half = b->size[a] / 2 - b->radius;
    p[a] = b->size[a] * ((double)ijk[a] / (double)b->cells[a] - 0.5);
    inner[a] = fmin(fmax(p[a], -half), half);
    normal_of[a] = p[a] - inner[a];
    length += normal_of[a] * normal_of[a];
  }
  if (b->radius > 0) {
    const double reach = (b->radius + b->noise * normal(vertex)) / sqrt(length);
    for (int a = 0; a < 3; a++) p[a] = inner[a] + reach * normal_of[a];
  }
  if (!b->turned) return;
  /* Rows of a rotation by about 50 degrees about (1, 2, 3): orthogonal to rounding. */
  static const double q[4] = {0.9, 0.1165, 0.233, 0.3495};
  const double s = 2 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const double cross[3] = {q[2] * p[2] - q[3] * p[1], q[3] * p[0] - q[1] * p[2],
                           q[1] * p[1] - q[2] * p[0]};
  turn[0] = q[2] * cross[2] - q[3] * cross[1] + q[0] * cross[0];
  turn[1] = q[3] * cross[0] - q[1] * cross[2] + q[0] * cross[1];
  turn[2] = q[1] * cross[1] - q[2] * cross[0] + q[0] * cross[2];
  for (int a = 0; a < 3; a++) p[a] += s * turn[a];
}

static void add_square(surface *s, const uint32_t *corner) {
  const uint32_t two[6] = {corner[0], corner[1], corner[2], corner[0], corner[2], corner[3]};
  memcpy(s->triangles + 3 * s->triangle_count, two, sizeof two);
  s->triangle_count += 2;
}

/* The two faces across axis: squares spanned by the other two axes, outward. */
static void add_faces(const body *b, int axis, surface *s) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int top = 0; top < 2; top++)
    for (long i = 0; i < b->cells[u]; i++)
      for (long j = 0; j < b->cells[v]; j++) {
        uint32_t corner[4];
        for (int c = 0; c < 4; c++) {
          const int turn = top ? c : 3 - c;
          long at[3];
          at[axis] = top ? b->cells[axis] : 0;
          at[u] = i + (turn == 1 || turn == 2);
          at[v] = j + (turn >= 2);
          corner[c] = number(b->cells, at[0], at[1], at[2]);
        }
        add_square(s, corner);
      }
}

static surface build(const body *b) {
  const long *n = b->cells;
  surface s = {.vertex_count = (size_t)vertex_count_of(n)};
  const size_t triangle_count = (size_t)(4 * (n[0] * n[1] + n[1] * n[2] + n[0] * n[2]));
  s.positions = malloc(3 * s.vertex_count * sizeof *s.positions);
  s.triangles = malloc(3 * triangle_count * sizeof *s.triangles);
  if (!s.positions || !s.triangles) {
    fputs("out of memory\n", stderr);
    exit(1);
  }
  for (long k = 0; k <= n[2]; k++)
    for (long j = 0; j <= n[1]; j++)
      for (long i = 0; i <= n[0];
           i += (k > 0 && k < n[2] && j > 0 && j < n[1] && i == 0) ? n[0] : 1) {
        const uint32_t v = number(n, i, j, k);
        place(b, (const long[3]){i, j, k}, v, s.positions + 3 * (size_t)v);
      }
  for (int axis = 0; axis < 3; axis++) add_faces(b, axis, &s);
  return s;
}

/* Cells so that 4 (ab + bc + ca) is count, or as near as the box's proportions allow. */
static void choose_cells(body *b, long count) {
  const double *d = b->size;
  const double h = sqrt(4 * (d[0] * d[1] + d[1] * d[2] + d[0] * d[2]) / (double)count);
  double best = 1e300;
  for (int a = 0; a < 3; a++) b->cells[a] = lround(d[a] / h);
  const long middle[2] = {b->cells[0], b->cells[1]};
  for (long x = middle[0] * 9 / 10; x <= middle[0] * 11 / 10; x++)
    for (long y = middle[1] * 9 / 10; y <= middle[1] * 11 / 10; y++) {
      const long z = (count / 4 - x * y) / (x + y);
      if (z < 2 || 4 * (x * y + (x + y) * z) != count) continue;
      const double skew = fabs((double)x * h / d[0] - 1) + fabs((double)y * h / d[1] - 1) +
                          fabs((double)z * h / d[2] - 1);
      if (skew >= best || skew > 0.35) continue;
      best = skew;
      b->cells[0] = x, b->cells[1] = y, b->cells[2] = z;
    }
}

static int write_stl(const surface *s, FILE *file) {
  char header[84] = "scree bench body";
  const uint32_t count = (uint32_t)s->triangle_count;
  memcpy(header + 80, &count, 4);
  fwrite(header, 1, 84, file);
  for (size_t t = 0; t < s->triangle_count; t++) {
    char record[50] = {0};
    for (int c = 0; c < 3; c++)
      for (int a = 0; a < 3; a++) {
        const float x =
            (float)s->positions[3 * (size_t)s->triangles[3 * t + (size_t)c] + (size_t)a];
        memcpy(record + 12 + 12 * c + 4 * a, &x, 4);
      }
    fwrite(record, 1, 50, file);
  }
  return ferror(file);
}

static int write_ply(const surface *s, FILE *file) {
  fprintf(file,
          "ply\nformat binary_little_endian 1.0\nelement vertex %zu\nproperty double x\n"
          "property double y\nproperty double z\nelement face %zu\n"
          "property list uchar int vertex_indices\nend_header\n",
          s->vertex_count, s->triangle_count);
  fwrite(s->positions, 8, 3 * s->vertex_count, file);
  for (size_t t = 0; t < s->triangle_count; t++) {
    fputc(3, file);
    fwrite(s->triangles + 3 * t, 4, 3, file);
  }
  return ferror(file);
}

int main(int argc, char **argv) {
  const struct {
    const char *name;
    body body;
  } kinds[] = {{"phone", {.size = {100, 50, 15}, .radius = 4, .noise = 0.02}},
               {"even", {.size = {100, 50, 15}, .radius = 4, .noise = 0.02, .even = 1}},
               {"clean", {.size = {100, 50, 15}, .radius = 4}},
               {"cube", {.size = {50, 50, 50}}},
               {"turned", {.size = {50, 50, 50}, .turned = 1}}};
  const size_t kind_count = sizeof kinds / sizeof *kinds;
  size_t kind = 0;
  while (argc == 4 && kind < kind_count && strcmp(argv[1], kinds[kind].name) != 0) kind++;
  if (argc != 4 || kind == kind_count) {
    fprintf(stderr, "usage: %s phone|even|clean|cube|turned COUNT OUT.stl|OUT.ply\n", argv[0]);
    return 2;
  }
  body b = kinds[kind].body;
  const long count = strtol(argv[2], NULL, 10);
  choose_cells(&b, count);
  if (b.even) b.noise *= sqrt(EVEN_COUNT / (double)count);
  surface s = build(&b);
  FILE *file = fopen(argv[3], "wb");
  if (!file) return fprintf(stderr, "%s: cannot write\n", argv[3]), 1;
  int failed = strstr(argv[3], ".stl") ? write_stl(&s, file) : write_ply(&s, file);
  failed |= fclose(file);
  printf("%s: %zu triangles, %ld x %ld x %ld cells\n", argv[3], s.triangle_count, b.cells[0],
         b.cells[1], b.cells[2]);
  free(s.positions);
  free(s.triangles);
  return failed ? 1 : 0;
}
