/* Symmetric positive definite matrices of small bandwidth: Cholesky's factor, solutions with it,
 * and the part of the inverse within the band. */
#ifndef PLACIDO_SOLVE_BAND_H
#define PLACIDO_SOLVE_BAND_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* So many columns are eliminated, and so many right-hand sides solved for, at a time. */
#define PLACIDO_BAND_PANEL 8

/* The lower triangle by columns: entry (i, j), i - j < width, is entries[j * stride + i - j]. What
 * a column has beyond its width is 0, and columns beyond `count` are those of the identity, so that
 * loops over whole panels need no borders. */
typedef struct placido_band {
  int count, width;
  int padded; /* count, and at least a width of columns beyond it */
  size_t stride;
  double *entries;
} placido_band;

/* Of zeros; the width is at least a panel's. Free with placido_band_free. PLACIDO_MEMORY. */
int placido_band_new(placido_band *band, int count, int width, placido_error *err);
void placido_band_free(placido_band *band);

/* Column j from its diagonal down. */
double *placido_band_column(const placido_band *band, int j);

/* Replaces the matrix by its factor L, A = L Lᵀ. Returns false where it is not positive definite:
 * what stands in it then is neither. */
bool placido_band_factorise(placido_band *band);

/* From here on the band is a factor. Solve L Lᵀ x = b and Lᵀ x = b in place, for `sides` vectors of
 * `count` numbers that stand one after the other. */
int placido_band_solve(const placido_band *factor, double *x, int sides, placido_error *err);
int placido_band_solve_transposed(const placido_band *factor, double *x, int sides,
                                  placido_error *err);

/* The part of the inverse within the band, into a band of the same size (Takahashi, Fagan and Chen
 * 1973). PLACIDO_MEMORY. */
int placido_band_inverse(placido_band *inverse, const placido_band *factor, placido_error *err);

#endif
