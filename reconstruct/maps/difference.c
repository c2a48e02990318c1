/* What is left between two corneas, the second moved onto the first: at every point of the grid the
 * jets of both, and what kinds of map make of them. */
#include "base/memory.h"
#include "reconstruct/maps/csv.h"
#include "reconstruct/maps/kinds.h"
#include "reconstruct/maps/motion.h"

#include <math.h>
#include <string.h>

#define EDGE_MM 1e-12 /* as for the maps */
#define STEP 1e-5     /* of the motion's terms, for their part of the error bars */
#define VERTEX_STEPS_MAX 30

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

/* A cornea where a motion puts it, with the vertex that it then has. */
typedef struct placed {
  const placido_measured *measured;
  placido_motion motion;
  double vertex_mm[2];
} placed;

/* Newton's method for the place without slope, from `start`; the axis where there is none. */
static placed place(const placido_measured *measured, const double terms[PLACIDO_MOTION_TERMS],
                    const double start[2]) {
  placed p = {measured, placido_motion_of(terms), {start[0], start[1]}};
  double length = INFINITY;
  for (int step = 0; step < VERTEX_STEPS_MAX && length > 1e-12; step++) {
    placido_moved at;
    double determinant = 0;
    if (placido_moved_at(&at, measured, &p.motion, p.vertex_mm[0], p.vertex_mm[1])) {
      determinant = at.jet.sxx * at.jet.syy - at.jet.sxy * at.jet.sxy;
    }
    if (!(determinant > 0)) {
      p.vertex_mm[0] = p.vertex_mm[1] = 0;
      return p;
    }
    double dx = -(at.jet.syy * at.jet.sx - at.jet.sxy * at.jet.sy) / determinant;
    double dy = -(at.jet.sxx * at.jet.sy - at.jet.sxy * at.jet.sx) / determinant;
    length = hypot(dx, dy);
    p.vertex_mm[0] += dx;
    p.vertex_mm[1] += dy;
  }
  return p;
}

/* The two corneas, and the second as it is when each term of the motion is a step off. */
typedef struct pair {
  placed first, second, off[PLACIDO_MOTION_TERMS];
  const placido_alignment *alignment;
} pair;

static pair bring_together(const placido_measured *first, const placido_measured *second,
                           const placido_alignment *alignment) {
  static const double none[PLACIDO_MOTION_TERMS] = {0};
  const double axis[2] = {0, 0};
  pair p = {.first = place(first, none, axis), .alignment = alignment};
  p.second = place(second, alignment->terms, p.first.vertex_mm);
  for (int k = 0; k < PLACIDO_MOTION_TERMS; k++) {
    double terms[PLACIDO_MOTION_TERMS];
    memcpy(terms, alignment->terms, sizeof terms);
    terms[k] += STEP;
    p.off[k] = place(second, terms, p.second.vertex_mm);
  }
  return p;
}

/* The maps' values of a placed cornea; false where it is not defined. */
static bool evaluate(double values[PLACIDO_DIFFERENCES], placido_moved *moved, const placed *p,
                     double x, double y) {
  if (!placido_moved_at(moved, p->measured, &p->motion, x, y)) {
    return false;
  }
  placido_map_point point = {.x_mm = x,
                             .y_mm = y,
                             .z_mm = moved->z_mm,
                             .jet = moved->jet,
                             .vertex_mm = {p->vertex_mm[0], p->vertex_mm[1]}};
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    values[k] = kinds[k].at(&point);
  }
  return true;
}

/* What the alignment's uncertainty adds to the variances. */
static void add_alignment(double variances[PLACIDO_DIFFERENCES], const pair *p, double x, double y,
                          const double values[PLACIDO_DIFFERENCES]) {
  double by[PLACIDO_MOTION_TERMS][PLACIDO_DIFFERENCES];
  for (int k = 0; k < PLACIDO_MOTION_TERMS; k++) {
    placido_moved moved;
    bool there = evaluate(by[k], &moved, &p->off[k], x, y);
    for (int d = 0; d < PLACIDO_DIFFERENCES; d++) {
      by[k][d] = there ? (by[k][d] - values[d]) / STEP : 0; /* at the very rim */
    }
  }
  for (int d = 0; d < PLACIDO_DIFFERENCES; d++) {
    for (int k = 0; k < PLACIDO_MOTION_TERMS; k++) {
      for (int l = 0; l < PLACIDO_MOTION_TERMS; l++) {
        variances[d] += by[k][d] * by[l][d] * p->alignment->covariance[k][l];
      }
    }
  }
}

static void fill_point(placido_difference *difference, const pair *p, int i, int j) {
  size_t index = (size_t)j * (size_t)difference->size + (size_t)i;
  double x = (i - difference->half) * difference->step_mm;
  double y = (j - difference->half) * difference->step_mm;
  placido_moved here, there;
  double before[PLACIDO_DIFFERENCES], after[PLACIDO_DIFFERENCES], variances[PLACIDO_DIFFERENCES];
  bool valid = evaluate(before, &here, &p->first, x, y) && here.covered &&
               evaluate(after, &there, &p->second, x, y) && there.covered;
  difference->valid[index] = valid;
  for (int k = 0; valid && k < PLACIDO_DIFFERENCES; k++) {
    enum placido_difference_kind kind = (enum placido_difference_kind)k;
    double a = placido_measured_sigma(p->first.measured, kind, here.from_mm);
    double b = placido_measured_sigma(p->second.measured, kind, there.from_mm);
    variances[k] = a * a + b * b;
  }
  if (valid && p->alignment->aligned) {
    add_alignment(variances, p, x, y, after);
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
  const pair p = bring_together(first, second, alignment);
  *difference =
      (placido_difference){.step_mm = first->step_mm,
                           .radius_mm = placido_surface_radius_mm(first->surface),
                           .half = first->half,
                           .size = first->size,
                           .vertices_mm = {{p.first.vertex_mm[0], p.first.vertex_mm[1]},
                                           {p.second.vertex_mm[0], p.second.vertex_mm[1]}}};
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
