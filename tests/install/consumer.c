#include <scree.h>

#include <stdio.h>

int main(void) {
  return scree_threads() < 1 || puts(scree_version()) < 0;
}
