/* Error bars by linear propagation: a map's value depends on the jet of its point, and, through
 * the reference or the vertex, on figures of the whole surface; with g its gradient by both and C
 * their covariance the variance is gᵀ C g (JCGM 100:2008, equation 13). Gradients are
 * differences of the map's own function, so that a new kind of map needs no more than its formula.
 */
#include "reconstruct/maps/errors.h"

#include "base/memory.h"
#include "reconstruct/maps/equations.h"
#include "reconstruct/maps/shape.h"

#include <math.h>
#include <string.h>

/* One-sided differences: their own error is this share of a curvature or a slope of 1. */
#define STEP 1e-6

#define VERTEX_FIGURES 2
#define VERTEX_FIRST (4 + 5 + 7)
#define LEVEL (VERTEX_FIRST + VERTEX_FIGURES) /* that heights count from */
#define FIGURES_MAX (LEVEL + 1)
#define TERMS PLACIDO_JET_TERMS

/* First figure and number of figures that a need stands for. */
static int figures_of(enum placido_map_needs needs, int *first) {
  int at = 0;
  for (int k = 0; k < PLACIDO_REFERENCES; k++) {
    int count = placido_shape_free((enum placido_reference)k);
    if (needs == (enum placido_map_needs)(PLACIDO_MAP_NEEDS_SPHERE + k)) {
      *first = at;
      return count;
    }
    at += count;
  }
  *first = at;
  return needs == PLACIDO_MAP_NEEDS_VERTEX ? VERTEX_FIGURES : 0;
}

/* The inverse of the fit's normal matrix Σ w h hᵀ; false where it is singular. */
static bool invert(double inverse[PLACIDO_SHAPE_PARAMETERS][PLACIDO_SHAPE_PARAMETERS],
                   const placido_zone *zone, const placido_conicoid_shape *shape,
                   enum placido_reference reference) {
  int count = placido_shape_free(reference);
  double row[PLACIDO_SHAPE_PARAMETERS];
  placido_equations equations = {.unknowns = count};
  for (size_t i = 0; i < zone->count; i++) {
    const double *p = zone->points[i];
    placido_shape_at(shape, p[0], p[1], row);
    double root = sqrt(placido_shape_weight(reference, shape, p[0], p[1]));
    for (int k = 0; k < count; k++) {
      row[k] *= root;
    }
    placido_equations_add(&equations, row, 0);
  }
  for (int k = 0; k < count; k++) {
    for (int l = 0; l < count; l++) {
      equations.right[l] = k == l;
    }
    if (!placido_equations_solve(&equations, inverse[k])) {
      return false;
    }
  }
  return true;
}

/* The parameters of a fitted shape move by (Σ w h hᵀ)⁻¹ Σ w h dz, h the derivatives of its z. */
static void weigh_shape(double *weights, const placido_fit *fit, const placido_zone *zone,
                        const placido_conicoid_shape *shape, enum placido_reference reference) {
  int count = placido_shape_free(reference);
  size_t n = placido_jet_coefficients(fit);
  double inverse[PLACIDO_SHAPE_PARAMETERS][PLACIDO_SHAPE_PARAMETERS];
  if (!isfinite(shape->c_mm1) || !invert(inverse, zone, shape, reference)) {
    return;
  }
  for (size_t i = 0; i < zone->count; i++) {
    const double *p = zone->points[i];
    double row[PLACIDO_SHAPE_PARAMETERS];
    placido_jet_rows rows;
    if (!placido_jet_rows_at(&rows, fit, p[0], p[1])) {
      continue;
    }
    placido_shape_at(shape, p[0], p[1], row);
    double weight = placido_shape_weight(reference, shape, p[0], p[1]);
    for (int k = 0; k < count; k++) {
      double by_z = 0;
      for (int l = 0; l < count; l++) {
        by_z += inverse[k][l] * weight * row[l];
      }
      placido_jet_weights_add(weights + (size_t)k * n, fit, &rows, 0, -by_z);
    }
  }
}

/* At the vertex the slope is 0: it moves by -H⁻¹ d(slope), H the second derivatives. */
static void weigh_vertex(double *weights, const placido_fit *fit, const placido_surface *surface,
                         const double vertex_mm[2]) {
  placido_jet jet;
  placido_jet_rows rows;
  size_t n = placido_jet_coefficients(fit);
  if (isnan(vertex_mm[0]) || !placido_surface_at(surface, vertex_mm[0], vertex_mm[1], &jet) ||
      !placido_jet_rows_at(&rows, fit, vertex_mm[0], vertex_mm[1])) {
    return;
  }
  double determinant = jet.sxx * jet.syy - jet.sxy * jet.sxy;
  placido_jet_weights_add(weights, fit, &rows, 1, -jet.syy / determinant);
  placido_jet_weights_add(weights, fit, &rows, 2, jet.sxy / determinant);
  placido_jet_weights_add(weights + n, fit, &rows, 1, jet.sxy / determinant);
  placido_jet_weights_add(weights + n, fit, &rows, 2, -jet.sxx / determinant);
}

int placido_map_errors_new(placido_map_errors *errors, const placido_fit *fit,
                           const placido_surface *surface, const placido_zone *zone,
                           const placido_map_point *common, placido_error *err) {
  *errors = (placido_map_errors){.fit = fit};
  size_t n = placido_jet_coefficients(fit);
  double *weights = placido_memory_new(FIGURES_MAX * n, sizeof *weights, err);
  if (!weights) {
    return PLACIDO_MEMORY;
  }
  int first;
  for (int k = 0; k < PLACIDO_REFERENCES; k++) {
    figures_of((enum placido_map_needs)(PLACIDO_MAP_NEEDS_SPHERE + k), &first);
    weigh_shape(weights + (size_t)first * n, fit, zone, &common->references[k],
                (enum placido_reference)k);
  }
  weigh_vertex(weights + VERTEX_FIRST * n, fit, surface, common->vertex_mm);
  placido_jet_weights_level(weights + LEVEL * n, fit);
  int status = placido_jet_figures_new(&errors->figures, fit, weights, FIGURES_MAX, err);
  placido_memory_free(weights);
  return status ? status : placido_jet_cells_new(&errors->cells, fit, err);
}

void placido_map_errors_free(placido_map_errors *errors) {
  placido_jet_figures_free(&errors->figures);
  placido_jet_cells_free(&errors->cells);
  *errors = (placido_map_errors){0};
}

/* How fast a kind's value changes with one of the point's numbers, which is put back. */
static double slope_by(const placido_map_kind *kind, placido_map_point *point, double *number,
                       double value) {
  double before = *number;
  *number += STEP;
  double moved = kind->at(point);
  *number = before;
  return (moved - value) / STEP;
}

static bool is_over_reference(const placido_map_kind *kind) {
  return kind->needs >= PLACIDO_MAP_NEEDS_SPHERE && kind->needs <= PLACIDO_MAP_NEEDS_TORIC;
}

static void by_jet(double gradient[TERMS], const placido_map_kind *kind, placido_map_point *point,
                   double value) {
  if (is_over_reference(kind)) { /* z in micrometres, less the reference's */
    const double height[TERMS] = {-1000};
    memcpy(gradient, height, sizeof height);
    return;
  }
  double *const terms[TERMS - 1] = {&point->jet.sx, &point->jet.sy, &point->jet.sxx,
                                    &point->jet.sxy, &point->jet.syy};
  /* no kind reads the sag but as z */
  gradient[0] = -slope_by(kind, point, &point->z_mm, value);
  for (int t = 1; t < TERMS; t++) {
    gradient[t] = slope_by(kind, point, terms[t - 1], value);
  }
}

static void by_figures(double gradient[PLACIDO_SHAPE_PARAMETERS], const placido_map_kind *kind,
                       placido_map_point *point, double value) {
  if (!is_over_reference(kind)) {
    for (int k = 0; k < VERTEX_FIGURES; k++) {
      gradient[k] = slope_by(kind, point, &point->vertex_mm[k], value);
    }
  } else {
    placido_shape_at(&point->references[kind->needs - PLACIDO_MAP_NEEDS_SPHERE], point->x_mm,
                     point->y_mm, gradient);
    for (int k = 0; k < PLACIDO_SHAPE_PARAMETERS; k++) {
      gradient[k] *= -1000;
    }
  }
}

/* What is known of a point: its jet's covariance, and that of the jet's terms with the figures. */
typedef struct knowledge {
  double jet[TERMS][TERMS], with[TERMS][FIGURES_MAX];
} knowledge;

/* Of a reference only the height matters, of the vertex every term. */
static void learn(knowledge *known, const placido_map_errors *errors,
                  const placido_jet_rows *rows) {
  placido_jet_covariance(known->jet, &errors->cells, rows);
  placido_jet_figures_with(known->with[0], &errors->figures, 0, FIGURES_MAX, rows, 0);
  for (int t = 1; t < TERMS; t++) {
    placido_jet_figures_with(known->with[t] + VERTEX_FIRST, &errors->figures, VERTEX_FIRST,
                             VERTEX_FIGURES, rows, t);
  }
}

/* What the figures of the whole surface add to the variance, their covariance with the jet
 * included. */
static double variance_of_figures(const placido_map_errors *errors, const placido_map_kind *kind,
                                  placido_map_point *point, double value, const knowledge *known,
                                  const double gradient[TERMS]) {
  int first, count = figures_of(kind->needs, &first);
  int terms = is_over_reference(kind) ? 1 : TERMS;
  double by[PLACIDO_SHAPE_PARAMETERS], sum = 0;
  by_figures(by, kind, point, value);
  for (int k = 0; k < count; k++) {
    for (int l = 0; l < count; l++) {
      sum += by[k] * by[l] * errors->figures.covariance[(first + k) * FIGURES_MAX + first + l];
    }
    for (int t = 0; t < terms; t++) {
      sum += 2 * by[k] * gradient[t] * known->with[t][first + k];
    }
  }
  return sum;
}

/* At the vertex itself a map about it is the curvature along +x, whose error does not ask where the
 * vertex is: beside it slope and place of the vertex make up for each other, to rounding. */
static bool move_to_vertex(placido_map_point *point, const placido_map_kind *kind) {
  double *at[2] = {&point->x_mm, &point->y_mm};
  if (kind->needs != PLACIDO_MAP_NEEDS_VERTEX ||
      !(hypot(*at[0] - point->vertex_mm[0], *at[1] - point->vertex_mm[1]) < 1e-3)) {
    return false;
  }
  *at[0] = point->vertex_mm[0];
  *at[1] = point->vertex_mm[1];
  return true;
}

static double variance_of(const placido_map_errors *errors, const placido_map_kind *kind,
                          placido_map_point *point, double value, const knowledge *known) {
  double gradient[TERMS], sum = 0, x_mm = point->x_mm, y_mm = point->y_mm;
  bool at_vertex = move_to_vertex(point, kind);
  by_jet(gradient, kind, point, at_vertex ? kind->at(point) : value);
  point->x_mm = x_mm;
  point->y_mm = y_mm;
  for (int t = 0; t < TERMS; t++) {
    for (int u = 0; u < TERMS; u++) {
      sum += gradient[t] * gradient[u] * known->jet[t][u];
    }
  }
  if (kind->needs != PLACIDO_MAP_NEEDS_NOTHING && !at_vertex) {
    sum += variance_of_figures(errors, kind, point, value, known, gradient);
  }
  return sum;
}

/* Against the level. Where nothing moves a variance is rounding of either sign. */
static double variance_of_height(const placido_map_errors *errors, const knowledge *known) {
  return known->jet[0][0] - 2 * known->with[0][LEVEL] +
         errors->figures.covariance[LEVEL * FIGURES_MAX + LEVEL];
}

void placido_map_errors_at(const placido_map_errors *errors, const placido_map_point *given,
                           const double *values, double *sigma_z_um, double *sigmas) {
  placido_map_point point = *given; /* its numbers are moved in turn */
  size_t count;
  const placido_map_kind *kinds = placido_map_kinds(&count);
  knowledge known;
  placido_jet_rows rows;
  bool inside = placido_jet_rows_at(&rows, errors->fit, point.x_mm, point.y_mm);
  *sigma_z_um = NAN;
  if (inside) {
    learn(&known, errors, &rows);
    *sigma_z_um = 1e3 * sqrt(fmax(variance_of_height(errors, &known), 0));
  }
  for (size_t i = 0; i < count; i++) {
    sigmas[i] = inside && isfinite(values[i])
                    ? sqrt(fmax(variance_of(errors, &kinds[i], &point, values[i], &known), 0))
                    : (double)NAN;
  }
}
