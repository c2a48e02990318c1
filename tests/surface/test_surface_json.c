/* Surface files: what is written reads back bit for bit, and a bad file is refused by file, line
 * and field. */
#include "base/memory.h"
#include "tests/support/near.h"

#include <placido/surface.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char directory[] = "/tmp/placido-surface-XXXXXX";
static char file_path[sizeof directory + 32];

static int make_directory(void **state) {
  (void)state;
  if (!mkdtemp(directory)) {
    return -1;
  }
  snprintf(file_path, sizeof file_path, "%s/surface.json", directory);
  return 0;
}

static int remove_directory(void **state) {
  (void)state;
  unlink(file_path);
  return rmdir(directory);
}

static void write_text(const char *text) {
  FILE *file = fopen(file_path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
}

static placido_surface *load(const char *text, placido_notes *notes) {
  placido_surface *surface;
  placido_error err = {0};
  write_text(text);
  if (placido_surface_load(&surface, file_path, notes, &err)) {
    fail_msg("%s", err.text);
  }
  return surface;
}

static double sag_at(const placido_surface *surface, double x, double y) {
  placido_jet jet;
  assert_true(placido_surface_at(surface, x, y, &jet));
  return jet.sag;
}

#define HEAD "{\"format\": \"placido-surface/1\", \"parts\": [\n"

static void what_is_missing_has_defaults(void **state) {
  (void)state;
  placido_surface *surface = load(HEAD "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0}]}", NULL);
  assert_near(placido_surface_vertex_z_mm(surface), 0, 0);
  assert_near(placido_surface_radius_mm(surface), 4.5, 0);
  assert_near(sag_at(surface, 0, 3), 7.8 - sqrt(7.8 * 7.8 - 9), 1e-14);
  assert_true(placido_surface_covered(surface, 4.4, 0));
  placido_surface_free(surface);
}

static void an_ablation_has_the_corneas_index(void **state) {
  (void)state;
  const char *form = HEAD "{\"kind\": \"ablation\", \"dioptres\": 5, \"zone_mm\": 6, "
                          "\"blend_mm\": 1.5, \"r0\": 7.72%s}]}";
  char text[256];
  snprintf(text, sizeof text, form, "");
  placido_surface *surface = load(text, NULL);
  double sag = sag_at(surface, 1, 1);
  placido_surface_free(surface);
  snprintf(text, sizeof text, form, ", \"n\": 1.376, \"cx\": 0, \"cy\": 0");
  surface = load(text, NULL);
  assert_near(sag_at(surface, 1, 1), sag, 0);
  placido_surface_free(surface);
}

static void unknown_keys_are_one_warning(void **state) {
  (void)state;
  placido_notes notes = {0};
  placido_surface *surface = load(
      HEAD "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0, \"colour\": 1, \"r3\": 2}]}", &notes);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "surface.json:2: "));
  assert_non_null(strstr(notes.lines[0], "colour, r3"));
  placido_notes_clear(&notes);
  placido_surface_free(surface);
}

/* One part of every kind, with numbers that no short decimal gives. */
static placido_surface *make_everything(void) {
  static const double knots[] = {-6.1, -6.1, -6.1, -6.1, 1.0 / 3, 6.1, 6.1, 6.1, 6.1};
  double coefficients[25];
  for (int i = 0; i < 25; i++) {
    coefficients[i] = sin(i) / 30;
  }
  placido_part parts[] = {
      {.kind = PLACIDO_PART_BICONIC,
       .as.biconic = {7.7 + 1e-15, -0.1 * 3, 7.5, 0.7 / 3, 1 / 3., 0.1, 0.2}},
      {.kind = PLACIDO_PART_BUMP, .as.bump = {0.04, 1.25, 1.1, 0.5, -1.1, 15}},
      {.kind = PLACIDO_PART_ABLATION, .as.ablation = {5, 6, 1.5, 7.72, 1.376, 0.2, 0.1}},
      {.kind = PLACIDO_PART_ZERNIKE, .as.zernike.radius_mm = 4.2},
      {.kind = PLACIDO_PART_RIDGE, .as.ridge = {0.008, 0.12, 0.3, 25}},
      {.kind = PLACIDO_PART_BSPLINE, .as.bspline = {3, 5, 5, knots, knots, coefficients}}};
  parts[3].as.zernike.coefficients_um[7] = -2.5;
  parts[3].as.zernike.coefficients_um[135] = 1e-3 / 3;
  const unsigned char mask[] = {1, 1, 0, 0, 1, 1};
  placido_coverage coverage = {-1.0 / 3, -2, 2.0 / 3, 2, 3, mask};
  placido_surface *surface;
  placido_error err = {0};
  if (placido_surface_new(&surface, 0.1, 5.0 - 1e-15, parts, 6, &coverage, &err)) {
    fail_msg("%s", err.text);
  }
  return surface;
}

static void what_is_written_reads_back_bit_for_bit(void **state) {
  (void)state;
  placido_surface *surface = make_everything(), *again;
  placido_notes notes = {0};
  assert_int_equal(placido_surface_save(surface, file_path, NULL), PLACIDO_OK);
  assert_int_equal(placido_surface_load(&again, file_path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 0);
  assert_true(placido_surface_radius_mm(again) == placido_surface_radius_mm(surface));
  for (double y = -4; y <= 4; y += 0.31) {
    for (double x = -2.9; x <= 2.9; x += 0.37) {
      placido_jet a, b;
      assert_true(placido_surface_at(surface, x, y, &a));
      assert_true(placido_surface_at(again, x, y, &b));
      assert_memory_equal(&a, &b, sizeof a);
      assert_int_equal(placido_surface_covered(surface, x, y),
                       placido_surface_covered(again, x, y));
    }
  }
  placido_surface_free(surface);
  placido_surface_free(again);
}

static void a_grid_covers_by_the_nearest_cell(void **state) {
  (void)state;
  placido_surface *surface = load(
      HEAD "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0}], \"coverage\": {\"kind\": \"grid\", "
           "\"x0_mm\": -1, \"y0_mm\": 0, \"step_mm\": 1, \"mask\": [\"100\", \"011\"]}}",
      NULL);
  assert_true(placido_surface_covered(surface, -1.4, 0.4)); /* the first string is the lowest row */
  assert_false(placido_surface_covered(surface, -0.4, 0.4));
  assert_false(placido_surface_covered(surface, -1, 1));
  assert_true(placido_surface_covered(surface, 1.4, 1.4));
  assert_false(placido_surface_covered(surface, 1.6, 1)); /* beyond the grid */
  placido_surface_free(surface);
}

static void a_polygon_covers_its_inside(void **state) {
  (void)state;
  placido_surface *surface = load(
      HEAD "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0}], \"coverage\": {\"kind\": "
           "\"polygon\", \"points_mm\": [[-2, -2], [3, -2], [3, 0], [0, 0], [0, 2], [-2, 2]]}}",
      NULL);
  const double inside[][2] = {{-1.9, -1.9}, {2.9, -0.1}, {-0.1, 1.9}, {0, -1}};
  const double outside[][2] = {{0.1, 0.1}, {-2.1, 0}, {3.1, -1}, {-1, 2.1}, {1, 1}};
  for (size_t i = 0; i < sizeof inside / sizeof inside[0]; i++) {
    assert_true(placido_surface_covered(surface, inside[i][0], inside[i][1]));
  }
  for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
    assert_false(placido_surface_covered(surface, outside[i][0], outside[i][1]));
  }
  placido_surface_free(surface);
}

#define SPLINE "{\"kind\": \"bspline\", \"degree\": 2,\n\"knots_x_mm\": [-5, -5, -5, 5, 5, 5],\n"
#define NINE "[0, 0, 0, 0, 0, 0, 0, 0, 0]"

static const struct {
  const char *text;
  const char *message; /* what the error says, from the file's name on */
} bad[] = {
    {"{\"format\": \"placido-surface/2\"}",
     "surface.json:1: field format: unknown version \"placido-surface/2\""},
    {"{\"format\": \"placido-instrument/1\"}", "surface.json:1: field format: unknown format"},
    {"{\"format\": \"placido-surface/1\"}", "surface.json:1: field parts: missing"},
    {HEAD "]}", "surface.json:1: field parts: an array of 1 to 256 parts"},
    {HEAD "{\"kind\": \"cone\"}]}",
     "surface.json:2: field parts[0].kind: unknown kind \"cone\" (known: biconic, bump, ablation, "
     "zernike, ridge, bspline)"},
    {HEAD "{\"kind\": \"biconic\",\n\"q1\": 0}]}", "surface.json:2: field parts[0].r1: missing"},
    {HEAD "{\"kind\": \"biconic\",\n\"r1\": 0, \"q1\": 0}]}",
     "surface.json:3: field parts[0].r1: is 0"},
    {HEAD "{\"kind\": \"biconic\", \"q1\": 0,\n\"r1\": \"7.8\"}]}",
     "surface.json:3: field parts[0].r1: is a string"},
    {HEAD "{\"kind\": \"biconic\", \"q1\": 0, \"r1\": 7.8, \n\n\"cx\": null}]}",
     "surface.json:4: field parts[0].cx: is null"},
    {HEAD
     "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0},\n{\"kind\": \"bump\", \"height_mm\": 0.1, "
     "\"sigma_x_mm\": 1,\n\"sigma_y_mm\": -1, \"x_mm\": 0, \"y_mm\": 0}]}",
     "surface.json:4: field parts[1].sigma_y_mm: is -1, a number greater than 0"},
    {HEAD
     "{\"kind\": \"ablation\", \"dioptres\": 5, \"zone_mm\": 6, \"blend_mm\": 1.5,\n\"r0\": 2.5}]}",
     "surface.json:3: field parts[0].r0: is 2.5 mm, more than half of zone_mm"},
    {HEAD "{\"kind\": \"ablation\",\n\"dioptres\": 60, \"zone_mm\": 6, \"blend_mm\": 1.5, \"r0\": "
          "7.8}]}",
     "surface.json:3: field parts[0].dioptres: of 60 leaves"},
    {HEAD
     "{\"kind\": \"zernike\", \"radius_mm\": 4, \"coefficients_um\": {\"6\": 1,\n\"136\": 1}}]}",
     "surface.json:3: field parts[0].coefficients_um.136: not an OSA index from 0 to 135"},
    {HEAD "{\"kind\": \"zernike\", \"radius_mm\": 4,\n\"coefficients_um\": [1, 2]}]}",
     "surface.json:3: field parts[0].coefficients_um: missing or not an object"},
    {HEAD "{\"kind\": \"ridge\", \"slope\": 0.01,\n\"width_mm\": 0, \"offset_mm\": 0}]}",
     "surface.json:3: field parts[0].width_mm: is 0"},
    {HEAD SPLINE "\"knots_y_mm\": [-5, -5, -5, 5, 4, 5], \"coefficients_mm\": " NINE "}]}",
     "surface.json:4: field parts[0].knots_y_mm[4]: 4 is less than the knot before it, 5"},
    {HEAD SPLINE
     "\"knots_y_mm\": [-5, -5, -5, -5, 5, 5, 5], \"coefficients_mm\": [0,0,0,0,0,0,0,0,0,0,0,0]}]}",
     "surface.json:4: field parts[0].knots_y_mm[3]: stands more than 2 times"},
    {HEAD SPLINE "\"knots_y_mm\": [-5, -5, 5, 5, 5],\n\"coefficients_mm\": " NINE "}]}",
     "surface.json:4: field parts[0].knots_y_mm: make 2 coefficients along the axis"},
    {HEAD SPLINE "\"knots_y_mm\": [-5, -5, -5, 5, 5, 5],\n\"coefficients_mm\": [0, 1]}]}",
     "surface.json:5: field parts[0].coefficients_mm: has 2 elements, 9 numbers are expected"},
    {HEAD "{\"kind\": \"bspline\",\n\"degree\": 6}]}",
     "surface.json:3: field parts[0].degree: is 6, an integer from 2 to 5"},
    {HEAD "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0}],\n\"radius_mm\": 0}",
     "surface.json:3: field radius_mm: is 0, more than 0"},
    {HEAD "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0}],\n\"coverage\": {\"kind\": \"disc\"}}",
     "surface.json:3: field coverage.kind: unknown kind \"disc\" (known: grid, polygon)"},
    {HEAD "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0}],\n\"coverage\": {\"kind\": \"grid\", "
          "\"x0_mm\": 0, \"y0_mm\": 0, \"step_mm\": 1, \"mask\": [\"01\",\n\"012\"]}}",
     "surface.json:4: field coverage.mask[1]: a string of zeros and ones"},
    {HEAD
     "{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": 0}],\n\"coverage\": {\"kind\": \"polygon\", "
     "\"points_mm\": [[0, 0], [1, 1]]}}",
     "surface.json:3: field coverage.points_mm: has 2 points, 3 to 10000"},
};

static void bad_files_are_refused_by_place(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    placido_surface *surface;
    placido_error err = {0};
    write_text(bad[i].text);
    assert_int_equal(placido_surface_load(&surface, file_path, NULL, &err), PLACIDO_INPUT);
    assert_null(surface);
    if (!strstr(err.text, bad[i].message)) {
      fail_msg("file %zu: \"%s\" does not say \"%s\"", i, err.text, bad[i].message);
    }
  }
}

static void absurd_parts_are_refused(void **state) {
  (void)state;
  placido_surface *surface;
  placido_error err = {0};
  placido_part part = {.kind = PLACIDO_PART_BICONIC, .as.biconic = {7.8, NAN, 7.8, 0, 0, 0, 0}};
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, &part, 1, NULL, &err), PLACIDO_INPUT);
  assert_null(surface);
  assert_non_null(strstr(err.text, "part 0 (biconic): q1: is nan"));
  part.kind = (enum placido_part_kind)77;
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, &part, 1, NULL, &err), PLACIDO_INPUT);
  assert_int_equal(placido_surface_new(&surface, 0, NAN, &part, 1, NULL, &err), PLACIDO_INPUT);
  assert_int_equal(placido_surface_new(&surface, 0, 4.5, &part, 0, NULL, &err), PLACIDO_INPUT);
}

/* Whichever allocation fails, loading says so and nothing leaks (the sanitizer counts). */
static void every_allocation_may_fail(void **state) {
  (void)state;
  placido_surface *surface = make_everything();
  assert_int_equal(placido_surface_save(surface, file_path, NULL), PLACIDO_OK);
  placido_surface_free(surface);
  int status = PLACIDO_MEMORY;
  unsigned long n;
  for (n = 1; status == PLACIDO_MEMORY && n < 1000; n++) {
    placido_error err = {0};
    placido_memory_fail_at(n);
    status = placido_surface_load(&surface, file_path, NULL, &err);
    placido_memory_fail_at(0);
    assert_int_equal(err.status, status);
    assert_true((surface == NULL) == (status != PLACIDO_OK));
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_true(n > 20);
  placido_surface_free(surface);
  placido_surface_free(NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_missing_has_defaults),
      cmocka_unit_test(an_ablation_has_the_corneas_index),
      cmocka_unit_test(unknown_keys_are_one_warning),
      cmocka_unit_test(what_is_written_reads_back_bit_for_bit),
      cmocka_unit_test(a_grid_covers_by_the_nearest_cell),
      cmocka_unit_test(a_polygon_covers_its_inside),
      cmocka_unit_test(bad_files_are_refused_by_place),
      cmocka_unit_test(absurd_parts_are_refused),
      cmocka_unit_test(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
