/* What several frames say of the same places, and how far they agree. */
#ifndef PLACIDO_SOLVE_AGREEMENT_H
#define PLACIDO_SOLVE_AGREEMENT_H

#include <placido/combine.h>

/* One frame's edges as distances from a yardstick that all frames have in common. */
typedef struct placido_testimony {
  double *residual_px; /* by edge, then meridian; NaN: not seen */
  bool used;           /* set beforehand; false: it does not count */
  double spread_px;    /* of single points about the frames' middle */
  double bias_px;      /* of whole blocks, told as that of the points that would explain it */
  double weight;       /* its share in the means; of all frames 1 */
} placido_testimony;

typedef struct placido_agreement {
  size_t count; /* frames */
  int edge_count, meridian_count;
  size_t places; /* edges × meridians */
  placido_testimony frames[PLACIDO_COMBINE_MAX];
  double *middle_px; /* median over the frames of use, by place; NaN: too few have it */
  double *work;      /* `places` numbers, anybody's */
} placido_agreement;

/* Room for `count` frames, all of use and without a place seen. Free with placido_agreement_free,
 * after a failure too. */
int placido_agreement_new(placido_agreement *agreement, size_t count, int edge_count,
                          int meridian_count, placido_error *err);
void placido_agreement_free(placido_agreement *agreement);

/* Finds out which frames agree: takes those that do not out of use, and weights the others. */
void placido_agreement_find(placido_agreement *agreement);

/* The mean at a place of the frames of use, without strays, and its standard deviation: from the
 * scatter, but no less than the frames' own spreads give. Returns false where too few frames have
 * it. */
bool placido_agreement_mean(const placido_agreement *agreement, size_t place, double *mean_px,
                            double *sigma_px);

#endif
