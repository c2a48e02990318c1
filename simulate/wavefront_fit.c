/* Zernike terms through scattered points: normal equations, summed up block by block of points.
 *
 * Terms: ANSI Z80.28; a term is a polynomial in the squared radius times the real or imaginary part
 * of (x + iy)^m. Normal equations by Cholesky's factorisation (Golub and Van Loan, Matrix
 * Computations, 4th ed., algorithm 4.2.1), their condition by power iteration (8.2.1). The value
 * counts as one more term, so that one sum holds matrix and right side. */
#include <placido/wavefront.h>

#include "base/dense.h"
#include "base/dispatch.h"
#include "base/memory.h"
#include "reconstruct/surface/zernike.h"

#include <math.h>
#include <string.h>

enum {
  BLOCK = 64,                                    /* points */
  COLUMNS_MAX = PLACIDO_WAVEFRONT_TERMS + 1 + 3, /* the value's, and padding */
  ITERATIONS = 60
};

static const double condition_max = 1e5;
static const double half_root = 0.70710678118654752440;

/* A block of points: by quantity while terms are computed, by point when they are multiplied. */
typedef struct block {
  double x[BLOCK], y[BLOCK], z[BLOCK], root[BLOCK]; /* root of the weight */
  double square[BLOCK], cosine[BLOCK], sine[BLOCK], radial[BLOCK], before[BLOCK];
  double rows[BLOCK * COLUMNS_MAX];
} block;

typedef struct fitting {
  int order, terms, columns; /* columns: terms, the value, padded to a multiple of 4 */
  double *sums;              /* columns * columns, lower part */
  block *points;
} fitting;

PLACIDO_WIDE
static void raise_angle(double *cosine, double *sine, const double *x, const double *y) {
  for (int i = 0; i < BLOCK; i++) {
    double real = cosine[i] * x[i] - sine[i] * y[i];
    sine[i] = cosine[i] * y[i] + sine[i] * x[i];
    cosine[i] = real;
  }
}

/* The next radial polynomial of a frequency, in place of this one, and this one in place of the one
 * before. */
PLACIDO_WIDE
static void raise_radial(double *radial, double *before, const double *square,
                         const placido_zernike_step *step) {
  const double by_s = step->by_s, constant = step->constant, back = step->before;
  for (int i = 0; i < BLOCK; i++) {
    double next = (by_s * square[i] + constant) * radial[i] - back * before[i];
    before[i] = radial[i];
    radial[i] = next;
  }
}

/* One column of the rows: the product of two quantities. */
static void put_column(double *rows, int columns, int column, double norm, const double *a,
                       const double *b) {
  for (int i = 0; i < BLOCK; i++) {
    rows[i * columns + column] = norm * a[i] * b[i];
  }
}

/* The terms of one frequency, the angle's part of which is there. */
static void evaluate_frequency(fitting *f, int m) {
  block *b = f->points;
  for (int i = 0; i < BLOCK; i++) {
    b->radial[i] = 1;
    b->before[i] = 0;
  }
  for (int n = m; n <= f->order; n += 2) {
    double norm = placido_zernike_norm(n, m);
    put_column(b->rows, f->columns, placido_zernike_index(n, m), norm, b->radial, b->cosine);
    if (m > 0) {
      put_column(b->rows, f->columns, placido_zernike_index(n, -m), norm, b->radial, b->sine);
    }
    const placido_zernike_step step = placido_zernike_step_of(m, (n - m) / 2);
    raise_radial(b->radial, b->before, b->square, &step);
  }
}

static void evaluate(fitting *f) {
  block *b = f->points;
  for (int i = 0; i < BLOCK; i++) {
    b->square[i] = b->x[i] * b->x[i] + b->y[i] * b->y[i];
    b->cosine[i] = b->root[i];
    b->sine[i] = 0;
  }
  for (int m = 0; m <= f->order; m++) {
    evaluate_frequency(f, m);
    raise_angle(b->cosine, b->sine, b->x, b->y);
  }
  put_column(b->rows, f->columns, f->terms, 1, b->z, b->root);
}

/* Adds the products of all pairs of columns, four points at a time. */
PLACIDO_WIDE
static void multiply(double *restrict sums, const double *restrict rows, int columns) {
  for (int point = 0; point < BLOCK; point += 4) {
    const double *a = rows + point * columns, *b = a + columns, *c = b + columns,
                 *d = c + columns;
    for (int i = 0; i < columns; i++) {
      double *restrict sum = sums + i * columns;
      double ai = a[i], bi = b[i], ci = c[i], di = d[i];
      for (int j = 0; j < (i | 3) + 1; j++) {
        sum[j] += (ai * a[j] + bi * b[j]) + (ci * c[j] + di * d[j]);
      }
    }
  }
}

static void sum_up(fitting *f, const double *x, const double *y, const double *z,
                   const double *weight, size_t count, size_t *used) {
  block *b = f->points;
  int filled = 0;
  *used = 0;
  for (size_t i = 0; i <= count; i++) {
    if (filled == BLOCK || (i == count && filled > 0)) {
      for (; filled < BLOCK; filled++) { /* points that count nothing */
        b->x[filled] = b->y[filled] = b->z[filled] = b->root[filled] = 0;
      }
      evaluate(f);
      multiply(f->sums, b->rows, f->columns);
      filled = 0;
    }
    double counts = i < count ? (weight != NULL ? weight[i] : 1) : 0;
    if (counts > 0 && x[i] * x[i] + y[i] * y[i] <= 1 && isfinite(z[i]) && isfinite(counts)) {
      b->x[filled] = x[i];
      b->y[filled] = y[i];
      b->z[filled] = z[i];
      b->root[filled++] = weight != NULL ? sqrt(counts) : 1;
      ++*used;
    }
  }
}

/* The matrix itself, times the vector, by way of its factor. */
static void apply(const double *factor, int terms, int columns, double *vector) {
  for (int i = 0; i < terms; i++) {
    vector[i] *= factor[i * columns + i];
    for (int k = i + 1; k < terms; k++) {
      vector[i] += factor[k * columns + i] * vector[k];
    }
  }
  for (int i = terms - 1; i >= 0; i--) {
    vector[i] *= factor[i * columns + i];
    for (int k = 0; k < i; k++) {
      vector[i] += factor[i * columns + k] * vector[k];
    }
  }
}

/* By how much a vector of length 1 grows in the end when `step` is taken again and again. */
static double growth(const double *factor, int terms, int columns,
                     void (*step)(const double *, int, int, double *)) {
  double vector[PLACIDO_WAVEFRONT_TERMS], length = 1;
  for (int i = 0; i < terms; i++) {
    vector[i] = 1 + half_root * (i % 3);
  }
  for (int k = 0; k < ITERATIONS; k++) {
    double square = 0;
    step(factor, terms, columns, vector);
    for (int i = 0; i < terms; i++) {
      square += vector[i] * vector[i];
    }
    length = sqrt(square);
    for (int i = 0; i < terms; i++) {
      vector[i] /= length;
    }
  }
  return length;
}

static int conclude(placido_zernike_fit *fit, fitting *f, const double *weight,
                    placido_error *err) {
  double right[PLACIDO_WAVEFRONT_TERMS], whole = f->sums[0];
  const double *last = f->sums + f->terms * f->columns;
  double square = last[f->terms];
  memcpy(right, last, (size_t)f->terms * sizeof *right);
  if (fit->count >= (size_t)f->terms && placido_dense_factor(f->sums, f->terms, f->columns, 1e-13)) {
    fit->condition = sqrt(growth(f->sums, f->terms, f->columns, apply) *
                          growth(f->sums, f->terms, f->columns, placido_dense_solve));
  }
  if (!(fit->condition > 0 && fit->condition < condition_max)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "%zu points do not determine the %d Zernike terms up to order %d",
                             fit->count, f->terms, f->order);
  }
  memcpy(fit->coefficients, right, (size_t)f->terms * sizeof *right);
  placido_dense_solve(f->sums, f->terms, f->columns, fit->coefficients);
  for (int j = 0; j < f->terms; j++) {
    square -= fit->coefficients[j] * right[j];
  }
  double total = weight != NULL ? whole : (double)fit->count; /* term 0 is 1 */
  fit->rms = sqrt(fmax(square, 0) / total);
  return PLACIDO_OK;
}

int placido_zernike_fit_points(placido_zernike_fit *fit, int order, const double *x,
                               const double *y, const double *z, const double *weight,
                               size_t count, placido_error *err) {
  *fit = (placido_zernike_fit){0};
  if (order < 0 || order > PLACIDO_WAVEFRONT_ORDER_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "Zernike terms of order %d, expected 0 to %d",
                             order, PLACIDO_WAVEFRONT_ORDER_MAX);
  }
  fitting *f = placido_memory_new(1, sizeof *f, err);
  if (f == NULL) {
    return PLACIDO_MEMORY;
  }
  fit->order = f->order = order;
  fit->term_count = f->terms = placido_zernike_count(order);
  f->columns = (f->terms + 4) / 4 * 4;
  size_t columns = (size_t)f->columns;
  f->sums = placido_memory_new(columns, columns * sizeof *f->sums, err);
  f->points = placido_memory_new(1, sizeof *f->points, err);
  int status = PLACIDO_MEMORY;
  if (f->sums != NULL && f->points != NULL) {
    sum_up(f, x, y, z, weight, count, &fit->count);
    status = conclude(fit, f, weight, err);
  }
  placido_memory_free(f->sums);
  placido_memory_free(f->points);
  placido_memory_free(f);
  return status;
}
