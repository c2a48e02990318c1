/* Eyes turned, mirrored, scaled and tilted: what they see follows to rounding. */
#include "tests/simulate/eyes.h"
#include "tests/simulate/planes.h"
#include "tests/stability/cases.h"
#include "tests/stability/table.h"

#include <float.h>
#include <math.h>
#include <placido/simulate.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

#define PUPIL_MM 5.0

static void add_row(const char *name, double condition, double perturbation, const char *in_unit,
                    double change, const char *out_unit, double bound) {
  const struct bounded row = {condition, perturbation, in_unit, change, out_unit, bound};
  case_bounded(&row, "%s", name);
}

static placido_wavefront front_of(const placido_surface *surface, double pupil_mm) {
  placido_wavefront wavefront;
  const placido_eye eye = {.pupil_mm = pupil_mm};
  assert_int_equal(placido_wavefront_new(&wavefront, surface, &eye, NULL, NULL, NULL), PLACIDO_OK);
  return wavefront;
}

/* Coefficients of the wavefront turned by an angle: cosine and sine of a frequency turn as
 * a vector by m times the angle. */
static void turn_terms(double *out, const placido_wavefront *w, double angle) {
  for (int n = 0; n <= w->order; n++) {
    for (int m = n % 2; m <= n; m += 2) {
      int even = placido_zernike_index(n, m), odd = placido_zernike_index(n, -m);
      double c = cos(m * angle), s = sin(m * angle);
      out[even] = c * w->coefficients_um[even] - (m > 0 ? s * w->coefficients_um[odd] : 0);
      out[odd] = m > 0 ? s * w->coefficients_um[even] + c * w->coefficients_um[odd] : out[even];
    }
  }
}

static double worst_difference(const double *a, const double *b, int count) {
  double worst = 0;
  for (int k = 0; k < count; k++) {
    worst = fmax(worst, fabs(a[k] - b[k]));
  }
  return worst;
}

/* A path difference is made of distances of n · 30 mm with some 32 roundings of numbers as large as
 * 1 mm (test_arithmetic_rays.c), the surface's depth with 57 more and a turn's 5: u · 94 mm each,
 * before and after, and the terms take means of it, which adds the sum's roundings over 768 rays
 * times the paths' size, 10 um. The search of the focus ends with a step below 1e-9 mm, of which
 * Gauss and Newton leave the residual's share of the paths, 1e-4 at most; it changes defocus and
 * tilt by that times r²/(4 √3 f²) and r/(2 f): n 1e-13 · 0.05 mm. The nodes' 48 spokes take
 * frequencies below 40 exactly in terms of order 8: what a smooth surface has above is below
 * rounding. */
static double front_bound(void) {
  return 1e3 * 2 * (94 * DBL_EPSILON / 2 + 1.34 * 1e-13 * 0.05) + 768 * DBL_EPSILON / 2 * 10;
}

static void turned_wavefronts(void **state) {
  (void)state;
  static const double angles_deg[] = {1, 7.5, 30, 45, 90, 123.4, 180, 271};
  placido_surface *straight = keratoconus(0);
  placido_wavefront w = front_of(straight, PUPIL_MM);
  for (size_t k = 0; k < sizeof angles_deg / sizeof angles_deg[0]; k++) {
    double expected[PLACIDO_WAVEFRONT_TERMS];
    char name[64];
    placido_surface *surface = keratoconus(angles_deg[k]);
    placido_wavefront v = front_of(surface, PUPIL_MM);
    turn_terms(expected, &w, angles_deg[k] * acos(-1) / 180);
    snprintf(name, sizeof name, "Zernike terms turned by %g degrees", angles_deg[k]);
    add_row(name, 1, DBL_EPSILON, "turn",
            worst_difference(v.coefficients_um, expected, v.term_count), "um", front_bound());
    placido_wavefront_free(&v);
    placido_surface_free(surface);
  }
  placido_wavefront_free(&w);
  placido_surface_free(straight);
}

/* A cone at (x, y) on a toric cornea whose axis is `axis_deg`; all lengths times `scale`. */
static placido_surface *eye_of(double x, double y, double axis_deg, double scale) {
  const placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC,
       .as.biconic = {7.9 * scale, -0.2, 7.6 * scale, -0.3, axis_deg, 0, 0}},
      {.kind = PLACIDO_PART_BUMP,
       .as.bump = {0.02 * scale, 1.1 * scale, 1.3 * scale, x * scale, y * scale, axis_deg}}};
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5 * scale, parts, 2, NULL, NULL), PLACIDO_OK);
  return surface;
}

/* Mirrored at the y axis: terms that are odd in x change their sign. Terms with the cosine are odd
 * where m is, those with the sine where m is even. */
static void mirrored_wavefronts(void **state) {
  (void)state;
  placido_surface *right = eye_of(0.6, -0.8, 20, 1), *left = eye_of(-0.6, -0.8, -20, 1);
  placido_wavefront w = front_of(right, PUPIL_MM), v = front_of(left, PUPIL_MM);
  double expected[PLACIDO_WAVEFRONT_TERMS];
  for (int j = 0; j < w.term_count; j++) {
    int n, m;
    placido_zernike_name(j, &n, &m);
    bool odd = m >= 0 ? m % 2 != 0 : m % 2 == 0;
    expected[j] = odd ? -w.coefficients_um[j] : w.coefficients_um[j];
  }
  add_row("Zernike terms of the other eye", 1, DBL_EPSILON, "x",
          worst_difference(v.coefficients_um, expected, v.term_count), "um", front_bound());
  placido_wavefront_free(&w);
  placido_wavefront_free(&v);
  placido_surface_free(right);
  placido_surface_free(left);
}

/* Every length times a scale: every path difference as well, and every angle stays. By a power of
 * two no digit changes but for the search of the focus, which ends within 1e-9 mm whatever the
 * scale. */
static void scaled_eyes(void **state) {
  (void)state;
  static const double scales[] = {1e-1, 0.5, 1.7, 2};
  placido_surface *usual = eye_of(0.6, -0.8, 20, 1);
  placido_wavefront w = front_of(usual, 3);
  for (size_t k = 0; k < sizeof scales / sizeof scales[0]; k++) {
    placido_surface *surface = eye_of(0.6, -0.8, 20, scales[k]);
    char name[64];
    double scale = scales[k], expected[PLACIDO_WAVEFRONT_TERMS];
    placido_wavefront v;
    /* the reference sphere's place is given: its search has limits in mm */
    const placido_eye eye = {.pupil_mm = 3 * scale, .retina_mm = w.focus_mm[2] * scale};
    if (eye.retina_mm < 5) { /* nor do retinas nearer than that */
      placido_surface_free(surface);
      continue;
    }
    assert_int_equal(placido_wavefront_new(&v, surface, &eye, NULL, NULL, NULL), PLACIDO_OK);
    for (int j = 0; j < v.term_count; j++) {
      expected[j] = scale * w.coefficients_um[j];
    }
    snprintf(name, sizeof name, "Zernike terms, lengths times %g", scale);
    add_row(name, 1, DBL_EPSILON, "scale",
            worst_difference(v.coefficients_um, expected, v.term_count), "um",
            fmax(scale, 1) * front_bound());
    placido_wavefront_free(&v);
    placido_surface_free(surface);
  }
  placido_wavefront_free(&w);
  placido_surface_free(usual);
}

static placido_psf seen_by(const placido_surface *surface, int buckets) {
  placido_psf psf;
  const placido_eye eye = {.pupil_mm = PUPIL_MM, .retina_mm = 30.5};
  const placido_optics optics = {.samples = 200, .buckets = buckets, .grow = 1};
  assert_int_equal(placido_psf_new(&psf, NULL, surface, &eye, &optics, NULL, NULL), PLACIDO_OK);
  return psf;
}

/* Σ |a - b| where b is looked at turned by a quarter or mirrored. */
static double light_moved(const placido_psf *a, const placido_psf *b, const int turn[2][2]) {
  int half = a->n / 2;
  double sum = 0;
  assert_int_equal(a->n, b->n);
  for (int row = -half; row <= half; row++) {
    for (int column = -half; column <= half; column++) {
      int x = turn[0][0] * column + turn[0][1] * row, y = turn[1][0] * column + turn[1][1] * row;
      sum += fabs(a->values[(row + half) * a->n + column + half] -
                  b->values[(y + half) * b->n + x + half]);
    }
  }
  return sum;
}

/* A ray's place on the retina is off by 100 roundings of 30 mm: δ in buckets. Of a box of light
 * that lies across a bucket's border the share δ / width goes to the other side, and the share of
 * boxes that do is the width: together δ for each of two borders, counted where it leaves and where
 * it arrives; and 4 δ again for the other eye. Light is counted in whole units of 2^-50 of it all,
 * and each of a ray's boxes, which a footprint of up to (10 buckets)² is cut into, may round 4 of
 * them. All light lies the other way by `shift` buckets where the points of fixation differ. */
static double light_bound(const placido_psf *psf, double shift) {
  double delta = 100 * DBL_EPSILON / 2 * 30e3 / psf->bucket_um;
  return 2 * 4 * (delta + shift) + (double)psf->rays * 100 * 4 * ldexp(1, -50);
}

/* The distance of the point of fixation from where a turn takes that of the other eye, in buckets.
 */
static double fixation_moved(const placido_psf *a, const placido_psf *b, const int turn[2][2]) {
  double x = turn[0][0] * a->centre_x_um + turn[0][1] * a->centre_y_um;
  double y = turn[1][0] * a->centre_x_um + turn[1][1] * a->centre_y_um;
  return hypot(b->centre_x_um - x, b->centre_y_um - y) / a->bucket_um;
}

/* It is found in single precision: slopes of up to 0.17 over 30 mm, rounded some 4 times, either
 * eye. */
static double fixation_bound(const placido_psf *psf) {
  return 2 * 4 * (double)FLT_EPSILON / 2 * 0.17 * 30e3 / psf->bucket_um;
}

/* One matrix turns the eye, which is looked at from before it with y upwards, and the picture,
 * which is seen from behind it with rows downwards. */
static void turned_psfs(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double x, y, axis_deg;
    int turn[2][2];
  } cases[] = {{"PSF turned by 90 degrees", 0.8, 0.6, 110, {{0, -1}, {1, 0}}},
               {"PSF turned by 180 degrees", -0.6, 0.8, 200, {{-1, 0}, {0, -1}}},
               {"PSF turned by 270 degrees", -0.8, -0.6, 290, {{0, 1}, {-1, 0}}},
               {"PSF of the other eye", -0.6, -0.8, -20, {{-1, 0}, {0, 1}}},
               {"PSF upside down", 0.6, 0.8, -20, {{1, 0}, {0, -1}}}};
  placido_surface *usual = eye_of(0.6, -0.8, 20, 1);
  placido_psf psf = seen_by(usual, 257);
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    placido_surface *surface = eye_of(cases[k].x, cases[k].y, cases[k].axis_deg, 1);
    placido_psf other = seen_by(surface, 257);
    const int(*turn)[2] = cases[k].turn;
    double shift = fixation_moved(&psf, &other, turn);
    char name[64];
    snprintf(name, sizeof name, "%s: fixation", cases[k].name);
    add_row(name, 1, FLT_EPSILON, "share", shift, "buckets", fixation_bound(&psf));
    add_row(cases[k].name, 4, shift, "buckets", light_moved(&psf, &other, turn), "of the light",
            light_bound(&psf, shift));
    placido_psf_free(&other);
    placido_surface_free(surface);
  }
  placido_psf_free(&psf);
  placido_surface_free(usual);
}

/* A wavefront tilted by so many buckets: the image moves by as many. Fields and transforms are of
 * single precision: log2 of the samples times 7 u for each of the two transforms (Higham, 24.2), of
 * the field's phases 2 π u for every wave of tilt at the rim, in the root mean square of the image,
 * which is a square: twice. */
static void tilted_pupils(void **state) {
  (void)state;
  enum { BUCKETS = 65 };
  static const int shifts[] = {1, 3, 8};
  static double straight[BUCKETS * BUCKETS], tilted[BUCKETS * BUCKETS];
  const double bucket_rad = 0.5 * acos(-1) / 10800, pupil_mm = 4;
  const placido_wave wave = {.wavelength_nm = 555, .weight = 1};
  const placido_window window = {.buckets = BUCKETS};
  double terms[11] = {[3] = 0.05, [4] = 0.1, [5] = -0.08, [7] = 0.12, [8] = -0.05};
  placido_pupil pupil;
  placido_diffraction_use use;
  assert_int_equal(placido_pupil_of_terms(&pupil, pupil_mm, terms, 11, 128, NULL), PLACIDO_OK);
  assert_int_equal(placido_diffraction(straight, NULL, &pupil, &wave, 1, &window, NULL),
                   PLACIDO_OK);
  placido_pupil_free(&pupil);
  for (size_t k = 0; k < sizeof shifts / sizeof shifts[0]; k++) {
    int shift = shifts[k];
    double size = 0, error = 0;
    char name[64];
    /* c · 2 x / r of the pupil's radius: a slope of 2 c / r; where it grows with x light comes from
     * -x */
    terms[2] = -1e3 * bucket_rad * shift * pupil_mm / 2 / 2;
    assert_int_equal(placido_pupil_of_terms(&pupil, pupil_mm, terms, 11, 128, NULL), PLACIDO_OK);
    assert_int_equal(placido_diffraction(tilted, &use, &pupil, &wave, 1, &window, NULL),
                     PLACIDO_OK);
    placido_pupil_free(&pupil);
    for (int row = 0; row < BUCKETS; row++) {
      for (int column = 0; column + shift < BUCKETS; column++) {
        double a = straight[row * BUCKETS + column], b = tilted[row * BUCKETS + column + shift];
        size += a * a;
        error += (b - a) * (b - a);
      }
    }
    double waves = fabs(terms[2]) * 2 / 0.555, samples = (double)use.samples * use.samples;
    double relative = 2 * (FLT_EPSILON / 2) * (2 * 7 * log2(4 * samples) + 2 * acos(-1) * waves);
    snprintf(name, sizeof name, "PSF of waves tilted by %d buckets", shift);
    add_row(name, 2, FLT_EPSILON, "of the field", sqrt(error / size), "of it, rms", 2 * relative);
  }
}

/* A picture and its PSF both mirrored: so is what is seen. */
static void mirrored_convolutions(void **state) {
  (void)state;
  enum { WIDTH = 97, HEIGHT = 61, BUCKETS = 15 };
  static const char *const names[2][2] = {
      {"convolution left to right, float", "convolution left to right, double"},
      {"convolution upside down, float", "convolution upside down, double"}};
  double values[BUCKETS * BUCKETS], flipped[BUCKETS * BUCKETS];
  float *source = noise_plane(WIDTH, HEIGHT, 3), *mirrored = noise_plane(WIDTH, HEIGHT, 3);
  const placido_psf psf = noise_psf(values, BUCKETS, 9);
  placido_psf other = psf;
  other.values = flipped;
  for (int down = 0; down < 2; down++) {
    for (int k = 0; k < WIDTH * HEIGHT; k++) {
      int x = k % WIDTH, y = k / WIDTH;
      mirrored[k] = source[down ? (HEIGHT - 1 - y) * WIDTH + x : y * WIDTH + WIDTH - 1 - x];
    }
    for (int k = 0; k < BUCKETS * BUCKETS; k++) {
      int x = k % BUCKETS, y = k / BUCKETS;
      flipped[k] = values[down ? (BUCKETS - 1 - y) * BUCKETS + x : y * BUCKETS + BUCKETS - 1 - x];
    }
    for (int doubles = 0; doubles < 2; doubles++) {
      const placido_convolution how = {.doubles = doubles};
      float *a = convolved_plane(source, WIDTH, HEIGHT, &psf, &how);
      float *b = convolved_plane(mirrored, WIDTH, HEIGHT, &other, &how);
      double error = 0, size = 0;
      for (int k = 0; k < WIDTH * HEIGHT; k++) {
        int x = k % WIDTH, y = k / WIDTH;
        double there = (double)b[down ? (HEIGHT - 1 - y) * WIDTH + x : y * WIDTH + WIDTH - 1 - x];
        error += pow((double)a[k] - there, 2);
        size += (double)a[k] * (double)a[k];
      }
      /* transforms as in test_arithmetic_sums.c, of both; in double both are rounded to float */
      double u = (doubles ? DBL_EPSILON : (double)FLT_EPSILON) / 2;
      double bound = 2 * (7 * rounding_bound(source, WIDTH, HEIGHT, &psf, u) / sqrt(size) +
                          (doubles ? (double)FLT_EPSILON / 2 : 0));
      add_row(names[down][doubles], 1, 2 * u, "of the light", sqrt(error / size), "of it, rms",
              bound);
      free(a);
      free(b);
    }
  }
  free(source);
  free(mirrored);
}

/* A scene mirrored and seen through a mirrored PSF. What is seen is cut and resampled the same way
 * from either side where the picture is as fine as the buckets. */
static void mirrored_scenes(void **state) {
  (void)state;
  placido_scene scene, other;
  placido_image seen, there;
  placido_surface *right = eye_of(0.6, -0.8, 20, 1), *left = eye_of(-0.6, -0.8, -20, 1);
  placido_psf psf = seen_by(right, 129), mirrored = seen_by(left, 129);
  assert_int_equal(placido_scene_draw(&scene, "tumbling-e", NULL, 0.5, NULL), PLACIDO_OK);
  assert_int_equal(placido_scene_draw(&other, "tumbling-e", NULL, 0.5, NULL), PLACIDO_OK);
  int width = scene.image.width_px, height = scene.image.height_px;
  for (int plane = 0; plane < scene.image.planes; plane++) {
    const float *from = placido_image_plane(&scene.image, plane);
    float *to = placido_image_plane(&other.image, plane);
    for (int k = 0; k < width * height; k++) {
      to[k] = from[k / width * width + width - 1 - k % width];
    }
  }
  assert_int_equal(placido_scene_see(&seen, &scene, &psf, 1, NULL), PLACIDO_OK);
  assert_int_equal(placido_scene_see(&there, &other, &mirrored, 1, NULL), PLACIDO_OK);
  double error = 0, size = 0;
  int count = seen.width_px * seen.height_px;
  for (int k = 0; k < count; k++) {
    double a = (double)seen.data[k];
    double b =
        (double)
            there.data[k / seen.width_px * seen.width_px + seen.width_px - 1 - k % seen.width_px];
    error += (a - b) * (a - b);
    size += a * a;
  }
  double bound =
      2 * 7 * rounding_bound(scene.image.data, width, height, &psf, FLT_EPSILON / 2.0) / sqrt(size);
  add_row("scene and PSF mirrored", 1, FLT_EPSILON, "of the light", sqrt(error / size),
          "of it, rms", bound + light_bound(&psf, fixation_bound(&psf)));
  placido_image_free(&seen);
  placido_image_free(&there);
  placido_scene_free(&scene);
  placido_scene_free(&other);
  placido_psf_free(&psf);
  placido_psf_free(&mirrored);
  placido_surface_free(right);
  placido_surface_free(left);
}

static void everything_follows(void **state) {
  (void)state;
  assert_int_equal(stability_print("metamorphic: optics"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(turned_wavefronts), cmocka_unit_test(mirrored_wavefronts),
      cmocka_unit_test(scaled_eyes),       cmocka_unit_test(turned_psfs),
      cmocka_unit_test(tilted_pupils),     cmocka_unit_test(mirrored_convolutions),
      cmocka_unit_test(mirrored_scenes),   cmocka_unit_test(everything_follows),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
