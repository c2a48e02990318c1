/* The pupil's diameter: what drives it is luminance times the field's area, a tenth of that where
 * one eye is covered; with age it is smaller, and changes less.
 *
 * A. B. Watson, J. I. Yellott, "A unified formula for light-adapted pupil size", Journal of Vision
 * 12(10):12 (2012): Stanley and Davies' formula, adjusted for age. */
#include "simulate/models/pupil_diameter.h"

#include <math.h>

static const double one_eye = 0.1, reference_years = 28.58;

double placido_pupil_diameter_mm(double luminance_cd_m2, double area_deg2, bool both_eyes,
                                 double age_years) {
  double flux = luminance_cd_m2 * area_deg2 * (both_eyes ? 1 : one_eye);
  double drive = pow(flux / 846, 0.41);
  double diameter_mm = 7.75 - 5.75 * (drive / (drive + 2));
  double age = fmin(fmax(age_years, PLACIDO_PUPIL_YOUNGEST_YEARS), PLACIDO_PUPIL_OLDEST_YEARS);
  return diameter_mm + (age - reference_years) * (0.02132 - 0.009562 * diameter_mm);
}
