/* Light spread: nodes, layers, lights and holes, each against sums made pixel by pixel. */
#include "base/memory.h"
#include "eyes.h"
#include "planes.h"
#include "simulate/plan/run.h"
#include "simulate/psf/slopes.h"
#include "tests/support/near.h"

#include <placido/simulate.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 45, HEIGHT = 37, AREA = WIDTH * HEIGHT, BUCKETS = 31, PSF = BUCKETS * BUCKETS };

static const double arcmin_rad = 2.908882086657216e-4;
static const double pi = 3.14159265358979323846;
static const double step = 3; /* arcmin, of pixels and buckets */

/* What the one effect of these tests does to the view. */
static void (*changing)(placido_view *view);

static int apply(void *state, placido_view *view, placido_error *err) {
  (void)state;
  (void)err;
  changing(view);
  return PLACIDO_OK;
}

static const placido_effect effect = {
  .name = "test", .stage = PLACIDO_STAGE_FIELD, .apply = apply};
static const placido_effect *const effects[] = {&effect};

static const placido_plan_settings settings = {.pupil_samples = 80,
                                               .wavelengths = 1,
                                               .layers = 2,
                                               .nodes = 1,
                                               .bucket_arcmin = 3,
                                               .buckets = BUCKETS};

/* Samples that look random; free with placido_scene_free. */
static placido_scene noise_scene(int planes) {
  placido_scene scene = {.name = "noise", .arcmin_per_px = step, .bits = 8};
  scene.conditions.distance_m = INFINITY;
  assert_int_equal(placido_image_new(&scene.image, WIDTH, HEIGHT, planes, NULL), PLACIDO_OK);
  float *noise = noise_plane(WIDTH, HEIGHT * planes, 7);
  memcpy(scene.image.data, noise, sizeof *noise * AREA * (size_t)planes);
  free(noise);
  return scene;
}

/* An eye whose spread differs much over the field: irregular, wide open, its retina given. */
static placido_eye wide_eye(void) {
  return (placido_eye){.pupil_mm = 6, .index = PLACIDO_EYE_INDEX, .retina_mm = 29};
}

/* What `how` makes of a view, run. */
static placido_image see(const placido_surface *surface, const placido_eye *eye,
                         const placido_scene *scene, void (*how)(placido_view *view), int threads,
                         placido_psf *psf) {
  changing = how;
  const placido_run run = {.surface = surface,
                           .scene = scene,
                           .settings = &settings,
                           .eye = eye,
                           .effects = effects,
                           .count = how != NULL ? 1 : 0,
                           .threads = threads};
  placido_image seen;
  placido_error err = {0};
  if (placido_view_run(&seen, psf, &run, &err) != PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return seen;
}

/* The spread of some waves from a direction; `values` has room for PSF. */
static placido_psf spread_of(double *values, const placido_surface *surface,
                             const placido_eye *eye, const double field_deg[2],
                             const placido_ocular *ocular, const placido_wave *waves,
                             size_t count) {
  const placido_window window = {.buckets = BUCKETS, .bucket_arcmin = step};
  double offset_arcmin[2];
  placido_pupil pupil;
  assert_int_equal(placido_ocular_fixation(offset_arcmin, surface, eye, ocular, NULL), PLACIDO_OK);
  assert_int_equal(placido_ocular_pupil(&pupil, surface, eye, ocular, field_deg, offset_arcmin, 0,
                                        settings.pupil_samples, 1, NULL),
                   PLACIDO_OK);
  assert_int_equal(placido_slopes(values, NULL, &pupil, waves, count, &window, NULL), PLACIDO_OK);
  placido_pupil_free(&pupil);
  return (placido_psf){.n = BUCKETS, .bucket_arcmin = step, .values = values};
}

/* The same of one wave, moved so that its centroid is where it is on the axis: twice, as a spread that
 * is moved loses other light beyond the window. */
static placido_psf spread_straight(double *values, const placido_surface *surface,
                                   const placido_eye *eye, const double field_deg[2],
                                   const placido_ocular *ocular) {
  static double middle_values[PSF];
  const double axis_deg[2] = {0, 0};
  placido_wave wave = {.wavelength_nm = 555, .weight = 1};
  placido_psf psf = spread_of(middle_values, surface, eye, axis_deg, ocular, &wave, 1);
  const moments middle = moments_of(&psf);
  for (int i = 0; i < 3; i++) {
    psf = spread_of(values, surface, eye, field_deg, ocular, &wave, 1);
    const moments own = moments_of(&psf);
    wave.x_arcmin += middle.column - own.column;
    wave.y_arcmin += middle.row - own.row;
  }
  return psf;
}

static placido_psf spread_at_axis(double *values, const placido_surface *surface,
                                  const placido_eye *eye, double defocus_D) {
  const placido_wave wave = {.wavelength_nm = 555, .weight = 1, .defocus_D = defocus_D};
  const placido_ocular none = {0};
  const double axis_deg[2] = {0, 0};
  return spread_of(values, surface, eye, axis_deg, &none, &wave, 1);
}

/* Values of one plane against `expected` everywhere: sums in single precision over a thousand
 * buckets. */
static void assert_plane_near(const placido_image *seen, int plane, const double *expected,
                              double tolerance) {
  const float *values = placido_image_plane(seen, plane);
  assert_int_equal(seen->width_px, WIDTH);
  assert_int_equal(seen->height_px, HEIGHT);
  for (int i = 0; i < AREA; i++) {
    assert_near((double)values[i], expected[i], tolerance);
  }
}

static void assert_plane(const placido_image *seen, int plane, const double *expected) {
  assert_plane_near(seen, plane, expected, 2e-6);
}

static void sum_directly(double *to, const float *source, const placido_psf *psf) {
  for (int i = 0; i < AREA; i++) {
    to[i] = direct_sum(source, WIDTH, HEIGHT, psf, i % WIDTH, i / WIDTH);
  }
}

/* What no effect touches is what the cornea alone shows, by the rays that it always had. */
static void nothing_running_is_the_geometric_picture(void **state) {
  (void)state;
  placido_surface *surfaces[] = {conic(7.8, -0.26), keratoconus(0)};
  for (int i = 0; i < 2; i++) {
    const placido_optics optics = {.grow = 1};
    const placido_eye eye = {.pupil_mm = 4};
    placido_eye found;
    placido_scene scene;
    placido_psf psf, mine;
    placido_image seen, expected;
    assert_int_equal(placido_psf_new(&psf, &found, surfaces[i], &eye, &optics, NULL, NULL),
                     PLACIDO_OK);
    assert_int_equal(placido_scene_load(&scene, "tumbling-e", 0.5, NULL, NULL), PLACIDO_OK);
    assert_int_equal(placido_scene_see(&expected, &scene, &psf, 1, NULL), PLACIDO_OK);
    placido_plan_settings fine = settings;
    fine.buckets = psf.n;
    fine.bucket_arcmin = 0.5;
    fine.pupil_samples = 0;
    const placido_run run = {.surface = surfaces[i], .scene = &scene, .settings = &fine,
                             .eye = &found, .threads = 1};
    assert_int_equal(placido_view_run(&seen, &mine, &run, NULL), PLACIDO_OK);
    assert_int_equal(seen.width_px, expected.width_px);
    assert_int_equal(seen.height_px, expected.height_px);
    for (int k = 0; k < seen.width_px * seen.height_px; k++) {
      assert_near((double)seen.data[k], (double)expected.data[k], 5e-4);
    }
    assert_near(mine.bucket_um, psf.bucket_um, 1e-9);
    assert_near(mine.centre_x_um, psf.centre_x_um, 0.1); /* a sixtieth of a minute */
    assert_near(mine.centre_y_um, psf.centre_y_um, 0.1);
    assert_near(mine.outside, psf.outside, 1e-3);
    assert_int_equal(mine.rays_missed, 0);
    placido_psf_free(&psf);
    placido_psf_free(&mine);
    placido_image_free(&seen);
    placido_image_free(&expected);
    placido_scene_free(&scene);
  }
  placido_surface_free(surfaces[0]);
  placido_surface_free(surfaces[1]);
}

static void three_nodes(placido_view *view) {
  view->nodes = 3;
  view->ocular.curved = true;
}

/* Nine spreads, from the directions of a grid in the picture's corners, edges and middle, each for
 * its share of every pixel's light, all summed pixel by pixel. */
static void every_node_spreads_its_share(void **state) {
  (void)state;
  static double values[PSF], sum[AREA], part[AREA];
  static float share[AREA];
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = wide_eye();
  const placido_ocular curved = {.curved = true};
  placido_scene scene = noise_scene(1);
  double apart = 0, first = 0;
  memset(sum, 0, sizeof sum);
  for (int node = 0; node < 9; node++) {
    const int right = node % 3 - 1, down = node / 3 - 1;
    const double field_deg[2] = {-atan(right * 22 * step * arcmin_rad) * 180 / pi,
                                 -atan(down * 18 * step * arcmin_rad) * 180 / pi};
    for (int i = 0; i < AREA; i++) {
      double x = fabs((i % WIDTH - 22) / 22.0 - right), y = fabs((i / WIDTH - 18) / 18.0 - down);
      share[i] = (float)(fmax(1 - x, 0) * fmax(1 - y, 0)) * scene.image.data[i];
    }
    placido_psf psf = spread_straight(values, surface, &eye, field_deg, &curved);
    sum_directly(part, share, &psf);
    moments m = moments_of(&psf);
    first = node == 0 ? m.cc : first;
    apart = fmax(apart, fabs(m.cc / first - 1));
    for (int i = 0; i < AREA; i++) {
      sum[i] += part[i];
    }
  }
  assert_true(apart > 0.02); /* else the test would not see which node is where */
  placido_image seen = see(surface, &eye, &scene, three_nodes, 1, NULL);
  /* Centroids of 80 samples across and of buckets of 3 arcmin: without them it would be 0.02. */
  assert_plane_near(&seen, 0, sum, 4e-3);
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static void add_layer(placido_view *view, double defocus_D, bool near) {
  placido_layer *layer = &view->layers[view->layer_count++];
  const placido_image *canvas = &view->canvas;
  int colours = canvas->planes == 4 ? 3 : canvas->planes;
  layer->defocus_D = defocus_D;
  assert_int_equal(placido_image_new(&layer->light, WIDTH, HEIGHT, colours, NULL), PLACIDO_OK);
  layer->cover = near ? placido_memory_new(AREA, sizeof *layer->cover, NULL) : NULL;
  for (int i = 0; i < AREA * colours; i++) {
    bool in_front = i % AREA % WIDTH >= WIDTH / 2;
    layer->light.data[i] = !near || in_front ? canvas->data[i] : 0;
    if (near) {
      layer->cover[i % AREA] = in_front ? 1 : 0;
    }
  }
}

/* All of the picture far away and its right half, opaque, near. */
static void two_layers(placido_view *view) {
  view->layers = placido_memory_new(2, sizeof *view->layers, NULL);
  assert_non_null(view->layers);
  add_layer(view, 0, false);
  add_layer(view, -2.5, true);
}

static void near_half_plane_covers_what_is_far(void **state) {
  (void)state;
  static double far_values[PSF], near_values[PSF], back[AREA], front[AREA], cover[AREA];
  static float light[AREA], half[AREA];
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = wide_eye();
  placido_scene scene = noise_scene(1);
  for (int i = 0; i < AREA; i++) {
    half[i] = i % WIDTH >= WIDTH / 2 ? 1 : 0;
    light[i] = half[i] * scene.image.data[i];
  }
  placido_psf far_psf = spread_at_axis(far_values, surface, &eye, 0), psf;
  placido_psf near_psf = spread_at_axis(near_values, surface, &eye, -2.5);
  sum_directly(back, scene.image.data, &far_psf);
  sum_directly(front, light, &near_psf);
  sum_directly(cover, half, &near_psf);
  for (int i = 0; i < AREA; i++) {
    back[i] = back[i] * (1 - cover[i]) + front[i];
  }
  placido_image seen = see(surface, &eye, &scene, two_layers, 1, &psf);
  assert_plane(&seen, 0, back);
  for (int i = 0; i < PSF; i++) {
    assert_near(psf.values[i], far_values[i], 1e-9); /* of what is in focus; all of it lands */
  }
  placido_psf_free(&psf);
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static const placido_wave blue = {.wavelength_nm = 450, .weight = 1, .defocus_D = 1};
static const placido_wave red = {.wavelength_nm = 650, .weight = 1, .defocus_D = -0.4};

static void three_lights(placido_view *view) {
  view->light_count = 3;
  view->lights[0] = (placido_light){.count = 1, .waves = {red}};
  view->lights[1] = (placido_light){.count = 2, .waves = {red, blue}};
  view->lights[1].waves[0].weight = 0.3;
  view->lights[1].waves[1].weight = 0.7;
  view->lights[2] = (placido_light){.count = 1, .waves = {blue}};
}

/* Each colour has its own light; that of two waves is their weighted sum. */
static void colours_are_spread_by_their_lights(void **state) {
  (void)state;
  static double values[2][PSF], mixed[PSF], expected[AREA];
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = wide_eye();
  placido_scene scene = noise_scene(3);
  placido_image seen = see(surface, &eye, &scene, three_lights, 1, NULL);
  placido_psf ends[2] = {spread_at_axis(values[0], surface, &eye, red.defocus_D),
                         spread_at_axis(values[1], surface, &eye, blue.defocus_D)};
  for (int i = 0; i < PSF; i++) {
    mixed[i] = 0.3 * values[0][i] + 0.7 * values[1][i];
  }
  const placido_psf middle = {.n = BUCKETS, .values = mixed};
  const placido_psf *psfs[3] = {&ends[0], &middle, &ends[1]};
  for (int plane = 0; plane < 3; plane++) {
    sum_directly(expected, placido_image_plane(&scene.image, plane), psfs[plane]);
    assert_plane(&seen, plane, expected);
  }
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static void shifted_blue(placido_view *view) {
  view->lights[0] = (placido_light){.count = 1, .waves = {blue}};
  view->shifts = true;
  view->shift_mm[0] = 2;
  view->shift_mm[1] = -1;
}

/* Two millimetres at a dioptre are two milliradians. */
static void image_of_a_wave_moves_with_its_defocus(void **state) {
  (void)state;
  static double values[PSF];
  placido_surface *surface = conic(7.8, -0.26);
  const placido_eye eye = wide_eye();
  placido_scene scene = noise_scene(1);
  placido_psf still = spread_at_axis(values, surface, &eye, blue.defocus_D), moved;
  placido_image seen = see(surface, &eye, &scene, shifted_blue, 1, &moved);
  moments a = moments_of(&still), b = moments_of(&moved);
  assert_near(b.column - a.column, 2e-3 / arcmin_rad, 0.1); /* buckets are 3' wide */
  assert_near(b.row - a.row, -1e-3 / arcmin_rad, 0.1);
  placido_psf_free(&moved);
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static void dimmed_disc(placido_view *view) {
  view->apodisation_per_mm2 = 0.05;
  view->lights[0].waves[0].defocus_D = 4;
}

/* Out of focus the spread is a picture of the pupil: light falls as 10^(-rho r²) from its middle,
 * and sums to 1 as before. The cornea is the one without aberrations, Q = -1/n². */
static void apodised_pupil_dims_its_rim(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -1 / (PLACIDO_EYE_INDEX * PLACIDO_EYE_INDEX));
  const placido_eye eye = {.pupil_mm = 6, .index = PLACIDO_EYE_INDEX,
                           .retina_mm = 7.8 * PLACIDO_EYE_INDEX / (PLACIDO_EYE_INDEX - 1)};
  placido_scene scene = noise_scene(1);
  placido_psf psf;
  placido_image seen = see(surface, &eye, &scene, dimmed_disc, 1, &psf);
  const double *middle = psf.values + PSF / 2;
  double sum = 0;
  for (int i = 0; i < PSF; i++) {
    sum += psf.values[i];
  }
  assert_near(sum, 1, 1e-9);
  for (int bucket = 1; bucket <= 10; bucket++) {
    double r_mm = bucket * step * arcmin_rad * 1e3 / 4;
    assert_near(middle[bucket] / middle[0], pow(10, -0.05 * r_mm * r_mm), 0.03);
    assert_near(middle[-BUCKETS * bucket] / middle[0], pow(10, -0.05 * r_mm * r_mm), 0.03);
  }
  placido_psf_free(&psf);
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static void half_core(placido_view *view) { view->core = 0.5; }

static void core_scales_the_picture(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = wide_eye();
  placido_scene scene = noise_scene(1);
  placido_image whole = see(surface, &eye, &scene, NULL, 1, NULL);
  placido_image half = see(surface, &eye, &scene, half_core, 1, NULL);
  for (int i = 0; i < AREA; i++) {
    assert_near((double)half.data[i], (double)whole.data[i] / 2, 1e-6);
  }
  placido_image_free(&whole);
  placido_image_free(&half);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

/* Through a hole nothing is seen, and it does not darken its rim: as scenes were always seen. */
static void holes_are_as_they_were(void **state) {
  (void)state;
  static double values[PSF];
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = wide_eye();
  placido_scene scene = noise_scene(4);
  placido_image expected;
  placido_psf psf = spread_at_axis(values, surface, &eye, 0);
  assert_int_equal(placido_scene_see(&expected, &scene, &psf, 1, NULL), PLACIDO_OK);
  placido_image seen = see(surface, &eye, &scene, NULL, 1, NULL);
  for (int i = 0; i < 4 * AREA; i++) {
    assert_near((double)seen.data[i], (double)expected.data[i], 2e-5); /* divided by alpha */
  }
  for (int i = 0; i < AREA; i++) {
    placido_image_plane(&scene.image, 3)[i] = 1;
  }
  placido_image_free(&seen);
  seen = see(surface, &eye, &scene, NULL, 1, NULL);
  for (int i = 0; i < AREA; i++) {
    assert_true(placido_image_plane(&seen, 3)[i] == 1);
  }
  placido_image_free(&seen);
  placido_image_free(&expected);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static void everything(placido_view *view) {
  three_nodes(view);
  two_layers(view);
  three_lights(view);
  view->waves = true;
}

static void bits_do_not_depend_on_threads(void **state) {
  (void)state;
  placido_surface *surface = keratoconus(0);
  const placido_eye eye = wide_eye();
  placido_scene scene = noise_scene(4);
  placido_image alone = see(surface, &eye, &scene, everything, 1, NULL);
  for (int threads = 2; threads <= 5; threads += 3) {
    placido_image together = see(surface, &eye, &scene, everything, threads, NULL);
    assert_memory_equal(together.data, alone.data, 4 * AREA * sizeof *alone.data);
    placido_image_free(&together);
  }
  placido_image_free(&alone);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

static void nodes_and_lights(placido_view *view) {
  three_nodes(view);
  three_lights(view);
}

static void every_failed_allocation_is_told(void **state) {
  (void)state;
  placido_surface *surface = conic(7.8, -0.26);
  const placido_eye eye = wide_eye();
  placido_scene scene = noise_scene(3);
  placido_plan_settings small = settings;
  small.pupil_samples = 16;
  const placido_run run = {.surface = surface, .scene = &scene, .settings = &small, .eye = &eye,
                           .effects = effects, .count = 1, .threads = 1};
  unsigned long count = 0;
  changing = nodes_and_lights;
  for (unsigned long n = 0; n <= count; n += n < 80 ? 1 : 7) {
    placido_image seen;
    placido_psf psf;
    placido_memory_fail_at(n);
    int status = placido_view_run(&seen, &psf, &run, NULL);
    unsigned long made = placido_memory_fail_at(0);
    count = n == 0 ? made : count;
    assert_int_equal(status, n == 0 ? PLACIDO_OK : PLACIDO_MEMORY);
    assert_true((seen.data != NULL) == (n == 0) && (psf.values != NULL) == (n == 0));
    placido_image_free(&seen);
    placido_psf_free(&psf);
  }
  assert_true(count > 80);
  placido_scene_free(&scene);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(nothing_running_is_the_geometric_picture),
    cmocka_unit_test(every_node_spreads_its_share),
    cmocka_unit_test(near_half_plane_covers_what_is_far),
    cmocka_unit_test(colours_are_spread_by_their_lights),
    cmocka_unit_test(image_of_a_wave_moves_with_its_defocus),
    cmocka_unit_test(apodised_pupil_dims_its_rim),
    cmocka_unit_test(core_scales_the_picture),
    cmocka_unit_test(holes_are_as_they_were),
    cmocka_unit_test(bits_do_not_depend_on_threads),
    cmocka_unit_test(every_failed_allocation_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
