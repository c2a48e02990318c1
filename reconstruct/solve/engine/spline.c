/* Uniform quintic and cubic B-splines by the Cox-de Boor recurrence (de Boor, A Practical Guide to
 * Splines). */
#include "reconstruct/solve/engine/spline.h"

#include "reconstruct/vector.h"

#include <math.h>
#include <string.h>

placido_grid placido_grid_covering(double radius_mm, double knot_mm, int degree) {
  placido_grid grid = {.knot_mm = knot_mm, .order = degree + 1};
  grid.cells = 2 * (int)ceil(radius_mm / knot_mm);
  grid.half_mm = grid.cells * knot_mm / 2;
  grid.side = grid.cells + degree;
  return grid;
}

/* Values of the basis functions of one degree in the cell at t in 0..1, scaled to unit knots. */
static void raise_degree(double *b, int degree, double t) {
  b[degree] = b[degree - 1] * t / degree;
  for (int i = degree - 1; i > 0; i--) {
    b[i] = ((t + degree - i) * b[i - 1] + (i + 1 - t) * b[i]) / degree;
  }
  b[0] *= (1 - t) / degree;
}

/* The derivative of a spline's basis: differences of the basis of one degree less. */
static void differences(const double *lower, int count, double *out) {
  out[0] = -lower[0];
  for (int i = 1; i < count - 1; i++) {
    out[i] = lower[i - 1] - lower[i];
  }
  out[count - 1] = lower[count - 2];
}

static void along(double t, double knot_mm, int p, double out[3][PLACIDO_SPLINE_ORDER]) {
  double b[PLACIDO_SPLINE_ORDER] = {1}, once[PLACIDO_SPLINE_ORDER];
  memset(out, 0, 3 * sizeof *out);
  for (int degree = 1; degree <= p - 2; degree++) {
    raise_degree(b, degree, t);
  }
  differences(b, p, once);
  differences(once, p + 1, out[2]);
  raise_degree(b, p - 1, t);
  differences(b, p + 1, out[1]);
  raise_degree(b, p, t);
  for (int i = 0; i <= p; i++) {
    out[0][i] = b[i];
    out[1][i] /= knot_mm;
    out[2][i] /= knot_mm * knot_mm;
  }
}

static bool locate(const placido_grid *grid, double x, int *cell, double *t) {
  double at = (x + grid->half_mm) / grid->knot_mm;
  if (!(at >= 0 && at <= grid->cells)) {
    return false;
  }
  *cell = at >= grid->cells ? grid->cells - 1 : (int)at;
  *t = at - *cell;
  return true;
}

bool placido_grid_locate(const placido_grid *grid, double x_mm, double y_mm, int *column, int *row,
                         double *x, double *y) {
  return locate(grid, x_mm, column, x) && locate(grid, y_mm, row, y);
}

bool placido_grid_basis(const placido_grid *grid, double x_mm, double y_mm,
                        placido_basis *basis) {
  double tx, ty;
  if (!placido_grid_locate(grid, x_mm, y_mm, &basis->column, &basis->row, &tx, &ty)) {
    return false;
  }
  along(tx, grid->knot_mm, grid->order - 1, basis->x);
  along(ty, grid->knot_mm, grid->order - 1, basis->y);
  return true;
}

enum { ORDER = PLACIDO_SPLINE_ORDER, CUBIC = 4 };

#define PARTS(a, b, c, d, e, f) {a / 120.0, b / 120.0, c / 120.0, d / 120.0, e / 120.0, f / 120.0}

const double placido_spline_powers[PLACIDO_SPLINE_ORDER][PLACIDO_SPLINE_ORDER] = {
    PARTS(1, 26, 66, 26, 1, 0),     PARTS(-5, -50, 0, 50, 5, 0),
    PARTS(10, 20, -60, 20, 10, 0),  PARTS(-10, 20, 0, -20, 10, 0),
    PARTS(5, -20, 30, -20, 5, 0),   PARTS(-1, 5, -10, 10, -5, 1),
};

const double placido_spline_powers_cubic[PLACIDO_SPLINE_ORDER][PLACIDO_SPLINE_ORDER] = {
    PARTS(20, 80, 20, 0, 0, 0),
    PARTS(-60, 0, 60, 0, 0, 0),
    PARTS(60, -120, 60, 0, 0, 0),
    PARTS(-20, 60, -60, 20, 0, 0),
};

PLACIDO_INSIDE void polynomial_of(double polynomial[PLACIDO_SPLINE_CELL], const double *c, int side,
                                  int order, const double powers[ORDER][ORDER]) {
  double lines[ORDER][ORDER] = {{0}};
  for (int j = 0; j < order; j++, c += side) {
    for (int i = 0; i < order; i++) {
      for (int n = 0; n < order; n++) {
        lines[j][n] += c[i] * powers[n][i];
      }
    }
  }
  for (int k = 0; k < ORDER * ORDER; k++) {
    polynomial[k] = 0;
    for (int j = 0; j < order; j++) {
      polynomial[k] += powers[k / ORDER][j] * lines[j][k % ORDER];
    }
  }
}

void placido_grid_polynomial(const placido_grid *grid, const double *coefficients, int column,
                             int row, double polynomial[PLACIDO_SPLINE_CELL]) {
  const double *c = coefficients + (long)row * grid->side + column;
  if (grid->order == ORDER) {
    polynomial_of(polynomial, c, grid->side, ORDER, placido_spline_powers);
  } else {
    polynomial_of(polynomial, c, grid->side, CUBIC, placido_spline_powers_cubic);
  }
}

void placido_grid_value(const placido_grid *grid, const double *coefficients,
                        const placido_basis *basis, double out[6]) {
  for (int i = 0; i < 6; i++) {
    out[i] = 0;
  }
  const double *c = coefficients + (long)basis->row * grid->side + basis->column;
  for (int j = 0; j < grid->order; j++, c += grid->side) {
    double v = 0, d = 0, dd = 0;
    for (int i = 0; i < grid->order; i++) {
      v += basis->x[0][i] * c[i];
      d += basis->x[1][i] * c[i];
      dd += basis->x[2][i] * c[i];
    }
    out[0] += basis->y[0][j] * v;
    out[1] += basis->y[0][j] * d;
    out[2] += basis->y[1][j] * v;
    out[3] += basis->y[0][j] * dd;
    out[4] += basis->y[1][j] * d;
    out[5] += basis->y[2][j] * v;
  }
}
