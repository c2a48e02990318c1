/* Downhill simplex in up to three unknowns, for objectives without derivatives. */
#ifndef PLACIDO_SIMULATE_MINIMISE_H
#define PLACIDO_SIMULATE_MINIMISE_H

#define PLACIDO_MINIMISE_MAX 3

/* A function to be made small; `user` is its own. */
typedef double placido_objective(void *user, const double *at);

/* Walks `at` (`count` unknowns, 1 to PLACIDO_MINIMISE_MAX) downhill from a simplex of edge `step`
 * until its corners lie within `tolerance` or `calls` evaluations are spent. Returns the value
 * reached, which is never above the one at the start. */
double placido_minimise(placido_objective *objective, void *user, double *at, int count,
                        double step, double tolerance, int calls);

#endif
