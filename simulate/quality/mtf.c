/* Modulation transfer along meridians, and its mean over all directions. */
#include <placido/quality.h>

#include "base/memory.h"
#include "simulate/quality/otf.h"

#include <math.h>

enum { DIRECTIONS = 64 }; /* over a half turn: the other half has the same moduli */

static const double half_turn = 3.14159265358979323846;

static double contrast(const placido_otf *otf, double frequency_cpd, double angle) {
  double real, imaginary;
  placido_otf_at(otf, frequency_cpd * cos(angle), frequency_cpd * sin(angle), &real, &imaginary);
  return fmin(hypot(real, imaginary), 1); /* within one bucket there is no width to divide out */
}

static void fill(placido_mtf *mtf, const placido_otf *otf) {
  for (int k = 0; k < mtf->count; k++) {
    double frequency = k * mtf->step_cpd, sum = 0;
    for (int i = 0; i < DIRECTIONS; i++) {
      sum += contrast(otf, frequency, half_turn * i / DIRECTIONS);
    }
    mtf->radial[k] = sum / DIRECTIONS;
    for (int i = 0; i < PLACIDO_MTF_MERIDIANS; i++) {
      mtf->meridian[i][k] = contrast(otf, frequency, half_turn * i / PLACIDO_MTF_MERIDIANS);
    }
  }
}

int placido_mtf_new(placido_mtf *mtf, const placido_psf *psf, int count, double step_cpd,
                    placido_error *err) {
  *mtf = (placido_mtf){.count = count, .step_cpd = step_cpd};
  double most_cpd = 30 / psf->bucket_arcmin;
  if (count < 2 || !(step_cpd > 0) || !((count - 1) * step_cpd <= most_cpd * (1 + 1e-9))) {
    *mtf = (placido_mtf){0};
    return placido_error_set(err, PLACIDO_INPUT,
                             "%d frequencies %g c/deg apart, expected 2 or more that end at %g "
                             "c/deg: buckets of %g' carry no finer ones",
                             count, step_cpd, most_cpd, psf->bucket_arcmin);
  }
  placido_otf otf;
  int status = placido_otf_new(&otf, psf, err);
  if (status != PLACIDO_OK) {
    *mtf = (placido_mtf){0};
    return status;
  }
  size_t columns = (size_t)count;
  mtf->radial = placido_memory_new(columns, (1 + PLACIDO_MTF_MERIDIANS) * sizeof(double), err);
  if (mtf->radial != NULL) {
    for (size_t i = 0; i < PLACIDO_MTF_MERIDIANS; i++) {
      mtf->meridian[i] = mtf->radial + (i + 1) * columns;
    }
    fill(mtf, &otf);
  } else {
    *mtf = (placido_mtf){0};
    status = PLACIDO_MEMORY;
  }
  placido_otf_free(&otf);
  return status;
}

void placido_mtf_free(placido_mtf *mtf) {
  if (mtf != NULL) {
    placido_memory_free(mtf->radial);
    *mtf = (placido_mtf){0};
  }
}
