/* Surfaces that clumps are fitted to. */
#pragma once

#include "cli/input.h"

typedef struct cli_clump_surface {
  size_t triangles; /* at most so many */
  bool no_repair;   /* refuse instead */
  /* What cli_load_for_clump fills. */
  scree_mesh mesh; /* m; free with scree_mesh_free */
  char note[1024]; /* what was repaired; "" */
  char format[sizeof((scree_scan *)0)->format];
  double unit_m;
  scree_checksum checksum;
  size_t scan_triangle_count;
} cli_clump_surface;

static inline void cli_clump_surface_free(cli_clump_surface *surface) {
  scree_mesh_free(&surface->mesh);
}

/* Loads, checks, repairs and decimates. Errors name the word. */
scree_status cli_load_for_clump(const char *word, const cli_input_options *input,
                                const scree_progress *progress, cli_clump_surface *surface,
                                scree_error *error);
