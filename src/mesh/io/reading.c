/* What a reader begins and ends with: text behind a byte order mark, the unit in scree's own
 * comment, welding in metres, and the sentence where it fails. */
#include "mesh/io/read.h"

#include "mesh/io/write.h"
#include "mesh/weld.h"

#include <stdarg.h>
#include <string.h>

scree_status scree_reading_fail(const scree_reading *r, scree_status status, const char *format,
                                ...) {
  char sentence[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(sentence, sizeof sentence, format, arguments);
  va_end(arguments);
  return scree_fail(r->error, status, "%s: %s", r->name, sentence);
}

scree_text scree_reading_text(const scree_reading *r) {
  const char *begin = (const char *)r->bytes, *end = begin + r->byte_count, *p = begin;
  if (r->byte_count >= 3 && !memcmp(p, "\xef\xbb\xbf", 3)) p += 3;
  return (scree_text){begin, p, end, r->name, r->unit_m, r->error};
}

typedef struct scaled_positions {
  const double *positions;
  double unit_m;
} scaled_positions;

static void fetch_scaled(const void *context, size_t first, size_t count, double *out) {
  const scaled_positions *scaled = context;
  const double *p = scaled->positions + 3 * first;
  for (size_t i = 0; i < 3 * count; i++) out[i] = p[i] * scaled->unit_m;
}

static scree_status weld_source(scree_reading *r, const double *positions, size_t position_count,
                                const uint32_t *triangles, size_t triangle_count) {
  scaled_positions scaled = {positions, r->unit_m};
  scree_corner_source source = {fetch_scaled, &scaled, position_count, triangles, triangle_count};
  r->scan->facet_count = triangle_count;
  return scree_weld_corners(&source, r->options->weld_tolerance, &r->scan->mesh,
                            &r->scan->degenerate_count, NULL, r->error);
}

scree_status scree_reading_weld(scree_reading *r, const double *corner_positions,
                                size_t triangle_count) {
  if (triangle_count == 0)
    return scree_reading_fail(r, SCREE_BAD_FILE, "%s with no facets", r->scan->format);
  return weld_source(r, corner_positions, 3 * triangle_count, NULL, triangle_count);
}

scree_status scree_reading_weld_faces(scree_reading *r, const double *positions,
                                      size_t position_count, scree_face_list *faces) {
  r->scan->solid_count = 1;
  size_t face_count = faces->triangles.count + faces->polygons.count;
  if (face_count == 0)
    return scree_reading_fail(r, SCREE_BAD_FILE, "%s with no facets (%zu vertices)",
                              r->scan->format, position_count);
  SCREE_TRY(scree_face_list_triangulate(faces, positions, r->name, r->error));
  SCREE_TRY(weld_source(r, positions, position_count, faces->triangles.items,
                        faces->triangles.count / 3));
  r->scan->facet_count += faces->lost_count;
  r->scan->degenerate_count += faces->lost_count;
  return SCREE_OK;
}

/* scree's comment stands in a binary STL's header, behind `solid`, and behind the words for
 * comments of PLY, OBJ and OFF. */
void scree_reading_take_unit(scree_reading *r, const unsigned char *bytes, size_t byte_count) {
  static const char *const marks[] = {"", "solid ", "comment ", "# "};
  enum { LINES = 4 };
  const char *p = (const char *)bytes;
  const char *end = p + (byte_count < SCREE_SNIFF_BYTES ? byte_count : SCREE_SNIFF_BYTES);
  double *unit = &r->scan->comment_unit_m;
  for (int line = 0; line < LINES && p && *unit == 0; line++) {
    for (size_t i = 0; i < sizeof marks / sizeof *marks && *unit == 0; i++) {
      size_t length = strlen(marks[i]);
      if ((size_t)(end - p) >= length && !memcmp(p, marks[i], length))
        *unit = scree_provenance_unit(p + length, end);
    }
    p = memchr(p, '\n', (size_t)(end - p));
    if (p) p++;
  }
  if (*unit == 0 || r->options->ignore_comment_unit) return;
  r->unit_m = *unit;
  r->scan->states_unit = true;
}
