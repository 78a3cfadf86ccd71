/* What a command costs:
 *
 *   bench_cost COMMAND [ARGUMENT...]
 *
 * runs it with its standard output thrown away and prints one CSV line: wall seconds, CPU seconds
 * (user and system, all threads), peak resident bytes, exit status. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static double seconds_of(struct timeval t) {
  return (double)t.tv_sec + 1e-6 * (double)t.tv_usec;
}

int main(int argc, char **argv) {
  struct timespec from, to;
  struct rusage usage;
  int status = 0;
  if (argc < 2) {
    fprintf(stderr, "usage: %s COMMAND [ARGUMENT...]\n", argv[0]);
    return 2;
  }
  clock_gettime(CLOCK_MONOTONIC, &from);
  const pid_t child = fork();
  if (child == 0) {
    if (!freopen("/dev/null", "w", stdout)) _exit(127);
    execvp(argv[1], argv + 1);
    perror(argv[1]);
    _exit(127);
  }
  if (child < 0 || waitpid(child, &status, 0) < 0) return 1;
  clock_gettime(CLOCK_MONOTONIC, &to);
  getrusage(RUSAGE_CHILDREN, &usage);
  printf("%.3f,%.3f,%ld,%d\n",
         (double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec),
         seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime), usage.ru_maxrss * 1024,
         WIFEXITED(status) ? WEXITSTATUS(status) : 128);
  return status == 0 ? 0 : 1;
}
