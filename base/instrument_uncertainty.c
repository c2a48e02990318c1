/* The geometry's covariance in its instrument file: standard deviations that mirror the file's own
 * fields, and the modes in which the parameters move together. */
#include <placido/uncertainty.h>

#include "base/instrument_json.h"
#include "base/json.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Nothing real comes near, and squares stay far from overflow. */
#define SIGMA_MAX 1e9

/* The camera's parameters as fields of the file. */
typedef struct field {
  const char *name;
  int first, count;
} field;

#define FIELDS 4
static const field pinhole[FIELDS] = {
    {"focal_px", 0, 2}, {"principal_px", 2, 2}, {"distortion", 4, 5}, {"position_mm", 9, 3}};
static const field telecentric[FIELDS] = {
    {"px_per_mm", 0, 2}, {"principal_px", 2, 2}, {"distortion", 4, 5}, {"position_mm", 9, 3}};

double *placido_instrument_parameter(placido_instrument *instrument, int parameter) {
  double *const groups[FIELDS] = {instrument->focal_px, instrument->principal_px,
                                  instrument->distortion, instrument->position_mm};
  for (int i = 0; i < FIELDS; i++) {
    if (parameter < pinhole[i].first + pinhole[i].count) {
      return &groups[i][parameter - pinhole[i].first];
    }
  }
  int edge = parameter - PLACIDO_UNCERTAINTY_CAMERA, n = instrument->edge_count;
  return edge < n ? &instrument->edges[edge].radius_mm : &instrument->edges[edge - n].z_mm;
}

int placido_uncertainty_new(placido_uncertainty *uncertainty, int edge_count, int mode_count,
                            placido_error *err) {
  int n = PLACIDO_UNCERTAINTY_CAMERA + 2 * edge_count;
  *uncertainty = (placido_uncertainty){
      .edge_count = edge_count, .parameter_count = n, .mode_count = mode_count};
  uncertainty->factor = placido_memory_new((size_t)n * (size_t)mode_count,
                                           sizeof *uncertainty->factor, err);
  uncertainty->sigma = placido_memory_new((size_t)n, sizeof *uncertainty->sigma, err);
  if (!uncertainty->factor || !uncertainty->sigma) {
    placido_uncertainty_free(uncertainty);
    return PLACIDO_MEMORY;
  }
  return PLACIDO_OK;
}

void placido_uncertainty_free(placido_uncertainty *uncertainty) {
  placido_memory_free(uncertainty->factor);
  placido_memory_free(uncertainty->sigma);
  *uncertainty = (placido_uncertainty){0};
}

void placido_uncertainty_apply(placido_instrument *out, const placido_instrument *instrument,
                               const placido_uncertainty *uncertainty, int mode, double amount) {
  const double *f = uncertainty->factor + (size_t)mode * (size_t)uncertainty->parameter_count;
  placido_instrument moved = *instrument;
  for (int i = 0; i < uncertainty->parameter_count; i++) {
    *placido_instrument_parameter(&moved, i) += amount * f[i];
  }
  *out = moved;
}

static int check_sigma(const placido_json *json, const char *path, double sigma,
                       placido_error *err) {
  if (!(sigma >= 0 && sigma <= SIGMA_MAX)) {
    return placido_json_refuse(json, path, err,
                               "%g is no standard deviation: 0 to %g is expected", sigma,
                               SIGMA_MAX);
  }
  return PLACIDO_OK;
}

/* A field that may be missing (0: exactly known). */
static int read_sigmas(double *sigma, int count, const placido_json *json, const char *path,
                       placido_error *err) {
  if (!placido_json_find(json, path)) {
    return PLACIDO_OK;
  }
  int status = placido_json_numbers(json, path, sigma, (size_t)count, err);
  for (int i = 0; !status && i < count; i++) {
    status = check_sigma(json, path, sigma[i], err);
  }
  return status;
}

static int read_sigma(double *sigma, const placido_json *json, const char *path,
                      placido_error *err) {
  int status = placido_json_number(json, path, sigma, err);
  return status ? status : check_sigma(json, path, *sigma, err);
}

/* sigma.mires: {"edges": [...]}, or one pair for every edge. */
static int read_edge_sigmas(placido_uncertainty *u, const placido_json *json,
                            placido_error *err) {
  double *sigma = u->sigma + PLACIDO_UNCERTAINTY_CAMERA;
  size_t count = (size_t)u->edge_count;
  bool each = placido_json_find(json, "sigma.mires.edges") != NULL;
  int status = PLACIDO_OK;
  if (!placido_json_find(json, "sigma.mires")) {
    return PLACIDO_OK;
  }
  if (each) {
    status = placido_json_count(json, "sigma.mires.edges", &count, err);
  }
  if (!status && count != (size_t)u->edge_count) {
    status = placido_json_refuse(json, "sigma.mires.edges", err,
                                 "has %zu elements, the instrument has %d edges", count,
                                 u->edge_count);
  }
  for (int k = 0; !status && k < 2 * u->edge_count; k++) {
    char path[64];
    const char *name = k < u->edge_count ? "radius_mm" : "z_mm";
    if (each) {
      snprintf(path, sizeof path, "sigma.mires.edges[%d].%s", k % u->edge_count, name);
    } else {
      snprintf(path, sizeof path, "sigma.mires.%s", name);
    }
    status = read_sigma(&sigma[k], json, path, err);
  }
  return status;
}

static int read_all_sigmas(placido_uncertainty *u, const placido_json *json,
                           placido_error *err) {
  const field *fields =
      placido_json_find(json, "camera.px_per_mm") ? telecentric : pinhole;
  int status = PLACIDO_OK;
  for (int i = 0; i < FIELDS && !status; i++) {
    char path[64];
    snprintf(path, sizeof path, "sigma.camera.%s", fields[i].name);
    status = read_sigmas(u->sigma + fields[i].first, fields[i].count, json, path, err);
  }
  return status ? status : read_edge_sigmas(u, json, err);
}

static int read_modes(placido_uncertainty *u, const placido_json *json, placido_error *err) {
  for (int m = 0; m < u->mode_count; m++) {
    char path[64];
    double *f = u->factor + (size_t)m * (size_t)u->parameter_count;
    snprintf(path, sizeof path, "covariance.modes[%d]", m);
    int status = placido_json_numbers(json, path, f, (size_t)u->parameter_count, err);
    for (int i = 0; i < u->parameter_count && !status; i++) {
      status = check_sigma(json, path, fabs(f[i]), err);
    }
    if (status) {
      return status;
    }
  }
  return PLACIDO_OK;
}

/* How many modes the file gives; without a covariance every parameter may become one. */
static int count_modes(int *modes, const placido_json *json, int parameters,
                       placido_error *err) {
  *modes = parameters;
  if (!placido_json_find(json, "covariance")) {
    return PLACIDO_OK;
  }
  size_t count;
  int status = placido_json_count(json, "covariance.modes", &count, err);
  if (!status && count > PLACIDO_UNCERTAINTY_MODES) {
    status = placido_json_refuse(json, "covariance.modes", err, "has %zu modes, at most %d are "
                                 "expected", count, PLACIDO_UNCERTAINTY_MODES);
  }
  *modes = status ? 0 : (int)count;
  return status;
}

/* Each standard deviation that is not 0 becomes a mode. */
static void modes_of_sigmas(placido_uncertainty *u) {
  u->mode_count = 0;
  for (int i = 0; i < u->parameter_count; i++) {
    if (u->sigma[i] > 0) {
      u->factor[(size_t)u->mode_count++ * (size_t)u->parameter_count + (size_t)i] = u->sigma[i];
    }
  }
}

static int read_both(placido_uncertainty *uncertainty, const placido_json *json,
                     placido_error *err) {
  size_t edges;
  int modes = 0, status = placido_json_count(json, "mires.edges", &edges, err);
  if (!status && (edges < 1 || edges > PLACIDO_EDGES_MAX)) {
    status = placido_json_refuse(json, "mires.edges", err, "has %zu edges, 1 to %d are expected",
                                 edges, PLACIDO_EDGES_MAX);
  }
  if (!status) {
    status = count_modes(&modes, json, PLACIDO_UNCERTAINTY_CAMERA + 2 * (int)edges, err);
  }
  if (!status) {
    status = placido_uncertainty_new(uncertainty, (int)edges, modes, err);
  }
  if (!status) {
    status = read_all_sigmas(uncertainty, json, err);
  }
  if (!status && placido_json_find(json, "covariance")) {
    status = read_modes(uncertainty, json, err);
  } else if (!status) {
    modes_of_sigmas(uncertainty);
  }
  return status;
}

int placido_uncertainty_load(placido_uncertainty *uncertainty, const char *path,
                             placido_error *err) {
  *uncertainty = (placido_uncertainty){0};
  placido_json *json;
  int status = placido_json_load(&json, path, PLACIDO_INSTRUMENT_FORMAT, err);
  if (status) {
    return status;
  }
  if (placido_json_find(json, "sigma") || placido_json_find(json, "covariance")) {
    status = read_both(uncertainty, json, err);
  }
  if (status) {
    placido_uncertainty_free(uncertainty);
  }
  placido_json_free(json);
  return status;
}

/* Puts an element into an array that may be NULL already; NULL once anything is missing. */
static json_t *extend(json_t *array, json_t *element) {
  if (json_array_append_new(array, element) != 0) {
    json_decref(array);
    array = NULL;
  }
  return array;
}

static json_t *sigma_object(const placido_uncertainty *u, bool is_telecentric) {
  const field *f = is_telecentric ? telecentric : pinhole;
  json_t *values[FIELDS], *edges = json_array();
  for (int i = 0; i < FIELDS; i++) {
    values[i] = placido_json_array(u->sigma + f[i].first, f[i].count);
  }
  const double *edge = u->sigma + PLACIDO_UNCERTAINTY_CAMERA;
  for (int k = 0; k < u->edge_count; k++) {
    edges = extend(edges, json_pack("{s:o, s:o}", "radius_mm", placido_json_real(edge[k]), "z_mm",
                                    placido_json_real(edge[u->edge_count + k])));
  }
  return json_pack("{s:{s:o, s:o, s:o, s:o}, s:{s:o}}", "camera", f[0].name, values[0], f[1].name,
                   values[1], f[2].name, values[2], f[3].name, values[3], "mires", "edges", edges);
}

static json_t *covariance_object(const placido_uncertainty *u) {
  json_t *modes = json_array();
  for (int m = 0; m < u->mode_count; m++) {
    const double *f = u->factor + (size_t)m * (size_t)u->parameter_count;
    modes = extend(modes, placido_json_array(f, u->parameter_count));
  }
  return json_pack("{s:o}", "modes", modes);
}

int placido_uncertainty_save(const placido_uncertainty *uncertainty,
                             const placido_instrument *instrument, const char *path,
                             placido_error *err) {
  json_t *root = placido_instrument_json(instrument, err);
  if (!root) {
    return PLACIDO_MEMORY;
  }
  int failed = 0;
  if (uncertainty->sigma) {
    bool is_telecentric = instrument->model == PLACIDO_TELECENTRIC;
    failed |= json_object_set_new(root, "sigma", sigma_object(uncertainty, is_telecentric));
  }
  if (uncertainty->mode_count > 0 && uncertainty->mode_count <= PLACIDO_UNCERTAINTY_MODES) {
    failed |= json_object_set_new(root, "covariance", covariance_object(uncertainty));
  }
  int status = failed ? placido_error_set(err, PLACIDO_MEMORY, "cannot put instrument %.100s "
                                          "into JSON", instrument->name)
                      : placido_json_save(root, path, err);
  json_decref(root);
  return status;
}
