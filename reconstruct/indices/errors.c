/* The error bar of an index: the squares of what the fit's variants change add up to its variance
 * (placido/reconstruct.h). */
#include "reconstruct/indices/errors.h"

#include <math.h>

void placido_index_fill_sigma(placido_index_value *value, const placido_fit *fit,
                              const double *changed, size_t stride, double period, double range) {
  double squares[PLACIDO_SIGMA_SOURCES] = {0}, sum = 0;
  int variants[PLACIDO_SIGMA_SOURCES] = {0};
  if (isnan(value->value)) {
    return;
  }
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    enum placido_sigma_source source = placido_fit_variant_source(fit, v);
    double change = changed[(size_t)v * stride] - value->value;
    change = period > 0 ? remainder(change, period) : change;
    squares[source] += change * change;
    variants[source]++;
  }
  for (int source = 0; source < PLACIDO_SIGMA_SOURCES; source++) {
    sum += squares[source];
    value->budget[source] = variants[source] > 0 ? sqrt(squares[source]) : NAN;
  }
  value->sigma = sqrt(sum);
  if (range > 0 && value->sigma > range / sqrt(12)) {
    value->sigma = range / sqrt(12);
  }
}
