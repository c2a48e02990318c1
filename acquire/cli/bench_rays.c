/* How long the geometric point spread function takes, against a loop that does no more than it has
 * to: trace a conicoid whose formula it knows, and count. */
#include "acquire/cli/bench_simulate.h"
#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/psf/geometric.h"

#include <placido/simulate.h>

#include <math.h>
#include <stdint.h>
#include <string.h>

#define PUPIL_MM 4.0
#define BUCKETS 257
#define FEW_SAMPLES 100  /* 100² + 99² = 19,801 rays */
#define MANY_SAMPLES 708 /* 1,001,113 */

/* A number of rays, how often, and what its figures are called. */
struct size {
  int samples, repeats, quick_repeats;
  const char *loop, *spread, *counted;
};

static const struct size sizes[] = {
    {FEW_SAMPLES, 31, 2, "tight loop: 19,801 rays, conicoid", "spread of 19,801 rays",
     "count of 19,801 rays"},
    {MANY_SAMPLES, 9, 1, "tight loop: a million rays, conicoid", "spread of a million rays",
     "count of a million rays"},
};

struct work {
  const placido_surface *surface;
  placido_eye eye; /* with everything decided: nothing is searched */
  placido_apex apex;
  double fixation_mm[2];
  uint32_t *buckets;
};

struct laps {
  struct bench_laps loop, spread, counted;
};

static int prepare(struct work *work, const placido_surface *surface, placido_error *err) {
  const placido_eye eye = {.pupil_mm = PUPIL_MM};
  const placido_optics optics = {.samples = FEW_SAMPLES};
  placido_psf psf;
  int status = placido_psf_new(&psf, &work->eye, surface, &eye, &optics, NULL, err);
  work->surface = surface;
  work->fixation_mm[0] = psf.centre_x_um / 1000;
  work->fixation_mm[1] = psf.centre_y_um / 1000;
  placido_psf_free(&psf);
  if (status == PLACIDO_OK) {
    status = placido_apex_find(&work->apex, surface, &work->eye, err);
  }
  if (status == PLACIDO_OK) {
    work->buckets = placido_memory_new((size_t)BUCKETS * BUCKETS, sizeof *work->buckets, err);
    status = work->buckets ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  return status;
}

/* One row of the loop: conic sag and slope, Snell's law, the plane retina, all in doubles. */
static void trace_row(uint32_t *buckets, double first_mm, double step_mm, int count, double y_mm,
                      double bucket_mm) {
  const double curvature = 1 / 7.8, k = 0.8 * curvature * curvature, slowness = 1 / 1.3375;
  const double retina_mm = 30.9;
  double column[FEW_SAMPLES], row[FEW_SAMPLES];
  for (int i = 0; i < count; i++) {
    double x_mm = first_mm + i * step_mm, square = x_mm * x_mm + y_mm * y_mm;
    double root = sqrt(1 - k * square), slope = curvature / root;
    double sag = curvature * square / (1 + root);
    double cosine = 1 / sqrt(1 + slope * slope * square);
    double bend = slowness * cosine - sqrt(1 - slowness * slowness * (1 - cosine * cosine));
    double reach = bend * cosine * slope * (retina_mm - sag) / (slowness - bend * cosine);
    column[i] = (x_mm + reach * x_mm) / bucket_mm + BUCKETS / 2.0;
    row[i] = (y_mm + reach * y_mm) / bucket_mm + BUCKETS / 2.0;
  }
  for (int i = 0; i < count; i++) {
    if (column[i] >= 0 && column[i] < BUCKETS && row[i] >= 0 && row[i] < BUCKETS) {
      buckets[(size_t)row[i] * BUCKETS + (size_t)column[i]]++;
    }
  }
}

/* Rows of both grids in pieces that the loop has room for. */
static void run_loop(struct bench_laps *laps, const struct work *work, int samples) {
  const double radius_mm = PUPIL_MM / 2, step_mm = PUPIL_MM / (samples - 1);
  const double bucket_mm = 0.0034; /* half a minute */
  bench_lap_begin(laps);
  memset(work->buckets, 0, (size_t)BUCKETS * BUCKETS * sizeof *work->buckets);
  for (int line = 0; line < 2 * samples - 1; line++) {
    double y_mm = line * step_mm / 2 - radius_mm;
    double half = sqrt(fmax(radius_mm * radius_mm - y_mm * y_mm, 0));
    int left = (int)(2 * half / step_mm);
    double first_mm = -left * step_mm / 2;
    for (; left > 0; left -= FEW_SAMPLES, first_mm += FEW_SAMPLES * step_mm) {
      trace_row(work->buckets, first_mm, step_mm, left < FEW_SAMPLES ? left : FEW_SAMPLES, y_mm,
                bucket_mm);
    }
  }
  bench_lap_end(laps);
}

static int run_psf(struct bench_laps *laps, const struct work *work, int samples,
                   enum placido_light_kind light, placido_error *err) {
  const placido_optics asked = {.samples = samples, .light = light, .buckets = BUCKETS};
  placido_optics optics;
  placido_psf psf = {0};
  int status = placido_optics_settle(&optics, &asked, err);
  if (status == PLACIDO_OK) {
    bench_lap_begin(laps);
    status = placido_geometric_fill(&psf, work->surface, &work->apex, &work->eye, &optics,
                                    work->fixation_mm, err);
    bench_lap_end(laps);
  }
  placido_psf_free(&psf);
  return status;
}

static int measure(struct bench_report *report, const struct work *work, const struct size *size,
                   bool quick, placido_error *err) {
  struct laps laps = {0};
  int repeats = quick ? size->quick_repeats : size->repeats, status = PLACIDO_OK;
  for (int i = 0; i < repeats && status == PLACIDO_OK; i++) {
    run_loop(&laps.loop, work, size->samples);
    status = run_psf(&laps.spread, work, size->samples, PLACIDO_LIGHT_SPREAD, err);
    if (status == PLACIDO_OK) {
      status = run_psf(&laps.counted, work, size->samples, PLACIDO_LIGHT_COUNTED, err);
    }
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, size->loop, &laps.loop, NULL, NULL, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_report_laps(report, size->spread, &laps.spread, &laps.loop, size->loop, err);
  }
  return status == PLACIDO_OK ? bench_report_laps(report, size->counted, &laps.counted,
                                                  &laps.loop, size->loop, err)
                              : status;
}

int bench_rays(struct bench_report *report, const placido_surface *surface, bool quick,
               placido_error *err) {
  struct work work = {0};
  int status = prepare(&work, surface, err);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes && status == PLACIDO_OK; i++) {
    status = measure(report, &work, &sizes[i], quick, err);
  }
  placido_memory_free(work.buckets);
  return status;
}
