/* Blur and motion from the innermost mires. */
#ifndef PLACIDO_GUIDE_BLUR_H
#define PLACIDO_GUIDE_BLUR_H

#include "acquire/guide/walk.h"

/* Standard deviation of what blurs alike in every direction, and length of the straight motion
 * that blurs along one; NaN where they cannot be told. */
void placido_guide_blur(double *blur_px, double *motion_px, const placido_guide_polar *polar,
                        const placido_guide_pattern *pattern, const placido_guide_walk *walk);

#endif
