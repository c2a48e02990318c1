/* What tests do with a device that a script plays, whatever its driver. */
#ifndef PLACIDO_TESTS_DRIVERS_DEVICE_USE_H
#define PLACIDO_TESTS_DRIVERS_DEVICE_USE_H

#include "drivers/driver.h"

/* Defined beside each script: the driver; setup: a new device; teardown: fails where something of
 * it is held. */
extern const placido_driver *const driver;
int reset(void **state);
int nothing_is_left(void **state);

/* Starts an open device and returns it. */
void *started(void *device);
void stop_camera(void *camera);
placido_device_statistics counts_of(const void *camera);
void take(void *camera, placido_frame *frame);
void assert_says(const placido_error *err, const char *text);

/* The place of a control in the driver's list; its value; sets it. */
size_t control_index(void *device, const char *name);
double value_of(void *device, const char *name);
void set(void *device, const char *name, double value);

#endif
