/* Navarro's schematic eye behind the front of its cornea: surfaces, media, and what they do to
 * light near the axis. */
#ifndef PLACIDO_SIMULATE_NAVARRO_H
#define PLACIDO_SIMULATE_NAVARRO_H

#include "simulate/ocular/beam.h"

enum { PLACIDO_NAVARRO_SURFACES = 3 };

/* Back of the cornea, front and back of the lens; the index behind one is that before the next. */
typedef struct placido_navarro {
  placido_conic surfaces[PLACIDO_NAVARRO_SURFACES];
} placido_navarro;

/* The eye that accommodates by accommodation_D, 0 to 10, for light of wavelength_nm, 365 to 1014.
 * Source: R. Navarro, J. Santamaria, J. Bescos, JOSA A 2 (1985) 1273, tables 1 to 4. */
placido_navarro placido_navarro_at(double accommodation_D, double wavelength_nm);

/* Index of the cornea, and of the vitreous body. */
double placido_navarro_cornea(const placido_navarro *eye);
double placido_navarro_vitreous(const placido_navarro *eye);

/* Where light near the axis that has the vergence vergence_D (in the cornea) right behind the
 * cornea's front is focused: depth behind it, mm; beyond the back of the lens or virtual. */
double placido_navarro_focus_mm(const placido_navarro *eye, double vergence_D);

/* Where the cornea's front is seen from behind: depth of its image. */
double placido_navarro_cornea_image_mm(const placido_navarro *eye);

#endif
