#include "cli/input.h"
#include "base/error.h"
#include "base/platform.h"
#include "cli/terminal.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

static const char SAMPLE_PREFIX[] = "sample:";

bool cli_is_sample(const char *word, const char **name) {
  size_t length = sizeof SAMPLE_PREFIX - 1;
  if (strncmp(word, SAMPLE_PREFIX, length) != 0) return false;
  if (name) *name = word + length;
  return true;
}

/* A file that is not there, but a sample of that name. */
static void hint_sample(const char *word, scree_error *error) {
  size_t used = strlen(error->message);
  if (scree_path_exists(word)) return;
  for (size_t i = 0; scree_sample_name(i); i++)
    if (!strcmp(word, scree_sample_name(i)))
      snprintf(error->message + used, sizeof error->message - used, "; did you mean %s%s?",
               SAMPLE_PREFIX, word);
}

/* ---- Remarks ---- */

/* What particles are: from fine sand to boulders, and scans in a unit that nobody named from gravel
 * on: one in metres, taken for millimetres, is smaller. */
static const double smallest_size = 1e-4, smallest_unnamed = 1e-3, largest_size = 10; /* m */

static bool is_quiet, unit_is_given;

void cli_input_obeys(const cli_common *common) {
  is_quiet = common->quiet;
  unit_is_given = common->unit_given;
}

void cli_remark(const char *word, const char *format, ...) {
  char shown[CLI_PRINTABLE_BYTES], sentence[512];
  va_list arguments;
  if (is_quiet) return;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  cli_terminal_end();
  fprintf(stderr, "%s: %s\n",
          cli_printable(strcmp(word, "-") != 0 ? word : "standard input", shown), sentence);
}

/* The longest side of the box around a mesh. */
static double longest_side(const scree_mesh *mesh) {
  double longest = 0;
  for (int k = 0; k < 3; k++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t v = 0; v < mesh->vertex_count; v++) {
      low = fmin(low, mesh->positions[3 * v + k]);
      high = fmax(high, mesh->positions[3 * v + k]);
    }
    longest = fmax(longest, high - low);
  }
  return longest;
}

/* "mm", or "0.007 m" of a unit without a name. */
static const char *unit_text(double unit_m, char buffer[32]) {
  const char *name = cli_unit_name(unit_m);
  if (*name != '?') return name;
  snprintf(buffer, 32, "%.6g m", unit_m);
  return buffer;
}

void cli_remark_size(const char *word, double size, const char *hint) {
  if (size < smallest_unnamed || size > largest_size)
    cli_remark(word, "%.3g %s across: is the unit right? %s", size < 1 ? 1e3 * size : size,
               size < 1 ? "mm" : "m", hint);
}

void cli_add_line(char *text, size_t size, const char *format, ...) {
  size_t used = strlen(text);
  va_list arguments;
  if (used > 0 && used + 1 < size) text[used++] = '\n';
  va_start(arguments, format);
  vsnprintf(text + used, size - used, format, arguments);
  va_end(arguments);
}

void cli_scan_remarks(const cli_input_options *options, const scree_scan *scan, double scale,
                      char *text, size_t bytes) {
  char written[32], asked[32];
  double size = scale * longest_side(&scan->mesh);
  bool states = scan->states_unit || (scan->comment_unit_m > 0 && !unit_is_given);
  if (scan->warning[0]) cli_add_line(text, bytes, "%s", scan->warning);
  if (scan->comment_unit_m > 0 && scan->comment_unit_m != options->read.unit_m)
    cli_add_line(text, bytes,
                 unit_is_given ? "scree wrote it in %s; read in %s, as -u says"
                               : "read in %s, as scree wrote it, not in %s",
                 unit_text(scan->comment_unit_m, written), unit_text(options->read.unit_m, asked));
  double least = states || unit_is_given ? smallest_size : smallest_unnamed;
  if (size < least || size > largest_size)
    cli_add_line(text, bytes, "%.3g %s across: is the unit right?%s", size < 1 ? 1e3 * size : size,
                 size < 1 ? "mm" : "m", states ? "" : " -u says which it is");
}

void cli_remark_scan(const char *word, const cli_input_options *options, const scree_scan *scan,
                     double scale) {
  char text[1024] = "";
  cli_scan_remarks(options, scan, scale, text, sizeof text);
  for (char *line = text, *end; *line; line = end) {
    size_t length = strcspn(line, "\n");
    end = line + length + (line[length] == '\n');
    cli_remark(word, "%.*s", (int)length, line);
  }
}

scree_status cli_load(const char *word, const cli_input_options *options,
                      const scree_progress *progress, scree_scan *scan, scree_error *error) {
  const char *name;
  scree_scan made = {.unit_m = 1, .states_unit = true, .format = "sample", .solid_count = 1};
  scree_status status;
  if (!cli_is_sample(word, &name)) {
    status = scree_scan_read(word, &options->read, scan, error);
    if (status == SCREE_OK && !options->remarked) cli_remark_scan(word, options, scan, 1);
    if (status == SCREE_OK) return status;
    status = cli_name_in_error(word, error);
    hint_sample(word, error);
    return status;
  }
  SCREE_TRY(scree_sample_make(name, &options->sample, progress, &made.mesh, error));
  made.facet_count = made.mesh.triangle_count;
  *scan = made;
  return SCREE_OK;
}

cli_input_options cli_source_options(const cli_source *source) {
  cli_input_options input = {.read = scree_default_read_options(),
                             .sample = scree_default_sample_options()};
  input.read.unit_m = source->unit;
  input.read.ignore_comment_unit = unit_is_given;
  input.sample.resolution = source->resolution;
  input.sample.noise = source->noise;
  input.sample.seed = source->seed;
  return input;
}

void cli_print_unit(FILE *stream, const char *word, const scree_scan *scan) {
  const char *unit = cli_unit_name(scan->unit_m);
  if (!cli_is_sample(word, NULL) && *unit != '?') fprintf(stream, ", coordinates in %s", unit);
}

void cli_short_name(const char *word, char *buffer, size_t size) {
  const char *name;
  if (!strcmp(word, "-")) word = "stdin";
  if (cli_is_sample(word, &name)) {
    snprintf(buffer, size, "%s", name);
    return;
  }
  const char *slash = strrchr(word, '/');
  snprintf(buffer, size, "%s", slash ? slash + 1 : word);
  char *dot = strrchr(buffer, '.');
  if (dot && dot != buffer) *dot = 0;
  if (!buffer[0]) snprintf(buffer, size, "scan");
  scree_make_printable(buffer, '_'); /* a name goes into tables and file names */
}

static bool name_taken(const char *names, size_t stride, size_t before, const char *name) {
  for (size_t k = 0; k < before; k++)
    if (!strcmp(names + k * stride, name)) return true;
  return false;
}

void cli_distinct_name(const char *word, char *names, size_t stride, size_t before, size_t size) {
  char *name = names + before * stride;
  cli_short_name(word, name, size - 24);
  size_t length = strlen(name);
  for (size_t n = 2; name_taken(names, stride, before, name); n++)
    snprintf(name + length, size - length, "-%zu", n);
}

static bool begins_character(char c) {
  return ((unsigned char)c & 0xc0) != 0x80;
}

void cli_print_cell(FILE *stream, const char *text, size_t least, size_t most) {
  size_t count = 0, at = 0;
  for (const char *c = text; *c; c++) count += begins_character(*c);
  size_t left = count <= most ? count : most / 2,
         right = count <= most ? count : count - most + left + 1;
  for (const char *c = text; *c; c++) {
    at += begins_character(*c);
    if (at == left + 1 && begins_character(*c) && at <= right) putc('~', stream);
    if (at <= left || at > right) putc(*c, stream);
  }
  for (; count < least; count++) putc(' ', stream);
}
