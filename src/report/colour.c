#include "report/image.h"

#include "base/alloc.h"

void scree_image_free(scree_image *image) {
  if (!image) return;
  scree_free(image->pixels);
  *image = (scree_image){0};
}

/* The matplotlib map viridis by sixth-degree fits of its three channels (linear light is left
 * aside: the values are sRGB and squared on the way in). */
vec3 scree_viridis(double t) {
  static const double c[7][3] = {{0.2777273272234177, 0.005407344544966578, 0.3340998053353061},
                                 {0.1050930431085774, 1.404613529898575, 1.384590162594685},
                                 {-0.3308618287255563, 0.214847559468213, 0.09509516302823659},
                                 {-4.634230498983486, -5.799100973351585, -19.33244095627987},
                                 {6.228269936347081, 14.17993336680509, 56.69055260068105},
                                 {4.776384997670288, -13.74514537774601, -65.35303263337234},
                                 {-5.435455855934631, 4.645852612178535, 26.3124352495832}};
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  double rgb[3];
  for (int channel = 0; channel < 3; channel++) {
    double value = c[6][channel];
    for (int i = 5; i >= 0; i--) value = value * t + c[i][channel];
    value = value < 0 ? 0 : value > 1 ? 1 : value;
    rgb[channel] = pow(value, 2.2);
  }
  return (vec3){rgb[0], rgb[1], rgb[2]};
}

uint8_t scree_to_srgb(double linear) {
  double x = linear <= 0 ? 0 : linear >= 1 ? 1 : linear;
  double s = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
  return (uint8_t)(255 * s + 0.5);
}
