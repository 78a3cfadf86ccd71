/* 3MF (3MF Core Specification 1.3; Production Extension 1.1): a zip archive of XML parts. Objects
 * are meshes or made of other objects; what the build of the first part names is placed. XML is
 * read by expat while it is inflated, so that no part is held whole.
 *
 * A model names the extensions without which it cannot be understood: those that change no shape
 * are passed over, the others refused by name (Core, 2.3.2). What slicers keep beside the objects
 * and do not print (modifiers, supports) or cut away (negative volumes) is left out and told; it
 * stands in settings of their own: ranges of triangles (PrusaSlicer) or parts of an object (Bambu
 * Studio, OrcaSlicer). */
#include "mesh/io/model_3mf.h"

#include "mesh/io/write.h"

#include <string.h>

enum { MOST_DEPTH = 32, MOST_PLACED = 1 << 16, MOST_VOLUMES = 4096 };

/* ---- Slicers' settings ---- */

static scree_3mf_role role_named(const char *name) {
  static const struct {
    const char *name;
    scree_3mf_role role;
  } names[] = {{"ModelPart", SCREE_3MF_SOLID},         {"normal_part", SCREE_3MF_SOLID},
               {"NegativeVolume", SCREE_3MF_NEGATIVE}, {"negative_part", SCREE_3MF_NEGATIVE},
               {"SupportBlocker", SCREE_3MF_SUPPORT},  {"support_blocker", SCREE_3MF_SUPPORT},
               {"SupportEnforcer", SCREE_3MF_SUPPORT}, {"support_enforcer", SCREE_3MF_SUPPORT}};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!strcmp(name, names[i].name)) return names[i].role;
  return SCREE_3MF_MODIFIER;
}

/* The last one, now that all of it is read. */
static void drop_solids(scree_3mf *m) {
  if (m->volumes.count && m->volumes.items[m->volumes.count - 1].role == SCREE_3MF_SOLID)
    m->volumes.count--;
}

static void start_setting(void *context, const char *name, const char **attributes) {
  scree_3mf_parse *p = context;
  scree_3mf *m = p->model;
  const char *id = scree_3mf_attribute(attributes, "id"),
             *first = scree_3mf_attribute(attributes, "firstid"),
             *last = scree_3mf_attribute(attributes, "lastid"),
             *key = scree_3mf_attribute(attributes, "key"),
             *value = scree_3mf_attribute(attributes, "value"),
             *subtype = scree_3mf_attribute(attributes, "subtype");
  if (!strcmp(name, "object") && id) p->object_id = scree_3mf_id(id);
  scree_3mf_volume v = {.object_id = p->object_id};
  bool is_volume = !strcmp(name, "volume") && first && last, is_part = !strcmp(name, "part");
  if (is_volume) v.first = scree_3mf_id(first), v.last = scree_3mf_id(last);
  if (is_part && id) v.is_component = true, v.first = scree_3mf_id(id);
  if (is_part && subtype) v.role = role_named(subtype);
  if (is_volume || (is_part && id)) {
    drop_solids(m);
    if (m->volumes.count == MOST_VOLUMES || !SCREE_PUSH(&m->volumes, v)) scree_3mf_stop_memory(p);
  }
  if (strcmp(name, "metadata") != 0 || !key || !value || !m->volumes.count) return;
  scree_3mf_volume *open = &m->volumes.items[m->volumes.count - 1];
  if (!strcmp(key, "volume_type")) open->role = role_named(value);
  if (!strcmp(key, "modifier") && !strcmp(value, "1")) open->role = SCREE_3MF_MODIFIER;
}

/* Volumes that are no solids mark their triangles. */
static void mark_volumes(scree_3mf *m) {
  for (size_t i = 0; i < m->volumes.count; i++) {
    const scree_3mf_volume *v = &m->volumes.items[i];
    const scree_3mf_object *o =
        v->role && !v->is_component ? scree_3mf_find(m, 0, v->object_id) : NULL;
    if (!o || v->first >= o->triangle_count) continue;
    m->left_out[v->role]++;
    for (size_t t = v->first; t <= v->last && t < o->triangle_count; t++)
      m->triangles.items[o->first_triangle + t].role = v->role;
  }
}

static scree_3mf_role role_of_component(const scree_3mf *m, uint32_t object_id, uint32_t inner_id) {
  for (size_t i = 0; i < m->volumes.count; i++) {
    const scree_3mf_volume *v = &m->volumes.items[i];
    if (v->is_component && v->object_id == object_id && v->first == inner_id) return v->role;
  }
  return SCREE_3MF_SOLID;
}

/* ---- Placing ---- */

typedef struct placing {
  scree_reading *r;
  scree_3mf *model;
  scree_placed placed;
  size_t count;
} placing;

static scree_status place_mesh(placing *p, const scree_3mf_object *o, const scree_affine *where) {
  const scree_3mf *m = p->model;
  size_t first = p->placed.positions.count / 3;
  bool is_mirrored = scree_affine_mirrors(where);
  if (o->vertex_count == 0) return SCREE_OK;
  SCREE_TRY(scree_placed_add(p->r, &p->placed, where, m->vertices.items + o->first_vertex,
                             o->vertex_count / 3));
  for (size_t i = 0; i < o->triangle_count; i++) {
    const scree_3mf_triangle *t = &m->triangles.items[o->first_triangle + i];
    if (t->role == SCREE_3MF_SOLID)
      SCREE_TRY(scree_placed_add_triangle(p->r, &p->placed, first, t->corner, is_mirrored));
  }
  return SCREE_OK;
}

static scree_status place(placing *p, const scree_3mf_component *c, const scree_affine *outer,
                          int depth) {
  scree_3mf *m = p->model;
  const scree_3mf_object *o = scree_3mf_find(m, c->part, c->object_id);
  if (!o)
    return scree_reading_fail(p->r, SCREE_BAD_FILE,
                              "as 3MF: object %u, which is placed, is not in %s", c->object_id,
                              m->parts.items[c->part].name);
  if (depth > MOST_DEPTH || ++p->count > MOST_PLACED)
    return scree_reading_fail(p->r, SCREE_LIMIT,
                              "as 3MF: objects lie more than %d deep in each other, or are placed "
                              "more than %d times",
                              MOST_DEPTH, MOST_PLACED);
  if (o->is_support) {
    m->left_out[SCREE_3MF_SUPPORT]++;
    return SCREE_OK;
  }
  scree_affine where = scree_affine_in(outer, &c->where);
  SCREE_TRY(place_mesh(p, o, &where));
  for (size_t i = 0; i < o->component_count; i++) {
    const scree_3mf_component *inner = &m->components.items[o->first_component + i];
    scree_3mf_role role = role_of_component(m, o->id, inner->object_id);
    if (role)
      m->left_out[role]++;
    else
      SCREE_TRY(place(p, inner, &where, depth + 1));
  }
  return SCREE_OK;
}

static void tell_left_out(scree_reading *r, const scree_3mf *m) {
  const size_t *counts = m->left_out;
  size_t negative = counts[SCREE_3MF_NEGATIVE],
         others = counts[SCREE_3MF_MODIFIER] + counts[SCREE_3MF_SUPPORT];
  if (negative)
    SCREE_ADD_TEXT(r->scan->warning,
                   "%zu negative volume%s left out: what the slicer cuts away is there", negative,
                   negative == 1 ? " is" : "s are");
  if (others)
    SCREE_ADD_TEXT(r->scan->warning, "%s%zu modifier%s or support%s left out", negative ? "; " : "",
                   others, others == 1 ? "" : "s", others == 1 ? " is" : "s are");
  if (m->unprinted)
    SCREE_ADD_TEXT(r->scan->warning, "%s%zu item%s not to be printed %s left out",
                   negative || others ? "; " : "", m->unprinted, m->unprinted == 1 ? "" : "s",
                   m->unprinted == 1 ? "is" : "are");
  if (m->unread)
    SCREE_ADD_TEXT(r->scan->warning, "%sits %s, which it can do without, is not read",
                   *r->scan->warning ? "; " : "", m->unread);
}

static scree_status place_build(scree_reading *r, scree_3mf *m) {
  placing p = {.r = r, .model = m};
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < m->items.count; i++) m->unprinted += m->items.items[i].is_unprinted;
  bool none_printed = m->unprinted == m->items.count; /* all that there is, then */
  if (none_printed) m->unprinted = 0;
  for (size_t i = 0; i < m->items.count && status == SCREE_OK; i++)
    if ((none_printed || !m->items.items[i].is_unprinted) && scree_placed_wants(r, NULL))
      status = place(&p, &m->items.items[i], &scree_affine_none, 0);
  if (status == SCREE_OK) status = scree_placed_weld(r, &p.placed);
  if (status == SCREE_OK) tell_left_out(r, m);
  scree_placed_free(&p.placed);
  return status;
}

/* ---- All of it ---- */

static void start_relation(void *context, const char *name, const char **attributes) {
  scree_3mf_parse *p = context;
  static const char kind[] = "/3dmodel";
  const char *type = scree_3mf_attribute(attributes, "Type"),
             *target = scree_3mf_attribute(attributes, "Target");
  size_t length = type ? strlen(type) : 0, tail = sizeof kind - 1;
  (void)name;
  if (target && length > tail && !strcmp(type + length - tail, kind) && !p->model->parts.count)
    (void)scree_3mf_part_index(p, target);
}

static scree_status read_parts(scree_reading *r, scree_3mf *m) {
  static const char *const settings[] = {"Metadata/Slic3r_PE_model.config",
                                         "Metadata/model_settings.config"};
  scree_3mf_parse p = {.model = m, .start = start_relation, .part_name = "_rels/.rels"};
  SCREE_TRY(scree_3mf_parse_part(r, &p, false));
  if (m->parts.count == 0) {
    scree_3mf_part root = {"3D/3dmodel.model"};
    if (!SCREE_PUSH(&m->parts, root)) return scree_fail_memory(r->error, sizeof root, "a part");
  }
  for (size_t i = 0; i < m->parts.count; i++) SCREE_TRY(scree_3mf_read_part(r, m, i));
  for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
    p = (scree_3mf_parse){.model = m, .start = start_setting, .part_name = settings[i]};
    SCREE_TRY(scree_3mf_parse_part(r, &p, false));
  }
  return SCREE_OK;
}

scree_status scree_read_3mf(scree_reading *r) {
  SCREE_CLEANUP(scree_3mf_free) scree_3mf m = {.unit_name = "millimeter"};
  snprintf(r->scan->format, sizeof r->scan->format, "3MF");
  SCREE_TRY(read_parts(r, &m));
  r->unit_m = scree_3mf_unit_m(m.unit_name);
  r->scan->states_unit = true;
  snprintf(r->scan->format, sizeof r->scan->format, "3MF, %s", m.unit_name);
  mark_volumes(&m);
  return place_build(r, &m);
}
