/* Normal equations, solved by Cholesky's factorisation (Golub & Van Loan, Matrix Computations, 4th
 * ed., algorithm 4.2.1). */
#include "reconstruct/maps/equations.h"

#include <math.h>
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

static bool factorise(int n, double l[PLACIDO_EQUATIONS_MAX][PLACIDO_EQUATIONS_MAX]) {
  for (int i = 0; i < n; i++) {
    for (int k = 0; k <= i; k++) {
      double sum = l[i][k];
      for (int m = 0; m < k; m++) {
        sum -= l[i][m] * l[k][m];
      }
      if (k < i) {
        l[i][k] = sum / l[k][k];
      } else if (sum > SINGULAR * l[i][i]) {
        l[i][i] = sqrt(sum);
      } else {
        return false;
      }
    }
  }
  return true;
}

bool placido_equations_solve(const placido_equations *equations, double *unknowns) {
  int n = equations->unknowns;
  double l[PLACIDO_EQUATIONS_MAX][PLACIDO_EQUATIONS_MAX];
  memcpy(l, equations->matrix, sizeof l);
  if (!factorise(n, l)) {
    return false;
  }
  for (int i = 0; i < n; i++) {
    unknowns[i] = equations->right[i];
    for (int k = 0; k < i; k++) {
      unknowns[i] -= l[i][k] * unknowns[k];
    }
    unknowns[i] /= l[i][i];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++) {
      unknowns[i] -= l[k][i] * unknowns[k];
    }
    unknowns[i] /= l[i][i];
  }
  return true;
}
