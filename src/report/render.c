/* Pictures of meshes by ray tracing: one jittered primary ray a sample, and at each hit one shadow
 * ray to a large round lamp (soft shadows) and one cosine-weighted ray to a uniform sky (ambient
 * occlusion), both Lambertian. The samples of a pixel are points of the sequence R6 (Roberts 2018),
 * shifted by random numbers of that pixel, so the picture does not depend on threads. Every pixel
 * takes all of them: to stop where the first few agree leaves specks wherever a ray seldom meets
 * what the others miss. Everything is moved into a box about the origin of half-size about 1 before
 * it goes to single precision: coordinates far from the origin are no trouble. */
#include "base/alloc.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/rng.h"
#include "report/image.h"
#include "report/ray.h"

#include <string.h>

/* What makes the look. Lengths are in units of the framed object's half diagonal. */
static const double field_of_view = 0.38; /* rad: a long lens keeps edges nearly parallel */
static const double frame_margin = 1.06;  /* room around the object */
static const double lamp_radius = 0.55;   /* at distance 1: the softness of shadows */
static const double lamp_power = 0.72;    /* of white at normal incidence */
static const double sky_power = 0.42;     /* of an open sky */
static const double self_offset = 2e-4;   /* start of secondary rays above the surface */
static const double ground_size = 30;     /* half width of the floor */
static const double ground_fade = 2.4;    /* distance over which the floor goes into the white */
static const double edge_width_px = 0.9;  /* full width of a drawn edge */
static const double full_edge_px = 14;    /* triangles this long get edges in full */
static const double edge_darkness = 0.75; /* how much of the colour an edge takes away */
static const size_t most_cells = 10000;
static const double unseen = 0.004; /* a share of white: half a step of 8 bits */
enum { ROWS_PER_BLOCK = 4, BAND_ROWS = 32, CAPTION_PX = 34, GAP_PX = 6 };

typedef struct camera {
  vec3 eye, right, up, forward; /* right and up scaled to half the image at distance 1 */
  double pixel_angle;           /* rad per pixel */
} camera;

typedef struct view {
  const scree_render_cell *cell;
  const scree_render_options *options;
  scree_ray_scene *scene;
  size_t ground_item; /* index of the floor among the scene's items; SIZE_MAX: none */
  vec3 centre;        /* of the bodies, m */
  double scale;       /* 1 / half diagonal */
  double floor_z;     /* in the scaled frame */
  camera camera;
  vec3 lamp;
  size_t x, y, width, height; /* of the cell in the image */
  size_t first_row;           /* of the band being rendered */
  uint64_t seed;
  scree_image *image;
} view;

scree_render_options scree_default_render_options(void) {
  return (scree_render_options){.width = 1200,
                                .height = 900,
                                .azimuth_deg = 35,
                                .elevation_deg = 25,
                                .samples = 8,
                                .ground = true,
                                .value_maximum = 1,
                                .value_scale = 1};
}

/* ---- the scene ---- */

static quat item_rotation(const scree_render_item *item) {
  const double *q = item->quaternion;
  quat rotation = {q[0], q[1], q[2], q[3]};
  return q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0 ? (quat){1, 0, 0, 0}
                                                          : quat_unit(rotation);
}

static vec3 item_point(const scree_render_item *item, const mat3 *rotation, size_t vertex) {
  vec3 p = vec3_load(item->mesh->positions + 3 * vertex);
  return vec3_add(mat3_mul_vec(rotation, p), vec3_load(item->position));
}

/* The sphere to fill the picture, where one is asked for; the floor stays under all bodies. */
static void frame_focus(view *v, double lowest) {
  const scree_render_options *o = v->options;
  v->centre = vec3_load(o->focus);
  v->scale = 1 / o->focus_radius;
  v->floor_z = (lowest - v->centre.z) * v->scale - 1e-3;
}

static void frame_bodies(view *v) {
  vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t i = 0; i < v->cell->item_count; i++) {
    const scree_render_item *item = &v->cell->items[i];
    mat3 rotation = quat_to_mat3(item_rotation(item));
    for (size_t j = 0; j < item->mesh->vertex_count; j++) {
      vec3 p = item_point(item, &rotation, j);
      low = vec3_min(low, p);
      high = vec3_max(high, p);
    }
  }
  double half = 0.5 * vec3_distance(low, high);
  bool empty = !(half >= 0) || isinf(half);
  v->centre = empty ? (vec3){0, 0, 0} : vec3_lerp(low, high, 0.5);
  v->scale = empty || half == 0 ? 1 : 1 / half;
  v->floor_z = empty ? -0.5 : (low.z - v->centre.z) * v->scale - 1e-3;
  if (!empty && v->options->focus_radius > 0) frame_focus(v, low.z);
}

static scree_status add_item(view *v, const scree_render_item *item, scree_error *error) {
  size_t count = item->mesh->vertex_count;
  SCREE_SCRATCH(float, positions, 3 * count, error);
  mat3 rotation = quat_to_mat3(item_rotation(item));
  for (size_t j = 0; j < count; j++) {
    vec3 p = vec3_scale(vec3_sub(item_point(item, &rotation, j), v->centre), v->scale);
    positions[3 * j] = (float)p.x;
    positions[3 * j + 1] = (float)p.y;
    positions[3 * j + 2] = (float)p.z;
  }
  return scree_ray_scene_add(v->scene, positions, count, item->mesh->triangles,
                             item->mesh->triangle_count, error);
}

static scree_status add_ground(view *v, scree_error *error) {
  float s = (float)ground_size, z = (float)v->floor_z;
  const float corners[] = {-s, -s, z, s, -s, z, s, s, z, -s, s, z};
  const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
  v->ground_item = v->cell->item_count;
  return scree_ray_scene_add(v->scene, corners, 4, triangles, 2, error);
}

static scree_status build_scene(view *v, scree_error *error) {
  SCREE_TRY(scree_ray_scene_create(&v->scene, error));
  for (size_t i = 0; i < v->cell->item_count; i++)
    SCREE_TRY(add_item(v, &v->cell->items[i], error));
  v->ground_item = SIZE_MAX;
  if (v->options->ground && !v->options->wire) SCREE_TRY(add_ground(v, error));
  return scree_ray_scene_commit(v->scene, error);
}

static const double degree = 0.017453292519943295;

vec3 scree_to_camera(double azimuth_deg, double elevation_deg) {
  double a = azimuth_deg * degree, e = elevation_deg * degree;
  return (vec3){cos(e) * sin(a), -cos(e) * cos(a), sin(e)};
}

/* Moves the camera along its axis until the bounding sphere's projection of every body vertex is
 * inside: one pass over the vertices gives the distance exactly. */
static void place_camera(view *v) {
  double a = v->options->azimuth_deg * degree;
  vec3 back = scree_to_camera(v->options->azimuth_deg, v->options->elevation_deg);
  vec3 right = {cos(a), sin(a), 0}, up = vec3_cross(back, right);
  double half_height = tan(0.5 * field_of_view);
  double half_width = half_height * (double)v->width / (double)v->height;
  double distance = 0;
  bool all = !(v->options->focus_radius > 0);
  if (!all) distance = frame_margin / fmin(half_width, half_height);
  for (size_t i = 0; all && i < v->cell->item_count; i++) {
    const scree_render_item *item = &v->cell->items[i];
    mat3 rotation = quat_to_mat3(item_rotation(item));
    for (size_t j = 0; j < item->mesh->vertex_count; j++) {
      vec3 p = vec3_scale(vec3_sub(item_point(item, &rotation, j), v->centre), v->scale);
      double depth = vec3_dot(p, back);
      distance = fmax(distance, depth + frame_margin * fabs(vec3_dot(p, right)) / half_width);
      distance = fmax(distance, depth + frame_margin * fabs(vec3_dot(p, up)) / half_height);
    }
  }
  if (distance == 0) distance = 3;
  v->camera =
      (camera){vec3_scale(back, distance), vec3_scale(right, half_width),
               vec3_scale(up, half_height), vec3_neg(back), 2 * half_height / (double)v->height};
  v->lamp = vec3_unit(
      vec3_add(vec3_add(vec3_scale(back, 0.55), vec3_scale(right, -0.55)), (vec3){0, 0, 0.95}));
}

/* ---- shading ---- */

static const vec3 white = {1, 1, 1};

static vec3 surface_color(const view *v, const scree_ray_hit *hit) {
  const scree_render_item *item = &v->cell->items[hit->item];
  if (!item->vertex_values) return (vec3){item->color[0], item->color[1], item->color[2]};
  const uint32_t *corner = item->mesh->triangles + 3 * (size_t)hit->triangle;
  double u = (double)hit->u, w = (double)hit->v;
  double value = (1 - u - w) * item->vertex_values[corner[0]] + u * item->vertex_values[corner[1]] +
                 w * item->vertex_values[corner[2]];
  double low = v->options->value_minimum, range = v->options->value_maximum - low;
  return scree_viridis(range > 0 ? (value - low) / range : 0);
}

/* How dark the edges of the hit's triangle make it, 0 to 1: full within half a line's width of an
 * edge, fading out for triangles so small in the picture that their edges would cover them. */
static double edge_ink(const view *v, const scree_ray_hit *hit) {
  const scree_render_item *item = &v->cell->items[hit->item];
  const uint32_t *corner = item->mesh->triangles + 3 * (size_t)hit->triangle;
  vec3 p[3];
  for (int i = 0; i < 3; i++)
    p[i] = vec3_scale(vec3_load(item->mesh->positions + 3 * (size_t)corner[i]), v->scale);
  double area2 = vec3_norm(vec3_triangle_normal(p[0], p[1], p[2]));
  double weight[3] = {1 - (double)hit->u - (double)hit->v, (double)hit->u, (double)hit->v};
  double nearest = INFINITY, longest = 0, pixel = (double)hit->t * v->camera.pixel_angle;
  for (int i = 0; i < 3; i++) {
    double side = vec3_distance(p[(i + 1) % 3], p[(i + 2) % 3]);
    nearest = fmin(nearest, weight[i] * area2 / (side > 0 ? side : 1));
    longest = fmax(longest, side);
  }
  if (nearest >= 0.5 * edge_width_px * pixel) return 0;
  return fmin(1, fmax(0, longest / (full_edge_px * pixel) - 0.25));
}

/* Numbers in [0, 1) that one sample takes. */
typedef struct sample {
  double pixel[2], lamp[2], sky[2];
} sample;

static vec3 disc_sample(const double at[2], double radius) {
  double r = radius * sqrt(at[0]), a = 6.283185307179586 * at[1];
  return (vec3){r * cos(a), r * sin(a), 0};
}

static bool blocked(const view *v, vec3 from, vec3 direction) {
  float origin[3] = {(float)from.x, (float)from.y, (float)from.z};
  float ray[3] = {(float)direction.x, (float)direction.y, (float)direction.z};
  return scree_ray_blocked(v->scene, origin, ray, 1e4f);
}

/* Light from the lamp and the sky that reaches a surface point. */
static double irradiance(const view *v, vec3 point, vec3 normal, const sample *at) {
  vec3 a, b, start = vec3_mad(point, normal, self_offset), d = disc_sample(at->lamp, lamp_radius);
  vec3_frame(v->lamp, &a, &b);
  vec3 to_lamp = vec3_unit(vec3_add(v->lamp, vec3_add(vec3_scale(a, d.x), vec3_scale(b, d.y))));
  double cosine = vec3_dot(normal, v->lamp), light = 0; /* to its middle: there samples agree */
  if (cosine > 0 && vec3_dot(normal, to_lamp) > 0 && !blocked(v, start, to_lamp))
    light += lamp_power * cosine;
  d = disc_sample(at->sky, 1);
  double lift = sqrt(fmax(0, 1 - d.x * d.x - d.y * d.y));
  vec3_frame(normal, &a, &b);
  vec3 to_sky =
      vec3_add(vec3_scale(normal, lift), vec3_add(vec3_scale(a, d.x), vec3_scale(b, d.y)));
  if (!blocked(v, start, to_sky)) light += sky_power;
  return light;
}

static vec3 shade_ground(const view *v, vec3 point, const sample *at) {
  vec3 normal = {0, 0, 1};
  double far = hypot(point.x, point.y) / ground_fade, fade = exp(-far * far);
  if (fade < unseen) return white;
  double open = lamp_power * vec3_dot(normal, v->lamp) + sky_power;
  double light = fmin(1, irradiance(v, point, normal, at) / open);
  double level = 1 - 0.75 * fade * (1 - light);
  return (vec3){level, level, level};
}

static vec3 trace(const view *v, vec3 direction, const sample *at) {
  float origin[3] = {(float)v->camera.eye.x, (float)v->camera.eye.y, (float)v->camera.eye.z};
  float ray[3] = {(float)direction.x, (float)direction.y, (float)direction.z};
  scree_ray_hit hit = scree_ray_first(v->scene, origin, ray);
  if (isinf(hit.t)) return white;
  vec3 point = vec3_mad(v->camera.eye, direction, (double)hit.t);
  if (hit.item == v->ground_item) return shade_ground(v, point, at);
  vec3 normal =
      vec3_unit((vec3){(double)hit.normal[0], (double)hit.normal[1], (double)hit.normal[2]});
  if (vec3_dot(normal, direction) > 0) normal = vec3_neg(normal);
  vec3 color = surface_color(v, &hit);
  double kept = v->options->edges ? 1 - edge_darkness * edge_ink(v, &hit) : 1;
  return vec3_scale(color, kept * irradiance(v, point, normal, at));
}

/* Only edges: goes through the triangles until one is hit near an edge; a few layers are enough. */
static vec3 trace_wire(const view *v, vec3 direction) {
  enum { LAYERS = 24 };
  vec3 start = v->camera.eye;
  double travelled = 0;
  for (int layer = 0; layer < LAYERS; layer++) {
    float origin[3] = {(float)start.x, (float)start.y, (float)start.z};
    float ray[3] = {(float)direction.x, (float)direction.y, (float)direction.z};
    scree_ray_hit hit = scree_ray_first(v->scene, origin, ray);
    if (isinf(hit.t)) return white;
    travelled += (double)hit.t;
    scree_ray_hit seen = hit;
    seen.t = (float)travelled;
    if (edge_ink(v, &seen) > 0)
      return layer == 0 ? (vec3){0.05, 0.05, 0.06} : (vec3){0.45, 0.47, 0.5};
    start = vec3_mad(start, direction, (double)hit.t + self_offset);
    travelled += self_offset;
  }
  return white;
}

/* Sample `index` of a pixel: what the sixth root-like number of x^7 = x + 1 makes of it (Roberts
 * 2018, "The unreasonable effectiveness of quasirandom sequences"), from where the pixel begins. */
static sample sample_at(const double start[6], size_t index) {
  static const double root = 1.1127756842787055;
  double at[6], step = 1;
  for (int i = 0; i < 6; i++) {
    step /= root;
    double x = start[i] + step * (double)index;
    at[i] = x - floor(x);
  }
  return (sample){{at[0], at[1]}, {at[2], at[3]}, {at[4], at[5]}};
}

static vec3 trace_sample(const view *v, size_t column, size_t row, const sample *at) {
  double sx = 2 * ((double)column + at->pixel[0]) / (double)v->width - 1;
  double sy = 1 - 2 * ((double)row + at->pixel[1]) / (double)v->height;
  vec3 direction = vec3_unit(vec3_add(
      v->camera.forward, vec3_add(vec3_scale(v->camera.right, sx), vec3_scale(v->camera.up, sy))));
  return v->options->wire ? trace_wire(v, direction) : trace(v, direction, at);
}

static void render_pixel(const view *v, size_t column, size_t row) {
  vec3 sum = {0, 0, 0};
  size_t pixel = (v->y + row) * v->image->width + v->x + column;
  scree_rng rng = {.seed = v->seed, .stream = pixel};
  double start[6];
  for (int i = 0; i < 6; i += 2) {
    uint64_t bits = scree_rng_next(&rng);
    start[i] = (double)(uint32_t)bits * 0x1p-32;
    start[i + 1] = (double)(bits >> 32) * 0x1p-32;
  }
  for (size_t i = 0; i < v->options->samples; i++) {
    const sample at = sample_at(start, i);
    sum = vec3_add(sum, trace_sample(v, column, row, &at));
  }
  sum = vec3_scale(sum, 1 / (double)v->options->samples);
  uint8_t *out = v->image->pixels + 3 * pixel;
  out[0] = scree_to_srgb(sum.x);
  out[1] = scree_to_srgb(sum.y);
  out[2] = scree_to_srgb(sum.z);
}

static void render_rows(void *context, scree_block block) {
  const view *v = context;
  for (size_t row = block.begin; row < block.end; row++)
    for (size_t column = 0; column < v->width; column++)
      render_pixel(v, column, v->first_row + row);
}

/* ---- the picture ---- */

/* The number of columns that makes the cells largest for objects about as wide as high. */
static size_t choose_columns(size_t cell_count, const scree_render_options *options) {
  size_t best = 1;
  double best_size = 0;
  for (size_t columns = 1; columns <= cell_count; columns++) {
    size_t rows = (cell_count + columns - 1) / columns;
    double width = (double)options->width / (double)columns;
    double height = (double)options->height / (double)rows - CAPTION_PX;
    double size = fmin(width, 1.25 * height);
    if (size > best_size) {
      best_size = size;
      best = columns;
    }
  }
  return best;
}

/* Renders in bands, so that progress can be told and a cancel be heard. */
static scree_status render_cell(view *v, scree_ticker *ticker, double done, double share,
                                scree_error *error) {
  frame_bodies(v);
  place_camera(v);
  scree_status status = build_scene(v, error);
  for (v->first_row = 0; status == SCREE_OK && v->first_row < v->height;
       v->first_row += BAND_ROWS) {
    size_t left = v->height - v->first_row;
    if (scree_tick(ticker, "rendering", done + share * (double)v->first_row / (double)v->height))
      scree_parallel_for(left < BAND_ROWS ? left : BAND_ROWS, ROWS_PER_BLOCK, render_rows, v);
    else
      status = scree_fail(error, SCREE_CANCELLED, "cancelled while rendering");
  }
  scree_ray_scene_free(v->scene);
  return status;
}

static scree_status check_options(const scree_render_options *o, size_t cell_count,
                                  scree_error *error) {
  if (o->width < 64 || o->height < 64 || o->width > 20000 || o->height > 20000)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "picture size %zu x %zu: each side must be 64 to 20000", o->width, o->height);
  if (!(o->focus_radius >= 0 && isfinite(o->focus_radius)) ||
      !isfinite(vec3_norm(vec3_load(o->focus))))
    return scree_fail(error, SCREE_BAD_ARGUMENT, "a focus of radius %g m: must not be below 0",
                      o->focus_radius);
  if (o->samples < 1 || o->samples > 65536)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu samples a pixel: must be 1 to 65536",
                      o->samples);
  if (cell_count < 1 || cell_count > most_cells || o->columns > most_cells)
    return scree_fail(error, SCREE_BAD_ARGUMENT, "%zu views in %zu columns: must be 1 to %zu",
                      cell_count, o->columns, most_cells);
  return SCREE_OK;
}

scree_status scree_render(const scree_render_cell *cells, size_t cell_count,
                          const scree_render_options *options, const scree_progress *progress,
                          scree_image *image, scree_error *error) {
  const scree_render_options defaults = scree_default_render_options();
  if (!options) options = &defaults;
  SCREE_TRY(check_options(options, cell_count, error));
  size_t bytes = 3 * options->width * options->height;
  SCREE_CLEANUP(scree_image_free) scree_image made = {options->width, options->height, NULL};
  SCREE_TRY_ALLOC(made.pixels, bytes, error);
  memset(made.pixels, 255, bytes);
  size_t columns = options->columns ? options->columns : choose_columns(cell_count, options);
  size_t rows = (cell_count + columns - 1) / columns;
  scree_ticker ticker = {.progress = progress};
  size_t pitch_x = options->width / columns, pitch_y = options->height / rows;
  for (size_t i = 0; i < cell_count; i++) {
    view v = {.cell = &cells[i], .options = options, .image = &made, .seed = 1};
    size_t below = cells[i].caption ? CAPTION_PX : 0;
    size_t gap = cell_count > 1 ? GAP_PX : 0;
    v.x = i % columns * pitch_x;
    v.y = i / columns * pitch_y;
    v.width = pitch_x - gap;
    v.height = pitch_y > below + gap + 8 ? pitch_y - below - gap : 8;
    SCREE_TRY(
        render_cell(&v, &ticker, (double)i / (double)cell_count, 1 / (double)cell_count, error));
    if (cells[i].caption)
      SCREE_TRY(
          scree_image_caption(&made, cells[i].caption, v.x, v.y + v.height, v.width, below, error));
  }
  if (options->value_label) SCREE_TRY(scree_image_scale_bar(&made, options, error));
  *image = made;
  made.pixels = NULL;
  return SCREE_OK;
}
