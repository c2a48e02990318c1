/* A harmonic fitted to the sectors by least squares, whichever of them are missing. */
#include "acquire/guide/wave.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Solves a symmetric 3 × 3 system given by its lower triangle; false where it is singular. */
static bool solve3(double a[3][3], double b[3]) {
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < i; j++) {
      a[j][i] = a[i][j];
    }
  }
  for (int i = 0; i < 3; i++) {
    if (!(fabs(a[i][i]) > 1e-9)) {
      return false;
    }
    for (int j = i + 1; j < 3; j++) {
      const double factor = a[j][i] / a[i][i];
      for (int k = i; k < 3; k++) {
        a[j][k] -= factor * a[i][k];
      }
      b[j] -= factor * b[i];
    }
  }
  for (int i = 2; i >= 0; i--) {
    for (int k = i + 1; k < 3; k++) {
      b[i] -= a[i][k] * b[k];
    }
    b[i] /= a[i][i];
  }
  return true;
}

bool placido_guide_wave_fit(double wave[3], int times,
                            const double values[PLACIDO_GUIDE_SECTORS]) {
  double normal[3][3] = {{0}};
  wave[0] = wave[1] = wave[2] = 0;
  for (int s = 0; s < PLACIDO_GUIDE_SECTORS; s++) {
    if (isnan(values[s])) {
      continue;
    }
    const double angle = 2 * PI * times * s / PLACIDO_GUIDE_SECTORS;
    const double row[3] = {1, cos(angle), sin(angle)};
    for (int i = 0; i < 3; i++) {
      for (int j = 0; j <= i; j++) {
        normal[i][j] += row[i] * row[j];
      }
      wave[i] += row[i] * values[s];
    }
  }
  return solve3(normal, wave);
}
