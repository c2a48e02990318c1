/* Eyes drawn by number, as statistics of corneas have them: for tests that must hold for any eye. */
#ifndef PLACIDO_TESTS_SIMULATE_RANDOM_EYES_H
#define PLACIDO_TESTS_SIMULATE_RANDOM_EYES_H

#include <placido/simulate.h>

/* Normal, astigmatic, high-order, post-PRK, keratoconic and decentred corneas in turn, pupils of 2
 * to 8 mm. `turn_deg` turns surface and pupil towards +y; `mirrored` exchanges left and right
 * first. Free with placido_surface_free. */
placido_surface *random_eye(placido_eye *eye, int number, double turn_deg, bool mirrored);

const char *random_eye_kind(int number);

#endif
