/* Luminous efficiency of the light-adapted eye, as two lobes with unlike flanks: C. Wyman,
 * P.-P. Sloan, P. Shirley, J. Computer Graphics Techniques 2 (2), 1 (2013), table 1. */
#include "simulate/spectrum/spectrum.h"

#include <math.h>

static double lobe(double height, double peak_nm, double below_per_nm, double above_per_nm,
                   double wavelength_nm) {
  double from_peak_nm = wavelength_nm - peak_nm;
  double steps = from_peak_nm * (from_peak_nm < 0 ? below_per_nm : above_per_nm);
  return height * exp(-0.5 * steps * steps);
}

double placido_luminous_efficiency(double wavelength_nm) {
  return lobe(0.821, 568.8, 0.0213, 0.0247, wavelength_nm) +
         lobe(0.286, 530.9, 0.0613, 0.0322, wavelength_nm);
}
