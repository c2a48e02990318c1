/* Systems of a few to a few hundred unknowns: symmetric positive definite matrices, row after row,
 * `stride` numbers from one row to the next. */
#ifndef PLACIDO_BASE_DENSE_H
#define PLACIDO_BASE_DENSE_H

#include <stdbool.h>
#include <stddef.h>

/* The Cholesky factor L of a = L·Lᵀ in place of the lower triangle, which alone is read; the upper one
 * becomes zero. False where a pivot is not above `singular` times its diagonal element (0: not positive). */
bool placido_dense_factor(double *a, int n, int stride, double singular);

/* Solves L·Lᵀ x = b in place of b. */
void placido_dense_solve(const double *factor, int n, int stride, double *b);

#endif
