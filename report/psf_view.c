/* Which part of a PSF is shown and in which colours. */
#include "report/psf_view.h"

#include "report/palette.h"

#include <math.h>

static const double share_shown = 0.99;
static const double least_arcmin = 5;

double placido_psf_view_at(const placido_psf_view *view, int right, int up) {
  const placido_psf *psf = view->psf;
  int centre = psf->n / 2, column = centre + right, row = centre - up;
  if (column < 0 || row < 0 || column >= psf->n || row >= psf->n) {
    return 0;
  }
  return psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
}

/* The light on the border of the square of this half side. */
static double sum_ring(const placido_psf_view *view, int half) {
  if (half == 0) {
    return placido_psf_view_at(view, 0, 0);
  }
  double sum = 0;
  for (int k = -half; k < half; k++) {
    sum += placido_psf_view_at(view, k, half) + placido_psf_view_at(view, half, -k) +
           placido_psf_view_at(view, -k, -half) + placido_psf_view_at(view, -half, k);
  }
  return sum;
}

double placido_psf_view_tick(double length, double most) {
  double decade = pow(10, floor(log10(length / most))), ratio = length / most / decade;
  return decade * (ratio <= 1 ? 1 : ratio <= 2 ? 2 : ratio <= 5 ? 5 : 10);
}

int placido_psf_view_find(placido_psf_view *view, const placido_psf *psf, placido_error *err) {
  *view = (placido_psf_view){.psf = psf};
  if (psf->values == NULL || psf->n < 3 || psf->n % 2 == 0 || !(psf->bucket_arcmin > 0)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "figure of a PSF: %d buckets of %g arcmin a side, expected an odd "
                             "number from 3 up",
                             psf->n, psf->bucket_arcmin);
  }
  double total = 0;
  for (size_t k = 0; k < (size_t)psf->n * (size_t)psf->n; k++) {
    total += psf->values[k];
    view->peak = fmax(view->peak, psf->values[k]);
  }
  if (!(total > 0) || !isfinite(total)) {
    return placido_error_set(err, PLACIDO_INPUT, "figure of a PSF: no light landed in it");
  }
  double held = sum_ring(view, 0);
  while (view->half < psf->n / 2 &&
         (held < share_shown * total || view->half * psf->bucket_arcmin < least_arcmin)) {
    view->half++;
    held += sum_ring(view, view->half);
  }
  view->half_arcmin = (view->half + 0.5) * psf->bucket_arcmin;
  view->tick_arcmin = placido_psf_view_tick(view->half_arcmin, 5.5);
  return PLACIDO_OK;
}

placido_rgb placido_psf_view_colour(const placido_psf_view *view, double value) {
  if (value <= 0) {
    return (placido_rgb){1, 1, 1};
  }
  return placido_palette_sequential(1 + log10(value / view->peak) / PLACIDO_PSF_DECADES);
}
