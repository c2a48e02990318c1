/* The radial polynomials that both a surface's part and a wavefront's terms are made of. */
#ifndef PLACIDO_SURFACE_ZERNIKE_H
#define PLACIDO_SURFACE_ZERNIKE_H

#include <placido/zernike.h>

#define PLACIDO_ZERNIKE_POWERS (PLACIDO_ZERNIKE_ORDER_MAX / 2 + 1)

/* A term of order n and frequency m is a polynomial in s = x² + y² times the real (m >= 0) or
 * imaginary part of (x + iy)^|m|: writes that polynomial's coefficients, with the normalisation,
 * by power of s, and returns how many they are. */
int placido_zernike_radial(double powers[PLACIDO_ZERNIKE_POWERS], int n, int m);

#endif
