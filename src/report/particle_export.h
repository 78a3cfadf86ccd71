/* What the exports of particles and of worlds share. */
#pragma once

#include "report/json.h"

/* Density and unit in their ranges. */
scree_status scree_export_check(const scree_export_options *options, scree_error *error);
/* file, checksum, version, command */
void scree_export_json_provenance(scree_json *json, const scree_export_options *options);
