/* What is left between two corneas, the second moved onto the first: at every point of the grid the
 * jets of both, and what kinds of map make of them. */
#include "base/memory.h"
#include "reconstruct/indices/layout.h"
#include "reconstruct/maps/csv.h"
#include "reconstruct/maps/kinds.h"
#include "reconstruct/maps/motion.h"

#include <math.h>

#define EDGE_MM 1e-12 /* as for the maps */
#define STEP 1e-5     /* of the motion's terms, for their part of the error bars */

static double height_um(const placido_map_point *point) {
  return 1e3 * point->z_mm;
}

static const struct {
  const char *name, *title, *unit;
  double (*at)(const placido_map_point *point);
} kinds[PLACIDO_DIFFERENCES] = {
    {"elevation", "Difference of elevation", "µm", height_um},
    {"axial", "Difference of axial curvature", "D", placido_map_axial_vertex},
    {"tangential", "Difference of tangential curvature", "D", placido_map_tangential_vertex},
};

const char *placido_difference_name(enum placido_difference_kind kind) {
  return kinds[kind].name;
}

const char *placido_difference_title(enum placido_difference_kind kind) {
  return kinds[kind].title;
}

const char *placido_difference_unit(enum placido_difference_kind kind) {
  return kinds[kind].unit;
}

const double *placido_difference_zone_mm(int zone) {
  static const double zones_mm[PLACIDO_DIFFERENCE_ZONES][2] = {{1, 3}, {3, 6}, {6, 8}, {0, 8}};
  return zones_mm[zone];
}

static void evaluate(double values[PLACIDO_DIFFERENCES], const placido_moved *moved, double x,
                     double y, const double vertex_mm[2]) {
  placido_map_point point = {.x_mm = x,
                             .y_mm = y,
                             .z_mm = moved->z_mm,
                             .jet = moved->jet,
                             .vertex_mm = {vertex_mm[0], vertex_mm[1]}};
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    values[k] = kinds[k].at(&point);
  }
}

/* What the alignment's uncertainty adds to the variances. */
static void add_alignment(double variances[PLACIDO_DIFFERENCES], const placido_measured *second,
                          const placido_alignment *alignment, double x, double y,
                          const double values[PLACIDO_DIFFERENCES], const double vertex_mm[2]) {
  double by[PLACIDO_MOTION_TERMS][PLACIDO_DIFFERENCES];
  for (int k = 0; k < PLACIDO_MOTION_TERMS; k++) {
    double terms[PLACIDO_MOTION_TERMS];
    for (int l = 0; l < PLACIDO_MOTION_TERMS; l++) {
      terms[l] = alignment->terms[l] + (k == l ? STEP : 0);
    }
    placido_motion motion = placido_motion_of(terms);
    placido_moved moved;
    bool there = placido_moved_at(&moved, second, &motion, x, y);
    if (there) {
      evaluate(by[k], &moved, x, y, vertex_mm);
    }
    for (int d = 0; d < PLACIDO_DIFFERENCES; d++) {
      by[k][d] = there ? (by[k][d] - values[d]) / STEP : 0; /* at the very rim */
    }
  }
  for (int d = 0; d < PLACIDO_DIFFERENCES; d++) {
    for (int k = 0; k < PLACIDO_MOTION_TERMS; k++) {
      for (int l = 0; l < PLACIDO_MOTION_TERMS; l++) {
        variances[d] += by[k][d] * by[l][d] * alignment->covariance[k][l];
      }
    }
  }
}

/* The two corneas and how they were brought together. */
typedef struct pair {
  const placido_measured *first, *second;
  const placido_alignment *alignment;
  placido_motion rest, motion;
} pair;

static void fill_point(placido_difference *difference, const pair *p, int i, int j) {
  size_t index = (size_t)j * (size_t)difference->size + (size_t)i;
  double x = (i - difference->half) * difference->step_mm;
  double y = (j - difference->half) * difference->step_mm;
  placido_moved here, there;
  double before[PLACIDO_DIFFERENCES], after[PLACIDO_DIFFERENCES], variances[PLACIDO_DIFFERENCES];
  bool valid = placido_moved_at(&here, p->first, &p->rest, x, y) && here.covered &&
               placido_moved_at(&there, p->second, &p->motion, x, y) && there.covered;
  difference->valid[index] = valid;
  if (valid) {
    evaluate(before, &here, x, y, difference->vertex_mm);
    evaluate(after, &there, x, y, difference->vertex_mm);
  }
  for (int k = 0; valid && k < PLACIDO_DIFFERENCES; k++) {
    enum placido_difference_kind kind = (enum placido_difference_kind)k;
    double a = placido_measured_sigma(p->first, kind, here.from_mm);
    double b = placido_measured_sigma(p->second, kind, there.from_mm);
    variances[k] = a * a + b * b;
  }
  if (valid && p->alignment->aligned) {
    add_alignment(variances, p->second, p->alignment, x, y, after, difference->vertex_mm);
  }
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    difference->values[k][index] = valid ? after[k] - before[k] : (double)NAN;
    difference->sigmas[k][index] = valid ? sqrt(variances[k]) : (double)NAN;
  }
}

static int allocate(placido_difference *difference, placido_error *err) {
  size_t points = (size_t)difference->size * (size_t)difference->size;
  difference->valid = placido_memory_new(points, sizeof *difference->valid, err);
  bool failed = !difference->valid;
  for (int k = 0; k < PLACIDO_DIFFERENCES && !failed; k++) {
    difference->values[k] = placido_memory_new(points, sizeof(double), err);
    difference->sigmas[k] =
        difference->values[k] ? placido_memory_new(points, sizeof(double), err) : NULL;
    failed = !difference->sigmas[k];
  }
  return failed ? PLACIDO_MEMORY : PLACIDO_OK;
}

static int check_any_valid(const placido_difference *difference, placido_error *err) {
  for (size_t k = 0; k < (size_t)difference->size * (size_t)difference->size; k++) {
    if (difference->valid[k]) {
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, PLACIDO_QUALITY, "the corneas have no point in common");
}

int placido_difference_new(placido_difference *difference, const placido_measured *first,
                           const placido_measured *second, const placido_alignment *alignment,
                           placido_error *err) {
  static const double none[PLACIDO_MOTION_TERMS] = {0};
  placido_vertex vertex = placido_vertex_find(first->surface);
  bool has_vertex = isfinite(vertex.x_mm) && isfinite(vertex.y_mm);
  *difference = (placido_difference){
      .step_mm = first->step_mm,
      .radius_mm = placido_surface_radius_mm(first->surface),
      .half = first->half,
      .size = first->size,
      .vertex_mm = {has_vertex ? (first->mirrored ? -vertex.x_mm : vertex.x_mm) : 0,
                    has_vertex ? vertex.y_mm : 0}};
  const pair p = {first, second, alignment, placido_motion_of(none),
                  placido_motion_of(alignment->terms)};
  int status = allocate(difference, err);
  if (!status) {
#pragma omp parallel for schedule(dynamic, 1)
    for (int j = 0; j < difference->size; j++) {
      for (int i = 0; i < difference->size; i++) {
        fill_point(difference, &p, i, j);
      }
    }
    status = check_any_valid(difference, err);
  }
  if (status) {
    placido_difference_free(difference);
  }
  return status;
}

void placido_difference_free(placido_difference *difference) {
  if (!difference) {
    return;
  }
  placido_memory_free(difference->valid);
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    placido_memory_free(difference->values[k]);
    placido_memory_free(difference->sigmas[k]);
  }
  *difference = (placido_difference){0};
}

int placido_difference_save(const placido_difference *difference, const char *path,
                            placido_error *err) {
  static const char *const columns[PLACIDO_DIFFERENCES] = {"elevation_um", "axial_D",
                                                           "tangential_D"};
  const placido_maps grid = {.step_mm = difference->step_mm,
                             .radius_mm = difference->radius_mm,
                             .half = difference->half,
                             .size = difference->size,
                             .valid = difference->valid};
  placido_map_table table = {.count = 0};
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    placido_map_table_add(&table, "difference_", columns[k], difference->values[k]);
    placido_map_table_add(&table, "sigma_", columns[k], difference->sigmas[k]);
  }
  return placido_map_table_save(&table, &grid, path, err);
}

placido_difference_zone placido_difference_zone_find(const placido_difference *difference,
                                                     enum placido_difference_kind kind,
                                                     double from_mm, double to_mm) {
  placido_difference_zone zone = {.from_mm = from_mm, .to_mm = to_mm};
  double sum = 0, squares = 0, significant = 0, known = 0;
  for (int j = 0; j < difference->size; j++) {
    for (int i = 0; i < difference->size; i++) {
      size_t index = (size_t)j * (size_t)difference->size + (size_t)i;
      double r = hypot(i - difference->half, j - difference->half) * difference->step_mm;
      double value = difference->values[kind][index], sigma = difference->sigmas[kind][index];
      if (!difference->valid[index] || r < from_mm / 2 - EDGE_MM || r > to_mm / 2 + EDGE_MM ||
          !isfinite(value)) {
        continue;
      }
      zone.points++;
      sum += value;
      squares += value * value;
      zone.largest = fabs(value) > fabs(zone.largest) ? value : zone.largest;
      known += isfinite(sigma);
      significant += fabs(value) > 2 * sigma;
    }
  }
  double count = (double)zone.points;
  zone.mean = sum / count;
  zone.deviation = sqrt(fmax(squares / count - zone.mean * zone.mean, 0));
  zone.largest = zone.points > 0 ? zone.largest : (double)NAN;
  zone.significant = known > 0 ? significant / known : (double)NAN;
  return zone;
}
