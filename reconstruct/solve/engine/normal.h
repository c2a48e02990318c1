/* The normal equations of the fit: a sparse symmetric matrix whose pattern never changes, its
 * right-hand side, and its Cholesky factor. */
#ifndef PLACIDO_SOLVE_NORMAL_H
#define PLACIDO_SOLVE_NORMAL_H

#include "reconstruct/solve/engine/spline.h"

#include <placido/status.h>

typedef struct placido_normal placido_normal;

/* For a grid; values are zero. What a new set of values needs anew is numbers only, so that one may
 * be used for many fits. Free with placido_normal_free. */
int placido_normal_new(placido_normal **normal, const placido_grid *grid, placido_error *err);
void placido_normal_free(placido_normal *normal);

/* Clears values and right-hand side. */
void placido_normal_clear(placido_normal *normal);

/* Adds a cell's dense share: `block` is the lower triangle of a symmetric matrix in rows of CELL,
 * `right` the right-hand side's share, over the order² coefficients (row + j, column + i), i inner.
 */
void placido_normal_add(placido_normal *normal, int column, int row, const double *block,
                        const double *right);

/* Adds weight · discrete integral of the squared third derivatives of the spline with these
 * coefficients (thin-plate like: x³, 3 x²y, 3 xy², y³), and its gradient to the right-hand side. */
void placido_normal_smooth(placido_normal *normal, double weight, const double *coefficients);

/* The penalty of placido_normal_smooth at weight 1. */
double placido_normal_roughness(const placido_normal *normal, const double *coefficients);

/* Factorises (matrix + damping · diagonal) and solves into `step`. PLACIDO_QUALITY where the matrix
 * is not positive definite. */
int placido_normal_solve(placido_normal *normal, double damping, double *step,
                         placido_error *err);

/* Solves with the last factor for `count` more right-hand sides, one after the other in `right` as
 * the solutions in `x`; both may be the same array. Any number of threads may do so. */
int placido_normal_solve_more(const placido_normal *normal, const double *right, int count,
                              double *x, placido_error *err);

/* `count` vectors of coefficients, one after the other in `x`, whose outer products have the
 * inverse of the last factor's matrix for their mean, from as many of standard normal numbers: Lᵀ x
 * = z. */
int placido_normal_draw(const placido_normal *normal, const double *z, int count, double *x,
                        placido_error *err);

/* An estimate of the reciprocal condition number of the last factor's matrix, from the factor's
 * diagonal: the square of its least over its greatest element, which is never too small. */
double placido_normal_rcond(const placido_normal *normal);

/* The entries of the inverse of the last factor's matrix at the matrix's own pattern (Takahashi,
 * Fagan and Chen 1973): all that the variance of a point of the spline needs. `inverse` receives
 * a new array, to be read by placido_normal_variance. Free with placido_memory_free. */
int placido_normal_inverse(const placido_normal *normal, double **inverse, placido_error *err);

/* Σ x xᵀ over `count` vectors of coefficients that stand one after the other in `x`, at the
 * matrix's pattern like an inverse. Free with placido_memory_free. */
int placido_normal_outer(const placido_normal *normal, const double *x, int count,
                         double **outer, placido_error *err);

/* vᵀ inverse v for a vector v over the cell's coefficients. */
double placido_normal_variance(const placido_normal *normal, const double *inverse, int column,
                               int row, const double v[PLACIDO_SPLINE_CELL]);

/* The cell's part of an inverse (or outer product) as a full symmetric CELL × CELL matrix; beyond
 * the grid's order² it is 0. */
void placido_normal_block(const placido_normal *normal, const double *inverse, int column, int row,
                          double block[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL]);

#endif
