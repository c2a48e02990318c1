#include "tests/simulate/aberrated.h"

#include "base/memory.h"
#include "simulate/quality/disc.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#define TERMS 15 /* up to the fourth order */

placido_psf dark(int n, double bucket_arcmin) {
  placido_psf psf = {.n = n, .bucket_arcmin = bucket_arcmin, .wavelength_nm = 555};
  psf.values = placido_memory_new((size_t)n * (size_t)n, sizeof *psf.values, NULL);
  assert_non_null(psf.values);
  return psf;
}

void put_spot(placido_psf *psf, double x_arcmin, double y_arcmin, double light) {
  int column = psf->n / 2 + (int)lround(x_arcmin / psf->bucket_arcmin);
  int row = psf->n / 2 - (int)lround(y_arcmin / psf->bucket_arcmin);
  psf->values[row * psf->n + column] += light;
}

placido_psf blur_disc(double radius_arcmin) {
  placido_psf psf = dark(257, 0.5);
  double r = radius_arcmin / psf.bucket_arcmin, middle = psf.n / 2.0;
  for (int y = 0; y < psf.n; y++) {
    for (int x = 0; x < psf.n; x++) {
      double left = x - middle, top = y - middle;
      psf.values[y * psf.n + x] =
        placido_disc_area(r, left, left + 1, top, top + 1) / (M_PI * r * r);
    }
  }
  return psf;
}

/* M = -4 sqrt(3) c20 / r², J0 = -2 sqrt(6) c22 / r² (Thibos et al. 2004); the sign does not matter
 * to an eye whose higher orders are as they are. */
placido_psf aberrated(double pupil_mm, const double *terms_um, int count, double m_D,
                      double j0_D) {
  double all[TERMS] = {0}, r2 = pupil_mm * pupil_mm / 4;
  placido_error err = {0};
  placido_pupil pupil;
  placido_psf psf = dark(257, 0.5);
  for (int i = 0; i < count; i++) {
    all[i] = terms_um[i];
  }
  all[4] += m_D * r2 / (4 * sqrt(3));
  all[5] += j0_D * r2 / (2 * sqrt(6));
  assert_int_equal(placido_pupil_of_terms(&pupil, pupil_mm, all, TERMS, 0, &err), PLACIDO_OK);
  const placido_wave wave = {.wavelength_nm = 555, .weight = 1};
  const placido_window window = {.buckets = psf.n, .bucket_arcmin = psf.bucket_arcmin};
  int status = placido_diffraction(psf.values, NULL, &pupil, &wave, 1, &window, &err);
  placido_pupil_free(&pupil);
  if (status != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  psf.pupil_mm = pupil_mm;
  return psf;
}

placido_psf normal_eye(double pupil_mm, double m_D, double j0_D) {
  static const double mix[TERMS] = {[6] = 0.3, [7] = 0.3, [8] = 0.5, [9] = 0.45, [12] = 0.5,
                                    [14] = 0.2};
  double rms_um = 0.045 + 0.055 * (pupil_mm - 3), norm = 0, terms_um[TERMS];
  for (int i = 0; i < TERMS; i++) {
    norm += mix[i] * mix[i];
  }
  for (int i = 0; i < TERMS; i++) {
    terms_um[i] = rms_um * mix[i] / sqrt(norm);
  }
  return aberrated(pupil_mm, terms_um, TERMS, m_D, j0_D);
}
