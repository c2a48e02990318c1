/* Hoare's selection (Commun. ACM 4:321, 1961). */
#include "reconstruct/median.h"

#include <math.h>

double placido_quantile(double *values, size_t count, double share) {
  if (!count) {
    return NAN;
  }
  size_t wanted = (size_t)(share * (double)(count - 1));
  ptrdiff_t low = 0, high = (ptrdiff_t)count - 1, k = (ptrdiff_t)wanted;
  while (low < high) {
    double pivot = values[k];
    ptrdiff_t i = low, j = high;
    while (i <= j) {
      while (values[i] < pivot) {
        i++;
      }
      while (pivot < values[j]) {
        j--;
      }
      if (i <= j) {
        double swap = values[i];
        values[i++] = values[j];
        values[j--] = swap;
      }
    }
    low = j < k ? i : low;
    high = k < i ? j : high;
  }
  return values[wanted];
}
