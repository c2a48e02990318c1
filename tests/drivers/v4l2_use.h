/* What tests do with a camera whose script is `fake`. */
#ifndef PLACIDO_TESTS_DRIVERS_V4L2_USE_H
#define PLACIDO_TESTS_DRIVERS_V4L2_USE_H

#include "drivers/v4l2/v4l2.h"
#include "tests/drivers/device_use.h"
#include "tests/drivers/v4l2_fake.h"

/* The picture that the camera gives: 8 x 4 samples. */
extern const uint8_t grey[32];

void *open_camera(const char *address, placido_notes *notes);
void *start_camera(const char *address);

/* Gives the camera controls of every kind. */
void have_controls(void);

#endif
