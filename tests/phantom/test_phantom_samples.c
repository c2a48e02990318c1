/* The phantom against pictures of an independent renderer: same surface and instrument, same
 * mires. */
#include "tests/phantom/locate.h"
#include "tests/support/truth.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <placido/image.h>
#include <placido/phantom.h>
#include <stdio.h>
#include <stdlib.h>

#define MERIDIANS 72

static const char *const samples[] = {"sphere",   "normal",        "keratoconus",
                                      "post-prk", "irregular-lid", "disc-normal"};

/* Distances of all edges from the principal point along a meridian; NaN where not seen. */
static void predict(double *distance, const placido_surface *surface,
                    const placido_instrument *instrument, double deg) {
  for (int k = 0; k < instrument->edge_count; k++) {
    double at[2];
    placido_phantom_edge_at(surface, instrument, k, instrument->principal_px, deg, at);
    distance[k] = hypot(at[0] - instrument->principal_px[0], at[1] - instrument->principal_px[1]);
  }
}

/* Half the width in which edge k is alone, but never more than what the blur reaches. */
static double half_width(const double *distance, int k, int count) {
  double width = 3;
  if (k > 0) {
    width = fmin(width, 0.5 * (distance[k] - distance[k - 1]));
  }
  if (k + 1 < count) {
    width = fmin(width, 0.5 * (distance[k + 1] - distance[k]));
  }
  return width;
}

/* Differences of one meridian's edges between two pictures; returns the new count. Where the
 * sample's edge is weaker than ours or over a pixel away, a lash, nose or lid hides it. */
static int compare_meridian(double *differences, int count, const placido_frame *ours,
                            const placido_frame *sample, const placido_surface *surface,
                            const placido_instrument *instrument, double deg) {
  double distance[PLACIDO_EDGES_MAX], radian = deg / 57.29577951308232;
  double along[2] = {cos(radian), -sin(radian)};
  predict(distance, surface, instrument, deg);
  for (int k = 0; k < instrument->edge_count; k++) {
    double at[2], height[2], width = half_width(distance, k, instrument->edge_count);
    for (int i = 0; i < 2; i++) {
      at[i] = instrument->principal_px[i] + distance[k] * along[i];
    }
    if (!(width > 1)) {
      continue;
    }
    double rising = (k % 2 == 0) == instrument->first_band_bright ? 1 : -1;
    double a = locate_step(ours, at, along, width, rising, &height[0]);
    double b = locate_step(sample, at, along, width, rising, &height[1]);
    if (height[1] > 0.9 * height[0] && fabs(a - b) < 1) {
      differences[count++] = fabs(a - b);
    }
  }
  return count;
}

static void agrees_with_sample(void **state) {
  const char *name = *state;
  char path[1024];
  placido_error err = {0};
  placido_frame sample = {0}, ours = {0};
  double axis_z_mm;
  placido_surface *surface = truth_load(name, &axis_z_mm);
  placido_instrument instrument = truth_instrument(name);
  placido_disturbance soft = {.blur_px = 0.8};
  snprintf(path, sizeof path, "%s/samples/%s.png", PLACIDO_TEST_DATA, name);
  assert_int_equal(placido_frame_load(&sample, path, &err), PLACIDO_OK);
  assert_int_equal(placido_phantom_render(&ours, surface, &instrument, &soft, 0, &err), PLACIDO_OK);
  double *differences = malloc(sizeof *differences * MERIDIANS * (size_t)instrument.edge_count);
  assert_non_null(differences);
  int count = 0;
  for (int m = 0; m < MERIDIANS; m++) {
    count = compare_meridian(differences, count, &ours, &sample, surface, &instrument,
                             360.0 * m / MERIDIANS + 1.3);
  }
  double median = median_of(differences, count);
  double covered = (double)count / (MERIDIANS * instrument.edge_count);
  print_message("%s: median %.4f px, 95 %% below %.4f px, %.1f %% of the edges\n", name, median,
                differences[count * 95 / 100], 100 * covered);
  /* The issue asks for 0.05 px; the samples' own noise of 1 to 2 grey levels makes about 0.01. */
  assert_true(median < 0.02);
  assert_true(covered > 0.9);
  free(differences);
  placido_frame_free(&sample);
  placido_frame_free(&ours);
  placido_surface_free(surface);
}

int main(void) {
  struct CMUnitTest tests[sizeof samples / sizeof *samples];
  for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
    tests[i] = (struct CMUnitTest){samples[i], agrees_with_sample, NULL, NULL,
                                   (void *)(uintptr_t)samples[i]};
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
