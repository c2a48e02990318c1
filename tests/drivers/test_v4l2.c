/* A camera is found, agreed with, and regulated as its script says. */
#include "drivers/v4l2/mjpeg.h"
#include "tests/base/scratch.h"
#include "tests/drivers/v4l2_use.h"

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
#include <unistd.h>

/* Every format of the table, as the only one that the camera has. */
static void every_format_is_agreed_and_streamed(void **state) {
  size_t count;
  const placido_v4l2_format *formats = placido_v4l2_formats(&count);
  for (size_t i = 0; i < count; i++) {
    uint8_t white[64];
    memset(white, 0xff, sizeof white);
    reset(state);
    fake.offers[0].fourcc = formats[i].fourcc;
    fake.picture = white;
    fake.picture_size = placido_v4l2_row_bytes(&formats[i], 8) * 4;
    void *camera;
    placido_error err = {0};
    const int status = placido_v4l2_open(&camera, "/dev/video0", &fake_calls, NULL, &err);
    if (!placido_v4l2_is_readable(&formats[i])) {
      assert_int_equal(status, PLACIDO_UNSUPPORTED);
      assert_says(&err, formats[i].name);
      continue;
    }
    assert_int_equal(status, PLACIDO_OK);
    if (!formats[i].unpack) {
      driver->close(camera);
      continue;
    }
    assert_int_equal(driver->start(camera, NULL), PLACIDO_OK);
    placido_frame frame = {0};
    take(camera, &frame);
    assert_int_equal(frame.bits, formats[i].bits);
    uint16_t wide;
    memcpy(&wide, frame.data, sizeof wide);
    assert_int_equal(frame.bits > 8 ? wide : frame.data[31], (1u << frame.bits) - 1);
    placido_frame_free(&frame);
    stop_camera(camera);
  }
}

/* What the camera offers, what is asked, and what comes of it. */
static void the_best_for_mires_is_chosen(void **state) {
  static const struct fake_offer yuyv_small = {V4L2_PIX_FMT_YUYV, 8, 4, {30}};
  static const struct fake_offer yuyv = {V4L2_PIX_FMT_YUYV, 16, 8, {30}};
  static const struct fake_offer y12 = {V4L2_PIX_FMT_Y12, 8, 4, {30}};
  static const struct fake_offer mjpeg = {V4L2_PIX_FMT_MJPEG, 32, 16, {30}};
  const struct {
    struct fake_offer offers[4];
    const char *query;
    uint32_t fourcc, width;
    const char *note; /* NULL: none */
  } cases[] = {
      {{mjpeg, yuyv_small, yuyv}, "", V4L2_PIX_FMT_YUYV, 16, NULL},
      {{yuyv, y12}, "", V4L2_PIX_FMT_Y12, 8, NULL},
      {{yuyv, y12}, "?size=16x8", V4L2_PIX_FMT_YUYV, 16, NULL},
      {{yuyv, y12}, "?size=16x8&format=Y12", V4L2_PIX_FMT_Y12, 8, "8 x 4 pixels, not 16 x 8"},
      {{yuyv_small, yuyv}, "?format=yuyv&size=8x4", V4L2_PIX_FMT_YUYV, 8, NULL},
      {{yuyv, y12}, "?format=GREY", V4L2_PIX_FMT_Y12, 8, "gives Y12, not GREY"},
      {{yuyv_small, yuyv}, "?size=15x8", V4L2_PIX_FMT_YUYV, 16, "16 x 8 pixels, not 15 x 8"},
      {{y12}, "?fps=60", V4L2_PIX_FMT_Y12, 8, NULL},
      {{y12}, "?fps=25", V4L2_PIX_FMT_Y12, 8, "gives 30 frames/s, not 25"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    reset(state);
    memcpy(fake.offers, cases[i].offers, sizeof cases[i].offers);
    placido_notes notes = {0};
    char address[100];
    snprintf(address, sizeof address, "/dev/video0%s", cases[i].query);
    driver->close(open_camera(address, &notes));
    assert_int_equal(fake.fourcc, cases[i].fourcc);
    assert_int_equal(fake.width, cases[i].width);
    assert_int_equal(notes.count, cases[i].note != NULL);
    assert_true(!cases[i].note || strstr(notes.lines[0], cases[i].note));
    placido_notes_clear(&notes);
  }
}

static void a_camera_without_rates_or_sizes_is_taken_as_it_is(void **state) {
  (void)state;
  fake.gives_no_sizes = true;
  fake.has_rate = false;
  placido_notes notes = {0};
  driver->close(open_camera("/dev/video0?fps=30", &notes));
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "has no frame rate to set"));
  placido_notes_clear(&notes);
}

/* The end of a range is no wish; a size within it is. */
static void a_range_of_sizes_is_left_as_it_is_set(void **state) {
  (void)state;
  fake.has_size_range = true;
  fake.width = 640;
  fake.height = 480;
  driver->close(open_camera("/dev/video0", NULL));
  assert_int_equal(fake.width, 640);
  driver->close(open_camera("/dev/video0?size=1280x1024", NULL));
  assert_int_equal(fake.width, 1280);
  assert_int_equal(fake.height, 1024);
}

static void wrong_addresses_are_told(void **state) {
  (void)state;
  static const struct {
    const char *address;
    int status;
    const char *said;
  } cases[] = {
      {"", PLACIDO_INPUT, "v4l2:/dev/videoN"},
      {"/dev/video9", PLACIDO_SYSTEM, "No such file"},
      {"serial=none", PLACIDO_SYSTEM, "no camera with serial=none"},
      {"/dev/video0?size=big", PLACIDO_INPUT, "WIDTHxHEIGHT"},
      {"/dev/video0?size=10x10x10", PLACIDO_INPUT, "WIDTHxHEIGHT"},
      {"/dev/video0?size=99999x10", PLACIDO_INPUT, "WIDTHxHEIGHT"},
      {"/dev/video0?size=0x10", PLACIDO_INPUT, "WIDTHxHEIGHT"},
      {"/dev/video0?format=RGB", PLACIDO_INPUT, "GREY"},
      {"/dev/video0?fps=fast", PLACIDO_INPUT, "fps=fast"},
      {"/dev/video0?fps=-1", PLACIDO_INPUT, "fps=-1"},
      {"/dev/video0?fps=nan", PLACIDO_INPUT, "fps=nan"},
      {"/dev/video0?buffers=1", PLACIDO_INPUT, "from 2 to 32"},
      {"/dev/video0?buffers=4four", PLACIDO_INPUT, "from 2 to 32"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    void *camera;
    placido_error err = {0};
    assert_int_equal(
        placido_v4l2_open(&camera, cases[i].address, &fake_calls, NULL, &err), cases[i].status);
    assert_null(camera);
    assert_says(&err, cases[i].said);
  }
  fake.is_not_camera = true;
  placido_error err = {0};
  void *camera;
  assert_int_equal(placido_v4l2_open(&camera, "/dev/video0", &fake_calls, NULL, &err),
                   PLACIDO_SYSTEM);
  assert_says(&err, "is not a camera");
}

static void controls_have_units_and_ranges(void **state) {
  (void)state;
  have_controls();
  static const struct {
    const char *name, *unit;
    double min, max, value, set, after;
  } cases[] = {
      {"exposure_us", "us", 100, 50000, 2000, 12340, 12300},
      {"gain", "", 0, 100, 10, 42, 40},
      {"black_level", "", -10, 10, 3, -7, -7},
      {"trigger_mode", "", 0, 3, 0, 1, 1},
      {"trigger_software", "", 0, 1, 0, 1, 0},
      {"lines", "", 0, 4294967295.0, 0, 4294967295.0, 4294967295.0},
      {"lines_2", "", 0, 7, 1, 2, 2},
      {"frame_rate_hz", "Hz", 30, 60, 60, 30, 30},
  };
  void *camera = open_camera("/dev/video0", NULL);
  size_t count;
  const placido_control *controls = driver->controls(camera, &count);
  assert_int_equal(count, 10); /* the cases, auto_exposure, clock */
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const size_t control = control_index(camera, cases[i].name);
    double value;
    assert_string_equal(controls[control].unit, cases[i].unit);
    assert_true(controls[control].min == cases[i].min && controls[control].max == cases[i].max);
    assert_int_equal(driver->get(camera, control, &value, NULL), PLACIDO_OK);
    assert_true(value == cases[i].value);
    assert_int_equal(driver->set(camera, control, cases[i].set, NULL), PLACIDO_OK);
    assert_int_equal(driver->get(camera, control, &value, NULL), PLACIDO_OK);
    assert_true(value == cases[i].after);
  }
  assert_string_equal(controls[control_index(camera, "trigger_mode")].help,
                      "0 Auto, 1 Manual, 3 Manual");
  double value;
  placido_error err = {0};
  const size_t clock = control_index(camera, "clock");
  assert_int_equal(driver->get(camera, clock, &value, NULL), PLACIDO_OK);
  assert_true(value == 4e9);
  assert_int_equal(driver->set(camera, clock, 1, &err), PLACIDO_UNSUPPORTED);
  assert_says(&err, "can only be read");
  driver->close(camera);
}

static void the_rate_is_not_changed_while_pictures_flow(void **state) {
  (void)state;
  void *camera = start_camera("/dev/video0");
  placido_error err = {0};
  assert_int_equal(driver->set(camera, control_index(camera, "frame_rate_hz"), 60, &err),
                   PLACIDO_SYSTEM);
  assert_says(&err, "while pictures flow");
  stop_camera(camera);
}

/* Through the front door and the kernel's own calls: what is open's reaches it, and what is no
 * camera is told. */
static void settings_reach_the_driver(void **state) {
  (void)state;
  static const struct {
    const char *uri;
    int status;
    const char *said;
  } cases[] = {
      {"v4l2:/dev/null?fps=30&size=640x480", PLACIDO_SYSTEM, "/dev/null is not a camera"},
      {"v4l2:/dev/null?gain=1&size=small", PLACIDO_INPUT, "size=small"},
      {"v4l2:serial=no such camera?buffers=3", PLACIDO_SYSTEM, "no camera with serial=no such"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    placido_device *device;
    placido_error err = {0};
    assert_int_equal(placido_device_open(&device, cases[i].uri, NULL, &err), cases[i].status);
    assert_null(device);
    assert_says(&err, cases[i].said);
  }
}

/* A tree like /sys: video0 of a USB device with a serial number, and what is no node. */
static char *make_tree(void **state) {
  static const char *const directories[] = {"sys", "sys/class", "sys/class/video4linux",
                                            "sys/class/video4linux/video0",
                                            "sys/class/video4linux/video0/device",
                                            "sys/class/video4linux/video1",
                                            "sys/class/video4linux/video1/device",
                                            "sys/class/video4linux/v4l-subdev0",
                                            "sys/class/video4linux/video99999"};
  for (size_t i = 0; i < sizeof directories / sizeof *directories; i++) {
    char *path = scratch_path(state, directories[i]);
    assert_int_equal(mkdir(path, 0700), 0);
    free(path);
  }
  free(scratch_write_text(state, "sys/class/video4linux/video0/serial", "A\tB-7\n"));
  free(scratch_write_text(state, "sys/class/video4linux/video1/serial", "A\tB-7\n"));
  free(scratch_write_text(state, "sys/class/video4linux/video0/manufacturer", "Maker\n"));
  return scratch_path(state, "");
}

static int note_found(void *user, const char *uri, const char *description) {
  snprintf(user, 300, "%s %s", uri, description);
  return 7;
}

static void cameras_are_found_by_serial_and_bus(void **state) {
  reset(state);
  char *root = make_tree(state);
  root[strlen(root) - 1] = '\0';
  placido_v4l2_calls calls = fake_calls;
  calls.root = root;
  char found[300] = "";
  assert_int_equal(placido_v4l2_scan(&calls, note_found, found, NULL), 7);
  assert_string_equal(
      found, "v4l2:/dev/video0 Fake camera (v4l2:serial=A B-7, v4l2:bus=usb-fake-1)");
  static const char *const addresses[] = {"serial=A B-7?fps=30", "bus=usb-fake-1", "/dev/video0"};
  for (size_t i = 0; i < 3; i++) {
    void *camera;
    assert_int_equal(placido_v4l2_open(&camera, addresses[i], &calls, NULL, NULL), PLACIDO_OK);
    const placido_device_info *info = driver->info(camera);
    assert_string_equal(info->vendor, "Maker");
    assert_string_equal(info->model, "Fake camera");
    assert_string_equal(info->serial, "A B-7");
    assert_true(isnan(info->axis_z_mm));
    driver->close(camera);
  }
  assert_int_equal(fake.open_count, 0);
  fake.second_bus = "usb-fake-2"; /* cheap cameras share a serial number */
  void *camera;
  placido_error err = {0};
  assert_int_equal(placido_v4l2_open(&camera, "serial=A B-7", &calls, NULL, &err), PLACIDO_INPUT);
  assert_says(&err, "v4l2:bus=usb-fake-1");
  fake.second_bus = fake.bus; /* two nodes of one camera: the first is it */
  assert_int_equal(placido_v4l2_open(&camera, "serial=A B-7", &calls, NULL, NULL), PLACIDO_OK);
  driver->close(camera);
  assert_int_equal(fake.open_count, 0);
  fake.is_not_camera = true;
  assert_int_equal(placido_v4l2_scan(&calls, note_found, found, NULL), PLACIDO_OK);
  assert_int_equal(fake.open_count, 0);
  free(root);
}

static int add_mode(void *user, const placido_device_mode *mode) {
  char *text = user;
  const size_t length = strlen(text);
  snprintf(text + length, 300 - length, "%s%s %dx%d %g/s..%d;", mode->format,
           mode->is_readable ? "" : "?", mode->width_max_px, mode->height_max_px,
           mode->rates_hz[0], mode->rate_count);
  return strstr(mode->format, "NV12") ? 7 : PLACIDO_OK;
}

static void what_a_camera_offers_is_listed(void **state) {
  (void)state;
  fake.offers[1] = (struct fake_offer){V4L2_PIX_FMT_YUYV, 16, 8, {5}};
  fake.offers[2] = (struct fake_offer){V4L2_PIX_FMT_YUYV, 32, 16, {5}};
  fake.offers[3] = (struct fake_offer){v4l2_fourcc('H', '2', '6', '4'), 64, 32, {30}};
  char text[300] = "";
  void *camera = start_camera("/dev/video0"); /* also while pictures flow */
  assert_int_equal(driver->modes(camera, add_mode, text, NULL), PLACIDO_OK);
  assert_string_equal(
      text, "GREY 8x4 60/s..2;YUYV 16x8 5/s..1;YUYV 32x16 5/s..1;H264? 64x32 30/s..1;");
  fake.offers[1].fourcc = V4L2_PIX_FMT_NV12;
  assert_int_equal(driver->modes(camera, add_mode, text, NULL), 7);
  fake_unplug();
  placido_error err = {0};
  assert_int_equal(driver->modes(camera, add_mode, text, &err), PLACIDO_GONE);
  assert_says(&err, "unplugged");
  stop_camera(camera);
}

/* Whoever used the camera last may have left it slow. */
static void the_fastest_rate_is_taken_where_none_is_asked(void **state) {
  (void)state;
  static const struct {
    const char *address;
    uint32_t rate;
  } cases[] = {{"/dev/video0", 60}, {"/dev/video0?fps=30", 30}, {"/dev/video0?size=8x4", 60}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    fake.rate = i % 2 ? 60 : 30;
    driver->close(open_camera(cases[i].address, NULL));
    assert_int_equal(fake.rate, cases[i].rate);
  }
  fake.offers[0].rates[0] = 0; /* it lists none: it is left as it is */
  fake.rate = 30;
  driver->close(open_camera("/dev/video0", NULL));
  assert_int_equal(fake.rate, 30);
  fake.offers[0].rates[0] = 4000000000u; /* no camera */
  driver->close(open_camera("/dev/video0", NULL));
  assert_int_equal(fake.rate, 30);
}

/* udev's links to a camera's node, which follow it wherever it is plugged in. */
static void links_lead_to_the_camera(void **state) {
  reset(state);
  char *root = make_tree(state);
  root[strlen(root) - 1] = '\0';
  placido_v4l2_calls calls = fake_calls;
  calls.root = root;
  static const char *const directories[] = {"dev", "dev/v4l", "dev/v4l/by-id", "dev/v4l/by-path"};
  for (size_t i = 0; i < sizeof directories / sizeof *directories; i++) {
    char *path = scratch_path(state, directories[i]);
    assert_int_equal(mkdir(path, 0700), 0);
    free(path);
  }
  static const char *const names[] = {"dev/v4l/by-id/usb-Maker_Fake_camera_A-video-index0",
                                      "dev/v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0"};
  free(scratch_write_text(state, "dev/video0", ""));
  for (size_t i = 0; i < 2; i++) {
    char *path = scratch_path(state, names[i]), address[200];
    assert_int_equal(symlink("../../video0", path), 0);
    snprintf(address, sizeof address, "/%s?fps=30", names[i]);
    void *camera;
    assert_int_equal(placido_v4l2_open(&camera, address, &calls, NULL, NULL), PLACIDO_OK);
    const placido_device_info *info = driver->info(camera);
    assert_string_equal(info->serial, "A B-7"); /* of video0: the link was followed */
    assert_non_null(strstr(info->uri, names[i])); /* and is what it is called by */
    driver->close(camera);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(placido_v4l2_open(&camera, address, &calls, NULL, NULL), PLACIDO_SYSTEM);
    free(path);
  }
  assert_int_equal(fake.open_count, 0);
  free(root);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, reset, nothing_is_left)
  const struct CMUnitTest tests[] = {
      TEST(every_format_is_agreed_and_streamed),
      TEST(the_best_for_mires_is_chosen),
      TEST(a_camera_without_rates_or_sizes_is_taken_as_it_is),
      TEST(a_range_of_sizes_is_left_as_it_is_set),
      TEST(wrong_addresses_are_told),
      TEST(controls_have_units_and_ranges),
      TEST(the_rate_is_not_changed_while_pictures_flow),
      TEST(settings_reach_the_driver),
      cmocka_unit_test_setup_teardown(cameras_are_found_by_serial_and_bus, scratch_setup,
                                      scratch_teardown),
      cmocka_unit_test_setup_teardown(links_lead_to_the_camera, scratch_setup, scratch_teardown),
      TEST(what_a_camera_offers_is_listed),
      TEST(the_fastest_rate_is_taken_where_none_is_asked),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
