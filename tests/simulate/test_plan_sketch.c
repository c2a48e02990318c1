/* The sketch's transfer function against closed forms and brute force, and its bounds against
 * edges whose spread is known. */
#include "eyes.h"
#include "simulate/plan/sketch.h"
#include "simulate/psf/settle.h"

#include <math.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

static const double pi = 3.14159265358979323846;
static const double arcmin_per_mm_D = 3.4377467707849396; /* a milliradian */
static const double rho = 0.05;                           /* of 10^(-rho r²), per mm² */

static double bessel_1(double x) {
  double sum = 0;
  const int steps = 2000; /* of the periodic integrand of Bessel's integral: exact to rounding */
  for (int i = 0; i < steps; i++) {
    double t = pi * (i + 0.5) / steps;
    sum += cos(t - x * sin(t));
  }
  return sum / steps;
}

/* Light spread evenly over a disc. */
static double jinc(double radius_arcmin, double cpd) {
  double x = 2 * pi * cpd / 60 * radius_arcmin;
  return 2 * bessel_1(x) / x;
}

static placido_strokes strokes_of(double defocus_D, bool waves) {
  return (placido_strokes){.defocus_D = defocus_D, .waves = waves};
}

static void dim(placido_strokes *strokes, const placido_sketch *sketch) {
  double sum = 0;
  for (int i = 0; i < sketch->rays.count; i++) {
    double x = (double)sketch->rays.x_mm[i], y = (double)sketch->rays.y_mm[i];
    strokes->weight[i] = (float)pow(10, -rho * (x * x + y * y));
    sum += (double)(sketch->rays.weight[i] * strokes->weight[i]);
  }
  for (int i = 0; i < sketch->rays.count; i++) {
    strokes->weight[i] /= (float)sum;
  }
  strokes->dims = true;
}

/* Every direction: the blur of a defocused pupil is round. Where it has waned little is wrong by
 * much; where it is below a twentieth, within the noise of 108 rays. */
static void defocus_makes_a_disc(void **state) {
  (void)state;
  const double pupils_mm[] = {2, 4, 7}, defoci_D[] = {0.1, 0.5, -2};
  placido_sketch sketch;
  placido_sketch_otf otf;
  for (int p = 0; p < 3; p++) {
    for (int d = 0; d < 3; d++) {
      const placido_strokes strokes = strokes_of(defoci_D[d], false);
      double radius_arcmin = pupils_mm[p] / 2 * fabs(defoci_D[d]) * arcmin_per_mm_D;
      placido_sketch_disc(&sketch, pupils_mm[p]);
      placido_sketch_transfer(&otf, &sketch, &strokes);
      for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
        double truth = jinc(radius_arcmin, placido_sketch_frequency_cpd(k));
        for (int direction = 0; direction < PLACIDO_SKETCH_DIRECTIONS; direction++) {
          double off = fabs((double)otf.re[0][direction][k] - truth);
          assert_true(off < (fabs(truth) > 0.1 ? 0.002 : 0.05));
          assert_true(fabs((double)otf.im[0][direction][k]) < 0.001);
        }
      }
    }
  }
}

/* Goodman, Introduction to Fourier Optics, 6.4: (2 / pi) (acos v - v sqrt(1 - v²)). */
static void a_perfect_pupil_is_limited_by_diffraction(void **state) {
  (void)state;
  const double pupil_mm = 3, wavelength_nm = 555;
  placido_sketch sketch;
  placido_sketch_otf otf;
  const placido_strokes strokes = strokes_of(0, true);
  placido_sketch_disc(&sketch, pupil_mm);
  placido_sketch_transfer(&otf, &sketch, &strokes);
  for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
    double v = placido_sketch_frequency_cpd(k) * 180 / pi * wavelength_nm * 1e-6 / pupil_mm;
    double truth = v < 1 ? 2 / pi * (acos(v) - v * sqrt(1 - v * v)) : 0;
    assert_true(fabs((double)otf.re[0][1][k] - truth) < 1e-5);
  }
}

/* The overlap of a pupil's field with itself shifted along x, by summing a fine grid. */
static double overlap(double pupil_mm, double shift_mm, double defocus_D, double wavelength_nm,
                      bool dims, double *phase_im) {
  const int n = 400;
  double re = 0, im = 0, light = 0, radius = pupil_mm / 2, step = pupil_mm / n;
  for (int row = 0; row < n; row++) {
    for (int column = 0; column < n; column++) {
      double x = (column + 0.5) * step - radius, y = (row + 0.5) * step - radius;
      double left = x - shift_mm / 2, right = x + shift_mm / 2;
      double a = dims ? pow(10, -rho / 2 * (left * left + y * y)) : 1;
      double b = dims ? pow(10, -rho / 2 * (right * right + y * y)) : 1;
      double own = dims ? pow(10, -rho * (x * x + y * y)) : 1;
      light += x * x + y * y <= radius * radius ? own : 0;
      if (left * left + y * y <= radius * radius && right * right + y * y <= radius * radius) {
        double opd_um = 0.5 * defocus_D * (right * right - left * left);
        double phase = -2 * pi * opd_um * 1e3 / wavelength_nm;
        re += a * b * cos(phase);
        im += a * b * sin(phase);
      }
    }
  }
  *phase_im = im / light;
  return re / light;
}

/* Waves of a dimmed, defocused pupil against that overlap. The sketch replaces the difference of
 * the wavefront by its slope, which for defocus is the same; what is left is 108 rays' share of a
 * rim. */
static void dimmed_waves_overlap(void **state) {
  (void)state;
  const double cases[][3] = {{2, 0, 1}, {4, 0, 1}, {4, 0.2, 0}, {6, 0.1, 1}, {3, 0.4, 1}};
  placido_sketch sketch;
  placido_sketch_otf otf;
  for (int i = 0; i < 5; i++) {
    placido_strokes strokes = strokes_of(cases[i][1], true);
    placido_sketch_disc(&sketch, cases[i][0]);
    if (cases[i][2] > 0) {
      dim(&strokes, &sketch);
    }
    placido_sketch_transfer(&otf, &sketch, &strokes);
    for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k += 2) {
      double im, shift_mm = placido_sketch_frequency_cpd(k) * 180 / pi * 555e-6;
      double re = overlap(cases[i][0], shift_mm, cases[i][1], 555, cases[i][2] > 0, &im);
      assert_true(fabs((double)otf.re[0][0][k] - re) < 0.02);
    }
  }
}

/* Dimmed rays: a sum over the pupil of their weights and phases. */
static void dimmed_rays_count_less(void **state) {
  (void)state;
  const double pupil_mm = 6, defocus_D = 0.3;
  const int n = 400;
  placido_sketch sketch;
  placido_sketch_otf otf;
  placido_strokes strokes = strokes_of(defocus_D, false);
  placido_sketch_disc(&sketch, pupil_mm);
  dim(&strokes, &sketch);
  placido_sketch_transfer(&otf, &sketch, &strokes);
  for (int k = 0; placido_sketch_frequency_cpd(k) < 20; k++) {
    double sum = 0, light = 0;
    for (int i = 0; i < n * n; i++) {
      double x = (i % n + 0.5) * pupil_mm / n - pupil_mm / 2;
      double y = ((i - i % n) / n + 0.5) * pupil_mm / n - pupil_mm / 2;
      if (x * x + y * y <= pupil_mm * pupil_mm / 4) {
        double weight = pow(10, -rho * (x * x + y * y));
        double angle = x * defocus_D * arcmin_per_mm_D;
        sum += weight * cos(2 * pi * placido_sketch_frequency_cpd(k) / 60 * angle);
        light += weight;
      }
    }
    assert_true(fabs((double)otf.re[0][0][k] - sum / light) < 0.002); /* the grid's own rim */
  }
}

/* Two colours beside each other: the cosine of their distance. More power goes where its shift
 * says. */
static void waves_shift_with_their_power(void **state) {
  (void)state;
  const double apart_arcmin = 3;
  placido_sketch sketch;
  placido_sketch_otf otf;
  placido_strokes strokes = {.lights = 1, .shift_x_arcmin = 1};
  placido_sketch_disc(&sketch, 0.1); /* so small that power does not blur */
  strokes.light[0].count = 2;
  strokes.light[0].waves[0] = (placido_wave){.wavelength_nm = 500, .weight = 0.5, .defocus_D = 1};
  strokes.light[0].waves[1] = (placido_wave){
    .wavelength_nm = 600, .weight = 0.5, .defocus_D = -1, .x_arcmin = 2 - apart_arcmin};
  placido_sketch_transfer(&otf, &sketch, &strokes);
  for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
    /* at 1' and -2': about their middle */
    double cycles = placido_sketch_frequency_cpd(k) / 60;
    double truth = cos(pi * cycles * apart_arcmin) * jinc(0.05 * arcmin_per_mm_D, 60 * cycles);
    double re = truth * cos(pi * cycles), im = -truth * sin(pi * cycles);
    assert_true(fabs((double)otf.re[0][0][k] - re) < 0.003);
    assert_true(fabs((double)otf.im[0][0][k] - im) < 0.003);
  }
}

static void an_aperture_averages(void **state) {
  (void)state;
  placido_sketch sketch;
  placido_sketch_otf otf;
  const placido_strokes strokes = {.aperture_arcmin = 2};
  placido_sketch_disc(&sketch, 4);
  placido_sketch_transfer(&otf, &sketch, &strokes);
  for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
    double turns = pi * placido_sketch_frequency_cpd(k) / 30;
    assert_true(fabs((double)otf.re[0][0][k] - sin(turns) / turns) < 1e-5);
  }
}

/* A traced sketch has the second moments of the eye's own spread. */
static void it_is_the_eye_that_is_traced(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(30);
  const placido_eye eye = {.pupil_mm = 4, .correct = PLACIDO_CORRECT_FULL};
  const placido_optics optics = {.bucket_arcmin = 0.25, .grow = 8};
  placido_eye found;
  placido_sketch sketch;
  double fixation_mm[2], sum[5] = {0};
  assert_int_equal(placido_psf_settle(&found, fixation_mm, surface, &eye, NULL, NULL), PLACIDO_OK);
  assert_true(placido_sketch_trace(&sketch, surface, &found, fixation_mm));
  placido_psf psf = psf_of(surface, &eye, &optics);
  moments m = moments_of(&psf);
  for (int i = 0; i < sketch.rays.count; i++) {
    double x = (double)sketch.rays.angle_x[i], y = (double)sketch.rays.angle_y[i];
    double weight = (double)sketch.rays.weight[i];
    sum[0] += weight * x;
    sum[1] += weight * y;
    sum[2] += weight * x * x;
    sum[3] += weight * x * y;
    sum[4] += weight * y * y;
  }
  double bucket = 0.25 * 0.25 / 12;
  assert_true(fabs(sum[2] - sum[0] * sum[0] + bucket - m.cc) < 0.03 * m.cc);
  assert_true(fabs(sum[4] - sum[1] * sum[1] + bucket - m.rr) < 0.03 * m.rr);
  assert_true(fabs(psf.retina_mm - found.retina_mm) == 0);
  assert_true(found.correction.j0_D == psf.correction.j0_D && found.correct == 0);
  placido_psf_free(&psf);
  placido_surface_free(surface);
}

/* Rays beside the surface are left out, and the others have all the light. */
static void rays_may_be_missing(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26);
  placido_eye eye = {.pupil_mm = 6, .pupil_x_mm = 2.5, .index = PLACIDO_EYE_INDEX, .retina_mm = 30};
  const double fixation_mm[2] = {0, 0};
  placido_sketch sketch;
  double sum = 0;
  assert_true(placido_sketch_trace(&sketch, surface, &eye, fixation_mm));
  assert_in_range(sketch.rays.count, 50, PLACIDO_SKETCH_RAYS - 1);
  for (int i = 0; i < sketch.rays.count; i++) {
    sum += (double)sketch.rays.weight[i];
    assert_true(isfinite(sketch.rays.angle_x[i]) && isfinite(sketch.rays.angle_y[i]));
  }
  assert_true(fabs(sum - 1) < 1e-5);
  eye.pupil_x_mm = 6;
  assert_false(placido_sketch_trace(&sketch, surface, &eye, fixation_mm));
  placido_surface_free(surface);
}

/* How much of an even disc of radius 1 lies left of x. */
static double disc_left_of(double x) {
  double t = fmin(fmax(x, -1), 1);
  return 0.5 + (t * sqrt(1 - t * t) + asin(t)) / pi;
}

/* Black beside white through two discs of blur: how much the pictures differ at most. */
static double edges_differ(double a_arcmin, double b_arcmin) {
  double most = 0;
  for (double x = 0; x < 40; x += 0.01) {
    most = fmax(most, fabs(disc_left_of(x / a_arcmin) - disc_left_of(x / b_arcmin)));
  }
  return most;
}

static void an_edge_differs_by_no_more_than_the_bound(void **state) {
  (void)state;
  const double pairs_D[][2] = {{0.3, 0.31}, {0.3, 0.4}, {0.5, 1}, {1, 1.02}, {2, 4}, {0.15, 0.16}};
  const placido_facts facts = {.planes = 1, .brightest = {1}, .step = {1}};
  const placido_sketch_scale scale = {0.5, 0.5};
  placido_sketch sketch;
  placido_sketch_disc(&sketch, 4);
  for (int i = 0; i < 6; i++) {
    placido_sketch_otf one, other;
    const placido_strokes a = strokes_of(pairs_D[i][0], false);
    const placido_strokes b = strokes_of(pairs_D[i][1], false);
    placido_sketch_transfer(&one, &sketch, &a);
    placido_sketch_transfer(&other, &sketch, &b);
    double truth = edges_differ(2 * arcmin_per_mm_D * pairs_D[i][0],
                                2 * arcmin_per_mm_D * pairs_D[i][1]);
    double bound = placido_sketch_bound(&one, &other, &facts, &scale);
    assert_true(bound >= truth);
    assert_true(bound <= fmin(12 * truth, 1)); /* edges crowd, gratings are worse (bound.c) */
  }
}

/* The bound follows the scene: no step, no difference; a shallow slope, less; bright light, white
 * at most. */
static void the_bound_is_of_the_scene(void **state) {
  (void)state;
  placido_facts facts = {.planes = 1, .brightest = {1}, .step = {1}};
  const placido_sketch_scale scale = {0.5, 0.5};
  const placido_strokes a = strokes_of(0.3, false), b = strokes_of(0.35, false);
  placido_sketch sketch;
  placido_sketch_otf one, other;
  placido_sketch_disc(&sketch, 4);
  placido_sketch_transfer(&one, &sketch, &a);
  placido_sketch_transfer(&other, &sketch, &b);
  double steep = placido_sketch_bound(&one, &other, &facts, &scale);
  assert_true(placido_sketch_bound(&one, &one, &facts, &scale) == 0);
  facts.step[0] = 0.01;
  double shallow = placido_sketch_bound(&one, &other, &facts, &scale);
  assert_true(shallow > 0 && shallow < 0.5 * steep);
  facts.brightest[0] = 1e4;
  facts.step[0] = 1e4;
  assert_true(placido_sketch_bound(&one, &other, &facts, &scale) == 1);
  facts.darkest[0] = facts.brightest[0];
  facts.step[0] = 0;
  assert_true(placido_sketch_bound(&one, &other, &facts, &scale) == 0);
}

/* Each colour has its own light and its own steps: the worst counts. */
static void the_worst_light_counts(void **state) {
  (void)state;
  placido_facts facts = {.planes = 3, .brightest = {1, 1, 1}, .step = {1, 1, 1}};
  const placido_sketch_scale scale = {0.5, 0.5};
  placido_strokes one_D = {.lights = 1}, three_D = {.lights = 3};
  placido_sketch sketch;
  placido_sketch_otf one, three;
  const placido_wave plain = {.wavelength_nm = 555, .weight = 1, .defocus_D = 0.2};
  one_D.light[0] = (placido_sketch_light){1, {plain}};
  for (int light = 0; light < 3; light++) {
    three_D.light[light] = one_D.light[0];
  }
  three_D.light[2].waves[0].defocus_D = -0.6;
  placido_sketch_disc(&sketch, 4);
  placido_sketch_transfer(&one, &sketch, &one_D);
  placido_sketch_transfer(&three, &sketch, &three_D);
  double worst = placido_sketch_bound(&one, &three, &facts, &scale);
  facts.brightest[2] = facts.step[2] = 0; /* no blue at all */
  assert_true(worst > 0.1 && placido_sketch_bound(&one, &three, &facts, &scale) == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(defocus_makes_a_disc),
    cmocka_unit_test(a_perfect_pupil_is_limited_by_diffraction),
    cmocka_unit_test(dimmed_waves_overlap),
    cmocka_unit_test(dimmed_rays_count_less),
    cmocka_unit_test(waves_shift_with_their_power),
    cmocka_unit_test(an_aperture_averages),
    cmocka_unit_test(it_is_the_eye_that_is_traced),
    cmocka_unit_test(rays_may_be_missing),
    cmocka_unit_test(an_edge_differs_by_no_more_than_the_bound),
    cmocka_unit_test(the_bound_is_of_the_scene),
    cmocka_unit_test(the_worst_light_counts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
