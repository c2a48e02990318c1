/* The spoilt instrument and the balls of the calibration tests. */
#include "tests/calibrate/balls.h"

#include <math.h>
#include <stdlib.h>

/* Marsaglia's xorshift (2003). */
static double chance_share(chance *c) {
  c->state ^= c->state << 13;
  c->state ^= c->state >> 7;
  c->state ^= c->state << 17;
  return (double)(c->state >> 11) / 9007199254740992.0;
}

double chance_even(chance *c) {
  return 2 * chance_share(c) - 1;
}

double chance_normal(chance *c) {
  double radius = sqrt(-2 * log(chance_share(c) + 1e-300));
  return radius * cos(6.28318530717958648 * chance_share(c));
}

placido_instrument balls_spoil(const placido_instrument *nominal, chance *c) {
  placido_instrument truth = *nominal;
  double corner = 0.5 * hypot(truth.width_px, truth.height_px) / truth.focal_px[0];
  truth.distortion[0] = 1.5 / (truth.focal_px[0] * pow(corner, 3)) * chance_even(c);
  truth.distortion[1] = 1.0 / (truth.focal_px[0] * pow(corner, 5)) * chance_even(c);
  for (int k = 0; k < truth.edge_count; k++) {
    truth.edges[k].radius_mm += 0.2 * chance_even(c);
    truth.edges[k].z_mm += 0.2 * chance_even(c);
  }
  double focal = chance_even(c) < 0 ? 0.99 : 1.01;
  for (int i = 0; i < 2; i++) {
    truth.focal_px[i] *= focal;
    truth.principal_px[i] += 5 * chance_even(c);
    truth.position_mm[i] += 0.1 * chance_even(c);
  }
  truth.position_mm[2] += 0.5 * chance_even(c);
  return truth;
}

placido_surface *balls_new(double radius_mm, double x_mm, double y_mm, double z_mm) {
  placido_part part = {.kind = PLACIDO_PART_BICONIC,
                       .as.biconic = {radius_mm, 0, radius_mm, 0, 0, x_mm, y_mm}};
  placido_surface *surface;
  if (placido_surface_new(&surface, z_mm, fmin(0.9 * radius_mm, 7), &part, 1, NULL, NULL)) {
    abort();
  }
  return surface;
}
