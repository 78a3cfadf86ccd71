/* Built-in samples. */
#ifndef SCREE_SAMPLE_H
#define SCREE_SAMPLE_H

#include "scree/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Nine electronic devices in the manner of the paper's, and four test solids. All are synthetic:
 * drawn, meshed and given a scanner's noise here (docs/background/samples.md), after no make in
 * particular. Samples 0 to SCREE_SAMPLE_DEVICES - 1 are the devices: fp-1, fp-2, fp-3 (feature
 * phones), dc-1, dc-2, dc-3 (digital cameras), sp-1, sp-2, sp-3 (smartphones); then sphere, box,
 * box-12 and icosphere. */
enum { SCREE_SAMPLE_DEVICES = 9 };

SCREE_API size_t scree_sample_count(void);
/* Name and one-line description of a sample; NULL for an index that is not below the count. */
SCREE_API const char *scree_sample_name(size_t index);
SCREE_API const char *scree_sample_description(size_t index);

typedef struct scree_sample_options {
  double resolution; /* spacing of the mesh's vertices, m; in [0.02e-3, 5e-3], default 0.27e-3 (the
                        paper's). Details finer than it are lost, without harm to the mesh. */
  double noise;      /* standard deviation of the scanner's noise, m; from 0 (a clean mesh) to a
                        quarter of the resolution, default 0.02e-3. The test solids have none. */
  uint64_t seed;     /* of the noise; default 1 */
} scree_sample_options;

SCREE_API scree_sample_options scree_default_sample_options(void);

/* Makes the sample of this name; icosphere-0 to icosphere-11 name a level of the icosphere. The
 * mesh is closed, manifold and outward, without degenerate triangles; at the default resolution a
 * device has 400,000 to 1,500,000 triangles. The same bits for any number of threads. options NULL
 * means the defaults, progress may be NULL. Errors: SCREE_BAD_ARGUMENT for an unknown name or an
 * option out of range, SCREE_LIMIT where the resolution is too fine or too coarse for the sample,
 * SCREE_CANCELLED, SCREE_OUT_OF_MEMORY. Cost: about a second per million triangles and processor.
 * Free *mesh with scree_mesh_free. */
SCREE_API scree_status scree_sample_make(const char *name, const scree_sample_options *options,
                                         const scree_progress *progress, scree_mesh *mesh,
                                         scree_error *error);

#ifdef __cplusplus
}
#endif
#endif
