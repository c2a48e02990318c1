/* How near an eye can focus: Hofstetter's mean amplitude (Am. J. Optom. 27 (1950)). */
#include "simulate/models/accommodation.h"

#include <placido/eye.h>

#include <math.h>

double placido_accommodation_amplitude_D(double age_years) {
  return fmax(18.5 - 0.3 * (age_years > 0 ? age_years : PLACIDO_EYE_AGE_YEARS), 0);
}

double placido_accommodation_response_D(double focus_D, double age_years) {
  return fmin(fmax(focus_D, 0), placido_accommodation_amplitude_D(age_years));
}
