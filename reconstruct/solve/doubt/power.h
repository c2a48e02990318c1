/* Whether a surface can be a cornea. */
#ifndef PLACIDO_SOLVE_POWER_H
#define PLACIDO_SOLVE_POWER_H

#include <placido/surface.h>

/* PLACIDO_QUALITY where the surface's usual power is none of a cornea's. A surface that follows the
 * mires and is no cornea comes of a wrong distance, instrument or numbering. */
int placido_power_check(const placido_surface *surface, placido_error *err);

#endif
