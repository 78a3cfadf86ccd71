/* The fields of a scene in tables, and what fields must be together. */
#include "scene/plan_fields.h"

#include "base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

double scree_plan_unit(int unit) {
  static const double metres[] = {1, 1e-2, 1e-3, 1e-6, 0.0254, 0.3048, 1e3};
  return metres[unit];
}

size_t scree_plan_find(const scree_records *records, size_t size, const char *name) {
  for (size_t i = 0; i < records->count; i++) {
    const scree_place *place = (const void *)((const char *)records->items + i * size);
    if (!strcmp(place->name, name)) return i;
  }
  return records->count;
}

static bool has_length(const double *v) {
  return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

static bool is_across(const double *v, const double *n) {
  vec3 a = vec3_load(v), b = vec3_load(n);
  return fabs(vec3_dot(a, b)) <= 1e-6 * vec3_norm(a) * vec3_norm(b);
}

scree_status scree_plan_one_of(const scree_reader *r, const scree_place *place, const bool *there,
                               size_t count, const char *names) {
  size_t found = 0;
  for (size_t i = 0; i < count; i++) found += there[i];
  if (found == 1) return SCREE_OK;
  return scree_fail_place(r, place, found ? "only one of %s may be given" : "needs one of %s",
                          names);
}

scree_status scree_plan_check_direction(const scree_reader *r, const scree_place *place,
                                        const char *what, const double *v) {
  if (!given(v) || has_length(v)) return SCREE_OK;
  return scree_fail_place(r, place, "%s [0, 0, 0] points nowhere", what);
}

/* ---- materials ---- */

#define AT(member) offsetof(scree_plan_material, member)
static const scree_field material_fields[] = {
    {"young", SCREE_FIELD_REAL, AT(young), 1, 1e16, "Pa",
     "stiffness of a contact over size; of the law hertz Young's modulus", NULL},
    {"density", SCREE_FIELD_REAL, AT(density), 1e-3, 1e6, "kg/m3", "of particles", NULL},
    {"restitution", SCREE_FIELD_REAL, AT(restitution), 0.01, 1, "",
     "of a pair, the lower of the two, unless `pairs` says more", NULL},
    {"friction", SCREE_FIELD_REAL, AT(friction), 0, 100, "", "likewise", NULL},
    {"rolling_friction", SCREE_FIELD_REAL, AT(rolling_friction), 0, 100, "",
     "of spheres, likewise; 0: they roll freely", NULL},
    {"surface_energy", SCREE_FIELD_REAL, AT(surface_energy), 0, 1e6, "J/m2",
     "of cohesion, likewise; 0: nothing sticks", NULL},
    {"poisson", SCREE_FIELD_REAL, AT(poisson), 0, 0.5, "", "Poisson's ratio, of the law hertz",
     NULL},
};
#undef AT
static const scree_plan_material material_defaults = {{0}, 1e8, 2000, 0.3, 0.5, 0, 0, 0.3};
static const scree_record material_record = {"a material", FIELDS(material_fields),
                                             sizeof(scree_plan_material), &material_defaults, NULL};

#define AT(member) offsetof(scree_plan_pair, member)
static const scree_field pair_fields[] = {
    {"between", SCREE_FIELD_TEXTS, AT(between), 0, 0, "", "two materials, or one twice", NULL},
    {"restitution", SCREE_FIELD_REAL, AT(restitution), 0.01, 1, "", "", NULL},
    {"friction", SCREE_FIELD_REAL, AT(friction), 0, 100, "", "", NULL},
    {"rolling_friction", SCREE_FIELD_REAL, AT(rolling_friction), 0, 100, "", "of spheres", NULL},
    {"surface_energy", SCREE_FIELD_REAL, AT(surface_energy), 0, 1e6, "J/m2", "of cohesion", NULL},
    {"pull_off", SCREE_FIELD_REAL, AT(pull_off), 0, 1e9, "N", "that holds any two that touch",
     NULL},
    {"wear", SCREE_FIELD_REAL, AT(wear), 0, 1, "1/Pa",
     "Archard's: volume that geometry loses over load and way of sliding", NULL},
};
#undef AT
static scree_status check_pair(const scree_reader *r, const void *record) {
  const scree_plan_pair *p = record;
  if (p->between.count == 2) return SCREE_OK;
  return scree_fail_place(r, &p->place, "needs between: [material, material]");
}
static const scree_plan_pair pair_defaults = {{0}, {0}, NAN, NAN, NAN, NAN, NAN, 0};
static const scree_record pair_record = {"a pair", FIELDS(pair_fields), sizeof(scree_plan_pair),
                                         &pair_defaults, check_pair};

/* ---- shapes ---- */

#define AT(member) offsetof(scree_plan_shape, member)
static const scree_field shape_fields[] = {
    {"file", SCREE_FIELD_TEXT, AT(file), 0, 0, "", "a scan, or a table of spheres", NULL},
    {"sample", SCREE_FIELD_TEXT, AT(sample), 0, 0, "", "a built-in one, as sp-1", NULL},
    {"sphere", SCREE_FIELD_REAL, AT(sphere), 1e-9, 1e3, "m", "diameter", NULL},
    {"clump", SCREE_FIELD_TEXT, AT(clump), 0, 0, "",
     "a table of spheres: x, y, z, radius; or so many that stand for the shape", NULL},
    {"box", SCREE_FIELD_VECTOR, AT(box), 1e-9, 1e3, "m", "three sides", NULL},
    {"unit", SCREE_FIELD_WORD, AT(unit), 0, 0, SCREE_PLAN_UNITS,
     "of the file's lengths; not given: as the file says, else mm", NULL},
    {"resolution", SCREE_FIELD_REAL, AT(resolution), 0.02e-3, 5e-3, "m", "of a sample's vertices",
     NULL},
    {"noise", SCREE_FIELD_REAL, AT(noise), 0, 2e-3, "m", "of a sample's vertices", NULL},
    {"sample_seed", SCREE_FIELD_SEED, AT(sample_seed), 0, 0, "", "of that noise", NULL},
    {"repair", SCREE_FIELD_FLAG, AT(repair), 0, 0, "",
     "what is no closed surface; false: it is refused", NULL},
    {"triangles", SCREE_FIELD_TEXT, AT(triangles), 0, 0, "",
     "recommended (as `scree choose` does), all, or at most so many", NULL},
    {"rp", SCREE_FIELD_TEXT, AT(rp), 0, 0, "",
     "or its level: this share of the triangles; recommended, or as 0.5*recommended a multiple; "
     "scan; clump:20; spheres",
     NULL},
    {"method", SCREE_FIELD_WORD, AT(method), 0, 0, "volume|qecd", "of decimation", NULL},
    {"mass_from", SCREE_FIELD_WORD, AT(mass_from), 0, 0, "mesh|scan",
     "volume that gives the mass: of the decimated mesh, or of the scan at every level", NULL},
    {"material", SCREE_FIELD_TEXT, AT(material), 0, 0, "", "", NULL},
    {"density", SCREE_FIELD_REAL, AT(density), 1e-3, 1e6, "kg/m3", "another than its material's",
     NULL},
    {"size", SCREE_FIELD_RECORD, AT(size), 0, 0, "",
     "of many sizes, each the diameter of the sphere of equal volume", &scree_plan_size_record},
};
#undef AT

/* 4 or more: fewer triangles enclose nothing. */
static bool is_count(const char *text) {
  size_t digits = strspn(text, "0123456789");
  return digits > 0 && digits < 10 && !text[digits] && (digits > 1 || *text >= '4');
}

enum { MOST_SPHERES = 300 };

static bool is_number(const char *text) {
  return *text && !text[strspn(text, "0123456789")];
}

size_t scree_plan_spheres(const scree_plan_shape *shape) {
  return shape->clump && is_number(shape->clump) ? strtoul(shape->clump, NULL, 10) : 0;
}

static scree_status check_spheres(const scree_reader *r, const scree_plan_shape *s) {
  size_t count = scree_plan_spheres(s);
  if (count < 1 || count > MOST_SPHERES)
    return scree_fail_place(r, &s->place, "clump %.20s: must be 1 to %d spheres", s->clump,
                            MOST_SPHERES);
  return SCREE_OK;
}

static scree_status check_shape(const scree_reader *r, const void *record) {
  const scree_plan_shape *s = record;
  bool table = s->clump && !is_number(s->clump);
  if (s->clump && !table && !s->file && !s->sample && !given(s->box))
    return scree_fail_place(r, &s->place,
                            "clump %.20s: so many spheres stand for a file, sample or box: give it",
                            s->clump);
  const bool there[] = {s->file != NULL, s->sample != NULL, given(&s->sphere), table,
                        given(s->box)};
  bool none = true;
  for (int i = 0; i < 5; i++) none = none && !there[i];
  if (s->size && none) return SCREE_OK; /* spheres */
  if (s->size && given(&s->sphere))
    return scree_fail_place(r, &s->place,
                            "size is of a file, sample, clump or box; alone, of spheres");
  scree_status status =
      scree_plan_one_of(r, &s->place, there, 5, "file, sample, sphere (its diameter), clump, box");
  if (status == SCREE_OK && s->clump && !table) status = check_spheres(r, s);
  if (status != SCREE_OK) return status;
  if (scree_plan_spheres(s) && s->file && scree_is_clump_table(s->file))
    return scree_fail_place(r, &s->place, "%.100s is a table of spheres: leave out clump: %.20s",
                            s->file, s->clump);
  if (s->triangles && s->rp)
    return scree_fail_place(r, &s->place, "triangles and rp say the same in two ways: give one");
  if (s->triangles && !s->file && !s->sample)
    return scree_fail_place(r, &s->place, "triangles are of scans: this one has none");
  if (s->rp && given(&s->sphere))
    return scree_fail_place(r, &s->place, "rp is of scans: a sphere has none");
  const char *wrong = s->rp ? scree_shape_level_error(s->rp) : NULL;
  if (wrong) return scree_fail_place(r, &s->place, "rp '%.60s': %s", s->rp, wrong);
  if (s->triangles && strcmp(s->triangles, "recommended") != 0 &&
      strcmp(s->triangles, "all") != 0 && !is_count(s->triangles))
    return scree_fail_place(r, &s->place,
                            "triangles '%.60s': must be recommended, all, or a count of 4 or more",
                            s->triangles);
  return SCREE_OK;
}
static const scree_plan_shape shape_defaults = {.sphere = NAN,
                                                .box = NONE,
                                                .resolution = NAN,
                                                .noise = NAN,
                                                .density = NAN,
                                                .scaled = NAN,
                                                .sample_seed = 1,
                                                .unit = -1,
                                                .repair = true};
static const scree_record shape_record = {"a shape", FIELDS(shape_fields), sizeof(scree_plan_shape),
                                          &shape_defaults, check_shape};

/* ---- geometry ---- */

#define AT(member) offsetof(scree_plan_turn, member)
static const scree_field turn_fields[] = {
    {"axis", SCREE_FIELD_VECTOR, AT(axis), 0, 0, "", "", NULL},
    {"angle_deg", SCREE_FIELD_REAL, AT(angle_deg), -360, 360, "deg", "right-handed about the axis",
     NULL},
};
#undef AT
static scree_status check_turn(const scree_reader *r, const void *record) {
  const scree_plan_turn *t = record;
  return scree_plan_check_direction(r, &t->place, "axis", t->axis);
}
static const scree_plan_turn turn_defaults = {{0}, {0, 0, 1}, 0};
static const scree_record turn_record = {"a turn", FIELDS(turn_fields), sizeof(scree_plan_turn),
                                         &turn_defaults, check_turn};

#define AT(member) offsetof(scree_plan_disc, member)
static const scree_field disc_fields[] = {
    {"radius", SCREE_FIELD_REAL, AT(radius), 1e-9, 1e6, "m", "", NULL},
    {"normal", SCREE_FIELD_VECTOR, AT(normal), 0, 0, "", "", NULL},
};
#undef AT
static scree_status check_disc(const scree_reader *r, const void *record) {
  const scree_plan_disc *d = record;
  if (!given(&d->radius)) return scree_fail_place(r, &d->place, "needs a radius");
  return scree_plan_check_direction(r, &d->place, "normal", d->normal);
}
static const scree_plan_disc disc_defaults = {{0}, {0, 0, 1}, NAN};
static const scree_record disc_record = {"a disc", FIELDS(disc_fields), sizeof(scree_plan_disc),
                                         &disc_defaults, check_disc};

#define AT(member) offsetof(scree_plan_cylinder, member)
static const scree_field cylinder_fields[] = {
    {"radius", SCREE_FIELD_REAL, AT(radius), 1e-9, 1e6, "m",
     "inside; of geometry with layers in it not given: as wide as what they pour will be high",
     NULL},
    {"length", SCREE_FIELD_REAL, AT(length), 0, 1e6, "m", "along the axis; of geometry 0: endless",
     NULL},
    {"axis", SCREE_FIELD_VECTOR, AT(axis), 0, 0, "", "", NULL},
    {"at", SCREE_FIELD_VECTOR, AT(at), -1e6, 1e6, "m",
     "of a region: the middle of the end it begins at", NULL},
};
#undef AT
static scree_status check_cylinder(const scree_reader *r, const void *record) {
  const scree_plan_cylinder *c = record;
  return scree_plan_check_direction(r, &c->place, "axis", c->axis);
}
static const scree_plan_cylinder cylinder_defaults = {{0}, NONE, {0, 0, 1}, NAN, 0};
const scree_record scree_plan_cylinder_record = {"a cylinder", FIELDS(cylinder_fields),
                                                 sizeof(scree_plan_cylinder), &cylinder_defaults,
                                                 check_cylinder};

#define AT(member) offsetof(scree_plan_box, member)
static const scree_field box_fields[] = {
    {"min", SCREE_FIELD_VECTOR, AT(min), -1e6, 1e6, "m", "corner", NULL},
    {"max", SCREE_FIELD_VECTOR, AT(max), -1e6, 1e6, "m", "opposite corner", NULL},
};
#undef AT
static scree_status check_corners(const scree_reader *r, const scree_place *place,
                                  const double *min, const double *max) {
  if (!given(min) || !given(max))
    return scree_fail_place(r, place, "needs min: [x, y, z] and max: [x, y, z]");
  for (int k = 0; k < 3; k++)
    if (!(min[k] < max[k]))
      return scree_fail_place(r, place, "min %g must be below max %g along %c", min[k], max[k],
                              "xyz"[k]);
  return SCREE_OK;
}
static scree_status check_box(const scree_reader *r, const void *record) {
  const scree_plan_box *b = record;
  return check_corners(r, &b->place, b->min, b->max);
}
static const scree_plan_box box_defaults = {{0}, NONE, NONE};
const scree_record scree_plan_box_record = {"a box", FIELDS(box_fields), sizeof(scree_plan_box),
                                            &box_defaults, check_box};

#define AT(member) offsetof(scree_plan_shaft, member)
static const scree_field shaft_fields[] = {
    {"width", SCREE_FIELD_REAL, AT(width), 1e-9, 1e6, "m",
     "inside, along x; with layers in it not given: as wide as what they pour will be high", NULL},
    {"depth", SCREE_FIELD_REAL, AT(depth), 1e-9, 1e6, "m", "along y; not given: the width", NULL},
};
#undef AT
static const scree_plan_shaft shaft_defaults = {{0}, NAN, NAN};
static const scree_record shaft_record = {"a shaft", FIELDS(shaft_fields), sizeof(scree_plan_shaft),
                                          &shaft_defaults, NULL};

scree_status scree_plan_check_window(const scree_reader *r, const scree_place *place, double from,
                                     double until) {
  if (!given(&until) || from < until) return SCREE_OK;
  return scree_fail_place(r, place, "until %g s must be after from %g s", until, from);
}

/* ---- geometry, whole ---- */

#define AT(member) offsetof(scree_plan_geometry, member)
static const scree_field geometry_fields[] = {
    {"file", SCREE_FIELD_TEXTS, AT(file), 0, 0, "", "a mesh, or several that move together", NULL},
    {"box", SCREE_FIELD_VECTOR, AT(box), 1e-9, 1e6, "m", "three sides, about `at`", NULL},
    {"plane", SCREE_FIELD_VECTOR, AT(plane), 0, 0, "", "normal, out of the solid", NULL},
    {"disc", SCREE_FIELD_RECORD, AT(disc), 0, 0, "", "", &disc_record},
    {"cylinder", SCREE_FIELD_RECORD, AT(cylinder), 0, 0, "", "a sheet from `at` along its axis",
     &scree_plan_cylinder_record},
    {"shaft", SCREE_FIELD_RECORD, AT(shaft), 0, 0, "", "four endless walls about z", &shaft_record},
    {"loop", SCREE_FIELD_RECORD, AT(loop), 0, 0, "",
     "a sheet round two wheels, one of them at `at`", &scree_plan_loop_record},
    {"screw", SCREE_FIELD_RECORD, AT(screw), 0, 0, "", "a flight on a shaft",
     &scree_plan_screw_record},
    {"sieve", SCREE_FIELD_RECORD, AT(sieve), 0, 0, "", "a plate with round holes, flat or bent",
     &scree_plan_sieve_record},
    {"unit", SCREE_FIELD_WORD, AT(unit), 0, 0, SCREE_PLAN_UNITS, "of the file's lengths", NULL},
    {"at", SCREE_FIELD_VECTOR, AT(at), -1e6, 1e6, "m", "where its origin goes", NULL},
    {"turn", SCREE_FIELD_RECORD, AT(turn), 0, 0, "", "about its origin, before it goes there",
     &turn_record},
    {"side", SCREE_FIELD_WORD, AT(side), 0, 0, "auto|outside|inside|both",
     "of a closed mesh or box: where bodies are; auto: where the inlets are", NULL},
    {"material", SCREE_FIELD_TEXT, AT(material), 0, 0, "", "", NULL},
    {"copies", SCREE_FIELD_RECORD, AT(copies), 0, 0, "", "of it, about an axis or along a chain",
     &scree_plan_copies_record},
    {"motion", SCREE_FIELD_LIST, AT(motion), 0, 0, "", "in this order", &scree_plan_motion_record},
    {"slide", SCREE_FIELD_RECORD, AT(slide), 0, 0, "", "moved by forces along a direction",
     &scree_plan_slide_record},
    {"hinge", SCREE_FIELD_RECORD, AT(hinge), 0, 0, "", "turned by forces about an axis",
     &scree_plan_hinge_record},
    {"surface_velocity", SCREE_FIELD_VECTOR, AT(surface_velocity), -1e3, 1e3, "m/s",
     "of a belt that stays where it is", NULL},
    {"belt", SCREE_FIELD_RECORD, AT(belt), 0, 0, "",
     "of a file or loop that is closed about an axis: its surface runs round",
     &scree_plan_belt_record},
};
#undef AT
static scree_status check_geometry(const scree_reader *r, const void *record) {
  const scree_plan_geometry *g = record;
  const bool there[] = {g->file.count > 0, given(g->box),       given(g->plane),
                        g->disc != NULL,   g->cylinder != NULL, g->shaft != NULL,
                        g->loop != NULL,   g->screw != NULL,    g->sieve != NULL};
  SCREE_TRY(scree_plan_one_of(r, &g->place, there, 9,
                              "file, box, plane, disc, cylinder, shaft, loop, screw, sieve"));
  SCREE_TRY(scree_plan_check_direction(r, &g->place, "plane", g->plane));
  if (g->cylinder && given(g->cylinder->at))
    return scree_fail_place(r, &g->cylinder->place,
                            "at stands beside the cylinder, as of all geometry, not in it");
  if (g->side && !there[0] && !there[1])
    return scree_fail_place(r, &g->place, "side is of a file or a box, which may be closed");
  const double *normal = g->disc ? g->disc->normal : g->plane;
  if (given(g->surface_velocity) && (g->disc || given(g->plane)) &&
      !is_across(g->surface_velocity, normal))
    return scree_fail_place(r, &g->place, "surface_velocity must lie in the surface");
  if (g->belt && !g->file.count && !g->loop)
    return scree_fail_place(r, &g->belt->place,
                            "is of a file or a loop; give a surface_velocity instead");
  if (g->belt && given(g->surface_velocity))
    return scree_fail_place(r, &g->place, "only one of surface_velocity, belt may be given");
  if ((g->slide != NULL) + (g->hinge != NULL) + (g->motion.count > 0) > 1)
    return scree_fail_place(r, &g->place, "only one of motion, slide, hinge may be given");
  if (g->copies && (g->belt || given(g->surface_velocity)))
    return scree_fail_place(r, &g->copies->place, "of belts there are none: give each its own");
  const scree_plan_motion *motions = g->motion.items;
  for (size_t i = 0; i < g->motion.count; i++)
    if (motions[i].round && (g->motion.count > 1 || !g->copies || !given(&g->copies->radius)))
      return scree_fail_place(r, &motions[i].place,
                              "round is the only motion of copies along a chain: give copies: "
                              "{count, axis, through, span, radius}");
  for (size_t i = 0; g->motion.count > 1 && i < g->motion.count; i++)
    if (motions[i].during)
      return scree_fail_place(r, &motions[i].place,
                              "a motion during a phase must be the geometry's only one");
  return SCREE_OK;
}
static const scree_plan_geometry geometry_defaults = {
    .box = NONE, .plane = NONE, .surface_velocity = NONE, .unit = 2};
static const scree_record geometry_record = {"geometry", FIELDS(geometry_fields),
                                             sizeof(scree_plan_geometry), &geometry_defaults,
                                             check_geometry};

/* ---- inlets and outlets ---- */

#define AT(member) offsetof(scree_plan_layers, member)
static const scree_field layers_fields[] = {
    {"packed", SCREE_FIELD_WORD, AT(packed), 0, 0, "random|grid",
     "as many as random places hold, or one in every cell of a square grid", NULL},
    {"pack_time", SCREE_FIELD_REAL, AT(pack_time), 0, 1e6, "s",
     "in which all enter; not given: each layer as the one before has made room by falling", NULL},
    {"in", SCREE_FIELD_TEXT, AT(in), 0, 0, "",
     "a cylinder or shaft that they fill, in place of a box or cylinder of their own", NULL},
    {"begin", SCREE_FIELD_WORD, AT(begin), 0, 0, "heap|top",
     "in it: from near its bottom, or above where all will lie loosely", NULL},
    {"bottom", SCREE_FIELD_REAL, AT(bottom), 0, 1e6, "m",
     "from near its bottom: height of the first; not given: as `above`", NULL},
    {"above", SCREE_FIELD_REAL, AT(above), 0, 1e3, "m", "the highest body, at least", NULL},
    {"clearance", SCREE_FIELD_REAL, AT(clearance), 0, 1e3, "m",
     "kept free around a body; not given: half a hundredth of the mean size", NULL},
};
#undef AT
static scree_status check_layers(const scree_reader *r, const void *record) {
  const scree_plan_layers *l = record;
  if (!l->packed) return SCREE_OK;
  if (given(&l->clearance))
    return scree_fail_place(r, &l->place, "clearance is of random layers; a grid has its cells");
  if (!given(&l->pack_time)) return SCREE_OK;
  return scree_fail_place(
      r, &l->place, "pack_time is of random layers; those of a grid follow from the velocity");
}
static const scree_plan_layers layers_defaults = {
    .pack_time = NAN, .bottom = NAN, .clearance = NAN};
static const scree_record layers_record = {
    "layers", FIELDS(layers_fields), sizeof(scree_plan_layers), &layers_defaults, check_layers};

#define AT(member) offsetof(scree_plan_inlet, member)
static const scree_field inlet_fields[] = {
    {"box", SCREE_FIELD_RECORD, AT(box), 0, 0, "", "bodies begin wholly inside",
     &scree_plan_box_record},
    {"cylinder", SCREE_FIELD_RECORD, AT(cylinder), 0, 0, "", "likewise",
     &scree_plan_cylinder_record},
    {"shapes", SCREE_FIELD_WEIGHTS, AT(shapes), 0, 1e12, "", "and their shares by number", NULL},
    {"rate", SCREE_FIELD_REAL, AT(rate), 0, 1e9, "1/s", "bodies a second", NULL},
    {"mass_rate", SCREE_FIELD_REAL, AT(mass_rate), 0, 1e9, "kg/s", "or mass a second", NULL},
    {"count", SCREE_FIELD_COUNT, AT(count), 1, 1e9, "",
     "at most so many; without a rate as soon as there is room", NULL},
    WINDOW(scree_plan_inlet),
    {"velocity", SCREE_FIELD_VECTOR, AT(velocity), -1e3, 1e3, "m/s", "on entering", NULL},
    {"orientation", SCREE_FIELD_WORD, AT(orientation), 0, 0, "random|fixed",
     "fixed: axes as in the shape's file", NULL},
    {"layers", SCREE_FIELD_RECORD, AT(layers), 0, 0, "",
     "batches, each above all that is there; the region is what they cover and where they begin",
     &layers_record},
};
#undef AT
static scree_status check_layered(const scree_reader *r, const scree_plan_inlet *i) {
  const scree_plan_cylinder *c = i->cylinder;
  if (!i->layers->in && (i->layers->begin || given(&i->layers->bottom)))
    return scree_fail_place(r, &i->layers->place,
                            "begin and bottom are of layers in a geometry: give in: NAME");
  if (c && !given(&c->radius)) return scree_fail_place(r, &c->place, "needs a radius");
  if (c && (!given(c->at) || c->axis[0] != 0 || c->axis[1] != 0))
    return scree_fail_place(r, &c->place, "of layers needs at: [x, y, z] and an axis along z");
  if (i->shapes.count == 0) return scree_fail_place(r, &i->place, "needs shapes: {name: share}");
  if (i->count == 0 || given(&i->rate) || given(&i->mass_rate) || given(&i->until) || i->from > 0)
    return scree_fail_place(r, &i->place,
                            "layers need a count, and no rate, mass_rate, from or until");
  if (i->orientation) return scree_fail_place(r, &i->place, "layers have random orientations only");
  if (i->velocity[0] != 0 || i->velocity[1] != 0 || i->velocity[2] > 0)
    return scree_fail_place(r, &i->place, "layers enter downwards: velocity: [0, 0, -1]");
  if (given(&i->layers->pack_time) && i->velocity[2] != 0)
    return scree_fail_place(r, &i->place,
                            "pack_time sets the velocity of layers: give one of them");
  return SCREE_OK;
}

static scree_status check_inlet(const scree_reader *r, const void *record) {
  const scree_plan_inlet *i = record;
  const bool there[] = {i->box != NULL, i->cylinder != NULL, i->layers && i->layers->in};
  const bool rates[] = {given(&i->rate), given(&i->mass_rate), i->count > 0};
  SCREE_TRY(scree_plan_one_of(r, &i->place, there, 3, "box, cylinder, layers in a geometry"));
  if (i->layers) return check_layered(r, i);
  if (i->cylinder && !given(&i->cylinder->radius))
    return scree_fail_place(r, &i->cylinder->place, "needs a radius");
  if (i->cylinder && (!given(i->cylinder->at) || !(i->cylinder->length > 0)))
    return scree_fail_place(r, &i->cylinder->place, "needs at: [x, y, z] and a length above 0");
  if (i->shapes.count == 0) return scree_fail_place(r, &i->place, "needs shapes: {name: share}");
  if (!rates[0] && !rates[1] && !rates[2])
    return scree_fail_place(r, &i->place, "needs a rate, a mass_rate or a count");
  if ((rates[0] && i->rate == 0) || (rates[1] && i->mass_rate == 0))
    return scree_fail_place(r, &i->place, "a rate of 0: nothing would ever enter");
  if (rates[0] && rates[1])
    return scree_fail_place(r, &i->place, "only one of rate, mass_rate may be given");
  return scree_plan_check_window(r, &i->place, i->from, i->until);
}
static const scree_plan_inlet inlet_defaults = {.rate = NAN, .mass_rate = NAN, .until = NAN};
static const scree_record inlet_record = {"an inlet", FIELDS(inlet_fields),
                                          sizeof(scree_plan_inlet), &inlet_defaults, check_inlet};

#define AT(member) offsetof(scree_plan_outlet, member)
static const scree_field outlet_fields[] = {
    {"box", SCREE_FIELD_RECORD, AT(box), 0, 0, "", "bodies whose centre is inside are taken out",
     &scree_plan_box_record},
    WINDOW(scree_plan_outlet),
};
#undef AT
static scree_status check_outlet(const scree_reader *r, const void *record) {
  const scree_plan_outlet *o = record;
  if (!o->box) return scree_fail_place(r, &o->place, "needs a box: {min: ..., max: ...}");
  return scree_plan_check_window(r, &o->place, o->from, o->until);
}
static const scree_plan_outlet outlet_defaults = {.until = NAN};
static const scree_record outlet_record = {
    "an outlet", FIELDS(outlet_fields), sizeof(scree_plan_outlet), &outlet_defaults, check_outlet};

#define AT(member) offsetof(scree_plan_domain, member)
static const scree_field domain_fields[] = {
    {"min", SCREE_FIELD_VECTOR, AT(min), -1e9, 1e9, "m", "corner", NULL},
    {"max", SCREE_FIELD_VECTOR, AT(max), -1e9, 1e9, "m", "opposite corner", NULL},
    {"periodic", SCREE_FIELD_TEXTS, AT(periodic), 0, 0, "",
     "axes along which what leaves enters again", NULL},
};
#undef AT
static scree_status check_domain(const scree_reader *r, const void *record) {
  const scree_plan_domain *d = record;
  SCREE_TRY(check_corners(r, &d->place, d->min, d->max));
  for (size_t i = 0; i < d->periodic.count; i++) {
    const char *axis = d->periodic.items[i];
    if (strlen(axis) != 1 || !strchr("xyz", *axis))
      return scree_fail_place(r, &d->place, "periodic '%.20s': must be x, y or z", axis);
  }
  if (d->periodic.count > 2)
    return scree_fail_place(r, &d->place, "periodic: along two axes at most");
  return SCREE_OK;
}
static const scree_plan_domain domain_defaults = {{0}, NONE, NONE, {0}};
static const scree_record domain_record = {
    "the domain", FIELDS(domain_fields), sizeof(scree_plan_domain), &domain_defaults, check_domain};

/* ---- the rest ---- */

#define AT(member) offsetof(scree_plan_contact, member)
static const scree_field contact_fields[] = {
    {"law", SCREE_FIELD_WORD, AT(law), 0, 0, "linear|hysteretic|hertz",
     "docs/background/physics.md", NULL},
    {"steps", SCREE_FIELD_REAL, AT(steps), 15, 1e6, "",
     "time steps in a quarter of the fastest contact's period", NULL},
    {"stiffness_factor", SCREE_FIELD_REAL, AT(stiffness_factor), 1e-9, 1e9, "",
     "multiplies every stiffness: below 1 steps are longer and overlaps deeper", NULL},
    {"tangential_ratio", SCREE_FIELD_REAL, AT(tangential_ratio), 1e-6, 1, "",
     "tangential over normal stiffness", NULL},
    {"time_step", SCREE_FIELD_REAL, AT(time_step), 0, 1, "s", "0: by steps", NULL},
};
#undef AT
static const scree_plan_contact contact_defaults = {{0}, 0, 20, 1, 1, 0};
static const scree_record contact_record = {"contact", FIELDS(contact_fields),
                                            sizeof(scree_plan_contact), &contact_defaults, NULL};

static const scree_field bodies_fields[] = {
    {"file", SCREE_FIELD_TEXT, offsetof(scree_plan_bodies, file), 0, 0, "",
     "a table with a line for each", NULL},
};
static scree_status check_bodies(const scree_reader *r, const void *record) {
  const scree_plan_bodies *b = record;
  return b->file ? SCREE_OK : scree_fail_place(r, &b->place, "needs a file");
}
static const scree_plan_bodies bodies_defaults = {{0}, NULL};
static const scree_record bodies_record = {
    "bodies", FIELDS(bodies_fields), sizeof(scree_plan_bodies), &bodies_defaults, check_bodies};

#define AT(member) offsetof(scree_plan_stop, member)
static const scree_field stop_fields[] = {
    {"still", SCREE_FIELD_REAL, AT(still), 0, 1e9, "J",
     "all have entered and move with less energy a body", NULL},
    {"rest", SCREE_FIELD_REAL, AT(rest), 0, 1e9, "s", "for so long; not given: for ten ticks",
     NULL},
    {"filled", SCREE_FIELD_REAL, AT(filled), 0, 1e9, "s", "so long after all have entered", NULL},
    {"empty", SCREE_FIELD_FLAG, AT(empty), 0, 0, "", "all have entered and left", NULL},
    {"after", SCREE_FIELD_REAL, AT(after), 0, 1e9, "s", "not before", NULL},
};
#undef AT
static const scree_plan_stop stop_defaults = {{0}, NAN, NAN, NAN, 0, false};
static const scree_record stop_record = {"stop", FIELDS(stop_fields), sizeof(scree_plan_stop),
                                         &stop_defaults, NULL};

#define AT(member) offsetof(scree_plan_phase, member)
static const scree_field phase_fields[] = {
    {"time", SCREE_FIELD_REAL, AT(time), 0, 1e9, "s", "it lasts, at most", NULL},
    {"filled", SCREE_FIELD_FLAG, AT(filled), 0, 0, "",
     "it lasts until all have entered, however long", NULL},
    {"still", SCREE_FIELD_REAL, AT(still), 0, 1e9, "J",
     "it ends early when all move with less energy a body", NULL},
    {"rest", SCREE_FIELD_REAL, AT(rest), 0, 1e9, "s", "for so long", NULL},
    {"early", SCREE_FIELD_FLAG, AT(early), 0, 0, "", "false: `still` does not end it", NULL},
    {"clear", SCREE_FIELD_TEXT, AT(clear), 0, 0, "",
     "a geometry: it ends early only when that is above all bodies", NULL},
};
#undef AT
static scree_status check_phase(const scree_reader *r, const void *record) {
  const scree_plan_phase *p = record;
  if (!given(&p->time)) return scree_fail_place(r, &p->place, "needs a time");
  if (p->clear && !given(&p->still))
    return scree_fail_place(r, &p->place, "clear says when `still` may end it: give still too");
  return SCREE_OK;
}
static const scree_plan_phase phase_defaults = {{0}, NAN, NAN, 0.1, false, true, NULL};
static const scree_record phase_record = {"a phase", FIELDS(phase_fields), sizeof(scree_plan_phase),
                                          &phase_defaults, check_phase};

#define AT(member) offsetof(scree_plan_output, member)
static const scree_field output_fields[] = {
    {"frames", SCREE_FIELD_REAL, AT(frames), 0, 1e9, "s", "between files for ParaView; 0: none",
     NULL},
    {"bodies", SCREE_FIELD_WORD, AT(bodies), 0, 0, "instances|surfaces",
     "of files for ParaView: a point for each, and each shape once; or all their triangles", NULL},
    {"series", SCREE_FIELD_REAL, AT(series), 1e-9, 1e9, "s", "between the lines of series.csv",
     NULL},
    {"motion", SCREE_FIELD_REAL, AT(motion), 0, 1e9, "s",
     "between moments of report.html; 0: a 240th of the time", NULL},
    {"checkpoint", SCREE_FIELD_REAL, AT(checkpoint), 0.01, 1e9, "s", "of the clock", NULL},
};
#undef AT
static const scree_plan_output output_defaults = {{0}, 0, 0.01, 60, 0, 0};
static const scree_record output_record = {"output", FIELDS(output_fields),
                                           sizeof(scree_plan_output), &output_defaults, NULL};

/* ---- names for what is set together ---- */

#define AT(member) offsetof(scree_scene_parameter, member)
static const scree_field parameter_fields[] = {
    {"name", SCREE_FIELD_TEXT, AT(name), 0, 0, "", "", NULL},
    {"sets", SCREE_FIELD_TEXTS, AT(sets), 0, 0, "", "fields; * is every name of a group", NULL},
    {"factor", SCREE_FIELD_REAL, AT(factor), -1e9, 1e9, "", "times the value", NULL},
    {"least", SCREE_FIELD_REAL, AT(least), -1e300, 1e300, "", "of the value", NULL},
    {"most", SCREE_FIELD_REAL, AT(most), -1e300, 1e300, "", "", NULL},
    {"below", SCREE_FIELD_REAL, AT(below), 1e-9, 1e3, "m",
     "where the largest shape is smaller, the fields shrink", NULL},
    {"power", SCREE_FIELD_REAL, AT(power), 0, 10, "",
     "of the share of that size that they shrink by; 0, once they are set: they do not", NULL},
};
#undef AT
static scree_status check_parameter(const scree_reader *r, const void *record) {
  const scree_scene_parameter *p = record;
  if (!p->name || !p->sets.count)
    return scree_fail_place(r, &p->place, "needs a name and sets: [FIELD, ...]");
  if (given(&p->below) != given(&p->power))
    return scree_fail_place(r, &p->place, "below and power go together");
  if (isnan(p->power) || 2 * p->power == floor(2 * p->power)) return SCREE_OK;
  return scree_fail_place(r, &p->place, "power %g: must be a whole number, or half of one",
                          p->power);
}
static const scree_scene_parameter parameter_defaults = {
    .factor = NAN, .least = NAN, .most = NAN, .below = NAN, .power = NAN};
static const scree_record parameter_record = {"a parameter", FIELDS(parameter_fields),
                                              sizeof(scree_scene_parameter), &parameter_defaults,
                                              check_parameter};

#define AT(member) offsetof(scree_plan_preset, member)
static const scree_field preset_fields[] = {
    {"name", SCREE_FIELD_TEXT, AT(name), 0, 0, "", "", NULL},
    {"about", SCREE_FIELD_TEXT, AT(about), 0, 0, "", "", NULL},
    {"set", SCREE_FIELD_VALUES, AT(set), 0, 0, "", "values of parameters and fields", NULL},
};
#undef AT
static scree_status check_preset(const scree_reader *r, const void *record) {
  const scree_plan_preset *p = record;
  return p->name ? SCREE_OK : scree_fail_place(r, &p->place, "needs a name");
}
static const scree_plan_preset preset_defaults = {.name = NULL};
static const scree_record preset_record = {
    "a preset", FIELDS(preset_fields), sizeof(scree_plan_preset), &preset_defaults, check_preset};

#define AT(member) offsetof(scree_plan, member)
static const scree_field plan_fields[] = {
    {"title", SCREE_FIELD_TEXT, AT(title), 0, 0, "", "", NULL},
    {"preset", SCREE_FIELD_TEXT, AT(preset), 0, 0, "", "of those below, whose values it has", NULL},
    {"time", SCREE_FIELD_REAL, AT(time), 1e-9, 1e9, "s", "simulated, at most", NULL},
    {"seed", SCREE_FIELD_SEED, AT(seed), 0, 0, "", "of places, orientations and order", NULL},
    {"gravity", SCREE_FIELD_VECTOR, AT(gravity), -1e3, 1e3, "m/s2", "", NULL},
    {"tick", SCREE_FIELD_COUNT, AT(tick), 1, 1e6, "",
     "steps between looks at inlets, outlets, flows and the end; not given: by the bodies' size",
     NULL},
    {"contact", SCREE_FIELD_RECORD, AT(contact), 0, 0, "", "", &contact_record},
    {"materials", SCREE_FIELD_NAMED, AT(materials), 0, 0, "", "", &material_record},
    {"pairs", SCREE_FIELD_LIST, AT(pairs), 0, 0, "", "", &pair_record},
    {"shapes", SCREE_FIELD_NAMED, AT(shapes), 0, 0, "", "", &shape_record},
    {"geometry", SCREE_FIELD_NAMED, AT(geometry), 0, 0, "", "", &geometry_record},
    {"bodies", SCREE_FIELD_RECORD, AT(bodies), 0, 0, "", "that are there from the start",
     &bodies_record},
    {"inlets", SCREE_FIELD_NAMED, AT(inlets), 0, 0, "", "", &inlet_record},
    {"outlets", SCREE_FIELD_NAMED, AT(outlets), 0, 0, "", "", &outlet_record},
    {"domain", SCREE_FIELD_RECORD, AT(domain), 0, 0, "", "what leaves it is taken out",
     &domain_record},
    {"sensors", SCREE_FIELD_NAMED, AT(sensors), 0, 0, "", "", &scree_plan_sensor_record},
    {"forces", SCREE_FIELD_NAMED, AT(forces), 0, 0, "", "on bodies", &scree_plan_force_record},
    {"phases", SCREE_FIELD_NAMED, AT(phases), 0, 0, "",
     "follow each other; after the last the scene ends", &phase_record},
    {"stop", SCREE_FIELD_RECORD, AT(stop), 0, 0, "", "what ends it before its time", &stop_record},
    {"output", SCREE_FIELD_RECORD, AT(output), 0, 0, "", "", &output_record},
    {"parameters", SCREE_FIELD_LIST, AT(parameters), 0, 0, "", "names for fields set together",
     &parameter_record},
    {"presets", SCREE_FIELD_LIST, AT(presets), 0, 0, "", "values for many", &preset_record},
};
#undef AT

static const scree_plan plan_defaults = {.time = NAN, .seed = 1, .gravity = {0, 0, -9.81}};
const scree_record scree_plan_record = {"a scene", FIELDS(plan_fields), sizeof(scree_plan),
                                        &plan_defaults, scree_plan_check};

/* Groups that may be left out, and then have their defaults. */
static scree_status fill_in(const scree_reader *r, const scree_record *kind, void **record) {
  if (*record) return SCREE_OK;
  *record = scree_arena_take(r->arena, 1, kind->size);
  if (!*record) return scree_fail_memory(r->error, kind->size, r->file);
  memcpy(*record, kind->defaults, kind->size);
  return SCREE_OK;
}

scree_status scree_plan_read(const scree_reader *reader, const scree_yaml *root, scree_plan *plan) {
  scree_plan made;
  scree_place place = {NULL, "", root->line, root->column};
  if (root->kind != SCREE_YAML_MAPPING)
    return scree_fail_place(reader, &place, "a scene is `key: value` lines");
  SCREE_TRY(scree_record_read(reader, root, &scree_plan_record, &made));
  SCREE_TRY(fill_in(reader, &contact_record, (void **)&made.contact));
  SCREE_TRY(fill_in(reader, &stop_record, (void **)&made.stop));
  SCREE_TRY(fill_in(reader, &output_record, (void **)&made.output));
  *plan = made;
  return SCREE_OK;
}
