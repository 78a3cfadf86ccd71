/* The report of `scree drop`: what the page is made of, and the page. The moments come from
 * series.csv, which a pour that went on has whole. */
#include "cli/drop.h"

#include "base/file.h"
#include "base/platform.h"
#include "report/provenance.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { MOMENTS = 240 }; /* of the longest schedule, as of a heap */

scree_status drop_record(drop_run *run, double schedule, scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = drop_path(run, "motion.scree", path, error);
  if (status != SCREE_OK || !(schedule > 0)) return status;
  return scree_pour_record(run->pour, path, schedule / MOMENTS, error);
}

/* ---- moments ---- */

typedef struct points {
  scree_pour_point *items;
  size_t count, capacity;
} points;

static bool add_point(points *p, const scree_pour_point *point) {
  if (p->count == p->capacity) {
    size_t capacity = 2 * p->capacity + 256;
    scree_pour_point *items = realloc(p->items, capacity * sizeof *items);
    if (!items) return false;
    p->items = items;
    p->capacity = capacity;
  }
  p->items[p->count++] = *point;
  return true;
}

/* A line as drop_write_line writes it; false for any other, as the head. */
static bool parse_line(const char *line, scree_pour_point *point) {
  scree_observation *o = &point->seen;
  unsigned long long steps;
  double ledger;
  return sscanf(line, "%lf,%llu,%zu,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%zu,%zu,%lf,%lf,%lf,%lf",
                &o->time, &steps, &o->body_count, &o->kinetic, &o->rotational, &o->potential,
                &o->elastic, &o->dissipated_dashpot, &o->dissipated_friction,
                &point->entered_energy, &ledger, &o->pair_count, &o->contact_count,
                &o->coordination, &o->largest_overlap, &o->highest_speed, &o->mean_rotation) == 17;
}

/* Of series.csv; and the last one with all its digits, from the pour as it stands. */
static scree_status read_points(const drop_run *run, points *p, scree_error *error) {
  char path[DROP_PATH_BYTES], line[1024];
  scree_pour_point point = {.entered_energy = 0};
  scree_status status = drop_path(run, "series.csv", path, error);
  if (status != SCREE_OK) return status;
  FILE *stream = scree_open_stream(path, "r");
  if (!stream) return cli_refuse(error, SCREE_IO, path, strerror(errno));
  bool room = true;
  while (room && fgets(line, sizeof line, stream))
    if (parse_line(line, &point)) room = add_point(p, &point);
  fclose(stream);
  scree_world_observe(scree_pour_view(run->pour), &point.seen);
  point.entered_energy = scree_pour_entered_energy(run->pour);
  if (p->count) p->count--;
  return room && add_point(p, &point) ? SCREE_OK : drop_no_memory(error);
}

/* ---- files ---- */

/* Name and source of each shape: a pour of another program may know neither. */
static void name_shapes(const drop_run *run, size_t count, const char **names, const char **sources,
                        char (*numbers)[32]) {
  for (size_t i = 0; i < count; i++) {
    snprintf(numbers[i], sizeof numbers[i], "shape %zu", i + 1);
    scree_pour_shape shape = scree_pour_get_shape(run->pour, i);
    names[i] = shape.name ? shape.name : numbers[i];
    sources[i] = shape.source;
  }
}

static scree_status write_json(const drop_run *run, const char *stopped_because,
                               scree_error *error) {
  char path[DROP_PATH_BYTES];
  size_t count = scree_pour_shape_count(run->pour);
  const char **texts = calloc(2 * count, sizeof *texts);
  char(*numbers)[32] = calloc(count, sizeof *numbers);
  points p = {NULL, 0, 0};
  if (!texts || !numbers) {
    free(texts);
    free(numbers);
    return drop_no_memory(error);
  }
  name_shapes(run, count, texts, texts + count, numbers);
  scree_status status = read_points(run, &p, error);
  scree_pour_entry entry = {.pour = run->pour,
                            .names = texts,
                            .sources = texts + count,
                            .points = p.items,
                            .point_count = p.count,
                            .still = run->schedule.still,
                            .stopped_because = stopped_because,
                            .command_line = run->call->command_line};
  if (status == SCREE_OK) status = drop_path(run, "drop.json", path, error);
  if (status == SCREE_OK) status = scree_pour_json_write(&entry, path, true, error);
  free(p.items);
  free(texts);
  free(numbers);
  return status;
}

scree_status drop_write_report(drop_run *run, const char *stopped_because, const char *text,
                               scree_error *error) {
  char path[DROP_PATH_BYTES];
  scree_status status = scree_pour_record_end(run->pour, error);
  if (status == SCREE_OK) status = drop_path(run, "last.world", path, error);
  if (status == SCREE_OK) status = scree_world_save(scree_pour_view(run->pour), path, true, error);
  if (status == SCREE_OK) status = write_json(run, stopped_because, error);
  if (status == SCREE_OK) status = drop_path(run, "drop.txt", path, error);
  if (status == SCREE_OK) status = scree_text_write(text, path, true, error);
  if (status == SCREE_OK) status = drop_path(run, "provenance.json", path, error);
  if (status == SCREE_OK)
    status = scree_provenance_write(&run->start, run->call->command_line, path, true, error);
  if (status == SCREE_OK) status = drop_path(run, "report.html", path, error);
  if (status == SCREE_OK) status = scree_page_write(&run->arguments->output, 1, path, true, error);
  return status;
}
