/* Whole examinations against the true eye, from the frame to the acuity through a pupil of 4 mm:
 * mires, surface, maps, indices, wavefront, point spread function, chart and acuity. Plans are not
 * part of it: they choose their own settings for a tolerance. */
#include "acquire/cli/accuracy/stage.h"
#include "acquire/cli/settings.h"
#include "acquire/cli/wavefront.h"
#include "base/memory.h"

#include <placido/index.h>
#include <placido/map.h>

#define MAP_STEP_MM 0.1

/* From the cheapest to the finest; what is not named is as in an examination of which nothing is
 * asked. */
static const char *const settings[] = {
    "meridians=45 knot_mm=2 degree=3 tolerance=1 samples=25 trials=256",
    "meridians=45 knot_mm=1 degree=3 tolerance=0.1 samples=35 trials=256",
    "meridians=60 knot_mm=0.75 degree=3 tolerance=0.1 samples=50 trials=512",
    "meridians=90 knot_mm=0.75 degree=3 tolerance=0.1 samples=71 trials=1024",
    "meridians=90 knot_mm=0.5 degree=3 tolerance=0.1 samples=71 trials=1024",
    "meridians=120 knot_mm=0.5 degree=5 tolerance=0.1 samples=100 trials=1024",
    "meridians=180 knot_mm=0.75 degree=3 samples=100 trials=1024",
    "meridians=180 knot_mm=0.5 samples=100 trials=2048",
    "meridians=180 samples=200 trials=2048",
    "meridians=360 knot_mm=0.75 samples=200 trials=4096",
    "meridians=360 knot_mm=0.5 degree=3 samples=200 trials=4096",
    "meridians=360 samples=400 trials=4096",
    "meridians=360 filter_px=1.4 samples=400 trials=4096",
    "meridians=720 samples=800 trials=16384",
    "meridians=720 tolerance=1e-6 samples=1600 trials=65536",
    NULL};
static const char *const quick[] = {
    "meridians=90 knot_mm=0.75 degree=3 tolerance=0.1 samples=71 trials=1024",
    "meridians=360 samples=400 trials=4096", NULL};

struct found {
  placido_mires mires;
  placido_fit *fit;
  placido_maps maps;
  placido_index_value indices[PLACIDO_INDICES_MAX];
  struct wavefronts wavefronts;
  placido_psf psf;
  placido_image image;
  placido_observer *observer;
  double logmar;
};

static void found_free(struct found *found) {
  placido_observer_free(found->observer);
  placido_image_free(&found->image);
  placido_psf_free(&found->psf);
  wavefronts_free(&found->wavefronts);
  placido_maps_free(&found->maps);
  placido_fit_free(found->fit);
  placido_mires_free(&found->mires);
  placido_memory_free(found);
}

static int measure(struct found *found, const struct accuracy_trial *trial, placido_error *err) {
  size_t count;
  int status = accuracy_eye_mires(&found->mires, trial->eye, &trial->knobs, err);
  if (status == PLACIDO_OK) {
    status = accuracy_eye_fit(&found->fit, &found->mires, trial->eye, &trial->knobs, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  const placido_surface *surface = placido_fit_surface(found->fit);
  status = placido_maps_new(&found->maps, surface, found->fit, MAP_STEP_MM, err);
  if (status == PLACIDO_OK) {
    status = placido_indices_find(found->indices, &count, surface, found->fit, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_indices_of_mires(found->indices, &count, found->fit, &found->mires,
                                      &trial->eye->instrument, err);
  }
  return status == PLACIDO_OK ? wavefronts_find(&found->wavefronts, surface, found->fit,
                                                trial->bench->settings, NULL, err)
                              : status;
}

static int see(struct found *found, const struct accuracy_trial *trial, placido_error *err) {
  const struct accuracy_knobs *knobs = &trial->knobs;
  const placido_eye eye = {.pupil_mm = ACCURACY_PUPIL_MM, .correct = PLACIDO_CORRECT_FULL};
  const placido_optics optics = {.samples = knobs->samples, .threads = 1};
  const placido_acuity_options options = {.trials = knobs->trials};
  int status = placido_psf_new(&found->psf, NULL, placido_fit_surface(found->fit), &eye, &optics,
                               NULL, err);
  if (status == PLACIDO_OK) {
    status = accuracy_chart_see(&found->image, &trial->bench->chart, &found->psf, knobs, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_observer_new(&found->observer, placido_acuity_test_find("e"), &options, err);
  }
  return status == PLACIDO_OK
             ? accuracy_chart_read(&found->logmar, found->observer, &found->psf, err)
             : status;
}

static int examine(struct found **found, struct accuracy_watch *watch,
                   const struct accuracy_trial *trial, placido_error *err) {
  *found = placido_memory_new(1, sizeof **found, err);
  if (!*found) {
    return PLACIDO_MEMORY;
  }
  accuracy_watch_begin(watch);
  int status = measure(*found, trial, err);
  if (status == PLACIDO_OK) {
    status = see(*found, trial, err);
  }
  accuracy_watch_end(watch);
  if (status != PLACIDO_OK) {
    found_free(*found);
    *found = NULL;
  }
  return status;
}

/* The image about the middle of its light, as the truth's; the acuity is the examination's own. */
static int compare(struct accuracy_row *row, const struct found *found,
                   const struct accuracy_trial *trial, placido_error *err) {
  struct accuracy_sight sight;
  int status = accuracy_sight_new(&sight, placido_fit_surface(found->fit), &trial->bench->chart,
                                  &trial->knobs, err);
  if (status == PLACIDO_OK) {
    sight.logmar = found->logmar;
    status = accuracy_sights_differ(row->error, &sight, &trial->eye->true_seen, err);
  }
  accuracy_sight_free(&sight);
  return status;
}

static int run(struct accuracy_row *row, const struct accuracy_trial *trial, placido_error *err) {
  struct accuracy_watch watch = {0};
  struct found *found = NULL;
  int status;
  do {
    if (found) {
      found_free(found);
    }
    status = examine(&found, &watch, trial, err);
  } while (status == PLACIDO_OK && accuracy_watch_again(&watch, trial->bench));
  row->ms = watch.least_ms;
  if (status == PLACIDO_OK) {
    status = compare(row, found, trial, err);
    found_free(found);
  }
  return status;
}

const struct accuracy_measure accuracy_measure_exam = {
    .stage = ACCURACY_EXAM, .settings = settings, .quick = quick, .defaults = true, .run = run};
