/* Corneas for tests. */
#ifndef PLACIDO_TESTS_SIMULATE_EYES_H
#define PLACIDO_TESTS_SIMULATE_EYES_H

#include <placido/simulate.h>

/* Defined to a radius of 4.5 mm; free with placido_surface_free. */
placido_surface *toric(double r1_mm, double r2_mm, double q, double axis_deg);
placido_surface *conic(double radius_mm, double q);

/* A cone of 40 um below the middle and to the right, on a toric base; all turned by turn_deg. */
placido_surface *keratoconus(double turn_deg);

/* A perfect cornea for `index` whose half above offset_mm (before turning by axis_deg about z) has
 * an extra slope: light from it makes a second image. */
placido_surface *ridged(double index, double slope, double offset_mm, double axis_deg);

/* A perfect cornea for `index` with vertical coma: OSA term 7 over a radius of 4.5 mm, micrometres
 * of sag; below zero the lower half is steeper. */
placido_surface *comatic(double index, double coma_um);

/* A cone of height_mm and width sigma_mm at (x, y) on a toric base. */
placido_surface *cone(double height_mm, double sigma_mm, double x_mm, double y_mm);

/* No curvature at all. */
placido_surface *flat(void);

/* Fails the test with the message where making the PSF fails. */
placido_psf psf_of(const placido_surface *surface, const placido_eye *eye,
                   const placido_optics *optics);

/* Light-weighted means over the PSF, relative to its middle bucket: row grows downwards. */
typedef struct moments {
  double sum, column, row;     /* centroid, arcmin */
  double cc, cr, rr;           /* central second moments, arcmin² */
} moments;

moments moments_of(const placido_psf *psf);

/* The cornea's eye with everything decided. Fails the test where there is no focus. */
placido_eye settled_eye(const placido_surface *surface, placido_eye eye);

#endif
