/* What tests do with a device that a script plays, whatever its driver. */
#include "tests/drivers/device_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

void *started(void *device) {
  placido_error err = {0};
  if (driver->start(device, &err)) {
    fail_msg("%s", err.text);
  }
  return device;
}

void stop_camera(void *camera) {
  assert_int_equal(driver->stop(camera, NULL), PLACIDO_OK);
  driver->close(camera);
}

placido_device_statistics counts_of(const void *camera) {
  placido_device_statistics counts;
  driver->statistics(camera, &counts);
  return counts;
}

void take(void *camera, placido_frame *frame) {
  placido_error err = {0};
  if (driver->next(camera, frame, 500, &err)) {
    fail_msg("%s", err.text);
  }
}

void assert_says(const placido_error *err, const char *text) {
  if (!strstr(err->text, text)) {
    fail_msg("\"%s\" does not say \"%s\"", err->text, text);
  }
}

size_t control_index(void *device, const char *name) {
  size_t count;
  const placido_control *controls = driver->controls(device, &count);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(controls[i].name, name) == 0) {
      return i;
    }
  }
  fail_msg("no control %s", name);
  return 0;
}

double value_of(void *device, const char *name) {
  double value;
  placido_error err = {0};
  if (driver->get(device, control_index(device, name), &value, &err)) {
    fail_msg("%s", err.text);
  }
  return value;
}

void set(void *device, const char *name, double value) {
  placido_error err = {0};
  if (driver->set(device, control_index(device, name), value, &err)) {
    fail_msg("%s", err.text);
  }
}
