/* Measured transforms: kept in the folder that was said, used again, ignored where broken, and
 * nobody else's business. */
#include "tests/simulate/planes.h"
#include "tests/support/near.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define WIDTH 90
#define HEIGHT 61
#define N 21

typedef struct fixture {
  char root[64], folder[80], file[128];
  double values[N * N];
  placido_psf psf;
  float *source;
} fixture;

static int set_up(void **state) {
  fixture *f = calloc(1, sizeof *f);
  assert_non_null(f);
  snprintf(f->root, sizeof f->root, "/tmp/placido-wisdom-XXXXXX");
  assert_non_null(mkdtemp(f->root));
  snprintf(f->folder, sizeof f->folder, "%s/a/b", f->root);
  snprintf(f->file, sizeof f->file, "%s/fftw-float.wisdom", f->folder);
  f->psf = noise_psf(f->values, N, 3);
  f->source = noise_plane(WIDTH, HEIGHT, 7);
  *state = f;
  return 0;
}

static int tear_down(void **state) {
  fixture *f = *state;
  char name[128];
  unlink(f->file);
  snprintf(name, sizeof name, "%s/fftw-double.wisdom", f->folder);
  unlink(name);
  rmdir(f->folder);
  snprintf(name, sizeof name, "%s/a", f->root);
  rmdir(name);
  assert_int_equal(rmdir(f->root), 0); /* nothing else was left behind */
  free(f->source);
  free(f);
  return 0;
}

static float *measured(const fixture *f, bool doubles, placido_notes *notes) {
  const placido_convolution how = {.doubles = doubles, .wisdom_folder = f->folder};
  placido_convolver *convolver;
  assert_int_equal(placido_convolver_new(&convolver, WIDTH, HEIGHT, N / 2, &how, notes, NULL),
                   PLACIDO_OK);
  placido_convolver_free(convolver);
  return convolved_plane(f->source, WIDTH, HEIGHT, &f->psf, &how);
}

static void test_what_was_measured_is_kept_and_used_again(void **state) {
  const fixture *f = *state;
  placido_notes notes = {0};
  struct stat first, second;
  float *one = measured(f, false, &notes);
  assert_int_equal(stat(f->file, &first), 0);
  assert_true(first.st_size > 0);
  float *two = measured(f, false, &notes);
  assert_int_equal(stat(f->file, &second), 0);
  assert_true(first.st_ino == second.st_ino); /* nothing new: not written again */
  assert_memory_equal(one, two, WIDTH * HEIGHT * sizeof *one);
  assert_int_equal(notes.count, 0);
  float *exact = measured(f, true, &notes);
  for (int i = 0; i < WIDTH * HEIGHT; i++) {
    assert_near(one[i], exact[i], 1e-6);
  }
  assert_int_equal(notes.count, 0);
  free(one);
  free(two);
  free(exact);
}

static void test_broken_wisdom_is_told_and_replaced(void **state) {
  const fixture *f = *state;
  const char *const texts[] = {"", "nonsense", "(fftw-3.3.10 fftwf_wisdom #x0 #x0 #x0 #x0",
                               "\1\2("};
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    placido_notes notes = {0};
    free(measured(f, false, NULL));
    FILE *file = fopen(f->file, "wb");
    assert_non_null(file);
    fputs(texts[i], file);
    fclose(file);
    free(measured(f, false, &notes));
    assert_int_equal(notes.count, 1);
    assert_non_null(strstr(notes.lines[0], "no wisdom"));
    placido_notes_clear(&notes);
    free(measured(f, false, &notes));
    assert_int_equal(notes.count, 0);
    unlink(f->file);
  }
}

static void test_folder_that_cannot_be_made_is_told_and_no_failure(void **state) {
  fixture *f = *state;
  placido_notes notes = {0};
  char kept[sizeof f->folder];
  memcpy(kept, f->folder, sizeof kept);
  snprintf(f->folder, sizeof f->folder, "/dev/null/cache");
  float *result = measured(f, false, &notes);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "not kept"));
  assert_near(result[30 * WIDTH + 40], direct_sum(f->source, WIDTH, HEIGHT, &f->psf, 40, 30), 1e-6);
  memcpy(f->folder, kept, sizeof kept);
  placido_notes_clear(&notes);
  free(result);
}

static void test_others_get_the_same_bits_as_without(void **state) {
  const fixture *f = *state;
  float *before = convolved_plane(f->source, WIDTH, HEIGHT, &f->psf, NULL);
  free(measured(f, false, NULL));
  float *after = convolved_plane(f->source, WIDTH, HEIGHT, &f->psf, NULL);
  assert_memory_equal(before, after, WIDTH * HEIGHT * sizeof *before);
  free(before);
  free(after);
}

typedef struct caller {
  const fixture *f;
  float *result;
} caller;

static void *call(void *user) {
  caller *c = user;
  for (int i = 0; i < 20; i++) {
    free(c->result);
    c->result = convolved_plane(c->f->source, WIDTH, HEIGHT, &c->f->psf, NULL);
  }
  return NULL;
}

/* Planner and convolvers are used by callers who do not know of each other. */
static void test_callers_at_the_same_time_do_not_disturb_each_other(void **state) {
  const fixture *f = *state;
  pthread_t threads[4];
  caller callers[4];
  float *alone = convolved_plane(f->source, WIDTH, HEIGHT, &f->psf, NULL);
  for (int i = 0; i < 4; i++) {
    callers[i] = (caller){f, NULL};
    assert_int_equal(pthread_create(&threads[i], NULL, call, &callers[i]), 0);
  }
  for (int i = 0; i < 4; i++) {
    assert_int_equal(pthread_join(threads[i], NULL), 0);
    assert_memory_equal(callers[i].result, alone, WIDTH * HEIGHT * sizeof *alone);
    free(callers[i].result);
  }
  free(alone);
}

static void expect_folder(const char *cache, const char *home, const char *expected) {
  char folder[64];
  if (cache != NULL) {
    setenv("XDG_CACHE_HOME", cache, 1);
  } else {
    unsetenv("XDG_CACHE_HOME");
  }
  if (home != NULL) {
    setenv("HOME", home, 1);
  } else {
    unsetenv("HOME");
  }
  int status = placido_wisdom_folder(folder, sizeof folder, NULL);
  assert_int_equal(status, expected[0] != '\0' ? PLACIDO_OK : PLACIDO_SYSTEM);
  assert_string_equal(folder, expected);
}

static void test_folder_is_the_users_cache(void **state) {
  (void)state;
  expect_folder("/var/c", "/home/u", "/var/c/placido");
  expect_folder("relative", "/home/u", "/home/u/.cache/placido");
  expect_folder(NULL, "/home/u", "/home/u/.cache/placido");
  expect_folder(NULL, NULL, "");
  expect_folder("/0123456789012345678901234567890123456789012345678901234567890123456789", NULL,
                "");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_what_was_measured_is_kept_and_used_again, set_up,
                                      tear_down),
      cmocka_unit_test_setup_teardown(test_broken_wisdom_is_told_and_replaced, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_folder_that_cannot_be_made_is_told_and_no_failure,
                                      set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_others_get_the_same_bits_as_without, set_up, tear_down),
      cmocka_unit_test_setup_teardown(test_callers_at_the_same_time_do_not_disturb_each_other,
                                      set_up, tear_down),
      cmocka_unit_test(test_folder_is_the_users_cache),
  };
  return cmocka_run_group_tests_name("simulate_wisdom", tests, NULL, NULL);
}
