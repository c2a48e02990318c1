/* The point spread function: rays counted in square buckets of the visual field.
 *
 * Counts are whole numbers, kept by every thread for itself and added up, so that the result does
 * not depend on the number of threads. */
#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/trace.h"

#include <placido/simulate.h>

#include <math.h>
#include <stdint.h>

static const double missed_share_max = 0.05; /* of the pupil's rays, beyond which it is refused */
static const double lost_share_told = 0.02;
static const double uncovered_share_told = 0.005;

/* What one thread has counted. */
typedef struct tally {
  uint32_t *buckets;
  long entered, missed;
} tally;

/* What all threads share. */
typedef struct counting {
  const placido_surface *surface;
  const placido_apex *apex;
  const placido_eye *eye;
  placido_crosshatch pattern;
  int n;
  double bucket_mm, centre_x_mm, centre_y_mm;
} counting;

static void count_ray(const counting *c, tally *t, double x_mm, double y_mm) {
  placido_entry entry;
  double hit_x, hit_y;
  if (!placido_entry_at(&entry, c->surface, c->apex, x_mm, y_mm) ||
      !placido_entry_trace(&entry, c->eye, c->eye->retina_mm, &hit_x, &hit_y)) {
    t->missed++;
    return;
  }
  t->entered++;
  double column = floor((hit_x - c->centre_x_mm) / c->bucket_mm + c->n / 2.0);
  double row = floor((hit_y - c->centre_y_mm) / c->bucket_mm + c->n / 2.0);
  if (column >= 0 && column < c->n && row >= 0 && row < c->n) {
    t->buckets[(size_t)row * (size_t)c->n + (size_t)column]++;
  }
}

/* Every `threads`-th row from `first` on. */
static void count_rows(const counting *c, tally *t, int first, int threads) {
  for (int row = first; row < c->pattern.rows; row += threads) {
    double x, y;
    int count;
    placido_crosshatch_row(&c->pattern, row, &x, &count, &y);
    for (int i = 0; i < count; i++) {
      count_ray(c, t, x + 2 * i * c->pattern.half_cell_mm, y);
    }
  }
}

/* Adds up the threads' counts and makes shares of them. */
static void fill(placido_psf *psf, const tally *tallies, int threads) {
  size_t area = (size_t)psf->n * (size_t)psf->n;
  for (int t = 0; t < threads; t++) {
    psf->rays_entered += tallies[t].entered;
    psf->rays_missed += tallies[t].missed;
  }
  long most = 0;
  for (size_t i = 0; i < area; i++) {
    long count = 0;
    for (int t = 0; t < threads; t++) {
      count += tallies[t].buckets[i];
    }
    psf->rays_landed += count;
    most = count > most ? count : most;
    psf->values[i] = psf->rays_entered > 0 ? (double)count / (double)psf->rays_entered : 0;
  }
  psf->strehl_g = psf->rays_landed > 0 ? (double)most / (double)psf->rays_landed : 0;
}

static int count_all(placido_psf *psf, const counting *c, int threads, placido_error *err) {
  size_t area = (size_t)psf->n * (size_t)psf->n;
  uint32_t *buckets = NULL;
  int status = PLACIDO_MEMORY;
  tally *tallies = placido_memory_new((size_t)threads, sizeof *tallies, err);
  if (tallies == NULL) {
    goto done;
  }
  buckets = placido_memory_new(area, (size_t)threads * sizeof *buckets, err);
  if (buckets == NULL) {
    goto done;
  }
#pragma omp parallel for num_threads(threads)
  for (int t = 0; t < threads; t++) {
    tallies[t].buckets = buckets + (size_t)t * area;
    count_rows(c, &tallies[t], t, threads);
  }
  fill(psf, tallies, threads);
  status = PLACIDO_OK;
done:
  placido_memory_free(buckets);
  placido_memory_free(tallies);
  return status;
}

static int check_pupil_filled(const placido_rays *rays, const placido_surface *surface,
                              const placido_eye *eye, placido_error *err) {
  double inside = (double)rays->count + (double)rays->missed;
  if ((double)rays->missed <= missed_share_max * inside) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "the surface fills only %.0f %% of the pupil of %g mm at (%g, %g) mm; "
                           "it is defined to a radius of %g mm",
                           100 * (double)rays->count / inside, eye->pupil_mm, eye->pupil_x_mm,
                           eye->pupil_y_mm, placido_surface_radius_mm(surface));
}

static void tell(const placido_psf *psf, const placido_rays *rays, placido_notes *notes) {
  double inside = (double)(psf->rays_entered + psf->rays_missed);
  double lost = 1 - (double)psf->rays_landed / (double)psf->rays_entered;
  double uncovered = (double)rays->uncovered / (double)rays->count;
  if (psf->rays_missed > 0) {
    placido_notes_add(notes, "pupil %g mm: %.2f %% of its rays do not meet the surface",
                      psf->pupil_mm, 100 * (double)psf->rays_missed / inside);
  }
  if (lost > lost_share_told) {
    placido_notes_add(notes, "pupil %g mm: %.0f %% of the light falls outside the PSF's %.0f'",
                      psf->pupil_mm, 100 * lost, psf->n * psf->bucket_arcmin);
  }
  if (uncovered > uncovered_share_told) {
    placido_notes_add(notes, "pupil %g mm: %.1f %% of it lies where no data support the surface",
                      psf->pupil_mm, 100 * uncovered);
  }
}

static int allocate(placido_psf *psf, const placido_optics *optics, placido_error *err) {
  psf->n = optics->buckets;
  psf->values = placido_memory_new((size_t)psf->n, (size_t)psf->n * sizeof *psf->values, err);
  return psf->values == NULL ? PLACIDO_MEMORY : PLACIDO_OK;
}

static void describe(placido_psf *psf, const placido_eye *eye, const placido_optics *optics,
                     const counting *c) {
  psf->bucket_arcmin = optics->bucket_arcmin;
  psf->bucket_um = 1000 * c->bucket_mm;
  psf->pupil_mm = eye->pupil_mm;
  psf->index = eye->index;
  psf->retina_mm = eye->retina_mm;
  psf->correction = eye->correction;
  psf->rays = placido_crosshatch_total(&c->pattern);
  psf->centre_x_um = 1000 * c->centre_x_mm;
  psf->centre_y_um = 1000 * c->centre_y_mm;
}

/* Decides what is open in `eye`, and the point of fixation. */
static int find_focus(placido_eye *eye, double fixation_mm[2], const placido_surface *surface,
                      const placido_apex *apex, const placido_rays *sparse,
                      const placido_optics *optics, placido_error *err) {
  placido_rays dense;
  int status =
    placido_rays_new(&dense, surface, apex, eye, PLACIDO_FOCUS_SETTLE_SAMPLES, err);
  if (status == PLACIDO_OK) {
    placido_focus focus = {.sparse = sparse, .dense = &dense, .apex = apex, .optics = optics};
    status = placido_focus_search(&focus, eye, err);
    if (status == PLACIDO_OK) {
      status = placido_focus_peak(&focus, eye, fixation_mm, err);
    }
  }
  placido_rays_free(&dense);
  return status;
}

/* Decides the eye and traces it; everything in `eye` and `optics` is settled. */
static int make(placido_psf *psf, placido_eye *eye, const placido_surface *surface,
                const placido_optics *optics, placido_notes *notes, placido_error *err) {
  const int samples = PLACIDO_FOCUS_SEARCH_SAMPLES;
  placido_rays rays = {0};
  placido_apex apex;
  double fixation_mm[2];
  int status = placido_apex_find(&apex, surface, eye, err);
  if (status != PLACIDO_OK ||
      (status = placido_rays_new(&rays, surface, &apex, eye, samples, err)) != 0 ||
      (status = check_pupil_filled(&rays, surface, eye, err)) != 0 ||
      (status = find_focus(eye, fixation_mm, surface, &apex, &rays, optics, err)) != 0 ||
      (status = allocate(psf, optics, err)) != 0) {
    goto done;
  }
  counting c = {.surface = surface,
                .apex = &apex,
                .eye = eye,
                .pattern = placido_crosshatch_of(eye, optics->samples),
                .n = psf->n,
                .centre_x_mm = fixation_mm[0],
                .centre_y_mm = fixation_mm[1]};
  c.bucket_mm = placido_apex_bucket_um(&apex, optics, eye->index, eye->retina_mm) / 1000;
  describe(psf, eye, optics, &c);
  status = count_all(psf, &c, optics->threads, err);
  if (status != PLACIDO_OK) {
    goto done;
  }
  if (psf->rays_landed == 0) {
    status = placido_error_set(err, PLACIDO_QUALITY, "no light lands within the PSF's %.0f'",
                               psf->n * psf->bucket_arcmin);
    goto done;
  }
  tell(psf, &rays, notes);
done:
  placido_rays_free(&rays);
  return status;
}

int placido_psf_new(placido_psf *psf, placido_eye *found, const placido_surface *surface,
                    const placido_eye *eye, const placido_optics *optics, placido_notes *notes,
                    placido_error *err) {
  placido_eye settled;
  placido_optics how;
  *psf = (placido_psf){0};
  int status = placido_eye_settle(&settled, eye, err);
  if (status == PLACIDO_OK) {
    status = placido_optics_settle(&how, optics, err);
  }
  if (status == PLACIDO_OK) {
    status = make(psf, &settled, surface, &how, notes, err);
  }
  if (status != PLACIDO_OK) {
    placido_psf_free(psf);
    return status;
  }
  if (found != NULL) {
    *found = settled;
    found->correct = false; /* decided: tracing it again searches nothing */
  }
  return PLACIDO_OK;
}

void placido_psf_free(placido_psf *psf) {
  if (psf != NULL) {
    placido_memory_free(psf->values);
    *psf = (placido_psf){0};
  }
}
