/* What the texts and the figures of a choice share. */
#pragma once

#include "base/error.h"
#include "report/program.h"

/* choice_text.c: the one Rp of a set: the rule's, and the paper's beside a recommended count. */
const scree_set_pick *scree_report_set_pick(const scree_choice_report *report);
