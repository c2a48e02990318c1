/* How long a picture takes to be spread by a point spread function of 257×257 buckets, against the
 * transforms alone: for each colour one there and one back, and one for the PSF, by FFTW at once. */
#include "acquire/cli/bench_simulate.h"
#include "base/memory.h"
#include "simulate/convolve.h"
#include "simulate/fft.h"

#include <placido/simulate.h>

#define BUCKETS 257
#define COLOURS 3

/* What is measured. All in one thread. */
struct spread_case {
  int width, height, repeats;
  bool doubles, when_quick;
  const char *transforms, *convolution;
};

static const struct spread_case cases[] = {
    {500, 250, 25, false, true, "transforms of 500×250×3", "convolution of 500×250×3"},
    {500, 250, 25, true, true, "transforms of 500×250×3", "the same in double precision"},
    {3840, 2160, 5, false, false, "transforms of 3840×2160×3", "convolution of 3840×2160×3"},
};

struct work {
  placido_psf psf;
  placido_image scene, seen;
  placido_fft fft;
  float *plane;
};

/* A PSF with light to its rim, as a large pupil gives it: an empty rim is not transformed. */
static int make_psf(placido_psf *psf, placido_error *err) {
  *psf = (placido_psf){.n = BUCKETS, .bucket_arcmin = 0.5};
  psf->values = placido_memory_new((size_t)BUCKETS * BUCKETS, sizeof *psf->values, err);
  for (int i = 0; psf->values != NULL && i < BUCKETS * BUCKETS; i++) {
    psf->values[i] = (1 + i % 7) / (4.0 * BUCKETS * BUCKETS);
  }
  return psf->values != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
}

static int prepare(struct work *work, const struct spread_case *c, placido_error *err) {
  int status = make_psf(&work->psf, err);
  if (status == PLACIDO_OK) {
    status = placido_image_new(&work->scene, c->width, c->height, COLOURS, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_image_new(&work->seen, c->width, c->height, COLOURS, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  for (size_t i = 0; i < (size_t)c->width * (size_t)c->height * COLOURS; i++) {
    work->scene.data[i] = (float)(i / 16 % 2); /* stripes */
  }
  work->fft = placido_fft_shape(placido_fft_fast_length(c->width + BUCKETS / 2),
                                placido_fft_fast_length(c->height + BUCKETS / 2));
  work->plane = placido_memory_new_aligned(work->fft.plane * sizeof *work->plane, err);
  return work->plane ? placido_fft_new(&work->fft, work->plane, err) : PLACIDO_MEMORY;
}

static void free_work(struct work *work) {
  placido_fft_free(&work->fft);
  placido_memory_free(work->plane);
  placido_image_free(&work->seen);
  placido_image_free(&work->scene);
  placido_psf_free(&work->psf);
}

static void transform(struct bench_laps *laps, struct work *work) {
  for (size_t i = 0; i < work->fft.plane; i++) {
    work->plane[i] = 1e-3f * (float)(i % 8);
  }
  bench_lap_begin(laps);
  placido_fft_forward(&work->fft, work->plane);
  for (int colour = 0; colour < COLOURS; colour++) {
    placido_fft_backward(&work->fft, work->plane);
    placido_fft_forward(&work->fft, work->plane);
  }
  bench_lap_end(laps);
}

static int measure(struct bench_report *report, const struct spread_case *c, bool quick,
                   placido_error *err) {
  const placido_convolution how = {.doubles = c->doubles};
  struct work work = {0};
  struct bench_laps transforms = {0}, convolution = {0};
  int status = prepare(&work, c, err);
  for (int i = 0; status == PLACIDO_OK && i < (quick ? 2 : c->repeats); i++) {
    transform(&transforms, &work);
    bench_lap_begin(&convolution);
    status = placido_convolve_as(&work.seen, &work.scene, &work.psf, &how, NULL, err);
    bench_lap_end(&convolution);
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, c->transforms, &transforms, NULL, NULL, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, c->convolution, &convolution, &transforms, c->transforms,
                               err);
  }
  free_work(&work);
  return status;
}

int bench_spread(struct bench_report *report, const placido_surface *surface, bool quick,
                 placido_error *err) {
  int status = PLACIDO_OK;
  (void)surface;
  for (size_t i = 0; i < sizeof cases / sizeof *cases && status == PLACIDO_OK; i++) {
    if (!quick || cases[i].when_quick) {
      status = measure(report, &cases[i], quick, err);
    }
  }
  return status;
}
