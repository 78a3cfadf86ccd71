/* A scanner's noise makes the surface rough at the scale of its spacing, and roughness is area:
 * height noise of slope g adds g^2 / 2 to each unit. Decimation smooths it within the first factor
 * of ten or two, long before the shape changes, so that S(N) falls, rests on a plateau, and then
 * moves again as the shape goes. The rest is an area free of noise, measured on the object itself.
 *
 * The plateau is sought in ln N: among windows of WINDOW steps (half a decade) whose middle lies
 * LEAST_FRACTION below the scan's area, the one in which S varies least, from the scan down to the
 * last count that can still carry a shape. It counts where the area lost on the way to it is
 * DROP_RATIO times what the window itself varies: a shape whose error falls like 1/N has 0.8 there.
 * (The windows above are left out because correlated noise leaves S flat at the scan's end too.) */
#include "base/math.h"
#include "choice/criterion.h"

#include <math.h>

enum {
  PER_DECADE = 24,
  WINDOW = 12,         /* steps: half a decade */
  DECADES = 3,         /* the plateau begins well above Rp = 1e-3: coarser is shape */
  SMALLEST_COUNT = 100 /* triangles; below, area says nothing of roughness */
};
static const double DROP_RATIO = 4;
/* Less noise than this changes no choice on the paper's grid. */
static const double LEAST_FRACTION = 5e-4;

typedef struct sample {
  double area;
  size_t level_index, triangle_count;
} sample;

static size_t take_samples(const scree_level_table *table, sample *samples) {
  double scan_count = (double)table->row(table->context, 0).triangle_count;
  size_t count = 0;
  for (size_t k = 0; k <= DECADES * PER_DECADE; k++) {
    double target = scan_count * scree_power_of_ten(-(double)k / PER_DECADE);
    if (target < SMALLEST_COUNT) break;
    size_t index = scree_level_find(table, (size_t)target);
    scree_level_row row = table->row(table->context, index);
    if (count && row.triangle_count == samples[count - 1].triangle_count) break; /* the floor */
    samples[count++] = (sample){row.area, index, row.triangle_count};
  }
  return count;
}

static double window_range(const sample *window) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i <= WINDOW; i++) {
    low = fmin(low, window[i].area);
    high = fmax(high, window[i].area);
  }
  return high - low;
}

scree_noise scree_noise_find(const scree_level_table *table) {
  scree_level_row scan = table->row(table->context, 0);
  scree_noise none = {false, scan.area, 0, 0, scan.triangle_count};
  sample samples[DECADES * PER_DECADE + 1];
  size_t count = take_samples(table, samples);
  if (count <= WINDOW) return none;
  size_t flattest = 0;
  double least = INFINITY;
  for (size_t begin = 0; begin + WINDOW < count; begin++) {
    double range = window_range(&samples[begin]);
    double lost = scan.area - samples[begin + WINDOW / 2].area;
    if (lost >= LEAST_FRACTION * scan.area && range < least) {
      least = range;
      flattest = begin;
    }
  }
  const sample *middle = &samples[flattest + WINDOW / 2];
  double drop = scan.area - middle->area;
  if (!(drop >= DROP_RATIO * least)) return none; /* also where no window lies low enough */
  const sample *start = &samples[flattest];
  return (scree_noise){true, middle->area, drop / middle->area, start->level_index,
                       start->triangle_count};
}
