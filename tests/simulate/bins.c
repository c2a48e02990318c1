/* Sums over squares of pixels, and how much of them lies elsewhere. */
#include "bins.h"

#include <math.h>

void bin_up(double *binned, const double *seen, int side, int bin) {
  const int bins = side / bin;
  for (int i = 0; i < bins * bins; i++) {
    binned[i] = 0;
  }
  for (int i = 0; i < side * side; i++) {
    binned[i / side / bin * bins + i % side / bin] += seen[i];
  }
}

double misplaced(const double *one, const double *other, int bins) {
  double apart = 0, all = 0;
  for (int i = 0; i < bins; i++) {
    apart += fabs(one[i] - other[i]) / 2;
    all += other[i];
  }
  return apart / all;
}
