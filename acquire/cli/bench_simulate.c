/* `placido bench simulate`: the seed's 19,801 rays, and a scene spread by what they give. */
#include "acquire/cli/bench_sight.h"
#include "base/memory.h"
#include "simulate/convolve.h"
#include "simulate/fft.h"

#include <placido/simulate.h>

#define REPEATS 15
#define QUICK_REPEATS 2
#define SIDE_SAMPLES 100 /* of the crosshatch: 100² + 99² = 19,801 rays */
#define PUPIL_MM 4.0
#define SCENE_PX 512
#define SURFACE "asking the surface once a ray"
#define TRANSFORM "one transform of that size"

struct laps {
  struct bench_laps surface, psf, transform, convolution;
};

/* What is measured, and what it is held against. */
struct work {
  const placido_surface *surface;
  placido_eye eye; /* with everything decided: nothing is searched */
  placido_psf psf;
  placido_image scene, seen;
  placido_fft fft;
  float *plane;
};

static const placido_optics optics = {.samples = SIDE_SAMPLES, .threads = 1};

static int prepare(struct work *work, placido_error *err) {
  const placido_eye eye = {.pupil_mm = PUPIL_MM};
  int status =
      placido_psf_new(&work->psf, &work->eye, work->surface, &eye, &optics, NULL, err);
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

/* A square of the surface within the pupil, asked as often as rays are traced. */
static double ask_surface(struct bench_laps *laps, const placido_surface *surface) {
  double sum = 0.0;
  bench_lap_begin(laps);
  for (int ray = 0; ray < 2 * SIDE_SAMPLES * (SIDE_SAMPLES - 1) + 1; ray++) {
    placido_jet jet;
    const double x = (double)(ray % SIDE_SAMPLES) / SIDE_SAMPLES - 0.5;
    const double y = (double)(ray / SIDE_SAMPLES) / (2 * SIDE_SAMPLES) - 0.5;
    placido_surface_at(surface, x, y, &jet);
    sum += jet.sag;
  }
  bench_lap_end(laps);
  return sum;
}

static int repeat(struct laps *laps, struct work *work, placido_error *err) {
  placido_psf psf = {0};
  if (ask_surface(&laps->surface, work->surface) == 0.0) {
    return placido_error_set(err, PLACIDO_QUALITY, "the surface is flat");
  }
  bench_lap_begin(&laps->psf);
  int status = placido_psf_new(&psf, NULL, work->surface, &work->eye, &optics, NULL, err);
  bench_lap_end(&laps->psf);
  placido_psf_free(&psf);
  if (status != PLACIDO_OK) {
    return status;
  }
  bench_lap_begin(&laps->transform);
  placido_fft_forward(&work->fft, work->plane);
  bench_lap_end(&laps->transform);
  bench_lap_begin(&laps->convolution);
  status = placido_convolve(&work->seen, &work->scene, &work->psf, 1, err);
  bench_lap_end(&laps->convolution);
  return status;
}

static int tell(struct bench_report *report, const struct laps *laps, placido_error *err) {
  int status = bench_report_laps(report, SURFACE, &laps->surface, NULL, NULL, err);
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, "spread of 19,801 rays", &laps->psf, &laps->surface,
                               SURFACE, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, TRANSFORM, &laps->transform, NULL, NULL, err);
  }
  return status == PLACIDO_OK ? bench_report_laps(report, "convolution of 512×512",
                                                  &laps->convolution, &laps->transform, TRANSFORM,
                                                  err)
                              : status;
}

static int run(struct bench_run *bench, placido_error *err) {
  const struct bench_sight *sight;
  struct work work = {0};
  struct laps laps = {0};
  const int repeats = bench->settings->quick ? QUICK_REPEATS : REPEATS;
  int status = bench_sight_get(&sight, bench, err);
  if (status == PLACIDO_OK) {
    work.surface = sight->surface;
    status = prepare(&work, err);
  }
  for (int i = 0; status == PLACIDO_OK && i < repeats; i++) {
    status = repeat(&laps, &work, err);
  }
  if (status == PLACIDO_OK) {
    status = tell(&bench->report, &laps, err);
  }
  free_work(&work);
  return status;
}

const struct bench bench_simulate = {
    .name = "simulate",
    .summary = "point spread function of 19,801 rays and convolution with it on one core",
    .run = run,
};
