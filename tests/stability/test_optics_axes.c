/* Cylinders that are none, and axes where they have their edge: at 0 and 180 degrees, and where a
 * lens is moved until its focus is on the way.
 *
 * A path from the cornea to the focus is of L = n f micrometres and rounds, depth, square root and
 * products, within 4 epsilon L; so does a Zernike term, whose weights sum to less than 1. */
#include "tests/simulate/eyes.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"
#include "tests/support/named_figure.h"

#include <placido/index.h>

#include <float.h>
#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double index_behind = PLACIDO_EYE_INDEX;

static placido_wavefront wavefront_of(const placido_surface *surface, double pupil_mm) {
  const placido_eye eye = {.pupil_mm = pupil_mm};
  placido_wavefront w;
  placido_error err = {0};
  if (placido_wavefront_new(&w, surface, &eye, NULL, NULL, &err) != PLACIDO_OK) {
    fail_msg("pupil of %g mm: %s", pupil_mm, err.text);
  }
  return w;
}

static double longest_um(double radius_mm) {
  return 1e3 * index_behind * index_behind * radius_mm / (index_behind - 1);
}

/* A cylinder of nothing is exactly none, whatever rounding has left of it, and has no axis. */
static void round_corneas_have_no_axis(void **state) {
  (void)state;
  const double radii_mm[] = {5, 7.8, 12};
  const double asphericities[] = {-1 / (index_behind * index_behind), -0.26, 0};
  const double pupils_mm[] = {0.1, 0.3, 1, 4, 8};
  for (int k = 0; k < 9; k++) {
    double radius_mm = radii_mm[k / 3], q = asphericities[k % 3], most_D = 0;
    placido_surface *surface = conic(radius_mm, q);
    for (int i = 0; i < 5; i++) {
      placido_wavefront w = wavefront_of(surface, pupils_mm[i]);
      most_D = fmax(most_D, fabs(named_figure(&w, "cylinder_D")));
      assert_true(isnan(named_figure(&w, "axis_deg")));
      assert_true(isnan(named_figure(&w, "coma_axis_deg")));
      placido_wavefront_free(&w);
    }
    case_bounded(&(struct bounded){NAN, 4 * DBL_EPSILON * longest_um(radius_mm), "um", most_D, "D",
                                   0},
                 "wavefront of R %g mm, Q %.2f: cylinder", radius_mm, q);
    placido_surface_free(surface);
  }
}

static void round_corneas_need_no_cylinder(void **state) {
  (void)state;
  const double pupils_mm[] = {0.3, 4, 8};
  for (int i = 0; i < 3; i++) {
    placido_surface *surface = conic(7.8, -0.26);
    placido_eye eye = settled_eye(
      surface, (placido_eye){.pupil_mm = pupils_mm[i], .correct = PLACIDO_CORRECT_FULL});
    double sphere_D, cylinder_D, axis_deg;
    placido_correction_clinical(&eye.correction, &sphere_D, &cylinder_D, &axis_deg);
    assert_true(isnan(axis_deg) && !signbit(cylinder_D));
    case_bounded(&(struct bounded){NAN, NAN, NULL, fabs(cylinder_D), "D", 0},
                 "lens for a pupil of %g mm: cylinder", pupils_mm[i]);
    placido_surface_free(surface);
  }
}

static double simk_axis_deg(const placido_surface *surface) {
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count;
  assert_int_equal(placido_indices_find(values, &count, surface, NULL, NULL), PLACIDO_OK);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, "simk_flat_axis_deg") == 0) {
      return values[i].value;
    }
  }
  fail_msg("no SimK");
  return NAN;
}

static double apart_deg(double a, double b) { return fabs(remainder(a - b, 180)); }

/* Axes on either side of where they begin again, and between. */
static const double axes_deg[] = {0,           1e-6,  179.999999, 180 - 1e-6 / 3, 45,
                                  90 - 1e-6, 90, 90 + 1e-6,  135.7};

enum { AXES = sizeof axes_deg / sizeof *axes_deg };

/* axis = atan2(c2-2, c22) / 2: an error of c in either turns it by 1 / (2 |c|). A surface's axis is
 * known to epsilon of a turn. */
static void wavefront_axes_have_no_edge(void **state) {
  (void)state;
  const struct {
    double steep_mm, pupil_mm;
    const char *name;
  } eyes[] = {{7.5, 4, "2.4 D"}, {7.5, 0.3, "2.4 D, 0.3 mm"}, {7.9 * (1 - 1e-9), 4, "4e-8 D"}};
  for (int k = 0; k < 3; k++) {
    double worst_deg = 0, bound_deg = 0, condition = 0;
    for (int i = 0; i < AXES; i++) {
      placido_surface *surface = toric(7.9, eyes[k].steep_mm, -0.2, axes_deg[i]);
      placido_wavefront w = wavefront_of(surface, eyes[k].pupil_mm);
      double axis_deg = named_figure(&w, "axis_deg");
      double size_um = hypot(w.coefficients_um[3], w.coefficients_um[5]);
      assert_true(axis_deg >= 0 && axis_deg < 180);
      worst_deg = fmax(worst_deg, apart_deg(axis_deg, axes_deg[i]));
      condition = longest_um(7.9) / (2 * size_um) * 180 / pi;
      bound_deg = 4 * DBL_EPSILON * condition + 180 * DBL_EPSILON;
      placido_wavefront_free(&w);
      placido_surface_free(surface);
    }
    case_bounded(&(struct bounded){condition, 4 * DBL_EPSILON, NULL, worst_deg, "deg", bound_deg},
                 "wavefront's axis, 0 to 180, %s", eyes[k].name);
  }
}

/* The search ends within 0.002 D of either component, which turns J by as much over its size; half
 * of that is the axis. */
static void lenses_axes_have_no_edge(void **state) {
  (void)state;
  double worst_deg = 0, size_D = 1;
  for (int i = 0; i < AXES; i++) {
    placido_surface *surface = toric(7.9, 7.5, -0.2, axes_deg[i]);
    placido_eye eye =
      settled_eye(surface, (placido_eye){.pupil_mm = 4, .correct = PLACIDO_CORRECT_FULL});
    double sphere_D, cylinder_D, axis_deg;
    placido_correction_clinical(&eye.correction, &sphere_D, &cylinder_D, &axis_deg);
    size_D = hypot(eye.correction.j0_D, eye.correction.j45_D);
    assert_true(axis_deg >= 0 && axis_deg < 180);
    worst_deg = fmax(worst_deg, apart_deg(axis_deg, axes_deg[i]));
    placido_surface_free(surface);
  }
  double condition = 90 / pi / size_D;
  case_bounded(&(struct bounded){condition, 0.002, "D", worst_deg, "deg",
                                 sqrt(2) * 0.002 * condition},
               "lens's axis, 0 to 180, 2.4 D");
}

/* The flattest of 128 diameters by a parabola: of a cosine of twice the angle, sampled every h = 2
 * pi / 128, the parabola's top is off by h³ / 62.4 at most, half of it in angle. Snell's cosine
 * has a second harmonic of C / 2 P, 0.03, whose fourth derivative is 16 times as large: another
 * half, taken as much again. */
static void simk_axes_have_no_edge(void **state) {
  (void)state;
  double h = 2 * pi / 128, worst_deg = 0;
  for (int i = 0; i < AXES; i++) {
    placido_surface *surface = toric(7.9, 7.5, -0.2, axes_deg[i]);
    double axis_deg = simk_axis_deg(surface);
    assert_true(axis_deg >= 0 && axis_deg < 180);
    worst_deg = fmax(worst_deg, apart_deg(axis_deg, axes_deg[i]));
    placido_surface_free(surface);
  }
  case_bounded(&(struct bounded){NAN, 180.0 / 128, "deg", worst_deg, "deg",
                                 2 * h * h * h / 62.4 / 2 * 180 / pi},
               "SimK's axis, 0 to 180, 2.4 D");
  const double radii_mm[] = {5, 7.8, 12};
  for (int i = 0; i < 3; i++) {
    placido_surface *surface = conic(radii_mm[i], -0.26);
    assert_true(isnan(simk_axis_deg(surface)));
    placido_surface_free(surface);
  }
}

/* 1 - d F, of d in metres: d and d F round, which counts by dF / (1 - d F), then the difference and
 * the quotient round. */
static void lenses_move_until_their_focus_is_reached(void **state) {
  (void)state;
  const double nearer_mm = 12, u = DBL_EPSILON / 2;
  placido_error err = {0};
  for (int k = 2; k <= 50; k += 16) {
    double left = ldexp(1, -k), power_D = 1000 / nearer_mm * (1 - left);
    const placido_correction worn = {.m_D = power_D};
    placido_correction moved, back;
    assert_int_equal(placido_correction_move(&moved, &worn, nearer_mm, NULL), PLACIDO_OK);
    long double over = 1 - (long double)nearer_mm * (long double)power_D / 1000;
    double condition = (double)(1 / over);
    double change = (double)fabsl((long double)moved.m_D * over / (long double)power_D - 1);
    case_bounded(&(struct bounded){condition, u, NULL, change, NULL, u * (2 * condition + 2)},
                 "lens moved 12 mm, 1 - d F = 2^-%d", k);
    assert_true(moved.j0_D == 0 && moved.j45_D == 0); /* a sphere stays one */
    /* The way back has 1 + d F' of the moved lens, where nothing cancels: the first way's error is
     * shrunk again by as much as it grew. */
    assert_int_equal(placido_correction_move(&back, &moved, -nearer_mm, NULL), PLACIDO_OK);
    case_bounded(&(struct bounded){1, u, NULL, fabs(back.m_D / power_D - 1), NULL, 8 * u},
                 "there and back, 1 - d F = 2^-%d", k);
  }
  const double beyond_D[] = {1000 / 12.0 * (1 + 2 * DBL_EPSILON), 100};
  for (int i = 0; i < 2; i++) {
    const placido_correction worn = {.m_D = beyond_D[i]};
    placido_correction moved;
    int status = placido_correction_move(&moved, &worn, nearer_mm, &err);
    case_refused(status, PLACIDO_INPUT, &err, "its focus lies in between", "lens of %+.3f D moved",
                 beyond_D[i]);
    assert_true(isnan(moved.m_D) && isnan(moved.j0_D));
  }
}

static void the_table_is_good(void **state) {
  (void)state;
  assert_int_equal(stability_print("Optics: cylinder and axis"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(round_corneas_have_no_axis),
    cmocka_unit_test(round_corneas_need_no_cylinder),
    cmocka_unit_test(wavefront_axes_have_no_edge),
    cmocka_unit_test(lenses_axes_have_no_edge),
    cmocka_unit_test(simk_axes_have_no_edge),
    cmocka_unit_test(lenses_move_until_their_focus_is_reached),
    cmocka_unit_test(the_table_is_good)};
  return cmocka_run_group_tests_name("stability_optics_axes", tests, NULL, NULL);
}
