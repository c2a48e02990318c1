/* Differences and autocorrelation of the residuals along the mires. */
#include "reconstruct/solve/noise.h"

#include "reconstruct/median.h"

#include <math.h>

#define LAG_MAX 30

/* Whether sample j lies `lag` meridians after sample i on the same edge, both of use. */
static bool neighbours(const placido_sample *samples, size_t i, size_t j, int lag,
                       const placido_mires *mires) {
  const placido_sample *a = &samples[i], *b = &samples[j];
  if (a->edge != b->edge || !a->used || !b->used || isnan(a->residual_px) ||
      isnan(b->residual_px)) {
    return false;
  }
  double step = (mires->points[b->point].meridian_deg - mires->points[a->point].meridian_deg) *
                mires->meridian_count / 360;
  return lrint(step) == lag;
}

double placido_noise_rough(const placido_sample *samples, size_t count,
                           const placido_mires *mires, int stride, double *work) {
  size_t n = 0;
  for (size_t i = 0; i + 1 < count; i++) {
    if (neighbours(samples, i, i + 1, stride, mires)) {
      work[n++] = fabs(samples[i + 1].residual_px - samples[i].residual_px);
    }
  }
  return 1.4826 * placido_quantile(work, n, 0.5) / M_SQRT2;
}

double placido_noise_inflation(const placido_sample *samples, const double *residual_px,
                               size_t count, const placido_mires *mires) {
  double variance = 0;
  size_t used = 0;
  for (size_t i = 0; i < count; i++) {
    if (samples[i].used && !isnan(samples[i].residual_px)) {
      variance += residual_px[i] * residual_px[i];
      used++;
    }
  }
  double factor = 1;
  for (int lag = 1; lag <= LAG_MAX && variance > 0; lag++) {
    double sum = 0;
    size_t pairs = 0;
    for (size_t i = 0; i < count; i++) {
      for (size_t j = i + 1; j <= i + (size_t)lag && j < count; j++) {
        if (neighbours(samples, i, j, lag, mires)) {
          sum += residual_px[i] * residual_px[j];
          pairs++;
          break;
        }
      }
    }
    double correlation = pairs ? sum / (double)pairs / (variance / (double)used) : 0;
    if (correlation < 0.03) {
      break; /* what follows is noise of the estimate itself */
    }
    factor += 2 * correlation;
  }
  return factor;
}
