/* The image unrolled about the mires' centre: one profile a meridian. */
#ifndef PLACIDO_MIRES_POLAR_H
#define PLACIDO_MIRES_POLAR_H

#include <placido/image.h>

#define PLACIDO_POLAR_STEP_PX 0.5
/* Variance along the tangent that averaging three parallel profiles adds, in px². */
#define PLACIDO_POLAR_ARC_VARIANCE 0.5

/* Row m is the profile along meridian m × 360 / meridians degrees, sample i at radius
 * i × PLACIDO_POLAR_STEP_PX; NaN beyond the image. */
typedef struct placido_polar {
  double centre_px[2];
  int meridians, samples;
  float *data;
} placido_polar;

/* Unrolls the plane out to radius_px by interpolating cubic splines (Unser, IEEE Signal Proc. Mag.
 * 16:22, 1999), averaging three profiles 1 px apart with weights 1/4 1/2 1/4. Free with
 * placido_polar_free. */
int placido_polar_new(placido_polar *polar, const placido_image *plane, const double centre_px[2],
                      double radius_px, int meridians, int threads, placido_error *err);
void placido_polar_free(placido_polar *polar);

#endif
