/* One cornea moved onto another: weighted least squares of the height by Gauss and Newton. A body
 * that moves by the field δ lifts its height at a place by n·δ/n_z, n the surface's normal
 * (s_x, s_y, 1). */
#include "reconstruct/maps/equations.h"
#include "reconstruct/maps/motion.h"

#include <math.h>
#include <string.h>

#define TERMS PLACIDO_MOTION_TERMS
#define STEPS_MAX 60
#define CONVERGED 1e-13 /* mm and radians */
#define POINTS_MIN 500
#define FLOOR_MM 2e-5      /* what the spline leaves */
#define CORRELATION_MM 0.5 /* over which error bars are shared: the knots' spacing */
#define DEGREE (3.14159265358979323846 / 180)

/* What eyes do between two looks at one target, 1 sigma; the piston is open. */
static const double prior[TERMS] = {0.5, 0.5, 100, 3 * DEGREE, 3 * DEGREE, 5 * DEGREE};

/* The sums over all common points. */
typedef struct sums {
  placido_equations equations;
  size_t points;
  double heights, squares, chi_square; /* of the difference, and over its sigma */
} sums;

/* How the height answers to the terms of the motion. */
static void answers(double row[TERMS], const placido_moved *moved, const placido_motion *motion,
                    double x, double y) {
  const placido_jet *jet = &moved->jet;
  double dx = x - motion->shift_mm[0], dy = y - motion->shift_mm[1];
  double dz = moved->z_mm - motion->shift_mm[2];
  const double all[TERMS] = {jet->sx,           jet->sy,           1,
                             dy - jet->sy * dz, jet->sx * dz - dx, jet->sy * dx - jet->sx * dy};
  memcpy(row, all, sizeof all);
}

/* Standard deviation of the difference in height, without the alignment's. */
static double sigma_mm(const placido_measured *first, const placido_measured *second,
                       const placido_moved *here, const placido_moved *there) {
  double a = placido_measured_sigma(first, PLACIDO_DIFFERENCE_ELEVATION, here->from_mm);
  double b = placido_measured_sigma(second, PLACIDO_DIFFERENCE_ELEVATION, there->from_mm);
  double um = hypot(isfinite(a) ? a : 0, isfinite(b) ? b : 0);
  return hypot(1e-3 * um, FLOOR_MM);
}

static void add_point(sums *s, const placido_measured *first, const placido_measured *second,
                      const placido_motion *rest, const placido_motion *motion, int i, int j) {
  double x = (i - first->half) * first->step_mm, y = (j - first->half) * first->step_mm;
  placido_moved here, there;
  if (!placido_moved_at(&here, first, rest, x, y) || !here.covered ||
      !placido_moved_at(&there, second, motion, x, y) || !there.covered) {
    return;
  }
  double row[TERMS], error = there.z_mm - here.z_mm;
  double sigma = sigma_mm(first, second, &here, &there);
  s->points++;
  s->heights += error;
  s->squares += error * error;
  s->chi_square += error * error / (sigma * sigma);
  answers(row, &there, motion, x, y);
  double scale = 1 / (sigma * fmax(CORRELATION_MM / first->step_mm, 1));
  for (int k = 0; k < TERMS; k++) {
    row[k] *= scale;
  }
  placido_equations_add(&s->equations, row, -error * scale);
}

static sums add_all(const placido_measured *first, const placido_measured *second,
                    const double terms[TERMS]) {
  static const double none[TERMS] = {0};
  sums s = {.equations = {.unknowns = TERMS}};
  placido_motion rest = placido_motion_of(none), motion = placido_motion_of(terms);
  for (int j = 0; j < first->size; j++) {
    for (int i = 0; i < first->size; i++) {
      add_point(&s, first, second, &rest, &motion, i, j);
    }
  }
  for (int k = 0; k < TERMS; k++) {
    double row[TERMS] = {0};
    row[k] = 1 / prior[k];
    placido_equations_add(&s.equations, row, -terms[k] / prior[k]);
  }
  return s;
}

static double rms_um(const sums *s, bool about_mean) {
  double mean = s->heights / (double)s->points;
  return 1e3 * sqrt(fmax(s->squares / (double)s->points - (about_mean ? mean * mean : 0), 0));
}

static bool find_covariance(placido_alignment *alignment, const sums *s) {
  double scale = fmax(alignment->chi_square, 1);
  for (int k = 0; k < TERMS; k++) {
    placido_equations unit = s->equations;
    for (int l = 0; l < TERMS; l++) {
      unit.right[l] = k == l;
    }
    if (!placido_equations_solve(&unit, alignment->covariance[k])) {
      return false;
    }
    for (int l = 0; l < TERMS; l++) {
      alignment->covariance[k][l] *= scale;
    }
    alignment->sigmas[k] = sqrt(alignment->covariance[k][k]);
  }
  return true;
}

int placido_align(placido_alignment *alignment, const placido_measured *first,
                  const placido_measured *second, placido_error *err) {
  *alignment = (placido_alignment){.aligned = true};
  double length = INFINITY, *terms = alignment->terms;
  sums s;
  while (true) {
    s = add_all(first, second, terms);
    if (s.points < POINTS_MIN) {
      return placido_error_set(err, PLACIDO_QUALITY,
                               "the corneas have only %zu points in common, at least %d are needed "
                               "to align them",
                               s.points, POINTS_MIN);
    }
    if (alignment->steps == 0) {
      alignment->rms_before_um = rms_um(&s, true);
    }
    double step[TERMS];
    if (length <= CONVERGED || alignment->steps == STEPS_MAX ||
        !placido_equations_solve(&s.equations, step)) {
      break;
    }
    length = 0;
    for (int k = 0; k < TERMS; k++) {
      terms[k] += step[k];
      length = fmax(length, fabs(step[k]));
    }
    alignment->steps++;
  }
  alignment->points = s.points;
  alignment->rms_um = rms_um(&s, false);
  alignment->chi_square = s.chi_square / (double)s.points;
  if (!(length < 1e-6) || !find_covariance(alignment, &s)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "the corneas cannot be aligned: no motion brings them together");
  }
  return PLACIDO_OK;
}
