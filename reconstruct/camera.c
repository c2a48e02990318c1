/* Pinhole and telecentric cameras with OpenCV's five-term distortion, image point to ray. */
#include "reconstruct/camera.h"

#include <float.h>
#include <math.h>

/* The distorted coordinates of (x, y) and their Jacobian. Brown's model as in OpenCV's manual of
 * calib3d: radial k1 k2 k3, tangential p1 p2. */
static void distort(const double k[5], double x, double y, double out[2], double jacobian[2][2]) {
  double r2 = x * x + y * y;
  double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  double slope = 2 * (k[0] + r2 * (2 * k[1] + r2 * 3 * k[4])); /* d radial / d r2, times 2 */
  out[0] = x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x);
  out[1] = y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y;
  jacobian[0][0] = radial + slope * x * x + 2 * k[2] * y + 6 * k[3] * x;
  jacobian[0][1] = slope * x * y + 2 * k[2] * x + 2 * k[3] * y;
  jacobian[1][0] = jacobian[0][1];
  jacobian[1][1] = radial + slope * y * y + 6 * k[2] * y + 2 * k[3] * x;
}

/* Solves distort(x, y) = target; leaves the inverse of the Jacobian there. What is left over is
 * rounding, and the Jacobian's place is then the solution's. */
static void undistort(const double k[5], const double target[2], double xy[2],
                      double inverse[2][2]) {
  double rounding = 4 * DBL_EPSILON * (fabs(target[0]) + fabs(target[1]));
  xy[0] = target[0];
  xy[1] = target[1];
  for (int step = 0; step < 12; step++) {
    double at[2], j[2][2];
    distort(k, xy[0], xy[1], at, j);
    double determinant = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    inverse[0][0] = j[1][1] / determinant;
    inverse[0][1] = -j[0][1] / determinant;
    inverse[1][0] = -j[1][0] / determinant;
    inverse[1][1] = j[0][0] / determinant;
    double ex = target[0] - at[0], ey = target[1] - at[1];
    xy[0] += inverse[0][0] * ex + inverse[0][1] * ey;
    xy[1] += inverse[1][0] * ex + inverse[1][1] * ey;
    if (fabs(ex) + fabs(ey) <= rounding) {
      break;
    }
  }
}

placido_ray placido_camera_ray(const placido_instrument *instrument, double u_px, double v_px) {
  const double *f = instrument->focal_px;
  double target[2] = {(u_px - instrument->principal_px[0]) / f[0],
                      (v_px - instrument->principal_px[1]) / f[1]};
  double xy[2], inverse[2][2];
  undistort(instrument->distortion, target, xy, inverse);
  /* y points down in the image and up in space */
  double across[3] = {xy[0], -xy[1], 0};
  double across_u[3] = {inverse[0][0] / f[0], -inverse[1][0] / f[0], 0};
  double across_v[3] = {inverse[0][1] / f[1], -inverse[1][1] / f[1], 0};
  placido_ray ray = {.direction = {0, 0, -1}};
  bool pinhole = instrument->model == PLACIDO_PINHOLE;
  double *moved = pinhole ? ray.direction : ray.origin;
  double *moved_u = pinhole ? ray.direction_u : ray.origin_u;
  double *moved_v = pinhole ? ray.direction_v : ray.origin_v;
  for (int i = 0; i < 3; i++) {
    ray.origin[i] = instrument->position_mm[i];
  }
  for (int i = 0; i < 2; i++) {
    moved[i] += across[i];
    moved_u[i] = across_u[i];
    moved_v[i] = across_v[i];
  }
  return ray;
}
