/* Quickhull through the reentrant library (Barber, Dobkin, Huhdanpaa 1996, "The quickhull algorithm
 * for convex hulls"). Qt triangulates merged facets. The volume is summed by us from tetrahedra to
 * the mean of the corners, all positive for a convex body, with compensation. */
#include "mesh/measure/hull.h"

#include "base/alloc.h"
#include "base/platform.h"
#include "base/sum.h"

#include <libqhull_r/qhull_ra.h>
#include <string.h>

/* qhull fails on flat input by design, and very rarely on wide merges, which Q12 allows. To merge
 * facets is quadratic in the corners that lie in one plane, so of many points the hull is found
 * first with each moved by some roundings (QJ), and anew of its corners, as they were, if these are
 * not many. */
static const char *const merged[] = {"qhull Qt Pp", "qhull Qt Q12 Pp", NULL};
static const char *const joggled[] = {"qhull QJ Pp", NULL};
enum { MANY = 4000 /* points; takes a second where they lie in one plane */ };
/* Volume over area^1.5 that is rounding alone. */
static const double FLAT = 1e-14;

static bool run_qhull(qhT *qh, const vec3 *points, size_t point_count, const char *command,
                      FILE *sink) {
  char words[64];
  snprintf(words, sizeof words, "%s", command);
  qh_zero(qh, sink);
  /* with ismalloc False the coordinates are only read */
  return qh_new_qhull(qh, 3, (int)point_count, (coordT *)(uintptr_t)points, False, words, sink,
                      sink) == 0;
}

static void free_qhull(qhT *qh) {
  int curlong, totlong;
  qh_freeqhull(qh, !qh_ALL);
  qh_memfreeshort(qh, &curlong, &totlong);
}

/* qhull.h's loops, spelled out: its macros do not pass our warnings. */
static scree_status copy_corners(qhT *qh, const vec3 *points, scree_hull *hull,
                                 scree_error *error) {
  size_t corner = 0, triangle = 0;
  for (vertexT *v = qh->vertex_list; v && v->next; v = v->next) hull->point_count++;
  for (facetT *f = qh->facet_list; f && f->next; f = f->next) hull->triangle_count++;
  SCREE_TRY_ALLOC(hull->points, hull->point_count, error);
  SCREE_TRY_ALLOC(hull->triangles, 3 * hull->triangle_count, error);
  for (vertexT *v = qh->vertex_list; v && v->next; v = v->next) {
    v->visitid = (unsigned int)corner;
    hull->points[corner++] = points[qh_pointid(qh, v->point)];
  }
  for (facetT *f = qh->facet_list; f && f->next; f = f->next) {
    uint32_t *out = hull->triangles + 3 * triangle++;
    for (int k = 0; k < 3; k++) out[k] = ((vertexT *)f->vertices->e[k].p)->visitid;
  }
  return SCREE_OK;
}

/* Turns every triangle outward, and sums. */
static void measure_hull(scree_hull *hull) {
  scree_sum area = {0}, volume = {0};
  vec3 inside = {0, 0, 0};
  for (size_t i = 0; i < hull->point_count; i++)
    inside = vec3_mad(inside, hull->points[i], 1 / (double)hull->point_count);
  for (size_t t = 0; t < hull->triangle_count; t++) {
    uint32_t *c = hull->triangles + 3 * t;
    vec3 p = hull->points[c[0]];
    vec3 normal = vec3_triangle_normal(p, hull->points[c[1]], hull->points[c[2]]);
    double six_volume = vec3_dot(vec3_sub(p, inside), normal);
    if (six_volume < 0) {
      uint32_t second = c[1];
      c[1] = c[2];
      c[2] = second;
    }
    scree_sum_add(&area, vec3_norm(normal) / 2);
    scree_sum_add(&volume, fabs(six_volume) / 6);
  }
  hull->area = scree_sum_value(area);
  hull->volume = scree_sum_value(volume);
}

/* Tries one command after the other; *hull stays without triangles where none will do. */
static scree_status find_hull(const vec3 *points, size_t point_count, const char *const *commands,
                              scree_hull *hull, scree_error *error) {
  FILE *sink = scree_null_open();
  if (!sink) return scree_fail(error, SCREE_IO, "cannot open the null device");
  scree_status status = SCREE_OK;
  for (bool done = point_count < 4; *commands && !done; commands++) {
    qhT qh;
    done = run_qhull(&qh, points, point_count, *commands, sink);
    if (done) status = copy_corners(&qh, points, hull, error);
    free_qhull(&qh);
  }
  fclose(sink);
  return status;
}

static scree_status keep_all(const vec3 *points, size_t point_count, scree_hull *hull,
                             scree_error *error) {
  scree_hull_free(hull);
  SCREE_TRY_ALLOC(hull->points, point_count, error);
  for (size_t i = 0; i < point_count; i++) hull->points[i] = points[i];
  hull->point_count = point_count;
  return SCREE_OK;
}

scree_status scree_hull_build(const vec3 *points, size_t point_count, scree_hull *hull,
                              scree_error *error) {
  SCREE_CLEANUP(scree_hull_free) scree_hull made = {0};
  bool many = point_count > MANY;
  if (point_count > INT32_MAX)
    return scree_fail(error, SCREE_LIMIT, "%zu points, above the limit of %d for a convex hull",
                      point_count, INT32_MAX);
  SCREE_TRY(find_hull(points, point_count, many ? joggled : merged, &made, error));
  if (many && made.point_count <= MANY) {
    SCREE_CLEANUP(scree_hull_free) scree_hull rough = made;
    made = (scree_hull){0};
    SCREE_TRY(find_hull(rough.points, rough.point_count, merged, &made, error));
  }
  measure_hull(&made);
  if (!(made.volume > FLAT * made.area * sqrt(made.area)))
    SCREE_TRY(keep_all(points, point_count, &made, error));
  *hull = made;
  made = (scree_hull){0};
  return SCREE_OK;
}

void scree_hull_free(scree_hull *hull) {
  if (!hull) return;
  scree_free(hull->points);
  scree_free(hull->triangles);
  *hull = (scree_hull){0};
}

scree_status scree_hull_mesh(const vec3 *points, size_t point_count, scree_mesh *mesh,
                             scree_error *error) {
  SCREE_CLEANUP(scree_hull_free) scree_hull hull = {0};
  SCREE_TRY(scree_hull_build(points, point_count, &hull, error));
  SCREE_TRY(scree_mesh_make(hull.point_count, hull.triangle_count, mesh, error));
  for (size_t v = 0; v < hull.point_count; v++) vec3_store(mesh->positions + 3 * v, hull.points[v]);
  if (hull.triangles)
    memcpy(mesh->triangles, hull.triangles, 3 * hull.triangle_count * sizeof *mesh->triangles);
  return SCREE_OK;
}
