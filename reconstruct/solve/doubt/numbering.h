/* The numbers of the mires, verified: whether they agree among neighbours, and with the surface. */
#ifndef PLACIDO_SOLVE_NUMBERING_H
#define PLACIDO_SOLVE_NUMBERING_H

#include "reconstruct/solve/engine/shape.h"

/* Samples are ordered by edge, then meridian, in all of these. */

/* Takes out of use what neighbours contradict: groups of points at whose borders an edge jumps by
 * about a mire from one meridian to the next, all but the largest group. `doubtful` receives how
 * many. Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_numbering_doubt(placido_sample *samples, size_t count, const placido_mires *mires,
                            size_t *doubtful, placido_error *err);

/* Gives points that the surface refuses under their own number, and takes under that of another
 * edge of the same polarity, that number. `limit_px` is how far a point may lie from its edge. The
 * samples, traced and told, are out of date where `changed` is not 0. Returns PLACIDO_OK or
 * PLACIDO_MEMORY. */
int placido_numbering_settle(placido_mires *mires, const placido_sample *samples, size_t count,
                             const placido_instrument *instrument, double limit_px, size_t *changed,
                             placido_error *err);

/* Adds `shift` to all numbers; points whose edge there is none of go. */
void placido_numbering_shift(placido_mires *mires, int shift);

/* The same of a copy of every stride-th meridian. Free with placido_mires_free. Returns PLACIDO_OK
 * or PLACIDO_MEMORY. */
int placido_numbering_shifted(placido_mires *copy, const placido_mires *mires, int shift,
                              int stride, placido_error *err);

#endif
