/* Light counted in square buckets, in whole units: adding them up gives the same sum in any order,
 * so that results do not depend on the number of threads. */
#ifndef PLACIDO_SIMULATE_PSF_TALLY_H
#define PLACIDO_SIMULATE_PSF_TALLY_H

#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

/* All light, 2^50: sums in doubles are exact, too. */
#define PLACIDO_TALLY_UNIT 1125899906842624.0

/* Places are counted in buckets from the corner of the first one. */
typedef struct placido_tally {
  int n;             /* buckets a side, odd */
  int rings;         /* of buckets about the middle one, (n + 1) / 2 at least */
  int64_t *buckets;  /* n * n, rows outer */
  int64_t *outside;  /* light beside the buckets, by ring; the last also has what is beyond it */
} placido_tally;

/* Free with placido_tally_free. PLACIDO_OK or PLACIDO_MEMORY. */
int placido_tally_new(placido_tally *tally, int n, int rings, placido_error *err);
void placido_tally_free(placido_tally *tally);

/* Adds what another has counted, of the same size. */
void placido_tally_merge(placido_tally *tally, const placido_tally *other);

/* Where pieces of light arrive, and over what they are spread. `count` columns each. */
typedef struct placido_spots {
  size_t count;
  double *x, *y;             /* the middle, in buckets; NaN: nothing arrives */
  double *light;             /* whole units */
  double *ax, *ay, *bx, *by; /* sides of the parallelogram that a ray's cell becomes, in buckets */
  double *width, *height;    /* of the upright box with the same variances */
} placido_spots;

/* Adds each spot's light to the bucket that its middle is in. Returns how many are in one. */
long placido_tally_count(placido_tally *tally, const placido_spots *spots);

/* Fills width and height, then spreads each spot's light evenly over its box; of one that is larger
 * than a bucket, over the boxes of its parallelogram's pieces. Returns how many spots have their
 * middle in a bucket. */
long placido_tally_spread(placido_tally *tally, const placido_spots *spots);

#endif
