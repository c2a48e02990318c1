/* Where the light of a pupil's rays arrives, run by run: places in buckets, and the parallelogram
 * that each ray's cell of the pupil becomes there. */
#ifndef PLACIDO_SIMULATE_PSF_FOOTPRINT_H
#define PLACIDO_SIMULATE_PSF_FOOTPRINT_H

#include "simulate/psf/tally.h"
#include "simulate/rays/tracer.h"

#include <stdbool.h>

/* The retina's buckets. */
typedef struct placido_raster {
  int n;
  double bucket_mm, centre_x_mm, centre_y_mm;
} placido_raster;

/* Rays that did not arrive, and light that did, in whole units. */
typedef struct placido_arrivals {
  long entered, landed, missed, grazed, reflected;
  int64_t light;
} placido_arrivals;

/* How light is counted: `unit` whole units for all of the pupil where it is spread, one for each
 * ray where it is counted. */
typedef struct placido_light_count {
  const placido_tracer *tracer;
  placido_raster raster;
  bool spread;
  double unit;
} placido_light_count;

/* Counts share number `share` of `shares` of the pupil's rays. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_footprint_count(placido_tally *tally, placido_arrivals *arrivals,
                            const placido_light_count *how, int share, int shares,
                            placido_error *err);

#endif
