/* The field over the pupil on the transform's own grid.
 *
 * A wavefront is smooth where its phase is not: it is interpolated from the given grid by cubics
 * through four samples a direction (Lagrange), and only then becomes a phase. A cell that the rim
 * crosses counts by its area inside; with whole cells the image converges erratically. */
#include "simulate/psf/diffraction.h"

#include "base/dispatch.h"
#include "simulate/eye.h"
#include "simulate/quality/disc.h"

#include <math.h>

enum { TAPS = 4 };

/* Where a place lies among `n` samples, and the cubic's weights of the four from the first on;
 * beyond the last sample the cubic goes on. */
static int find_taps(double weights[TAPS], double place, int n) {
  double first = fmin(fmax(floor(place) - 1, 0), n - TAPS), t = place - first;
  weights[0] = (t - 1) * (t - 2) * (t - 3) / -6;
  weights[1] = t * (t - 2) * (t - 3) / 2;
  weights[2] = t * (t - 1) * (t - 3) / -2;
  weights[3] = t * (t - 1) * (t - 2) / 6;
  return (int)first;
}

/* The same along a line. */
static int find_linear(double weights[2], double place, int n) {
  double first = fmin(fmax(floor(place), 0), n - 2), t = fmin(fmax(place - first, 0), 1);
  weights[0] = 1 - t;
  weights[1] = t;
  return (int)first;
}

PLACIDO_WIDE
static void blend_rows(double *line, const double *rows, size_t n, const double weights[TAPS]) {
  for (size_t i = 0; i < n; i++) {
    line[i] = weights[0] * rows[i] + weights[1] * rows[n + i] + weights[2] * rows[2 * n + i] +
              weights[3] * rows[3 * n + i];
  }
}

PLACIDO_WIDE
static void blend_two(double *line, const double *rows, size_t n, const double weights[2]) {
  for (size_t i = 0; i < n; i++) {
    line[i] = weights[0] * rows[i] + weights[1] * rows[n + i];
  }
}

/* cos and sin of 2 pi t, |t| <= 1/2, times the height: Taylor's series of half the angle, doubled;
 * errors below 1e-6. */
PLACIDO_WIDE
static void turn(float *field, const float *turns, const float *height, size_t count) {
  for (size_t i = 0; i < count; i++) {
    float h = 3.14159265f * turns[i], s = h * h;
    float sine =
      h * (1 + s * (-1.66666667e-1f +
                    s * (8.33333333e-3f +
                         s * (-1.98412698e-4f + s * (2.75573192e-6f - 2.50521084e-8f * s)))));
    float cosine =
      1 + s * (-0.5f +
               s * (4.16666667e-2f +
                    s * (-1.38888889e-3f +
                         s * (2.48015873e-5f + s * (-2.75573192e-7f + 2.0876757e-9f * s)))));
    field[2 * i] = height[i] * (1 - 2 * sine * sine);
    field[2 * i + 1] = height[i] * (2 * sine * cosine);
  }
}

/* What is worked on: columns of taps, a line of blended rows, and a row of cells. */
typedef struct workshop {
  double *taps, *line;     /* TAPS a column; as many as the front has */
  double *pairs, *bright;  /* two a column, and a line, of the amplitude */
  double *extra_um;        /* a column: defocus and tilt */
  float *turns, *height;
  int *first, *first_pair; /* a column */
} workshop;

size_t placido_field_work(const placido_front *front, int n) {
  return 2 * (size_t)front->n + (TAPS + 5) * (size_t)n + 16;
}

static workshop lay_out(double *work, const placido_front *front, int n) {
  size_t m = (size_t)n, given = (size_t)front->n;
  workshop w = {.taps = work};
  w.line = w.taps + TAPS * m;
  w.pairs = w.line + given;
  w.bright = w.pairs + 2 * m;
  w.extra_um = w.bright + given;
  w.turns = (float *)(void *)(w.extra_um + m);
  w.height = w.turns + m;
  w.first = (int *)(void *)(w.height + m);
  w.first_pair = w.first + m;
  return w;
}

/* The path difference that defocus and tilt of the wave add along one axis. */
static double extra_um(double place_mm, const placido_wave *wave, double tilt_arcmin) {
  return 0.5 * wave->defocus_D * place_mm * place_mm -
         1e3 * PLACIDO_ARCMIN_RAD * tilt_arcmin * place_mm;
}

static void prepare_columns(workshop *w, int n, double spacing_mm, const placido_front *front,
                            const placido_wave *wave) {
  for (int i = 0; i < n; i++) {
    double x = (i - 0.5 * (n - 1)) * spacing_mm;
    double place = x / front->spacing_mm + 0.5 * (front->n - 1);
    w->first[i] = find_taps(w->taps + TAPS * i, place, front->n);
    w->first_pair[i] = find_linear(w->pairs + 2 * i, place, front->n);
    w->extra_um[i] = extra_um(x, wave, wave->x_arcmin);
  }
}

/* Areas within the pupil of a row's cells, in cells, from `from` up to `to`. */
static void weigh(float *height, int from, int to, int n, double y, double spacing_mm,
                  double radius_mm) {
  double half = 0.5 * spacing_mm, far = fabs(y) + half;
  double whole = far < radius_mm ? sqrt(radius_mm * radius_mm - far * far) - half : -1;
  for (int i = from; i < to; i++) {
    double x = (i - 0.5 * (n - 1)) * spacing_mm;
    height[i] = fabs(x) <= whole ? 1
                                 : (float)(placido_disc_area(radius_mm, x - half, x + half,
                                                             y - half, y + half) /
                                           (spacing_mm * spacing_mm));
  }
}

/* Path differences of a row's cells in turns of the phase, less whole ones. */
static void interpolate(workshop *w, int from, int to, double y_extra_um, double wavelength_um) {
  double waves = 1 / wavelength_um;
  for (int i = from; i < to; i++) {
    const double *line = w->line + w->first[i], *taps = w->taps + TAPS * i;
    double opd_um = taps[0] * line[0] + taps[1] * line[1] + taps[2] * line[2] + taps[3] * line[3];
    double turns = (opd_um + w->extra_um[i] + y_extra_um) * waves;
    w->turns[i] = (float)(turns - rint(turns));
  }
}

/* Turns areas into heights of the field; returns the row's light. */
static double light_row(workshop *w, int from, int to, bool amplitude) {
  double light = 0;
  for (int i = from; i < to; i++) {
    const double *line = w->bright + w->first_pair[i], *pairs = w->pairs + 2 * i;
    double bright = amplitude ? pairs[0] * line[0] + pairs[1] * line[1] : 1;
    light += w->height[i] * bright * bright;
    w->height[i] = (float)(w->height[i] * bright);
  }
  return light;
}

double placido_field_fill(float *field, size_t stride, int n, double spacing_mm,
                          const placido_front *front, const placido_wave *wave, double *work) {
  workshop w = lay_out(work, front, n);
  double radius = front->pupil_mm / 2, light = 0, taps[TAPS], pair[2];
  prepare_columns(&w, n, spacing_mm, front, wave);
  for (int j = 0; j < n; j++) {
    double y = (j - 0.5 * (n - 1)) * spacing_mm;
    double near = fmax(fabs(y) - 0.5 * spacing_mm, 0);
    if (near >= radius) {
      continue;
    }
    double reach = sqrt(radius * radius - near * near) / spacing_mm + 0.5;
    int from = (int)fmax(ceil(0.5 * (n - 1) - reach), 0), to = n - from;
    double place = y / front->spacing_mm + 0.5 * (front->n - 1);
    int row = find_taps(taps, place, front->n);
    blend_rows(w.line, front->opd_um + (size_t)row * (size_t)front->n, (size_t)front->n, taps);
    if (front->amplitude != NULL) {
      row = find_linear(pair, place, front->n);
      blend_two(w.bright, front->amplitude + (size_t)row * (size_t)front->n, (size_t)front->n,
                pair);
    }
    weigh(w.height, from, to, n, y, spacing_mm, radius);
    light += light_row(&w, from, to, front->amplitude != NULL);
    interpolate(&w, from, to, extra_um(y, wave, wave->y_arcmin), 1e-3 * wave->wavelength_nm);
    turn(field + 2 * ((size_t)j * stride + (size_t)from), w.turns + from, w.height + from,
         (size_t)(to - from));
  }
  return light;
}
