/* Selection by partition about a pivot near the wanted element (Floyd and Rivest, Commun. ACM
 * 18:165, 1975), without branches that a processor would have to guess. */
#include "reconstruct/median.h"

#include <math.h>

#define FEW 12
#define MANY 500
#define SAMPLE_FEW 5 /* elements that the pivot is taken from */
#define SAMPLE_MANY 31

static void sort(double *values, ptrdiff_t count) {
  for (ptrdiff_t i = 1; i < count; i++) {
    double value = values[i];
    ptrdiff_t j = i;
    for (; j > 0 && values[j - 1] > value; j--) {
      values[j] = values[j - 1];
    }
    values[j] = value;
  }
}

/* An element that should lie near the wanted one. */
static double pivot_of(const double *values, ptrdiff_t count, ptrdiff_t wanted) {
  double some[SAMPLE_MANY];
  const ptrdiff_t sample = count < MANY ? SAMPLE_FEW : SAMPLE_MANY;
  for (ptrdiff_t i = 0; i < sample; i++) {
    some[i] = values[i * (count - 1) / (sample - 1)];
  }
  sort(some, sample);
  return some[(wanted * (sample - 1) + (count - 1) / 2) / (count - 1)];
}

/* Brings what is less than the pivot to the front; returns how many that are. With `equal` what
 * equals it comes along. */
static ptrdiff_t partition(double *values, ptrdiff_t count, double pivot, int equal) {
  ptrdiff_t front = 0;
  for (ptrdiff_t i = 0; i < count; i++) {
    double value = values[i];
    values[i] = values[front];
    values[front] = value;
    front += equal ? value <= pivot : value < pivot;
  }
  return front;
}

double placido_quantile(double *values, size_t count, double share) {
  if (!count) {
    return NAN;
  }
  ptrdiff_t left = (ptrdiff_t)count, wanted = (ptrdiff_t)(share * (double)(count - 1));
  while (left > FEW) {
    double pivot = pivot_of(values, left, wanted);
    ptrdiff_t less = partition(values, left, pivot, 0);
    if (wanted < less) {
      left = less;
      continue;
    }
    values += less;
    wanted -= less;
    left -= less;
    ptrdiff_t equal = partition(values, left, pivot, 1);
    if (wanted < equal || equal == 0) { /* none at all: the pivot is no number */
      return pivot;
    }
    values += equal;
    wanted -= equal;
    left -= equal;
  }
  sort(values, left);
  return values[wanted];
}
