/* The image of each edge in a sphere, by bisection of the miss along the image's u axis. */
#include "reconstruct/mires/expect.h"

#include "reconstruct/mirror.h"

#include <math.h>
#include <stdbool.h>

/* The miss of the ray that meets a sphere at distance x from the axis; the ray is built backwards
 * from the point, so nothing has to be intersected. The camera's own offset from the axis and its
 * distortion shift the picture as a whole and are left out: only the scale is asked for. */
static double miss_at(const placido_instrument *instrument, const placido_edge *edge,
                      double sphere_mm, double x) {
  double root = sqrt(sphere_mm * sphere_mm - x * x);
  double depth = instrument->position_mm[2] - (root - sphere_mm);
  bool pinhole = instrument->model == PLACIDO_PINHOLE;
  placido_ray ray = {.origin = {pinhole ? 0 : x, 0, instrument->position_mm[2]},
                     .direction = {pinhole ? x / depth : 0, 0, -1}};
  placido_hit hit = {.x = x, .z = root - sphere_mm, .p = -x / root};
  return placido_mirror_miss(&ray, &hit, edge).f;
}

static double image_radius(const placido_instrument *instrument, double sphere_mm, double x) {
  double depth = instrument->position_mm[2] - (sqrt(sphere_mm * sphere_mm - x * x) - sphere_mm);
  double across = instrument->model == PLACIDO_PINHOLE ? x / depth : x;
  return across * instrument->focal_px[0];
}

void placido_mires_expect(double *radius_px, const placido_instrument *instrument,
                          double sphere_mm) {
  for (int k = 0; k < instrument->edge_count; k++) {
    const placido_edge *edge = &instrument->edges[k];
    double low = 0, high = NAN;
    /* the miss is -radius·r_z < 0 on the axis; it grows outwards up to the ray that runs level */
    for (int i = 1; i <= 400 && isnan(high); i++) {
      double x = sphere_mm * 0.98 * i / 400;
      if (miss_at(instrument, edge, sphere_mm, x) > 0) {
        high = x;
      } else {
        low = x;
      }
    }
    radius_px[k] = NAN;
    if (isnan(high)) {
      continue;
    }
    for (int i = 0; i < 60; i++) {
      double middle = (low + high) / 2;
      if (miss_at(instrument, edge, sphere_mm, middle) > 0) {
        high = middle;
      } else {
        low = middle;
      }
    }
    radius_px[k] = image_radius(instrument, sphere_mm, low);
  }
}
