/* Where no process can be forked: what is not to be trusted is not done. */
#include "base/child.h"

bool scree_child_write(int output, const void *bytes, size_t byte_count) {
  (void)output, (void)bytes, (void)byte_count;
  return false;
}

scree_status scree_child_run(scree_child_work *work, void *context,
                             const scree_child_limits *limits, const char *what,
                             scree_child_answer *answer, scree_error *error) {
  (void)work, (void)context, (void)limits, (void)answer;
  return scree_fail(error, SCREE_UNSUPPORTED,
                    "%s: wants a child process, which this system does not have", what);
}
