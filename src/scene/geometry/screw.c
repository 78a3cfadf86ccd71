/* Two solids: a flight of a helix about an axis, from the geometry's origin on, which begins and
 * ends square to it, and its shaft. Arcs have TURN edges in a turn: to 4e-3 of the radius. */
#include "scene/geometry/solid.h"

#include "base/math.h"

#define SCREE_PLAN_SCREW(ROW, T)                                                                   \
  ROW(T, DIRECTION, axis, (1, 0, 0), "from `at` on; the flight is right-handed")                   \
  ROW(T, REAL, radius, NAN, 1e-9, 1e6, "m", "of the flight")                                       \
  ROW(T, REAL, shaft, NAN, 1e-9, 1e6, "m", "radius of the shaft")                                  \
  ROW(T, REAL, pitch, NAN, 1e-9, 1e6, "m", "")                                                     \
  ROW(T, REAL, length, NAN, 1e-9, 1e6, "m", "")                                                    \
  ROW(T, REAL, thickness, NAN, 1e-9, 1e6, "m", "of the flight, along the axis")
SCREE_RECORD_TYPE(scree_plan_screw, SCREE_PLAN_SCREW)

static scree_status check_screw(const scree_reader *r, const void *record) {
  const scree_plan_screw *s = record;
  if (!(s->shaft < s->radius))
    return scree_fail_place(r, &s->place, "shaft %g m: must be below the radius %g m", s->shaft,
                            s->radius);
  if (!(s->thickness < s->pitch && s->thickness < s->length))
    return scree_fail_place(r, &s->place, "thickness %g m: must be below the pitch and the length",
                            s->thickness);
  if (s->length > 100 * s->pitch)
    return scree_fail_place(r, &s->place, "length %g m: at most 100 times the pitch", s->length);
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_screw, SCREE_PLAN_SCREW, "a screw",
                   "radius, shaft, pitch, length and thickness", check_screw)

enum { TURN = 36 };
static const double pi = 3.14159265358979323846;

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
      scree_solid_vertex(mesh, around(s, c % 3 ? plan->radius : inner, angle,
                                      along + (c > 1 ? plan->thickness : 0)));
  }
  for (uint32_t k = 0; k < sections; k++)
    for (uint32_t c = 0; c < 4; c++) {
      const uint32_t a = first + 4 * k + c, b = first + 4 * k + (c + 1) % 4;
      if (c == 2) /* cut as the face before it: it is equally thick */
        scree_solid_quad(mesh, b, a, a + 4, b + 4);
      else
        scree_solid_quad(mesh, a, a + 4, b + 4, b);
    }
  scree_solid_quad(mesh, first, first + 1, first + 2, first + 3);
  scree_solid_quad(mesh, last + 3, last + 2, last + 1, last);
}

static void add_shaft(const scree_plan_screw *plan, const spiral *s, scree_mesh *mesh) {
  const uint32_t first = (uint32_t)mesh->vertex_count;
  scree_solid_vertex(mesh, (vec3){0, 0, 0});
  scree_solid_vertex(mesh, vec3_scale(s->axis, plan->length));
  for (int k = 0; k < 2 * TURN; k++)
    scree_solid_vertex(mesh,
                       around(s, plan->shaft, 2 * pi * (k / 2) / TURN, k % 2 ? plan->length : 0));
  for (uint32_t k = 0; k < TURN; k++) {
    const uint32_t a = first + 2 + 2 * k, b = first + 2 + 2 * ((k + 1) % TURN);
    scree_solid_quad(mesh, a, b, b + 1, a + 1);
    scree_solid_triangle(mesh, first, b, a);
    scree_solid_triangle(mesh, first + 1, a + 1, b + 1);
  }
}

static scree_status make_mesh(const scree_plan_geometry *g, scree_mesh *mesh, scree_error *error) {
  const scree_plan_screw *plan = g->screw;
  spiral s = {.axis = vec3_unit(vec3_load(plan->axis))};
  const size_t sections = 1 + (size_t)(TURN * plan->length / plan->pitch);
  scree_mesh made = {0};
  SCREE_TRY(scree_solid_reserve(&made, 4 * (sections + 1) + 2 + 2 * TURN,
                                8 * sections + 4 + 4 * TURN, error));
  vec3_frame(s.axis, &s.u, &s.v);
  add_flight(plan, &s, sections, &made);
  add_shaft(plan, &s, &made);
  *mesh = made;
  return SCREE_OK;
}

const scree_geometry_kind scree_geometry_screw = {.mesh = make_mesh};
