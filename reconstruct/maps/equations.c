/* Normal equations, summed row by row. */
#include "reconstruct/maps/equations.h"

#include "base/dense.h"

#include <string.h>

/* A pivot that has lost this share of its diagonal element is rounding. */
#define SINGULAR 1e-13

void placido_equations_add(placido_equations *equations, const double *row, double value) {
  for (int i = 0; i < equations->unknowns; i++) {
    for (int k = 0; k <= i; k++) {
      equations->matrix[i][k] += row[i] * row[k];
    }
    equations->right[i] += row[i] * value;
  }
}

bool placido_equations_solve(const placido_equations *equations, double *unknowns) {
  int n = equations->unknowns;
  double l[PLACIDO_EQUATIONS_MAX][PLACIDO_EQUATIONS_MAX];
  memcpy(l, equations->matrix, sizeof l);
  memcpy(unknowns, equations->right, (size_t)n * sizeof *unknowns);
  if (!placido_dense_factor(&l[0][0], n, PLACIDO_EQUATIONS_MAX, SINGULAR)) {
    return false;
  }
  placido_dense_solve(&l[0][0], n, PLACIDO_EQUATIONS_MAX, unknowns);
  return true;
}
