/* Where and when some work was done: what changes from run to run, apart from the results. */
#include "base/file.h"
#include "base/progress.h"
#include "report/json.h"

#include <string.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

static double processor_time(void) {
  struct timespec t = {0, 0};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

scree_work_start scree_work_started(void) {
  return (scree_work_start){(double)time(NULL), scree_now(), processor_time()};
}

static void put_start(scree_json *json, double calendar) {
  time_t seconds = (time_t)calendar;
  struct tm parts;
  char text[32] = "";
  if (gmtime_r(&seconds, &parts)) strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  scree_json_text(json, "started", text);
}

/* Linux tells it in /proc; elsewhere the kind of machine must do. */
static void put_processor(scree_json *json, const char *machine) {
  char line[256], *name = NULL;
  FILE *stream = fopen("/proc/cpuinfo", "r");
  while (stream && !name && fgets(line, sizeof line, stream)) {
    char *colon = strchr(line, ':');
    if (colon && !strncmp(line, "model name", 10)) name = colon + 1 + strspn(colon + 1, " ");
  }
  if (stream) fclose(stream);
  if (name) name[strcspn(name, "\n")] = 0;
  scree_json_text(json, "processor", name ? name : machine);
}

scree_status scree_provenance_write(const scree_work_start *start, const char *command_line,
                                    const char *path, bool overwrite, scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  scree_json json = scree_json_start(output.stream);
  struct utsname system = {.sysname = "unknown"};
  char text[sizeof system.sysname + sizeof system.release + sizeof system.machine + 4];
  uname(&system);
  snprintf(text, sizeof text, "%s %s, %s", system.sysname, system.release, system.machine);
  scree_json_object(&json, NULL);
  scree_json_text(&json, "version", scree_version());
  scree_json_text(&json, "command", command_line);
  put_start(&json, start->calendar);
  scree_json_number(&json, "elapsed_s", scree_now() - start->elapsed);
  scree_json_number(&json, "processor_s", processor_time() - start->processor);
  scree_json_count(&json, "threads", (uint64_t)scree_threads());
  scree_json_text(&json, "system", text);
  put_processor(&json, system.machine);
  scree_json_count(&json, "processors", (uint64_t)sysconf(_SC_NPROCESSORS_ONLN));
  scree_json_end(&json);
  return scree_output_commit(&output, error);
}

scree_status scree_text_write(const char *text, const char *path, bool overwrite,
                              scree_error *error) {
  scree_output output;
  scree_status status = scree_output_open(path, overwrite, &output, error);
  if (status != SCREE_OK) return status;
  fputs(text, output.stream);
  return scree_output_commit(&output, error);
}
