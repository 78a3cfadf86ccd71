/* Work that is not to be trusted, done in a child process under limits: code of others that reads
 * hostile files may crash, spin or swell there, and costs one error sentence here. */
#pragma once

#include "base/alloc.h"

typedef struct scree_child_limits {
  size_t memory_bytes; /* address space beyond what the process has at the fork */
  int processor_s, wall_s;
  size_t output_bytes; /* the most the child may answer */
} scree_child_limits;

/* The work: runs in the child, answers through scree_child_write, true when done. It must not use
 * scree_alloc (another thread may hold the allocator's lock for ever) or scree_parallel_for, and
 * cannot open files. */
typedef bool scree_child_work(void *context, int output);

bool scree_child_write(int output, const void *bytes, size_t byte_count);

/* What the child answered; free items with scree_free. */
typedef struct scree_child_answer {
  char *items;
  size_t count, capacity;
} scree_child_answer;

/* Forks, does the work in the child, collects its answer. `what` begins the error sentences, for
 * example "scan.3mf: reading it as 3MF". Errors: SCREE_BAD_FILE where the child crashes or gives
 * up; SCREE_LIMIT for time and for the answer's size; SCREE_IO where no child can be made;
 * SCREE_OUT_OF_MEMORY. */
scree_status scree_child_run(scree_child_work *work, void *context,
                             const scree_child_limits *limits, const char *what,
                             scree_child_answer *answer, scree_error *error);
