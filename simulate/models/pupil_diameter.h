/* The pupil that an eye has in a light: the unified formula of Watson and Yellott. */
#ifndef PLACIDO_SIMULATE_PUPIL_DIAMETER_H
#define PLACIDO_SIMULATE_PUPIL_DIAMETER_H

#include <stdbool.h>

/* The ages of the people whose pupils the formula is of. */
#define PLACIDO_PUPIL_YOUNGEST_YEARS 20
#define PLACIDO_PUPIL_OLDEST_YEARS 83

/* Diameter of the entrance pupil, 1.9 to 8.3 mm, of an eye that has adapted to a field of
 * `luminance_cd_m2` (0 or more) and `area_deg2` square degrees, seen with one eye or with both.
 * Outside of the formula's ages it is that of the nearest. Source: A. B. Watson, J. I. Yellott,
 * Journal of Vision 12(10):12 (2012), the unified formula. */
double placido_pupil_diameter_mm(double luminance_cd_m2, double area_deg2, bool both_eyes,
                                 double age_years);

#endif
