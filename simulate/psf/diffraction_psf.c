/* The PSF by diffraction: exact paths to the point of fixation on the retina, then Fraunhofer's
 * integral. A retinal point X beside the focus at the depth L is seen by the pupil, whose samples
 * stand for L times the sine of a ray's direction, as the angle n X / L in air. */
#include "simulate/psf/diffraction_psf.h"

#include "base/memory.h"

#include <placido/diffraction.h>

#include <math.h>
#include <stdlib.h>

static const double outside_max = 0.001; /* share of the rays beyond which the PSF grows */

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

bool placido_pupil_lit(const placido_pupil *pupil, int column, int row) {
  double middle = 0.5 * (pupil->n - 1), radius = 0.5 * pupil->pupil_mm / pupil->spacing_mm;
  return hypot(column - middle, row - middle) <= radius;
}

static double opd_at(const placido_pupil *pupil, int column, int row) {
  return pupil->opd_um[(size_t)row * (size_t)pupil->n + (size_t)column];
}

void placido_psf_count_samples(placido_psf *psf, const placido_pupil *pupil) {
  for (int row = 0; row < pupil->n; row++) {
    for (int column = 0; column < pupil->n; column++) {
      bool inside = placido_pupil_lit(pupil, column, row);
      bool missed = inside && isnan(opd_at(pupil, column, row));
      psf->rays_missed += missed;
      psf->rays_entered += inside && !missed;
    }
  }
  psf->rays = (long)pupil->n * pupil->n;
  psf->rays_landed = psf->rays_entered;
}

/* How far out, along either axis, all but outside_max of the rays arrive: radians. */
static int find_reach(double *reach_rad, const placido_pupil *pupil, placido_error *err) {
  size_t count = 0, most = (size_t)pupil->n * (size_t)pupil->n;
  double *angles = placido_memory_new(most, sizeof *angles, err);
  *reach_rad = 0;
  if (angles == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int row = 1; row + 1 < pupil->n; row++) {
    for (int column = 1; column + 1 < pupil->n; column++) {
      double across = opd_at(pupil, column + 1, row) - opd_at(pupil, column - 1, row);
      double along = opd_at(pupil, column, row + 1) - opd_at(pupil, column, row - 1);
      double slope = fmax(fabs(across), fabs(along)) / (2e3 * pupil->spacing_mm);
      if (placido_pupil_lit(pupil, column, row) && isfinite(across) && isfinite(along)) {
        angles[count++] = slope;
      }
    }
  }
  qsort(angles, count, sizeof *angles, ascending);
  if (count > 0) {
    *reach_rad = angles[(size_t)floor((1 - outside_max) * (double)(count - 1))];
  }
  placido_memory_free(angles);
  return PLACIDO_OK;
}

/* The buckets a side that hold what arrives. */
static int choose_buckets(double reach_rad, double bucket_rad, const placido_optics *optics) {
  double most = fmin(floor(optics->grow * optics->buckets), PLACIDO_PSF_BUCKETS_MAX);
  double needed = 2 * ceil(reach_rad / bucket_rad) + 3;
  if (needed <= optics->buckets) {
    return optics->buckets;
  }
  int buckets = (int)fmin(needed, most);
  return buckets - (buckets % 2 == 0);
}

void placido_psf_summarise(placido_psf *psf) {
  double sum = 0, most = 0;
  for (size_t i = 0; i < (size_t)psf->n * (size_t)psf->n; i++) {
    sum += psf->values[i];
    most = fmax(most, psf->values[i]);
  }
  psf->outside = 1 - sum;
  psf->strehl_g = most / sum;
}

static int spread_light(placido_psf *psf, const placido_pupil *pupil, double bucket_rad,
                        const placido_optics *optics, placido_error *err) {
  double reach_rad;
  int status = find_reach(&reach_rad, pupil, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  psf->n = choose_buckets(reach_rad, bucket_rad, optics);
  psf->values = placido_memory_new((size_t)psf->n, (size_t)psf->n * sizeof *psf->values, err);
  if (psf->values == NULL) {
    return PLACIDO_MEMORY;
  }
  placido_wave wave = {.wavelength_nm = optics->wavelength_nm, .weight = 1};
  placido_window window = {.buckets = psf->n,
                           .bucket_arcmin = bucket_rad / PLACIDO_ARCMIN_RAD,
                           .threads = optics->threads};
  return placido_diffraction(psf->values, NULL, pupil, &wave, 1, &window, err);
}

int placido_diffraction_fill(placido_psf *psf, const placido_surface *surface,
                             const placido_apex *apex, const placido_eye *eye,
                             const placido_optics *optics, const double fixation_mm[2],
                             placido_error *err) {
  const double focus_mm[3] = {fixation_mm[0], fixation_mm[1], eye->retina_mm};
  placido_pupil pupil;
  int status = placido_pupil_of_surface(&pupil, surface, eye, focus_mm, optics->threads, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  psf->bucket_um = placido_apex_bucket_um(apex, optics, eye->index, eye->retina_mm);
  psf->bucket_arcmin = optics->bucket_arcmin;
  psf->wavelength_nm = optics->wavelength_nm;
  psf->pupil_mm = eye->pupil_mm;
  psf->index = eye->index;
  psf->retina_mm = eye->retina_mm;
  psf->correction = eye->correction;
  psf->centre_x_um = 1e3 * fixation_mm[0];
  psf->centre_y_um = 1e3 * fixation_mm[1];
  placido_psf_count_samples(psf, &pupil);
  status = spread_light(psf, &pupil, 1e-3 * psf->bucket_um * eye->index / eye->retina_mm, optics,
                        err);
  if (status == PLACIDO_OK) {
    placido_psf_summarise(psf);
  }
  placido_pupil_free(&pupil);
  return status;
}
