/* What tests do with a camera whose script is `fake`. */
#include "tests/drivers/v4l2_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

const placido_driver *const driver = &placido_v4l2_driver;

const uint8_t grey[32] = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16,
                          17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32};

int reset(void **state) {
  (void)state;
  fake_reset();
  fake.picture = grey;
  fake.picture_size = sizeof grey;
  return 0;
}

int nothing_is_left(void **state) {
  (void)state;
  return fake.open_count == 0 && fake.mapped_count == 0 ? 0 : -1;
}

void *open_camera(const char *address, placido_notes *notes) {
  void *camera;
  placido_error err = {0};
  if (placido_v4l2_open(&camera, address, &fake_calls, notes, &err)) {
    fail_msg("%s", err.text);
  }
  return camera;
}

void *start_camera(const char *address) {
  return started(open_camera(address, NULL));
}

void have_controls(void) {
  static const struct fake_control controls[] = {
      {V4L2_CID_USER_CLASS, V4L2_CTRL_TYPE_CTRL_CLASS, 0, "User Controls", 0, 0, 0, 0},
      {V4L2_CID_BLACK_LEVEL, V4L2_CTRL_TYPE_INTEGER, 0, "Black", -10, 10, 1, 3},
      {V4L2_CID_GAIN, V4L2_CTRL_TYPE_INTEGER, 0, "Gain", 0, 100, 5, 10},
      {V4L2_CID_HFLIP, V4L2_CTRL_TYPE_BOOLEAN, V4L2_CTRL_FLAG_DISABLED, "Flip", 0, 1, 1, 0},
      {V4L2_CID_BASE + 0x1000, V4L2_CTRL_TYPE_MENU, 0, "Trigger Mode", 0, 3, 1, 0},
      {V4L2_CID_BASE + 0x1001, V4L2_CTRL_TYPE_BUTTON, 0, "Trigger, Software!", 0, 0, 0, 0},
      {V4L2_CID_BASE + 0x1002, V4L2_CTRL_TYPE_INTEGER64, V4L2_CTRL_FLAG_READ_ONLY, "Clock", 0,
       5000000000, 1, 4000000000},
      {V4L2_CID_BASE + 0x1003, V4L2_CTRL_TYPE_BITMASK, 0, "Lines", 0, 0xffffffff, 0, 0},
      {V4L2_CID_BASE + 0x1004, V4L2_CTRL_TYPE_INTEGER, 0, "Lines", 0, 7, 1, 1},
      {V4L2_CID_BASE + 0x1005, V4L2_CTRL_TYPE_STRING, 0, "Text", 0, 7, 1, 1},
      {V4L2_CID_EXPOSURE_AUTO, V4L2_CTRL_TYPE_MENU, 0, "Auto Exposure", 0, 3, 1, 3},
      {V4L2_CID_EXPOSURE_ABSOLUTE, V4L2_CTRL_TYPE_INTEGER, V4L2_CTRL_FLAG_INACTIVE, "Exposure", 1,
       500, 1, 20},
  };
  memcpy(fake.controls, controls, sizeof controls);
}
