/* Covariance of the jet: the sag and its derivatives are linear in the spline's coefficients, so
 * that C(jet) = R C Rᵀ with R the rows of the basis and C the coefficients' covariance; of C a
 * point needs its cell's part alone, which the selected inverse holds. Signs do not matter: the
 * spline was fitted to z, which is minus the sag throughout. */
#include "reconstruct/solve/errors/jet_sigma.h"

#include "base/memory.h"
#include "reconstruct/vector.h"

#include <math.h>

#define CELL PLACIDO_SPLINE_CELL

bool placido_jet_rows_at(placido_jet_rows *rows, const placido_fit *fit, double x_mm, double y_mm) {
  static const int by_x[PLACIDO_JET_TERMS] = {0, 1, 0, 2, 1, 0};
  static const int by_y[PLACIDO_JET_TERMS] = {0, 0, 1, 0, 1, 2};
  placido_basis basis;
  if (!placido_grid_basis(&fit->grid, x_mm, y_mm, &basis)) {
    return false;
  }
  *rows = (placido_jet_rows){
      .column = basis.column, .row = basis.row, .order = fit->grid.order};
  for (int t = 0; t < PLACIDO_JET_TERMS; t++) {
    double *term = rows->terms[t];
    for (int j = 0; j < rows->order; j++) {
      for (int i = 0; i < rows->order; i++) {
        *term++ = basis.y[by_y[t]][j] * basis.x[by_x[t]][i];
      }
    }
  }
  return true;
}

/* Index of the cell's coefficient k among all. */
static size_t index_of(const placido_jet_rows *rows, int side, int k) {
  return (size_t)(rows->row + k / rows->order) * (size_t)side +
         (size_t)(rows->column + k % rows->order);
}

/* What a step of the distance by one sigma moves of a coefficient beyond the lift as a whole, which
 * is no error of the shape: the basis sums to 1, so that lift is 1 in every coefficient. */
static double by_distance(const placido_fit *fit, size_t index) {
  return fit->axis_z_sigma_mm * (fit->by_distance[index] - 1);
}

static void find_cell(double covariance[CELL * CELL], const placido_fit *fit, int column, int row) {
  const placido_jet_rows at = {.column = column, .row = row, .order = fit->grid.order};
  double geometry[CELL * CELL], distance[CELL] = {0};
  placido_fit_noise_block(covariance, fit, column, row);
  if (fit->geometry) {
    placido_normal_block(fit->normal, fit->geometry, column, row, geometry);
  }
  for (int k = 0; k < at.order * at.order; k++) {
    distance[k] = by_distance(fit, index_of(&at, fit->grid.side, k));
  }
  for (int k = 0; k < CELL * CELL; k++) {
    covariance[k] += distance[k / CELL] * distance[k % CELL] + (fit->geometry ? geometry[k] : 0);
  }
}

int placido_jet_cells_new(placido_jet_cells *cells, const placido_fit *fit, placido_error *err) {
  size_t side = (size_t)fit->grid.cells;
  *cells = (placido_jet_cells){.side = fit->grid.cells};
  cells->covariance = placido_memory_new(side * side * CELL * CELL, sizeof(double), err);
  if (!cells->covariance) {
    return PLACIDO_MEMORY;
  }
#pragma omp parallel for schedule(dynamic, 1)
  for (int row = 0; row < cells->side; row++) {
    for (int column = 0; column < cells->side; column++) {
      size_t cell = (size_t)row * side + (size_t)column;
      find_cell(cells->covariance + cell * CELL * CELL, fit, column, row);
    }
  }
  return PLACIDO_OK;
}

void placido_jet_cells_free(placido_jet_cells *cells) {
  placido_memory_free(cells->covariance);
  *cells = (placido_jet_cells){0};
}

/* out = R C Rᵀ. */
PLACIDO_WIDE
static void enclose(double out[PLACIDO_JET_TERMS][PLACIDO_JET_TERMS], const double *covariance,
                    const double terms[PLACIDO_JET_TERMS][CELL]) {
  double through[PLACIDO_JET_TERMS][CELL] = {{0}};
  for (int r = 0; r < CELL; r++) {
    const double *line = covariance + r * CELL;
    for (int t = 0; t < PLACIDO_JET_TERMS; t++) {
      for (int c = 0; c < CELL; c++) {
        through[t][c] += terms[t][r] * line[c];
      }
    }
  }
  for (int t = 0; t < PLACIDO_JET_TERMS; t++) {
    for (int u = 0; u <= t; u++) {
      double sum = 0;
      for (int c = 0; c < CELL; c++) {
        sum += through[t][c] * terms[u][c];
      }
      out[t][u] = out[u][t] = sum;
    }
  }
}

void placido_jet_covariance(double covariance[PLACIDO_JET_TERMS][PLACIDO_JET_TERMS],
                            const placido_jet_cells *cells, const placido_jet_rows *rows) {
  size_t cell = (size_t)rows->row * (size_t)cells->side + (size_t)rows->column;
  enclose(covariance, cells->covariance + cell * CELL * CELL, rows->terms);
}

size_t placido_jet_coefficients(const placido_fit *fit) {
  return (size_t)fit->grid.side * (size_t)fit->grid.side;
}

void placido_jet_weights_add(double *weights, const placido_fit *fit, const placido_jet_rows *rows,
                             int term, double amount) {
  for (int k = 0; k < rows->order * rows->order; k++) {
    weights[index_of(rows, fit->grid.side, k)] += amount * rows->terms[term][k];
  }
}

void placido_jet_weights_level(double *weights, const placido_fit *fit) {
  for (size_t i = 0; i < placido_jet_coefficients(fit); i++) {
    weights[i] = fit->level ? fit->level[i] : 0;
  }
}

static double product(const double *a, const double *b, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* Adds to C w what the independent step `step` of the coefficients gives: step (step · w). */
static void add_step(double *answer, const double *step, const double *weights, size_t n) {
  double along = product(step, weights, n);
  for (size_t i = 0; i < n; i++) {
    answer[i] += step[i] * along;
  }
}

static void add_sources(double *answer, double *distance, const placido_fit *fit,
                        const double *weights) {
  size_t n = placido_jet_coefficients(fit);
  for (size_t i = 0; i < n; i++) {
    distance[i] = by_distance(fit, i);
  }
  add_step(answer, distance, weights, n);
  for (int m = 0; m < fit->mode_count; m++) {
    add_step(answer, fit->modes + (size_t)m * n, weights, n);
  }
}

/* From the answers C w of all figures, one behind the other, to covariances. */
static void keep_answers(placido_jet_figures *figures, const double *answers, const double *weights,
                         size_t n) {
  size_t count = (size_t)figures->count;
  for (size_t k = 0; k < count; k++) {
    for (size_t i = 0; i < n; i++) {
      figures->with_coefficients[i * count + k] = answers[k * n + i];
    }
    for (size_t l = 0; l < count; l++) {
      figures->covariance[k * count + l] = product(answers + k * n, weights + l * n, n);
    }
  }
}

int placido_jet_figures_new(placido_jet_figures *figures, const placido_fit *fit,
                            const double *weights, int count, placido_error *err) {
  size_t n = placido_jet_coefficients(fit), many = (size_t)count;
  *figures = (placido_jet_figures){.count = count, .side = fit->grid.side};
  figures->with_coefficients = placido_memory_new(many * n, sizeof(double), err);
  figures->covariance = placido_memory_new(many * many, sizeof(double), err);
  double *answers = placido_memory_new(many * n, sizeof *answers, err);
  double *distance = placido_memory_new(n, sizeof *distance, err);
  int status = figures->with_coefficients && figures->covariance && answers && distance
                   ? placido_fit_noise_times(answers, fit, weights, count, err)
                   : PLACIDO_MEMORY;
  for (size_t k = 0; k < many && !status; k++) {
    add_sources(answers + k * n, distance, fit, weights + k * n);
  }
  if (!status) {
    keep_answers(figures, answers, weights, n);
  } else {
    placido_jet_figures_free(figures);
  }
  placido_memory_free(answers);
  placido_memory_free(distance);
  return status;
}

void placido_jet_figures_free(placido_jet_figures *figures) {
  placido_memory_free(figures->with_coefficients);
  placido_memory_free(figures->covariance);
  *figures = (placido_jet_figures){0};
}

PLACIDO_WIDE
void placido_jet_figures_with(double *with, const placido_jet_figures *figures, int first,
                              int count, const placido_jet_rows *rows, int term) {
  for (int f = 0; f < count; f++) {
    with[f] = 0;
  }
  for (int k = 0; k < rows->order * rows->order; k++) {
    const double *of = figures->with_coefficients +
                       index_of(rows, figures->side, k) * (size_t)figures->count + first;
    for (int f = 0; f < count; f++) {
      with[f] += of[f] * rows->terms[term][k];
    }
  }
}
