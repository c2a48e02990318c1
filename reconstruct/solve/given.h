/* What a fit is given, held against what its header asks for. */
#ifndef PLACIDO_SOLVE_GIVEN_H
#define PLACIDO_SOLVE_GIVEN_H

#include <placido/reconstruct.h>

/* PLACIDO_INPUT, and a sentence that names the first thing that is not as it should be: a point
 * that is no place in the image, that has no noise or no edge, that is out of order or stands
 * twice; an instrument of no size that mires of a cornea come from; a distance that is none. */
int placido_given_check(const placido_mires *mires, const placido_instrument *instrument,
                        const placido_fit_options *options, placido_error *err);

#endif
