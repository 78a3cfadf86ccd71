#include "cli/study.h"
#include "report/program.h"

#include <math.h>
#include <string.h>

static void print_seconds(FILE *stream, double seconds) {
  if (!isfinite(seconds))
    fputs("unknown", stream);
  else if (seconds < 120)
    fprintf(stream, "%.0f s", seconds);
  else if (seconds < 7200)
    fprintf(stream, "%.0f min", seconds / 60);
  else
    fprintf(stream, "%.1f h", seconds / 3600);
}

static void print_counts(FILE *stream, const scree_study_result *r) {
  const scree_study_counts *c = &r->counts;
  char shown[CLI_PRINTABLE_BYTES];
  fprintf(stream, "%s: %zu point%s x %zu replicate%s, %zu runs: %zu done",
          cli_printable(r->name, shown), r->point_count, cli_plural(r->point_count),
          r->replicate_count, cli_plural(r->replicate_count), r->point_count * r->replicate_count,
          c->done);
  if (c->failed) fprintf(stream, ", %zu failed", c->failed);
  if (c->running) fprintf(stream, ", %zu running", c->running);
  if (c->leased) fprintf(stream, ", %zu leased", c->leased);
  if (c->waiting) fprintf(stream, ", %zu waiting", c->waiting);
  fputs("\n", stream);
  if (c->waiting + c->leased + c->running == 0) return;
  fprintf(stream, "%zu worker%s now; left: ", r->worker_count, cli_plural(r->worker_count));
  print_seconds(stream, r->seconds_left);
  fputs(r->worker_count ? "\n" : " with one\n", stream);
}

/* The finest's comparison with itself says nothing. */
static const scree_comparison *find_comparison(const scree_study_result *r, size_t point,
                                               bool *finest) {
  *finest = false;
  for (size_t f = 0; f < r->family_count; f++)
    for (size_t k = 0; k < r->families[f].level_count; k++) {
      if (r->families[f].levels[k] != point) continue;
      *finest = k + 1 == r->families[f].level_count;
      return *finest ? NULL : &r->families[f].comparisons[k];
    }
  return NULL;
}

static void print_comparison(FILE *stream, const scree_study_result *r, size_t point) {
  bool finest;
  const scree_comparison *c = find_comparison(r, point, &finest);
  if (finest) fputs("  finest", stream);
  if (!c) return;
  if (isnan(c->low)) {
    fputs("  -", stream);
    return;
  }
  fprintf(stream, "  %s %+.1f",
          c->equivalent  ? "same"
          : c->different ? "differs"
                         : "open",
          c->difference);
}

/* A longer label stands on a line of its own. */
enum { LABEL_WIDTH = 20 };

static const char *label_of(const scree_study_result *r, size_t index, const char *other) {
  const char *label = r->points[index].label[0] ? r->points[index].label : other;
  return label + (!strncmp(label, "rp ", 3) && r->factor_count == 1 ? 3 : 0);
}

static int label_width(const scree_study_result *r, bool shapes) {
  size_t width = 5;
  for (size_t i = 0; i < r->point_count; i++) {
    size_t length = strlen(label_of(r, i, shapes ? r->points[i].shapes : r->name));
    if (length > width && length <= LABEL_WIDTH) width = length;
  }
  return (int)width;
}

static void print_label(FILE *stream, const char *label, int width) {
  if (strlen(label) <= (size_t)width)
    fprintf(stream, "%-*s", width, label);
  else
    fprintf(stream, "%s\n%*s", label, width, "");
}

static void print_point(FILE *stream, const scree_study_result *r, size_t index, int width) {
  const scree_point_result *p = &r->points[index];
  const scree_summary *a = &p->angle_deg;
  print_label(stream, label_of(r, index, p->shapes), width);
  if (isnan(p->triangle_count)) /* before the first run */
    fprintf(stream, " %9s", "-");
  else
    fprintf(stream, " %9.0f", p->triangle_count);
  fprintf(stream, " %3zu/%-3zu", p->counts.done, r->replicate_count);
  if (!p->counts.done)
    fprintf(stream, " %-38s", " -");
  else if (!p->heap_count)
    fprintf(stream, " %-38s", " no heap");
  else if (a->count < 2)
    fprintf(stream, " %6.2f %31s", a->mean, "");
  else if (a->sd == 0) /* no interval of no width: what scatter there is was not seen */
    fprintf(stream, " %6.2f %-31s", a->mean, "all runs alike");
  else
    fprintf(stream, " %6.2f [%6.2f, %6.2f] %6.2f %6.1f %%", a->mean, a->mean_low, a->mean_high,
            a->sd, 100 * a->cv);
  if (p->counts.done)
    fprintf(stream, " %9.4g", p->seconds.mean);
  else
    fprintf(stream, " %9s", "-");
  print_comparison(stream, r, index);
  if (p->heap_count && p->heap_count < p->counts.done)
    fprintf(stream, "  (%zu runs left no heap)", p->counts.done - p->heap_count);
  fputs("\n", stream);
}

static void print_table(FILE *stream, const scree_study_result *r) {
  int width = label_width(r, true);
  bool only_rp = r->factor_count == 1 && !strncmp(r->points[0].label, "rp ", 3);
  fprintf(stream, "%-*s %9s %7s %6s %-16s %6s %8s %9s  %s\n", width, only_rp ? "Rp" : "point",
          "triangles", "runs", "angle", "  interval", "SD", "CV", "time (s)",
          r->family_count ? "against finest" : "");
  for (size_t i = 0; i < r->point_count; i++) print_point(stream, r, i, width);
}

static const char *range_text(scree_in_range in) {
  return in == SCREE_IN_RANGE_YES  ? "within the converged range"
         : in == SCREE_IN_RANGE_NO ? "below the converged range"
                                   : "not to be judged, for the angle has not converged";
}

static void print_pick(FILE *stream, const char *what, const scree_rp_pick *pick) {
  if (isnan(pick->mean)) {
    fprintf(stream, "%s: unknown, the shapes are not decimated yet\n", what);
    return;
  }
  fprintf(stream, "%s: %.2g", what, pick->mean);
  if (pick->low < pick->high)
    fprintf(stream, " (%.2g to %.2g over the shapes)", pick->low, pick->high);
  fprintf(stream, ", %s\n", range_text(pick->in_range));
}

static void print_needed(FILE *stream, const scree_study_result *r, const scree_family_result *f) {
  for (size_t k = 0; k + 1 < f->level_count; k++) {
    const scree_comparison *c = &f->comparisons[k];
    if (!isnan(c->low) && !c->equivalent && !c->different && c->count_needed)
      fprintf(stream, "Rp %s is open: with this spread about %zu replicate%s would decide it\n",
              r->points[f->levels[k]].rp, c->count_needed, cli_plural(c->count_needed));
  }
}

static void print_family(FILE *stream, const scree_study_result *r, const scree_family_result *f) {
  if (f->label[0]) fprintf(stream, "%s:\n", f->label);
  print_needed(stream, r, f);
  print_pick(stream, "Rp that choose recommends", &f->recommended);
  print_pick(stream, "Rp by the paper's criterion", &f->by_ip);
  print_pick(stream, "Rp by the robust criterion", &f->by_robust);
  if (!f->time_law.count) return;
  fprintf(stream, "the time of a run grows as Rp to the power %.3f", f->time_law.exponent);
  if (!isnan(f->time_law.exponent_low))
    fprintf(stream, " [%.3f, %.3f]", f->time_law.exponent_low, f->time_law.exponent_high);
  if (f->time_curve.count)
    fprintf(stream, "; a polynomial of fourth order fits to %.3g s", f->time_curve.rms);
  fputs("\n", stream);
}

/* A table for each answer of a scene. */
static void print_answers(FILE *stream, const scree_study_result *r) {
  int width = label_width(r, false);
  fprintf(stream, "intervals of %g %%; time of the processor\n", 100 * r->confidence);
  for (size_t k = 0; k < r->answer_count; k++) {
    fprintf(stream, "%s%s%s%s\n%-*s %7s %10s %-22s %9s %8s\n", r->answers[k],
            r->units[k][0] ? " [" : "", r->units[k], r->units[k][0] ? "]" : "", width, "point",
            "runs", "mean", "  interval", "SD", "time (s)");
    for (size_t i = 0; i < r->point_count; i++) {
      const scree_point_result *p = &r->points[i];
      const scree_summary *a = &p->answers[k];
      print_label(stream, label_of(r, i, r->name), width);
      fprintf(stream, " %3zu/%-3zu ", p->counts.done, r->replicate_count);
      if (a->count == 0)
        fprintf(stream, "%10s %32s", "-", "");
      else if (a->count < 2 || a->sd == 0)
        fprintf(stream, "%10.5g %-32s", a->mean, a->count < 2 ? "" : "all runs alike");
      else
        fprintf(stream, "%10.5g [%9.4g, %9.4g] %9.4g", a->mean, a->mean_low, a->mean_high, a->sd);
      if (p->counts.done)
        fprintf(stream, " %8.3g\n", p->seconds.mean);
      else
        fprintf(stream, " %8s\n", "-");
    }
  }
}

/* The answer, a line for each of those that it has. */
static void print_words(FILE *stream, const scree_study_result *r) {
  enum { MOST_ANSWERS = 5 };
  size_t count = r->answer_count ? r->answer_count : 1;
  scree_words words;
  for (size_t k = 0; k < count && k < MOST_ANSWERS; k++) {
    scree_study_words(r, k, &words);
    if (k == 0) fprintf(stream, "%s.\n", words.state);
    fprintf(stream, "%s\n", words.answer);
    if (r->counts.done == 0) return;
  }
  if (count > MOST_ANSWERS) fprintf(stream, "and %zu more answers\n", count - MOST_ANSWERS);
  scree_study_words(r, 0, &words);
  fprintf(stream, "%s\n", words.but);
  if (*words.next) fprintf(stream, "Next: %s\n", words.next);
}

void study_print(FILE *stream, const scree_study_result *r, bool all) {
  print_words(stream, r);
  print_counts(stream, r);
  if (!all) return;
  if (r->answer_count) {
    print_answers(stream, r);
  } else {
    fprintf(
        stream,
        "angle of repose by %s, in degrees: mean, its %g %% interval, standard deviation (SD) and\n"
        "coefficient of variation (CV) over the runs; processor time of a run\n",
        r->angle, 100 * r->confidence);
    print_table(stream, r);
  }
  for (size_t f = 0; f < r->family_count; f++) print_family(stream, r, &r->families[f]);
  if (r->mixed_versions) fputs("the runs were made by different versions of scree\n", stream);
  for (size_t i = 0; i < r->failure_count && i < 5; i++)
    fprintf(stream, "failed: %s, replicate %zu: %s\n", r->failures[i].label,
            r->failures[i].replicate, r->failures[i].reason);
  if (r->failure_count > 5) fprintf(stream, "and %zu more\n", r->failure_count - 5);
}
