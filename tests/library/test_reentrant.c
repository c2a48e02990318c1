/* The simulation core from several threads at once: each gets what it gets alone. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <placido/phantom.h>
#include <placido/simulate.h>
#include <pthread.h>
#include <string.h>

#define THREADS 4
#define ROUNDS 2

/* One user of the library: an eye, and what it sees. */
struct user {
  const char *eye;
  double pupil_mm;
  int threads, status;
  placido_psf psf;
  placido_image seen;
};

static const struct user users[THREADS] = {
    {.eye = "normal", .pupil_mm = 3, .threads = 1},
    {.eye = "keratoconus", .pupil_mm = 5, .threads = 2},
    {.eye = "astigmatic", .pupil_mm = 4, .threads = 1},
    {.eye = "diplopic", .pupil_mm = 6, .threads = 2},
};

static void forget(struct user *user) {
  placido_image_free(&user->seen);
  placido_psf_free(&user->psf);
}

static void *look(void *data) {
  struct user *user = data;
  const placido_eye eye = {.pupil_mm = user->pupil_mm, .correct = PLACIDO_CORRECT_FULL};
  const placido_optics optics = {.samples = 100, .buckets = 129, .threads = user->threads};
  placido_surface *surface = NULL;
  placido_scene scene = {0};
  user->status = placido_phantom_eye(&surface, user->eye, NULL);
  for (int round = 0; round < ROUNDS && !user->status; round++) {
    forget(user);
    if (!(user->status = placido_psf_new(&user->psf, NULL, surface, &eye, &optics, NULL, NULL)) &&
        !(user->status = placido_scene_load(&scene, "tumbling-e", 1, NULL, NULL))) {
      scene.arcmin_per_px = user->psf.bucket_arcmin; /* as large as it is drawn: no resampling */
      user->status = placido_scene_see(&user->seen, &scene, &user->psf, user->threads, NULL);
    }
    placido_scene_free(&scene);
  }
  placido_surface_free(surface);
  return NULL;
}

static void at_once_as_alone(void **state) {
  (void)state;
  struct user alone[THREADS], together[THREADS];
  pthread_t threads[THREADS];
  for (int i = 0; i < THREADS; i++) {
    alone[i] = together[i] = users[i];
    look(&alone[i]);
    assert_int_equal(alone[i].status, PLACIDO_OK);
  }
  for (int i = 0; i < THREADS; i++) {
    assert_int_equal(pthread_create(&threads[i], NULL, look, &together[i]), 0);
  }
  for (int i = 0; i < THREADS; i++) {
    pthread_join(threads[i], NULL);
    assert_int_equal(together[i].status, PLACIDO_OK);
    assert_int_equal(together[i].psf.n, alone[i].psf.n);
    size_t buckets = (size_t)alone[i].psf.n * (size_t)alone[i].psf.n;
    assert_memory_equal(together[i].psf.values, alone[i].psf.values, buckets * sizeof(double));
    const placido_image *seen = &alone[i].seen;
    assert_memory_equal(together[i].seen.data, seen->data,
                        (size_t)seen->width_px * (size_t)seen->height_px * sizeof *seen->data);
    forget(&alone[i]);
    forget(&together[i]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(at_once_as_alone)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
