/* cgltf (MIT, its notice at the end of cgltf.h), as Debian's meshoptimizer 0.18+dfsg carries it;
 * but for two changes: instances need no buffer view, as their extension says, and memory that is
 * out in an attribute list leaves none to be freed. */
#include "base/number.h"

#include <stdlib.h>
#include <string.h>

/* Whatever the locale. */
static double number_of(const char *text) {
  double value = 0;
  (void)scree_number_parse(text, text + strlen(text), &value);
  return value;
}

#define CGLTF_MALLOC(size) NULL /* scree gives its own */
#define CGLTF_FREE(block)  (void)(block)
#define CGLTF_ATOI(text)   atoi(text)
#define CGLTF_ATOLL(text)  atoll(text)
#define CGLTF_ATOF(text)   number_of(text)
#define CGLTF_IMPLEMENTATION
#include "mesh/io/vendor/cgltf.h"
