/* Others' heights: read as they stand, fitted to the noise, refused where they make no sense. */
#include "tests/exchange/cornea.h"

#include <placido/elevation.h>
#include <placido/mesh.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <setjmp.h>

#include <cmocka.h>

#define FILE_NAME "test_elevation.txt"

/* Fitted less true z, um. */
static double error_um(const placido_surface *fitted, const placido_surface *truth,
                       double vertex_mm, double x, double y) {
  placido_jet a, b;
  assert_true(placido_surface_at(fitted, x, y, &a) && placido_surface_at(truth, x, y, &b));
  return 1e3 * (placido_surface_vertex_z_mm(fitted) - a.sag - (vertex_mm - b.sag));
}

/* Its mean over the central 3 mm. */
static double level_um(const placido_surface *fitted, const placido_surface *truth,
                       double vertex_mm) {
  double sum = 0;
  int count = 0;
  for (int j = -6; j <= 6; j++) {
    for (int i = -6; i <= 6; i++) {
      if (i * i + j * j <= 36) {
        sum += error_um(fitted, truth, vertex_mm, i * 0.25, j * 0.25);
        count++;
      }
    }
  }
  return sum / count;
}

/* Root mean square of the difference in z over what the fit says it covers, um. */
static double difference_um(const placido_surface *fitted, const placido_surface *truth,
                            double vertex_mm) {
  double sum = 0;
  int count = 0;
  for (int j = -40; j <= 40; j++) {
    for (int i = -40; i <= 40; i++) {
      double x = i * 0.12, y = j * 0.12;
      if (placido_surface_covered(fitted, x, y) && placido_surface_covered(truth, x, y)) {
        double d = error_um(fitted, truth, vertex_mm, x, y);
        sum += d * d;
        count++;
      }
    }
  }
  assert_true(count > 1000);
  return sqrt(sum / count);
}

static placido_fit *fit_file(placido_elevation *elevation, placido_heights_summary *summary,
                             const placido_elevation_options *options) {
  placido_error err;
  placido_fit *fit = NULL;
  if (placido_elevation_load(elevation, FILE_NAME, options, NULL, &err) != PLACIDO_OK ||
      placido_heights_fit(&fit, summary, elevation->heights, elevation->count, 0, &err) !=
          PLACIDO_OK) {
    fail_msg("%s", err.text);
  }
  return fit;
}

static double index_called(const placido_index_value *values, size_t count, const char *name) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(values[i].name, name) == 0) {
      return values[i].value;
    }
  }
  fail_msg("no index is called %s", name);
  return NAN;
}

static void a_cso_export_is_the_cornea_it_was_made_of(void **state) {
  (void)state;
  placido_surface *truth = make_cornea(6);
  placido_elevation elevation;
  placido_heights_summary summary;
  write_cso(FILE_NAME, truth, false);
  placido_fit *fit = fit_file(&elevation, &summary, NULL);
  assert_string_equal(elevation.kind, "cso");
  assert_int_equal(elevation.count, 24 * 256);
  assert_string_equal(elevation.maker.eye_flag, "True");
  assert_true(fabs(elevation.maker.k_D[1] - 43.8) < 1e-9);
  assert_true(fabs(elevation.maker.axis_deg[1] - 110) < 1e-9);
  assert_true(fabs(elevation.maker.pupil_radius_mm - 7.8) < 1e-9);
  assert_true(isnan(elevation.maker.pupil_diameter_mm));
  /* the file has 15 digits: what is left is what a spline of 0.5 mm knots lacks */
  assert_true(summary.rms_um < 0.05);
  assert_true(difference_um(placido_fit_surface(fit), truth, 0) < 0.05);
  placido_fit_free(fit);
  placido_elevation_free(&elevation);
  placido_surface_free(truth);
}

static void keratometry_follows_the_makers_rule(void **state) {
  (void)state;
  placido_surface *truth = make_cornea(6);
  placido_elevation elevation;
  placido_heights_summary summary;
  placido_error err;
  write_cso(FILE_NAME, truth, false);
  placido_fit *fit = fit_file(&elevation, &summary, NULL);
  placido_index_value values[PLACIDO_INDICES_MAX];
  size_t count;
  assert_int_equal(
      placido_indices_find(values, &count, placido_fit_surface(fit), fit, &err), PLACIDO_OK);
  assert_int_equal(placido_elevation_indices(values, &count, &elevation, fit, &err), PLACIDO_OK);
  /* the rule on the true surface: rings 6 to 10 of both halves of the diameter */
  double axis = index_called(values, count, "simk_flat_axis_deg"), sum = 0;
  for (int k = 5; k < 10; k++) {
    for (int half = 0; half < 2; half++) {
      double a = (axis + 180 * half) * 3.14159265358979 / 180, r = 0.2 + 0.2 * k;
      placido_jet jet;
      placido_surface_at(truth, r * cos(a), r * sin(a), &jet);
      double slope = jet.sx * cos(a) + jet.sy * sin(a);
      sum += r * sqrt(1 + slope * slope) / slope / 10;
    }
  }
  /* rings wobble by 2 % of their radius here, which is nothing to the power */
  assert_true(fabs(index_called(values, count, "simk_flat_D") - 337.5 / sum) < 0.01);
  assert_true(index_called(values, count, "simk_steep_D") > 337.5 / sum + 0.5);
  /* the rings are neither circles nor concentric, so that there is something to tell */
  assert_true(index_called(values, count, "placido_pi_1") >= 0);
  placido_fit_free(fit);
  placido_elevation_free(&elevation);
  placido_surface_free(truth);
}

static void missing_rings_are_a_hole_of_the_map(void **state) {
  (void)state;
  placido_surface *truth = make_cornea(6);
  placido_elevation elevation;
  placido_heights_summary summary;
  write_cso(FILE_NAME, truth, true);
  placido_fit *fit = fit_file(&elevation, &summary, NULL);
  assert_int_equal(elevation.missing, 8 * 64);
  assert_false(placido_surface_covered(placido_fit_surface(fit), 0, 4.4));
  assert_true(placido_surface_covered(placido_fit_surface(fit), 0, 2.5));
  assert_true(placido_surface_covered(placido_fit_surface(fit), 0, 0));
  assert_true(placido_surface_covered(placido_fit_surface(fit), 0, -4.4));
  assert_true(difference_um(placido_fit_surface(fit), truth, 0) < 0.05);
  placido_fit_free(fit);
  placido_elevation_free(&elevation);
  placido_surface_free(truth);
}

static void a_grid_comes_back_as_the_surface_it_was_written_from(void **state) {
  (void)state;
  placido_surface *truth = make_cornea(4.5);
  placido_elevation elevation;
  placido_heights_summary summary;
  placido_error err;
  assert_int_equal(placido_surface_save_grid(truth, 0.1, FILE_NAME, &err), PLACIDO_OK);
  placido_fit *fit = fit_file(&elevation, &summary, NULL);
  assert_string_equal(elevation.kind, "points");
  /* what the issue asks for is 0.1 um */
  assert_true(difference_um(placido_fit_surface(fit), truth, 0.1) < 0.02);
  placido_fit_free(fit);
  placido_elevation_free(&elevation);
  placido_surface_free(truth);
}

/* Noise of 1 um on every height: the error bar of a height is what it is wrong by, and no finer
 * knots are taken for it. */
static void error_bars_are_those_of_the_noise(void **state) {
  (void)state;
  placido_surface *truth = make_cornea(4.5);
  placido_height heights[5000];
  size_t count = 0;
  uint32_t random = 1;
  for (int j = -30; j <= 30; j++) {
    for (int i = -30; i <= 30; i++) {
      double x = i * 0.14, y = j * 0.14, noise = 0;
      placido_jet jet;
      for (int k = 0; k < 12; k++) { /* twelve uniform numbers: nearly normal, sigma 1 */
        random = random * 1664525u + 1013904223u;
        noise += (random >> 8) / 16777216.0;
      }
      if (hypot(x, y) < 4.2 && placido_surface_at(truth, x, y, &jet)) {
        heights[count++] = (placido_height){x, y, 0.1 - jet.sag + 1e-3 * (noise - 6)};
      }
    }
  }
  placido_fit *fit;
  placido_heights_summary summary;
  placido_error err;
  assert_int_equal(placido_heights_fit(&fit, &summary, heights, count, 0, &err), PLACIDO_OK);
  assert_true(fabs(summary.sigma_um - 1) < 0.05); /* 2500 points: 1.4 % */
  assert_true(fabs(summary.knot_mm - 0.5) < 1e-9);
  const placido_surface *fitted = placido_fit_surface(fit);
  assert_true(difference_um(fitted, truth, 0.1) < 0.4); /* a knot's points are averaged over */
  double ratio = 0, level = level_um(fitted, truth, 0.1);
  int places = 0;
  for (int j = -6; j <= 6; j++) {
    for (int i = -6; i <= 6; i++) {
      double x = i * 0.5, y = j * 0.5, sigma_z, sigma_axial;
      if (hypot(x, y) < 3.9) {
        placido_fit_sigma_at(fit, x, y, &sigma_z, &sigma_axial);
        double d = error_um(fitted, truth, 0.1, x, y) - level; /* as sigma_z counts it */
        ratio += d * d / (sigma_z * sigma_z);
        places++;
      }
    }
  }
  ratio = sqrt(ratio / places);
  assert_true(ratio > 0.7 && ratio < 1.4); /* neighbours share errors: some 60 are independent */
  placido_fit_free(fit);
  placido_surface_free(truth);
}

static const struct {
  const char *text, *says;
} malformed[] = {
    {"", "is empty"},
    {"x_mm,y_mm\n1,2\n", ":1: no column is called z"},
    {"x_mm,z_mm\n1,2\n", ":1: no column is called y"},
    {"1,2,3,4\n", ":1: 4 columns without a header"},
    {"1,2\n", ":1: 2 columns without a header"},
    {"x_mm,y_mm,z_mm\n1,2,3\n1,b,3\n", ":3: \"b\" is no number"},
    {"x_mm,y_mm,z_mm\n1,2\n", ":2: 2 columns, z was expected in column 3"},
    {"x_mm,y_mm,z_mm\nnan,2,3\n", ":2: \"nan\" is no number"},
    {"x_mm,y_mm,z_mm\n1,2,0x10\n", ":2: \"0x10\" is no number"},
    {"x_mm,y_mm,z_mm\n1,2,inf\n", ":2: \"inf\" is no number"},
    {"x_mm,y_mm,z_mm\n4500,2,3\n", ":2: x is 4500 mm: the unit"},
    {"x_mm,y_mm,z_mm\n1,2,3\n0,0,0\n1,2,3.5\n", ":4: the point (1, 2) mm stands in line 2"},
    {"N Anelli : 24\nN Semimeridiani : 0\n1,5\n", ":2: number of semi-meridians"},
    {"N Semimeridiani : 8\n1,5\n", ":2: the header names no number of rings"},
    {"N Anelli : 1\nN Semimeridiani : 2\n1,5\n", ":3: the file ends after 1 of 4"},
    {"N Anelli : 1\nN Semimeridiani : 1\n1,5\n0\n7\n", ":5: \"7\" is one number too many"},
    {"N Anelli : 1\nN Semimeridiani : 1\n1,5\nx\n", ":4: \"x\" is no number"},
    {"N Anelli : 1\nN Semimeridiani : 1\n-2\n0\n", ":3: a radius of -2 mm"},
    {"Dato misurato : Curvature\nN Anelli : 1\nN Semimeridiani : 1\n1,5\n0\n", ":1: the data are"},
};

static void what_makes_no_sense_is_refused_with_its_line(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof malformed / sizeof malformed[0]; i++) {
    placido_elevation elevation;
    placido_error err = {0};
    write_text(FILE_NAME, malformed[i].text);
    assert_int_equal(placido_elevation_load(&elevation, FILE_NAME, NULL, NULL, &err),
                     PLACIDO_INPUT);
    if (!strstr(err.text, malformed[i].says) || !strstr(err.text, FILE_NAME)) {
      fail_msg("\"%s\" does not say \"%s\"", err.text, malformed[i].says);
    }
    assert_null(elevation.heights);
  }
}

static void few_points_or_no_cornea_are_not_good_enough(void **state) {
  (void)state;
  placido_height heights[400];
  placido_heights_summary summary;
  placido_fit *fit;
  placido_error err;
  for (int i = 0; i < 400; i++) {
    heights[i] = (placido_height){(i % 20) * 0.3 - 3, (i / 20) * 0.3 - 3, 0};
  }
  assert_int_equal(placido_heights_fit(&fit, &summary, heights, 100, 0, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "only 100 points"));
  assert_int_equal(placido_heights_fit(&fit, &summary, heights, 400, 0, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "a cornea has")); /* a plane */
  for (int i = 0; i < 400; i++) {
    heights[i].y_mm = heights[i].x_mm;
  }
  assert_int_equal(placido_heights_fit(&fit, &summary, heights, 400, 0, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "one line"));
  assert_null(fit);
}

/* One cornea in as many ways as people write it. */
static void units_signs_and_separators_are_understood(void **state) {
  (void)state;
  static const struct {
    const char *header, *line;
    double z_scale;
    placido_elevation_options options;
  } ways[] = {
      {"x_mm,y_mm,z_mm\n", "%.9g,%.9g,%.12g\n", 1, {.z_mm = 0}},
      {"\xEF\xBB\xBF\"x (mm)\";\"y (mm)\";\"sag (um)\"\r\n",
       "%.9g;%.9g;%.12g\r\n",
       -1e3,
       {.z_mm = 0}},
      {"# a comment\nX Y Z\n", "%.9g  %.9g\t%.12g\n", 1, {.z_mm = 0}},
      {"", "%.9g\t%.9g\t%.12g\n", -1e3, {.z_mm = 1e-3}},
      {"", "%.9g,%.9g,%.12g\n", 1e3, {.z_mm = 1e-3, .sign = PLACIDO_HEIGHT_UP}},
  };
  placido_surface *truth = make_cornea(4.5);
  for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++) {
    FILE *file = fopen(FILE_NAME, "w");
    assert_non_null(file);
    fputs(ways[w].header, file);
    for (int i = 0; i < 30 * 30; i++) {
      double x = (i % 30) * 0.2 - 2.9, y = (i / 30) * 0.2 - 2.9;
      placido_jet jet;
      placido_surface_at(truth, x, y, &jet);
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
      fprintf(file, ways[w].line, x, y, ways[w].z_scale * (0.1 - jet.sag));
#pragma GCC diagnostic pop
    }
    assert_int_equal(fclose(file), 0);
    placido_elevation elevation;
    placido_heights_summary summary;
    placido_fit *fit = fit_file(&elevation, &summary, &ways[w].options);
    assert_int_equal(elevation.count, 900);
    assert_true(difference_um(placido_fit_surface(fit), truth, 0.1) < 0.05);
    placido_fit_free(fit);
    placido_elevation_free(&elevation);
  }
  placido_surface_free(truth);
}

/* Others' files, where they are there: they are not part of the project. Of N01 and K02 the
 * header's keratometry, and indices that rPACI gives. */
static void real_exports_have_their_headers_keratometry(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double limit_D, rms_um, pi_1, sl;
  } files[] = {{"N01", 0.1, 0.1, 13.2183932492, 36.4870650987},
               {"K02", 0.3, 0.2, 94.4661742009, 3.72189258947}};
  if (access(PLACIDO_SHARED "/real/cso", R_OK) != 0) {
    skip();
  }
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    char path[512];
    placido_elevation elevation;
    placido_heights_summary summary;
    placido_fit *fit;
    placido_error err;
    placido_index_value values[PLACIDO_INDICES_MAX];
    size_t count;
    snprintf(path, sizeof path, PLACIDO_SHARED "/real/cso/%s.txt", files[i].name);
    assert_int_equal(placido_elevation_load(&elevation, path, NULL, NULL, &err), PLACIDO_OK);
    assert_int_equal(
        placido_heights_fit(&fit, &summary, elevation.heights, elevation.count, 0, &err),
        PLACIDO_OK);
    assert_true(summary.rms_um < files[i].rms_um);
    assert_int_equal(
        placido_indices_find(values, &count, placido_fit_surface(fit), fit, &err), PLACIDO_OK);
    assert_int_equal(placido_elevation_indices(values, &count, &elevation, fit, &err), PLACIDO_OK);
    assert_true(fabs(index_called(values, count, "simk_flat_D") - elevation.maker.k_D[0]) <
                files[i].limit_D);
    assert_true(fabs(index_called(values, count, "simk_steep_D") - elevation.maker.k_D[1]) <
                files[i].limit_D);
    assert_true(fabs(index_called(values, count, "placido_pi_1") / files[i].pi_1 - 1) < 1e-6);
    assert_true(fabs(index_called(values, count, "placido_sl") / files[i].sl - 1) < 1e-6);
    placido_fit_free(fit);
    placido_elevation_free(&elevation);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cso_export_is_the_cornea_it_was_made_of),
      cmocka_unit_test(keratometry_follows_the_makers_rule),
      cmocka_unit_test(missing_rings_are_a_hole_of_the_map),
      cmocka_unit_test(a_grid_comes_back_as_the_surface_it_was_written_from),
      cmocka_unit_test(error_bars_are_those_of_the_noise),
      cmocka_unit_test(what_makes_no_sense_is_refused_with_its_line),
      cmocka_unit_test(few_points_or_no_cornea_are_not_good_enough),
      cmocka_unit_test(units_signs_and_separators_are_understood),
      cmocka_unit_test(real_exports_have_their_headers_keratometry),
  };
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  remove(FILE_NAME);
  return failed;
}
