/* The processor's arithmetic is IEEE 754's: before anything else, and after the libraries that we
 * call have had their turn, in every thread. Libraries that were linked with -ffast-math set it to
 * flush denormal numbers to zero when they are loaded. */
#include "base/cv/cv.h"
#include "tests/base/scratch.h"
#include "tests/simulate/planes.h"
#include "tests/stability/table.h"

#include <fenv.h>
#include <float.h>
#include <math.h>
#include <placido/image.h>
#include <placido/phantom.h>
#include <placido/session.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>

_Static_assert(FLT_EVAL_METHOD == 0, "every operation is rounded to its own type");

/* How many of some truths of IEEE 754 do not hold in this thread. What is volatile is computed when
 * the program runs. */
static int falsehoods(void) {
  volatile double least = DBL_MIN, half = 0.5, denormal = DBL_MIN * DBL_EPSILON, nothing = 0;
  volatile float least_float = FLT_MIN, half_float = 0.5F, third = 3;
  volatile double one = 1, tiny = DBL_EPSILON / 2, large = DBL_MAX;
  int wrong = 0;
  wrong += !(least * half > 0);                      /* flushed when it comes out */
  wrong += !(least - least * (1 - DBL_EPSILON) > 0); /* x != y where x - y is flushed */
  wrong += !(denormal * 2 == 2 * DBL_MIN * DBL_EPSILON && denormal > 0); /* or when it goes in */
  wrong += !(least_float * half_float > 0);
  wrong += !(one + tiny == 1 && -one - tiny == -1); /* rounded to the nearest, even */
  wrong += !(one + tiny * 3 == 1 + 2 * DBL_EPSILON);
  wrong += !(large * 2 == INFINITY && isnan(nothing / nothing) && 1 / -nothing == -INFINITY);
  wrong += !((double)(1 / third) == 0.3333333432674407958984375); /* a float is no double inside */
  wrong += fegetround() != FE_TONEAREST;
  return wrong;
}

static int falsehoods_anywhere(void) {
  int wrong = falsehoods();
#pragma omp parallel num_threads(4) reduction(+ : wrong)
  { wrong += falsehoods(); }
  return wrong;
}

static void look(const char *when) {
  const struct stability_row row = {.name = when,
                                    .condition = NAN,
                                    .perturbation = NAN,
                                    .change = falsehoods_anywhere(),
                                    .out_unit = "untrue",
                                    .bound = 0,
                                    .extended = NAN};
  stability_add(&row);
}

static void at_first(void **state) {
  (void)state;
  look("when the program starts");
}

static void after_opencv(void **state) {
  placido_image image, large;
  placido_error err = {0};
  char *path = scratch_path(state, "picture.png");
  assert_int_equal(placido_image_new(&image, 200, 150, 3, NULL), PLACIDO_OK);
  assert_int_equal(placido_image_new(&large, 500, 400, 3, NULL), PLACIDO_OK);
  assert_int_equal(placido_cv_blur(&image, 2, 2, &err), PLACIDO_OK);
  assert_int_equal(placido_cv_resize(&large, &image, PLACIDO_CV_CUBIC, &err), PLACIDO_OK);
  assert_int_equal(placido_image_save_png(&large, path, NULL), PLACIDO_OK);
  placido_image_free(&image);
  assert_int_equal(placido_image_load(&image, path, NULL), PLACIDO_OK);
  free(path);
  placido_image_free(&image);
  placido_image_free(&large);
  look("after OpenCV");
}

static void after_fftw(void **state) {
  (void)state;
  enum { SIZE = 120, BUCKETS = 21 };
  static double values[BUCKETS * BUCKETS];
  float *source = noise_plane(SIZE, SIZE, 1);
  const placido_psf psf = noise_psf(values, BUCKETS, 2);
  for (int doubles = 0; doubles < 2; doubles++) {
    const placido_convolution how = {.doubles = doubles, .threads = 2};
    free(convolved_plane(source, SIZE, SIZE, &psf, &how));
  }
  free(source);
  look("after FFTW");
}

/* In a build without sessions there is nothing to look at. */
static void after_ffmpeg(void **state) {
  char *session = scratch_path(state, "eye");
  placido_instrument instrument;
  placido_surface *surface;
  placido_session_reader *reader;
  placido_frame frame = {0};
  placido_notes notes = {0};
  placido_error err = {0};
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_eye(&surface, "sphere", NULL), PLACIDO_OK);
  int status = placido_phantom_session(session, surface, &instrument, "OD", 1, 10, NULL, 2, &err);
  if (status != PLACIDO_UNSUPPORTED) {
    assert_int_equal(status, PLACIDO_OK);
    assert_int_equal(placido_session_reader_open(&reader, session, &notes, &err), PLACIDO_OK);
    assert_int_equal(placido_session_reader_next(reader, &frame, &err), PLACIDO_OK);
    placido_session_reader_close(reader);
    placido_frame_free(&frame);
    look("after FFmpeg");
  }
  free(session);
  placido_surface_free(surface);
}

static void nothing_is_untrue(void **state) {
  (void)state;
  assert_int_equal(stability_print("arithmetic: the processor's modes"), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(at_first),          cmocka_unit_test(after_opencv),
      cmocka_unit_test(after_fftw),        cmocka_unit_test(after_ffmpeg),
      cmocka_unit_test(nothing_is_untrue),
  };
  return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
