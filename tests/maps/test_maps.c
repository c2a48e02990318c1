/* Maps: exact results on shapes that have them, invariance, and what is not supported stays empty.
 */
#include "base/memory.h"
#include "tests/maps/eyes.h"
#include "tests/support/near.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#define INDEX 1.3375

static bool is_inside(const placido_maps *maps, int i, int j) {
  return maps->valid[j * maps->size + i] != 0;
}

static void a_sphere_has_one_power_everywhere(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  placido_maps maps = maps_of(surface);
  int inside = 0;
  for (int j = 0; j < maps.size; j++) {
    for (int i = 0; i < maps.size; i++) {
      if (is_inside(&maps, i, j)) {
        inside++;
        assert_near(map_at(&maps, "axial", i, j), 337.5 / 7.8, 1e-9);
        assert_near(map_at(&maps, "tangential", i, j), 337.5 / 7.8, 1e-9);
        assert_near(map_at(&maps, "mean", i, j), 337.5 / 7.8, 1e-9);
        assert_near(337.5 * sqrt(map_at(&maps, "gaussian", i, j)), 337.5 / 7.8, 1e-9);
        assert_near(map_at(&maps, "elevation", i, j), 0, 1e-9);
      }
    }
  }
  assert_int_equal(inside, 6361); /* grid points in a disc of 4.5 mm */
  assert_near(337.5 / 7.8, 43.269, 5e-4);
  assert_near(maps.sphere.radius_mm, 7.8, 1e-11);
  assert_near(maps.sphere.z_mm, -7.8, 1e-11);
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

/* A conic's axial radius is sqrt(R² - Q r²), its tangential radius that cubed over R². */
static void a_conicoid_has_its_textbook_powers(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.7, -0.3, 0, 0);
  placido_maps maps = maps_of(surface);
  for (int j = 0; j < maps.size; j++) {
    for (int i = 0; i < maps.size; i++) {
      if (is_inside(&maps, i, j)) {
        double r = distance_of(&maps, i, j), radius = sqrt(7.7 * 7.7 + 0.3 * r * r);
        assert_near(map_at(&maps, "axial", i, j), 337.5 / radius, 1e-10);
        assert_near(map_at(&maps, "tangential", i, j), 337.5 * 7.7 * 7.7 / pow(radius, 3), 1e-10);
      }
    }
  }
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

static void a_toric_apex_has_both_curvatures(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {8, -0.2, 7.5, -0.2, 0, 0, 0}};
  placido_surface *surface = eye_of(&part, 1);
  placido_maps maps = maps_of(surface);
  int half = maps.half;
  assert_near(map_at(&maps, "mean", half, half), 337.5 * (1 / 8. + 1 / 7.5) / 2, 1e-12);
  assert_near(map_at(&maps, "gaussian", half, half), 1 / (8 * 7.5), 1e-15);
  assert_near(map_at(&maps, "axial", half, half), 337.5 / 8, 1e-12); /* along +x */
  assert_near(map_at(&maps, "tangential", half, half), 337.5 / 8, 1e-12);
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

/* The ellipsoid with Q = -1/n² brings every ray to one focus. */
static void the_perfect_ellipsoid_has_one_refractive_power(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, -1 / (INDEX * INDEX), 0, 0);
  placido_maps maps = maps_of(surface);
  for (int j = 0; j < maps.size; j++) {
    for (int i = 0; i < maps.size; i++) {
      if (is_inside(&maps, i, j)) {
        assert_near(map_at(&maps, "refractive", i, j), 337.5 / 7.8, 1e-9);
      }
    }
  }
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

/* By trigonometry: sin i = r/R, sin t = sin i / n, and the ray descends to the axis at the angle i
 * - t. */
static void a_spheres_refractive_power_follows_snell(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  placido_maps maps = maps_of(surface);
  assert_near(map_at(&maps, "refractive", maps.half, maps.half), 337.5 / 7.8, 1e-12);
  for (int i = maps.half + 1; i < maps.size; i++) {
    double r = placido_maps_position(&maps, i), incident = asin(r / 7.8);
    double refracted = asin(sin(incident) / INDEX);
    double focal = 7.8 * (1 - cos(incident)) + r / tan(incident - refracted);
    assert_near(map_at(&maps, "refractive", i, maps.half), 1000 * INDEX / focal, 1e-9);
  }
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

/* References of the very shapes that they are: nothing is left over them. */
static void a_conicoid_has_no_elevation_over_itself(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.7, -0.4, 0.3, -0.2);
  placido_maps maps = maps_of(surface);
  const placido_conicoid_shape *conic = &maps.references[PLACIDO_REFERENCE_CONIC];
  assert_near(1 / conic->c_mm1, 7.7, 1e-9);
  assert_near(conic->p, 0.6, 1e-9);
  assert_near(conic->x_mm, 0.3, 1e-9);
  assert_near(conic->y_mm, -0.2, 1e-9);
  assert_near(conic->z_mm, 0, 1e-10);
  assert_near(maps.vertex_mm[0], 0.3, 1e-9);
  assert_near(maps.vertex_mm[1], -0.2, 1e-9);
  for (int j = 0; j < maps.size; j++) {
    for (int i = 0; i < maps.size; i++) {
      if (is_inside(&maps, i, j)) {
        assert_near(map_at(&maps, "elevation_conic", i, j), 0, 1e-7);
        assert_near(map_at(&maps, "elevation_toric", i, j), 0, 1e-7);
        /* about its own vertex a conicoid has its textbook powers wherever it stands */
        double r =
            hypot(placido_maps_position(&maps, i) - 0.3, placido_maps_position(&maps, j) + 0.2);
        double radius = sqrt(7.7 * 7.7 + 0.4 * r * r);
        assert_near(map_at(&maps, "axial_vertex", i, j), 337.5 / radius, 1e-7);
        assert_near(map_at(&maps, "tangential_vertex", i, j), 337.5 * 7.7 * 7.7 / pow(radius, 3),
                    1e-7);
      }
    }
  }
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

static void a_toric_conicoid_has_no_elevation_over_itself(void **state) {
  (void)state;
  const double axes[] = {0, 35, 90, 150};
  for (int a = 0; a < 4; a++) {
    placido_part part = {.kind = PLACIDO_PART_BICONIC,
                         .as.biconic = {8.1, -0.3, 7.4, -0.3, axes[a], -0.2, 0.4}};
    placido_surface *surface = eye_of(&part, 1);
    placido_maps maps = maps_of(surface);
    const placido_conicoid_shape *toric = &maps.references[PLACIDO_REFERENCE_TORIC];
    double angle = 2 * axes[a] * 3.14159265358979323846 / 180;
    double half = (1 / 7.4 - 1 / 8.1) / 2; /* along the axis flatter by that, across steeper */
    assert_near(toric->c_mm1, (1 / 8.1 + 1 / 7.4) / 2, 1e-11);
    assert_near(toric->d_mm1, -half * cos(angle), 1e-11);
    assert_near(toric->e_mm1, -half * sin(angle), 1e-11);
    assert_near(toric->p, 0.7, 1e-9);
    for (int j = 0; j < maps.size; j += 3) {
      for (int i = 0; i < maps.size; i += 3) {
        if (is_inside(&maps, i, j)) {
          assert_near(map_at(&maps, "elevation_toric", i, j), 0, 1e-7);
        }
      }
    }
    placido_maps_free(&maps);
    placido_surface_free(surface);
  }
}

static placido_maps maps_with(const placido_surface *surface, placido_maps_options options) {
  placido_maps maps;
  placido_error err = {0};
  if (placido_maps_find_all(&maps, surface, NULL, &options, 0.1, &err)) {
    fail_msg("%s", err.text);
  }
  return maps;
}

static void the_reference_is_of_the_chosen_zone(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, -0.5, 0, 0);
  placido_maps narrow = maps_with(surface, (placido_maps_options){.zone_mm = 3});
  placido_maps wide = maps_of(surface);
  assert_near(narrow.sphere.zone_mm, 3, 0);
  assert_near(wide.references[PLACIDO_REFERENCE_TORIC].zone_mm, 8, 0);
  assert_true(narrow.sphere.radius_mm < wide.sphere.radius_mm - 0.05); /* it flattens outwards */
  placido_maps_free(&narrow);
  placido_maps_free(&wide);
  placido_surface_free(surface);
}

/* All rays of the perfect ellipsoid meet in its far focus, at n R/(n - 1) behind the apex: with the
 * fovea there nothing misses it, and both powers are n over the way to it. */
static void the_perfect_ellipsoid_misses_no_fovea(void **state) {
  (void)state;
  const double n = 1.376, focus = n * 7.8 / (n - 1);
  placido_surface *surface = conicoid_eye(7.8, -1 / (n * n), 0, 0);
  placido_maps maps = maps_with(surface, (placido_maps_options){.index = n, .retina_mm = focus});
  for (int j = 0; j < maps.size; j++) {
    for (int i = 0; i < maps.size; i++) {
      if (is_inside(&maps, i, j)) {
        double r = distance_of(&maps, i, j), z = maps.z_mm[j * maps.size + i] + focus;
        double power = 1000 * n / hypot(r, z);
        assert_near(map_at(&maps, "axial_refractive", i, j), power, 1e-8);
        assert_near(map_at(&maps, "instantaneous_refractive", i, j), power, 1e-8);
        assert_near(map_at(&maps, "focusing_distance", i, j), 0, 1e-8);
        assert_near(map_at(&maps, "retinal_distance", i, j), 0, 1e-9);
      }
    }
  }
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

/* A sphere by trigonometry: i the incidence, t the refraction, the ray descends at i - t. It
 * crosses the axis after r/sin(i - t), and meets its neighbour after R n cos² t/(n cos t - cos i)
 * (Coddington's equation for a distant source). */
static void a_sphere_focuses_as_coddington_says(void **state) {
  (void)state;
  const double radius = 7.8, retina = 31;
  placido_surface *surface = conicoid_eye(radius, 0, 0, 0);
  placido_maps maps = maps_with(surface, (placido_maps_options){.retina_mm = retina});
  assert_near(map_at(&maps, "axial_refractive", maps.half, maps.half), 337.5 / radius, 1e-9);
  for (int i = maps.half + 1; i < maps.size; i++) {
    double r = placido_maps_position(&maps, i), in = asin(r / radius), t = asin(r / radius / INDEX);
    double to_axis = r / sin(in - t);
    double to_focus = radius * INDEX * cos(t) * cos(t) / (INDEX * cos(t) - cos(in));
    double depth = radius * (1 - cos(in));
    double x = r - to_focus * sin(in - t), z = depth + to_focus * cos(in - t) - retina;
    assert_near(map_at(&maps, "axial_refractive", i, maps.half), 1000 * INDEX / to_axis, 1e-9);
    assert_near(map_at(&maps, "instantaneous_refractive", i, maps.half), 1000 * INDEX / to_focus,
                1e-9);
    assert_near(map_at(&maps, "focusing_distance", i, maps.half), hypot(x, z), 1e-10);
    assert_near(map_at(&maps, "retinal_distance", i, maps.half),
                fabs(r - (retina - depth) * tan(in - t)), 1e-11);
  }
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

/* An eye turned by 90 degrees gives maps turned by 90 degrees: (i, j) goes to (-j, i) about the
 * middle. */
static void a_turned_eye_has_turned_maps(void **state) {
  (void)state;
  placido_part parts[] = {
      {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.9, -0.3, 7.5, -0.1, 20, 0.1, 0.2}},
      {.kind = PLACIDO_PART_BUMP, .as.bump = {0.04, 1.25, 1, 0.5, -1.1, 15}},
      {.kind = PLACIDO_PART_RIDGE, .as.ridge = {0.003, 0.5, 0.3, 10}}};
  placido_surface *surface = eye_of(parts, 3);
  parts[0].as.biconic.axis_deg += 90;
  parts[0].as.biconic.cx = -0.2;
  parts[0].as.biconic.cy = 0.1;
  parts[1].as.bump.axis_deg += 90;
  parts[1].as.bump.x_mm = 1.1;
  parts[1].as.bump.y_mm = 0.5;
  parts[2].as.ridge.axis_deg += 90;
  placido_surface *turned_surface = eye_of(parts, 3);
  placido_maps maps = maps_of(surface), turned = maps_of(turned_surface);
  const char *const names[] = {"elevation", "axial",    "tangential",
                               "mean",      "gaussian", "refractive"};
  for (int j = 0; j < maps.size; j++) {
    for (int i = 0; i < maps.size; i++) {
      for (int k = 0; k < 6 && is_inside(&maps, i, j); k++) {
        if (i == maps.half && j == maps.half) {
          continue; /* on the axis the direction is +x by convention and does not turn */
        }
        /* slopes on the axis make axial power some 1e3 D beside it, with 1e-16 relative errors */
        assert_near(map_at(&turned, names[k], maps.size - 1 - j, i), map_at(&maps, names[k], i, j),
                    1e-8);
      }
    }
  }
  placido_maps_free(&maps);
  placido_maps_free(&turned);
  placido_surface_free(surface);
  placido_surface_free(turned_surface);
}

static void elevation_is_positive_towards_the_camera(void **state) {
  (void)state;
  placido_part parts[] = {{.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}},
                          {.kind = PLACIDO_PART_BUMP, .as.bump = {0.01, 0.3, 0.3, 1, -1, 0}}};
  placido_surface *surface = eye_of(parts, 2);
  placido_maps maps = maps_of(surface);
  /* 10 µm over 1 % of the zone hardly move the sphere */
  assert_near(map_at(&maps, "elevation", maps.half + 10, maps.half - 10), 10, 0.7);
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

static void the_sphere_floats(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.5, 0, 0.4, -0.3);
  placido_maps maps = maps_of(surface);
  assert_near(maps.sphere.x_mm, 0.4, 1e-11);
  assert_near(maps.sphere.y_mm, -0.3, 1e-11);
  assert_near(maps.sphere.radius_mm, 7.5, 1e-10);
  assert_near(maps.sphere.zone_mm, 8, 0);
  assert_near(map_at(&maps, "elevation", 20, 60), 0, 1e-9);
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

static void what_data_do_not_support_is_empty(void **state) {
  (void)state;
  const unsigned char left[19] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  placido_surface *surface = partly_covered_eye(7.8, left);
  placido_maps maps = maps_of(surface);
  size_t kinds;
  placido_map_kinds(&kinds);
  for (int j = 0; j < maps.size; j++) {
    for (int i = 0; i < maps.size; i++) {
      /* column 9 of the coverage, at x = 0, reaches to 0.25 mm */
      bool supported =
          distance_of(&maps, i, j) < 4.5 + 1e-9 && placido_maps_position(&maps, i) < 0.25;
      int index = j * maps.size + i;
      assert_int_equal(maps.valid[index], supported);
      assert_int_equal(isfinite(maps.z_mm[index]) != 0, supported);
      for (size_t k = 0; k < kinds; k++) {
        assert_int_equal(isfinite(maps.values[k][index]) != 0, supported);
      }
    }
  }
  assert_null(maps.sigma_z_um);
  assert_near(maps.sphere.radius_mm, 7.8, 1e-9); /* half a sphere tells the sphere */
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

static void nothing_supported_is_no_map(void **state) {
  (void)state;
  const unsigned char none[19] = {0};
  placido_surface *surface = partly_covered_eye(7.8, none);
  placido_maps maps;
  placido_error err = {0};
  assert_int_equal(placido_maps_new(&maps, surface, NULL, 0.1, &err), PLACIDO_QUALITY);
  assert_null(maps.values);
  assert_non_null(strstr(err.text, "no valid point"));
  assert_int_equal(placido_maps_new(&maps, surface, NULL, 0, &err), PLACIDO_INPUT);
  assert_int_equal(placido_maps_new(&maps, surface, NULL, NAN, &err), PLACIDO_INPUT);
  placido_surface_free(surface);
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  placido_maps maps;
  int status = PLACIDO_MEMORY;
  unsigned long n;
  for (n = 1; status == PLACIDO_MEMORY && n < 100; n++) {
    placido_memory_fail_at(n);
    status = placido_maps_new(&maps, surface, NULL, 0.5, NULL);
    placido_memory_fail_at(0);
    assert_true((maps.values == NULL) == (status != PLACIDO_OK));
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 8);
  placido_maps_free(&maps);
  placido_maps_free(NULL);
  placido_surface_free(surface);
}

#ifdef _OPENMP /* without it there is one thread */
static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.7, -0.3, 0.2, 0.1);
  int usual = omp_get_max_threads();
  omp_set_num_threads(1);
  placido_maps one = maps_of(surface);
  omp_set_num_threads(5);
  placido_maps five = maps_of(surface);
  omp_set_num_threads(usual);
  size_t kinds, bytes = (size_t)one.size * (size_t)one.size * sizeof(double);
  placido_map_kinds(&kinds);
  for (size_t k = 0; k < kinds; k++) {
    assert_memory_equal(one.values[k], five.values[k], bytes);
  }
  placido_maps_free(&one);
  placido_maps_free(&five);
  placido_surface_free(surface);
}
#endif

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_sphere_has_one_power_everywhere),
      cmocka_unit_test(a_conicoid_has_its_textbook_powers),
      cmocka_unit_test(a_toric_apex_has_both_curvatures),
      cmocka_unit_test(the_perfect_ellipsoid_has_one_refractive_power),
      cmocka_unit_test(a_spheres_refractive_power_follows_snell),
      cmocka_unit_test(a_conicoid_has_no_elevation_over_itself),
      cmocka_unit_test(a_toric_conicoid_has_no_elevation_over_itself),
      cmocka_unit_test(the_reference_is_of_the_chosen_zone),
      cmocka_unit_test(the_perfect_ellipsoid_misses_no_fovea),
      cmocka_unit_test(a_sphere_focuses_as_coddington_says),
      cmocka_unit_test(a_turned_eye_has_turned_maps),
      cmocka_unit_test(elevation_is_positive_towards_the_camera),
      cmocka_unit_test(the_sphere_floats),
      cmocka_unit_test(what_data_do_not_support_is_empty),
      cmocka_unit_test(nothing_supported_is_no_map),
      cmocka_unit_test(every_allocation_may_fail),
#ifdef _OPENMP
      cmocka_unit_test(threads_do_not_change_a_bit),
#endif
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
