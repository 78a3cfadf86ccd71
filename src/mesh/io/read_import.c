/* COLLADA, X3D, AMF, FBX and 3DS through assimp's C interface, in a child process under limits
 * (base/child.h): assimp reads forty formats, and hostile files break it. The child answers a
 * record and then the corners of all triangles; nothing it says is believed before it is checked.
 *
 * The import is raw: assimp only cuts polygons into triangles; node transforms are applied here in
 * double precision, mirrored nodes are turned outward again, an instance counts each time it is
 * placed, and welding is scree's. assimp holds coordinates in single precision.
 *
 * Units: X3D is in metres by its specification; assimp brings COLLADA to metres. AMF names one in
 * its root element (ISO/ASTM 52915), which assimp 5.2 does not pass on, so the child looks into the
 * file itself. FBX tells how many centimetres a unit has. 3DS has none. */
#include "mesh/io/read.h"

#ifdef SCREE_WITH_ASSIMP
#include "base/child.h"
#include "mesh/io/affine.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum {
  PEEK_BYTES = 1 << 16,
  CHUNK_TRIANGLES = 512,
  PROCESSOR_S = 120,
  WALL_S = 240,
};
static const size_t MOST_MEMORY = (size_t)4 << 30;

typedef struct import {
  const unsigned char *bytes;
  size_t byte_count;
  scree_import_format format;
} import;

/* ---- in the child: the unit of an AMF ---- */

/* Behind the next `mark`, or NULL. */
static const char *behind(const char *text, const char *mark) {
  const char *found = strstr(text, mark);
  return found ? found + strlen(mark) : NULL;
}

/* The attributes of the root element, behind its name, which ends in `name`. */
static const char *find_root_attributes(const char *text, const char *name) {
  while (text && (text = strchr(text, '<'))) {
    if (text[1] == '?')
      text = behind(text, "?>");
    else if (!strncmp(text, "<!--", 4))
      text = behind(text, "-->");
    else {
      size_t length = strcspn(text, " \t\r\n/>"), tail = strlen(name);
      return length > tail && !strncasecmp(text + length - tail, name, tail) ? text + length : NULL;
    }
  }
  return NULL;
}

/* The value of attribute `unit` goes to name, "millimeter" where there is none; false where the
 * element does not end. */
static bool read_unit_name(const char *p, char name[16]) {
  snprintf(name, 16, "millimeter");
  for (;;) {
    p += strspn(p, " \t\r\n");
    if (*p == '>' || *p == '/') return true;
    const char *word = p;
    size_t length = strcspn(p, "= \t\r\n>");
    p += length;
    p += strspn(p, " \t\r\n");
    if (length == 0 || *p++ != '=') return false;
    p += strspn(p, " \t\r\n");
    char quote[2] = {*p, 0};
    if (*quote != '"' && *quote != '\'') return false;
    size_t value_length = strcspn(++p, quote);
    if (p[value_length] != *quote) return false;
    if (length == 4 && !memcmp(word, "unit", 4))
      snprintf(name, 16, "%.*s", value_length < 16 ? (int)value_length : 15, p);
    p += value_length + 1;
  }
}

static void find_root_unit(const import *im, scree_import_answer *a) {
  static char text[PEEK_BYTES + 1];
  size_t count = im->byte_count < PEEK_BYTES ? im->byte_count : PEEK_BYTES;
  memcpy(text, im->bytes, count);
  text[count] = 0;
  const char *attributes = find_root_attributes(text, "amf");
  a->status = SCREE_BAD_FILE;
  if (!attributes || !read_unit_name(attributes, a->unit_name)) {
    snprintf(a->message, sizeof a->message,
             "as AMF: it does not begin with an XML element <amf ...>");
    return;
  }
  a->unit_m = scree_unit_of_root(a->unit_name);
  if (a->unit_m > 0)
    a->status = SCREE_OK;
  else
    snprintf(a->message, sizeof a->message,
             "as AMF: the unit is '%s'; it should be micron, millimeter, centimeter, inch, foot or "
             "meter",
             a->unit_name);
}

/* ---- in the child: the scene ---- */

static scree_affine place_in(const scree_affine *outer, const struct aiMatrix4x4 *t) {
  scree_affine inner = {
      {{t->a1, t->a2, t->a3, t->a4}, {t->b1, t->b2, t->b3, t->b4}, {t->c1, t->c2, t->c3, t->c4}}};
  return scree_affine_in(outer, &inner);
}

/* The walk over all placed meshes: once to count, once to write. */
typedef struct walk {
  const struct aiScene *scene;
  int output; /* negative: only count */
  bool is_valid, is_written;
  uint64_t triangle_count;
  size_t chunk_count;
  double chunk[CHUNK_TRIANGLES][3][3];
} walk;

static void flush_chunk(walk *w) {
  size_t byte_count = w->chunk_count * sizeof *w->chunk;
  w->is_written = w->is_written && scree_child_write(w->output, w->chunk, byte_count);
  w->chunk_count = 0;
}

static void walk_face(walk *w, const struct aiMesh *mesh, const struct aiFace *face,
                      const scree_affine *p, bool mirrored) {
  if (w->output >= 0 && w->chunk_count == CHUNK_TRIANGLES) flush_chunk(w);
  for (int c = 0; c < 3; c++) {
    unsigned index = face->mIndices[mirrored ? 2 - c : c];
    if (index >= mesh->mNumVertices) {
      w->is_valid = false;
      return;
    }
    const struct aiVector3D *v = &mesh->mVertices[index];
    if (w->output >= 0)
      scree_affine_apply(p, (double[3]){v->x, v->y, v->z}, w->chunk[w->chunk_count][c]);
  }
  w->chunk_count++;
  w->triangle_count++;
}

static void walk_node(walk *w, const struct aiNode *node, const scree_affine *outer) {
  scree_affine p = place_in(outer, &node->mTransformation);
  bool mirrored = scree_affine_mirrors(&p);
  for (unsigned i = 0; i < node->mNumMeshes && w->is_valid; i++) {
    if (node->mMeshes[i] >= w->scene->mNumMeshes) w->is_valid = false;
    if (!w->is_valid || w->triangle_count > SCREE_IMPORT_MOST) return;
    const struct aiMesh *mesh = w->scene->mMeshes[node->mMeshes[i]];
    for (unsigned f = 0; f < mesh->mNumFaces && w->is_valid; f++)
      if (mesh->mFaces[f].mNumIndices == 3) /* points and lines have no surface */
        walk_face(w, mesh, &mesh->mFaces[f], &p, mirrored);
  }
  for (unsigned i = 0; i < node->mNumChildren && w->is_valid; i++)
    walk_node(w, node->mChildren[i], &p);
}

static void walk_scene(walk *w, const struct aiScene *scene, int output) {
  w->scene = scene;
  w->output = output;
  w->is_valid = w->is_written = true;
  w->triangle_count = w->chunk_count = 0;
  if (scene->mRootNode) walk_node(w, scene->mRootNode, &scree_affine_none);
}

/* An FBX's centimetres per unit; 1 where it does not say. */
static void find_scene_unit(const struct aiScene *scene, scree_import_answer *a) {
  const struct aiMetadata *data = scene->mMetaData;
  double factor = 1;
  for (unsigned i = 0; data && i < data->mNumProperties; i++) {
    const struct aiMetadataEntry *value = &data->mValues[i];
    if (strcmp(data->mKeys[i].data, "UnitScaleFactor") != 0) continue;
    if (value->mType == AI_DOUBLE) factor = *(const double *)value->mData;
    if (value->mType == AI_FLOAT) factor = (double)*(const float *)value->mData;
  }
  a->unit_m = 0.01 * factor;
  snprintf(a->unit_name, sizeof a->unit_name, "%.6g m", a->unit_m);
}

static void explain_refusal(const import *im, scree_import_answer *a) {
  const char *reason = aiGetErrorString();
  bool is_memory = strstr(reason, "bad_alloc") != NULL;
  a->status = is_memory ? SCREE_LIMIT : SCREE_BAD_FILE;
  snprintf(a->message, sizeof a->message,
           is_memory ? "as %s: reading it takes more memory than it is given"
                     : "as %s: assimp refuses it: %.180s",
           scree_import_kinds[im->format].name, *reason ? reason : "no reason given");
}

/* What assimp makes of the file; NULL with the reason in the answer. */
static const struct aiScene *import_scene(const import *im, scree_import_answer *a) {
  const struct aiScene *scene =
      aiImportFileFromMemory((const char *)im->bytes, (unsigned)im->byte_count,
                             aiProcess_Triangulate, scree_import_kinds[im->format].hint);
  if (!scene) explain_refusal(im, a);
  return scene;
}

/* A child's work. */
static bool import_in_child(void *context, int output) {
  static walk w;
  const import *im = context;
  scree_import_answer a = {.unit_m = 1, .unit_name = "meter"};
  const struct aiScene *scene = NULL;
  if (scree_import_kinds[im->format].unit == SCREE_UNIT_IN_ROOT) find_root_unit(im, &a);
  if (a.status == SCREE_OK) scene = import_scene(im, &a);
  if (scene) {
    if (scree_import_kinds[im->format].unit == SCREE_UNIT_IN_SCENE) find_scene_unit(scene, &a);
    walk_scene(&w, scene, -1);
    a.triangle_count = w.triangle_count;
    if (!w.is_valid || w.triangle_count > SCREE_IMPORT_MOST) {
      a.status = w.is_valid ? SCREE_LIMIT : SCREE_BAD_FILE;
      snprintf(a.message, sizeof a.message,
               w.is_valid ? "as %s: more than %d triangles with all instances"
                          : "as %s: a face names a vertex that is not there",
               scree_import_kinds[im->format].name, SCREE_IMPORT_MOST);
    }
  }
  if (!scree_child_write(output, &a, sizeof a)) return false;
  if (!scene || a.status != SCREE_OK) return true;
  walk_scene(&w, scene, output);
  flush_chunk(&w);
  return w.is_written;
}

/* ---- in the parent ---- */

scree_status scree_read_import(scree_reading *r, scree_import_format format) {
  if (r->byte_count > UINT_MAX)
    return scree_reading_fail(r, SCREE_LIMIT, "%zu bytes; %s is read up to %u", r->byte_count,
                              scree_import_kinds[format].name, UINT_MAX);
  size_t memory = scree_memory_limit();
  scree_child_limits limits = {
      .memory_bytes = memory && memory < MOST_MEMORY ? memory : MOST_MEMORY,
      .processor_s = PROCESSOR_S,
      .wall_s = WALL_S,
      .output_bytes = sizeof(scree_import_answer) + (size_t)SCREE_IMPORT_MOST * 9 * sizeof(double),
  };
import im = {r->bytes, r->byte_count, format };
  char what[512];
  snprintf(what, sizeof what, "%.400s: reading it as %s", r->name, scree_import_kinds[format].name);
  scree_child_answer raw = {0};
  scree_status status = scree_child_run(import_in_child, &im, &limits, what, &raw, r->error);
  if (status == SCREE_OK) status = scree_import_take(r, format, raw.items, raw.count);
  scree_free(raw.items);
  return status;
}

#else
scree_status scree_read_import(scree_reading *r, scree_import_format format) {
  static const char *const sentences[] = {
      [SCREE_IMPORT_COLLADA] = "is a COLLADA model", [SCREE_IMPORT_X3D] = "is an X3D model",
      [SCREE_IMPORT_AMF] = "is an AMF model",        [SCREE_IMPORT_FBX] = "is an FBX model",
      [SCREE_IMPORT_3DS] = "is a 3DS model",
  };
  return scree_reading_fail(r, SCREE_UNSUPPORTED,
                            "%s; this build of scree reads STL, PLY, OBJ, OFF, 3MF and glTF, and "
                            "other formats only with assimp",
                            sentences[format]);
}
#endif
