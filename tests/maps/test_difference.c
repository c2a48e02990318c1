/* Differences: none of an eye with itself, however it was moved in between; a change where one was
 * made; and files that are no exam. */
#include "base/memory.h"
#include "reconstruct/maps/motion.h"
#include "tests/base/scratch.h"
#include "tests/maps/eyes.h"
#include "tests/support/near.h"

#include <placido/difference.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (M_PI / 180)
#define HALF 45

/* A surface as if it had been measured, with the same error bars everywhere. */
static placido_measured measured_of(placido_surface *surface, double sigma_um, double sigma_D) {
  placido_measured m = {.surface = surface, .step_mm = 0.1, .half = HALF, .size = 2 * HALF + 1};
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    m.sigmas[k] = placido_memory_new((size_t)(m.size * m.size), sizeof(double), NULL);
    assert_non_null(m.sigmas[k]);
    for (int i = 0; i < m.size * m.size; i++) {
      m.sigmas[k][i] = k == PLACIDO_DIFFERENCE_ELEVATION ? sigma_um : sigma_D;
    }
  }
  return m;
}

/* An astigmatic eye with a cone, turned by `turn_deg` about the axis and shifted. */
static placido_surface *cone(double x, double y, double turn_deg, double lift_mm, double height) {
  double c = cos(turn_deg * DEGREE), s = sin(turn_deg * DEGREE);
  placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.9, -0.2, 7.6, -0.3, 20 + turn_deg, x, y}},
      {.kind = PLACIDO_PART_BUMP,
       .as.bump = {height, 1.1, 0.9, x + 0.5 * c + 1.2 * s, y + 0.5 * s - 1.2 * c, turn_deg}}};
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, lift_mm, 5, parts, 2, NULL, NULL), PLACIDO_OK);
  return surface;
}

static double rms_of(const placido_difference *difference, enum placido_difference_kind kind) {
  double sum = 0;
  int count = 0;
  for (int k = 0; k < difference->size * difference->size; k++) {
    if (difference->valid[k]) {
      sum += difference->values[kind][k] * difference->values[kind][k];
      count++;
    }
  }
  assert_true(count > 5000);
  return sqrt(sum / count);
}

static void an_eye_does_not_differ_from_itself(void **state) {
  (void)state;
  placido_measured eye = measured_of(cone(0.1, -0.1, 0, 0, 0.03), 0.03, 0.02);
  placido_alignment alignment;
  placido_difference difference;
  assert_int_equal(placido_align(&alignment, &eye, &eye, NULL), PLACIDO_OK);
  for (int k = 0; k < PLACIDO_MOTION_TERMS; k++) {
    assert_near(alignment.terms[k], 0, 1e-12);
    assert_true(alignment.sigmas[k] > 0);
  }
  assert_int_equal(placido_difference_new(&difference, &eye, &eye, &alignment, NULL), PLACIDO_OK);
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    assert_near(rms_of(&difference, (enum placido_difference_kind)k), 0, 1e-8);
  }
  placido_difference_zone zone =
      placido_difference_zone_find(&difference, PLACIDO_DIFFERENCE_AXIAL, 0, 6);
  assert_near(zone.significant, 0, 0);
  assert_int_equal(zone.points, 2821); /* grid points in a disc of 3 mm */
  placido_difference_free(&difference);
  placido_measured_free(&eye);
}

/* A moved copy of analytic parts is the same eye exactly. What the prior holds back is below what a
 * spline leaves. */
static void a_moved_eye_is_brought_back(void **state) {
  (void)state;
  placido_measured eye = measured_of(cone(0, 0, 0, 0, 0.04), 0.03, 0.02);
  double angle = 4 * DEGREE, shift[2] = {0.3, -0.2};
  placido_measured moved = measured_of(cone(shift[0], shift[1], 4, 0.05, 0.04), 0.03, 0.02);
  placido_alignment a;
  placido_difference difference;
  assert_int_equal(placido_align(&a, &eye, &moved, NULL), PLACIDO_OK);
  /* the second is turned back, and what was at the shift comes to the origin */
  assert_near(a.terms[PLACIDO_TORSION], -angle, 1e-4);
  assert_near(a.terms[PLACIDO_SHIFT_X], -shift[0] * cos(angle) - shift[1] * sin(angle), 2e-3);
  assert_near(a.terms[PLACIDO_SHIFT_Y], shift[0] * sin(angle) - shift[1] * cos(angle), 2e-3);
  assert_near(a.terms[PLACIDO_PISTON], -0.05, 1e-4);
  assert_true(a.rms_before_um > 10);
  assert_near(a.rms_um, 0, 5e-3);
  assert_int_equal(placido_difference_new(&difference, &eye, &moved, &a, NULL), PLACIDO_OK);
  assert_near(rms_of(&difference, PLACIDO_DIFFERENCE_ELEVATION), 0, 5e-3);
  assert_near(rms_of(&difference, PLACIDO_DIFFERENCE_AXIAL), 0, 2e-3);
  assert_near(rms_of(&difference, PLACIDO_DIFFERENCE_TANGENTIAL), 0, 5e-3);
  placido_difference_free(&difference);
  placido_measured_free(&eye);
  placido_measured_free(&moved);
}

static void a_mirrored_eye_is_the_other_eye(void **state) {
  (void)state;
  placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.9, -0.2, 7.6, -0.2, 20, 0.1, 0}},
      {.kind = PLACIDO_PART_BUMP, .as.bump = {0.02, 1, 0.8, 0.5, -1, 30}}};
  placido_measured right = measured_of(eye_of(parts, 2), 0.03, 0.02);
  parts[0].as.biconic.axis_deg = 160;
  parts[0].as.biconic.cx = -0.1;
  parts[1].as.bump.x_mm = -0.5;
  parts[1].as.bump.axis_deg = -30;
  placido_measured left = measured_of(eye_of(parts, 2), 0.03, 0.02);
  left.mirrored = true;
  const placido_alignment none = {.aligned = false};
  placido_difference difference;
  assert_int_equal(placido_difference_new(&difference, &right, &left, &none, NULL), PLACIDO_OK);
  for (int k = 0; k < PLACIDO_DIFFERENCES; k++) {
    assert_near(rms_of(&difference, (enum placido_difference_kind)k), 0, 1e-9);
  }
  /* without an alignment the error bars are those of the two */
  int middle = HALF * difference.size + HALF;
  assert_near(difference.sigmas[PLACIDO_DIFFERENCE_AXIAL][middle], 0.02 * sqrt(2), 1e-12);
  placido_difference_free(&difference);
  placido_measured_free(&right);
  placido_measured_free(&left);
}

static void a_cone_that_grew_is_found(void **state) {
  (void)state;
  placido_measured before = measured_of(cone(0, 0, 0, 0, 0.030), 0.03, 0.02);
  placido_measured after = measured_of(cone(0, 0, 0, 0, 0.036), 0.03, 0.02);
  placido_alignment alignment;
  placido_difference difference;
  assert_int_equal(placido_align(&alignment, &before, &after, NULL), PLACIDO_OK);
  assert_int_equal(placido_difference_new(&difference, &before, &after, &alignment, NULL),
                   PLACIDO_OK);
  int steepest = HALF * after.size + HALF + 20;
  const double *values = difference.values[PLACIDO_DIFFERENCE_TANGENTIAL];
  for (int k = 0; k < difference.size * difference.size; k++) {
    /* within a vertex's reach meridians of the two run every way */
    double r = 0.1 * hypot(k % difference.size - HALF, k / difference.size - HALF);
    if (difference.valid[k] && r > 0.7 && values[k] > values[steepest]) {
      steepest = k;
    }
  }
  assert_near((steepest % difference.size - HALF) * 0.1, 0.5, 0.35);
  assert_near((steepest / difference.size - HALF) * 0.1, -1.2, 0.35);
  /* 337.5 h / s² of the 6 µm along the steeper direction is 2.5 D; alignment takes little of it */
  assert_near(values[steepest], 2.1, 0.5);
  assert_true(alignment.chi_square > 100); /* and is told to be no mere movement */
  placido_difference_free(&difference);
  placido_measured_free(&before);
  placido_measured_free(&after);
}

/* A sphere turned about its centre is the same sphere: the heights cannot tell how far, and the
 * sigmas say that they are the prior's. */
static void a_sphere_does_not_tell_its_turn(void **state) {
  (void)state;
  placido_measured ball = measured_of(conicoid_eye(7.8, 0, 0, 0), 0.03, 0.02);
  placido_alignment alignment;
  assert_int_equal(placido_align(&alignment, &ball, &ball, NULL), PLACIDO_OK);
  assert_near(alignment.sigmas[PLACIDO_TORSION], 5 * DEGREE, 1e-3);
  /* a tilt of 3 degrees goes with a shift of R times it, 0.41 mm: the two priors together */
  double turn = 3 * DEGREE, shift = 0.5 / 7.8;
  assert_near(alignment.sigmas[PLACIDO_TILT_X], turn * shift / hypot(turn, shift), 1e-3);
  placido_measured_free(&ball);
}

/* Central differences of the moved height give its moved jet. */
static void a_moved_jet_is_the_jet_of_the_moved_height(void **state) {
  (void)state;
  placido_measured eye = measured_of(cone(0.1, 0.2, 30, 0.1, 0.03), 0.03, 0.02);
  eye.mirrored = true;
  const double terms[PLACIDO_MOTION_TERMS] = {0.2, -0.1, 0.3, 0.05, -0.04, 0.2}, h = 1e-4;
  placido_motion motion = placido_motion_of(terms);
  placido_moved at[9], centre;
  for (int k = 0; k < 9; k++) {
    assert_true(
        placido_moved_at(&at[k], &eye, &motion, 0.7 + (k % 3 - 1) * h, -1.1 + (k / 3 - 1) * h));
  }
  centre = at[4];
  assert_near(centre.jet.sx, -(at[5].z_mm - at[3].z_mm) / (2 * h), 1e-8);
  assert_near(centre.jet.sy, -(at[7].z_mm - at[1].z_mm) / (2 * h), 1e-8);
  assert_near(centre.jet.sxx, -(at[5].z_mm - 2 * centre.z_mm + at[3].z_mm) / (h * h), 1e-6);
  assert_near(centre.jet.syy, -(at[7].z_mm - 2 * centre.z_mm + at[1].z_mm) / (h * h), 1e-6);
  assert_near(centre.jet.sxy, -(at[8].z_mm - at[6].z_mm - at[2].z_mm + at[0].z_mm) / (4 * h * h),
              1e-6);
  placido_measured_free(&eye);
}

static void eyes_without_common_ground_are_refused(void **state) {
  (void)state;
  const unsigned char left[19] = {1, 1, 1, 1, 1, 1}, right[19] = {[13] = 1, 1, 1, 1, 1, 1};
  placido_measured a = measured_of(partly_covered_eye(7.8, left), 0.03, 0.02);
  placido_measured b = measured_of(partly_covered_eye(7.8, right), 0.03, 0.02);
  placido_alignment alignment;
  placido_difference difference;
  placido_error err = {0};
  assert_int_equal(placido_align(&alignment, &a, &b, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "in common"));
  alignment = (placido_alignment){.aligned = false};
  assert_int_equal(placido_difference_new(&difference, &a, &b, &alignment, &err), PLACIDO_QUALITY);
  assert_null(difference.valid);
  placido_measured_free(&a);
  placido_measured_free(&b);
}

static void write_file(void **state, const char *name, const char *text) {
  char *path = scratch_path(state, name);
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0 && fclose(file) == 0);
  free(path);
}

static const char surface_text[] =
    "{\"format\": \"placido-surface/1\", \"radius_mm\": 4.5, \"parts\": [{\"kind\": \"biconic\", "
    "\"r1\": 7.8, \"q1\": 0}]}";

static void an_exam_is_read_back(void **state) {
  char *folder = scratch_path(state, "");
  write_file(state, "surface.json", surface_text);
  write_file(state, "maps.csv", "x_mm,y_mm,valid,sigma_z_um\n-0.1,0,1,0.5\n0,0,1,\n0.2,0.1,1,2\n");
  write_file(state, "maps_sigma.csv",
             "x_mm,sigma_tangential_vertex_D,y_mm,sigma_axial_vertex_D\n0.2,4,0.1,3\n");
  placido_measured m;
  assert_int_equal(placido_measured_load(&m, folder, NULL, NULL), PLACIDO_OK);
  assert_int_equal(m.half, 2);
  assert_near(m.sigmas[PLACIDO_DIFFERENCE_ELEVATION][2 * 5 + 1], 0.5, 0);
  assert_true(isnan(m.sigmas[PLACIDO_DIFFERENCE_ELEVATION][2 * 5 + 2]));
  assert_near(m.sigmas[PLACIDO_DIFFERENCE_ELEVATION][3 * 5 + 4], 2, 0);
  assert_near(m.sigmas[PLACIDO_DIFFERENCE_AXIAL][3 * 5 + 4], 3, 0);
  assert_near(m.sigmas[PLACIDO_DIFFERENCE_TANGENTIAL][3 * 5 + 4], 4, 0);
  placido_measured_free(&m);
  free(folder);
}

static void a_broken_exam_is_refused_with_its_place(void **state) {
  static const struct {
    const char *maps, *said;
  } rows[] = {
      {"", "is empty"},
      {"x_mm,y_mm,valid\n0.1,0,1\n", "sigma_z_um is missing"},
      {"x_mm,y_mm,valid,sigma_z_um\n", "no rows"},
      {"x_mm,y_mm,valid,sigma_z_um\n0.1,0,1,abc\n", ":2: sigma_z_um is no number"},
      {"x_mm,y_mm,valid,sigma_z_um\n0.1,0,1,nan\n", "is no number"},
      {"x_mm,y_mm,valid,sigma_z_um\n0.15,0,1,1\n", "x_mm is no place of the grid"},
      {"x_mm,y_mm,valid,sigma_z_um\n0.1,1e9,1,1\n", "y_mm is no place of the grid"},
      {"x_mm,y_mm,valid,sigma_z_um\n0,,1,1\n", "y_mm is no place of the grid"},
      {"x_mm,y_mm,valid,sigma_z_um\n0.1,0,1,1\n0,0\n", ":3: "},
  };
  char *folder = scratch_path(state, "");
  write_file(state, "surface.json", surface_text);
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
    placido_measured m;
    placido_error err = {0};
    write_file(state, "maps.csv", rows[k].maps);
    assert_int_equal(placido_measured_load(&m, folder, NULL, &err), PLACIDO_INPUT);
    assert_null(m.surface);
    if (!strstr(err.text, rows[k].said) || !strstr(err.text, "maps.csv")) {
      fail_msg("\"%s\" is said, not \"%s\"", err.text, rows[k].said);
    }
  }
  free(folder);
}

#define SCRATCH_TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_eye_does_not_differ_from_itself),
      cmocka_unit_test(a_moved_eye_is_brought_back),
      cmocka_unit_test(a_mirrored_eye_is_the_other_eye),
      cmocka_unit_test(a_cone_that_grew_is_found),
      cmocka_unit_test(a_sphere_does_not_tell_its_turn),
      cmocka_unit_test(a_moved_jet_is_the_jet_of_the_moved_height),
      cmocka_unit_test(eyes_without_common_ground_are_refused),
      SCRATCH_TEST(an_exam_is_read_back),
      SCRATCH_TEST(a_broken_exam_is_refused_with_its_place),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
