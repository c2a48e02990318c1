/* Exact edge positions of the phantom against reflection in a plane, solved here by the angles'
 * equality, and against turning the eye. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <placido/phantom.h>

static const double radian = 57.29577951308232;
/* What placido_phantom_edge_at promises. */
static const double exact_px = 1e-6;

static placido_surface *sphere_of(double radius_mm, double vertex_z_mm) {
  placido_part part = {PLACIDO_PART_BICONIC, {.biconic = {.r1 = radius_mm, .r2 = radius_mm}}};
  placido_surface *surface;
  placido_error err = {0};
  assert_int_equal(placido_surface_new(&surface, vertex_z_mm, 5.5, &part, 1, NULL, &err),
                   PLACIDO_OK);
  return surface;
}

/* How much the angle of incidence falls short of the angle of reflection at the point of a sphere
 * whose radius stands at `angle` to the axis. Everything lies in one plane. */
static double angle_gap(const placido_instrument *instrument, int edge, double radius_mm,
                        double vertex_z_mm, double angle) {
  double r = radius_mm * sin(angle), z = vertex_z_mm - radius_mm + radius_mm * cos(angle);
  double to_camera =
      instrument->model == PLACIDO_TELECENTRIC ? 0 : atan2(-r, instrument->position_mm[2] - z);
  double to_edge = atan2(instrument->edges[edge].radius_mm - r, instrument->edges[edge].z_mm - z);
  return (to_edge - angle) - (angle - to_camera);
}

/* Distance in the image at which a sphere on the axis mirrors an edge, by halving. */
static double planar_px(const placido_instrument *instrument, int edge, double radius_mm,
                        double vertex_z_mm) {
  double low = 0, high = 0.8;
  for (int i = 0; i < 100; i++) {
    double middle = 0.5 * (low + high);
    if (angle_gap(instrument, edge, radius_mm, vertex_z_mm, middle) > 0) {
      low = middle;
    } else {
      high = middle;
    }
  }
  double r = radius_mm * sin(low), z = vertex_z_mm - radius_mm + radius_mm * cos(low);
  double depth = instrument->model == PLACIDO_TELECENTRIC ? 1 : instrument->position_mm[2] - z;
  return instrument->focal_px[0] * r / depth;
}

static void expect_planar(const placido_instrument *instrument, double radius_mm,
                          double vertex_z_mm) {
  placido_surface *surface = sphere_of(radius_mm, vertex_z_mm);
  const double *centre = instrument->principal_px;
  for (int k = 0; k < instrument->edge_count; k++) {
    double expected = planar_px(instrument, k, radius_mm, vertex_z_mm);
    for (double deg = 17; deg < 360; deg += 61) {
      double at[2];
      assert_true(placido_phantom_edge_at(surface, instrument, k, centre, deg, at));
      assert_true(fabs(at[0] - centre[0] - expected * cos(deg / radian)) < exact_px);
      assert_true(fabs(at[1] - centre[1] + expected * sin(deg / radian)) < exact_px);
    }
  }
  placido_surface_free(surface);
}

static placido_instrument built_in(const char *name) {
  placido_instrument instrument;
  assert_int_equal(placido_phantom_instrument(&instrument, name, NULL), PLACIDO_OK);
  return instrument;
}

static void cone_mirrors_as_in_a_plane(void **state) {
  (void)state;
  placido_instrument cone = built_in("cone24");
  expect_planar(&cone, 7.8, 0);
  expect_planar(&cone, 7.1, -0.4);
}

static void disc_mirrors_as_in_a_plane(void **state) {
  (void)state;
  placido_instrument disc = built_in("disc18");
  expect_planar(&disc, 7.8, 0);
}

static void telecentric_camera_mirrors_as_in_a_plane(void **state) {
  (void)state;
  placido_instrument cone = built_in("cone24");
  cone.model = PLACIDO_TELECENTRIC;
  cone.focal_px[0] = cone.focal_px[1] = 90;
  expect_planar(&cone, 7.8, 0);
}

/* Edges alternately 1 mm nearer and farther: the profile is no funnel. */
static void staggered_mires_mirror_as_in_a_plane(void **state) {
  (void)state;
  placido_instrument disc = built_in("disc18");
  for (int k = 0; k < disc.edge_count; k++) {
    disc.edges[k].z_mm += k % 2 ? 0.5 : -0.5;
  }
  expect_planar(&disc, 7.8, 0);
}

/* Middle of the edges seen to both sides of the principal point along a meridian. */
static double middle_of(const placido_surface *surface, const placido_instrument *instrument,
                        double deg, int axis) {
  double a[2], b[2];
  const double *centre = instrument->principal_px;
  assert_true(placido_phantom_edge_at(surface, instrument, 9, centre, deg, a));
  assert_true(placido_phantom_edge_at(surface, instrument, 9, centre, deg + 180, b));
  return 0.5 * (a[axis] + b[axis]) - centre[axis];
}

/* x to the right, y up in the image: an eye that stands right and up is seen right and up. */
static void eye_is_seen_on_its_side(void **state) {
  (void)state;
  placido_part part = {PLACIDO_PART_BICONIC, {.biconic = {7.8, 0, 7.8, 0, 0, 0.2, 0.1}}};
  placido_surface *surface;
  placido_instrument cone = built_in("cone24");
  assert_int_equal(placido_surface_new(&surface, 0, 5.5, &part, 1, NULL, NULL), PLACIDO_OK);
  for (int model = 0; model < 2; model++) {
    if (model == 1) {
      cone.model = PLACIDO_TELECENTRIC;
      cone.focal_px[0] = cone.focal_px[1] = 90;
    }
    double right_px = middle_of(surface, &cone, 0, 0), down_px = middle_of(surface, &cone, 90, 1);
    assert_true(right_px > 9 && right_px < 18); /* the reflection follows the eye's 18 px partly */
    assert_true(down_px < -4.5 && down_px > -9);
  }
  placido_surface_free(surface);
}

/* A telecentric camera that stands aside sees the same with its principal point moved back. */
static void telecentric_position_is_a_shift_of_the_image(void **state) {
  (void)state;
  placido_surface *surface = sphere_of(7.8, 0);
  placido_instrument cone = built_in("cone24");
  cone.model = PLACIDO_TELECENTRIC;
  cone.focal_px[0] = cone.focal_px[1] = 90;
  placido_instrument aside = cone;
  aside.position_mm[0] = 0.3;
  aside.position_mm[1] = -0.2;
  aside.principal_px[0] += 90 * 0.3;
  aside.principal_px[1] -= 90 * -0.2;
  for (double deg = 10; deg < 360; deg += 70) {
    double a[2], b[2];
    assert_true(placido_phantom_edge_at(surface, &cone, 20, cone.principal_px, deg, a));
    assert_true(placido_phantom_edge_at(surface, &aside, 20, cone.principal_px, deg, b));
    assert_true(hypot(a[0] - b[0], a[1] - b[1]) < exact_px);
  }
  placido_surface_free(surface);
}

static void a_single_edge_is_found(void **state) {
  (void)state;
  placido_instrument disc = built_in("disc18");
  disc.edge_count = 1;
  expect_planar(&disc, 7.8, 0);
}

/* Radial distortion leaves meridians through the principal point as they are. */
static void distortion_moves_edges_as_the_model_says(void **state) {
  (void)state;
  const double k1 = 3, k2 = -20;
  placido_instrument plain = built_in("cone24"), bent = plain;
  placido_surface *surface = sphere_of(7.8, 0);
  bent.distortion[0] = k1;
  bent.distortion[1] = k2;
  for (int k = 0; k < plain.edge_count; k++) {
    double at[2], r = planar_px(&plain, k, 7.8, 0) / plain.focal_px[0];
    double expected = plain.focal_px[0] * r * (1 + k1 * r * r + k2 * r * r * r * r);
    assert_true(placido_phantom_edge_at(surface, &bent, k, plain.principal_px, 33, at));
    double found = hypot(at[0] - plain.principal_px[0], at[1] - plain.principal_px[1]);
    assert_true(fabs(found - expected) < exact_px);
  }
  placido_surface_free(surface);
}

static placido_surface *cone_eye(double turned_deg) {
  double c = cos(turned_deg / radian), s = sin(turned_deg / radian);
  placido_part parts[] = {
      {PLACIDO_PART_BICONIC,
       {.biconic = {7.7, -0.3, 7.5, -0.25, 20 + turned_deg, 0.1 * c - 0.05 * s,
                    0.1 * s + 0.05 * c}}},
      {PLACIDO_PART_BUMP,
       {.bump = {0.03, 1.2, 1.0, 0.4 * c + 1.1 * s, 0.4 * s - 1.1 * c, 15 + turned_deg}}},
  };
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 5.5, parts, 2, NULL, NULL), PLACIDO_OK);
  return surface;
}

static void turned_eye_turns_the_picture(void **state) {
  (void)state;
  const double turned_deg = 37;
  placido_instrument cone = built_in("cone24");
  placido_surface *eye = cone_eye(0), *turned = cone_eye(turned_deg);
  for (int k = 0; k < cone.edge_count; k++) {
    for (double deg = 5; deg < 360; deg += 40) {
      double a[2], b[2];
      assert_true(placido_phantom_edge_at(eye, &cone, k, cone.principal_px, deg, a));
      assert_true(
          placido_phantom_edge_at(turned, &cone, k, cone.principal_px, deg + turned_deg, b));
      double ra = hypot(a[0] - cone.principal_px[0], a[1] - cone.principal_px[1]);
      double rb = hypot(b[0] - cone.principal_px[0], b[1] - cone.principal_px[1]);
      assert_true(fabs(ra - rb) < exact_px);
    }
  }
  placido_surface_free(eye);
  placido_surface_free(turned);
}

static void built_in_mires_look_evenly_spaced(void **state) {
  (void)state;
  placido_instrument cone = built_in("cone24");
  double first = planar_px(&cone, 0, 7.8, 0);
  double last = planar_px(&cone, cone.edge_count - 1, 7.8, 0);
  double step = (last - first) / (cone.edge_count - 1);
  assert_true(fabs(last / 90 - 4.4) < 0.1); /* 90 px/mm at the vertex */
  for (int k = 0; k < cone.edge_count; k++) {
    /* Radii are rounded to 0.01 mm; depth and perspective bend the spacing a little. */
    assert_true(fabs(planar_px(&cone, k, 7.8, 0) - first - k * step) < 0.25 * step);
  }
}

static void what_cannot_be_seen_is_not_found(void **state) {
  (void)state;
  placido_instrument cone = built_in("cone24");
  placido_surface *surface = sphere_of(7.8, 0);
  double at[2];
  const double outside[2] = {-50, 500};
  assert_false(placido_phantom_edge_at(surface, &cone, -1, cone.principal_px, 0, at));
  assert_false(placido_phantom_edge_at(surface, &cone, 48, cone.principal_px, 0, at));
  assert_false(placido_phantom_edge_at(surface, &cone, 3, outside, 0, at));
  assert_true(isnan(at[0]) && isnan(at[1]));
  cone.height_px = 600; /* the outer mires fall below the picture */
  assert_false(placido_phantom_edge_at(surface, &cone, 40, cone.principal_px, 270, at));
  assert_true(placido_phantom_edge_at(surface, &cone, 40, cone.principal_px, 90, at));
  placido_surface_free(surface);
}

/* From a centre beside the innermost circle, it is met from outside and left on its far side. */
static void a_centre_outside_the_circle_sees_its_far_side(void **state) {
  (void)state;
  placido_instrument cone = built_in("cone24");
  placido_surface *surface = sphere_of(7.8, 0);
  double at[2], expected = planar_px(&cone, 0, 7.8, 0);
  const double beside[2] = {cone.principal_px[0] - 60, cone.principal_px[1]};
  assert_true(placido_phantom_edge_at(surface, &cone, 0, beside, 0, at));
  assert_true(fabs(at[0] - cone.principal_px[0] - expected) < exact_px);
  assert_false(placido_phantom_edge_at(surface, &cone, 0, beside, 180, at));
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cone_mirrors_as_in_a_plane),
      cmocka_unit_test(disc_mirrors_as_in_a_plane),
      cmocka_unit_test(telecentric_camera_mirrors_as_in_a_plane),
      cmocka_unit_test(staggered_mires_mirror_as_in_a_plane),
      cmocka_unit_test(eye_is_seen_on_its_side),
      cmocka_unit_test(telecentric_position_is_a_shift_of_the_image),
      cmocka_unit_test(a_single_edge_is_found),
      cmocka_unit_test(distortion_moves_edges_as_the_model_says),
      cmocka_unit_test(turned_eye_turns_the_picture),
      cmocka_unit_test(built_in_mires_look_evenly_spaced),
      cmocka_unit_test(what_cannot_be_seen_is_not_found),
      cmocka_unit_test(a_centre_outside_the_circle_sees_its_far_side),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
