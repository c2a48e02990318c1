/* The cornea's distance: solved for where staggered mires tell it, taken as given where they lie on
 * one cone. Exact points of the phantom's forward trace, each edge by itself: nothing hides any. */
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <placido/reconstruct.h>

#define MERIDIANS 90
#define NOISE_PX 0.03
#define GIVEN_SIGMA_MM 0.05

/* The cone with every other mire farther by a share. */
static placido_instrument cone(double stagger) {
  placido_instrument instrument;
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  for (int k = 0; k < instrument.edge_count; k++) {
    instrument.edges[k].z_mm *= k / 2 % 2 ? 1 + stagger : 1;
    instrument.edges[k].radius_mm *= k / 2 % 2 ? 1 + stagger : 1;
  }
  return instrument;
}

/* An eye's points on one cone, or staggered: tracing them takes longer than fitting. */
typedef struct subject {
  const char *eye;
  double stagger, axis_z_mm;
  placido_surface *truth;
  placido_mires mires;
} subject;

enum { NORMAL_STAGGERED, CONE_STAGGERED, NORMAL, CONE, SUBJECTS };
static subject subjects[SUBJECTS] = {[NORMAL_STAGGERED] = {.eye = "astigmatic", .stagger = 0.05},
                                     [CONE_STAGGERED] = {.eye = "keratoconus", .stagger = 0.05},
                                     [NORMAL] = {.eye = "irregular"},
                                     [CONE] = {.eye = "keratoconus"}};

static int trace(void **state) {
  (void)state;
  for (int i = 0; i < SUBJECTS; i++) {
    subject *s = &subjects[i];
    placido_instrument instrument = cone(s->stagger);
    placido_jet jet;
    assert_int_equal(placido_phantom_eye(&s->truth, s->eye, NULL), PLACIDO_OK);
    assert_true(placido_surface_at(s->truth, 0, 0, &jet));
    s->axis_z_mm = placido_surface_vertex_z_mm(s->truth) - jet.sag;
    s->mires = truth_points(s->truth, &instrument, MERIDIANS, NOISE_PX, NULL);
  }
  return 0;
}

static int forget(void **state) {
  (void)state;
  for (int i = 0; i < SUBJECTS; i++) {
    placido_mires_free(&subjects[i].mires);
    placido_surface_free(subjects[i].truth);
  }
  return 0;
}

/* The fit when the distance is given `off_mm` wrong; what it says of it. */
static placido_fit_summary summary_of(subject *s, double off_mm, double sigma_mm,
                                      truth_error *error) {
  placido_instrument instrument = cone(s->stagger);
  placido_fit *fit;
  placido_error err = {0};
  placido_fit_options options = {
      .axis_z_mm = s->axis_z_mm + off_mm, .axis_z_sigma_mm = sigma_mm, .threads = 2};
  int status = placido_fit_new(&fit, &s->mires, &instrument, &options, NULL, &err);
  if (status) {
    print_error("%s\n", err.text);
  }
  assert_int_equal(status, PLACIDO_OK);
  placido_fit_summary summary = placido_fit_summary_get(fit);
  *error = truth_compare(fit, s->truth, 0, 8);
  print_message("%s, stagger %.2f, given %+.3f: z %+.4f +- %.4f mm, %.4f um\n", s->eye, s->stagger,
                off_mm, summary.axis_z_mm - s->axis_z_mm, summary.axis_z_sigma_mm,
                error->elevation_um);
  placido_fit_free(fit);
  return summary;
}

/* Every other mire 5 % farther: the distance comes out to some micrometres, whatever was given,
 * with a standard deviation that says so. */
static void staggered_mires_tell_the_distance(void **state) {
  (void)state;
  for (int i = NORMAL_STAGGERED; i <= CONE_STAGGERED; i++) {
    for (int sign = -1; sign <= 1; sign++) {
      truth_error error;
      subject *eye = &subjects[i];
      placido_fit_summary s = summary_of(eye, 0.06 * sign, GIVEN_SIGMA_MM, &error);
      assert_true(s.axis_z_solved);
      assert_true(s.axis_z_sigma_mm < 0.01);
      assert_true(fabs(s.axis_z_mm - eye->axis_z_mm) < 3 * s.axis_z_sigma_mm);
      assert_true(error.elevation_um < 0.2); /* 0.06 mm unsolved cost 0.9 um */
      assert_true(error.over_sigma < 3);
    }
  }
}

/* Mires on one cone do not: what was given stays, to the bit. */
static void mires_on_a_cone_leave_it_as_given(void **state) {
  (void)state;
  for (int i = NORMAL; i <= CONE; i++) {
    truth_error error;
    placido_fit_summary s = summary_of(&subjects[i], 0.03, GIVEN_SIGMA_MM, &error);
    assert_false(s.axis_z_solved);
    assert_true(s.axis_z_mm == subjects[i].axis_z_mm + 0.03);
    assert_true(s.axis_z_sigma_mm == GIVEN_SIGMA_MM);
    assert_true(error.over_sigma < 1.5); /* the error bars know of the 0.03 mm */
  }
}

/* A distance that is known exactly is not argued with, and one that is given far from what the
 * mires say is not left: no run-off. */
static void the_distance_cannot_run_off(void **state) {
  (void)state;
  truth_error error;
  subject *eye = &subjects[NORMAL_STAGGERED];
  placido_fit_summary s = summary_of(eye, 0.02, 0, &error);
  assert_false(s.axis_z_solved);
  assert_true(s.axis_z_mm == eye->axis_z_mm + 0.02);
  s = summary_of(eye, 0.4, GIVEN_SIGMA_MM, &error);
  assert_false(s.axis_z_solved);
  assert_true(s.axis_z_mm == eye->axis_z_mm + 0.4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(staggered_mires_tell_the_distance),
      cmocka_unit_test(mires_on_a_cone_leave_it_as_given),
      cmocka_unit_test(the_distance_cannot_run_off),
  };
  return cmocka_run_group_tests(tests, trace, forget);
}
