/* Distributions of sizes as classes, each of one size.
 *
 * A continuous distribution is cut into classes of equal width in the logarithm of the size. With f
 * the density by mass a class has the mass M, the integral of f, and the number N, that of f/d^3;
 * its size (M/N)^(1/3) gives it both. By number likewise with f d^3 and f. Rosin-Rammler
 * (Rosin and Rammler 1933): f = n/d' (d/d')^(n-1) exp(-(d/d')^n), of which 63.2 % is finer than d'.
 */
#include "scene/plan_fields.h"

#include "base/math.h"

#include <string.h>

enum { SLICES = 200 }; /* of a class, for its integrals */

/* ---- fields ---- */

SCREE_RECORD_TABLE(scree_plan_rosin_rammler, SCREE_PLAN_ROSIN_RAMMLER, "rosin_rammler",
                   "size and spread", NULL)

SCREE_RECORD_TABLE(scree_plan_lognormal, SCREE_PLAN_LOGNORMAL, "lognormal", "median and deviation",
                   NULL)

static scree_status check_table(const scree_reader *r, const scree_plan_size *s) {
  const scree_table *t = &s->distribution;
  double sum = 0;
  if (t->count > SCREE_MOST_CLASSES)
    return scree_fail_place(r, &s->place, "%zu sizes: at most %d", t->count, SCREE_MOST_CLASSES);
  for (size_t i = 0; i < t->count; i++) {
    sum += t->items[i][1];
    if (!(t->items[i][0] > 1e-9))
      return scree_fail_place(r, &s->place, "%g m: a size must be above 1e-9 m", t->items[i][0]);
    if (i && t->items[i][0] < 1.0001 * t->items[i - 1][0])
      return scree_fail_place(r, &s->place, "%g m and %g m are the same size", t->items[i - 1][0],
                              t->items[i][0]);
    if (s->cumulative && i && t->items[i][1] < t->items[i - 1][1])
      return scree_fail_place(r, &s->place, "what is finer cannot become less: %g after %g",
                              t->items[i][1], t->items[i - 1][1]);
  }
  if (!(sum > 0)) return scree_fail_place(r, &s->place, "all shares are 0");
  if (!s->cumulative) return SCREE_OK;
  double first = t->items[0][1], last = t->items[t->count - 1][1];
  if (t->count > 1 && first == 0 && fabs(last - 1) < 1e-9) return SCREE_OK;
  return scree_fail_place(r, &s->place, "cumulative shares go from 0 to 1, not %g to %g", first,
                          last);
}

static scree_status check_size(const scree_reader *r, const void *record) {
  const scree_plan_size *s = record;
  const bool table = s->distribution.count > 0,
             there[] = {table, s->rosin_rammler != NULL, s->lognormal != NULL, s->uniform};
  SCREE_TRY(
      scree_plan_one_of(r, &s->place, there, 4, "distribution, rosin_rammler, lognormal, uniform"));
  if (s->cumulative && !table)
    return scree_fail_place(r, &s->place, "cumulative is of a distribution");
  if (table && (given(&s->least) || given(&s->most)))
    return scree_fail_place(r, &s->place, "a distribution has its own least and most");
  if (table) return check_table(r, s);
  if (!given(&s->least) || !given(&s->most) || !(1.0001 * s->least < s->most))
    return scree_fail_place(r, &s->place, "needs least and most, where it is cut off");
  return SCREE_OK;
}
SCREE_RECORD_TABLE(scree_plan_size, SCREE_PLAN_SIZE, "size", NULL, check_size)

/* ---- classes ---- */

static double density_at(const scree_plan_size *s, double d) {
  if (s->rosin_rammler) {
    const scree_plan_rosin_rammler *p = s->rosin_rammler;
    double logarithm = scree_log(d / p->size);
    return scree_exp((p->spread - 1) * logarithm - scree_exp(p->spread * logarithm));
  }
  if (s->lognormal) {
    double x = scree_log(d / s->lognormal->median) / s->lognormal->deviation;
    return scree_exp(-0.5 * x * x) / d;
  }
  return 1;
}

/* Number and size of the class from low to high. */
static scree_size_class class_of(const scree_plan_size *s, double low, double high, double factor) {
  double share = 0, other = 0, step = (high - low) / SLICES;
  for (int i = 0; i < SLICES; i++) {
    double d = low + (i + 0.5) * step, f = factor * density_at(s, d) * step, cube = d * d * d;
    share += f;
    other += s->by ? f * cube : f / cube;
  }
  double number = s->by ? share : other, mass = s->by ? other : share;
  if (!(number > 0)) return (scree_size_class){0.5 * (low + high), 0};
  return (scree_size_class){scree_cbrt(mass / number), number};
}

static scree_size_class class_at(const scree_plan_size *s, size_t i) {
  const scree_table *t = &s->distribution;
  if (t->count == 0) {
    double decades = scree_log(s->most / s->least), n = (double)s->classes;
    return class_of(s, s->least * scree_exp(decades * (double)i / n),
                    s->least * scree_exp(decades * (double)(i + 1) / n), 1);
  }
  if (s->cumulative) {
    double low = t->items[i][0], high = t->items[i + 1][0];
    return class_of(s, low, high, (t->items[i + 1][1] - t->items[i][1]) / (high - low));
  }
  double d = t->items[i][0], share = t->items[i][1];
  return (scree_size_class){d, s->by ? share : share / (d * d * d)};
}

scree_size_class *scree_plan_size_classes(const scree_plan_size *s, scree_arena *arena,
                                          size_t *count) {
  size_t most = s->distribution.count ? s->distribution.count - s->cumulative : s->classes,
         kept = 0;
  scree_size_class *classes = scree_arena_take(arena, most, sizeof *classes);
  double sum = 0;
  if (!classes) return NULL;
  for (size_t i = 0; i < most; i++) {
    classes[kept] = class_at(s, i);
    sum += classes[kept].share;
    kept += classes[kept].share > 0;
  }
  for (size_t i = 0; i < kept; i++) classes[i].share /= sum;
  *count = kept;
  return classes;
}

/* ---- in a plan ---- */

typedef struct family {
  const scree_size_class *classes;
  size_t first, count;
} family;

static const char *class_name(scree_arena *arena, const char *name, double size) {
  char *text = scree_arena_take(arena, strlen(name) + 24, 1);
  if (text) snprintf(text, strlen(name) + 24, "%s-%.6gmm", name, 1e3 * size);
  return text;
}

static bool expand_shapes(scree_plan *plan, const family *families, size_t total,
                          scree_arena *arena) {
  scree_plan_shape *made = scree_arena_take(arena, total, sizeof *made);
  if (!made) return false;
  plan->shapes = (scree_plan_shape_list){made, total};
  for (size_t i = 0; i < plan->families.count; i++)
    for (size_t k = 0; k < families[i].count; k++) {
      *made = plan->families.items[i];
      made->family = i;
      if (families[i].classes) {
        made->scaled = families[i].classes[k].size;
        if (!made->file && !made->sample && !made->clump && !given(made->box))
          made->sphere = made->scaled;
        made->place.name = class_name(arena, made->place.name, made->scaled);
        if (!made->place.name) return false;
      }
      made++;
    }
  return true;
}

static bool expand_weights(const scree_plan *plan, const family *families, scree_weights *weights,
                           scree_arena *arena) {
  size_t total = 0, at = 0;
  for (size_t i = 0; i < weights->count; i++)
    total += families[SCREE_PLAN_FIND(plan->families, weights->names[i])].count;
  scree_weights made = {scree_arena_take(arena, total, sizeof *made.names),
                        scree_arena_take(arena, total, sizeof *made.values), total};
  if (!made.names || !made.values) return false;
  for (size_t i = 0; i < weights->count; i++) {
    const family *f = &families[SCREE_PLAN_FIND(plan->families, weights->names[i])];
    for (size_t k = 0; k < f->count; k++, at++) {
      made.names[at] = plan->shapes.items[f->first + k].place.name;
      made.values[at] = weights->values[i] * (f->classes ? f->classes[k].share : 1);
    }
  }
  *weights = made;
  return true;
}

scree_status scree_plan_expand(scree_plan *plan, scree_arena *arena, scree_error *error) {
  plan->families = plan->shapes;
  size_t total = 0;
  family *families = scree_arena_take(arena, plan->families.count, sizeof *families);
  bool good = families != NULL;
  for (size_t i = 0; good && i < plan->families.count; i++) {
    const scree_plan_shape *s = &plan->families.items[i];
    families[i] = (family){NULL, total, 1};
    if (s->size) families[i].classes = scree_plan_size_classes(s->size, arena, &families[i].count);
    good = !s->size || families[i].classes;
    total += families[i].count;
  }
  good = good && expand_shapes(plan, families, total, arena);
  scree_plan_inlet *inlets = plan->inlets.items;
  for (size_t i = 0; good && i < plan->inlets.count; i++)
    good = expand_weights(plan, families, &inlets[i].shapes, arena);
  return good ? SCREE_OK : scree_fail_memory(error, 0, "the sizes of shapes");
}
