#include "base/parts.h"
#include "scree.h"

static const struct {
  bool there;
  const char *text;
} parts[SCREE_BUILD_COUNT] = {
    [SCREE_BUILD_PICTURES] = {SCREE_HAS_PICTURES, "figures as PNG, SVG and PDF (cairo)"},
    [SCREE_BUILD_RAYS] = {SCREE_HAS_RAYS, "rendered pictures (Embree)"},
    [SCREE_BUILD_STUDY] = {SCREE_HAS_STUDY, "studies of many runs (SQLite)"},
};

bool scree_build_has(scree_build_part part) {
  return (unsigned)part < SCREE_BUILD_COUNT && parts[part].there;
}

const char *scree_build_text(scree_build_part part) {
  return (unsigned)part < SCREE_BUILD_COUNT ? parts[part].text : "";
}
