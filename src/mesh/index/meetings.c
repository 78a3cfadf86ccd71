/* All facets of a mesh that meet where they should not: a tree of boxes (mesh/index/facet_tree.h)
 * traversed against itself, the exact test (mesh/index/intersect.h) at its leaves.
 *
 * The tree and the cutting of the work depend on the mesh alone, and pairs are sorted at the end:
 * the result is the same for any number of threads. */
#include "base/array.h"
#include "base/parallel.h"
#include "base/radix.h"
#include "mesh/index/facet_tree.h"
#include "mesh/index/intersect.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum {
  WORK_ITEMS = 2048, /* node pairs handed to the threads */
  TICK_ITEMS = 64,   /* of these per call of the progress */
  FACETS_PER_ITEM = 256,
};

typedef struct item {
  uint32_t a, b;
} item;

typedef struct search {
  const scree_facet_tree *tree;
  const bool *settled; /* by facet: of two such it is known that they do not meet; NULL: of none */
  bool *calm;          /* by node: all its facets are settled; NULL: none is */
  item *work;
  scree_meetings *found; /* per work item */
  size_t limit;
  atomic_size_t total;
  atomic_bool failed;
} search;

static bool test_pair(search *s, uint32_t a, uint32_t b, scree_meetings *out) {
  const scree_mesh *mesh = s->tree->mesh;
  const uint32_t *t = mesh->triangles + 3 * (size_t)a, *u = mesh->triangles + 3 * (size_t)b;
  if (s->settled && s->settled[a] && s->settled[b]) return true;
  scree_meet meet = scree_triangles_meet(mesh->positions, t, u);
  if (meet == SCREE_MEET_NOT) return true;
  if (atomic_fetch_add(&s->total, 1) >= s->limit) return true;
  uint32_t first = a < b ? a : b, second = a < b ? b : a;
  return SCREE_PUSH(out, (scree_meeting){first, second, meet});
}

/* Facets of a leaf with their boxes. */
typedef struct crowd {
  uint32_t facet[SCREE_LEAF_FACETS];
  scree_box box[SCREE_LEAF_FACETS];
  int count;
} crowd;

/* Those of the leaf that are not apart from the box. */
static void list_near(const scree_facet_tree *t, const scree_tree_node *leaf, const scree_box *box,
                      crowd *near) {
  near->count = 0;
  for (uint32_t i = leaf->first; i < leaf->first + leaf->count; i++) {
    scree_box of = scree_facet_box(t->mesh, t->tree.order[i]);
    if (!scree_box_meets(&of, box)) continue;
    near->box[near->count] = of;
    near->facet[near->count++] = t->tree.order[i];
  }
}

static bool test_leaves(search *s, const scree_tree_node *a, const scree_tree_node *b,
                        scree_meetings *out) {
  crowd of_a, of_b;
  list_near(s->tree, a, &b->box, &of_a);
  if (of_a.count == 0) return true;
  list_near(s->tree, b, &a->box, &of_b);
  for (int i = 0; i < of_a.count; i++)
    for (int j = a == b ? i + 1 : 0; j < of_b.count; j++)
      if (scree_box_meets(&of_a.box[i], &of_b.box[j]) &&
          !test_pair(s, of_a.facet[i], of_b.facet[j], out))
        return false;
  return true;
}

static double size2_of(const scree_tree_node *n) {
  return vec3_norm2(vec3_sub(n->box.high, n->box.low));
}

/* The pairs of nodes that (a, b) falls into; a == b is a node against itself. */
static int divide(const scree_tree *t, item pair, item parts[3]) {
  const scree_tree_node *a = &t->nodes[pair.a], *b = &t->nodes[pair.b];
  if (pair.a == pair.b) {
    parts[0] = (item){a->first, a->first};
    parts[1] = (item){a->first + 1, a->first + 1};
    parts[2] = (item){a->first, a->first + 1};
    return 3;
  }
  bool of_a = b->count || (!a->count && size2_of(a) >= size2_of(b));
  for (uint32_t side = 0; side < 2; side++)
    parts[side] = of_a ? (item){a->first + side, pair.b} : (item){pair.a, b->first + side};
  return 2;
}

/* Whether nothing is to be found between the two nodes. */
static bool apart(const search *s, item pair) {
  if (s->calm && s->calm[pair.a] && s->calm[pair.b]) return true;
  return pair.a != pair.b && scree_facet_nodes_apart(s->tree, pair.a, pair.b);
}

static bool both_leaves(const scree_tree *t, item pair) {
  return t->nodes[pair.a].count && t->nodes[pair.b].count;
}

static bool traverse(search *s, item start, scree_meetings *out) {
  const scree_tree *t = &s->tree->tree;
  /* each step replaces a pair by at most three of smaller nodes; the tree is at most 80 deep */
  item stack[2048];
  int depth = 0;
  stack[depth++] = start;
  while (depth > 0) {
    item pair = stack[--depth];
    if (apart(s, pair)) continue;
    if (both_leaves(t, pair)) {
      if (atomic_load_explicit(&s->total, memory_order_relaxed) > s->limit) return true;
      if (!test_leaves(s, &t->nodes[pair.a], &t->nodes[pair.b], out)) return false;
      continue;
    }
    depth += divide(t, pair, stack + depth);
  }
  return true;
}

static void traverse_block(void *context, scree_block block) {
  search *s = context;
  for (size_t i = block.begin; i < block.end; i++)
    if (!traverse(s, s->work[i], &s->found[i])) atomic_store(&s->failed, true);
}

/* Small meshes are not worth cutting finely. */
static size_t work_items(const scree_facet_tree *t) {
  size_t items = t->mesh->triangle_count / FACETS_PER_ITEM;
  return items < 4 ? 4 : items < WORK_ITEMS ? items : WORK_ITEMS;
}

/* Divides the root's pair breadth first until there are enough pairs for the threads. */
static size_t spread_work(const search *s, item *work, size_t most) {
  const scree_tree *t = &s->tree->tree;
  size_t first = 0, count = 1;
  work[0] = (item){0, 0};
  /* pairs before `first` are done being divided: both leaves */
  while (first < count && count + 2 < most) {
    item pair = work[first], parts[3];
    if (apart(s, pair)) {
      work[first] = work[--count];
    } else if (both_leaves(t, pair)) {
      first++;
    } else {
      int part_count = divide(t, pair, parts);
      memmove(work + first, work + first + 1, (count - first - 1) * sizeof *work);
      count--;
      for (int i = 0; i < part_count; i++) work[count++] = parts[i];
    }
  }
  return count;
}

static scree_status run(search *s, size_t work_count, const scree_progress *progress,
                        scree_error *error) {
  scree_ticker ticker = {.progress = progress};
  item *all = s->work;
  scree_meetings *lists = s->found;
  scree_status status = SCREE_OK;
  for (size_t i = 0; i < work_count && status == SCREE_OK; i += TICK_ITEMS) {
    s->work = all + i;
    s->found = lists + i;
    scree_parallel_for(work_count - i < TICK_ITEMS ? work_count - i : TICK_ITEMS, 1, traverse_block,
                       s);
    double done = (double)(i + TICK_ITEMS) / (double)work_count;
    if (!scree_tick(&ticker, "self-intersections", done < 1 ? done : 1))
      status = scree_fail(error, SCREE_CANCELLED, "cancelled while looking for self-intersections");
    if (atomic_load(&s->failed))
      status = scree_fail_memory(error, sizeof(scree_meeting), "self-intersections");
  }
  s->work = all;
  s->found = lists;
  return status;
}

SCREE_ORDER_BY2(compare_meetings, scree_meeting, first, second)

static scree_status gather(search *s, size_t work_count, scree_meetings *found,
                           scree_error *error) {
  size_t total = atomic_load(&s->total);
  if (total > s->limit) {
    *found = (scree_meetings){.count = s->limit, .truncated = true};
    return SCREE_OK;
  }
  scree_meetings all = {.capacity = total};
  SCREE_TRY_ALLOC(all.items, total, error);
  for (size_t i = 0; i < work_count; i++) {
    if (s->found[i].count)
      memcpy(all.items + all.count, s->found[i].items, s->found[i].count * sizeof *all.items);
    all.count += s->found[i].count;
  }
  qsort(all.items, all.count, sizeof *all.items, compare_meetings);
  *found = all;
  return SCREE_OK;
}

static void mark_calm(search *s) {
  const scree_tree *t = &s->tree->tree;
  for (size_t i = t->node_count; i-- > 0;) { /* children come after their parent */
    const scree_tree_node *n = &t->nodes[i];
    s->calm[i] = n->count || (s->calm[n->first] && s->calm[n->first + 1]);
    for (uint32_t j = 0; j < n->count; j++) s->calm[i] &= s->settled[t->order[n->first + j]];
  }
}

scree_status scree_facet_meetings(const scree_facet_tree *tree, size_t limit,
                                  const scree_progress *progress, scree_meetings *found,
                                  scree_error *error) {
  return scree_facet_meetings_new(tree, NULL, limit, progress, found, error);
}

scree_status scree_facet_meetings_new(const scree_facet_tree *tree, const bool *settled,
                                      size_t limit, const scree_progress *progress,
                                      scree_meetings *found, scree_error *error) {
  search s = {.tree = tree, .settled = settled, .limit = limit};
  size_t most = work_items(tree);
  SCREE_SCRATCH(bool, calm, tree->tree.node_count, error);
  SCREE_SCRATCH(item, work, most, error);
  SCREE_TRY_ALLOC_ZERO(s.found, most, error);
  s.calm = settled ? calm : NULL;
  s.work = work;
  if (settled) mark_calm(&s);
  size_t work_count = spread_work(&s, work, most);
  scree_status status = run(&s, work_count, progress, error);
  if (status == SCREE_OK) status = gather(&s, work_count, found, error);
  for (size_t i = 0; i < work_count; i++) scree_free(s.found[i].items);
  scree_free(s.found);
  return status;
}

/* ---- Of few facets ---- */

/* Some facets of a mesh, in a tree. */
typedef struct few {
  const scree_mesh *mesh;
  const uint32_t *facet;
  scree_tree tree;
  bool *near; /* by facet of the mesh: its box meets the box of one of them */
} few;

static scree_box box_of_one(const void *context, size_t i) {
  const few *f = context;
  return scree_facet_box(f->mesh, f->facet[i]);
}

static bool is_near(const few *f, const scree_box *box) {
  scree_tree_walk walk;
  scree_tree_start(&walk, &f->tree);
  for (const scree_tree_node *n; (n = scree_tree_next(&walk));) {
    if (!scree_box_meets(&n->box, box) || scree_tree_enter(&walk, n)) continue;
    for (uint32_t i = n->first; i < n->first + n->count; i++) {
      scree_box of = box_of_one(f, f->tree.order[i]);
      if (scree_box_meets(&of, box)) return true;
    }
  }
  return false;
}

static void mark_near(void *context, scree_block block) {
  const few *f = context;
  for (size_t t = block.begin; t < block.end; t++) {
    scree_box box = scree_facet_box(f->mesh, (uint32_t)t);
    f->near[t] = is_near(f, &box);
  }
}

/* `new_count` facets are not settled, at least one: they are sought among those near them. */
static scree_status meetings_of_few(const scree_mesh *mesh, const bool *settled, size_t new_count,
                                    size_t limit, const scree_progress *progress,
                                    scree_meetings *found, scree_error *error) {
  enum { BLOCK = 4096 };
  SCREE_SCRATCH(uint32_t, facet, mesh->triangle_count, error);
  SCREE_SCRATCH(bool, near, mesh->triangle_count, error);
  few f = {.mesh = mesh, .facet = facet, .near = near};
  for (uint32_t t = 0, n = 0; t < mesh->triangle_count; t++)
    if (!settled[t]) facet[n++] = t;
  const scree_boxed boxed = {new_count, box_of_one, &f, SCREE_LEAF_FACETS, SCREE_SPLIT_HALVES};
  SCREE_TRY(scree_tree_build(&boxed, &f.tree, error));
  scree_parallel_for(mesh->triangle_count, BLOCK, mark_near, &f);
  scree_tree_free(&f.tree);
  size_t count = 0;
  for (uint32_t t = 0; t < mesh->triangle_count; t++)
    if (near[t]) facet[count++] = t;
  SCREE_SCRATCH(uint32_t, triangles, 3 * count, error);
  SCREE_SCRATCH(bool, old, count, error);
  for (size_t i = 0; i < count; i++) {
    memcpy(triangles + 3 * i, mesh->triangles + 3 * (size_t)facet[i], 3 * sizeof *triangles);
    old[i] = settled[facet[i]];
  }
  const scree_mesh part = {mesh->positions, triangles, mesh->vertex_count, count};
  SCREE_CLEANUP(scree_facet_tree_free) scree_facet_tree tree = {0};
  SCREE_TRY(scree_facet_tree_build(&part, &tree, error));
  SCREE_TRY(scree_facet_meetings_new(&tree, old, limit, progress, found, error));
  for (size_t i = 0; !found->truncated && i < found->count; i++) {
    found->items[i].first = facet[found->items[i].first];
    found->items[i].second = facet[found->items[i].second];
  }
  return SCREE_OK;
}

scree_status scree_mesh_meetings(const scree_mesh *mesh, const bool *settled, size_t limit,
                                 const scree_progress *progress, scree_meetings *found,
                                 scree_error *error) {
  enum { FEW = 8 }; /* a share of one in so many */
  SCREE_CLEANUP(scree_facet_tree_free) scree_facet_tree tree = {0};
  size_t new_count = 0;
  *found = (scree_meetings){0};
  for (size_t t = 0; t < mesh->triangle_count; t++) new_count += !settled || !settled[t];
  if (new_count == 0) return SCREE_OK;
  if (new_count < mesh->triangle_count / FEW)
    return meetings_of_few(mesh, settled, new_count, limit, progress, found, error);
  SCREE_TRY(scree_facet_tree_build(mesh, &tree, error));
  return scree_facet_meetings_new(&tree, settled, limit, progress, found, error);
}
