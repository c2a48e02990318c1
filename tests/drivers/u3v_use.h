/* What tests do with a USB3 Vision camera whose script is `fake`. */
#ifndef PLACIDO_TESTS_DRIVERS_U3V_USE_H
#define PLACIDO_TESTS_DRIVERS_U3V_USE_H

#include "drivers/u3v/u3v.h"
#include "tests/drivers/u3v_fake.h"

/* Setup: a camera. Teardown: fails where something of it is held. */
int reset(void **state);
int nothing_is_left(void **state);

void *open_camera(const char *address, placido_notes *notes);
void *start_camera(const char *address);
void stop_camera(void *camera);
placido_device_statistics counts_of(const void *camera);
void assert_counts(const void *camera, uint64_t frames, uint64_t dropped, uint64_t corrupt,
                   uint64_t truncated, uint64_t restarts);
void take(void *camera, placido_frame *frame);
/* Takes a frame that must show the samples of picture `id` in all its rows but the last
 * `black_rows`. */
void take_picture_of(void *camera, placido_frame *frame, uint64_t id, int black_rows);
void assert_says(const placido_error *err, const char *text);

/* The place of a control in the driver's list; its value; sets it. */
size_t control_index(void *camera, const char *name);
double value_of(void *camera, const char *name);
void set(void *camera, const char *name, double value);

#endif
