/* Shells: scraps and debris dropped, the rest turned outside out, what lies inside material
 * dropped, and facets cut out where a shell meets itself.
 *
 * A shell with nothing around it bounds material, whatever its winding was: an outermost shell that
 * is inward is turned, and all shells within it are, so that a scan that is inside out as a whole
 * keeps its cavities. An inward shell that then still has no material around it is turned alone. An
 * outward shell within material adds nothing to the union and is dropped; an inward one is a cavity
 * and stays. None of this is done to a shell that meets another: what is inside what has no answer
 * there; and while it may be merged with the other it is no debris: together they are one body. */
#include "base/alloc.h"
#include "base/radix.h"
#include "mesh/repair/repair.h"

#include <stdlib.h>
#include <string.h>

enum {
  MEETING_LIMIT = 4000000, /* more, and cutting is hopeless */
  TURNS = 64,              /* depth of shells in shells that is set right */
};

/* No more than this share of the facets is cut out: beyond it, it is no local repair. */
#define CUT_SHARE 0.1

/* An open shell is a flat sheet where it bounds no more than this share of its area to the power of
 * 3/2: filled, it would lie on itself. */
#define FLAT_SHARE 1e-3

typedef struct nest {
  scree_adjacency adjacency;
  scree_shells shells;
  scree_facet_tree tree; /* empty where there is one shell */
  scree_shell_pairs pairs;
  bool all_tangled; /* there are more meetings than were looked for */
  bool *drop;       /* by shell */
  double largest_area;
} nest;

static void free_nest(nest *n) {
  scree_adjacency_free(&n->adjacency);
  scree_shells_free(&n->shells);
  scree_facet_tree_free(&n->tree);
  scree_free(n->pairs.keys);
  scree_free(n->drop);
}

static scree_status find_nest(const scree_repair *r, nest *n, scree_error *error) {
  SCREE_TRY(scree_adjacency_build(&r->mesh, &n->adjacency, error));
  SCREE_TRY(scree_shells_find(&r->mesh, &n->adjacency, &n->shells, error));
  if (n->shells.count > 1) SCREE_TRY(scree_facet_tree_build(&r->mesh, &n->tree, error));
  SCREE_TRY_ALLOC_ZERO(n->drop, n->shells.count, error);
  for (size_t i = 0; i < n->shells.count; i++)
    n->largest_area = fmax(n->largest_area, n->shells.items[i].area);
  return SCREE_OK;
}

/* Removes the facets of the shells marked. What they enclosed is not lost by cutting or merging. */
static scree_status drop_shells(scree_repair *r, const nest *n, scree_error *error) {
  SCREE_SCRATCH(bool, marked, r->mesh.triangle_count, error);
  for (size_t i = 0; i < n->shells.count; i++) {
    const scree_shell *s = &n->shells.items[i];
    if (n->drop[i] && s->closed && scree_shell_kind_of(s) != SCREE_SHELL_NESTED)
      r->volume -= s->volume;
  }
  for (size_t t = 0; t < r->mesh.triangle_count; t++)
    marked[t] = n->shells.label[t] != SCREE_NO_SHELL && n->drop[n->shells.label[t]];
  scree_facets_drop(&r->mesh, marked);
  return SCREE_OK;
}

static bool is_flat_sheet(const scree_shell *s) {
  return !s->closed && fabs(s->volume) <= FLAT_SHARE * s->area * sqrt(s->area);
}

/* Small open shells and, beside a larger one that is none, flat sheets, as labels are in scans. */
scree_status scree_repair_scraps(scree_repair *r, scree_error *error) {
  SCREE_CLEANUP(free_nest) nest n = {0};
  SCREE_TRY(find_nest(r, &n, error));
  size_t count = 0;
  double largest_body = 0;
  for (size_t i = 0; i < n.shells.count; i++)
    if (!is_flat_sheet(&n.shells.items[i]))
      largest_body = fmax(largest_body, n.shells.items[i].area);
  for (size_t i = 0; i < n.shells.count; i++) {
    const scree_shell *s = &n.shells.items[i];
    double least = r->options->debris_share * n.largest_area;
    n.drop[i] = !s->closed &&
                (s->area < least || (least > 0 && is_flat_sheet(s) && s->area < largest_body));
    count += n.drop[i];
  }
  if (count) SCREE_TRY(drop_shells(r, &n, error));
  r->report.done[SCREE_REPAIR_DROP_DEBRIS] += count;
  return SCREE_OK;
}

/* ---- Outside out ---- */

static void turn_shells(scree_repair *r, nest *n, const bool *turn) {
  for (size_t t = 0; t < r->mesh.triangle_count; t++) {
    uint32_t label = n->shells.label[t];
    if (label != SCREE_NO_SHELL && turn[label]) scree_corners_turn(r->mesh.triangles + 3 * t);
  }
  for (size_t i = 0; i < n->shells.count; i++) {
    if (!turn[i]) continue;
    n->shells.items[i].volume = -n->shells.items[i].volume;
    r->report.done[SCREE_REPAIR_INVERT_SHELL]++;
  }
}

static scree_status find_pairs(const scree_repair *r, nest *n, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) scree_meetings found = {0};
  if (!r->options->intersections || r->untangled || n->shells.count < 2) return SCREE_OK;
  SCREE_TRY(scree_facet_meetings(&n->tree, MEETING_LIMIT, r->progress, &found, error));
  n->all_tangled = found.truncated;
  return scree_shell_pairs_find(&n->shells, &found, &n->pairs, error);
}

static scree_status wind_shells(nest *n, scree_error *error) {
  return n->shells.count > 1 ? scree_shells_wind(&n->shells, &n->pairs, &n->tree, error) : SCREE_OK;
}

/* Whether the shell meets another; once they are wound. */
static bool is_tangled(const nest *n, size_t shell) {
  return n->all_tangled || n->shells.items[shell].met;
}

/* Marks inward outermost shells with all that lies in them; true where there are any. */
static bool mark_inverted_nests(const nest *n, bool *turn) {
  bool any = false;
  for (size_t i = 0; i < n->shells.count; i++) {
    const scree_shell *s = &n->shells.items[i];
    const scree_shell *out = s->outermost == SCREE_NO_SHELL ? s : &n->shells.items[s->outermost];
    bool outer_tangled = is_tangled(n, (size_t)(out - n->shells.items));
    turn[i] = s->closed && !is_tangled(n, i) && !outer_tangled && out->volume < 0;
    any |= turn[i];
  }
  return any;
}

static bool mark_inverted(const nest *n, bool *turn) {
  bool any = false;
  long long least = 0;
  for (size_t i = 0; i < n->shells.count; i++) {
    const scree_shell *s = &n->shells.items[i];
    turn[i] = scree_shell_kind_of(s) == SCREE_SHELL_INSIDE_OUT && !is_tangled(n, i);
    if (turn[i] && (!any || s->depth < least)) least = s->depth;
    any |= turn[i];
  }
  /* the outer ones first: turning them may make cavities of the others */
  for (size_t i = 0; i < n->shells.count; i++)
    turn[i] = turn[i] && n->shells.items[i].depth == least;
  return any;
}

static scree_status turn_outward(scree_repair *r, nest *n, scree_error *error) {
  SCREE_SCRATCH(bool, turn, n->shells.count, error);
  SCREE_TRY(wind_shells(n, error));
  if (mark_inverted_nests(n, turn)) {
    turn_shells(r, n, turn);
    SCREE_TRY(wind_shells(n, error));
  }
  for (int i = 0; i < TURNS && mark_inverted(n, turn); i++) {
    turn_shells(r, n, turn);
    SCREE_TRY(wind_shells(n, error));
  }
  return SCREE_OK;
}

/* ---- What stays ---- */

/* The largest shell, bodies alone or any, that comes after this one by area; the count of shells
 * where there is none. after NO_SHELL: of all. */
static size_t next_largest(const nest *n, bool bodies, size_t after) {
  const scree_shell *items = n->shells.items;
  size_t found = n->shells.count;
  for (size_t i = 0; i < n->shells.count; i++) {
    if (bodies && scree_shell_kind_of(&items[i]) != SCREE_SHELL_BODY) continue;
    bool later = after == SCREE_NO_SHELL || items[i].area < items[after].area ||
                 (items[i].area == items[after].area && i > after);
    if (later && (found == n->shells.count || items[i].area > items[found].area)) found = i;
  }
  return found;
}

static size_t count_bodies(const nest *n) {
  size_t count = 0;
  for (size_t i = 0; i < n->shells.count; i++)
    count += scree_shell_kind_of(&n->shells.items[i]) == SCREE_SHELL_BODY;
  return count;
}

/* That which is kept where only one is. */
static size_t chosen_shell(const nest *n, size_t body) {
  if (body < 2 || count_bodies(n) < 2) return next_largest(n, false, SCREE_NO_SHELL);
  size_t found = SCREE_NO_SHELL;
  for (size_t k = 0; k < body; k++) found = next_largest(n, true, found);
  return found;
}

static scree_status verify_body(const scree_repair *r, const nest *n, scree_error *error) {
  size_t bodies = count_bodies(n), body = r->options->keep_body;
  if (body <= bodies || bodies < 2) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_ARGUMENT, "there is no body %zu: there are %zu", body, bodies);
}

static void judge_shells(scree_repair *r, nest *n) {
  const scree_repair_options *o = r->options;
  const bool one = o->keep_largest || o->keep_body > 0;
  size_t *done = r->report.done, kept = chosen_shell(n, o->keep_body);
  for (size_t i = 0; i < n->shells.count; i++) {
    const scree_shell *s = &n->shells.items[i];
    scree_shell_kind kind = scree_shell_kind_of(s);
    bool cavity = kind == SCREE_SHELL_CAVITY && !is_tangled(n, i);
    bool of_kept = cavity && s->depth == 1 && s->outermost == kept;
    bool waits = is_tangled(n, i) && !r->apart; /* it is to be merged first */
    if (cavity && o->drop_cavities) {
      n->drop[i] = true;
      done[SCREE_REPAIR_DROP_CAVITY]++;
    } else if (kind == SCREE_SHELL_NESTED && !is_tangled(n, i)) {
      n->drop[i] = true;
      done[SCREE_REPAIR_DROP_NESTED]++;
    } else if (!waits && i != kept &&
               ((!cavity && s->area < o->debris_share * n->largest_area) || (one && !of_kept))) {
      n->drop[i] = true;
      done[SCREE_REPAIR_DROP_DEBRIS]++;
    }
  }
}

/* ---- Small cavities ---- */

typedef struct cavity {
  double volume;
  size_t shell;
} cavity;

SCREE_ORDER_BY2(compare_cavities, cavity, volume, shell)

/* Marks them from the smallest on, as long as all that was filled stays under the share. */
static scree_status fill_cavities(scree_repair *r, nest *n, scree_error *error) {
  size_t count = 0;
  double held = 0, *filled = &r->report.filled_volume;
  SCREE_SCRATCH(cavity, cavities, n->shells.count, error);
  for (size_t i = 0; i < n->shells.count; i++) {
    const scree_shell *s = &n->shells.items[i];
    scree_shell_kind kind = scree_shell_kind_of(s);
    if (kind == SCREE_SHELL_BODY) held += s->volume;
    if (kind == SCREE_SHELL_CAVITY && !is_tangled(n, i) && !n->drop[i])
      cavities[count++] = (cavity){-s->volume, i};
  }
  if (count) qsort(cavities, count, sizeof *cavities, compare_cavities);
  for (size_t i = 0; i < count; i++) {
    if (*filled + cavities[i].volume > r->options->cavity_share * held) break;
    *filled += cavities[i].volume;
    n->drop[cavities[i].shell] = true;
    r->report.done[SCREE_REPAIR_FILL_CAVITY]++;
  }
  return SCREE_OK;
}

scree_status scree_repair_outward(scree_repair *r, scree_error *error) {
  SCREE_CLEANUP(free_nest) nest n = {0};
  SCREE_TRY(find_nest(r, &n, error));
  SCREE_TRY(find_pairs(r, &n, error));
  return turn_outward(r, &n, error);
}

scree_status scree_repair_shells(scree_repair *r, scree_error *error) {
  SCREE_CLEANUP(free_nest) nest n = {0};
  SCREE_TRY(find_nest(r, &n, error));
  SCREE_TRY(find_pairs(r, &n, error));
  SCREE_TRY(turn_outward(r, &n, error));
  SCREE_TRY(verify_body(r, &n, error));
  judge_shells(r, &n);
  SCREE_TRY(fill_cavities(r, &n, error));
  return drop_shells(r, &n, error);
}

/* ---- Cutting ---- */

/* Marks the facets that have a vertex with a marked one. */
static void grow_marks(const scree_mesh *mesh, bool *marked, bool *vertex) {
  memset(vertex, 0, mesh->vertex_count);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
    if (marked[c / 3]) vertex[mesh->triangles[c]] = true;
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
    if (vertex[mesh->triangles[c]]) marked[c / 3] = true;
}

static void mark_meetings(const scree_meetings *found, const scree_shells *shells, bool *marked) {
  for (size_t i = 0; i < found->count; i++) {
    const scree_meeting *m = &found->items[i];
    if (shells->label[m->first] == shells->label[m->second])
      marked[m->first] = marked[m->second] = true;
  }
}

/* The share of the facets that is marked: areas would say little, facets that cross are often long.
 */
static double marked_share(const scree_mesh *mesh, const bool *marked) {
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; t++) count += marked[t];
  return (double)count / (double)mesh->triangle_count;
}

scree_status scree_repair_cut(scree_repair *r, int rings, size_t *cut_count, bool *clear,
                              scree_error *error) {
  SCREE_CLEANUP(free_nest) nest n = {0};
  SCREE_CLEANUP(scree_free_at) scree_meetings found = {0};
  *cut_count = 0;
  SCREE_TRY(scree_searched_meetings(&r->searched, &r->mesh, NULL, MEETING_LIMIT, r->progress,
                                    &found, error));
  *clear = found.count + r->report.after.defects[SCREE_DEFECT_SHARP_EDGE] == 0;
  if (found.truncated || *clear) return SCREE_OK;
  SCREE_TRY(find_nest(r, &n, error));
  SCREE_SCRATCH_ZERO(bool, marked, r->mesh.triangle_count, error);
  SCREE_SCRATCH(bool, vertex, r->mesh.vertex_count, error);
  mark_meetings(&found, &n.shells, marked);
  scree_sharp_edges(&r->mesh, &n.adjacency, marked);
  for (int i = 0; i < rings; i++) grow_marks(&r->mesh, marked, vertex);
  if (marked_share(&r->mesh, marked) <= CUT_SHARE) *cut_count = scree_facets_drop(&r->mesh, marked);
  r->report.done[SCREE_REPAIR_CUT_INTERSECTION] += *cut_count;
  return SCREE_OK;
}
