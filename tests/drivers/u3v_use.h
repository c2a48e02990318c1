/* What tests do with a USB3 Vision camera whose script is `fake`. */
#ifndef PLACIDO_TESTS_DRIVERS_U3V_USE_H
#define PLACIDO_TESTS_DRIVERS_U3V_USE_H

#include "drivers/u3v/u3v.h"
#include "tests/drivers/device_use.h"
#include "tests/drivers/u3v_fake.h"

void *open_camera(const char *address, placido_notes *notes);
void *start_camera(const char *address);
void assert_counts(const void *camera, uint64_t frames, uint64_t dropped, uint64_t corrupt,
                   uint64_t truncated, uint64_t restarts);
/* Takes a frame that must show the samples of picture `id` in all its rows but the last
 * `black_rows`. */
void take_picture_of(void *camera, placido_frame *frame, uint64_t id, int black_rows);

#endif
