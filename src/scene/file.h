/* Scenes' files, before there is a scene. */
#pragma once

#include "base/owned.h"
#include "scene/plan.h"
#include "scree.h"

struct scree_scene_file {
  scree_yaml root;
  char *name;   /* for messages */
  char *folder; /* where the files that it names lie, with a slash at its end, or "" */
};

/* plan.c of a file: into the arena of whoever asks. */
scree_status scree_scene_file_plan(const scree_scene_file *file, scree_arena *arena,
                                   scree_plan *plan, scree_error *error);
/* scree_scene_file_input, but that it fails where the file or memory does; "": no more. */
scree_status scree_scene_file_find_input(const scree_scene_file *file, size_t index, char *path,
                                         size_t size, scree_error *error);
/* A file of a tree, which it takes, of that name. */
scree_status scree_scene_file_keep(scree_yaml *root, const char *name, scree_scene_file **file,
                                   scree_error *error);
/* How large shapes are, in m: the diameter that the largest needs, and the mean of the spheres of
 * equal volume. */
typedef struct scree_scene_extent {
  double largest, mean;
} scree_scene_extent;
/* Whether it has parameters whose fields follow the size of the shapes; a copy in which they have,
 * to be freed. */
bool scree_scene_file_scales(const scree_scene_file *file);
scree_status scree_scene_file_scale(const scree_scene_file *file, const scree_scene_extent *extent,
                                    scree_scene_file **scaled, scree_error *error);
/* The extent of a file's shapes, which are made for it. */
scree_status scree_scene_file_extent(const scree_scene_file *file, scree_shape_store *store,
                                     const scree_progress *progress, scree_scene_extent *extent,
                                     scree_error *error);
/* The file as printed, to be freed. */
scree_status scree_scene_file_text(const scree_scene_file *file, char **text, scree_error *error);

/* particles.c: what a shape is made from, whose file lies at path. */
scree_shape_spec scree_scene_shape_spec(const scree_plan_shape *shape, const char *path);
/* Where a file named in a scene lies; NULL when memory is out. */
char *scree_scene_path(const char *folder, const char *name);

/* The templates that are built into the library (cmake/templates.cmake). */
typedef struct scree_template {
  const char *name, *text;
} scree_template;

/* The last has no name. */
extern const scree_template scree_templates[];
