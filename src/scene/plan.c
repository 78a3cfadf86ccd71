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

size_t scree_plan_find(const void *items, size_t count, size_t size, const char *name) {
  for (size_t i = 0; i < count; i++) {
    const scree_place *place = (const void *)((const char *)items + i * size);
    if (!strcmp(place->name, name)) return i;
  }
  return count;
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

/* ---- materials ---- */

SCREE_RECORD_TABLE(scree_plan_material, SCREE_PLAN_MATERIAL, "a material", NULL, NULL)

static scree_status check_pair(const scree_reader *r, const void *record) {
  const scree_plan_pair *p = record;
  if (p->between.count == 2) return SCREE_OK;
  return scree_fail_place(r, &p->place, "needs between: [material, material]");
}
SCREE_RECORD_TABLE(scree_plan_pair, SCREE_PLAN_PAIR, "a pair", NULL, check_pair)

/* ---- shapes ---- */

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
SCREE_RECORD_TABLE(scree_plan_shape, SCREE_PLAN_SHAPE, "a shape", NULL, check_shape)

/* ---- geometry ---- */

SCREE_RECORD_TABLE(scree_plan_turn, SCREE_PLAN_TURN, "a turn", NULL, NULL)

SCREE_RECORD_TABLE(scree_plan_disc, SCREE_PLAN_DISC, "a disc", "a radius", NULL)

SCREE_RECORD_TABLE(scree_plan_cylinder, SCREE_PLAN_CYLINDER, "a cylinder", NULL, NULL)

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
SCREE_RECORD_TABLE(scree_plan_box, SCREE_PLAN_BOX, "a box", NULL, check_box)

SCREE_RECORD_TABLE(scree_plan_shaft, SCREE_PLAN_SHAFT, "a shaft", NULL, NULL)

scree_status scree_plan_check_window(const scree_reader *r, const scree_place *place, double from,
                                     double until) {
  if (!given(&until) || from < until) return SCREE_OK;
  return scree_fail_place(r, place, "until %g s must be after from %g s", until, from);
}

/* ---- geometry, whole ---- */

static scree_status check_geometry(const scree_reader *r, const void *record) {
  const scree_plan_geometry *g = record;
  const bool there[] = {g->file.count > 0, given(g->box),       given(g->plane),
                        g->disc != NULL,   g->cylinder != NULL, g->shaft != NULL,
                        g->loop != NULL,   g->screw != NULL,    g->sieve != NULL};
  SCREE_TRY(scree_plan_one_of(r, &g->place, there, 9,
                              "file, box, plane, disc, cylinder, shaft, loop, screw, sieve"));
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
SCREE_RECORD_TABLE(scree_plan_geometry, SCREE_PLAN_GEOMETRY, "geometry", NULL, check_geometry)

/* ---- inlets and outlets ---- */

static scree_status check_layers(const scree_reader *r, const void *record) {
  const scree_plan_layers *l = record;
  if (!l->packed) return SCREE_OK;
  if (given(&l->clearance))
    return scree_fail_place(r, &l->place, "clearance is of random layers; a grid has its cells");
  if (!given(&l->pack_time)) return SCREE_OK;
  return scree_fail_place(
      r, &l->place, "pack_time is of random layers; those of a grid follow from the velocity");
}
SCREE_RECORD_TABLE(scree_plan_layers, SCREE_PLAN_LAYERS, "layers", NULL, check_layers)

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
SCREE_RECORD_TABLE(scree_plan_inlet, SCREE_PLAN_INLET, "an inlet", NULL, check_inlet)

static scree_status check_outlet(const scree_reader *r, const void *record) {
  const scree_plan_outlet *o = record;
  return scree_plan_check_window(r, &o->place, o->from, o->until);
}
SCREE_RECORD_TABLE(scree_plan_outlet, SCREE_PLAN_OUTLET, "an outlet", "a box: {min: ..., max: ...}",
                   check_outlet)

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
SCREE_RECORD_TABLE(scree_plan_domain, SCREE_PLAN_DOMAIN, "the domain", NULL, check_domain)

/* ---- forces ---- */

SCREE_RECORD_TABLE(scree_plan_drag, SCREE_PLAN_DRAG, "drag",
                   "the density and the viscosity of the fluid", NULL)

static scree_status check_force(const scree_reader *r, const void *record) {
  const scree_plan_force *f = record;
  const bool there[] = {given(f->force), given(f->acceleration), given(f->per_volume),
                        f->drag != NULL};
  scree_status status =
      scree_plan_one_of(r, &f->place, there, 4, "force, acceleration, per_volume, drag");
  if (status == SCREE_OK && f->box && f->cylinder)
    status = scree_fail_place(r, &f->place, "only one of box, cylinder may be given");
  if (status == SCREE_OK && f->cylinder &&
      (!given(&f->cylinder->radius) || !given(f->cylinder->at)))
    status = scree_fail_place(r, &f->cylinder->place, "needs a radius and at: [x, y, z]");
  return status == SCREE_OK ? scree_plan_check_window(r, &f->place, f->from, f->until) : status;
}
SCREE_RECORD_TABLE(scree_plan_force, SCREE_PLAN_FORCE, "a force", NULL, check_force)

/* ---- the rest ---- */

SCREE_RECORD_TABLE(scree_plan_contact, SCREE_PLAN_CONTACT, "contact", NULL, NULL)

SCREE_RECORD_TABLE(scree_plan_bodies, SCREE_PLAN_BODIES, "bodies", "a file", NULL)

SCREE_RECORD_TABLE(scree_plan_stop, SCREE_PLAN_STOP, "stop", NULL, NULL)

static scree_status check_phase(const scree_reader *r, const void *record) {
  const scree_plan_phase *p = record;
  if (p->clear && !given(&p->still))
    return scree_fail_place(r, &p->place, "clear says when `still` may end it: give still too");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_phase, SCREE_PLAN_PHASE, "a phase", "a time", check_phase)

SCREE_RECORD_TABLE(scree_plan_output, SCREE_PLAN_OUTPUT, "output", NULL, NULL)

/* ---- names for what is set together ---- */

static scree_status check_parameter(const scree_reader *r, const void *record) {
  const scree_scene_parameter *p = record;
  if (given(&p->below) != given(&p->power))
    return scree_fail_place(r, &p->place, "below and power go together");
  if (isnan(p->power) || 2 * p->power == floor(2 * p->power)) return SCREE_OK;
  return scree_fail_place(r, &p->place, "power %g: must be a whole number, or half of one",
                          p->power);
}
SCREE_RECORD_TABLE(scree_scene_parameter, SCREE_PLAN_PARAMETER, "a parameter",
                   "a name and sets: [FIELD, ...]", check_parameter)

SCREE_RECORD_TABLE(scree_plan_preset, SCREE_PLAN_PRESET, "a preset", "a name", NULL)

SCREE_RECORD_TABLE(scree_plan, SCREE_PLAN_SCENE, "a scene", NULL, scree_plan_check)

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
  SCREE_TRY(fill_in(reader, &scree_plan_contact_record, (void **)&made.contact));
  SCREE_TRY(fill_in(reader, &scree_plan_stop_record, (void **)&made.stop));
  SCREE_TRY(fill_in(reader, &scree_plan_output_record, (void **)&made.output));
  *plan = made;
  return SCREE_OK;
}
