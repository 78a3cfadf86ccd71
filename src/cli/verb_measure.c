/* scree measure: sizes, mass properties and topology of scans. */
#include "base/alloc.h"
#include "base/radix.h"
#include "cli/input.h"
#include "cli/output.h"
#include "cli/terminal.h"
#include "report/program.h"

#include <math.h>
#include <string.h>

typedef struct measure_arguments {
  cli_source source;
  double weld;
  const char *zingg;
  bool json, csv, overwrite;
} measure_arguments;

static const measure_arguments defaults = {.source = CLI_SOURCE_DEFAULTS};

#define ARGUMENTS measure_arguments
static const cli_option options[] = {
    CLI_RANGE_ROW(CLI_SHARE, "weld", weld, "SHARE", 0, 0.1,
                  "Unite vertices closer than this share of the bounding box diagonal. Default: 0, "
                  "only equal ones."),
    CLI_SOURCE_OPTIONS,
    CLI_FLAG_ROW("json", json, "JSON: one array, an object per file, in SI units."),
    CLI_FLAG_ROW("csv", csv, "CSV: one row per file, in SI units."),
    CLI_ROW(CLI_TEXT, "zingg", zingg, "FILE",
            "Draw Zingg's plot of all files: .png, .svg or .pdf, or its data as .csv."),
    CLI_FLAG_ROW("force", overwrite, "Overwrite an existing file."),
};

/* ---- Text ---- */

static void print_three(const char *label, const double *values, double unit, const char *name,
                        const char *note) {
  printf("  %-22s %.7g x %.7g x %.7g %s%s\n", label, values[0] / unit, values[1] / unit,
         values[2] / unit, name, note);
}

/* What is rounding beside the largest that it may be counts as zero, which has no sign. */
static double tidy(double value, double largest) {
  return fabs(value) < 1e-14 * largest ? 0 : value;
}

/* As many as tell a place to a ten-millionth of the body's size, however far off it lies. */
static int place_digits(double place, double size) {
  enum { DIGITS = 7, MOST = 17 };
  double more = size > 0 && fabs(place) > size ? ceil(log10(fabs(place) / size)) : 0;
  return more < MOST - DIGITS ? DIGITS + (int)more : MOST;
}

static void print_axis(const char *label, const double axis[3]) {
  printf("  %-22s", label);
  for (int i = 0; i < 3; i++) printf(" %+.6f", fabs(axis[i]) < 5e-7 ? 0 : axis[i]);
  putchar('\n');
}

/* The row of what encloses no volume. */
static void print_none(const char *label) {
  printf("  %-22s none\n", label);
}

static void print_centroid(const scree_measures *m, double unit, const char *name) {
  double size = m->oriented_dimensions[0];
  if (!m->has_volume) {
    print_none("centroid");
    return;
  }
  printf("  %-22s", "centroid");
  for (int i = 0; i < 3; i++)
    printf("%s%.*g", i ? ", " : " ", place_digits(m->centroid[i], size),
           tidy(m->centroid[i], size) / unit);
  printf(" %s\n", name);
}

/* What follows from the volume. */
static void print_mass(const scree_measures *m, double unit, const char *name) {
  static const char *const labels[] = {"equivalent diameter", "sphericity", "convexity",
                                       "principal moments", "principal axes"};
  double cube = unit * unit * unit;
  for (size_t i = 0; i < sizeof labels / sizeof *labels && !m->has_volume; i++)
    print_none(labels[i]);
  if (!m->has_volume) return;
  printf("  %-22s %.7g %s\n", labels[0], m->equivalent_diameter / unit, name);
  printf("  %-22s %.5f\n", labels[1], m->sphericity);
  printf("  %-22s %.5f\n", labels[2], m->convexity);
  printf("  %-22s %.6g, %.6g, %.6g %s5 (times density)\n", labels[3],
         m->principal_moments[0] / cube / unit / unit, m->principal_moments[1] / cube / unit / unit,
         m->principal_moments[2] / cube / unit / unit, name);
  for (int i = 0; i < 3; i++) print_axis(i ? "" : labels[4], m->principal_axes[i]);
}

static void print_measures(const scree_measures *m, double unit) {
  const char *name = cli_unit_name(unit);
  printf("  %-22s %.9g %s2\n", "area S", m->area / unit / unit, name);
  printf("  %-22s %.9g %s3\n", "volume V", m->volume / (unit * unit * unit), name);
  print_centroid(m, unit, name);
  print_three("dimensions x, y, z", m->dimensions, unit, name, "");
  print_three("oriented dimensions", m->oriented_dimensions, unit, name, "");
  print_mass(m, unit, name);
}

static void print_shape(const scree_descriptors *d, double unit) {
  const char *name = cli_unit_name(unit);
  printf("  %-22s %.4f I/L, %.4f S/I: %s (Zingg)\n", "elongation, flatness", d->elongation,
         d->flatness, scree_zingg_name(d->zingg));
  printf("  %-22s %.5f\n", "Krumbein sphericity", d->krumbein_sphericity);
  printf("  %-22s %.4f, %.4g\n", "roundness, angularity", d->roundness, d->angularity);
  printf("  %-22s %.6g inside, %.6g around %s\n", "radii of spheres", d->inscribed_radius / unit,
         d->bounding_radius / unit, name);
}

/* ---- Of a set ---- */

/* Least, quartiles and largest of sorted values, interpolated. */
static void print_spread(const char *label, double *values, size_t count) {
  scree_sort_numbers(values, count);
  printf("  %-22s", label);
  for (int q = 0; q <= 4; q++) printf(" %9.4g", scree_quantile(values, count, q / 4.0));
  putchar('\n');
}

static const scree_field spreads[] = {
    SCREE_FIELD_AS(scree_measure_entry, "equivalent diameter/m", measures.equivalent_diameter),
    SCREE_FIELD_AS(scree_measure_entry, "elongation I/L", descriptors.elongation),
    SCREE_FIELD_AS(scree_measure_entry, "flatness S/I", descriptors.flatness),
    SCREE_FIELD_AS(scree_measure_entry, "Wadell sphericity", measures.sphericity),
    SCREE_FIELD_AS(scree_measure_entry, "Krumbein sphericity", descriptors.krumbein_sphericity),
    SCREE_FIELD_AS(scree_measure_entry, "convexity", measures.convexity),
    SCREE_FIELD_AS(scree_measure_entry, "roundness", descriptors.roundness),
    SCREE_FIELD_AS(scree_measure_entry, "angularity", descriptors.angularity),
};

/* Distributions over all bodies described, and how many are of which class. */
static scree_status print_set(const scree_measure_entry *entries, size_t count,
                              scree_error *error) {
  SCREE_SCRATCH(double, values, count, error);
  size_t bodies = 0, classes[4] = {0};
  for (size_t i = 0; i < count; i++) {
    bodies += entries[i].described;
    if (entries[i].described) classes[entries[i].descriptors.zingg]++;
  }
  if (bodies < 2) return SCREE_OK;
  printf("\n%zu bodies            %9s %9s %9s %9s %9s\n", bodies, "least", "25 %", "median", "75 %",
         "largest");
  for (size_t k = 0; k < sizeof spreads / sizeof *spreads; k++) {
    size_t used = 0;
    for (size_t i = 0; i < count; i++)
      if (entries[i].described) values[used++] = scree_field_real(&spreads[k], &entries[i]);
    print_spread(spreads[k].key, values, used);
  }
  for (int c = 0; c < 4; c++)
    printf("%s%zu %s%s", c ? ", " : "  ", classes[c], scree_zingg_name((scree_zingg)c),
           c == 3 ? "\n" : "");
  return SCREE_OK;
}

static void print_count(size_t count, const char *what) {
  if (count) printf("; %zu %s%s", count, what, cli_plural(count));
}

static void print_topology(const scree_topology *t) {
  printf("  %zu facet%s, %zu vertices, %zu edges in %zu shell%s", t->facet_count,
         cli_plural(t->facet_count), t->vertex_count, t->edge_count, t->shell_count,
         cli_plural(t->shell_count));
  if (t->genus >= 0) printf(", genus %lld", t->genus);
  printf("\n  %s, %s, %s", t->closed ? "closed" : "open", t->manifold ? "manifold" : "not manifold",
         t->oriented ? "consistently wound" : "not consistently wound");
  if (!t->closed)
    printf("; %zu boundary edge%s round %zu hole%s", t->boundary_edge_count,
           cli_plural(t->boundary_edge_count), t->boundary_count, cli_plural(t->boundary_count));
  print_count(t->non_manifold_edge_count, "non-manifold edge");
  if (t->non_manifold_vertex_count)
    printf("; %zu non-manifold vert%s", t->non_manifold_vertex_count,
           t->non_manifold_vertex_count == 1 ? "ex" : "ices");
  print_count(t->inconsistent_edge_count, "inconsistent edge");
  print_count(t->degenerate_facet_count, "degenerate facet");
  print_count(t->duplicate_facet_count, "duplicate facet");
  print_count(t->inward_shell_count, "shell");
  puts(t->inward_shell_count ? " wound inward" : "");
}

static void warn(const scree_measure_entry *entry) {
  const scree_measures *m = &entry->measures;
  const scree_topology *t = &entry->topology;
  char shown[CLI_PRINTABLE_BYTES];
  const char *file = cli_printable(entry->file, shown), *what = NULL;
  size_t crowded = t->non_manifold_edge_count;
  if (!m->has_volume)
    what = "the surface encloses no volume: it has no centroid, moments, sphericity or convexity";
  else if (!m->closed && t->closed && t->oriented)
    fprintf(stderr,
            "scree: %s: warning: %zu non-manifold edge%s, where the facets do not pair up both "
            "ways, so they enclose no volume; volume, centroid, moments and what follows from them "
            "mean little\n",
            file, crowded, cli_plural(crowded));
  else if (!m->closed && t->closed)
    what = "the facets are not wound consistently, so they enclose no volume; volume, centroid, "
           "moments and what follows from them mean little";
  else if (!m->closed)
    what = "the surface is not closed; volume, centroid, moments and what follows from them are a "
           "stand-in, with every hole closed by a cone";
  else if (m->inward)
    what = "the surface is inside out: its volume is negative";
  if (what) fprintf(stderr, "scree: %s: warning: %s\n", file, what);
}

/* Shells are measured one by one and added up: said where their union has another volume. */
static scree_status warn_of_shells(const cli_call *call, const scree_mesh *mesh,
                                   const scree_measure_entry *entry, scree_error *error) {
  const double unit = ((const measure_arguments *)call->options)->source.unit;
  double volume = fabs(entry->measures.volume), cube = pow(unit, 3);
  char shown[CLI_PRINTABLE_BYTES];
  const char *file = cli_printable(entry->file, shown);
  scree_check check;
  if (call->quiet || !entry->measures.closed || entry->topology.shell_count < 2) return SCREE_OK;
  scree_status status = scree_mesh_check(mesh, NULL, call->progress, &check, error);
  cli_terminal_end();
  if (status != SCREE_OK) return status;
  if (!check.volume_known)
    fprintf(stderr,
            "scree: %s: warning: it cannot be told how the shells lie in each other; volume, "
            "centroid and moments count each by itself\n",
            file);
  else if (fabs(check.volume - volume) > 1e-9 * volume)
    fprintf(stderr,
            "scree: %s: warning: shells lie in each other or overlap: their union has a volume of "
            "%.9g %s3; volume, centroid and moments count what they share more than once\n",
            file, check.volume / cube, cli_unit_name(unit));
  return SCREE_OK;
}

/* ---- The work ---- */

static scree_status measure_file(const cli_call *call, const char *file, scree_measure_entry *entry,
                                 char format[32], scree_error *error) {
  const measure_arguments *arguments = call->options;
  cli_input_options input = cli_source_options(&arguments->source);
  scree_scan scan;
  input.read.weld_tolerance = arguments->weld;
  SCREE_TRY(cli_load(file, &input, call->progress, &scan, error));
  memcpy(format, scan.format, sizeof scan.format);
  *entry = (scree_measure_entry){
      .file = file, .format = format, .checksum = scan.checksum, .unit_m = scan.unit_m};
  scree_status status = scree_mesh_measure(&scan.mesh, &entry->measures, error);
  if (status == SCREE_OK) status = scree_mesh_topology(&scan.mesh, &entry->topology, error);
  const scree_measures *m = &entry->measures;
  entry->described = m->closed && m->has_volume && !m->inward;
  if (status == SCREE_OK && entry->described)
    status = scree_mesh_describe(&scan.mesh, m, &entry->descriptors, error);
  if (status == SCREE_OK) status = warn_of_shells(call, &scan.mesh, entry, error);
  if (status == SCREE_OK) entry->topology.degenerate_facet_count += scan.degenerate_count;
  scree_scan_free(&scan);
  return status == SCREE_OK ? status : cli_name_in_error(file, error);
}

static void print_entry(const scree_measure_entry *entry, double unit) {
  char shown[CLI_PRINTABLE_BYTES];
  printf("%s (%s, lengths in %s)\n", cli_printable(entry->file, shown), entry->format,
         cli_unit_name(unit));
  print_topology(&entry->topology);
  print_measures(&entry->measures, unit);
  if (entry->described) print_shape(&entry->descriptors, unit);
}

static scree_status write_tables(const cli_call *call, const scree_measure_entry *entries,
                                 size_t count, scree_error *error) {
  const measure_arguments *arguments = call->options;
  if (arguments->zingg)
    SCREE_TRY(
        scree_zingg_figure_write(entries, count, arguments->zingg, arguments->overwrite, error));
  if (arguments->json)
    return scree_measure_json_write(entries, count, call->command_line, "-", false, error);
  if (arguments->csv) return scree_measure_csv_write(entries, count, "-", false, error);
  return print_set(entries, count, error);
}

/* A file that cannot be measured is told on stderr; the others are measured all the same. */
static scree_status run(const cli_call *call, scree_error *error) {
  const measure_arguments *arguments = call->options;
  if (arguments->zingg) {
    SCREE_TRY(cli_check_ending(call->verb, arguments->zingg, CLI_FIGURE));
    SCREE_TRY(cli_check_output(call, arguments->zingg, arguments->overwrite, error));
  }
  SCREE_SCRATCH_ZERO(scree_measure_entry, entries, call->input_count, error);
  typedef char format_name[32];
  SCREE_SCRATCH_ZERO(format_name, formats, call->input_count, error);
  scree_status status = SCREE_OK;
  size_t count = 0;
  cli_terminal_release(); /* qhull asks nobody whether to go on */
  for (size_t i = 0; i < call->input_count; i++) {
    if (measure_file(call, call->inputs[i], &entries[count], formats[count], error) != SCREE_OK) {
      status = cli_fail(error);
      continue;
    }
    cli_terminal_end();
    if (!arguments->json && !arguments->csv) {
      if (count) putchar('\n');
      print_entry(&entries[count], arguments->source.unit);
      cli_flush();
    }
    if (!call->quiet) warn(&entries[count]);
    count++;
  }
  SCREE_TRY(write_tables(call, entries, count, error));
  return status;
}

const cli_verb cli_verb_measure = {
    .name = "measure",
    .summary = "area, volume, inertia, dimensions and topology of scans",
    .inputs = "FILE...|sample:NAME...",
    .description =
        "Measures each scan: area, volume, centroid, principal moments of inertia (of unit "
        "density), dimensions along the axes and of the least-volume box found, the diameter of "
        "the sphere of equal volume, sphericity (Wadell), convexity (volume over that of the "
        "convex hull), how its facets hang together, and of a closed body what people report of "
        "shapes: elongation, flatness and Zingg's class, Krumbein's sphericity, roundness and "
        "angularity by local curvature, the largest sphere inside and the smallest around; of "
        "several their distributions. Integrals are exact for the polyhedron. Where the surface is "
        "not closed, a warning says so. - is standard input.\n\n"
        "Text is in the file's unit; JSON and CSV are in SI units.",
    .examples = "scree measure phone.stl\n"
                "scree measure --unit m --csv stones/*.ply\n",
    CLI_OPTIONS(options, defaults),
    .input_minimum = 1,
    .input_maximum = SIZE_MAX,
    .partners = CLI_SAMPLE_PARTNERS,
    .exclusive = "json|csv",
    .run = run,
};
