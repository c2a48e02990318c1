/* How near an eye can focus at its age. */
#ifndef PLACIDO_SIMULATE_ACCOMMODATION_H
#define PLACIDO_SIMULATE_ACCOMMODATION_H

/* The mean amplitude of accommodation at an age, dioptres: 18.5 - 0.3 age, 0 from 62 years on.
 * Source: H. W. Hofstetter, Am. J. Optom. 27 (1950). An age of 0 is PLACIDO_EYE_AGE_YEARS. */
double placido_accommodation_amplitude_D(double age_years);

/* By how much a settled eye, focused far away, accommodates to look at `focus_D` (1 / distance in
 * m): all of it, as far as its amplitude goes. */
double placido_accommodation_response_D(double focus_D, double age_years);

#endif
