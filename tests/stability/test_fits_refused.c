/* What is no measurement is refused with a sentence that names it; what is little more than that
 * has error bars that say so. */
#include "tests/stability/fits.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#define MERIDIANS 90

typedef void spoiler(placido_mires *mires, placido_instrument *instrument, double with);

static placido_mire_point *some_point(placido_mires *mires) {
  return &mires->points[mires->count / 3];
}

static void set_u(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  some_point(mires)->u_px = with;
}

static void set_v(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  some_point(mires)->v_px = with;
}

static void set_sigma(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  some_point(mires)->sigma_px = with;
}

static void set_edge(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  some_point(mires)->edge = (int)with;
}

static void set_meridian(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  some_point(mires)->meridian_deg = with;
}

static void swap_two(placido_mires *mires, placido_instrument *instrument, double apart) {
  (void)instrument;
  placido_mire_point *a = some_point(mires), *b = a + (int)apart, kept = *a;
  *a = *b;
  *b = kept;
}

/* Every point `with` times for those in the first 1/`with` of the list, which stays as long. */
static void repeat_all(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  for (size_t i = mires->count; i-- > 0;) {
    mires->points[i] = mires->points[i / (size_t)with];
  }
}

static void repeat_one(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  placido_mire_point *point = some_point(mires);
  for (int i = 1; i < (int)with; i++) {
    point[i] = point[0];
  }
}

static void set_edge_count(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  mires->edge_count = (int)with;
}

static void set_meridian_count(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)instrument;
  mires->meridian_count = (int)with;
}

static void set_edge_radius(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)mires;
  instrument->edges[7].radius_mm = with;
}

static void set_edge_z(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)mires;
  instrument->edges[7].z_mm = with;
}

static void set_camera_z(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)mires;
  instrument->position_mm[2] = with;
}

static void scale(placido_mires *mires, placido_instrument *instrument, double with) {
  (void)mires;
  for (int k = 0; k < instrument->edge_count; k++) {
    instrument->edges[k].radius_mm *= with;
    instrument->edges[k].z_mm *= with;
  }
  for (int i = 0; i < 3; i++) {
    instrument->position_mm[i] *= with;
  }
}

static const struct {
  const char *name;
  spoiler *spoil;
  double with;
  const char *says;
} spoilt[] = {
    {"u is no number", set_u, NAN, "is not in the image"},
    {"v is infinite", set_v, INFINITY, "is not in the image"},
    {"u far left of the image", set_u, -5000, "is not in the image of 1280 x 1024 px"},
    {"v far below the image", set_v, 1e300, "is not in the image"},
    {"sigma is no number", set_sigma, NAN, "standard deviation of nan px"},
    {"sigma is infinite", set_sigma, INFINITY, "standard deviation of inf px"},
    {"sigma is 0", set_sigma, 0, "a positive number is expected"},
    {"sigma is negative", set_sigma, -0.1, "a positive number is expected"},
    {"edge -1", set_edge, -1, "the instrument has 0 to 47"},
    {"edge 48 of 48", set_edge, 48, "the instrument has 0 to 47"},
    {"edge INT_MAX", set_edge, INT_MAX, "the instrument has 0 to 47"},
    {"edge INT_MIN", set_edge, INT_MIN, "the instrument has 0 to 47"},
    {"meridian is no number", set_meridian, NAN, "from 0 to below 360"},
    {"meridian of 360 degrees", set_meridian, 360, "from 0 to below 360"},
    {"meridian of -4 degrees", set_meridian, -4, "from 0 to below 360"},
    {"meridian of 1e30 degrees", set_meridian, 1e30, "from 0 to below 360"},
    {"two neighbours swapped", swap_two, 1, "stands behind later ones"},
    {"two edges swapped", swap_two, 200, "stands behind later ones"},
    {"each point twice", repeat_all, 2, "stands twice"},
    {"one point 1,000 times", repeat_one, 1000, "stands twice"},
    {"mires of 47 edges", set_edge_count, 47, "expected the instrument's 48"},
    {"no meridians", set_meridian_count, 0, "on at least one"},
    {"meridian count negative", set_meridian_count, -3, "on at least one"},
    {"radius of an edge is no number", set_edge_radius, NAN, "edge 7 of the instrument"},
    {"radius of an edge is 0", set_edge_radius, 0, "edge 7 of the instrument"},
    {"z of an edge is infinite", set_edge_z, INFINITY, "edge 7 of the instrument"},
    {"camera behind the eye", set_camera_z, -100, "from the cornea, 5 to 5000 mm are expected"},
    {"camera's place is no number", set_camera_z, NAN, "the camera stands nan mm"},
    {"instrument times 1e-3", scale, 1e-3, "1 to 1000 mm are expected"},
    {"instrument times 1e3", scale, 1e3, "1 to 1000 mm are expected"},
};

/* No place in a table is looked up before the index is known to be one; ASan watches. */
static void spoilt_input_is_refused(void **state) {
  (void)state;
  const placido_part part = FITS_TORIC;
  const fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  for (size_t i = 0; i < sizeof spoilt / sizeof spoilt[0]; i++) {
    placido_mires mires = fits_some(&eye, NULL, 0);
    placido_instrument instrument = eye.instrument;
    placido_fit_options options = {.axis_z_mm = eye.axis_z_mm};
    spoilt[i].spoil(&mires, &instrument, spoilt[i].with);
    fits_add_refusal(spoilt[i].name, &instrument, &mires, &options, PLACIDO_INPUT, spoilt[i].says);
    placido_mires_free(&mires);
  }
  fits_eye whole = eye;
  fits_eye_free(&whole);
}

static void impossible_options_are_refused(void **state) {
  (void)state;
  static const struct {
    const char *name;
    placido_fit_options options;
    const char *says;
  } cases[] = {
      {"z on the axis is no number", {.axis_z_mm = NAN}, "finite numbers are expected"},
      {"z on the axis is infinite", {.axis_z_mm = -INFINITY}, "finite numbers are expected"},
      {"its sigma is negative", {.axis_z_sigma_mm = -0.1}, "the second not negative"},
      {"its sigma is no number", {.axis_z_sigma_mm = NAN}, "the second not negative"},
      {"its sigma is infinite", {.axis_z_sigma_mm = INFINITY}, "the second not negative"},
      {"knots below their limit", {.knot_mm = 0.149}, "expected 0.15 to 2 mm"},
      {"knots beyond their limit", {.knot_mm = 2.001}, "expected 0.15 to 2 mm"},
      {"knots negative", {.knot_mm = -0.5}, "expected 0.15 to 2 mm"},
      {"smoothing negative", {.smoothing = -5}, "smoothing of weight -5"},
      {"smoothing is no number", {.smoothing = NAN}, "smoothing of weight nan"},
      {"smoothing is infinite", {.smoothing = INFINITY}, "smoothing of weight inf"},
      {"steps negative", {.steps_max = -1}, "at most -1 steps"},
  };
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    fits_add_refusal(cases[i].name, &eye.instrument, &eye.mires, &cases[i].options, PLACIDO_INPUT,
                     cases[i].says);
  }
  fits_eye_free(&eye);
}

/* The same picture belongs to an eye and an instrument that are both larger or smaller. Lengths in
 * the program are those of human eyes (knots, penalty, coverage), so that nothing scales to
 * rounding; but whatever is still a cornea is measured as well as its error bars say. */
static void other_sizes_are_measured_or_refused(void **state) {
  (void)state;
  static const double factors[] = {0.1, 0.6, 0.8, 1.25, 1.5, 10};
  for (size_t i = 0; i < sizeof factors / sizeof factors[0]; i++) {
    char name[64];
    placido_part part = FITS_TORIC;
    fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
    double f = factors[i], axis_z_mm = eye.axis_z_mm * f;
    snprintf(name, sizeof name, "eye and instrument times %g", f);
    scale(&eye.mires, &eye.instrument, f);
    part.as.biconic.r1 *= f;
    part.as.biconic.r2 *= f;
    part.as.biconic.cx *= f;
    part.as.biconic.cy *= f;
    if (f < 0.5 || f > 1.4) {
      placido_fit_options options = {.axis_z_mm = axis_z_mm};
      fits_add_refusal(name, &eye.instrument, &eye.mires, &options, PLACIDO_QUALITY,
                       f < 5 ? "are possible" : "no cornea");
    } else {
      placido_surface_free(eye.truth);
      assert_int_equal(placido_surface_new(&eye.truth, 0, 6 * f, &part, 1, NULL, NULL), PLACIDO_OK);
      eye.axis_z_mm = axis_z_mm;
      placido_fit *fit = fits_of(&eye, NULL, NULL);
      fits_error e = fits_compare(fit, &eye);
      fits_add(name, fit, &e, 0, f, "times");
      placido_fit_free(fit);
    }
    fits_eye_free(&eye);
  }
}

/* A wrong distance cannot be seen in the mires, so its error bar is the caller's word. Where that
 * is as large as the error d: |error| <= d g + bound·noise, which is at most sqrt(1 + bound²) times
 * the claimed sqrt((d g)² + noise²) (Cauchy-Schwarz), g being linear: d² / R adds d / 7.8 mm of
 * that. */
static void a_wrong_distance_is_covered_by_its_sigma(void **state) {
  (void)state;
  static const double off_mm[] = {1e-3, 0.03, 0.3, -0.3, 1};
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  const double true_z_mm = eye.axis_z_mm;
  for (size_t i = 0; i < sizeof off_mm / sizeof off_mm[0]; i++) {
    char name[64];
    placido_fit_options options = {.axis_z_sigma_mm = fabs(off_mm[i])};
    eye.axis_z_mm = true_z_mm + off_mm[i];
    placido_fit *fit = fits_of(&eye, NULL, &options);
    fits_error e = fits_compare(fit, &eye);
    double bound = fits_bound(e.points);
    snprintf(name, sizeof name, "distance off by its sigma of %g mm", off_mm[i]);
    const struct stability_row row = {.name = name,
                                      .condition = placido_fit_summary_get(fit).condition,
                                      .perturbation = off_mm[i],
                                      .in_unit = "mm",
                                      .change = e.over_sigma,
                                      .out_unit = "sigma",
                                      .bound =
                                          sqrt(1 + bound * bound) * (1 + fabs(off_mm[i]) / 7.8),
                                      .extended = NAN};
    stability_add(&row);
    placido_fit_free(fit);
  }
  eye.axis_z_mm = true_z_mm;
  fits_eye_free(&eye);
}

static void a_distance_far_off_is_refused(void **state) {
  (void)state;
  static const struct {
    double z_mm;
    int status;
    const char *says;
  } cases[] = {
      {-1e6, PLACIDO_INPUT, "are the instrument's lengths and the distance in millimetres"},
      {119, PLACIDO_INPUT, "the camera stands 1 mm from the cornea"},
      {-60, PLACIDO_QUALITY, ""},
      {-30, PLACIDO_QUALITY, ""},
      {20, PLACIDO_QUALITY, ""},
      {40, PLACIDO_QUALITY, ""},
      {60, PLACIDO_QUALITY, ""},
  };
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, MERIDIANS);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char name[64];
    placido_mires mires = fits_some(&eye, NULL, 0);
    placido_fit_options options = {.axis_z_mm = cases[i].z_mm};
    snprintf(name, sizeof name, "distance off by %g mm", cases[i].z_mm);
    fits_add_refusal(name, &eye.instrument, &mires, &options, cases[i].status, cases[i].says);
    placido_mires_free(&mires);
  }
  fits_eye_free(&eye);
}

/* The eye under 256 edges between the instrument's first and last. */
static fits_eye under_many_edges(int meridians) {
  const placido_part part = FITS_TORIC;
  fits_eye eye = fits_eye_new("cone24", &part, 1, 1);
  placido_instrument *in = &eye.instrument;
  const placido_edge first = in->edges[0], last = in->edges[in->edge_count - 1];
  in->edge_count = PLACIDO_EDGES_MAX;
  for (int k = 0; k < in->edge_count; k++) {
    double share = (double)k / (in->edge_count - 1);
    in->edges[k].radius_mm = first.radius_mm + share * (last.radius_mm - first.radius_mm);
    in->edges[k].z_mm = first.z_mm + share * (last.z_mm - first.z_mm);
  }
  placido_mires_free(&eye.mires);
  eye.mires = truth_points(eye.truth, in, meridians, FITS_NOISE_PX, NULL);
  return eye;
}

static bool within_10_deg(const placido_mire_point *point, size_t index, double share) {
  (void)index;
  (void)share;
  return point->meridian_deg < 10 && point->edge % 2 == 0;
}

/* Points on one line say nothing of what is beside it. */
static void lines_make_no_surface(void **state) {
  (void)state;
  for (int meridians = 1; meridians <= 2; meridians++) {
    fits_eye eye = under_many_edges(meridians);
    placido_fit_options options = {.axis_z_mm = eye.axis_z_mm};
    fits_add_refusal(meridians == 1 ? "all points on one meridian" : "all points on one line",
                     &eye.instrument, &eye.mires, &options, PLACIDO_QUALITY, "");
    fits_eye_free(&eye);
  }
  fits_eye eye = under_many_edges(360);
  placido_mires some = fits_some(&eye, within_10_deg, 0);
  placido_fit *fit = fits_of(&eye, &some, NULL);
  fits_error e = fits_compare(fit, &eye);
  fits_add("ten meridians beside each other", fit, &e, 0, 10, "meridians");
  placido_fit_free(fit);
  placido_mires_free(&some);
  some = (placido_mires){.edge_count = 256, .meridian_count = 360};
  fits_add_refusal("no point at all", &eye.instrument, &some, NULL, PLACIDO_QUALITY,
                   "only 0 edge points");
  fits_eye_free(&eye);
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Fits: what is refused, and what nearly is"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(spoilt_input_is_refused),
      cmocka_unit_test(impossible_options_are_refused),
      cmocka_unit_test(other_sizes_are_measured_or_refused),
      cmocka_unit_test(a_wrong_distance_is_covered_by_its_sigma),
      cmocka_unit_test(a_distance_far_off_is_refused),
      cmocka_unit_test(lines_make_no_surface),
      cmocka_unit_test(the_table_is_good),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
