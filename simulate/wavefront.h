/* Quadrature over the unit disc. */
#ifndef PLACIDO_SIMULATE_WAVEFRONT_H
#define PLACIDO_SIMULATE_WAVEFRONT_H

/* Nodes of `rings` circles and 3 `rings` angles, 3 rings² in all; the weights sum to 1. Exact for
 * polynomials of degree 4 rings - 2 in the radius whose frequency is below 3 rings. */
void placido_disc_quadrature(double *x, double *y, double *weight, int rings);

#endif
