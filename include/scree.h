/* scree: triangle counts for DEM particles from 3D scans, chosen by a criterion, tested by
 * simulation.
 *
 * This is the whole public interface. What holds everywhere:
 *
 *   Units       SI inside: metres, kilograms, seconds, radians. A value in another unit says so in
 * its name (angle_deg). Errors      A fallible call returns a scree_status. Its last parameter is a
 * scree_error, which may be NULL, filled with one sentence on failure. Outputs are untouched on
 * failure. Ownership   Inputs are borrowed. Whoever gets a `T **` or a filled struct frees it with
 * T_free; freeing NULL or a zeroed struct is legal. Threads     No global state but the allocator,
 * the memory limit and the number of threads. Results are the same bits for every number of
 * threads. Output      The library never prints, exits, aborts or longjmps. */
#ifndef SCREE_H
#define SCREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SCREE_API __attribute__((visibility("default")))

/* ==== 1. Version, errors, memory, threads, progress ============================================
 */

/* The version as text, for example "0.1.0". */
SCREE_API const char *scree_version(void);

#define SCREE_STATUS_LIST(X)                                                                       \
  X(OK, "ok")                                                                                      \
  X(BAD_ARGUMENT, "bad argument")   /* the caller passed a value outside its range */              \
  X(BAD_FILE, "bad file")           /* a file's content is not what it claims to be */             \
  X(BAD_MESH, "bad mesh")           /* a surface that cannot serve the purpose */                  \
  X(IO, "input/output error")       /* the system refused to open, read or write */                \
  X(OUT_OF_MEMORY, "out of memory") /* or above the memory limit */                                \
  X(LIMIT, "limit exceeded")        /* a stated limit of scree, not of memory */                   \
  X(CANCELLED, "cancelled")         /* a progress callback answered false */                       \
  X(EXISTS, "file exists")          /* nothing is overwritten unless asked */                      \
  X(UNSUPPORTED, "unsupported")     /* known, but not in this build or not yet */                  \
  X(NO_BACKEND, "no such backend")  /* the compute backend is not in this build */                 \
  X(DIVERGED, "diverged")           /* a simulation left the range of its model */

typedef enum scree_status {
#define SCREE_STATUS_ENUM(name, text) SCREE_##name,
  SCREE_STATUS_LIST(SCREE_STATUS_ENUM)
#undef SCREE_STATUS_ENUM
      SCREE_STATUS_COUNT
} scree_status;

/* The status in words, for example "bad file". */
SCREE_API const char *scree_status_text(scree_status status);

/* What went wrong, in one sentence: file, position, value, limit as far as they apply. */
typedef struct scree_error {
  scree_status status;
  char message[1024];
} scree_error;

/* All memory comes from one function: block NULL allocates, size 0 frees, else resizes; NULL means
 * it failed. It must be thread-safe. NULL restores realloc and free. Set it before any other call.
 */
typedef void *scree_reallocate(void *context, void *block, size_t size);
SCREE_API void scree_set_allocator(scree_reallocate *reallocate, void *context);

/* The most bytes the library may hold at once; further allocations fail with SCREE_OUT_OF_MEMORY.
 * 0 (the default) means no limit. */
SCREE_API void scree_set_memory_limit(size_t byte_count);
/* Bytes held now, and the most held since the start or the last reset of the peak. */
SCREE_API size_t scree_memory_used(void);
SCREE_API size_t scree_memory_peak(void);
SCREE_API void scree_reset_memory_peak(void);

/* How many threads parallel work uses; 0 (the default) means one per processor. The result of no
 * function depends on it. */
SCREE_API void scree_set_threads(int thread_count);
SCREE_API int scree_threads(void);

/* Progress of long work. report is called a few times a second at most, from the calling thread,
 * with the phase in a few words and the fraction done in [0, 1]; answering false cancels the work,
 * which then returns SCREE_CANCELLED. */
typedef struct scree_progress {
  bool (*report)(void *context, const char *phase, double fraction);
  void *context;
} scree_progress;

/* 128 bits that name a file's content: XXH3-128, as `xxhsum -H2` prints it. */
typedef struct scree_checksum {
  uint64_t high, low;
} scree_checksum;

/* ==== 2. Meshes and scans ======================================================================
 */

/* An indexed triangle mesh. Triangle t has corners triangles[3t..3t+2]; vertex v lies at
 * positions[3v..3v+2], in metres. Counter-clockwise from outside. */
typedef struct scree_mesh {
  double *positions;   /* 3 * vertex_count */
  uint32_t *triangles; /* 3 * triangle_count */
  size_t vertex_count;
  size_t triangle_count;
} scree_mesh;

SCREE_API void scree_mesh_free(scree_mesh *mesh);
SCREE_API scree_status scree_mesh_copy(const scree_mesh *mesh, scree_mesh *copy,
                                       scree_error *error);

/* ---- 2.1 Reading and writing ---- */

/* ---- 2.2 Measures ---- */

/* ---- 2.3 Distance between surfaces ---- */

/* ---- 2.4 Check and repair ---- */

/* ==== 3. Decimation: the curve =================================================================
 */

typedef enum scree_method {
  SCREE_METHOD_VOLUME, /* "volume", the default: keeps the volume at every level */
  SCREE_METHOD_QECD,   /* "qecd": quadric edge collapse decimation as MeshLab's, the paper's */
} scree_method;

/* ==== 4. The choice ============================================================================
 */

/* ==== 5. Built-in samples ======================================================================
 */

/* ==== 6. Particles =============================================================================
 */

/* ==== 7. World: bodies, walls, contacts, time ==================================================
 */

/* ==== 8. Pile: filling, lifting, angle of repose, studies ======================================
 */

/* ==== 9. Reports: figures, pictures, files for other programs ==================================
 */

#ifdef __cplusplus
}
#endif
#endif
