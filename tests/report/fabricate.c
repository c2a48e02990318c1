/* Data made up for the figures' tests. */
#include "tests/report/fabricate.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

placido_maps fabricate_maps(double (*at)(double x_mm, double y_mm)) {
  placido_maps maps = {.step_mm = 0.1, .radius_mm = 4.5, .half = 45, .size = 91};
  maps.sphere = (placido_sphere){.radius_mm = 7.8, .zone_mm = 8};
  size_t points = 91 * 91, kinds;
  placido_map_kinds(&kinds);
  double *values = calloc(points, sizeof *values);
  maps.valid = calloc(points, 1);
  maps.values = calloc(kinds, sizeof *maps.values);
  assert_true(values != NULL && maps.valid != NULL && maps.values != NULL);
  for (int j = 0; j < 91; j++) {
    for (int i = 0; i < 91; i++) {
      double x = (i - 45) * 0.1, y = (j - 45) * 0.1;
      double value = hypot(x, y) <= 4.5 + 1e-9 ? at(x, y) : NAN;
      values[j * 91 + i] = value;
      maps.valid[j * 91 + i] = isfinite(value);
    }
  }
  for (size_t k = 0; k < kinds; k++) {
    maps.values[k] = values; /* one array serves all: figures only read */
  }
  return maps;
}

void fabricate_maps_free(placido_maps *maps) {
  free(maps->values[0]);
  free(maps->values);
  free(maps->valid);
}

placido_frame fabricate_frame(int width_px, int height_px, enum placido_format format) {
  placido_frame frame = {0};
  assert_int_equal(placido_frame_resize(&frame, width_px, height_px, format, NULL), PLACIDO_OK);
  memset(frame.data, 0, (size_t)height_px * frame.stride_bytes);
  return frame;
}

placido_mires fabricate_mires(double u_px, double v_px, double spacing_px, int edges) {
  placido_mires mires = {.centre_u_px = u_px,
                         .centre_v_px = v_px,
                         .edge_count = edges,
                         .meridian_count = 180,
                         .count = 180 * (size_t)edges,
                         .coverage = 1};
  mires.points = calloc(mires.count, sizeof *mires.points);
  assert_non_null(mires.points);
  for (size_t k = 0; k < mires.count; k++) {
    int edge = (int)(k / 180);
    double degrees = 2.0 * (double)(k % 180), radians = degrees * acos(-1) / 180;
    double radius = spacing_px * (edge + 1);
    mires.points[k] = (placido_mire_point){.edge = edge,
                                           .meridian_deg = degrees,
                                           .u_px = u_px + radius * cos(radians),
                                           .v_px = v_px - radius * sin(radians),
                                           .sigma_px = 0.05,
                                           .used = k % 10 != 0,
                                           .residual_px = 0};
  }
  return mires;
}

placido_psf fabricate_psf(int n) {
  placido_psf psf = {.n = n,
                     .bucket_arcmin = 0.5,
                     .bucket_um = 3.4,
                     .pupil_mm = 4,
                     .index = 1.3375,
                     .retina_mm = 31.4,
                     .rays = 1000,
                     .rays_entered = 800,
                     .rays_landed = 800,
                     .strehl_g = 1};
  psf.values = calloc((size_t)n * (size_t)n, sizeof *psf.values);
  assert_non_null(psf.values);
  psf.values[(size_t)(n / 2) * (size_t)n + (size_t)(n / 2)] = 1;
  return psf;
}

unsigned colour_at(const placido_frame *picture, int x, int y) {
  const uint8_t *row = picture->data + (size_t)y * picture->stride_bytes;
  if (picture->format == PLACIDO_MONO8) {
    return row[x] * 0x010101u;
  }
  assert_int_equal(picture->format, PLACIDO_RGB8);
  const uint8_t *at = row + 3 * (size_t)x;
  return (unsigned)at[0] << 16 | (unsigned)at[1] << 8 | at[2];
}
