/* Orders of convergence: the slope of errors on logarithmic scales, and its row in the table. */
#ifndef PLACIDO_TESTS_STABILITY_ORDER_H
#define PLACIDO_TESTS_STABILITY_ORDER_H

/* The least-squares slope of log error over log step. */
double order_of(const double *step, const double *error, int count);

/* Prints the errors and adds a row: the order may be off the expected one by so much on either
 * side. */
void order_add(const char *name, const double *step, const double *error, int count,
               double expected, double margin);

#endif
