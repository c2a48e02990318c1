/* report.html: whole, self-contained, and safe whatever stands in the strings. */
#include "base/file.h"
#include "base/memory.h"
#include "tests/base/scratch.h"
#include "tests/report/fabricate.h"

#include <placido/image.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Writes the report into the scratch directory and returns its text; free with
 * placido_memory_free. */
static char *write_report(void **state, placido_report *report) {
  char *folder = scratch_path(state, ""), *path = scratch_path(state, "report.html");
  placido_error err = {0};
  report->directory = folder;
  assert_int_equal(placido_report_write(report, &err), PLACIDO_OK);
  char *text;
  size_t size;
  assert_int_equal(placido_file_read(&text, &size, path, 0, &err), PLACIDO_OK);
  assert_int_equal(strlen(text), size);
  free(path);
  free(folder);
  return text;
}

static size_t count(const char *text, const char *word) {
  size_t found = 0;
  for (const char *at = strstr(text, word); at != NULL; at = strstr(at + 1, word)) {
    found++;
  }
  return found;
}

/* A tiny picture in the scratch directory. */
static void make_picture(void **state, const char *name) {
  char *path = scratch_path(state, name);
  placido_frame frame = fabricate_frame(3, 2, PLACIDO_RGB8);
  assert_int_equal(placido_frame_save_png(&frame, path, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  free(path);
}

static void hostile_strings_stay_strings(void **state) {
  static const char hostile[] = "<script>alert(1)</script>&\"'\x01\xff";
  static const char safe[] = "&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;&#39; \xef\xbf\xbd";
  char *lines[] = {(char *)(uintptr_t)hostile};
  placido_notes notes = {1, lines};
  placido_index_value index = {
      .name = hostile, .unit = hostile, .help = hostile, .value = 1, .sigma = NAN};
  placido_stage stage = {hostile, 1};
  make_picture(state, "a.png");
  const placido_report_map map = {"a.png", hostile, PLACIDO_PLACE_MAIN};
  placido_psf psf = fabricate_psf(3);
  const char *scene_pictures[] = {"a.png"}, *scene_names[] = {hostile};
  placido_report_pupil pupil = {.psf = &psf,
                                .psf_picture = "a.png",
                                .scene_names = scene_names,
                                .scene_pictures = scene_pictures,
                                .scene_count = 1,
                                .scene_arcmin_per_px = 0.5};
  placido_report report = {.input = hostile,
                           .eye = hostile,
                           .instrument_name = hostile,
                           .software = hostile,
                           .created = hostile,
                           .maps = &map,
                           .map_count = 1,
                           .indices = &index,
                           .index_count = 1,
                           .pupils = &pupil,
                           .pupil_count = 1,
                           .stages = &stage,
                           .stage_count = 1,
                           .notes = &notes};
  char *text = write_report(state, &report);
  assert_null(strstr(text, "<script"));
  assert_null(strstr(text, "alert(1)</"));
  /* title, 5 in the head, note, 3 of the index, stage, caption and alt of the map, of the scene */
  assert_int_equal(count(text, safe), 15);
  placido_memory_free(text);
  free(psf.values);
}

static void utf8_stays_as_it_is_and_the_broken_is_replaced(void **state) {
  placido_report report = {.input = "Müller ′ 角膜 \xf0\x9f\x91\x81", .eye = "a\xc3(b\xe2\x82"};
  char *text = write_report(state, &report);
  assert_non_null(strstr(text, "<td>Müller ′ 角膜 \xf0\x9f\x91\x81</td>"));
  assert_non_null(strstr(text, "<td>a\xef\xbf\xbd(b\xef\xbf\xbd\xef\xbf\xbd</td>"));
  placido_memory_free(text);
}

static void what_is_missing_leaves_no_heading(void **state) {
  placido_notes notes = {0};
  placido_report report = {.input = "x", .notes = &notes};
  char *text = write_report(state, &report);
  assert_int_equal(count(text, "<h1>"), 1);
  assert_int_equal(count(text, "<h2>"), 0);
  assert_int_equal(count(text, "<section"), 0);
  assert_int_equal(count(text, "class=\"banner\""), 0);
  assert_int_equal(count(text, "<th"), 1); /* the input's name */
  assert_non_null(strstr(text, "Not a medical device"));
  placido_memory_free(text);
}

static void nominal_geometry_is_announced(void **state) {
  placido_report report = {.instrument_name = "cone", .calibrated = false};
  char *text = write_report(state, &report);
  assert_non_null(strstr(text, "NOMINAL GEOMETRY"));
  placido_memory_free(text);
  report.calibrated = true;
  text = write_report(state, &report);
  assert_null(strstr(text, "NOMINAL GEOMETRY"));
  placido_memory_free(text);
}

static void figures_are_shown_with_their_errors(void **state) {
  placido_index_value indices[] = {
      {.name = "simk_flat_D", .unit = "D", .help = "h", .value = 43.2712, .sigma = 0.021},
      {.name = "KISA", .unit = "%", .help = "h", .value = NAN, .sigma = NAN}};
  placido_mires mires = {
      .edge_count = 48, .meridian_count = 180, .count = 8300, .coverage = 0.961, .contrast = 0.42};
  placido_fit_summary fit = {.rms_px = 0.0312,
                             .sigma_px = 0.028,
                             .points = 8300,
                             .points_used = 8211,
                             .steps = 9,
                             .knot_mm = 0.5,
                             .radius_mm = 4.6};
  placido_report report = {.indices = indices,
                           .index_count = 2,
                           .mires = &mires,
                           .fit = &fit,
                           .axis_z_mm = 0.0123,
                           .axis_z_sigma_mm = 0.05};
  char *text = write_report(state, &report);
  assert_non_null(strstr(text, ">SimK flat</th>"));
  assert_non_null(strstr(text, "43.271 ± 0.021"));
  assert_non_null(strstr(text, "<td class=\"number\">–</td>"));
  assert_non_null(strstr(text, "8300, 96.1 % of 48 edges on 180 meridians"));
  assert_non_null(strstr(text, "8211 of 8300"));
  assert_non_null(strstr(text, "0.031 px rms"));
  assert_non_null(strstr(text, "0.012 ± 0.050 mm"));
  placido_memory_free(text);
}

/* Groups in the page's order whatever the order of the indices, and why a value is missing. */
static void indices_stand_in_groups(void **state) {
  placido_index_value indices[] = {
      {.name = "kisa_percent", .unit = "%", .help = "h", .value = NAN, .sigma = NAN,
       .reason = "not_covered"},
      {.name = "simk_flat_D", .unit = "D", .help = "h", .value = 43, .sigma = 0.1},
      {.name = "something_new", .unit = "", .help = "h", .value = 1, .sigma = NAN}};
  placido_report report = {.indices = indices, .index_count = 3};
  char *text = write_report(state, &report);
  const char *first = strstr(text, "Keratometry"), *second = strstr(text, "Keratoconus");
  const char *last = strstr(text, "Others");
  assert_true(first != NULL && second > first && last > second);
  assert_int_equal(count(text, "rowgroup"), 3);
  assert_non_null(strstr(text, ">KISA</th>"));
  assert_non_null(strstr(text, "Not given: not covered."));
  assert_non_null(strstr(text, ">Something new</th>"));
  placido_memory_free(text);
}

static void the_error_budget_adds_up(void **state) {
  const placido_sigma budget[PLACIDO_SIGMA_SOURCES] = {
      [PLACIDO_SIGMA_NOISE] = {0.03, 0.003},
      [PLACIDO_SIGMA_DISTANCE] = {0.4, 0.04},
      [PLACIDO_SIGMA_GEOMETRY] = {NAN, NAN}};
  placido_report report = {.budget = budget, .budget_zone_mm = 6};
  char *text = write_report(state, &report);
  assert_non_null(strstr(text, "Error budget"));
  assert_non_null(strstr(text, "<td class=\"number\">–</td>")); /* unknown is not zero */
  assert_non_null(strstr(text, "All that is known</th><td class=\"number\">0.40</td>"));
  placido_memory_free(text);
}

static void what_was_promised_stands_beside_what_was_found(void **state) {
  const placido_report_accuracy accuracy = {.elevation_um = {0.5, 0.081, 0.19},
                                            .psf = {NAN, NAN, NAN},
                                            .time_ms = {NAN, 812, 790},
                                            .settings = "Settings chosen: <knots>",
                                            .table = "By your table."};
  placido_report report = {.accuracy = &accuracy};
  char *text = write_report(state, &report);
  assert_non_null(strstr(text, "<h2>Accuracy</h2>"));
  assert_non_null(strstr(text, "<td class=\"number\">0.50</td><td class=\"number\">0.081</td>"
                               "<td class=\"number\">0.19</td>"));
  assert_non_null(strstr(text, "<td class=\"number\">–</td><td class=\"number\">812</td>"));
  assert_null(strstr(text, "Transfer function")); /* neither asked for nor promised */
  assert_non_null(strstr(text, "&lt;knots&gt;"));
  placido_memory_free(text);
}

static void the_wavefront_has_a_column_a_pupil(void **state) {
  size_t figure_count;
  placido_wavefront_figures(&figure_count);
  double figures[32] = {0}, sigmas[32] = {0};
  assert_true(figure_count <= 32);
  figures[0] = 1.234;
  sigmas[0] = 0.01;
  make_picture(state, "a.png");
  const placido_wavefront small = {.eye.pupil_mm = 3}, large = {.eye.pupil_mm = 6};
  const placido_report_wavefront wavefronts[] = {{&small, figures, sigmas, "a.png"},
                                                 {&large, figures, NULL, "a.png"}};
  placido_report report = {.wavefronts = wavefronts, .wavefront_count = 2};
  char *text = write_report(state, &report);
  assert_non_null(strstr(text, "Corneal wavefront"));
  assert_non_null(strstr(text, "6 mm ± 1 σ"));
  assert_non_null(strstr(text, ">RMS total</th><td class=\"number\">1.234 ± 0.010</td>"
                               "<td class=\"number\">1.234</td>"));
  assert_int_equal(count(text, "src=\"data:image/png"), 2);
  placido_memory_free(text);
}

static void pictures_are_embedded_and_nothing_else_is_referred_to(void **state) {
  make_picture(state, "a.png");
  const char *pictures[] = {"a.png", "a.png"};
  const placido_report_map maps[] = {{"a.png", "one", PLACIDO_PLACE_MAIN},
                                     {"a.png", "two", PLACIDO_PLACE_UNCERTAINTY}};
  placido_psf psf = fabricate_psf(3);
  const char *names[] = {"tumbling-e", "fan"};
  placido_report_pupil pupil = {.psf = &psf,
                                .psf_picture = "a.png",
                                .scene_names = names,
                                .scene_pictures = pictures,
                                .scene_count = 2,
                                .scene_arcmin_per_px = 20};
  placido_report report = {.capture_picture = "a.png",
                           .mires_picture = "a.png",
                           .maps = maps,
                           .map_count = 2,
                           .pupils = &pupil,
                           .pupil_count = 1};
  char *text = write_report(state, &report);
  assert_int_equal(count(text, "<img width=\"3\" height=\"2\" alt=\""), 7);
  assert_int_equal(count(text, "src=\"data:image/png;base64,iVBORw0KGgo"), 7);
  assert_int_equal(count(text, "src="), 7);
  assert_int_equal(count(text, "href="), 0);
  assert_int_equal(count(text, "url("), 0);
  assert_int_equal(count(text, "http:"), 0);
  assert_int_equal(count(text, "https:"), 0);
  assert_int_equal(count(text, "<figure>"), count(text, "</figure>"));
  assert_int_equal(count(text, "<section"), count(text, "</section>"));
  assert_non_null(strstr(text, "tumbling-e: 20′ per pixel, 1° × 0.667°"));
  placido_memory_free(text);
  free(psf.values);
}

/* The bytes between the base64 mark and the quote decode to the file. */
static void the_embedded_picture_is_the_file(void **state) {
  make_picture(state, "a.png");
  placido_report report = {.capture_picture = "a.png"};
  char *text = write_report(state, &report), *path = scratch_path(state, "a.png"), *bytes;
  size_t size;
  assert_int_equal(placido_file_read(&bytes, &size, path, 0, NULL), PLACIDO_OK);
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const char *at = strstr(text, "base64,") + strlen("base64,");
  size_t bits = 0, decoded = 0;
  uint32_t word = 0;
  for (; *at != '"' && *at != '='; at++) {
    const char *digit = strchr(digits, *at);
    assert_non_null(digit);
    word = word << 6 | (uint32_t)(digit - digits);
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      assert_true(decoded < size);
      assert_int_equal(word >> bits & 255, (unsigned char)bytes[decoded++]);
    }
  }
  assert_int_equal(decoded, size);
  placido_memory_free(text);
  placido_memory_free(bytes);
  free(path);
}

static void a_missing_picture_is_named_and_nothing_is_left(void **state) {
  char *folder = scratch_path(state, "");
  placido_report report = {.directory = folder, .capture_picture = "gone.png"};
  placido_error err = {0};
  assert_int_equal(placido_report_write(&report, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "gone.png"));
  assert_int_equal(scratch_count(folder), 0);
  free(scratch_write_text(state, "text.png", "this is no picture at all, though long enough"));
  report.capture_picture = "text.png";
  assert_int_equal(placido_report_write(&report, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "text.png"));
  assert_int_equal(scratch_count(folder), 1);
  free(folder);
}

static void an_unwritable_directory_is_named(void **state) {
  char *folder = scratch_path(state, "missing");
  placido_report report = {.directory = folder};
  placido_error err = {0};
  assert_int_equal(placido_report_write(&report, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "report.html"));
  free(folder);
}

#define SCRATCH_TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)

/* Of effects the page tells whether they ran, what they are worth and why, as text. */
static void a_plan_is_a_table_of_every_effect(void **state) {
  const placido_verdict verdicts[] = {
      {.name = "straylight", .runs = true, .applies = true, .bound = 0.5, .cost_ms = 3.5,
       .reason = "a lamp <1000 times> as bright as white"},
      {.name = "field", .applies = true, .bound = 2e-7, .cost_ms = 40, .reason = "small"},
      {.name = "receptors", .applies = true, .bound = NAN, .cost_ms = NAN,
       .force = PLACIDO_FORCE_OFF, .reason = "coarse"},
  };
  const placido_report_plan plan = {.verdicts = verdicts,
                                    .count = 3,
                                    .tolerance = 0.01,
                                    .promised = 0.0042,
                                    .planning_s = 0.00021,
                                    .predicted_s = NAN,
                                    .run_s = 0.1};
  placido_psf psf = fabricate_psf(3);
  make_picture(state, "a.png");
  const char *scene_pictures[] = {"a.png"}, *scene_names[] = {"street & houses"};
  placido_report_pupil pupil = {.psf = &psf,
                                .automatic = true,
                                .scene_names = scene_names,
                                .scene_pictures = scene_pictures,
                                .scene_count = 1,
                                .plans = &plan};
  placido_report report = {.pupils = &pupil, .pupil_count = 1};
  char *text = write_report(state, &report);
  assert_int_equal(count(text, "<details class=\"plan\" open>"), 1);
  assert_non_null(strstr(text, "street &amp; houses: 1 of 3 effects ran; at most 0.0042 of white "
                               "is wrong beside what was forced off, tolerance 0.01; planned in "
                               "0.21 ms, took 100 ms</summary>"));
  assert_non_null(strstr(text, "<th scope=\"row\">straylight</th><td>ran</td>"
                               "<td class=\"number\">0.50</td><td class=\"number\">3.5</td>"
                               "<td>a lamp &lt;1000 times&gt; as bright as white</td>"));
  assert_non_null(strstr(text, "<th scope=\"row\">field</th><td>left out</td>"
                               "<td class=\"number\">&lt; 0.0001</td>"));
  assert_non_null(strstr(text, "<td>left out, as asked for</td><td class=\"number\">–</td>"));
  assert_non_null(strstr(text, "as its scenes&#39; light gives it"));
  placido_memory_free(text);

  pupil.plans = NULL;
  text = write_report(state, &report);
  assert_int_equal(count(text, "<details"), 0);
  placido_memory_free(text);
  free(psf.values);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      SCRATCH_TEST(hostile_strings_stay_strings),
      SCRATCH_TEST(utf8_stays_as_it_is_and_the_broken_is_replaced),
      SCRATCH_TEST(what_is_missing_leaves_no_heading),
      SCRATCH_TEST(nominal_geometry_is_announced),
      SCRATCH_TEST(figures_are_shown_with_their_errors),
      SCRATCH_TEST(indices_stand_in_groups),
      SCRATCH_TEST(the_error_budget_adds_up),
      SCRATCH_TEST(what_was_promised_stands_beside_what_was_found),
      SCRATCH_TEST(the_wavefront_has_a_column_a_pupil),
      SCRATCH_TEST(a_plan_is_a_table_of_every_effect),
      SCRATCH_TEST(pictures_are_embedded_and_nothing_else_is_referred_to),
      SCRATCH_TEST(the_embedded_picture_is_the_file),
      SCRATCH_TEST(a_missing_picture_is_named_and_nothing_is_left),
      SCRATCH_TEST(an_unwritable_directory_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
