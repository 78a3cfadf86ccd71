/* scree: triangle counts for DEM particles from 3D scans, chosen by a criterion, tested by
 * simulation.
 *
 * These headers are the whole public interface; each can be included alone. In the order in which
 * the data goes: base, mesh, measure, check, fracture, simplify, fidelity, choice, sample,
 * particle, clump, world, heap, scene, pile, study, report.
 *
 * What holds everywhere:
 *
 * Units: SI inside (metres, kilograms, seconds, radians). A value in another unit says so in its
 * name (angle_deg).
 *
 * Errors: a fallible call returns a scree_status. Its last parameter is a scree_error, which may be
 * NULL, filled with one sentence on failure. Outputs are untouched on failure.
 *
 * Options: NULL stands for a struct of options whose scree_default_... function takes nothing, and
 * for a scree_progress that nobody sees.
 *
 * Ownership: inputs are borrowed. Whoever gets a `T **` or a filled struct frees it with T_free;
 * freeing NULL or a zeroed struct is legal.
 *
 * Threads: no global state but the allocator, the memory limit and the number of threads. Results
 * are the same bits for every number of threads.
 *
 * Output: the library never prints, exits, aborts or longjmps. */
#ifndef SCREE_H
#define SCREE_H

#include "scree/base.h"
#include "scree/calibrate.h"
#include "scree/check.h"
#include "scree/choice.h"
#include "scree/clump.h"
#include "scree/fidelity.h"
#include "scree/fracture.h"
#include "scree/heap.h"
#include "scree/joints.h"
#include "scree/measure.h"
#include "scree/mesh.h"
#include "scree/particle.h"
#include "scree/report.h"
#include "scree/sample.h"
#include "scree/scene.h"
#include "scree/simplify.h"
#include "scree/study.h"
#include "scree/world.h"

#endif
