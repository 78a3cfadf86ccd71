/* One description, five files. */
#include "report/plot.h"

#include "base/file.h"
#include "base/number.h"
#include "base/path.h"
#include "base/quote.h"
#include "report/csv.h"

#include <string.h>

/* Those that are painted first, in the order of scree_paint. */
static const char *const ENDINGS[] = {".png", ".svg", ".pdf", ".csv", ".gnuplot"};
enum { ENDING_COUNT = 5, LABEL_BYTES = 256 };

/* ---- data ---- */

static void write_csv(const scree_figure *figure, FILE *stream) {
  fputs("panel,series,label,x,y,low,high\n", stream);
  for (size_t p = 0; p < figure->panel_count; p++)
    for (size_t s = 0; s < figure->panels[p].series_count; s++) {
      const scree_series *series = &figure->panels[p].series[s];
      char label[LABEL_BYTES];
      scree_text_plain(series->label ? series->label : "", label, sizeof label);
      for (size_t i = 0; i < series->count; i++) {
        const double *values[4] = {series->x, series->y, series->low, series->high};
        fprintf(stream, "%zu,%zu,", p + 1, s + 1);
        scree_quote(stream, SCREE_QUOTE_CSV, label);
        for (int v = 0; v < 4; v++) {
          putc(',', stream);
          if (values[v]) scree_csv_number(stream, values[v][i]);
        }
        putc('\n', stream);
      }
    }
}

/* A text of the figure: gnuplot's enhanced text has the same marks. */
static void write_label(FILE *stream, const char *text) {
  scree_text_run r;
  putc('\'', stream);
  while (text && *text) {
    text = scree_text_run_next(text, &r);
    if (r.kind) fprintf(stream, "%c{", r.kind);
    scree_quote(stream, SCREE_QUOTE_GNUPLOT_LABEL, r.text);
    if (r.kind) putc('}', stream);
  }
  putc('\'', stream);
}

static void write_script_axis(FILE *stream, char name, const scree_axis *axis) {
  fprintf(stream, "set %clabel ", name);
  write_label(stream, axis->label);
  fprintf(stream, "\n%s logscale %c\n", axis->scale == SCREE_SCALE_LOG ? "set" : "unset", name);
  if (axis->scale == SCREE_SCALE_LOG) fprintf(stream, "set format %c \"10^{%%L}\"\n", name);
  char low[SCREE_NUMBER_SIZE] = "*", high[SCREE_NUMBER_SIZE] = "*";
  if (axis->minimum != 0 || axis->maximum != 0) {
    scree_number_format(axis->minimum, low);
    scree_number_format(axis->maximum, high);
  }
  fprintf(stream, "set %crange [%s:%s]\n", name, low, high);
}

static void write_script_series(FILE *stream, const char *data, size_t panel, size_t index,
                                const scree_series *series) {
  const char *kind = !(series->draw & SCREE_DRAW_LINE)   ? "points"
                     : series->draw & SCREE_DRAW_MARKERS ? "linespoints"
                                                         : "lines";
  fputs("  ", stream);
  scree_quote(stream, SCREE_QUOTE_GNUPLOT, data);
  fprintf(stream, " using ($1==%zu&&$2==%zu?$4:NaN):5 with %s lc %d dt %d title ", panel, index,
          kind, series->style < 0 ? 0 : series->style + 1,
          series->draw & SCREE_DRAW_DASHED ? 2 : 1);
  write_label(stream, series->label);
  if ((series->draw & (SCREE_DRAW_BARS | SCREE_DRAW_BAND)) && series->low && series->high) {
    fputs(", \\\n  ", stream);
    scree_quote(stream, SCREE_QUOTE_GNUPLOT, data);
    fprintf(stream, " using ($1==%zu&&$2==%zu?$4:NaN):5:6:7 with yerrorbars lc %d notitle", panel,
            index, series->style < 0 ? 0 : series->style + 1);
  }
}

static void write_script(const scree_figure *figure, const char *data, FILE *stream) {
  size_t columns = figure->columns ? figure->columns : figure->panel_count;
  if (columns > figure->panel_count) columns = figure->panel_count;
  fputs("# gnuplot -p FILE draws the figure from the .csv beside it (run it in the same folder)\n"
        "set datafile separator comma\nset key below maxrows 4\nset grid\n",
        stream);
  if (figure->note) {
    fputs("# ", stream);
    scree_quote(stream, SCREE_QUOTE_COMMENT, figure->note);
    putc('\n', stream);
  }
  fprintf(stream, "set multiplot layout %zu,%zu\n", (figure->panel_count + columns - 1) / columns,
          columns);
  for (size_t p = 0; p < figure->panel_count; p++) {
    const scree_panel *panel = &figure->panels[p];
    fputs("set title ", stream);
    write_label(stream, panel->title);
    putc('\n', stream);
    write_script_axis(stream, 'x', &panel->x);
    write_script_axis(stream, 'y', &panel->y);
    if (panel->series_count == 0) continue;
    fputs("plot \\\n", stream);
    for (size_t s = 0; s < panel->series_count; s++) {
      write_script_series(stream, data, p + 1, s + 1, &panel->series[s]);
      fputs(s + 1 < panel->series_count ? ", \\\n" : "\n", stream);
    }
  }
  fputs("unset multiplot\n", stream);
}

/* Its data: the name without folders and with .csv in place of .gnuplot; in this folder, for
 * gnuplot runs what begins with `<`. */
static scree_status write_script_for(const scree_figure *figure, const char *path, FILE *stream,
                                     scree_error *error) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  char data[SCREE_PATH_BYTES];
  int length = (int)(strlen(name) - strlen(".gnuplot"));
  if (snprintf(data, sizeof data, "./%.*s.csv", length, name) >= (int)sizeof data)
    return scree_fail(error, SCREE_LIMIT, "%.200s: the path is too long", path);
  write_script(figure, data, stream);
  return SCREE_OK;
}

static scree_status write_one(const scree_figure *figure, int ending, const char *path,
                              bool overwrite, scree_error *error) {
  scree_output output;
  SCREE_TRY(scree_output_open(path, overwrite, &output, error));
  scree_status status = SCREE_OK;
  if (ending <= SCREE_PAINT_PDF)
    status = scree_figure_paint(figure, (scree_paint)ending, output.stream, path, error);
  else if (!strcmp(ENDINGS[ending], ".csv"))
    write_csv(figure, output.stream);
  else
    status = write_script_for(figure, path, output.stream, error);
  if (status == SCREE_OK) return scree_output_commit(&output, error);
  scree_output_discard(&output);
  return status;
}

static scree_status write_all(const scree_figure *figure, const char *stem, bool overwrite,
                              scree_error *error) {
  for (int i = 0; i < ENDING_COUNT; i++) {
    char path[SCREE_PATH_BYTES];
    snprintf(path, sizeof path, "%s%s", stem, ENDINGS[i]);
    scree_status status = write_one(figure, i, path, overwrite, error);
    if (status != SCREE_OK && status != SCREE_UNSUPPORTED) return status;
  }
  return SCREE_OK;
}

scree_status scree_figure_write(const scree_figure *figure, const char *path, bool overwrite,
                                scree_error *error) {
  const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
  bool bare = !dot || (slash && dot < slash);
  if (figure->panel_count == 0)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%s: a figure without panels", path);
  for (int i = 0; !bare && i < ENDING_COUNT; i++)
    if (scree_ends_with(path, ENDINGS[i])) return write_one(figure, i, path, overwrite, error);
  if (bare) return write_all(figure, path, overwrite, error);
  return scree_fail(error, SCREE_BAD_ARGUMENT,
                    "%s: a figure ends in .png, .svg, .pdf, .csv or .gnuplot", path);
}
