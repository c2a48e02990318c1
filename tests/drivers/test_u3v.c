/* A USB3 Vision camera is found, agreed with, regulated and found again as its script says. */
#include "tests/drivers/u3v_use.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

static void assert_refused(const char *address, int status, const char *text) {
  void *camera;
  placido_error err = {0};
  assert_int_equal(placido_u3v_open(&camera, address, &fake_calls, NULL, &err), status);
  assert_int_equal(err.status, status);
  assert_null(camera);
  assert_says(&err, text);
}

static void a_camera_is_found_by_all_its_names(void **state) {
  (void)state;
  static const char *const addresses[] = {"", "S1", "left eye", "place=4-1.2"};
  for (size_t i = 0; i < sizeof addresses / sizeof *addresses; i++) {
    void *camera = open_camera(addresses[i], NULL);
    const placido_device_info *info = driver->info(camera);
    assert_string_equal(info->vendor, "Test");
    assert_string_equal(info->model, "Fake");
    assert_string_equal(info->serial, "S1");
    assert_string_equal(info->firmware, "1.0");
    assert_true(info->endless);
    driver->close(camera);
  }
}

static void what_does_not_fit_one_camera_is_told(void **state) {
  (void)state;
  assert_refused("S2", PLACIDO_SYSTEM, "there is Fake (u3v:place=4-1.2, serial S1)");
  fake.found_count = 2;
  fake.found[1] = fake.found[0];
  strcpy(fake.found[1].serial, "left eye");
  strcpy(fake.found[1].place, "4-1.3");
  assert_refused("", PLACIDO_INPUT, "fits 2 cameras");
  assert_refused("", PLACIDO_INPUT, "u3v:place=4-1.3, serial left eye");
  /* A serial number goes before a name that a user gave. */
  driver->close(open_camera("left eye", NULL));
  fake.found_count = 0;
  assert_refused("", PLACIDO_SYSTEM, "no USB3 Vision camera is plugged in");
}

static void wrong_settings_are_told(void **state) {
  (void)state;
  static const struct {
    const char *query, *text;
  } cases[] = {
      {"?size=64", "not WIDTHxHEIGHT"},   {"?size=0x48", "not WIDTHxHEIGHT"},
      {"?offset=4x4", "not X,Y"},         {"?format=Mono9", "is not one of Mono8"},
      {"?buffers=1", "from 2 to 32"},     {"?fps=fast", "not a number of frames"},
      {"?size=64x48x", "not WIDTHxHEIGHT"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    assert_refused(cases[i].query, PLACIDO_INPUT, cases[i].text);
  }
}

static void the_nearest_is_agreed_and_noted(void **state) {
  const struct {
    const char *query;
    uint32_t format, width, height, x, y;
    const char *note; /* NULL: none */
  } cases[] = {
      {"", 0x01080001, 64, 48, 40, 6, NULL},
      {"?format=mono12p", 0x010C0047, 64, 48, 40, 6, NULL},
      {"?format=RGB8", 0x01080001, 64, 48, 40, 6, "gives Mono8, not RGB8"},
      /* Without an offset the middle of the sensor is taken: (2048 - 32) / 2. */
      {"?size=32x24", 0x01080001, 32, 24, 1008, 756, NULL},
      {"?size=35x24&offset=16,2", 0x01080001, 32, 24, 16, 2, "32 x 24 pixels, not 35 x 24"},
      {"?size=9999x48&offset=0,0", 0x01080001, 2048, 48, 0, 0, "2048 x 48 pixels"},
      {"?offset=13,2", 0x01080001, 64, 48, 16, 2, "begin at pixel 16, 2, not 13, 2"},
      {"?fps=50", 0x01080001, 64, 48, 40, 6, NULL},
      {"?fps=500", 0x01080001, 64, 48, 40, 6, "gives 100 frames/s, not 500"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    reset(state);
    fake_put(FAKE_OFFSET_X, 40);
    fake_put(FAKE_OFFSET_Y, 6);
    placido_notes notes = {0};
    driver->close(open_camera(cases[i].query, &notes));
    assert_int_equal(fake_get(FAKE_PIXEL_FORMAT), cases[i].format);
    assert_int_equal(fake_get(FAKE_WIDTH), cases[i].width);
    assert_int_equal(fake_get(FAKE_HEIGHT), cases[i].height);
    assert_int_equal(fake_get(FAKE_OFFSET_X), cases[i].x);
    assert_int_equal(fake_get(FAKE_OFFSET_Y), cases[i].y);
    assert_int_equal(notes.count, cases[i].note != NULL);
    assert_true(!cases[i].note || strstr(notes.lines[0], cases[i].note));
    placido_notes_clear(&notes);
  }
}

static void a_camera_that_lacks_a_size_is_refused(void **state) {
  (void)state;
  fake.without = "Height";
  assert_refused("", PLACIDO_INPUT, "Height");
  fake.without = "PixelFormat";
  assert_refused("", PLACIDO_INPUT, "PixelFormat");
}

static int count_mode(void *user, const placido_device_mode *mode) {
  int *count = user;
  assert_int_equal(mode->width_min_px, 8);
  assert_int_equal(mode->width_max_px, FAKE_WIDTH_MAX);
  assert_int_equal(mode->height_step_px, 2);
  assert_int_equal(mode->rate_count, 2);
  assert_true(mode->rates_hz[1] == 100);
  assert_int_equal(mode->is_readable, strcmp(mode->format, "Vendor7") != 0);
  return ++*count < 4 ? 0 : 1;
}

static void modes_are_listed(void **state) {
  (void)state;
  fake_put(FAKE_OFFSET_X, 40);
  void *camera = open_camera("", NULL);
  int count = 0;
  assert_int_equal(driver->modes(camera, count_mode, &count, NULL), 1);
  assert_int_equal(count, 4);
  driver->close(camera);
}

static void controls_have_names_units_and_ranges(void **state) {
  (void)state;
  static const placido_control expected[] = {
      {.name = "exposure_us", .unit = "us", .min = 10, .max = 9000},
      {.name = "gain_db", .unit = "dB", .min = 0, .max = 24},
      {.name = "black_level", .unit = "", .min = 0, .max = 255, .step = 5},
      {.name = "frame_rate_hz", .unit = "Hz", .min = 1, .max = 100},
      {.name = "trigger", .unit = "", .min = 0, .max = 1, .step = 1},
      {.name = "trigger_source", .unit = "", .min = 1, .max = 7, .step = 1},
      {.name = "trigger_software", .unit = "", .min = 0, .max = 1, .step = 1},
      {.name = "device_temperature_c", .unit = "C", .min = -40, .max = 120},
  };
  void *camera = open_camera("", NULL);
  size_t count;
  const placido_control *rows = driver->controls(camera, &count);
  assert_int_equal(count, sizeof expected / sizeof *expected);
  for (size_t i = 0; i < count; i++) {
    assert_string_equal(rows[i].name, expected[i].name);
    assert_string_equal(rows[i].unit, expected[i].unit);
    assert_float_equal(rows[i].min, expected[i].min, 1e-6); /* the camera's single precision */
    assert_float_equal(rows[i].max, expected[i].max, 1e-6);
    assert_float_equal(rows[i].step, expected[i].step, 1e-6);
  }
  assert_string_equal(rows[5].help, "1 Line1, 7 Software");
  driver->close(camera);
}

static void controls_reach_the_camera(void **state) {
  (void)state;
  void *camera = open_camera("", NULL);
  set(camera, "exposure_us", 2500);
  assert_true(fabsf(fake_get_float(FAKE_EXPOSURE) - 2.5f) < 1e-6f); /* milliseconds */
  assert_int_equal(fake_get(FAKE_EXPOSURE_AUTO), 0); /* the camera does not regulate against us */
  assert_true(fabs(value_of(camera, "exposure_us") - 2500) < 1e-3);
  set(camera, "frame_rate_hz", 25);
  assert_int_equal(fake_get(FAKE_RATE_ENABLE), 1);
  assert_true(value_of(camera, "frame_rate_hz") == 25);
  set(camera, "trigger", 1);
  assert_int_equal(fake_get(FAKE_TRIGGER_MODE), 1);
  assert_true(value_of(camera, "trigger") == 1);
  set(camera, "trigger_source", 7);
  assert_int_equal(fake_get(FAKE_TRIGGER_SOURCE), 7);
  assert_true(value_of(camera, "device_temperature_c") == 41.5);
  assert_true(value_of(camera, "trigger_software") == 0);
  driver->close(camera);
}

static void what_can_only_be_read_is_not_set(void **state) {
  (void)state;
  void *camera = open_camera("", NULL);
  placido_error err;
  const size_t control = control_index(camera, "device_temperature_c");
  assert_int_equal(driver->set(camera, control, 20, &err), PLACIDO_UNSUPPORTED);
  assert_says(&err, "can only be read");
  driver->close(camera);
}

static void features_that_are_not_there_are_left_out(void **state) {
  (void)state;
  static const struct {
    const char *without;
    size_t left;
  } cases[] = {{"Trigger", 5}, {"Gain", 7}, {"Temperature", 7}, {"Rate", 7}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    fake.without = cases[i].without;
    size_t count;
    placido_notes notes = {0};
    void *camera = open_camera("?fps=50", &notes);
    driver->controls(camera, &count);
    assert_int_equal(count, cases[i].left);
    assert_int_equal(notes.count, strcmp(cases[i].without, "Rate") == 0);
    placido_notes_clear(&notes);
    driver->close(camera);
  }
}

/* Cameras of ten years ago: numbers in a unit of their own, which ours do not pretend to know. */
static void raw_features_are_controls_without_a_unit(void **state) {
  (void)state;
  fake.without_exactly = "ExposureTime";
  void *camera = open_camera("", NULL);
  size_t count;
  const placido_control *rows = driver->controls(camera, &count);
  assert_string_equal(rows[0].name, "exposure");
  assert_string_equal(rows[0].unit, "");
  assert_true(rows[0].max == 4095);
  set(camera, "exposure", 700);
  assert_int_equal(fake_get(FAKE_EXPOSURE_RAW), 700);
  driver->close(camera);
  fake.without_exactly = "Gain";
  camera = open_camera("", NULL);
  rows = driver->controls(camera, &count);
  assert_string_equal(rows[1].name, "gain");
  driver->close(camera);
}

struct seen {
  char uri[100], description[300];
};

static int note_device(void *user, const char *uri, const char *description) {
  struct seen *seen = user;
  snprintf(seen->uri, sizeof seen->uri, "%s", uri);
  snprintf(seen->description, sizeof seen->description, "%s", description);
  return 0;
}

static void cameras_are_listed_by_what_finds_them(void **state) {
  (void)state;
  struct seen seen = {"", ""};
  assert_int_equal(placido_u3v_scan(&fake_calls, note_device, &seen, NULL), PLACIDO_OK);
  assert_string_equal(seen.uri, "u3v:S1");
  assert_non_null(strstr(seen.description, "Test Fake \"left eye\""));
  assert_non_null(strstr(seen.description, "u3v:place=4-1.2"));
  /* A serial number that would be read as something else. */
  strcpy(fake.found[0].serial, "A?b=1");
  assert_int_equal(placido_u3v_scan(&fake_calls, note_device, &seen, NULL), PLACIDO_OK);
  assert_string_equal(seen.uri, "u3v:place=4-1.2");
}

static void a_lost_camera_is_found_again_as_it_was(void **state) {
  (void)state;
  void *camera = start_camera("?size=32x24&format=Mono8&fps=50");
  placido_frame frame = {0};
  placido_error err = {0};
  double value;
  set(camera, "exposure_us", 1000);
  set(camera, "gain_db", 6);
  take(camera, &frame);
  fake_unplug();
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_GONE);
  assert_says(&err, "unplugged");
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_GONE);
  assert_int_equal(driver->get(camera, 0, &value, &err), PLACIDO_GONE);
  assert_int_equal(driver->set(camera, 0, 20, &err), PLACIDO_GONE);
  assert_int_equal(fake.open_count, 0);
  assert_int_equal(driver->stop(camera, NULL), PLACIDO_OK);
  assert_int_equal(driver->start(camera, &err), PLACIDO_GONE);
  fake_replug();
  strcpy(fake.found[0].place, "2-3"); /* in another socket */
  assert_int_equal(driver->start(camera, &err), PLACIDO_OK);
  assert_int_equal(fake_get(FAKE_WIDTH), 32);
  assert_int_equal(fake_get(FAKE_OFFSET_X), 1008);
  assert_true(fake_get_float(FAKE_EXPOSURE) == 1);
  assert_true(fake_get_float(FAKE_GAIN) == 6);
  assert_true(fake_get_float(FAKE_RATE) == 50);
  take_picture_of(camera, &frame, 0, 0);
  assert_int_equal(frame.seq, 1); /* numbers go on */
  stop_camera(camera);
  placido_frame_free(&frame);
}

static void another_camera_in_its_place_is_not_taken(void **state) {
  (void)state;
  void *camera = start_camera("place=4-1.2");
  placido_frame frame = {0};
  placido_error err = {0};
  fake_unplug();
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_GONE);
  fake_replug();
  strcpy((char *)fake.memory + 0x144, "S9");
  assert_int_equal(driver->start(camera, &err), PLACIDO_SYSTEM);
  assert_says(&err, "is the camera Fake now");
  assert_int_equal(fake.open_count, 0);
  driver->close(camera);
}

static void a_camera_that_comes_back_wrong_may_be_tried_again(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  placido_error err = {0};
  fake_unplug();
  assert_int_equal(driver->next(camera, &frame, 100, &err), PLACIDO_GONE);
  fake_replug();
  fake_put(FAKE_WIDTH, 72);
  fake.without = "Offset";
  assert_int_equal(driver->start(camera, &err), PLACIDO_INPUT); /* WidthRoom is gone */
  fake.without = NULL;
  assert_int_equal(driver->start(camera, &err), PLACIDO_OK);
  assert_int_equal(fake_get(FAKE_WIDTH), 64);
  stop_camera(camera);
}

/* Nothing is lost on the way, however often the plug is pulled. */
static void a_thousand_unpluggings_leave_nothing_behind(void **state) {
  (void)state;
  void *camera = start_camera("");
  placido_frame frame = {0};
  for (uint64_t i = 0; i < 1000; i++) {
    take(camera, &frame);
    assert_int_equal(frame.seq, i);
    fake_unplug();
    assert_int_equal(driver->next(camera, &frame, 100, NULL), PLACIDO_GONE);
    assert_int_equal(fake.open_count + fake.pending_count + fake.own_count, 0);
    assert_int_equal(driver->stop(camera, NULL), PLACIDO_OK);
    fake_replug();
    assert_int_equal(driver->start(camera, NULL), PLACIDO_OK);
  }
  assert_int_equal(counts_of(camera).frames, 1000);
  stop_camera(camera);
  placido_frame_free(&frame);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_camera_is_found_by_all_its_names, reset, nothing_is_left),
      cmocka_unit_test_setup_teardown(what_does_not_fit_one_camera_is_told, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(wrong_settings_are_told, reset, nothing_is_left),
      cmocka_unit_test_setup_teardown(the_nearest_is_agreed_and_noted, reset, nothing_is_left),
      cmocka_unit_test_setup_teardown(a_camera_that_lacks_a_size_is_refused, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(modes_are_listed, reset, nothing_is_left),
      cmocka_unit_test_setup_teardown(controls_have_names_units_and_ranges, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(controls_reach_the_camera, reset, nothing_is_left),
      cmocka_unit_test_setup_teardown(what_can_only_be_read_is_not_set, reset, nothing_is_left),
      cmocka_unit_test_setup_teardown(features_that_are_not_there_are_left_out, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(raw_features_are_controls_without_a_unit, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(cameras_are_listed_by_what_finds_them, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(a_lost_camera_is_found_again_as_it_was, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(a_thousand_unpluggings_leave_nothing_behind, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(another_camera_in_its_place_is_not_taken, reset,
                                      nothing_is_left),
      cmocka_unit_test_setup_teardown(a_camera_that_comes_back_wrong_may_be_tried_again, reset,
                                      nothing_is_left),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
