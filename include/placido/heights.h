/* A surface through measured heights, such as another topographer's: the linear cousin of the fit
 * from mires, with the same kind of error bars. */
#ifndef PLACIDO_HEIGHTS_H
#define PLACIDO_HEIGHTS_H

#include <placido/reconstruct.h>

/* A measured point of the cornea; z grows towards the camera. */
typedef struct placido_height {
  double x_mm, y_mm, z_mm;
} placido_height;

/* How the fit went. */
typedef struct placido_heights_summary {
  size_t count;
  double rms_um;      /* of the residuals: measured less fitted height */
  double sigma_um;    /* the same for a single point, with the fit's own freedom counted in */
  double worst_um;    /* the residual that is farthest from 0 */
  size_t worst;       /* and whose it is */
  double correlation; /* variance of a mean of neighbours over what it would be were they
                         independent: 1 and more, from the residuals in the order of the points */
  double spacing_mm;  /* of the points: the side of a square that one of them has for itself */
  double knot_mm;
} placido_heights_summary;

/* Fits a paraboloid with a biquintic B-spline on top by linear least squares. `knot_mm` is 0.15 to
 * 2, or 0: as fine as the residuals ask for, but no finer than the points. The coverage closes gaps
 * of up to three times their spacing (at least 0.6 mm) and adds nothing outside the outermost ones.
 * The error bars take the residuals for the noise, correlated as they are; distance and geometry of
 * the instrument that measured are not known. In the fit's summary the pixels are NaN.
 * Free with placido_fit_free. Returns PLACIDO_OK, PLACIDO_INPUT (knot_mm out of range, a coordinate
 * that is not finite or beyond 20 mm), PLACIDO_QUALITY (too few points, or no cornea: the sentence
 * says which), PLACIDO_MEMORY. */
int placido_heights_fit(placido_fit **fit, placido_heights_summary *summary,
                        const placido_height *heights, size_t count, double knot_mm,
                        placido_error *err);

/* Curvature (1/mm) of the paraboloid nearest to the points: positive where they bulge towards the
 * camera, as a cornea does. NaN where they determine none. */
double placido_heights_curvature(const placido_height *heights, size_t count);

#endif
