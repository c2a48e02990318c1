/* Scene files: a chart or a picture file, its calibration, how it is seen. */
#include "simulate/scene_file.h"

#include "base/file.h"
#include "simulate/calibration.h"
#include "simulate/charts/chart.h"
#include "simulate/charts/logmar.h"
#include "simulate/depth/map.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const known_keys[] = {
  "format",     "name",  "image",    "calibration", "chart",      "luminance_cd_m2",
  "distance_m", "depth", "spectrum", "tolerance",   "resampling", "allow_coarse", NULL};
static const char *const known_chart_keys[] = {"first_logmar", "last_logmar", "directions", NULL};

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

int placido_scene_beside(char *out, const char *path, const char *name, placido_error *err) {
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

static int read_seeing(placido_scene *scene, const placido_json *json, placido_error *err) {
  char resampling[32] = "area";
  int status = PLACIDO_OK;
  if (placido_json_find(json, "resampling") != NULL) {
    status = placido_json_string(json, "resampling", resampling, sizeof resampling, err);
  }
  if (status == PLACIDO_OK && placido_json_find(json, "allow_coarse") != NULL) {
    status = placido_json_boolean(json, "allow_coarse", &scene->allow_coarse, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  bool bicubic = strcmp(resampling, "bicubic") == 0;
  if (!bicubic && strcmp(resampling, "area") != 0) {
    return placido_json_refuse(json, "resampling", err, "\"%s\", expected area or bicubic",
                               resampling);
  }
  scene->resampling = bicubic ? PLACIDO_RESAMPLING_BICUBIC : PLACIDO_RESAMPLING_AREA;
  return PLACIDO_OK;
}

static int read_optional(const placido_json *json, const char *path, double *value,
                         placido_error *err) {
  return placido_json_find(json, path) != NULL ? placido_json_number(json, path, value, err)
                                               : PLACIDO_OK;
}

/* The object "chart". One of the two numbers alone is one line. */
static int read_lines(placido_chart_lines *lines, const placido_json *json, placido_notes *notes,
                      placido_error *err) {
  bool first = placido_json_find(json, "chart.first_logmar") != NULL;
  bool last = placido_json_find(json, "chart.last_logmar") != NULL;
  *lines = placido_logmar_usual();
  placido_json_warn_unknown(json, "chart", known_chart_keys, notes);
  int status = read_optional(json, "chart.first_logmar", &lines->first_logmar, err);
  if (status == PLACIDO_OK) {
    status = read_optional(json, "chart.last_logmar", &lines->last_logmar, err);
  }
  if (status == PLACIDO_OK && placido_json_find(json, "chart.directions") != NULL) {
    status = placido_json_integer(json, "chart.directions", 4, 8, &lines->directions, err);
  }
  if (first != last) {
    lines->first_logmar = lines->last_logmar = first ? lines->first_logmar : lines->last_logmar;
  }
  placido_error reason = {0};
  if (status == PLACIDO_OK && placido_logmar_check(lines, &reason) != PLACIDO_OK) {
    status = placido_json_refuse(json, "chart", err, "%s", reason.text);
  }
  return status;
}

static int read_chart(placido_scene *scene, const char *chart, double arcmin_per_px,
                      const placido_json *json, placido_notes *notes, placido_error *err) {
  placido_scene drawn = {0};
  placido_chart_lines lines;
  bool own_lines = placido_json_find(json, "chart") != NULL;
  int status = own_lines ? read_lines(&lines, json, notes, err) : PLACIDO_OK;
  if (status == PLACIDO_OK && placido_json_find(json, "calibration") != NULL) {
    status = placido_calibration_read(&arcmin_per_px, json, 0, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_scene_draw(&drawn, chart, own_lines ? &lines : NULL, arcmin_per_px, err);
  }
  scene->image = drawn.image;
  scene->arcmin_per_px = drawn.arcmin_per_px;
  scene->bleed_px = drawn.bleed_px;
  scene->bits = drawn.bits;
  scene->depth_D = drawn.depth_D;
  return status;
}

static int read_depth(placido_scene *scene, placido_error *err) {
  const char *path = scene->conditions.depth_path;
  return path[0] != '\0' ? placido_depth_load(scene, path, err) : PLACIDO_OK;
}

/* A picture is a plane: far from its middle a pixel is seen under a smaller angle (cos²). */
static void tell_width(const placido_scene *scene, placido_notes *notes) {
  const double told_deg = 20, arcmin = acos(-1) / 10800;
  double half = scene->image.width_px * tan(scene->arcmin_per_px / 2 * arcmin);
  double width_deg = 2 * atan(half) / (60 * arcmin);
  if (width_deg > told_deg) {
    placido_notes_add(notes, "scene %s is %.0f degrees wide: at its rim a pixel is seen %.0f %% "
                      "smaller than in the middle, but blurred like one there", scene->name,
                      width_deg, 100 * half * half / (1 + half * half));
  }
}

static int read_photograph(placido_scene *scene, const char *scene_path, const char *name,
                           const placido_json *json, placido_notes *notes, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = placido_scene_beside(path, scene_path, name, err);
  if (status == PLACIDO_OK && placido_json_find(json, "chart") != NULL) {
    status = placido_json_refuse(json, "chart", err, "%s is a photograph", name);
  }
  if (status == PLACIDO_OK) {
    status = placido_photograph_load(&scene->image, &scene->bits, path, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_calibration_read(&scene->arcmin_per_px, json, scene->image.width_px, notes,
                                      err);
  }
  if (status == PLACIDO_OK) {
    tell_width(scene, notes);
  }
  return status;
}

/* What every scene has, then what its picture needs. */
static int read_scene(placido_scene *scene, const placido_json *json, const char *path,
                      double chart_arcmin_per_px, placido_notes *notes, placido_error *err) {
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
    status = read_seeing(scene, json, err);
  }
  const placido_chart *chart = placido_chart_find(image);
  if (status == PLACIDO_OK) {
    scene->conditions = placido_conditions_of(chart);
    status = placido_conditions_read(&scene->conditions, json, path, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = chart != NULL ? read_chart(scene, chart->name, chart_arcmin_per_px, json, notes, err)
                         : read_photograph(scene, path, image, json, notes, err);
  return status == PLACIDO_OK ? read_depth(scene, err) : status;
}

int placido_scene_read(placido_scene *scene, const char *path, double chart_arcmin_per_px,
                       placido_notes *notes, placido_error *err) {
  placido_json *json;
  int status = placido_json_load(&json, path, "placido-scene/1", err);
  if (status == PLACIDO_OK) {
    status = read_scene(scene, json, path, chart_arcmin_per_px, notes, err);
  }
  placido_json_free(json);
  return status;
}
