/* Arcs are polygons whose corners lie on them: of loops with ARC edges in a half circle, to 3e-4 of
 * the radius; of screws with TURN in a turn, to 4e-3. A hole has HOLE, around the circle. */
#include "scene/solids.h"

#include "base/alloc.h"
#include "base/math.h"
#include "world/loop.h"

#include <string.h>

enum { ARC = 60, TURN = 36, HOLE = 16 };
static const double pi = 3.14159265358979323846;

/* Room for a mesh whose counts grow as it is filled. */
static scree_status reserve(scree_mesh *mesh, size_t vertices, size_t triangles,
                            scree_error *error) {
  mesh->positions = scree_alloc(vertices, 3 * sizeof *mesh->positions);
  mesh->triangles = scree_alloc(triangles, 3 * sizeof *mesh->triangles);
  if (mesh->positions && mesh->triangles) return SCREE_OK;
  scree_mesh_free(mesh);
  return scree_fail_memory(error, 24 * vertices + 12 * triangles, "a mesh");
}

static uint32_t add_vertex(scree_mesh *mesh, vec3 at) {
  vec3_store(mesh->positions + 3 * mesh->vertex_count, at);
  return (uint32_t)mesh->vertex_count++;
}

static void add_triangle(scree_mesh *mesh, uint32_t a, uint32_t b, uint32_t c) {
  const uint32_t corners[3] = {a, b, c};
  memcpy(mesh->triangles + 3 * mesh->triangle_count++, corners, sizeof corners);
}

/* a, b, c, d around it, seen from outside against the clock. */
static void add_quad(scree_mesh *mesh, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

scree_status scree_loop_mesh(const scree_plan_loop *plan, scree_mesh *mesh, scree_error *error) {
  const scree_loop loop = {
      vec3_unit(vec3_load(plan->axis)), {0, 0, 0}, vec3_load(plan->span), plan->radius};
  const double strand = vec3_norm(loop.span), half = scree_loop_length(&loop) / 2;
  const vec3 w = vec3_cross(loop.axis, vec3_unit(loop.span)), begin = vec3_scale(w, -loop.radius),
             aside = vec3_scale(loop.axis, 0.5 * plan->width);
  const uint32_t ring = 2 * (ARC + 1);
  scree_mesh made = {0};
  SCREE_TRY(reserve(&made, 2 * ring, 2 * ring, error));
  for (uint32_t k = 0; k < ring; k++) {
    const double s = k / (ARC + 1) * half + strand + k % (ARC + 1) * (half - strand) / ARC;
    const scree_loop_place place = scree_loop_at(&loop, s);
    const vec3 at = scree_loop_carry(&loop, &place, begin);
    add_vertex(&made, vec3_sub(at, aside));
    add_vertex(&made, vec3_add(at, aside));
  }
  for (uint32_t k = 0; k < ring; k++) {
    const uint32_t a = 2 * k, b = 2 * ((k + 1) % ring);
    add_quad(&made, a, b, b + 1, a + 1);
  }
  *mesh = made;
  return SCREE_OK;
}

/* ---- screws ---- */

typedef struct spiral {
  vec3 axis, u, v; /* v = axis x u */
} spiral;

static vec3 around(const spiral *s, double radius, double angle, double along) {
  const vec3 out =
      vec3_mad(vec3_scale(s->u, radius * scree_cos(angle)), s->v, radius * scree_sin(angle));
  return vec3_mad(out, s->axis, along);
}

/* Sections of four: within, outside, and both further by the thickness. It begins within the shaft,
 * so that both are one to what touches them. */
static void add_flight(const scree_plan_screw *plan, const spiral *s, size_t sections,
                       scree_mesh *mesh) {
  const double inner = 0.9 * plan->shaft, way = plan->length - plan->thickness;
  const uint32_t first = (uint32_t)mesh->vertex_count, last = first + 4 * (uint32_t)sections;
  for (size_t k = 0; k <= sections; k++) {
    const double along = way * (double)k / (double)sections, angle = 2 * pi * along / plan->pitch;
    for (int c = 0; c < 4; c++)
      add_vertex(mesh, around(s, c % 3 ? plan->radius : inner, angle,
                              along + (c > 1 ? plan->thickness : 0)));
  }
  for (uint32_t k = 0; k < sections; k++)
    for (uint32_t c = 0; c < 4; c++) {
      const uint32_t a = first + 4 * k + c, b = first + 4 * k + (c + 1) % 4;
      if (c == 2) /* cut as the face before it: it is equally thick */
        add_quad(mesh, b, a, a + 4, b + 4);
      else
        add_quad(mesh, a, a + 4, b + 4, b);
    }
  add_quad(mesh, first, first + 1, first + 2, first + 3);
  add_quad(mesh, last + 3, last + 2, last + 1, last);
}

static void add_shaft(const scree_plan_screw *plan, const spiral *s, scree_mesh *mesh) {
  const uint32_t first = (uint32_t)mesh->vertex_count;
  add_vertex(mesh, (vec3){0, 0, 0});
  add_vertex(mesh, vec3_scale(s->axis, plan->length));
  for (int k = 0; k < 2 * TURN; k++)
    add_vertex(mesh, around(s, plan->shaft, 2 * pi * (k / 2) / TURN, k % 2 ? plan->length : 0));
  for (uint32_t k = 0; k < TURN; k++) {
    const uint32_t a = first + 2 + 2 * k, b = first + 2 + 2 * ((k + 1) % TURN);
    add_quad(mesh, a, b, b + 1, a + 1);
    add_triangle(mesh, first, b, a);
    add_triangle(mesh, first + 1, a + 1, b + 1);
  }
}

scree_status scree_screw_mesh(const scree_plan_screw *plan, scree_mesh *mesh, scree_error *error) {
  spiral s = {.axis = vec3_unit(vec3_load(plan->axis))};
  const size_t sections = 1 + (size_t)(TURN * plan->length / plan->pitch);
  scree_mesh made = {0};
  SCREE_TRY(reserve(&made, 4 * (sections + 1) + 2 + 2 * TURN, 8 * sections + 4 + 4 * TURN, error));
  vec3_frame(s.axis, &s.u, &s.v);
  add_flight(plan, &s, sections, &made);
  add_shaft(plan, &s, &made);
  *mesh = made;
  return SCREE_OK;
}

/* ---- sieves ---- */

typedef struct plate {
  const scree_plan_sieve *plan;
  size_t nx, ny; /* holes */
  scree_mesh *mesh;
} plate;

/* x and y from the middle; depth below the upper face. */
static uint32_t place_in_plate(const plate *p, double x, double y, double depth) {
  const double bend = p->plan->bend;
  if (isnan(bend)) return add_vertex(p->mesh, (vec3){x, y, -depth});
  const double angle = x / bend;
  return add_vertex(p->mesh, (vec3){(bend + depth) * scree_sin(angle), y,
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
      add_triangle(p->mesh, next, lower ? a : b, lower ? b : a);
    }
    add_triangle(p->mesh, first, lower ? next : here, lower ? here : next);
  }
}

static void add_cell(const plate *p, size_t i, size_t k) {
  const uint32_t above = add_ring(p, i, k, 0), below = add_ring(p, i, k, 1);
  add_face(p, i, k, 0, above);
  add_face(p, i, k, 1, below);
  for (uint32_t h = 0; h < HOLE; h++) {
    const uint32_t next = (h + 1) % HOLE;
    add_quad(p->mesh, above + h, above + next, below + next, below + h);
  }
}

static void add_rim(const plate *p) {
  for (size_t i = 0; i < p->nx; i++) {
    add_quad(p->mesh, corner(p, i, 0, 1), corner(p, i + 1, 0, 1), corner(p, i + 1, 0, 0),
             corner(p, i, 0, 0));
    add_quad(p->mesh, corner(p, i, p->ny, 0), corner(p, i + 1, p->ny, 0),
             corner(p, i + 1, p->ny, 1), corner(p, i, p->ny, 1));
  }
  for (size_t k = 0; k < p->ny; k++) {
    add_quad(p->mesh, corner(p, 0, k, 0), corner(p, 0, k + 1, 0), corner(p, 0, k + 1, 1),
             corner(p, 0, k, 1));
    add_quad(p->mesh, corner(p, p->nx, k, 1), corner(p, p->nx, k + 1, 1),
             corner(p, p->nx, k + 1, 0), corner(p, p->nx, k, 0));
  }
}

scree_status scree_sieve_mesh(const scree_plan_sieve *plan, scree_mesh *mesh, scree_error *error) {
  scree_mesh made = {0};
  const plate p = {plan, (size_t)(plan->size[0] / plan->pitch + 1e-9),
                   (size_t)(plan->size[1] / plan->pitch + 1e-9), &made};
  const size_t cells = p.nx * p.ny;
  SCREE_TRY(reserve(&made, 2 * (p.nx + 1) * (p.ny + 1) + 2 * HOLE * cells,
                    cells * (4 * HOLE + 8) + 4 * (p.nx + p.ny), error));
  add_corners(&p);
  for (size_t k = 0; k < p.ny; k++)
    for (size_t i = 0; i < p.nx; i++) add_cell(&p, i, k);
  add_rim(&p);
  *mesh = made;
  return SCREE_OK;
}
