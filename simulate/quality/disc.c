/* Areas of a disc's parts, in closed form: a rectangle is the difference of four that have a corner
 * in the disc's centre, and such a one is bounded by an arc whose integral is elementary. */
#include "simulate/quality/disc.h"

#include <math.h>

static const double quarter_turn = 1.57079632679489661923;

/* Area within the disc of the rectangle from the centre to (x, y), negative where x or y is. */
static double corner_area(double radius, double x, double y) {
  double a = fmin(fabs(x), radius), b = fmin(fabs(y), radius), square = radius * radius;
  double sign = (x < 0) != (y < 0) ? -1 : 1;
  if (a * a + b * b <= square) {
    return sign * a * b;
  }
  double arc = asin(a / radius) + asin(b / radius) - quarter_turn;
  return sign * 0.5 * (a * sqrt(square - a * a) + b * sqrt(square - b * b) + square * arc);
}

double placido_disc_area(double radius, double x0, double x1, double y0, double y1) {
  return corner_area(radius, x1, y1) - corner_area(radius, x0, y1) - corner_area(radius, x1, y0) +
         corner_area(radius, x0, y0);
}
