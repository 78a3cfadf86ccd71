/* The whole of a repair: check, do what the defects found ask for, check again, until nothing is
 * wrong or nothing more can be done.
 *
 * A round begins with the cheap check (no self-intersections). While that finds something, the
 * stages for what it found run, in an order in which each finds what it needs: duplicates and flat
 * facets go, seams and T-junctions close, fins and membranes go, the winding is made to agree,
 * edges of many facets are sorted out by it, open scraps go, holes are filled, and vertices with
 * several fans are split last, because filling joins fans. Once the surface is closed and manifold,
 * shells are put in order. Then the exact check looks for facets that meet; those of one shell are
 * cut out with their neighbourhood, wider each time, shells that meet each other are merged, sharp
 * edges that are too many to cut out are made blunt, and the round starts over.
 *
 * Short handles of the closed surface that comes of it are cut.
 *
 * Every round ends with a weld, so vertices and facets are always in canonical order and the result
 * does not depend on the order of the input. Nothing is called repaired that the check has not
 * passed. */
#include "mesh/repair/repair.h"
#include "base/alloc.h"
#include "base/owned.h"
#include "mesh/measure/surface.h"

#include <math.h>
#include <string.h>

enum {
  ROUNDS = 24,    /* in all; three or four are usual */
  CUT_ROUNDS = 4, /* of these with cutting */
  MERGE_ROUNDS = 3
};

static const struct {
  const char *name, *one, *several;
} actions[] = {
#define ACTION_ROW(name, key, one, several) {key, one, several},
    SCREE_REPAIR_LIST(ACTION_ROW)
#undef ACTION_ROW
};

const char *scree_repair_action_name(scree_repair_action action) {
  return (unsigned)action < SCREE_REPAIR_ACTION_COUNT ? actions[action].name : "unknown";
}

const char *scree_repair_action_text(scree_repair_action action, size_t count) {
  if ((unsigned)action >= SCREE_REPAIR_ACTION_COUNT) return "unknown";
  return count == 1 ? actions[action].one : actions[action].several;
}

scree_repair_options scree_default_repair_options(void) {
  return (scree_repair_options){.seam_tolerance = 1e-4,
                                .hole_share = 0.45,
                                .debris_share = 0.01,
                                .cut_intersections = true,
                                .merge_shells = true,
                                .intersections = true,
                                .cavity_share = 1e-3,
                                .handle_edges = 6,
                                .volume_change = 0.01};
}

static scree_status verify_options(const scree_repair_options *o, scree_error *error) {
  if (!(o->seam_tolerance >= 0 && o->seam_tolerance <= 0.01))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "seam_tolerance is %g; the range is [0, 0.01]",
                      o->seam_tolerance);
  if (!(o->debris_share >= 0 && o->debris_share < 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "debris_share is %g; the range is [0, 1)",
                      o->debris_share);
  if (!(o->hole_share >= 0 && o->hole_share <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "hole_share is %g; the range is [0, 1]",
                      o->hole_share);
  if (!(o->cavity_share >= 0 && o->cavity_share <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "cavity_share is %g; the range is [0, 1]",
                      o->cavity_share);
  if (!(o->volume_change >= 0 && o->volume_change <= 1))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "volume_change is %g; the range is [0, 1]",
                      o->volume_change);
  return SCREE_OK;
}

/* ---- Welding ---- */

void scree_repair_take(scree_repair *r, scree_mesh *mesh) {
  scree_mesh_free(&r->mesh);
  r->mesh = *mesh;
  *mesh = (scree_mesh){0};
  r->vertex_capacity = r->mesh.vertex_count;
  r->triangle_capacity = r->mesh.triangle_count;
  const scree_box box = scree_box_of_points(r->mesh.positions, r->mesh.vertex_count);
  r->diagonal = r->mesh.vertex_count ? vec3_distance(box.low, box.high) : 0;
  vec3 far = vec3_max(vec3_neg(box.low), box.high);
  r->largest = fmax(far.x, fmax(far.y, far.z));
}

/* Replaces the mesh under repair by `mesh` welded exactly and put in canonical order; facets with
 * bad coordinates are left out. mesh may be r->mesh. */
static scree_status weld(scree_repair *r, const scree_mesh *mesh, size_t *bad, size_t *collapsed,
                         scree_error *error) {
  SCREE_CLEANUP(scree_mesh_free) scree_mesh welded = {0};
  SCREE_SCRATCH_ZERO(bool, marked, mesh->triangle_count, error);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++)
    marked[c / 3] |= scree_vertex_is_bad(mesh->positions + 3 * (size_t)mesh->triangles[c]);
  SCREE_TRY(scree_mesh_copy(mesh, &welded, error));
  *bad = scree_facets_drop(&welded, marked);
  for (double *p = welded.positions; p < welded.positions + 3 * welded.vertex_count; p += 3)
    if (scree_vertex_is_bad(p)) memset(p, 0, 3 * sizeof *p); /* no facet names it any more */
  *collapsed = welded.triangle_count;
  SCREE_TRY(scree_mesh_canonicalize(&welded, error));
  *collapsed -= welded.triangle_count;
  scree_repair_take(r, &welded);
  return SCREE_OK;
}

scree_status scree_repair_duplicates(scree_repair *r, scree_error *error) {
  size_t dropped;
  SCREE_TRY(scree_facets_drop_doubles(&r->mesh, &dropped, error));
  r->report.done[SCREE_REPAIR_DROP_DUPLICATE] += dropped;
  return SCREE_OK;
}

/* ---- Rounds ---- */

static scree_status check_now(scree_repair *r, bool intersections, scree_check *check,
                              scree_error *error) {
  scree_check_options options = {.intersections = intersections};
  return scree_check_searched(&r->mesh, &options, &r->searched, r->progress, check, error);
}

static bool surface_is_sound(const scree_check *check) {
  for (int i = SCREE_DEFECT_BAD_COORDINATE; i <= SCREE_DEFECT_INCONSISTENT_EDGE; i++)
    if (check->defects[i]) return false;
  return true;
}

static scree_status mend_open(scree_repair *r, scree_error *error) {
  /* the holes of a surface that was closed are all of the repair's own cutting */
  bool was_closed = r->report.before.defects[SCREE_DEFECT_BOUNDARY_EDGE] == 0;
  SCREE_TRY(scree_repair_scraps(r, error));
  return scree_repair_holes(r, was_closed, error);
}

static scree_status mend_surface(scree_repair *r, const scree_check *check, scree_error *error) {
  const size_t *defect = check->defects;
  bool open = defect[SCREE_DEFECT_BOUNDARY_EDGE] > 0;
  bool crowded = defect[SCREE_DEFECT_NON_MANIFOLD_EDGE] > 0;
  bool dented = defect[SCREE_DEFECT_DEGENERATE_FACET] > 0;
  if (defect[SCREE_DEFECT_DUPLICATE_FACET]) SCREE_TRY(scree_repair_duplicates(r, error));
  if (dented) SCREE_TRY(scree_repair_flat(r, error));
  if (open || dented) SCREE_TRY(scree_repair_seams(r, error));
  if (open || dented) SCREE_TRY(scree_repair_t_junctions(r, error));
  if (crowded) SCREE_TRY(scree_repair_fins(r, error));
  if (crowded) SCREE_TRY(scree_repair_membranes(r, error));
  if (crowded || defect[SCREE_DEFECT_INCONSISTENT_EDGE]) SCREE_TRY(scree_repair_winding(r, error));
  if (crowded) SCREE_TRY(scree_repair_edges(r, error));
  if (open) return mend_open(r, error);
  return defect[SCREE_DEFECT_NON_MANIFOLD_VERTEX] ? scree_repair_vertices(r, error) : SCREE_OK;
}

static size_t actions_done(const scree_repair *r) {
  size_t sum = 0;
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++) sum += r->report.done[i];
  return sum;
}

/* ---- What must not be lost ---- */

/* A share of the volume that is worth a try in another way. */
#define NOTABLE_LOSS 1e-3

/* The volume that cutting and merging are to keep, once: where the exact check knows it of this
 * closed surface, else the integral of the winding number, which counts twice where shells overlap
 * and is of no use there. */
static scree_status take_volume(scree_repair *r, scree_error *error) {
  scree_check check = r->report.before;
  bool as_given = actions_done(r) == r->report.done[SCREE_REPAIR_WELD];
  if (isnan(r->volume) && as_given && r->report.before.volume_known)
    r->volume = r->report.before.volume;
  if (!isnan(r->volume)) return SCREE_OK;
  if (actions_done(r) > 0)
    SCREE_TRY(check_now(r, r->options->intersections && !r->untangled, &check, error));
  if (check.volume_known)
    r->volume = check.volume;
  else if (!check.defects[SCREE_DEFECT_OVERLAPPING_SHELLS] &&
           !check.defects[SCREE_DEFECT_NON_MANIFOLD_EDGE]) /* shells that share one count as one */
    return scree_mesh_area_volume(&r->mesh, NULL, &r->volume, error);
  return SCREE_OK;
}

/* Area and volume of a surface whose coordinates may be bad, then NaN, or that has no facets, then
 * 0. */
static scree_status measure(const scree_mesh *mesh, const scree_check *check, double *area,
                            double *volume, scree_error *error) {
  *area = *volume = check->defects[SCREE_DEFECT_BAD_COORDINATE] ? NAN : 0;
  if (check->defects[SCREE_DEFECT_BAD_COORDINATE] || mesh->triangle_count == 0) return SCREE_OK;
  return scree_mesh_area_volume(mesh, area, volume, error);
}

/* The report on a mesh to which nothing is done. */
static scree_status report_untouched(const scree_mesh *mesh, scree_repair_report *report,
                                     scree_error *error) {
  report->after = report->before;
  SCREE_TRY(measure(mesh, &report->before, &report->area_before, &report->volume_after, error));
  report->area_after = report->area_before;
  report->volume_before = report->before.volume_known ? report->before.volume : NAN;
  return SCREE_OK;
}

/* The change of the result's volume, as a share. */
static double volume_change(const scree_repair *r) {
  return isnan(r->volume) ? 0 : fabs(r->report.volume_after - r->volume) / fabs(r->volume);
}

static scree_status refuse_loss(const scree_repair *r, scree_error *error) {
  const scree_repair_options *o = r->options;
  if (!(volume_change(r) > o->volume_change)) return SCREE_OK;
  return scree_fail(error, SCREE_BAD_MESH,
                    "a repair would change the volume by %.3g %%, from %.6g to %.6g cm3, and more "
                    "than %g %% is not allowed",
                    100 * volume_change(r), 1e6 * r->volume, 1e6 * r->report.volume_after,
                    100 * o->volume_change);
}

/* How often the dear stages have run. */
typedef struct tries {
  int cuts, merges;
  bool blunted;
  bool refused;      /* merging was ... */
  size_t refused_at; /* ... when so much had been done: as long as no more is, it would be again */
} tries;

static scree_status try_merge(scree_repair *r, tries *n, bool early, bool *merged,
                              scree_error *error) {
  *merged = false;
  if (n->refused && n->refused_at == actions_done(r)) return SCREE_OK;
  SCREE_TRY(scree_repair_merge(r, early, merged, error));
  n->refused = r->unmerged != NULL;
  n->refused_at = actions_done(r);
  return SCREE_OK;
}

/* Facets that meet are cut out, or shells merged; *settled where neither is done. */
static scree_status untangle(scree_repair *r, tries *n, bool *settled, scree_error *error) {
  const scree_repair_options *o = r->options;
  size_t cut_count = 0;
  bool merged = false;
  *settled = false;
  if (o->cut_intersections && !o->merge_folds && n->cuts < CUT_ROUNDS)
    SCREE_TRY(scree_repair_cut(r, ++n->cuts, &cut_count, settled, error));
  if (*settled) return SCREE_OK;
  if (cut_count == 0 && o->merge_shells && n->merges < MERGE_ROUNDS) {
    n->merges++;
    SCREE_TRY(try_merge(r, n, false, &merged, error));
  }
  if (cut_count == 0 && !merged && o->cut_intersections && !n->blunted) {
    n->blunted = true; /* of an open sheet that was filled, both sides may be the same */
    if (r->report.before.defects[SCREE_DEFECT_BOUNDARY_EDGE] == 0)
      SCREE_TRY(scree_repair_blunt(r, &cut_count, error));
  }
  *settled = cut_count == 0 && !merged;
  if (*settled && !r->apart) { /* without the small ones, or all but the largest, it may do */
    r->apart = true;
    *settled = false;
  }
  return SCREE_OK;
}

/* Neither turned nor dropped. */
static bool is_alone(const scree_check *check) {
  return check->shell_count == 1 && !check->too_many_pairs &&
         !check->defects[SCREE_DEFECT_INSIDE_OUT_SHELL];
}

/* One step on a mesh with the given cheap check; *settled where there is nothing left to do. */
static scree_status step(scree_repair *r, const scree_check *check, tries *n, bool *settled,
                         scree_error *error) {
  size_t before = actions_done(r);
  *settled = false;
  if (!surface_is_sound(check)) {
    SCREE_TRY(mend_surface(r, check, error));
    *settled = actions_done(r) == before;
    return SCREE_OK;
  }
  if (!is_alone(check)) SCREE_TRY(scree_repair_shells(r, error));
  if (actions_done(r) != before) return SCREE_OK;
  SCREE_TRY(take_volume(r, error));
  *settled = true;
  if (!r->options->intersections || r->untangled) return SCREE_OK;
  return untangle(r, n, settled, error);
}

/* Shells that are closed and overlap are merged before anything else is done: what coincides is no
 * duplicate there, and edges of four facets are no defect. */
static scree_status merge_early(scree_repair *r, tries *n, scree_error *error) {
  const size_t *defect = r->report.before.defects;
  bool met = defect[SCREE_DEFECT_CROSSING_PAIR] || defect[SCREE_DEFECT_TOUCHING_PAIR] ||
             defect[SCREE_DEFECT_OVERLAPPING_PAIR] || r->report.before.too_many_pairs;
  bool merged, alone = actions_done(r) == 0 && is_alone(&r->report.before);
  size_t bad, collapsed;
  if (!r->options->merge_shells || !met) return SCREE_OK;
  if (!defect[SCREE_DEFECT_BOUNDARY_EDGE] && !defect[SCREE_DEFECT_INCONSISTENT_EDGE]) {
    if (!alone) SCREE_TRY(scree_repair_outward(r, error));
    SCREE_TRY(take_volume(r, error));
  }
  if (alone && !defect[SCREE_DEFECT_NON_MANIFOLD_EDGE] && !r->options->merge_folds) return SCREE_OK;
  SCREE_TRY(try_merge(r, n, true, &merged, error));
  return merged ? weld(r, &r->mesh, &bad, &collapsed, error) : SCREE_OK;
}

static scree_status run_rounds(scree_repair *r, scree_error *error) {
  tries n = {0};
  size_t bad, collapsed;
  r->came_in = r->mesh.triangle_count;
  SCREE_TRY(merge_early(r, &n, error));
  for (int round = 0; round < ROUNDS; round++) {
    bool settled;
    r->report.after = r->report.before;
    if (actions_done(r) > 0) SCREE_TRY(check_now(r, false, &r->report.after, error));
    if (r->mesh.triangle_count == 0) break;
    SCREE_TRY(step(r, &r->report.after, &n, &settled, error));
    if (settled) break;
    SCREE_TRY(weld(r, &r->mesh, &bad, &collapsed, error));
    r->report.done[SCREE_REPAIR_DROP_DEGENERATE] += collapsed;
    SCREE_TRY(scree_repair_growth(r, r->mesh.triangle_count, error));
  }
  return SCREE_OK;
}

/* Everything after the first check, which found what r->report.before says. */
static scree_status mend(scree_repair *r, const scree_mesh *mesh, scree_error *error) {
  size_t *done = r->report.done, collapsed = 0;
  size_t unused = r->report.before.defects[SCREE_DEFECT_UNUSED_VERTEX];
  size_t used = r->report.before.vertex_count - unused;
  scree_mesh copy;
  if (unused || !scree_is_canonical(mesh)) {
    SCREE_TRY(weld(r, mesh, &done[SCREE_REPAIR_DROP_BAD], &collapsed, error));
  } else { /* as every reader gives it */
    SCREE_TRY(scree_mesh_copy(mesh, &copy, error));
    scree_repair_take(r, &copy);
  }
  done[SCREE_REPAIR_DROP_DEGENERATE] = collapsed;
  if (!done[SCREE_REPAIR_DROP_BAD] && !collapsed && used > r->mesh.vertex_count)
    done[SCREE_REPAIR_WELD] = used - r->mesh.vertex_count;
  r->untangled = r->report.before.usable;
  if (!r->report.before.usable || r->report.before.shell_count > 1) SCREE_TRY(run_rounds(r, error));
  r->report.after = r->report.before; /* of the same facets */
  if (actions_done(r) > 0 || r->report.before.defects[SCREE_DEFECT_UNUSED_VERTEX])
    SCREE_TRY(check_now(r, r->options->intersections, &r->report.after, error));
  r->report.volume_before = r->report.before.volume_known ? r->report.before.volume : r->volume;
  return measure(&r->mesh, &r->report.after, &r->report.area_after, &r->report.volume_after, error);
}

/* Whether cutting has taken so much of the body, or added so much, that another way may keep it
 * better. A fold that was filled adds a little. */
static bool has_lost(const scree_repair *r) {
  const size_t *before = r->report.before.defects, *after = r->report.after.defects;
  return r->report.done[SCREE_REPAIR_CUT_INTERSECTION] &&
         (!r->report.after.usable || volume_change(r) > r->options->volume_change ||
          r->report.volume_after < (1 - NOTABLE_LOSS) * r->volume ||
          after[SCREE_DEFECT_EXTRA_BODY] > before[SCREE_DEFECT_EXTRA_BODY]);
}

/* The same with folds merged instead of cut out, which takes r's place where it keeps more. */
static scree_status mend_otherwise(scree_repair *r, const scree_mesh *mesh, scree_error *error) {
  scree_repair_options options = *r->options;
  scree_repair other = {.options = &options,
                        .progress = r->progress,
                        .volume = NAN,
                        .searched = r->searched,
                        .report.before = r->report.before};
  scree_error reason;
  r->searched = (scree_searched){.met = NULL};
  options.merge_folds = true;
  scree_status status = mend(&other, mesh, &reason);
  other.options = r->options;
  bool sound = status == SCREE_OK && other.report.after.usable;
  size_t bodies = r->report.after.defects[SCREE_DEFECT_EXTRA_BODY],
         other_bodies = other.report.after.defects[SCREE_DEFECT_EXTRA_BODY];
  if (sound && (!r->report.after.usable || other_bodies < bodies ||
                (other_bodies == bodies && volume_change(&other) < volume_change(r)))) {
    scree_mesh_free(&r->mesh);
    *r = other;
  } else {
    scree_mesh_free(&other.mesh);
    r->searched = other.searched;
  }
  if (status != SCREE_CANCELLED && status != SCREE_OUT_OF_MEMORY) return SCREE_OK;
  if (error) *error = reason;
  return status;
}

/* ---- Handles ---- */

/* The handles of a closed manifold surface, by Euler's characteristic. */
static size_t handle_count(const scree_check *check) {
  size_t vertices = check->vertex_count - check->defects[SCREE_DEFECT_UNUSED_VERTEX];
  return check->shell_count - (vertices - check->triangle_count / 2) / 2;
}

static bool may_cut_handles(const scree_repair_options *o, const scree_check *check) {
  return o->handle_edges > 0 && check->usable && handle_count(check) > 0;
}

/* Nothing is cut where the surface would not be as sound as it was. */
static scree_status cut_handles(scree_repair *r, scree_error *error) {
  enum { HANDLE_ROUNDS = 16 };
  SCREE_CLEANUP(scree_mesh_free) scree_mesh cut = {0};
  scree_handles told = {0};
  scree_check check;
  for (int round = 0; round < HANDLE_ROUNDS; round++) {
    scree_mesh next;
    size_t before = told.count;
    const scree_mesh *from = round ? &cut : &r->mesh;
    SCREE_TRY(scree_handles_cut(from, r->options->handle_edges, &next, &told, error));
    scree_mesh_free(&cut);
    cut = next;
    if (told.count == before) break;
    SCREE_TRY(scree_mesh_canonicalize(&cut, error));
  }
  if (told.count == 0) return SCREE_OK;
  scree_check_options how = {.intersections = r->options->intersections};
  SCREE_TRY(scree_check_searched(&cut, &how, &r->searched, r->progress, &check, error));
  if (!check.usable || check.shell_count != r->report.after.shell_count) return SCREE_OK;
  if (isnan(r->report.volume_before)) r->report.volume_before = r->report.volume_after;
  scree_repair_take(r, &cut);
  r->report.done[SCREE_REPAIR_CUT_HANDLE] = told.count;
  r->report.handle_length = told.length;
  memcpy(r->report.handle_place, told.place, sizeof told.place);
  r->report.after = check;
  return measure(&r->mesh, &check, &r->report.area_after, &r->report.volume_after, error);
}

/* ---- What became of it ---- */

/* How far one surface lies off another: facets that both have are at no distance. */
static scree_status measure_way(const scree_mesh *from, double area, const scree_mesh *to,
                                const scree_progress *progress, scree_deviation *far,
                                scree_error *error) {
  enum { MOVE_POINTS = 20000 };
  SCREE_CLEANUP(scree_mesh_free) scree_mesh rest = {0};
  SCREE_OWNED(scree_surface, part);
  SCREE_OWNED(scree_surface, whole);
  SCREE_SCRATCH_ZERO(bool, met, to->triangle_count, error);
  SCREE_SCRATCH_ZERO(bool, same, from->triangle_count, error);
  bool known;
  *far = (scree_deviation){.mean = 0};
  SCREE_TRY(scree_searched_settled(&(scree_searched){*to, met}, from, same, &known, error));
  SCREE_TRY(scree_mesh_copy(from, &rest, error));
  scree_facets_drop(&rest, same);
  SCREE_TRY(scree_mesh_canonicalize(&rest, error));
  if (rest.triangle_count == 0) return SCREE_OK;
  SCREE_TRY(scree_surface_create(&rest, &part, error));
  SCREE_TRY(scree_surface_create(to, &whole, error));
  double share = part->area / area;
  scree_deviation_rule rule = {.sample_count = 1 + (size_t)(MOVE_POINTS * share), .slope = 1};
  SCREE_TRY(scree_surface_deviation(part, whole, &rule, progress, far, error));
  far->mean *= share;
  return SCREE_OK;
}

/* Where the area tells that something is missing, or new: how far off that is. */
static scree_status measure_move(const scree_mesh *mesh, const scree_repair *r,
                                 scree_repair_report *report, scree_error *error) {
  static const double NOTABLE_AREA = 1e-3;
  scree_deviation gone, new;
  double before = report->area_before, after = report->area_after;
  if (!(fabs(after / before - 1) > NOTABLE_AREA)) return SCREE_OK; /* NaN: bad coordinates */
  SCREE_TRY(measure_way(mesh, before, &r->mesh, r->progress, &gone, error));
  SCREE_TRY(measure_way(&r->mesh, after, mesh, r->progress, &new, error));
  const scree_deviation *far = gone.maximum > new.maximum ? &gone : &new;
  report->moved_mean = fmax(gone.mean, new.mean);
  report->moved_most = far->maximum;
  memcpy(report->moved_place, far->at, sizeof far->at);
  return SCREE_OK;
}

/* Whether mend would come to a copy. */
static bool needs_nothing(const scree_mesh *mesh, const scree_repair_options *options,
                          const scree_check *check) {
  return !may_cut_handles(options, check) && check->usable && check->shell_count == 1 &&
         !check->defects[SCREE_DEFECT_UNUSED_VERTEX] && scree_is_canonical(mesh);
}

/* mesh with its check and what it searched known, which it takes over. */
static scree_status repair_checked(const scree_mesh *mesh, const scree_check *before,
                                   scree_searched *searched, const scree_repair_options *options,
                                   const scree_progress *progress, scree_mesh *repaired,
                                   scree_repair_report *report, scree_error *error) {
  scree_repair r = {.options = options,
                    .progress = progress,
                    .apart = !options->merge_shells,
                    .volume = NAN,
                    .searched = *searched,
                    .report.before = *before};
  double area_before, unsaid;
  *searched = (scree_searched){.met = NULL};
  scree_status status = measure(mesh, before, &area_before, &unsaid, error);
  if (status == SCREE_OK) status = mend(&r, mesh, error);
  if (status == SCREE_OK && options->merge_shells && !options->merge_folds && has_lost(&r))
    status = mend_otherwise(&r, mesh, error);
  if (status == SCREE_OK && may_cut_handles(options, &r.report.after))
    status = cut_handles(&r, error);
  scree_searched_free(&r.searched);
  r.report.area_before = area_before;
  if (report && (status == SCREE_OK || status == SCREE_BAD_MESH)) *report = r.report;
  if (status == SCREE_OK && !r.report.after.usable)
    status =
        scree_fail(error, SCREE_BAD_MESH, "the mesh cannot be repaired; what remains is %s%s%s",
                   r.report.after.verdict, r.unmerged ? "; shells were not merged: " : "",
                   r.unmerged ? r.unmerged : "");
  if (status == SCREE_OK) status = refuse_loss(&r, error);
  if (status == SCREE_OK && report) status = measure_move(mesh, &r, report, error);
  if (status == SCREE_OK)
    *repaired = r.mesh;
  else
    scree_mesh_free(&r.mesh);
  return status;
}

/* What stands on a plane, repaired. */
static scree_status repair_cut_off(const scree_mesh *mesh, const scree_repair_options *options,
                                   const scree_progress *progress, scree_mesh *repaired,
                                   scree_repair_report *report, scree_error *error) {
  scree_repair_options chosen = *options;
  scree_check_options how = {.intersections = chosen.intersections};
  scree_repair_report made = {.seam_distance = 0};
  scree_cut_plane plane;
  scree_check before;
  SCREE_CLEANUP(scree_mesh_free) scree_mesh above = {0};
  scree_mesh whole;
  size_t dropped;
  double area, unsaid;
  SCREE_TRY(scree_mesh_check(mesh, &how, progress, &before, error));
  SCREE_TRY(measure(mesh, &before, &area, &unsaid, error));
  SCREE_TRY(scree_repair_cut_off(mesh, chosen.cut == SCREE_CUT_GIVEN ? &chosen.plane : NULL, &plane,
                                 &dropped, &above, error));
  chosen.cut = SCREE_CUT_NONE;
  chosen.keep_largest = chosen.flat_holes = true;
  chosen.hole_share = 1;
  scree_status status = scree_mesh_repair(&above, &chosen, progress, &whole, &made, error);
  made.done[SCREE_REPAIR_CUT_OFF] = dropped;
  made.plane = plane;
  made.before = before;
  made.area_before = area;
  made.volume_before = before.volume_known ? before.volume : NAN;
  if (report && (status == SCREE_OK || status == SCREE_BAD_MESH)) *report = made;
  if (status != SCREE_OK) return status;
  if (mesh == repaired) scree_mesh_free(repaired);
  *repaired = whole;
  return SCREE_OK;
}

scree_status scree_mesh_repair(const scree_mesh *mesh, const scree_repair_options *options,
                               const scree_progress *progress, scree_mesh *repaired,
                               scree_repair_report *report, scree_error *error) {
  scree_repair_options chosen = options ? *options : scree_default_repair_options();
  scree_check_options how = {.intersections = chosen.intersections};
  scree_repair_report untouched = {.seam_distance = 0};
  scree_check *before = &untouched.before;
  SCREE_TRY(verify_options(&chosen, error));
  if (chosen.cut != SCREE_CUT_NONE)
    return repair_cut_off(mesh, &chosen, progress, repaired, report, error);
  SCREE_CLEANUP(scree_searched_free) scree_searched searched = {.met = NULL};
  SCREE_TRY(scree_check_searched(mesh, &how, &searched, progress, before, error));
  if (mesh == repaired && needs_nothing(mesh, &chosen, before)) {
    SCREE_TRY(report_untouched(mesh, &untouched, error));
    if (report) *report = untouched;
    return SCREE_OK;
  }
  scree_mesh made;
  SCREE_TRY(repair_checked(mesh, before, &searched, &chosen, progress, &made, report, error));
  if (mesh == repaired) scree_mesh_free(repaired);
  *repaired = made;
  return SCREE_OK;
}

scree_status scree_mesh_prepare(const scree_mesh *mesh, const scree_repair_options *options,
                                const scree_progress *progress, scree_mesh *ready,
                                scree_repair_report *report, scree_error *error) {
  scree_repair_report made = {.seam_distance = 0};
  if (options) return scree_mesh_repair(mesh, options, progress, ready, report, error);
  scree_status status = SCREE_OK;
  SCREE_TRY(scree_mesh_check(mesh, NULL, progress, &made.before, error));
  SCREE_TRY(report_untouched(mesh, &made, error));
  if (!made.before.usable)
    status = scree_fail(error, SCREE_BAD_MESH, "the mesh is %s", made.before.verdict);
  else if (mesh != ready)
    status = scree_mesh_copy(mesh, ready, error);
  if (report && (status == SCREE_OK || status == SCREE_BAD_MESH)) *report = made;
  return status;
}
