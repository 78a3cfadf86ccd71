/* Shells by union-find over edges; their nesting by winding numbers.
 *
 * The winding number of a closed surface around a point is the signed number of its facets that a
 * ray from the point leaves through, less those it enters through. Rays run along +x from the
 * vertex of a shell that lies farthest that way, of those that no other shell has. A ray may run
 * through an edge or a vertex of another shell, or start on one where every vertex is shared; it is
 * thought to be displaced by (-e^3, e, e^2) with e infinitely small ("simulation of simplicity",
 * Edelsbrunner and Muecke, ACM Trans. Graph. 9 (1990)), which makes every crossing a plain one and
 * the count exact. */
#include "mesh/repair/shells.h"

#include "base/array.h"
#include "base/radix.h"
#include "base/sum.h"
#include "mesh/predicates.h"

#include <stdlib.h>

/* Labels in the order of the lowest facets; returns how many shells there are. */
static size_t label_shells(const scree_mesh *mesh, const scree_adjacency *adjacency,
                           uint32_t *label) {
  size_t count = 0;
  scree_join_over_edges(mesh, adjacency, false, label);
  /* roots are the lowest of their set, so the root's label is made before the others ask for it */
  for (size_t t = 0; t < mesh->triangle_count; t++) label[t] = scree_find_root(label, (uint32_t)t);
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    uint32_t root = label[t];
    if (!scree_takes_part(adjacency, t))
      label[t] = SCREE_NO_SHELL;
    else
      label[t] = root == t ? (uint32_t)count++ : label[root];
  }
  return count;
}

static void add_facet(const scree_mesh *mesh, size_t t, scree_shell *shell, scree_sum *sums) {
  if (shell->facet_count++ == 0) {
    shell->first_facet = (uint32_t)t;
    shell->closed = true;
    shell->outermost = SCREE_NO_SHELL;
  }
  vec3 origin = scree_mesh_corner(mesh, shell->first_facet, 0), p = scree_mesh_corner(mesh, t, 0);
  vec3 normal =
      vec3_triangle_normal(p, scree_mesh_corner(mesh, t, 1), scree_mesh_corner(mesh, t, 2));
  scree_sum_add(&sums[0], 0.5 * vec3_norm(normal));
  scree_sum_add(&sums[1], vec3_dot(vec3_sub(p, origin), normal) / 6);
}

static void mark_open(const scree_mesh *mesh, const scree_adjacency *adjacency,
                      scree_shells *shells) {
  for (size_t e = 0; e < adjacency->edge_count; e++) {
    uint32_t first = adjacency->edges[e], from = scree_half_edge_from(mesh, first), h = first;
    long long balance = 0;
    do {
      balance += scree_half_edge_from(mesh, h) == from ? 1 : -1;
      h = adjacency->ring[h];
    } while (h != first);
    if (balance) shells->items[shells->label[first / 3]].closed = false;
  }
}

scree_status scree_shells_find(const scree_mesh *mesh, const scree_adjacency *adjacency,
                               scree_shells *shells, scree_error *error) {
  SCREE_CLEANUP(scree_shells_free) scree_shells made = {0};
  typedef scree_sum shell_sums[2]; /* area, volume */
  SCREE_TRY_ALLOC(made.label, mesh->triangle_count, error);
  made.count = label_shells(mesh, adjacency, made.label);
  SCREE_TRY_ALLOC_ZERO(made.items, made.count, error);
  SCREE_SCRATCH_ZERO(shell_sums, sums, made.count, error);
  for (size_t t = 0; t < mesh->triangle_count; t++)
    if (made.label[t] != SCREE_NO_SHELL)
      add_facet(mesh, t, &made.items[made.label[t]], sums[made.label[t]]);
  for (size_t i = 0; i < made.count; i++) {
    made.items[i].area = scree_sum_value(sums[i][0]);
    made.items[i].volume = scree_sum_value(sums[i][1]);
  }
  mark_open(mesh, adjacency, &made);
  *shells = made;
  made = (scree_shells){0};
  return SCREE_OK;
}

void scree_shells_free(scree_shells *shells) {
  if (!shells) return;
  scree_free(shells->label);
  scree_free(shells->items);
  *shells = (scree_shells){0};
}

bool scree_shells_closed(const scree_shells *shells) {
  for (size_t i = 0; i < shells->count; i++)
    if (!shells->items[i].closed) return false;
  return true;
}

/* ---- Shells that meet ---- */

static int compare_keys(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

static uint64_t key_of(uint32_t a, uint32_t b) {
  return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

scree_status scree_shell_pairs_find(const scree_shells *shells, const scree_meetings *found,
                                    scree_shell_pairs *pairs, scree_error *error) {
  uint64_t *keys;
  size_t key_count = 0, count = 0;
  SCREE_TRY_ALLOC(keys, found->count, error);
  for (size_t i = 0; i < found->count; i++) {
    uint32_t a = shells->label[found->items[i].first], b = shells->label[found->items[i].second];
    if (a != b && a != SCREE_NO_SHELL && b != SCREE_NO_SHELL) keys[key_count++] = key_of(a, b);
  }
  scree_sort_keys(keys, key_count);
  for (size_t i = 0; i < key_count; i++)
    if (i == 0 || keys[i] != keys[i - 1]) keys[count++] = keys[i];
  *pairs = (scree_shell_pairs){keys, count};
  return SCREE_OK;
}

static bool do_meet(const scree_shell_pairs *pairs, uint32_t a, uint32_t b) {
  uint64_t key = key_of(a, b);
  return pairs && pairs->count &&
         bsearch(&key, pairs->keys, pairs->count, sizeof key, compare_keys);
}

/* ---- Where rays start ---- */

static bool is_farther(const scree_mesh *mesh, uint32_t v, uint32_t than) {
  const double *p = mesh->positions + 3 * (size_t)v, *q = mesh->positions + 3 * (size_t)than;
  for (int k = 0; k < 3; k++)
    if (p[k] != q[k]) return p[k] > q[k];
  return false;
}

/* By vertex: the shell that alone has it, else SCREE_NO_SHELL. */
static void find_owners(const scree_shells *shells, const scree_mesh *mesh, uint32_t *owner) {
  for (int pass = 0; pass < 2; pass++)
    for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
      uint32_t label = shells->label[c / 3], *o = &owner[mesh->triangles[c]];
      if (label != SCREE_NO_SHELL) *o = pass == 0 || *o == label ? label : SCREE_NO_SHELL;
    }
}

/* The vertex of each shell that is farthest along x, then y, then z; one of its own goes before one
 * that it shares. */
static void find_starts(const scree_shells *shells, const scree_mesh *mesh, const uint32_t *owner,
                        uint32_t *start) {
  for (size_t i = 0; i < shells->count; i++)
    start[i] = mesh->triangles[3 * (size_t)shells->items[i].first_facet];
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
    uint32_t v = mesh->triangles[c], label = shells->label[c / 3];
    if (label == SCREE_NO_SHELL) continue;
    bool own = owner[v] == label, had = owner[start[label]] == label;
    if (own != had ? own : is_farther(mesh, v, start[label])) start[label] = v;
  }
}

static scree_status make_starts(const scree_shells *shells, const scree_mesh *mesh,
                                uint32_t **start, scree_error *error) {
  SCREE_SCRATCH(uint32_t, owner, mesh->vertex_count, error);
  SCREE_TRY_ALLOC(*start, shells->count, error);
  find_owners(shells, mesh, owner);
  find_starts(shells, mesh, owner, *start);
  return SCREE_OK;
}

/* ---- Winding numbers ---- */

/* On which side of the line a b, seen along x, the displaced point lies; 0 only where a and b
 * coincide so seen. */
static int displaced_side(const double *a, const double *b, const double *p) {
  int side = scree_orient2(a + 1, b + 1, p + 1);
  if (side) return side;
  if (a[2] != b[2]) return a[2] > b[2] ? 1 : -1;
  return (b[1] > a[1]) - (b[1] < a[1]);
}

/* +1 where the ray from p along x leaves through the facet, -1 where it enters, else 0. */
static int crossing(const scree_mesh *mesh, uint32_t facet, const double *p) {
  const double *corner[3];
  for (size_t k = 0; k < 3; k++)
    corner[k] = mesh->positions + 3 * (size_t)mesh->triangles[3 * (size_t)facet + k];
  int side = displaced_side(corner[0], corner[1], p);
  if (!side || displaced_side(corner[1], corner[2], p) != side ||
      displaced_side(corner[2], corner[0], p) != side)
    return 0;
  return scree_orient3(corner[0], corner[1], corner[2], p) == side ? 0 : side;
}

static bool ray_misses(const scree_box *box, const double *p) {
  return box->high.x < p[0] || box->low.y > p[1] || box->high.y < p[1] || box->low.z > p[2] ||
         box->high.z < p[2];
}

/* A facet that a ray goes through. */
typedef struct hit {
  uint32_t label;
  int side;
} hit;

typedef struct hits {
  hit *items;
  size_t count, capacity;
} hits;

SCREE_ORDER_BY(compare_hits, hit, label)

static bool shoot(const scree_shells *shells, const scree_facet_tree *tree, uint32_t own,
                  uint32_t start, hits *found) {
  const scree_mesh *mesh = tree->mesh;
  const double *p = mesh->positions + 3 * (size_t)start;
  scree_tree_walk walk;
  found->count = 0;
  scree_tree_start(&walk, &tree->tree);
  for (const scree_tree_node *n; (n = scree_tree_next(&walk));) {
    if (ray_misses(&n->box, p) || scree_tree_enter(&walk, n)) continue;
    for (uint32_t i = n->first; i < n->first + n->count; i++) {
      uint32_t facet = tree->tree.order[i], label = shells->label[facet];
      if (label == SCREE_NO_SHELL || label == own || !shells->items[label].closed) continue;
      int side = crossing(mesh, facet, p);
      if (side && !SCREE_PUSH(found, (hit){label, side})) return false;
    }
  }
  if (found->count) qsort(found->items, found->count, sizeof *found->items, compare_hits);
  return true;
}

/* Adds up the hits of each shell that this one does not meet; the shells around it go to the front
 * of found, once each. */
static void wind_around(scree_shells *shells, uint32_t own, const scree_shell_pairs *pairs,
                        hits *found) {
  scree_shell *shell = &shells->items[own];
  size_t kept = 0;
  shell->around = 0;
  for (size_t i = 0; i < found->count;) {
    long long winding = 0;
    uint32_t label = found->items[i].label;
    for (; i < found->count && found->items[i].label == label; i++) winding += found->items[i].side;
    if (do_meet(pairs, own, label)) continue;
    shell->around += winding;
    if (winding) found->items[kept++].label = label;
  }
  shell->depth = (long long)(found->count = kept);
}

static void mark_met(scree_shells *shells, const scree_shell_pairs *pairs) {
  for (size_t i = 0; pairs && i < pairs->count; i++)
    shells->items[pairs->keys[i] >> 32].met = shells->items[(uint32_t)pairs->keys[i]].met = true;
}

scree_status scree_shells_wind(scree_shells *shells, const scree_shell_pairs *pairs,
                               const scree_facet_tree *tree, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) hits found = {0};
  SCREE_CLEANUP(scree_free_at) uint32_t *start = NULL;
  SCREE_TRY(make_starts(shells, tree->mesh, &start, error));
  mark_met(shells, pairs);
  /* the depths are made first: outermost asks for those of others */
  for (int pass = 0; pass < 2; pass++)
    for (uint32_t i = 0; i < shells->count; i++) {
      scree_shell *shell = &shells->items[i];
      if (!shell->closed || (pass && shell->depth == 0)) continue;
      if (!shoot(shells, tree, i, start[i], &found))
        return scree_fail_memory(error, found.capacity * sizeof(hit), "the nesting of shells");
      wind_around(shells, i, pairs, &found);
      shell->outermost = SCREE_NO_SHELL;
      for (size_t j = 0; pass && j < found.count; j++)
        if (shells->items[found.items[j].label].depth == 0) shell->outermost = found.items[j].label;
    }
  return SCREE_OK;
}

scree_shell_kind scree_shell_kind_of(const scree_shell *shell) {
  if (!shell->closed) return SCREE_SHELL_OPEN;
  if (shell->volume > 0) return shell->around == 0 ? SCREE_SHELL_BODY : SCREE_SHELL_NESTED;
  if (shell->around == 1) return SCREE_SHELL_CAVITY;
  return shell->around > 1 ? SCREE_SHELL_NESTED : SCREE_SHELL_INSIDE_OUT;
}
