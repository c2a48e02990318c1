/* A device is found by its URI, keeps the order of its calls and the ranges of its controls; an
 * image file is one. */
#include "base/memory.h"
#include "tests/base/scratch.h"

#include <placido/device.h>
#include <placido/image.h>

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* A PNG of 6 x 4 samples under a name; returns its path. */
static char *make_image(void **state, const char *name) {
  char *path = scratch_path(state, name);
  placido_frame frame = {0};
  assert_int_equal(placido_frame_resize(&frame, 6, 4, PLACIDO_MONO8, NULL), PLACIDO_OK);
  for (int i = 0; i < 24; i++) {
    frame.data[i] = (uint8_t)(i * 10);
  }
  assert_int_equal(placido_frame_save_png(&frame, path, NULL), PLACIDO_OK);
  placido_frame_free(&frame);
  return path;
}

/* "SCHEME" + path + "QUERY"; free with free. */
static char *uri_of(const char *scheme, const char *path, const char *query) {
  size_t size = strlen(scheme) + strlen(path) + strlen(query) + 1;
  char *uri = malloc(size);
  assert_non_null(uri);
  snprintf(uri, size, "%s%s%s", scheme, path, query);
  return uri;
}

static placido_device *open_device(const char *uri) {
  placido_device *device;
  placido_error err = {0};
  if (placido_device_open(&device, uri, NULL, &err)) {
    fail_msg("%s", err.text);
  }
  return device;
}

static void an_image_gives_one_frame(void **state) {
  char *path = make_image(state, "a.png"), *uri = uri_of("replay:", path, "");
  const char *const uris[] = {path, uri};
  for (size_t i = 0; i < 2; i++) {
    placido_device *device = open_device(uris[i]);
    placido_frame frame = {0};
    const placido_device_info *info = placido_device_info_get(device);
    assert_string_equal(info->uri, uri);
    assert_string_equal(info->instrument_path, "");
    assert_string_equal(info->eye, "");
    assert_true(isnan(info->axis_z_mm) && isnan(info->axis_z_sigma_mm));
    for (int round = 0; round < 2; round++) {
      assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
      assert_int_equal(placido_device_next(device, &frame, 100, NULL), PLACIDO_OK);
      assert_int_equal(frame.width_px, 6);
      assert_int_equal(frame.data[23], 230);
      assert_int_equal(placido_device_next(device, &frame, 100, NULL), PLACIDO_END);
      assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
    }
    placido_frame_free(&frame);
    placido_device_close(device);
  }
  free(path);
  free(uri);
}

static void a_path_that_exists_wins_over_its_colons(void **state) {
  char *folder = scratch_path(state, "v4l2:x?speed=1");
  assert_int_equal(mkdir(folder, 0777), 0);
  char *path = make_image(state, "v4l2:x?speed=1/b?loop=2.png");
  char *uri = uri_of("replay:", path, ""), *asked = uri_of("replay:", path, "?loop=1");
  const char *const uris[] = {path, uri, asked};
  for (size_t i = 0; i < 3; i++) {
    placido_device *device = open_device(uris[i]);
    double loop;
    assert_int_equal(placido_device_get(device, "loop", &loop, NULL), PLACIDO_OK);
    assert_true(loop == (i == 2));
    placido_device_close(device);
  }
  free(folder);
  free(path);
  free(uri);
  free(asked);
}

static void what_cannot_be_opened_is_named(void **state) {
  char *text = scratch_write_text(state, "text.png", "words"), *image = make_image(state, "a.png");
  char *nowhere = scratch_path(state, "none.png");
  const struct {
    char *uri;
    int status;
    const char *said;
  } cases[] = {
      {uri_of("", nowhere, ""), PLACIDO_SYSTEM, "none.png"},
      {uri_of("replay:", nowhere, "?speed=1"), PLACIDO_SYSTEM, "none.png"},
      {uri_of("", text, ""), PLACIDO_INPUT, "text.png"},
      {uri_of("sonar:7", "", ""), PLACIDO_UNSUPPORTED, "no driver \"sonar\""},
      {uri_of("", "", ""), PLACIDO_SYSTEM, "cannot open"},
      {uri_of("replay:", "", ""), PLACIDO_SYSTEM, "cannot open"},
      {uri_of("replay:", image, "?colour=1"), PLACIDO_INPUT, "no control \"colour\""},
      {uri_of("replay:", image, "?speed=fast"), PLACIDO_INPUT, "\"speed=fast\""},
      {uri_of("replay:", image, "?speed"), PLACIDO_INPUT, "\"speed\""},
      {uri_of("replay:", image, "?loop=2"), PLACIDO_INPUT, "control loop is 0 to 1"},
      {uri_of("replay:", image, "?speed=nan"), PLACIDO_INPUT, "control speed is 0 to"},
      {uri_of("replay:", image, "?speed=-1&loop=1"), PLACIDO_INPUT, "control speed is 0 to"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    placido_device *device;
    placido_error err = {0};
    assert_int_equal(placido_device_open(&device, cases[i].uri, NULL, &err), cases[i].status);
    assert_null(device);
    if (!strstr(err.text, cases[i].said)) {
      fail_msg("\"%s\" does not say \"%s\"", err.text, cases[i].said);
    }
    free(cases[i].uri);
  }
  placido_device_close(NULL);
  free(text);
  free(image);
  free(nowhere);
}

static void calls_out_of_order_are_refused(void **state) {
  char *path = make_image(state, "a.png");
  placido_device *device = open_device(path);
  placido_frame frame = {0};
  assert_int_equal(placido_device_next(device, &frame, 0, NULL), PLACIDO_INPUT);
  assert_int_equal(placido_device_stop(device, NULL), PLACIDO_OK);
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_INPUT);
  placido_device_close(device); /* while it runs */
  free(path);
}

static void controls_are_data(void **state) {
  char *path = make_image(state, "a.png");
  placido_device *device = open_device(path);
  size_t count;
  const placido_control *controls = placido_device_controls(device, &count);
  assert_true(count >= 2);
  for (size_t i = 0; i < count; i++) {
    double value;
    assert_true(controls[i].unit && controls[i].help && controls[i].min < controls[i].max);
    assert_int_equal(placido_device_set(device, controls[i].name, controls[i].max, NULL),
                     PLACIDO_OK);
    assert_int_equal(placido_device_get(device, controls[i].name, &value, NULL), PLACIDO_OK);
    assert_true(value == controls[i].max);
    assert_int_equal(
        placido_device_set(device, controls[i].name, controls[i].max + controls[i].step, NULL),
        PLACIDO_INPUT);
  }
  double value;
  assert_int_equal(placido_device_get(device, "none", &value, NULL), PLACIDO_INPUT);
  placido_device_close(device);
  free(path);
}

static int count_mode(void *user, const placido_device_mode *mode) {
  (void)mode;
  ++*(int *)user;
  return 0;
}

/* A file has neither formats to choose from nor events, and is never unplugged; patience is every
 * device's setting all the same. */
static void what_a_device_has_not_is_told(void **state) {
  char *path = make_image(state, "a.png"), *uri = uri_of("replay:", path, "?replug_s=10");
  placido_device *device = open_device(uri);
  placido_event event;
  placido_device_statistics counts;
  int modes = 0;
  assert_int_equal(placido_device_modes(device, count_mode, &modes, NULL), PLACIDO_UNSUPPORTED);
  assert_int_equal(modes, 0);
  assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
  assert_int_equal(placido_device_event(device, &event, 0, NULL), PLACIDO_UNSUPPORTED);
  assert_false(placido_device_is_waiting(device));
  placido_device_statistics_get(device, &counts);
  assert_int_equal(counts.replugs, 0);
  placido_device_close(device);
  free(path);
  free(uri);
}

static int count_found(void *user, const char *uri, const char *description) {
  (void)uri;
  (void)description;
  ++*(int *)user;
  return 0;
}

static void see_driver(void *user, const char *scheme, const char *summary) {
  assert_true(strlen(summary) > 0);
  *(int *)user += strcmp(scheme, "replay") == 0;
}

static void drivers_are_listed_and_replay_has_nothing_to_look_for(void **state) {
  (void)state;
  int seen = 0, found = 0;
  placido_driver_list(see_driver, &seen);
  assert_int_equal(seen, 1);
  assert_int_equal(placido_device_scan("replay", count_found, &found, NULL), PLACIDO_OK);
  assert_int_equal(found, 0);
  placido_error err;
  assert_int_equal(placido_device_scan("none", count_found, &found, &err), PLACIDO_UNSUPPORTED);
}

static void every_allocation_may_fail(void **state) {
  char *path = make_image(state, "a.png"), *uri = uri_of("replay:", path, "?loop=1");
  int status = PLACIDO_MEMORY;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_device *device;
    placido_frame frame = {0};
    placido_memory_fail_at(n);
    status = placido_device_open(&device, uri, NULL, NULL);
    if (!status) {
      assert_int_equal(placido_device_start(device, NULL), PLACIDO_OK);
      status = placido_device_next(device, &frame, 0, NULL);
    }
    placido_memory_fail_at(0);
    placido_frame_free(&frame);
    placido_device_close(device);
  }
  assert_int_equal(status, PLACIDO_OK);
  free(path);
  free(uri);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(an_image_gives_one_frame),
      TEST(a_path_that_exists_wins_over_its_colons),
      TEST(what_cannot_be_opened_is_named),
      TEST(calls_out_of_order_are_refused),
      TEST(controls_are_data),
      TEST(what_a_device_has_not_is_told),
      TEST(drivers_are_listed_and_replay_has_nothing_to_look_for),
      TEST(every_allocation_may_fail),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
