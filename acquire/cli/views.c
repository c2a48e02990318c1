/* Reads what is looked at, and keeps what is seen. */
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

void views_name_pupil(char directory[32], double pupil_mm, bool automatic) {
  snprintf(directory, 32, "pupil-%gmm", automatic ? round(10 * pupil_mm) / 10 : pupil_mm);
}

int views_check_pupils(const struct number_list *pupils, placido_error *err) {
  for (size_t i = 0; i < pupils->count; i++) {
    for (size_t k = 0; k < i; k++) {
      char one[32], other[32];
      views_name_pupil(one, pupils->values[i], false);
      views_name_pupil(other, pupils->values[k], false);
      if (strcmp(one, other) != 0) {
        continue;
      }
      if (pupils->values[i] == PUPIL_AUTO) {
        return placido_error_set(err, STATUS_USAGE, "--pupils: auto stands twice");
      }
      return placido_error_set(err, STATUS_USAGE, "--pupils: %g stands twice", pupils->values[i]);
    }
  }
  return PLACIDO_OK;
}

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
  int status = eye_settings_check(settings, err);
  if (status == PLACIDO_OK) {
    status = plan_settings_check(settings, err);
  }
  return status == PLACIDO_OK ? views_check_pupils(&settings->pupils_mm, err) : status;
}

double views_chart_scale(const struct settings *settings) {
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
                                views_chart_scale(examination->settings),
                                &examination->outcome->notes, err);
    if (status == PLACIDO_OK) {
      views->scene_count++;
      views->scenes[i].allow_coarse |= examination->settings->allow_coarse;
      make_stem(views->stems[i], views->scenes[i].name);
      status = check_stem(views, i, err);
    }
    if (status == PLACIDO_OK) {
      status = plan_settings_check_scene(&examination->settings->pupils_mm, &views->scenes[i],
                                         err);
    }
  }
  return status;
}

const placido_plan *views_first_plan(const struct view *view) {
  size_t i = 0;
  while (i + 1 < LIST_MAX && !view->sights[i].plan) {
    i++;
  }
  return view->sights[i].plan;
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

static void view_free(struct view *view) {
  placido_psf_free(&view->psf);
  placido_focus_curve_free(&view->focus);
  for (size_t k = 0; k < LIST_MAX; k++) {
    placido_plan_free(view->sights[k].plan);
    placido_image_free(&view->sights[k].image);
  }
}

/* Plans borrow the scenes. */
void views_free(struct views *views) {
  for (size_t i = 0; i < VIEWS_MAX; i++) {
    view_free(&views->items[i]);
  }
  for (size_t i = 0; i < LIST_MAX; i++) {
    placido_scene_free(&views->scenes[i]);
  }
}
