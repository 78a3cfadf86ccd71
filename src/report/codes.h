/* The codes that `scree export --to` writes for: cmake/templates.cmake makes the table of the files
 * codes/NAME-clump.txt and codes/NAME-mesh.txt (NULL: the code takes none of these). */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct scree_code_template {
  const char *name;
  bool meshes_first; /* what a surface becomes where nothing else is asked */
  const char *clump, *mesh;
} scree_code_template;

extern const scree_code_template scree_code_templates[];
extern const size_t scree_code_template_count;
