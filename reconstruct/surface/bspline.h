/* A B-spline as it stands in memory: for what evaluates it at points and along lines. */
#ifndef PLACIDO_SURFACE_BSPLINE_H
#define PLACIDO_SURFACE_BSPLINE_H

#include "reconstruct/surface/part.h"

#define PLACIDO_BSPLINE_ORDER 6       /* basis functions over a span of the highest degree */
#define PLACIDO_BSPLINE_EDGE_MM 1e-12 /* tolerance outside the last knot */

/* The basis functions that are not zero in a span: coefficients [power of t][function]. */
typedef struct placido_bspline_span {
  double start, inverse_width;
  double power[PLACIDO_BSPLINE_ORDER][PLACIDO_BSPLINE_ORDER];
} placido_bspline_span;

typedef struct placido_bspline_axis {
  int degree, count;           /* coefficients */
  double *knots;               /* count + degree + 1 */
  double first, last;          /* where the spline is defined */
  placido_bspline_span *spans; /* count - degree, in the order of the knots; empty ones are not
                                  used */
  int bins;
  double bins_per_mm;
  int *bin_span; /* the span at each bin's start */
} placido_bspline_axis;

typedef struct placido_bspline {
  placido_bspline_axis x, y;
  double *coefficients; /* y.count * x.count, y outer */
} placido_bspline;

static inline bool placido_bspline_reaches(const placido_bspline_axis *axis, double at_mm) {
  return at_mm >= axis->first - PLACIDO_BSPLINE_EDGE_MM &&
         at_mm <= axis->last + PLACIDO_BSPLINE_EDGE_MM;
}

/* The basis functions at x, where the axis reaches: values, first and second derivatives. Returns
 * the span. */
int placido_bspline_evaluate(const placido_bspline_axis *axis, double x,
                             double basis[3][PLACIDO_BSPLINE_ORDER]);

/* The part's make_columns and add_line. */
int placido_bspline_columns_new(void **columns, size_t *work, const void *state,
                                const double *x_mm, size_t count, placido_error *err);
void placido_bspline_add_line(const void *state, const void *columns, const placido_line *line);

#endif
