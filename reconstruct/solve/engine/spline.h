/* The unknowns of the fit: a tensor-product B-spline on uniform knots, and what one point of it
 * depends on. */
#ifndef PLACIDO_SOLVE_SPLINE_H
#define PLACIDO_SOLVE_SPLINE_H

#include <stdbool.h>

/* The usual degree, and the highest; the other one is 3. A cell has order² coefficients, rows of
 * `order` one behind the other: room is for those of the highest degree. */
#define PLACIDO_SPLINE_DEGREE 5
#define PLACIDO_SPLINE_ORDER (PLACIDO_SPLINE_DEGREE + 1)
#define PLACIDO_SPLINE_CELL (PLACIDO_SPLINE_ORDER * PLACIDO_SPLINE_ORDER)

/* Square [-half, half]² in cells of knot_mm; coefficients side × side, y outer. A value. */
typedef struct placido_grid {
  double half_mm, knot_mm;
  int cells; /* along a side */
  int side;  /* coefficients along a side: cells + degree */
  int order; /* degree + 1: coefficients that a cell depends on, along a side */
} placido_grid;

placido_grid placido_grid_covering(double radius_mm, double knot_mm, int degree);

/* The basis along x and y at a point: the first of `order` coefficients each way, and values, first
 * and second derivatives. What is beyond the order is 0. */
typedef struct placido_basis {
  int column, row;
  double x[3][PLACIDO_SPLINE_ORDER], y[3][PLACIDO_SPLINE_ORDER];
} placido_basis;

/* Returns false outside the square. */
bool placido_grid_basis(const placido_grid *grid, double x_mm, double y_mm, placido_basis *basis);

/* The cell of a point and its place there, 0 to 1 each way. Returns false outside the square. */
bool placido_grid_locate(const placido_grid *grid, double x_mm, double y_mm, int *column, int *row,
                         double *x, double *y);

/* The pieces of the basis along one axis as polynomials of the place in a cell: piece i is
 * Σ powers[n][i] tⁿ. Of degree 5, and of degree 3. */
extern const double placido_spline_powers[PLACIDO_SPLINE_ORDER][PLACIDO_SPLINE_ORDER];
extern const double placido_spline_powers_cubic[PLACIDO_SPLINE_ORDER][PLACIDO_SPLINE_ORDER];

/* The spline in one cell as a polynomial of the place: Σ polynomial[m · ORDER + n] yᵐ xⁿ; of a
 * lower degree, too. */
void placido_grid_polynomial(const placido_grid *grid, const double *coefficients, int column,
                             int row, double polynomial[PLACIDO_SPLINE_CELL]);

/* Value, d/dx, d/dy, d²/dx², d²/dxdy, d²/dy² of the spline with these coefficients. */
void placido_grid_value(const placido_grid *grid, const double *coefficients,
                        const placido_basis *basis, double out[6]);

#endif
