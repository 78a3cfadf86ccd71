/* The fields of a scene in tables, and what fields must be together. */
#include "scene/region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

static scree_status check_fracture(const scree_reader *r, const void *record) {
  const scree_plan_fracture *f = record;
  if (isnan(f->tension)) return scree_fail_place(r, &f->place, "needs tension, the strength in Pa");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_fracture, SCREE_PLAN_FRACTURE, "a fracture", NULL, check_fracture)

static scree_status check_strengths(const scree_reader *r, const void *record) {
  const scree_plan_joints *j = record;
  for (size_t k = 0; k < j->pairs.count; k++)
    if (j->pairs.items[k].between.count != 2)
      return scree_fail_place(r, &j->pairs.items[k].place, "needs between: [part, part]");
  if (isnan(j->tension)) return scree_fail_place(r, &j->place, "needs tension, the strength in Pa");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_joined, SCREE_PLAN_JOINED, "a pair of parts", NULL, NULL)
SCREE_RECORD_TABLE(scree_plan_joints, SCREE_PLAN_JOINTS, "joints", NULL, check_strengths)
SCREE_RECORD_TABLE(scree_plan_point, SCREE_PLAN_POINT, "a point", "at: [x, y, z]", NULL)

static scree_status check_cable(const scree_reader *r, const void *record) {
  const scree_plan_cable *c = record;
  if (isnan(c->diameter) || c->path.count < 2)
    return scree_fail_place(r, &c->place, "needs a diameter and a path of two points or more");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_cable, SCREE_PLAN_CABLE, "a cable", NULL, check_cable)
SCREE_RECORD_TABLE(scree_plan_component, SCREE_PLAN_COMPONENT, "a part", NULL, NULL)

/* Shapes that break or come apart. */
static scree_status check_joints(const scree_reader *r, const scree_plan_shape *s) {
  if (given(&s->thickness) && !s->file)
    return scree_fail_place(r, &s->place, "thickness is of a file's open surface");
  if (s->parts.count > 0 && !s->joints)
    return scree_fail_place(r, &s->place, "has parts: give joints, what holds them");
  if (s->joints && s->fracture)
    return scree_fail_place(r, &s->fracture->place,
                            "the shape has joints between parts: give fracture to a part");
  if (s->joints && (s->size || s->rp || scree_plan_spheres(s)))
    return scree_fail_place(r, &s->place, "size, rp and a number of spheres are not for parts");
  if (s->cable && !s->joints)
    return scree_fail_place(r, &s->place, "a cable needs joints, with the tension that it bears");
  if (s->joints && !s->file && !s->parts.count && !s->clump && !s->cable)
    return scree_fail_place(r, &s->joints->place,
                            "needs parts, a file that names them, or spheres");
  for (size_t k = 0; k < s->parts.count; k++) {
    const scree_plan_component *c = &s->parts.items[k];
    const bool there[] = {c->file != NULL, c->sample != NULL, given(c->box)};
    if (!s->file) SCREE_TRY(scree_plan_one_of(r, &c->place, there, 3, "file, sample, box"));
    if (s->file && (there[0] || there[1] || there[2]))
      return scree_fail_place(r, &c->place, "its surface is in the shape's file: %.100s", s->file);
  }
  return SCREE_OK;
}

static scree_status check_shape(const scree_reader *r, const void *record) {
  const scree_plan_shape *s = record;
  bool table = s->clump && !is_number(s->clump);
  if (s->clump && !table && !s->file && !s->sample && !given(s->box))
    return scree_fail_place(r, &s->place,
                            "clump %.20s: so many spheres stand for a file, sample or box: give it",
                            s->clump);
  const bool there[] = {s->file != NULL, s->sample != NULL, given(&s->sphere),
                        table,           given(s->box),     s->parts.count > 0 && !s->file,
                        s->cable != NULL};
  bool none = true;
  SCREE_TRY(check_joints(r, s));
  for (int i = 0; i < 7; i++) none = none && !there[i];
  if (s->size && none) return SCREE_OK; /* spheres */
  if (s->size && given(&s->sphere))
    return scree_fail_place(r, &s->place,
                            "size is of a file, sample, clump or box; alone, of spheres");
  scree_status status = scree_plan_one_of(
      r, &s->place, there, 7, "file, sample, sphere (its diameter), clump, box, parts, cable");
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
  SCREE_TRY(scree_region_check(r, &SCREE_REGION_OF(i), true));
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
  SCREE_TRY(scree_plan_check_corners(r, &d->place, d->min, d->max));
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
  SCREE_TRY(scree_plan_one_of(r, &f->place, there, 4, "force, acceleration, per_volume, drag"));
  if (f->box && f->cylinder)
    return scree_fail_place(r, &f->place, "only one of box, cylinder may be given");
  SCREE_TRY(scree_region_check(r, &SCREE_REGION_OF(f), false));
  return scree_plan_check_window(r, &f->place, f->from, f->until);
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
  if ((given(&p->below) || given(&p->size)) != given(&p->power))
    return scree_fail_place(r, &p->place, "below or size, and power, go together");
  for (const double *power = &p->power; power; power = power == &p->power ? &p->scales : NULL)
    if (!isnan(*power) && 2 * *power != floor(2 * *power))
      return scree_fail_place(r, &p->place, "power %g: must be a whole number, or half of one",
                              *power);
  return SCREE_OK;
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
