/* Broken tear film: patches of the cornea whose thin film is rippled, so that the mires get wavy.
 */
#ifndef PLACIDO_PHANTOM_FILM_H
#define PLACIDO_PHANTOM_FILM_H

#include <stdint.h>

#define PLACIDO_PHANTOM_PATCHES 400

/* A round patch with two crossed ripples that fade towards its rim. */
typedef struct placido_phantom_patch {
  double x_mm, y_mm, radius_mm;
  double wave[2][3]; /* radians per mm along x and y, and phase */
} placido_phantom_patch;

/* A value without heap. */
typedef struct placido_phantom_film {
  int count;
  placido_phantom_patch patches[PLACIDO_PHANTOM_PATCHES];
} placido_phantom_film;

/* Breaks the film over the share `broken` of the disc of radius_mm. */
void placido_phantom_film_break(placido_phantom_film *film, double broken, double radius_mm,
                                uint64_t seed);

/* Adds the film's part of the sag's slopes at (x, y), in the eye's own coordinates. */
void placido_phantom_film_add(const placido_phantom_film *film, double x_mm, double y_mm,
                              double slope[2]);

#endif
