/* What is given to others says what the surface says. */
#include "tests/exchange/cornea.h"

#include <placido/expansion.h>
#include <placido/heights.h>
#include <placido/mesh.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>

#include <cmocka.h>

#define FILE_NAME "test_export.bin"

/* The terms, taken as a surface's part, are the surface again. */
static void terms_are_a_zernike_part(void **state) {
  (void)state;
  placido_part part = {.kind = PLACIDO_PART_ZERNIKE};
  for (int j = 0; j < 45; j++) {
    part.as.zernike.coefficients_um[j] = 100.0 / (1 + j) * (j % 3 - 1);
  }
  part.as.zernike.radius_mm = 4;
  placido_surface *surface;
  placido_error err;
  assert_int_equal(placido_surface_new(&surface, 0, 4.2, &part, 1, NULL, &err), PLACIDO_OK);
  placido_expansion e;
  assert_int_equal(placido_expansion_find(&e, surface, NULL, 4, 8, &err), PLACIDO_OK);
  assert_int_equal(e.count, 45);
  for (int j = 0; j < 45; j++) {
    /* rounding of 8000 points' least squares */
    assert_true(fabs(e.coefficients_um[j] - part.as.zernike.coefficients_um[j]) < 1e-8);
    assert_true(isnan(e.sigma_um[j]));
  }
  assert_true(e.rms_um < 1e-8);
  placido_surface_free(surface);
}

/* On another radius the terms differ and the surface does not. */
static void any_radius_gives_the_same_sag(void **state) {
  (void)state;
  placido_surface *truth = make_cornea(5);
  placido_error err;
  for (int i = 0; i < 3; i++) {
    double radius = 1.5 + 1.5 * i;
    placido_expansion e;
    placido_surface *again;
    assert_int_equal(placido_expansion_find(&e, truth, NULL, radius, 15, &err), PLACIDO_OK);
    placido_part part = {.kind = PLACIDO_PART_ZERNIKE, .as.zernike.radius_mm = e.radius_mm};
    memcpy(part.as.zernike.coefficients_um, e.coefficients_um, sizeof e.coefficients_um);
    assert_int_equal(placido_surface_new(&again, e.vertex_z_mm, radius, &part, 1, NULL, &err),
                     PLACIDO_OK);
    for (int k = 0; k < 50; k++) {
      double r = radius * 0.98 * sqrt(k / 50.0), a = 2.4 * k;
      placido_jet one, other;
      placido_surface_at(truth, r * cos(a), r * sin(a), &one);
      placido_surface_at(again, r * cos(a), r * sin(a), &other);
      /* order 15 leaves nanometres of a cone 1 mm wide on a 4.5 mm disc */
      assert_true(fabs(one.sag - other.sag) < 2e-5);
    }
    placido_surface_free(again);
  }
  placido_surface_free(truth);
}

/* A lift and a tilt of the whole surface move the first three terms and no other. */
static void sigma_is_what_the_variants_change(void **state) {
  (void)state;
  placido_surface *truth = make_cornea(4.5);
  placido_height heights[5000];
  size_t count = 0;
  for (int i = 0; i < 60 * 60; i++) {
    double x = (i % 60) * 0.13 - 3.8, y = (i / 60) * 0.13 - 3.8;
    placido_jet jet;
    if (hypot(x, y) < 3.8 && placido_surface_at(truth, x, y, &jet)) {
      heights[count++] = (placido_height){x, y, -jet.sag + 5e-4 * sin(37.0 * i * i)};
    }
  }
  placido_fit *fit;
  placido_heights_summary summary;
  placido_error err;
  placido_expansion e;
  assert_int_equal(placido_heights_fit(&fit, &summary, heights, count, 0, &err), PLACIDO_OK);
  assert_int_equal(placido_expansion_find(&e, placido_fit_surface(fit), fit, 3, 4, &err),
                   PLACIDO_OK);
  for (int j = 0; j < e.count; j++) {
    /* 0.35 um of noise on some 1700 points of the disc: each term to about 0.01 um */
    assert_true(e.sigma_um[j] > 0.003 && e.sigma_um[j] < 0.05);
  }
  placido_fit_free(fit);
  placido_surface_free(truth);
}

static void a_disc_without_data_is_refused(void **state) {
  (void)state;
  unsigned char mask[41 * 41];
  for (int i = 0; i < 41 * 41; i++) {
    mask[i] = i / 41 < 24; /* up to y = 0.75 mm */
  }
  const placido_coverage coverage = {-4, -4, 0.2, 41, 41, mask};
  const placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}};
  placido_surface *surface;
  placido_expansion e;
  placido_error err;
  assert_int_equal(placido_surface_new(&surface, 0, 4, &part, 1, &coverage, &err), PLACIDO_OK);
  assert_int_equal(placido_expansion_find(&e, surface, NULL, 3, 6, &err), PLACIDO_QUALITY);
  assert_non_null(strstr(err.text, "all of it up to 0.6"));
  assert_int_equal(placido_expansion_find(&e, surface, NULL, 5, 6, &err), PLACIDO_INPUT);
  assert_int_equal(placido_expansion_find(&e, surface, NULL, 0, 2, &err), PLACIDO_OK);
  assert_true(e.radius_mm > 0.6 && e.radius_mm < 0.75);
  placido_surface_free(surface);
}

static int compare_edges(const void *a, const void *b) {
  return memcmp(a, b, 2 * sizeof(unsigned));
}

/* Every edge of a closed mesh is walked once each way; of an open one at most. */
static void check_edges(const placido_mesh *mesh, bool closed) {
  size_t count = 3 * mesh->triangle_count;
  unsigned(*edges)[2] = calloc(count, sizeof *edges);
  assert_non_null(edges);
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    for (int k = 0; k < 3; k++) {
      edges[3 * i + (size_t)k][0] = mesh->triangles[i][k];
      edges[3 * i + (size_t)k][1] = mesh->triangles[i][(k + 1) % 3];
    }
  }
  qsort(edges, count, sizeof *edges, compare_edges);
  for (size_t i = 0; i < count; i++) {
    const unsigned back[2] = {edges[i][1], edges[i][0]};
    assert_true(i == 0 || compare_edges(edges[i - 1], edges[i]) != 0);
    assert_true(!closed || bsearch(back, edges, count, sizeof *edges, compare_edges) != NULL);
  }
  free(edges);
}

/* Six times the volume that the triangles enclose, positive where they look outwards. */
static double volume_mm3(const placido_mesh *mesh) {
  double sum = 0;
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    const double *a = mesh->vertices_mm[mesh->triangles[i][0]];
    const double *b = mesh->vertices_mm[mesh->triangles[i][1]];
    const double *c = mesh->vertices_mm[mesh->triangles[i][2]];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

/* Cells that touch by a corner alone are among them. */
static placido_surface *make_ragged(void) {
  static unsigned char mask[81 * 81];
  uint32_t random = 7;
  for (int i = 0; i < 81 * 81; i++) {
    random = random * 1664525u + 1013904223u;
    mask[i] = random >> 24 > 20;
  }
  const placido_coverage coverage = {-4, -4, 0.1, 81, 81, mask};
  const placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}};
  placido_surface *surface;
  assert_int_equal(placido_surface_new(&surface, 0, 4, &part, 1, &coverage, NULL), PLACIDO_OK);
  return surface;
}

static void a_solid_mesh_is_watertight(void **state) {
  (void)state;
  placido_surface *whole = make_cornea(4), *ragged = make_ragged();
  placido_mesh mesh;
  placido_error err;
  assert_int_equal(placido_mesh_new(&mesh, whole, 0.1, 1, &err), PLACIDO_OK);
  check_edges(&mesh, true);
  double volume = volume_mm3(&mesh), top = -INFINITY, bottom = INFINITY;
  for (size_t i = 0; i < mesh.vertex_count; i++) {
    top = fmax(top, mesh.vertices_mm[i][2]);
    bottom = fmin(bottom, mesh.vertices_mm[i][2]);
  }
  /* a cap of height h on a disc of radius 4 holds about half of its cylinder; 1 mm is below it */
  double h = top - bottom - 1, area = 3.14159265 * 16;
  assert_true(fabs(volume - area * (1 + h / 2)) < 0.03 * volume);
  placido_mesh_free(&mesh);
  assert_int_equal(placido_mesh_new(&mesh, ragged, 0.1, 0.5, &err), PLACIDO_OK);
  check_edges(&mesh, true);
  placido_mesh_free(&mesh);
  assert_int_equal(placido_mesh_new(&mesh, ragged, 0.1, 0, &err), PLACIDO_OK);
  check_edges(&mesh, false);
  placido_mesh_free(&mesh);
  placido_surface_free(whole);
  placido_surface_free(ragged);
}

static unsigned char *read_all(size_t *size) {
  FILE *file = fopen(FILE_NAME, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  *size = (size_t)ftell(file);
  rewind(file);
  unsigned char *bytes = malloc(*size + 1);
  assert_non_null(bytes);
  assert_int_equal(fread(bytes, 1, *size, file), *size);
  bytes[*size] = 0;
  fclose(file);
  return bytes;
}

static uint32_t integer_at(const unsigned char *at) {
  return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static float real_at(const unsigned char *at) {
  uint32_t bits = integer_at(at);
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static void stl_normals_look_to_the_camera(void **state) {
  (void)state;
  placido_surface *surface = make_cornea(4);
  placido_mesh mesh;
  placido_error err;
  size_t size;
  assert_int_equal(placido_mesh_new(&mesh, surface, 0.2, 0, &err), PLACIDO_OK);
  assert_int_equal(placido_mesh_save_stl(&mesh, FILE_NAME, &err), PLACIDO_OK);
  unsigned char *bytes = read_all(&size);
  assert_int_equal(size, 84 + 50 * mesh.triangle_count);
  assert_int_equal(integer_at(bytes + 80), mesh.triangle_count);
  assert_true(strncmp((char *)bytes, "solid", 5) != 0);
  for (size_t i = 0; i < mesh.triangle_count; i++) {
    const unsigned char *at = bytes + 84 + 50 * i;
    double x = real_at(at), y = real_at(at + 4), z = real_at(at + 8);
    assert_true(z > 0.7);
    assert_true(fabs(x * x + y * y + z * z - 1) < 1e-6); /* single precision */
  }
  free(bytes);
  placido_mesh_free(&mesh);
  placido_surface_free(surface);
}

static void ply_holds_every_vertex_with_its_power(void **state) {
  (void)state;
  const placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}};
  placido_surface *surface;
  placido_mesh mesh;
  placido_error err;
  size_t size;
  assert_int_equal(placido_surface_new(&surface, 0, 4, &part, 1, NULL, &err), PLACIDO_OK);
  assert_int_equal(placido_mesh_new(&mesh, surface, 0.2, 0, &err), PLACIDO_OK);
  assert_int_equal(placido_mesh_save_ply(&mesh, FILE_NAME, &err), PLACIDO_OK);
  unsigned char *bytes = read_all(&size);
  const char *end = strstr((char *)bytes, "end_header\n");
  assert_non_null(end);
  const unsigned char *at = (const unsigned char *)end + strlen("end_header\n");
  assert_int_equal(size, (size_t)(at - bytes) + 19 * mesh.vertex_count + 13 * mesh.triangle_count);
  for (size_t i = 0; i < mesh.vertex_count; i++, at += 19) {
    assert_true(fabs(real_at(at) - mesh.vertices_mm[i][0]) < 1e-6);
    /* a sphere has one axial power everywhere */
    assert_true(fabs(real_at(at + 12) - 337.5 / 7.8) < 1e-4);
  }
  for (size_t i = 0; i < mesh.triangle_count; i++, at += 13) {
    assert_int_equal(at[0], 3);
    assert_true(integer_at(at + 1) < mesh.vertex_count);
  }
  free(bytes);
  placido_mesh_free(&mesh);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(terms_are_a_zernike_part),
      cmocka_unit_test(any_radius_gives_the_same_sag),
      cmocka_unit_test(sigma_is_what_the_variants_change),
      cmocka_unit_test(a_disc_without_data_is_refused),
      cmocka_unit_test(a_solid_mesh_is_watertight),
      cmocka_unit_test(stl_normals_look_to_the_camera),
      cmocka_unit_test(ply_holds_every_vertex_with_its_power),
  };
  int failed = cmocka_run_group_tests(tests, NULL, NULL);
  remove(FILE_NAME);
  return failed;
}
