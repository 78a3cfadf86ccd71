/* Cairo streams into our own output file, so that a picture appears complete or not at all. */
#include "report/plot_draw.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <math.h>

static const double PIXELS_PER_POINT = 2;

/* Never fails: a write that does leaves its mark on the stream, and scree_output_commit, which
 * knows the reason, finds it. */
static cairo_status_t to_stream(void *stream, const unsigned char *bytes, unsigned count) {
  (void)fwrite(bytes, 1, count, stream);
  return CAIRO_STATUS_SUCCESS;
}

static cairo_status_t draw_to(const scree_figure *figure, cairo_surface_t *surface, double scale) {
  cairo_t *cr = cairo_create(surface);
  cairo_scale(cr, scale, scale);
  scree_figure_draw(figure, cr);
  cairo_status_t status = cairo_status(cr);
  cairo_destroy(cr);
  return status;
}

static cairo_status_t write_png(const scree_figure *figure, FILE *stream) {
  double width, height;
  scree_figure_extent(figure, &width, &height);
  cairo_surface_t *surface =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)ceil(width * PIXELS_PER_POINT),
                                 (int)ceil(height * PIXELS_PER_POINT));
  cairo_status_t status = draw_to(figure, surface, PIXELS_PER_POINT);
  if (status == CAIRO_STATUS_SUCCESS)
    status = cairo_surface_write_to_png_stream(surface, to_stream, stream);
  cairo_surface_destroy(surface);
  return status;
}

static cairo_status_t write_vector(const scree_figure *figure, FILE *stream, bool pdf) {
  double width, height;
  scree_figure_extent(figure, &width, &height);
  cairo_surface_t *surface =
      pdf ? cairo_pdf_surface_create_for_stream(to_stream, stream, width, height)
          : cairo_svg_surface_create_for_stream(to_stream, stream, width, height);
  cairo_status_t status = draw_to(figure, surface, 1);
  cairo_surface_finish(surface);
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
  cairo_surface_destroy(surface);
  return status;
}

scree_status scree_figure_paint(const scree_figure *figure, scree_paint paint, FILE *stream,
                                const char *path, scree_error *error) {
  cairo_status_t drawn = paint == SCREE_PAINT_PNG
                             ? write_png(figure, stream)
                             : write_vector(figure, stream, paint == SCREE_PAINT_PDF);
  if (drawn == CAIRO_STATUS_SUCCESS) return SCREE_OK;
  return scree_fail(error, SCREE_IO, "%s: cannot draw: %s", path, cairo_status_to_string(drawn));
}
