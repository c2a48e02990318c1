/* Contrast filters of human vision.
 *
 * Sensitivity: A. B. Watson, A. J. Ahumada, J. Vision 5(9):6 (2005), the HPmH function fitted to
 * the ModelFest data. Mean optics: A. B. Watson, J. Vision 13(6):18 (2013). Their
 * quotient is the neural filter: Watson and Ahumada, J. Vision 8(4):17 (2008). */
#include "simulate/acuity/neural.h"

#include <math.h>

static const double wavelength_mm = 555e-6;

/* The pupil that a display of 30 cd/m² and some 80 deg², as of ModelFest, leaves to a young
 * observer: 5.2 mm with both eyes to 6.4 mm with one, by A. B. Watson and J. I. Yellott, J. Vision
 * 12(10):12 (2012); the mean transfer function is known up to 6 mm. */
static const double modelfest_pupil_mm = 6;

/* Beyond it the quotient is one of two numbers that are both next to nothing. */
static const double highest_cpd = 70;

static double sech(double x) {
  return 1 / cosh(x);
}

double placido_contrast_sensitivity(double cpd) {
  return 373.08 * (sech(pow(cpd / 4.1726, 0.7786)) - 0.8493 * sech(cpd / 1.3625));
}

double placido_diffraction_mtf(double cpd, double pupil_mm) {
  double cut_off = pupil_mm / wavelength_mm * M_PI / 180;
  double share = cpd / cut_off;
  return share >= 1 ? 0 : 2 / M_PI * (acos(share) - share * sqrt(1 - share * share));
}

double placido_mean_mtf(double cpd, double pupil_mm) {
  double u1 = 21.95 - 5.512 * pupil_mm + 0.3922 * pupil_mm * pupil_mm;
  double scaled = cpd / u1;
  return pow(1 + scaled * scaled, -0.62) * sqrt(placido_diffraction_mtf(cpd, pupil_mm));
}

double placido_neural_filter(double cpd) {
  if (cpd >= highest_cpd) {
    return 0;
  }
  return placido_contrast_sensitivity(cpd) / placido_mean_mtf(cpd, modelfest_pupil_mm);
}
