/* The image unrolled about the mires' centre: one profile a meridian. */
#ifndef PLACIDO_MIRES_POLAR_H
#define PLACIDO_MIRES_POLAR_H

#include <placido/image.h>

/* Where the samples of a meridian lie: sample i at radius start_px + i × step_px, for i < count.
 * The first few lie beyond the centre, at negative radii. */
typedef struct placido_meridian {
  double start_px, step_px;
  int count;
  double radial_px2, tangential_px2; /* variance that gathering pixels adds along and across */
} placido_meridian;

/* Row m of `data`, `samples` wide, is the profile along meridian m × 360 / meridians degrees; what
 * lies beyond its count is 0. `clipped` has the same shape and is NULL where no pixel of the image
 * is saturated: 1 where a sample took such a pixel. */
typedef struct placido_polar {
  double centre_px[2];
  int meridians, samples;
  placido_meridian *along; /* one a meridian */
  float *data;
  unsigned char *clipped;
} placido_polar;

/* Unrolls the plane out to radius_px. A meridian nearer to the rows (columns) takes a sample at
 * each column (row) that it crosses, weighing the pixels of that column (row) about it, usually
 * six, by B-splines that are nearly a Gaussian (Unser, IEEE Signal Proc. Mag. 16:22, 1999), of
 * standard deviation filter_px (1/√3 to 4; usually 1): no pixel serves two samples of a meridian,
 * so their noise is independent, and the blur that the kernel adds is known. Free with
 * placido_polar_free. */
int placido_polar_new(placido_polar *polar, const placido_image *plane, const double centre_px[2],
                      double radius_px, int meridians, double filter_px, int threads,
                      placido_error *err);
void placido_polar_free(placido_polar *polar);

#endif
