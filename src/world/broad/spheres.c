/* The lists of spheres: their order in space, who is near whom, and where what they remember has
 * come. The grids find the pairs (grids.c). */
#include "world/broad/spheres.h"
#include "world/broad/broad.h"
#include "world/broad/grids.h"
#include "world/broad/lists.h"
#include "world/state/parameters.h"

#include "base/alloc.h"
#include "base/array.h"
#include "base/radix.h"

#include <string.h>

/* Cells of the order, in margins: two mean sizes. */
static const double cell_margins = 20;
enum { CODE_BITS = 30 };
/* Up to so many kinds of spheres every two have a law in a table, beyond them every pair its own.
 */
enum { MOST_KINDS = 64 };

void scree_spheres_free(scree_world *world) {
  scree_spheres *s = &world->spheres;
  scree_sphere_list *lists[] = {&s->list, &s->old};
  for (int i = 0; i < 2; i++) {
    scree_free(lists[i]->body);
    scree_free(lists[i]->place_of);
    scree_free(lists[i]->begin);
    scree_free(lists[i]->pairs.items);
    scree_free(lists[i]->contacts.items);
  }
  scree_free(s->kind);
  scree_free(s->place);
  scree_free(s->motion);
  scree_free(s->load);
  scree_free(s->blocks.items);
  scree_free(s->blocks.tallies);
  scree_free(s->found.items);
  scree_free(s->shares.items);
  scree_free(s->laws.items);
  scree_free(s->seconds.items);
}

static bool is_listed(const scree_world *world, size_t i) {
  return !world->bodies.removed[i] &&
         world->bodies.particle[i]->measures.kind == SCREE_PARTICLE_SPHERE;
}

bool scree_spheres_are_there(const scree_world *world) {
  size_t count = 0;
  for (size_t i = 0; i < world->bodies.count && count < 2; i++) count += is_listed(world, i);
  return count == 2;
}

scree_status scree_spheres_reserve(scree_world *world, scree_error *error) {
  scree_spheres *s = &world->spheres;
  const size_t n = world->bodies.capacity;
  if (s->capacity >= n) return SCREE_OK;
  const struct {
    void **array;
    size_t size;
  } arrays[] = {{(void **)&s->list.body, sizeof *s->list.body},
                {(void **)&s->list.place_of, sizeof *s->list.place_of},
                {(void **)&s->list.begin, sizeof *s->list.begin},
                {(void **)&s->old.body, sizeof *s->old.body},
                {(void **)&s->old.place_of, sizeof *s->old.place_of},
                {(void **)&s->old.begin, sizeof *s->old.begin},
                {(void **)&s->kind, sizeof *s->kind},
                {(void **)&s->place, sizeof *s->place},
                {(void **)&s->motion, sizeof *s->motion},
                {(void **)&s->load, sizeof *s->load}};
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
    void *moved = scree_resize(*arrays[i].array, n + 1, arrays[i].size);
    if (!moved) return scree_fail_memory(error, n * arrays[i].size, "spheres");
    *arrays[i].array = moved;
  }
  s->capacity = n;
  return SCREE_OK;
}

/* ---- the order ---- */

/* The bits of x in every third place. */
static uint32_t spread(uint32_t x) {
  x &= 1023;
  x = (x | x << 16) & 0x030000FF;
  x = (x | x << 8) & 0x0300F00F;
  x = (x | x << 4) & 0x030C30C3;
  return (x | x << 2) & 0x09249249;
}

/* Far out the curve begins anew, which costs time alone. */
static uint32_t cell_of(double place) {
  const double cell = floor(place);
  return fabs(cell) < 1 << 30 ? (uint32_t)(int32_t)cell : 0;
}

static uint32_t code_of(const scree_world *world, size_t i) {
  const double cell = cell_margins * world->list.margin;
  vec3 p = vec3_scale(scree_world_fold(world, world->bodies.frame[i].position), 1 / cell);
  return spread(cell_of(p.x)) | spread(cell_of(p.y)) << 1 | spread(cell_of(p.z)) << 2;
}

scree_status scree_spheres_order(scree_world *world, scree_error *error) {
  scree_spheres *s = &world->spheres;
  const size_t n = world->bodies.count;
  SCREE_SCRATCH(scree_keyed, codes, 2 * n, error);
  size_t count = 0;
  for (size_t i = 0; i < n; i++)
    if (is_listed(world, i)) codes[count++] = (scree_keyed){code_of(world, i), (uint32_t)i};
  const scree_keyed *sorted = scree_radix_sort(codes, codes + n, count, CODE_BITS);
  scree_sphere_list kept = s->list;
  s->list = s->old;
  s->old = kept;
  scree_sphere_list *list = &s->list;
  list->count = count;
  list->body_count = n;
  list->pairs.count = 0;
  for (size_t i = 0; i < n; i++) list->place_of[i] = scree_none;
  for (size_t p = 0; p < count; p++) {
    list->body[p] = sorted[p].index;
    list->place_of[list->body[p]] = (uint32_t)p;
  }
  return SCREE_OK;
}

/* ---- pairs ---- */

/* Where the seconds of a place begin they are sorted, and become pairs. */
static void list_pairs(scree_world *world, size_t a) {
  scree_sphere_list *list = &world->spheres.list;
  uint32_t begin = list->begin[a], count = list->begin[a + 1] - begin,
           *second = world->spheres.found.items + begin;
  scree_sort_places(second, count);
  for (uint32_t k = 0; k < count; k++)
    list->pairs.items[begin + k] = (scree_sphere_pair){(uint32_t)a, second[k], scree_none, 0};
}

static uint32_t place_in(const scree_sphere_list *list, uint32_t body) {
  return body < list->body_count ? list->place_of[body] : scree_none;
}

/* The pair of two places; NULL: it is not listed. */
static scree_sphere_pair *find_pair(const scree_sphere_list *list, uint32_t a, uint32_t b) {
  uint32_t low = list->begin[a], end = list->begin[a + 1], high = end;
  while (low < high) {
    uint32_t middle = low + (high - low) / 2;
    if (list->pairs.items[middle].b < b)
      low = middle + 1;
    else
      high = middle;
  }
  return low < end && list->pairs.items[low].b == b ? &list->pairs.items[low] : NULL;
}

/* Contacts of pairs that stay: where they were before. Whoever stays is none of the old list's. */
static void match_pairs(scree_world *world, size_t a) {
  scree_spheres *s = &world->spheres;
  for (uint32_t k = s->list.begin[a]; k < s->list.begin[a + 1]; k++) {
    scree_sphere_pair *pair = &s->list.pairs.items[k];
    uint32_t one = place_in(&s->old, s->list.body[a]),
             other = place_in(&s->old, s->list.body[pair->b]);
    if (one == scree_none || other == scree_none) continue;
    scree_sphere_pair *old =
        find_pair(&s->old, one < other ? one : other, one < other ? other : one);
    if (!old) continue;
    pair->contact = old->contact;
    old->contact = scree_none;
    pair->law = one > other; /* it is turned round */
  }
}

/* What others have booked is their first body's. */
static void drop_pairs(scree_world *world, size_t a) {
  scree_sphere_list *old = &world->spheres.old;
  scree_balance *balance = &world->bodies.balance[old->body[a]];
  for (uint32_t k = old->begin[a]; k < old->begin[a + 1]; k++) {
    const uint32_t contact = old->pairs.items[k].contact;
    if (contact == scree_none) continue;
    const scree_sphere_contact *c = &old->contacts.items[contact & ~scree_sphere_touches];
    balance->dashpot += c->dashpot;
    balance->tangential += c->tangential;
  }
}

/* As seen from the other side. */
static void turn_round(scree_sphere_contact *c) {
  c->slid = vec3_neg(c->slid);
  float *const vectors[] = {c->normal, c->rubs, c->couple, c->rolled};
  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) vectors[i][k] = -vectors[i][k];
}

static void carry_contacts(scree_world *world, size_t block) {
  scree_spheres *s = &world->spheres;
  scree_sphere_list *list = &s->list;
  const size_t first = block * SCREE_SPHERE_BLOCK, next = first + SCREE_SPHERE_BLOCK,
               end = next < list->count ? next : list->count;
  uint32_t at = list->begin[first];
  for (uint32_t k = list->begin[first]; k < list->begin[end]; k++) {
    scree_sphere_pair *pair = &list->pairs.items[k];
    if (pair->contact == scree_none) continue;
    scree_sphere_contact *to = &list->contacts.items[at];
    *to = s->old.contacts.items[pair->contact & ~scree_sphere_touches];
    if (pair->law) turn_round(to);
    pair->contact = at++ | (pair->contact & scree_sphere_touches);
  }
  s->blocks.items[block].contacts = at - list->begin[first];
}

scree_status scree_spheres_list_seconds(scree_world *world, scree_error *error) {
  scree_spheres *s = &world->spheres;
  const scree_sphere_list *list = &s->list;
  const size_t count = list->pairs.count ? list->count + 2 + list->pairs.count : 0;
  s->seconds.count = count;
  if (!SCREE_RESERVE(&s->seconds, count))
    return scree_fail_memory(error, count * sizeof *s->seconds.items, "pairs of spheres");
  if (!count) return SCREE_OK;
  uint32_t *begin = s->seconds.items, *items = begin + list->count + 2;
  memset(begin, 0, (list->count + 2) * sizeof *begin);
  for (size_t k = 0; k < list->pairs.count; k++) begin[list->pairs.items[k].b + 2]++;
  for (size_t i = 0; i < list->count; i++) begin[i + 2] += begin[i + 1];
  for (size_t k = 0; k < list->pairs.count; k++)
    items[begin[list->pairs.items[k].b + 1]++] = (uint32_t)k;
  return SCREE_OK;
}

/* ---- laws ---- */

/* Spheres of the same shape, matter and mass are of one kind. How many there are; MOST_KINDS + 1:
 * more than that. */
static uint32_t find_kinds(scree_world *world) {
  const scree_spheres *s = &world->spheres;
  const scree_bodies *b = &world->bodies;
  uint32_t known[MOST_KINDS], count = 0;
  for (size_t p = 0; p < s->list.count; p++) {
    const uint32_t i = s->list.body[p];
    uint32_t kind = 0;
    while (kind < count &&
           !(b->particle[known[kind]] == b->particle[i] && b->mass[known[kind]] == b->mass[i] &&
             b->material[known[kind]] == b->material[i]))
      kind++;
    if (kind == MOST_KINDS) return MOST_KINDS + 1;
    if (kind == count) known[count++] = i;
    s->kind[p] = kind;
  }
  return count;
}

static scree_status set_up(scree_world *world, scree_error *error) {
  scree_spheres *s = &world->spheres;
  const size_t kinds = find_kinds(world), pairs = s->list.pairs.count;
  const bool table = kinds <= MOST_KINDS;
  s->laws.count = table ? kinds * kinds : pairs;
  if (!SCREE_RESERVE(&s->laws, s->laws.count))
    return scree_fail_memory(error, s->laws.count * sizeof *s->laws.items, "laws of spheres");
  for (size_t k = 0; k < pairs; k++) {
    scree_sphere_pair *pair = &s->list.pairs.items[k];
    pair->law = table ? s->kind[pair->a] * (uint32_t)kinds + s->kind[pair->b] : (uint32_t)k;
  }
  scree_spheres_set_up_laws(world);
  return SCREE_OK;
}

/* ---- all ---- */

static size_t block_count(const scree_sphere_list *list) {
  return list->pairs.count ? (list->count + SCREE_SPHERE_BLOCK - 1) / SCREE_SPHERE_BLOCK : 0;
}

/* Pairs of two blocks. */
static uint32_t count_shares(const scree_sphere_list *list, size_t first, size_t end) {
  uint32_t count = 0;
  for (uint32_t k = list->begin[first]; k < list->begin[end]; k++)
    count += list->pairs.items[k].b >= end;
  return count;
}

static scree_status make_blocks(scree_world *world, scree_error *error) {
  scree_spheres *s = &world->spheres;
  const size_t blocks = block_count(&world->spheres.list);
  if (blocks > s->blocks.capacity) {
    void *tallies = scree_resize(s->blocks.tallies, blocks, sizeof *s->blocks.tallies);
    if (tallies) s->blocks.tallies = tallies;
    void *items = scree_resize(s->blocks.items, blocks, sizeof *s->blocks.items);
    if (items) s->blocks.items = items;
    if (!items || !tallies)
      return scree_fail_memory(error, blocks * sizeof(scree_tally), "spheres");
    s->blocks.capacity = blocks;
  }
  s->blocks.count = blocks;
  uint32_t shares = 0;
  for (size_t block = 0; block < blocks; block++) {
    const size_t first = block * SCREE_SPHERE_BLOCK, next = first + SCREE_SPHERE_BLOCK;
    s->blocks.items[block] = (scree_sphere_block){.share_begin = shares};
    shares += count_shares(&s->list, first, next < s->list.count ? next : s->list.count);
  }
  if (!SCREE_RESERVE(&s->shares, shares))
    return scree_fail_memory(error, shares * sizeof *s->shares.items, "spheres");
  return SCREE_OK;
}

bool scree_spheres_reserve_pairs(scree_world *world, size_t count) {
  scree_spheres *s = &world->spheres;
  return count < SCREE_MOST_NEIGHBOURS && SCREE_RESERVE(&s->list.pairs, count) &&
         SCREE_RESERVE(&s->list.contacts, count) && SCREE_RESERVE(&s->found, count);
}

/* Contacts that are loaded lie where their pairs do: in each block they move down. */
static void pack_contacts(scree_sphere_list *list, scree_sphere_block *own, size_t first,
                          size_t end) {
  uint32_t at = list->begin[first];
  for (uint32_t k = list->begin[first]; k < list->begin[end]; k++) {
    scree_sphere_pair *two = &list->pairs.items[k];
    if (two->contact == scree_none) continue;
    list->contacts.items[at] = list->contacts.items[k];
    two->contact = at | (list->contacts.items[at].overlap > 0 ? scree_sphere_touches : 0);
    at++;
  }
  own->contacts = at - list->begin[first];
}

scree_status scree_spheres_restore(scree_world *world, scree_error *error) {
  scree_spheres *s = &world->spheres;
  if (s->list.count == 0) return SCREE_OK;
  SCREE_TRY(make_blocks(world, error));
  for (size_t block = 0; block < s->blocks.count; block++) {
    const size_t first = block * SCREE_SPHERE_BLOCK, next = first + SCREE_SPHERE_BLOCK;
    pack_contacts(&s->list, &s->blocks.items[block], first,
                  next < s->list.count ? next : s->list.count);
  }
  return set_up(world, error);
}

scree_status scree_spheres_list(scree_world *world, scree_error *error) {
  scree_spheres *s = &world->spheres;
  scree_broad_run(world, list_pairs, s->list.count);
  scree_broad_run(world, match_pairs, s->list.count);
  scree_broad_run(world, drop_pairs, s->old.count);
  SCREE_TRY(make_blocks(world, error));
  for (size_t block = 0; block < s->blocks.count; block++) carry_contacts(world, block);
  s->old.count = s->old.body_count = s->old.pairs.count = 0;
  return set_up(world, error);
}
