/* Zernike terms of the sag by least squares on a square grid of points, each of which stands for
 * the same area. Terms: ANSI Z80.28. */
#include <placido/expansion.h>

#include "base/dense.h"
#include "base/memory.h"

#include <placido/zernike.h>

#include <math.h>
#include <string.h>

#define POINTS_PER_RADIUS 50
#define COVERED_LEAST 0.9
#define RADIUS_USUAL_MM 3.0
#define RADIUS_LEAST_MM 0.1
#define SEARCH_STEP_MM 0.05
#define SEARCH_ANGLES 180
#define SINGULAR 1e-12 /* share of its diagonal element below which a pivot is rounding */
#define PI 3.14159265358979323846

/* What is computed once for all surfaces: where, and the factor of the normal equations. */
struct plan {
  int count;        /* terms */
  size_t points;    /* those supported */
  double *x_mm, *y_mm;
  double *terms;    /* count rows of `points` */
  double *factor;   /* count * count, lower triangle */
  double *sag_mm;   /* of the surface at hand */
};

/* The radius of the widest disc about the axis of which data support every point. */
static double covered_radius_mm(const placido_surface *surface) {
  double radius = 0, most = placido_surface_radius_mm(surface);
  for (; radius + SEARCH_STEP_MM <= most; radius += SEARCH_STEP_MM) {
    for (int i = 0; i < SEARCH_ANGLES; i++) {
      double angle = 2 * PI * i / SEARCH_ANGLES, r = radius + SEARCH_STEP_MM;
      if (!placido_surface_covered(surface, r * cos(angle), r * sin(angle))) {
        return radius;
      }
    }
  }
  return radius;
}

static void plan_free(struct plan *plan) {
  placido_memory_free(plan->x_mm);
  placido_memory_free(plan->y_mm);
  placido_memory_free(plan->terms);
  placido_memory_free(plan->factor);
  placido_memory_free(plan->sag_mm);
}

/* Lists the supported points of the disc; the share of all of them to *covered. */
static int list_points(struct plan *plan, double *covered, const placido_surface *surface,
                       double radius_mm, placido_error *err) {
  const int half = POINTS_PER_RADIUS;
  size_t most = (size_t)(2 * half) * (size_t)(2 * half), all = 0;
  plan->x_mm = placido_memory_new(most, sizeof *plan->x_mm, err);
  plan->y_mm = placido_memory_new(most, sizeof *plan->y_mm, err);
  if (!plan->x_mm || !plan->y_mm) {
    return PLACIDO_MEMORY;
  }
  for (int j = -half; j < half; j++) {
    for (int i = -half; i < half; i++) {
      double x = (i + 0.5) * radius_mm / half, y = (j + 0.5) * radius_mm / half;
      placido_jet jet;
      if (hypot(x, y) > radius_mm) {
        continue;
      }
      all++;
      if (placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, &jet)) {
        plan->x_mm[plan->points] = x;
        plan->y_mm[plan->points++] = y;
      }
    }
  }
  *covered = (double)plan->points / (double)all;
  return PLACIDO_OK;
}

static double product(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

static int evaluate_terms(struct plan *plan, int order, double radius_mm, placido_error *err) {
  size_t n = (size_t)plan->count;
  plan->terms = placido_memory_new(n * plan->points, sizeof *plan->terms, err);
  plan->factor = placido_memory_new(n * n, sizeof *plan->factor, err);
  plan->sag_mm = placido_memory_new(2 * plan->points, sizeof *plan->sag_mm, err);
  if (!plan->terms || !plan->factor || !plan->sag_mm) {
    return PLACIDO_MEMORY;
  }
  double *x = plan->sag_mm, *y = x + plan->points; /* free until there is a sag */
  for (size_t i = 0; i < plan->points; i++) {
    x[i] = plan->x_mm[i] / radius_mm;
    y[i] = plan->y_mm[i] / radius_mm;
  }
  placido_zernike_terms(plan->terms, order, x, y, plan->points);
#pragma omp parallel for schedule(dynamic)
  for (int i = 0; i < plan->count; i++) {
    for (int k = 0; k <= i; k++) {
      plan->factor[i * plan->count + k] =
          product(plan->terms + (size_t)i * plan->points, plan->terms + (size_t)k * plan->points,
                  plan->points);
    }
  }
  if (!placido_dense_factor(plan->factor, plan->count, plan->count, SINGULAR)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the supported part of the disc does not tell the %d terms apart",
                             plan->count);
  }
  return PLACIDO_OK;
}

/* The surface's terms, mm. */
static void expand(double *coefficients, struct plan *plan, const placido_surface *surface) {
  int n = plan->count;
  for (size_t i = 0; i < plan->points; i++) {
    placido_jet jet;
    placido_surface_at(surface, plan->x_mm[i], plan->y_mm[i], &jet);
    plan->sag_mm[i] = jet.sag;
  }
  for (int i = 0; i < n; i++) {
    coefficients[i] = product(plan->terms + (size_t)i * plan->points, plan->sag_mm, plan->points);
  }
  placido_dense_solve(plan->factor, n, n, coefficients);
}

/* What the terms leave of the sag that was expanded last. */
static void judge(placido_expansion *e, const struct plan *plan, const double *coefficients) {
  double sum = 0;
  for (size_t i = 0; i < plan->points; i++) {
    double rest = plan->sag_mm[i];
    for (int k = 0; k < plan->count; k++) {
      rest -= coefficients[k] * plan->terms[(size_t)k * plan->points + i];
    }
    sum += rest * rest;
    e->worst_um = fmax(e->worst_um, 1e3 * fabs(rest));
  }
  e->rms_um = 1e3 * sqrt(sum / (double)plan->points);
}

/* Standard deviations: what the variants change. A variant's height on the axis differs by what its
 * surface says, as the surface's own does. */
static int find_sigmas(placido_expansion *e, struct plan *plan, const placido_fit *fit,
                       const double *coefficients, placido_error *err) {
  double other[PLACIDO_ZERNIKE_TERMS], sum[PLACIDO_ZERNIKE_TERMS] = {0};
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    placido_surface *variant;
    int status = placido_fit_variant(&variant, fit, v, err);
    if (status) {
      return status;
    }
    expand(other, plan, variant);
    placido_surface_free(variant);
    for (int k = 0; k < plan->count; k++) {
      double change = other[k] - coefficients[k];
      sum[k] += change * change;
    }
  }
  for (int k = 0; k < plan->count; k++) {
    e->sigma_um[k] = 1e3 * sqrt(sum[k]);
  }
  return PLACIDO_OK;
}

static int check(placido_expansion *e, const placido_surface *surface, placido_error *err) {
  if (e->order < 1 || e->order > PLACIDO_ZERNIKE_ORDER_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "Zernike order %d: 1 to %d is expected", e->order,
                             PLACIDO_ZERNIKE_ORDER_MAX);
  }
  double most = placido_surface_radius_mm(surface);
  if (e->radius_mm == 0) {
    e->radius_mm = fmin(RADIUS_USUAL_MM, covered_radius_mm(surface));
  }
  if (!(e->radius_mm >= RADIUS_LEAST_MM && e->radius_mm <= most)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a disc of radius %.3g mm: %g mm to where the surface ends, %.3f mm, "
                             "is expected",
                             e->radius_mm, RADIUS_LEAST_MM, most);
  }
  return PLACIDO_OK;
}

int placido_expansion_find(placido_expansion *expansion, const placido_surface *surface,
                           const placido_fit *fit, double radius_mm, int order,
                           placido_error *err) {
  placido_expansion e = {.radius_mm = radius_mm,
                         .order = order,
                         .vertex_z_mm = placido_surface_vertex_z_mm(surface)};
  double coefficients[PLACIDO_ZERNIKE_TERMS] = {0};
  struct plan plan = {0};
  *expansion = (placido_expansion){0};
  int status = check(&e, surface, err);
  if (status) {
    return status;
  }
  plan.count = e.count = placido_zernike_count(order);
  status = list_points(&plan, &e.covered, surface, e.radius_mm, err);
  if (!status && e.covered < COVERED_LEAST) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "data support %.0f %% of a disc of radius %.3g mm, %.0f %% are "
                               "needed; all of it up to %.2f mm",
                               100 * e.covered, e.radius_mm, 100 * COVERED_LEAST,
                               covered_radius_mm(surface));
  }
  if (!status) {
    status = evaluate_terms(&plan, order, e.radius_mm, err);
  }
  if (!status) {
    expand(coefficients, &plan, surface);
    judge(&e, &plan, coefficients);
    for (int k = 0; k < PLACIDO_ZERNIKE_TERMS; k++) {
      e.coefficients_um[k] = 1e3 * coefficients[k];
      e.sigma_um[k] = NAN;
    }
    status = fit ? find_sigmas(&e, &plan, fit, coefficients, err) : PLACIDO_OK;
  }
  plan_free(&plan);
  if (!status) {
    *expansion = e;
  }
  return status;
}
