#include "simplify/own.h"

#include "base/parallel.h"
#include "simplify/grid_cells.h"

#include <assert.h>
#include <string.h>

/* Boxes that are joined to one; joinings of 2^16. */
enum { JOINED = 8, MOST_LEVELS = 6 };

typedef uint16_t bounds __attribute__((vector_size(sizeof(scree_own_box))));

scree_status scree_own_allocate(scree_own *o, size_t room, scree_error *error) {
  assert(room <= UINT16_MAX + 1);
  *o = (scree_own){.room = room};
  SCREE_ALLOC_OR(o->triangles, room, error, out_of_memory);
  SCREE_ALLOC_OR(o->boxes, 2 * room + MOST_LEVELS, error, out_of_memory);
  SCREE_ALLOC_OR(o->averse, room, error, out_of_memory);
  SCREE_ALLOC_OR(o->found, room, error, out_of_memory);
  return SCREE_OK;
out_of_memory:
  return SCREE_OUT_OF_MEMORY;
}

void scree_own_free(scree_own *o) {
  scree_free(o->triangles);
  scree_free(o->boxes);
  scree_free(o->averse);
  scree_free(o->found);
  *o = (scree_own){.count = 0};
}

static uint16_t step_along(double x, double low, double per_length) {
  return (uint16_t)scree_cell_along(x, low, per_length, UINT16_MAX + 1);
}

/* Steps grow with the place, so that what is apart in steps is apart. */
static scree_own_box box_of(const scree_own *o, vec3 low, vec3 high) {
  double k = o->steps_per_length;
  return (scree_own_box){
      {step_along(low.x, o->low.x, k), step_along(low.y, o->low.y, k),
       step_along(low.z, o->low.z, k), (uint16_t)~step_along(high.x, o->low.x, k),
       (uint16_t)~step_along(high.y, o->low.y, k), (uint16_t)~step_along(high.z, o->low.z, k)}};
}

/* What others are compared with: they touch the box if no bound of theirs is above its. */
static bounds most_for(const scree_own_box *box) {
  bounds most = {0};
  for (int i = 0; i < 3; i++) {
    most[i] = (uint16_t)~box->bound[3 + i];
    most[3 + i] = (uint16_t)~box->bound[i];
  }
  return most;
}

static bool touches(const scree_own_box *box, bounds most) {
  bounds b;
  uint64_t above[2];
  memcpy(&b, box, sizeof b);
  b = (bounds)(b > most);
  memcpy(above, &b, sizeof above);
  return (above[0] | above[1]) == 0;
}

#define NO_BOX                                                                                     \
  ((scree_own_box){{UINT16_MAX, UINT16_MAX, UINT16_MAX, UINT16_MAX, UINT16_MAX, UINT16_MAX}})

static void join(scree_own_box *all, const scree_own_box *box) {
  for (int i = 0; i < 6; i++)
    if (box->bound[i] < all->bound[i]) all->bound[i] = box->bound[i];
}

/* The boxes of each level, the triangles' own first, and how many; answers the last level. */
typedef struct level {
  scree_own_box *boxes;
  size_t count;
} level;

static int find_levels(const scree_own *o, level *levels) {
  int last = 0;
  levels[0] = (level){o->boxes, o->count};
  for (; levels[last].count > JOINED; last++)
    levels[last + 1] = (level){levels[last].boxes + levels[last].count,
                               scree_block_count(levels[last].count, JOINED)};
  return last;
}

static void enter_triangle(scree_own *o, const scree_grid *grid, const scree_halfmesh *s,
                           size_t place) {
  vec3 at[3];
  scree_corners(s, o->triangles[place], at);
  o->boxes[place] =
      box_of(o, vec3_min(at[0], vec3_min(at[1], at[2])), vec3_max(at[0], vec3_max(at[1], at[2])));
  o->averse[place] = scree_averse_to(grid, vec3_triangle_normal(at[0], at[1], at[2]));
}

void scree_own_enter(scree_own *o, const scree_grid *grid, const scree_halfmesh *s,
                     uint16_t *place_of) {
  const vec3 far = {INFINITY, INFINITY, INFINITY};
  vec3 low = far, high = vec3_scale(far, -1);
  level levels[MOST_LEVELS + 1];
  for (size_t i = 0; i < o->count; i++)
    for (size_t k = 0; k < 3; k++) {
      vec3 at = s->vertex[s->half[3 * (size_t)o->triangles[i] + k].from].at;
      low = vec3_min(low, at);
      high = vec3_max(high, at);
    }
  vec3 extent = vec3_sub(high, low);
  o->low = low;
  o->steps_per_length = UINT16_MAX / fmax(extent.x, fmax(extent.y, extent.z));
  for (size_t i = 0; i < o->count; i++) {
    enter_triangle(o, grid, s, i);
    place_of[o->triangles[i]] = (uint16_t)i;
  }
  int last = find_levels(o, levels);
  for (int k = 0; k < last; k++)
    for (size_t i = 0; i < levels[k].count; i++) {
      scree_own_box *to = &levels[k + 1].boxes[i / JOINED];
      if (i % JOINED == 0) *to = NO_BOX;
      join(to, &levels[k].boxes[i]);
    }
}

void scree_own_follow(scree_own *o, const scree_grid *grid, const scree_halfmesh *s,
                      const scree_ring *r, const uint32_t gone[2], const uint16_t *place_of) {
  level levels[MOST_LEVELS + 1];
  int last = find_levels(o, levels);
  for (int i = 0; i < 2; i++) {
    o->boxes[place_of[gone[i]]] = NO_BOX;
    o->averse[place_of[gone[i]]] = 0;
  }
  for (uint32_t i = 0; i < r->count; i++) {
    size_t place = place_of[r->edge[i] / 3], at = place;
    enter_triangle(o, grid, s, place);
    for (int k = 1; k <= last; k++) {
      at /= JOINED;
      join(&levels[k].boxes[at], &o->boxes[place]);
    }
  }
}

/* Adds those below these boxes of level k that touch the box looked for. */
static size_t find_below(const scree_own *o, const level *levels, int k, size_t begin, bounds most,
                         size_t count) {
  size_t end = begin + JOINED < levels[k].count ? begin + JOINED : levels[k].count;
  for (size_t i = begin; i < end; i++) {
    if (!touches(&levels[k].boxes[i], most)) continue;
    if (k > 0)
      count = find_below(o, levels, k - 1, i * JOINED, most, count);
    else
      o->found[count++] = (uint32_t)i;
  }
  return count;
}

bool scree_own_clear(const scree_own *o, const scree_grid *grid, const scree_halfmesh *s,
                     const scree_ring *r, vec3 target, const scree_around *around) {
  level levels[MOST_LEVELS + 1];
  scree_own_box box = box_of(o, r->low, r->high);
  int last = find_levels(o, levels);
  size_t count = find_below(o, levels, last, 0, most_for(&box), 0);
  uint64_t averse = 0;
  for (uint32_t i = 0; i < r->count; i++) averse |= scree_averse_to(grid, around->after[i]);
  for (size_t i = 0; i < count; i++) averse |= o->averse[o->found[i]];
  if (averse != SCREE_ALL_AVERSE) return true; /* the certificate of grid.h */
  for (size_t i = 0; i < count; i++) o->found[i] = o->triangles[o->found[i]];
  return scree_grid_clear_among(grid, s, r, target, o->found, count);
}
