/* The Stiles-Crawford effect on the blur of a perfect eye out of focus: there a ray's place on the
 * retina tells its place in the pupil, so that what each counts can be read off. */
#include "eyes.h"
#include "simulate/effects/effect.h"
#include "simulate/plan/run.h"
#include "simulate/quality/disc.h"
#include "tests/support/near.h"

#include <string.h>

static const double index_behind = 4.0 / 3, radius_mm = 7.8, pupil_mm = 6;
static const double arcmin = 3.14159265358979323846 / 10800;

/* The ellipsoid's exact focus, and a retina 3 D in front of it: blur of 31' to all sides. */
static double focus_mm(void) { return index_behind * radius_mm / (index_behind - 1); }
static double retina_mm(void) {
  return 1000 * index_behind / (1000 * index_behind / focus_mm() + 3);
}

static double q(void) { return -1 / (index_behind * index_behind); }

/* Where a ray at r from the axis is seen: straight from the surface to the focus. */
static double seen_arcmin(double r_mm) {
  double sag = r_mm * r_mm / (radius_mm + sqrt(radius_mm * radius_mm - (1 + q()) * r_mm * r_mm));
  double landed_mm = r_mm * (focus_mm() - retina_mm()) / (focus_mm() - sag);
  return landed_mm / (retina_mm() - radius_mm) / arcmin;
}

/* A dark scene: all that matters is the spread. */
static placido_psf spread_with(const placido_effect *effect) {
  placido_surface *surface = conic(radius_mm, q());
  placido_scene scene = {.name = "dark", .arcmin_per_px = 0.5, .bits = 8,
                         .conditions = {.luminance_cd_m2 = NAN, .distance_m = INFINITY,
                                        .wavelength_nm = NAN, .tolerance = 0.01}};
  assert_int_equal(placido_image_new(&scene.image, 32, 32, 1, NULL), PLACIDO_OK);
  placido_facts facts;
  assert_int_equal(placido_facts_find(&facts, &scene, NULL), PLACIDO_OK);
  const placido_plan_settings settings = {.pupil_samples = 400, .wavelengths = 1, .layers = 1,
                                          .nodes = 1, .bucket_arcmin = 0.5, .buckets = 257};
  const placido_eye eye = {.pupil_mm = pupil_mm, .index = index_behind,
                           .retina_mm = retina_mm(), .age_years = 35};
  const placido_run run = {.surface = surface, .scene = &scene, .facts = &facts,
                           .settings = &settings, .eye = &eye, .effects = &effect,
                           .count = effect != NULL ? 1 : 0, .threads = 1};
  placido_image seen;
  placido_psf psf;
  placido_error err = {.text = ""};
  if (placido_view_run(&seen, &psf, &run, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_surface_free(surface);
  return psf;
}

/* Share of the light within so far of its middle, buckets on the rim by their part inside. Where
 * the point of fixation lies in an even blur is not told. */
static double light_within(const placido_psf *psf, double radius_arcmin) {
  const moments middle = moments_of(psf);
  double sum = 0, step = psf->bucket_arcmin;
  for (int row = 0; row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      double x = (column - psf->n / 2 - 0.5) * step - middle.column;
      double y = (row - psf->n / 2 - 0.5) * step - middle.row;
      sum += psf->values[row * psf->n + column] *
             placido_disc_area(radius_arcmin, x, x + step, y, y + step) / (step * step);
    }
  }
  return sum;
}

/* Between 0 and r the rays count 2 pi times the integral of 10^(-rho r²) r. */
static double counted(double r_mm) { return 1 - pow(10, -0.05 * r_mm * r_mm); }

static void blur_dims_towards_its_rim(void **state) {
  (void)state;
  placido_psf psf = spread_with(&placido_effect_stiles_crawford);
  for (double r_mm = 0.5; r_mm < 3; r_mm += 0.5) {
    /* samples stand for directions at the retina, 1 % from where rays pass the pupil */
    assert_near(light_within(&psf, seen_arcmin(r_mm)), counted(r_mm) / counted(3), 4e-3);
  }
  placido_psf_free(&psf);
}

/* Without it, light within r is the area. */
static void rays_count_alike_without_it(void **state) {
  (void)state;
  placido_psf psf = spread_with(NULL);
  for (double r_mm = 0.5; r_mm < 3; r_mm += 0.5) {
    assert_near(light_within(&psf, seen_arcmin(r_mm)), r_mm * r_mm / 9, 2e-3); /* buckets */
  }
  placido_psf_free(&psf);
}

/* The effect keeps to the cornea where the pupil is off its middle: factors over the sketch's rays
 * tell the place, and their weighted mean is 1. */
static void sketch_is_dimmed_around_the_corneal_axis(void **state) {
  (void)state;
  const placido_eye eye = {.pupil_mm = 4, .pupil_x_mm = 0.4, .pupil_y_mm = -0.3};
  placido_sketch_rays rays = {.count = 3, .x_mm = {-0.4f, 1.6f, 0}, .y_mm = {0.3f, 0.3f, 0},
                              .weight = {0.5f, 0.25f, 0.25f}};
  placido_strokes strokes = {.dims = false};
  placido_answer answer = {.strokes = &strokes};
  const placido_question question = {.eye = &eye, .rays = &rays};
  placido_effect_stiles_crawford.ask(&question, &answer);
  const float *weight = strokes.weight;
  assert_true(answer.applies && strokes.dims);
  /* the first ray is on the axis, the second 2 mm, the third 0.5 mm off; factors are floats */
  assert_near((double)(weight[1] / weight[0]), pow(10, -0.05 * 4), 1e-6);
  assert_near((double)(weight[2] / weight[0]), pow(10, -0.05 * 0.25), 1e-6);
  assert_near(0.5 * (double)weight[0] + 0.25 * (double)(weight[1] + weight[2]), 1, 1e-6);
  /* 10^(-0.05 × 2.5²) at the rim's far side */
  assert_non_null(strstr(answer.reason, "4 mm light counts 49 %"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(blur_dims_towards_its_rim),
    cmocka_unit_test(rays_count_alike_without_it),
    cmocka_unit_test(sketch_is_dimmed_around_the_corneal_axis),
  };
  return cmocka_run_group_tests_name("effect_stiles_crawford", tests, NULL, NULL);
}
