/* Charts in lines of five optotypes, every line a tenth of a log unit smaller. */
#ifndef PLACIDO_SIMULATE_LOGMAR_H
#define PLACIDO_SIMULATE_LOGMAR_H

#include "simulate/charts/chart.h"

#define PLACIDO_LOGMAR_LETTERS 5 /* a line */

/* Where one line stands. */
typedef struct placido_logmar_line {
  double logmar, height_arcmin;
  double left_arcmin, top_arcmin; /* of the first letter */
  double pitch_arcmin;            /* from one letter to the next: twice the height */
  int letters[PLACIDO_LOGMAR_LETTERS]; /* which of the optotypes */
} placido_logmar_line;

/* The chart's own lines: 1.0 to -0.3, Landolt rings in eight directions. */
placido_chart_lines placido_logmar_usual(void);

/* Whether lines make sense, with the reason where they do not. */
int placido_logmar_check(const placido_chart_lines *lines, placido_error *err);

int placido_logmar_count(const placido_chart_lines *lines);
placido_logmar_line placido_logmar_place(const placido_chart_lines *lines,
                                         enum placido_optotype optotype, int index);

void placido_logmar_measure(const placido_chart_lines *lines, double *width_arcmin,
                            double *height_arcmin);

void placido_logmar_draw(placido_image *image, double arcmin_per_px, const placido_chart *chart,
                         const placido_chart_lines *lines);

#endif
