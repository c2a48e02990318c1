/* An instrument survives the way to a file and back; impossible geometry is refused at its line. */
#include "base/memory.h"
#include "tests/base/scratch.h"

#include <placido/instrument.h>

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char whole[] = "{\"format\": \"placido-instrument/1\",\n"
                            "\"name\": \"test\",\n"
                            "\"camera\": {\n"
                            "\"model\": \"pinhole\",\n"
                            "\"image_size_px\": [640, 480],\n"
                            "\"focal_px\": [5000, 5001],\n"
                            "\"principal_px\": [319.5, 239.5],\n"
                            "\"position_mm\": [0, 0, 120]},\n"
                            "\"mires\": {\n"
                            "\"first_band\": \"dark\",\n"
                            "\"edges\": [\n"
                            "{\"radius_mm\": 6.5, \"z_mm\": 71.25},\n"
                            "{\"radius_mm\": 7.5, \"z_mm\": 70}]}}\n";

/* The whole document with the first `from` replaced by `to`. */
static char *changed(const char *from, const char *to) {
  const char *place = strstr(whole, from);
  assert_non_null(place);
  size_t size = sizeof whole + strlen(to);
  char *text = malloc(size);
  assert_non_null(text);
  snprintf(text, size, "%.*s%s%s", (int)(place - whole), whole, to, place + strlen(from));
  return text;
}

static int load(void **state, const char *text, placido_instrument *instrument,
                placido_notes *notes, placido_error *err) {
  char *path = scratch_write_text(state, "i.json", text);
  int status = placido_instrument_load(instrument, path, notes, err);
  free(path);
  return status;
}

static void what_may_be_missing_has_its_default(void **state) {
  placido_instrument instrument;
  placido_notes notes = {0};
  assert_int_equal(load(state, whole, &instrument, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 0);
  assert_false(instrument.calibrated);
  assert_true(instrument.distortion[0] == 0 && instrument.distortion[4] == 0);
  assert_true(instrument.focal_px[1] == 5001);
  assert_false(instrument.first_band_bright);
  assert_int_equal(instrument.edge_count, 2);
  assert_true(instrument.edges[0].z_mm == 71.25);
}

static void the_sample_instrument_is_read(void **state) {
  (void)state;
  placido_instrument instrument;
  placido_notes notes = {0};
  const char *path = PLACIDO_TEST_DATA "/samples/normal.instrument.json";
  assert_int_equal(placido_instrument_load(&instrument, path, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 0);
  assert_int_equal(instrument.width_px, 1280);
  assert_int_equal(instrument.height_px, 1024);
  assert_true(instrument.first_band_bright);
  assert_true(instrument.edge_count > 40);
  for (int i = 1; i < instrument.edge_count; i++) {
    assert_true(instrument.edges[i].radius_mm > instrument.edges[i - 1].radius_mm);
  }
}

static void an_instrument_reads_back_bit_for_bit(void **state) {
  char *path = scratch_path(state, "saved.json");
  const placido_instrument instrument = {.name = "µ \"quoted\"",
                                         .model = PLACIDO_TELECENTRIC,
                                         .width_px = 65536,
                                         .height_px = 1,
                                         .focal_px = {1.0 / 3, 0.1},
                                         .principal_px = {-0.5, 1e-300},
                                         .distortion = {0.1, -0.2, 0.3, 1e-17, 5},
                                         .position_mm = {0.1, 0.2, 120.3},
                                         .first_band_bright = true,
                                         .edge_count = 2,
                                         .edges = {{6.1, 71.7}, {7.1, -0.7}},
                                         .calibrated = false};
  placido_instrument read;
  placido_error err = {0};
  assert_int_equal(placido_instrument_save(&instrument, path, &err), PLACIDO_OK);
  assert_int_equal(placido_instrument_load(&read, path, NULL, &err), PLACIDO_OK);
  assert_string_equal(read.name, instrument.name);
  assert_int_equal(read.model, PLACIDO_TELECENTRIC);
  assert_int_equal(read.width_px, 65536);
  assert_memory_equal(read.focal_px, instrument.focal_px, sizeof read.focal_px);
  assert_memory_equal(read.principal_px, instrument.principal_px, sizeof read.principal_px);
  assert_memory_equal(read.distortion, instrument.distortion, sizeof read.distortion);
  assert_memory_equal(read.position_mm, instrument.position_mm, sizeof read.position_mm);
  assert_memory_equal(read.edges, instrument.edges, sizeof read.edges);
  assert_true(read.first_band_bright);
  assert_false(read.calibrated);
  free(path);
}

static void a_telecentric_camera_has_a_scale(void **state) {
  placido_instrument instrument;
  placido_error err;
  char *text = changed("\"pinhole\"", "\"telecentric\", \"px_per_mm\": 91.5");
  assert_int_equal(load(state, text, &instrument, NULL, &err), PLACIDO_OK);
  assert_int_equal(instrument.model, PLACIDO_TELECENTRIC);
  assert_true(instrument.focal_px[0] == 91.5 && instrument.focal_px[1] == 91.5);
  free(text);
  text = changed("\"pinhole\"", "\"telecentric\"");
  assert_int_equal(load(state, text, &instrument, NULL, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "i.json:3: field camera.px_per_mm: missing"));
  free(text);
}

static void unknown_fields_are_one_warning(void **state) {
  placido_instrument instrument;
  placido_notes notes = {0};
  char *text = changed("\"name\"", "\"sigma\": {}, \"colour\": 1, \"maker\": 2, \"name\"");
  assert_int_equal(load(state, text, &instrument, &notes, NULL), PLACIDO_OK);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "colour, maker"));
  placido_notes_clear(&notes);
  free(text);
}

static void impossible_geometry_is_refused_at_its_line(void **state) {
  static const struct {
    const char *from, *to, *said;
  } cases[] = {
      {"instrument/1", "instrument/2", "i.json:1: field format: unknown version"},
      {"\"pinhole\"", "\"fisheye\"", "i.json:4: field camera.model: is \"fisheye\""},
      {"\"pinhole\"", "7", "i.json:4: field camera.model: is a number"},
      {"640, 480", "640", "i.json:5: field camera.image_size_px: has 1 elements"},
      {"640, 480", "640, 65537", "i.json:5: field camera.image_size_px[1]: is 65537"},
      {"640, 480", "0, 480", "i.json:5: field camera.image_size_px[0]: is 0"},
      {"640, 480", "640.5, 480", "i.json:5: field camera.image_size_px[0]: is 640.5"},
      {"5000, 5001", "5000, -1", "i.json:6: field camera.focal_px: 5000, -1 must be positive"},
      {"5000, 5001", "5000, 1e300", "i.json:6: field camera.focal_px"},
      {"5000, 5001", "5000, null", "i.json:6: field camera.focal_px: element 1"},
      {"[319.5, 239.5]", "{}", "i.json:7: field camera.principal_px: is an object"},
      {"0, 0, 120", "0, 0, 0", "i.json:8: field camera.position_mm: z is 0 mm"},
      {"0, 0, 120", "0, 0, 1e7", "i.json:8: field camera.position_mm: 1e+07 mm is over"},
      {"\"dark\"", "\"grey\"", "i.json:10: field mires.first_band: is \"grey\""},
      {"\"radius_mm\": 7.5, ", "", "i.json:13: field mires.edges[1].radius_mm: missing"},
      {"6.5", "-6.5", "i.json:12: field mires.edges[0].radius_mm: -6.5 mm must be positive"},
      {"71.25", "1e99", "i.json:12: field mires.edges[0].z_mm"},
      {"71.25", "-20", "i.json:12: field mires.edges[0].z_mm: -20 mm: the edge lies behind"},
      {"71.25", "NaN", "i.json:12:"},
      {"\"edges\"", "\"edge\"", "i.json:9: field mires.edges: missing"},
      {"\"mires\"", "\"mire\"", "i.json:1: field mires.first_band: missing"},
      {"\"name\": \"test\"", "\"name\": \"test\", \"calibrated\": 1",
       "i.json:2: field calibrated: is a number"},
      {"\"name\": \"test\"", "\"title\": \"test\"", "i.json:1: field name: missing"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char *text = changed(cases[i].from, cases[i].to);
    placido_instrument instrument;
    placido_error err = {0};
    assert_int_equal(load(state, text, &instrument, NULL, &err), PLACIDO_INPUT);
    if (!strstr(err.text, cases[i].said)) {
      fail_msg("\"%s\" does not say \"%s\"", err.text, cases[i].said);
    }
    free(text);
  }
}

static void the_number_of_edges_is_bounded(void **state) {
  placido_instrument instrument;
  placido_error err;
  char edges[300 * 32] = "";
  char *end = edges;
  for (int i = 0; i < PLACIDO_EDGES_MAX - 1; i++) {
    end += sprintf(end, "{\"radius_mm\": 1, \"z_mm\": 2},");
  }
  char pair[sizeof edges + 64];
  snprintf(pair, sizeof pair, "%s{\"radius_mm\": 7.5", edges);
  char *text = changed("{\"radius_mm\": 7.5", pair); /* one of the document's own is before them */
  assert_int_equal(load(state, text, &instrument, NULL, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "has 257 edges, 1 to 256 are expected"));
  free(text);
  text = changed("{\"radius_mm\": 6.5, \"z_mm\": 71.25},\n{\"radius_mm\": 7.5, \"z_mm\": 70}", "");
  assert_int_equal(load(state, text, &instrument, NULL, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "has 0 edges"));
  free(text);
}

static void every_allocation_may_fail(void **state) {
  char *path = scratch_write_text(state, "i.json", whole);
  placido_instrument instrument;
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_memory_fail_at(n);
    status = placido_instrument_load(&instrument, path, NULL, NULL);
    placido_memory_fail_at(0);
  }
  assert_int_equal(status, PLACIDO_OK);
  free(path);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(what_may_be_missing_has_its_default),
      TEST(the_sample_instrument_is_read),
      TEST(an_instrument_reads_back_bit_for_bit),
      TEST(a_telecentric_camera_has_a_scale),
      TEST(unknown_fields_are_one_warning),
      TEST(impossible_geometry_is_refused_at_its_line),
      TEST(the_number_of_edges_is_bounded),
      TEST(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
