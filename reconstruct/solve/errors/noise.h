/* What the residuals say of the edge points' noise. Samples are ordered by edge, then meridian. */
#ifndef PLACIDO_SOLVE_NOISE_H
#define PLACIDO_SOLVE_NOISE_H

#include "reconstruct/solve/engine/shape.h"

/* Standard deviation of the part of the residuals that changes over `stride` meridians, the
 * distance of neighbouring samples: from their differences (von Neumann 1941), robust. A spread
 * well above it means that the surface cannot follow the mires. `work` holds `count` numbers. */
double placido_noise_rough(const placido_sample *samples, size_t count, const placido_mires *mires,
                           int stride, double *work);

/* Factor by which the variance of a smooth surface grows because neighbouring residuals of an
 * edge resemble each other: 1 + 2 Σ autocorrelation, at least 1. `residual_px` are the samples'
 * residuals, or a part of them. */
double placido_noise_inflation(const placido_sample *samples, const double *residual_px,
                               size_t count, const placido_mires *mires);

/* Sets every sample's `noise` from how unlike the residuals of neighbouring edges are about it, so
 * that what the surface cannot follow counts little: from half to eight times what is usual. Where
 * meridians lie closer together than `kin_px`, the distance along an edge over which errors are
 * found to be alike, it is larger by `shared`. Half of the samples have at least 1. The samples'
 * residuals are out of date then. */
int placido_noise_find(placido_sample *samples, double *kin_px, size_t count,
                       const placido_mires *mires, placido_error *err);

#endif
