/* Checkpoints. All of the world's state goes through one list of fields per record (base/codec.h),
 * which serves saving and loading alike. What follows from other state is made anew: features and
 * trees of particles, the sides of pairs by body; scratch and timings start empty.
 *
 * The file: a seal (base/seal.h), then options, materials, particles, walls, bodies, pairs,
 * counters. A length and a checksum find accidents; counts, indices and kinds are checked besides,
 * so that no file whatever leads outside an array. Bodies, walls and materials are added through
 * the public functions, with their checks, before the saved bits replace what these set up. */
#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"
#include "base/seal.h"
#include "world/backend.h"
#include "world/broad.h"
#include "world/checkpoint.h"
#include "world/contact.h"
#include "world/pairs.h"
#include "world/walls.h"

#include <stdlib.h>
#include <string.h>

static const scree_seal seal = {"screeWLD", "checkpoint of a scree world", "world", 20};

/* Whoever changes these records must add the fields below, and raise the version. */
_Static_assert(sizeof(void *) != 8 ||
                   (sizeof(scree_feature_pair) == 128 && sizeof(scree_anchor) == 56 &&
                    sizeof(scree_sleeping_feature) == 24 && sizeof(scree_pair) == 832 &&
                    sizeof(scree_neighbours) == 280 && sizeof(scree_frame) == 192),
               "a field was added: add it to the checkpoint");

/* ---- field lists ---- */

/* A record of real numbers alone, in the order of its fields. */
#define CODE_REALS(codec, record)                                                                  \
  scree_code_reals(codec, (double *)(record), sizeof *(record) / sizeof(double))

/* Such records one after another. */
#define CODE_EACH(codec, type, ...)                                                                \
  do {                                                                                             \
    type *const each[] = {__VA_ARGS__};                                                            \
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) CODE_REALS(codec, each[i]);            \
  } while (0)

/* A kind or small number, at most `most`. */
static uint32_t coded(scree_codec *c, uint32_t value, uint32_t most) {
  scree_code_u32(c, &value);
  if (value > most) c->failed = true;
  return value;
}

static void code_options(scree_codec *c, scree_world_options *o) {
  scree_code_reals(c, o->gravity, 3);
  o->law = (scree_law)coded(c, (uint32_t)o->law, UINT32_MAX);
  CODE_EACH(c, double, &o->steps_per_contact, &o->time_step, &o->stiffness_factor,
            &o->tangential_ratio, &o->size, &o->smoothing, &o->sharing, &o->overlap_limit, &o->skin,
            &o->floor_height);
  scree_code_reals(c, o->period, 3);
  scree_code_reals(c, o->period_from, 3);
}

static void code_measures(scree_codec *c, scree_particle_measures *m) {
  m->kind = (scree_particle_kind)coded(c, (uint32_t)m->kind, SCREE_PARTICLE_CLUMP);
  CODE_EACH(c, double, &m->volume, &m->size);
  scree_code_reals(c, m->centre, 3);
  scree_code_reals(c, m->orientation, 4);
  scree_code_reals(c, m->inertia, 3);
  CODE_EACH(c, double, &m->bounding_radius, &m->thickness, &m->rounding);
}

/* When loading, *mesh is filled and is to be freed, whatever comes. */
static void code_mesh(scree_codec *c, scree_mesh *mesh) {
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

static void code_given_wall(scree_codec *c, scree_wall *w) {
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

static void code_wall_motion(scree_codec *c, scree_motion_state *m) {
  m->law = coded(c, m->law, SCREE_MOTION_CRANK);
  scree_code_bool(c, &m->turns);
  CODE_EACH(c, vec3, &m->axis, &m->through, &m->span);
  CODE_EACH(c, double, &m->speed, &m->amplitude, &m->frequency, &m->phase, &m->rod, &m->radius,
            &m->start, &m->from, &m->until, &m->origin);
  scree_code_count(c, &m->row_count, 3 * sizeof(double));
  bool table = m->law == SCREE_MOTION_POSITIONS || m->law == SCREE_MOTION_SPEEDS;
  if (table != (m->row_count > 0)) c->failed = true;
}

static void code_wall_state(scree_codec *c, scree_world_wall *w) {
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

static void code_feature(scree_codec *c, scree_feature_pair *i, scree_further *further) {
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

static void code_sleeping(scree_codec *c, scree_sleeping_feature *s) {
  scree_code_real(c, &s->wake);
  scree_code_u32(c, &s->a);
  scree_code_u32(c, &s->b);
  scree_code_u32(c, &s->kind);
}

static void code_pair_name(scree_codec *c, scree_neighbours *n) {
  scree_code_u32(c, &n->a);
  scree_code_u32(c, &n->b);
  scree_code_bool(c, &n->wall);
}

static void code_pair_state(scree_codec *c, scree_pair *p, scree_neighbours *n) {
  scree_code_bool(c, &p->asleep);
  scree_code_bool(c, &p->touching);
  scree_code_bool(c, &p->depenetrating);
  scree_code_bool(c, &p->was_depenetrating);
  scree_code_bool(c, &p->followed);
  CODE_REALS(c, &n->law);
  CODE_REALS(c, &p->list);
  CODE_EACH(c, double, &n->wake, &n->asleep_since, &p->elastic, &p->tangential_elastic, &p->age,
            &p->overlap, &p->largest, &p->depth, &p->kick, &p->foreseen, &p->found,
            &p->later_dashpot, &p->later_tangential);
  code_floats(c, &p->elastic_since, 1);
  code_floats(c, &p->belt_power, 1);
  CODE_EACH(c, vec3, &p->rolled, &p->separation, &p->pushed);
  CODE_EACH(c, scree_pair_wrench, &p->wrench, &p->owed, &p->ahead);
  code_watch(c, &p->watch);
  p->substeps = (uint8_t)coded(c, p->substeps, SCREE_MOST_SUBSTEPS);
  if (p->substeps < 1) c->failed = true;
  CODE_REALS(c, &p->spring);
  scree_kept_wrench *kept[] = {&p->dashpot, &p->tangential, &p->others[0], &p->others[1]};
  for (int i = 0; i < 4; i++) code_floats(c, (float *)kept[i], 6);
  uint64_t contacts = p->contact_count;
  scree_code_u64(c, &contacts);
  p->contact_count = (uint32_t)contacts;
  size_t active = p->active.count, sleeping = n->sleeping.count;
  scree_code_count(c, &active, 242);
  scree_code_count(c, &sleeping, 20);
  if (active > UINT32_MAX / 2 || sleeping > UINT32_MAX / 2) c->failed = true;
  p->active.count = (uint32_t)active;
  n->sleeping.count = (uint32_t)sleeping;
  scree_code_vec3(c, &n->asleep_at);
  CODE_REALS(c, &n->asleep_turned);
}

static void code_body(scree_codec *c, const scree_world *world, size_t body) {
  const scree_bodies *b = &world->bodies;
  CODE_REALS(c, &b->frame[body]);
  CODE_REALS(c, &b->orientation[body]);
  CODE_EACH(c, vec3, &b->momentum[body], &b->inertia[body], &b->force[body], &b->torque[body]);
  CODE_EACH(c, double, &b->mass[body], &b->travel[body], &b->path[body],
            &world->body_path_at_build[body]);
  scree_code_bool(c, &b->removed[body]);
  CODE_REALS(c, &b->balance[body]);
}

/* What the world counts, and how it ended. */
typedef struct tail_record {
  double time, time_step, largest_overlap, margin;
  uint64_t step_count, depenetration_count;
  bool pairs_stale, time_step_stale, diverged;
  uint32_t failure;
  char message[sizeof((scree_error *)0)->message];
} tail_record;

static void code_tail(scree_codec *c, tail_record *t) {
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

/* ---- saving ---- */

static void save_particle(scree_codec *c, const scree_particle *p) {
  scree_particle_measures measures = p->measures;
  code_measures(c, &measures);
  scree_mesh mesh = p->mesh; /* saving only reads it */
  if (measures.kind == SCREE_PARTICLE_MESH) {
    code_mesh(c, &mesh);
    return;
  }
  size_t count = p->point_count;
  scree_code_count(c, &count, 4 * sizeof(double));
  for (size_t i = 0; i < count; i++) {
    vec3 centre = p->points[i];
    double radius = p->point_radii[i];
    scree_code_vec3(c, &centre);
    scree_code_real(c, &radius);
  }
}

typedef struct owner {
  const scree_particle *particle;
  size_t body;
} owner;

static int compare_owners(const void *x, const void *y) {
  const owner *a = x, *b = y;
  if (a->particle != b->particle) return (uintptr_t)a->particle < (uintptr_t)b->particle ? -1 : 1;
  return a->body < b->body ? -1 : a->body > b->body;
}

/* The particles in the order in which bodies first use them, then each body's number: the order of
 * addresses does not show. */
static void save_particles(scree_codec *c, const scree_world *world) {
  size_t count = world->bodies.count, used = 0;
  owner *owners = scree_alloc(count, sizeof *owners);
  size_t *first = scree_alloc(count, sizeof *first);
  uint32_t *number = scree_alloc(count, sizeof *number);
  if (!owners || !first || !number) {
    c->out_of_memory = true;
    goto done;
  }
  for (size_t i = 0; i < count; i++) owners[i] = (owner){world->bodies.particle[i], i};
  qsort(owners, count, sizeof *owners, compare_owners);
  for (size_t i = 0; i < count; i++) {
    bool same = i > 0 && owners[i].particle == owners[i - 1].particle;
    first[owners[i].body] = same ? first[owners[i - 1].body] : owners[i].body;
  }
  for (size_t i = 0; i < count; i++)
    number[i] = first[i] == i ? (uint32_t)used++ : number[first[i]];
  scree_code_count(c, &used, 1);
  for (size_t i = 0; i < count; i++)
    if (first[i] == i) save_particle(c, world->bodies.particle[i]);
  scree_code_count(c, &count, 1);
  for (size_t i = 0; i < count; i++) {
    scree_code_u32(c, &number[i]);
    uint8_t material = world->bodies.material[i];
    scree_code_u8(c, &material);
  }
done:
  scree_free(owners);
  scree_free(first);
  scree_free(number);
}

static void save_setup(scree_codec *c, const scree_world *world) {
  scree_world_options options = world->options;
  code_options(c, &options);
  size_t count = world->material_count;
  scree_code_count(c, &count, 1);
  for (size_t i = 0; i < count; i++) {
    scree_material material = world->materials[i];
    CODE_REALS(c, &material);
  }
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j <= i; j++) {
      scree_material_pair contact = world->contacts[i][j];
      CODE_REALS(c, &contact);
    }
  count = world->walls.count;
  scree_code_count(c, &count, 1);
  for (size_t w = 0; w < count; w++) {
    scree_world_wall wall = world->walls.items[w];
    code_given_wall(c, &wall.given);
    scree_mesh mesh = scree_wall_is_analytic(&wall) ? (scree_mesh){0} : wall.surface->mesh;
    if (wall.given.kind == SCREE_WALL_MESH) code_mesh(c, &mesh);
    code_wall_state(c, &wall);
  }
  for (size_t i = 0; i < world->motions.count; i++) code_wall_motion(c, &world->motions.items[i]);
  for (size_t i = 0; i < world->motion_rows.count; i++) CODE_REALS(c, &world->motion_rows.items[i]);
}

static void save_bodies(scree_codec *c, const scree_world *world) {
  const scree_bodies *b = &world->bodies;
  for (size_t i = 0; i < b->count; i++) code_body(c, world, i);
  bool any = b->applied != NULL;
  scree_code_bool(c, &any);
  for (size_t i = 0; any && i < b->count; i++) CODE_REALS(c, &b->applied[i]);
}

static void save_pairs(scree_codec *c, const scree_world *world, bool contacts) {
  const scree_pools *pools = &world->pools;
  size_t count = contacts ? world->neighbours.count : 0;
  scree_code_count(c, &count, 1);
  for (uint32_t k = 0; k < count; k++) {
    scree_neighbours *n = &world->neighbours.items[k]; /* only read, and so are its lists */
    scree_pair asleep = {0}, *pair = scree_pair_of(world, k);
    if (!pair) scree_pair_begin(pair = &asleep, n, k);
    code_pair_name(c, n);
    code_pair_state(c, pair, n);
    CODE_REALS(c, &world->ledger.items[k]);
    scree_range items = pair->active, sleeping_features = n->sleeping;
    for (uint32_t i = 0; i < items.count; i++)
      code_feature(c, &pools->features[items.first + i], &pools->further[items.first + i]);
    for (uint32_t i = 0; i < sleeping_features.count; i++)
      code_sleeping(c, &pools->sleeping_features[sleeping_features.first + i]);
  }
}

static void save_tail(scree_codec *c, const scree_world *world) {
  tail_record tail = {.time = world->time,
                      .time_step = world->time_step,
                      .largest_overlap = world->largest_overlap,
                      .margin = world->margin,
                      .step_count = world->step_count,
                      .depenetration_count = world->depenetration_count,
                      .pairs_stale = world->pairs_stale,
                      .time_step_stale = world->time_step_stale,
                      .diverged = world->diverged,
                      .failure = world->diverged ? (uint32_t)world->failure.status : 0};
  if (world->diverged) snprintf(tail.message, sizeof tail.message, "%s", world->failure.message);
  code_tail(c, &tail);
}

scree_status scree_world_pack(const scree_world *world, bool contacts, unsigned char **bytes,
                              size_t *byte_count, scree_error *error) {
  SCREE_TRY(scree_world_bring(
      world, contacts ? SCREE_ALL_PARTS : SCREE_ALL_PARTS & ~SCREE_PART_LISTS, error));
  scree_walls_settle(world);
  SCREE_CLEANUP(scree_codec_free) scree_codec c = {0};
  scree_seal_begin(&c);
  save_setup(&c, world);
  save_particles(&c, world);
  save_bodies(&c, world);
  save_pairs(&c, world, contacts);
  save_tail(&c, world);
  SCREE_TRY(scree_seal_end(&c, &seal, error));
  *bytes = c.bytes;
  *byte_count = c.count;
  c.bytes = NULL;
  return SCREE_OK;
}

scree_status scree_world_save(const scree_world *world, const char *path, bool overwrite,
                              scree_error *error) {
  SCREE_CLEANUP(scree_free_at) unsigned char *bytes = NULL;
  size_t count;
  SCREE_TRY(scree_world_pack(world, true, &bytes, &count, error));
  return scree_seal_write(bytes, count, path, overwrite, error);
}

/* ---- loading ---- */

/* A file being loaded; `error` is filled by the first public function that refused something. */
typedef struct loader {
  scree_codec codec;
  scree_world *world;
  scree_particle **particles;
  size_t particle_count;
  scree_scratch scratch; /* where the lists of the pair in hand lie */
  scree_error error;
} loader;

static bool good(const loader *l) {
  return scree_codec_good(&l->codec) && l->error.status == SCREE_OK;
}

/* The motions of all walls, and their tables. */
static void load_motions(loader *l) {
  scree_world *world = l->world;
  size_t motions = 0, rows = 0;
  for (size_t w = 0; good(l) && w < world->walls.count; w++)
    motions += world->walls.items[w].motion_count;
  for (size_t i = 0; i < motions && good(l); i++) {
    scree_motion_state motion = {0};
    code_wall_motion(&l->codec, &motion);
    if (!SCREE_PUSH(&world->motions, motion)) l->codec.out_of_memory = true;
    rows += motion.row_count;
  }
  for (size_t i = 0; i < rows && good(l); i++) {
    scree_motion_row row = {0};
    CODE_REALS(&l->codec, &row);
    if (!SCREE_PUSH(&world->motion_rows, row)) l->codec.out_of_memory = true;
  }
}

static void load_setup(loader *l) {
  scree_codec *c = &l->codec;
  scree_world_options options = {0};
  size_t count = 0;
  code_options(c, &options);
  if (good(l)) scree_world_create(&options, &l->world, &l->error);
  scree_code_count(c, &count, 4 * sizeof(double));
  for (size_t i = 0; i < count && good(l); i++) {
    scree_material material = {0};
    CODE_REALS(c, &material);
    if (good(l)) scree_world_add_material(l->world, &material, NULL, &l->error);
  }
  for (size_t i = 0; i < count && good(l); i++)
    for (size_t j = 0; j <= i; j++) {
      CODE_REALS(c, &l->world->contacts[i][j]);
      l->world->contacts[j][i] = l->world->contacts[i][j];
    }
  scree_code_count(c, &count, 64);
  for (size_t w = 0; w < count && good(l); w++) {
    scree_wall given = {0};
    scree_mesh mesh = {0};
    code_given_wall(c, &given);
    if (given.kind == SCREE_WALL_MESH) code_mesh(c, &mesh);
    given.mesh = &mesh;
    if (good(l)) scree_world_add_wall(l->world, &given, NULL, &l->error);
    if (good(l)) {
      scree_world_wall *wall = &l->world->walls.items[w];
      code_wall_state(c, wall);
    }
    scree_mesh_free(&mesh);
  }
  load_motions(l);
}

static void load_clump(loader *l, const scree_particle_measures *measures,
                       scree_particle **particle) {
  scree_codec *c = &l->codec;
  size_t count = 0;
  scree_code_count(c, &count, 4 * sizeof(double));
  double *centres = scree_alloc(3 * count, sizeof *centres);
  double *radii = scree_alloc(count, sizeof *radii);
  if (!centres || !radii || count == 0)
    *(count ? &c->out_of_memory : &c->failed) = true;
  else
    for (size_t i = 0; i < count; i++) {
      scree_code_reals(c, &centres[3 * i], 3);
      scree_code_real(c, &radii[i]);
      vec3 centre = vec3_load(&centres[3 * i]);
      if (!(isfinite(vec3_norm(centre)) && radii[i] > 0 && isfinite(radii[i]))) c->failed = true;
    }
  if (good(l)) scree_particle_restore(measures, NULL, centres, radii, count, particle, &l->error);
  scree_free(centres);
  scree_free(radii);
}

static void load_particle(loader *l, scree_particle **particle) {
  scree_particle_measures measures = {0};
  code_measures(&l->codec, &measures);
  if (measures.kind != SCREE_PARTICLE_MESH) {
    load_clump(l, &measures, particle);
    return;
  }
  scree_mesh mesh = {0};
  code_mesh(&l->codec, &mesh);
  if (good(l)) scree_particle_restore(&measures, &mesh, NULL, NULL, 0, particle, &l->error);
  scree_mesh_free(&mesh);
}

/* The particles, and the bodies that have them, still at the origin. */
static void load_particles(loader *l) {
  scree_codec *c = &l->codec;
  scree_code_count(c, &l->particle_count, 100);
  l->particles = scree_alloc_zero(l->particle_count, sizeof *l->particles);
  if (!l->particles) c->out_of_memory = true;
  for (size_t i = 0; i < l->particle_count && good(l); i++) load_particle(l, &l->particles[i]);
  size_t count = 0;
  scree_code_count(c, &count, 5);
  for (size_t i = 0; i < count && good(l); i++) {
    uint32_t number = 0;
    uint8_t material = 0;
    scree_code_u32(c, &number);
    scree_code_u8(c, &material);
    if (number >= l->particle_count) c->failed = true;
    if (good(l))
      scree_world_add_body(l->world, l->particles[number], material, NULL, NULL, &l->error);
  }
}

static void load_bodies(loader *l) {
  scree_bodies *b = &l->world->bodies;
  for (size_t i = 0; i < b->count && good(l); i++) {
    code_body(&l->codec, l->world, i);
    const vec3 at = b->frame[i].position; /* its norm may overflow */
    if (!isfinite(at.x) || !isfinite(at.y) || !isfinite(at.z)) l->codec.failed = true;
    b->removed_count += b->removed[i];
  }
  bool any = false;
  scree_code_bool(&l->codec, &any);
  if (any && good(l)) scree_bodies_make_applied(b, &l->error);
  for (size_t i = 0; any && i < b->count && good(l); i++) CODE_REALS(&l->codec, &b->applied[i]);
}

/* Whether a feature pair names features that are there. */
static bool names_features(const loader *l, const scree_pair *pair, uint32_t kind, uint32_t a,
                           uint32_t b) {
  const scree_particle *of_a = l->world->bodies.particle[pair->a],
                       *of_b = scree_pair_shape_b(l->world, pair);
  if (kind == SCREE_FEATURE_POINT_WALL)
    return pair->wall && scree_wall_is_analytic(&l->world->walls.items[pair->b]) &&
           a < of_a->point_count;
  if (!of_b) return false;
  switch (kind) {
  case SCREE_FEATURE_POINT_FACE:
    return of_b->face_count > 0 && a < of_a->point_count;
  case SCREE_FEATURE_FACE_POINT:
    return of_a->face_count > 0 && b < of_b->point_count;
  case SCREE_FEATURE_EDGE_EDGE:
    return a < of_a->edge_count && b < of_b->edge_count;
  case SCREE_FEATURE_POINT_POINT:
    return a < of_a->point_count && b < of_b->point_count;
  default:
    return false;
  }
}

static bool is_feature(const loader *l, const scree_pair *pair, const scree_feature_pair *feature) {
  if (!names_features(l, pair, feature->kind, feature->a, feature->b)) return false;
  if (feature->kind == SCREE_FEATURE_EDGE_EDGE) return feature->crossing <= SCREE_CROSSING_REFUSED;
  if (feature->face_count > SCREE_CACHED_FACES || feature->side < -1 || feature->side > 1)
    return false;
  const scree_particle *surface = feature->kind == SCREE_FEATURE_FACE_POINT
                                      ? l->world->bodies.particle[pair->a]
                                      : scree_pair_shape_b(l->world, pair);
  for (uint32_t k = 0; k < feature->face_count; k++)
    if (!surface || feature->face[k] >= surface->face_count) return false;
  return true;
}

/* Room for the lists of the pair in hand. */
static bool make_room(loader *l, scree_pair *pair, uint32_t active, uint32_t sleeping) {
  scree_world *world = l->world;
  scree_neighbours *n = &world->neighbours.items[pair->neighbours];
  for (;;) {
    scree_take_in_hand(&l->scratch, &world->pools, pair, n);
    if (scree_reserve_features(&l->scratch, pair, active) &&
        scree_reserve_sleeping(&l->scratch, sleeping))
      return true;
    if (!scree_pools_grow(&world->pools, world->pairs.items, world->pairs.count,
                          world->neighbours.items, world->neighbours.count))
      return false;
  }
}

static void load_features(loader *l, scree_pair *pair) {
  scree_range *sleeping_features = &l->world->neighbours.items[pair->neighbours].sleeping;
  uint32_t active = pair->active.count, sleeping = sleeping_features->count;
  pair->active.count = sleeping_features->count = 0;
  bool awake = active > 0 || (pair->spheres && pair->touching) || pair->depth > 0 ||
               pair->depenetrating || pair->substeps > 1;
  if ((pair->asleep || pair->touching) && pair->asleep == awake) l->codec.failed = true;
  if (!good(l)) return;
  if (!make_room(l, pair, active, sleeping)) l->codec.out_of_memory = true;
  for (uint32_t i = 0; i < active && good(l); i++) {
    scree_feature_pair *feature = &l->scratch.features[i];
    *feature = (scree_feature_pair){0};
    l->scratch.further[i] = (scree_further){0};
    code_feature(&l->codec, feature, &l->scratch.further[i]);
    if (!is_feature(l, pair, feature)) l->codec.failed = true;
    pair->active.count++;
  }
  for (uint32_t i = 0; i < sleeping && good(l); i++) {
    scree_sleeping_feature s = {0};
    code_sleeping(&l->codec, &s);
    if (!names_features(l, pair, s.kind, s.a, s.b)) l->codec.failed = true;
    scree_sleeping_features(&l->scratch)[sleeping_features->count++] = s;
  }
}

/* Pairs come sorted by a, bodies before walls, then b, and none twice. */
static bool follows(const scree_neighbours *last, const scree_neighbours *next) {
  if (!last) return true;
  if (last->a != next->a) return last->a < next->a;
  if (last->wall != next->wall) return next->wall;
  return last->b < next->b;
}

static void load_pair(loader *l, uint32_t k, uint32_t index) {
  scree_world *world = l->world;
  scree_neighbours *n = &world->neighbours.items[k];
  scree_pair *pair = &world->pairs.items[index];
  scree_pair_begin(pair, n, k);
  code_pair_state(&l->codec, pair, n);
  CODE_REALS(&l->codec, &world->ledger.items[k]);
  load_features(l, pair);
  pair->law = n->law;
  if (scree_pair_stays_awake(pair)) {
    world->pair_of.items[k] = index;
  } else {
    scree_pair_end(pair, n);
    scree_pair_give_back(world, index);
  }
}

static void load_pairs(loader *l) {
  scree_world *world = l->world;
  size_t count = 0;
  scree_code_count(&l->codec, &count, 484);
  if (count >= scree_none) l->codec.failed = true;
  if (!SCREE_RESERVE(&world->neighbours, count) || !SCREE_RESERVE(&world->pair_of, count) ||
      !SCREE_RESERVE(&world->ledger, count))
    l->codec.out_of_memory = true;
  for (uint32_t k = 0; k < count && good(l); k++) {
    scree_neighbours name = {0};
    code_pair_name(&l->codec, &name);
    bool known =
        name.a < world->bodies.count &&
        (name.wall ? name.b < world->walls.count : name.a < name.b && name.b < world->bodies.count);
    if (!known || !follows(k ? &world->neighbours.items[k - 1] : NULL, &name))
      l->codec.failed = true;
    if (!good(l)) return;
    if (atomic_load(&world->spare_pairs.count) == 0 && !scree_pairs_grow(world)) {
      l->codec.out_of_memory = true;
      return;
    }
    world->neighbours.items[k] = scree_neighbours_new(world, name.a, name.b, name.wall);
    world->pair_of.items[k] = scree_none;
    world->neighbours.count++;
    load_pair(l, k, scree_pair_take(world));
  }
}

static void load_tail(loader *l) {
  scree_world *world = l->world;
  tail_record tail = {0};
  code_tail(&l->codec, &tail);
  if (l->codec.position != l->codec.count) l->codec.failed = true;
  if (!good(l) || scree_broad_restore(world, tail.margin, &l->error)) return;
  world->time = tail.time;
  world->time_step = tail.time_step;
  world->largest_overlap = tail.largest_overlap;
  world->step_count = tail.step_count;
  for (size_t w = 0; w < world->walls.count; w++) {
    world->walls.items[w].summed = tail.step_count;
    world->walls.items[w].work = scree_wall_work(world, w);
  }
  world->depenetration_count = tail.depenetration_count;
  world->pairs_stale = tail.pairs_stale;
  world->time_step_stale = tail.time_step_stale;
  world->diverged = tail.diverged;
  world->failure.status = (scree_status)tail.failure;
  memcpy(world->failure.message, tail.message, sizeof tail.message);
}

static scree_status finish(loader *l, const char *name, scree_error *error) {
  if (l->codec.out_of_memory || l->error.status == SCREE_OUT_OF_MEMORY)
    return scree_fail_memory(error, l->codec.count, "a checkpoint's world");
  if (l->error.status)
    return scree_fail(error, SCREE_BAD_FILE, "%s: byte %zu: %.900s", name, l->codec.position,
                      l->error.message);
  return l->codec.failed ? scree_seal_refuse(&l->codec, &seal, name, error) : SCREE_OK;
}

scree_status scree_world_unpack(const unsigned char *bytes, size_t byte_count, const char *name,
                                scree_world **world, scree_error *error) {
  loader l = {.codec = {.source = bytes, .count = byte_count, .loading = true}};
  scree_status status = scree_seal_check(&l.codec, &seal, name, error);
  if (status) return status;
  void (*const stages[])(loader *) = {load_setup, load_particles, load_bodies, load_pairs,
                                      load_tail};
  for (size_t i = 0; i < sizeof stages / sizeof *stages && good(&l); i++) stages[i](&l);
  for (size_t i = 0; l.particles && i < l.particle_count; i++) scree_particle_free(l.particles[i]);
  scree_free(l.particles);
  status = finish(&l, name, error);
  if (status)
    scree_world_free(l.world);
  else
    *world = l.world;
  return status;
}

scree_status scree_world_save_block(scree_codec *codec, const scree_world *world, bool contacts,
                                    scree_error *error) {
  unsigned char *bytes;
  size_t count;
  scree_status status = scree_world_pack(world, contacts, &bytes, &count, error);
  if (status) return status;
  scree_code_count(codec, &count, 1);
  scree_code_bytes(codec, bytes, count);
  scree_free(bytes);
  return SCREE_OK;
}

scree_status scree_world_load_block(scree_codec *codec, const char *name, scree_world **world,
                                    scree_error *error) {
  size_t count = 0;
  scree_code_count(codec, &count, 1);
  if (!scree_codec_good(codec))
    return scree_fail(error, SCREE_BAD_FILE, "%s: byte %zu: too few bytes for a world", name,
                      codec->position);
  codec->position += count;
  return scree_world_unpack(codec->source + codec->position - count, count, name, world, error);
}

scree_status scree_world_load(const char *path, scree_world **world, scree_error *error) {
  char *bytes;
  size_t count;
  scree_status status = scree_file_read(path, 0, &bytes, &count, error);
  if (status) return status;
  status = scree_world_unpack((const unsigned char *)bytes, count, path, world, error);
  scree_free(bytes);
  return status;
}
