/* Scenes: a generated chart, or a picture file with its calibration, in linear light. */
#include "base/file.h"
#include "base/json.h"
#include "simulate/calibration.h"
#include "simulate/charts/chart.h"

#include <placido/simulate.h>

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double usual_arcmin_per_px = 0.5;
static const double chart_bleed_arcmin = 64; /* 128 buckets of half a minute to a side */

/* Part of the format, drawn by a later build. */
static const char *const future_charts[] = {"landolt", "sloan"};

static const char *const known_keys[] = {
  "format",     "name",  "image",    "calibration", "luminance_cd_m2",
  "distance_m", "depth", "spectrum", "tolerance",   NULL};

/* Conditions that the geometric simulation does not follow. */
static const char *const idle_keys[] = {"luminance_cd_m2", "depth", "spectrum"};

static int refuse_future_chart(const char *name, placido_error *err) {
  size_t count;
  const placido_chart *charts = placido_chart_table(&count);
  for (size_t i = 0; i < sizeof future_charts / sizeof *future_charts; i++) {
    if (strcmp(name, future_charts[i]) == 0) {
      char list[256] = "";
      for (size_t k = 0; k < count; k++) {
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", k > 0 ? ", " : "", charts[k].name);
      }
      return placido_error_set(err, PLACIDO_UNSUPPORTED,
                               "this build does not draw the chart %s; it draws %s", name, list);
    }
  }
  return PLACIDO_OK;
}

/* A name that can be a file's: no folders, nothing hidden, no control characters. */
static void make_stem(char *name) {
  if (*name == '.') {
    *name = '-';
  }
  for (; *name != '\0'; name++) {
    if (*name == '/' || iscntrl((unsigned char)*name)) {
      *name = '-';
    }
  }
}

/* The last part of a path without its ending. */
static void stem_of(char *stem, size_t size, const char *path) {
  const char *slash = strrchr(path, '/');
  snprintf(stem, size, "%.*s", (int)size - 1, slash != NULL ? slash + 1 : path);
  char *dot = strrchr(stem, '.');
  if (dot != NULL && dot != stem) {
    *dot = '\0';
  }
}

/* A file named in `path`, relative to the folder of `path`. */
static int beside(char *out, const char *path, const char *name, placido_error *err) {
  const char *slash = strrchr(path, '/');
  char folder[PLACIDO_PATH_MAX];
  if (slash == NULL || *name == '/') {
    snprintf(out, PLACIDO_PATH_MAX, "%s", name); /* fits: it was read into as much */
    return PLACIDO_OK;
  }
  size_t length = slash == path ? 1 : (size_t)(slash - path);
  if (length >= sizeof folder) {
    return placido_error_set(err, PLACIDO_INPUT, "a path of %zu bytes is too long", strlen(path));
  }
  memcpy(folder, path, length);
  folder[length] = '\0';
  return placido_path_join(out, folder, name, err);
}

/* A chart in the middle of its bleed of white. */
static int draw_chart(placido_scene *scene, const placido_chart *chart, placido_error *err) {
  placido_image alone, *whole = &scene->image;
  int status = placido_chart_new(&alone, chart, scene->arcmin_per_px, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  int bleed = scene->bleed_px = (int)ceil(chart_bleed_arcmin / scene->arcmin_per_px);
  status = placido_image_new(whole, alone.width_px + 2 * bleed, alone.height_px + 2 * bleed, 1,
                             err);
  if (status == PLACIDO_OK) {
    size_t width = (size_t)whole->width_px, pixels = width * (size_t)whole->height_px;
    for (size_t i = 0; i < pixels; i++) {
      whole->data[i] = 1;
    }
    for (int y = 0; y < alone.height_px; y++) {
      memcpy(&whole->data[(size_t)(y + bleed) * width + (size_t)bleed],
             &alone.data[(size_t)y * (size_t)alone.width_px],
             (size_t)alone.width_px * sizeof *alone.data);
    }
  }
  placido_image_free(&alone);
  return status;
}

static int load_photograph(placido_scene *scene, const char *scene_path, const char *name,
                           placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = beside(path, scene_path, name, err);
  if (status == PLACIDO_OK) {
    status = placido_image_load(&scene->image, path, err);
  }
  if (status == PLACIDO_OK) {
    placido_image_to_linear(&scene->image);
  }
  return status;
}

static void tell_idle(const placido_json *json, const char *name, placido_notes *notes) {
  for (size_t i = 0; i < sizeof idle_keys / sizeof *idle_keys; i++) {
    if (placido_json_find(json, idle_keys[i]) != NULL) {
      placido_notes_add(notes, "scene %s: %s has no effect in this build", name, idle_keys[i]);
    }
  }
  if (json_is_number(placido_json_find(json, "distance_m"))) {
    placido_notes_add(notes, "scene %s: distance_m has no effect in this build, everything is "
                      "seen at infinity", name);
  }
}

/* Optional fields that are there must still make sense. */
static int check_conditions(const placido_json *json, placido_error *err) {
  static const char *const positive[] = {"luminance_cd_m2", "distance_m", "tolerance"};
  for (size_t i = 0; i < sizeof positive / sizeof *positive; i++) {
    const json_t *value = placido_json_find(json, positive[i]);
    const char *text = json_string_value(value);
    bool infinite = strcmp(positive[i], "distance_m") == 0 && text != NULL &&
                    strcmp(text, "infinity") == 0;
    if (value == NULL || infinite) {
      continue;
    }
    double number;
    int status = placido_json_number(json, positive[i], &number, err);
    if (status == PLACIDO_OK && !(number > 0)) {
      status = placido_json_refuse(json, positive[i], err, "%g, expected above 0", number);
    }
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static int read_name(placido_scene *scene, const placido_json *json, const char *image,
                     placido_error *err) {
  int status = PLACIDO_OK;
  if (placido_json_find(json, "name") != NULL) {
    status = placido_json_string(json, "name", scene->name, sizeof scene->name, err);
  }
  if (status == PLACIDO_OK && scene->name[0] == '\0') {
    stem_of(scene->name, sizeof scene->name, image);
  }
  make_stem(scene->name);
  return status;
}

static int read_scene(placido_scene *scene, const placido_json *json, const char *path,
                      placido_notes *notes, placido_error *err) {
  char image[PLACIDO_PATH_MAX];
  placido_json_warn_unknown(json, "", known_keys, notes);
  int status = placido_json_string(json, "image", image, sizeof image, err);
  if (status == PLACIDO_OK && image[0] == '\0') {
    status = placido_json_refuse(json, "image", err, "is empty, expected a file or a chart's name");
  }
  if (status == PLACIDO_OK) {
    status = read_name(scene, json, image, err);
  }
  if (status == PLACIDO_OK) {
    status = check_conditions(json, err);
  }
  if (status == PLACIDO_OK) {
    status = refuse_future_chart(image, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  tell_idle(json, scene->name, notes);
  const placido_chart *chart = placido_chart_find(image);
  if (chart == NULL) {
    status = load_photograph(scene, path, image, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_calibration_read(&scene->arcmin_per_px, json, scene->image.width_px, notes,
                                      err);
  }
  if (status == PLACIDO_OK && chart != NULL) {
    status = draw_chart(scene, chart, err);
  }
  return status;
}

static int load_file(placido_scene *scene, const char *path, placido_notes *notes,
                     placido_error *err) {
  placido_json *json;
  int status = placido_json_load(&json, path, "placido-scene/1", err);
  if (status == PLACIDO_OK) {
    status = read_scene(scene, json, path, notes, err);
  }
  placido_json_free(json);
  return status;
}

int placido_scene_load(placido_scene *scene, const char *name_or_path, double chart_arcmin_per_px,
                       placido_notes *notes, placido_error *err) {
  *scene = (placido_scene){0};
  const placido_chart *chart = placido_chart_find(name_or_path);
  int status = refuse_future_chart(name_or_path, err);
  if (status == PLACIDO_OK && chart != NULL) {
    snprintf(scene->name, sizeof scene->name, "%s", chart->name);
    scene->arcmin_per_px = chart_arcmin_per_px > 0 ? chart_arcmin_per_px : usual_arcmin_per_px;
    status = draw_chart(scene, chart, err);
  } else if (status == PLACIDO_OK) {
    status = load_file(scene, name_or_path, notes, err);
  }
  if (status != PLACIDO_OK) {
    placido_scene_free(scene);
  }
  return status;
}

void placido_scene_free(placido_scene *scene) {
  if (scene != NULL) {
    placido_image_free(&scene->image);
    *scene = (placido_scene){0};
  }
}
