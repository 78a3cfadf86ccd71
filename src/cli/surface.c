#include "cli/surface.h"

void cli_print_check(FILE *stream, const scree_check *check) {
  fprintf(stream, "%10zu triangles\n%10zu vertices\n%10zu shells\n", check->triangle_count,
          check->vertex_count, check->shell_count);
  for (int i = 0; i < SCREE_DEFECT_COUNT; i++)
    if (check->defects[i])
      fprintf(stream, "%10zu %s\n", check->defects[i], scree_defect_text((scree_defect)i));
  if (check->volume_known)
    fprintf(stream, "%10.6g cm3 volume\n", check->volume * 1e6);
  else
    fprintf(stream, "%10s volume%s\n", "unknown",
            check->intersections_known ? "" : ": self-intersections were not looked for");
}

void cli_repair_text(const scree_repair_report *report, char *buffer, size_t size) {
  size_t used = 0;
  buffer[0] = 0;
  if (report->before.usable) return;
  for (int a = 0; a < SCREE_REPAIR_ACTION_COUNT; a++) {
    if (!report->done[a] || used + 1 >= size) continue;
    used += (size_t)snprintf(buffer + used, size - used, "%s%zu %s",
                             used ? ", " : "repaired: ", report->done[a],
                             scree_repair_action_text((scree_repair_action)a));
  }
}

void cli_print_repair(FILE *stream, const scree_repair_report *report) {
  bool any = false;
  for (int i = 0; i < SCREE_REPAIR_ACTION_COUNT; i++) {
    if (!report->done[i]) continue;
    any = true;
    fprintf(stream, "%10zu %s\n", report->done[i],
            scree_repair_action_text((scree_repair_action)i));
  }
  if (report->seam_distance > 0)
    fprintf(stream, "%10.3g mm is the distance within which seams were closed\n",
            report->seam_distance * 1e3);
  if (!any)
    fprintf(stream, "%10s %s be done\n", "nothing", report->before.usable ? "had to" : "could");
}
