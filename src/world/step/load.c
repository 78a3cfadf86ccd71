/* Checkpoints are read (state/code.c has what is in them). */
#include "world/broad/broad.h"
#include "world/broad/spheres.h"
#include "world/state/code.h"
#include "world/state/joints.h"
#include "world/state/pairs.h"
#include "world/state/parameters.h"
#include "world/state/scratch.h"
#include "world/state/walls.h"
#include "world/step/checkpoint.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/file.h"

#include <string.h>

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
    scree_code_wall_motion(&l->codec, &motion);
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
  scree_code_options(c, &options);
  if (good(l)) scree_world_create(&options, &l->world, &l->error);
  scree_code_count(c, &count, 4 * sizeof(double));
  for (size_t i = 0; i < count && good(l); i++) {
    scree_material material = {0};
    CODE_REALS(c, &material);
    if (good(l)) scree_world_add_material(l->world, &material, NULL, &l->error);
  }
  for (size_t i = 0; i < count && good(l); i++)
    for (size_t j = 0; j <= i; j++) {
      CODE_REALS(c, &l->world->materials.contacts[i][j]);
      l->world->materials.contacts[j][i] = l->world->materials.contacts[i][j];
    }
  scree_code_count(c, &count, 64);
  for (size_t w = 0; w < count && good(l); w++) {
    scree_wall given = {0};
    scree_mesh mesh = {0};
    scree_code_given_wall(c, &given);
    if (given.kind == SCREE_WALL_MESH) scree_code_mesh(c, &mesh);
    given.mesh = &mesh;
    if (good(l)) scree_world_add_wall(l->world, &given, NULL, &l->error);
    if (good(l)) {
      scree_world_wall *wall = &l->world->walls.items[w];
      scree_code_wall_state(c, wall);
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
  scree_code_measures(&l->codec, &measures);
  if (measures.kind != SCREE_PARTICLE_MESH) {
    load_clump(l, &measures, particle);
    return;
  }
  scree_mesh mesh = {0};
  scree_code_mesh(&l->codec, &mesh);
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
    scree_code_body(&l->codec, l->world, i);
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
  scree_neighbours *n = &world->list.neighbours.items[pair->neighbours];
  for (;;) {
    scree_take_in_hand(&l->scratch, &world->pools, pair, n);
    if (scree_reserve_features(&l->scratch, pair, active) &&
        scree_reserve_sleeping(&l->scratch, sleeping))
      return true;
    if (!scree_pools_grow(&world->pools, world->pairs.items, world->pairs.count,
                          world->list.neighbours.items, world->list.neighbours.count))
      return false;
  }
}

static void load_features(loader *l, scree_pair *pair) {
  scree_range *sleeping_features = &l->world->list.neighbours.items[pair->neighbours].sleeping;
  uint32_t active = pair->active.count, sleeping = sleeping_features->count;
  pair->active.count = sleeping_features->count = 0;
  bool awake = active > 0 || (pair->spheres && pair->touching) || pair->depth > 0 ||
               pair->depenetrating || pair->substeps.count > 1;
  if ((pair->asleep || pair->touching) && pair->asleep == awake) l->codec.failed = true;
  if (!good(l)) return;
  if (!make_room(l, pair, active, sleeping)) l->codec.out_of_memory = true;
  for (uint32_t i = 0; i < active && good(l); i++) {
    scree_feature_pair *feature = &l->scratch.features[i];
    *feature = (scree_feature_pair){0};
    l->scratch.further[i] = (scree_further){0};
    scree_code_feature(&l->codec, feature, &l->scratch.further[i]);
    if (!is_feature(l, pair, feature)) l->codec.failed = true;
    pair->active.count++;
  }
  for (uint32_t i = 0; i < sleeping && good(l); i++) {
    scree_sleeping_feature s = {0};
    scree_code_sleeping(&l->codec, &s);
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
  scree_neighbours *n = &world->list.neighbours.items[k];
  scree_pair *pair = &world->pairs.items[index];
  scree_pair_begin(pair, n, k);
  scree_code_pair_state(&l->codec, pair, n);
  CODE_REALS(&l->codec, &world->list.ledger.items[k]);
  load_features(l, pair);
  pair->law = n->law;
  if (scree_pair_stays_awake(pair)) {
    world->list.pair_of.items[k] = index;
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
  if (!SCREE_RESERVE(&world->list.neighbours, count) ||
      !SCREE_RESERVE(&world->list.pair_of, count) || !SCREE_RESERVE(&world->list.ledger, count))
    l->codec.out_of_memory = true;
  for (uint32_t k = 0; k < count && good(l); k++) {
    scree_neighbours name = {0};
    scree_code_pair_name(&l->codec, &name);
    bool known =
        name.a < world->bodies.count &&
        (name.wall ? name.b < world->walls.count : name.a < name.b && name.b < world->bodies.count);
    if (!known || !follows(k ? &world->list.neighbours.items[k - 1] : NULL, &name))
      l->codec.failed = true;
    if (!good(l)) return;
    if (atomic_load(&world->spare_pairs.count) == 0 && !scree_pairs_grow(world)) {
      l->codec.out_of_memory = true;
      return;
    }
    world->list.neighbours.items[k] = scree_neighbours_new(world, name.a, name.b, name.wall);
    world->list.pair_of.items[k] = scree_none;
    world->list.neighbours.count++;
    load_pair(l, k, scree_pair_take(world));
  }
}

/* The order of spheres, each once. */
static void load_order(loader *l) {
  scree_world *world = l->world;
  scree_sphere_list *list = &world->spheres.list;
  size_t count = 0;
  scree_code_count(&l->codec, &count, 4);
  if (count > world->bodies.count) l->codec.failed = true;
  if (!good(l) || world->bodies.count == 0 || scree_spheres_reserve(world, &l->error)) return;
  list->body_count = world->bodies.count;
  for (size_t i = 0; i < list->body_count; i++) list->place_of[i] = scree_none;
  for (; list->count < count && good(l); list->count++) {
    uint32_t body = 0;
    scree_code_u32(&l->codec, &body);
    if (body >= list->body_count || list->place_of[body] != scree_none ||
        world->bodies.particle[body]->measures.kind != SCREE_PARTICLE_SPHERE) {
      l->codec.failed = true;
      return;
    }
    list->body[list->count] = body;
    list->place_of[body] = (uint32_t)list->count;
  }
}

/* Pairs come sorted by a, then b, and none twice. */
static void load_spheres(loader *l) {
  load_order(l);
  scree_sphere_list *list = &l->world->spheres.list;
  size_t count = 0, at = 0;
  if (good(l)) scree_code_count(&l->codec, &count, 9);
  if (good(l) && !scree_spheres_reserve_pairs(l->world, count)) l->codec.out_of_memory = true;
  for (uint32_t k = 0; k < count && good(l); k++) {
    scree_sphere_pair *two = &list->pairs.items[k], *last = k ? two - 1 : NULL;
    scree_code_sphere_pair(&l->codec, two, &list->contacts.items[k]);
    const bool follows = !last || last->a < two->a || (last->a == two->a && last->b < two->b);
    if (!follows || two->a >= two->b || two->b >= list->count) l->codec.failed = true;
    if (!good(l)) return;
    for (; at <= two->a; at++) list->begin[at] = k;
    list->pairs.count = k + 1;
  }
  for (; list->begin && at <= list->count; at++) list->begin[at] = (uint32_t)list->pairs.count;
  if (good(l)) scree_spheres_restore(l->world, &l->error);
}

static void load_joints(loader *l) {
  scree_joints_code(&l->codec, l->world);
}

static void load_tail(loader *l) {
  scree_world *world = l->world;
  scree_world_tail tail = {0};
  scree_code_tail(&l->codec, &tail);
  for (size_t i = 0; i < scree_hardening_count(world); i++)
    scree_code_hardening(&l->codec, &world->materials.hardened[i]);
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
  world->list.stale = tail.pairs_stale;
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
  return l->codec.failed ? scree_seal_refuse(&l->codec, &scree_world_seal, name, error) : SCREE_OK;
}

scree_status scree_world_unpack(const unsigned char *bytes, size_t byte_count, const char *name,
                                scree_world **world, scree_error *error) {
  loader l = {.codec = {.source = bytes, .count = byte_count, .loading = true}};
  scree_status status = scree_seal_check(&l.codec, &scree_world_seal, name, error);
  if (status) return status;
  void (*const stages[])(loader *) = {load_setup, load_particles, load_bodies, load_joints,
                                      load_pairs, load_spheres,   load_tail};
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
