/* Slopes: a ray is the wavefront's normal (Malus), so a cell of the pupil sends its light in the
 * direction of the path's gradient, over the parallelogram that its second derivatives make of the
 * cell. Gradients are fourth-order differences; a wave's defocus and shift are added to them, so
 * that many wavelengths cost one set. */
#include "simulate/psf/slopes.h"

#include "base/dispatch.h"
#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/psf/diffraction.h"
#include "simulate/psf/tally.h"
#include "simulate/quality/disc.h"

#include <math.h>

enum { TAPS = 5, COLUMNS = 8, TOGETHER = 256 };

/* First derivatives at each of five samples in a row, in twelfths. */
static const double differences[TAPS][TAPS] = {{-25, 48, -36, 16, -3},
                                               {-3, -10, 18, -6, 1},
                                               {1, -8, 0, 8, -1},
                                               {-1, 6, -18, 10, 3},
                                               {3, -16, 36, -48, 25}};

/* Cells of the pupil with light, a column for each figure: places, first derivatives of the path
 * (micrometres a millimetre: thousandths of a radian), second ones (dioptres), light; all of it
 * sums to 1. */
typedef struct cells {
  size_t count;
  double spacing_mm;
  double *x_mm, *y_mm, *along_x, *along_y, *xx, *xy, *yy, *light;
  double *block;
} cells;

static int cells_new(cells *c, size_t room, placido_error *err) {
  *c = (cells){.block = placido_memory_new(room, COLUMNS * sizeof *c->block, err)};
  if (c->block == NULL) {
    return PLACIDO_MEMORY;
  }
  double **columns[COLUMNS] = {&c->x_mm, &c->y_mm, &c->along_x, &c->along_y,
                               &c->xx,   &c->xy,   &c->yy,      &c->light};
  for (size_t i = 0; i < COLUMNS; i++) {
    *columns[i] = c->block + i * room;
  }
  return PLACIDO_OK;
}

static int within(int value, int least, int most) {
  return value < least ? least : value > most ? most : value;
}

/* The derivative at place `at` of a line of n samples `step` apart. */
static double slope(const double *line, size_t step, int at, int n, double spacing) {
  int first = within(at - TAPS / 2, 0, n - TAPS);
  const double *weight = differences[at - first];
  double sum = 0;
  for (int k = 0; k < TAPS; k++) {
    sum += weight[k] * line[(size_t)(first + k) * step];
  }
  return sum / (12 * spacing);
}

static void add_cell(cells *c, const placido_front *f, int column, int row, double light) {
  const size_t n = (size_t)f->n, i = c->count++;
  const double h = f->spacing_mm, square = h * h;
  const double *w = f->opd_um + (size_t)within(row, 1, f->n - 2) * n +
                    (size_t)within(column, 1, f->n - 2);
  c->x_mm[i] = (column - 0.5 * (f->n - 1)) * h;
  c->y_mm[i] = (row - 0.5 * (f->n - 1)) * h;
  c->along_x[i] = slope(f->opd_um + (size_t)row * n, 1, column, f->n, h);
  c->along_y[i] = slope(f->opd_um + (size_t)column, n, row, f->n, h);
  c->xx[i] = (w[1] - 2 * w[0] + *(w - 1)) / square;
  c->yy[i] = (w[n] - 2 * w[0] + *(w - n)) / square;
  c->xy[i] = (w[n + 1] - w[n - 1] - *(w - n + 1) + *(w - n - 1)) / (4 * square);
  c->light[i] = light;
}

/* The part of a sample's cell that lies within the pupil. */
static double area_at(double x, double y, double h, double radius) {
  double nx = fmax(fabs(x) - h / 2, 0), ny = fmax(fabs(y) - h / 2, 0);
  double fx = fabs(x) + h / 2, fy = fabs(y) + h / 2, square = radius * radius;
  if (nx * nx + ny * ny >= square) {
    return 0;
  }
  return fx * fx + fy * fy <= square
           ? 1
           : placido_disc_area(radius, x - h / 2, x + h / 2, y - h / 2, y + h / 2) / (h * h);
}

/* A sample's light: that area times what comes through there. */
static double light_at(const placido_front *f, int column, int row) {
  double x = (column - 0.5 * (f->n - 1)) * f->spacing_mm;
  double y = (row - 0.5 * (f->n - 1)) * f->spacing_mm;
  double bright =
    f->amplitude != NULL ? f->amplitude[(size_t)row * (size_t)f->n + (size_t)column] : 1;
  return area_at(x, y, f->spacing_mm, f->pupil_mm / 2) * bright * bright;
}

static int find_cells(cells *c, const placido_front *f, placido_error *err) {
  double sum = 0;
  int status = cells_new(c, (size_t)f->n * (size_t)f->n, err);
  for (int row = 0; row < f->n && status == PLACIDO_OK; row++) {
    for (int column = 0; column < f->n; column++) {
      double light = light_at(f, column, row);
      if (light > 0) {
        add_cell(c, f, column, row, light);
        sum += light;
      }
    }
  }
  c->spacing_mm = f->spacing_mm;
  for (size_t i = 0; i < c->count; i++) {
    c->light[i] /= sum;
  }
  return status;
}

/* How a wave's angles become places: in buckets a thousandth of a radian. */
typedef struct scale {
  double middle, buckets, units; /* units of light for all of a wave's */
} scale;

/* Room for some spots, in the processor's nearest memory. */
typedef struct room {
  double x[TOGETHER], y[TOGETHER], light[TOGETHER], ax[TOGETHER], ay[TOGETHER], by[TOGETHER],
    width[TOGETHER], height[TOGETHER];
} room;

/* Places along one axis, and the parallelogram's sides along it and across. */
PLACIDO_WIDE
static void land(double *restrict to, const double *restrict along, const double *restrict place_mm,
                 size_t count, double defocus_D, double shift, double per_mrad) {
  for (size_t i = 0; i < count; i++) {
    to[i] = shift - per_mrad * (along[i] + defocus_D * place_mm[i]);
  }
}

PLACIDO_WIDE
static void find_sides(double *restrict side, const double *restrict power_D, size_t count,
                       double defocus_D, double per_D) {
  for (size_t i = 0; i < count; i++) {
    side[i] = -per_D * (power_D[i] + defocus_D);
  }
}

PLACIDO_WIDE
static void weigh(double *restrict units, const double *restrict light, size_t count, double all) {
  for (size_t i = 0; i < count; i++) {
    units[i] = floor(light[i] * all);
  }
}

static void spread_some(placido_tally *tally, room *r, const cells *c, size_t begin, size_t count,
                        const placido_wave *wave, const scale *by) {
  const double arcmin = 1e3 * PLACIDO_ARCMIN_RAD * by->buckets, side = c->spacing_mm * by->buckets;
  land(r->x, c->along_x + begin, c->x_mm + begin, count, wave->defocus_D,
       by->middle + arcmin * wave->x_arcmin, by->buckets);
  land(r->y, c->along_y + begin, c->y_mm + begin, count, wave->defocus_D,
       by->middle + arcmin * wave->y_arcmin, by->buckets);
  find_sides(r->ax, c->xx + begin, count, wave->defocus_D, side);
  find_sides(r->ay, c->xy + begin, count, 0, side);
  find_sides(r->by, c->yy + begin, count, wave->defocus_D, side);
  weigh(r->light, c->light + begin, count, by->units);
  const placido_spots spots = {.count = count, .x = r->x, .y = r->y, .light = r->light,
                               .ax = r->ax, .ay = r->ay, .bx = r->ay, .by = r->by,
                               .width = r->width, .height = r->height};
  placido_tally_spread(tally, &spots);
}

/* What all waves share. */
typedef struct job {
  const cells *c;
  const placido_wave *waves;
  size_t count;
  double weights; /* their sum */
  placido_window window;
} job;

/* Every `shares`-th piece of the cells from number `share` on. */
static void count_share(placido_tally *tally, const job *j, size_t share, size_t shares) {
  room r;
  scale by = {.middle = j->window.buckets / 2.0,
              .buckets = 1e-3 / (PLACIDO_ARCMIN_RAD * j->window.bucket_arcmin)};
  for (size_t begin = share * TOGETHER; begin < j->c->count; begin += shares * TOGETHER) {
    size_t rest = j->c->count - begin, some = rest < TOGETHER ? rest : TOGETHER;
    for (size_t i = 0; i < j->count; i++) {
      by.units = PLACIDO_TALLY_UNIT * (j->waves[i].weight / j->weights);
      if (by.units > 0) {
        spread_some(tally, &r, j->c, begin, some, &j->waves[i], &by);
      }
    }
  }
}

static double take(double *values, const placido_tally *tally, double weights) {
  double sum = 0;
  for (size_t i = 0; i < (size_t)tally->n * (size_t)tally->n; i++) {
    values[i] = (double)tally->buckets[i] * (weights / PLACIDO_TALLY_UNIT);
    sum += values[i];
  }
  return sum;
}

static int count(double *values, double *share, const job *j, placido_error *err) {
  const int n = j->window.buckets, threads = j->window.threads;
  placido_tally *tallies = placido_memory_new((size_t)threads, sizeof *tallies, err);
  int status = tallies != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  for (int i = 0; i < threads && status == PLACIDO_OK; i++) {
    status = placido_tally_new(&tallies[i], n, (n + 1) / 2, err);
  }
  if (status == PLACIDO_OK) {
#pragma omp parallel for num_threads(threads) if (threads > 1)
    for (int i = 0; i < threads; i++) {
      count_share(&tallies[i], j, (size_t)i, (size_t)threads);
    }
    for (int i = 1; i < threads; i++) {
      placido_tally_merge(&tallies[0], &tallies[i]);
    }
    *share = take(values, &tallies[0], j->weights);
  }
  for (int i = 0; i < threads && tallies != NULL; i++) {
    placido_tally_free(&tallies[i]);
  }
  placido_memory_free(tallies);
  return status;
}

static double sum_of_weights(const placido_wave *waves, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    sum += waves[i].weight;
  }
  return sum;
}

int placido_slopes(double *values, double *share, const placido_pupil *pupil,
                   const placido_wave *waves, size_t count_of_waves, const placido_window *window,
                   placido_error *err) {
  placido_front front = {0};
  cells c = {0};
  job j = {.c = &c, .waves = waves, .count = count_of_waves};
  double sum = 0;
  int status = placido_window_settle(&j.window, window, err);
  if (status == PLACIDO_OK) {
    status = placido_waves_check(waves, count_of_waves, err);
  }
  j.weights = status == PLACIDO_OK ? sum_of_weights(waves, count_of_waves) : 0;
  if (status == PLACIDO_OK && !(j.weights > 0)) {
    status = placido_error_set(err, PLACIDO_QUALITY, "no wavelength has any light");
  }
  if (status == PLACIDO_OK) {
    status = placido_front_new(&front, pupil, INFINITY, err);
  }
  if (status == PLACIDO_OK) {
    status = find_cells(&c, &front, err);
  }
  if (status == PLACIDO_OK) {
    status = count(values, &sum, &j, err);
  }
  placido_memory_free(c.block);
  placido_front_free(&front);
  if (share != NULL) {
    *share = sum;
  }
  return status;
}
