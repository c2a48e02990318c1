/* From mires to the cornea: the surface that mirrors the instrument's edges to where they were
 * seen, with the error bars of what it does and does not know. */
#ifndef PLACIDO_RECONSTRUCT_H
#define PLACIDO_RECONSTRUCT_H

#include <placido/mires.h>
#include <placido/surface.h>

/* Knobs of the fit; zero means the default in brackets. */
typedef struct placido_fit_options {
  double axis_z_mm;       /* z of the cornea at x = y = 0 [0] */
  double axis_z_sigma_mm; /* its standard deviation; 0 means exactly known */
  double knot_mm;         /* knot spacing, 0.15 to 2; [0.5, or finer where residuals ask for it] */
  double smoothing;       /* weight of the third-derivative penalty [1000] */
  int steps_max;          /* Gauss-Newton steps [40] */
  int threads;            /* [1]; the result does not depend on it */
} placido_fit_options;

/* Opaque: the fitted surface with its covariance. Immutable. */
typedef struct placido_fit placido_fit;

/* How the fit went. */
typedef struct placido_fit_summary {
  double rms_px;            /* of the residuals of the used points */
  double sigma_px;          /* robust standard deviation of an edge point, from the residuals */
  size_t points, points_used;
  int steps;                /* Gauss-Newton steps taken */
  double knot_mm;
  double radius_mm;         /* of the fitted disc */
  double condition;         /* estimate of the normal matrix's condition number */
} placido_fit_summary;

/* Fits the surface. Sets used and residual_px in `mires`. Free with placido_fit_free.
 * Returns PLACIDO_OK, PLACIDO_INPUT (an option out of range), PLACIDO_QUALITY (too few points, no
 * convergence, or no cornea: the sentence says which), PLACIDO_MEMORY. */
int placido_fit_new(placido_fit **fit, placido_mires *mires,
                    const placido_instrument *instrument, const placido_fit_options *options,
                    placido_notes *notes, placido_error *err);
void placido_fit_free(placido_fit *fit);

/* Borrowed until the fit is freed. */
const placido_surface *placido_fit_surface(const placido_fit *fit);
placido_fit_summary placido_fit_summary_get(const placido_fit *fit);

/* Standard deviations at (x, y), 1 sigma: of z (micrometres) against its value on the axis, whose
 * own uncertainty is axis_z_sigma_mm, and of axial curvature (337.5 dioptres); from edge noise,
 * smoothing and the distance's uncertainty. NaN outside the disc. */
void placido_fit_sigma_at(const placido_fit *fit, double x_mm, double y_mm, double *sigma_z_um,
                          double *sigma_axial_D);

#endif
