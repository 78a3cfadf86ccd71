/* Which backend worlds step on. */
#include "world/device/backend.h"
#include "world/device/cuda_driver.h"

#include "base/error.h"

#include <stdlib.h>
#include <string.h>

static const scree_backend *chosen = &scree_backend_cpu;
static int chosen_device = 0;

const scree_backend *scree_backend_of(const scree_world *world) {
  return world->residence.backend ? world->residence.backend : chosen;
}
int scree_backend_device_of(const scree_world *world) {
  return world->residence.backend ? world->residence.device : chosen_device;
}

/* "cpu", "cuda" or "cuda:N". */
static const scree_backend *find(const char *name, int *device) {
  *device = 0;
  if (strcmp(name, "cpu") == 0) return &scree_backend_cpu;
  if (strncmp(name, "cuda", 4) != 0) return NULL;
  if (name[4] == 0) return &scree_backend_cuda;
  char *end;
  long number = strtol(name + 5, &end, 10);
  if (name[4] != ':' || name[5] < '0' || name[5] > '9' || *end || number > 999) return NULL;
  *device = (int)number;
  return &scree_backend_cuda;
}

scree_status scree_check_backend(const char *name, char description[256], scree_error *error) {
  int device;
  const scree_backend *backend = find(name, &device);
  if (!backend)
    return scree_fail(error, SCREE_BAD_ARGUMENT,
                      "backend '%s': cpu, cuda or cuda:N (the device's number) are known", name);
  if (backend == &scree_backend_cuda) return scree_cuda_open(device, description, error);
  snprintf(description, 256, "the processor's threads");
  return SCREE_OK;
}

scree_status scree_set_backend(const char *name, scree_error *error) {
  char description[256];
  scree_status status = scree_check_backend(name, description, error);
  if (status == SCREE_OK) chosen = find(name, &chosen_device);
  return status;
}

scree_status scree_world_set_backend(scree_world *world, const char *name, scree_error *error) {
  char description[256];
  int device;
  SCREE_TRY(scree_check_backend(name, description, error));
  const scree_backend *backend = find(name, &device);
  int there = scree_cuda_device_of(world);
  if (backend == &scree_backend_cuda && there >= 0 && there != device)
    return scree_fail(
        error, SCREE_BAD_ARGUMENT,
        "backend '%s': the world is on cuda:%d already; it stays there, or goes on on "
        "the processor",
        name, there);
  world->residence.backend = backend;
  world->residence.device = device;
  return SCREE_OK;
}
