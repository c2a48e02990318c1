/* The image of a point by the rays of a pupil: a cell of the pupil sends its light where the slope
 * of the wavefront points. The geometric counterpart of placido_diffraction, of the same pupil and
 * waves, into the same window. */
#ifndef PLACIDO_SIMULATE_SLOPES_H
#define PLACIDO_SIMULATE_SLOPES_H

#include <placido/diffraction.h>

/* As placido_diffraction: buckets * buckets values that sum to the share of the light within the
 * window; window->samples and window->points are not looked at. `share` (may be NULL) receives that
 * sum. Cells that the rim crosses count by their area inside; the light of a cell is spread over
 * what it becomes in the window. The same bits for any number of threads. PLACIDO_OK,
 * PLACIDO_INPUT, PLACIDO_QUALITY (no light), PLACIDO_MEMORY. */
int placido_slopes(double *values, double *share, const placido_pupil *pupil,
                   const placido_wave *waves, size_t count, const placido_window *window,
                   placido_error *err);

#endif
