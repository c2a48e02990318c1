/* Geometric PSF: every thread counts a share of the pupil, the sum is divided by what entered;
 * where too much falls outside, again with more buckets. */
#include "simulate/psf/geometric.h"

#include "base/memory.h"
#include "simulate/psf/footprint.h"

#include <math.h>
#include <string.h>

static const double outside_max = 0.001; /* share beyond which the PSF grows */

/* What the threads have counted. */
typedef struct counts {
  placido_tally *tallies;
  placido_arrivals *arrivals;
  int *statuses, threads;
} counts;

static void counts_free(counts *c) {
  for (int i = 0; c->tallies != NULL && i < c->threads; i++) {
    placido_tally_free(&c->tallies[i]);
  }
  placido_memory_free(c->tallies);
  placido_memory_free(c->arrivals);
  placido_memory_free(c->statuses);
  *c = (counts){0};
}

static int counts_new(counts *c, int threads, int n, int rings, placido_error *err) {
  *c = (counts){.threads = threads};
  c->tallies = placido_memory_new((size_t)threads, sizeof *c->tallies, err);
  c->arrivals = placido_memory_new((size_t)threads, sizeof *c->arrivals, err);
  c->statuses = placido_memory_new((size_t)threads, sizeof *c->statuses, err);
  int status = c->tallies && c->arrivals && c->statuses ? PLACIDO_OK : PLACIDO_MEMORY;
  for (int i = 0; i < threads && status == PLACIDO_OK; i++) {
    status = placido_tally_new(&c->tallies[i], n, rings, err);
  }
  if (status != PLACIDO_OK) {
    counts_free(c);
  }
  return status;
}

/* Adds everything up in the first thread's; tells of memory that a thread lacked. */
static int gather(counts *c, placido_error *err) {
  placido_arrivals *sum = &c->arrivals[0];
  int status = c->statuses[0];
  for (int i = 1; i < c->threads; i++) {
    const placido_arrivals *more = &c->arrivals[i];
    status = status == PLACIDO_OK ? c->statuses[i] : status;
    placido_tally_merge(&c->tallies[0], &c->tallies[i]);
    sum->entered += more->entered;
    sum->landed += more->landed;
    sum->missed += more->missed;
    sum->grazed += more->grazed;
    sum->reflected += more->reflected;
    sum->light += more->light;
  }
  return status == PLACIDO_OK
           ? PLACIDO_OK
           : placido_error_set(err, status, "out of memory while rays were traced");
}

static int count(counts *c, const placido_light_count *how, placido_error *err) {
#pragma omp parallel for num_threads(c->threads) if (c->threads > 1)
  for (int i = 0; i < c->threads; i++) {
    c->statuses[i] =
      placido_footprint_count(&c->tallies[i], &c->arrivals[i], how, i, c->threads, NULL);
  }
  return gather(c, err);
}

/* The least number of buckets a side beside which no more than outside_max of the light falls; the
 * tally's own where that is enough or no more are allowed. */
static int find_size(const placido_tally *tally, int64_t light) {
  int64_t beyond = tally->outside[tally->rings - 1]; /* beside even the most */
  int64_t most = (int64_t)(outside_max * (double)light);
  int ring = tally->rings - 1;
  while (ring > (tally->n + 1) / 2 && beyond + tally->outside[ring - 1] <= most) {
    beyond += tally->outside[--ring];
  }
  return 2 * ring - 1;
}

/* Rings of buckets that a PSF may grow to, and one for what is beyond. */
static int rings_of(const placido_optics *optics) {
  int most = (int)fmin(optics->buckets * optics->grow, PLACIDO_PSF_BUCKETS_MAX);
  return (most + 1) / 2 + 1;
}

/* All the light in the tally, and the most in a bucket. */
static void add_up(const placido_tally *tally, int64_t *sum, int64_t *most) {
  size_t area = (size_t)tally->n * (size_t)tally->n;
  *sum = *most = 0;
  for (size_t i = 0; i < area; i++) {
    *sum += tally->buckets[i];
    *most = tally->buckets[i] > *most ? tally->buckets[i] : *most;
  }
}

/* Light to shares in the same memory; a row where none came is zero as it is. */
static void make_shares(int64_t *buckets, int n, double all) {
  _Static_assert(sizeof(int64_t) == sizeof(double), "a bucket's light and its share are as large");
  for (int row = 0; row < n; row++, buckets += n) {
    int64_t any = 0;
    for (int i = 0; i < n; i++) {
      any |= buckets[i];
    }
    for (int i = 0; i < n && any != 0; i++) {
      double share = (double)buckets[i] / all;
      memcpy(&buckets[i], &share, sizeof share);
    }
  }
}

/* The first tally's memory becomes the PSF's values. They sum to the share of rays that landed: the
 * area-weighted light differs from that by its last digits, and files shall not. */
static int take(placido_psf *psf, counts *c, placido_error *err) {
  placido_tally *tally = &c->tallies[0];
  const placido_arrivals *arrivals = &c->arrivals[0];
  int64_t sum, most;
  add_up(tally, &sum, &most);
  psf->n = tally->n;
  psf->rays_entered = arrivals->entered;
  psf->rays_landed = arrivals->landed;
  psf->rays_grazed = arrivals->grazed;
  psf->rays_reflected = arrivals->reflected;
  psf->rays_missed = arrivals->missed + arrivals->grazed + arrivals->reflected;
  if (psf->rays_landed == 0) {
    return placido_error_set(err, PLACIDO_QUALITY, "no light lands within the PSF's %.4g'",
                             psf->n * psf->bucket_arcmin);
  }
  double entered = (double)psf->rays_entered, landed = (double)psf->rays_landed;
  make_shares(tally->buckets, tally->n,
              psf->rays_landed == psf->rays_entered ? (double)sum
                                                    : (double)sum / landed * entered);
  psf->outside = 1 - landed / entered;
  psf->strehl_g = (double)most / (double)sum;
  psf->values = (double *)tally->buckets;
  *tally = (placido_tally){0};
  return PLACIDO_OK;
}

static void describe(placido_psf *psf, const placido_eye *eye, const placido_optics *optics,
                     const placido_light_count *how) {
  psf->bucket_arcmin = optics->bucket_arcmin;
  psf->bucket_um = 1000 * how->raster.bucket_mm;
  psf->pupil_mm = eye->pupil_mm;
  psf->index = eye->index;
  psf->retina_mm = eye->retina_mm;
  psf->correction = eye->correction;
  psf->rays = how->tracer->pattern.total;
  psf->centre_x_um = 1000 * how->raster.centre_x_mm;
  psf->centre_y_um = 1000 * how->raster.centre_y_mm;
}

int placido_geometric_fill(placido_psf *psf, const placido_surface *surface,
                           const placido_apex *apex, const placido_eye *eye,
                           const placido_optics *optics, const double fixation_mm[2],
                           placido_error *err) {
  placido_tracer tracer;
  counts c = {0};
  int status = placido_tracer_new(&tracer, surface, apex, eye, optics->pattern, optics->rays, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  placido_light_count how = {
    .tracer = &tracer,
    .raster = {.n = optics->buckets,
               .bucket_mm =
                 placido_apex_bucket_um(apex, optics, eye->index, eye->retina_mm) / 1000,
               .centre_x_mm = fixation_mm[0],
               .centre_y_mm = fixation_mm[1]},
    .spread = optics->light == PLACIDO_LIGHT_SPREAD,
    .unit = PLACIDO_TALLY_UNIT};
  describe(psf, eye, optics, &how);
  for (bool grown = false;; grown = true) {
    status = counts_new(&c, optics->threads, how.raster.n, rings_of(optics), err);
    if (status != PLACIDO_OK || (status = count(&c, &how, err)) != PLACIDO_OK) {
      break;
    }
    int size = find_size(&c.tallies[0], c.arrivals[0].light);
    if (grown || size == how.raster.n) {
      status = take(psf, &c, err);
      break;
    }
    how.raster.n = size;
    counts_free(&c);
  }
  counts_free(&c);
  placido_tracer_free(&tracer);
  return status;
}
