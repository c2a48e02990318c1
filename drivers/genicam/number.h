/* A number of a camera: whole (64 bits) or real. */
#ifndef PLACIDO_DRIVERS_GENICAM_NUMBER_H
#define PLACIDO_DRIVERS_GENICAM_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* `real` is always there; `whole` counts where `is_whole`. */
struct number {
  bool is_whole;
  int64_t whole;
  double real;
};

struct number placido_genicam_whole(int64_t value);
struct number placido_genicam_real(double value);

/* The nearest whole number; false where it does not fit into 64 bits, or is NaN. */
bool placido_genicam_round(const struct number *number, int64_t *value);

/* Reads all of `text`: decimal or 0x..., with a sign or a fraction, "true" or "false". Whole
 * numbers from 2^63 to 2^64-1 wrap around in `whole`, but not in `real`. */
bool placido_genicam_number_read(struct number *number, const char *text);

#endif
