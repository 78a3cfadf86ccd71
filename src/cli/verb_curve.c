/* scree curve: the table of levels. */
#include "base/math.h"
#include "base/owned.h"
#include "cli/input.h"
#include "cli/options.h"
#include "cli/surface.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <math.h>

typedef struct curve_arguments {
  cli_source source;
  cli_soundness soundness;
  const char *grid;
  size_t points;
  int method;
  bool distance, csv, json;
} curve_arguments;

#define ARGUMENTS curve_arguments
static const cli_option options[] = {
    CLI_CHOICE_ROW("method", method, "METHOD", "volume|qecd",
                   "volume keeps the volume at every level; qecd is MeshLab's quadric edge "
                   "collapse decimation. Default: volume."),
    CLI_GRID_OPTION,
    CLI_FLAG_ROW("distance", distance,
                 "Mean and maximum distance from the scan to the level and back, in the table in "
                 "place of S, V and Q; the Hausdorff distance is the greater maximum."),
    CLI_RANGE_ROW(CLI_COUNT, "points", points, "N", 0, 268435456,
                  "Points per surface for --distance; every vertex is one besides. Default: the "
                  "scan's vertex count."),
    CLI_FLAG_ROW("csv", csv, "Comma-separated values in SI units, full digits."),
    CLI_FLAG_ROW("json", json, "JSON in SI units: one object with the levels in an array."),
    CLI_SOUNDNESS_OPTIONS,
    CLI_SOURCE_OPTIONS,
};

static const curve_arguments defaults = {.source = CLI_SOURCE_DEFAULTS, .grid = CLI_GRID_DEFAULT};

/* Parts of the time with --distance, without which the curve takes the rest. */
static const double LOAD_PART = 0.1, CURVE_PART = 0.3;

/* Share of a step by which the end of the grid may be missed. */
static const double GRID_SLACK = 1e-9;

/* What the rows need. */
typedef struct table {
  const cli_call *call;
  const curve_arguments *arguments;
  cli_share share; /* of the progress: all is one */
  cli_grid grid;
  scree_curve *curve;
  scree_replay *replay;
  scree_surface *scan;
  scree_level first;
  scree_curve_row *rows;
  size_t row_count;
  scree_error *error;
} table;

static void free_table(table *t) {
  scree_free(t->rows);
  scree_replay_free(t->replay);
  scree_surface_free(t->scan);
  scree_curve_free(t->curve);
}

static void print_header(const table *t) {
  bool distance = t->arguments->distance;
  if (t->arguments->json) return;
  printf("%*s", t->arguments->csv ? 0 : 9, t->arguments->csv ? "triangle_count" : "triangles");
  for (int k = 0; k < SCREE_CURVE_COLUMNS; k++) {
    const scree_curve_column *c = &scree_curve_columns[k];
    if (!t->arguments->csv && c->text[distance].width)
      printf(" %*s", c->text[distance].width, c->head);
    else if (t->arguments->csv && (distance || k < SCREE_CURVE_DISTANCES))
      printf(",%s", c->of.key);
  }
  putchar('\n');
}

static void print_row(const table *t, const scree_curve_row *row) {
  bool distance = t->arguments->distance, csv = t->arguments->csv;
  cli_terminal_end();
  printf("%*zu", csv ? 0 : 9, row->level.triangle_count);
  for (int k = 0; k < SCREE_CURVE_COLUMNS; k++) {
    const scree_curve_column *c = &scree_curve_columns[k];
    double value = scree_field_real(&c->of, row);
    if (!csv && c->text[distance].width)
      printf(" %*.*g", c->text[distance].width, c->text[distance].digits, value * c->scale);
    else if (csv && (distance || k < SCREE_CURVE_DISTANCES))
      printf(",%.17g", value);
  }
  putchar('\n');
}

static scree_status measure_distance(table *t, size_t index, const scree_progress *progress,
                                     scree_distance *distance) {
  scree_distance_options settings = scree_default_distance_options();
  const scree_mesh *mesh;
  SCREE_OWNED(scree_surface, surface);
  settings.sample_count = t->arguments->points;
  SCREE_TRY(scree_replay_step(t->replay, index, &mesh, t->error));
  SCREE_TRY(scree_surface_create(mesh, &surface, t->error));
  return scree_surface_distance(t->scan, surface, &settings, progress, distance, t->error);
}

static scree_status make_row(table *t, size_t index, const scree_progress *progress,
                             scree_curve_row *row) {
  double whole = fabs(t->first.volume);
  scree_curve_level(t->curve, index, &row->level);
  row->eps_s = fabs(row->level.area - t->first.area) / t->first.area;
  row->eps_v = whole > 0 ? fabs(row->level.volume - t->first.volume) / whole : 0;
  row->ip = row->eps_s + row->level.rp;
  return t->arguments->distance ? measure_distance(t, index, progress, &row->distance) : SCREE_OK;
}

/* Rows from fine to coarse on the grid of Rp, each level once; text and CSV as they come. */
static scree_status make_rows(table *t) {
  const curve_arguments *arguments = t->arguments;
  double bottom = scree_log10(t->grid.least), steps = t->grid.per_decade;
  size_t rows = (size_t)floor((scree_log10(t->grid.most) - bottom) * steps + GRID_SLACK) + 1;
  size_t last = SIZE_MAX;
  SCREE_TRY_ALLOC_ZERO(t->rows, rows, t->error);
  for (size_t i = 0; i < rows; i++) {
    double rp = scree_power_of_ten(bottom + (double)(rows - 1 - i) / steps);
    size_t target = (size_t)(rp * (double)t->first.triangle_count * (1 + 1e-12));
    size_t index = scree_curve_find(t->curve, target);
    if (index == last) continue;
    last = index;
    double part = (1 - LOAD_PART - CURVE_PART) / (double)rows;
    const scree_progress *progress =
        cli_share_enter(&t->share, 1 - part * (double)(rows - i), part);
    SCREE_TRY(make_row(t, index, progress, &t->rows[t->row_count]));
    if (!arguments->json) print_row(t, &t->rows[t->row_count]);
    t->row_count++;
  }
  return SCREE_OK;
}

static scree_status write_json(table *t, const scree_scan *scan) {
  scree_curve_entry entry = {.file = t->call->inputs[0],
                             .format = scan->format,
                             .checksum = scan->checksum,
                             .unit_m = scan->unit_m,
                             .facts = scree_curve_get_facts(t->curve),
                             .area = t->first.area,
                             .volume = t->first.volume,
                             .rows = t->rows,
                             .row_count = t->row_count,
                             .distances = t->arguments->distance};
  return scree_curve_json_write(&entry, t->call->command_line, "-", false, t->error);
}

static void print_legend(const table *t) {
  if (t->call->quiet || t->arguments->csv || t->arguments->json) return;
  if (t->arguments->distance)
    printf("Rp = share of the scan's triangles; eps_s, eps_v errors of area and volume;\n"
           "Ip = eps_s + Rp, the paper's criterion; mean, max: distance of the scan to the\n"
           "level, mm; back: of the level to the scan\n");
  else
    printf("Rp = share of the scan's triangles; S area, V volume; eps_s, eps_v their errors;\n"
           "Ip = eps_s + Rp, the paper's criterion; Q quadric error, about the distance moved\n");
}

static void print_facts(const table *t, const scree_scan *scan) {
  scree_curve_facts facts = scree_curve_get_facts(t->curve);
  char shown[CLI_PRINTABLE_BYTES];
  if (t->call->quiet || t->arguments->csv || t->arguments->json) return;
  printf("%s: %zu triangles, %zu shell%s, method %s; the coarsest level has %zu",
         cli_printable(t->call->inputs[0], shown), facts.triangle_count, facts.shell_count,
         cli_plural(facts.shell_count), scree_method_name(facts.method), facts.floor_count);
  cli_print_unit(stdout, t->call->inputs[0], scan);
  putchar('\n');
  if (!facts.closed)
    printf("not closed: %zu boundary edge%s; V and eps_v mean nothing\n", facts.boundary_edge_count,
           cli_plural(facts.boundary_edge_count));
  if (facts.locked_vertex_count > 0)
    printf("non-manifold places: %zu of the vertices stay where they are\n",
           facts.locked_vertex_count);
}

static scree_status run(const cli_call *call, scree_error *error) {
  SCREE_CLEANUP(free_table) table t = {.call = call, .arguments = call->options, .error = error};
  scree_simplify_options settings = scree_default_simplify_options();
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  const bool distance = t.arguments->distance;
  double scale, part = distance ? CURVE_PART : 1 - LOAD_PART;
  SCREE_TRY(cli_parse_grid(call->verb, t.arguments->grid, &t.grid));
  settings.method = (scree_method)t.arguments->method;
  cli_call loading = *call;
  t.share = cli_share_of(call->progress, distance ? "decimating and measuring" : "decimating");
  loading.progress = cli_share_enter(&t.share, 0, LOAD_PART);
  SCREE_TRY(cli_load_for_levels(&loading, &t.arguments->source, &t.arguments->soundness, &scan,
                                &scale, error));
  SCREE_TRY(scree_curve_build_scaled(&scan.mesh, scale, &settings,
                                     cli_share_enter(&t.share, LOAD_PART, part), &t.curve, error));
  if (distance) {
    SCREE_TRY(scree_surface_create(&scan.mesh, &t.scan, error));
    SCREE_TRY(scree_replay_start(t.curve, &t.replay, error));
  }
  scree_curve_level(t.curve, 0, &t.first);
  cli_terminal_end();
  print_facts(&t, &scan);
  print_legend(&t);
  print_header(&t);
  SCREE_TRY(make_rows(&t));
  cli_terminal_end();
  return t.arguments->json ? write_json(&t, &scan) : SCREE_OK;
}

const cli_verb cli_verb_curve = {
    .name = "curve",
    .summary = "print area, volume and errors at every level of decimation",
    .inputs = "FILE|sample:NAME",
    .description =
        "Decimates a scan once (repaired first where it is no closed surface, which is said) and "
        "prints, on a logarithmic grid of the percentage reduction Rp = N/Nm: the triangle count, "
        "Rp, the area S, the volume V, eps_s = |S - Sm|/Sm, eps_v alike, the criterion Ip = eps_s "
        "+ Rp of Katagiri and Koyanaka (2020), and the quadric error.",
    .examples = "scree curve phone.stl\n"
                "scree curve phone.stl --distance --csv > phone.csv\n"
                "scree curve phone.stl -m qecd --grid 1e-4:1e-1:20\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = 1,
    .partners = "points:distance " CLI_SAMPLE_PARTNERS,
    .exclusive = "json|csv " CLI_SOUNDNESS_EXCLUSIVE,
    .run = run,
};
