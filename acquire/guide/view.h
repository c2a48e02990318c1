/* A frame's samples of one plane as numbers from 0 to 1, wherever they are asked for. */
#ifndef PLACIDO_GUIDE_VIEW_H
#define PLACIDO_GUIDE_VIEW_H

#include <placido/frame.h>
#include <stdbool.h>

#define PLACIDO_GUIDE_MERIDIANS 128
#define PLACIDO_GUIDE_OUTSIDE (-1.0F) /* a sample beyond the picture */

/* Borrows the frame. */
typedef struct placido_guide_view {
  const placido_frame *frame;
  size_t channel;
  int white; /* largest sample */
} placido_guide_view;

/* Of a colour frame the plane with the strongest fine contrast. */
placido_guide_view placido_guide_view_of(const placido_frame *frame);

/* The picture with `bin` × `bin` pixels in one; a last part of a bin is left out. */
void placido_guide_view_shrink(float *small, const placido_guide_view *view, int bin);

/* Profiles about a centre: row m of `samples` values runs along meridian m, from +x towards -v (up
 * in the picture), value i at radius i × step_px. */
typedef struct placido_guide_polar {
  double centre_px[2];
  double step_px;
  int samples;
  float *data; /* PLACIDO_GUIDE_MERIDIANS × samples */
} placido_guide_polar;

/* Unit vector of a meridian in the image, (u, v). */
void placido_guide_direction(double uv[2], int meridian);

/* Fills the first `count` values of each row about the centre set in `polar`; each is the mean of
 * three, a step apart along the tangent. */
void placido_guide_polar_fill(placido_guide_polar *polar, const placido_guide_view *view,
                              int count);

/* Shares of the samples in a disc that are 0 and white. */
typedef struct placido_guide_clipping {
  double black, white;
} placido_guide_clipping;
placido_guide_clipping placido_guide_view_clipping(const placido_guide_view *view,
                                                   const double centre_px[2], double radius_px);

#endif
