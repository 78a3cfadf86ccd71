/* Checkpoints are written (code.c has what is in them). */
#include "world/state/save.h"
#include "world/state/code.h"
#include "world/state/joints.h"
#include "world/state/pairs.h"
#include "world/state/remote.h"
#include "world/state/walls.h"

#include "base/alloc.h"

#include <stdlib.h>
#include <string.h>

static void save_particle(scree_codec *c, const scree_particle *p) {
  scree_particle_measures measures = p->measures;
  scree_code_measures(c, &measures);
  scree_mesh mesh = p->mesh; /* saving only reads it */
  if (measures.kind == SCREE_PARTICLE_MESH) {
    scree_code_mesh(c, &mesh);
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
  scree_code_options(c, &options);
  size_t count = world->materials.count;
  scree_code_count(c, &count, 1);
  for (size_t i = 0; i < count; i++) {
    scree_material material = world->materials.items[i];
    CODE_REALS(c, &material);
  }
  for (size_t i = 0; i < count; i++)
    for (size_t j = 0; j <= i; j++) {
      scree_material_pair contact = world->materials.contacts[i][j];
      CODE_REALS(c, &contact);
    }
  count = world->walls.count;
  scree_code_count(c, &count, 1);
  for (size_t w = 0; w < count; w++) {
    scree_world_wall wall = world->walls.items[w];
    scree_code_given_wall(c, &wall.given);
    scree_mesh mesh = scree_wall_is_analytic(&wall) ? (scree_mesh){0} : wall.surface->mesh;
    if (wall.given.kind == SCREE_WALL_MESH) scree_code_mesh(c, &mesh);
    scree_code_wall_state(c, &wall);
  }
  for (size_t i = 0; i < world->motions.count; i++)
    scree_code_wall_motion(c, &world->motions.items[i]);
  for (size_t i = 0; i < world->motion_rows.count; i++) CODE_REALS(c, &world->motion_rows.items[i]);
}

static void save_bodies(scree_codec *c, const scree_world *world) {
  const scree_bodies *b = &world->bodies;
  for (size_t i = 0; i < b->count; i++) scree_code_body(c, world, i);
  bool any = b->applied != NULL;
  scree_code_bool(c, &any);
  for (size_t i = 0; any && i < b->count; i++) CODE_REALS(c, &b->applied[i]);
}

static void save_pairs(scree_codec *c, const scree_world *world, bool contacts) {
  const scree_pools *pools = &world->pools;
  size_t count = contacts ? world->list.neighbours.count : 0;
  scree_code_count(c, &count, 1);
  for (uint32_t k = 0; k < count; k++) {
    scree_neighbours *n = &world->list.neighbours.items[k]; /* only read, and so are its lists */
    scree_pair asleep = {0}, *pair = scree_pair_of(world, k);
    if (!pair) scree_pair_begin(pair = &asleep, n, k);
    scree_code_pair_name(c, n);
    scree_code_pair_state(c, pair, n);
    CODE_REALS(c, &world->list.ledger.items[k]);
    scree_range items = pair->active, sleeping_features = n->sleeping;
    for (uint32_t i = 0; i < items.count; i++)
      scree_code_feature(c, &pools->features[items.first + i], &pools->further[items.first + i]);
    for (uint32_t i = 0; i < sleeping_features.count; i++)
      scree_code_sleeping(c, &pools->sleeping_features[sleeping_features.first + i]);
  }
}

static void save_spheres(scree_codec *c, const scree_world *world, bool contacts) {
  const scree_sphere_list *list = &world->spheres.list;
  size_t spheres = contacts ? list->count : 0, pairs = contacts ? list->pairs.count : 0;
  scree_code_count(c, &spheres, 4);
  for (size_t i = 0; i < spheres; i++) scree_code_u32(c, &list->body[i]);
  scree_code_count(c, &pairs, 9);
  for (size_t k = 0; k < pairs; k++) {
    scree_sphere_pair two = list->pairs.items[k];
    scree_sphere_contact none = {.kick = 0};
    scree_code_sphere_pair(c, &two,
                           two.contact == scree_none
                               ? &none
                               : &list->contacts.items[two.contact & ~scree_sphere_touches]);
  }
}

static void save_tail(scree_codec *c, const scree_world *world) {
  scree_world_tail tail = {.time = world->time,
                           .time_step = world->time_step,
                           .largest_overlap = world->largest_overlap,
                           .margin = world->list.margin,
                           .step_count = world->step_count,
                           .depenetration_count = world->depenetration_count,
                           .pairs_stale = world->list.stale,
                           .time_step_stale = world->time_step_stale,
                           .diverged = world->diverged,
                           .failure = world->diverged ? (uint32_t)world->failure.status : 0};
  if (world->diverged) snprintf(tail.message, sizeof tail.message, "%s", world->failure.message);
  scree_code_tail(c, &tail);
  for (size_t i = 0; i < scree_hardening_count(world); i++) {
    scree_hardening hardening = world->materials.hardened[i];
    scree_code_hardening(c, &hardening);
  }
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
  scree_joints_code(&c, (scree_world *)(uintptr_t)world); /* which only reads it */
  save_pairs(&c, world, contacts);
  save_spheres(&c, world, contacts);
  save_tail(&c, world);
  SCREE_TRY(scree_seal_end(&c, &scree_world_seal, error));
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
