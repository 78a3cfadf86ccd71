/* What is wrong with a surface: topology (mesh/topology.c), meetings of facets
 * (mesh/index/meetings.c) and the nesting of shells (mesh/repair/shells.c) put together, and a
 * verdict.
 *
 * The volume of a solid is that where the winding number is positive. Where no facets meet, each
 * shell bounds one region against one other: outward shells in empty space add their volume, inward
 * ones in material take theirs away, and shells in material that are no cavities change nothing.
 * Where facets meet it is counted piece by piece (mesh/measure/union_volume.c). Open or inside-out
 * shells leave the volume unknown. */
#include "mesh/repair/repair.h"

#include "base/alloc.h"
#include "base/parallel.h"
#include "base/path.h"
#include "base/sum.h"
#include "mesh/adjacency.h"
#include "mesh/index/apart.h"
#include "mesh/index/intersect.h"
#include "mesh/measure/bounds.h"
#include "mesh/mesh.h"
#include "mesh/repair/shells.h"

#include <string.h>

/* What reading and welding accept, m; far within the range of the exact predicates. */
#define LARGEST_COORDINATE 1e30

/* Fewer facets are looked at as they are. */
enum { PROOF_FACETS = 2000 };

static const struct {
  const char *name, *one, *several;
  bool grave;
} defects[] = {
#define DEFECT_ROW(name, key, grave, one, several) {key, one, several, grave},
    SCREE_DEFECT_LIST(DEFECT_ROW)
#undef DEFECT_ROW
};

const char *scree_defect_name(scree_defect defect) {
  return (unsigned)defect < SCREE_DEFECT_COUNT ? defects[defect].name : "unknown";
}

const char *scree_defect_text(scree_defect defect, size_t count) {
  if ((unsigned)defect >= SCREE_DEFECT_COUNT) return "unknown";
  return count == 1 ? defects[defect].one : defects[defect].several;
}

bool scree_defect_is_grave(scree_defect defect) {
  return (unsigned)defect < SCREE_DEFECT_COUNT && defects[defect].grave;
}

bool scree_defect_is_counted(const scree_check *check, scree_defect defect) {
  return !check->too_many_pairs || defect < SCREE_DEFECT_INSIDE_OUT_SHELL ||
         defect > SCREE_DEFECT_EXTRA_BODY;
}

scree_check_options scree_default_check_options(void) {
  return (scree_check_options){.intersections = true};
}

/* ---- Counting ---- */

static scree_status verify_indices(const scree_mesh *mesh, scree_error *error) {
  if (mesh->triangle_count > (UINT32_MAX - 1) / 3)
    return scree_fail(error, SCREE_LIMIT, "the mesh has %zu triangles; the limit is %u",
                      mesh->triangle_count, (UINT32_MAX - 1) / 3);
  size_t stray = scree_mesh_stray_corner(mesh);
  if (stray != SIZE_MAX)
    return scree_fail(error, SCREE_BAD_MESH,
                      "triangle %zu names vertex %u, but there are only %zu vertices", stray / 3,
                      mesh->triangles[stray], mesh->vertex_count);
  return SCREE_OK;
}

bool scree_vertex_is_bad(const double *position) {
  for (int k = 0; k < 3; k++)
    if (!(fabs(position[k]) <= LARGEST_COORDINATE)) return true;
  return false;
}

static void take_topology(const scree_topology *t, scree_check *check) {
  size_t *defect = check->defects;
  defect[SCREE_DEFECT_DEGENERATE_FACET] = t->degenerate_facet_count;
  defect[SCREE_DEFECT_DUPLICATE_FACET] = t->duplicate_facet_count;
  defect[SCREE_DEFECT_BOUNDARY_EDGE] = t->boundary_edge_count;
  defect[SCREE_DEFECT_HOLE] = t->boundary_count;
  defect[SCREE_DEFECT_NON_MANIFOLD_EDGE] = t->non_manifold_edge_count;
  defect[SCREE_DEFECT_NON_MANIFOLD_VERTEX] = t->non_manifold_vertex_count;
  defect[SCREE_DEFECT_INCONSISTENT_EDGE] = t->inconsistent_edge_count;
  defect[SCREE_DEFECT_UNUSED_VERTEX] = t->unused_vertex_count;
}

static scree_status need_tree(const scree_mesh *mesh, scree_facet_tree *tree, scree_error *error) {
  return tree->mesh ? SCREE_OK : scree_facet_tree_build(mesh, tree, error);
}

static scree_status count_meetings(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                   const scree_shells *shells, scree_searched *searched,
                                   const scree_progress *progress, scree_facet_tree *tree,
                                   scree_shell_pairs *pairs, scree_check *check,
                                   scree_error *error) {
  SCREE_CLEANUP(scree_free_at) scree_meetings found = {0};
  SCREE_TRY(
      scree_searched_meetings(searched, mesh, tree, SCREE_PAIR_LIMIT, progress, &found, error));
  check->intersections_known = true;
  if (found.truncated) {
    check->too_many_pairs = true;
    return SCREE_OK;
  }
  for (size_t i = 0; i < found.count; i++) {
    scree_meet meet = found.items[i].meet;
    check->defects[meet == SCREE_MEET_CROSS   ? SCREE_DEFECT_CROSSING_PAIR
                   : meet == SCREE_MEET_TOUCH ? SCREE_DEFECT_TOUCHING_PAIR
                                              : SCREE_DEFECT_OVERLAPPING_PAIR]++;
  }
  SCREE_TRY(scree_shell_pairs_find(shells, &found, pairs, error));
  check->defects[SCREE_DEFECT_OVERLAPPING_SHELLS] = pairs->count;
  if (found.count == 0 || !scree_shells_closed(shells)) return SCREE_OK;
  SCREE_TRY(need_tree(mesh, tree, error));
  return scree_union_volume(tree, adjacency, &found, &check->volume, &check->volume_known, error);
}

/* An inward shell that meets others may be a pocket in the wall of one: where the union's volume is
 * known, no winding number is negative, and so it is. */
static scree_shell_kind kind_in(const scree_check *check, const scree_shell *shell) {
  scree_shell_kind kind = scree_shell_kind_of(shell);
  return kind == SCREE_SHELL_INSIDE_OUT && shell->met && check->volume_known ? SCREE_SHELL_CAVITY
                                                                             : kind;
}

static void count_kinds(const scree_shells *shells, scree_check *check) {
  size_t kinds[SCREE_SHELL_INSIDE_OUT + 1] = {0};
  scree_sum volume = {0};
  for (size_t i = 0; i < shells->count; i++) {
    scree_shell_kind kind = kind_in(check, &shells->items[i]);
    kinds[kind]++;
    if (kind == SCREE_SHELL_BODY || kind == SCREE_SHELL_CAVITY)
      scree_sum_add(&volume, shells->items[i].volume);
  }
  size_t *defect = check->defects, bodies = kinds[SCREE_SHELL_BODY];
  defect[SCREE_DEFECT_INSIDE_OUT_SHELL] = kinds[SCREE_SHELL_INSIDE_OUT];
  defect[SCREE_DEFECT_NESTED_SHELL] = kinds[SCREE_SHELL_NESTED];
  defect[SCREE_DEFECT_CAVITY] = kinds[SCREE_SHELL_CAVITY];
  defect[SCREE_DEFECT_EXTRA_BODY] = bodies > 1 ? bodies - 1 : 0;
  bool met = defect[SCREE_DEFECT_CROSSING_PAIR] || defect[SCREE_DEFECT_TOUCHING_PAIR] ||
             defect[SCREE_DEFECT_OVERLAPPING_PAIR];
  if (!met) {
    check->volume_known = check->intersections_known && shells->count && !kinds[SCREE_SHELL_OPEN];
    check->volume = scree_sum_value(volume);
  }
  if (kinds[SCREE_SHELL_INSIDE_OUT]) check->volume_known = false;
  if (!check->volume_known) check->volume = 0;
}

/* Walks over the same surface, beside each other: shells, sharp edges, the parts of the topology.
 */
enum { WALKS = 2 + SCREE_TOPOLOGY_PARTS };
typedef struct connection {
  const scree_mesh *mesh;
  const scree_adjacency *adjacency;
  scree_topology topology;
  scree_shells shells;
  size_t sharp_count;
  scree_status status[WALKS];
  scree_error error[WALKS];
} connection;

static void connect(void *context, scree_block block) {
  connection *c = context;
  c->status[block.index] = SCREE_OK;
  if (block.index == 0)
    c->status[block.index] =
        scree_shells_find(c->mesh, c->adjacency, &c->shells, &c->error[block.index]);
  else if (block.index == 1)
    c->sharp_count = scree_sharp_edges(c->mesh, c->adjacency, NULL);
  else
    c->status[block.index] = scree_topology_count(c->mesh, c->adjacency, block.index - 2,
                                                  &c->topology, &c->error[block.index]);
}

/* Topology and shells. */
static scree_status find_connection(const scree_mesh *mesh, const scree_adjacency *adjacency,
                                    scree_check *check, scree_shells *shells, scree_error *error) {
  connection c = {.mesh = mesh, .adjacency = adjacency};
  scree_parallel_for(WALKS, 1, connect, &c);
  *shells = c.shells;
  for (int walk = 0; walk < WALKS; walk++) {
    if (c.status[walk] == SCREE_OK) continue;
    if (error) *error = c.error[walk];
    return c.status[walk];
  }
  SCREE_TRY(scree_topology_finish(mesh, adjacency, &c.topology, error));
  take_topology(&c.topology, check);
  check->defects[SCREE_DEFECT_SHARP_EDGE] = c.sharp_count;
  return SCREE_OK;
}

/* The facets at every vertex hang together. */
static bool fans_are_whole(const scree_check *check) {
  return !check->defects[SCREE_DEFECT_NON_MANIFOLD_VERTEX] &&
         !check->defects[SCREE_DEFECT_DEGENERATE_FACET];
}

/* Whether some edge has so many facets that pairs of these alone, each with each, would take too
 * long. Such a surface is of no use anyway. */
static bool has_crowded_edge(const scree_adjacency *adjacency) {
  enum { CROWD = 8192 };
  for (size_t e = 0; e < adjacency->edge_count; e++)
    if (scree_edge_facet_count(adjacency, adjacency->edges[e]) > CROWD) return true;
  return false;
}

static scree_status examine(const scree_mesh *mesh, const scree_check_options *options,
                            scree_searched *searched, const scree_progress *progress,
                            scree_check *check, scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_CLEANUP(scree_shells_free) scree_shells shells = {0};
  SCREE_CLEANUP(scree_free_at) scree_shell_pairs pairs = {0};
  SCREE_CLEANUP(scree_facet_tree_free) scree_facet_tree tree = {0};
  SCREE_TRY(scree_adjacency_build(mesh, &adjacency, error));
  SCREE_TRY(find_connection(mesh, &adjacency, check, &shells, error));
  check->shell_count = shells.count;
  if (mesh->triangle_count == 0) return SCREE_OK;
  bool clear = false; /* the tree is dear: a clean scan of one shell does without */
  if (options->intersections && shells.count == 1 && mesh->triangle_count >= PROOF_FACETS)
    SCREE_TRY(scree_facets_apart(mesh, fans_are_whole(check) ? &adjacency : NULL, &clear, error));
  check->intersections_known = clear;
  bool look = options->intersections && !clear && !has_crowded_edge(&adjacency);
  if (look)
    SCREE_TRY(
        count_meetings(mesh, &adjacency, &shells, searched, progress, &tree, &pairs, check, error));
  if (check->too_many_pairs) return SCREE_OK;
  if (shells.count > 1) {
    SCREE_TRY(need_tree(mesh, &tree, error));
    SCREE_TRY(scree_shells_wind(&shells, &pairs, &tree, error));
  }
  count_kinds(&shells, check);
  return SCREE_OK;
}

/* ---- The verdict ---- */

/* "1 non manifold edge", "12 boundary edges": the name is a plural. */
static void add_count(scree_check *check, size_t count, const char *name) {
  static const struct {
    const char *several, *one;
  } endings[] = {{"vertices", "vertex"}, {"ies", "y"}, {"s", ""}};
  char words[96];
  snprintf(words, sizeof words, "%zu %s", count, name);
  for (size_t i = 0; count == 1 && i < sizeof endings / sizeof *endings; i++) {
    if (!scree_ends_with(words, endings[i].several)) continue;
    size_t begin = strlen(words) - strlen(endings[i].several);
    snprintf(words + begin, sizeof words - begin, "%s", endings[i].one);
    break;
  }
  for (char *c = words; *c; c++)
    if (*c == '_') *c = ' ';
  SCREE_ADD_TEXT(check->verdict, "%s", words);
}

static void add_defects(scree_check *check, bool grave) {
  const char *between = "";
  if (grave && check->too_many_pairs) {
    SCREE_ADD_TEXT(check->verdict, "more than %d meeting pairs", SCREE_PAIR_LIMIT);
    between = ", ";
  }
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++) {
    if (!check->defects[i] || defects[i].grave != grave) continue;
    SCREE_ADD_TEXT(check->verdict, "%s", between);
    between = ", ";
    add_count(check, check->defects[i], defects[i].name);
  }
}

static void conclude(scree_check *check) {
  bool grave = check->too_many_pairs, noted = false;
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++) {
    grave |= check->defects[i] && defects[i].grave;
    noted |= check->defects[i] && !defects[i].grave;
  }
  check->usable = !grave && check->triangle_count > 0;
  SCREE_ADD_TEXT(check->verdict, "%s",
                 check->triangle_count == 0 ? "not usable as a particle: no facets"
                 : grave                    ? "not usable as a particle: "
                                            : "usable as a particle: closed, manifold, outward");
  if (check->triangle_count && grave) add_defects(check, true);
  if (check->usable)
    SCREE_ADD_TEXT(check->verdict, "%s",
                   check->intersections_known ? ", nowhere meeting itself"
                                              : "; self-intersections were not looked for");
  if (!noted) return;
  SCREE_ADD_TEXT(check->verdict, "; with ");
  add_defects(check, false);
}

scree_status scree_mesh_check(const scree_mesh *mesh, const scree_check_options *options,
                              const scree_progress *progress, scree_check *check,
                              scree_error *error) {
  return scree_check_searched(mesh, options, NULL, progress, check, error);
}

scree_status scree_check_searched(const scree_mesh *mesh, const scree_check_options *options,
                                  scree_searched *searched, const scree_progress *progress,
                                  scree_check *check, scree_error *error) {
  scree_check_options defaults = scree_default_check_options();
  scree_check made = {.triangle_count = mesh->triangle_count, .vertex_count = mesh->vertex_count};
  SCREE_TRY(verify_indices(mesh, error));
  for (size_t v = 0; v < mesh->vertex_count; v++)
    made.defects[SCREE_DEFECT_BAD_COORDINATE] += scree_vertex_is_bad(mesh->positions + 3 * v);
  bool finite = !made.defects[SCREE_DEFECT_BAD_COORDINATE];
  if (finite && mesh->triangle_count) {
    vec3 low, high;
    scree_mesh_bounds(mesh, &low, &high);
    vec3_store(made.size, vec3_sub(high, low));
  }
  if (finite)
    SCREE_TRY(examine(mesh, options ? options : &defaults, searched, progress, &made, error));
  conclude(&made);
  *check = made;
  return SCREE_OK;
}
