/* The built-in instruments, made by rule: a cone whose mires look evenly spaced on an average
 * cornea, and a flat disc of evenly spaced mires. */
#include <math.h>
#include <placido/phantom.h>
#include <stdio.h>
#include <string.h>

/* An instrument of the table. */
typedef struct design {
  const char *name;
  void (*make)(placido_instrument *instrument);
} design;

static placido_instrument camera_at(double distance_mm, double focal_px, const char *name) {
  placido_instrument instrument = {
      .model = PLACIDO_PINHOLE,
      .width_px = 1280,
      .height_px = 1024,
      .focal_px = {focal_px, focal_px},
      .principal_px = {639.5, 511.5},
      .position_mm = {0, 0, distance_mm},
      .first_band_bright = true,
      .calibrated = true,
  };
  snprintf(instrument.name, sizeof instrument.name, "%s", name);
  return instrument;
}

/* Tangent of the angle between the z axis and the ray that a camera on the axis sees mirrored at
 * height r_mm of a sphere with its vertex at 0: it is turned by twice the slope's angle. */
static double mirrored_tangent(double r_mm, double sphere_mm, double camera_mm, double *z_mm) {
  *z_mm = sqrt(sphere_mm * sphere_mm - r_mm * r_mm) - sphere_mm;
  return tan(2 * asin(r_mm / sphere_mm) + atan(r_mm / (camera_mm - *z_mm)));
}

/* 24 bright mires in a cone r = (97 - z)/2.6: 7 mm wide at the camera's end, 34 mm at the eye's.
 * Edges are where evenly spaced heights of a 7.8 mm sphere mirror them, to a hundredth of a
 * millimetre as a workshop could make them. */
static void make_cone(placido_instrument *instrument) {
  const double apex_mm = 97, steepness = 2.6, sphere_mm = 7.8, camera_mm = 120;
  const double first_mm = 0.3, last_mm = 4.4;
  *instrument = camera_at(camera_mm, 10800, "cone, 24 mires");
  instrument->edge_count = 48;
  for (int i = 0; i < instrument->edge_count; i++) {
    double r_mm = first_mm + (last_mm - first_mm) * i / (instrument->edge_count - 1);
    double z_mm, tangent = mirrored_tangent(r_mm, sphere_mm, camera_mm, &z_mm);
    double radius_mm = (r_mm + (apex_mm - z_mm) * tangent) / (1 + steepness * tangent);
    radius_mm = round(100 * radius_mm) / 100;
    instrument->edges[i] = (placido_edge){radius_mm, apex_mm - steepness * radius_mm};
  }
}

/* 18 bright mires in the plane z = 45 mm: 36 edges from 4 to 92.47 mm. */
static void make_disc(placido_instrument *instrument) {
  *instrument = camera_at(100, 9000, "disc, 18 mires");
  instrument->edge_count = 36;
  for (int i = 0; i < instrument->edge_count; i++) {
    instrument->edges[i] = (placido_edge){4 + i * (95 - 4) / 36.0, 45};
  }
}

static const design designs[] = {
    {"cone24", make_cone},
    {"disc18", make_disc},
};

static const char *const names[] = {"cone24", "disc18", NULL};

const char *const *placido_phantom_instruments(void) {
  return names;
}

int placido_phantom_instrument(placido_instrument *instrument, const char *name,
                               placido_error *err) {
  memset(instrument, 0, sizeof *instrument);
  for (size_t i = 0; i < sizeof designs / sizeof *designs; i++) {
    if (strcmp(designs[i].name, name) == 0) {
      designs[i].make(instrument);
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "no built-in instrument is called \"%s\"; there are cone24, disc18",
                           name);
}
