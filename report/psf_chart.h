/* A chart of curves: axes with units, a grid, lines told apart by colour and by dashes. */
#ifndef PLACIDO_REPORT_PSF_CHART_H
#define PLACIDO_REPORT_PSF_CHART_H

#include "report/canvas.h"

#define PLACIDO_CHART_CURVES_MAX 5

typedef struct placido_chart_curve {
  const char *name;
  int count;
  const double *x, *y; /* NaN interrupts */
} placido_chart_curve;

/* Both axes linear; y from 0 to `high`. */
typedef struct placido_chart {
  const char *title, *x_name; /* x_name with the unit */
  double first, last, high;
  placido_chart_curve curves[PLACIDO_CHART_CURVES_MAX];
  int count;
} placido_chart;

/* Draws it into the rectangle, axes' numbers and legend included. */
void placido_chart_draw(const placido_chart *chart, const placido_canvas *canvas, double left,
                        double top, double width, double height);

#endif
