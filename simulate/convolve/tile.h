/* One padded tile of a plane: rows transformed, columns transformed and multiplied and back, rows
 * back. In two precisions, each a table of functions. */
#ifndef PLACIDO_SIMULATE_CONVOLVE_TILE_H
#define PLACIDO_SIMULATE_CONVOLVE_TILE_H

#include "simulate/convolve/layout.h"

#include <placido/psf.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

#define PLACIDO_LINE_BYTES 64 /* of the cache */

/* Sizes of a padded tile. Its spectrum, columns / 2 + 1 complex numbers a row, lies in blocks of
 * `lanes` columns (a cache line), row after row: so both passes read and write whole lines in
 * order. All in samples of the precision; a complex number is two. */
typedef struct placido_shape {
  int columns, rows;
  int reach_x, reach_y; /* of the PSF, within the plane */
  int lanes, blocks;
  size_t row, block, column; /* a row's spectrum; a block; a block turned, column after column */
} placido_shape;

/* Plans of FFTW for tiles of a shape: one row; the columns of one block. */
typedef struct placido_plans {
  placido_shape shape;
  void *row_forward, *row_backward, *columns_forward, *columns_backward;
} placido_plans;

/* What one thread works in: all at multiples of 64 bytes, in one allocation. */
typedef struct placido_workspace {
  void *samples, *row; /* a row of the picture, and of its spectrum */
  void *column;
  void *spectrum, *sum; /* sum: NULL where there is one term */
} placido_workspace;

/* Where in which plane a tile lies: `width` samples from row to row. */
typedef struct placido_spot {
  int width;
  placido_stretch x, y;
} placido_spot;

/* Which of the terms of a sum: the first sets the sum, the last takes it back. */
typedef struct placido_turn {
  bool first, last;
} placido_turn;

typedef struct placido_precision {
  const char *name;
  size_t sample_bytes;

  /* FFTW's wisdom, the planner locked. `get` gives text to be freed with free(), or NULL. */
  char *(*wisdom_get)(void);
  bool (*wisdom_put)(const char *text);
  void (*wisdom_forget)(void);

  /* Plans in `work`, whose contents are lost; the planner locked. False where memory is short; what
   * was made is freed with free_plans. */
  bool (*make_plans)(placido_plans *plans, const placido_workspace *work, bool measure);
  void (*free_plans)(placido_plans *plans);

  /* A PSF's transform, blocks * column samples, with the factor that makes the pair of transforms
   * come out even. */
  void (*transform)(const placido_plans *plans, const placido_workspace *work,
                    const placido_psf *psf, void *transfer);

  /* Adds one term's spectrum times its transfer to the sum. */
  void (*add_term)(const placido_plans *plans, const placido_workspace *work,
                   const placido_spot *spot, const float *source, const void *transfer,
                   placido_turn turn);
  /* Takes the sum's plane: behind the last term. */
  void (*take)(const placido_plans *plans, const placido_workspace *work, const placido_spot *spot,
               float *target);
} placido_precision;

extern const placido_precision placido_precision_float, placido_precision_double;

placido_shape placido_shape_of(const placido_layout *layout, const placido_precision *precision);

/* `sum`: for sums of more than one term. Free with placido_workspace_free. */
int placido_workspace_new(placido_workspace *work, const placido_shape *shape,
                          const placido_precision *precision, bool sum, placido_error *err);
void placido_workspace_free(placido_workspace *work);

#endif
