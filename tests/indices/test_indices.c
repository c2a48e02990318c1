/* Indices: exact figures of shapes that have them, NaN (null in the file) and why where data are
 * missing. */
#include "base/json.h"
#include "base/memory.h"
#include "tests/indices/found.h"
#include "tests/maps/eyes.h"
#include "tests/support/near.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void a_sphere_has_one_power(void **state) {
  (void)state;
  static const char *const powers[] = {"simk_flat_D",
                                       "simk_steep_D",
                                       "simk_mean_D",
                                       "min_k_D",
                                       "max_k_D",
                                       "central_k_D",
                                       "mean_axial_0_3mm_D",
                                       "mean_axial_3_6mm_D",
                                       "mean_axial_6_8mm_D",
                                       "max_tangential_D"};
  static const char *const zeros[] = {"simk_cylinder_D",
                                      "inferior_superior_D",
                                      "clmi_D",
                                      "sai_like_D",
                                      "sri_like_D",
                                      "iai_like_D",
                                      "dsi_D",
                                      "osi_D",
                                      "csi_D"};
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  found_indices found = found_of(surface, NULL);
  for (size_t i = 0; i < sizeof powers / sizeof powers[0]; i++) {
    assert_near(found_value(&found, powers[i]), 337.5 / 7.8, 1e-10);
  }
  for (size_t i = 0; i < sizeof zeros / sizeof zeros[0]; i++) {
    assert_near(found_value(&found, zeros[i]), 0, 1e-10);
  }
  assert_near(found_value(&found, "asphericity_q"), 0, 1e-8);
  assert_near(found_value(&found, "shape_factor_p"), 1, 1e-8);
  assert_near(found_value(&found, "apical_radius_mm"), 7.8, 1e-8);
  assert_near(found_value(&found, "best_fit_sphere_radius_mm"), 7.8, 1e-10);
  assert_near(found_value(&found, "analysed_area_percent"), 100, 1e-12);
  assert_near(found_value(&found, "ppk_percent"), 100 / (1 + exp(6.4483)), 1e-9);
  assert_near(found_value(&found, "kpi"),
              0.30 + 0.01 * (-41.23 + (1.08 - 0.56) * 337.5 / 7.8 + 0.10 * 100), 1e-10);
  for (size_t i = 0; i < found.count; i++) {
    assert_true(isnan(found.values[i].sigma)); /* no fit, no error bars */
    assert_true(isnan(found.values[i].value) == (found.values[i].reason != NULL));
  }
  placido_surface_free(surface);
}

static void a_sphere_has_no_axis(void **state) {
  (void)state;
  static const char *const axes[] = {"simk_flat_axis_deg", "simk_steep_axis_deg", "max_k_axis_deg",
                                     "srax_deg", "asphericity_q_flat_6mm"};
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  found_indices found = found_of(surface, NULL);
  for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
    assert_string_equal(found_reason(&found, axes[i]), "no_cylinder");
  }
  assert_string_equal(found_reason(&found, "clmi_x_mm"), "no_cone");
  placido_surface_free(surface);
}

/* The principal meridians of a toric surface with Q = 0 are circles: axial power along them is
 * constant. */
static void a_toric_surface_has_its_two_powers_and_axes(void **state) {
  (void)state;
  const double axes[] = {0, 30, 77.3, 135, 179.6};
  for (size_t i = 0; i < sizeof axes / sizeof axes[0]; i++) {
    placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {8, 0, 7.5, 0, axes[i], 0, 0}};
    placido_surface *surface = eye_of(&part, 1);
    found_indices found = found_of(surface, NULL);
    assert_near(found_value(&found, "simk_flat_D"), 337.5 / 8, 1e-7);
    assert_near(found_value(&found, "simk_steep_D"), 45, 1e-7);
    assert_near(found_value(&found, "max_k_D"), 45, 1e-7);
    assert_near(found_value(&found, "simk_cylinder_D"), 45 - 337.5 / 8, 1e-7);
    /* the parabola stands for a cosine within a step: a thousandth of a degree is far below any
     * measurement */
    double flat = found_value(&found, "simk_flat_axis_deg");
    assert_near(remainder(flat - axes[i], 180), 0, 2e-3);
    assert_near(remainder(found_value(&found, "max_k_axis_deg") - axes[i] - 90, 180), 0, 2e-3);
    assert_near(fabs(flat - found_value(&found, "simk_steep_axis_deg")), 90, 1e-9);
    /* two lobes that face each other: no skew; and both halves are alike */
    assert_near(found_value(&found, "srax_deg"), 0, 2e-3);
    assert_near(found_value(&found, "inferior_superior_D"), 0, 1e-9);
    assert_near(found_value(&found, "osi_D"), 0, 1e-9);
    placido_surface_free(surface);
  }
}

/* The cut of a biconic along a principal meridian is the conic of that meridian. */
static void a_biconic_has_its_two_asphericities(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BICONIC,
                       .as.biconic = {8, -0.4, 7.5, 0.15, 0, 0.2, -0.1}};
  placido_surface *surface = eye_of(&part, 1);
  found_indices found = found_of(surface, NULL);
  static const char *const zones[] = {"4_5mm", "6mm", "8mm"};
  for (int i = 0; i < 3; i++) {
    char name[64];
    /* the axis is found to a thousandth of a degree, which turns Q by its square */
    snprintf(name, sizeof name, "asphericity_q_flat_%s", zones[i]);
    assert_near(found_value(&found, name), -0.4, 1e-5);
    snprintf(name, sizeof name, "asphericity_q_steep_%s", zones[i]);
    assert_near(found_value(&found, name), 0.15, 1e-5);
  }
  placido_surface_free(surface);
}

static void a_conicoid_has_its_asphericity_in_every_zone(void **state) {
  (void)state;
  const double eyes[][4] = {{7.8, -0.26, 0, 0}, {7.7, 0.3, 0, 0}, {8.2, -0.7, 0.3, -0.2}};
  for (size_t i = 0; i < sizeof eyes / sizeof eyes[0]; i++) {
    double q = eyes[i][1];
    placido_surface *surface = conicoid_eye(eyes[i][0], q, eyes[i][2], eyes[i][3]);
    found_indices found = found_of(surface, NULL);
    assert_near(found_value(&found, "vertex_x_mm"), eyes[i][2], 1e-9);
    assert_near(found_value(&found, "vertex_y_mm"), eyes[i][3], 1e-9);
    assert_near(found_value(&found, "asphericity_q_4_5mm"), q, 1e-6);
    assert_near(found_value(&found, "asphericity_q"), q, 1e-7);
    assert_near(found_value(&found, "asphericity_q_8mm"), q, 1e-7);
    assert_near(found_value(&found, "apical_radius_mm"), eyes[i][0], 1e-7);
    assert_near(found_value(&found, "shape_factor_e"), -q, 1e-7);
    if (q < 0) {
      assert_near(found_value(&found, "eccentricity"), sqrt(-q), 1e-7);
    } else {
      assert_string_equal(found_reason(&found, "eccentricity"), "oblate");
    }
    placido_surface_free(surface);
  }
}

/* Axial radius of a conicoid is sqrt(R² - Q r²), so that its power's mean over a zone has a
 * formula: the integral of 2 r dr 337.5/sqrt(R² - Q r²) is -2·337.5/Q sqrt(R² - Q r²). */
static void zones_are_weighted_by_area(void **state) {
  (void)state;
  static const struct {
    const char *name;
    double from_mm, to_mm;
  } zones[] = {
      {"mean_axial_0_3mm_D", 0, 1.5}, {"mean_axial_3_6mm_D", 1.5, 3}, {"mean_axial_6_8mm_D", 3, 4}};
  const double radius = 7.7, q = -0.5;
  placido_surface *surface = conicoid_eye(radius, q, 0, 0);
  found_indices found = found_of(surface, NULL);
  double mean[3];
  for (int i = 0; i < 3; i++) {
    double a = zones[i].from_mm * zones[i].from_mm, b = zones[i].to_mm * zones[i].to_mm;
    mean[i] =
        -2 * 337.5 / q * (sqrt(radius * radius - q * b) - sqrt(radius * radius - q * a)) / (b - a);
    /* a ring stands for its annulus of 0.2 mm; half a one at the edge of a zone */
    assert_near(found_value(&found, zones[i].name), mean[i], 0.02);
  }
  assert_near(found_value(&found, "csi_D"), mean[0] - mean[1], 0.03);
  placido_surface_free(surface);
}

static placido_surface *cone_at(double x_mm, double y_mm) {
  placido_part parts[] = {{.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}},
                          {.kind = PLACIDO_PART_BUMP, .as.bump = {0.02, 0.8, 0.8, x_mm, y_mm, 0}}};
  return eye_of(parts, 2);
}

static void a_cone_is_found_where_it_is(void **state) {
  (void)state;
  placido_surface *surface = cone_at(1.2, -1.6);
  found_indices found = found_of(surface, NULL);
  assert_near(found_value(&found, "max_tangential_x_mm"), 1.2, 0.25);
  assert_near(found_value(&found, "max_tangential_y_mm"), -1.6, 0.25);
  /* 337.5 h/s² on top of the sphere, less what the cone's inclination takes */
  assert_near(found_value(&found, "max_tangential_D"), 337.5 * (1 / 7.8 + 0.02 / 0.64), 2);
  assert_true(found_value(&found, "inferior_superior_D") > 0);
  placido_surface_free(surface);
}

/* Mean axial power about the vertex over the central 8 mm, by points of a square grid: within the
 * disc 1 mm around (x, y), or outside. */
static double mean_of_disc(const placido_surface *surface, const found_indices *found, double x_mm,
                           double y_mm, bool inside) {
  double vertex_x = found_value(found, "vertex_x_mm"), vertex_y = found_value(found, "vertex_y_mm");
  double sum = 0;
  int count = 0;
  for (int j = -80; j <= 80; j++) {
    for (int i = -80; i <= 80; i++) {
      double x = i * 0.05, y = j * 0.05, r = hypot(x, y);
      placido_jet jet;
      if (r == 0 || r > 4 || (hypot(x - x_mm, y - y_mm) <= 1) != inside) {
        continue;
      }
      assert_true(placido_surface_at(surface, vertex_x + x, vertex_y + y, &jet));
      double slope = (x * jet.sx + y * jet.sy) / r;
      sum += 337.5 * slope / (r * sqrt(1 + slope * slope));
      count++;
    }
  }
  return sum / count;
}

/* The index's arcs of rings and the grid's points are two ways to integrate: within 1 %. */
static void clmi_compares_the_steepest_disc_with_its_opposite(void **state) {
  (void)state;
  const double places[][2] = {{1.2, -1.6}, {-0.3, -0.5}};
  for (int i = 0; i < 2; i++) {
    placido_surface *surface = cone_at(places[i][0], places[i][1]);
    found_indices found = found_of(surface, NULL);
    double x = found_value(&found, "clmi_x_mm"), y = found_value(&found, "clmi_y_mm");
    double most = mean_of_disc(surface, &found, x, y, true);
    for (int angle = 0; angle < 360; angle += 30) {
      double dx = 0.3 * cos(angle / 57.29578), dy = 0.3 * sin(angle / 57.29578);
      assert_true(hypot(x + dx, y + dy) > 3 ||
                  mean_of_disc(surface, &found, x + dx, y + dy, true) < most + 0.01);
    }
    double m1 = most - mean_of_disc(surface, &found, x, y, false);
    double m2 =
        mean_of_disc(surface, &found, -x, -y, true) - mean_of_disc(surface, &found, -x, -y, false);
    double clmi = m1 - fmin(1, hypot(x, y)) * m2;
    assert_near(found_value(&found, "clmi_D"), clmi, 0.01 * clmi);
    assert_near(found_value(&found, "ppk_percent"),
                100 / (1 + exp(6.4483 - 2.1319 * found_value(&found, "clmi_D"))), 1e-9);
    placido_surface_free(surface);
  }
}

static void steeper_below_is_positive(void **state) {
  (void)state;
  placido_surface *below = cone_at(0, -1.8), *above = cone_at(0, 1.8);
  found_indices lower = found_of(below, NULL), upper = found_of(above, NULL);
  double difference = found_value(&lower, "inferior_superior_D");
  assert_true(difference > 1);
  assert_near(found_value(&upper, "inferior_superior_D"), -difference, 1e-9);
  placido_surface_free(below);
  placido_surface_free(above);
}

/* Astigmatism with trefoil has two lobes that do not face each other; neither moves the vertex. */
static placido_surface *skewed_eye(double trefoil_um) {
  placido_part parts[] = {{.kind = PLACIDO_PART_BICONIC, .as.biconic = {7, 0, 6.6, 0, 0, 0, 0}},
                          {.kind = PLACIDO_PART_ZERNIKE,
                           .as.zernike = {.coefficients_um = {[9] = trefoil_um}, .radius_mm = 4}}};
  return eye_of(parts, 2);
}

/* What srax_deg looks for, by a search in steps of a hundredth of a degree. */
static double steepest_between(const placido_surface *surface, double from_deg, double to_deg) {
  const double degree = 3.14159265358979323846 / 180;
  double best = NAN, most = -INFINITY;
  for (double angle = from_deg; angle <= to_deg; angle += 0.01) {
    double c = cos(angle * degree), s = sin(angle * degree), sum = 0;
    for (int i = 0; i <= 10; i++) {
      double r = 0.9 + 0.2 * i;
      placido_jet jet;
      assert_true(placido_surface_at(surface, r * c, r * s, &jet));
      double slope = c * jet.sx + s * jet.sy;
      sum += slope / (r * sqrt(1 + slope * slope));
    }
    if (sum > most) {
      most = sum;
      best = angle;
    }
  }
  return best;
}

static void two_lobes_have_their_skew(void **state) {
  (void)state;
  placido_surface *surface = skewed_eye(3);
  found_indices found = found_of(surface, NULL);
  double skew = 180 - fabs(steepest_between(surface, 180, 360) - steepest_between(surface, 0, 180));
  assert_true(fabs(skew) > 10);
  assert_near(found_value(&found, "srax_deg"), fabs(skew), 0.05);
  placido_surface_free(surface);
}

/* KISA% of a cornea whose factors are all above 1 is their product, and a third of one per cent
 * times 100 where none is. */
static void kisa_is_the_product_of_its_factors(void **state) {
  (void)state;
  placido_part parts[] = {{.kind = PLACIDO_PART_BICONIC, .as.biconic = {7, 0, 6.6, 0, 0, 0, 0}},
                          {.kind = PLACIDO_PART_ZERNIKE,
                           .as.zernike = {.coefficients_um = {[7] = -3, [9] = 3}, .radius_mm = 4}}};
  placido_surface *surface = eye_of(parts, 2);
  found_indices found = found_of(surface, NULL);
  double product = (found_value(&found, "central_k_D") - 47.2) *
                   found_value(&found, "inferior_superior_D") *
                   found_value(&found, "simk_cylinder_D") * found_value(&found, "srax_deg");
  assert_true(found_value(&found, "inferior_superior_D") > 1);
  assert_true(found_value(&found, "srax_deg") > 1);
  assert_near(found_value(&found, "kisa_percent"), product / 3, 1e-6);
  placido_surface_free(surface);
  placido_part flat = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {8, 0, 7.95, 0, 0, 0, 0}};
  surface = eye_of(&flat, 1);
  found = found_of(surface, NULL);
  assert_near(found_value(&found, "kisa_percent"), 100 / 300.0, 1e-9);
  placido_surface_free(surface);
}

/* Coma alone: axial power of opposite points differs, that of neighbours along a semi-meridian
 * hardly. A ridge the other way round. */
static void asymmetry_and_irregularity_are_told_apart(void **state) {
  (void)state;
  placido_part comatic[] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}},
      {.kind = PLACIDO_PART_ZERNIKE, .as.zernike = {.coefficients_um = {[7] = 2}, .radius_mm = 4}}};
  placido_part wavy[] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}},
      {.kind = PLACIDO_PART_ZERNIKE,
       .as.zernike = {.coefficients_um = {[60] = 0.3}, .radius_mm = 4}}}; /* Z(10, 0) */
  placido_surface *coma = eye_of(comatic, 2), *waves = eye_of(wavy, 2);
  found_indices one = found_of(coma, NULL), other = found_of(waves, NULL);
  assert_true(found_value(&one, "sai_like_D") > 0.1);
  assert_near(found_value(&other, "sai_like_D"), 0, 1e-9);
  assert_true(found_value(&other, "sri_like_D") > 5 * found_value(&one, "sri_like_D"));
  assert_true(found_value(&other, "iai_like_D") > 2 * found_value(&one, "iai_like_D"));
  placido_surface_free(coma);
  placido_surface_free(waves);
}

static void missing_data_give_no_figure_but_a_reason(void **state) {
  (void)state;
  static const char *const missing[] = {"simk_flat_D",
                                        "simk_cylinder_D",
                                        "asphericity_q",
                                        "asphericity_q_flat_6mm",
                                        "simk_flat_axis_deg",
                                        "best_fit_sphere_radius_mm",
                                        "inferior_superior_D",
                                        "srax_deg",
                                        "kisa_percent",
                                        "clmi_D",
                                        "ppk_percent",
                                        "dsi_D",
                                        "osi_D",
                                        "csi_D",
                                        "kpi",
                                        "sai_like_D"};
  const unsigned char left[19] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  placido_surface *surface = partly_covered_eye(7.8, left);
  found_indices found = found_of(surface, NULL);
  for (size_t i = 0; i < sizeof missing / sizeof missing[0]; i++) {
    assert_string_equal(found_reason(&found, missing[i]), "not_covered");
  }
  assert_near(found_value(&found, "max_tangential_D"), 337.5 / 7.8, 1e-10);
  assert_near(found_index(&found, "csi_D")->zone_mm, 6, 0);
  assert_near(found_index(&found, "csi_D")->covered, 0.55, 0.02); /* to x = 0.25 mm */
  assert_near(found_value(&found, "analysed_area_percent"), 53.5, 1);
  placido_surface_free(surface);
}

/* The vertex is where nothing was seen: what needs none is given, what needs it says so. */
static void without_a_vertex_nothing_is_about_it(void **state) {
  (void)state;
  const unsigned char sides[19] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  placido_surface *surface = partly_covered_eye(7.8, sides);
  found_indices found = found_of(surface, NULL);
  assert_string_equal(found_reason(&found, "vertex_x_mm"), "no_vertex");
  assert_string_equal(found_reason(&found, "mean_axial_3_6mm_D"), "no_vertex");
  assert_near(found_value(&found, "best_fit_sphere_radius_mm"), 7.8, 1e-9);
  placido_surface_free(surface);
}

static void the_file_holds_what_was_found(void **state) {
  (void)state;
  char path[] = "/tmp/placido-indices-XXXXXX";
  int descriptor = mkstemp(path);
  assert_true(descriptor >= 0);
  close(descriptor);
  placido_index_value values[] = {{.name = "alpha_D",
                                   .unit = "D",
                                   .help = "First.",
                                   .value = 1.0 / 3,
                                   .sigma = 0.25,
                                   .budget = {0.15, 0.2, NAN},
                                   .zone_mm = 6,
                                   .covered = 0.75},
                                  {.name = "beta",
                                   .unit = "",
                                   .help = "Second.",
                                   .value = NAN,
                                   .sigma = NAN,
                                   .reason = "not_covered"}};
  assert_int_equal(placido_indices_save(values, 2, path, NULL), PLACIDO_OK);
  placido_json *json;
  double number;
  char text[16];
  assert_int_equal(placido_json_load(&json, path, "placido-indices/1", NULL), PLACIDO_OK);
  static const struct {
    const char *path;
    double value;
  } numbers[] = {{"indices[0].value", 1.0 / 3},     {"indices[0].sigma", 0.25},
                 {"indices[0].budget.noise", 0.15}, {"indices[0].budget.distance", 0.2},
                 {"indices[0].zone_mm", 6},         {"indices[0].covered", 0.75}};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
    assert_int_equal(placido_json_number(json, numbers[i].path, &number, NULL), PLACIDO_OK);
    assert_true(number == numbers[i].value);
  }
  assert_true(json_is_null(placido_json_find(json, "indices[0].budget.geometry")));
  assert_null(placido_json_find(json, "indices[0].reason"));
  assert_int_equal(placido_json_string(json, "indices[0].unit", text, sizeof text, NULL),
                   PLACIDO_OK);
  assert_string_equal(text, "D");
  assert_int_equal(placido_json_string(json, "indices[1].reason", text, sizeof text, NULL),
                   PLACIDO_OK);
  assert_string_equal(text, "not_covered");
  assert_null(placido_json_find(json, "indices[1].zone_mm"));
  assert_true(json_is_null(placido_json_find(json, "indices[1].value")));
  assert_true(json_is_null(placido_json_find(json, "indices[1].sigma")));
  placido_json_free(json);
  unlink(path);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  found_indices found;
  int status = PLACIDO_MEMORY;
  unsigned long n;
  for (n = 1; status == PLACIDO_MEMORY && n < 20; n++) {
    placido_memory_fail_at(n);
    status = placido_indices_find(found.values, &found.count, surface, NULL, NULL);
    placido_memory_fail_at(0);
    assert_true((found.count == 0) == (status != PLACIDO_OK));
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 2);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_sphere_has_one_power),
      cmocka_unit_test(a_sphere_has_no_axis),
      cmocka_unit_test(a_toric_surface_has_its_two_powers_and_axes),
      cmocka_unit_test(a_biconic_has_its_two_asphericities),
      cmocka_unit_test(a_conicoid_has_its_asphericity_in_every_zone),
      cmocka_unit_test(zones_are_weighted_by_area),
      cmocka_unit_test(a_cone_is_found_where_it_is),
      cmocka_unit_test(clmi_compares_the_steepest_disc_with_its_opposite),
      cmocka_unit_test(steeper_below_is_positive),
      cmocka_unit_test(two_lobes_have_their_skew),
      cmocka_unit_test(kisa_is_the_product_of_its_factors),
      cmocka_unit_test(asymmetry_and_irregularity_are_told_apart),
      cmocka_unit_test(missing_data_give_no_figure_but_a_reason),
      cmocka_unit_test(without_a_vertex_nothing_is_about_it),
      cmocka_unit_test(the_file_holds_what_was_found),
      cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
