/* Pupils made of Zernike terms or of a surface's exact paths. */
#include <placido/diffraction.h>

#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/rays/bundle.h"

#include <math.h>

enum { TERMS_MAX = 136, SAMPLES_LEAST = 96, SAMPLES_MOST = 1024, MARGIN = 3 };

static const double surface_spacing_mm = 0.025; /* half a knot of the finest fit */

static void take(placido_pupil *pupil, double *opd_um, int n, double pupil_mm,
                 double spacing_mm) {
  *pupil = (placido_pupil){
    .n = n, .spacing_mm = spacing_mm, .pupil_mm = pupil_mm, .opd_um = opd_um};
}

/* The sum of the terms at a row of points, `room` for TERMS_MAX rows of terms. */
static void add_terms(double *sum, double *room, int order, const double *x, const double *y,
                      const double *coefficients_um, int count, int points) {
  placido_zernike_terms(room, order, x, y, (size_t)points);
  for (int i = 0; i < points; i++) {
    sum[i] = 0;
    for (int j = 0; j < count; j++) {
      sum[i] += coefficients_um[j] * room[j * points + i];
    }
  }
}

int placido_pupil_of_terms(placido_pupil *pupil, double pupil_mm, const double *coefficients_um,
                           int count, int n, placido_error *err) {
  *pupil = (placido_pupil){0};
  if (count < 1 || count > TERMS_MAX || !(pupil_mm > 0) || n < 0 || n > 8192 - 2 * MARGIN) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%d Zernike terms over a pupil of %g mm on %d samples, expected 1 to "
                             "%d, more than 0, and 0 to %d",
                             count, pupil_mm, n, TERMS_MAX, 8192 - 2 * MARGIN);
  }
  int order, frequency;
  placido_zernike_name(count - 1, &order, &frequency);
  int across = n > 0 ? n : SAMPLES_LEAST + 16 * order, side = n > 0 ? n : across + 2 * MARGIN;
  size_t columns = (size_t)side, terms = (size_t)placido_zernike_count(order);
  double *opd_um = placido_memory_new(columns, columns * sizeof *opd_um, err);
  double *room = placido_memory_new((terms + 2) * columns, sizeof *room, err);
  if (opd_um == NULL || room == NULL) {
    placido_memory_free(opd_um);
    placido_memory_free(room);
    return PLACIDO_MEMORY;
  }
  double *x = room + terms * columns, *y = x + columns;
  for (int row = 0; row < side; row++) {
    for (int i = 0; i < side; i++) {
      x[i] = (2.0 * i - (side - 1)) / across;
      y[i] = (2.0 * row - (side - 1)) / across;
    }
    add_terms(opd_um + (size_t)row * columns, room, order, x, y, coefficients_um, count, side);
  }
  placido_memory_free(room);
  take(pupil, opd_um, side, pupil_mm, pupil_mm / across);
  return PLACIDO_OK;
}

/* Path difference of one ray; NaN where the surface is not defined. */
static double surface_opd_um(const placido_surface *surface, const placido_apex *apex,
                             const placido_eye *eye, const double focus_mm[3], double chief_mm,
                             double x_mm, double y_mm) {
  placido_jet jet;
  if (!placido_surface_at(surface, x_mm, y_mm, &jet)) {
    return NAN;
  }
  double depth_mm = jet.sag - apex->axis_sag_mm;
  return 1e3 * (chief_mm - placido_path_mm(eye, x_mm, y_mm, depth_mm, focus_mm));
}

int placido_pupil_of_surface(placido_pupil *pupil, const placido_surface *surface,
                             const placido_eye *eye, const double focus_mm[3], int threads,
                             placido_error *err) {
  *pupil = (placido_pupil){0};
  placido_eye settled;
  placido_apex apex;
  int status = placido_eye_settle(&settled, eye, err);
  if (status == PLACIDO_OK) {
    status = placido_apex_find(&apex, surface, &settled, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  double across = fmin(fmax(settled.pupil_mm / surface_spacing_mm, SAMPLES_LEAST), SAMPLES_MOST);
  double spacing_mm = settled.pupil_mm / ceil(across);
  int n = (int)ceil(across) + 2 * MARGIN;
  double *opd_um = placido_memory_new((size_t)n, (size_t)n * sizeof *opd_um, err);
  if (opd_um == NULL) {
    return PLACIDO_MEMORY;
  }
  double chief_mm = -1e-3 * surface_opd_um(surface, &apex, &settled, focus_mm, 0,
                                           settled.pupil_x_mm, settled.pupil_y_mm);
#pragma omp parallel for num_threads(threads) if (threads > 1)
  for (int row = 0; row < n; row++) {
    for (int column = 0; column < n; column++) {
      double x = settled.pupil_x_mm + (column - 0.5 * (n - 1)) * spacing_mm;
      double y = settled.pupil_y_mm + (row - 0.5 * (n - 1)) * spacing_mm;
      opd_um[(size_t)row * (size_t)n + (size_t)column] =
        surface_opd_um(surface, &apex, &settled, focus_mm, chief_mm, x, y);
    }
  }
  take(pupil, opd_um, n, settled.pupil_mm, spacing_mm);
  return PLACIDO_OK;
}

void placido_pupil_free(placido_pupil *pupil) {
  if (pupil != NULL) {
    placido_memory_free((double *)pupil->opd_um);
    placido_memory_free((double *)pupil->amplitude);
    *pupil = (placido_pupil){0};
  }
}
