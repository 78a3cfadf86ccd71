#include "scree.h"

int main(void) {
  return puts(scree_version()) < 0;
}
