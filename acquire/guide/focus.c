/* A flatter cornea shows every mire larger in the same proportion, one that is nearer shows the
 * mires low in the cone larger than those high up: a least-squares solution for apical radius,
 * asphericity and distance with what is known of corneas (Gaussian priors). Mires in one plane, or
 * far away, leave the distance as unknown as it was; the solution's own standard deviation says so,
 * once for an instrument, and nothing is told. */
#include "acquire/guide/focus.h"

#include "acquire/guide/expect.h"

#include <math.h>

/* Of adult corneas; below, the standard deviations, keratoconus included (the spread of healthy
 * eyes is half as large). Of the distance nothing is known. */
static const double radius_mm = 7.8;
static const double asphericity = -0.25;
#define Z_SIGMA_MM 3.0
/* What a real cornea's mean radius departs from a conic's, and what is left of the decentration. */
static const double shape_sigma = 0.006; /* of an edge's radius */
static const double sigma_max_mm = 0.35; /* beyond, nothing is told */
static const double misfit_max = 3;      /* times shape_sigma: this is no conic */

enum { PARAMETERS = 3, SEEN_MIN = 8, QUORUM = PLACIDO_GUIDE_MERIDIANS / 3 };

static const double prior_sigmas[PARAMETERS] = {0.5, 0.25, Z_SIGMA_MM};

/* Normal equations in units of the priors. */
struct normal {
  double a[PARAMETERS][PARAMETERS], b[PARAMETERS];
};

static struct normal start_normal(void) {
  struct normal normal = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
  return normal;
}

/* Departures of neighbouring mires from a conic go together: all count like SEEN_MIN of them. */
static void add_edge(struct normal *normal, const placido_guide_focus *focus, int k, int seen,
                     double residual_px) {
  const double weight = sqrt((double)SEEN_MIN / seen) / (shape_sigma * focus->expected_px[k]);
  double row[PARAMETERS];
  for (int p = 0; p < PARAMETERS; p++) {
    row[p] = weight * focus->slope_px[p][k] * prior_sigmas[p];
  }
  for (int p = 0; p < PARAMETERS; p++) {
    for (int q = 0; q < PARAMETERS; q++) {
      normal->a[p][q] += row[p] * row[q];
    }
    normal->b[p] += row[p] * weight * residual_px;
  }
}

/* Solves by elimination (the matrix is the identity plus something positive); returns the last
 * parameter's variance in units of its prior's. */
static double solve(struct normal *normal) {
  for (int p = 0; p < PARAMETERS; p++) {
    for (int q = p + 1; q < PARAMETERS; q++) {
      const double factor = normal->a[q][p] / normal->a[p][p];
      for (int i = p; i < PARAMETERS; i++) {
        normal->a[q][i] -= factor * normal->a[p][i];
      }
      normal->b[q] -= factor * normal->b[p];
    }
  }
  for (int p = PARAMETERS - 1; p >= 0; p--) {
    for (int q = p + 1; q < PARAMETERS; q++) {
      normal->b[p] -= normal->a[p][q] * normal->b[q];
    }
    normal->b[p] /= normal->a[p][p];
  }
  return 1 / normal->a[PARAMETERS - 1][PARAMETERS - 1];
}

static bool has_edge(const placido_guide_focus *focus, int k) {
  return !isnan(focus->expected_px[k]) && !isnan(focus->slope_px[0][k]) &&
         !isnan(focus->slope_px[1][k]) && !isnan(focus->slope_px[2][k]);
}

static double sigma_of_all(const placido_guide_focus *focus) {
  struct normal normal = start_normal();
  for (int k = 0; k < focus->edge_count; k++) {
    if (has_edge(focus, k)) {
      add_edge(&normal, focus, k, focus->edge_count, 0);
    }
  }
  return sqrt(solve(&normal)) * Z_SIGMA_MM;
}

void placido_guide_focus_prepare(placido_guide_focus *focus, const placido_instrument *instrument,
                                 int edge_count) {
  static const double steps[PARAMETERS] = {0.2, 0.1, 0.3};
  double plus[PLACIDO_EDGES_MAX], minus[PLACIDO_EDGES_MAX];
  focus->edge_count = edge_count;
  placido_guide_expect(focus->expected_px, instrument,
                       &(placido_guide_cornea){radius_mm, asphericity, 0});
  for (int p = 0; p < PARAMETERS; p++) {
    const double a = p == 0 ? steps[0] : 0, q = p == 1 ? steps[1] : 0, z = p == 2 ? steps[2] : 0;
    placido_guide_expect(plus, instrument,
                         &(placido_guide_cornea){radius_mm + a, asphericity + q, z});
    placido_guide_expect(minus, instrument,
                         &(placido_guide_cornea){radius_mm - a, asphericity - q, -z});
    for (int k = 0; k < edge_count; k++) {
      focus->slope_px[p][k] = 0.5 * (plus[k] - minus[k]) / steps[p];
    }
  }
  focus->can_tell = sigma_of_all(focus) < sigma_max_mm;
}

/* Mean radius of an edge over the meridians on which its number is sure; NaN where too few. */
static double mean_radius(const placido_guide_walk *walk, int k) {
  double sum = 0;
  int count = 0;
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    const float radius = walk->radius_px[(size_t)m * (size_t)walk->edge_count + (size_t)k];
    if (k < walk->numbered[m] && !isnan(radius)) {
      sum += (double)radius;
      count++;
    }
  }
  return count >= QUORUM ? sum / count : NAN;
}

/* Root mean square of what the solution leaves, in units of shape_sigma. */
static double misfit(const placido_guide_focus *focus, const double *residuals_px,
                     const struct normal *solved) {
  double sum = 0;
  int count = 0;
  for (int k = 0; k < focus->edge_count; k++) {
    double rest = residuals_px[k];
    for (int p = 0; p < PARAMETERS; p++) {
      rest -= solved->b[p] * prior_sigmas[p] * focus->slope_px[p][k];
    }
    if (!isnan(rest)) {
      rest /= shape_sigma * focus->expected_px[k];
      sum += rest * rest;
      count++;
    }
  }
  return sqrt(sum / count);
}

double placido_guide_focus_find(const placido_guide_focus *focus, const placido_guide_walk *walk) {
  double residuals_px[PLACIDO_EDGES_MAX];
  int seen = 0;
  if (!focus->can_tell) {
    return NAN;
  }
  for (int k = 0; k < focus->edge_count; k++) {
    residuals_px[k] =
        has_edge(focus, k) ? mean_radius(walk, k) - focus->expected_px[k] : (double)NAN;
    seen += !isnan(residuals_px[k]);
  }
  if (seen < SEEN_MIN) {
    return NAN;
  }
  struct normal normal = start_normal();
  for (int k = 0; k < focus->edge_count; k++) {
    if (!isnan(residuals_px[k])) {
      add_edge(&normal, focus, k, seen, residuals_px[k]);
    }
  }
  const double sigma_mm = sqrt(solve(&normal)) * Z_SIGMA_MM;
  const double z_mm = normal.b[PARAMETERS - 1] * Z_SIGMA_MM;
  return sigma_mm < sigma_max_mm && misfit(focus, residuals_px, &normal) < misfit_max
             ? z_mm
             : (double)NAN;
}
