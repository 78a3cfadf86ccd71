/* The parent's side of reading through a child process (mesh/io/read_import.c): the child may have
 * been taken over by the file, so nothing that it answers is believed before it is checked. */
#include "mesh/io/import.h"
#include "mesh/io/read.h"

#include <math.h>
#include <string.h>

static const double MOST_SIZE_M = 1e30;

const scree_import_kind scree_import_kinds[] = {
    [SCREE_IMPORT_COLLADA] = {"COLLADA", "dae", SCREE_UNIT_METRE},
    [SCREE_IMPORT_X3D] = {"X3D", "x3d", SCREE_UNIT_METRE},
    [SCREE_IMPORT_AMF] = {"AMF", "amf", SCREE_UNIT_IN_ROOT},
    [SCREE_IMPORT_FBX] = {"FBX", "fbx", SCREE_UNIT_IN_SCENE},
    [SCREE_IMPORT_3DS] = {"3DS", "3ds", SCREE_UNIT_ASKED},
};

double scree_unit_of_root(const char *name) {
  static const struct {
    const char *name;
    double unit_m;
  } units[] = {{"micron", 1e-6}, {"millimeter", 1e-3}, {"centimeter", 1e-2}, {"inch", 0.0254},
               {"foot", 0.3048}, {"feet", 0.3048},     {"meter", 1}};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (!strcmp(units[i].name, name)) return units[i].unit_m;
  return 0;
}

/* One printable line, whatever the file put into it. */
static void make_printable(char *text, size_t size) {
  text[size - 1] = 0;
  for (; *text; text++)
    if (*text < ' ' || *text > '~') *text = *text == '\n' || *text == '\t' ? ' ' : '?';
}

static scree_status check_corners(scree_reading *r, const double *corners, size_t triangle_count) {
  double most = MOST_SIZE_M / r->unit_m;
  for (size_t i = 0; i < 9 * triangle_count; i++)
    if (!(fabs(corners[i]) <= most))
      return scree_reading_fail(
          r, SCREE_BAD_FILE,
          "triangle %zu of %zu has a coordinate %g; coordinates must be finite and at most %g m "
          "in size",
          i / 9 + 1, triangle_count, corners[i], MOST_SIZE_M);
  return SCREE_OK;
}

scree_status scree_import_take(scree_reading *r, scree_import_format format, const char *bytes,
                               size_t byte_count) {
  _Static_assert(sizeof(scree_import_answer) % sizeof(double) == 0,
                 "the corners behind it are aligned");
  scree_import_answer a;
  if (byte_count < sizeof a)
    return scree_reading_fail(r, SCREE_BAD_FILE, "as %s: no answer from the child process",
                              scree_import_kinds[format].name);
  memcpy(&a, bytes, sizeof a);
  make_printable(a.message, sizeof a.message);
  make_printable(a.unit_name, sizeof a.unit_name);
  if (a.status != SCREE_OK)
    return scree_reading_fail(r, a.status == SCREE_LIMIT ? SCREE_LIMIT : SCREE_BAD_FILE, "%s",
                              a.message);
  size_t corner_bytes = byte_count - sizeof a;
  if (a.triangle_count > SCREE_IMPORT_MOST ||
      corner_bytes != a.triangle_count * 9 * sizeof(double) ||
      !(a.unit_m >= 1e-9 && a.unit_m <= 1e6))
    return scree_reading_fail(r, SCREE_BAD_FILE, "as %s: the child process contradicts itself",
                              scree_import_kinds[format].name);
  r->scan->solid_count = 1;
  if (scree_import_kinds[format].unit == SCREE_UNIT_ASKED) {
    snprintf(r->scan->format, sizeof r->scan->format, "%s", scree_import_kinds[format].name);
  } else {
    r->unit_m = a.unit_m;
    r->scan->states_unit = true;
    snprintf(r->scan->format, sizeof r->scan->format, "%s, %s", scree_import_kinds[format].name,
             a.unit_name);
  }
  const double *corners = (const double *)(const void *)(bytes + sizeof a);
  SCREE_TRY(check_corners(r, corners, a.triangle_count));
  return scree_reading_weld(r, corners, a.triangle_count);
}
