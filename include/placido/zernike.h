/* The OSA/ANSI normalised circle polynomials: their indices, and their values at many points.
 * ANSI Z80.28; Thibos et al., J. Refract. Surg. 18, S652-S660 (2002), eqs. 1 to 5. */
#ifndef PLACIDO_ZERNIKE_H
#define PLACIDO_ZERNIKE_H

#include <placido/status.h>
#include <stddef.h>

#define PLACIDO_ZERNIKE_ORDER_MAX 15

/* How many terms there are up to an order: (order + 1) (order + 2) / 2. */
int placido_zernike_count(int order);

/* The OSA index j = (n (n + 2) + m) / 2 of order n and frequency m, and back. */
int placido_zernike_index(int n, int m);
void placido_zernike_name(int j, int *n, int *m);

/* Values of all terms up to `order` (0 to 15) at `count` points (x, y) in units of the pupil's
 * radius, m >= 0 with the cosine, each of mean square 1 over the unit disc. `terms` holds
 * placido_zernike_count(order) rows of `count` values: row j is term j. */
void placido_zernike_terms(double *terms, int order, const double *x, const double *y,
                           size_t count);

#endif
