/* Between the plot's drawing and its files. */
#ifndef SCREE_REPORT_PLOT_DRAW_H
#define SCREE_REPORT_PLOT_DRAW_H

#include "report/plot.h"

struct _cairo; /* cairo_t */

/* Size of the whole figure in points. */
void scree_figure_extent(const scree_figure *figure, double *width, double *height);
/* Draws in points from the origin, background included. */
void scree_figure_draw(const scree_figure *figure, struct _cairo *cr);

#endif
