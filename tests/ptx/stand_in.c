/* A stand-in for NVIDIA's driver, to be found as libcuda.so.1: kernels are the PTX itself,
 * translated to C (ptx_to_c.py), and run on the processor, one thread after another. Memory of the
 * device is memory. SCREE_STAND_IN_ORDER is the order of a launch's threads: forward, reverse or
 * shuffled; SCREE_STAND_IN_MEMORY the device's bytes; SCREE_STAND_IN_LOST=N loses the device at the
 * Nth launch. Tests may also set stand_in_lost and stand_in_full. With SCREE_STAND_IN_RACES=1 every
 * plain access of a thread to the device's memory is noted: where of two threads of one launch one
 * writes what the other reads or writes, the program ends with a message. With
 * SCREE_STAND_IN_COUNTS=1 it says at the end what was written and read. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct kernel {
  const char *name;
  void (*run)(void *, void *);
} kernel;
extern const kernel kernels[];
extern _Thread_local uint32_t thread_index, block_index, block_size, block_count, world_index;
extern const char translated_ptx[]; /* what the kernels were translated from */

enum { INVALID_VALUE = 1, OUT_OF_MEMORY = 2, INVALID_PTX = 218, NOT_FOUND = 500, LOST = 719 };
static _Atomic size_t used, peak;
static _Atomic unsigned long launches, refused;
int stand_in_lost, stand_in_full; /* every call fails; there is no more memory */
int watching;
void note_access(const void *at, uint64_t size, int is_write);

static size_t setting(const char *name, size_t otherwise) {
  const char *text = getenv(name);
  return text ? strtoull(text, NULL, 10) : otherwise;
}

/* Bytes to the device and back. */
_Atomic unsigned long long stand_in_written, stand_in_read;

static void tell_counts(void) {
  fprintf(stderr,
          "stand-in: %llu bytes written, %llu read, %lu launches, %zu bytes in use at most, %lu "
          "times too little memory\n",
          stand_in_written, stand_in_read, launches, peak, refused);
}

int cuInit(unsigned flags) {
  if (setting("SCREE_STAND_IN_COUNTS", 0)) atexit(tell_counts);
  return flags ? INVALID_VALUE : 0;
}
int cuDeviceGetCount(int *count) {
  *count = 1;
  return 0;
}
int cuDeviceGet(int *device, int number) {
  *device = number;
  return 0;
}
int cuDeviceGetName(char *name, int size, int device) {
  (void)device;
  snprintf(name, (size_t)size, "stand-in");
  return 0;
}
int cuDeviceTotalMem_v2(size_t *size, int device) {
  (void)device;
  *size = setting("SCREE_STAND_IN_MEMORY", (size_t)8 << 30);
  return 0;
}
int cuDevicePrimaryCtxRetain(void **context, int device) {
  static int only;
  *context = &only;
  return device ? INVALID_VALUE : 0;
}
int cuCtxSetCurrent(void *context) {
  return context ? 0 : INVALID_VALUE;
}
int cuCtxSetLimit(int limit, size_t value) {
  (void)limit, (void)value;
  return 0;
}
int cuGetErrorString(int error, const char **text) {
  *text = error == OUT_OF_MEMORY ? "out of memory"
          : error == LOST        ? "unspecified launch failure"
                                 : "invalid";
  return 0;
}

/* Only what was translated can be run. */
int cuModuleLoadDataEx(void **module, const void *text, unsigned count, int *options,
                       void **values) {
  (void)count, (void)options, (void)values;
  *module = (void *)(uintptr_t)kernels;
  return strcmp(text, translated_ptx) ? INVALID_PTX : 0;
}
int cuModuleGetFunction(void **function, void *module, const char *name) {
  (void)module;
  for (const kernel *k = kernels; k->name; k++)
    if (strcmp(k->name, name) == 0) {
      *function = (void *)(uintptr_t)k;
      return 0;
    }
  return NOT_FOUND;
}

/* ---- races ---- */

/* Who wrote a byte last, and who read it: launch << 32 | thread + 1; many readers are no thread. */
typedef struct access {
  uint64_t writer, reader;
} access;
static struct watched {
  char *begin;
  size_t size;
  access *bytes;
} blocks[256];
static size_t watched_count;
static const uint64_t many = UINT32_MAX;

static void watch_block(char *begin, size_t size) {
  if (watched_count == sizeof blocks / sizeof *blocks) abort();
  blocks[watched_count++] = (struct watched){begin, size, calloc(size, sizeof(access))};
}

static void forget_block(const char *begin) {
  for (size_t i = 0; i < watched_count; i++)
    if (blocks[i].begin == begin) {
      free(blocks[i].bytes);
      blocks[i] = blocks[--watched_count];
      return;
    }
}

static const char *running; /* the kernel */

static void note_byte(const struct watched *block, size_t at, int is_write) {
  access *byte = &block->bytes[at];
  uint64_t launch = (uint64_t)launches << 32,
           self = launch | (((uint64_t)world_index * block_count + block_index) * block_size +
                            thread_index + 1);
  bool written = byte->writer >> 32 == launches && byte->writer != self,
       read = byte->reader >> 32 == launches && byte->reader != self;
  if (written || (is_write && read)) {
    fprintf(stderr, "stand-in: threads %llu and %llu of launch %lu, %s, meet at byte %zu of %zu\n",
            (unsigned long long)((written ? byte->writer : byte->reader) & many) - 1,
            (unsigned long long)(self & many) - 1, launches, running, at, block->size);
    exit(3);
  }
  if (is_write)
    byte->writer = self;
  else
    byte->reader = read ? launch | many : self;
}

void note_access(const void *at, uint64_t size, int is_write) {
  for (size_t i = 0; i < watched_count; i++) {
    const struct watched *block = &blocks[i];
    if ((const char *)at < block->begin || (const char *)at >= block->begin + block->size) continue;
    size_t first = (size_t)((const char *)at - block->begin);
    for (size_t k = first; k < first + size; k++) note_byte(block, k, is_write);
    return;
  }
}

/* ---- memory ---- */

/* The size of a block lies before it. */
int cuMemAlloc_v2(unsigned long long *address, size_t size) {
  size_t most = setting("SCREE_STAND_IN_MEMORY", (size_t)8 << 30);
  bool fits = size && !stand_in_full && used + size <= most;
  if (stand_in_lost) return LOST;
  char *block = fits ? aligned_alloc(256, (size + 511) & ~(size_t)255) : NULL;
  if (!block) {
    refused++;
    return OUT_OF_MEMORY;
  }
  memcpy(block, &size, sizeof size);
  memset(block + 256, 0xA5, size);
  used += size;
  if (used > peak) peak = used;
  watching = setting("SCREE_STAND_IN_RACES", 0) != 0;
  if (watching) watch_block(block + 256, size);
  *address = (uintptr_t)(block + 256);
  return 0;
}
int cuMemFree_v2(unsigned long long address) {
  char *block = (char *)(uintptr_t)address - 256;
  size_t size;
  memcpy(&size, block, sizeof size);
  used -= size;
  forget_block(block + 256);
  free(block);
  return 0;
}
/* Queues: each does at once what it is asked. */
int cuStreamCreate(void **stream, unsigned flags) {
  static int only;
  *stream = &only;
  return flags == 1 ? 0 : INVALID_VALUE;
}
int cuStreamDestroy_v2(void *stream) {
  return stream ? 0 : INVALID_VALUE;
}
int cuStreamSynchronize(void *stream) {
  return stand_in_lost ? LOST : stream ? 0 : INVALID_VALUE;
}
int cuMemcpyHtoDAsync_v2(unsigned long long to, const void *from, size_t size, void *stream) {
  if (!stream) return INVALID_VALUE;
  if (stand_in_lost) return LOST;
  memcpy((void *)(uintptr_t)to, from, size);
  stand_in_written += size;
  return 0;
}
int cuMemcpyDtoHAsync_v2(void *to, unsigned long long from, size_t size, void *stream) {
  if (!stream) return INVALID_VALUE;
  if (stand_in_lost) return LOST;
  memcpy(to, (const void *)(uintptr_t)from, size);
  stand_in_read += size;
  return 0;
}

int cuMemsetD8Async(unsigned long long at, unsigned char value, size_t size, void *stream) {
  (void)stream;
  if (stand_in_lost) return LOST;
  memset((void *)(uintptr_t)at, value, size);
  return 0;
}

/* A permutation of the threads: i times a number that has no divisor in common with the count. */
static size_t shuffled(size_t i, size_t count) {
  size_t step = count / 3 * 2 + 1;
  for (;; step++) {
    size_t a = step, b = count;
    while (b) {
      size_t rest = a % b;
      a = b;
      b = rest;
    }
    if (a == 1) return i * step % count;
  }
}

int cuLaunchKernel(void *function, unsigned grid_x, unsigned grid_y, unsigned grid_z,
                   unsigned block_x, unsigned block_y, unsigned block_z, unsigned shared,
                   void *stream, void **arguments, void **extra) {
  (void)stream, (void)extra;
  if (grid_z * block_y * block_z != 1 || shared) return INVALID_VALUE;
  if (++launches == setting("SCREE_STAND_IN_LOST", 0)) stand_in_lost = 1;
  if (stand_in_lost) return LOST;
  const char *order = getenv("SCREE_STAND_IN_ORDER");
  bool reverse = order && strcmp(order, "reverse") == 0,
       shuffle = order && strcmp(order, "shuffled") == 0;
  size_t in_world = (size_t)grid_x * block_x, count = in_world * grid_y;
  block_size = block_x;
  block_count = grid_x;
  running = ((const kernel *)function)->name;
  for (size_t i = 0; i < count; i++) {
    size_t thread = reverse ? count - 1 - i : shuffle ? shuffled(i, count) : i;
    world_index = (uint32_t)(thread / in_world);
    block_index = (uint32_t)(thread % in_world / block_x);
    thread_index = (uint32_t)(thread % block_x);
    ((const kernel *)function)->run(arguments[0], arguments[1]);
  }
  return 0;
}
