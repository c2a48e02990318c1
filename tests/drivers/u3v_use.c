/* What tests do with a USB3 Vision camera whose script is `fake`. */
#include "tests/drivers/u3v_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

const placido_driver *const driver = &placido_u3v_driver;

int reset(void **state) {
  (void)state;
  fake_reset();
  return 0;
}

int nothing_is_left(void **state) {
  (void)state;
  return fake.open_count == 0 && fake.own_count == 0 && fake.pending_count == 0 ? 0 : -1;
}

void *open_camera(const char *address, placido_notes *notes) {
  void *camera;
  placido_error err = {0};
  if (placido_u3v_open(&camera, address, &fake_calls, notes, &err)) {
    fail_msg("%s", err.text);
  }
  return camera;
}

void *start_camera(const char *address) {
  return started(open_camera(address, NULL));
}

void assert_counts(const void *camera, uint64_t frames, uint64_t dropped, uint64_t corrupt,
                   uint64_t truncated, uint64_t restarts) {
  const placido_device_statistics counts = counts_of(camera);
  assert_int_equal(counts.frames, frames);
  assert_int_equal(counts.dropped, dropped);
  assert_int_equal(counts.corrupt, corrupt);
  assert_int_equal(counts.truncated, truncated);
  assert_int_equal(counts.restarts, restarts);
}

void take_picture_of(void *camera, placido_frame *frame, uint64_t id, int black_rows) {
  take(camera, frame);
  for (int y = 0; y < frame->height_px; y++) {
    for (int x = 0; x < frame->width_px; x++) {
      const size_t byte = (size_t)y * frame->stride_bytes + (size_t)x;
      const bool is_black = y >= frame->height_px - black_rows;
      const uint8_t expected = is_black ? 0 : fake_sample(id, byte);
      if (frame->data[byte] != expected) {
        fail_msg("picture %d: sample %d, %d is %d, not %d", (int)id, x, y, frame->data[byte],
                 expected);
      }
    }
  }
  assert_int_equal((frame->flags & PLACIDO_FRAME_TRUNCATED) != 0, black_rows > 0);
}
