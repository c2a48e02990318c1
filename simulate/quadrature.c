/* Quadrature over the unit disc: Gauss-Legendre in the squared radius, the trapezoidal rule in
 * angle. A Zernike term of order n is a polynomial of degree n / 2 in the squared radius times a
 * harmonic (or, m odd, its product with one of the same kind is), so their products come out exact.
 * Nodes by Newton's method on Legendre's recurrence: Press et al., Numerical Recipes, 4.6. */
#include "simulate/wavefront.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Node number `index` of `count` within (0, 1), and its weight; the weights sum to 1. */
static double legendre_node(int index, int count, double *weight) {
  double x = cos(pi * (index + 0.75) / (count + 0.5)), slope = 1;
  for (int step = 0; step < 100; step++) {
    double value = 1, before = 0;
    for (int k = 0; k < count; k++) {
      double next = ((2 * k + 1) * x * value - k * before) / (k + 1);
      before = value;
      value = next;
    }
    slope = count * (x * value - before) / (x * x - 1);
    double change = value / slope;
    x -= change;
    if (fabs(change) < 1e-15) {
      break;
    }
  }
  *weight = 1 / ((1 - x * x) * slope * slope);
  return 0.5 * (1 - x);
}

void placido_disc_quadrature(double *x, double *y, double *weight, int rings) {
  int spokes = 3 * rings, at = 0;
  for (int ring = 0; ring < rings; ring++) {
    double share, radius = sqrt(legendre_node(ring, rings, &share));
    for (int spoke = 0; spoke < spokes; spoke++, at++) {
      double angle = 2 * pi * spoke / spokes;
      x[at] = radius * cos(angle);
      y[at] = radius * sin(angle);
      weight[at] = share / spokes;
    }
  }
}
