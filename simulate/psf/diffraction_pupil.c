/* Pupils made of Zernike terms or of a surface's exact paths.
 *
 * A point X beside the focus F is reached from the entry P by a path that differs by -n X s from that
 * to F, s the sine of the direction from F to P (its two components across the axis). So the field
 * belongs on a grid of s, not of P: for wide pupils P = s |F - P| is another thing (the condition of
 * Abbe; Goodman, Introduction to Fourier Optics, 6.2). Samples stand for s times the focus' depth. */
#include <placido/diffraction.h>

#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/rays/bundle.h"

#include <math.h>

enum { TERMS_MAX = 136, SAMPLES_LEAST = 96, SAMPLES_MOST = 1024, MARGIN = 3 };
enum { STEPS_MAX = 16, RIM = 64 };

static const double surface_spacing_mm = 0.025; /* half a knot of the finest fit */
static const double settled_mm = 1e-5; /* of a way: a millionth of a millimetre at the entry */
static const double retreat = 0.9;     /* of a way whose entry was beyond the surface */

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

/* A surface's pupil while it is filled. */
typedef struct sight {
  const placido_surface *surface;
  const placido_eye *eye;
  const double *focus_mm;
  placido_apex apex;
  double chief_mm;      /* path of the ray through the pupil's centre */
  double across, along; /* sines of its direction to the focus */
  double spacing_mm;
  int n;
  double *x_mm, *y_mm;  /* where the ray of each sample enters */
} sight;

/* A ray that enters at (x, y): the surface there, its sag counted from the axis, and the ray's way
 * to the focus; false where the surface is not defined. */
static bool enter(const sight *s, double x_mm, double y_mm, placido_jet *entry, double *way_mm) {
  if (!placido_surface_at(s->surface, x_mm, y_mm, entry)) {
    return false;
  }
  entry->sag -= s->apex.axis_sag_mm;
  double dx = x_mm - s->focus_mm[0], dy = y_mm - s->focus_mm[1];
  double dz = entry->sag - s->focus_mm[2];
  *way_mm = sqrt(dx * dx + dy * dy + dz * dz);
  return true;
}

/* The way behind a sphere of the apical radius: where the search of an entry begins. */
static double first_way_mm(const sight *s, double x_mm, double y_mm) {
  double radius_mm = s->apex.radius_mm, square = x_mm * x_mm + y_mm * y_mm, depth_mm = 0;
  if (square < 0.9 * radius_mm * radius_mm && isfinite(radius_mm)) {
    depth_mm = square / (radius_mm + sqrt(radius_mm * radius_mm - square));
  }
  return hypot(sqrt(square), s->focus_mm[2] - depth_mm);
}

/* The path difference of the ray whose direction to the focus has these sines: it enters where that
 * direction, followed back, meets the surface, found by Newton's method in the ray's way. A step that
 * leads beyond the surface is halved. NaN where there is no such entry. */
static double trace(const sight *s, double across, double along, double *x_mm, double *y_mm) {
  double way_mm = first_way_mm(s, across * s->focus_mm[2], along * s->focus_mm[2]), inside_mm = 0;
  for (int step = 0; step < STEPS_MAX; step++) {
    placido_jet entry;
    double found_mm;
    *x_mm = s->focus_mm[0] + across * way_mm;
    *y_mm = s->focus_mm[1] + along * way_mm;
    if (!enter(s, *x_mm, *y_mm, &entry, &found_mm)) {
      way_mm = inside_mm > 0 ? (way_mm + inside_mm) / 2 : retreat * way_mm;
      continue;
    }
    inside_mm = way_mm;
    double growth = ((across * across + along * along) * way_mm +
                     (entry.sag - s->focus_mm[2]) * (across * entry.sx + along * entry.sy)) /
                    found_mm;
    double change_mm = (found_mm - way_mm) / (1 - growth);
    if (fabs(change_mm) <= settled_mm) {
      return 1e3 * (s->chief_mm - placido_path_mm(s->eye, *x_mm, *y_mm, entry.sag, s->focus_mm));
    }
    way_mm += change_mm;
  }
  return NAN;
}

static void trace_line(double *opd_um, const sight *s, int row) {
  double step = s->spacing_mm / s->focus_mm[2], middle = 0.5 * (s->n - 1);
  for (int column = 0; column < s->n; column++) {
    size_t at = (size_t)row * (size_t)s->n + (size_t)column;
    opd_um[column] = trace(s, s->across + (column - middle) * step, s->along + (row - middle) * step,
                       &s->x_mm[at], &s->y_mm[at]);
    if (isnan(opd_um[column])) {
      s->x_mm[at] = s->y_mm[at] = NAN;
    }
  }
}

/* The light that a sample stands for is the area where its rays enter: the square of the amplitude. */
static void find_amplitude(double *amplitude, const sight *s) {
  for (int row = 0; row < s->n; row++) {
    for (int column = 0; column < s->n; column++) {
      size_t n = (size_t)s->n, at = (size_t)row * n + (size_t)column;
      amplitude[at] = NAN;
      if (row > 0 && column > 0 && row + 1 < s->n && column + 1 < s->n) {
        double xx = s->x_mm[at + 1] - s->x_mm[at - 1], xy = s->x_mm[at + n] - s->x_mm[at - n];
        double yx = s->y_mm[at + 1] - s->y_mm[at - 1], yy = s->y_mm[at + n] - s->y_mm[at - n];
        amplitude[at] = sqrt(fmax(xx * yy - xy * yx, 0)) / (2 * s->spacing_mm);
      }
    }
  }
}

/* The mean radius of the pupil's rim in directions, times the focus' depth. */
static double rim_mm(const sight *s) {
  double sum = 0, count = 0;
  for (int i = 0; i < RIM; i++) {
    double angle = 2 * acos(-1) * i / RIM, way_mm;
    placido_jet entry;
    double x = s->eye->pupil_x_mm + s->eye->pupil_mm / 2 * cos(angle);
    double y = s->eye->pupil_y_mm + s->eye->pupil_mm / 2 * sin(angle);
    if (enter(s, x, y, &entry, &way_mm)) {
      sum += s->focus_mm[2] * hypot((x - s->focus_mm[0]) / way_mm - s->across,
                                    (y - s->focus_mm[1]) / way_mm - s->along);
      count++;
    }
  }
  return count > 0 ? sum / count : s->eye->pupil_mm / 2;
}

static int look(sight *s, const placido_surface *surface, const placido_eye *eye,
                const double focus_mm[3], placido_error *err) {
  placido_jet entry = {0};
  double way_mm = 1;
  *s = (sight){.surface = surface, .eye = eye, .focus_mm = focus_mm};
  if (!(focus_mm[2] >= 1 && focus_mm[2] <= 1000)) {
    return placido_error_set(err, PLACIDO_INPUT, "a focus %g mm behind the cornea, expected 1 to "
                             "1000", focus_mm[2]);
  }
  int status = placido_apex_find(&s->apex, surface, eye, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  enter(s, eye->pupil_x_mm, eye->pupil_y_mm, &entry, &way_mm); /* defined: the apex was found */
  s->chief_mm = placido_path_mm(eye, eye->pupil_x_mm, eye->pupil_y_mm, entry.sag, focus_mm);
  s->across = (eye->pupil_x_mm - focus_mm[0]) / way_mm;
  s->along = (eye->pupil_y_mm - focus_mm[1]) / way_mm;
  return PLACIDO_OK;
}

static int fill_pupil(placido_pupil *pupil, sight *s, int threads, placido_error *err) {
  double pupil_mm = 2 * rim_mm(s);
  double across = ceil(fmin(fmax(pupil_mm / surface_spacing_mm, SAMPLES_LEAST), SAMPLES_MOST));
  s->spacing_mm = pupil_mm / across;
  s->n = (int)across + 2 * MARGIN;
  size_t area = (size_t)s->n * (size_t)s->n;
  double *opd_um = placido_memory_new(area, sizeof *opd_um, err);
  double *amplitude = placido_memory_new(area, sizeof *amplitude, err);
  s->x_mm = placido_memory_new(area, 2 * sizeof *s->x_mm, err);
  if (opd_um == NULL || amplitude == NULL || s->x_mm == NULL) {
    placido_memory_free(opd_um);
    placido_memory_free(amplitude);
    placido_memory_free(s->x_mm);
    return PLACIDO_MEMORY;
  }
  s->y_mm = s->x_mm + area;
#pragma omp parallel for num_threads(threads) schedule(static, 8) if (threads > 1)
  for (int row = 0; row < s->n; row++) {
    trace_line(opd_um + (size_t)row * (size_t)s->n, s, row);
  }
  find_amplitude(amplitude, s);
  placido_memory_free(s->x_mm);
  take(pupil, opd_um, s->n, pupil_mm, s->spacing_mm);
  pupil->amplitude = amplitude;
  return PLACIDO_OK;
}

int placido_pupil_of_surface(placido_pupil *pupil, const placido_surface *surface,
                             const placido_eye *eye, const double focus_mm[3], int threads,
                             placido_error *err) {
  placido_eye settled;
  sight s;
  *pupil = (placido_pupil){0};
  int status = placido_eye_settle(&settled, eye, err);
  if (status == PLACIDO_OK && (threads < 1 || threads > 256)) {
    status = placido_error_set(err, PLACIDO_INPUT, "%d threads, expected 1 to 256", threads);
  }
  if (status == PLACIDO_OK) {
    status = look(&s, surface, &settled, focus_mm, err);
  }
  return status == PLACIDO_OK ? fill_pupil(pupil, &s, threads, err) : status;
}

void placido_pupil_free(placido_pupil *pupil) {
  if (pupil != NULL) {
    placido_memory_free((double *)pupil->opd_um);
    placido_memory_free((double *)pupil->amplitude);
    *pupil = (placido_pupil){0};
  }
}
