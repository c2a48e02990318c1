/* How long a picture takes to be spread by the point spread function, against one transform of that
 * size. */
#include "acquire/cli/bench_simulate.h"
#include "base/memory.h"
#include "simulate/convolve.h"
#include "simulate/fft.h"

#include <placido/simulate.h>

#define REPEATS 15
#define QUICK_REPEATS 2
#define PUPIL_MM 4.0
#define SCENE_PX 512
#define TRANSFORM "one transform of that size"

struct laps {
  struct bench_laps transform, convolution;
};

struct work {
  placido_psf psf;
  placido_image scene, seen;
  placido_fft fft;
  float *plane;
};

static int prepare(struct work *work, const placido_surface *surface, placido_error *err) {
  const placido_eye eye = {.pupil_mm = PUPIL_MM};
  const placido_optics optics = {.samples = 100};
  int status = placido_psf_new(&work->psf, NULL, surface, &eye, &optics, NULL, err);
  if (status == PLACIDO_OK) {
    status = placido_image_new(&work->scene, SCENE_PX, SCENE_PX, 1, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_image_new(&work->seen, SCENE_PX, SCENE_PX, 1, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  for (size_t i = 0; i < (size_t)SCENE_PX * SCENE_PX; i++) {
    work->scene.data[i] = (float)(i / 16 % 2); /* stripes */
  }
  const int padded = SCENE_PX + work->psf.n / 2; /* as wide as the convolution's transform */
  work->fft = placido_fft_shape(padded, padded);
  work->plane = placido_memory_new(work->fft.plane, sizeof *work->plane, err);
  return work->plane ? placido_fft_new(&work->fft, work->plane, err) : PLACIDO_MEMORY;
}

static void free_work(struct work *work) {
  placido_fft_free(&work->fft);
  placido_memory_free(work->plane);
  placido_image_free(&work->seen);
  placido_image_free(&work->scene);
  placido_psf_free(&work->psf);
}

static int repeat(struct laps *laps, struct work *work, placido_error *err) {
  bench_lap_begin(&laps->transform);
  placido_fft_forward(&work->fft, work->plane);
  bench_lap_end(&laps->transform);
  bench_lap_begin(&laps->convolution);
  int status = placido_convolve(&work->seen, &work->scene, &work->psf, 1, err);
  bench_lap_end(&laps->convolution);
  return status;
}

int bench_spread(struct bench_report *report, const placido_surface *surface, bool quick,
                 placido_error *err) {
  struct work work = {0};
  struct laps laps = {0};
  int status = prepare(&work, surface, err);
  for (int i = 0; status == PLACIDO_OK && i < (quick ? QUICK_REPEATS : REPEATS); i++) {
    status = repeat(&laps, &work, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, TRANSFORM, &laps.transform, NULL, NULL, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, "convolution of 512×512", &laps.convolution,
                               &laps.transform, TRANSFORM, err);
  }
  free_work(&work);
  return status;
}
