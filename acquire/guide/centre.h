/* The point about which the picture's edges run, roughly. */
#ifndef PLACIDO_GUIDE_CENTRE_H
#define PLACIDO_GUIDE_CENTRE_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* A place with a strong slope. */
typedef struct placido_guide_slope {
  float x, y, gx, gy;
} placido_guide_slope;

#define PLACIDO_GUIDE_SLOPES_MAX 160000

/* A small picture, and room for its slopes. */
typedef struct placido_guide_small {
  int width, height, bin; /* bin: pixels of the frame in one of these, along one side */
  double axis[2];         /* where the instrument's axis is seen */
  float *grey;
  size_t count;
  placido_guide_slope *slopes; /* PLACIDO_GUIDE_SLOPES_MAX */
} placido_guide_small;

/* Lists the slopes that stand out within `reach` of the axis, both in pixels of `small`. */
void placido_guide_slopes_find(placido_guide_small *small, double reach);

/* Finds the centre (pixels of the frame) of the mires that lie within inner_px of it, starting with
 * all slopes and then those within outer_px. False where the slopes run about no point. */
bool placido_guide_centre(double centre_px[2], const placido_guide_small *small, double inner_px,
                          double outer_px);

#endif
