/* The stages of the broad phase as launches, in two parts: between them the host makes room for the
 * neighbours that were counted. Old and new neighbours, keys and places of keys are in memories
 * that change places. */
#include "world/device/cuda_broad.h"
#include "world/broad/broad.h"
#include "world/broad/grids.h"

#include "base/alloc.h"

#include <string.h>

#ifdef SCREE_WITH_CUDA

enum { LEAST_CHUNK = 64, MOST_ARRAYS = 24, KEPT_COUNT = 4 };

struct scree_cuda_broad {
  scree_cuda_block own, arrays[MOST_ARRAYS], kept[KEPT_COUNT], match, left;
  scree_broad image;
};

typedef struct array {
  size_t field, size; /* where its pointer is in scree_broad; bytes */
} array;

#define FIELD(member) offsetof(scree_broad, member)
#define OF(member, length)                                                                         \
  { FIELD(member), (length) * sizeof *b->member }
#define GROUPS(member, length)                                                                     \
  OF(member.count, length), OF(member.begin, (length) + 1),                                        \
      OF(member.sums, scree_groups_chunks(&b->member))

/* Their size depends on the bodies alone. */
static size_t list_body_arrays(const scree_world *w, const scree_broad *b,
                               array arrays[MOST_ARRAYS]) {
  const size_t n = w->bodies.count;
  const array all[] = {OF(boxes, n),
                       OF(cells, n),
                       OF(wall_reach, 2 * w->walls.count + 1),
                       OF(binned, n),
                       OF(found, SCREE_FOUND * n),
                       OF(found_count, n),
                       OF(old_begin, n + 1),
                       GROUPS(buckets, b->bucket_count),
                       GROUPS(listed, n),
                       GROUPS(left, n),
                       GROUPS(walls, n),
                       OF(sides.count, n),
                       OF(sides.sums, scree_groups_chunks(&b->sides))};
  memcpy(arrays, all, sizeof all);
  return sizeof all / sizeof *all;
}

/* An array of the world's neighbours, and the one of scree_broad that it changes places with. */
typedef struct kept {
  size_t field, old_field, size;
} kept;
#define KEPT(member, old)                                                                          \
  { offsetof(scree_world, member), FIELD(old), sizeof *((scree_world *)0)->member }
static const kept all_kept[KEPT_COUNT] = {
    KEPT(list.neighbours.items, old_neighbours), KEPT(list.pair_of.items, old_pair_of),
    KEPT(list.ledger.items, old_ledger), KEPT(list.keys.items, old_keys)};
#undef KEPT

static void lead(void *structure, size_t field, scree_device_address address) {
  uintptr_t at = (uintptr_t)address;
  memcpy((char *)structure + field, &at, sizeof at);
}

scree_status scree_cuda_broad_tell(const scree_cuda_place *place, size_t field, const void *value,
                                   size_t size, scree_error *error) {
  char *known = (char *)place->image + field;
  if (memcmp(known, value, size) == 0) return SCREE_OK;
  memcpy(known, value, size);
  return scree_cuda_write(place->queue, place->world + field, known, size, error);
}

static scree_status write_image(scree_cuda_broad *broad, const scree_cuda_place *place,
                                scree_error *error) {
  return scree_cuda_write(place->queue, broad->own.at, &broad->image, sizeof broad->image, error);
}

/* About as many chunks as there are owners in each. */
static void set_length(scree_groups *groups, size_t length) {
  groups->length = length;
  for (groups->chunk = LEAST_CHUNK; groups->chunk * groups->chunk < length;) groups->chunk *= 2;
}

/* Counters begin at 0; stages leave them so. */
static scree_status clear_counts(scree_cuda_broad *broad, const scree_cuda_place *place,
                                 scree_error *error) {
  scree_broad *b = &broad->image;
  const scree_groups *all[] = {&b->buckets, &b->listed};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    SCREE_TRY(scree_cuda_clear(place->queue, (uintptr_t)all[i]->count,
                               all[i]->length * sizeof *all[i]->count, error));
  return SCREE_OK;
}

scree_status scree_cuda_broad_send(scree_cuda_broad **made, scree_world *w,
                                   const scree_cuda_place *place, scree_device_address *at,
                                   scree_error *error) {
  if (!*made) *made = scree_alloc_zero(1, sizeof **made);
  scree_cuda_broad *broad = *made;
  if (!broad) return scree_fail_memory(error, sizeof *broad, "the broad phase");
  scree_broad *b = &broad->image;
  const size_t n = w->bodies.count;
  *b = (scree_broad){.bucket_count = w->broad->bucket_count, .old_bodies = w->broad->old_bodies};
  set_length(&b->buckets, b->bucket_count);
  scree_groups *by_body[] = {&b->listed, &b->left, &b->walls, &b->sides};
  for (size_t i = 0; i < sizeof by_body / sizeof *by_body; i++) set_length(by_body[i], n);
  array arrays[MOST_ARRAYS];
  size_t count = list_body_arrays(w, b, arrays);
  SCREE_TRY(scree_cuda_reserve(&broad->own, sizeof *b, error));
  for (size_t i = 0; i < count; i++) {
    SCREE_TRY(scree_cuda_reserve_more(&broad->arrays[i], arrays[i].size, error));
    lead(b, arrays[i].field, broad->arrays[i].at);
  }
  b->wall_gap = b->wall_reach + w->walls.count;
  lead(b, FIELD(sides.begin), place->array(w, offsetof(scree_world, list.side_begin))->at);
  SCREE_TRY(clear_counts(broad, place, error));
  SCREE_TRY(scree_cuda_write(place->queue, (uintptr_t)b->listed.begin, w->broad->listed.begin,
                             (b->old_bodies + 1) * sizeof *b->listed.begin, error));
  *at = broad->own.at;
  return write_image(broad, place, error);
}

scree_status scree_cuda_broad_keep(const scree_cuda_broad *broad, scree_world *w,
                                   const scree_cuda_place *place, scree_error *error) {
  const scree_broad *b = &broad->image;
  w->broad->old_bodies = b->old_bodies;
  return scree_cuda_read(place->queue, w->broad->listed.begin, (uintptr_t)b->listed.begin,
                         (b->old_bodies + 1) * sizeof *b->listed.begin, error);
}

/* Kernels [first, last]. */
static scree_status launch(const scree_cuda_broad *broad, const scree_world *w,
                           const scree_cuda_place *place, scree_kernel first, scree_kernel last,
                           scree_error *error) {
  const scree_broad *b = &broad->image;
  const size_t n = w->bodies.count, k = w->list.neighbours.count,
               chunks = scree_groups_chunks(&b->listed), buckets = scree_groups_chunks(&b->buckets),
               counts[SCREE_KERNEL_COUNT] = {
                   [SCREE_KERNEL_grids] = 1,
                   [SCREE_KERNEL_bucket_sums] = buckets,
                   [SCREE_KERNEL_bucket_places] = buckets,
                   [SCREE_KERNEL_key_sums] = chunks,
                   [SCREE_KERNEL_key_places] = chunks,
                   [SCREE_KERNEL_match] = k,
                   [SCREE_KERNEL_left_sums] = chunks,
                   [SCREE_KERNEL_left_places] = chunks,
                   [SCREE_KERNEL_leave_wall] = w->walls.count + 1,
                   [SCREE_KERNEL_carry] = k,
                   [SCREE_KERNEL_renew] = k,
                   [SCREE_KERNEL_side_count] = k,
                   [SCREE_KERNEL_side_sums] = chunks,
                   [SCREE_KERNEL_side_places] = chunks,
                   [SCREE_KERNEL_side] = k,
                   [SCREE_KERNEL_wall_sums] = chunks,
                   [SCREE_KERNEL_wall_places] = chunks,
                   [SCREE_KERNEL_list_touching] = k / 64 + 1,
               };
  for (int kernel = (int)first; kernel <= (int)last; kernel++)
    SCREE_TRY(scree_cuda_launch(place->queue, (scree_kernel)kernel,
                                counts[kernel] ? counts[kernel] : n, 1, place->worlds, 0, error));
  return SCREE_OK;
}

/* Where bodies' keys begin, of the old list and of the new one. */
static void exchange_begins(scree_broad *b) {
  uint32_t *begin = b->listed.begin;
  b->listed.begin = b->old_begin;
  b->old_begin = begin;
}

scree_status scree_cuda_broad_find(scree_cuda_broad *broad, scree_world *w,
                                   const scree_cuda_place *place, size_t *count,
                                   scree_error *error) {
  scree_broad *b = &broad->image;
  w->list.margin = scree_broad_margin(w);
  SCREE_TRY(scree_cuda_broad_tell(place, offsetof(scree_world, list.margin), &w->list.margin,
                                  sizeof w->list.margin, error));
  exchange_begins(b);
  b->widest = 0;
  b->used = 0;
  b->left.length = b->old_bodies;
  SCREE_TRY(scree_cuda_clear(place->queue, (uintptr_t)b->wall_reach,
                             2 * w->walls.count * sizeof *b->wall_reach, error));
  SCREE_TRY(write_image(broad, place, error));
  SCREE_TRY(launch(broad, w, place, SCREE_KERNEL_box, SCREE_KERNEL_key_places, error));
  SCREE_TRY(scree_cuda_read(place->queue, b, broad->own.at, sizeof *b, error));
  *count = (size_t)b->listed.total;
  if (b->listed.total >= SCREE_MOST_NEIGHBOURS)
    return scree_fail_memory(error, *count * sizeof(scree_neighbours), "pairs of bodies");
  return SCREE_OK;
}

/* The old neighbours are kept aside, and there is room for the new ones. */
static scree_status exchange_neighbours(scree_cuda_broad *broad, scree_world *w,
                                        const scree_cuda_place *place, size_t count,
                                        scree_error *error) {
  for (size_t i = 0; i < KEPT_COUNT; i++) {
    const kept *one = &all_kept[i];
    scree_cuda_block *now = place->array(w, one->field), *old = &broad->kept[i], block = *now;
    *now = *old;
    *old = block;
    SCREE_TRY(scree_cuda_reserve_more(now, count * one->size, error));
    uintptr_t at = (uintptr_t)now->at;
    lead(&broad->image, one->old_field, old->at);
    SCREE_TRY(scree_cuda_broad_tell(place, one->field, &at, sizeof at, error));
  }
  return SCREE_OK;
}

/* Lists of the world that are made anew. */
static scree_status reserve_lists(scree_world *w, const scree_cuda_place *place, size_t count,
                                  scree_error *error) {
#define LIST(member, length)                                                                       \
  { offsetof(scree_world, member.items), (length) * sizeof *w->member.items }
  const array all[] = {LIST(list.slots, count),      LIST(list.touching, count / 64 + 1),
                       LIST(list.sides, 2 * count),  LIST(list.acting, 2 * count),
                       LIST(workspace.awake, count), LIST(list.wall_pairs, count)};
#undef LIST
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    scree_cuda_block *block = place->array(w, all[i].field);
    SCREE_TRY(scree_cuda_reserve_more(block, all[i].size, error));
    uintptr_t at = (uintptr_t)block->at;
    SCREE_TRY(scree_cuda_broad_tell(place, all[i].field, &at, sizeof at, error));
  }
  return SCREE_OK;
}

/* For where the neighbours were, and which of them are left. */
static scree_status reserve_own(scree_cuda_broad *broad, size_t old, size_t count,
                                scree_error *error) {
  scree_broad *b = &broad->image;
  SCREE_TRY(scree_cuda_reserve_more(&broad->match, count * sizeof *b->match.items, error));
  SCREE_TRY(scree_cuda_reserve_more(&broad->left, old * sizeof *b->left_features.items, error));
  lead(b, FIELD(match.items), broad->match.at);
  lead(b, FIELD(left_features.items), broad->left.at);
  return SCREE_OK;
}

scree_status scree_cuda_broad_list(scree_cuda_broad *broad, scree_world *w,
                                   const scree_cuda_place *place, size_t count,
                                   scree_error *error) {
  SCREE_TRY(exchange_neighbours(broad, w, place, count, error));
  SCREE_TRY(reserve_lists(w, place, count, error));
  SCREE_TRY(reserve_own(broad, w->list.neighbours.count, count, error));
  SCREE_TRY(scree_cuda_broad_tell(place, offsetof(scree_world, list.neighbours.count), &count,
                                  sizeof count, error));
  SCREE_TRY(scree_cuda_broad_tell(place, offsetof(scree_world, list.keys.count), &count,
                                  sizeof count, error));
  SCREE_TRY(write_image(broad, place, error));
  w->list.neighbours.count = count;
  SCREE_TRY(launch(broad, w, place, SCREE_KERNEL_key_write, SCREE_KERNEL_list_date, error));
  broad->image.old_bodies = w->broad->old_bodies = w->list.body_count = w->bodies.count;
  w->list.stale = false;
  w->timings.broad_builds++;
  return SCREE_OK;
}

void scree_cuda_broad_free(scree_cuda_broad *broad) {
  if (!broad) return;
  for (size_t i = 0; i < MOST_ARRAYS; i++) scree_cuda_free(broad->arrays[i]);
  for (size_t i = 0; i < KEPT_COUNT; i++) scree_cuda_free(broad->kept[i]);
  scree_cuda_free(broad->match);
  scree_cuda_free(broad->left);
  scree_cuda_free(broad->own);
  scree_free(broad);
}

#endif
