/* What goes around the mires once or twice: decentration, direction of motion. */
#ifndef PLACIDO_GUIDE_WAVE_H
#define PLACIDO_GUIDE_WAVE_H

#include <stdbool.h>

#define PLACIDO_GUIDE_SECTORS 16

/* Least squares of wave[0] + wave[1] cos(times θ) + wave[2] sin(times θ) to a value in the middle
 * of every sector, NaN: none. False where they do not determine it. */
bool placido_guide_wave_fit(double wave[3], int times, const double values[PLACIDO_GUIDE_SECTORS]);

#endif
