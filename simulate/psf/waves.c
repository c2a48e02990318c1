/* White light in wavelengths: what the eye's power and its sensitivity do over the spectrum.
 *
 * Refraction of the chromatic eye: Thibos, Ye, Zhang and Bradley, Applied Optics 31, 3594 (1992),
 * 1.68524 - 633.46 / (wavelength_nm - 214.102) dioptres. */
#include <placido/diffraction.h>

#include "simulate/spectrum/spectrum.h"

#include <math.h>

double placido_chromatic_defocus(double wavelength_nm, double focus_nm) {
  return 633.46 / (wavelength_nm - 214.102) - 633.46 / (focus_nm - 214.102);
}

int placido_waves_white(placido_wave *waves, size_t count, double first_nm, double last_nm,
                        double focus_nm, placido_error *err) {
  const double least_nm = 300, most_nm = 1200;
  if (count == 0 || !(first_nm >= least_nm && first_nm <= last_nm && last_nm <= most_nm) ||
      !(focus_nm >= least_nm && focus_nm <= most_nm)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%zu wavelengths from %g to %g nm with %g nm in focus, expected 1 or "
                             "more between %g and %g",
                             count, first_nm, last_nm, focus_nm, least_nm, most_nm);
  }
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    double share = count > 1 ? (double)i / (double)(count - 1) : 0.5;
    double wavelength_nm = first_nm + share * (last_nm - first_nm);
    waves[i] = (placido_wave){
      .wavelength_nm = wavelength_nm,
      .weight = placido_luminous_efficiency(wavelength_nm),
      .defocus_D = placido_chromatic_defocus(wavelength_nm, focus_nm)};
    sum += waves[i].weight;
  }
  for (size_t i = 0; i < count; i++) {
    waves[i].weight /= sum;
  }
  return PLACIDO_OK;
}
