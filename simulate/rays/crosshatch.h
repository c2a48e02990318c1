/* The seed's pattern of rays: two square grids, one in the middles of the other's cells. */
#ifndef PLACIDO_SIMULATE_RAYS_CROSSHATCH_H
#define PLACIDO_SIMULATE_RAYS_CROSSHATCH_H

#include <placido/eye.h>

/* N×N nodes over the pupil's square, its edges included, and the (N-1)×(N-1) middles of their
 * cells. Counted in half cells from the pupil's centre, a ray stands at whole numbers, so that
 * whether it is inside the pupil is decided exactly. */
typedef struct placido_crosshatch {
  int samples;                 /* N */
  int rows;                    /* 2 N - 1: first the N node rows, then the N - 1 middle rows */
  double half_cell_mm;
  double x_mm, y_mm;           /* the pupil's centre */
} placido_crosshatch;

placido_crosshatch placido_crosshatch_of(const placido_eye *eye, int samples);

/* N² + (N-1)²: the seed's 100 gives 19,801. */
long placido_crosshatch_total(const placido_crosshatch *pattern);

/* The least N of 2 or more that has at least `rays` rays. */
int placido_crosshatch_samples(long rays);

/* The rays of a row that are inside the pupil: `*count` of them from *first_x_mm on, two half cells
 * apart, at *y_mm. */
void placido_crosshatch_row(const placido_crosshatch *pattern, int row, double *first_x_mm,
                            int *count, double *y_mm);

/* The share of the pupil's area that each ray of a row stands for; they sum to 1 over all rows.
 * Either grid fills the pupil with square cells about its rays, and counts half. A cell that the
 * rim crosses counts by its area inside; where its middle is outside, for the next ray inwards.
 * `weight` has room for the row's rays. */
void placido_crosshatch_weights(const placido_crosshatch *pattern, int row, double *weight);

#endif
