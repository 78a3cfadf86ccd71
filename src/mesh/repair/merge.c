/* Shells that overlap, cross or touch become one surface: that of the space where the winding
 * number is positive.
 *
 * All facets are cut where they meet (mesh/repair/arrange.c). What then hangs together over edges
 * of two facets has the same winding numbers on either side everywhere, so one facet is asked for
 * all (mesh/index/winding.c); they bound the union where the winding number is positive on one side
 * only. Edges and vertices at which the union touches itself are left to the stages for those. */
#include "base/alloc.h"
#include "base/rng.h"
#include "mesh/index/winding.h"
#include "mesh/repair/arrange.h"
#include "mesh/repair/repair.h"
#include "mesh/repair/rim.h"

enum {
  ATTEMPTS = 32, /* sample points of a patch; one in general position is all but sure */
  LOOKS = 256,   /* beside facets that meet */
};

/* So far from a facet, as a share of its size, a point lies beside it whatever rounding does. */
#define BESIDE 1e-3

static const char inward[] = "where they cross, one is wound inward";

typedef struct merger {
  scree_meetings found;
  scree_arrangement parts;
  scree_adjacency adjacency;
  scree_facet_tree tree;
  uint32_t *patch;   /* by facet: union-find over edges of two facets */
  uint32_t *speaker; /* by root: the largest facet */
  bool *keep;        /* by root */
} merger;

static void free_merger(merger *m) {
  scree_free(m->found.items);
  scree_arrangement_free(&m->parts);
  scree_adjacency_free(&m->adjacency);
  scree_facet_tree_free(&m->tree);
  SCREE_FREE_ALL(m->patch, m->speaker, m->keep);
}

/* ---- What is merged ---- */

typedef struct tangle {
  bool closed;        /* every edge is used equally often both ways */
  bool any, between;  /* facets meet; those of different shells do */
  size_t crowded;     /* edges with more than two facets: shells that share edges count as one */
  size_t shell_count; /* that meet another or themselves */
} tangle;

static scree_status count_tangled(const scree_shells *shells, const scree_meetings *found,
                                  tangle *t, scree_error *error) {
  SCREE_SCRATCH_ZERO(bool, tangled, shells->count, error);
  for (size_t i = 0; i < found->count; i++) {
    uint32_t a = shells->label[found->items[i].first], b = shells->label[found->items[i].second];
    if (a == SCREE_NO_SHELL || b == SCREE_NO_SHELL) continue;
    tangled[a] = tangled[b] = t->any = true;
    if (a != b) t->between = true;
  }
  for (size_t i = 0; i < shells->count; i++) t->shell_count += tangled[i];
  return SCREE_OK;
}

static scree_status find_tangle(scree_repair *r, tangle *t, scree_meetings *found,
                                scree_error *error) {
  SCREE_CLEANUP(scree_adjacency_free) scree_adjacency adjacency = {0};
  SCREE_CLEANUP(scree_shells_free) scree_shells shells = {0};
  size_t open;
  *t = (tangle){.closed = false};
  SCREE_TRY(scree_adjacency_build(&r->mesh, &adjacency, error));
  SCREE_TRY(scree_shells_find(&r->mesh, &adjacency, &shells, error));
  t->closed = scree_shells_closed(&shells);
  scree_rim_count(&adjacency, &open, &t->crowded);
  if (!t->closed) return SCREE_OK;
  SCREE_TRY(scree_searched_meetings(&r->searched, &r->mesh, NULL, scree_arrange_limit(&r->mesh),
                                    r->progress, found, error));
  if (found->truncated) r->unmerged = scree_arrange_too_many;
  return found->truncated ? SCREE_OK : count_tangled(&shells, found, t, error);
}

/* ---- Which side is which ---- */

static void find_patches(merger *m) {
  const scree_mesh *mesh = &m->parts.mesh;
  scree_join_over_edges(mesh, &m->adjacency, true, m->patch);
  for (uint32_t t = 0; t < mesh->triangle_count; t++) {
    uint32_t root = scree_find_root(m->patch, t); /* the lowest: it comes first */
    if (root == t || vec3_norm(scree_facet_normal(mesh, t)) >
                         vec3_norm(scree_facet_normal(mesh, m->speaker[root])))
      m->speaker[root] = t;
  }
}

/* A point of the facet as it is seen, another for each attempt. */
static scree_seen draw(const scree_view *f, scree_rng *rng) {
  double sum = 0;
  scree_seen p = {0, 0};
  for (int k = 0; k < 3; k++) {
    scree_seen q = scree_view_point(f, f->corner[k]);
    double weight = 0.1 + scree_rng_uniform(rng);
    sum += weight;
    p.x += weight * q.x;
    p.y += weight * q.y;
  }
  return (scree_seen){p.x / sum, p.y / sum};
}

/* Whether the facet bounds the union; why not is answered, as the end of a sentence. */
static const char *ask(const scree_winding *w, uint32_t facet, bool folds, bool *keep) {
  scree_view f = scree_view_of(w->tree->mesh, facet);
  scree_rng rng = {.seed = facet};
  for (int attempt = 0; attempt < ATTEMPTS && f.side; attempt++) {
    scree_sides found;
    if (!scree_winding_look(w, facet, &f, draw(&f, &rng), &found)) continue;
    *keep = (found.above > 0) != (found.below > 0);
    if (!folds && (found.above < 0 || found.below < 0)) return inward;
    return NULL;
  }
  return "what is inside and what outside cannot be told";
}

/* Looks on both sides of the first facets that meet for space that is wound inward, which no
 * cutting does away with: folds in the noise of a scan show it at once, and there are thousands to
 * cut. */
static scree_status look_beside(const scree_mesh *mesh, const scree_meetings *found,
                                const char **reason, scree_error *error) {
  SCREE_CLEANUP(scree_facet_tree_free) scree_facet_tree tree = {0};
  scree_rng rng = {.seed = LOOKS};
  SCREE_TRY(scree_facet_tree_build(mesh, &tree, error));
  scree_winding w = {.tree = &tree, .rounding = scree_winding_rounding(&tree)};
  for (size_t i = 0; i < LOOKS && i / 4 < found->count && !*reason; i++) {
    uint32_t t = i % 2 ? found->items[i / 4].first : found->items[i / 4].second;
    vec3 normal = scree_facet_normal(mesh, t);
    double corner[3][3], way = (i & 2 ? BESIDE : -BESIDE) / sqrt(vec3_norm(normal));
    for (int k = 0; k < 3; k++)
      vec3_store(corner[k], vec3_mad(scree_mesh_corner(mesh, t, k), normal, way));
    scree_view f = scree_view_of_corners(corner[0], corner[1], corner[2]);
    scree_sides sides;
    if (isfinite(way) && f.side && scree_winding_look(&w, UINT32_MAX, &f, draw(&f, &rng), &sides) &&
        sides.above < 0)
      *reason = inward;
  }
  return SCREE_OK;
}

static scree_status judge_patches(merger *m, bool folds, const char **reason, scree_error *error) {
  const scree_mesh *mesh = &m->parts.mesh;
  bool any = false;
  if (mesh->triangle_count == 0) { /* each facet lies on one that is wound the other way */
    *reason = "they enclose nothing";
    return SCREE_OK;
  }
  SCREE_TRY(scree_adjacency_build(mesh, &m->adjacency, error));
  SCREE_TRY_ALLOC(m->patch, mesh->triangle_count, error);
  SCREE_TRY_ALLOC(m->speaker, mesh->triangle_count, error);
  SCREE_TRY_ALLOC(m->keep, mesh->triangle_count, error);
  find_patches(m);
  SCREE_TRY(scree_facet_tree_build(mesh, &m->tree, error));
  scree_winding w = {
      .tree = &m->tree, .weights = m->parts.weights, .rounding = scree_winding_rounding(&m->tree)};
  for (uint32_t t = 0; t < mesh->triangle_count && !*reason; t++) {
    if (m->patch[t] != t) continue;
    *reason = ask(&w, m->speaker[t], folds, &m->keep[t]);
    any |= !*reason && m->keep[t];
  }
  if (!any && !*reason) *reason = "they enclose nothing";
  return SCREE_OK;
}

/* ---- The surface ---- */

/* The facets kept take the place of the mesh, wound so that the lower winding number is outside. */
static void take_surface(scree_repair *r, merger *m) {
  scree_mesh *mesh = &m->parts.mesh;
  size_t kept = 0;
  for (uint32_t t = 0; t < mesh->triangle_count; t++) {
    if (!m->keep[scree_find_root(m->patch, t)]) continue;
    const uint32_t *v = mesh->triangles + 3 * (size_t)t;
    bool turned = m->parts.weights[t] < 0;
    uint32_t a = v[0], b = v[turned ? 2 : 1], c = v[turned ? 1 : 2];
    uint32_t *out = mesh->triangles + 3 * kept++;
    out[0] = a, out[1] = b, out[2] = c;
  }
  mesh->triangle_count = kept;
  scree_repair_take(r, mesh);
}

scree_status scree_repair_merge(scree_repair *r, bool early, bool *merged, scree_error *error) {
  bool folds = r->options->merge_folds;
  tangle t;
  SCREE_CLEANUP(free_merger) merger m = {.patch = NULL};
  *merged = false;
  r->unmerged = NULL;
  SCREE_TRY(find_tangle(r, &t, &m.found, error));
  if (r->unmerged || !t.closed || !t.any) return SCREE_OK;
  if (early && !folds && !t.between && !t.crowded) return SCREE_OK;
  if (!folds) SCREE_TRY(look_beside(&r->mesh, &m.found, &r->unmerged, error));
  if (r->unmerged) return SCREE_OK;
  SCREE_TRY(scree_arrange(&r->mesh, r->progress, &m.parts, &r->unmerged, error));
  if (!r->unmerged) SCREE_TRY(judge_patches(&m, folds, &r->unmerged, error));
  if (r->unmerged) return SCREE_OK;
  take_surface(r, &m);
  r->report.done[SCREE_REPAIR_MERGE_SHELL] += t.shell_count;
  *merged = true;
  return SCREE_OK;
}
