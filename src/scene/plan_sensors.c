/* The fields of sensors. */
#include "scene/plan_fields.h"

#define AT(member) offsetof(scree_plan_flow, member)
static const scree_field flow_fields[] = {
    {"through", SCREE_FIELD_VECTOR, AT(through), -1e6, 1e6, "m", "a point of the plane", NULL},
    {"normal", SCREE_FIELD_VECTOR, AT(normal), 0, 0, "", "along it counts up, against it down",
     NULL},
    {"radius", SCREE_FIELD_REAL, AT(radius), 0, 1e6, "m", "about the point; not given: all of it",
     NULL},
};
#undef AT
static scree_status check_flow(const scree_reader *r, const void *record) {
  const scree_plan_flow *f = record;
  if (!given(f->through)) return scree_fail_place(r, &f->place, "needs through: [x, y, z]");
  return scree_plan_check_direction(r, &f->place, "normal", f->normal);
}
static const scree_plan_flow flow_defaults = {{0}, NONE, {0, 0, 1}, NAN};
static const scree_record flow_record = {"a flow", FIELDS(flow_fields), sizeof(scree_plan_flow),
                                         &flow_defaults, check_flow};

static const scree_field region_fields[] = {
    {"box", SCREE_FIELD_RECORD, offsetof(scree_plan_region, box), 0, 0, "", "",
     &scree_plan_box_record},
};
static scree_status check_region(const scree_reader *r, const void *record) {
  const scree_plan_region *g = record;
  return g->box ? SCREE_OK : scree_fail_place(r, &g->place, "needs a box: {min: ..., max: ...}");
}
static const scree_plan_region region_defaults = {{0}, NULL};
static const scree_record region_record = {
    "a region", FIELDS(region_fields), sizeof(scree_plan_region), &region_defaults, check_region};

#define AT(member) offsetof(scree_plan_pile, member)
static const scree_field pile_fields[] = {
    {"floor", SCREE_FIELD_REAL, AT(floor), -1e6, 1e6, "m", "height of what the pile stands on",
     NULL},
    {"cell", SCREE_FIELD_REAL, AT(cell), 0, 1e3, "m", "of the height field; 0: a tenth of the size",
     NULL},
    {"disc", SCREE_FIELD_REAL, AT(disc), 1e-9, 1e6, "m",
     "radius about the origin; bodies beyond are not of the pile; not given: all are", NULL},
    {"reach", SCREE_FIELD_REAL, AT(reach), 1e-9, 1e6, "m",
     "of the height field with a disc; not given: one and a half of the longest shape beyond it",
     NULL},
    {"size", SCREE_FIELD_REAL, AT(size), 1e-9, 1e3, "m",
     "of a body; not given: the mean of what layers pour, else of those there", NULL},
    {"sectors", SCREE_FIELD_COUNT, AT(sectors), 1, 3600, "", "in azimuth", NULL},
    {"band_low", SCREE_FIELD_REAL, AT(band_low), 0, 1, "", "of the height: the flank begins", NULL},
    {"band_high", SCREE_FIELD_REAL, AT(band_high), 0, 1, "", "and ends", NULL},
    {"every", SCREE_FIELD_REAL, AT(every), 0, 1e9, "s",
     "between lines of the series that have it; 0: only the last; not given: all", NULL},
    {"during", SCREE_FIELD_TEXTS, AT(during), 0, 0, "", "phases; not given: all", NULL},
};
#undef AT
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
static const scree_record pile_record = {"a pile", FIELDS(pile_fields), sizeof(scree_plan_pile),
                                         &pile_defaults, check_pile};

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
static const scree_record slope_record = {"a slope", FIELDS(slope_fields), sizeof(scree_plan_slope),
                                          &slope_defaults, check_slope};

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
static const scree_record segregation_record = {"segregation", FIELDS(segregation_fields),
                                                sizeof(scree_plan_segregation),
                                                &segregation_defaults, check_segregation};

#define AT(member) offsetof(scree_plan_residence, member)
static const scree_field residence_fields[] = {
    {"by", SCREE_FIELD_WORD, AT(by), 0, 0, "size|shape|material",
     "classes: of a shape's sizes each, all of a shape, all of a material", NULL},
    {"inlet", SCREE_FIELD_TEXT, AT(inlet), 0, 0, "", "of those that came by it; not given: all",
     NULL},
    {"outlet", SCREE_FIELD_TEXT, AT(outlet), 0, 0, "", "of those that left by it; not given: all",
     NULL},
    {"bins", SCREE_FIELD_COUNT, AT(bins), 1, 10000, "", "of the histogram", NULL},
};
#undef AT
static const scree_plan_residence residence_defaults = {.bins = 20};
static const scree_record residence_record = {
    "residence", FIELDS(residence_fields), sizeof(scree_plan_residence), &residence_defaults, NULL};

#define AT(member) offsetof(scree_plan_impacts, member)
static const scree_field impacts_fields[] = {
    {"by", SCREE_FIELD_WORD, AT(by), 0, 0, "shape|material", "classes of bodies; geometry by name",
     NULL},
    {"least", SCREE_FIELD_REAL, AT(least), 1e-18, 1e12, "J", "where the spectra begin", NULL},
    {"most", SCREE_FIELD_REAL, AT(most), 1e-18, 1e12, "J", "and end", NULL},
    {"bins", SCREE_FIELD_COUNT, AT(bins), 1, 100, "", "in a decade of energy", NULL},
    {"threshold", SCREE_FIELD_REAL, AT(threshold), 0, 1e12, "J",
     "damage is what the energy of approach exceeds it by", NULL},
    {"window", SCREE_FIELD_REAL, AT(window), 1e-9, 1e9, "s",
     "a spectrum for each; not given: one of all", NULL},
};
#undef AT
static scree_status check_impacts(const scree_reader *r, const void *record) {
  const scree_plan_impacts *p = record;
  if (p->least < p->most) return SCREE_OK;
  return scree_fail_place(r, &p->place, "least %g J must be below most %g J", p->least, p->most);
}
static const scree_plan_impacts impacts_defaults = {
    .least = 1e-9, .most = 1e3, .bins = 5, .window = NAN};
static const scree_record impacts_record = {"impacts", FIELDS(impacts_fields),
                                            sizeof(scree_plan_impacts), &impacts_defaults,
                                            check_impacts};

#define AT(member) offsetof(scree_plan_grid, member)
static const scree_field grid_fields[] = {
    {"box", SCREE_FIELD_RECORD, AT(box), 0, 0, "", "", &scree_plan_box_record},
    {"cylinder", SCREE_FIELD_RECORD, AT(cylinder), 0, 0, "", "instead of a box",
     &scree_plan_cylinder_record},
    {"cells", SCREE_FIELD_VECTOR, AT(cells), 1, 1000, "",
     "along x, y and z; of a cylinder outward, around and along", NULL},
    {"width", SCREE_FIELD_REAL, AT(width), 1e-9, 1e3, "m",
     "of coarse graining; not given: the largest body's size", NULL},
    {"every", SCREE_FIELD_REAL, AT(every), 1e-9, 1e9, "s",
     "between samples; not given: as the series", NULL},
    {"with", SCREE_FIELD_TEXT, AT(with), 0, 0, "",
     "a geometry: the grid is in its frame and moves with it", NULL},
};
#undef AT
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
static const scree_record grid_record = {"a grid", FIELDS(grid_fields), sizeof(scree_plan_grid),
                                         &grid_defaults, check_grid};

#define AT(member) offsetof(scree_plan_sensor, member)
static const scree_field sensor_fields[] = {
    {"flow", SCREE_FIELD_RECORD, AT(flow), 0, 0, "", "count and mass through a plane, by shape",
     &flow_record},
    {"region", SCREE_FIELD_RECORD, AT(region), 0, 0, "", "what is in a box", &region_record},
    {"wall", SCREE_FIELD_TEXT, AT(wall), 0, 0, "", "force, torque, power and wear of a geometry",
     NULL},
    {"position", SCREE_FIELD_TEXT, AT(position), 0, 0, "", "where a geometry is", NULL},
    {"part", SCREE_FIELD_TEXT, AT(part), 0, 0, "", "of a geometry that forces move", NULL},
    {"pile", SCREE_FIELD_RECORD, AT(pile), 0, 0, "", "angle of repose three ways", &pile_record},
    {"slope", SCREE_FIELD_RECORD, AT(slope), 0, 0, "", "angle of the surface", &slope_record},
    {"segregation", SCREE_FIELD_RECORD, AT(segregation), 0, 0, "", "Lacey's index by shape",
     &segregation_record},
    {"residence", SCREE_FIELD_RECORD, AT(residence), 0, 0, "", "time from inlet to outlet",
     &residence_record},
    {"grid", SCREE_FIELD_RECORD, AT(grid), 0, 0, "", "fields of means over time, for ParaView",
     &grid_record},
    {"impacts", SCREE_FIELD_RECORD, AT(impacts), 0, 0, "", "energies of contacts, by class",
     &impacts_record},
    {"from", SCREE_FIELD_REAL, AT(from), 0, 1e9, "s",
     "what comes before is neither gathered nor in means", NULL},
    {"until", SCREE_FIELD_REAL, AT(until), 1e-9, 1e9, "s", "nor what comes after; not given: all",
     NULL},
};
#undef AT
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
const scree_record scree_plan_sensor_record = {
    "a sensor", FIELDS(sensor_fields), sizeof(scree_plan_sensor), &sensor_defaults, check_sensor};
