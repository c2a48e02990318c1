/* The radial polynomials that both a surface's part and a wavefront's terms are made of. */
#ifndef PLACIDO_SURFACE_ZERNIKE_H
#define PLACIDO_SURFACE_ZERNIKE_H

#include <placido/zernike.h>

#define PLACIDO_ZERNIKE_POWERS (PLACIDO_ZERNIKE_ORDER_MAX / 2 + 1)

/* A term of order n and frequency m is its norm times a polynomial in s = x² + y² times the real
 * (m >= 0) or imaginary part of (x + iy)^|m|. The polynomials q of one frequency, number
 * k = (n - |m|) / 2, follow from each other:
 *
 *   q_0 = 1,  q_k+1 = (by_s s + constant) q_k - before q_k-1
 *
 * In powers of s they would cancel: five digits are lost at the rim in order 15, none this way.
 * They are Jacobi's P_k^(0, m)(2 s - 1) (DLMF 18.9.2). */
typedef struct placido_zernike_step {
  double by_s, constant, before;
} placido_zernike_step;

/* From number k to the next one. */
placido_zernike_step placido_zernike_step_of(int m, int k);

double placido_zernike_norm(int n, int m);

/* The polynomial's coefficients with the norm, by power of s; returns how many they are. */
int placido_zernike_radial(double powers[PLACIDO_ZERNIKE_POWERS], int n, int m);

#endif
