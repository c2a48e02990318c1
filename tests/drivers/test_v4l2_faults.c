/* Whatever call fails and whatever the camera's driver claims: no crash, no hang, nothing held. */
#include "base/memory.h"
#include "drivers/v4l2/v4l2.h"
#include "tests/drivers/v4l2_fake.h"

#include <errno.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

static const placido_driver *const driver = &placido_v4l2_driver;

/* How many calls a whole day with a camera may take, at most: a loop would pass it. */
#define CALLS_MAX 5000

/* The ways to the pictures. */
enum way { QUEUE, MULTIPLANAR, READ, WAYS };

static void set_up(enum way way) {
  fake_reset();
  fake.is_multiplanar = way == MULTIPLANAR;
  fake.can_stream = way != READ;
  fake.can_read = way == READ;
  fake.picture_size = 32;
  fake.offers[1] = (struct fake_offer){V4L2_PIX_FMT_YUYV, 16, 8, {30}};
  fake.controls[0] =
      (struct fake_control){V4L2_CID_GAIN, V4L2_CTRL_TYPE_MENU, 0, "Gain", 0, 3, 1, 1};
}

static void assert_told(int status, const placido_error *err) {
  if (status != PLACIDO_OK && !err->text[0]) {
    fail_msg("status %d without a sentence", status);
  }
  if (status != PLACIDO_OK) {
    assert_int_equal(err->status, status);
  }
}

/* Opens, regulates, takes pictures, stops, starts again, closes. Returns the first status that is
 * not PLACIDO_OK. */
static int run_a_day(void) {
  void *camera = NULL;
  placido_frame frame = {0};
  placido_error err = {0};
  int first = placido_v4l2_open(&camera, "/dev/video0?fps=30", &fake_calls, NULL, &err);
  assert_told(first, &err);
  assert_true((first == PLACIDO_OK) == (camera != NULL));
  for (int round = 0; camera && round < 2; round++) {
    size_t count;
    double value;
    driver->controls(camera, &count);
    for (size_t i = 0; i < count; i++) {
      int status = driver->get(camera, i, &value, &err);
      status = status ? status : driver->set(camera, i, value, &err);
      assert_told(status, &err);
      first = first ? first : status;
    }
    int status = driver->start(camera, &err);
    assert_told(status, &err);
    first = first ? first : status;
    for (int i = 0; !status && i < 6; i++) {
      const int taken = driver->next(camera, &frame, 20, &err);
      assert_told(taken, &err);
      assert_true(taken != PLACIDO_OK || frame.data);
      first = first ? first : taken;
    }
    if (!status) {
      assert_int_equal(driver->stop(camera, &err), PLACIDO_OK);
    }
  }
  if (camera) {
    driver->close(camera);
  }
  placido_frame_free(&frame);
  assert_int_equal(fake.open_count, 0);
  assert_int_equal(fake.mapped_count, 0);
  assert_true(fake.call_count < CALLS_MAX);
  return first;
}

static void every_call_may_fail_in_every_way(void **state) {
  (void)state;
  static const int codes[] = {EINTR, EAGAIN, EIO, ENODEV, EINVAL, ENOMEM, EBUSY, ENOTTY, 0};
  int failed_runs = 0;
  for (int way = 0; way < WAYS; way++) {
    set_up((enum way)way);
    assert_int_equal(run_a_day(), PLACIDO_OK);
    const int calls = fake.call_count;
    assert_true(calls > 40);
    for (size_t i = 0; i < sizeof codes / sizeof *codes; i++) {
      for (int n = 1; n <= calls; n++) {
        for (int for_ever = 0; for_ever < 2; for_ever++) {
          set_up((enum way)way);
          fake.fail_at = n;
          fake.fail_code = codes[i];
          fake.fails_for_ever = for_ever;
          failed_runs += run_a_day() != PLACIDO_OK;
        }
      }
    }
  }
  assert_true(failed_runs > 100); /* the faults did arrive */
}

static void every_event_may_be_the_unplugging(void **state) {
  (void)state;
  for (int way = 0; way < WAYS; way++) {
    for (int n = 0; n < 12; n++) {
      set_up((enum way)way);
      for (int i = 0; i < n; i++) {
        fake_next((struct fake_event){0});
      }
      fake_next((struct fake_event){.is_unplug = true});
      assert_int_equal(run_a_day(), PLACIDO_GONE);
    }
  }
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  for (int way = 0; way < WAYS; way++) {
    int status = PLACIDO_MEMORY;
    for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
      set_up((enum way)way);
      placido_memory_fail_at(n);
      status = run_a_day();
      placido_memory_fail_at(0);
    }
    assert_int_equal(status, PLACIDO_OK);
  }
}

/* A driver that claims absurd things; `way` has been set up before. */
static void lie(int number) {
  static const uint32_t absurd[] = {1, 7, 0x7fffffff, 0x80000000u, 0xffffffffu};
  const uint32_t value = absurd[number % 5];
  uint32_t *const lies[] = {&fake.lie_width, &fake.lie_height, &fake.lie_stride,
                            &fake.lie_size,  &fake.lie_fourcc, &fake.lie_planes,
                            &fake.lie_count, &fake.lie_data_offset};
  if (number / 5 < 8) {
    *lies[number / 5] = value;
  } else if (number / 5 == 8) {
    fake.lie_length = value <= 7 ? value : 0; /* others are refused by mmap */
  } else {
    fake.lie_seconds = (int64_t)(value & 0x7fffffff) << 32 | value;
  }
}

static void absurd_claims_are_survived(void **state) {
  (void)state;
  for (int way = 0; way < WAYS; way++) {
    for (int number = 0; number < 50; number++) {
      set_up((enum way)way);
      lie(number);
      run_a_day();
    }
  }
}

static void a_buffer_that_is_not_ours_is_not_touched(void **state) {
  (void)state;
  static const uint32_t indices[] = {1, 4, 31, 32, 0x7fffffff, 0xffffffff};
  for (size_t i = 0; i < sizeof indices / sizeof *indices; i++) {
    set_up(QUEUE);
    fake_next((struct fake_event){0});
    /* 1 is ours and queued: the kernel's confusion costs a buffer, then a restart */
    for (int k = 0; k < 3; k++) {
      fake_next((struct fake_event){.is_elsewhere = true, .index = indices[i]});
    }
    run_a_day();
  }
}

static void a_list_without_end_ends(void **state) {
  (void)state;
  set_up(QUEUE);
  fake.lists_never_end = true;
  fake_next((struct fake_event){0});
  fake.call_count = -100000; /* lists may be long, but must end */
  run_a_day();
  assert_true(fake.call_count < 0);
}

static void a_queue_that_is_ready_and_empty_does_not_hang(void **state) {
  (void)state;
  set_up(QUEUE);
  fake.is_always_ready = true;
  for (int i = 0; i < FAKE_EVENTS; i++) {
    fake_next((struct fake_event){.code = EAGAIN});
  }
  assert_int_equal(run_a_day(), PLACIDO_TIMEOUT);
}

static void limits_of_controls_are_survived(void **state) {
  (void)state;
  static const int64_t limits[] = {INT64_MIN, -1, 0, 1, INT32_MAX, INT64_MAX};
  static const uint32_t types[] = {V4L2_CTRL_TYPE_INTEGER, V4L2_CTRL_TYPE_MENU,
                                   V4L2_CTRL_TYPE_INTEGER64, V4L2_CTRL_TYPE_BITMASK,
                                   V4L2_CTRL_TYPE_INTEGER_MENU};
  for (int i = 0; i < 6 * 6 * 5; i++) {
    set_up(QUEUE);
    fake.controls[0] = (struct fake_control){
        .id = V4L2_CID_EXPOSURE_ABSOLUTE,
        .type = types[i / 36],
        .name = i % 2 ? "" : "A name of exactly 32 characters!",
        .min = limits[i % 6],
        .max = limits[i / 6 % 6],
        .value = limits[i / 6 % 6]};
    run_a_day();
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_call_may_fail_in_every_way),
      cmocka_unit_test(every_event_may_be_the_unplugging),
      cmocka_unit_test(every_allocation_may_fail),
      cmocka_unit_test(absurd_claims_are_survived),
      cmocka_unit_test(a_buffer_that_is_not_ours_is_not_touched),
      cmocka_unit_test(a_list_without_end_ends),
      cmocka_unit_test(a_queue_that_is_ready_and_empty_does_not_hang),
      cmocka_unit_test(limits_of_controls_are_survived),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
