/* The profile likelihood of the distance, linearised: with u the residuals' change per mm once the
 * surface has answered, the step is -Σ w u r / Σ w u², and its variance that of its numerator,
 * summed over edges as clusters (Liang and Zeger, Biometrika 73:13, 1986). */
#include "reconstruct/solve/distance.h"

#include "base/memory.h"

#include <math.h>

int placido_distance_answer(double *by_distance, placido_normal *normal, const placido_grid *grid,
                            placido_error *err) {
  size_t n = (size_t)grid->side * (size_t)grid->side;
  double *right = placido_memory_new(n, sizeof *right, err);
  if (!right) {
    return PLACIDO_MEMORY;
  }
  /* the spring at the axis pulls to the distance: its push per millimetre is weight · B(0, 0) */
  placido_basis basis;
  placido_grid_basis(grid, 0, 0, &basis);
  for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
    int j = k / PLACIDO_SPLINE_ORDER, i = k % PLACIDO_SPLINE_ORDER;
    right[(basis.row + j) * grid->side + basis.column + i] =
        PLACIDO_DISTANCE_WEIGHT * basis.y[0][j] * basis.x[0][i];
  }
  int status = placido_normal_solve_more(normal, right, 1, by_distance, err);
  placido_memory_free(right);
  return status;
}

/* A sample's residual per mm of distance, in sigmas, and its weight. */
static double change_of(double *weight, const placido_refinement *r, const placido_sample *s,
                        const double *by_distance) {
  int side = r->shape.grid->side;
  double row[PLACIDO_SPLINE_CELL], sum = 0;
  const double *corner = by_distance + s->basis.row * side + s->basis.column;
  *weight = placido_sample_row(row, s, r->sigma_px);
  for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
    sum += row[k] * corner[k / PLACIDO_SPLINE_ORDER * side + k % PLACIDO_SPLINE_ORDER];
  }
  return sum;
}

/* Sums over one edge. */
struct witness {
  double information, pull;
};

/* Adds what a mode of the geometry by one standard deviation would be taken for. */
static double variance_by_geometry(const placido_refinement *r, const double *by_distance,
                                   const placido_moves *moves, double information) {
  double sum = 0;
  for (int m = 0; moves && m < moves->modes; m++) {
    double pull = 0, weight;
    for (size_t i = 0; i < r->count; i++) {
      double change = moves->change[i * (size_t)moves->modes + (size_t)m];
      if (change != 0) {
        double by = change_of(&weight, r, &r->samples[i], by_distance);
        pull += weight * by * change;
      }
    }
    sum += pull * pull / (information * information);
  }
  return sum;
}

placido_distance placido_distance_find(const placido_refinement *r, const placido_mires *mires,
                                       const double *by_distance, const placido_moves *moves) {
  struct witness witnesses[PLACIDO_EDGES_MAX] = {{0}};
  double information = 0, pull = 0, scatter = 0;
  int edges = 0;
  for (size_t i = 0; i < r->count; i++) {
    const placido_sample *s = &r->samples[i];
    if (s->used && !isnan(s->residual_px)) {
      double weight, by = change_of(&weight, r, s, by_distance);
      struct witness *here = &witnesses[mires->points[s->point].edge];
      here->information += weight * by * by;
      here->pull += weight * by * s->residual_px / r->sigma_px;
    }
  }
  for (int k = 0; k < mires->edge_count; k++) {
    information += witnesses[k].information;
    pull += witnesses[k].pull;
    edges += witnesses[k].information > 0;
  }
  if (!(information > 0) || edges < 3) {
    return (placido_distance){NAN, INFINITY};
  }
  double step = -pull / information;
  for (int k = 0; k < mires->edge_count; k++) {
    double left = witnesses[k].pull + step * witnesses[k].information;
    scatter += left * left;
  }
  double variance = fmax(scatter * edges / (edges - 2), information) / (information * information) +
                    variance_by_geometry(r, by_distance, moves, information);
  return (placido_distance){step, sqrt(variance)};
}

void placido_distance_move(placido_refinement *r, const double *by_distance, double step_mm) {
  size_t n = (size_t)r->shape.grid->side * (size_t)r->shape.grid->side;
  r->shape.base.apex_z_mm += step_mm;
  for (size_t i = 0; i < n; i++) {
    r->coefficients[i] += step_mm * (by_distance[i] - 1); /* the base brings the lift itself */
  }
  r->traced = false;
}
