/* Placido indices: exact figures of circles and ellipses, the published package's figures for real
 * exports (where those are there: they are others' and not part of the project), and the mires of a
 * cornea against where the camera sees them. */
#include "tests/indices/found.h"
#include "tests/maps/eyes.h"
#include "tests/support/near.h"
#include "tests/support/truth.h"

#include <placido/phantom.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

static found_indices indices_of(const placido_mire_rings *rings) {
  found_indices found = {.count = 0};
  placido_indices_of_rings(found.values, &found.count, rings);
  return found;
}

/* An ellipse with half axes a along x and b along y. */
static void put_ring(placido_mire_rings *rings, double a, double b, double x_mm, double y_mm) {
  for (int i = 0; i < PLACIDO_MIRE_RING_POINTS; i++) {
    double angle = 2 * PI * i / PLACIDO_MIRE_RING_POINTS;
    rings->points_mm[rings->count][i][0] = x_mm + a * cos(angle);
    rings->points_mm[rings->count][i][1] = y_mm + b * sin(angle);
  }
  rings->count++;
}

/* Centres that march 3 µm to the right and 1.5 µm up from ring to ring, ratios 1 and 1.02 in turn:
 * every figure can be worked out by hand. */
static void figures_of_ellipses_are_exact(void **state) {
  (void)state;
  placido_mire_rings rings = {.cso = true};
  for (int k = 0; k < 6; k++) {
    double r = 0.2 * (k + 1);
    put_ring(&rings, k % 2 ? 1.02 * r : r, r, 0.003 * k, 0.0015 * k);
  }
  found_indices found = indices_of(&rings);
  double step = hypot(0.003, 0.0015);
  assert_near(found_value(&found, "placido_pi_1"), 12368.398072 * 5 * step / 6 - 12.520056, 1e-6);
  assert_near(found_value(&found, "placido_pi_2"), 9699.239153 * step - 18.291661, 1e-6);
  assert_near(found_value(&found, "placido_pi_3"), 5233.703995 * 0.01 * sqrt(6.0 / 5) - 13.737515,
              1e-6);
  assert_near(found_value(&found, "placido_sl"), 25, 1e-6);
  assert_near(found_value(&found, "placido_ar_1"), 444.770836 - 1961.923470 * 0.2, 1e-6);
  assert_near(found_value(&found, "placido_ar_5"), 321.418014 - 288.403796 * 1.0, 1e-6);
  assert_near(found_value(&found, "placido_ar_3"), 331.313769 - 486.921809 * 0.6, 1e-6);
}

static void few_rings_and_other_mires_have_their_reasons(void **state) {
  (void)state;
  placido_mire_rings rings = {.cso = false};
  for (int k = 0; k < 4; k++) {
    put_ring(&rings, 0.2 * (k + 1), 0.2 * (k + 1), 0.01 * k, 0);
  }
  found_indices found = indices_of(&rings);
  assert_string_equal(found_reason(&found, "placido_pi_1"), "too_few_mires");
  assert_string_equal(found_reason(&found, "placido_nbi"), "too_few_mires");
  put_ring(&rings, 1, 1, 0.04, 0);
  found = indices_of(&rings);
  assert_true(isfinite(found_value(&found, "placido_pi_1")));
  assert_true(isfinite(found_value(&found, "placido_nbi")));
  assert_string_equal(found_reason(&found, "placido_ar_4"), "other_mires");
  assert_string_equal(found_reason(&found, "placido_glpi"), "other_mires");
  rings.count = 0;
  for (int k = 0; k < 6; k++) {
    put_ring(&rings, 0.2 * (k + 1), 0.2 * (k + 1), 0, 0);
  }
  found = indices_of(&rings);
  assert_string_equal(found_reason(&found, "placido_sl"), "no_line");
}

/* The first block of an export: 24 rings of 256 radii, a number a line, decimal comma, -1 missing.
 */
static bool read_export(placido_mire_rings *rings, const char *name) {
  char path[1024], line[256];
  snprintf(path, sizeof path, "%s/real/cso/%s.txt", PLACIDO_SHARED, name);
  FILE *file = fopen(path, "r");
  *rings = (placido_mire_rings){.cso = true};
  if (!file) {
    return false;
  }
  for (int i = 0; i < 22; i++) {
    assert_non_null(fgets(line, sizeof line, file));
  }
  bool complete = true;
  for (int k = 0; k < PLACIDO_MIRE_RINGS_MAX && complete; k++) {
    for (int i = 0; i < PLACIDO_MIRE_RING_POINTS; i++) {
      assert_non_null(fgets(line, sizeof line, file));
      char *comma = strchr(line, ',');
      if (comma) {
        *comma = '.';
      }
      double r = strtod(line, NULL), angle = 2 * PI * i / PLACIDO_MIRE_RING_POINTS;
      complete = complete && r != -1;
      rings->points_mm[k][i][0] = r * cos(angle);
      rings->points_mm[k][i][1] = r * sin(angle);
    }
    rings->count += complete;
  }
  fclose(file);
  return true;
}

/* Its constants are printed with six decimals, so that six digits agree; the package samples the
 * Bayes network, here it is exact. */
static void real_exports_give_the_published_figures(void **state) {
  (void)state;
  static const struct {
    const char *export;
    int rings;
    double pi_1, pi_2, pi_3, sl, ar_1, ar_4, glpi, nbi;
  } golden[] = {
      {"N01", 15, 13.2183932492, 20.483426422, 17.6920463803, 36.4870650987, 42.5978070814,
       21.3711126753, 1.64706581707e-09, 2.27501220046e-07},
      {"K02", 9, 94.4661742009, 85.0715935585, 93.0601148769, 3.72189258947, 0, 0, 99.6626761878,
       99.9999982619},
  };
  for (size_t i = 0; i < sizeof golden / sizeof golden[0]; i++) {
    placido_mire_rings rings;
    if (!read_export(&rings, golden[i].export)) {
      skip();
    }
    assert_int_equal(rings.count, golden[i].rings);
    found_indices found = indices_of(&rings);
    assert_near(found_value(&found, "placido_pi_1"), golden[i].pi_1, 5e-7 * golden[i].pi_1);
    assert_near(found_value(&found, "placido_pi_2"), golden[i].pi_2, 5e-7 * golden[i].pi_2);
    assert_near(found_value(&found, "placido_pi_3"), golden[i].pi_3, 5e-7 * golden[i].pi_3);
    assert_near(found_value(&found, "placido_sl"), golden[i].sl, 5e-7 * golden[i].sl);
    assert_near(found_value(&found, "placido_ar_1"), golden[i].ar_1, 5e-7 * golden[i].ar_1);
    assert_near(found_value(&found, "placido_ar_4"), golden[i].ar_4, 5e-7 * golden[i].ar_4);
    assert_near(found_value(&found, "placido_glpi"), golden[i].glpi, 5e-6 * golden[i].glpi);
    assert_near(found_value(&found, "placido_nbi"), golden[i].nbi, 0.05 * golden[i].nbi);
  }
}

/* Where the ray of an image point meets the surface, by bisection. The cone's camera is a pinhole
 * without distortion. */
static void hit(const placido_surface *surface, const placido_instrument *in, double u, double v,
                double at[2]) {
  double dx = (u - in->principal_px[0]) / in->focal_px[0];
  double dy = -(v - in->principal_px[1]) / in->focal_px[1];
  double near = in->position_mm[2] - 3, far = in->position_mm[2] + 6;
  for (int i = 0; i < 60; i++) {
    double depth = (near + far) / 2;
    placido_jet jet;
    at[0] = in->position_mm[0] + dx * depth;
    at[1] = in->position_mm[1] + dy * depth;
    assert_true(placido_surface_at(surface, at[0], at[1], &jet));
    bool above = in->position_mm[2] - depth > placido_surface_vertex_z_mm(surface) - jet.sag;
    near = above ? depth : near;
    far = above ? far : depth;
  }
}

/* The phantom's exact edge points, half a degree apart, followed to the cornea: the one nearest in
 * direction to a point of the ring lies as far from the vertex. */
static void mires_lie_where_the_camera_sees_them(void **state) {
  (void)state;
  placido_surface *surface;
  placido_instrument instrument;
  assert_int_equal(placido_phantom_eye(&surface, "keratoconus", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  placido_mires mires = truth_points(surface, &instrument, 72, 0, NULL);
  static placido_mire_rings rings;
  placido_mire_rings_find(&rings, surface, &mires, &instrument);
  assert_int_equal(rings.count, PLACIDO_MIRE_RINGS_MAX);
  int first = instrument.first_band_bright ? 0 : 1;
  found_indices found = found_of(surface, NULL);
  double x = found_value(&found, "vertex_x_mm"), y = found_value(&found, "vertex_y_mm");
  for (int k = 0; k < rings.count; k += 7) {
    for (int i = 0; i < PLACIDO_MIRE_RING_POINTS; i += 32) {
      double middle = 0;
      double angle = atan2(rings.points_mm[k][i][1] - y, rings.points_mm[k][i][0] - x);
      for (int edge = first + 2 * k; edge <= first + 2 * k + 1; edge++) {
        double best = INFINITY, radius = NAN;
        for (double deg = 0; deg < 360; deg += 0.5) {
          double px[2], at[2];
          assert_true(placido_phantom_edge_at(surface, &instrument, edge, instrument.principal_px,
                                              deg, px));
          hit(surface, &instrument, px[0], px[1], at);
          double turn = fabs(remainder(atan2(at[1] - y, at[0] - x) - angle, 2 * PI));
          if (turn < best) {
            best = turn;
            radius = hypot(at[0] - x, at[1] - y);
          }
        }
        middle += radius / 2;
      }
      /* a quarter of a degree is 0.0044; on this eye a mire's radius changes by at most a tenth of
       * itself in a radian */
      assert_near(hypot(rings.points_mm[k][i][0] - x, rings.points_mm[k][i][1] - y), middle,
                  0.0045 * 0.1 * middle + 1e-6);
    }
  }
  placido_mires_free(&mires);
  placido_surface_free(surface);
}

/* A mire that the fit did not use all around ends the count. */
static bool hides_an_arc(int edge, double meridian_deg) {
  return edge >= 16 && meridian_deg > 80 && meridian_deg < 110;
}

static void rings_end_at_the_first_gap(void **state) {
  (void)state;
  placido_surface *surface;
  placido_instrument instrument;
  assert_int_equal(placido_phantom_eye(&surface, "normal", NULL), PLACIDO_OK);
  assert_int_equal(placido_phantom_instrument(&instrument, "cone24", NULL), PLACIDO_OK);
  placido_mires mires = truth_points(surface, &instrument, 90, 0, hides_an_arc);
  static placido_mire_rings rings;
  placido_mire_rings_find(&rings, surface, &mires, &instrument);
  assert_int_equal(rings.count, instrument.first_band_bright ? 8 : 7);
  placido_mires_free(&mires);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(figures_of_ellipses_are_exact),
      cmocka_unit_test(few_rings_and_other_mires_have_their_reasons),
      cmocka_unit_test(real_exports_give_the_published_figures),
      cmocka_unit_test(mires_lie_where_the_camera_sees_them),
      cmocka_unit_test(rings_end_at_the_first_gap),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
