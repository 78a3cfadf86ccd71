#include "cli/pile_measured.h"
#include "report/program.h"

#include "base/file.h"
#include "cli/output.h"
#include "cli/scene_run.h"

#include <math.h>
#include <string.h>

cli_pile_kind cli_pile_kind_of(const char *path) {
  char head[8] = {0};
  scree_stream stream;
  if (!strcmp(path, "-")) return CLI_PILE_SCENE;
  if (cli_is_sample(path, NULL)) return CLI_PILE_SCAN;
  if (cli_has_ending(path, ".csv")) return CLI_PILE_OUTLINE;
  if (!scree_stream_open(path, &stream)) return CLI_PILE_SCENE; /* which says why */
  bool whole = scree_stream_read(&stream, head, sizeof head);
  scree_stream_close(&stream);
  if (whole && !memcmp(head, "\x89PNG\r\n\x1a\n", sizeof head)) return CLI_PILE_PICTURE;
  return whole && !memcmp(head, "scree", 5) ? CLI_PILE_SCENE : CLI_PILE_SCAN;
}

/* What was found, to be freed but for the numbers. */
typedef struct found {
  scree_ground ground;
  scree_repose repose;
  scree_outline outline;
} found;

static void free_found(found *f) {
  scree_outline_free(&f->outline);
}

static scree_status measure_scan(const cli_call *call, const cli_measured_pile *what, found *f,
                                 scree_error *error) {
  const cli_source source = {.unit = what->unit, .resolution = 0.27e-3, .seed = 1};
  cli_input_options input = cli_source_options(&source);
  SCREE_CLEANUP(scree_height_field_free) scree_height_field field = {0};
  SCREE_CLEANUP(scree_scan_free) scree_scan scan = {0};
  input.remarked = true; /* a heap is larger than a particle */
  SCREE_TRY(cli_load(call->inputs[0], &input, call->progress, &scan, error));
  SCREE_TRY(scree_height_field_scan(&scan.mesh, what->cell, &f->ground, &field, error));
  SCREE_TRY(scree_repose_measure(&field, &what->how, &f->repose, error));
  return what->csv ? scree_outline_of_field(&field, f->repose.axis[0], &f->outline, error)
                   : SCREE_OK;
}

static scree_status measure_picture(const cli_call *call, const cli_measured_pile *what, found *f,
                                    scree_error *error) {
  SCREE_CLEANUP(scree_image_free) scree_image image = {0};
  SCREE_TRY(scree_image_read_png(call->inputs[0], &image, error));
  return scree_outline_trace(image.pixels, image.width, image.height,
                             what->scale / (double)image.width, &f->outline, error);
}

static scree_status find(const cli_call *call, const cli_measured_pile *what, found *f,
                         scree_error *error) {
  if (what->kind == CLI_PILE_SCAN) return measure_scan(call, what, f, error);
  SCREE_TRY(what->kind == CLI_PILE_PICTURE
                ? measure_picture(call, what, f, error)
                : scree_outline_read(call->inputs[0], what->unit, &f->outline, error));
  scree_status status =
      scree_outline_measure(&f->outline, what->cell, &what->how, &f->repose, error);
  return status == SCREE_BAD_FILE ? cli_name_in_error(call->inputs[0], error) : status;
}

static void print_outline(const scree_outline *o) {
  puts("x [m],z [m]");
  for (size_t i = 0; i < o->count; i++) printf("%.6g,%.6g\n", o->x[i], o->z[i]);
}

static void print_found(const cli_measured_pile *what, const found *f) {
  const scree_ground *g = &f->ground;
  if (what->kind == CLI_PILE_SCAN) {
    printf("floor in %.0f %% of the scan, to %.2g mm, turned by %.1f deg", 100 * g->share,
           1e3 * g->rms, 57.29577951308232 * acos(fmin(1, g->up[2])));
    if (g->filled > 0) printf("; holes filled: %.1f %% of the heap", 100 * g->filled);
    putchar('\n');
  } else {
    printf("%s, %zu points, %.4g mm across; sectors and silhouettes are its two sides\n",
           what->kind == CLI_PILE_PICTURE ? "silhouette" : "outline", f->outline.count,
           1e3 * (f->outline.x[f->outline.count - 1] - f->outline.x[0]));
  }
  cli_print_repose(stdout, &f->repose);
}

scree_status cli_measure_pile(const cli_call *call, const cli_measured_pile *what,
                              scree_error *error) {
  static const char *const kinds[] = {"scene", "scan", "outline", "picture"};
  SCREE_CLEANUP(free_found) found f = {.ground.share = 0};
  if (find(call, what, &f, error) != SCREE_OK) return cli_name_in_error(call->inputs[0], error);
  const scree_heap_entry entry = {
      call->inputs[0], kinds[what->kind], call->command_line,
      &f.repose,       &what->how,        what->kind == CLI_PILE_SCAN ? &f.ground : NULL};
  if (what->json) return scree_heap_json_write(&entry, "-", true, error);
  if (what->csv)
    print_outline(&f.outline);
  else
    print_found(what, &f);
  return SCREE_OK;
}
