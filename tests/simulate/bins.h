/* Where light lies, in bins of several pixels: rays that are drawn at random leave little noise
 * there. */
#ifndef PLACIDO_TESTS_SIMULATE_BINS_H
#define PLACIDO_TESTS_SIMULATE_BINS_H

/* Sums of side * side pixels over bin * bin of them, which `side` is a multiple of. */
void bin_up(double *binned, const double *seen, int side, int bin);

/* The light that lies elsewhere, as a share of all in `other`. */
double misplaced(const double *one, const double *other, int bins);

#endif
