/* Error bar of a circle about the axis. */
#include "reconstruct/indices/cornea.h"
#include "reconstruct/maps/sigma.h"

#include <math.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define RING_STEP_DEG 5

double placido_ring_sigma(const placido_surface *surface, const placido_fit *fit, double r_mm) {
  double sum = 0;
  int count = 0;
  for (int angle = 0; angle < 360; angle += RING_STEP_DEG) {
    double x = r_mm * cos(angle * DEGREE), y = r_mm * sin(angle * DEGREE), sigma_z, sigma;
    if (placido_surface_covered(surface, x, y)) {
      placido_sigma_at(fit, x, y, &sigma_z, &sigma);
      sum += sigma;
      count++;
    }
  }
  return count > 0 ? sum / count : NAN;
}
