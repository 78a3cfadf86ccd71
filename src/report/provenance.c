/* Where and when some work was done: what changes from run to run, apart from the results. */
#include "report/provenance.h"
#include "base/platform.h"
#include "report/json.h"

scree_work_start scree_work_started(void) {
  return (scree_work_start){scree_calendar_time(), scree_now(), scree_processor_time()};
}

scree_status scree_provenance_write(const scree_work_start *start, const char *command_line,
                                    const char *path, bool overwrite, scree_error *error) {
  scree_json json;
  SCREE_TRY(scree_json_open(&json, path, overwrite, error));
  char started[32], system[SCREE_SYSTEM_TEXT], processor[SCREE_SYSTEM_TEXT];
  scree_format_time(start->calendar, started);
  scree_system_name(system);
  scree_processor_name(processor);
  scree_json_object(&json, NULL);
  scree_json_maker(&json, command_line);
  SCREE_JSON_MEMBERS(&json, AS("started", started), AS("elapsed_s", scree_now() - start->elapsed),
                     AS("processor_s", scree_processor_time() - start->processor),
                     AS("threads", (uint64_t)scree_threads()), AS("system", system),
                     AS("processor", processor),
                     AS("processors", (uint64_t)scree_processor_count()));
  scree_json_end(&json);
  return scree_json_commit(&json, error);
}

static void json_time(scree_json *json, const char *name, double calendar) {
  char text[32];
  scree_format_time(calendar, text);
  scree_json_text(json, name, *text ? text : NULL);
}

void scree_json_origin(scree_json *json, const scree_origin *origin) {
  char text[SCREE_CHECKSUM_TEXT];
  scree_json_text(json, "command", origin->command);
  json_time(json, "started", origin->started);
  json_time(json, "ended", origin->ended);
  scree_json_text(json, "machine", origin->machine);
  SCREE_JSON_LIST (json, "inputs", i, origin->input_count) {
    SCREE_JSON_ROW(json, NULL, AS("path", origin->inputs[i].path),
                   AS("checksum", scree_checksum_text(origin->inputs[i].checksum, text)));
  }
}
