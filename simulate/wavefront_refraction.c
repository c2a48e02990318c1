/* Refraction from Zernike terms: of the whole pupil by least squares, or of its centre.
 *
 * Thibos, Hong, Bradley and Applegate, J. Vision 4, 329 (2004), eqs. 2 and 3. At the centre a term
 * of frequency 0 gives its coefficient of the squared radius, and one of frequency 2 the constant
 * that its angle is multiplied by there. */
#include <placido/wavefront.h>

#include "reconstruct/surface/zernike.h"

#include <math.h>

/* The curvature's share of all terms of this frequency, order 2 alone or all of them. */
static double bend(const double *coefficients_um, int count, int frequency, bool at_centre) {
  double powers[PLACIDO_ZERNIKE_POWERS], sum = 0;
  for (int n = 2; n <= PLACIDO_ZERNIKE_ORDER_MAX; n += 2) {
    int j = placido_zernike_index(n, frequency);
    if (j < count && (n == 2 || at_centre)) {
      placido_zernike_radial(powers, n, frequency);
      sum += powers[frequency == 0 ? 1 : 0] * coefficients_um[j];
    }
  }
  return sum;
}

placido_correction placido_terms_refraction(const double *coefficients_um, int count,
                                            double pupil_mm, bool at_centre) {
  double scale = -2 / (pupil_mm * pupil_mm / 4);
  return (placido_correction){.m_D = scale * bend(coefficients_um, count, 0, at_centre),
                              .j0_D = scale * bend(coefficients_um, count, 2, at_centre),
                              .j45_D = scale * bend(coefficients_um, count, -2, at_centre)};
}
