/* The height of a moved cornea: Newton's method on the vertical line, and the derivatives of the
 * implicit function G(x, y, z) = 0 that the moved surface is. */
#include "reconstruct/maps/motion.h"

#include <math.h>

#define STEPS_MAX 20
#define CLOSE_MM 1e-13

/* Rodrigues' formula for the rotation vector. */
placido_motion placido_motion_of(const double terms[PLACIDO_MOTION_TERMS]) {
  const double w[3] = {terms[PLACIDO_TILT_X], terms[PLACIDO_TILT_Y], terms[PLACIDO_TORSION]};
  double angle = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  double sine = angle > 0 ? sin(angle) / angle : 1, half = sin(angle / 2);
  double rest = angle > 0 ? 2 * half * half / (angle * angle) : 0.5;
  const double cross[3][3] = {{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
  placido_motion motion = {
      .shift_mm = {terms[PLACIDO_SHIFT_X], terms[PLACIDO_SHIFT_Y], terms[PLACIDO_PISTON]}};
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      double square = w[i] * w[j] - (i == j ? angle * angle : 0);
      motion.turn[i][j] = (i == j) + sine * cross[i][j] + rest * square;
    }
  }
  return motion;
}

/* z of the measurement at (x, y) and its jet, seen mirrored where it is. */
static bool seen_at(const placido_measured *measured, double x, double y, double *z,
                    placido_jet *jet) {
  double sign = measured->mirrored ? -1 : 1;
  if (!placido_surface_at(measured->surface, sign * x, y, jet)) {
    return false;
  }
  jet->sx *= sign;
  jet->sxy *= sign;
  *z = placido_surface_vertex_z_mm(measured->surface) - jet->sag;
  return true;
}

/* Where a point was before the motion. */
static void take_back(double before[3], const placido_motion *motion, const double after[3]) {
  for (int i = 0; i < 3; i++) {
    before[i] = 0;
    for (int j = 0; j < 3; j++) {
      before[i] += motion->turn[j][i] * (after[j] - motion->shift_mm[j]);
    }
  }
}

/* With G = z - Z(x, y) before the motion its gradient is (s_x, s_y, 1) and its second derivatives
 * are those of the sag; both turn with the body. z_x = -G_x/G_z, z_xx = -(G_xx + 2 G_xz z_x + G_zz
 * z_x²)/G_z and so on. */
static placido_jet turned_jet(const placido_jet *jet, const placido_motion *motion, double z) {
  const double gradient[3] = {jet->sx, jet->sy, 1};
  const double bend[2][2] = {{jet->sxx, jet->sxy}, {jet->sxy, jet->syy}};
  double g[3] = {0}, h[3][3] = {{0}};
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      g[i] += motion->turn[i][j] * gradient[j];
      for (int k = 0; k < 4; k++) {
        h[i][j] += motion->turn[i][k / 2] * bend[k / 2][k % 2] * motion->turn[j][k % 2];
      }
    }
  }
  double s[2] = {g[0] / g[2], g[1] / g[2]}, second[2][2]; /* of the sag: minus those of z */
  for (int i = 0; i < 2; i++) {
    for (int j = 0; j < 2; j++) {
      second[i][j] = (h[i][j] - h[i][2] * s[j] - h[j][2] * s[i] + h[2][2] * s[i] * s[j]) / g[2];
    }
  }
  return (placido_jet){-z, s[0], s[1], second[0][0], second[0][1], second[1][1]};
}

bool placido_moved_at(placido_moved *moved, const placido_measured *measured,
                      const placido_motion *motion, double x_mm, double y_mm) {
  double z = motion->shift_mm[2], last = INFINITY;
  placido_jet jet;
  for (int step = 0; step < STEPS_MAX; step++) {
    const double at[3] = {x_mm, y_mm, z};
    double before[3], height;
    take_back(before, motion, at);
    if (!seen_at(measured, before[0], before[1], &height, &jet)) {
      return false;
    }
    double over = before[2] - height;
    if (fabs(over) < CLOSE_MM || fabs(over) >= last) {
      double sign = measured->mirrored ? -1 : 1;
      *moved = (placido_moved){
          .z_mm = z, .jet = turned_jet(&jet, motion, z), .from_mm = {sign * before[0], before[1]}};
      moved->covered =
          placido_surface_covered(measured->surface, moved->from_mm[0], moved->from_mm[1]);
      return fabs(over) < 1e-9;
    }
    last = fabs(over);
    z -= over / (motion->turn[2][0] * jet.sx + motion->turn[2][1] * jet.sy + motion->turn[2][2]);
  }
  return false;
}

double placido_measured_sigma(const placido_measured *measured, enum placido_difference_kind kind,
                              const double at_mm[2]) {
  const double *sigmas = measured->sigmas[kind];
  double sum = 0, weights = 0;
  double x = at_mm[0] / measured->step_mm + measured->half;
  double y = at_mm[1] / measured->step_mm + measured->half;
  int i = (int)floor(x), j = (int)floor(y);
  for (int corner = 0; corner < 4; corner++) {
    int right = corner & 1, up = corner >> 1, column = i + right, row = j + up;
    if (column < 0 || row < 0 || column >= measured->size || row >= measured->size) {
      continue;
    }
    double sigma = sigmas[row * measured->size + column];
    double weight = (right ? x - i : i + 1 - x) * (up ? y - j : j + 1 - y);
    if (isfinite(sigma)) {
      sum += weight * sigma;
      weights += weight;
    }
  }
  return weights > 0 ? sum / weights : (double)NAN;
}
