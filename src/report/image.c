#include "report/image.h"

#include "base/alloc.h"
#include "base/file.h"

#include <cairo.h>
#include <string.h>

enum { BAR_WIDTH = 16, BAR_MARGIN = 90, CAPTION_FONT_PX = 19, BAR_FONT_PX = 15 };
enum { LARGEST_PNG = 256 << 20, MOST_ACROSS = 16384 };

/* ---- between our rows of bytes and cairo's rows of native 32-bit words ---- */

static cairo_surface_t *surface_of(const scree_image *image) {
  cairo_surface_t *surface =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)image->width, (int)image->height);
  if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
    cairo_surface_destroy(surface);
    return NULL;
  }
  cairo_surface_flush(surface);
  unsigned char *data = cairo_image_surface_get_data(surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(surface);
  for (size_t row = 0; row < image->height; row++)
    for (size_t column = 0; column < image->width; column++) {
      const uint8_t *p = image->pixels + 3 * (row * image->width + column);
      uint32_t word = (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
      memcpy(data + row * stride + 4 * column, &word, 4);
    }
  cairo_surface_mark_dirty(surface);
  return surface;
}

static void take_back(scree_image *image, cairo_surface_t *surface) {
  cairo_surface_flush(surface);
  const unsigned char *data = cairo_image_surface_get_data(surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(surface);
  for (size_t row = 0; row < image->height; row++)
    for (size_t column = 0; column < image->width; column++) {
      uint32_t word;
      memcpy(&word, data + row * stride + 4 * column, 4);
      uint8_t *p = image->pixels + 3 * (row * image->width + column);
      p[0] = (uint8_t)(word >> 16);
      p[1] = (uint8_t)(word >> 8);
      p[2] = (uint8_t)word;
    }
}

static void set_font(cairo_t *cr, double size) {
  cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cr, size);
  cairo_set_source_rgb(cr, 0.1, 0.1, 0.12);
}

/* Draws with `draw` on the image. */
typedef void draw_function(cairo_t *cr, const scree_image *image, const void *context);

static scree_status draw_on(scree_image *image, draw_function *draw, const void *context,
                            scree_error *error) {
  cairo_surface_t *surface = surface_of(image);
  if (!surface) return scree_fail_memory(error, 4 * image->width * image->height, "a picture");
  cairo_t *cr = cairo_create(surface);
  draw(cr, image, context);
  bool drawn = cairo_status(cr) == CAIRO_STATUS_SUCCESS;
  cairo_destroy(cr);
  if (drawn) take_back(image, surface);
  cairo_surface_destroy(surface);
  return drawn ? SCREE_OK : scree_fail(error, SCREE_BAD_ARGUMENT, "text is not valid UTF-8");
}

typedef struct caption_box {
  const char *text;
  size_t x, y, width, height;
} caption_box;

static void draw_caption(cairo_t *cr, const scree_image *image, const void *context) {
  (void)image;
  const caption_box *box = context;
  cairo_text_extents_t extents;
  set_font(cr, CAPTION_FONT_PX);
  cairo_text_extents(cr, box->text, &extents);
  double room = (double)box->width - 8;
  if (extents.x_advance > room) {
    cairo_set_font_size(cr, CAPTION_FONT_PX * room / extents.x_advance);
    cairo_text_extents(cr, box->text, &extents);
  }
  cairo_move_to(cr, (double)box->x + 0.5 * ((double)box->width - extents.x_advance),
                (double)box->y + 0.68 * (double)box->height);
  cairo_show_text(cr, box->text);
}

scree_status scree_image_caption(scree_image *image, const char *text, size_t x, size_t y,
                                 size_t width, size_t height, scree_error *error) {
  caption_box box = {text, x, y, width, height};
  return draw_on(image, draw_caption, &box, error);
}

static void draw_scale_bar(cairo_t *cr, const scree_image *image, const void *context) {
  const scree_render_options *options = context;
  double height = 0.5 * (double)image->height, top = 0.25 * (double)image->height;
  double left = (double)image->width - BAR_MARGIN;
  for (int i = 0; i < (int)height; i++) {
    vec3 c = scree_viridis(1 - i / height);
    cairo_set_source_rgb(cr, scree_to_srgb(c.x) / 255.0, scree_to_srgb(c.y) / 255.0,
                         scree_to_srgb(c.z) / 255.0);
    cairo_rectangle(cr, left, top + i, BAR_WIDTH, 1.5);
    cairo_fill(cr);
  }
  set_font(cr, BAR_FONT_PX);
  for (int i = 0; i <= 4; i++) {
    double t = i / 4.0;
    double value = options->value_minimum + t * (options->value_maximum - options->value_minimum);
    char text[32];
    snprintf(text, sizeof text, "%.3g", value * options->value_scale);
    cairo_move_to(cr, left + BAR_WIDTH + 6, top + (1 - t) * height + 0.35 * BAR_FONT_PX);
    cairo_show_text(cr, text);
  }
  cairo_text_extents_t extents;
  cairo_text_extents(cr, options->value_label, &extents);
  cairo_move_to(cr, (double)image->width - 8 - extents.x_advance, top - 14);
  cairo_show_text(cr, options->value_label);
}

scree_status scree_image_scale_bar(scree_image *image, const scree_render_options *options,
                                   scree_error *error) {
  return draw_on(image, draw_scale_bar, options, error);
}

typedef struct png_bytes {
  const char *at;
  size_t left;
} png_bytes;

static cairo_status_t from_bytes(void *context, unsigned char *to, unsigned count) {
  png_bytes *b = context;
  if (count > b->left) return CAIRO_STATUS_READ_ERROR;
  memcpy(to, b->at, count);
  b->at += count;
  b->left -= count;
  return CAIRO_STATUS_SUCCESS;
}

/* Cairo gives what is not opaque as premultiplied colours with an alpha: over white. */
static void lay_on_white(cairo_surface_t *read, scree_image *image, cairo_surface_t *surface) {
  cairo_t *cr = cairo_create(surface);
  cairo_set_source_rgb(cr, 1, 1, 1);
  cairo_paint(cr);
  cairo_set_source_surface(cr, read, 0, 0);
  cairo_paint(cr);
  cairo_destroy(cr);
  take_back(image, surface);
}

/* Width and height as the file's head says: cairo would take memory for them unseen. */
static bool is_png(const char *head, size_t size, size_t *width, size_t *height) {
  static const char magic[] = "\x89PNG\r\n\x1a\n";
  if (size < 24 || memcmp(head, magic, sizeof magic - 1) != 0) return false;
  const unsigned char *p = (const unsigned char *)head + 16;
  *width = (size_t)p[0] << 24 | (size_t)p[1] << 16 | (size_t)p[2] << 8 | p[3];
  *height = (size_t)p[4] << 24 | (size_t)p[5] << 16 | (size_t)p[6] << 8 | p[7];
  return true;
}

static scree_status decode(const char *path, png_bytes b, scree_image *image, scree_error *error) {
  cairo_surface_t *read = cairo_image_surface_create_from_png_stream(from_bytes, &b);
  cairo_status_t why = cairo_surface_status(read);
  scree_status status = SCREE_OK;
  if (why != CAIRO_STATUS_SUCCESS)
    status = scree_fail(error, why == CAIRO_STATUS_NO_MEMORY ? SCREE_OUT_OF_MEMORY : SCREE_BAD_FILE,
                        "%s: cannot be read as a PNG: %s", path, cairo_status_to_string(why));
  image->pixels = status == SCREE_OK ? scree_alloc_zero(3 * image->width * image->height, 1) : NULL;
  cairo_surface_t *surface = image->pixels ? surface_of(image) : NULL;
  if (surface) lay_on_white(read, image, surface);
  if (status == SCREE_OK && !surface)
    status = scree_fail_memory(error, 3 * image->width * image->height, "a picture");
  if (status != SCREE_OK) scree_image_free(image);
  if (surface) cairo_surface_destroy(surface);
  cairo_surface_destroy(read);
  return status;
}

scree_status scree_image_read_png(const char *path, scree_image *image, scree_error *error) {
  SCREE_CLEANUP(scree_free_at) char *content = NULL;
  size_t size;
  scree_image made = {0};
  SCREE_TRY(scree_file_read(path, LARGEST_PNG, &content, &size, error));
  if (!is_png(content, size, &made.width, &made.height))
    return scree_fail(error, SCREE_BAD_FILE, "%s: is no PNG", path);
  if (made.width > MOST_ACROSS || made.height > MOST_ACROSS || !made.width || !made.height)
    return scree_fail(error, SCREE_LIMIT, "%s: %zu x %zu pixels; must be 1 to %d each", path,
                      made.width, made.height, MOST_ACROSS);
  SCREE_TRY(decode(path, (png_bytes){content, size}, &made, error));
  *image = made;
  return SCREE_OK;
}

/* Never fails: a write that does leaves its mark on the stream, and scree_output_commit, which
 * knows the reason, finds it. */
static cairo_status_t to_stream(void *stream, const unsigned char *bytes, unsigned count) {
  (void)fwrite(bytes, 1, count, stream);
  return CAIRO_STATUS_SUCCESS;
}

scree_status scree_image_write_png(const scree_image *image, const char *path, bool overwrite,
                                   scree_error *error) {
  cairo_surface_t *surface = surface_of(image);
  if (!surface) return scree_fail_memory(error, 4 * image->width * image->height, "a picture");
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status == SCREE_OK) {
    cairo_status_t drawn = cairo_surface_write_to_png_stream(surface, to_stream, output.stream);
    if (drawn == CAIRO_STATUS_SUCCESS) {
      status = scree_output_commit(&output, error);
    } else {
      scree_output_discard(&output);
      status =
          scree_fail(error, SCREE_IO, "%s: cannot draw: %s", path, cairo_status_to_string(drawn));
    }
  }
  cairo_surface_destroy(surface);
  return status;
}
