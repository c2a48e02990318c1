/* Linear algebra of the few hundred numbers that an instrument has: symmetric n × n matrices,
 * row after row. */
#ifndef PLACIDO_CALIBRATE_DENSE_H
#define PLACIDO_CALIBRATE_DENSE_H

#include <stdbool.h>

/* The Cholesky factor L of a = L·Lᵀ in place of the lower triangle, which alone is read; the upper
 * one is set to zero. False where the matrix is not positive definite. */
bool placido_dense_factor(double *a, int n);

/* Solves L·Lᵀ x = b in place of b. */
void placido_dense_solve(const double *factor, int n, double *b);

/* (L·Lᵀ)⁻¹. */
void placido_dense_inverse(double *inverse, const double *factor, int n);

/* The eigenvalues of a symmetric matrix, the greatest first, and the eigenvectors as rows of
 * `vectors`. Destroys `a`. */
void placido_dense_eigen(double *values, double *vectors, double *a, int n);

#endif
