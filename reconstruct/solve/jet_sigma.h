/* How well the surface's jet is known at a point, and how well figures of the whole surface are:
 * what the error bar of any map is propagated from. */
#ifndef PLACIDO_SOLVE_JET_SIGMA_H
#define PLACIDO_SOLVE_JET_SIGMA_H

#include "reconstruct/solve/result.h"

/* A jet's terms in the order of placido_jet: sag, sx, sy, sxx, sxy, syy. The sag's error is that
 * against its value on the axis (placido_jet_weights_level tells the level). */
#define PLACIDO_JET_TERMS 6

/* The covariance of a cell's coefficients, all sources together, kept from point to point: points
 * of one cell share it. Start with {.known = false}; each thread has its own. */
typedef struct placido_jet_cell {
  bool known;
  int column, row;
  double covariance[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL];
} placido_jet_cell;

/* The rows of the jet's terms over the coefficients of the point's cell. */
typedef struct placido_jet_rows {
  int column, row;
  double terms[PLACIDO_JET_TERMS][PLACIDO_SPLINE_CELL];
} placido_jet_rows;

/* The rows at a point; false outside the spline's square. */
bool placido_jet_rows_at(placido_jet_rows *rows, const placido_fit *fit, double x_mm, double y_mm);

/* The covariance of the jet from all sources of placido_sigma_source. */
void placido_jet_covariance(double covariance[PLACIDO_JET_TERMS][PLACIDO_JET_TERMS],
                            placido_jet_cell *cell, const placido_fit *fit,
                            const placido_jet_rows *rows);

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
