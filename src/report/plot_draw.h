/* Between the plot's drawing and its files. */
#pragma once

#include "report/plot.h"

typedef enum scree_paint { SCREE_PAINT_PNG, SCREE_PAINT_SVG, SCREE_PAINT_PDF } scree_paint;
/* The figure as a picture; path is for messages. SCREE_UNSUPPORTED in a build without pictures. */
scree_status scree_figure_paint(const scree_figure *figure, scree_paint paint, FILE *stream,
                                const char *path, scree_error *error);
