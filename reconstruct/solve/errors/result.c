/* Error bars by linear propagation: edge noise through the inverse of the normal matrix, the
 * uncertainty of distance and geometry through the derivative of the solution. */
#include "reconstruct/solve/errors/result.h"

#include "base/memory.h"
#include "reconstruct/solve/distance.h"

#include <math.h>
#include <string.h>

#define BUDGET_STEP_MM 0.25
#define LEVEL_MM 3.0 /* the zone whose mean height is 0 */
#define LEVEL_STEP_MM 0.25
#define LEVEL_FINE_MM 0.05 /* where little of the zone is covered: the pitch of the coverage */
#define LEVEL_FEW 64       /* points, of the 113 that the zone has */

/* Index of a cell's coefficients among all; returns how many they are. */
static int coefficients_of(size_t index[PLACIDO_SPLINE_CELL], const placido_fit *fit, int column,
                           int row) {
  int count = 0;
  for (int j = 0; j < fit->grid.order; j++) {
    for (int i = 0; i < fit->grid.order; i++) {
      index[count++] =
          (size_t)(row + j) * (size_t)fit->grid.side + (size_t)(column + i);
    }
  }
  return count;
}

/* Where nothing better is known the noise is alike everywhere. */
static int even_scatter(placido_fit *fit, placido_error *err) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  fit->scatter.spread = placido_memory_new(n, sizeof *fit->scatter.spread, err);
  for (size_t i = 0; i < n && fit->scatter.spread; i++) {
    fit->scatter.spread[i] = sqrt(fit->variance_scale);
  }
  return fit->scatter.spread ? PLACIDO_OK : PLACIDO_MEMORY;
}

int placido_fit_covariance(placido_fit *fit, placido_error *err) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  fit->by_distance = placido_memory_new(n, sizeof *fit->by_distance, err);
  int status = fit->by_distance ? placido_distance_answer(fit->by_distance, fit->normal, &fit->grid,
                                                          err)
                                : PLACIDO_MEMORY;
  if (!status && !fit->inverse) {
    status = placido_normal_inverse(fit->normal, &fit->inverse, err);
  }
  if (!status && !fit->scatter.spread) {
    status = even_scatter(fit, err);
  }
  return status;
}

/* The sum of the heights at a zone's covered points, as weights over the coefficients. Returns how
 * many points it has. */
static int sum_heights(double *level, const placido_fit *fit, double radius_mm, double step_mm) {
  int half = (int)(radius_mm / step_mm), points = 0;
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * step_mm, y = j * step_mm;
      placido_basis b;
      if (hypot(x, y) > radius_mm || !placido_surface_covered(fit->surface, x, y) ||
          !placido_grid_basis(&fit->grid, x, y, &b)) {
        continue;
      }
      points++;
      size_t index[PLACIDO_SPLINE_CELL];
      int count = coefficients_of(index, fit, b.column, b.row);
      for (int k = 0; k < count; k++) {
        level[index[k]] += b.y[0][k / fit->grid.order] * b.x[0][k % fit->grid.order];
      }
    }
  }
  return points;
}

/* The mean height of the zone, or of all that is covered where nothing of the zone is. */
static void find_level(double *level, const placido_fit *fit) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  int points = sum_heights(level, fit, LEVEL_MM / 2, LEVEL_STEP_MM);
  if (points < LEVEL_FEW) {
    memset(level, 0, n * sizeof *level);
    points = sum_heights(level, fit, LEVEL_MM / 2, LEVEL_FINE_MM);
  }
  if (!points) {
    points = sum_heights(level, fit, placido_surface_radius_mm(fit->surface), LEVEL_FINE_MM);
  }
  for (size_t i = 0; i < n && points; i++) {
    level[i] /= points;
  }
}

/* The level times a vector over all coefficients. */
static double level_along(const placido_fit *fit, const double *vector) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    sum += fit->level[i] * vector[i];
  }
  return sum;
}

int placido_fit_level_find(placido_fit *fit, placido_error *err) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  fit->level = placido_memory_new(n, sizeof *fit->level, err);
  fit->with_level = placido_memory_new(n, sizeof *fit->with_level, err);
  fit->lift = placido_memory_new((size_t)fit->mode_count + 1, sizeof *fit->lift, err);
  if (!fit->level || !fit->with_level || !fit->lift) {
    return PLACIDO_MEMORY;
  }
  find_level(fit->level, fit);
  int status = placido_fit_noise_times(fit->with_level, fit, fit->level, 1, err);
  fit->lift[0] = level_along(fit, fit->by_distance);
  for (int m = 0; m < fit->mode_count; m++) {
    fit->lift[1 + m] = level_along(fit, fit->modes + (size_t)m * n);
  }
  fit->level_variance = level_along(fit, fit->with_level);
  return status;
}

void placido_fit_free(placido_fit *fit) {
  if (!fit) {
    return;
  }
  placido_surface_free(fit->surface);
  placido_memory_free(fit->sags_mm);
  placido_normal_free(fit->normal);
  placido_memory_free(fit->inverse);
  placido_memory_free(fit->by_distance);
  placido_memory_free(fit->geometry);
  placido_memory_free(fit->modes);
  placido_memory_free(fit->level);
  placido_memory_free(fit->with_level);
  placido_memory_free(fit->lift);
  placido_scatter_free(&fit->scatter);
  placido_memory_free(fit);
}

const placido_surface *placido_fit_surface(const placido_fit *fit) {
  return fit->surface;
}

placido_fit_summary placido_fit_summary_get(const placido_fit *fit) {
  return fit->summary;
}

/* What the error bars at one place are computed from: the rows of height and of slope along the
 * meridian over the cell's coefficients. */
struct place {
  placido_basis basis;
  int count; /* of the cell's coefficients, and which these are */
  size_t index[PLACIDO_SPLINE_CELL];
  double height[PLACIDO_SPLINE_CELL], tilt[PLACIDO_SPLINE_CELL];
  double power; /* dioptres of axial curvature per unit of slope */
};

static bool place_at(struct place *place, const placido_fit *fit, double x_mm, double y_mm) {
  placido_jet jet;
  if (!placido_surface_at(fit->surface, x_mm, y_mm, &jet) ||
      !placido_grid_basis(&fit->grid, x_mm, y_mm, &place->basis)) {
    return false;
  }
  /* axial curvature s/(r·sqrt(1+s²)) changes by ds/(r·(1+s²)^1.5); at the axis it is s', and the
   * slope's own row over a short radius stands for it */
  double r = hypot(x_mm, y_mm), slope, along[2] = {1, 0};
  double radius = fmax(r, 0.05);
  if (r > 0) {
    along[0] = x_mm / r;
    along[1] = y_mm / r;
  }
  slope = jet.sx * along[0] + jet.sy * along[1];
  place->power = 337.5 / (radius * pow(1 + slope * slope, 1.5));
  const placido_basis *b = &place->basis;
  const int order = fit->grid.order;
  for (int j = 0; j < order; j++) {
    for (int i = 0; i < order; i++) {
      int k = j * order + i;
      place->height[k] = b->y[0][j] * b->x[0][i];
      place->tilt[k] = along[0] * b->y[0][j] * b->x[1][i] + along[1] * b->y[1][j] * b->x[0][i];
    }
  }
  place->count = coefficients_of(place->index, fit, b->column, b->row);
  return true;
}

/* Variances of height in mm² and of slope. */
struct variance {
  double height, tilt;
};

/* A row of the place times a vector over all coefficients. */
static double along(const struct place *place, const double row[PLACIDO_SPLINE_CELL],
                    const double *vector) {
  double sum = 0;
  for (int k = 0; k < place->count; k++) {
    sum += row[k] * vector[place->index[k]];
  }
  return sum;
}

/* rowᵀ C row of the noise. */
static double noise_of(const placido_fit *fit, const struct place *place,
                       const double row[PLACIDO_SPLINE_CELL]) {
  int column = place->basis.column, line = place->basis.row;
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  double spread[PLACIDO_SPLINE_CELL];
  for (int k = 0; k < place->count; k++) {
    spread[k] = row[k] * fit->scatter.spread[place->index[k]];
  }
  double sum = placido_normal_variance(fit->normal, fit->inverse, column, line, spread);
  for (int m = 0; m < fit->scatter.steps; m++) {
    double moved = along(place, row, fit->scatter.step + (size_t)m * n);
    sum += moved * moved;
  }
  return sum;
}

/* What lifts the surface as a whole is no error of the shape: heights count from the level. */
static struct variance from_noise(const placido_fit *fit, const struct place *place) {
  double with = fit->level ? along(place, place->height, fit->with_level) : 0;
  return (struct variance){noise_of(fit, place, place->height) - 2 * with + fit->level_variance,
                           noise_of(fit, place, place->tilt)};
}

static struct variance from_step(const struct place *place, const double *step, double lift,
                                 double factor) {
  double height = factor * (along(place, place->height, step) - lift);
  double tilt = factor * along(place, place->tilt, step);
  return (struct variance){height * height, tilt * tilt};
}

/* The sources' variances, in the order of placido_sigma_source. */
static void variances(struct variance out[PLACIDO_SIGMA_SOURCES], const placido_fit *fit,
                      const struct place *place) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  out[PLACIDO_SIGMA_NOISE] = from_noise(fit, place);
  out[PLACIDO_SIGMA_DISTANCE] =
      from_step(place, fit->by_distance, fit->lift ? fit->lift[0] : 1, fit->axis_z_sigma_mm);
  struct variance geometry = {0};
  for (int m = 0; m < fit->mode_count; m++) {
    struct variance mode = from_step(place, fit->modes + (size_t)m * n,
                                     fit->lift ? fit->lift[1 + m] : 0, 1);
    geometry.height += mode.height;
    geometry.tilt += mode.tilt;
  }
  out[PLACIDO_SIGMA_GEOMETRY] = geometry;
}

/* Where nothing moves, as on the axis, a variance is rounding of either sign. */
static placido_sigma sigma_of(struct variance variance, double power) {
  return (placido_sigma){1e3 * sqrt(fmax(variance.height, 0)),
                         power * sqrt(fmax(variance.tilt, 0))};
}

void placido_fit_sigma_at(const placido_fit *fit, double x_mm, double y_mm, double *sigma_z_um,
                          double *sigma_axial_D) {
  struct place place;
  struct variance source[PLACIDO_SIGMA_SOURCES], sum = {0};
  *sigma_z_um = *sigma_axial_D = NAN;
  if (!place_at(&place, fit, x_mm, y_mm)) {
    return;
  }
  variances(source, fit, &place);
  for (int i = 0; i < PLACIDO_SIGMA_SOURCES; i++) {
    sum.height += source[i].height;
    sum.tilt += source[i].tilt;
  }
  placido_sigma sigma = sigma_of(sum, place.power);
  *sigma_z_um = sigma.z_um;
  *sigma_axial_D = sigma.axial_D;
}

/* Adds the squared sigmas at a place. Returns whether there are any. */
static bool add_squares(placido_sigma sums[PLACIDO_SIGMA_SOURCES], const placido_fit *fit, double x,
                        double y) {
  struct place place;
  struct variance source[PLACIDO_SIGMA_SOURCES];
  if (!placido_surface_covered(fit->surface, x, y) || !place_at(&place, fit, x, y)) {
    return false;
  }
  variances(source, fit, &place);
  for (int i = 0; i < PLACIDO_SIGMA_SOURCES; i++) {
    placido_sigma sigma = sigma_of(source[i], place.power);
    sums[i].z_um += sigma.z_um * sigma.z_um;
    sums[i].axial_D += sigma.axial_D * sigma.axial_D;
  }
  return true;
}

void placido_fit_budget(const placido_fit *fit, double zone_mm,
                        placido_sigma budget[PLACIDO_SIGMA_SOURCES]) {
  double half_mm = fmin(zone_mm / 2, placido_surface_radius_mm(fit->surface));
  int half = (int)(half_mm / BUDGET_STEP_MM), points = 0;
  placido_sigma sums[PLACIDO_SIGMA_SOURCES] = {{0}};
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      double x = i * BUDGET_STEP_MM, y = j * BUDGET_STEP_MM;
      if (hypot(x, y) <= half_mm) {
        points += add_squares(sums, fit, x, y);
      }
    }
  }
  for (int i = 0; i < PLACIDO_SIGMA_SOURCES; i++) {
    bool known = points > 0 && (i != PLACIDO_SIGMA_GEOMETRY || fit->geometry);
    budget[i].z_um = known ? sqrt(sums[i].z_um / points) : (double)NAN;
    budget[i].axial_D = known ? sqrt(sums[i].axial_D / points) : (double)NAN;
  }
}

double placido_fit_open_share(const placido_fit *fit, double limit_D, placido_open *worst) {
  double radius = placido_surface_radius_mm(fit->surface);
  int half = (int)(radius / BUDGET_STEP_MM), covered = 0, open = 0;
  *worst = (placido_open){0};
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      struct place place;
      double x = i * BUDGET_STEP_MM, y = j * BUDGET_STEP_MM;
      if (hypot(x, y) < BUDGET_STEP_MM || !placido_surface_covered(fit->surface, x, y) ||
          !place_at(&place, fit, x, y)) {
        continue;
      }
      double sigma_D = place.power * sqrt(fmax(noise_of(fit, &place, place.tilt), 0));
      covered++;
      open += sigma_D > limit_D;
      if (sigma_D > worst->sigma_D) {
        *worst = (placido_open){x, y, sigma_D};
      }
    }
  }
  return covered ? (double)open / covered : 0;
}

void placido_fit_noise_block(double block[PLACIDO_SPLINE_CELL * PLACIDO_SPLINE_CELL],
                             const placido_fit *fit, int column, int row) {
  const placido_scatter *scatter = &fit->scatter;
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side, at[PLACIDO_SPLINE_CELL];
  const int count = coefficients_of(at, fit, column, row);
  placido_normal_block(fit->normal, fit->inverse, column, row, block);
  for (int r = 0; r < count; r++) {
    for (int c = 0; c < count; c++) {
      double *entry = &block[r * PLACIDO_SPLINE_CELL + c];
      *entry *= scatter->spread[at[r]] * scatter->spread[at[c]];
      for (int m = 0; m < scatter->steps; m++) {
        const double *step = scatter->step + (size_t)m * n;
        *entry += step[at[r]] * step[at[c]];
      }
    }
  }
}

int placido_fit_noise_times(double *answers, const placido_fit *fit, const double *weights,
                            int count, placido_error *err) {
  const placido_scatter *scatter = &fit->scatter;
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side, numbers = n * (size_t)count;
  double *right = placido_memory_new(numbers, sizeof *right, err);
  if (!right) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < numbers; i++) {
    right[i] = weights[i] * scatter->spread[i % n];
  }
  int status = placido_normal_solve_more(fit->normal, right, count, answers, err);
  for (size_t i = 0; i < numbers && !status; i++) {
    answers[i] *= scatter->spread[i % n];
  }
  for (int k = 0; k < count * scatter->steps && !status; k++) {
    const double *row = weights + (size_t)(k / scatter->steps) * n;
    const double *step = scatter->step + (size_t)(k % scatter->steps) * n;
    double *answer = answers + (size_t)(k / scatter->steps) * n, share = 0;
    for (size_t i = 0; i < n; i++) {
      share += step[i] * row[i];
    }
    for (size_t i = 0; i < n; i++) {
      answer[i] += share * step[i];
    }
  }
  placido_memory_free(right);
  return status;
}
