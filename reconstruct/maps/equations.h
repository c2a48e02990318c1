/* Small linear least squares by normal equations, for well-scaled problems of a few unknowns. */
#ifndef PLACIDO_MAPS_EQUATIONS_H
#define PLACIDO_MAPS_EQUATIONS_H

#include <stdbool.h>

#define PLACIDO_EQUATIONS_MAX 8

/* Start with {.unknowns = n}. */
typedef struct placido_equations {
  int unknowns;
  double matrix[PLACIDO_EQUATIONS_MAX][PLACIDO_EQUATIONS_MAX]; /* lower triangle */
  double right[PLACIDO_EQUATIONS_MAX];
} placido_equations;

/* Adds the equation row · unknowns = value. */
void placido_equations_add(placido_equations *equations, const double *row, double value);

/* Solves; false where the equations do not determine every unknown. */
bool placido_equations_solve(const placido_equations *equations, double *unknowns);

#endif
