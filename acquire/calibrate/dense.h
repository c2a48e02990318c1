/* Inverse and eigenvalues of the few hundred numbers that an instrument has: symmetric n × n matrices,
 * row after row. */
#ifndef PLACIDO_CALIBRATE_DENSE_H
#define PLACIDO_CALIBRATE_DENSE_H

/* (L·Lᵀ)⁻¹ of a factor (base/dense.h). */
void placido_dense_inverse(double *inverse, const double *factor, int n);

/* The eigenvalues of a symmetric matrix, the greatest first, and the eigenvectors as rows of
 * `vectors`. Destroys `a`. */
void placido_dense_eigen(double *values, double *vectors, double *a, int n);

#endif
