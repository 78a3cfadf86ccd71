/* Lloyd's relaxation (1982): each site moves to the middle of what is nearer to it than to any
 * other, here of points spread over the body, forty for each cell. */
#include "mesh/fracture/sites.h"
#include "base/alloc.h"
#include "base/rng.h"
#include "mesh/index/bvh.h"

enum { SAMPLES = 40 };
/* Draws for one point that is in the body, at most: of a body that fills little of its box, or with
 * a small dense place. */
static const double most_draws = 20000;

/* How many cells a volume has there, against the densest place. */
static double density(const scree_fracture_options *o, const mat3 *there, vec3 p) {
  if (!(o->near_distance > 0)) return 1;
  vec3 off = vec3_sub(mat3_mul_vec(there, p), vec3_load(o->near));
  return 1 / (1 + vec3_norm2(off) / (o->near_distance * o->near_distance));
}

static scree_status spread(const scree_bvh *bvh, const mat3 *there, const scree_fracture_options *o,
                           vec3 *points, size_t count, scree_error *error) {
  const scree_box box = bvh->tree.nodes[0].box;
  const vec3 size = vec3_sub(box.high, box.low);
  scree_rng rng = {o->seed, 1, 0};
  double draws = 0;
  for (size_t k = 0; k < count;) {
    double x = scree_rng_uniform(&rng), y = scree_rng_uniform(&rng), z = scree_rng_uniform(&rng),
           w = scree_rng_uniform(&rng);
    vec3 p = vec3_add(box.low, (vec3){x * size.x, y * size.y, z * size.z});
    if (++draws > most_draws * (double)(k + 100))
      return scree_fail(error, SCREE_BAD_ARGUMENT,
                        "no places for %zu cells: the body fills too little of its box, or the "
                        "dense place is too far from it",
                        o->cell_count);
    if (w < density(o, there, p) && scree_bvh_holds(bvh, p)) points[k++] = p;
  }
  return SCREE_OK;
}

static size_t nearest(const vec3 *sites, size_t count, vec3 p) {
  size_t best = 0;
  double least = INFINITY;
  for (size_t s = 0; s < count; s++) {
    double d = vec3_norm2(vec3_sub(sites[s], p));
    if (d < least) least = d, best = s;
  }
  return best;
}

static scree_status relax(const vec3 *points, size_t count, size_t rounds, vec3 *sites,
                          size_t site_count, scree_error *error) {
  SCREE_SCRATCH(vec3, sums, site_count, error);
  SCREE_SCRATCH(double, counts, site_count, error);
  for (size_t round = 0; round < rounds; round++) {
    memset(sums, 0, site_count * sizeof *sums);
    memset(counts, 0, site_count * sizeof *counts);
    for (size_t k = 0; k < count; k++) {
      size_t s = nearest(sites, site_count, points[k]);
      sums[s] = vec3_add(sums[s], points[k]);
      counts[s]++;
    }
    for (size_t s = 0; s < site_count; s++)
      if (counts[s] > 0) sites[s] = vec3_scale(sums[s], 1 / counts[s]);
  }
  return SCREE_OK;
}

scree_status scree_sites_draw(const scree_mesh *mesh, const mat3 *there,
                              const scree_fracture_options *options, vec3 *sites,
                              scree_error *error) {
  size_t site_count = options->cell_count, count = site_count * (options->rounds ? SAMPLES : 1);
  SCREE_SCRATCH(vec3, points, count, error);
  SCREE_CLEANUP(scree_bvh_free) scree_bvh bvh = {0};
  SCREE_TRY(scree_bvh_build(mesh, &bvh, error));
  SCREE_TRY(spread(&bvh, there, options, points, count, error));
  memcpy(sites, points, site_count * sizeof *sites);
  return relax(points, count, options->rounds, sites, site_count, error);
}
