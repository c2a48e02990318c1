/* Measured less known, by zone, weighted by area, and this project's targets.
 *
 * Zones and statistics as ISO 19980 and ANSI Z80.23 have them: diameters of 1 to 3, 3 to 6 and over
 * 6 mm; mean and twice the standard deviation of the differences. On a polar grid a point of ring i
 * weighs pi (r_{i+1/2}² - r_{i-1/2}²) / M, M points a ring. */
#include "acquire/cli/iso_check.h"

#include "reconstruct/maps/equations.h"

#include <placido/index.h>
#include <placido/map.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define RING_STEP_MM 0.1 /* rings at 0.05, 0.15 ...: half-way marks meet the zones' bounds */
#define SPOKES 256
#define POSE_ZONE_MM 6.0

static const double pi = 3.14159265358979323846;

const char iso_targets_note[] =
    "The limits that ISO 19980 sets for instruments of types A and B are not reproduced here; the "
    "targets are this project's own.";

/* Where a ring's point lies, and its weight. */
struct spot {
  double x_mm, y_mm, weight;
};

static struct spot spot_of(int ring, int spoke) {
  const double r = (ring + 0.5) * RING_STEP_MM, angle = 2 * pi * spoke / SPOKES;
  return (struct spot){r * cos(angle), r * sin(angle), 2 * pi * r * RING_STEP_MM / SPOKES};
}

/* The two surfaces. */
struct both {
  const placido_surface *measured, *truth;
};

/* A point at which both are known. */
struct pair {
  placido_map_point measured, known;
};

static void fill_point(placido_map_point *point, const placido_surface *surface, double x_mm,
                       double y_mm, const placido_jet *jet) {
  memset(point, 0, sizeof *point);
  point->x_mm = x_mm;
  point->y_mm = y_mm;
  point->z_mm = placido_surface_vertex_z_mm(surface) - jet->sag;
  point->jet = *jet;
}

static bool pair_at(struct pair *pair, const placido_iso_result *result,
                    const struct both *both, const struct spot *spot) {
  placido_jet seen, known;
  const placido_surface *measured = both->measured, *truth = both->truth;
  const double x = spot->x_mm, y = spot->y_mm, *shift = result->shift_mm;
  if (!placido_surface_covered(measured, x, y) || !placido_surface_at(measured, x, y, &seen) ||
      !placido_surface_at(truth, x - shift[0], y - shift[1], &known)) {
    return false;
  }
  fill_point(&pair->measured, measured, x, y, &seen);
  fill_point(&pair->known, truth, x, y, &known);
  pair->known.z_mm += shift[2];
  return true;
}

/* Gauss-Newton on the shift that brings the known shape nearest in height within 6 mm. */
static void find_pose(placido_iso_result *result, const struct both *both) {
  for (int step = 0; step < 20; step++) {
    placido_equations equations = {.unknowns = 3};
    double change[3];
    for (int ring = 0; ring < (int)(POSE_ZONE_MM / 2 / RING_STEP_MM); ring++) {
      for (int spoke = 0; spoke < SPOKES; spoke += 4) {
        const struct spot spot = spot_of(ring, spoke);
        struct pair pair;
        if (pair_at(&pair, result, both, &spot)) {
          const double w = sqrt(spot.weight);
          const double row[3] = {w * pair.known.jet.sx, w * pair.known.jet.sy, w};
          placido_equations_add(&equations, row, w * (pair.measured.z_mm - pair.known.z_mm));
        }
      }
    }
    if (!placido_equations_solve(&equations, change)) {
      return;
    }
    for (int i = 0; i < 3; i++) {
      result->shift_mm[i] += change[i];
    }
    if (fabs(change[0]) + fabs(change[1]) + fabs(change[2]) < 1e-9) {
      return;
    }
  }
}

/* Weighted sums of one quantity. */
struct sums {
  double weight, first, second;
};

static void add(struct sums *sums, double weight, double value) {
  sums->weight += weight;
  sums->first += weight * value;
  sums->second += weight * value * value;
}

static double mean_of(const struct sums *sums) {
  return sums->first / sums->weight;
}

static double deviation_of(const struct sums *sums) {
  const double mean = mean_of(sums), square = sums->second / sums->weight - mean * mean;
  return square < 0 ? 0 : sqrt(square);
}

static void measure_zone(placido_iso_zone *zone, const placido_iso_result *result,
                         const struct both *both) {
  struct sums power = {0}, height = {0};
  size_t kinds;
  double area = 0;
  const placido_map_kind *axial = &placido_map_kinds(&kinds)[placido_maps_find("axial")];
  const double edge_mm = fmin(placido_surface_radius_mm(both->measured), zone->outer_mm / 2);
  const int first = (int)lround(zone->inner_mm / 2 / RING_STEP_MM);
  for (int ring = first; (ring + 1) * RING_STEP_MM <= edge_mm + 1e-9; ring++) {
    for (int spoke = 0; spoke < SPOKES; spoke++) {
      const struct spot spot = spot_of(ring, spoke);
      struct pair pair;
      area += spot.weight;
      if (pair_at(&pair, result, both, &spot)) {
        add(&power, spot.weight, axial->at(&pair.measured) - axial->at(&pair.known));
        add(&height, spot.weight, 1e3 * (pair.measured.z_mm - pair.known.z_mm));
        zone->points++;
      }
    }
  }
  zone->covered = area > 0 ? power.weight / area : 0;
  zone->axial_mean_D = mean_of(&power);
  zone->axial_2sd_D = 2 * deviation_of(&power);
  zone->elevation_mean_um = mean_of(&height);
  zone->elevation_2sd_um = 2 * deviation_of(&height);
}

static double rms_within(const placido_iso_result *result, const struct both *both,
                         double zone_mm) {
  struct sums height = {0};
  for (int ring = 0; ring < (int)lround(zone_mm / 2 / RING_STEP_MM); ring++) {
    for (int spoke = 0; spoke < SPOKES; spoke++) {
      const struct spot spot = spot_of(ring, spoke);
      struct pair pair;
      if (pair_at(&pair, result, both, &spot)) {
        add(&height, spot.weight, 1e3 * (pair.measured.z_mm - pair.known.z_mm));
      }
    }
  }
  return deviation_of(&height);
}

/* An index of a surface by name; NaN where it has none. */
static double index_of(const placido_index_value *values, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return values[i].value;
    }
  }
  return NAN;
}

/* Passed where the value is known and within the limit. */
static void check(placido_iso_result *result, const char *name, const char *unit, double value,
                  double limit) {
  const bool passed = fabs(value) <= limit;
  result->checks[result->check_count++] =
      (placido_iso_check){.name = name, .unit = unit, .value = value, .limit = limit, .passed = passed};
  result->passed = result->passed && passed;
}

/* Indices of both, so that an index's own definition does not count as an error. */
static int check_shape(placido_iso_result *result, const struct iso_object *object,
                       const placido_surface *measured, placido_error *err) {
  placido_index_value seen[PLACIDO_INDICES_MAX], known[PLACIDO_INDICES_MAX];
  size_t seen_count, known_count;
  int status = placido_indices_find(seen, &seen_count, measured, NULL, err);
  if (status == PLACIDO_OK) {
    status = placido_indices_find(known, &known_count, object->truth, NULL, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  if (object->toric && index_of(known, known_count, "simk_cylinder_D") > 0.5) {
    const char *name = "simk_flat_axis_deg";
    check(result, "axis", "deg",
          remainder(index_of(seen, seen_count, name) - index_of(known, known_count, name), 180), 2);
  }
  if (object->aspheric) {
    const char *name = "asphericity_q";
    check(result, "asphericity", "",
          index_of(seen, seen_count, name) - index_of(known, known_count, name), 0.05);
  }
  return PLACIDO_OK;
}

/* How far the axial powers of a zone may be off: the mean and twice the standard deviation. */
static double bound_of(const placido_iso_zone *zone) {
  return zone->points > 0 ? fabs(zone->axial_mean_D) + zone->axial_2sd_D : (double)NAN;
}

int iso_compare(placido_iso_result *result, const struct iso_object *object,
                const placido_surface *measured, placido_error *err) {
  static const double bounds_mm[PLACIDO_ISO_ZONES + 1] = {1, 3, 6, INFINITY};
  const struct both both = {measured, object->truth};
  if (object->free_pose) {
    placido_jet axis;
    if (placido_surface_at(measured, 0, 0, &axis)) {
      result->shift_mm[2] = placido_surface_vertex_z_mm(measured) - axis.sag -
                            placido_surface_vertex_z_mm(object->truth);
    }
    find_pose(result, &both);
  }
  for (int k = 0; k < PLACIDO_ISO_ZONES; k++) {
    result->zones[k] =
        (placido_iso_zone){.inner_mm = bounds_mm[k], .outer_mm = bounds_mm[k + 1]};
    measure_zone(&result->zones[k], result, &both);
  }
  result->elevation_rms_6_um = rms_within(result, &both, 6);
  result->passed = true;
  check(result, "axial power, 1 to 3 mm", "D", bound_of(&result->zones[0]), 0.1);
  check(result, "axial power, 3 to 6 mm", "D", bound_of(&result->zones[1]), 0.25);
  check(result, "elevation, 6 mm", "um", result->elevation_rms_6_um, 1);
  return check_shape(result, object, measured, err);
}
