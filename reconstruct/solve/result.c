/* Error bars by linear propagation: edge noise through the inverse of the normal matrix, the
 * uncertainty of distance and geometry through the derivative of the solution. */
#include "reconstruct/solve/result.h"

#include "base/memory.h"
#include "reconstruct/solve/refine.h"

#include <math.h>

#define BUDGET_STEP_MM 0.25

int placido_fit_covariance(placido_fit *fit, placido_error *err) {
  size_t n = (size_t)fit->grid.side * (size_t)fit->grid.side;
  double *right = placido_memory_new(n, sizeof *right, err);
  fit->by_distance = placido_memory_new(n, sizeof *fit->by_distance, err);
  int status = right && fit->by_distance ? PLACIDO_OK : PLACIDO_MEMORY;
  placido_basis basis;
  if (!status) {
    /* the spring at the axis pulls to the distance: its push per millimetre is weight · B(0, 0) */
    placido_grid_basis(&fit->grid, 0, 0, &basis);
    for (int i = 0; i < PLACIDO_SPLINE_CELL; i++) {
      int j = i / PLACIDO_SPLINE_ORDER, k = i % PLACIDO_SPLINE_ORDER;
      right[(basis.row + j) * fit->grid.side + basis.column + k] =
          PLACIDO_DISTANCE_WEIGHT * basis.y[0][j] * basis.x[0][k];
    }
    status = placido_normal_solve_more(fit->normal, right, 1, fit->by_distance, err);
  }
  if (!status) {
    status = placido_normal_inverse(fit->normal, &fit->inverse, err);
  }
  if (!status) {
    status = placido_fit_variants_draw(fit, err);
  }
  placido_memory_free(right);
  return status;
}

void placido_fit_free(placido_fit *fit) {
  if (!fit) {
    return;
  }
  placido_surface_free(fit->surface);
  placido_normal_free(fit->normal);
  placido_memory_free(fit->inverse);
  placido_memory_free(fit->by_distance);
  placido_memory_free(fit->geometry);
  placido_memory_free(fit->modes);
  placido_memory_free(fit->draws);
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
  for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
    int j = k / PLACIDO_SPLINE_ORDER, i = k % PLACIDO_SPLINE_ORDER;
    place->height[k] = b->y[0][j] * b->x[0][i];
    place->tilt[k] = along[0] * b->y[0][j] * b->x[1][i] + along[1] * b->y[1][j] * b->x[0][i];
  }
  return true;
}

/* Variances of height in mm² and of slope. */
struct variance {
  double height, tilt;
};

static struct variance from_covariance(const placido_fit *fit, const double *covariance,
                                       const struct place *place) {
  int column = place->basis.column, row = place->basis.row;
  return (struct variance){
      placido_normal_variance(fit->normal, covariance, column, row, place->height),
      placido_normal_variance(fit->normal, covariance, column, row, place->tilt)};
}

/* What the distance lifts as a whole, itself included, is no error of the shape: lifted is what is
 * left here beyond the lift on the axis. */
static struct variance from_distance(const placido_fit *fit, const struct place *place) {
  double lifted = -1, tilted = 0;
  for (int k = 0; k < PLACIDO_SPLINE_CELL; k++) {
    int j = k / PLACIDO_SPLINE_ORDER, i = k % PLACIDO_SPLINE_ORDER;
    double by = fit->by_distance[(place->basis.row + j) * fit->grid.side + place->basis.column + i];
    lifted += place->height[k] * by;
    tilted += place->tilt[k] * by;
  }
  double height = lifted * fit->axis_z_sigma_mm, tilt = tilted * fit->axis_z_sigma_mm;
  return (struct variance){height * height, tilt * tilt};
}

/* The sources' variances, in the order of placido_sigma_source. The geometry moves no height on the
 * axis, where it is given. */
static void variances(struct variance out[PLACIDO_SIGMA_SOURCES], const placido_fit *fit,
                      const struct place *place) {
  struct variance noise = from_covariance(fit, fit->inverse, place);
  out[PLACIDO_SIGMA_NOISE] = (struct variance){fit->variance_scale * noise.height,
                                               fit->variance_scale * noise.tilt};
  out[PLACIDO_SIGMA_DISTANCE] = from_distance(fit, place);
  out[PLACIDO_SIGMA_GEOMETRY] = (struct variance){0};
  if (fit->geometry) {
    out[PLACIDO_SIGMA_GEOMETRY] = from_covariance(fit, fit->geometry, place);
  }
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
