#include <scree.h>

int main(void) {
  return scree_threads() < 1 || puts(scree_version()) < 0;
}
