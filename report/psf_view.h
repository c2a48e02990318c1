/* The part of a PSF that is worth looking at, and its two pictures. */
#ifndef PLACIDO_REPORT_PSF_VIEW_H
#define PLACIDO_REPORT_PSF_VIEW_H

#include "report/canvas.h"

#include <placido/simulate.h>

#define PLACIDO_PSF_DECADES 4 /* that the colours cover, downwards from the peak */

/* A square about the centre bucket. */
typedef struct placido_psf_view {
  const placido_psf *psf;
  int half;           /* buckets from the centre to the edge; the square has 2 half + 1 a side */
  double half_arcmin; /* from the centre to the outer side of the last bucket */
  double tick_arcmin; /* distance between ticks */
  double peak;        /* largest value of the PSF */
} placido_psf_view;

/* The smallest view that holds 99 % of the light that landed, and at least 5 arcmin each way
 * (where the PSF is that large). PLACIDO_OK, PLACIDO_INPUT (a PSF without light, or whose size
 * is not an odd number from 3 up). */
int placido_psf_view_find(placido_psf_view *view, const placido_psf *psf, placido_error *err);

/* The value of the bucket `right` and `up` buckets away from the centre; 0 outside the PSF. */
double placido_psf_view_at(const placido_psf_view *view, int right, int up);

/* The colour of a value: the sequential palette over the logarithm of value / peak; white for 0. */
placido_rgb placido_psf_view_colour(const placido_psf_view *view, double value);

/* The smallest of 1, 2 and 5 times a power of ten that goes at most `most` times into `length`. */
double placido_psf_view_tick(double length, double most);

/* Draws the height field in perspective into a rectangle of the canvas. `*block` receives how many
 * buckets a side one corner of the mesh stands for; it has the largest of their values. */
int placido_psf_relief_draw(const placido_psf_view *view, const placido_canvas *canvas, double left,
                            double top, double width, double height, int *block,
                            placido_error *err);

/* Draws the plan with its axes and colour bar (relative to the peak); (left, top) is the corner
 * of the square itself. */
int placido_psf_plan_draw(const placido_psf_view *view, const placido_canvas *canvas, double left,
                          double top, double side, placido_error *err);

/* Draws lines of equal light (relative to the peak) with their legend at the right and a scale bar;
 * (left, top) is the corner of the square itself. */
void placido_psf_contour_draw(const placido_psf_view *view, const placido_canvas *canvas,
                              double left, double top, double side);

#endif
