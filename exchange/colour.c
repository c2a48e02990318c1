/* A ramp of five colours, evenly spaced in dioptres and mixed between. */
#include "exchange/colour.h"

#include <math.h>

#define COOL_D 30.0
#define WARM_D 60.0

void placido_power_colour(double colour[3], double power_D) {
  static const double ramp[5][3] = {{0.08, 0.16, 0.78},
                                    {0, 0.67, 0.86},
                                    {0.16, 0.67, 0.24},
                                    {0.94, 0.82, 0.12},
                                    {0.82, 0.12, 0.12}};
  double at = fmin(fmax((power_D - COOL_D) / (WARM_D - COOL_D), 0), 1) * 4;
  int below = at < 3 ? (int)at : 3;
  for (int k = 0; k < 3; k++) {
    double mixed = ramp[below][k] + (at - below) * (ramp[below + 1][k] - ramp[below][k]);
    colour[k] = isnan(power_D) ? 0.63 : mixed;
  }
}
