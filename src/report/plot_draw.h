/* Between the plot's drawing and its files. */
#pragma once

#include "report/plot.h"

struct _cairo; /* cairo_t */

typedef enum scree_paint { SCREE_PAINT_PNG, SCREE_PAINT_SVG, SCREE_PAINT_PDF } scree_paint;
/* The figure as a picture; path is for messages. SCREE_UNSUPPORTED in a build without pictures. */
scree_status scree_figure_paint(const scree_figure *figure, scree_paint paint, FILE *stream,
                                const char *path, scree_error *error);

/* Size of the whole figure in points. */
void scree_figure_extent(const scree_figure *figure, double *width, double *height);
/* Draws in points from the origin, background included. */
void scree_figure_draw(const scree_figure *figure, struct _cairo *cr);
