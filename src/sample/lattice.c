/* The lattice is cut into blocks. A block whose centre is farther from the surface than its own
 * half diagonal and a margin holds none of it (the field is a lower bound of the distance) and is
 * only remembered as inside or outside. The others are sampled with the solids that matter there.
 *
 * Then the sampling is made well-composed (Latecki 1997, "3D well-composed pictures"): corners are
 * moved from outside to inside until no face shows its inside corners on a diagonal and no cell
 * shows only two opposite corners of one kind. Every cell then holds one sheet, and the net with
 * one vertex per cell is a manifold. Corners only ever become inside, so this ends; it touches
 * places where the shape is thinner or narrower than the lattice resolves, and nothing else. */
#include "sample/lattice.h"

#include "base/alloc.h"
#include "base/parallel.h"

#define BLOCK_LIMIT ((size_t)1 << 26) /* blocks of the whole lattice: 256 MiB of slots */

enum { SITES_PER_TASK = SCREE_SHAPE_BATCH, BLOCKS_PER_TASK = 16 };

/* Half the diagonal of a block with its 9^3 corners, and how far beyond it a block still counts as
 * near the surface; both in steps. The margin exceeds a cell's diagonal, so that corners outside
 * the sampled blocks never have a crossing. */
static const double half_diagonal = 6.928203230275509, margin = 2;

static vec3 corner_position(const scree_lattice *lattice, double i, double j, double k) {
  return (vec3){lattice->origin.x + i * lattice->step, lattice->origin.y + j * lattice->step,
                lattice->origin.z + k * lattice->step};
}

/* ---- Which blocks ---- */

static void classify(void *context, scree_block block) {
  scree_lattice *lattice = context;
  scree_shape_list list;
  scree_points centres;
  double d[SCREE_SHAPE_BATCH];
  scree_shape_list_all(lattice->shape, &list);
  for (size_t s = block.begin; s < block.end; s++) {
    size_t nx = (size_t)lattice->size[0], ny = (size_t)lattice->size[1];
    vec3 c = corner_position(lattice, 8.0 * (double)(s % nx) + 4, 8.0 * (double)(s / nx % ny) + 4,
                             8.0 * (double)(s / nx / ny) + 4);
    centres.x[s - block.begin] = c.x;
    centres.y[s - block.begin] = c.y;
    centres.z[s - block.begin] = c.z;
  }
  scree_shape_distance(lattice->shape, &list, &centres, block.end - block.begin, d);
  double reach = (half_diagonal + margin) * lattice->step;
  for (size_t s = block.begin; s < block.end; s++)
    lattice->slots[s] = d[s - block.begin] > reach    ? SCREE_SLOT_OUTSIDE
                        : d[s - block.begin] < -reach ? SCREE_SLOT_INSIDE
                                                      : 0;
}

static scree_status make_blocks(scree_lattice *lattice, scree_error *error) {
  size_t nx = (size_t)lattice->size[0], ny = (size_t)lattice->size[1],
         site_count = nx * ny * (size_t)lattice->size[2];
  lattice->slots = scree_alloc(site_count, sizeof *lattice->slots);
  if (!lattice->slots)
    return scree_fail_memory(error, site_count * sizeof *lattice->slots, "the lattice");
  scree_parallel_for(site_count, SITES_PER_TASK, classify, lattice);
  for (size_t s = 0; s < site_count; s++)
    if (lattice->slots[s] == 0) lattice->slots[s] = (int32_t)lattice->block_count++;
  lattice->blocks = scree_alloc(lattice->block_count, sizeof *lattice->blocks);
  if (!lattice->blocks)
    return scree_fail_memory(error, lattice->block_count * sizeof *lattice->blocks,
                             "the lattice's blocks");
  for (size_t s = 0; s < site_count; s++) {
    if (lattice->slots[s] < 0) continue;
    scree_lattice_block *b = &lattice->blocks[lattice->slots[s]];
    b->at[0] = (int32_t)(8 * (s % nx));
    b->at[1] = (int32_t)(8 * (s / nx % ny));
    b->at[2] = (int32_t)(8 * (s / nx / ny));
  }
  return SCREE_OK;
}

void scree_lattice_list(const scree_lattice *lattice, const scree_lattice_block *block,
                        scree_shape_list *list) {
  vec3 centre = corner_position(lattice, block->at[0] + 4, block->at[1] + 4, block->at[2] + 4);
  scree_shape_prune(lattice->shape, centre, half_diagonal * lattice->step, margin * lattice->step,
                    list);
}

static void sample_blocks(void *context, scree_block range) {
  scree_lattice *lattice = context;
  scree_shape_list list;
  scree_points points;
  double d[SCREE_BLOCK_CELLS];
  for (size_t b = range.begin; b < range.end; b++) {
    scree_lattice_block *block = &lattice->blocks[b];
    scree_lattice_list(lattice, block, &list);
    for (int c = 0; c < SCREE_BLOCK_CELLS; c++) {
      vec3 p = corner_position(lattice, block->at[0] + c % 8, block->at[1] + c / 8 % 8,
                               block->at[2] + c / 64);
      points.x[c] = p.x;
      points.y[c] = p.y;
      points.z[c] = p.z;
    }
    scree_shape_distance(lattice->shape, &list, &points, SCREE_BLOCK_CELLS, d);
    for (int c = 0; c < SCREE_BLOCK_CELLS; c++) block->value[c] = (float)(d[c] / lattice->step);
  }
}

/* ---- Looking up ---- */

static int32_t slot_at(const scree_lattice *lattice, int32_t i, int32_t j, int32_t k) {
  if (i < 0 || j < 0 || k < 0) return SCREE_SLOT_OUTSIDE;
  i >>= 3, j >>= 3, k >>= 3;
  if (i >= lattice->size[0] || j >= lattice->size[1] || k >= lattice->size[2])
    return SCREE_SLOT_OUTSIDE;
  return lattice
      ->slots[i + (size_t)lattice->size[0] * ((size_t)j + (size_t)lattice->size[1] * (size_t)k)];
}

scree_lattice_block *scree_lattice_find(const scree_lattice *lattice, int32_t i, int32_t j,
                                        int32_t k, int *corner) {
  int32_t slot = slot_at(lattice, i, j, k);
  *corner = (i & 7) + 8 * ((j & 7) + 8 * (k & 7));
  return slot < 0 ? NULL : &lattice->blocks[slot];
}

void scree_lattice_gather(const scree_lattice *lattice, const scree_lattice_block *block,
                          float *pad) {
  for (int n = 0; n < 8; n++) { /* the block and its seven neighbours above */
    int x0 = n & 1, y0 = n >> 1 & 1, z0 = n >> 2;
    int32_t slot =
        slot_at(lattice, block->at[0] + 8 * x0, block->at[1] + 8 * y0, block->at[2] + 8 * z0);
    const float *value = slot < 0 ? NULL : lattice->blocks[slot].value;
    float constant = slot == SCREE_SLOT_INSIDE ? -8.0f : 8.0f;
    int nx = x0 ? 1 : 8, ny = y0 ? 1 : 8, nz = z0 ? 1 : 8;
    for (int z = 0; z < nz; z++)
      for (int y = 0; y < ny; y++)
        for (int x = 0; x < nx; x++)
          pad[8 * x0 + x + SCREE_PAD * (8 * y0 + y + SCREE_PAD * (8 * z0 + z))] =
              value ? value[x + 8 * (y + 8 * z)] : constant;
  }
}

void scree_lattice_free(scree_lattice *lattice) {
  scree_free(lattice->slots);
  scree_free(lattice->blocks);
  *lattice = (scree_lattice){0};
}

/* ---- Well-composed ---- */

static const uint8_t faces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                    {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};

/* The outside corners of which one must become inside, as bits; 0 for a cell with one sheet. */
static unsigned critical_corners(unsigned mask) {
  for (int f = 0; f < 6; f++) {
    unsigned a = 1u << faces[f][0] | 1u << faces[f][2], b = 1u << faces[f][1] | 1u << faces[f][3];
    if ((mask & a) == a && !(mask & b)) return b;
    if ((mask & b) == b && !(mask & a)) return a;
  }
  for (int c = 0; c < 4; c++) {
    unsigned opposite = 1u << c | 1u << (7 - c);
    if (mask == opposite || mask == (~opposite & 255u)) return ~mask & 255u;
  }
  return 0;
}

typedef struct composing {
  scree_lattice *lattice;
  const uint8_t *critical; /* per mask */
  uint8_t *flagged;        /* per block */
} composing;

static void flag_blocks(void *context, scree_block block) {
  composing *c = context;
  float pad[SCREE_PAD_CORNERS];
  for (size_t b = block.begin; b < block.end; b++) {
    scree_lattice_gather(c->lattice, &c->lattice->blocks[b], pad);
    c->flagged[b] = 0;
    for (int cell = 0; cell < SCREE_BLOCK_CELLS; cell++)
      c->flagged[b] |= c->critical[scree_pad_mask(pad, cell)] != 0;
  }
}

/* Makes the outside corner of `candidates` that is nearest to the surface inside. False where it
 * lies outside the sampled blocks: then the shape is far too fine for the lattice. */
static bool fill_corner(scree_lattice *lattice, const scree_lattice_block *block, int cell,
                        const float *pad, unsigned candidates) {
  const float *v = pad + scree_pad_index(cell);
  int best = -1;
  for (int c = 0; c < 8; c++)
    if (candidates >> c & 1 && (best < 0 || v[scree_pad_offset(c)] < v[scree_pad_offset(best)]))
      best = c;
  int corner;
  scree_lattice_block *owner = scree_lattice_find(lattice, block->at[0] + cell % 8 + (best & 1),
                                                  block->at[1] + cell / 8 % 8 + (best >> 1 & 1),
                                                  block->at[2] + cell / 64 + (best >> 2), &corner);
  if (!owner) return false;
  owner->value[corner] = -0.25f;
  return true;
}

static bool compose_block(scree_lattice *lattice, const uint8_t *critical,
                          scree_lattice_block *block) {
  float pad[SCREE_PAD_CORNERS];
  scree_lattice_gather(lattice, block, pad);
  for (int cell = 0; cell < SCREE_BLOCK_CELLS;) {
    unsigned candidates = critical[scree_pad_mask(pad, cell)];
    if (!candidates) {
      cell++;
      continue;
    }
    if (!fill_corner(lattice, block, cell, pad, candidates)) return false;
    scree_lattice_gather(lattice, block, pad);
  }
  return true;
}

static scree_status compose(scree_lattice *lattice, scree_error *error) {
  uint8_t critical[256];
  for (unsigned mask = 0; mask < 256; mask++) critical[mask] = (uint8_t)critical_corners(mask);
  SCREE_SCRATCH(uint8_t, flagged, lattice->block_count, error);
  composing context = {lattice, critical, flagged};
  for (bool again = true; again;) {
    again = false;
    scree_parallel_for(lattice->block_count, BLOCKS_PER_TASK, flag_blocks, &context);
    for (size_t b = 0; b < lattice->block_count; b++) {
      if (!flagged[b]) continue;
      again = true;
      if (!compose_block(lattice, critical, &lattice->blocks[b]))
        return scree_fail(error, SCREE_LIMIT,
                          "a resolution of %g mm is too coarse for this sample's details",
                          lattice->step * 1e3);
    }
  }
  return SCREE_OK;
}

/* ---- All of it ---- */

static scree_status place(const scree_shape *shape, double step, scree_lattice *lattice,
                          scree_error *error) {
  vec3 extent = vec3_sub(shape->high, shape->low);
  const double lengths[3] = {extent.x, extent.y, extent.z};
  double total = 1;
  for (int a = 0; a < 3; a++) {
    /* two steps of air on every side, at least */
    double blocks = ceil((lengths[a] / step + 5) / SCREE_BLOCK);
    total *= blocks;
    if (!(total < (double)BLOCK_LIMIT))
      return scree_fail(error, SCREE_LIMIT,
                        "a resolution of %g mm needs more than %zu blocks of the sample's lattice",
                        step * 1e3, BLOCK_LIMIT);
    lattice->size[a] = (int32_t)blocks;
  }
  /* Faces of a drawing lie at round coordinates; an odd fraction keeps the lattice off them. */
  const double gap = 2.381966;
  lattice->shape = shape;
  lattice->step = step;
  lattice->origin = vec3_sub(shape->low, (vec3){gap * step, gap * step, gap * step});
  return SCREE_OK;
}

scree_status scree_lattice_build(const scree_shape *shape, double step, scree_ticker *ticker,
                                 scree_lattice *lattice, scree_error *error) {
  SCREE_CLEANUP(scree_lattice_free) scree_lattice made = {0};
  SCREE_TRY(place(shape, step, &made, error));
  SCREE_TRY(make_blocks(&made, error));
  scree_parallel_for(made.block_count, BLOCKS_PER_TASK, sample_blocks, &made);
  SCREE_TRY(compose(&made, error));
  if (!scree_tick(ticker, "sampling the shape", 0.4))
    return scree_fail(error, SCREE_CANCELLED, "cancelled while sampling the shape");
  *lattice = made;
  made = (scree_lattice){0};
  return SCREE_OK;
}
