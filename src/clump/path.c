/* A few counts begin at random. Coarse to fine, each starts from the best of one sphere less and
 * one more where most is gained, and from spheres spread evenly; then fine to coarse, each from the
 * best of one sphere more without the one that is least missed. Each start is optimised, and the
 * better kept. At the end spheres that nobody would miss are put elsewhere, and counts that gain
 * nothing over a smaller one are dropped: IoU is monotonic and no sphere useless. */
#include "clump/path.h"

#include "base/alloc.h"
#include "base/math.h"
#include "base/rng.h"

/* Tuning, each once; lengths where the body's volume is 1. */
static const double soft_begin =
                        0.3, /* softness of the first and the last step for one sphere; of n, */
    soft_end = 0.05,         /* smaller as n^(-1/3), the size of theirs */
    soft_random = 0.5,       /* from a random start */
    damping = 0.9,           /* of the first step; of the last half */
    hold = 0.5,              /* share of the moments' errors corrected in a step */
    least_outside = 0.02,    /* weight of what is outside, at IoU 0 */
    strict_outside = 4,      /* likewise where spheres may not stand out as they like */
    lost = 0.8,              /* radii outside: a sphere that ran off */
    least_gain = 1e-4;       /* IoU that a sphere must add */
enum {
  STEPS = 30,         /* per start */
  RANDOM_COUNTS = 10, /* counts that are started at random too */
  RANDOM_STARTS = 3,  /* each */
  SPARE_COUNTS = 8,   /* above the largest asked, where the way down starts */
  CHOICES = 4,        /* places of which the one with most gain is taken */
  RESTORING_STEPS = 6,
  MENDING_TRIES = 3,
};

/* How many moments a clump of n spheres can hold. */
static size_t held_moments(size_t n) {
  return n >= 10 ? SCREE_MOMENTS : n >= 4 ? SCREE_FIRST_INERTIA : 1;
}

static bool is_strict(const scree_path *p) {
  return p->mover.most_outside < INFINITY;
}

static void measure(scree_path *p, scree_trial *t) {
  t->overlap = scree_ruler_measure(&p->ruler, t->spheres, t->count, NULL);
}

/* What held moments out of tolerance cost, as IoU. */
static double penalty(const scree_path *p, const scree_trial *t) {
  double worst = 0;
  for (size_t m = 0; m < held_moments(t->count); m++) {
    double error = fabs(t->overlap.moments[m] - p->body->moments[m]);
    worst = fmax(worst, error - p->mover.tolerance[m]);
  }
  return worst;
}

static double score(const scree_path *p, const scree_trial *t) {
  return t->overlap.iou - (is_strict(p) ? 0 : penalty(p, t));
}

/* Held moments to those of the body, by the least motion that does it. */
static void restore(scree_path *p, scree_trial *t, int steps) {
  double share = 1;
  scree_trial *next = &p->work[3];
  scree_step step = {
      .softness = 1, .damping = 1, .outside = 1, .held = held_moments(t->count), .restore = true};
  for (int k = 0; k < steps && penalty(p, t) > 0; k++) {
    *next = *t;
    step.hold = share;
    step.moments = t->overlap.moments;
    scree_mover_step(&p->mover, next->spheres, next->count, &step);
    measure(p, next);
    if (score(p, next) > score(p, t))
      *t = *next;
    else
      share *= 0.4;
  }
}

/* Radii so that no sphere stands out of the surface by more than allowed. */
static void clip(const scree_path *p, scree_trial *t) {
  for (size_t i = 0; i < t->count; i++) {
    scree_sphere *s = &t->spheres[i];
    double distance;
    scree_target_nearest(p->body, vec3_load(s->centre), &distance);
    double depth = scree_distance_field_at(&p->field, s->centre) < 0 ? distance : -distance;
    s->radius = fmax(1e-6, fmin(s->radius, depth + p->mover.most_outside));
  }
}

/* One more sphere, where most is gained; `skip`: at the next best places. */
static bool add_sphere(scree_path *p, scree_trial *t, size_t skip) {
  scree_sphere_candidate found[CHOICES];
  double outside = fmax(t->overlap.iou, least_outside);
  size_t count =
      scree_sphere_sites_free_of(&p->places, t->spheres, t->count, outside, found, CHOICES);
  if (count == 0) return false;
  t->spheres[t->count++] = found[skip < count ? skip : count - 1].sphere;
  return true;
}

/* How many spheres hardly change the IoU; which is the least missed, and what IoU loses by it. */
static size_t find_useless(scree_path *p, scree_trial *t, size_t *least, double *least_loss) {
  scree_alone alone[SCREE_MOST_SPHERES];
  size_t useless = 0;
  *least_loss = INFINITY;
  t->overlap = scree_ruler_measure(&p->ruler, t->spheres, t->count, alone);
  for (size_t i = 0; i < t->count; i++) {
    double loss = scree_overlap_loss(&t->overlap, &alone[i]);
    useless += fabs(loss) < least_gain;
    if (loss < *least_loss) *least = i, *least_loss = loss;
  }
  return useless;
}

static void remove_sphere(scree_path *p, scree_trial *t) {
  size_t least = 0;
  double loss;
  find_useless(p, t, &least, &loss);
  t->spheres[least] = t->spheres[--t->count];
}

/* Spheres that ran off the body start again elsewhere. */
static void recall(scree_path *p, scree_trial *t) {
  for (size_t i = t->count; i-- > 0;) {
    if ((double)scree_distance_field_at(&p->field, t->spheres[i].centre) <=
        lost * t->spheres[i].radius)
      continue;
    scree_sphere kept = t->spheres[i];
    t->spheres[i] = t->spheres[--t->count];
    if (!add_sphere(p, t, 0)) t->spheres[t->count++] = kept;
  }
}

/* From soft to sharp; `softness`: of the first step, for one sphere. */
static void optimise(scree_path *p, scree_trial *t, int steps, double softness) {
  double size = 1 / scree_cbrt((double)t->count), ratio = soft_end / softness;
  scree_step step = {.hold = is_strict(p) ? 0 : hold, .held = held_moments(t->count)};
  step.outside = is_strict(p) ? strict_outside : fmax(t->overlap.iou, least_outside);
  for (int k = 0; k < steps; k++) {
    double done = (double)k / (steps - 1);
    if (k == steps / 2) recall(p, t);
    step.softness = size * softness * scree_exp(done * scree_log(ratio));
    step.damping = damping * (1 - 0.5 * done);
    scree_mover_step(&p->mover, t->spheres, t->count, &step);
  }
  if (is_strict(p)) clip(p, t);
  measure(p, t);
  if (!is_strict(p)) restore(p, t, 2);
}

bool scree_path_keep(scree_path *p, scree_trial *t) {
  scree_trial *best = &p->best[t->count];
  if (best->count && score(p, t) <= score(p, best)) return false;
  *best = *t;
  return true;
}

static bool tick(scree_path *p, double fraction) {
  if (!p->cancelled && !scree_tick(&p->ticker, "fitting spheres", fraction)) p->cancelled = true;
  return !p->cancelled && !p->ruler.failed;
}

/* Shares of the whole time at the end of each sweep, measured. */
static const double share_random = 0.14, share_up = 0.58, share_down = 0.9;

static void try_start(scree_path *p, scree_trial *t) {
  optimise(p, t, STEPS, soft_begin);
  scree_path_keep(p, t);
}

static void sweep_up(scree_path *p) {
  scree_trial *t = &p->work[0];
  for (size_t n = 1; n <= p->room; n++) {
    double done = (double)n / (double)p->room;
    if (!tick(p, share_random + (share_up - share_random) * done)) return;
    *t = p->best[n - 1];
    if (!add_sphere(p, t, 0)) return;
    try_start(p, t);
    *t = (scree_trial){.count = n};
    if (!scree_sphere_sites_spread(&p->places, n, t->spheres)) continue;
    measure(p, t);
    try_start(p, t);
  }
}

static void sweep_down(scree_path *p) {
  size_t top = p->room;
  while (top > 0 && p->best[top].count == 0) top--;
  for (size_t n = top; n-- > 1;) {
    double done = 1 - (double)n / (double)p->room;
    if (!tick(p, share_up + (share_down - share_up) * done)) return;
    scree_trial *t = &p->work[0];
    *t = p->best[n + 1];
    remove_sphere(p, t);
    try_start(p, t);
  }
}

static void start_at_random(scree_path *p, size_t n, scree_rng *rng, scree_trial *t) {
  *t = (scree_trial){.count = n};
  for (size_t i = 0; i < n; i++) {
    size_t at = (size_t)scree_rng_below(rng, p->places.count);
    t->spheres[i] =
        (scree_sphere){{(double)p->places.x[at], (double)p->places.y[at], (double)p->places.z[at]},
                       fmax(0.05, (double)p->places.depth[at])};
  }
}

/* Few spheres have many arrangements, of which the sweeps see two. */
static void sweep_random(scree_path *p) {
  scree_rng rng = {.seed = 1};
  for (size_t n = 2; n <= RANDOM_COUNTS && n <= p->most && p->places.count > 0; n++)
    for (int start = 0; start < RANDOM_STARTS; start++) {
      double done = (double)n / RANDOM_COUNTS;
      if (!tick(p, share_random * done)) return;
      scree_trial *t = &p->work[0];
      start_at_random(p, n, &rng, t);
      optimise(p, t, STEPS, soft_random);
      try_start(p, t);
    }
}

/* Spheres that nobody would miss go elsewhere. */
static void refresh(scree_path *p, size_t n) {
  scree_trial *best = &p->best[n], *t = &p->work[0];
  for (int attempt = 0; attempt < MENDING_TRIES; attempt++) {
    size_t least, count;
    double loss;
    count = find_useless(p, best, &least, &loss);
    if (count == 0 || 2 * count > n) return;
    *t = *best;
    for (size_t i = 0; i < count; i++) remove_sphere(p, t);
    for (size_t i = 0; i < count; i++)
      if (!add_sphere(p, t, (size_t)attempt)) return;
    optimise(p, t, STEPS, soft_begin);
    if (find_useless(p, t, &least, &loss) < count && score(p, t) > score(p, best) - least_gain)
      *best = *t;
  }
}

/* A count that is no better than the last smaller one starts from that one again. */
static void catch_up(scree_path *p, size_t n, size_t last) {
  scree_trial *t = &p->work[0];
  for (size_t attempt = 0; attempt < MENDING_TRIES; attempt++) {
    if (p->best[n].count && score(p, &p->best[n]) > score(p, &p->best[last]) + least_gain) return;
    *t = p->best[last];
    while (t->count < n)
      if (!add_sphere(p, t, t->count + 1 == n ? attempt : 0)) return;
    optimise(p, t, STEPS, attempt ? soft_end : soft_begin);
    scree_path_keep(p, t);
  }
}

/* Drops what has a sphere too many, once the clump without it has had its chance. A sphere that
 * costs IoU may be what holds the moments: it stays unless the clump without it is better. */
static void settle(scree_path *p) {
  for (size_t n = p->most; n > 1; n--) {
    size_t least = 0, useless;
    double loss;
    if (!p->best[n].count) continue;
    useless = find_useless(p, &p->best[n], &least, &loss);
    if (loss >= least_gain) continue;
    scree_trial *t = &p->work[0];
    *t = p->best[n];
    t->spheres[least] = t->spheres[--t->count];
    measure(p, t);
    if (!is_strict(p)) restore(p, t, RESTORING_STEPS);
    scree_path_keep(p, t);
    if (useless) p->best[n].count = 0;
  }
  size_t last = 1;
  for (size_t n = 2; n <= p->most; n++) {
    scree_trial *t = &p->best[n];
    if (t->count && t->overlap.iou <= p->best[last].overlap.iou + least_gain) t->count = 0;
    if (t->count) last = n;
  }
}

scree_status scree_path_search(scree_path *p, scree_error *error) {
  sweep_random(p);
  sweep_up(p);
  sweep_down(p);
  for (size_t n = 2, last = 1; n <= p->most && p->best[1].count; n++) {
    if (!tick(p, share_down + (1 - share_down) * (double)n / (double)p->most)) break;
    if (p->best[n].count) refresh(p, n);
    catch_up(p, n, last);
    if (p->best[n].count && !is_strict(p)) restore(p, &p->best[n], RESTORING_STEPS);
    if (p->best[n].count) last = n;
  }
  if (p->cancelled) return scree_fail(error, SCREE_CANCELLED, "cancelled");
  if (p->ruler.failed) return scree_fail_memory(error, 0, "the chords of a clump");
  if (!p->best[1].count)
    return scree_fail(error, SCREE_LIMIT,
                      "no point of the grid lies inside: walls are thinner than %g of the size",
                      scree_distance_field_spacing(&p->field) / SCREE_UNIT_SIZE);
  settle(p);
  return p->ruler.failed ? scree_fail_memory(error, 0, "the chords of a clump") : SCREE_OK;
}

scree_status scree_path_make(const scree_target *body, size_t most, double most_outside,
                             const scree_progress *progress, scree_path *path, scree_error *error) {
  *path = (scree_path){.body = body,
                       .most = most,
                       .room = most > 20 ? most + SPARE_COUNTS : most + 2,
                       .ticker = {.progress = progress}};
  SCREE_TRY(scree_distance_field_make(body, most, &path->field, error));
  SCREE_TRY(scree_ruler_make(body, &path->ruler, error));
  SCREE_TRY(scree_mover_make(body, &path->field, &path->mover, error));
  SCREE_TRY(scree_sphere_sites_make(&path->field, &path->places, error));
  SCREE_TRY_ALLOC_ZERO(path->best, path->room + 1, error);
  SCREE_TRY_ALLOC_ZERO(path->work, 4, error);
  path->mover.most_outside = most_outside;
  return SCREE_OK;
}

void scree_path_free(scree_path *path) {
  scree_distance_field_free(&path->field);
  scree_ruler_free(&path->ruler);
  scree_mover_free(&path->mover);
  scree_sphere_sites_free(&path->places);
  scree_free(path->best);
  scree_free(path->work);
  *path = (scree_path){0};
}
