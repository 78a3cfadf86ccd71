/* Version, errors, memory, threads, progress. */
#ifndef SCREE_BASE_H
#define SCREE_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SCREE_API __attribute__((visibility("default")))

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
  X(NO_BACKEND, "no such backend")  /* the compute backend is not there, or was lost */            \
  X(DIVERGED, "diverged")           /* a simulation left the range of its model */

typedef enum scree_status {
#define SCREE_STATUS_ENUM(name, text) SCREE_##name,
  SCREE_STATUS_LIST(SCREE_STATUS_ENUM)
#undef SCREE_STATUS_ENUM
      SCREE_STATUS_COUNT
} scree_status;

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

/* Bytes held now, and the most held since the start or the last reset of the peak. */
SCREE_API size_t scree_memory_used(void);
SCREE_API size_t scree_memory_peak(void);
SCREE_API void scree_reset_memory_peak(void);

/* How many threads parallel work uses; 0 (the default) means one per processor. The result of no
 * function depends on it. */
SCREE_API void scree_set_threads(int thread_count);
SCREE_API int scree_threads(void);

/* Where worlds that were not told otherwise (scree_world_set_backend) are stepped from now on:
 * "cpu" (the default), "cuda", or "cuda:N" for the NVIDIA device of that number. The results are
 * the same bits. SCREE_BAD_ARGUMENT for another name; SCREE_NO_BACKEND, with what is missing, where
 * it is not there: the choice stays then. */
SCREE_API scree_status scree_set_backend(const char *name, scree_error *error);
/* The same without choosing it; description: what is there, in a few words. */
SCREE_API scree_status scree_check_backend(const char *name, char description[256],
                                           scree_error *error);

/* Progress of long work. report is called from the calling thread, with the phase in a few words
 * and the fraction done in [0, 1]; answering false cancels the work, which then returns
 * SCREE_CANCELLED. interval is the least time between two reports, in seconds; the first and the
 * last come always, and with 0 each one does. */
typedef struct scree_progress {
  bool (*report)(void *context, const char *phase, double fraction);
  void *context;
  double interval;
} scree_progress;

/* 128 bits that name a file's content: XXH3-128, as `xxhsum -H2` prints it. */
typedef struct scree_checksum {
  uint64_t high, low;
} scree_checksum;

enum { SCREE_CHECKSUM_TEXT = 33 }; /* characters with the final zero */

/* Puts the 32 hexadecimal digits into text. Returns text; NULL for a checksum of zero, which stands
 * for none (a sample has no bytes). */
SCREE_API const char *scree_checksum_text(scree_checksum checksum, char text[SCREE_CHECKSUM_TEXT]);

/* What a build may lack. */
typedef enum scree_build_part {
  SCREE_BUILD_PICTURES, /* figures as PNG, SVG and PDF (cairo) */
  SCREE_BUILD_RAYS,     /* rendered pictures (Embree) */
  SCREE_BUILD_STUDY,    /* scree_study_... (SQLite) */
  SCREE_BUILD_COUNT
} scree_build_part;
SCREE_API bool scree_build_has(scree_build_part part);

#ifdef __cplusplus
}
#endif
#endif
