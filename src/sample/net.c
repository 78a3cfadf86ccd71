/* Surface nets (Gibson 1998, "Constrained elastic surface nets") over the sparse lattice: one
 * vertex in every cell that the surface crosses, one quadrilateral around every lattice edge that
 * it crosses. The lattice is well-composed (lattice.c), so the net is a closed manifold.
 *
 * Unlike Gibson's, the net is not relaxed inside its cells only: every round moves a vertex towards
 * the mean of its neighbours in the tangent plane, and then back onto the surface by a Newton step
 * p -= d g / |g|^2 on the distance field itself. So it spreads evenly without shrinking. A vertex
 * stays within `reach` of its cell's centre, which is what keeps sheets apart where the shape is
 * finer than the lattice.
 *
 * Rounds are Jacobi iterations: each reads the positions of the round before, so that the result
 * does not depend on the order. */
#include "sample/net.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "mesh/mesh.h"
#include "sample/lattice.h"

#include <string.h>

#define NO_VERTEX UINT32_MAX

enum { BLOCKS_PER_TASK = 16, ROUNDS = 8, HOLD_PASSES = 8 };

static const double pull = 0.6;         /* of the way to the neighbours' mean, each round */
static const double probe = 1e-3;       /* steps; half the width of the gradient's differences */
static const double newton_limit = 0.5; /* steps; the longest move onto the surface */
static const double reach = 0.8;        /* steps from the cell's centre, along each axis */
static const double upright = 0.1;  /* least cosine between a triangle and its vertices' normals */
static const double flattest = 0.1; /* least height of a triangle over its longest side */
static const double longer = 1e-3;  /* a diagonal counts as shorter only by this much */

typedef struct net {
  scree_lattice lattice;
  size_t vertex_count, quad_count;
  vec3 *position, *moved, *normal;
  uint32_t (*neighbour)[6]; /* across the six faces of the cell */
  uint8_t *fallen;          /* per triangle */
  uint8_t *held;            /* per vertex: 1 where it stays at its cell's crossings */
  size_t *first_quad;       /* per block, and the total */
  scree_mesh mesh;
} net;

/* ---- Vertices ---- */

static void count_block(void *context, scree_block range) {
  net *n = context;
  float pad[SCREE_PAD_CORNERS];
  for (size_t b = range.begin; b < range.end; b++) {
    scree_lattice_block *block = &n->lattice.blocks[b];
    scree_lattice_gather(&n->lattice, block, pad);
    uint32_t vertex_count = 0;
    size_t quad_count = 0;
    for (int cell = 0; cell < SCREE_BLOCK_CELLS; cell++) {
      unsigned mask = scree_pad_mask(pad, cell), low = mask & 1;
      bool crossed = mask != 0 && mask != 255;
      block->vertex[cell] = crossed ? (int16_t)vertex_count++ : -1;
      quad_count += (mask >> 1 & 1) != low;
      quad_count += (mask >> 2 & 1) != low;
      quad_count += (mask >> 4 & 1) != low;
    }
    block->vertex_count = vertex_count;
    n->first_quad[b] = quad_count;
  }
}

/* Counts of blocks become where each begins. */
static scree_status number_blocks(net *n, double step, scree_error *error) {
  size_t vertex_count = 0, quad_count = 0;
  for (size_t b = 0; b < n->lattice.block_count; b++) {
    size_t here = n->first_quad[b];
    n->lattice.blocks[b].first_vertex = (uint32_t)vertex_count;
    n->first_quad[b] = quad_count;
    vertex_count += n->lattice.blocks[b].vertex_count;
    quad_count += here;
    if (quad_count > INT32_MAX / 2 || vertex_count > INT32_MAX)
      return scree_fail(error, SCREE_LIMIT, "a resolution of %g mm gives more than %d triangles",
                        step * 1e3, INT32_MAX);
  }
  n->first_quad[n->lattice.block_count] = quad_count;
  n->vertex_count = vertex_count;
  n->quad_count = quad_count;
  return SCREE_OK;
}

/* The mean of the points where the surface crosses the cell's edges, in steps from its low
 * corner. */
static vec3 crossing_mean(const float *pad, int cell) {
  const float *v = pad + scree_pad_index(cell);
  vec3 sum = {0, 0, 0};
  int count = 0;
  for (int axis = 0; axis < 3; axis++)
    for (int c = 0; c < 8; c++) {
      if (c >> axis & 1) continue;
      double a = v[scree_pad_offset(c)], b = v[scree_pad_offset(c | 1 << axis)];
      if ((a < 0) == (b < 0)) continue;
      double at[3] = {c & 1, c >> 1 & 1, c >> 2};
      at[axis] += a / (a - b);
      sum = vec3_add(sum, vec3_load(at));
      count++;
    }
  return vec3_scale(sum, 1.0 / count);
}

static vec3 cell_low(const scree_lattice *lattice, const scree_lattice_block *block, int cell) {
  return (vec3){lattice->origin.x + (block->at[0] + cell % 8) * lattice->step,
                lattice->origin.y + (block->at[1] + cell / 8 % 8) * lattice->step,
                lattice->origin.z + (block->at[2] + cell / 64) * lattice->step};
}

static uint32_t vertex_of(const scree_lattice *lattice, int32_t i, int32_t j, int32_t k) {
  int cell;
  const scree_lattice_block *block = scree_lattice_find(lattice, i, j, k, &cell);
  return !block || block->vertex[cell] < 0 ? NO_VERTEX
                                           : block->first_vertex + (uint32_t)block->vertex[cell];
}

/* Neighbours lie across the faces that the surface crosses. */
static void link_cell(const net *n, const scree_lattice_block *block, int cell, unsigned mask,
                      uint32_t *neighbour) {
  static const uint8_t face_mask[6] = {0x55, 0xaa, 0x33, 0xcc, 0x0f, 0xf0};
  for (int f = 0; f < 6; f++) {
    unsigned on_face = mask & face_mask[f];
    int32_t at[3] = {block->at[0] + cell % 8, block->at[1] + cell / 8 % 8,
                     block->at[2] + cell / 64};
    at[f / 2] += f & 1 ? 1 : -1;
    neighbour[f] = on_face == 0 || on_face == face_mask[f]
                       ? NO_VERTEX
                       : vertex_of(&n->lattice, at[0], at[1], at[2]);
  }
}

static void place_vertices(void *context, scree_block range) {
  net *n = context;
  float pad[SCREE_PAD_CORNERS];
  for (size_t b = range.begin; b < range.end; b++) {
    const scree_lattice_block *block = &n->lattice.blocks[b];
    if (block->vertex_count == 0) continue;
    scree_lattice_gather(&n->lattice, block, pad);
    for (int cell = 0; cell < SCREE_BLOCK_CELLS; cell++) {
      if (block->vertex[cell] < 0) continue;
      size_t v = block->first_vertex + (size_t)block->vertex[cell];
      n->position[v] =
          vec3_mad(cell_low(&n->lattice, block, cell), crossing_mean(pad, cell), n->lattice.step);
      link_cell(n, block, cell, scree_pad_mask(pad, cell), n->neighbour[v]);
    }
  }
}

/* ---- Onto the surface ---- */

/* Distance and gradient at count points from four probes each, at the corners of a tetrahedron:
 * their mean is the distance to second order, their differences the gradient. */
static void probe_field(const scree_lattice *lattice, const scree_shape_list *list,
                        const vec3 *points, size_t count, double *distance, vec3 *gradient) {
  static const double corner[4][3] = {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}};
  scree_points at;
  double d[SCREE_SHAPE_BATCH], width = probe * lattice->step;
  for (size_t begin = 0; begin < count; begin += SCREE_SHAPE_BATCH / 4) {
    size_t batch = count - begin < SCREE_SHAPE_BATCH / 4 ? count - begin : SCREE_SHAPE_BATCH / 4;
    for (size_t i = 0; i < 4 * batch; i++) {
      vec3 p = points[begin + i / 4];
      at.x[i] = p.x + corner[i & 3][0] * width;
      at.y[i] = p.y + corner[i & 3][1] * width;
      at.z[i] = p.z + corner[i & 3][2] * width;
    }
    scree_shape_distance(lattice->shape, list, &at, 4 * batch, d);
    for (size_t i = 0; i < batch; i++) {
      const double *f = d + 4 * i;
      distance[begin + i] = 0.25 * (f[0] + f[1] + f[2] + f[3]);
      gradient[begin + i] = (vec3){(f[0] - f[1] - f[2] + f[3]) / (4 * width),
                                   (f[2] + f[3] - f[0] - f[1]) / (4 * width),
                                   (f[1] + f[3] - f[0] - f[2]) / (4 * width)};
    }
  }
}

static double clamp(double x, double limit) {
  return x < -limit ? -limit : x > limit ? limit : x;
}

/* One Newton step each for the block's vertices, kept near their cells; sets their normals. */
static void settle_block(net *n, const scree_lattice_block *block, const scree_shape_list *list) {
  double distance[SCREE_BLOCK_CELLS], step = n->lattice.step;
  vec3 gradient[SCREE_BLOCK_CELLS], *position = n->position + block->first_vertex;
  probe_field(&n->lattice, list, position, block->vertex_count, distance, gradient);
  for (int cell = 0; cell < SCREE_BLOCK_CELLS; cell++) {
    if (block->vertex[cell] < 0) continue;
    size_t v = (size_t)block->vertex[cell];
    vec3 g = gradient[v];
    double g2 = vec3_norm2(g);
    double move = g2 > 1e-6 ? clamp(distance[v] / sqrt(g2), newton_limit * step) : 0;
    vec3 unit = vec3_unit(g), p = vec3_mad(position[v], unit, -move);
    vec3 centre =
        vec3_add(cell_low(&n->lattice, block, cell), (vec3){0.5 * step, 0.5 * step, 0.5 * step});
    vec3 away = vec3_sub(p, centre);
    position[v] =
        (vec3){centre.x + clamp(away.x, reach * step), centre.y + clamp(away.y, reach * step),
               centre.z + clamp(away.z, reach * step)};
    n->normal[block->first_vertex + v] = unit;
  }
}

static void settle(void *context, scree_block block) {
  net *n = context;
  scree_shape_list list;
  for (size_t b = block.begin; b < block.end; b++) {
    if (n->lattice.blocks[b].vertex_count == 0) continue;
    scree_lattice_list(&n->lattice, &n->lattice.blocks[b], &list);
    settle_block(n, &n->lattice.blocks[b], &list);
  }
}

static void relax(void *context, scree_block block) {
  net *n = context;
  for (size_t v = block.begin; v < block.end; v++) {
    vec3 sum = {0, 0, 0}, p = n->position[v], normal = n->normal[v];
    int count = 0;
    for (int f = 0; f < 6; f++) {
      if (n->neighbour[v][f] == NO_VERTEX) continue;
      sum = vec3_add(sum, n->position[n->neighbour[v][f]]);
      count++;
    }
    vec3 move = vec3_sub(vec3_scale(sum, 1.0 / count), p);
    move = vec3_mad(move, normal, -vec3_dot(move, normal));
    n->moved[v] = vec3_mad(p, move, pull);
  }
}

static bool spread(net *n, scree_ticker *ticker) {
  scree_parallel_for(n->lattice.block_count, BLOCKS_PER_TASK, settle, n);
  for (int round = 0; round < ROUNDS; round++) {
    scree_parallel_for(n->vertex_count, 4096, relax, n);
    vec3 *swap = n->position;
    n->position = n->moved;
    n->moved = swap;
    scree_parallel_for(n->lattice.block_count, BLOCKS_PER_TASK, settle, n);
    if (!scree_tick(ticker, "meshing the shape", 0.4 + 0.5 * (round + 1) / ROUNDS)) return false;
  }
  scree_parallel_for(n->lattice.block_count, BLOCKS_PER_TASK, settle, n);
  return true;
}

/* ---- Triangles ---- */

/* How well the two triangles a b c and a c d stand on their vertices' normals: the worst cosine. */
static double standing(const net *n, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  const uint32_t corner[2][3] = {{a, b, c}, {a, c, d}};
  double worst = 1;
  for (int t = 0; t < 2; t++) {
    vec3 p = n->position[corner[t][0]], q = n->position[corner[t][1]],
         r = n->position[corner[t][2]];
    vec3 face = vec3_unit(vec3_triangle_normal(p, q, r));
    for (int i = 0; i < 3; i++) {
      double cosine = vec3_dot(face, n->normal[corner[t][i]]);
      if (cosine < worst && !n->held[corner[t][i]]) worst = cosine;
    }
  }
  return worst;
}

/* Cuts a quadrilateral along the diagonal that follows the surface better; where both do, along
 * the shorter one; where they are equal (flat faces), always along the same. */
static void cut_quad(const net *n, const uint32_t quad[4], uint32_t *triangles) {
  double ac = vec3_distance(n->position[quad[0]], n->position[quad[2]]),
         bd = vec3_distance(n->position[quad[1]], n->position[quad[3]]);
  double along_ac = standing(n, quad[0], quad[1], quad[2], quad[3]),
         along_bd = standing(n, quad[1], quad[2], quad[3], quad[0]);
  bool turn = fabs(along_ac - along_bd) > 0.05 ? along_bd > along_ac : bd < ac * (1 - longer);
  for (int i = 0; i < 6; i++) {
    static const int order[6] = {0, 1, 2, 0, 2, 3};
    triangles[i] = quad[(order[i] + turn) & 3];
  }
}

static void make_quads(void *context, scree_block range) {
  net *n = context;
  float pad[SCREE_PAD_CORNERS];
  for (size_t b = range.begin; b < range.end; b++) {
    if (n->first_quad[b] == n->first_quad[b + 1]) continue;
    const scree_lattice_block *block = &n->lattice.blocks[b];
    uint32_t *triangles = n->mesh.triangles + 6 * n->first_quad[b];
    scree_lattice_gather(&n->lattice, block, pad);
    for (int cell = 0; cell < SCREE_BLOCK_CELLS; cell++) {
      unsigned mask = scree_pad_mask(pad, cell), low = mask & 1;
      for (int axis = 0; axis < 3; axis++) {
        if ((mask >> (1 << axis) & 1) == low) continue;
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        /* counter-clockwise around the edge seen from its upper end */
        static const int32_t around[4][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
        uint32_t quad[4];
        for (int q = 0; q < 4; q++) {
          int32_t at[3] = {block->at[0] + cell % 8, block->at[1] + cell / 8 % 8,
                           block->at[2] + cell / 64};
          at[u] += around[low ? q : 3 - q][0];
          at[v] += around[low ? q : 3 - q][1];
          quad[q] = vertex_of(&n->lattice, at[0], at[1], at[2]);
        }
        cut_quad(n, quad, triangles);
        triangles += 6;
      }
    }
  }
}

/* ---- Where the shape is finer than the lattice ---- */

/* There the field has no one nearest surface, and vertices that follow it may fold the net or meet.
 * Triangles that fall over or are too flat hold their vertices at the mean of their cells'
 * crossings, where Gibson puts them; after each pass the net is looked at again. At a resolution
 * that suits the shape there are none. */
static void find_fallen(void *context, scree_block block) {
  net *n = context;
  for (size_t t = block.begin; t < block.end; t++) {
    const uint32_t *corner = n->mesh.triangles + 3 * t;
    vec3 p[3], normal;
    double longest = 0, worst = 1;
    for (int i = 0; i < 3; i++) p[i] = n->position[corner[i]];
    normal = vec3_triangle_normal(p[0], p[1], p[2]);
    double size = vec3_norm(normal);
    for (int i = 0; i < 3; i++) {
      double side = vec3_norm2(vec3_sub(p[(i + 1) % 3], p[i]));
      double cosine = vec3_dot(normal, n->normal[corner[i]]);
      if (side > longest) longest = side;
      if (cosine < worst * size && !n->held[corner[i]]) worst = size > 0 ? cosine / size : 0;
    }
    n->fallen[t] = worst < upright || size < flattest * longest;
  }
}

static void hold_vertices(void *context, scree_block range) {
  net *n = context;
  float pad[SCREE_PAD_CORNERS];
  for (size_t b = range.begin; b < range.end; b++) {
    const scree_lattice_block *block = &n->lattice.blocks[b];
    if (block->vertex_count == 0 || !memchr(n->held + block->first_vertex, 1, block->vertex_count))
      continue;
    scree_lattice_gather(&n->lattice, block, pad);
    for (int cell = 0; cell < SCREE_BLOCK_CELLS; cell++) {
      size_t v = block->first_vertex + (size_t)block->vertex[cell];
      if (block->vertex[cell] >= 0 && n->held[v])
        n->position[v] =
            vec3_mad(cell_low(&n->lattice, block, cell), crossing_mean(pad, cell), n->lattice.step);
    }
  }
}

/* Makes the triangles, and again until none has fallen or all that have are held. */
static void make_triangles(net *n) {
  bool again = true;
  for (int pass = 0; again && pass <= HOLD_PASSES; pass++) {
    again = false;
    scree_parallel_for(n->lattice.block_count, BLOCKS_PER_TASK, make_quads, n);
    scree_parallel_for(n->mesh.triangle_count, 4096, find_fallen, n);
    for (size_t t = 0; t < n->mesh.triangle_count; t++) {
      const uint32_t *corner = n->mesh.triangles + 3 * t;
      if (!n->fallen[t]) continue;
      again |= !(n->held[corner[0]] && n->held[corner[1]] && n->held[corner[2]]);
      for (int i = 0; i < 3; i++) n->held[corner[i]] = 1;
    }
    if (again) scree_parallel_for(n->lattice.block_count, BLOCKS_PER_TASK, hold_vertices, n);
  }
}

/* ---- All of it ---- */

static scree_status allocate(net *n, scree_error *error) {
  SCREE_TRY_ALLOC(n->position, n->vertex_count, error);
  SCREE_TRY_ALLOC(n->moved, n->vertex_count, error);
  SCREE_TRY_ALLOC(n->normal, n->vertex_count, error);
  SCREE_TRY_ALLOC(n->neighbour, n->vertex_count, error);
  SCREE_TRY_ALLOC_ZERO(n->held, n->vertex_count, error);
  SCREE_TRY_ALLOC(n->fallen, 2 * n->quad_count, error);
  return scree_mesh_make(n->vertex_count, 2 * n->quad_count, &n->mesh, error);
}

static scree_status build(net *n, double step, scree_ticker *ticker, scree_error *error) {
  SCREE_TRY_ALLOC(n->first_quad, n->lattice.block_count + 1, error);
  scree_parallel_for(n->lattice.block_count, BLOCKS_PER_TASK, count_block, n);
  SCREE_TRY(number_blocks(n, step, error));
  SCREE_TRY(allocate(n, error));
  scree_parallel_for(n->lattice.block_count, BLOCKS_PER_TASK, place_vertices, n);
  if (!spread(n, ticker))
    return scree_fail(error, SCREE_CANCELLED, "cancelled while meshing the shape");
  make_triangles(n);
  for (size_t v = 0; v < n->vertex_count; v++)
    vec3_store(n->mesh.positions + 3 * v, n->position[v]);
  return SCREE_OK;
}

static void free_net(net *n) {
  scree_mesh_free(&n->mesh);
  scree_free(n->position);
  scree_free(n->moved);
  scree_free(n->normal);
  scree_free(n->neighbour);
  scree_free(n->held);
  scree_free(n->fallen);
  scree_free(n->first_quad);
  scree_lattice_free(&n->lattice);
}

scree_status scree_net_mesh(const scree_shape *shape, double step, scree_ticker *ticker,
                            scree_mesh *mesh, scree_error *error) {
  SCREE_CLEANUP(free_net) net n = {0};
  SCREE_TRY(scree_lattice_build(shape, step, ticker, &n.lattice, error));
  SCREE_TRY(build(&n, step, ticker, error));
  *mesh = n.mesh;
  n.mesh = (scree_mesh){0};
  return SCREE_OK;
}
