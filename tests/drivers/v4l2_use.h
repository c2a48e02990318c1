/* What tests do with a camera whose script is `fake`. */
#ifndef PLACIDO_TESTS_DRIVERS_V4L2_USE_H
#define PLACIDO_TESTS_DRIVERS_V4L2_USE_H

#include "drivers/v4l2/v4l2.h"
#include "tests/drivers/v4l2_fake.h"

/* The picture that the camera gives: 8 x 4 samples. */
extern const uint8_t grey[32];

/* Setup: a camera that gives `grey`. Teardown: fails where something of the camera is held. */
int reset(void **state);
int nothing_is_left(void **state);

void *open_camera(const char *address, placido_notes *notes);
void *start_camera(const char *address);
void stop_camera(void *camera);
placido_device_statistics counts_of(const void *camera);
void take(void *camera, placido_frame *frame);
void assert_says(const placido_error *err, const char *text);

/* Gives the camera controls of every kind; the place of one in the driver's list. */
void have_controls(void);
size_t control_index(void *camera, const char *name);

#endif
