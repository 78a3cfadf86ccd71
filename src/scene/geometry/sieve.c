/* A plate with round holes in a square pattern about the geometry's origin, one solid with its
 * upper face at z = 0: as many whole pitches as its size along x and y holds; or bent about a line
 * along y above it. A hole has HOLE edges around the circle. */
#include "scene/geometry/solid.h"

#include "base/math.h"

#define SCREE_PLAN_SIEVE(ROW, T)                                                                   \
  ROW(T, VECTOR, size, SCREE_NONE, 1e-9, 1e6, "m", "along x and y, and its thickness")             \
  ROW(T, REAL, hole, NAN, 1e-9, 1e6, "m", "diameter")                                              \
  ROW(T, REAL, pitch, NAN, 1e-9, 1e6, "m", "from hole to hole, along x and y")                     \
  ROW(T, REAL, bend, NAN, 1e-9, 1e6, "m",                                                          \
      "radius of the upper face about a line along y above it; not given: flat")
SCREE_RECORD_TYPE(scree_plan_sieve, SCREE_PLAN_SIEVE)

static scree_status check_sieve(const scree_reader *r, const void *record) {
  const scree_plan_sieve *s = record;
  if (!(s->hole <= 0.95 * s->pitch))
    return scree_fail_place(r, &s->place, "hole %g m: must be below 0.95 of the pitch, %g m",
                            s->hole, 0.95 * s->pitch);
  if (s->size[0] < s->pitch || s->size[1] < s->pitch ||
      s->size[0] * s->size[1] > 1e4 * s->pitch * s->pitch)
    return scree_fail_place(r, &s->place, "has %.0f holes: 1 to 10000",
                            floor(s->size[0] / s->pitch) * floor(s->size[1] / s->pitch));
  if (given(&s->bend) && s->size[0] > 6 * s->bend)
    return scree_fail_place(r, &s->place, "bend %g m: size along x must be below 6 times that",
                            s->bend);
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_sieve, SCREE_PLAN_SIEVE, "a sieve",
                   "size: [x, y, thickness], hole and pitch", check_sieve)

enum { HOLE = 16 };
static const double pi = 3.14159265358979323846;

typedef struct plate {
  const scree_plan_sieve *plan;
  size_t nx, ny; /* holes */
  scree_mesh *mesh;
} plate;

/* x and y from the middle; depth below the upper face. */
static uint32_t place_in_plate(const plate *p, double x, double y, double depth) {
  const double bend = p->plan->bend;
  if (isnan(bend)) return scree_solid_vertex(p->mesh, (vec3){x, y, -depth});
  const double angle = x / bend;
  return scree_solid_vertex(p->mesh, (vec3){(bend + depth) * scree_sin(angle), y,
                                            bend - (bend + depth) * scree_cos(angle)});
}

/* Corners of cells: (nx + 1)(ny + 1) of the upper face, then as many of the lower one. */
static uint32_t corner(const plate *p, size_t i, size_t k, int lower) {
  return (uint32_t)((size_t)lower * (p->nx + 1) * (p->ny + 1) + k * (p->nx + 1) + i);
}

static void add_corners(const plate *p) {
  const double pitch = p->plan->pitch;
  for (int lower = 0; lower < 2; lower++)
    for (size_t k = 0; k <= p->ny; k++)
      for (size_t i = 0; i <= p->nx; i++)
        place_in_plate(p, pitch * ((double)i - 0.5 * (double)p->nx),
                       pitch * ((double)k - 0.5 * (double)p->ny), lower * p->plan->size[2]);
}

/* A hole's upper or lower edge; its first vertex. */
static uint32_t add_ring(const plate *p, size_t i, size_t k, int lower) {
  const double pitch = p->plan->pitch, r = 0.5 * p->plan->hole / scree_cos(pi / HOLE),
               x = pitch * ((double)i + 0.5 - 0.5 * (double)p->nx),
               y = pitch * ((double)k + 0.5 - 0.5 * (double)p->ny);
  const uint32_t first = (uint32_t)p->mesh->vertex_count;
  for (int h = 0; h < HOLE; h++) {
    const double angle = 2 * pi * (h - 0.125 * HOLE) / HOLE;
    place_in_plate(p, x + r * scree_cos(angle), y + r * scree_sin(angle), lower * p->plan->size[2]);
  }
  return first;
}

/* The upper or lower face of a cell around its hole, of which a quarter belongs to each corner,
 * from that at +x, -y on against the clock. */
static void add_face(const plate *p, size_t i, size_t k, int lower, uint32_t ring) {
  const size_t ci[4] = {i + 1, i + 1, i, i}, ck[4] = {k, k + 1, k + 1, k};
  for (uint32_t q = 0; q < 4; q++) {
    const uint32_t here = corner(p, ci[q], ck[q], lower), first = ring + q * HOLE / 4,
                   next = corner(p, ci[(q + 1) % 4], ck[(q + 1) % 4], lower);
    for (uint32_t h = q * HOLE / 4; h < (q + 1) * HOLE / 4; h++) {
      const uint32_t a = ring + h, b = ring + (h + 1) % HOLE;
      scree_solid_triangle(p->mesh, next, lower ? a : b, lower ? b : a);
    }
    scree_solid_triangle(p->mesh, first, lower ? next : here, lower ? here : next);
  }
}

static void add_cell(const plate *p, size_t i, size_t k) {
  const uint32_t above = add_ring(p, i, k, 0), below = add_ring(p, i, k, 1);
  add_face(p, i, k, 0, above);
  add_face(p, i, k, 1, below);
  for (uint32_t h = 0; h < HOLE; h++) {
    const uint32_t next = (h + 1) % HOLE;
    scree_solid_quad(p->mesh, above + h, above + next, below + next, below + h);
  }
}

static void add_rim(const plate *p) {
  for (size_t i = 0; i < p->nx; i++) {
    scree_solid_quad(p->mesh, corner(p, i, 0, 1), corner(p, i + 1, 0, 1), corner(p, i + 1, 0, 0),
                     corner(p, i, 0, 0));
    scree_solid_quad(p->mesh, corner(p, i, p->ny, 0), corner(p, i + 1, p->ny, 0),
                     corner(p, i + 1, p->ny, 1), corner(p, i, p->ny, 1));
  }
  for (size_t k = 0; k < p->ny; k++) {
    scree_solid_quad(p->mesh, corner(p, 0, k, 0), corner(p, 0, k + 1, 0), corner(p, 0, k + 1, 1),
                     corner(p, 0, k, 1));
    scree_solid_quad(p->mesh, corner(p, p->nx, k, 1), corner(p, p->nx, k + 1, 1),
                     corner(p, p->nx, k + 1, 0), corner(p, p->nx, k, 0));
  }
}

static scree_status make_mesh(const scree_plan_geometry *g, scree_mesh *mesh, scree_error *error) {
  const scree_plan_sieve *plan = g->sieve;
  scree_mesh made = {0};
  const plate p = {plan, (size_t)(plan->size[0] / plan->pitch + 1e-9),
                   (size_t)(plan->size[1] / plan->pitch + 1e-9), &made};
  const size_t cells = p.nx * p.ny;
  SCREE_TRY(scree_solid_reserve(&made, 2 * (p.nx + 1) * (p.ny + 1) + 2 * HOLE * cells,
                                cells * (4 * HOLE + 8) + 4 * (p.nx + p.ny), error));
  add_corners(&p);
  for (size_t k = 0; k < p.ny; k++)
    for (size_t i = 0; i < p.nx; i++) add_cell(&p, i, k);
  add_rim(&p);
  *mesh = made;
  return SCREE_OK;
}

const scree_geometry_kind scree_geometry_sieve = {.mesh = make_mesh};
