/* Numbers confirmed once the places are measured. */
#ifndef PLACIDO_MIRES_CONFIRM_H
#define PLACIDO_MIRES_CONFIRM_H

#include "reconstruct/mires/edges.h"

/* Takes the number from measured crossings that lie further from where the sure ones around them
 * say than is usual on their edge: the border of a lash along a mire. `ordinary_px` as in
 * placido_crossings_settle. */
int placido_crossings_confirm(placido_crossings *crossings, int edge_count,
                              const double *ordinary_px, placido_error *err);

#endif
