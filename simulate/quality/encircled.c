/* Where the light of a PSF is: moments, and the share within a circle. */
#include <placido/quality.h>

#include "simulate/quality/disc.h"

#include <math.h>

enum { HALVINGS = 40 };

/* Angles of a bucket's middle. */
static double right_arcmin(const placido_psf *psf, int column) {
  return (column - psf->n / 2) * psf->bucket_arcmin;
}

static double up_arcmin(const placido_psf *psf, int row) {
  return (psf->n / 2 - row) * psf->bucket_arcmin;
}

placido_moments placido_psf_moments(const placido_psf *psf) {
  double s[6] = {0};
  for (int row = 0; row < psf->n; row++) {
    double y = up_arcmin(psf, row);
    for (int column = 0; column < psf->n; column++) {
      double x = right_arcmin(psf, column);
      double value = psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
      s[0] += value;
      s[1] += value * x;
      s[2] += value * y;
      s[3] += value * x * x;
      s[4] += value * x * y;
      s[5] += value * y * y;
    }
  }
  double x = s[1] / s[0], y = s[2] / s[0];
  placido_moments m = {.sum = s[0], .x = x, .y = y};
  m.xx = s[3] / s[0] - x * x;
  m.xy = s[4] / s[0] - x * y;
  m.yy = s[5] / s[0] - y * y;
  m.rms = sqrt(fmax(m.xx + m.yy, 0));
  if (!(s[0] > 0)) {
    m.x = m.y = m.xx = m.xy = m.yy = m.rms = NAN;
  }
  return m;
}

/* Light within a circle; the square whose corners a circle passes by is all in or all out. */
static double light_within(const placido_psf *psf, double x, double y, double radius) {
  double half = 0.5 * psf->bucket_arcmin, corner = sqrt(2) * half, sum = 0;
  for (int row = 0; row < psf->n; row++) {
    double up = up_arcmin(psf, row) - y;
    for (int column = 0; column < psf->n; column++) {
      double right = right_arcmin(psf, column) - x;
      double value = psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
      double square = right * right + up * up, far = radius + corner, near = radius - corner;
      if (square >= far * far || value == 0) {
        continue;
      }
      bool inside = near > 0 && square <= near * near;
      sum += inside ? value
                    : value *
                        placido_disc_area(radius, right - half, right + half, up - half,
                                          up + half) /
                        (psf->bucket_arcmin * psf->bucket_arcmin);
    }
  }
  return sum;
}

double placido_encircled_share(const placido_psf *psf, double x_arcmin, double y_arcmin,
                               double radius_arcmin) {
  return light_within(psf, x_arcmin, y_arcmin, radius_arcmin) / placido_psf_moments(psf).sum;
}

double placido_encircled_radius(const placido_psf *psf, double share) {
  placido_moments m = placido_psf_moments(psf);
  if (!(m.sum > 0)) {
    return NAN;
  }
  double low = 0, high = 2 * psf->n * psf->bucket_arcmin;
  for (int i = 0; i < HALVINGS; i++) {
    double radius = 0.5 * (low + high);
    if (light_within(psf, m.x, m.y, radius) < share * m.sum) {
      low = radius;
    } else {
      high = radius;
    }
  }
  return 0.5 * (low + high);
}
