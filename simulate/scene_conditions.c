/* The conditions of a scene: light, distance, tolerance. */
#include "base/file.h"
#include "simulate/scene_file.h"

#include <math.h>
#include <string.h>

static const double usual_tolerance = 0.01;

static const struct {
  const char *name;
  enum placido_spectrum spectrum;
} spectra[] = {
  {"display-srgb", PLACIDO_SPECTRUM_DISPLAY_SRGB},
  {"equal-energy", PLACIDO_SPECTRUM_EQUAL_ENERGY},
  {"daylight", PLACIDO_SPECTRUM_DAYLIGHT},
  {"incandescent", PLACIDO_SPECTRUM_INCANDESCENT},
};

placido_conditions placido_conditions_of(const placido_chart *chart) {
  bool lit = chart != NULL && chart->luminance_cd_m2 > 0;
  bool near = chart != NULL && chart->distance_m > 0;
  return (placido_conditions){.luminance_cd_m2 = lit ? chart->luminance_cd_m2 : NAN,
                              .distance_m = near ? chart->distance_m : INFINITY,
                              .spectrum = chart != NULL ? chart->spectrum
                                                        : PLACIDO_SPECTRUM_DISPLAY_SRGB,
                              .wavelength_nm = NAN,
                              .tolerance = usual_tolerance};
}

/* A number from min to max, or what `value` is already where the field is missing. */
static int read_range(const placido_json *json, const char *field, double min, double max,
                      double *value, placido_error *err) {
  double read;
  if (placido_json_find(json, field) == NULL) {
    return PLACIDO_OK;
  }
  int status = placido_json_number(json, field, &read, err);
  if (status == PLACIDO_OK && !(read >= min && read <= max)) {
    status = placido_json_refuse(json, field, err, "%g, expected %g to %g", read, min, max);
  }
  if (status == PLACIDO_OK) {
    *value = read;
  }
  return status;
}

static int read_distance(placido_conditions *conditions, const placido_json *json,
                         placido_error *err) {
  const char *text = json_string_value(placido_json_find(json, "distance_m"));
  if (text == NULL) {
    return read_range(json, "distance_m", 0.01, 1e9, &conditions->distance_m, err);
  }
  if (strcmp(text, "infinity") != 0) {
    return placido_json_refuse(json, "distance_m", err,
                               "\"%s\", expected metres or \"infinity\"", text);
  }
  conditions->distance_m = INFINITY;
  return PLACIDO_OK;
}

static int read_spectrum(placido_conditions *conditions, const placido_json *json,
                         placido_error *err) {
  const json_t *value = placido_json_find(json, "spectrum");
  const char *text = json_string_value(value);
  if (json_is_number(value)) {
    conditions->spectrum = PLACIDO_SPECTRUM_LINE;
    return read_range(json, "spectrum", 380, 780, &conditions->wavelength_nm, err);
  }
  for (size_t i = 0; text != NULL && i < sizeof spectra / sizeof *spectra; i++) {
    if (strcmp(text, spectra[i].name) == 0) {
      conditions->spectrum = spectra[i].spectrum;
      return PLACIDO_OK;
    }
  }
  return value == NULL ? PLACIDO_OK
                       : placido_json_refuse(json, "spectrum", err,
                                             "expected display-srgb, equal-energy, daylight, "
                                             "incandescent or a wavelength in nm");
}

/* Where the depth map is. Without a distance the eye looks at what it has in the middle, which is
 * not known before it is read. */
static int read_depth_path(placido_conditions *conditions, const placido_json *json,
                           const char *path, placido_error *err) {
  char name[sizeof conditions->depth_path], whole[PLACIDO_PATH_MAX];
  if (placido_json_find(json, "depth") == NULL) {
    return PLACIDO_OK;
  }
  int status = placido_json_string(json, "depth", name, sizeof name, err);
  if (status == PLACIDO_OK) {
    status = placido_scene_beside(whole, path, name, err);
  }
  if (status == PLACIDO_OK && strlen(whole) >= sizeof conditions->depth_path) {
    status = placido_error_set(err, PLACIDO_INPUT, "a path of %zu bytes is too long",
                               strlen(whole));
  }
  if (status == PLACIDO_OK) {
    memcpy(conditions->depth_path, whole, strlen(whole) + 1);
  }
  if (placido_json_find(json, "distance_m") == NULL) {
    conditions->distance_m = NAN;
  }
  return status;
}

int placido_conditions_read(placido_conditions *conditions, const placido_json *json,
                            const char *path, placido_error *err) {
  int status = read_range(json, "luminance_cd_m2", 1e-6, 1e6, &conditions->luminance_cd_m2, err);
  if (status == PLACIDO_OK) {
    status = read_distance(conditions, json, err);
  }
  if (status == PLACIDO_OK) {
    status = read_spectrum(conditions, json, err);
  }
  if (status == PLACIDO_OK) {
    status = read_range(json, "tolerance", 1e-6, 1, &conditions->tolerance, err);
  }
  if (status == PLACIDO_OK) {
    status = read_depth_path(conditions, json, path, err);
  }
  return status;
}
