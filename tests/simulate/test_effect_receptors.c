/* The mosaic of cones against the mathematics of sampling: a hexagonal lattice, the transform of a
 * hexagon, that of linear interpolation in triangles. */
#include "base/memory.h"
#include "simulate/effects/effect.h"
#include "simulate/plan/view.h"
#include "tests/support/near.h"

#include <complex.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double cone_arcmin = 0.5;

static placido_image picture(int width, int height, int planes) {
  placido_image image;
  assert_int_equal(placido_image_new(&image, width, height, planes, NULL), PLACIDO_OK);
  return image;
}

/* The effect alone, in place. */
static void look(placido_image *image, double bucket_arcmin, bool holes, int threads) {
  const placido_plan_settings settings = {.bucket_arcmin = bucket_arcmin};
  placido_view view = {.settings = &settings, .seen = *image, .holes = holes, .threads = threads};
  assert_int_equal(placido_effect_receptors.apply(NULL, &view, NULL), PLACIDO_OK);
}

static double sinc(double x) { return x == 0 ? 1 : sin(pi * x) / (pi * x); }

/* Stripes along x of `frequency` per arcmin: what buckets receive of 0.5 + 0.5 cos. */
static void draw_stripes(placido_image *image, double bucket_arcmin, double frequency) {
  double amplitude = 0.5 * sinc(frequency * bucket_arcmin);
  for (int i = 0; i < image->width_px * image->height_px; i++) {
    double y = (i / image->width_px + 0.5) * bucket_arcmin;
    image->data[i] = (float)(0.5 + amplitude * cos(2 * pi * frequency * y));
  }
}

/* The amplitude of that frequency in the middle column: a raised cosine keeps others out. */
static double amplitude_of(const placido_image *image, double bucket_arcmin, double frequency) {
  const int rim = 20, rows = image->height_px - 2 * rim;
  double complex sum = 0;
  for (int k = 0; k < rows; k++) {
    double y = (k + rim + 0.5) * bucket_arcmin, window = 1 - cos(2 * pi * (k + 0.5) / rows);
    double value = (double)image->data[(k + rim) * image->width_px + image->width_px / 2];
    sum += window * (value - 0.5) * cexp(-2 * I * pi * frequency * y);
  }
  return 2 * cabs(sum) / rows;
}

/* Of a hexagon with corners above and below: a trapezoid, two boxes of which one slides over the
 * other. Of linear interpolation: boxes along the three directions of the lattice, of which one is
 * level. */
static double hexagon(double frequency) {
  double side = cone_arcmin / sqrt(3);
  return sinc(1.5 * side * frequency) * sinc(0.5 * side * frequency);
}

static double triangles(double frequency) {
  double slanted = sinc(frequency * cone_arcmin * sqrt(3) / 2);
  return slanted * slanted;
}

/* Rows of cones stand 0.433' apart: they cannot tell stripes from others of 2.309 / arcmin less
 * their frequency. Up to 1.155 (69 c/deg) the interpolation favours what was there, above it the
 * coarser ones. Light is interpolated between buckets of 0.1', which takes 1 % of 0.6 / arcmin and
 * 8 % of 1.6. */
static void stripes_alias_as_a_lattice_does(void **state) {
  (void)state;
  const double bucket = 0.1, repeat = 2 / (cone_arcmin * sqrt(3));
  const double frequencies[3] = {0.6, 1.0, 1.6};
  for (int i = 0; i < 3; i++) {
    double f = frequencies[i], alias = repeat - f, between = sinc(f * bucket) * sinc(f * bucket);
    double caught = 0.5 * sinc(f * bucket) * between * hexagon(f);
    placido_image image = picture(24, 1240, 1);
    draw_stripes(&image, bucket, f);
    look(&image, bucket, false, 1);
    /* of an amplitude of 0.5: buckets show what is in their middles */
    assert_near(amplitude_of(&image, bucket, f), caught * triangles(f), 0.003);
    assert_near(amplitude_of(&image, bucket, alias), caught * triangles(alias), 0.003);
    placido_image_free(&image);
  }
}

/* 96 c/deg are seen as 43 c/deg, and themselves hardly. */
static void fine_stripes_come_out_coarser(void **state) {
  (void)state;
  placido_image image = picture(24, 1240, 1);
  draw_stripes(&image, 0.1, 1.6);
  look(&image, 0.1, false, 1);
  assert_true(amplitude_of(&image, 0.1, 0.709) > 4 * amplitude_of(&image, 0.1, 1.6));
  assert_true(amplitude_of(&image, 0.1, 0.709) > 20 * amplitude_of(&image, 0.1, 0.4));
  placido_image_free(&image);
}

static void even_fields_stay_even(void **state) {
  (void)state;
  const double buckets[4] = {0.07, 0.2, 0.25, 0.4};
  for (int k = 0; k < 4; k++) {
    placido_image image = picture(43, 31, 3);
    for (int i = 0; i < 3 * 43 * 31; i++) {
      image.data[i] = i < 43 * 31 ? 0.3f : 1234.5f;
    }
    look(&image, buckets[k], false, 2);
    for (int i = 0; i < 3 * 43 * 31; i++) {
      assert_true(image.data[i] == (i < 43 * 31 ? 0.3f : 1234.5f));
    }
    placido_image_free(&image);
  }
}

/* Light that slopes is shown as it is, up to the rim's cones. */
static void slopes_stay(void **state) {
  (void)state;
  placido_image image = picture(60, 50, 1);
  for (int i = 0; i < 60 * 50; i++) {
    image.data[i] = 0.01f * (float)(i % 60) - 0.003f * (float)(i / 60);
  }
  look(&image, 0.25, false, 1);
  for (int i = 0; i < 60 * 50; i++) {
    int x = i % 60, y = i / 60;
    if (x >= 4 && x < 56 && y >= 4 && y < 46) {
      assert_near((double)image.data[i], 0.01 * x - 0.003 * y, 1e-6); /* floats */
    }
  }
  placido_image_free(&image);
}

/* A bright disc gives as much light as it had: over 1,800 cones their shares average out. */
static void light_is_conserved(void **state) {
  (void)state;
  const double buckets[3] = {0.1, 0.2, 0.4};
  for (int k = 0; k < 3; k++) {
    int n = (int)lround(40 / buckets[k]);
    placido_image image = picture(n, n, 1);
    double before = 0, after = 0;
    for (int i = 0; i < n * n; i++) {
      double x = (i % n + 0.5) * buckets[k] - 19.3, y = (i / n + 0.5) * buckets[k] - 20.6;
      image.data[i] = hypot(x, y) < 11 ? 5 : 0.1f;
      before += (double)image.data[i];
    }
    look(&image, buckets[k], false, 1);
    for (int i = 0; i < n * n; i++) {
      after += (double)image.data[i];
    }
    assert_near(after / before, 1, 1e-3);
    placido_image_free(&image);
  }
}

/* The same bits for any number of threads; alpha stays unless it spreads with the colours. */
static void alpha_stays_and_threads_agree(void **state) {
  (void)state;
  placido_image one = picture(50, 40, 4);
  for (int i = 0; i < 4 * 50 * 40; i++) {
    one.data[i] = (float)(i * 7919 % 1000) / 1000;
  }
  placido_image two = picture(50, 40, 4), holes = picture(50, 40, 4);
  const size_t plane = 50 * 40, bytes = plane * sizeof(float);
  memcpy(two.data, one.data, 4 * bytes);
  memcpy(holes.data, one.data, 4 * bytes);
  float alpha[50 * 40];
  memcpy(alpha, placido_image_plane(&one, 3), bytes);
  look(&one, 0.25, false, 1);
  look(&two, 0.25, false, 2);
  look(&holes, 0.25, true, 1);
  assert_memory_equal(one.data, two.data, 4 * bytes);
  assert_memory_equal(placido_image_plane(&one, 3), alpha, bytes);
  assert_memory_equal(one.data, holes.data, 3 * bytes);
  assert_memory_not_equal(placido_image_plane(&holes, 3), alpha, bytes);
  placido_image_free(&one);
  placido_image_free(&two);
  placido_image_free(&holes);
}

static placido_answer ask(double bucket_arcmin, placido_strokes *strokes) {
  const placido_scene scene = {.image = {.width_px = 100, .height_px = 100}, .arcmin_per_px = 0.5};
  const placido_question question = {.scene = &scene, .bucket_arcmin = bucket_arcmin};
  *strokes = (placido_strokes){.dims = false};
  placido_answer answer = {.strokes = strokes};
  placido_effect_receptors.ask(&question, &answer);
  return answer;
}

static void buckets_of_a_cone_need_no_mosaic(void **state) {
  (void)state;
  placido_strokes strokes;
  placido_answer answer = ask(0.5, &strokes);
  assert_false(answer.applies);
  assert_near(strokes.aperture_arcmin, 0, 0);
  assert_non_null(strstr(answer.reason, "is a cone already"));
  assert_true(ask(0.25, &strokes).applies);
  assert_true(strokes.aperture_arcmin > cone_arcmin);
}

/* An edge at `offset` from the middle, at an angle, softened by a Gaussian: in buckets' means. */
static void draw_edge(placido_image *image, double bucket, double sigma, double angle,
                      double offset) {
  const int points = 5;
  for (int i = 0; i < image->width_px * image->height_px; i++) {
    double sum = 0;
    for (int k = 0; k < points * points; k++) {
      double x = (i % image->width_px + (k % points + 0.5) / points) * bucket - 4;
      double y = (i / image->width_px + (k / points + 0.5) / points) * bucket - 4;
      sum += erfc(-(x * cos(angle) + y * sin(angle) - offset) / (sigma * sqrt(2))) / 2;
    }
    image->data[i] = (float)(sum / (points * points));
  }
}

/* The mean over a square of an edge that is soft already, less itself: at most. */
static double softened(double width, double sigma) {
  double most = 0;
  for (double x = 0; x < 3; x += 0.02) {
    double sum = 0;
    for (int k = 0; k < 100; k++) {
      sum += erfc(-(x + ((k + 0.5) / 100 - 0.5) * width) / (sigma * sqrt(2))) / 200;
    }
    most = fmax(most, fabs(sum - erfc(-x / (sigma * sqrt(2))) / 2));
  }
  return most;
}

/* The stroke says at least what the mosaic does to an edge, and no more than 1.5 times that. */
static void stroke_is_what_the_mosaic_does(void **state) {
  (void)state;
  const double buckets[3] = {0.1, 0.25, 0.4}, sigmas[3] = {0.2, 0.5, 1};
  for (int k = 0; k < 9; k++) {
    double bucket = buckets[k / 3], sigma = sigmas[k % 3], most = 0;
    int n = (int)lround(8 / bucket);
    for (int turn = 0; turn < 16; turn++) {
      placido_image before = picture(n, n, 1), after = picture(n, n, 1);
      draw_edge(&before, bucket, sigma, turn / 4 * pi / 6, 0.11 * (turn % 4));
      memcpy(after.data, before.data, (size_t)n * (size_t)n * sizeof(float));
      look(&after, bucket, false, 1);
      for (int i = 0; i < n * n; i++) {
        bool middle = abs(i % n - n / 2) < n / 4 && abs(i / n - n / 2) < n / 4;
        double found = fabs((double)after.data[i] - (double)before.data[i]);
        most = middle ? fmax(most, found) : most;
      }
      placido_image_free(&before);
      placido_image_free(&after);
    }
    placido_strokes strokes;
    ask(bucket, &strokes);
    double bound = softened(strokes.aperture_arcmin, sigma);
    if (!(most <= bound && bound <= 1.5 * most)) {
      fail_msg("buckets of %g, sigma %g: changed by %g, bound %g", bucket, sigma, most, bound);
    }
  }
}

static void memory_may_run_out(void **state) {
  (void)state;
  placido_image image = picture(20, 20, 1);
  const placido_plan_settings settings = {.bucket_arcmin = 0.25};
  placido_view view = {.settings = &settings, .seen = image, .threads = 1};
  placido_memory_fail_at(1);
  assert_int_equal(placido_effect_receptors.apply(NULL, &view, NULL), PLACIDO_MEMORY);
  placido_memory_fail_at(0);
  placido_image_free(&image);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(stripes_alias_as_a_lattice_does),
    cmocka_unit_test(fine_stripes_come_out_coarser),
    cmocka_unit_test(even_fields_stay_even),
    cmocka_unit_test(slopes_stay),
    cmocka_unit_test(light_is_conserved),
    cmocka_unit_test(alpha_stays_and_threads_agree),
    cmocka_unit_test(buckets_of_a_cone_need_no_mosaic),
    cmocka_unit_test(stroke_is_what_the_mosaic_does),
    cmocka_unit_test(memory_may_run_out),
  };
  return cmocka_run_group_tests_name("effect_receptors", tests, NULL, NULL);
}
