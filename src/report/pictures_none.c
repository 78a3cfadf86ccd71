/* A build without pictures (SCREE_PICTURES=OFF): the data behind them are written all the same. */
#include "report/image.h"
#include "report/plot.h"

static scree_status refuse(scree_error *error) {
  return scree_fail(error, SCREE_UNSUPPORTED,
                    "this build of scree has no pictures (SCREE_PICTURES=OFF)");
}

scree_status scree_figure_paint(const scree_figure *figure, scree_paint paint, FILE *stream,
                                const char *path, scree_error *error) {
  (void)figure, (void)paint, (void)stream, (void)path;
  return refuse(error);
}
scree_status scree_image_caption(scree_image *image, const char *text, size_t x, size_t y,
                                 size_t width, size_t height, scree_error *error) {
  (void)image, (void)text, (void)x, (void)y, (void)width, (void)height;
  return refuse(error);
}
scree_status scree_image_scale_bar(scree_image *image, const scree_render_options *options,
                                   scree_error *error) {
  (void)image, (void)options;
  return refuse(error);
}
scree_status scree_image_write_png(const scree_image *image, const char *path, bool overwrite,
                                   scree_error *error) {
  (void)image, (void)path, (void)overwrite;
  return refuse(error);
}
scree_status scree_image_read_png(const char *path, scree_image *image, scree_error *error) {
  (void)path, (void)image;
  return refuse(error);
}
