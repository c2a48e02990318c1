/* What the phantom's pictures must be whatever they show: the same for any number of threads, in
 * agreement with the exact edges, and disturbed as much as was asked for. */
#include "tests/phantom/locate.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <placido/phantom.h>
#include <string.h>

typedef struct bench {
  placido_surface *surface;
  placido_instrument instrument;
} bench;

static int set_up(void **state) {
  static bench b;
  *state = &b;
  return placido_phantom_eye(&b.surface, "keratoconus", NULL) ||
         placido_phantom_instrument(&b.instrument, "cone24", NULL);
}

static int tear_down(void **state) {
  placido_surface_free(((bench *)*state)->surface);
  return 0;
}

static placido_frame render(const bench *b, placido_disturbance disturbance, int threads) {
  placido_frame frame = {0};
  placido_error err = {0};
  assert_int_equal(
      placido_phantom_render(&frame, b->surface, &b->instrument, &disturbance, threads, &err),
      PLACIDO_OK);
  return frame;
}

static int compare(const placido_frame *a, const placido_frame *b) {
  assert_int_equal(a->height_px, b->height_px);
  assert_int_equal(a->stride_bytes, b->stride_bytes);
  return memcmp(a->data, b->data, a->stride_bytes * (size_t)a->height_px);
}

static void threads_change_nothing(void **state) {
  placido_disturbance all = {.seed = 3,
                             .blur_px = 1,
                             .motion_px = 2,
                             .noise = 2,
                             .lashes = 5,
                             .nose = true,
                             .lid = true,
                             .break_up = 0.1};
  placido_frame one = render(*state, all, 1), two = render(*state, all, 2);
  assert_int_equal(compare(&one, &two), 0);
  placido_frame_free(&one);
  placido_frame_free(&two);
}

static void seed_decides_the_noise(void **state) {
  placido_frame a = render(*state, (placido_disturbance){.seed = 3, .noise = 2}, 0);
  placido_frame b = render(*state, (placido_disturbance){.seed = 3, .noise = 2}, 0);
  placido_frame c = render(*state, (placido_disturbance){.seed = 4, .noise = 2}, 0);
  assert_int_equal(compare(&a, &b), 0);
  assert_int_not_equal(compare(&a, &c), 0);
  placido_frame_free(&a);
  placido_frame_free(&b);
  placido_frame_free(&c);
}

static void noise_is_as_strong_as_asked(void **state) {
  placido_frame still = render(*state, (placido_disturbance){.bits = 16}, 0);
  placido_frame noisy = render(*state, (placido_disturbance){.bits = 16, .noise = 2}, 0);
  assert_int_equal(noisy.format, PLACIDO_MONO16);
  const uint16_t *a = (const uint16_t *)(void *)still.data;
  const uint16_t *b = (const uint16_t *)(void *)noisy.data;
  double sum = 0, squares = 0;
  size_t count = (size_t)still.width_px * (size_t)still.height_px;
  for (size_t i = 0; i < count; i++) {
    double d = ((double)b[i] - a[i]) * 255 / 65535;
    sum += d;
    squares += d * d;
  }
  /* 1.3 million draws: both figures are known to 2 parts in a thousand. */
  assert_true(fabs(sqrt(squares / (double)count) - 2) < 0.01);
  assert_true(fabs(sum / (double)count) < 0.01);
  placido_frame_free(&still);
  placido_frame_free(&noisy);
}

/* How far, outwards, the picture has its edges from where the exact trace of `where` has them. */
static int locate_all(double *found, const bench *b, const placido_surface *where,
                      const placido_frame *frame) {
  int count = 0;
  const double *centre = b->instrument.principal_px;
  for (int m = 0; m < 24; m++) {
    double angle = (15 * m + 4) / 57.29577951308232, along[2] = {cos(angle), -sin(angle)};
    for (int k = 2; k < 46; k++) {
      double at[2], height, rising = k % 2 == 0 ? 1 : -1;
      assert_true(placido_phantom_edge_at(where, &b->instrument, k, centre, 15 * m + 4, at));
      found[count++] = locate_step(frame, at, along, 2.5, rising, &height);
    }
  }
  return count;
}

static double mean_of(const double *values, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += values[i];
  }
  return sum / count;
}

static double spread_of(double *values, int count) {
  for (int i = 0; i < count; i++) {
    values[i] = fabs(values[i]);
  }
  return median_of(values, count);
}

static void picture_agrees_with_exact_edges(void **state) {
  const bench *b = *state;
  double found[24 * 44];
  placido_frame frame = render(b, (placido_disturbance){.bits = 16, .blur_px = 0.6}, 0);
  int count = locate_all(found, b, b->surface, &frame);
  /* 16 rays a pixel leave a few hundredths of a pixel; a bias would be a wrong pixel centre. */
  assert_true(fabs(mean_of(found, count)) < 0.005);
  assert_true(spread_of(found, count) < 0.02);
  placido_frame_free(&frame);
}

/* Moving the eye is the same as a surface that stands elsewhere. */
static void shift_moves_the_eye(void **state) {
  bench b = *(const bench *)*state;
  const double x_mm = 0.2, y_mm = -0.1, z_mm = 0.3;
  double found[24 * 44];
  placido_surface *moved;
  placido_part part = {PLACIDO_PART_BICONIC, {.biconic = {7.8, -0.2, 7.6, -0.2, 30, 0, 0}}};
  assert_int_equal(placido_surface_new(&b.surface, 0, 5.5, &part, 1, NULL, NULL), PLACIDO_OK);
  part.as.biconic.cx = x_mm;
  part.as.biconic.cy = y_mm;
  assert_int_equal(placido_surface_new(&moved, z_mm, 5.5, &part, 1, NULL, NULL), PLACIDO_OK);
  placido_disturbance shift = {.bits = 16, .blur_px = 0.6, .shift_mm = {x_mm, y_mm, z_mm}};
  placido_frame frame = render(&b, shift, 0);
  int count = locate_all(found, &b, moved, &frame);
  assert_true(fabs(mean_of(found, count)) < 0.005);
  assert_true(spread_of(found, count) < 0.02);
  placido_frame_free(&frame);
  placido_surface_free(moved);
  placido_surface_free(b.surface);
}

static void motion_blur_moves_no_edge(void **state) {
  const bench *b = *state;
  double still[24 * 44], moved[24 * 44];
  placido_disturbance disturbance = {.bits = 16, .blur_px = 0.6};
  placido_frame a = render(b, disturbance, 0);
  disturbance.motion_px = 2.3;
  disturbance.motion_deg = 25;
  placido_frame c = render(b, disturbance, 0);
  assert_int_not_equal(compare(&a, &c), 0);
  int count = locate_all(still, b, b->surface, &a);
  locate_all(moved, b, b->surface, &c);
  double along = 0;
  for (int i = 0; i < count; i++) {
    moved[i] -= still[i];
    along += moved[i] * cos((15 * (i / 44) + 4 - 25) / 57.29577951308232);
  }
  /* A kernel half a pixel off its middle would show as 0.25 here. Its width itself draws curved
   * edges inwards by length²/24R, some 0.002 px. */
  assert_true(fabs(mean_of(moved, count)) < 0.01);
  assert_true(fabs(along / count) < 0.005);
  placido_frame_free(&a);
  placido_frame_free(&c);
}

/* Mean grey of a box about a place in mm from the axis, 90 px to the millimetre. */
static double mean_grey(const placido_frame *frame, double x_mm, double y_mm) {
  double sum = 0;
  for (int v = -15; v <= 15; v++) {
    for (int u = -15; u <= 15; u++) {
      sum += grey_between(frame, 639.5 + 90 * x_mm + u, 511.5 - 90 * y_mm + v);
    }
  }
  return sum / (31 * 31);
}

static void nose_and_lid_hide_the_mires(void **state) {
  placido_frame plain = render(*state, (placido_disturbance){0}, 0);
  placido_frame hidden = render(*state, (placido_disturbance){.nose = true, .lid = true}, 0);
  const double mires = 43 + 176 / 2; /* half bright, half dark */
  assert_true(fabs(mean_grey(&plain, -3.3, -1.2) - mires) < 20);
  assert_true(mean_grey(&hidden, -3.3, -1.2) < 55);
  assert_true(fabs(mean_grey(&hidden, -2.2, -0.8) - mires) < 20);
  assert_true(fabs(mean_grey(&hidden, 3.3, -1.2) - mires) < 20);
  assert_true(fabs(mean_grey(&hidden, 0, 4.5) - 126) < 15); /* skin */
  assert_true(fabs(mean_grey(&plain, 0, 4.9) - 43) < 15);   /* iris */
  placido_frame_free(&plain);
  placido_frame_free(&hidden);
}

static int count_changed(const placido_frame *a, const placido_frame *b, int *darker) {
  int changed = 0;
  *darker = 0;
  for (size_t i = 0; i < a->stride_bytes * (size_t)a->height_px; i++) {
    changed += a->data[i] != b->data[i];
    *darker += b->data[i] < a->data[i];
  }
  return changed;
}

static void lashes_only_darken(void **state) {
  int darker;
  placido_frame plain = render(*state, (placido_disturbance){0}, 0);
  placido_frame lashes = render(*state, (placido_disturbance){.lashes = 10}, 0);
  int changed = count_changed(&plain, &lashes, &darker);
  assert_int_equal(changed, darker);
  assert_true(changed > 10 * 150 * 4); /* ten strokes of over 150 by 4 px */
  placido_frame_free(&plain);
  placido_frame_free(&lashes);
}

static void broken_film_bends_a_share_of_the_edges(void **state) {
  const bench *b = *state;
  double found[24 * 44];
  placido_frame frame = render(b, (placido_disturbance){.bits = 16, .break_up = 0.3, .seed = 5}, 0);
  int count = locate_all(found, b, b->surface, &frame), bent = 0;
  for (int i = 0; i < count; i++) {
    bent += fabs(found[i]) > 0.2;
  }
  /* Ripples fade towards each patch's rim and have nodes: about half of the share shows. */
  assert_in_range(bent, count / 20, count * 2 / 5);
  placido_frame_free(&frame);
}

static void bits_scale_the_greys(void **state) {
  placido_frame eight = render(*state, (placido_disturbance){0}, 0);
  placido_frame twelve = render(*state, (placido_disturbance){.bits = 12}, 0);
  assert_int_equal(eight.format, PLACIDO_MONO8);
  assert_int_equal(eight.bits, 8);
  assert_int_equal(twelve.format, PLACIDO_MONO16);
  assert_int_equal(twelve.bits, 12);
  assert_true(fabs(grey_between(&eight, 20, 20) - grey_between(&twelve, 20, 20)) < 0.6);
  placido_frame_free(&eight);
  placido_frame_free(&twelve);
}

static void refuse(const bench *b, placido_disturbance disturbance, const char *word) {
  placido_frame frame = {0};
  placido_error err = {0};
  assert_int_equal(
      placido_phantom_render(&frame, b->surface, &b->instrument, &disturbance, 1, &err),
      PLACIDO_INPUT);
  assert_non_null(strstr(err.text, word));
  assert_null(frame.data);
}

static void nonsense_is_refused(void **state) {
  bench b = *(const bench *)*state;
  refuse(&b, (placido_disturbance){.blur_px = -1}, "blur_px");
  refuse(&b, (placido_disturbance){.blur_px = NAN}, "blur_px");
  refuse(&b, (placido_disturbance){.motion_px = INFINITY}, "motion_px");
  refuse(&b, (placido_disturbance){.noise = -2}, "noise");
  refuse(&b, (placido_disturbance){.subsamples = -4}, "subsamples");
  refuse(&b, (placido_disturbance){.lashes = -1}, "lashes");
  refuse(&b, (placido_disturbance){.break_up = 0.6}, "break_up");
  refuse(&b, (placido_disturbance){.bits = 17}, "bits");
  refuse(&b, (placido_disturbance){.bits = 7}, "bits");
  refuse(&b, (placido_disturbance){.shift_mm = {0, NAN, 0}}, "shift_mm[1]");
  b.instrument.focal_px[1] = 0;
  refuse(&b, (placido_disturbance){0}, "focal length");
  b.instrument.focal_px[1] = 1;
  b.instrument.width_px = 0;
  refuse(&b, (placido_disturbance){0}, "width");
  b.instrument.width_px = 100;
  b.instrument.edges[7].z_mm = NAN;
  refuse(&b, (placido_disturbance){0}, "edge");
  b.surface = NULL;
  refuse(&b, (placido_disturbance){0}, "surface");
}

static void every_built_in_can_be_made(void **state) {
  (void)state;
  placido_error err = {0};
  placido_surface *surface;
  placido_instrument instrument;
  for (const char *const *name = placido_phantom_eyes(); *name; name++) {
    assert_int_equal(placido_phantom_eye(&surface, *name, &err), PLACIDO_OK);
    placido_surface_free(surface);
  }
  for (const char *const *name = placido_phantom_instruments(); *name; name++) {
    assert_int_equal(placido_phantom_instrument(&instrument, *name, &err), PLACIDO_OK);
    assert_true(instrument.edge_count > 1 && instrument.first_band_bright);
  }
  assert_int_equal(placido_phantom_eye(&surface, "glass", &err), PLACIDO_INPUT);
  assert_null(surface);
  assert_int_equal(placido_phantom_instrument(&instrument, "ruler", &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "ruler"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(threads_change_nothing),
      cmocka_unit_test(seed_decides_the_noise),
      cmocka_unit_test(noise_is_as_strong_as_asked),
      cmocka_unit_test(picture_agrees_with_exact_edges),
      cmocka_unit_test(shift_moves_the_eye),
      cmocka_unit_test(motion_blur_moves_no_edge),
      cmocka_unit_test(nose_and_lid_hide_the_mires),
      cmocka_unit_test(lashes_only_darken),
      cmocka_unit_test(broken_film_bends_a_share_of_the_edges),
      cmocka_unit_test(bits_scale_the_greys),
      cmocka_unit_test(nonsense_is_refused),
      cmocka_unit_test(every_built_in_can_be_made),
  };
  return cmocka_run_group_tests(tests, set_up, tear_down);
}
