/* The fields of sensors. */
#include "scene/plan_fields.h"

#define RECORD scree_plan_flow
static const scree_field flow_fields[] = {
    VECTOR(through, -1e6, 1e6, "m", "a point of the plane"),
    VECTOR(normal, 0, 0, "", "along it counts up, against it down"),
    REAL(radius, 0, 1e6, "m", "about the point; not given: all of it"),
};
#undef RECORD
static scree_status check_flow(const scree_reader *r, const void *record) {
  const scree_plan_flow *f = record;
  if (!given(f->through)) return scree_fail_place(r, &f->place, "needs through: [x, y, z]");
  return scree_plan_check_direction(r, &f->place, "normal", f->normal);
}
static const scree_plan_flow flow_defaults = {{0}, NONE, {0, 0, 1}, NAN};
static const scree_record flow_record =
    SCREE_RECORD("a flow", flow_fields, flow_defaults, check_flow);

static const scree_field region_fields[] = {
    {"box", SCREE_FIELD_RECORD, offsetof(scree_plan_region, box), 0, 0, "", "",
     &scree_plan_box_record},
};
static scree_status check_region(const scree_reader *r, const void *record) {
  const scree_plan_region *g = record;
  return g->box ? SCREE_OK : scree_fail_place(r, &g->place, "needs a box: {min: ..., max: ...}");
}
static const scree_plan_region region_defaults = {{0}, NULL};
static const scree_record region_record =
    SCREE_RECORD("a region", region_fields, region_defaults, check_region);

#define RECORD scree_plan_pile
static const scree_field pile_fields[] = {
    REAL(floor, -1e6, 1e6, "m", "height of what the pile stands on"),
    REAL(cell, 0, 1e3, "m", "of the height field; 0: a tenth of the size"),
    REAL(disc, 1e-9, 1e6, "m",
         "radius about the origin; bodies beyond are not of the pile; not given: all are"),
    REAL(reach, 1e-9, 1e6, "m",
         "of the height field with a disc; not given: one and a half of the longest shape beyond "
         "it"),
    REAL(size, 1e-9, 1e3, "m",
         "of a body; not given: the mean of what layers pour, else of those there"),
    COUNT(sectors, 1, 3600, "in azimuth"),
    REAL(band_low, 0, 1, "", "of the height: the flank begins"),
    REAL(band_high, 0, 1, "", "and ends"),
    REAL(every, 0, 1e9, "s",
         "between lines of the series that have it; 0: only the last; not given: all"),
    TEXTS(during, "phases; not given: all"),
};
#undef RECORD
static scree_status check_pile(const scree_reader *r, const void *record) {
  const scree_plan_pile *p = record;
  if (p->band_low < p->band_high) return SCREE_OK;
  return scree_fail_place(r, &p->place, "band_low %g must be below band_high %g", p->band_low,
                          p->band_high);
}
static const scree_plan_pile pile_defaults = {.disc = NAN,
                                              .reach = NAN,
                                              .size = NAN,
                                              .every = NAN,
                                              .band_low = 0.2,
                                              .band_high = 0.8,
                                              .sectors = 36};
static const scree_record pile_record =
    SCREE_RECORD("a pile", pile_fields, pile_defaults, check_pile);

static const scree_field slope_fields[] = {
    {"axis", SCREE_FIELD_VECTOR, offsetof(scree_plan_slope, axis), 0, 0, "",
     "the surface is seen along it", NULL},
    {"box", SCREE_FIELD_RECORD, offsetof(scree_plan_slope, box), 0, 0, "",
     "of the bodies in it; not given: about the middle of all", &scree_plan_box_record},
};
static scree_status check_slope(const scree_reader *r, const void *record) {
  const scree_plan_slope *s = record;
  return scree_plan_check_direction(r, &s->place, "axis", s->axis);
}
static const scree_plan_slope slope_defaults = {{0}, {1, 0, 0}, NULL};
static const scree_record slope_record =
    SCREE_RECORD("a slope", slope_fields, slope_defaults, check_slope);

static const scree_field segregation_fields[] = {
    {"cells", SCREE_FIELD_REAL, offsetof(scree_plan_segregation, cells), 1e-9, 1e6, "m",
     "side of the cells that are compared", NULL},
    {"by", SCREE_FIELD_WORD, offsetof(scree_plan_segregation, by), 0, 0, "size|shape|material",
     "classes: of a shape's sizes each, all of a shape, all of a material", NULL},
};
static scree_status check_segregation(const scree_reader *r, const void *record) {
  const scree_plan_segregation *s = record;
  return given(&s->cells) ? SCREE_OK : scree_fail_place(r, &s->place, "needs cells: their side");
}
static const scree_plan_segregation segregation_defaults = {{0}, NAN, 0};
static const scree_record segregation_record =
    SCREE_RECORD("segregation", segregation_fields, segregation_defaults, check_segregation);

#define RECORD scree_plan_residence
static const scree_field residence_fields[] = {
    WORD(by, "size|shape|material",
         "classes: of a shape's sizes each, all of a shape, all of a material"),
    TEXT(inlet, "of those that came by it; not given: all"),
    TEXT(outlet, "of those that left by it; not given: all"),
    COUNT(bins, 1, 10000, "of the histogram"),
};
#undef RECORD
static const scree_plan_residence residence_defaults = {.bins = 20};
static const scree_record residence_record =
    SCREE_RECORD("residence", residence_fields, residence_defaults, NULL);

#define RECORD scree_plan_impacts
static const scree_field impacts_fields[] = {
    WORD(by, "shape|material", "classes of bodies; geometry by name"),
    REAL(least, 1e-18, 1e12, "J", "where the spectra begin"),
    REAL(most, 1e-18, 1e12, "J", "and end"),
    COUNT(bins, 1, 100, "in a decade of energy"),
    REAL(threshold, 0, 1e12, "J", "damage is what the energy of approach exceeds it by"),
    REAL(window, 1e-9, 1e9, "s", "a spectrum for each; not given: one of all"),
};
#undef RECORD
static scree_status check_impacts(const scree_reader *r, const void *record) {
  const scree_plan_impacts *p = record;
  if (p->least < p->most) return SCREE_OK;
  return scree_fail_place(r, &p->place, "least %g J must be below most %g J", p->least, p->most);
}
static const scree_plan_impacts impacts_defaults = {
    .least = 1e-9, .most = 1e3, .bins = 5, .window = NAN};
static const scree_record impacts_record =
    SCREE_RECORD("impacts", impacts_fields, impacts_defaults, check_impacts);

#define RECORD scree_plan_grid
static const scree_field grid_fields[] = {
    GROUP(box, "", &scree_plan_box_record),
    GROUP(cylinder, "instead of a box", &scree_plan_cylinder_record),
    VECTOR(cells, 1, 1000, "", "along x, y and z; of a cylinder outward, around and along"),
    REAL(width, 1e-9, 1e3, "m", "of coarse graining; not given: the largest body's size"),
    REAL(every, 1e-9, 1e9, "s", "between samples; not given: as the series"),
    TEXT(with, "a geometry: the grid is in its frame and moves with it"),
};
#undef RECORD
static scree_status check_grid(const scree_reader *r, const void *record) {
  const scree_plan_grid *p = record;
  const bool there[] = {p->box != NULL, p->cylinder != NULL};
  SCREE_TRY(scree_plan_one_of(r, &p->place, there, 2, "box, cylinder"));
  if (!given(p->cells)) return scree_fail_place(r, &p->place, "needs cells: [10, 10, 10]");
  for (int k = 0; k < 3; k++)
    if (p->cells[k] != floor(p->cells[k]))
      return scree_fail_place(r, &p->place, "cells %g: must be whole numbers", p->cells[k]);
  if (p->cells[0] * p->cells[1] * p->cells[2] > 1e6)
    return scree_fail_place(r, &p->place, "%g cells: at most 1e6",
                            p->cells[0] * p->cells[1] * p->cells[2]);
  if (p->cylinder && (!given(p->cylinder->at) || !(p->cylinder->length > 0)))
    return scree_fail_place(r, &p->cylinder->place, "needs at: [x, y, z] and a length above 0");
  return SCREE_OK;
}
static const scree_plan_grid grid_defaults = {.cells = NONE, .width = NAN, .every = NAN};
static const scree_record grid_record =
    SCREE_RECORD("a grid", grid_fields, grid_defaults, check_grid);

#define RECORD scree_plan_sensor
static const scree_field sensor_fields[] = {
    GROUP(flow, "count and mass through a plane, by shape", &flow_record),
    GROUP(region, "what is in a box", &region_record),
    TEXT(wall, "force, torque, power and wear of a geometry"),
    TEXT(position, "where a geometry is"),
    TEXT(part, "of a geometry that forces move"),
    GROUP(pile, "angle of repose three ways", &pile_record),
    GROUP(slope, "angle of the surface", &slope_record),
    GROUP(segregation, "Lacey's index by shape", &segregation_record),
    GROUP(residence, "time from inlet to outlet", &residence_record),
    GROUP(grid, "fields of means over time, for ParaView", &grid_record),
    GROUP(impacts, "energies of contacts, by class", &impacts_record),
    REAL(from, 0, 1e9, "s", "what comes before is neither gathered nor in means"),
    REAL(until, 1e-9, 1e9, "s", "nor what comes after; not given: all"),
};
#undef RECORD
static scree_status check_sensor(const scree_reader *r, const void *record) {
  const scree_plan_sensor *s = record;
  const bool there[] = {s->flow != NULL,      s->region != NULL,   s->wall != NULL,
                        s->pile != NULL,      s->slope != NULL,    s->segregation != NULL,
                        s->residence != NULL, s->position != NULL, s->impacts != NULL,
                        s->part != NULL,      s->grid != NULL};
  SCREE_TRY(scree_plan_one_of(
      r, &s->place, there, sizeof there / sizeof *there,
      "flow, region, wall, position, part, pile, slope, segregation, residence, impacts, grid"));
  return scree_plan_check_window(r, &s->place, s->from, s->until);
}
static const scree_plan_sensor sensor_defaults = {.until = NAN};
const scree_record scree_plan_sensor_record =
    SCREE_RECORD("a sensor", sensor_fields, sensor_defaults, check_sensor);
