/* Pupils made of Zernike terms or of a surface's exact paths. */
#include <placido/diffraction.h>

#include "base/memory.h"
#include "reconstruct/surface/sheet.h"
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

/* What the lines of a surface's pupil share. */
typedef struct lines {
  const placido_sheet *sheet;
  const placido_eye *eye;
  const double *focus_mm, *x_mm;
  double axis_sag_mm, chief_mm, spacing_mm;
  int n;
} lines;

/* Path differences of one line; NaN where the surface is not defined. */
static void fill_line(double *opd_um, double *work, const lines *l, int row) {
  size_t n = (size_t)l->n;
  double y_mm = l->eye->pupil_y_mm + (row - 0.5 * (l->n - 1)) * l->spacing_mm;
  double *sag_mm = work, *sx = work + n, *sy = work + 2 * n;
  placido_sheet_line(l->sheet, work + 3 * n, y_mm, 0, n, sag_mm, sx, sy);
  for (size_t i = 0; i < n; i++) {
    opd_um[i] = 1e3 * (l->chief_mm - placido_path_mm(l->eye, l->x_mm[i], y_mm,
                                                     sag_mm[i] - l->axis_sag_mm, l->focus_mm));
  }
}

static int fill_lines(double *opd_um, const lines *l, int threads, placido_error *err) {
  size_t n = (size_t)l->n, size = 3 * n + placido_sheet_work(l->sheet);
  double *work = placido_memory_new((size_t)threads, size * sizeof *work, err);
  if (work == NULL) {
    return PLACIDO_MEMORY;
  }
#pragma omp parallel for num_threads(threads) if (threads > 1)
  for (int thread = 0; thread < threads; thread++) {
    for (int row = thread; row < l->n; row += threads) {
      fill_line(opd_um + (size_t)row * n, work + (size_t)thread * size, l, row);
    }
  }
  placido_memory_free(work);
  return PLACIDO_OK;
}

/* Path of the chief ray, through the pupil's centre, where the surface is known to be defined. */
static double chief_path_mm(const placido_surface *surface, const placido_eye *eye,
                            double axis_sag_mm, const double focus_mm[3]) {
  placido_jet jet;
  placido_surface_at(surface, eye->pupil_x_mm, eye->pupil_y_mm, &jet);
  return placido_path_mm(eye, eye->pupil_x_mm, eye->pupil_y_mm, jet.sag - axis_sag_mm, focus_mm);
}

int placido_pupil_of_surface(placido_pupil *pupil, const placido_surface *surface,
                             const placido_eye *eye, const double focus_mm[3], int threads,
                             placido_error *err) {
  *pupil = (placido_pupil){0};
  placido_eye settled;
  placido_apex apex;
  placido_sheet *sheet = NULL;
  double *x_mm = NULL, *opd_um = NULL;
  int status = placido_eye_settle(&settled, eye, err);
  if (status == PLACIDO_OK && (threads < 1 || threads > 256)) {
    status = placido_error_set(err, PLACIDO_INPUT, "%d threads, expected 1 to 256", threads);
  }
  if (status == PLACIDO_OK) {
    status = placido_apex_find(&apex, surface, &settled, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  double across = ceil(fmin(fmax(settled.pupil_mm / surface_spacing_mm, SAMPLES_LEAST),
                            SAMPLES_MOST));
  lines l = {.eye = &settled, .focus_mm = focus_mm, .axis_sag_mm = apex.axis_sag_mm,
             .spacing_mm = settled.pupil_mm / across, .n = (int)across + 2 * MARGIN};
  l.chief_mm = chief_path_mm(surface, &settled, apex.axis_sag_mm, focus_mm);
  x_mm = placido_memory_new((size_t)l.n, sizeof *x_mm, err);
  opd_um = placido_memory_new((size_t)l.n, (size_t)l.n * sizeof *opd_um, err);
  status = x_mm != NULL && opd_um != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  for (int i = 0; i < l.n && status == PLACIDO_OK; i++) {
    x_mm[i] = settled.pupil_x_mm + (i - 0.5 * (l.n - 1)) * l.spacing_mm;
  }
  if (status == PLACIDO_OK) {
    status = placido_sheet_new(&sheet, surface, x_mm, (size_t)l.n, err);
  }
  if (status == PLACIDO_OK) {
    l.sheet = sheet;
    l.x_mm = x_mm;
    status = fill_lines(opd_um, &l, threads, err);
  }
  placido_sheet_free(sheet);
  placido_memory_free(x_mm);
  if (status != PLACIDO_OK) {
    placido_memory_free(opd_um);
    return status;
  }
  take(pupil, opd_um, l.n, settled.pupil_mm, l.spacing_mm);
  return PLACIDO_OK;
}

void placido_pupil_free(placido_pupil *pupil) {
  if (pupil != NULL) {
    placido_memory_free((double *)pupil->opd_um);
    placido_memory_free((double *)pupil->amplitude);
    *pupil = (placido_pupil){0};
  }
}
