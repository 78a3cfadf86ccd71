/* What only some systems have, for those that lack it. */
#include "base/platform.h"

#ifndef __linux__
int scree_nameless_open(const char *folder) {
  (void)folder;
  return -1;
}
bool scree_nameless_link(int descriptor, const char *path) {
  (void)descriptor, (void)path;
  return false;
}
int scree_nameless_read(int descriptor) {
  (void)descriptor;
  return -1;
}
#endif

#if defined _WIN32 || defined __EMSCRIPTEN__
void scree_pages_large(void *block, size_t size) {
  (void)block, (void)size;
}
void scree_pages_touch(void *block, size_t size) {
  (void)block, (void)size;
}
void scree_pages_drop(void *block, size_t size) {
  (void)block, (void)size;
}
void scree_pages_give_back(void) {}

void scree_at_fork(void (*child)(void)) {
  (void)child;
}
#endif
