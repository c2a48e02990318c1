/* Calibration of scenes: four ways to know how large a pixel is seen.
 *
 * A picture is a plane before the eye, so a pixel's angle is largest in its middle; that is the one
 * given: atan(pixel's size / plane's distance). At the rim of a picture 12 degrees wide it is 1 %
 * less. */
#include "simulate/calibration.h"

#include "simulate/eye.h"

#include <math.h>
#include <string.h>

/* What a pixel may be seen under: from far below what any eye resolves to the widest picture's only
 * one. */
static const double least_arcmin = 1e-6, most_arcmin = 170 * 60;

/* A pixel's size relative to its distance. */
typedef int read_tangent(double *tangent, const placido_json *json, int width_px,
                         placido_error *err);

/* A number above 0 and at most `max`. */
static int positive(const placido_json *json, const char *path, double max, double *value,
                    placido_error *err) {
  int status = placido_json_number(json, path, value, err);
  if (status == PLACIDO_OK && !(*value > 0 && *value <= max)) {
    status = placido_json_refuse(json, path, err, "%g, expected above 0 and at most %g", *value,
                                 max);
  }
  return status;
}

static int read_angle(double *tangent, const placido_json *json, int width_px,
                      placido_error *err) {
  double arcmin;
  (void)width_px;
  int status = positive(json, "calibration.value", 600, &arcmin, err);
  *tangent = 2 * tan(arcmin * PLACIDO_ARCMIN_RAD / 2);
  return status;
}

static int read_camera(double *tangent, const placido_json *json, int width_px,
                       placido_error *err) {
  double fov_deg;
  int status = positive(json, "calibration.horizontal_fov_deg", 170, &fov_deg, err);
  if (status == PLACIDO_OK && width_px == 0) {
    status = placido_json_refuse(json, "calibration.kind", err,
                                 "\"camera\" is for photographs, a chart needs another kind");
  }
  *tangent = 2 * tan(fov_deg * 30 * PLACIDO_ARCMIN_RAD) / (width_px > 0 ? width_px : 1);
  return status;
}

static int read_object(double *tangent, const placido_json *json, int width_px,
                       placido_error *err) {
  double size_m, distance_m, size_px;
  (void)width_px;
  *tangent = 0;
  int status = positive(json, "calibration.size_m", 1e6, &size_m, err);
  if (status == PLACIDO_OK) {
    status = positive(json, "calibration.distance_m", 1e9, &distance_m, err);
  }
  if (status == PLACIDO_OK) {
    status = positive(json, "calibration.size_px", 65536, &size_px, err);
  }
  if (status == PLACIDO_OK) {
    *tangent = size_m / distance_m / size_px;
  }
  return status;
}

static int read_monitor(double *tangent, const placido_json *json, int width_px,
                        placido_error *err) {
  double dpi, distance_m;
  (void)width_px;
  *tangent = 0;
  int status = positive(json, "calibration.dpi", 10000, &dpi, err);
  if (status == PLACIDO_OK) {
    status = positive(json, "calibration.distance_m", 1e5, &distance_m, err);
  }
  if (status == PLACIDO_OK) {
    *tangent = 0.0254 / dpi / distance_m;
  }
  return status;
}

static const struct {
  const char *kind;
  read_tangent *read;
  const char *known[5];
} kinds[] = {
  {"arcmin_per_px", read_angle, {"kind", "value", NULL}},
  {"camera", read_camera, {"kind", "horizontal_fov_deg", NULL}},
  {"object", read_object, {"kind", "size_m", "distance_m", "size_px", NULL}},
  {"monitor", read_monitor, {"kind", "dpi", "distance_m", NULL}},
};

int placido_calibration_read(double *arcmin_per_px, const placido_json *json, int width_px,
                             placido_notes *notes, placido_error *err) {
  char kind[32];
  *arcmin_per_px = 0;
  int status = placido_json_string(json, "calibration.kind", kind, sizeof kind, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    if (strcmp(kind, kinds[i].kind) == 0) {
      double tangent;
      placido_json_warn_unknown(json, "calibration", kinds[i].known, notes);
      status = kinds[i].read(&tangent, json, width_px, err);
      if (status != PLACIDO_OK) {
        return status;
      }
      const double arcmin = 2 * atan(tangent / 2) / PLACIDO_ARCMIN_RAD;
      if (!(arcmin >= least_arcmin && arcmin <= most_arcmin)) {
        return placido_json_refuse(json, "calibration", err,
                                   "makes a pixel %g arcmin large, expected %g to %g", arcmin,
                                   least_arcmin, most_arcmin);
      }
      *arcmin_per_px = arcmin;
      return PLACIDO_OK;
    }
  }
  return placido_json_refuse(json, "calibration.kind", err,
                             "\"%s\", expected arcmin_per_px, camera, object or monitor", kind);
}
