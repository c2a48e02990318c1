/* Runs the simulation for every pupil and scene. A pupil that the surface cannot fill and a scene
 * too coarse for its PSF are left out with a warning: the rest is worth having. */
#include "acquire/cli/views.h"

#include "acquire/cli/examination.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const default_scenes[] = {"tumbling-e"};

/* A scene's name as the stem of a file name: letters, digits, '.', '_' and '-' stay. */
static void make_stem(char stem[80], const char *name) {
  snprintf(stem, 80, "%s", name);
  for (char *c = stem; *c; c++) {
    if (!isalnum((unsigned char)*c) && !strchr("._-", *c)) {
      *c = '-';
    }
  }
  if (stem[0] == '.' || stem[0] == '\0') {
    stem[0] = '-';
  }
}

/* Two scenes of one name would be one file; the PSF's own picture has its name already. */
static int check_stem(const struct views *views, size_t index, placido_error *err) {
  const char *stem = views->stems[index];
  bool taken = strcmp(stem, "psf") == 0 || strcmp(stem, "quality") == 0;
  for (size_t i = 0; i < index; i++) {
    taken = taken || strcmp(stem, views->stems[i]) == 0;
  }
  if (taken) {
    return placido_error_set(err, STATUS_USAGE,
                             "scene \"%s\": the file name %s.png is taken; give it another name",
                             views->scenes[index].name, stem);
  }
  return PLACIDO_OK;
}

static void name_pupil(char directory[32], double pupil_mm) {
  snprintf(directory, 32, "pupil-%gmm", pupil_mm);
}

/* Two pupils are the same where they would share a folder. */
static int check_pupils(const struct number_list *pupils, placido_error *err) {
  for (size_t i = 0; i < pupils->count; i++) {
    for (size_t k = 0; k < i; k++) {
      char one[32], other[32];
      name_pupil(one, pupils->values[i]);
      name_pupil(other, pupils->values[k]);
      if (strcmp(one, other) == 0) {
        return placido_error_set(err, STATUS_USAGE, "--pupils: %g stands twice",
                                 pupils->values[i]);
      }
    }
  }
  return PLACIDO_OK;
}

#define FOCUS_STEPS 41
#define CHART_COARSEST_ARCMIN 0.5
#define CHART_FINEST_ARCMIN 0.05

static int check_seeing(const struct settings *settings, placido_error *err) {
  if (settings->cwhatuc && settings->bucket_arcmin > 0.0) {
    return placido_error_set(err, STATUS_USAGE,
                             "--cwhatuc has buckets of its own: leave --bucket out");
  }
  if (settings->cwhatuc && settings->rays.wavelength_nm > 0.0) {
    return placido_error_set(err, STATUS_USAGE,
                             "--cwhatuc knows rays, no waves: leave --diffraction out");
  }
  const int status = eye_settings_check(settings, err);
  return status == PLACIDO_OK ? check_pupils(&settings->pupils_mm, err) : status;
}

/* Charts are drawn as finely as the PSF's buckets ask for, but no coarser than usual; 0: usual. */
static double chart_scale(const struct settings *settings) {
  const double bucket = settings->bucket_arcmin;
  return bucket > 0 && bucket < CHART_COARSEST_ARCMIN ? fmax(bucket, CHART_FINEST_ARCMIN) : 0;
}

int step_scenes(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "read scenes");
  struct views *views = &examination->views;
  const struct text_list *asked = &examination->settings->scenes;
  const char *const *names = asked->count ? asked->values : default_scenes;
  const size_t count = asked->count ? asked->count : 1;
  int status = check_seeing(examination->settings, err);
  for (size_t i = 0; i < count && status == PLACIDO_OK; i++) {
    status = placido_scene_load(&views->scenes[i], names[i],
                                chart_scale(examination->settings),
                                &examination->outcome->notes, err);
    if (status == PLACIDO_OK) {
      views->scene_count++;
      views->scenes[i].allow_coarse |= examination->settings->allow_coarse;
      make_stem(views->stems[i], views->scenes[i].name);
      status = check_stem(views, i, err);
    }
  }
  return status;
}

static int see_psf(struct examination *examination, struct view *view, double pupil_mm,
                   placido_error *err) {
  const struct settings *settings = examination->settings;
  struct stages *stages = &examination->outcome->stages;
  stages_next(stages, "psf %g mm", pupil_mm);
  placido_eye eye;
  int status = eye_settings_read(&eye, settings, pupil_mm, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const placido_optics optics = ray_settings_read(settings, examination->threads);
  status = placido_psf_new(&view->psf, &view->eye, examination->surface, &eye, &optics,
                           &examination->outcome->notes, err);
  name_pupil(view->directory, pupil_mm);
  view->seconds = stages_elapsed(stages);
  const double reach_D = settings->rays.through_focus_D;
  if (status == PLACIDO_OK && reach_D > 0) {
    stages_next(stages, "focus %g mm", pupil_mm);
    status = placido_focus_curve_new(&view->focus, examination->surface, &view->eye, &optics,
                                     -reach_D, reach_D, FOCUS_STEPS, err);
  }
  return status;
}

static int see_scene(struct examination *examination, struct view *view, size_t scene,
                     placido_error *err) {
  struct views *views = &examination->views;
  placido_notes *notes = &examination->outcome->notes;
  placido_error reason = {0};
  char folder[PLACIDO_PATH_MAX];
  const placido_convolution how =
      spread_settings_read(folder, examination->settings, examination->threads, notes);
  const int status = placido_scene_see_as(&view->seen[scene], &views->scenes[scene], &view->psf,
                                          &how, notes, &reason);
  if (status == PLACIDO_QUALITY) {
    placido_notes_add(&examination->outcome->notes, "left out: %s", reason.text);
    return PLACIDO_OK;
  }
  if (status != PLACIDO_OK) {
    return placido_error_set(err, status, "%s", reason.text);
  }
  if (placido_scene_coarse(&views->scenes[scene], &view->psf)) {
    placido_notes_add(&examination->outcome->notes,
                      "scene %s is coarse: a pixel is %.4g', the PSF's bucket %.4g'; blur finer "
                      "than a pixel is not real", views->scenes[scene].name,
                      views->scenes[scene].arcmin_per_px, view->psf.bucket_arcmin);
  }
  placido_image_to_srgb(&view->seen[scene]);
  return PLACIDO_OK;
}

static int see_pupil(struct examination *examination, double pupil_mm, placido_error *err) {
  struct views *views = &examination->views;
  struct view *view = &views->items[views->count];
  int status = see_psf(examination, view, pupil_mm, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  views->count++;
  stages_next(&examination->outcome->stages, "scenes %g mm", pupil_mm);
  for (size_t i = 0; i < views->scene_count && status == PLACIDO_OK; i++) {
    status = see_scene(examination, view, i, err);
  }
  return status;
}

int step_see(struct examination *examination, placido_error *err) {
  const struct number_list *pupils = &examination->settings->pupils_mm;
  placido_error reason = {0};
  for (size_t i = 0; i < pupils->count; i++) {
    const int status = see_pupil(examination, pupils->values[i], &reason);
    if (status == PLACIDO_QUALITY) {
      placido_notes_add(&examination->outcome->notes, "pupil of %g mm left out: %s",
                        pupils->values[i], reason.text);
    } else if (status != PLACIDO_OK) {
      return placido_error_set(err, status, "%s", reason.text);
    }
  }
  if (examination->views.count == 0 && !examination->fit) {
    return placido_error_set(err, PLACIDO_QUALITY, "no pupil can be simulated: %s", reason.text);
  }
  return PLACIDO_OK;
}

static void print_chart(void *user, const char *name, const char *help) {
  (void)user;
  printf("  %-23s %s\n", name, help);
}

void views_list_charts(void) {
  puts("\nCharts");
  placido_chart_list(print_chart, NULL);
  puts("\nScene files (placido-scene/1, docs/formats.md)\n"
       "  a photograph taken with a lens that covers 12 degrees:\n"
       "      {\"format\": \"placido-scene/1\", \"image\": \"street.png\",\n"
       "       \"calibration\": {\"kind\": \"camera\", \"horizontal_fov_deg\": 12}}\n"
       "  a screen of 110 dpi seen from 60 cm:\n"
       "      \"calibration\": {\"kind\": \"monitor\", \"dpi\": 110, \"distance_m\": 0.6}\n"
       "  a door of 2 m, 640 pixels high, 25 m away:\n"
       "      \"calibration\": {\"kind\": \"object\", \"size_m\": 2, \"distance_m\": 25, "
       "\"size_px\": 640}\n"
       "  half a minute of arc a pixel:\n"
       "      \"calibration\": {\"kind\": \"arcmin_per_px\", \"value\": 0.5}\n"
       "  letters of 20/40 down to 20/20:\n"
       "      {\"format\": \"placido-scene/1\", \"image\": \"sloan\",\n"
       "       \"chart\": {\"first_logmar\": 0.3, \"last_logmar\": 0}}");
}

void views_free(struct views *views) {
  for (size_t i = 0; i < LIST_MAX; i++) {
    placido_scene_free(&views->scenes[i]);
    placido_psf_free(&views->items[i].psf);
    placido_focus_curve_free(&views->items[i].focus);
    for (size_t k = 0; k < LIST_MAX; k++) {
      placido_image_free(&views->items[i].seen[k]);
    }
  }
}
