/* Strehl ratios: |mean of exp(i 2 pi W / wavelength)|² over the pupil (Born and Wolf, 9.1.3), and
 * its largest value over all tilts of W. */
#include <placido/quality.h>

#include "base/memory.h"
#include "simulate/eye.h"

#include <math.h>

enum { SIDE = 1025, FINER = 8 }; /* buckets; of them in wavelength / pupil */

static const double pi = 3.14159265358979323846;

double placido_strehl(const double *opd_um, const double *amplitude, const double *weight,
                      size_t count, double wavelength_nm) {
  double real = 0, imaginary = 0, sum = 0, per_um = 2e3 * pi / wavelength_nm;
  for (size_t i = 0; i < count; i++) {
    double height = weight[i] * (amplitude != NULL ? amplitude[i] : 1);
    real += height * cos(per_um * opd_um[i]);
    imaginary += height * sin(per_um * opd_um[i]);
    sum += height;
  }
  return (real * real + imaginary * imaginary) / (sum * sum);
}

double placido_strehl_marechal(double rms_um, double wavelength_nm) {
  double rms_rad = 2e3 * pi * rms_um / wavelength_nm;
  return exp(-rms_rad * rms_rad);
}

/* The top of the paraboloid through nine samples about `v`: its height, and where it is from there
 * in samples. */
static double top_of(const double *v, double *right, double *down) {
  double slope_x = 0.5 * (v[1] - v[-1]), slope_y = 0.5 * (v[SIDE] - v[-SIDE]);
  double xx = v[1] - 2 * v[0] + v[-1], yy = v[SIDE] - 2 * v[0] + v[-SIDE];
  double xy = 0.25 * (v[SIDE + 1] - v[SIDE - 1] - v[1 - SIDE] + v[-1 - SIDE]);
  double area = xx * yy - xy * xy;
  *right = *down = 0;
  if (!(area > 0 && xx < 0)) {
    return v[0];
  }
  *right = (xy * slope_y - yy * slope_x) / area;
  *down = (xy * slope_x - xx * slope_y) / area;
  return v[0] + 0.5 * (slope_x * *right + slope_y * *down);
}

/* The fullest bucket that is not on the rim, and the top about it. */
static double find_top(const double *values, double bucket_arcmin, double peak_arcmin[2]) {
  size_t best = SIDE + 1;
  for (size_t row = 1; row + 1 < SIDE; row++) {
    for (size_t column = 1; column + 1 < SIDE; column++) {
      size_t at = row * SIDE + column;
      best = values[at] > values[best] ? at : best;
    }
  }
  double right, down, top = top_of(values + best, &right, &down);
  peak_arcmin[0] = ((double)(best % SIDE) - SIDE / 2 + right) * bucket_arcmin;
  peak_arcmin[1] = ((double)(best / SIDE) - SIDE / 2 + down) * bucket_arcmin;
  return top;
}

/* Without aberrations the peak has (sum of amplitudes)² / (sum of their squares) over the number of
 * samples in the pupil, of what an evenly lit one has. */
static double evenness(const placido_pupil *pupil) {
  double sum = 0, squares = 0, count = 0;
  double middle = 0.5 * (pupil->n - 1), radius = 0.5 * pupil->pupil_mm / pupil->spacing_mm;
  for (int row = 0; row < pupil->n; row++) {
    for (int column = 0; column < pupil->n; column++) {
      size_t at = (size_t)row * (size_t)pupil->n + (size_t)column;
      if (hypot(column - middle, row - middle) > radius) {
        continue;
      }
      double height = pupil->amplitude != NULL ? pupil->amplitude[at] : 1;
      height = isnan(pupil->opd_um[at]) ? 0 : height;
      sum += height;
      squares += height * height;
      count++;
    }
  }
  return sum * sum / (squares * count);
}

int placido_strehl_peak(double *strehl, double peak_arcmin[2], const placido_pupil *pupil,
                        double wavelength_nm, placido_error *err) {
  *strehl = peak_arcmin[0] = peak_arcmin[1] = NAN;
  double *values = placido_memory_new((size_t)SIDE * SIDE, sizeof *values, err);
  if (values == NULL) {
    return PLACIDO_MEMORY;
  }
  double bucket_rad = 1e-6 * wavelength_nm / pupil->pupil_mm / FINER;
  placido_wave wave = {.wavelength_nm = wavelength_nm, .weight = 1};
  placido_window window = {.buckets = SIDE,
                           .bucket_arcmin = bucket_rad / PLACIDO_ARCMIN_RAD,
                           .points = true};
  int status = placido_diffraction(values, NULL, pupil, &wave, 1, &window, err);
  if (status == PLACIDO_OK) {
    double ideal = pi / 4 / (FINER * FINER) * evenness(pupil);
    *strehl = find_top(values, window.bucket_arcmin, peak_arcmin) / ideal;
  }
  placido_memory_free(values);
  return status;
}
