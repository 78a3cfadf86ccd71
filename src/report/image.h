/* Where ray-traced pictures are seen from, and what is drawn onto them: captions, the scale bar of
 * the colour map, the map itself. */
#pragma once

#include "base/error.h"
#include "base/vec.h"

/* Unit, towards a camera at these angles about z and above the horizontal (render.c). */
vec3 scree_to_camera(double azimuth_deg, double elevation_deg);

/* Linear RGB of the colour map at t in [0, 1]. */
vec3 scree_viridis(double t);
uint8_t scree_to_srgb(double linear);

/* Text centred in the box, made smaller until it fits its width. */
scree_status scree_image_caption(scree_image *image, const char *text, size_t x, size_t y,
                                 size_t width, size_t height, scree_error *error);
/* The colour map with its ends, middle and label along the right edge. */
scree_status scree_image_scale_bar(scree_image *image, const scree_render_options *options,
                                   scree_error *error);
