/* Seeing through a cornea, twice: about the point of fixation, and then about the centroid, where
 * the light of a slightly different cornea is as well. */
#include "acquire/cli/accuracy/sight.h"

#include "acquire/cli/accuracy/differ.h"
#include "simulate/psf/geometric.h"
#include "simulate/psf/settle.h"

#include <math.h>

#define CHART "tumbling-e"
#define TRIALS 16384
#define QUICK_TRIALS 1024

int accuracy_chart_new(struct accuracy_chart *chart, bool quick, placido_error *err) {
  const placido_acuity_options options = {.trials = quick ? QUICK_TRIALS : TRIALS};
  *chart = (struct accuracy_chart){.observer = NULL};
  int status = placido_scene_load(&chart->scene, CHART, 0, NULL, err);
  if (status == PLACIDO_OK) {
    status = placido_observer_new(&chart->observer, placido_acuity_test_find("e"), &options, err);
  }
  if (status != PLACIDO_OK) {
    accuracy_chart_free(chart);
  }
  return status;
}

void accuracy_chart_free(struct accuracy_chart *chart) {
  placido_observer_free(chart->observer);
  placido_scene_free(&chart->scene);
  *chart = (struct accuracy_chart){.observer = NULL};
}

int accuracy_sight_trace(placido_psf *psf, const struct accuracy_sight *sight,
                         const struct accuracy_knobs *knobs, placido_error *err) {
  const placido_optics asked = {.samples = knobs->samples,
                                .pattern = (enum placido_pattern_kind)knobs->pattern,
                                .light = (enum placido_light_kind)knobs->light,
                                .bucket_arcmin = knobs->bucket_arcmin,
                                .buckets = knobs->buckets};
  placido_optics optics;
  *psf = (placido_psf){0};
  const int status = placido_optics_settle(&optics, &asked, err);
  return status == PLACIDO_OK ? placido_geometric_fill(psf, sight->surface, &sight->apex,
                                                       &sight->eye, &optics, sight->fixation_mm,
                                                       err)
                              : status;
}

int accuracy_chart_see(placido_image *seen, const struct accuracy_chart *chart,
                       const placido_psf *psf, const struct accuracy_knobs *knobs,
                       placido_error *err) {
  const placido_convolution how = {.doubles = knobs->doubles != 0, .memory_MB = knobs->memory_MB};
  return placido_scene_see_as(seen, &chart->scene, psf, &how, NULL, err);
}

int accuracy_chart_read(double *logmar, const placido_observer *observer, const placido_psf *psf,
                        placido_error *err) {
  placido_acuity acuity;
  *logmar = NAN;
  const int status = placido_acuity_find(&acuity, observer, psf, NULL, 0, err);
  if (status == PLACIDO_OK) {
    *logmar = isnan(acuity.logmar) ? acuity.bound_logmar : acuity.logmar;
  }
  return status;
}

/* Columns grow with x on the retina, and rows, which the patient sees upside down, with y. */
static void centre(struct accuracy_sight *sight) {
  const placido_moments moments = placido_psf_moments(&sight->psf);
  const double mm = 1e-3 * sight->psf.bucket_um / sight->psf.bucket_arcmin;
  sight->fixation_mm[0] += mm * moments.x;
  sight->fixation_mm[1] -= mm * moments.y;
}

static int trace_centred(struct accuracy_sight *sight, const struct accuracy_knobs *knobs,
                         placido_error *err) {
  const struct accuracy_knobs finely = {.meridians = 0};
  int status = accuracy_sight_trace(&sight->psf, sight, &finely, err);
  if (status == PLACIDO_OK) {
    centre(sight);
    placido_psf_free(&sight->psf);
    status = accuracy_sight_trace(&sight->psf, sight, knobs, err);
  }
  return status;
}

int accuracy_sight_new(struct accuracy_sight *sight, const placido_surface *surface,
                       const struct accuracy_chart *chart, const struct accuracy_knobs *knobs,
                       placido_error *err) {
  const placido_eye eye = {.pupil_mm = ACCURACY_PUPIL_MM, .correct = PLACIDO_CORRECT_FULL};
  *sight = (struct accuracy_sight){.surface = surface, .logmar = NAN};
  int status = placido_psf_settle(&sight->eye, sight->fixation_mm, surface, &eye, NULL, err);
  if (status == PLACIDO_OK) {
    status = placido_apex_find(&sight->apex, surface, &sight->eye, err);
  }
  if (status == PLACIDO_OK) {
    status = trace_centred(sight, knobs, err);
  }
  if (status == PLACIDO_OK &&
      !placido_scene_coarse(&chart->scene, &sight->psf)) {
    status = accuracy_chart_see(&sight->image, chart, &sight->psf, knobs, err);
  }
  if (status == PLACIDO_OK) {
    status = accuracy_chart_read(&sight->logmar, chart->observer, &sight->psf, err);
  }
  if (status != PLACIDO_OK) {
    accuracy_sight_free(sight);
  }
  return status;
}

void accuracy_sight_free(struct accuracy_sight *sight) {
  placido_image_free(&sight->image);
  placido_psf_free(&sight->psf);
  *sight = (struct accuracy_sight){.surface = NULL};
}

int accuracy_sights_differ(double error[ACCURACY_ERRORS], const struct accuracy_sight *one,
                           const struct accuracy_sight *other, placido_error *err) {
  accuracy_differ_surfaces(&error[ACCURACY_ELEVATION_UM], &error[ACCURACY_AXIAL_D], one->surface,
                           other->surface);
  error[ACCURACY_IMAGE] = one->image.data && other->image.data
                              ? accuracy_differ_images(&one->image, &other->image)
                              : NAN;
  error[ACCURACY_LOGMAR] = fabs(one->logmar - other->logmar);
  return accuracy_differ_psfs(&error[ACCURACY_PSF_OTF], &one->psf, &other->psf, err);
}
