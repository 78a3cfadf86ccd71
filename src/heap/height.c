/* A height field from the particles' own triangles: each triangle raises the cells whose centres
 * its projection covers. */
#include "base/alloc.h"
#include "base/vec.h"

#include <math.h>

static const double most_cells = 1e8; /* 0.8 GB: a coarser grid is meant */
static const double rounding = 1e-9;  /* a centre on an edge is in both triangles, not in neither */

scree_status scree_height_field_create(double centre_x, double centre_y, double half_width,
                                       double cell, scree_height_field *field, scree_error *error) {
  double side = ceil(2 * half_width / cell);
  if (!(cell > 0) || !(half_width > 0) || !(side * side <= most_cells))
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "a height field of half width %g m with cells of %g m: must be positive and "
                      "at most %g cells",
                      half_width, cell, most_cells);
  size_t count = (size_t)side;
  double *height = scree_alloc_zero(count * count, sizeof *height);
  if (!height) return scree_fail_memory(error, count * count * sizeof *height, "a height field");
  *field = (scree_height_field){
      centre_x - 0.5 * side * cell, centre_y - 0.5 * side * cell, cell, count, count, height};
  return SCREE_OK;
}

void scree_height_field_free(scree_height_field *field) {
  if (!field) return;
  scree_free(field->height);
  *field = (scree_height_field){0};
}

typedef struct cell_range {
  size_t begin, end;
} cell_range;

/* Cells whose centres lie in [low, high]. */
static cell_range centres_between(double low, double high, double origin, double cell,
                                  size_t count) {
  double first = ceil((low - origin) / cell - 0.5), last = floor((high - origin) / cell - 0.5);
  if (!(last >= 0) || !(first < (double)count) || first > last) return (cell_range){0, 0};
  return (cell_range){first > 0 ? (size_t)first : 0,
                      last + 1 < (double)count ? (size_t)last + 1 : count};
}

static void raise_cell(double *height, double z) {
  if (z > *height) *height = z;
}

static void raise_point(scree_height_field *field, vec3 p) {
  double i = floor((p.x - field->x) / field->cell), j = floor((p.y - field->y) / field->cell);
  if (i >= 0 && j >= 0 && i < (double)field->columns && j < (double)field->rows)
    raise_cell(&field->height[(size_t)j * field->columns + (size_t)i], p.z);
}

static double edge_function(vec3 a, vec3 b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/* Whether the triangle covered any centre. */
static bool raise_triangle(scree_height_field *field, vec3 a, vec3 b, vec3 c) {
  double area = edge_function(a, b, c.x, c.y);
  bool covered = false;
  if (area == 0) return false;
  cell_range columns = centres_between(fmin(a.x, fmin(b.x, c.x)), fmax(a.x, fmax(b.x, c.x)),
                                       field->x, field->cell, field->columns);
  cell_range rows = centres_between(fmin(a.y, fmin(b.y, c.y)), fmax(a.y, fmax(b.y, c.y)), field->y,
                                    field->cell, field->rows);
  for (size_t j = rows.begin; j < rows.end; j++)
    for (size_t i = columns.begin; i < columns.end; i++) {
      double x = field->x + ((double)i + 0.5) * field->cell;
      double y = field->y + ((double)j + 0.5) * field->cell;
      double u = edge_function(b, c, x, y) / area, v = edge_function(c, a, x, y) / area;
      if (u < -rounding || v < -rounding || u + v > 1 + rounding) continue;
      raise_cell(&field->height[j * field->columns + i], u * a.z + v * b.z + (1 - u - v) * c.z);
      covered = true;
    }
  return covered;
}

void scree_height_field_add_mesh(scree_height_field *field, const scree_mesh *mesh,
                                 const double position[3], const double quaternion[4],
                                 double floor_z) {
  mat3 rotation = quat_to_mat3(quat_load(quaternion));
  vec3 origin = {position[0], position[1], position[2] - floor_z};
  for (size_t t = 0; t < mesh->triangle_count; t++) {
    vec3 p[3];
    for (int corner = 0; corner < 3; corner++) {
      vec3 local = vec3_load(mesh->positions + 3 * (size_t)mesh->triangles[3 * t + (size_t)corner]);
      p[corner] = vec3_add(mat3_mul_vec(&rotation, local), origin);
    }
    if (!raise_triangle(field, p[0], p[1], p[2]))
      for (int corner = 0; corner < 3; corner++) raise_point(field, p[corner]);
  }
}

void scree_height_field_add_sphere(scree_height_field *field, const double centre[3], double radius,
                                   double floor_z) {
  cell_range columns = centres_between(centre[0] - radius, centre[0] + radius, field->x,
                                       field->cell, field->columns);
  cell_range rows =
      centres_between(centre[1] - radius, centre[1] + radius, field->y, field->cell, field->rows);
  bool covered = false;
  for (size_t j = rows.begin; j < rows.end; j++)
    for (size_t i = columns.begin; i < columns.end; i++) {
      double dx = field->x + ((double)i + 0.5) * field->cell - centre[0];
      double dy = field->y + ((double)j + 0.5) * field->cell - centre[1];
      double left = radius * radius - dx * dx - dy * dy;
      if (left < 0) continue;
      raise_cell(&field->height[j * field->columns + i], centre[2] - floor_z + sqrt(left));
      covered = true;
    }
  if (!covered) raise_point(field, (vec3){centre[0], centre[1], centre[2] - floor_z + radius});
}
