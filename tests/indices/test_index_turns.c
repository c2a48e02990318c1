/* What the indices of an irregular cornea do when it is turned, mirrored or moved: axes and places
 * follow, everything else stays. */
#include "tests/indices/found.h"
#include "tests/maps/eyes.h"
#include "tests/support/near.h"

#include <string.h>

#define DEGREE (3.14159265358979323846 / 180)

/* Astigmatic, with a cone: no symmetry at all. */
static placido_surface *eye(double turn_deg, double mirror, double x_mm, double y_mm) {
  double c = cos(turn_deg * DEGREE), s = sin(turn_deg * DEGREE), px = 0.9, py = -1.1;
  double x = mirror * (c * px - s * py), y = s * px + c * py;
  placido_part parts[] = {
      {.kind = PLACIDO_PART_BICONIC,
       .as.biconic = {7.6, -0.3, 7.2, -0.2, mirror * (25 + turn_deg), x_mm, y_mm}},
      {.kind = PLACIDO_PART_BUMP,
       .as.bump = {0.012, 0.9, 1.1, x + x_mm, y + y_mm, mirror * (40 + turn_deg)}}};
  return eye_of(parts, 2);
}

/* What has a direction of its own. */
static bool has_direction(const char *name) {
  static const char *const names[] = {"vertex_x_mm", "vertex_y_mm",         "clmi_x_mm",
                                      "clmi_y_mm",   "max_tangential_x_mm", "max_tangential_y_mm"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    if (strcmp(name, names[i]) == 0) {
      return true;
    }
  }
  return strstr(name, "axis_deg") != NULL;
}

static bool is_about_up_and_down(const char *name) {
  return strcmp(name, "inferior_superior_D") == 0 || strcmp(name, "kisa_percent") == 0;
}

static void compare(const found_indices *one, const found_indices *other, bool upright,
                    double tolerance) {
  for (size_t i = 0; i < one->count; i++) {
    const char *name = one->values[i].name;
    if (has_direction(name) || (!upright && is_about_up_and_down(name))) {
      continue;
    }
    double expected = one->values[i].value, value = other->values[i].value;
    if (!(fabs(value - expected) <= tolerance * fmax(1, fabs(expected)))) {
      fail_msg("%s: %.12g became %.12g", name, expected, value);
    }
  }
}

static void check_axis(const found_indices *found, const char *name, double expected) {
  assert_near(remainder(found_value(found, name) - expected, 180), 0, 1e-6);
}

static void a_quarter_turn_changes_directions_only(void **state) {
  (void)state;
  placido_surface *upright = eye(0, 1, 0, 0), *turned = eye(90, 1, 0, 0);
  found_indices one = found_of(upright, NULL), other = found_of(turned, NULL);
  compare(&one, &other, false, 1e-8);
  check_axis(&other, "simk_flat_axis_deg", found_value(&one, "simk_flat_axis_deg") + 90);
  check_axis(&other, "max_k_axis_deg", found_value(&one, "max_k_axis_deg") + 90);
  assert_near(found_value(&other, "clmi_x_mm"), -found_value(&one, "clmi_y_mm"), 1e-8);
  assert_near(found_value(&other, "clmi_y_mm"), found_value(&one, "clmi_x_mm"), 1e-8);
  assert_near(found_value(&other, "vertex_x_mm"), -found_value(&one, "vertex_y_mm"), 1e-8);
  assert_near(found_value(&other, "max_tangential_y_mm"), found_value(&one, "max_tangential_x_mm"),
              1e-8);
  placido_surface_free(upright);
  placido_surface_free(turned);
}

/* A right eye's mirror image is a left eye's. */
static void a_mirrored_eye_has_the_same_figures(void **state) {
  (void)state;
  placido_surface *right = eye(0, 1, 0, 0), *left = eye(0, -1, 0, 0);
  found_indices one = found_of(right, NULL), other = found_of(left, NULL);
  compare(&one, &other, true, 1e-8);
  check_axis(&other, "simk_flat_axis_deg", -found_value(&one, "simk_flat_axis_deg"));
  assert_near(found_value(&other, "clmi_x_mm"), -found_value(&one, "clmi_x_mm"), 1e-8);
  assert_near(found_value(&other, "clmi_y_mm"), found_value(&one, "clmi_y_mm"), 1e-8);
  assert_near(found_value(&other, "vertex_x_mm"), -found_value(&one, "vertex_x_mm"), 1e-8);
  placido_surface_free(right);
  placido_surface_free(left);
}

/* Any angle: where the samples do not coincide, their density shows. */
static void any_turn_changes_figures_little(void **state) {
  (void)state;
  placido_surface *upright = eye(0, 1, 0, 0), *turned = eye(17.3, 1, 0, 0);
  found_indices one = found_of(upright, NULL), other = found_of(turned, NULL);
  compare(&one, &other, false, 2e-3);
  placido_surface_free(upright);
  placido_surface_free(turned);
}

/* Off the axis, the vertex moves along: what is about the vertex stays. */
static void an_eye_off_the_axis_has_the_same_figures(void **state) {
  (void)state;
  static const char *const names[] = {"simk_flat_D",
                                      "simk_flat_axis_deg",
                                      "max_k_D",
                                      "central_k_D",
                                      "mean_axial_3_6mm_D",
                                      "asphericity_q",
                                      "asphericity_q_flat_6mm",
                                      "inferior_superior_D",
                                      "srax_deg",
                                      "kisa_percent",
                                      "clmi_D",
                                      "clmi_x_mm",
                                      "sai_like_D",
                                      "sri_like_D",
                                      "dsi_D",
                                      "csi_D"};
  placido_surface *centred = eye(0, 1, 0, 0), *moved = eye(0, 1, 0.15, -0.1);
  found_indices one = found_of(centred, NULL), other = found_of(moved, NULL);
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    assert_near(found_value(&other, names[i]), found_value(&one, names[i]), 1e-7);
  }
  assert_near(found_value(&other, "vertex_x_mm"), found_value(&one, "vertex_x_mm") + 0.15, 1e-9);
  placido_surface_free(centred);
  placido_surface_free(moved);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_quarter_turn_changes_directions_only),
      cmocka_unit_test(a_mirrored_eye_has_the_same_figures),
      cmocka_unit_test(any_turn_changes_figures_little),
      cmocka_unit_test(an_eye_off_the_axis_has_the_same_figures),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
