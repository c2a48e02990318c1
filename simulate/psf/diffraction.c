/* Diffraction images of one or more wavelengths: sampling, transform, sum.
 *
 * A pupil sampled every d repeats its image every wavelength / d, so d follows from the window that
 * must not wrap, and from the steepest ray, which must not come back on the other side. */
#include "simulate/psf/diffraction.h"

#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/fft.h"

#include <math.h>
#include <string.h>

enum { SAMPLES_LEAST = 256, PERIOD_MAX = 6000 };

static const double window_room = 1.02;      /* of the period over the window */
static const double tolerance_waves = 0.01;  /* of the wavefront between its samples, rms */
static const double plan_worth_keeping = 1.1; /* longer than needed */

/* The sampling of one wavelength. */
typedef struct sampling {
  int period, cells; /* buckets after which the image repeats; cells across the pupil */
  double spacing_mm, samples;
} sampling;

/* What all wavelengths share. */
typedef struct diffraction {
  placido_front front;
  const placido_wave *waves;
  placido_window window;
  double bucket_rad;
} diffraction;

/* The steepest ray of a wavelength, radians. */
static double steepest_rad(const diffraction *d, const placido_wave *wave) {
  double tilt_rad = PLACIDO_ARCMIN_RAD * hypot(wave->x_arcmin, wave->y_arcmin);
  return 1e-3 * (d->front.slope_max + fabs(wave->defocus_D) * d->front.pupil_mm / 2) + tilt_rad;
}

/* What the window and the steepest ray ask for, in samples across the pupil. */
static double samples_for(double angle_rad, const diffraction *d, const placido_wave *wave) {
  return d->front.pupil_mm * angle_rad / (1e-6 * wave->wavelength_nm);
}

static int choose_period(const diffraction *d, const placido_wave *wave) {
  double least = SAMPLES_LEAST / samples_for(d->bucket_rad, d, wave);
  double window = window_room * d->window.buckets;
  double steep = 2 * steepest_rad(d, wave) / d->bucket_rad;
  double buckets = ceil(fmax(fmax(window, steep), least));
  return buckets < 1e6 ? placido_fft_good_length((int)buckets) : 1000000;
}

static int refuse_window(double across, const diffraction *d, const placido_wave *wave,
                         placido_error *err) {
  double window_rad = d->window.buckets * d->bucket_rad;
  return placido_error_set(err, PLACIDO_INPUT,
                           "%g samples across a pupil of %g mm repeat the image of %g nm every "
                           "%.4g', and it would wrap in a window of %.4g': at least %.0f are "
                           "needed",
                           across, d->front.pupil_mm, wave->wavelength_nm,
                           d->window.bucket_arcmin * across / samples_for(d->bucket_rad, d, wave),
                           window_rad / PLACIDO_ARCMIN_RAD,
                           ceil(samples_for(window_rad, d, wave)));
}

static int refuse_slope(double across, const diffraction *d, const placido_wave *wave,
                        int status, placido_error *err) {
  double steep_rad = steepest_rad(d, wave);
  return placido_error_set(err, status,
                           "rays reach %.3g' from the middle behind a pupil of %g mm: %.0f samples "
                           "across are needed at %g nm for the path to differ by less than half a "
                           "wavelength, and %s%g",
                           steep_rad / PLACIDO_ARCMIN_RAD, d->front.pupil_mm,
                           ceil(samples_for(2 * steep_rad, d, wave)), wave->wavelength_nm,
                           status == PLACIDO_INPUT ? "there are " : "there can be no more than ",
                           across);
}

/* The sampling that was asked for, or the one that is needed. */
static int choose(sampling *chosen, const diffraction *d, const placido_wave *wave,
                  placido_error *err) {
  double bucket_samples = samples_for(d->bucket_rad, d, wave);
  int asked = d->window.samples;
  if (asked > 0) {
    chosen->period = (int)fmin(asked / bucket_samples, 1e6);
    if (chosen->period < d->window.buckets) {
      return refuse_window(asked, d, wave, err);
    }
    if (asked < samples_for(2 * steepest_rad(d, wave), d, wave)) {
      return refuse_slope(asked, d, wave, PLACIDO_INPUT, err);
    }
  } else {
    chosen->period = choose_period(d, wave);
  }
  if (chosen->period > PERIOD_MAX && samples_for(d->bucket_rad * PERIOD_MAX, d, wave) <
                                       PLACIDO_DIFFRACTION_SAMPLES_MAX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "buckets of %g' are far finer than the image of %g nm behind a pupil "
                             "of %g mm: choose wider ones",
                             d->window.bucket_arcmin, wave->wavelength_nm, d->front.pupil_mm);
  }
  chosen->samples = chosen->period * bucket_samples;
  chosen->spacing_mm = d->front.pupil_mm / chosen->samples;
  chosen->cells = (int)fmin(ceil(chosen->samples - 1e-9), 1e6);
  if (chosen->samples <= PLACIDO_DIFFRACTION_SAMPLES_MAX + 0.5) {
    return PLACIDO_OK;
  }
  if (samples_for(2 * steepest_rad(d, wave), d, wave) > PLACIDO_DIFFRACTION_SAMPLES_MAX) {
    return refuse_slope(PLACIDO_DIFFRACTION_SAMPLES_MAX, d, wave, PLACIDO_QUALITY, err);
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "a window of %.4g' needs %.0f samples across a pupil of %g mm at %g nm, "
                           "at most %d can be: choose a smaller one",
                           d->window.buckets * d->window.bucket_arcmin, chosen->samples,
                           d->front.pupil_mm, wave->wavelength_nm,
                           PLACIDO_DIFFRACTION_SAMPLES_MAX);
}

/* What a thread works with. */
typedef struct bench {
  float *field, *image;
  double *work, light;
} bench;

static void free_benches(bench *benches, int count) {
  for (int i = 0; i < count && benches != NULL; i++) {
    placido_memory_free(benches[i].field);
    placido_memory_free(benches[i].image);
    placido_memory_free(benches[i].work);
  }
  placido_memory_free(benches);
}

static int new_benches(bench **benches, int count, const placido_spread *spread,
                       const placido_front *front, placido_error *err) {
  *benches = placido_memory_new((size_t)count, sizeof **benches, err);
  bool whole = *benches != NULL;
  for (int i = 0; i < count && whole; i++) {
    bench *b = *benches + i;
    b->field = placido_memory_new_aligned(spread->field_size * sizeof(fftwf_complex), err);
    b->image = placido_memory_new_aligned(spread->image_size * sizeof(fftwf_complex), err);
    b->work = placido_memory_new(placido_field_work(front, spread->samples), sizeof *b->work, err);
    whole = b->field != NULL && b->image != NULL && b->work != NULL;
  }
  return whole ? PLACIDO_OK : PLACIDO_MEMORY;
}

/* The image of one wavelength, not yet normalised. */
static void make_image(bench *b, const placido_spread *spread, const sampling *s,
                       const diffraction *d, const placido_wave *wave) {
  memset(b->field, 0, spread->field_size * sizeof(fftwf_complex));
  b->light = placido_field_fill(b->field, spread->field_stride, s->cells, s->spacing_mm, &d->front,
                                wave, b->work);
  placido_spread_run(spread, b->field, b->image, d->window.points);
}

/* Adds the window's part to the sum. Rounding may leave a dark bucket a little below nothing. */
static void add_image(double *values, const bench *b, const placido_spread *spread,
                      const diffraction *d, const placido_wave *wave) {
  int n = d->window.buckets, half = n / 2, period = spread->period;
  double size = (double)spread->padded * period;
  double scale = b->light > 0 ? wave->weight / (size * size * b->light) : 0;
  for (int row = 0; row < n; row++) {
    size_t from = (size_t)((row - half + period) % period) * 2 * spread->image_stride;
    for (int column = 0; column < n; column++) {
      size_t at = from + (size_t)((column - half + period) % period);
      values[(size_t)row * (size_t)n + (size_t)column] += scale * fmax(b->image[at], 0);
    }
  }
}

/* The wavelengths from `first` on that can use this spread. */
static size_t alike(const sampling *samplings, size_t first, size_t count) {
  size_t end = first + 1;
  while (end < count && samplings[end].period == samplings[first].period &&
         samplings[end].cells <= samplings[first].cells &&
         plan_worth_keeping * samplings[end].cells >= samplings[first].cells) {
    end++;
  }
  return end;
}

/* Wavelengths that share a plan; as many at once as there are threads, added up in their order. */
static int run_alike(double *values, double *light, const diffraction *d,
                     const sampling *samplings, size_t first, size_t end, placido_error *err) {
  placido_spread spread;
  bench *benches = NULL;
  size_t batch = (size_t)d->window.threads;
  batch = end - first < batch ? end - first : batch;
  int status = placido_spread_new(&spread, samplings[first].cells, samplings[first].period, err);
  if (status == PLACIDO_OK) {
    status = new_benches(&benches, (int)batch, &spread, &d->front, err);
  }
  for (size_t from = first; from < end && status == PLACIDO_OK; from += batch) {
    size_t now = end - from < batch ? end - from : batch;
#pragma omp parallel for num_threads((int)batch) if (batch > 1)
    for (size_t i = 0; i < now; i++) {
      make_image(&benches[i], &spread, &samplings[from + i], d, &d->waves[from + i]);
    }
    for (size_t i = 0; i < now; i++) {
      const sampling *s = &samplings[from + i];
      add_image(values, &benches[i], &spread, d, &d->waves[from + i]);
      *light = benches[i].light / (s->samples * s->samples * 0.25 * acos(-1));
    }
  }
  free_benches(benches, (int)batch);
  placido_spread_free(&spread);
  return status;
}

static void describe(placido_diffraction_use *use, const double *values, const diffraction *d,
                     const sampling *samplings, size_t count, double light) {
  double weights = 0, sum = 0;
  *use = (placido_diffraction_use){.light = light};
  for (size_t i = 0; i < count; i++) {
    weights += d->waves[i].weight;
    if (samplings[i].cells > use->samples) {
      use->samples = samplings[i].cells;
      use->period_arcmin = samplings[i].period * d->window.bucket_arcmin;
    }
  }
  for (size_t i = 0; i < (size_t)d->window.buckets * (size_t)d->window.buckets; i++) {
    sum += values[i];
  }
  use->share = weights > 0 ? sum / weights : 0;
}

static double shortest_um(const placido_wave *waves, size_t count) {
  double shortest = INFINITY;
  for (size_t i = 0; i < count; i++) {
    shortest = fmin(shortest, 1e-3 * waves[i].wavelength_nm);
  }
  return shortest;
}

static int run(double *values, placido_diffraction_use *use, const diffraction *d, size_t count,
               placido_error *err) {
  double light = 0;
  sampling *samplings = placido_memory_new(count, sizeof *samplings, err);
  int status = samplings != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  for (size_t i = 0; i < count && status == PLACIDO_OK; i++) {
    status = choose(&samplings[i], d, &d->waves[i], err);
  }
  if (status == PLACIDO_OK) {
    memset(values, 0, (size_t)d->window.buckets * (size_t)d->window.buckets * sizeof *values);
  }
  for (size_t first = 0; first < count && status == PLACIDO_OK;) {
    size_t end = alike(samplings, first, count);
    status = run_alike(values, &light, d, samplings, first, end, err);
    first = end;
  }
  if (status == PLACIDO_OK && use != NULL) {
    describe(use, values, d, samplings, count, light);
  }
  placido_memory_free(samplings);
  return status;
}

int placido_diffraction(double *values, placido_diffraction_use *use, const placido_pupil *pupil,
                        const placido_wave *waves, size_t count, const placido_window *window,
                        placido_error *err) {
  diffraction d = {.waves = waves};
  if (use != NULL) {
    *use = (placido_diffraction_use){0};
  }
  int status = placido_window_settle(&d.window, window, err);
  if (status == PLACIDO_OK) {
    status = placido_waves_check(waves, count, err);
  }
  if (status == PLACIDO_OK) {
    d.bucket_rad = PLACIDO_ARCMIN_RAD * d.window.bucket_arcmin;
    status = placido_front_new(&d.front, pupil, tolerance_waves * shortest_um(waves, count), err);
  }
  if (status == PLACIDO_OK) {
    status = run(values, use, &d, count, err);
  }
  placido_front_free(&d.front);
  return status;
}
