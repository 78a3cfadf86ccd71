#include "world/device/cuda_driver.h"

#include "base/error.h"
#include "base/parallel.h"

#ifdef SCREE_WITH_CUDA
#include <dlfcn.h>
#include <string.h>

extern const char scree_ptx[]; /* made by cmake/ptx.sh */

enum { THREADS = 64, MOST_BLOCKS = 2048, LEAST_BLOCKS = 64, STACK_BYTES = 24576 };
/* The driver's own numbers. */
enum {
  LIMIT_STACK = 0,
  JIT_ERROR_LOG = 5,
  JIT_ERROR_LOG_SIZE = 6,
  OUT_OF_MEMORY = 2,
  NON_BLOCKING = 1
};

typedef void *handle;
static struct {
  int (*init)(unsigned);
  int (*device_count)(int *);
  int (*device_get)(int *, int);
  int (*device_name)(char *, int, int);
  int (*device_memory)(size_t *, int);
  int (*retain)(handle *, int);
  int (*set_current)(handle);
  int (*set_limit)(int, size_t);
  int (*load)(handle *, const void *, unsigned, int *, void **);
  int (*get_function)(handle *, handle, const char *);
  int (*allocate)(scree_device_address *, size_t);
  int (*release)(scree_device_address);
  int (*open_queue)(handle *, unsigned);
  int (*close_queue)(handle);
  int (*wait)(handle);
  int (*write)(scree_device_address, const void *, size_t, handle);
  int (*read)(void *, scree_device_address, size_t, handle);
  int (*clear)(scree_device_address, unsigned char, size_t, handle);
  int (*launch)(handle, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned,
                handle, void **, void **);
  int (*error_text)(int, const char **);
} cu;

static const struct {
  void **function;
  const char *name;
} names[] = {{(void **)&cu.init, "cuInit"},
             {(void **)&cu.device_count, "cuDeviceGetCount"},
             {(void **)&cu.device_get, "cuDeviceGet"},
             {(void **)&cu.device_name, "cuDeviceGetName"},
             {(void **)&cu.device_memory, "cuDeviceTotalMem_v2"},
             {(void **)&cu.retain, "cuDevicePrimaryCtxRetain"},
             {(void **)&cu.set_current, "cuCtxSetCurrent"},
             {(void **)&cu.set_limit, "cuCtxSetLimit"},
             {(void **)&cu.load, "cuModuleLoadDataEx"},
             {(void **)&cu.get_function, "cuModuleGetFunction"},
             {(void **)&cu.allocate, "cuMemAlloc_v2"},
             {(void **)&cu.release, "cuMemFree_v2"},
             {(void **)&cu.open_queue, "cuStreamCreate"},
             {(void **)&cu.close_queue, "cuStreamDestroy_v2"},
             {(void **)&cu.wait, "cuStreamSynchronize"},
             {(void **)&cu.write, "cuMemcpyHtoDAsync_v2"},
             {(void **)&cu.read, "cuMemcpyDtoHAsync_v2"},
             {(void **)&cu.clear, "cuMemsetD8Async"},
             {(void **)&cu.launch, "cuLaunchKernel"},
             {(void **)&cu.error_text, "cuGetErrorString"}};

static struct opened {
  handle context, functions[SCREE_KERNEL_COUNT];
  char description[256];
} devices[SCREE_MOST_DEVICES];

static scree_status check(int result, const char *what, scree_error *error) {
  const char *text = NULL;
  if (result == 0) return SCREE_OK;
  cu.error_text(result, &text);
  return scree_fail(error, result == OUT_OF_MEMORY ? SCREE_OUT_OF_MEMORY : SCREE_NO_BACKEND,
                    "cuda: %s: %s (error %d)", what, text ? text : "no text", result);
}

static scree_status load_driver(scree_error *error) {
  static bool loaded = false;
  if (loaded) return SCREE_OK;
  void *library = dlopen("libcuda.so.1", RTLD_NOW);
  if (!library)
    return scree_fail(error, SCREE_NO_BACKEND,
                      "cuda: no NVIDIA driver (libcuda.so.1) is installed");
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!(*names[i].function = dlsym(library, names[i].name)))
      return scree_fail(error, SCREE_NO_BACKEND, "cuda: the driver has no %s: too old",
                        names[i].name);
  SCREE_TRY(check(cu.init(0), "the driver does not start", error));
  loaded = true;
  return SCREE_OK;
}

static scree_status load_kernels(struct opened *device, scree_error *error) {
#define SCREE_NAME(name) "scree_kernel_" #name,
  static const char *const kernels[] = {SCREE_KERNELS(SCREE_NAME) SCREE_BROAD_KERNELS(SCREE_NAME)
                                            SCREE_OBSERVE_KERNELS(SCREE_NAME)};
#undef SCREE_NAME
  char log[512] = "";
  int options[] = {JIT_ERROR_LOG, JIT_ERROR_LOG_SIZE};
  void *values[] = {log, (void *)sizeof log};
  handle module;
  int result = cu.load(&module, scree_ptx, 2, options, values);
  if (result)
    return scree_fail(error, SCREE_NO_BACKEND,
                      "cuda: the driver refuses the kernels: error %d %.300s", result, log);
  for (int k = 0; k < SCREE_KERNEL_COUNT; k++)
    SCREE_TRY(check(cu.get_function(&device->functions[k], module, kernels[k]), kernels[k], error));
  return SCREE_OK;
}

static scree_status open_device(int number, scree_error *error) {
  SCREE_TRY(load_driver(error));
  int count = 0, id;
  SCREE_TRY(check(cu.device_count(&count), "devices", error));
  if (number >= count || number >= SCREE_MOST_DEVICES)
    return scree_fail(error, SCREE_NO_BACKEND,
                      "cuda: there is no device %d; there are %d, numbered from 0", number, count);
  struct opened *device = &devices[number];
  if (device->context) return SCREE_OK;
  char name[128];
  size_t memory = 0;
  handle context;
  SCREE_TRY(check(cu.device_get(&id, number), "device", error));
  SCREE_TRY(check(cu.device_name(name, sizeof name, id), "device", error));
  SCREE_TRY(check(cu.device_memory(&memory, id), "device", error));
  SCREE_TRY(check(cu.retain(&context, id), "context", error));
  SCREE_TRY(check(cu.set_current(context), "context", error));
  SCREE_TRY(check(cu.set_limit(LIMIT_STACK, STACK_BYTES), "stack", error));
  SCREE_TRY(load_kernels(device, error));
  snprintf(device->description, sizeof device->description, "%s, %.1f GB", name,
           (double)memory * 1e-9);
  device->context = context;
  return SCREE_OK;
}

scree_status scree_cuda_open(int device, char description[256], scree_error *error) {
  scree_enter_alone();
  scree_status status = open_device(device, error);
  scree_leave_alone();
  if (!status) snprintf(description, 256, "%s", devices[device].description);
  return status;
}

scree_status scree_cuda_use(int device, scree_error *error) {
  return check(cu.set_current(devices[device].context), "context", error);
}

scree_status scree_cuda_reserve(scree_cuda_block *block, size_t size, scree_error *error) {
  if (size <= block->capacity) return SCREE_OK;
  scree_cuda_free(*block);
  *block = (scree_cuda_block){0, 0};
  scree_device_address made;
  int result = cu.allocate(&made, size);
  if (result == OUT_OF_MEMORY)
    return scree_fail(error, SCREE_OUT_OF_MEMORY,
                      "out of memory: the device has no room for %zu bytes more", size);
  if (result) return check(result, "memory", error);
  *block = (scree_cuda_block){made, size};
  return SCREE_OK;
}

scree_status scree_cuda_reserve_more(scree_cuda_block *block, size_t size, scree_error *error) {
  return size <= block->capacity ? SCREE_OK : scree_cuda_reserve(block, size + size / 4, error);
}

void scree_cuda_free(scree_cuda_block block) {
  if (block.at) cu.release(block.at);
}

scree_status scree_cuda_open_queue(scree_cuda_queue *queue, scree_error *error) {
  return check(cu.open_queue(&queue->stream, NON_BLOCKING), "a queue", error);
}

void scree_cuda_close_queue(scree_cuda_queue *queue) {
  if (queue->stream) cu.close_queue(queue->stream);
}

scree_status scree_cuda_wait(const scree_cuda_queue *queue, scree_error *error) {
  return check(cu.wait(queue->stream), "kernels", error);
}

scree_status scree_cuda_write(const scree_cuda_queue *queue, scree_device_address to,
                              const void *from, size_t size, scree_error *error) {
  if (size == 0) return SCREE_OK;
  return check(cu.write(to, from, size, queue->stream), "to the device", error);
}

scree_status scree_cuda_read(const scree_cuda_queue *queue, void *to, scree_device_address from,
                             size_t size, scree_error *error) {
  if (size == 0) return SCREE_OK;
  SCREE_TRY(check(cu.read(to, from, size, queue->stream), "from the device", error));
  return scree_cuda_wait(queue, error);
}

scree_status scree_cuda_clear(const scree_cuda_queue *queue, scree_device_address at, size_t size,
                              scree_error *error) {
  return size ? check(cu.clear(at, 0, size, queue->stream), "memory", error) : SCREE_OK;
}

scree_status scree_cuda_launch(const scree_cuda_queue *queue, scree_kernel kernel, size_t count,
                               size_t worlds, scree_device_address world, scree_device_address step,
                               scree_error *error) {
  void *arguments[] = {&world, &step};
  size_t blocks = scree_block_count(count, THREADS);
  size_t most = MOST_BLOCKS / worlds > LEAST_BLOCKS ? MOST_BLOCKS / worlds : LEAST_BLOCKS;
  if (count == 0) return SCREE_OK;
  if (blocks > most) blocks = most;
  return check(cu.launch(devices[queue->device].functions[kernel], (unsigned)blocks,
                         (unsigned)worlds, 1, THREADS, 1, 1, 0, queue->stream, arguments, NULL),
               "a kernel", error);
}

#else

scree_status scree_cuda_open(int device, char description[256], scree_error *error) {
  (void)device, (void)description;
  return scree_fail(error, SCREE_NO_BACKEND,
                    "cuda: this build has no kernels (it was made without clang for NVPTX)");
}

#endif
