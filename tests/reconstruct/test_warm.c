/* The fit that starts from the frame before: the same surface, sooner, whatever it starts from. */
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <placido/reconstruct.h>
#include <stdlib.h>

#define MERIDIANS 180
#define NOISE_PX 0.02 /* of an edge in a good picture */

static placido_instrument instrument_of(const char *name) {
  placido_instrument instrument;
  assert_int_equal(placido_phantom_instrument(&instrument, name, NULL), PLACIDO_OK);
  return instrument;
}

/* A toric cornea with a slight cone, all of it moved sideways. */
static placido_surface *eye_at(double x_mm, double y_mm, double cone_mm) {
  placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.9, -0.2, 7.6, -0.3, 15, x_mm, y_mm}},
      {.kind = PLACIDO_PART_BUMP,
       .as.bump = {cone_mm, 1.2, 1.2, 0.8 + x_mm, -0.6 + y_mm, 0}}};
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 6, parts, 2, NULL, NULL), PLACIDO_OK);
  return surface;
}

static double axis_z_of(const placido_surface *surface) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, 0, 0, &jet));
  return placido_surface_vertex_z_mm(surface) - jet.sag;
}

static placido_fit *fit_of(const placido_surface *eye, const placido_instrument *instrument,
                           const placido_fit *start, int threads) {
  placido_fit *fit;
  placido_error err = {0};
  placido_mires mires = truth_points(eye, instrument, MERIDIANS, NOISE_PX, NULL);
  const placido_fit_options options = {
      .axis_z_mm = axis_z_of(eye), .threads = threads, .start = start};
  const int status = placido_fit_new(&fit, &mires, instrument, &options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  placido_mires_free(&mires);
  return fit;
}

static double z_of(const placido_fit *fit, double x_mm, double y_mm) {
  placido_jet jet;
  const placido_surface *surface = placido_fit_surface(fit);
  assert_true(placido_surface_at(surface, x_mm, y_mm, &jet));
  return placido_surface_vertex_z_mm(surface) - jet.sag;
}

/* Where two fits of the same points end differs by what their last steps leave: 0.2 of a standard
 * deviation adds 2 % to an error bar. */
static void assert_same(const placido_fit *a, const placido_fit *b) {
  double worst = 0;
  for (double r = 0.4; r < 4; r += 0.4) {
    for (double angle = 0; angle < 6.2; angle += 0.4) {
      double x = r * cos(angle), y = r * sin(angle), sigma_um[2], sigma_D;
      placido_fit_sigma_at(a, x, y, &sigma_um[0], &sigma_D);
      placido_fit_sigma_at(b, x, y, &sigma_um[1], &sigma_D);
      assert_near(sigma_um[1], sigma_um[0], 0.1 * sigma_um[0]);
      worst = fmax(worst, 1e3 * fabs(z_of(a, x, y) - z_of(b, x, y)) / sigma_um[0]);
    }
  }
  print_message("differ by %.4f sigma at worst\n", worst);
  assert_true(worst < 0.2);
}

/* Frame after frame of an eye that drifts by a twentieth of a millimetre: no error is handed on. */
static void a_chain_of_frames_ends_where_a_fresh_fit_does(void **state) {
  (void)state;
  const placido_instrument instrument = instrument_of("cone24");
  placido_fit *last = NULL, *fresh = NULL;
  for (int frame = 0; frame < 6; frame++) {
    placido_surface *eye = eye_at(0.05 * frame, -0.02 * frame, 0.01);
    placido_fit *next = fit_of(eye, &instrument, last, 1);
    placido_fit_free(last);
    last = next;
    if (frame == 5) {
      fresh = fit_of(eye, &instrument, NULL, 1);
    }
    placido_surface_free(eye);
  }
  assert_true(placido_fit_summary_get(last).steps <= placido_fit_summary_get(fresh).steps);
  assert_same(last, fresh);
  placido_fit_free(last);
  placido_fit_free(fresh);
}

/* Another eye, another instrument, another distance: passed over or got over. */
static void a_wrong_start_does_no_harm(void **state) {
  (void)state;
  const placido_instrument cone = instrument_of("cone24"), disc = instrument_of("disc18");
  placido_surface *eye = eye_at(0, 0, 0.01), *other = eye_at(0.6, -0.5, 0.05);
  placido_surface *sphere;
  assert_int_equal(placido_phantom_eye(&sphere, "sphere", NULL), PLACIDO_OK);
  placido_fit *fresh = fit_of(eye, &cone, NULL, 1);
  placido_fit *starts[] = {fit_of(other, &cone, NULL, 1), fit_of(sphere, &cone, NULL, 1),
                           fit_of(eye, &disc, NULL, 1)};
  for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
    placido_fit *fit = fit_of(eye, &cone, starts[i], 1);
    assert_same(fit, fresh);
    placido_fit_free(fit);
    placido_fit_free(starts[i]);
  }
  placido_fit_free(fresh);
  placido_surface_free(eye);
  placido_surface_free(other);
  placido_surface_free(sphere);
}

static void threads_change_no_bit(void **state) {
  (void)state;
  const placido_instrument instrument = instrument_of("cone24");
  placido_surface *before = eye_at(0, 0, 0.01), *now = eye_at(0.04, 0.03, 0.01);
  placido_fit *start = fit_of(before, &instrument, NULL, 1);
  double first = 0;
  for (int threads = 1; threads <= 4; threads *= 2) {
    placido_fit *fit = fit_of(now, &instrument, start, threads);
    const double z = z_of(fit, 1.3, -0.7);
    first = threads == 1 ? z : first;
    assert_memory_equal(&z, &first, sizeof z);
    placido_fit_free(fit);
  }
  placido_fit_free(start);
  placido_surface_free(before);
  placido_surface_free(now);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_chain_of_frames_ends_where_a_fresh_fit_does),
      cmocka_unit_test(a_wrong_start_does_no_harm),
      cmocka_unit_test(threads_change_no_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
