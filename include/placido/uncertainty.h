/* How well the topographer's geometry is known: its covariance, as a calibration leaves it.
 * Keys `sigma` and `covariance` of `placido-instrument/1` (docs/formats.md). */
#ifndef PLACIDO_UNCERTAINTY_H
#define PLACIDO_UNCERTAINTY_H

#include <placido/instrument.h>

/* The parameters, each in its own unit, in this order:
 *   0, 1    focal_px        4 .. 8   distortion
 *   2, 3    principal_px    9 .. 11  position_mm
 *   12 + k                  radius_mm of edge k
 *   12 + edge_count + k     z_mm of edge k */
#define PLACIDO_UNCERTAINTY_CAMERA 12

/* A calibration writes at most so many modes: those that move the mires in the picture of an
 * ordinary cornea most, so that what is left out cannot be seen. */
#define PLACIDO_UNCERTAINTY_MODES 32

/* The covariance of the parameters is the sum over the modes of f·fᵀ: the geometry moves along each
 * mode by an independent, standard normal amount. */
typedef struct placido_uncertainty {
  int edge_count, parameter_count;
  int mode_count; /* 0: nothing is known of it */
  double *factor; /* mode m's column f: parameter_count numbers from m * parameter_count, strongest
                     mode first */
  double *sigma;  /* parameter_count standard deviations, all causes together; NULL: not known */
} placido_uncertainty;

/* Room for `mode_count` modes of an instrument with `edge_count` edges, all zero. Free with
 * placido_uncertainty_free. Returns PLACIDO_OK, PLACIDO_MEMORY. */
int placido_uncertainty_new(placido_uncertainty *uncertainty, int edge_count, int mode_count,
                            placido_error *err);

/* Reads both keys of an instrument file. Neither: no modes, PLACIDO_OK. Without `covariance` every
 * standard deviation that is not 0 is a mode of its own (then there may be more than
 * PLACIDO_UNCERTAINTY_MODES of them). Free with placido_uncertainty_free. Returns PLACIDO_OK,
 * PLACIDO_SYSTEM, PLACIDO_INPUT (file, line and field named), PLACIDO_MEMORY. */
int placido_uncertainty_load(placido_uncertainty *uncertainty, const char *path,
                             placido_error *err);

/* Writes an instrument file with both keys, by way of a temporary name; as placido_instrument_save
 * where nothing is known. The edge counts must agree. Returns PLACIDO_OK, PLACIDO_SYSTEM,
 * PLACIDO_MEMORY. */
int placido_uncertainty_save(const placido_uncertainty *uncertainty,
                             const placido_instrument *instrument, const char *path,
                             placido_error *err);

/* The instrument moved by `amount` standard deviations along mode `mode`, 0 to mode_count - 1.
 * `out` may be `instrument`; the edge counts must agree. */
void placido_uncertainty_apply(placido_instrument *out, const placido_instrument *instrument,
                               const placido_uncertainty *uncertainty, int mode, double amount);

/* Parameter `parameter` of an instrument, to read or to write. Borrowed from the instrument. */
double *placido_instrument_parameter(placido_instrument *instrument, int parameter);

/* Frees the numbers and zeroes the struct. */
void placido_uncertainty_free(placido_uncertainty *uncertainty);

#endif
