/* The templates that are built into the library (cmake/templates.cmake). */
#pragma once

typedef struct scree_template {
  const char *name, *text;
} scree_template;

/* The last has no name. */
extern const scree_template scree_templates[];
