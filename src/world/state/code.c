/* Checkpoints. All of the world's state goes through one list of fields per record (base/codec.h),
 * which serves saving and loading alike. What follows from other state is made anew: features and
 * trees of particles, the sides of pairs by body; scratch and timings start empty.
 *
 * The file: a seal (base/seal.h), then options, materials, particles, walls, bodies, pairs,
 * counters. A length and a checksum find accidents; counts, indices and kinds are checked besides,
 * so that no file whatever leads outside an array. Bodies, walls and materials are added through
 * the public functions, with their checks, before the saved bits replace what these set up. */
#include "world/state/code.h"

#include "base/alloc.h"

#include <string.h>

const scree_seal scree_world_seal = {"screeWLD", "checkpoint of a scree world", "world", 23};

/* Whoever changes these records must add the fields below, and raise the version. */
_Static_assert(sizeof(void *) != 8 ||
                   (sizeof(scree_feature_pair) == 128 && sizeof(scree_anchor) == 56 &&
                    sizeof(scree_sleeping_feature) == 24 && sizeof(scree_pair) == 832 &&
                    sizeof(scree_neighbours) == 288 && sizeof(scree_frame) == 192 &&
                    sizeof(scree_sphere_contact) == 128),
               "a field was added: add it to the checkpoint");

/* A kind or small number, at most `most`. */
static uint32_t coded(scree_codec *c, uint32_t value, uint32_t most) {
  scree_code_u32(c, &value);
  if (value > most) c->failed = true;
  return value;
}

void scree_code_options(scree_codec *c, scree_world_options *o) {
  scree_code_reals(c, o->gravity, 3);
  o->law = (scree_law)coded(c, (uint32_t)o->law, UINT32_MAX);
  o->rolling = (scree_rolling)coded(c, (uint32_t)o->rolling, SCREE_ROLLING_EPSD);
  CODE_EACH(c, double, &o->steps_per_contact, &o->time_step, &o->stiffness_factor,
            &o->tangential_ratio, &o->size, &o->smoothing, &o->sharing, &o->overlap_limit, &o->skin,
            &o->floor_height);
  scree_code_reals(c, o->period, 3);
  scree_code_reals(c, o->period_from, 3);
}

void scree_code_measures(scree_codec *c, scree_particle_measures *m) {
  m->kind = (scree_particle_kind)coded(c, (uint32_t)m->kind, SCREE_PARTICLE_CLUMP);
  CODE_EACH(c, double, &m->volume, &m->size);
  scree_code_reals(c, m->centre, 3);
  scree_code_reals(c, m->orientation, 4);
  scree_code_reals(c, m->inertia, 3);
  CODE_EACH(c, double, &m->bounding_radius, &m->thickness, &m->rounding);
}

/* When loading, *mesh is filled and is to be freed, whatever comes. */
void scree_code_mesh(scree_codec *c, scree_mesh *mesh) {
  scree_code_count(c, &mesh->vertex_count, 3 * sizeof(double));
  scree_code_count(c, &mesh->triangle_count, 3 * sizeof(uint32_t));
  if (c->loading) {
    mesh->positions = scree_alloc(3 * mesh->vertex_count, sizeof *mesh->positions);
    mesh->triangles = scree_alloc(3 * mesh->triangle_count, sizeof *mesh->triangles);
    if (!mesh->positions || !mesh->triangles) {
      c->out_of_memory = true;
      return;
    }
    memset(mesh->triangles, 0, 3 * mesh->triangle_count * sizeof *mesh->triangles);
  }
  scree_code_reals(c, mesh->positions, 3 * mesh->vertex_count);
  for (size_t i = 0; i < 3 * mesh->triangle_count; i++) scree_code_u32(c, &mesh->triangles[i]);
}

void scree_code_given_wall(scree_codec *c, scree_wall *w) {
  w->kind = (scree_wall_kind)coded(c, (uint32_t)w->kind, SCREE_WALL_MESH);
  w->material = coded(c, (uint32_t)w->material, UINT32_MAX);
  scree_code_bool(c, &w->two_sided);
  scree_code_reals(c, w->position, 3);
  scree_code_reals(c, w->axis, 3);
  scree_code_real(c, &w->radius);
  scree_code_real(c, &w->length);
  scree_code_reals(c, w->velocity, 3);
  scree_code_reals(c, w->angular_velocity, 3);
  scree_code_reals(c, w->surface_velocity, 3);
  scree_code_reals(c, w->surface_angular_velocity, 3);
  scree_code_reals(c, w->surface_loop, 3);
}

void scree_code_wall_motion(scree_codec *c, scree_motion_state *m) {
  m->law = coded(c, m->law, SCREE_MOTION_CRANK);
  scree_code_bool(c, &m->turns);
  CODE_EACH(c, vec3, &m->axis, &m->through, &m->span);
  CODE_EACH(c, double, &m->speed, &m->amplitude, &m->frequency, &m->phase, &m->rod, &m->radius,
            &m->start, &m->from, &m->until, &m->origin);
  scree_code_count(c, &m->row_count, 3 * sizeof(double));
  bool table = m->law == SCREE_MOTION_POSITIONS || m->law == SCREE_MOTION_SPEEDS;
  if (table != (m->row_count > 0)) c->failed = true;
}

void scree_code_wall_state(scree_codec *c, scree_world_wall *w) {
  CODE_REALS(c, &w->frame);
  CODE_REALS(c, &w->orientation);
  CODE_EACH(c, double, &w->travel, &w->path, &w->path_at_build, &w->reach, &w->slack);
  CODE_EACH(c, vec3, &w->force, &w->torque, &w->surface_velocity, &w->surface_spin,
            &w->surface_loop, &w->start_position);
  CODE_REALS(c, &w->start_orientation);
  CODE_EACH(c, double, &w->power, &w->energy);
  scree_code_count(c, &w->motion_count, 8 * sizeof(double));
}

/* Memory that has come to nothing is saved as such: whether a world has been saved in between does
 * not show. */
static void code_further(scree_codec *c, scree_feature_pair *i, scree_further *further) {
  bool any = false;
  for (int k = 0; k < SCREE_ANCHORS - 1; k++) {
    scree_anchor *own = &further->anchor[k], none = {0};
    CODE_REALS(c, c->loading || (i->notched && own->weight > 0) ? own : &none);
    any = any || (c->loading && own->weight > 0);
  }
  if (c->loading) i->notched = any;
}

void scree_code_feature(scree_codec *c, scree_feature_pair *i, scree_further *further) {
  const uint32_t kind = coded(c, i->kind, SCREE_FEATURE_POINT_WALL);
  if (c->loading) i->kind = (uint8_t)kind;
  scree_code_u32(c, &i->a);
  scree_code_u32(c, &i->b);
  uint32_t state = kind == SCREE_FEATURE_EDGE_EDGE
                       ? i->crossing
                       : i->face_count | (uint32_t)(i->side + 1) << 8 | (uint32_t)i->sheet << 16;
  scree_code_u32(c, &state);
  if (c->loading && kind == SCREE_FEATURE_EDGE_EDGE) i->crossing = state;
  if (c->loading && kind != SCREE_FEATURE_EDGE_EDGE) {
    i->face_count = (uint8_t)state;
    i->side = (int8_t)((int)(state >> 8 & 255) - 1);
    i->sheet = (uint16_t)(state >> 16);
  }
  for (int k = 0; k < SCREE_CACHED_FACES; k++) scree_code_u32(c, &i->face[k]);
  scree_code_real(c, &i->valid);
  scree_code_vec3(c, &i->reference);
  scree_code_real(c, &i->gap);
  scree_code_bool(c, &i->has_reference);
  scree_code_bool(c, &i->inside);
  CODE_REALS(c, &i->anchor);
  code_further(c, i, further);
}

static void code_floats(scree_codec *c, float *numbers, int count) {
  for (int i = 0; i < count; i++) {
    double number = numbers[i];
    scree_code_real(c, &number);
    numbers[i] = (float)number;
  }
}

static void code_watch(scree_codec *c, scree_watch *w) {
  scree_code_real(c, &w->due);
  scree_code_vec3(c, &w->at);
  code_floats(c, w->turned, 4);
  code_floats(c, w->came, 3);
  code_floats(c, &w->speed, 1);
  code_floats(c, &w->since, 1);
  for (int i = 0; i < SCREE_INNER_PLACES; i++)
    w->through[i] = (uint8_t)coded(c, w->through[i], UINT32_MAX);
  scree_code_bool(c, &w->taken);
}

void scree_code_sleeping(scree_codec *c, scree_sleeping_feature *s) {
  scree_code_real(c, &s->wake);
  scree_code_u32(c, &s->a);
  scree_code_u32(c, &s->b);
  scree_code_u32(c, &s->kind);
}

void scree_code_pair_name(scree_codec *c, scree_neighbours *n) {
  scree_code_u32(c, &n->a);
  scree_code_u32(c, &n->b);
  scree_code_bool(c, &n->wall);
}

void scree_code_pair_state(scree_codec *c, scree_pair *p, scree_neighbours *n) {
  scree_code_bool(c, &p->asleep);
  scree_code_bool(c, &p->touching);
  scree_code_bool(c, &p->depenetrating);
  scree_code_bool(c, &p->was_depenetrating);
  scree_code_bool(c, &p->substeps.followed);
  CODE_REALS(c, &n->law);
  CODE_REALS(c, &p->list);
  CODE_EACH(c, double, &n->wake, &n->asleep_since, &p->contact.elastic,
            &p->contact.tangential_elastic, &p->history.age, &p->contact.overlap,
            &p->history.largest, &p->depth, &p->book.kick, &p->substeps.foreseen, &p->apart.found,
            &p->book.later_dashpot, &p->book.later_tangential);
  code_floats(c, &p->substeps.elastic_since, 1);
  code_floats(c, &p->contact.belt_power, 1);
  CODE_EACH(c, vec3, &p->history.rolled, &p->apart.direction, &p->apart.place);
  CODE_EACH(c, scree_pair_wrench, &p->contact.wrench, &p->substeps.owed, &p->substeps.ahead);
  code_watch(c, &p->watch);
  p->substeps.count = (uint8_t)coded(c, p->substeps.count, SCREE_MOST_SUBSTEPS);
  if (p->substeps.count < 1) c->failed = true;
  CODE_REALS(c, &p->book.spring);
  scree_kept_wrench *kept[] = {&p->book.dashpot, &p->book.tangential, &p->substeps.others[0],
                               &p->substeps.others[1]};
  for (int i = 0; i < 4; i++) code_floats(c, (float *)kept[i], 6);
  uint64_t contacts = p->contact.count;
  scree_code_u64(c, &contacts);
  p->contact.count = (uint32_t)contacts;
  size_t active = p->active.count, sleeping = n->sleeping.count;
  scree_code_count(c, &active, 242);
  scree_code_count(c, &sleeping, 20);
  if (active > UINT32_MAX / 2 || sleeping > UINT32_MAX / 2) c->failed = true;
  p->active.count = (uint32_t)active;
  n->sleeping.count = (uint32_t)sleeping;
  scree_code_vec3(c, &n->asleep_at);
  CODE_REALS(c, &n->asleep_turned);
}

void scree_code_sphere_pair(scree_codec *c, scree_sphere_pair *two, scree_sphere_contact *contact) {
  bool known = two->contact != scree_none;
  scree_code_u32(c, &two->a);
  scree_code_u32(c, &two->b);
  scree_code_bool(c, &known);
  if (c->loading) two->contact = known ? 0 : scree_none;
  if (!known) return;
  scree_code_vec3(c, &contact->slid);
  CODE_EACH(c, double, &contact->overlap, &contact->largest, &contact->dashpot,
            &contact->tangential, &contact->kick);
  float *const vectors[] = {contact->normal, contact->rubs, contact->couple, contact->rolled};
  for (int i = 0; i < 4; i++) code_floats(c, vectors[i], 3);
  float *const numbers[] = {&contact->damps, &contact->springs, &contact->age};
  for (int i = 0; i < 3; i++) code_floats(c, numbers[i], 1);
}

void scree_code_body(scree_codec *c, const scree_world *world, size_t body) {
  const scree_bodies *b = &world->bodies;
  CODE_REALS(c, &b->frame[body]);
  CODE_REALS(c, &b->orientation[body]);
  CODE_EACH(c, vec3, &b->momentum[body], &b->inertia[body], &b->force[body], &b->torque[body]);
  CODE_EACH(c, double, &b->mass[body], &b->travel[body], &b->path[body],
            &world->list.body_path_at_build[body]);
  scree_code_bool(c, &b->removed[body]);
  CODE_REALS(c, &b->balance[body]);
}

void scree_code_tail(scree_codec *c, scree_world_tail *t) {
  CODE_EACH(c, double, &t->time, &t->time_step, &t->largest_overlap, &t->margin);
  scree_code_u64(c, &t->step_count);
  scree_code_u64(c, &t->depenetration_count);
  scree_code_bool(c, &t->pairs_stale);
  scree_code_bool(c, &t->time_step_stale);
  scree_code_bool(c, &t->diverged);
  scree_code_u32(c, &t->failure);
  scree_code_bytes(c, t->message, sizeof t->message);
  if (t->failure >= SCREE_STATUS_COUNT || (t->diverged && !t->failure)) c->failed = true;
  t->message[sizeof t->message - 1] = 0;
}

void scree_code_hardening(scree_codec *c, scree_hardening *h) {
  scree_code_u32(c, &h->count);
  scree_code_u64(c, &h->deepest);
  scree_code_u64(c, &h->missing);
}
