/* The templates that are built into the library (cmake/templates.cmake). */
#ifndef SCREE_SCENE_TEMPLATES_H
#define SCREE_SCENE_TEMPLATES_H

typedef struct scree_template {
  const char *name, *text;
} scree_template;

/* The last has no name. */
extern const scree_template scree_templates[];

#endif
