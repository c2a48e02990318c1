/* The topographer's geometry as a file: reading with every value checked, and writing. */
#include <placido/instrument.h>

#include "base/instrument_json.h"
#include "base/json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SIDE_MAX_PX 65536
/* A kilometre, and pixels in the same proportion: nothing real comes near, and products of such
 * numbers stay far from overflow. */
#define LENGTH_MAX_MM 1e6
#define FOCAL_MAX_PX 1e9
#define DISTORTION_MAX 1e9
/* Even the limbus (some 2 mm back, sloping at 45 degrees) mirrors nothing from farther behind. */
#define EDGE_MIN_MM (-10.0)

static int read_length(const placido_json *json, const char *path, double *value_mm,
                       placido_error *err) {
  int status = placido_json_number(json, path, value_mm, err);
  if (!status && fabs(*value_mm) > LENGTH_MAX_MM) {
    status = placido_json_refuse(json, path, err, "%g mm is over a kilometre", *value_mm);
  }
  return status;
}

static int read_model(placido_instrument *instrument, const placido_json *json,
                      placido_error *err) {
  char model[32];
  int status = placido_json_string(json, "camera.model", model, sizeof model, err);
  if (status) {
    return status;
  }
  instrument->model = strcmp(model, "telecentric") == 0 ? PLACIDO_TELECENTRIC : PLACIDO_PINHOLE;
  if (instrument->model == PLACIDO_PINHOLE && strcmp(model, "pinhole") != 0) {
    return placido_json_refuse(json, "camera.model", err,
                               "is \"%s\", \"pinhole\" or \"telecentric\" is expected", model);
  }
  return PLACIDO_OK;
}

/* focal_px or px_per_mm: a pair, or one number for both directions. */
static int read_scale(placido_instrument *instrument, const placido_json *json,
                      placido_error *err) {
  const char *path =
      instrument->model == PLACIDO_TELECENTRIC ? "camera.px_per_mm" : "camera.focal_px";
  double *scale = instrument->focal_px;
  int status;
  if (json_is_number(placido_json_find(json, path))) {
    status = placido_json_number(json, path, &scale[0], err);
    scale[1] = scale[0];
  } else {
    status = placido_json_numbers(json, path, scale, 2, err);
  }
  if (!status && !(scale[0] > 0 && scale[1] > 0)) {
    status = placido_json_refuse(json, path, err, "%g, %g must be positive", scale[0], scale[1]);
  }
  if (!status && !(scale[0] <= FOCAL_MAX_PX && scale[1] <= FOCAL_MAX_PX)) {
    status = placido_json_refuse(json, path, err, "%g, %g is over %g", scale[0], scale[1],
                                 FOCAL_MAX_PX);
  }
  return status;
}

static int read_size(placido_instrument *instrument, const placido_json *json,
                     placido_error *err) {
  size_t count;
  int status = placido_json_count(json, "camera.image_size_px", &count, err);
  if (!status && count != 2) {
    status = placido_json_refuse(json, "camera.image_size_px", err,
                                 "has %zu elements, width and height are expected", count);
  }
  if (!status) {
    status = placido_json_integer(json, "camera.image_size_px[0]", 1, SIDE_MAX_PX,
                                  &instrument->width_px, err);
  }
  if (!status) {
    status = placido_json_integer(json, "camera.image_size_px[1]", 1, SIDE_MAX_PX,
                                  &instrument->height_px, err);
  }
  return status;
}

static int read_position(placido_instrument *instrument, const placido_json *json,
                         placido_error *err) {
  const char *path = "camera.position_mm";
  double *position_mm = instrument->position_mm;
  int status = placido_json_numbers(json, path, position_mm, 3, err);
  for (int i = 0; !status && i < 3; i++) {
    if (fabs(position_mm[i]) > LENGTH_MAX_MM) {
      status = placido_json_refuse(json, path, err, "%g mm is over a kilometre", position_mm[i]);
    }
  }
  if (!status && position_mm[2] <= 0) {
    status = placido_json_refuse(json, path, err,
                                 "z is %g mm; the camera must stand in front of the cornea (z > 0)",
                                 position_mm[2]);
  }
  return status;
}

static int read_principal(placido_instrument *instrument, const placido_json *json,
                          placido_error *err) {
  const char *path = "camera.principal_px";
  double *principal_px = instrument->principal_px;
  int status = placido_json_numbers(json, path, principal_px, 2, err);
  for (int i = 0; !status && i < 2; i++) {
    if (fabs(principal_px[i]) > FOCAL_MAX_PX) {
      status = placido_json_refuse(json, path, err, "%g is over %g", principal_px[i],
                                   FOCAL_MAX_PX);
    }
  }
  return status;
}

/* May be missing: none. */
static int read_distortion(placido_instrument *instrument, const placido_json *json,
                           placido_error *err) {
  const char *path = "camera.distortion";
  if (!placido_json_find(json, path)) {
    return PLACIDO_OK;
  }
  int status = placido_json_numbers(json, path, instrument->distortion, 5, err);
  for (int i = 0; !status && i < 5; i++) {
    if (fabs(instrument->distortion[i]) > DISTORTION_MAX) {
      status = placido_json_refuse(json, path, err, "%g is over %g", instrument->distortion[i],
                                   DISTORTION_MAX);
    }
  }
  return status;
}

static int read_camera(placido_instrument *instrument, const placido_json *json,
                       placido_error *err) {
  int status = read_model(instrument, json, err);
  if (!status) {
    status = read_size(instrument, json, err);
  }
  if (!status) {
    status = read_scale(instrument, json, err);
  }
  if (!status) {
    status = read_principal(instrument, json, err);
  }
  if (!status) {
    status = read_distortion(instrument, json, err);
  }
  if (!status) {
    status = read_position(instrument, json, err);
  }
  return status;
}

static int read_first_band(placido_instrument *instrument, const placido_json *json,
                           placido_error *err) {
  char band[32];
  int status = placido_json_string(json, "mires.first_band", band, sizeof band, err);
  if (status) {
    return status;
  }
  instrument->first_band_bright = strcmp(band, "bright") == 0;
  if (!instrument->first_band_bright && strcmp(band, "dark") != 0) {
    return placido_json_refuse(json, "mires.first_band", err,
                               "is \"%s\", \"bright\" or \"dark\" is expected", band);
  }
  return PLACIDO_OK;
}

static int read_edge(placido_edge *edge, const placido_json *json, size_t index,
                     placido_error *err) {
  char radius_path[64], z_path[64];
  snprintf(radius_path, sizeof radius_path, "mires.edges[%zu].radius_mm", index);
  snprintf(z_path, sizeof z_path, "mires.edges[%zu].z_mm", index);
  int status = read_length(json, radius_path, &edge->radius_mm, err);
  if (!status && edge->radius_mm <= 0) {
    status = placido_json_refuse(json, radius_path, err, "%g mm must be positive",
                                 edge->radius_mm);
  }
  if (!status) {
    status = read_length(json, z_path, &edge->z_mm, err);
  }
  if (!status && edge->z_mm < EDGE_MIN_MM) {
    status = placido_json_refuse(json, z_path, err,
                                 "%g mm: the edge lies behind the cornea (%g mm or more is "
                                 "expected)",
                                 edge->z_mm, EDGE_MIN_MM);
  }
  return status;
}

static int read_mires(placido_instrument *instrument, const placido_json *json,
                      placido_error *err) {
  size_t count;
  int status = read_first_band(instrument, json, err);
  if (!status) {
    status = placido_json_count(json, "mires.edges", &count, err);
  }
  if (status) {
    return status;
  }
  if (count < 1 || count > PLACIDO_EDGES_MAX) {
    return placido_json_refuse(json, "mires.edges", err, "has %zu edges, 1 to %d are expected",
                               count, PLACIDO_EDGES_MAX);
  }
  for (size_t i = 0; !status && i < count; i++) {
    status = read_edge(&instrument->edges[i], json, i, err);
  }
  instrument->edge_count = (int)count;
  return status;
}

static void warn_unknown(const placido_json *json, placido_notes *notes) {
  static const char *const root[] = {"format", "name",       "camera",     "mires",
                                     "sigma",  "covariance", "calibrated", NULL};
  static const char *const camera[] = {"model",        "image_size_px", "focal_px", "px_per_mm",
                                       "principal_px", "distortion",    "position_mm", NULL};
  static const char *const mires[] = {"first_band", "edges", NULL};
  placido_json_warn_unknown(json, "", root, notes);
  placido_json_warn_unknown(json, "camera", camera, notes);
  placido_json_warn_unknown(json, "mires", mires, notes);
}

int placido_instrument_load(placido_instrument *instrument, const char *path,
                            placido_notes *notes, placido_error *err) {
  *instrument = (placido_instrument){0};
  placido_json *json;
  int status = placido_json_load(&json, path, PLACIDO_INSTRUMENT_FORMAT, err);
  if (status) {
    return status;
  }
  status = placido_json_string(json, "name", instrument->name, sizeof instrument->name, err);
  if (!status) {
    status = read_camera(instrument, json, err);
  }
  if (!status) {
    status = read_mires(instrument, json, err);
  }
  /* a file that does not say that its geometry was measured holds nominal geometry */
  instrument->calibrated = placido_json_find(json, "sigma") != NULL;
  if (!status && placido_json_find(json, "calibrated")) {
    status = placido_json_boolean(json, "calibrated", &instrument->calibrated, err);
  }
  if (!status) {
    warn_unknown(json, notes);
  } else {
    *instrument = (placido_instrument){0};
  }
  placido_json_free(json);
  return status;
}

json_t *placido_json_array(const double *values, int count) {
  json_t *array = json_array();
  for (int i = 0; array && i < count; i++) {
    if (json_array_append_new(array, placido_json_real(values[i])) != 0) {
      json_decref(array);
      array = NULL;
    }
  }
  return array;
}

static json_t *camera_object(const placido_instrument *instrument) {
  bool telecentric = instrument->model == PLACIDO_TELECENTRIC;
  return json_pack("{s:s, s:[i,i], s:o, s:o, s:o, s:o}",
                   "model", telecentric ? "telecentric" : "pinhole",
                   "image_size_px", instrument->width_px, instrument->height_px,
                   telecentric ? "px_per_mm" : "focal_px",
                   placido_json_array(instrument->focal_px, 2),
                   "principal_px", placido_json_array(instrument->principal_px, 2),
                   "distortion", placido_json_array(instrument->distortion, 5),
                   "position_mm", placido_json_array(instrument->position_mm, 3));
}

static json_t *edges_array(const placido_instrument *instrument) {
  json_t *array = json_array();
  for (int i = 0; array && i < instrument->edge_count; i++) {
    const placido_edge *edge = &instrument->edges[i];
    json_t *object = json_pack("{s:o, s:o}", "radius_mm", placido_json_real(edge->radius_mm),
                               "z_mm", placido_json_real(edge->z_mm));
    if (json_array_append_new(array, object) != 0) {
      json_decref(array);
      array = NULL;
    }
  }
  return array;
}

json_t *placido_instrument_json(const placido_instrument *instrument, placido_error *err) {
  json_t *root = json_pack("{s:s, s:s, s:o, s:{s:s, s:o}, s:b}",
                           "format", PLACIDO_INSTRUMENT_FORMAT,
                           "name", instrument->name,
                           "camera", camera_object(instrument),
                           "mires",
                           "first_band", instrument->first_band_bright ? "bright" : "dark",
                           "edges", edges_array(instrument),
                           "calibrated", (int)instrument->calibrated);
  if (!root) {
    placido_error_set(err, PLACIDO_MEMORY, "cannot put instrument %.100s into JSON",
                      instrument->name);
  }
  return root;
}

int placido_instrument_save(const placido_instrument *instrument, const char *path,
                            placido_error *err) {
  json_t *root = placido_instrument_json(instrument, err);
  if (!root) {
    return PLACIDO_MEMORY;
  }
  int status = placido_json_save(root, path, err);
  json_decref(root);
  return status;
}
