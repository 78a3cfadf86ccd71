/* Filling a scree_error, and the assertion for callers' bugs (never for user data). */
#pragma once

#include "base/platform.h"
#include "scree.h"

/* Fills *error (may be NULL) with status and a printf-formatted sentence; returns status, so that
 * `return scree_fail(error, SCREE_BAD_FILE, "...", ...)` is the whole handling. A macro, so that
 * the status is in sight of the compiler and of static analysis. */
#define scree_fail(error, status, ...)                                                             \
  scree_status_after(scree_fail_text((error), (status), __VA_ARGS__), (status))

scree_status scree_fail_text(scree_error *error, scree_status status, const char *format, ...)
    SCREE_PRINTF(3, 4);
static inline scree_status scree_status_after(scree_status told, scree_status status) {
  (void)told;
  return status;
}

/* Adds a printf-formatted text to what stands in a buffer of `size` bytes, as far as there is room.
 */
void scree_add_text(char *text, size_t size, const char *format, ...) SCREE_PRINTF(3, 4);
#define SCREE_ADD_TEXT(buffer, ...) scree_add_text((buffer), sizeof(buffer), __VA_ARGS__)

/* A call that fails ends the function with its status. For functions that hold nothing by then. */
#define SCREE_TRY(call)                                                                            \
  do {                                                                                             \
    scree_status tried_ = (call);                                                                  \
    if (tried_ != SCREE_OK) return tried_;                                                         \
  } while (0)

/* The one sentence for a failed allocation of byte_count bytes (0: not said) needed for `what`, or
 * for the C expression that they were for; at the limit of memory it names that. */
void scree_tell_memory(scree_error *error, size_t byte_count, const char *what,
                       const char *expression);
static inline scree_status scree_fail_memory(scree_error *error, size_t byte_count,
                                             const char *what) {
  scree_tell_memory(error, byte_count, what, NULL);
  return SCREE_OUT_OF_MEMORY;
}

/* Replaces what a terminal obeys, the control characters of UTF-8 text: each of its bytes becomes
 * `instead`. All errors' messages are so. */
void scree_make_printable(char *text, char instead);

#ifdef SCREE_ASSERTIONS
void scree_assert_failed(const char *condition, const char *file, int line);
#define SCREE_ASSERT(condition)                                                                    \
  ((condition) ? (void)0 : scree_assert_failed(#condition, __FILE__, __LINE__))
#else
#define SCREE_ASSERT(condition) ((void)sizeof(condition))
#endif

/* The status in words, for example "bad file". */
const char *scree_status_text(scree_status status);
