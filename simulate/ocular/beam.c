/* Beam: exact skew rays, column by column (Born and Wolf, Principles of Optics, 3.2; W. T. Welford,
 * Aberrations of Optical Systems, 4). */
#include "simulate/ocular/beam.h"

#include "base/dispatch.h"

#include <math.h>

static const double cosine_min = 0.17364817766693034885; /* of 80 degrees */

placido_beam placido_beam_of(double *block, size_t room) {
  placido_beam beam = {.count = room};
  double **columns[PLACIDO_BEAM_COLUMNS] = {
    &beam.x_mm, &beam.y_mm, &beam.depth_mm, &beam.sx, &beam.sy, &beam.px,
    &beam.py,   &beam.pz,   &beam.tx,       &beam.ty, &beam.tz, &beam.path_mm};
  for (size_t i = 0; i < PLACIDO_BEAM_COLUMNS; i++) {
    *columns[i] = block + i * room;
  }
  return beam;
}

/* n t = a + l N, a the wave vector that the lens lets through, N the normal towards the light. */
PLACIDO_WIDE
void placido_beam_enter(const placido_beam *beam, const placido_incidence *incidence) {
  const placido_incidence in = *incidence;
  const double kx = in.slope[0], ky = in.slope[1], near = in.nearness;
  const double whole = sqrt(1 + kx * kx + ky * ky);
  const double *restrict x = beam->x_mm, *restrict y = beam->y_mm, *restrict z = beam->depth_mm;
  const double *restrict sx = beam->sx, *restrict sy = beam->sy;
  double *restrict px = beam->px, *restrict py = beam->py, *restrict pz = beam->pz;
  double *restrict tx = beam->tx, *restrict ty = beam->ty, *restrict tz = beam->tz;
  double *restrict path = beam->path_mm;
  const size_t count = beam->count;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    double rx = x[i] - in.x_mm, ry = y[i] - in.y_mm;
    double bx = in.xx * rx + in.xy * ry, by = in.xy * rx + in.yy * ry;
    double u = kx + near * rx, v = ky + near * ry, w = 1 + near * z[i];
    double length = sqrt(u * u + v * v + w * w);
    double ax = u / length - bx, ay = v / length - by, az = w / length;
    double square = ax * ax + ay * ay + az * az;
    double steep = 1 / sqrt(1 + sx[i] * sx[i] + sy[i] * sy[i]);
    double against = (az - ax * sx[i] - ay * sy[i]) * steep;
    double root = sqrt(in.index * in.index - square + against * against);
    double onto = against >= cosine_min * sqrt(square) ? (against - root) * steep : NAN;
    tx[i] = (ax + onto * sx[i]) / in.index;
    ty[i] = (ay + onto * sy[i]) / in.index;
    tz[i] = (az - onto) / in.index;
    px[i] = x[i];
    py[i] = y[i];
    pz[i] = z[i];
    double ahead = 2 * (kx * rx + ky * ry + z[i]) + near * (rx * rx + ry * ry + z[i] * z[i]);
    path[i] = ahead / (length + whole) - 0.5 * (bx * rx + by * ry);
  }
}

PLACIDO_WIDE
void placido_beam_refract(const placido_beam *beam, const placido_conic *conic) {
  const placido_conic s = *conic;
  const double c = s.curvature, k = c * (1 + s.q), ratio = s.before / s.behind;
  double *restrict px = beam->px, *restrict py = beam->py, *restrict pz = beam->pz;
  double *restrict tx = beam->tx, *restrict ty = beam->ty, *restrict tz = beam->tz;
  double *restrict path = beam->path_mm;
  const size_t count = beam->count;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    double x = px[i], y = py[i], z = pz[i] - s.vertex_mm, u = tx[i], v = ty[i], w = tz[i];
    double a = c * (u * u + v * v) + k * w * w;
    double b = c * (x * u + y * v) + k * z * w - w;
    double d = c * (x * x + y * y) + k * z * z - 2 * z;
    double way = d / (sqrt(b * b - a * d) - b);
    x += way * u;
    y += way * v;
    z += way * w;
    double nx = c * x, ny = c * y, nz = k * z - 1;
    double length = 1 / sqrt(nx * nx + ny * ny + nz * nz);
    double cosine = -(u * nx + v * ny + w * nz) * length;
    double root = sqrt(1 - ratio * ratio * (1 - cosine * cosine));
    double onto = cosine > 0 ? (ratio * cosine - root) * length : NAN;
    px[i] = x;
    py[i] = y;
    pz[i] = z + s.vertex_mm;
    tx[i] = ratio * u + onto * nx;
    ty[i] = ratio * v + onto * ny;
    tz[i] = ratio * w + onto * nz;
    path[i] += s.before * way;
  }
}

PLACIDO_WIDE
void placido_beam_plane(const placido_beam *beam, double depth_mm, double index) {
  double *restrict px = beam->px, *restrict py = beam->py, *restrict pz = beam->pz;
  const double *restrict tx = beam->tx, *restrict ty = beam->ty, *restrict tz = beam->tz;
  double *restrict path = beam->path_mm;
  const size_t count = beam->count;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    double way = tz[i] > 0 ? (depth_mm - pz[i]) / tz[i] : NAN;
    px[i] += way * tx[i];
    py[i] += way * ty[i];
    pz[i] = depth_mm + 0 * way;
    path[i] += index * way;
  }
}

PLACIDO_WIDE
void placido_beam_sphere(const placido_beam *beam, double centre_mm, double radius_mm,
                         double index) {
  double *restrict px = beam->px, *restrict py = beam->py, *restrict pz = beam->pz;
  const double *restrict tx = beam->tx, *restrict ty = beam->ty, *restrict tz = beam->tz;
  double *restrict path = beam->path_mm;
  const size_t count = beam->count;
#pragma omp simd
  for (size_t i = 0; i < count; i++) {
    double x = px[i], y = py[i], z = pz[i] - centre_mm;
    double b = x * tx[i] + y * ty[i] + z * tz[i];
    double way = sqrt(b * b - (x * x + y * y + z * z) + radius_mm * radius_mm) - b;
    px[i] += way * tx[i];
    py[i] += way * ty[i];
    pz[i] += way * tz[i];
    path[i] += index * way;
  }
}
