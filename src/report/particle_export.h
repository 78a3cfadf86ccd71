/* What the exports of particles and of worlds share. */
#ifndef SCREE_REPORT_PARTICLE_EXPORT_H
#define SCREE_REPORT_PARTICLE_EXPORT_H

#include "report/json.h"

/* Density and unit in their ranges. */
scree_status scree_export_check(const scree_export_options *options, scree_error *error);
/* file, checksum, version, command */
void scree_export_json_provenance(scree_json *json, const scree_export_options *options);

#endif
