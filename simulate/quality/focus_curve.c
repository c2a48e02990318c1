/* Quality through focus: a PSF for every lens, judged against a perfect eye's. */
#include <placido/quality.h>

#include "base/memory.h"
#include "simulate/acuity/neural.h"
#include "simulate/eye.h"
#include "simulate/quality/otf.h"

#include <math.h>

enum { DIRECTIONS = 32, FREQUENCIES = 60, COLUMNS = 4 };

static const double frequency_max_cpd = 60;
static const double half_turn = 3.14159265358979323846;

/* What of a PSF is judged. */
typedef struct judgement {
  double peak, visual, area;
} judgement;

static double fullest(const placido_psf *psf) {
  double most = 0;
  for (size_t i = 0; i < (size_t)psf->n * (size_t)psf->n; i++) {
    most = fmax(most, psf->values[i]);
  }
  return most;
}

static int judge(judgement *j, const placido_psf *psf, placido_error *err) {
  placido_otf otf;
  *j = (judgement){.peak = fullest(psf)};
  int status = placido_otf_new(&otf, psf, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  double most = fmin(frequency_max_cpd, 30 / psf->bucket_arcmin);
  for (int k = 0; k < FREQUENCIES; k++) {
    double frequency = most * (k + 0.5) / FREQUENCIES;
    double sensitivity = placido_neural_filter(frequency);
    for (int i = 0; i < DIRECTIONS; i++) {
      double real, imaginary, angle = half_turn * i / DIRECTIONS;
      placido_otf_at(&otf, frequency * cos(angle), frequency * sin(angle), &real, &imaginary);
      j->visual += frequency * sensitivity * real;
      j->area += hypot(real, imaginary);
    }
  }
  placido_otf_free(&otf);
  return PLACIDO_OK;
}

/* Light of the eye's own pupil without aberrations. */
static int spread_perfectly(placido_psf *perfect, const placido_surface *surface,
                            const placido_eye *eye, placido_error *err) {
  const double focus_mm[3] = {1e-3 * perfect->centre_x_um, 1e-3 * perfect->centre_y_um,
                              perfect->retina_mm};
  placido_pupil pupil;
  int status = placido_pupil_of_surface(&pupil, surface, eye, focus_mm, 1, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  double *opd_um = (double *)pupil.opd_um; /* the pupil is ours */
  for (size_t i = 0; i < (size_t)pupil.n * (size_t)pupil.n; i++) {
    opd_um[i] *= 0; /* where no light comes it stays unknown */
  }
  placido_wave wave = {.wavelength_nm = perfect->wavelength_nm, .weight = 1};
  double bucket_rad = 1e-3 * perfect->bucket_um * perfect->index / perfect->retina_mm;
  placido_window window = {.buckets = perfect->n,
                           .bucket_arcmin = bucket_rad / PLACIDO_ARCMIN_RAD};
  status = placido_diffraction(perfect->values, NULL, &pupil, &wave, 1, &window, err);
  placido_pupil_free(&pupil);
  return status;
}

/* The image that no aberration disturbs, in the buckets of `psf`. */
static int judge_perfect(judgement *j, const placido_psf *psf, const placido_surface *surface,
                         const placido_eye *eye, placido_error *err) {
  placido_psf perfect = *psf;
  size_t n = (size_t)psf->n;
  perfect.values = placido_memory_new(n, n * sizeof *perfect.values, err);
  int status = perfect.values != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  if (status == PLACIDO_OK && psf->wavelength_nm > 0) {
    status = spread_perfectly(&perfect, surface, eye, err);
  } else if (status == PLACIDO_OK) {
    perfect.values[n / 2 * n + n / 2] = 1;
  }
  if (status == PLACIDO_OK) {
    status = judge(j, &perfect, err);
  }
  placido_memory_free(perfect.values);
  return status;
}

static int judge_lens(placido_focus_curve *curve, int k, judgement *perfect,
                      const placido_surface *surface, const placido_eye *eye,
                      const placido_optics *optics, placido_error *err) {
  placido_eye wearing = *eye;
  placido_psf psf;
  judgement found;
  wearing.correction.m_D += curve->lens_D[k];
  int status = placido_psf_new(&psf, NULL, surface, &wearing, optics, NULL, err);
  if (status == PLACIDO_OK && perfect->peak == 0) {
    status = judge_perfect(perfect, &psf, surface, &wearing, err);
  }
  if (status == PLACIDO_OK) {
    status = judge(&found, &psf, err);
  }
  if (status == PLACIDO_OK) {
    curve->peak[k] = found.peak / perfect->peak;
    curve->visual_strehl[k] = found.visual / perfect->visual;
    curve->mtf_area[k] = found.area / perfect->area;
  }
  placido_psf_free(&psf);
  return status;
}

int placido_focus_curve_new(placido_focus_curve *curve, const placido_surface *surface,
                            const placido_eye *eye, const placido_optics *optics, double from_D,
                            double to_D, int count, placido_error *err) {
  *curve = (placido_focus_curve){0};
  if (count < 2 || count > 10000 || !(from_D < to_D) || !(eye->retina_mm > 0)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "through focus: %d lenses from %g to %g D before a retina at %g mm, "
                             "expected 2 to 10000, growing, and a retina that is found",
                             count, from_D, to_D, eye->retina_mm);
  }
  size_t rows = (size_t)count;
  curve->lens_D = placido_memory_new(rows, COLUMNS * sizeof(double), err);
  if (curve->lens_D == NULL) {
    return PLACIDO_MEMORY;
  }
  curve->count = count;
  curve->peak = curve->lens_D + rows;
  curve->visual_strehl = curve->lens_D + 2 * rows;
  curve->mtf_area = curve->lens_D + 3 * rows;
  placido_optics how = *optics;
  how.grow = 1; /* the same buckets for all */
  judgement perfect = {0};
  int status = PLACIDO_OK;
  for (int k = 0; k < count && status == PLACIDO_OK; k++) {
    curve->lens_D[k] = from_D + (to_D - from_D) * k / (count - 1);
    status = judge_lens(curve, k, &perfect, surface, eye, &how, err);
  }
  if (status != PLACIDO_OK) {
    placido_focus_curve_free(curve);
  }
  return status;
}

void placido_focus_curve_free(placido_focus_curve *curve) {
  if (curve != NULL) {
    placido_memory_free(curve->lens_D);
    *curve = (placido_focus_curve){0};
  }
}
