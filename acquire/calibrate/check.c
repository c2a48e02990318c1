/* A ball measured like an eye, and held against what it is. */
#include "acquire/calibrate/setup.h"
#include "acquire/calibrate/solve.h"

#include "base/dense.h"

#include <math.h>

#define STEP_MM 0.1
#define HALF_MM 4.0        /* of the 8 mm within which the shape is judged */
#define SEEN_SHARE 0.9     /* of a zone that must be covered */
#define DISTANCE_SIGMA_MM 5.0
#define KERATOMETRIC 337.5 /* dioptres times millimetres */

const double placido_ball_zone_mm[PLACIDO_BALL_ZONES][2] = {{0.4, 1.5}, {1.5, 3}, {3, 4}};

/* Where the vertex is, with the instrument and the radius as they are; at vertex_z_mm, or where the
 * mires say if that is NaN. */
static int find_vertex(double vertex_mm[3], const placido_mires *mires,
                       const placido_instrument *instrument, double radius_mm,
                       double vertex_z_mm, placido_error *err) {
  placido_calibrate_problem problem;
  placido_calibrate_solver solver = {0};
  bool free_z = isnan(vertex_z_mm);
  int status = placido_calibrate_problem_new(&problem, instrument, NULL, 1, 1, err);
  if (status) {
    return status;
  }
  placido_calibrate_ball_set(&problem, 0, radius_mm, 0);
  placido_calibrate_view_set(&problem, 0, mires, 0, free_z ? 0 : vertex_z_mm,
                             free_z ? DISTANCE_SIGMA_MM : 0);
  status = placido_calibrate_solver_new(&solver, &problem, err);
  if (!status) {
    status = placido_calibrate_solver_run(&solver, err);
  }
  if (!status) {
    placido_calibrate_geometry g = placido_calibrate_geometry_of(&problem, solver.q, 0);
    for (int i = 0; i < 3; i++) {
      vertex_mm[i] = g.centre_mm[i] + (i == 2 ? radius_mm : 0);
    }
  }
  placido_calibrate_solver_free(&solver);
  placido_calibrate_problem_free(&problem);
  return status;
}

/* Sums over the points of a grid about the vertex. */
typedef struct sums {
  int places, seen;
  double first, second; /* of the surface less the ball */
} sums;

static void add(sums *s, bool seen, double value) {
  s->places++;
  if (seen) {
    s->seen++;
    s->first += value;
    s->second += value * value;
  }
}

static bool enough(const sums *s) {
  return s->seen > 0 && s->seen >= SEEN_SHARE * s->places;
}

static double mean_of(const sums *s) {
  return enough(s) ? s->first / s->seen : NAN;
}

/* About their mean: the height as a whole is the distance's, not the shape's. */
static double spread_of(const sums *s) {
  double mean = mean_of(s);
  return sqrt(fmax(0, s->second / s->seen - mean * mean));
}

/* Normal equations of the sphere nearest to the surface: height, two tilts, radius. */
typedef struct nearest {
  double a[16], b[4];
} nearest;

static void add_nearest(nearest *n, double x, double y, double radius_mm, double difference) {
  double root = sqrt(radius_mm * radius_mm - x * x - y * y);
  const double row[4] = {1, x, y, radius_mm / root - 1};
  for (int i = 0; i < 4; i++) {
    for (int j = 0; j < 4; j++) {
      n->a[4 * i + j] += row[i] * row[j];
    }
    n->b[i] += row[i] * difference;
  }
}

/* A place of the grid: offset from the vertex, and what the surface is there. */
typedef struct place {
  double x, y, rho, difference_mm, power_D;
  bool seen;
} place;

static place place_at(const placido_surface *surface, const double vertex_mm[3],
                      double radius_mm, double x, double y) {
  place p = {.x = x, .y = y, .rho = hypot(x, y)};
  placido_jet jet;
  double at[2] = {vertex_mm[0] + x, vertex_mm[1] + y};
  if (!placido_surface_at(surface, at[0], at[1], &jet) ||
      !placido_surface_covered(surface, at[0], at[1])) {
    return p;
  }
  double ball = vertex_mm[2] - radius_mm + sqrt(radius_mm * radius_mm - p.rho * p.rho);
  double slope = p.rho > 0 ? (jet.sx * x + jet.sy * y) / p.rho : 0;
  p.seen = true;
  p.difference_mm = placido_surface_vertex_z_mm(surface) - jet.sag - ball;
  p.power_D = KERATOMETRIC * slope / (p.rho * sqrt(1 + slope * slope));
  return p;
}

static void compare(placido_ball_check *check, const placido_surface *surface,
                    double radius_mm) {
  sums six = {0}, eight = {0}, zones[PLACIDO_BALL_ZONES] = {{0}};
  nearest sphere = {{0}, {0}};
  int half = (int)lrint(HALF_MM / STEP_MM);
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      place p = place_at(surface, check->vertex_mm, radius_mm, i * STEP_MM, j * STEP_MM);
      if (p.rho > HALF_MM) {
        continue;
      }
      add(&eight, p.seen, p.difference_mm);
      if (p.rho <= 3) {
        add(&six, p.seen, p.difference_mm);
      }
      for (int k = 0; k < PLACIDO_BALL_ZONES; k++) {
        if (p.rho >= placido_ball_zone_mm[k][0] && p.rho < placido_ball_zone_mm[k][1]) {
          add(&zones[k], p.seen, p.power_D - KERATOMETRIC / radius_mm);
        }
      }
      if (p.seen) {
        add_nearest(&sphere, p.x, p.y, radius_mm, p.difference_mm);
      }
    }
  }
  check->rms_6_um = 1000 * spread_of(&six);
  check->rms_8_um = 1000 * spread_of(&eight);
  check->worst_power_D = 0;
  for (int k = 0; k < PLACIDO_BALL_ZONES; k++) {
    check->power_error_D[k] = mean_of(&zones[k]);
    double error = check->power_error_D[k];
    if (isnan(error) || fabs(error) > fabs(check->worst_power_D)) {
      check->worst_power_D = error; /* which stays NaN from then on */
    }
  }
  check->radius_mm = NAN;
  if (eight.seen > 100 && placido_dense_factor(sphere.a, 4, 4, 0)) {
    placido_dense_solve(sphere.a, 4, 4, sphere.b);
    check->radius_mm = radius_mm + sphere.b[3];
  }
}

int placido_ball_check_run(placido_ball_check *check, placido_mires *mires,
                           const placido_instrument *instrument, const placido_ball *ball,
                           int threads, placido_notes *notes, placido_error *err) {
  *check = (placido_ball_check){0};
  placido_fit *fit = NULL;
  double radius_mm = ball->radius_mm, *v = check->vertex_mm, drop = 0;
  /* how far the ball is lower on the axis than at its vertex is known when its place is */
  int status = PLACIDO_OK, passes = ball->on_axis && !isnan(ball->z_mm) ? 2 : 1;
  for (int pass = 0; pass < passes && !status; pass++) {
    status = find_vertex(v, mires, instrument, radius_mm,
                         ball->z_mm + (ball->on_axis ? drop : 0), err);
    double across = hypot(v[0], v[1]);
    if (!status && !(across < 0.5 * radius_mm)) {
      status = placido_error_set(err, PLACIDO_QUALITY,
                                 "the ball stands %.2f mm beside the axis: bring it to the middle",
                                 across);
    }
    drop = radius_mm - sqrt(fmax(0, radius_mm * radius_mm - across * across));
  }
  placido_fit_options options = {.axis_z_mm = v[2] - drop, .threads = threads};
  if (!status) {
    status = placido_fit_new(&fit, mires, instrument, &options, notes, err);
  }
  if (!status) {
    check->mires_rms_px = placido_fit_summary_get(fit).rms_px;
    compare(check, placido_fit_surface(fit), radius_mm);
  }
  placido_fit_free(fit);
  return status;
}
