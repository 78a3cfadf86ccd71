#include "cli/input.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct render_arguments {
  const char *output, *size, *reference;
  cli_source source;
  double azimuth_deg, elevation_deg;
  size_t samples, columns;
  bool edges, wire, no_ground, no_captions, overwrite;
} render_arguments;

static const render_arguments defaults = {.size = "1200x900",
                                          .source = CLI_SOURCE_DEFAULTS,
                                          .azimuth_deg = 35,
                                          .elevation_deg = 25,
                                          .samples = 24};

#define AT(field) offsetof(render_arguments, field)
static const cli_option options[] = {
    {"output", 'o', CLI_TEXT, AT(output), "FILE", "The PNG to write (required); - is stdout.", 0, 0,
     NULL},
    {"size", 's', CLI_TEXT, AT(size), "WxH", "Size in pixels. Default: 1200x900.", 0, 0, NULL},
    {"azimuth", 'a', CLI_REAL, AT(azimuth_deg), "DEG",
     "The camera's angle about the vertical. Default: 35.", -360, 360, NULL},
    {"elevation", 'e', CLI_REAL, AT(elevation_deg), "DEG",
     "The camera's angle above the horizontal. Default: 25.", -90, 90, NULL},
    {"samples", 'n', CLI_COUNT, AT(samples), "N",
     "Rays a pixel: more is smoother and slower. Default: 24.", 1, 65536, NULL},
    {"columns", 'c', CLI_COUNT, AT(columns), "N",
     "Columns of views. Default: what makes them largest.", 1, 1000, NULL},
    {"edges", 0, CLI_FLAG, AT(edges), NULL, "Draw the edges of the triangles.", 0, 0, NULL},
    {"wire", 0, CLI_FLAG, AT(wire), NULL, "Draw only the edges.", 0, 0, NULL},
    {"reference", 'r', CLI_TEXT, AT(reference), "FILE",
     "Colour by the distance to the surface in FILE, with a scale bar.", 0, 0, NULL},
    {"no-ground", 0, CLI_FLAG, AT(no_ground), NULL, "No floor and no shadow on it.", 0, 0, NULL},
    {"no-captions", 0, CLI_FLAG, AT(no_captions), NULL,
     "No file name and triangle count below each view.", 0, 0, NULL},
    {"unit", 'u', CLI_UNIT, AT(source.unit), "UNIT", "The files' unit of length. Default: mm.", 0,
     0, NULL},
    CLI_SAMPLE_OPTIONS(render_arguments, source),
    {"force", 'f', CLI_FLAG, AT(overwrite), NULL, "Overwrite an existing file.", 0, 0, NULL},
};

typedef struct picture {
  size_t count;
  scree_scan *scans;
  double **distances; /* per scan, or NULL */
  scree_render_item *items;
  scree_render_cell *cells;
  char (*captions)[160];
} picture;

static void free_picture(picture *p) {
  for (size_t i = 0; i < p->count; i++) {
    if (p->scans) scree_scan_free(&p->scans[i]);
    if (p->distances) free(p->distances[i]);
  }
  free(p->scans);
  free(p->distances);
  free(p->items);
  free(p->cells);
  free(p->captions);
}

static bool allocate_picture(picture *p, size_t count) {
  *p = (picture){count,
                 calloc(count, sizeof *p->scans),
                 calloc(count, sizeof *p->distances),
                 calloc(count, sizeof *p->items),
                 calloc(count, sizeof *p->cells),
                 calloc(count, sizeof *p->captions)};
  return p->scans && p->distances && p->items && p->cells && p->captions;
}

static scree_status read_one(picture *p, size_t i, const char *word, const cli_source *source,
                             const scree_progress *progress, scree_error *error) {
  cli_input_options input = cli_source_options(source);
  scree_status status = cli_load(word, &input, progress, &p->scans[i], error);
  if (status != SCREE_OK) return status;
  char name[96], count[32];
  cli_short_name(word, name, sizeof name);
  snprintf(p->captions[i], sizeof p->captions[i], "%s: %s triangles", name,
           cli_count_text(p->scans[i].mesh.triangle_count, count));
  p->items[i] = (scree_render_item){.mesh = &p->scans[i].mesh, .color = {0.34f, 0.46f, 0.60f}};
  p->cells[i] = (scree_render_cell){&p->items[i], 1, p->captions[i]};
  return SCREE_OK;
}

/* Distances of every vertex of every mesh to the reference, and their largest. */
static scree_status measure_distances(picture *p, const char *word, const cli_source *source,
                                      double *largest, scree_error *error) {
  cli_input_options input = cli_source_options(source);
  scree_scan reference;
  scree_status status = cli_load(word, &input, NULL, &reference, error);
  if (status != SCREE_OK) return status;
  for (size_t i = 0; status == SCREE_OK && i < p->count; i++) {
    size_t count = p->scans[i].mesh.vertex_count;
    p->distances[i] = malloc(count * sizeof(double) + 1);
    if (!p->distances[i]) {
      *error = (scree_error){SCREE_OUT_OF_MEMORY, "out of memory for the distances"};
      status = SCREE_OUT_OF_MEMORY;
      break;
    }
    status = scree_mesh_distance_field(&p->scans[i].mesh, &reference.mesh, p->distances[i], error);
    p->items[i].vertex_values = p->distances[i];
    for (size_t j = 0; status == SCREE_OK && j < count; j++)
      *largest = fmax(*largest, p->distances[i][j]);
  }
  scree_scan_free(&reference);
  return status;
}

static int run(const cli_call *call) {
  const render_arguments *arguments = call->options;
  scree_render_options render = scree_default_render_options();
  char rest;
  if (!arguments->output) return cli_misuse(call->verb, "needs an output file: -o FILE.png");
  if (sscanf(arguments->size, "%zux%zu%c", &render.width, &render.height, &rest) != 2)
    return cli_misuse(call->verb, "--size %s: not a size such as 1200x900", arguments->size);
  render.azimuth_deg = arguments->azimuth_deg;
  render.elevation_deg = arguments->elevation_deg;
  render.samples = arguments->samples;
  render.columns = arguments->columns;
  render.edges = arguments->edges;
  render.wire = arguments->wire;
  render.ground = !arguments->no_ground;

  picture p;
  scree_error error = {SCREE_OUT_OF_MEMORY, "out of memory"};
  scree_image image = {0};
  scree_status status = allocate_picture(&p, call->input_count) ? SCREE_OK : SCREE_OUT_OF_MEMORY;
  for (size_t i = 0; status == SCREE_OK && i < p.count; i++) {
    status = read_one(&p, i, call->inputs[i], &arguments->source, call->progress, &error);
    if (arguments->no_captions) p.cells[i].caption = NULL;
  }
  if (status == SCREE_OK && arguments->reference) {
    render.value_maximum = 0;
    render.value_label = "distance / mm";
    render.value_scale = 1e3;
    status = measure_distances(&p, arguments->reference, &arguments->source, &render.value_maximum,
                               &error);
  }
  if (status == SCREE_OK)
    status = scree_render(p.cells, p.count, &render, call->progress, &image, &error);
  if (status == SCREE_OK)
    status = scree_image_write_png(&image, arguments->output, arguments->overwrite, &error);
  scree_image_free(&image);
  free_picture(&p);
  return status == SCREE_OK ? 0 : cli_fail(&error);
}

const cli_verb cli_verb_render = {
    .name = "render",
    .summary = "picture of meshes, ray-traced",
    .inputs = "FILE...|sample:NAME...",
    .description =
        "Writes one PNG with a view of each mesh, framed alike, captioned with its name and "
        "triangle count: for example a scan and its levels side by side.",
    .examples = "  scree render scan.stl -o scan.png\n"
                "  scree render scan.stl level-*.stl -o levels.png --size 1800x500 --edges\n"
                "  scree render level.stl --reference scan.stl -o error.png\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .defaults = &defaults,
    .options_size = sizeof defaults,
    .input_minimum = 1,
    .input_maximum = 1000,
    .run = run,
};
