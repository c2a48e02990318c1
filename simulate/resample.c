/* Resampling by separable filters whose width follows the scale: first every row, then every
 * column.
 *
 * Area: the exact share of each source pixel under the target pixel. Bicubic: Keys, IEEE Trans
 * ASSP 29 (1981) 1153, a = -1/2, stretched to the coarser of the two grids. */
#include "simulate/resample.h"

#include "base/memory.h"

#include <math.h>

/* Filter of one axis: target pixel i is the sum of weights[i * room + k] * source[first[i] + k]. */
typedef struct taps {
  int count, room;
  int *first, *used;
  float *weights;
} taps;

static void free_taps(taps *axis) {
  placido_memory_free(axis->first);
  placido_memory_free(axis->used);
  placido_memory_free(axis->weights);
}

static double keys(double t) {
  const double a = -0.5;
  t = fabs(t);
  if (t < 1) {
    return ((a + 2) * t - (a + 3)) * t * t + 1;
  }
  return t < 2 ? a * (((t - 5) * t + 8) * t - 4) : 0;
}

/* Weight of the source pixel from `at` to `at` + 1 for the target pixel `step` wide at `from`. */
static double weight_of(enum placido_resampling resampling, int at, double from, double step) {
  if (resampling == PLACIDO_RESAMPLING_AREA) {
    return fmax(fmin(at + 1, from + step) - fmax(at, from), 0);
  }
  return keys((at + 0.5 - (from + step / 2)) / fmax(step, 1));
}

/* How far beyond the target pixel's rim the filter reaches. */
static double reach_of(enum placido_resampling resampling, double step) {
  return resampling == PLACIDO_RESAMPLING_AREA ? 0 : 2 * fmax(step, 1) - step / 2;
}

static int clamp(double value, int low, int high) {
  return (int)fmin(fmax(value, low), high);
}

static void fill_tap(taps *axis, int i, int source_count, double from, double step,
                     enum placido_resampling resampling) {
  double reach = reach_of(resampling, step), sum = 0;
  int first = clamp(floor(from - reach), 0, source_count - 1);
  int last = clamp(ceil(from + step + reach) - 1, first, source_count - 1);
  float *weights = &axis->weights[(size_t)i * (size_t)axis->room];
  axis->first[i] = first;
  axis->used[i] = last - first + 1 < axis->room ? last - first + 1 : axis->room;
  for (int k = 0; k < axis->used[i]; k++) {
    sum += weight_of(resampling, first + k, from, step);
  }
  for (int k = 0; k < axis->used[i]; k++) {
    /* A target pixel that lies wholly beyond the rim takes the rim's. */
    weights[k] = sum > 0 ? (float)(weight_of(resampling, first + k, from, step) / sum)
                         : (float)(k == 0);
  }
}

/* What it got stays in `axis`, also where it fails. */
static int make_taps(taps *axis, int count, int source_count, double from, double step,
                     enum placido_resampling resampling, placido_error *err) {
  double span = step + 2 * reach_of(resampling, step);
  *axis = (taps){.count = count, .room = (int)fmin(ceil(span) + 1, source_count)};
  axis->first = placido_memory_new((size_t)count, sizeof *axis->first, err);
  axis->used = placido_memory_new((size_t)count, sizeof *axis->used, err);
  axis->weights = placido_memory_new((size_t)count * (size_t)axis->room, sizeof *axis->weights,
                                     err);
  if (axis->first == NULL || axis->used == NULL || axis->weights == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int i = 0; i < count; i++) {
    fill_tap(axis, i, source_count, from + i * step, step, resampling);
  }
  return PLACIDO_OK;
}

/* A row of the source to the target's columns. */
static void shrink_row(float *target, const float *source, const taps *columns) {
  for (int i = 0; i < columns->count; i++) {
    const float *weights = &columns->weights[(size_t)i * (size_t)columns->room];
    const float *from = &source[columns->first[i]];
    double sum = 0;
    for (int k = 0; k < columns->used[i]; k++) {
      sum += (double)weights[k] * from[k];
    }
    target[i] = (float)sum;
  }
}

/* One row of the target from rows that have its columns already. `sums` has a row's length. */
static void mix_rows(float *target, const float *rows, int width, const taps *axis, int row,
                     double *sums) {
  const float *weights = &axis->weights[(size_t)row * (size_t)axis->room];
  for (int x = 0; x < width; x++) {
    sums[x] = 0;
  }
  for (int k = 0; k < axis->used[row]; k++) {
    const float *from = &rows[(size_t)(axis->first[row] + k) * (size_t)width];
    for (int x = 0; x < width; x++) {
      sums[x] += (double)weights[k] * from[x];
    }
  }
  for (int x = 0; x < width; x++) {
    target[x] = (float)sums[x];
  }
}

/* The filters of both axes and room for one plane in between. */
typedef struct work {
  taps columns, rows;
  float *narrow; /* the target's width, the source's height */
  double *sums;  /* one row for each thread */
} work;

static void resample_plane(float *target, const float *source, int source_width, int source_height,
                           const work *room, int threads) {
  int width = room->columns.count, height = room->rows.count;
#pragma omp parallel for num_threads(threads)
  for (int y = 0; y < source_height; y++) {
    shrink_row(&room->narrow[(size_t)y * (size_t)width], &source[(size_t)y * (size_t)source_width],
               &room->columns);
  }
#pragma omp parallel for num_threads(threads)
  for (int block = 0; block < threads; block++) {
    double *sums = &room->sums[(size_t)block * (size_t)width];
    for (int y = block; y < height; y += threads) {
      mix_rows(&target[(size_t)y * (size_t)width], room->narrow, width, &room->rows, y, sums);
    }
  }
}

int placido_resample(placido_image *target, const placido_image *source, double left, double top,
                     double step, enum placido_resampling resampling, int threads,
                     placido_error *err) {
  work room = {0};
  size_t width = (size_t)target->width_px;
  int status = make_taps(&room.columns, target->width_px, source->width_px, left, step, resampling,
                         err);
  if (status == PLACIDO_OK) {
    status = make_taps(&room.rows, target->height_px, source->height_px, top, step, resampling,
                       err);
  }
  if (status == PLACIDO_OK) {
    room.narrow = placido_memory_new((size_t)source->height_px, width * sizeof *room.narrow, err);
    room.sums = placido_memory_new((size_t)threads, width * sizeof *room.sums, err);
    status = room.narrow != NULL && room.sums != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  for (int plane = 0; plane < source->planes && status == PLACIDO_OK; plane++) {
    resample_plane(placido_image_plane(target, plane), placido_image_plane(source, plane),
                   source->width_px, source->height_px, &room, threads);
  }
  placido_memory_free(room.narrow);
  placido_memory_free(room.sums);
  free_taps(&room.columns);
  free_taps(&room.rows);
  return status;
}
