/* The phantom tests' edge finder. */
#include "tests/phantom/locate.h"

#include <math.h>
#include <stdlib.h>

static double grey_of(const placido_frame *frame, int u, int v) {
  u = u < 0 ? 0 : u >= frame->width_px ? frame->width_px - 1 : u;
  v = v < 0 ? 0 : v >= frame->height_px ? frame->height_px - 1 : v;
  const uint8_t *row = frame->data + (size_t)v * frame->stride_bytes;
  if (frame->format == PLACIDO_MONO8) {
    return row[u];
  }
  return ((const uint16_t *)(const void *)row)[u] * 255.0 / ((1 << frame->bits) - 1);
}

double grey_between(const placido_frame *frame, double u_px, double v_px) {
  int u = (int)floor(u_px), v = (int)floor(v_px);
  double fu = u_px - u, fv = v_px - v;
  double above = (1 - fu) * grey_of(frame, u, v) + fu * grey_of(frame, u + 1, v);
  double below = (1 - fu) * grey_of(frame, u, v + 1) + fu * grey_of(frame, u + 1, v + 1);
  return (1 - fv) * above + fv * below;
}

double locate_step(const placido_frame *frame, const double place[2], const double along[2],
                   double half_width_px, double rising, double *height) {
  const int steps = 48;
  double sum = 0, moment = 0, last = 0;
  for (int i = 0; i <= steps; i++) {
    double away = half_width_px * (2.0 * i / steps - 1);
    double grey = grey_between(frame, place[0] + away * along[0], place[1] + away * along[1]);
    if (i > 0) {
      double rise = rising * (grey - last);
      sum += rise;
      moment += rise * (away - half_width_px / steps);
    }
    last = grey;
  }
  *height = sum;
  return moment / sum;
}

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

double median_of(double *values, int count) {
  qsort(values, (size_t)count, sizeof *values, compare);
  return count > 0 ? values[count / 2] : NAN;
}
