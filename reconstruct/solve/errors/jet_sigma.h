/* How well the surface's jet is known at a point, and how well figures of the whole surface are:
 * what the error bar of any map is propagated from. */
#ifndef PLACIDO_SOLVE_JET_SIGMA_H
#define PLACIDO_SOLVE_JET_SIGMA_H

#include "reconstruct/solve/errors/result.h"

/* A jet's terms in the order of placido_jet: sag, sx, sy, sxx, sxy, syy. The sag's error is that
 * against its value on the axis (placido_jet_weights_level tells the level). */
#define PLACIDO_JET_TERMS 6

/* The covariance of every cell's coefficients, all sources together: the points of a cell share
 * it. */
typedef struct placido_jet_cells {
  int side;           /* cells along a side */
  double *covariance; /* side * side full matrices of CELL × CELL, rows of cells outer */
} placido_jet_cells;

/* Works on cells in parallel. Free with placido_jet_cells_free. Returns PLACIDO_OK or
 * PLACIDO_MEMORY. */
int placido_jet_cells_new(placido_jet_cells *cells, const placido_fit *fit, placido_error *err);
void placido_jet_cells_free(placido_jet_cells *cells);

/* The rows of the jet's terms over the order² coefficients of the point's cell; 0 beyond. */
typedef struct placido_jet_rows {
  int column, row, order;
  double terms[PLACIDO_JET_TERMS][PLACIDO_SPLINE_CELL];
} placido_jet_rows;

/* The rows at a point; false outside the spline's square. */
bool placido_jet_rows_at(placido_jet_rows *rows, const placido_fit *fit, double x_mm, double y_mm);

/* The covariance of the jet from all sources of placido_sigma_source. */
void placido_jet_covariance(double covariance[PLACIDO_JET_TERMS][PLACIDO_JET_TERMS],
                            const placido_jet_cells *cells, const placido_jet_rows *rows);

/* Figures that are linear in the sag of the whole surface, such as the parameters of a shape that
 * is fitted to it: their covariance, and how they vary with the coefficients. */
typedef struct placido_jet_figures {
  int count, side;
  double *with_coefficients; /* per coefficient its covariances with all figures */
  double *covariance;        /* count × count */
} placido_jet_figures;

/* `weights` holds `count` rows over all coefficients: the figures' derivatives by the coefficients
 * of the sag. One thread at a time may ask the same fit. Free with placido_jet_figures_free.
 * Returns PLACIDO_OK or PLACIDO_MEMORY. */
int placido_jet_figures_new(placido_jet_figures *figures, const placido_fit *fit,
                            const double *weights, int count, placido_error *err);
void placido_jet_figures_free(placido_jet_figures *figures);

/* Fills a row of weights with those of the level that heights' error bars count from. */
void placido_jet_weights_level(double *weights, const placido_fit *fit);

/* How many coefficients a row of weights has. */
size_t placido_jet_coefficients(const placido_fit *fit);

/* Adds `amount` times term `term` of the jet at the rows' point to a row of weights. */
void placido_jet_weights_add(double *weights, const placido_fit *fit, const placido_jet_rows *rows,
                             int term, double amount);

/* The covariances of `count` figures from number `first` on with term `term` of the jet at the
 * rows' point. */
void placido_jet_figures_with(double *with, const placido_jet_figures *figures, int first,
                              int count, const placido_jet_rows *rows, int term);

#endif
