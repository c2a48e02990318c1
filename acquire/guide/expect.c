/* Mirror images by the law of reflection in the plane of one meridian: a camera ray at the angle α
 * to the axis that meets a slope of angle φ leaves at 2φ + α. The camera is taken to be on the
 * axis. */
#include "acquire/guide/expect.h"

#include <math.h>

#define REACH_MM 6.5 /* no cornea is wider */
#define HALVINGS 40

/* Sag and the angle of the slope at r; false beyond the conic's rim. */
static bool shape_at(const placido_guide_cornea *cornea, double r_mm, double *sag_mm,
                     double *angle) {
  const double c = 1 / cornea->radius_mm;
  const double square = 1 - (1 + cornea->asphericity) * c * c * r_mm * r_mm;
  if (square <= 1e-6) {
    return false;
  }
  *sag_mm = c * r_mm * r_mm / (1 + sqrt(square));
  *angle = atan(c * r_mm / sqrt(square));
  return true;
}

/* Positive where the mirrored ray passes inside the edge, negative outside. */
static double miss(const placido_instrument *instrument, const placido_guide_cornea *cornea,
                   const placido_edge *edge, double r_mm) {
  double sag_mm, angle;
  if (!shape_at(cornea, r_mm, &sag_mm, &angle)) {
    return -1;
  }
  const double z_mm = cornea->z_mm - sag_mm;
  const double camera = instrument->model == PLACIDO_TELECENTRIC
                            ? 0
                            : atan(r_mm / (instrument->position_mm[2] - z_mm));
  const double leaves = 2 * angle + camera;
  return (edge->radius_mm - r_mm) * cos(leaves) - (edge->z_mm - z_mm) * sin(leaves);
}

static double image_radius(const placido_instrument *instrument,
                           const placido_guide_cornea *cornea, double r_mm) {
  double sag_mm = 0, angle, r = r_mm;
  shape_at(cornea, r_mm, &sag_mm, &angle);
  if (instrument->model == PLACIDO_PINHOLE) {
    r /= instrument->position_mm[2] - cornea->z_mm + sag_mm;
  }
  const double *k = instrument->distortion, square = r * r;
  r *= 1 + square * (k[0] + square * (k[1] + square * k[4]));
  return 0.5 * (instrument->focal_px[0] + instrument->focal_px[1]) * r;
}

void placido_guide_expect(double *radius_px, const placido_instrument *instrument,
                          const placido_guide_cornea *cornea) {
  for (int k = 0; k < instrument->edge_count; k++) {
    double low = 0, high = REACH_MM;
    radius_px[k] = NAN;
    if (miss(instrument, cornea, &instrument->edges[k], high) > 0) {
      continue;
    }
    for (int i = 0; i < HALVINGS; i++) {
      const double middle = 0.5 * (low + high);
      if (miss(instrument, cornea, &instrument->edges[k], middle) > 0) {
        low = middle;
      } else {
        high = middle;
      }
    }
    double sag_mm, angle;
    if (shape_at(cornea, high, &sag_mm, &angle)) {
      radius_px[k] = image_radius(instrument, cornea, low);
    }
  }
}

/* The normal at the mirror point of an object and a camera on the axis, seen from the sphere's
 * centre at (s, -R), leans towards the axis by the mean of the two angles s/(R + height). */
double placido_guide_follow(const placido_instrument *instrument, double radius_mm) {
  double leans = 1 / (radius_mm + instrument->edges[0].z_mm);
  if (instrument->model == PLACIDO_PINHOLE) {
    leans += 1 / (radius_mm + instrument->position_mm[2]);
  }
  return 1 - 0.5 * radius_mm * leans;
}

/* Undoes OpenCV's distortion by repeated substitution. */
static void undistort(double xy[2], const double k[5]) {
  const double x0 = xy[0], y0 = xy[1];
  for (int i = 0; i < 8; i++) {
    const double x = xy[0], y = xy[1], square = x * x + y * y;
    const double radial = 1 + square * (k[0] + square * (k[1] + square * k[4]));
    xy[0] = (x0 - 2 * k[2] * x * y - k[3] * (square + 2 * x * x)) / radial;
    xy[1] = (y0 - k[2] * (square + 2 * y * y) - 2 * k[3] * x * y) / radial;
  }
}

void placido_guide_place(double place_mm[2], const placido_instrument *instrument,
                         const double uv_px[2]) {
  double xy[2];
  for (int i = 0; i < 2; i++) {
    xy[i] = (uv_px[i] - instrument->principal_px[i]) / instrument->focal_px[i];
  }
  undistort(xy, instrument->distortion);
  const double distance = instrument->model == PLACIDO_PINHOLE ? instrument->position_mm[2] : 1;
  place_mm[0] = instrument->position_mm[0] + xy[0] * distance;
  place_mm[1] = instrument->position_mm[1] - xy[1] * distance;
}
