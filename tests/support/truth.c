#include "tests/support/truth.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <jansson.h>
#include <math.h>
#include <placido/phantom.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The surface of a truth stands in it without a head of its own: a file with one is made. */
placido_surface *truth_load(const char *name, double *axis_z_mm) {
  char path[1024], copy[] = "/tmp/placido-truth-XXXXXX";
  snprintf(path, sizeof path, "%s/samples/%s.truth.json", PLACIDO_TEST_DATA, name);
  json_t *root = json_load_file(path, 0, NULL);
  json_t *inside = json_object_get(root, "surface");
  assert_non_null(inside);
  *axis_z_mm = json_number_value(json_object_get(root, "axis_z_mm"));
  json_object_set_new(inside, "format", json_string("placido-surface/1"));
  json_object_set_new(inside, "radius_mm", json_real(5.5));
  int file = mkstemp(copy);
  assert_true(file >= 0);
  close(file);
  assert_int_equal(json_dump_file(inside, copy, 0), 0);
  placido_surface *surface;
  placido_error err = {0};
  assert_int_equal(placido_surface_load(&surface, copy, NULL, &err), PLACIDO_OK);
  unlink(copy);
  json_decref(root);
  return surface;
}

placido_instrument truth_instrument(const char *name) {
  char path[1024];
  placido_instrument instrument;
  placido_error err = {0};
  snprintf(path, sizeof path, "%s/samples/%s.instrument.json", PLACIDO_TEST_DATA, name);
  assert_int_equal(placido_instrument_load(&instrument, path, NULL, &err), PLACIDO_OK);
  return instrument;
}

/* A standard normal number that depends on the key alone (SplitMix64, Box-Muller). */
static double noise(uint64_t key) {
  double uniform[2];
  for (int i = 0; i < 2; i++) {
    key += 0x9e3779b97f4a7c15u;
    uint64_t z = key;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    uniform[i] = ((double)((z ^ (z >> 31)) >> 11) + 0.5) / 9007199254740992.0;
  }
  return sqrt(-2 * log(uniform[0])) * cos(2 * M_PI * uniform[1]);
}

placido_mires truth_points(const placido_surface *surface, const placido_instrument *instrument,
                           int meridians, double sigma_px,
                           bool (*hidden)(int edge, double meridian_deg)) {
  placido_mires mires = {.centre_u_px = instrument->principal_px[0],
                         .centre_v_px = instrument->principal_px[1],
                         .edge_count = instrument->edge_count,
                         .meridian_count = meridians};
  const size_t places = (size_t)instrument->edge_count * (size_t)meridians;
  double(*at_px)[2] = calloc(places, sizeof *at_px); /* edges together, meridian by meridian */
  mires.points = calloc(places, sizeof *mires.points);
  assert_non_null(at_px);
  assert_non_null(mires.points);
  for (int m = 0; m < meridians; m++) {
    placido_phantom_edges_at(surface, instrument, instrument->principal_px, 360.0 * m / meridians,
                             at_px + (size_t)m * (size_t)instrument->edge_count);
  }
  for (int k = 0; k < instrument->edge_count; k++) {
    for (int m = 0; m < meridians; m++) {
      double deg = 360.0 * m / meridians;
      const double *at = at_px[m * instrument->edge_count + k];
      if ((hidden && hidden(k, deg)) || isnan(at[0])) {
        continue;
      }
      double off = sigma_px * noise((uint64_t)k * 100003u + (uint64_t)m);
      double du = at[0] - instrument->principal_px[0], dv = at[1] - instrument->principal_px[1];
      double r = hypot(du, dv);
      mires.points[mires.count++] = (placido_mire_point){.edge = k,
                                                         .meridian_deg = deg,
                                                         .u_px = at[0] + off * du / r,
                                                         .v_px = at[1] + off * dv / r,
                                                         .sigma_px = fmax(sigma_px, 1e-3),
                                                         .used = true,
                                                         .residual_px = NAN};
    }
  }
  free(at_px);
  return mires;
}

static double axial_D(const placido_jet *jet, double x, double y) {
  double r = hypot(x, y), s = (jet->sx * x + jet->sy * y) / r;
  return 337.5 * s / (r * sqrt(1 + s * s));
}

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

truth_error truth_compare(const placido_fit *fit, const placido_surface *truth, double from_mm,
                          double to_mm) {
  enum { HALF = 50, ROOM = (2 * HALF + 1) * (2 * HALF + 1) };
  static double inner[ROOM];
  const placido_surface *found = placido_fit_surface(fit);
  double lift = placido_surface_vertex_z_mm(found) - placido_surface_vertex_z_mm(truth), piston = 0;
  truth_error e = {0};
  size_t near = 0, points = 0, covered = 0, curved = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (int j = -HALF; j <= HALF; j++) {
      for (int i = -HALF; i <= HALF; i++) {
        double x = i / 10.0, y = j / 10.0, r = hypot(x, y), sigma_um, sigma_D;
        placido_jet a, b;
        bool has = placido_surface_covered(found, x, y) && placido_surface_at(found, x, y, &a) &&
                   placido_surface_at(truth, x, y, &b);
        double error = has ? (lift - (a.sag - b.sag)) * 1e3 : NAN;
        if (pass == 0 && has && r <= 1.5) {
          inner[near++] = error;
        } else if (pass == 1 && r > from_mm / 2 && r <= to_mm / 2) {
          points++;
          if (!has) {
            continue;
          }
          covered++;
          placido_fit_sigma_at(fit, x, y, &sigma_um, &sigma_D);
          e.elevation_um += (error - piston) * (error - piston);
          e.over_sigma += sigma_um > 0 ? pow((error - piston) / sigma_um, 2) : 0;
          if (r > 0.25) {
            e.axial_D += pow(axial_D(&a, x, y) - axial_D(&b, x, y), 2);
            curved++;
          }
        }
      }
    }
    if (pass == 0) {
      assert_true(near > 20);
      qsort(inner, near, sizeof *inner, by_value);
      piston = inner[near / 2];
    }
  }
  e.elevation_um = sqrt(e.elevation_um / (double)covered);
  e.over_sigma = sqrt(e.over_sigma / (double)covered);
  e.axial_D = sqrt(e.axial_D / (double)curved);
  e.covered = (double)covered / (double)points;
  return e;
}

placido_mires truth_copy(const placido_mires *mires) {
  placido_mires copy = *mires;
  copy.points = malloc(copy.count * sizeof *copy.points);
  assert_non_null(copy.points);
  memcpy(copy.points, mires->points, copy.count * sizeof *copy.points);
  return copy;
}
