/* What new triangles must not be, each by itself and with its neighbours. */
#pragma once

#include "simplify/fan.h"

/* Whether, with the vertex where the fan is set, no normal turns farther than leniency allows, no
 * triangle is a sliver and no edge a fold, unless what was there is as bad; at no leniency are
 * there more folds over 149 degrees (150, less what rounding to single precision takes) or more
 * triangles without area than before. */
bool scree_shape_allows(const scree_halfmesh *s, const scree_fan *fan, int leniency);

/* Whether a planned collapse before this one in order (the lower index) would make a fold with it,
 * both done. */
bool scree_shape_folds_with(const scree_halfmesh *s, const scree_fan *fan,
                            const scree_planned *planned, int leniency);

/* Whether a vertex there would lie outside the scan's box by more than a share of the size of the
 * level's triangles. */
bool scree_shape_is_spike(const scree_halfmesh *s, vec3 at);
