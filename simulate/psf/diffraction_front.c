/* A wavefront made ready: continued a little beyond its edge, its steepest slope found, and its
 * grid judged. */
#include "simulate/psf/diffraction.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { SAMPLES_MIN = 8, SAMPLES_MAX = 8192, BEYOND = 3 };

/* Neighbours to continue from: quadratically along a line of three samples. */
static const int along[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};

static bool within(const placido_front *f, int column, int row, double radius_mm) {
  double x = (column - 0.5 * (f->n - 1)) * f->spacing_mm;
  double y = (row - 0.5 * (f->n - 1)) * f->spacing_mm;
  return x * x + y * y <= radius_mm * radius_mm;
}

/* The value that the samples on one side lead to; NaN where there are not three of them. */
static double lead(const double *values, int n, int column, int row, const int step[2]) {
  int far_column = column + 3 * step[0], far_row = row + 3 * step[1];
  if (far_column < 0 || far_row < 0 || far_column >= n || far_row >= n) {
    return NAN;
  }
  const double *at = values + (size_t)row * (size_t)n + (size_t)column;
  ptrdiff_t s = step[0] + (ptrdiff_t)step[1] * n;
  return 3 * at[s] - 3 * at[2 * s] + at[3 * s];
}

/* Gives the missing samples next to known ones a value; `before` is a copy of `values`. */
static void continue_once(double *values, const double *before, int n) {
  for (int row = 0; row < n; row++) {
    for (int column = 0; column < n; column++) {
      double *value = values + (size_t)row * (size_t)n + (size_t)column;
      double sum = 0;
      int count = 0;
      for (int k = 0; k < 4 && isnan(*value); k++) {
        double led = lead(before, n, column, row, along[k]);
        if (!isnan(led)) {
          sum += led;
          count++;
        }
      }
      if (count > 0) {
        *value = sum / count;
      }
    }
  }
}

static int continue_beyond(double *values, int n, placido_error *err) {
  size_t area = (size_t)n * (size_t)n;
  double *before = placido_memory_new(area, sizeof *before, err);
  if (before == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int pass = 0; pass < BEYOND; pass++) {
    memcpy(before, values, area * sizeof *before);
    continue_once(values, before, n);
  }
  placido_memory_free(before);
  return PLACIDO_OK;
}

/* Copies the pupil; sets `*holes` where the path difference is missing in the square, and makes an
 * amplitude where one was given or light is missing in the pupil. */
static int copy(placido_front *f, const placido_pupil *pupil, bool *holes, placido_error *err) {
  size_t area = (size_t)f->n * (size_t)f->n;
  bool dark = false;
  *holes = false;
  f->opd_um = placido_memory_new(area, sizeof *f->opd_um, err);
  if (f->opd_um == NULL) {
    return PLACIDO_MEMORY;
  }
  memcpy(f->opd_um, pupil->opd_um, area * sizeof *f->opd_um);
  for (int row = 0; row < f->n; row++) {
    for (int column = 0; column < f->n; column++) {
      size_t at = (size_t)row * (size_t)f->n + (size_t)column;
      bool missing = !isfinite(f->opd_um[at]);
      f->opd_um[at] = missing ? (double)NAN : f->opd_um[at];
      *holes = *holes || missing;
      dark = dark || (missing && within(f, column, row, f->pupil_mm / 2));
    }
  }
  if (pupil->amplitude == NULL && !dark) {
    return PLACIDO_OK;
  }
  f->amplitude = placido_memory_new(area, sizeof *f->amplitude, err);
  if (f->amplitude == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int row = 0; row < f->n; row++) {
    for (int column = 0; column < f->n; column++) {
      size_t at = (size_t)row * (size_t)f->n + (size_t)column;
      double given = pupil->amplitude != NULL ? pupil->amplitude[at] : 1;
      bool missing = isnan(f->opd_um[at]) && within(f, column, row, f->pupil_mm / 2);
      f->amplitude[at] = missing ? 0 : isfinite(given) ? given : (double)NAN;
      *holes = *holes || isnan(f->amplitude[at]);
    }
  }
  return PLACIDO_OK;
}

static void zero_missing(double *values, size_t area) {
  for (size_t i = 0; i < area; i++) {
    values[i] = isnan(values[i]) ? 0 : values[i];
  }
}

static int fill_holes(placido_front *f, placido_error *err) {
  size_t area = (size_t)f->n * (size_t)f->n;
  int status = continue_beyond(f->opd_um, f->n, err);
  if (status == PLACIDO_OK && f->amplitude != NULL) {
    status = continue_beyond(f->amplitude, f->n, err);
  }
  if (status == PLACIDO_OK) {
    zero_missing(f->opd_um, area);
    if (f->amplitude != NULL) {
      zero_missing(f->amplitude, area);
    }
  }
  return status;
}

/* The steepest slope where light comes through, and the root mean square of what interpolation from
 * this grid leaves: 3/128 of the fourth difference along each axis. */
static double judge(placido_front *f) {
  double sum = 0, steepest = 0;
  size_t n = (size_t)f->n, count = 0;
  for (size_t row = 2; row + 2 < n; row++) {
    for (size_t column = 2; column + 2 < n; column++) {
      const double *w = f->opd_um + row * n + column;
      bool lit = f->amplitude == NULL || f->amplitude[row * n + column] > 0;
      if (!lit || !within(f, (int)column, (int)row, f->pupil_mm / 2 - 2 * f->spacing_mm)) {
        continue;
      }
      double dx = w[1] - w[-1], dy = w[n] - *(w - n);
      double across = w[2] - 4 * w[1] + 6 * w[0] - 4 * w[-1] + w[-2];
      double along_y = w[2 * n] - 4 * w[n] + 6 * w[0] - 4 * *(w - n) + *(w - 2 * n);
      steepest = fmax(steepest, dx * dx + dy * dy);
      sum += across * across + along_y * along_y;
      count++;
    }
  }
  f->slope_max = sqrt(steepest) / (2 * f->spacing_mm);
  return count > 0 ? 3 / 128.0 * sqrt(sum / (double)count) : 0;
}

static int check(const placido_pupil *pupil, placido_error *err) {
  if (pupil->n < SAMPLES_MIN || pupil->n > SAMPLES_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "a pupil of %d samples a side, expected %d to %d",
                             pupil->n, SAMPLES_MIN, SAMPLES_MAX);
  }
  if (!(pupil->pupil_mm > 0 && pupil->pupil_mm < 1000)) {
    return placido_error_set(err, PLACIDO_INPUT, "a pupil of %g mm, expected more than 0",
                             pupil->pupil_mm);
  }
  if (!(pupil->n * pupil->spacing_mm >= pupil->pupil_mm * (1 - 1e-9))) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%d samples %g mm apart do not reach across a pupil of %g mm",
                             pupil->n, pupil->spacing_mm, pupil->pupil_mm);
  }
  return PLACIDO_OK;
}

static bool any_light(const placido_front *f) {
  for (int row = 0; row < f->n; row++) {
    for (int column = 0; column < f->n; column++) {
      double amplitude =
        f->amplitude == NULL ? 1 : f->amplitude[(size_t)row * (size_t)f->n + (size_t)column];
      if (amplitude > 0 && within(f, column, row, f->pupil_mm / 2)) {
        return true;
      }
    }
  }
  return false;
}

int placido_front_new(placido_front *front, const placido_pupil *pupil, double tolerance_um,
                      placido_error *err) {
  *front = (placido_front){0};
  int status = check(pupil, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  bool holes;
  front->n = pupil->n;
  front->spacing_mm = pupil->spacing_mm;
  front->pupil_mm = pupil->pupil_mm;
  status = copy(front, pupil, &holes, err);
  if (status == PLACIDO_OK && holes) {
    status = fill_holes(front, err);
  }
  if (status == PLACIDO_OK && !any_light(front)) {
    status = placido_error_set(err, PLACIDO_QUALITY, "no light comes through the pupil of %g mm",
                               pupil->pupil_mm);
  }
  double left_um = status == PLACIDO_OK ? judge(front) : 0;
  if (left_um > tolerance_um) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "a wavefront known every %.3g mm leaves %.2g um open between its "
                               "samples, at most %.2g um may be: give a finer grid",
                               pupil->spacing_mm, left_um, tolerance_um);
  }
  if (status != PLACIDO_OK) {
    placido_front_free(front);
  }
  return status;
}

void placido_front_free(placido_front *front) {
  if (front != NULL) {
    placido_memory_free(front->opd_um);
    placido_memory_free(front->amplitude);
    *front = (placido_front){0};
  }
}
