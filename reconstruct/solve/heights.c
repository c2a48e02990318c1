/* The fit to heights: linear least squares for the coefficients of a biquintic B-spline on a
 * paraboloid, with the penalty on third derivatives of the fit to mires (Eilers and Marx, Statist.
 * Sci. 11, 89-121, 1996, in two dimensions), its weight that of the residuals' variance. */
#include <placido/heights.h>

#include "base/memory.h"
#include "reconstruct/maps/equations.h"
#include "reconstruct/solve/doubt/mask.h"
#include "reconstruct/solve/engine/normal.h"
#include "reconstruct/solve/errors/result.h"

#include <math.h>

#define POINTS_MIN 200
#define MARGIN_MM 0.6
#define REACH_MM 20.0        /* of a point from the axis: what a surface file can hold */
#define RADIUS_LEAST_MM 4.0  /* of curvature, of what may be a cornea */
#define RADIUS_MOST_MM 20.0
#define HALF_MIN_MM 1.0      /* what of a cornea must be there at least */
#define SMOOTHING 1e2        /* weight of the penalty over the residuals' variance */
#define SIGMA_FIRST_MM 1e-4  /* until there are residuals */
#define SIGMA_LEAST_MM 1e-7  /* rounding in files */
#define ENOUGH_MM 5e-5       /* residual at which finer knots need not be tried */
#define GAIN 0.85            /* finer knots must bring the residuals below this share */
#define FREEDOM 2            /* points per coefficient at least */
#define LAGS 64              /* neighbours over which residuals may be correlated */
#define UNCORRELATED 0.05
#define CLOSING 1.5          /* reach of the coverage's closing, in spacings */
#define CLOSING_MIN_MM 0.3
#define CLOSING_MAX_MM 1.5

static const double KNOTS_MM[] = {0.5, 0.35, 0.25, 0.2};
#define KNOT_CHOICES (sizeof KNOTS_MM / sizeof KNOTS_MM[0])
#define KNOT_LEAST_MM 0.15
#define KNOT_MOST_MM 2.0

/* z = a + b x + c y + d (x² + y²) */
typedef struct paraboloid {
  double a, b, c, d;
} paraboloid;

/* One grid and how well it follows the points. */
typedef struct attempt {
  placido_grid grid;
  placido_normal *normal;
  double *coefficients; /* of z on the paraboloid's a + d r² */
  double *residual_mm;
  double rms_mm, sigma_mm;
} attempt;

/* What all attempts share. */
typedef struct task {
  const placido_height *heights;
  size_t count;
  paraboloid base;
  double reach_mm, spacing_mm;
  size_t *order; /* of the points, by cell of a grid */
} task;

static bool fit_paraboloid(paraboloid *base, const placido_height *heights, size_t count) {
  placido_equations equations = {.unknowns = 4};
  double u[4];
  for (size_t i = 0; i < count; i++) {
    const placido_height *h = &heights[i];
    const double row[4] = {1, h->x_mm, h->y_mm, h->x_mm * h->x_mm + h->y_mm * h->y_mm};
    placido_equations_add(&equations, row, h->z_mm);
  }
  if (!placido_equations_solve(&equations, u)) {
    return false;
  }
  *base = (paraboloid){u[0], u[1], u[2], u[3]};
  return true;
}

double placido_heights_curvature(const placido_height *heights, size_t count) {
  paraboloid base;
  return fit_paraboloid(&base, heights, count) ? -2 * base.d : (double)NAN;
}

/* Height over what the spline lies on. */
static double over_base(const task *t, const placido_height *h) {
  return h->z_mm - t->base.a - t->base.d * (h->x_mm * h->x_mm + h->y_mm * h->y_mm);
}

/* The points by cell: order[start[c]] to order[start[c + 1] - 1] lie in cell c. */
static int sort_by_cell(size_t **start, const task *t, const placido_grid *grid,
                        placido_error *err) {
  size_t cells = (size_t)grid->cells * (size_t)grid->cells;
  size_t *first = *start = placido_memory_new(cells + 2, sizeof *first, err);
  if (!first) {
    return PLACIDO_MEMORY;
  }
  placido_basis basis;
  first++; /* counted one further on, so that filling in leaves the starts */
  for (size_t i = 0; i < t->count; i++) {
    placido_grid_basis(grid, t->heights[i].x_mm, t->heights[i].y_mm, &basis);
    first[basis.row * grid->cells + basis.column + 1]++;
  }
  for (size_t c = 1; c <= cells; c++) {
    first[c] += first[c - 1];
  }
  for (size_t i = 0; i < t->count; i++) {
    placido_grid_basis(grid, t->heights[i].x_mm, t->heights[i].y_mm, &basis);
    t->order[first[basis.row * grid->cells + basis.column]++] = i;
  }
  return PLACIDO_OK;
}

/* Adds one cell's points to the normal equations. */
static void add_cell(placido_normal *normal, const task *t, const placido_grid *grid,
                     const size_t *points, size_t count) {
  double block[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL] = {0}, right[PLACIDO_SPLINE_CELL] = {0};
  double row[PLACIDO_SPLINE_CELL];
  placido_basis basis;
  for (size_t p = 0; p < count; p++) {
    const placido_height *h = &t->heights[points[p]];
    double value = over_base(t, h);
    placido_grid_basis(grid, h->x_mm, h->y_mm, &basis);
    for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
      row[k] = basis.y[0][k / PLACIDO_SPLINE_ORDER] * basis.x[0][k % PLACIDO_SPLINE_ORDER];
    }
    for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
      right[k] += row[k] * value;
      for (int m = 0; m <= k; m++) {
        block[k * PLACIDO_SPLINE_CELL + m] += row[k] * row[m];
      }
    }
  }
  if (count > 0) {
    placido_normal_add(normal, basis.column, basis.row, block, right);
  }
}

/* Fills the residuals and their figures. */
static void judge(attempt *a, const task *t) {
  double sum = 0;
  for (size_t i = 0; i < t->count; i++) {
    const placido_height *h = &t->heights[i];
    placido_basis basis;
    double jet[6];
    placido_grid_basis(&a->grid, h->x_mm, h->y_mm, &basis);
    placido_grid_value(&a->grid, a->coefficients, &basis, jet);
    a->residual_mm[i] = over_base(t, h) - jet[0];
    sum += a->residual_mm[i] * a->residual_mm[i];
  }
  double cell = t->spacing_mm / a->grid.knot_mm; /* coefficients that data speak of, per point */
  double freedom = fmax(1 - cell * cell, 1.0 / FREEDOM);
  a->rms_mm = sqrt(sum / (double)t->count);
  a->sigma_mm = fmax(a->rms_mm / sqrt(freedom), SIGMA_LEAST_MM);
}

/* Solves for the coefficients, the smoothing that of residuals of sigma_mm. */
static int solve(attempt *a, const task *t, double sigma_mm, placido_error *err) {
  size_t *start, cells = (size_t)a->grid.cells * (size_t)a->grid.cells;
  size_t unknowns = (size_t)a->grid.side * (size_t)a->grid.side;
  int status = sort_by_cell(&start, t, &a->grid, err);
  if (status) {
    return status;
  }
  placido_normal_clear(a->normal);
  for (size_t i = 0; i < unknowns; i++) {
    a->coefficients[i] = 0;
  }
  for (size_t c = 0; c < cells; c++) {
    add_cell(a->normal, t, &a->grid, t->order + start[c], start[c + 1] - start[c]);
  }
  placido_normal_smooth(a->normal, SMOOTHING * sigma_mm * sigma_mm, a->coefficients);
  status = placido_normal_solve(a->normal, 0, a->coefficients, err);
  placido_memory_free(start);
  if (status == PLACIDO_QUALITY) {
    status = placido_error_set(err, status, "the points do not determine a surface");
  }
  if (!status) {
    judge(a, t);
  }
  return status;
}

static void attempt_free(attempt *a) {
  placido_normal_free(a->normal);
  placido_memory_free(a->coefficients);
  placido_memory_free(a->residual_mm);
  *a = (attempt){0};
}

static int attempt_new(attempt *a, const task *t, double knot_mm, double sigma_mm,
                       placido_error *err) {
  *a = (attempt){.grid = placido_grid_covering(t->reach_mm + MARGIN_MM, knot_mm,
                                                 PLACIDO_SPLINE_DEGREE)};
  size_t unknowns = (size_t)a->grid.side * (size_t)a->grid.side;
  a->coefficients = placido_memory_new(unknowns, sizeof *a->coefficients, err);
  a->residual_mm = placido_memory_new(t->count, sizeof *a->residual_mm, err);
  int status = a->coefficients && a->residual_mm ? placido_normal_new(&a->normal, &a->grid, err)
                                                 : PLACIDO_MEMORY;
  return status ? status : solve(a, t, sigma_mm, err);
}

/* Whether there are points enough for these knots. */
static bool supports(const task *t, double knot_mm) {
  double per_knot = knot_mm / t->spacing_mm;
  return per_knot * per_knot >= FREEDOM;
}

/* Tries finer and finer knots while that brings the residuals down. */
static int explore(attempt *best, const task *t, double asked_mm, placido_error *err) {
  size_t choices = asked_mm > 0 ? 1 : KNOT_CHOICES;
  double coarse_mm = fmax(KNOTS_MM[0], 1.5 * t->spacing_mm); /* of points that are far apart */
  int status = attempt_new(best, t, asked_mm > 0 ? asked_mm : coarse_mm, SIGMA_FIRST_MM, err);
  for (size_t i = 1; i < choices && !status && best->rms_mm > ENOUGH_MM; i++) {
    if (!supports(t, KNOTS_MM[i])) {
      break;
    }
    attempt finer;
    status = attempt_new(&finer, t, KNOTS_MM[i], best->sigma_mm, err);
    if (status || finer.sigma_mm > GAIN * best->sigma_mm) {
      attempt_free(&finer);
      break;
    }
    attempt_free(best);
    *best = finer;
  }
  return status ? status : solve(best, t, best->sigma_mm, err);
}

/* Side of the square that one point has for itself: of the cells of a size at which each that is
 * not empty holds a few. */
static int find_spacing(task *t, placido_error *err) {
  for (double cell_mm = 0.1;; cell_mm *= 2) {
    int half = (int)(t->reach_mm / cell_mm) + 1, side = 2 * half + 1;
    unsigned char *seen = placido_memory_new((size_t)side * (size_t)side, 1, err);
    size_t cells = 0;
    if (!seen) {
      return PLACIDO_MEMORY;
    }
    for (size_t i = 0; i < t->count; i++) {
      size_t column = (size_t)(floor(t->heights[i].x_mm / cell_mm) + half);
      size_t row = (size_t)(floor(t->heights[i].y_mm / cell_mm) + half);
      cells += !seen[row * (size_t)side + column];
      seen[row * (size_t)side + column] = 1;
    }
    placido_memory_free(seen);
    double share = (double)t->count / (double)cells;
    if (share >= 4 || cell_mm > t->reach_mm) {
      t->spacing_mm = cell_mm / sqrt(share);
      return PLACIDO_OK;
    }
  }
}

static int check_points(task *t, placido_error *err) {
  if (t->count < POINTS_MIN) {
    return placido_error_set(err, PLACIDO_QUALITY, "only %zu points, at least %d are needed",
                             t->count, POINTS_MIN);
  }
  for (size_t i = 0; i < t->count; i++) {
    const placido_height *h = &t->heights[i];
    double far = fmax(fabs(h->x_mm), fabs(h->y_mm));
    if (!isfinite(h->x_mm + h->y_mm + h->z_mm) || far > REACH_MM) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "point %zu at (%g, %g) mm, %g mm high: finite numbers within %g mm "
                               "of the axis are expected",
                               i, h->x_mm, h->y_mm, h->z_mm, REACH_MM);
    }
    t->reach_mm = fmax(t->reach_mm, far);
  }
  double power = fit_paraboloid(&t->base, t->heights, t->count) ? -2 * t->base.d : (double)NAN;
  if (isnan(power) || t->reach_mm < HALF_MIN_MM) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the points lie on one line or within %g mm of the axis: they "
                             "determine no surface",
                             HALF_MIN_MM);
  }
  if (!(1 / power >= RADIUS_LEAST_MM && 1 / power <= RADIUS_MOST_MM)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the points have a radius of curvature of %.4g mm, a cornea has %g "
                             "to %g mm: wrong units, or heights of the other sign",
                             1 / power, RADIUS_LEAST_MM, RADIUS_MOST_MM);
  }
  return PLACIDO_OK;
}

/* 1 + 2 Σ of the autocorrelation, up to where it is lost in the noise. */
static double correlation_of(const attempt *a, size_t count) {
  double sum = 1, variance = a->rms_mm * a->rms_mm * (double)count;
  for (size_t lag = 1; lag <= LAGS && lag < count && variance > 0; lag++) {
    double product = 0;
    for (size_t i = lag; i < count; i++) {
      product += a->residual_mm[i] * a->residual_mm[i - lag];
    }
    if (product < UNCORRELATED * variance) {
      break;
    }
    sum += 2 * product / variance;
  }
  return sum;
}

static void summarise(placido_heights_summary *s, const attempt *a, const task *t) {
  *s = (placido_heights_summary){.count = t->count,
                                 .rms_um = 1e3 * a->rms_mm,
                                 .sigma_um = 1e3 * a->sigma_mm,
                                 .correlation = correlation_of(a, t->count),
                                 .spacing_mm = t->spacing_mm,
                                 .knot_mm = a->grid.knot_mm};
  for (size_t i = 0; i < t->count; i++) {
    if (fabs(a->residual_mm[i]) > fabs(s->worst_um) * 1e-3) {
      s->worst_um = 1e3 * a->residual_mm[i];
      s->worst = i;
    }
  }
}

static int cover(placido_coverage *coverage, unsigned char **mask, double *radius_mm,
                 const task *t, placido_error *err) {
  placido_place *places = placido_memory_new(t->count, sizeof *places, err);
  if (!places) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < t->count; i++) {
    places[i] = (placido_place){t->heights[i].x_mm, t->heights[i].y_mm};
  }
  double reach = fmin(fmax(CLOSING * t->spacing_mm, CLOSING_MIN_MM), CLOSING_MAX_MM);
  int status = placido_mask_close(coverage, mask, radius_mm, places, t->count, reach, err);
  placido_memory_free(places);
  *radius_mm = fmin(*radius_mm, REACH_MM);
  return status;
}

static int build_surface(placido_fit *fit, const attempt *a, const task *t, placido_error *err) {
  const placido_grid *g = &a->grid;
  size_t unknowns = (size_t)g->side * (size_t)g->side;
  size_t knots = (size_t)g->side + PLACIDO_SPLINE_ORDER;
  placido_coverage coverage;
  unsigned char *mask = NULL;
  double *places = placido_memory_new(knots, sizeof *places, err);
  double *sags = placido_memory_new(unknowns, sizeof *sags, err);
  int status = places && sags ? cover(&coverage, &mask, &fit->summary.radius_mm, t, err)
                              : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < knots; i++) {
      places[i] = ((double)i - PLACIDO_SPLINE_DEGREE) * g->knot_mm - g->half_mm;
    }
    for (size_t i = 0; i < unknowns; i++) {
      sags[i] = -a->coefficients[i];
    }
    double r = -1 / (2 * t->base.d);
    const placido_part parts[2] = {
        {.kind = PLACIDO_PART_BICONIC, .as.biconic = {.r1 = r, .q1 = -1, .r2 = r, .q2 = -1}},
        {.kind = PLACIDO_PART_BSPLINE,
         .as.bspline = {PLACIDO_SPLINE_DEGREE, g->side, g->side, places, places, sags}}};
    status = placido_surface_new(&fit->surface, t->base.a, fit->summary.radius_mm, parts, 2,
                                 &coverage, err);
  }
  placido_memory_free(places);
  placido_memory_free(sags);
  placido_memory_free(mask);
  return status;
}

static int build_fit(placido_fit *fit, attempt *a, const task *t,
                     const placido_heights_summary *summary, placido_error *err) {
  fit->grid = a->grid;
  fit->normal = a->normal;
  a->normal = NULL;
  fit->variance_scale = a->sigma_mm * a->sigma_mm * summary->correlation;
  fit->summary = (placido_fit_summary){.rms_px = NAN,
                                       .sigma_px = NAN,
                                       .points = t->count,
                                       .points_used = t->count,
                                       .knot_mm = a->grid.knot_mm,
                                       .condition = 1 / placido_normal_rcond(fit->normal)};
  int status = placido_fit_covariance(fit, err);
  if (!status) {
    status = build_surface(fit, a, t, err);
  }
  return status ? status : placido_fit_level_find(fit, err);
}

int placido_heights_fit(placido_fit **fit, placido_heights_summary *summary,
                        const placido_height *heights, size_t count, double knot_mm,
                        placido_error *err) {
  *fit = NULL;
  *summary = (placido_heights_summary){0};
  if (knot_mm != 0 && !(knot_mm >= KNOT_LEAST_MM && knot_mm <= KNOT_MOST_MM)) {
    return placido_error_set(err, PLACIDO_INPUT, "knots every %g mm, expected %g to %g mm", knot_mm,
                             KNOT_LEAST_MM, KNOT_MOST_MM);
  }
  attempt best = {0};
  task t = {.heights = heights, .count = count};
  int status = check_points(&t, err);
  if (status || (status = find_spacing(&t, err))) {
    return status;
  }
  placido_fit *f = placido_memory_new(1, sizeof *f, err);
  t.order = placido_memory_new(count, sizeof *t.order, err);
  status = f && t.order ? explore(&best, &t, knot_mm, err) : PLACIDO_MEMORY;
  if (!status) {
    summarise(summary, &best, &t);
    status = build_fit(f, &best, &t, summary, err);
  }
  if (!status) {
    *fit = f;
    f = NULL;
  }
  placido_fit_free(f);
  placido_memory_free(t.order);
  attempt_free(&best);
  return status;
}
