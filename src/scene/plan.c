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

#define RECORD scree_plan_material
static const scree_field material_fields[] = {
    REAL(young, 1, 1e16, "Pa",
         "stiffness of a contact over size; of the law hertz Young's modulus"),
    REAL(density, 1e-3, 1e6, "kg/m3", "of particles"),
    REAL(restitution, 0.01, 1, "", "of a pair, the lower of the two, unless `pairs` says more"),
    REAL(friction, 0, 100, "", "likewise"),
    REAL(rolling_friction, 0, 100, "", "of spheres, likewise; 0: they roll freely"),
    REAL(surface_energy, 0, 1e6, "J/m2", "of cohesion, likewise; 0: nothing sticks"),
    REAL(poisson, 0, 0.5, "", "Poisson's ratio, of the law hertz"),
};
#undef RECORD
static const scree_plan_material material_defaults = {{0}, 1e8, 2000, 0.3, 0.5, 0, 0, 0.3};
static const scree_record material_record =
    SCREE_RECORD("a material", material_fields, material_defaults, NULL);

#define RECORD scree_plan_pair
static const scree_field pair_fields[] = {
    TEXTS(between, "two materials, or one twice"),
    REAL(restitution, 0.01, 1, "", ""),
    REAL(friction, 0, 100, "", ""),
    REAL(rolling_friction, 0, 100, "", "of spheres"),
    REAL(surface_energy, 0, 1e6, "J/m2", "of cohesion"),
    REAL(pull_off, 0, 1e9, "N", "that holds any two that touch"),
    REAL(wear, 0, 1, "1/Pa", "Archard's: volume that geometry loses over load and way of sliding"),
};
#undef RECORD
static scree_status check_pair(const scree_reader *r, const void *record) {
  const scree_plan_pair *p = record;
  if (p->between.count == 2) return SCREE_OK;
  return scree_fail_place(r, &p->place, "needs between: [material, material]");
}
static const scree_plan_pair pair_defaults = {{0}, {0}, NAN, NAN, NAN, NAN, NAN, 0};
static const scree_record pair_record =
    SCREE_RECORD("a pair", pair_fields, pair_defaults, check_pair);

/* ---- shapes ---- */

#define RECORD scree_plan_shape
static const scree_field shape_fields[] = {
    TEXT(file, "a scan, or a table of spheres"),
    TEXT(sample, "a built-in one, as sp-1"),
    REAL(sphere, 1e-9, 1e3, "m", "diameter"),
    TEXT(clump, "a table of spheres: x, y, z, radius; or so many that stand for the shape"),
    VECTOR(box, 1e-9, 1e3, "m", "three sides"),
    WORD(unit, SCREE_PLAN_UNITS, "of the file's lengths; not given: as the file says, else mm"),
    REAL(resolution, 0.02e-3, 5e-3, "m", "of a sample's vertices"),
    REAL(noise, 0, 2e-3, "m", "of a sample's vertices"),
    SEED(sample_seed, "of that noise"),
    FLAG(repair, "what is no closed surface; false: it is refused"),
    TEXT(triangles, "recommended (as `scree choose` does), all, or at most so many"),
    TEXT(
        rp,
        "or its level: this share of the triangles; recommended, or as 0.5*recommended a multiple; "
        "scan; clump:20; spheres"),
    WORD(method, "volume|qecd", "of decimation"),
    WORD(mass_from, "mesh|scan",
         "volume that gives the mass: of the decimated mesh, or of the scan at every level"),
    TEXT(material, ""),
    REAL(density, 1e-3, 1e6, "kg/m3", "another than its material's"),
    GROUP(size, "of many sizes, each the diameter of the sphere of equal volume",
          &scree_plan_size_record),
};
#undef RECORD

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
static const scree_record shape_record =
    SCREE_RECORD("a shape", shape_fields, shape_defaults, check_shape);

/* ---- geometry ---- */

#define RECORD scree_plan_turn
static const scree_field turn_fields[] = {
    VECTOR(axis, 0, 0, "", ""),
    REAL(angle_deg, -360, 360, "deg", "right-handed about the axis"),
};
#undef RECORD
static scree_status check_turn(const scree_reader *r, const void *record) {
  const scree_plan_turn *t = record;
  return scree_plan_check_direction(r, &t->place, "axis", t->axis);
}
static const scree_plan_turn turn_defaults = {{0}, {0, 0, 1}, 0};
static const scree_record turn_record =
    SCREE_RECORD("a turn", turn_fields, turn_defaults, check_turn);

#define RECORD scree_plan_disc
static const scree_field disc_fields[] = {
    REAL(radius, 1e-9, 1e6, "m", ""),
    VECTOR(normal, 0, 0, "", ""),
};
#undef RECORD
static scree_status check_disc(const scree_reader *r, const void *record) {
  const scree_plan_disc *d = record;
  if (!given(&d->radius)) return scree_fail_place(r, &d->place, "needs a radius");
  return scree_plan_check_direction(r, &d->place, "normal", d->normal);
}
static const scree_plan_disc disc_defaults = {{0}, {0, 0, 1}, NAN};
static const scree_record disc_record =
    SCREE_RECORD("a disc", disc_fields, disc_defaults, check_disc);

#define RECORD scree_plan_cylinder
static const scree_field cylinder_fields[] = {
    REAL(radius, 1e-9, 1e6, "m",
         "inside; of geometry with layers in it not given: as wide as what they pour will be high"),
    REAL(length, 0, 1e6, "m", "along the axis; of geometry 0: endless"),
    VECTOR(axis, 0, 0, "", ""),
    VECTOR(at, -1e6, 1e6, "m", "of a region: the middle of the end it begins at"),
};
#undef RECORD
static scree_status check_cylinder(const scree_reader *r, const void *record) {
  const scree_plan_cylinder *c = record;
  return scree_plan_check_direction(r, &c->place, "axis", c->axis);
}
static const scree_plan_cylinder cylinder_defaults = {{0}, NONE, {0, 0, 1}, NAN, 0};
const scree_record scree_plan_cylinder_record =
    SCREE_RECORD("a cylinder", cylinder_fields, cylinder_defaults, check_cylinder);

#define RECORD scree_plan_box
static const scree_field box_fields[] = {
    VECTOR(min, -1e6, 1e6, "m", "corner"),
    VECTOR(max, -1e6, 1e6, "m", "opposite corner"),
};
#undef RECORD
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
const scree_record scree_plan_box_record =
    SCREE_RECORD("a box", box_fields, box_defaults, check_box);

#define RECORD scree_plan_shaft
static const scree_field shaft_fields[] = {
    REAL(width, 1e-9, 1e6, "m",
         "inside, along x; with layers in it not given: as wide as what they pour will be high"),
    REAL(depth, 1e-9, 1e6, "m", "along y; not given: the width"),
};
#undef RECORD
static const scree_plan_shaft shaft_defaults = {{0}, NAN, NAN};
static const scree_record shaft_record =
    SCREE_RECORD("a shaft", shaft_fields, shaft_defaults, NULL);

scree_status scree_plan_check_window(const scree_reader *r, const scree_place *place, double from,
                                     double until) {
  if (!given(&until) || from < until) return SCREE_OK;
  return scree_fail_place(r, place, "until %g s must be after from %g s", until, from);
}

/* ---- geometry, whole ---- */

#define RECORD scree_plan_geometry
static const scree_field geometry_fields[] = {
    TEXTS(file, "a mesh, or several that move together"),
    VECTOR(box, 1e-9, 1e6, "m", "three sides, about `at`"),
    VECTOR(plane, 0, 0, "", "normal, out of the solid"),
    GROUP(disc, "", &disc_record),
    GROUP(cylinder, "a sheet from `at` along its axis", &scree_plan_cylinder_record),
    GROUP(shaft, "four endless walls about z", &shaft_record),
    GROUP(loop, "a sheet round two wheels, one of them at `at`", &scree_plan_loop_record),
    GROUP(screw, "a flight on a shaft", &scree_plan_screw_record),
    GROUP(sieve, "a plate with round holes, flat or bent", &scree_plan_sieve_record),
    WORD(unit, SCREE_PLAN_UNITS, "of the file's lengths"),
    VECTOR(at, -1e6, 1e6, "m", "where its origin goes"),
    GROUP(turn, "about its origin, before it goes there", &turn_record),
    WORD(side, "auto|outside|inside|both",
         "of a closed mesh or box: where bodies are; auto: where the inlets are"),
    TEXT(material, ""),
    GROUP(copies, "of it, about an axis or along a chain", &scree_plan_copies_record),
    LIST(motion, "in this order", &scree_plan_motion_record),
    GROUP(slide, "moved by forces along a direction", &scree_plan_slide_record),
    GROUP(hinge, "turned by forces about an axis", &scree_plan_hinge_record),
    VECTOR(surface_velocity, -1e3, 1e3, "m/s", "of a belt that stays where it is"),
    GROUP(belt, "of a file or loop that is closed about an axis: its surface runs round",
          &scree_plan_belt_record),
};
#undef RECORD
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
static const scree_record geometry_record =
    SCREE_RECORD("geometry", geometry_fields, geometry_defaults, check_geometry);

/* ---- inlets and outlets ---- */

#define RECORD scree_plan_layers
static const scree_field layers_fields[] = {
    WORD(packed, "random|grid",
         "as many as random places hold, or one in every cell of a square grid"),
    REAL(pack_time, 0, 1e6, "s",
         "in which all enter; not given: each layer as the one before has made room by falling"),
    TEXT(in, "a cylinder or shaft that they fill, in place of a box or cylinder of their own"),
    WORD(begin, "heap|top", "in it: from near its bottom, or above where all will lie loosely"),
    REAL(bottom, 0, 1e6, "m", "from near its bottom: height of the first; not given: as `above`"),
    REAL(above, 0, 1e3, "m", "the highest body, at least"),
    REAL(clearance, 0, 1e3, "m",
         "kept free around a body; not given: half a hundredth of the mean size"),
};
#undef RECORD
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
static const scree_record layers_record =
    SCREE_RECORD("layers", layers_fields, layers_defaults, check_layers);

#define RECORD scree_plan_inlet
static const scree_field inlet_fields[] = {
    GROUP(box, "bodies begin wholly inside", &scree_plan_box_record),
    GROUP(cylinder, "likewise", &scree_plan_cylinder_record),
    WEIGHTS(shapes, 0, 1e12, "", "and their shares by number"),
    REAL(rate, 0, 1e9, "1/s", "bodies a second"),
    REAL(mass_rate, 0, 1e9, "kg/s", "or mass a second"),
    COUNT(count, 1, 1e9, "at most so many; without a rate as soon as there is room"),
    WINDOW(scree_plan_inlet),
    VECTOR(velocity, -1e3, 1e3, "m/s", "on entering"),
    WORD(orientation, "random|fixed", "fixed: axes as in the shape's file"),
    GROUP(
        layers,
        "batches, each above all that is there; the region is what they cover and where they begin",
        &layers_record),
};
#undef RECORD
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
static const scree_record inlet_record =
    SCREE_RECORD("an inlet", inlet_fields, inlet_defaults, check_inlet);

#define RECORD scree_plan_outlet
static const scree_field outlet_fields[] = {
    GROUP(box, "bodies whose centre is inside are taken out", &scree_plan_box_record),
    WINDOW(scree_plan_outlet),
};
#undef RECORD
static scree_status check_outlet(const scree_reader *r, const void *record) {
  const scree_plan_outlet *o = record;
  if (!o->box) return scree_fail_place(r, &o->place, "needs a box: {min: ..., max: ...}");
  return scree_plan_check_window(r, &o->place, o->from, o->until);
}
static const scree_plan_outlet outlet_defaults = {.until = NAN};
static const scree_record outlet_record =
    SCREE_RECORD("an outlet", outlet_fields, outlet_defaults, check_outlet);

#define RECORD scree_plan_domain
static const scree_field domain_fields[] = {
    VECTOR(min, -1e9, 1e9, "m", "corner"),
    VECTOR(max, -1e9, 1e9, "m", "opposite corner"),
    TEXTS(periodic, "axes along which what leaves enters again"),
};
#undef RECORD
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
static const scree_record domain_record =
    SCREE_RECORD("the domain", domain_fields, domain_defaults, check_domain);

/* ---- the rest ---- */

#define RECORD scree_plan_contact
static const scree_field contact_fields[] = {
    WORD(law, "linear|hysteretic|hertz", "docs/background/physics.md"),
    REAL(steps, 15, 1e6, "", "time steps in a quarter of the fastest contact's period"),
    REAL(stiffness_factor, 1e-9, 1e9, "",
         "multiplies every stiffness: below 1 steps are longer and overlaps deeper"),
    REAL(tangential_ratio, 1e-6, 1, "", "tangential over normal stiffness"),
    REAL(time_step, 0, 1, "s", "0: by steps"),
};
#undef RECORD
static const scree_plan_contact contact_defaults = {{0}, 0, 20, 1, 1, 0};
static const scree_record contact_record =
    SCREE_RECORD("contact", contact_fields, contact_defaults, NULL);

static const scree_field bodies_fields[] = {
    {"file", SCREE_FIELD_TEXT, offsetof(scree_plan_bodies, file), 0, 0, "",
     "a table with a line for each", NULL},
};
static scree_status check_bodies(const scree_reader *r, const void *record) {
  const scree_plan_bodies *b = record;
  return b->file ? SCREE_OK : scree_fail_place(r, &b->place, "needs a file");
}
static const scree_plan_bodies bodies_defaults = {{0}, NULL};
static const scree_record bodies_record =
    SCREE_RECORD("bodies", bodies_fields, bodies_defaults, check_bodies);

#define RECORD scree_plan_stop
static const scree_field stop_fields[] = {
    REAL(still, 0, 1e9, "J", "all have entered and move with less energy a body"),
    REAL(rest, 0, 1e9, "s", "for so long; not given: for ten ticks"),
    REAL(filled, 0, 1e9, "s", "so long after all have entered"),
    FLAG(empty, "all have entered and left"),
    REAL(after, 0, 1e9, "s", "not before"),
};
#undef RECORD
static const scree_plan_stop stop_defaults = {{0}, NAN, NAN, NAN, 0, false};
static const scree_record stop_record = SCREE_RECORD("stop", stop_fields, stop_defaults, NULL);

#define RECORD scree_plan_phase
static const scree_field phase_fields[] = {
    REAL(time, 0, 1e9, "s", "it lasts, at most"),
    FLAG(filled, "it lasts until all have entered, however long"),
    REAL(still, 0, 1e9, "J", "it ends early when all move with less energy a body"),
    REAL(rest, 0, 1e9, "s", "for so long"),
    FLAG(early, "false: `still` does not end it"),
    TEXT(clear, "a geometry: it ends early only when that is above all bodies"),
};
#undef RECORD
static scree_status check_phase(const scree_reader *r, const void *record) {
  const scree_plan_phase *p = record;
  if (!given(&p->time)) return scree_fail_place(r, &p->place, "needs a time");
  if (p->clear && !given(&p->still))
    return scree_fail_place(r, &p->place, "clear says when `still` may end it: give still too");
  return SCREE_OK;
}
static const scree_plan_phase phase_defaults = {{0}, NAN, NAN, 0.1, false, true, NULL};
static const scree_record phase_record =
    SCREE_RECORD("a phase", phase_fields, phase_defaults, check_phase);

#define RECORD scree_plan_output
static const scree_field output_fields[] = {
    REAL(frames, 0, 1e9, "s", "between files for ParaView; 0: none"),
    WORD(bodies, "instances|surfaces",
         "of files for ParaView: a point for each, and each shape once; or all their triangles"),
    REAL(series, 1e-9, 1e9, "s", "between the lines of series.csv"),
    REAL(motion, 0, 1e9, "s", "between moments of report.html; 0: a 240th of the time"),
    REAL(checkpoint, 0.01, 1e9, "s", "of the clock"),
};
#undef RECORD
static const scree_plan_output output_defaults = {{0}, 0, 0.01, 60, 0, 0};
static const scree_record output_record =
    SCREE_RECORD("output", output_fields, output_defaults, NULL);

/* ---- names for what is set together ---- */

#define RECORD scree_scene_parameter
static const scree_field parameter_fields[] = {
    TEXT(name, ""),
    TEXTS(sets, "fields; * is every name of a group"),
    REAL(factor, -1e9, 1e9, "", "times the value"),
    REAL(least, -1e300, 1e300, "", "of the value"),
    REAL(most, -1e300, 1e300, "", ""),
    REAL(below, 1e-9, 1e3, "m", "where the largest shape is smaller, the fields shrink"),
    REAL(power, 0, 10, "",
         "of the share of that size that they shrink by; 0, once they are set: they do not"),
};
#undef RECORD
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
static const scree_record parameter_record =
    SCREE_RECORD("a parameter", parameter_fields, parameter_defaults, check_parameter);

#define RECORD scree_plan_preset
static const scree_field preset_fields[] = {
    TEXT(name, ""),
    TEXT(about, ""),
    VALUES(set, "values of parameters and fields"),
};
#undef RECORD
static scree_status check_preset(const scree_reader *r, const void *record) {
  const scree_plan_preset *p = record;
  return p->name ? SCREE_OK : scree_fail_place(r, &p->place, "needs a name");
}
static const scree_plan_preset preset_defaults = {.name = NULL};
static const scree_record preset_record =
    SCREE_RECORD("a preset", preset_fields, preset_defaults, check_preset);

#define RECORD scree_plan
static const scree_field plan_fields[] = {
    TEXT(title, ""),
    TEXT(preset, "of those below, whose values it has"),
    REAL(time, 1e-9, 1e9, "s", "simulated, at most"),
    SEED(seed, "of places, orientations and order"),
    VECTOR(gravity, -1e3, 1e3, "m/s2", ""),
    COUNT(tick, 1, 1e6,
          "steps between looks at inlets, outlets, flows and the end; not given: by the bodies' "
          "size"),
    GROUP(contact, "", &contact_record),
    NAMED(materials, "", &material_record),
    LIST(pairs, "", &pair_record),
    NAMED(shapes, "", &shape_record),
    NAMED(geometry, "", &geometry_record),
    GROUP(bodies, "that are there from the start", &bodies_record),
    NAMED(inlets, "", &inlet_record),
    NAMED(outlets, "", &outlet_record),
    GROUP(domain, "what leaves it is taken out", &domain_record),
    NAMED(sensors, "", &scree_plan_sensor_record),
    NAMED(forces, "on bodies", &scree_plan_force_record),
    NAMED(phases, "follow each other; after the last the scene ends", &phase_record),
    GROUP(stop, "what ends it before its time", &stop_record),
    GROUP(output, "", &output_record),
    LIST(parameters, "names for fields set together", &parameter_record),
    LIST(presets, "values for many", &preset_record),
};
#undef RECORD

static const scree_plan plan_defaults = {.time = NAN, .seed = 1, .gravity = {0, 0, -9.81}};
const scree_record scree_plan_record =
    SCREE_RECORD("a scene", plan_fields, plan_defaults, scree_plan_check);

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
