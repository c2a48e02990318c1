/* How long a diffraction image takes, against the transforms that its pupil needs alone, and a fit
 * of Zernike terms, against computing the terms. */
#include "acquire/cli/bench_simulate.h"
#include "base/memory.h"
#include "simulate/fft.h"

#include <placido/diffraction.h>
#include <placido/wavefront.h>

#include <math.h>

#define BUCKETS 257
#define PUPIL_MM 4.0
#define GREEN_NM 555.0
#define WAVES 31
#define SIDE 576 /* twice the pupil's samples for GREEN_NM, as it is padded */
#define POINTS 100000
#define ORDER 7 /* 36 terms */
#define TERMS 36
#define REPEATS 15
#define TRANSFORMS "transforms of 576×576"
#define EVALUATION "36 Zernike terms at 100,000 points"

/* Of an aberrated eye, OSA indices, micrometres. */
static const double eye_um[15] = {[3] = 0.03, [4] = 0.10, [5] = -0.08, [6] = 0.06,
                                  [7] = 0.12, [8] = 0.05, [9] = -0.04, [12] = 0.07};

struct work {
  placido_pupil pupil;
  placido_wave waves[WAVES];
  placido_fft fft;
  float *plane;
  double *image;
  double *x, *y, *z, *terms;
};

static void scatter(struct work *work) {
  double a = 0.5, b = 0.5;
  for (size_t i = 0; i < POINTS;) { /* additive recurrence: fills the square evenly */
    a = fmod(a + 0.7548776662466927, 1.0);
    b = fmod(b + 0.5698402909980532, 1.0);
    work->x[i] = 2 * a - 1;
    work->y[i] = 2 * b - 1;
    work->z[i] = a * b;
    i += work->x[i] * work->x[i] + work->y[i] * work->y[i] <= 1;
  }
}

static int prepare(struct work *work, placido_error *err) {
  int status = placido_pupil_of_terms(&work->pupil, PUPIL_MM, eye_um, 15, 0, err);
  if (status == PLACIDO_OK) {
    status = placido_waves_white(work->waves, WAVES, 400, 700, GREEN_NM, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  work->image = placido_memory_new((size_t)BUCKETS * BUCKETS, sizeof *work->image, err);
  work->x = placido_memory_new((size_t)POINTS, (3 + TERMS) * sizeof *work->x, err);
  work->fft = placido_fft_shape(SIDE, SIDE);
  work->plane = placido_memory_new_aligned(work->fft.plane * sizeof *work->plane, err);
  if (!work->image || !work->x || !work->plane) {
    return PLACIDO_MEMORY;
  }
  work->y = work->x + POINTS;
  work->z = work->x + 2 * POINTS;
  work->terms = work->x + 3 * POINTS;
  scatter(work);
  return placido_fft_new(&work->fft, work->plane, err);
}

static void free_work(struct work *work) {
  placido_pupil_free(&work->pupil);
  placido_fft_free(&work->fft);
  placido_memory_free(work->plane);
  placido_memory_free(work->image);
  placido_memory_free(work->x);
}

/* What no way through the autocorrelation can do without: a complex and a real transform. */
static void transform(struct bench_laps *laps, struct work *work) {
  for (size_t i = 0; i < work->fft.plane; i++) {
    work->plane[i] = 1e-3f * (float)(i % 8);
  }
  bench_lap_begin(laps);
  placido_fft_forward(&work->fft, work->plane);
  placido_fft_backward(&work->fft, work->plane);
  placido_fft_forward(&work->fft, work->plane);
  bench_lap_end(laps);
}

static int image(struct bench_laps *laps, struct work *work, const placido_wave *waves,
                 size_t count, placido_error *err) {
  const placido_window window = {.buckets = BUCKETS};
  bench_lap_begin(laps);
  int status =
      placido_diffraction(work->image, NULL, &work->pupil, waves, count, &window, err);
  bench_lap_end(laps);
  return status;
}

static int fit(struct bench_laps *evaluation, struct bench_laps *fitting, struct work *work,
               placido_error *err) {
  placido_zernike_fit found;
  bench_lap_begin(evaluation);
  placido_zernike_terms(work->terms, ORDER, work->x, work->y, POINTS);
  bench_lap_end(evaluation);
  bench_lap_begin(fitting);
  int status = placido_zernike_fit_points(&found, ORDER, work->x, work->y, work->z, NULL, POINTS,
                                          err);
  bench_lap_end(fitting);
  return status;
}

struct laps {
  struct bench_laps transforms, green, white, evaluation, fitting;
};

static int tell(struct bench_report *report, const struct laps *laps, placido_error *err) {
  const struct {
    const char *what;
    const struct bench_laps *laps, *reference;
    const char *against;
  } rows[] = {
      {TRANSFORMS, &laps->transforms, NULL, NULL},
      {"diffraction of a 4 mm pupil, 555 nm", &laps->green, &laps->transforms, TRANSFORMS},
      {"the same, 31 wavelengths", &laps->white, &laps->transforms, TRANSFORMS},
      {EVALUATION, &laps->evaluation, NULL, NULL},
      {"fit of them to 100,000 values", &laps->fitting, &laps->evaluation, EVALUATION},
  };
  int status = PLACIDO_OK;
  for (size_t i = 0; i < sizeof rows / sizeof *rows && status == PLACIDO_OK; i++) {
    status = bench_report_laps(report, rows[i].what, rows[i].laps, rows[i].reference,
                               rows[i].against, err);
  }
  return status;
}

int bench_waves(struct bench_report *report, const placido_surface *surface, bool quick,
                placido_error *err) {
  const placido_wave green = {.wavelength_nm = GREEN_NM, .weight = 1};
  struct work work = {0};
  struct laps laps = {0};
  (void)surface;
  int status = prepare(&work, err);
  for (int i = 0; status == PLACIDO_OK && i < (quick ? 1 : REPEATS); i++) {
    transform(&laps.transforms, &work);
    status = image(&laps.green, &work, &green, 1, err);
    if (status == PLACIDO_OK) {
      status = image(&laps.white, &work, work.waves, WAVES, err);
    }
    if (status == PLACIDO_OK) {
      status = fit(&laps.evaluation, &laps.fitting, &work, err);
    }
  }
  if (status == PLACIDO_OK) {
    status = tell(report, &laps, err);
  }
  free_work(&work);
  return status;
}
