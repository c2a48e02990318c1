/* Planes of light spread by point spread functions: every tile of every plane is a job of its own,
 * whose result does not depend on who does it. */
#include "base/memory.h"
#include "simulate/convolve/layout.h"
#include "simulate/convolve/tile.h"
#include "simulate/convolve/wisdom.h"

#include <placido/convolution.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE_MAX_PX 65536
#define SIZE_MAX_PX 16384 /* of a transform that is asked for: a gigabyte of floats */
#define THREADS_MAX 256
#define MEGABYTE 1e6

static const double usual_memory_MB = 1024;

struct placido_convolver {
  const placido_precision *precision;
  placido_layout layout;
  placido_plans plans;
  int width, height, reach, threads;
};

/* `spectrum` is NULL where the light is in one bucket: then it moves by dx, dy. */
struct placido_transfer {
  void *spectrum;
  int dx, dy;
  float value;
};

int placido_psf_reach(const placido_psf *psf) {
  int reach = 0;
  for (int row = 0; psf->values != NULL && row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      int x = abs(column - psf->n / 2), y = abs(row - psf->n / 2), far = x > y ? x : y;
      bool dark = psf->values[(size_t)row * (size_t)psf->n + (size_t)column] == 0;
      reach = !dark && far > reach ? far : reach;
    }
  }
  return reach;
}

static int check(int width, int height, int reach, const placido_convolution *how,
                 placido_error *err) {
  if (width < 1 || width > SIDE_MAX_PX || height < 1 || height > SIDE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT, "convolution of %d by %d pixels, expected 1 to %d",
                             width, height, SIDE_MAX_PX);
  }
  if (reach < 0 || reach > SIDE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT, "a PSF that reaches %d pixels, expected 0 to %d",
                             reach, SIDE_MAX_PX);
  }
  if (!(how->memory_MB >= 0)) {
    return placido_error_set(err, PLACIDO_INPUT, "%g MB for a convolution, expected 0 or more",
                             how->memory_MB);
  }
  if (how->size_px < 0 || how->size_px > SIZE_MAX_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "transforms of at least %d samples a side, expected 0 to %d",
                             how->size_px, SIZE_MAX_PX);
  }
  if (how->threads < 0 || how->threads > THREADS_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "%d threads, expected 0 to %d", how->threads,
                             THREADS_MAX);
  }
  return PLACIDO_OK;
}

static int plan(placido_convolver *c, const placido_convolution *how, placido_notes *notes,
                placido_error *err) {
  placido_workspace work;
  placido_shape shape = placido_shape_of(&c->layout, c->precision);
  int status = placido_workspace_new(&work, &shape, c->precision, false, err);
  if (status == PLACIDO_OK) {
    status =
        placido_plans_new(&c->plans, &shape, c->precision, &work, how->wisdom_folder, notes, err);
  }
  placido_workspace_free(&work);
  return status;
}

int placido_convolver_new(placido_convolver **convolver, int width_px, int height_px, int reach_px,
                          const placido_convolution *how, placido_notes *notes,
                          placido_error *err) {
  const placido_convolution usual = {0};
  how = how != NULL ? how : &usual;
  *convolver = NULL;
  int status = check(width_px, height_px, reach_px, how, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_convolver *c = placido_memory_new(1, sizeof *c, err);
  if (c == NULL) {
    return PLACIDO_MEMORY;
  }
  double bytes = MEGABYTE * (how->memory_MB > 0 ? how->memory_MB : usual_memory_MB);
  c->precision = how->doubles ? &placido_precision_double : &placido_precision_float;
  c->layout = placido_layout_find(width_px, height_px, reach_px, bytes, how->size_px,
                                  c->precision->sample_bytes);
  c->width = width_px;
  c->height = height_px;
  c->reach = reach_px;
  c->threads = how->threads > 0 ? how->threads : 1;
  status = plan(c, how, notes, err);
  if (status != PLACIDO_OK) {
    placido_memory_free(c);
    return status;
  }
  *convolver = c;
  return PLACIDO_OK;
}

void placido_convolver_free(placido_convolver *convolver) {
  if (convolver != NULL) {
    placido_plans_free(&convolver->plans, convolver->precision);
    placido_memory_free(convolver);
  }
}

static int check_psf(const placido_convolver *c, const placido_psf *psf, placido_error *err) {
  if (psf->values == NULL || psf->n < 1 || psf->n % 2 == 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a PSF of %d buckets a side, expected an odd number",
                             psf->values != NULL ? psf->n : 0);
  }
  for (size_t i = 0; i < (size_t)psf->n * (size_t)psf->n; i++) {
    if (!isfinite(psf->values[i])) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "the PSF's bucket %zu of row %zu is not a number",
                               i % (size_t)psf->n, i / (size_t)psf->n);
    }
  }
  int reach = placido_psf_reach(psf);
  if (reach > c->reach) {
    return placido_error_set(err, PLACIDO_INPUT, "a PSF reaches %d buckets, expected at most %d",
                             reach, c->reach);
  }
  return PLACIDO_OK;
}

/* Whether at most one bucket has light: which, and how much. */
static bool find_shift(placido_transfer *transfer, const placido_psf *psf) {
  int found = 0;
  for (int row = 0; row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      double value = psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
      if (value != 0) {
        transfer->dx = column - psf->n / 2;
        transfer->dy = row - psf->n / 2;
        transfer->value = (float)value;
        found++;
      }
    }
  }
  return found <= 1;
}

static int transform(placido_transfer *transfer, const placido_convolver *c, const placido_psf *psf,
                     placido_error *err) {
  const placido_shape *shape = &c->plans.shape;
  placido_workspace work;
  int status = placido_workspace_new(&work, shape, c->precision, false, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  transfer->spectrum = placido_memory_new_aligned(
      (size_t)shape->blocks * shape->column * c->precision->sample_bytes, err);
  if (transfer->spectrum != NULL) {
    c->precision->transform(&c->plans, &work, psf, transfer->spectrum);
  }
  placido_workspace_free(&work);
  return transfer->spectrum != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
}

int placido_transfer_new(placido_transfer **transfer, const placido_convolver *convolver,
                         const placido_psf *psf, placido_error *err) {
  *transfer = NULL;
  int status = check_psf(convolver, psf, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_transfer *made = placido_memory_new(1, sizeof *made, err);
  if (made == NULL) {
    return PLACIDO_MEMORY;
  }
  if (!find_shift(made, psf)) {
    status = transform(made, convolver, psf, err);
  }
  if (status != PLACIDO_OK) {
    placido_memory_free(made);
    return status;
  }
  *transfer = made;
  return PLACIDO_OK;
}

void placido_transfer_free(placido_transfer *transfer) {
  if (transfer != NULL) {
    placido_memory_free(transfer->spectrum);
    placido_memory_free(transfer);
  }
}

/* What a tile gives of the plane becomes dark. */
static void clear_spot(float *target, const placido_spot *spot) {
  for (int y = 0; y < spot->y.count; y++) {
    memset(&target[(size_t)(spot->y.first + y) * (size_t)spot->width + (size_t)spot->x.first], 0,
           (size_t)spot->x.count * sizeof *target);
  }
}

static int clamp(int value, int low, int high) {
  return value < low ? low : value > high ? high : value;
}

/* A term whose light is in one bucket: its source, moved. */
static void add_moved(float *target, const placido_convolver *c, const placido_spot *spot,
                      const placido_convolution_term *term) {
  const placido_transfer *by = term->transfer;
  int left = spot->x.first, top = spot->y.first;
  int first_x = clamp(by->dx, left, left + spot->x.count);
  int end_x = clamp(by->dx + c->width, left, left + spot->x.count);
  int first_y = clamp(by->dy, top, top + spot->y.count);
  int end_y = clamp(by->dy + c->height, top, top + spot->y.count);
  for (int y = first_y; y < end_y; y++) {
    float *to = target + (size_t)y * (size_t)c->width;
    const float *from = term->source + (size_t)(y - by->dy) * (size_t)c->width;
    for (int x = first_x; x < end_x; x++) {
      to[x] += by->value * from[x - by->dx];
    }
  }
}

/* Terms that need transforms, from `from` on; plane->count where there is none. */
static size_t next_transform(const placido_superposition *plane, size_t from) {
  while (from < plane->count && plane->terms[from].transfer->spectrum == NULL) {
    from++;
  }
  return from;
}

static void fill_tile(const placido_convolver *c, const placido_workspace *work,
                      const placido_superposition *plane, int index) {
  const placido_layout *layout = &c->layout;
  const placido_spot spot = {.width = c->width,
                             .x = placido_axis_stretch(&layout->x, index % layout->x.tiles),
                             .y = placido_axis_stretch(&layout->y, index / layout->x.tiles)};
  size_t first = next_transform(plane, 0);
  for (size_t i = first, next; i < plane->count; i = next) {
    next = next_transform(plane, i + 1);
    c->precision->add_term(&c->plans, work, &spot, plane->terms[i].source,
                           plane->terms[i].transfer->spectrum,
                           (placido_turn){.first = i == first, .last = next == plane->count});
  }
  if (first < plane->count) {
    c->precision->take(&c->plans, work, &spot, plane->target);
  } else {
    clear_spot(plane->target, &spot);
  }
  for (size_t i = 0; i < plane->count; i++) {
    if (plane->terms[i].transfer->spectrum == NULL) {
      add_moved(plane->target, c, &spot, &plane->terms[i]);
    }
  }
}

/* What the planes need to be worked on: nothing, a tile, or also the sum of tiles. */
static void find_need(const placido_superposition *planes, size_t count, bool *transforms,
                      bool *sums) {
  *transforms = *sums = false;
  for (size_t i = 0; i < count; i++) {
    size_t first = next_transform(&planes[i], 0);
    if (first < planes[i].count) {
      *transforms = true;
      *sums = *sums || next_transform(&planes[i], first + 1) < planes[i].count;
    }
  }
}

/* Every `workers`-th tile from `first` on. */
static void work_on(const placido_convolver *c, const placido_workspace *work,
                    const placido_superposition *planes, size_t count, size_t first,
                    size_t workers) {
  size_t tiles = (size_t)c->layout.x.tiles * (size_t)c->layout.y.tiles;
  for (size_t job = first; job < count * tiles; job += workers) {
    fill_tile(c, work, &planes[job / tiles], (int)(job % tiles));
  }
}

int placido_convolver_run(const placido_convolver *convolver, const placido_superposition *planes,
                          size_t count, placido_error *err) {
  const placido_convolver *c = convolver;
  placido_workspace works[THREADS_MAX] = {0};
  size_t jobs = count * (size_t)c->layout.x.tiles * (size_t)c->layout.y.tiles;
  int workers = jobs >= (size_t)c->threads ? c->threads : jobs > 0 ? (int)jobs : 1;
  int status = PLACIDO_OK;
  bool transforms, sums;
  find_need(planes, count, &transforms, &sums);
  for (int i = 0; i < workers && transforms && status == PLACIDO_OK; i++) {
    status = placido_workspace_new(&works[i], &c->plans.shape, c->precision, sums, err);
  }
  if (status == PLACIDO_OK) {
#pragma omp parallel for num_threads(workers)
    for (int i = 0; i < workers; i++) {
      work_on(c, &works[i], planes, count, (size_t)i, (size_t)workers);
    }
  }
  for (int i = 0; i < workers; i++) {
    placido_workspace_free(&works[i]);
  }
  return status;
}
