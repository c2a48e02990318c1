/* Indices of an export of rings: the Placido indices of the rings themselves, and simulated
 * keratometry by the maker's rule in place of ours, so that it can be held against the header. */
#include "exchange/rings.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

#define UNKNOWN_DEG 51.96 /* of an axis that may be anywhere: 180/sqrt(12) */

/* The rows that the rule gives, in the order of `figures_of`. */
static const struct {
  const char *name;
  bool axis;
  const char *help;
} rows[] = {
    {"simk_flat_D", false,
     "Simulated keratometry as the maker of the file has it: 337.5 over the mean axial radius on "
     "the rings 6 to 10 of both halves of the flattest diameter."},
    {"simk_flat_axis_deg", true,
     "Meridian of simk_flat_D, 0 to 180, from +x (right) towards +y (up)."},
    {"simk_steep_D", false,
     "Simulated keratometry of the diameter perpendicular to the flattest, by the same rule."},
    {"simk_steep_axis_deg", true, "Meridian of simk_steep_D, perpendicular to the flattest."},
    {"simk_cylinder_D", false, "Corneal astigmatism: simk_steep_D less simk_flat_D."},
    {"simk_mean_D", false, "Mean of simk_flat_D and simk_steep_D."},
};
#define ROWS (sizeof rows / sizeof rows[0])

static bool figures_of(double figures[ROWS], const placido_elevation *elevation,
                       const placido_surface *surface) {
  placido_ring_simk simk;
  bool known = placido_elevation_simk(&simk, elevation, surface);
  const double all[ROWS] = {simk.flat_D,         simk.flat_axis_deg,
                            simk.steep_D,        simk.steep_axis_deg,
                            simk.steep_D - simk.flat_D, (simk.steep_D + simk.flat_D) / 2};
  memcpy(figures, all, sizeof all);
  return known;
}

/* What the fit's variants change in each row, squared and summed by source. */
static int add_variants(double sums[ROWS][PLACIDO_SIGMA_SOURCES], const double figures[ROWS],
                        const placido_elevation *elevation, const placido_fit *fit,
                        placido_error *err) {
  for (int v = 0; v < placido_fit_variant_count(fit); v++) {
    placido_surface *variant;
    double moved[ROWS];
    int status = placido_fit_variant(&variant, fit, v, err);
    if (status) {
      return status;
    }
    figures_of(moved, elevation, variant);
    placido_surface_free(variant);
    for (size_t i = 0; i < ROWS; i++) {
      double change = moved[i] - figures[i];
      change = rows[i].axis ? remainder(change, 180) : change;
      sums[i][placido_fit_variant_source(fit, v)] += change * change;
    }
  }
  return PLACIDO_OK;
}

static placido_index_value *index_called(placido_index_value *values, size_t count,
                                         const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return &values[i];
    }
  }
  return NULL;
}

static void put(placido_index_value *value, size_t row, double figure,
                const double squares[PLACIDO_SIGMA_SOURCES]) {
  double sum = 0;
  value->value = figure;
  value->help = rows[row].help;
  value->reason = isnan(figure) ? "no_cylinder" : NULL;
  for (int s = 0; s < PLACIDO_SIGMA_SOURCES; s++) {
    value->budget[s] = isnan(figure) ? (double)NAN : sqrt(squares[s]);
    sum += squares[s];
  }
  value->sigma = isnan(figure) ? (double)NAN : sqrt(sum);
  if (rows[row].axis) {
    value->sigma = fmin(value->sigma, UNKNOWN_DEG);
  }
}

/* Replaces the rows of simulated keratometry. */
static int put_simk(placido_index_value *values, size_t count, const placido_elevation *elevation,
                    const placido_fit *fit, placido_error *err) {
  double figures[ROWS], sums[ROWS][PLACIDO_SIGMA_SOURCES] = {{0}};
  if (!figures_of(figures, elevation, placido_fit_surface(fit))) {
    return PLACIDO_OK;
  }
  int status = add_variants(sums, figures, elevation, fit, err);
  for (size_t i = 0; i < ROWS && !status; i++) {
    placido_index_value *value = index_called(values, count, rows[i].name);
    if (value) {
      put(value, i, figures[i], sums[i]);
    }
  }
  return status;
}

int placido_elevation_indices(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                              const placido_elevation *elevation, const placido_fit *fit,
                              placido_error *err) {
  if (elevation->ring_count == 0) {
    return PLACIDO_OK;
  }
  placido_mire_rings *rings = placido_memory_new(1, sizeof *rings, err);
  if (!rings) {
    return PLACIDO_MEMORY;
  }
  placido_elevation_rings(rings, elevation);
  placido_indices_of_rings(values, count, rings);
  placido_memory_free(rings);
  return put_simk(values, *count, elevation, fit, err);
}
