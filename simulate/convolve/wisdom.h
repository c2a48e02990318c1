/* Plans that were measured for this machine, kept in a file. */
#ifndef PLACIDO_SIMULATE_CONVOLVE_WISDOM_H
#define PLACIDO_SIMULATE_CONVOLVE_WISDOM_H

#include "simulate/convolve/tile.h"

#include <placido/notes.h>
#include <placido/status.h>

/* Makes the plans of plans->shape with what `folder` knows, measures what it does not know, and
 * puts that into the folder, which is made where it is missing. FFTW's wisdom is the whole
 * process's: it is set aside meanwhile and put back, so that nobody else's plans change. Trouble
 * with the folder is a note and no failure. `folder` NULL: estimated plans. Locks FFTW's planner.
 * Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_plans_new(placido_plans *plans, const placido_shape *shape,
                      const placido_precision *precision, const placido_workspace *work,
                      const char *folder, placido_notes *notes, placido_error *err);
void placido_plans_free(placido_plans *plans, const placido_precision *precision);

#endif
