/* The passes over a padded tile, compiled once for each precision: tile_float.c and tile_double.c
 * say which by SAMPLE, the type of a sample, FFTW(name), the name in FFTW's library of that type,
 * and TABLE, the name of what is defined. C has no other way to write this once.
 *
 * A plane is transformed by rows and columns. Only rows that hold light are transformed, and only
 * rows of the result transformed back. A block of columns is turned, transformed, multiplied by its
 * part of the transfer function and brought back while it lies in the cache: the plane goes through
 * memory three times, where a transform forward, a product and a transform back take it five. */
#include "base/dispatch.h"
#include "simulate/convolve/tile.h"

#include <fftw3.h>
#include <string.h>

static char *wisdom_get(void) {
  return FFTW(export_wisdom_to_string)();
}

static bool wisdom_put(const char *text) {
  return FFTW(import_wisdom_from_string)(text) != 0;
}

static void wisdom_forget(void) {
  FFTW(forget_wisdom)();
}

static FFTW(plan) plan_block(const placido_shape *s, SAMPLE *block, SAMPLE *column, int sign,
                             unsigned how) {
  FFTW(complex) *rows = (FFTW(complex) *)(void *)block, *turned = (FFTW(complex) *)(void *)column;
  int n = s->rows, k = s->lanes;
  if (sign == FFTW_FORWARD) {
    return FFTW(plan_many_dft)(1, &n, k, rows, NULL, k, 1, turned, NULL, 1, n, sign, how);
  }
  return FFTW(plan_many_dft)(1, &n, k, turned, NULL, 1, n, rows, NULL, k, 1, sign, how);
}

static bool make_plans(placido_plans *plans, const placido_workspace *work, bool measure) {
  const placido_shape *s = &plans->shape;
  FFTW(complex) *row = work->row;
  unsigned how = (measure ? FFTW_MEASURE : FFTW_ESTIMATE) | FFTW_DESTROY_INPUT;
  unsigned keep = (how & ~FFTW_DESTROY_INPUT) | FFTW_PRESERVE_INPUT; /* zeros stay beside a row */
  plans->row_forward = FFTW(plan_dft_r2c_1d)(s->columns, work->samples, row, keep);
  plans->row_backward = FFTW(plan_dft_c2r_1d)(s->columns, row, work->samples, how);
  plans->columns_forward = plan_block(s, work->spectrum, work->column, FFTW_FORWARD, how);
  plans->columns_backward = plan_block(s, work->spectrum, work->column, FFTW_BACKWARD, how);
  return plans->row_forward != NULL && plans->row_backward != NULL &&
         plans->columns_forward != NULL && plans->columns_backward != NULL;
}

static void free_plans(placido_plans *plans) {
  void *all[] = {plans->row_forward, plans->row_backward, plans->columns_forward,
                 plans->columns_backward};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    if (all[i] != NULL) {
      FFTW(destroy_plan)(all[i]);
    }
  }
}

/* A row's spectrum to its place in every block, and back. */
static void scatter_row(const placido_shape *s, SAMPLE *spectrum, const SAMPLE *row, int y) {
  size_t line = 2 * (size_t)s->lanes;
  SAMPLE *to = spectrum + line * (size_t)y;
  for (int block = 0; block < s->blocks; block++, to += s->block, row += line) {
    memcpy(to, row, PLACIDO_LINE_BYTES);
  }
}

static void gather_row(const placido_shape *s, SAMPLE *row, const SAMPLE *spectrum, int y) {
  size_t line = 2 * (size_t)s->lanes;
  const SAMPLE *from = spectrum + line * (size_t)y;
  for (int block = 0; block < s->blocks; block++, from += s->block, row += line) {
    memcpy(row, from, PLACIDO_LINE_BYTES);
  }
}

static void transform_row(const placido_plans *plans, const placido_workspace *work, int y) {
  FFTW(execute_dft_r2c)(plans->row_forward, work->samples, work->row);
  scatter_row(&plans->shape, work->spectrum, work->row, y);
}

/* Zeros rows of a block that no row of light was written to. */
static void clear_rows(const placido_shape *s, SAMPLE *block, int first, int end) {
  size_t line = 2 * (size_t)s->lanes;
  memset(block + line * (size_t)first, 0, line * (size_t)(end - first) * sizeof *block);
}

/* spectrum *= transfer, complex numbers in pairs. */
PLACIDO_WIDE
static void multiply(SAMPLE *restrict a, const SAMPLE *restrict b, size_t samples) {
  for (size_t i = 0; i < samples; i += 2) {
    SAMPLE re = a[i] * b[i] - a[i + 1] * b[i + 1];
    SAMPLE im = a[i] * b[i + 1] + a[i + 1] * b[i];
    a[i] = re;
    a[i + 1] = im;
  }
}

PLACIDO_WIDE
static void add_product(SAMPLE *restrict sum, const SAMPLE *restrict a, const SAMPLE *restrict b,
                        size_t samples) {
  for (size_t i = 0; i < samples; i += 2) {
    sum[i] += a[i] * b[i] - a[i + 1] * b[i + 1];
    sum[i + 1] += a[i] * b[i + 1] + a[i + 1] * b[i];
  }
}

/* The PSF's middle goes to (0, 0), the negative side wraps to the far end; what reaches farther
 * than the plane meets nothing and is left out. */
static void place_psf_row(const placido_shape *s, SAMPLE *samples, const placido_psf *psf,
                          int row) {
  int half = psf->n / 2, reach = half < s->reach_x ? half : s->reach_x;
  const double *values = &psf->values[(size_t)row * (size_t)psf->n + (size_t)half];
  double scale = 1.0 / ((double)s->columns * s->rows);
  memset(samples, 0, (size_t)s->columns * sizeof *samples);
  for (int x = -reach; x <= reach; x++) {
    samples[x < 0 ? x + s->columns : x] = (SAMPLE)(values[x] * scale);
  }
}

static void transform(const placido_plans *plans, const placido_workspace *work,
                      const placido_psf *psf, void *transfer) {
  const placido_shape *s = &plans->shape;
  int half = psf->n / 2, reach = half < s->reach_y ? half : s->reach_y;
  SAMPLE *spectrum = work->spectrum, *turned = transfer;
  for (int y = -reach; y <= reach; y++) {
    place_psf_row(s, work->samples, psf, y + half);
    transform_row(plans, work, y < 0 ? y + s->rows : y);
  }
  for (int block = 0; block < s->blocks; block++, spectrum += s->block, turned += s->column) {
    clear_rows(s, spectrum, reach + 1, s->rows - reach);
    FFTW(execute_dft)(plans->columns_forward, (void *)spectrum, (void *)turned);
  }
}

static void transform_source(const placido_plans *plans, const placido_workspace *work,
                             const placido_spot *spot, const float *source) {
  SAMPLE *samples = work->samples;
  memset(samples, 0, (size_t)plans->shape.columns * sizeof *samples);
  for (int y = 0; y < spot->y.used; y++) {
    const float *from = source + (size_t)(spot->y.from + y) * (size_t)spot->width + spot->x.from;
    for (int x = 0; x < spot->x.used; x++) {
      samples[spot->x.at + x] = (SAMPLE)from[x];
    }
    transform_row(plans, work, spot->y.at + y);
  }
}

static void add_term(const placido_plans *plans, const placido_workspace *work,
                     const placido_spot *spot, const float *source, const void *transfer,
                     placido_turn turn) {
  const placido_shape *s = &plans->shape;
  SAMPLE *block = work->spectrum;
  const SAMPLE *factor = transfer;
  bool alone = turn.first && turn.last;
  size_t step = alone ? 0 : s->column; /* a lone term's sum is forgotten block by block */
  SAMPLE *sum = alone ? work->column : work->sum;
  transform_source(plans, work, spot, source);
  for (int i = 0; i < s->blocks; i++, block += s->block, factor += s->column, sum += step) {
    SAMPLE *turned = turn.first ? sum : work->column;
    clear_rows(s, block, 0, spot->y.at);
    clear_rows(s, block, spot->y.at + spot->y.used, s->rows);
    FFTW(execute_dft)(plans->columns_forward, (void *)block, (void *)turned);
    if (turn.first) {
      multiply(sum, factor, s->column);
    } else {
      add_product(sum, turned, factor, s->column);
    }
    if (turn.last) {
      FFTW(execute_dft)(plans->columns_backward, (void *)sum, (void *)block);
    }
  }
}

static void take(const placido_plans *plans, const placido_workspace *work,
                 const placido_spot *spot, float *target) {
  const SAMPLE *samples = work->samples;
  for (int y = 0; y < spot->y.count; y++) {
    float *to = target + (size_t)(spot->y.first + y) * (size_t)spot->width + spot->x.first;
    gather_row(&plans->shape, work->row, work->spectrum, spot->y.lead + y);
    FFTW(execute_dft_c2r)(plans->row_backward, work->row, work->samples);
    for (int x = 0; x < spot->x.count; x++) {
      to[x] = (float)samples[spot->x.lead + x];
    }
  }
}

const placido_precision TABLE = {.name = PRECISION,
                                 .sample_bytes = sizeof(SAMPLE),
                                 .wisdom_get = wisdom_get,
                                 .wisdom_put = wisdom_put,
                                 .wisdom_forget = wisdom_forget,
                                 .make_plans = make_plans,
                                 .free_plans = free_plans,
                                 .transform = transform,
                                 .add_term = add_term,
                                 .take = take};
